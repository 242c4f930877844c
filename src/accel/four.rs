//! Four f32 at once: SSE2, which every x86-64 has, or plain arithmetic. No fused operation in either.

#![allow(unsafe_code)]

#[cfg(target_arch = "x86_64")]
mod imp {
    use std::arch::x86_64::*;

    use crate::math::DVec3;

    /// Four lanes.
    #[derive(Clone, Copy, Debug)]
    pub struct F4(pub(in crate::accel) __m128);

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

        /// A vector rounded to f32, and 0 in the last lane. Read number by number: a wider read of numbers that
        /// were just written one by one, or in other pairs, has to wait until they are in the cache.
        #[inline(always)]
        pub(in crate::accel) fn rounded(v: &DVec3) -> Self {
            unsafe {
                let nothing = _mm_setzero_ps();
                let x = _mm_cvtsd_ss(nothing, _mm_load_sd(&v.x));
                let y = _mm_cvtsd_ss(nothing, _mm_load_sd(&v.y));
                let z = _mm_cvtsd_ss(nothing, _mm_load_sd(&v.z));
                Self(_mm_movelh_ps(_mm_unpacklo_ps(x, y), z))
            }
        }

        /// Each lane without its sign.
        #[inline(always)]
        pub(in crate::accel) fn abs(self) -> Self {
            Self(unsafe { _mm_andnot_ps(_mm_set1_ps(-0.0), self.0) })
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

        /// The lanes one place on: y z x w.
        #[inline(always)]
        pub(in crate::accel) fn rotate(self) -> Self {
            Self(unsafe { _mm_shuffle_ps::<0b11_00_10_01>(self.0, self.0) })
        }

        /// The first lane.
        #[inline(always)]
        pub(in crate::accel) fn first(self) -> f32 {
            unsafe { _mm_cvtss_f32(self.0) }
        }

        /// Whole numbers as f32.
        #[inline(always)]
        pub(in crate::accel) fn from_whole(a: [i32; 4]) -> Self {
            Self(unsafe { _mm_cvtepi32_ps(_mm_loadu_si128(a.as_ptr().cast())) })
        }

        /// The first lanes of three, then the second and the third; the fourth lanes do not matter.
        #[inline(always)]
        pub(in crate::accel) fn transpose([x, y, z]: [Self; 3]) -> [Self; 3] {
            unsafe {
                let (low, high) = (_mm_unpacklo_ps(x.0, y.0), _mm_unpackhi_ps(x.0, y.0));
                [
                    Self(_mm_shuffle_ps::<0b00_00_01_00>(low, z.0)),
                    Self(_mm_shuffle_ps::<0b01_01_11_10>(low, z.0)),
                    Self(_mm_shuffle_ps::<0b10_10_01_00>(high, z.0)),
                ]
            }
        }

        /// Whole numbers, rounded towards 0. What is not within the range of i32 gives any number.
        #[inline(always)]
        pub(in crate::accel) fn truncate(self) -> [i32; 4] {
            let mut out = [0; 4];
            unsafe { _mm_storeu_si128(out.as_mut_ptr().cast(), _mm_cvttps_epi32(self.0)) };
            out
        }

        /// All bits set, which is NaN, in each lane where `self < b` does not hold.
        #[inline(always)]
        pub(in crate::accel) fn not_less(self, b: Self) -> Self {
            Self(unsafe { _mm_cmpnlt_ps(self.0, b.0) })
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

        #[inline(always)]
        pub(in crate::accel) fn div(self, b: Self) -> Self {
            Self(unsafe { _mm_div_ps(self.0, b.0) })
        }

        /// All bits of each lane where `self < b`; none where either is NaN.
        #[inline(always)]
        pub(in crate::accel) fn below(self, b: Self) -> Self {
            Self(unsafe { _mm_cmplt_ps(self.0, b.0) })
        }

        /// Bit by bit.
        #[inline(always)]
        pub(in crate::accel) fn or(self, b: Self) -> Self {
            Self(unsafe { _mm_or_ps(self.0, b.0) })
        }

        /// Bit by bit.
        #[inline(always)]
        pub(in crate::accel) fn and(self, b: Self) -> Self {
            Self(unsafe { _mm_and_ps(self.0, b.0) })
        }

        /// The topmost bit of each lane.
        #[inline(always)]
        pub(in crate::accel) fn bits(self) -> u32 {
            unsafe { _mm_movemask_ps(self.0) as u32 }
        }
    }
}

#[cfg(not(target_arch = "x86_64"))]
mod imp {
    use crate::math::DVec3;

