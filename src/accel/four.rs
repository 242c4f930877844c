//! Four f32 at once: SSE2, which every x86-64 has, or plain arithmetic. No fused operation in either.

#![allow(unsafe_code)]

#[cfg(target_arch = "x86_64")]
mod imp {
    use std::arch::x86_64::*;

    /// Four lanes.
    #[derive(Clone, Copy, Debug)]
    pub(in crate::accel) struct F4(__m128);

    // SAFETY of all calls below: SSE2 is part of the x86-64 target.
    impl F4 {
        #[inline(always)]
        pub(in crate::accel) fn splat(x: f32) -> Self {
            Self(unsafe { _mm_set1_ps(x) })
        }

        #[inline(always)]
        pub(in crate::accel) fn from_array(a: [f32; 4]) -> Self {
            Self(unsafe { _mm_setr_ps(a[0], a[1], a[2], a[3]) })
        }

        #[inline(always)]
        pub(in crate::accel) fn add(self, b: Self) -> Self {
            Self(unsafe { _mm_add_ps(self.0, b.0) })
        }

        #[inline(always)]
        pub(in crate::accel) fn sub(self, b: Self) -> Self {
            Self(unsafe { _mm_sub_ps(self.0, b.0) })
        }

        #[inline(always)]
        pub(in crate::accel) fn mul(self, b: Self) -> Self {
            Self(unsafe { _mm_mul_ps(self.0, b.0) })
        }

        /// The smaller of each lane; the second where either is NaN.
        #[inline(always)]
        pub(in crate::accel) fn min(self, b: Self) -> Self {
            Self(unsafe { _mm_min_ps(self.0, b.0) })
        }

        /// The larger of each lane; the second where either is NaN.
        #[inline(always)]
        pub(in crate::accel) fn max(self, b: Self) -> Self {
            Self(unsafe { _mm_max_ps(self.0, b.0) })
        }

        #[inline(always)]
        pub(in crate::accel) fn to_array(self) -> [f32; 4] {
            let mut out = [0.0; 4];
            unsafe { _mm_storeu_ps(out.as_mut_ptr(), self.0) };
            out
        }

        /// The sign bits of each lane, for [`F4::flip`].
        #[inline(always)]
        pub(in crate::accel) fn sign(self) -> Self {
            Self(unsafe { _mm_and_ps(self.0, _mm_set1_ps(-0.0)) })
        }

        /// Each lane negated where `sign` has its sign bit set.
        #[inline(always)]
        pub(in crate::accel) fn flip(self, sign: Self) -> Self {
            Self(unsafe { _mm_xor_ps(self.0, sign.0) })
        }

        /// One bit for each lane where `self < b`; clear where either is NaN.
        #[inline(always)]
        pub(in crate::accel) fn below(self, b: Self) -> u32 {
            unsafe { _mm_movemask_ps(_mm_cmplt_ps(self.0, b.0)) as u32 }
        }
    }
}

#[cfg(not(target_arch = "x86_64"))]
mod imp {
    /// Four lanes.
    #[derive(Clone, Copy, Debug)]
    pub(in crate::accel) struct F4([f32; 4]);

    impl F4 {
        #[inline(always)]
        fn zip(self, b: Self, f: impl Fn(f32, f32) -> f32) -> Self {
            Self(std::array::from_fn(|i| f(self.0[i], b.0[i])))
        }

        #[inline(always)]
        pub(in crate::accel) fn splat(x: f32) -> Self {
            Self([x; 4])
        }

        #[inline(always)]
        pub(in crate::accel) fn from_array(a: [f32; 4]) -> Self {
            Self(a)
        }

        #[inline(always)]
        pub(in crate::accel) fn add(self, b: Self) -> Self {
            self.zip(b, |a, b| a + b)
        }

        #[inline(always)]
        pub(in crate::accel) fn sub(self, b: Self) -> Self {
            self.zip(b, |a, b| a - b)
        }

        #[inline(always)]
        pub(in crate::accel) fn mul(self, b: Self) -> Self {
            self.zip(b, |a, b| a * b)
        }

        /// The smaller of each lane; the second where either is NaN.
        #[inline(always)]
        pub(in crate::accel) fn min(self, b: Self) -> Self {
            self.zip(b, |a, b| if a < b { a } else { b })
        }

        /// The larger of each lane; the second where either is NaN.
        #[inline(always)]
        pub(in crate::accel) fn max(self, b: Self) -> Self {
            self.zip(b, |a, b| if a > b { a } else { b })
        }

        #[inline(always)]
        pub(in crate::accel) fn to_array(self) -> [f32; 4] {
            self.0
        }

        /// The sign bits of each lane, for [`F4::flip`].
        #[inline(always)]
        pub(in crate::accel) fn sign(self) -> Self {
            Self(self.0.map(|a| f32::from_bits(a.to_bits() & 0x8000_0000)))
        }

        /// Each lane negated where `sign` has its sign bit set.
        #[inline(always)]
        pub(in crate::accel) fn flip(self, sign: Self) -> Self {
            self.zip(sign, |a, s| f32::from_bits(a.to_bits() ^ s.to_bits()))
        }

        /// One bit for each lane where `self < b`; clear where either is NaN.
        #[inline(always)]
        pub(in crate::accel) fn below(self, b: Self) -> u32 {
            (0..4).fold(0, |mask, i| mask | u32::from(self.0[i] < b.0[i]) << i)
        }
    }
}

pub(super) use imp::F4;