    /// Four lanes.
    #[derive(Clone, Copy, Debug)]
    pub struct F4([f32; 4]);

    impl F4 {
        /// A vector rounded to f32, and 0 in the last lane.
        #[inline(always)]
        pub(in crate::accel) fn rounded(v: &DVec3) -> Self {
            Self([v.x as f32, v.y as f32, v.z as f32, 0.0])
        }

        /// Each lane without its sign.
        #[inline(always)]
        pub(in crate::accel) fn abs(self) -> Self {
            Self(self.0.map(f32::abs))
        }

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

        /// The lanes one place on: y z x w.
        #[inline(always)]
        pub(in crate::accel) fn rotate(self) -> Self {
            let [x, y, z, w] = self.0;
            Self([y, z, x, w])
        }

        /// The first lane.
        #[inline(always)]
        pub(in crate::accel) fn first(self) -> f32 {
            self.0[0]
        }

        /// Whole numbers as f32.
        #[inline(always)]
        pub(in crate::accel) fn from_whole(a: [i32; 4]) -> Self {
            Self(a.map(|x| x as f32))
        }

        /// The first lanes of three, then the second and the third; the fourth lanes do not matter.
        #[inline(always)]
        pub(in crate::accel) fn transpose([x, y, z]: [Self; 3]) -> [Self; 3] {
            [0, 1, 2].map(|k| Self([x.0[k], y.0[k], z.0[k], z.0[k]]))
        }

        /// Whole numbers, rounded towards 0. What is not within the range of i32 gives any number.
        #[inline(always)]
        pub(in crate::accel) fn truncate(self) -> [i32; 4] {
            self.0.map(|x| x as i32)
        }

        /// All bits set, which is NaN, in each lane where `self < b` does not hold.
        #[inline(always)]
        pub(in crate::accel) fn not_less(self, b: Self) -> Self {
            self.zip(b, |a, b| f32::from_bits(if a < b { 0 } else { u32::MAX }))
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

        #[inline(always)]
        fn combine(self, b: Self, f: impl Fn(u32, u32) -> u32) -> Self {
            self.zip(b, |a, b| f32::from_bits(f(a.to_bits(), b.to_bits())))
        }

        #[inline(always)]
        pub(in crate::accel) fn div(self, b: Self) -> Self {
            self.zip(b, |a, b| a / b)
        }

        /// All bits of each lane where `self < b`; none where either is NaN.
        #[inline(always)]
        pub(in crate::accel) fn below(self, b: Self) -> Self {
            self.zip(b, |a, b| f32::from_bits(if a < b { u32::MAX } else { 0 }))
        }

        /// Bit by bit.
        #[inline(always)]
        pub(in crate::accel) fn or(self, b: Self) -> Self {
            self.combine(b, |a, b| a | b)
        }

        /// Bit by bit.
        #[inline(always)]
        pub(in crate::accel) fn and(self, b: Self) -> Self {
            self.combine(b, |a, b| a & b)
        }

        /// The topmost bit of each lane.
        #[inline(always)]
        pub(in crate::accel) fn bits(self) -> u32 {
            (0..4).fold(0, |mask, i| mask | self.0[i].to_bits() >> 31 << i)
        }
    }
}

pub(super) use imp::F4;
