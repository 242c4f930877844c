//! As many rays at once as a register holds. What is computed with them is conservative, so which of these runs
//! never shows in a picture.

#![allow(unsafe_code)]

/// Lanes of f32, one for each ray. A value of an implementing type is the proof that the processor has its
/// instructions.
pub(super) trait Wide: Copy {
    /// Lanes of one value.
    const LANES: usize;
    type F: Copy;
    type Mask: Copy;
    /// The `group`-th run of lanes of an array.
    fn load<const N: usize>(self, from: &[f32; N], group: usize) -> Self::F;
    fn store<const N: usize>(self, a: Self::F, to: &mut [f32; N], group: usize);
    fn splat(self, x: f32) -> Self::F;
    fn sub(self, a: Self::F, b: Self::F) -> Self::F;
    fn mul(self, a: Self::F, b: Self::F) -> Self::F;
    fn div(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a * b + c`, rounded once or twice.
    fn mul_add(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// The smaller of each lane; the second where either is NaN.
    fn min(self, a: Self::F, b: Self::F) -> Self::F;
    /// The larger of each lane; the second where either is NaN.
    fn max(self, a: Self::F, b: Self::F) -> Self::F;
    /// The sign bits of each lane.
    fn sign(self, a: Self::F) -> Self::F;
    /// Each lane negated where `sign` has its sign bit set.
    fn flip(self, a: Self::F, sign: Self::F) -> Self::F;
    /// Where `a < b`; clear where either is NaN.
    fn below(self, a: Self::F, b: Self::F) -> Self::Mask;
    fn and(self, a: Self::Mask, b: Self::Mask) -> Self::Mask;
    fn select(self, mask: Self::Mask, yes: Self::F, no: Self::F) -> Self::F;
    /// One bit for each lane.
    fn bits(self, mask: Self::Mask) -> u64;

    // What follows is spelled out: a closure would be compiled without the instructions of the function around it.

    #[inline(always)]
    fn add(self, a: Self::F, b: Self::F) -> Self::F {
        self.mul_add(a, self.splat(1.0), b)
    }

    #[inline(always)]
    fn load3<const N: usize>(self, from: &[[f32; N]; 3], group: usize) -> [Self::F; 3] {
        [
            self.load(&from[0], group),
            self.load(&from[1], group),
            self.load(&from[2], group),
        ]
    }

    #[inline(always)]
    fn splat3(self, x: [f32; 3]) -> [Self::F; 3] {
        [self.splat(x[0]), self.splat(x[1]), self.splat(x[2])]
    }

    /// Lane `lane` of three arrays in all lanes.
    #[inline(always)]
    fn broadcast3<const N: usize>(self, from: &[[f32; N]; 3], lane: usize) -> [Self::F; 3] {
        [
            self.splat(from[0][lane]),
            self.splat(from[1][lane]),
            self.splat(from[2][lane]),
        ]
    }

    #[inline(always)]
    fn dot(self, a: [Self::F; 3], b: [Self::F; 3]) -> Self::F {
        self.mul_add(a[0], b[0], self.mul_add(a[1], b[1], self.mul(a[2], b[2])))
    }

    /// The greatest lane.
    #[inline(always)]
    fn most(self, a: Self::F) -> f32 {
        -self.least(self.sub(self.splat(0.0), a))
    }

    /// The least lane.
    #[inline(always)]
    fn least(self, a: Self::F) -> f32 {
        let mut lanes = [f32::INFINITY; 16];
        self.store(a, &mut lanes, 0);
        let mut least = lanes[0];
        for &lane in &lanes[1..Self::LANES] {
            least = if lane < least { lane } else { least };
        }
        least
    }
}

/// Where the `group`-th run of lanes begins in an array of `N`, which no group is beyond.
#[inline(always)]
fn place<W: Wide, const N: usize>(group: usize) -> usize {
    const { assert!(N.is_power_of_two() && W::LANES.is_power_of_two() && N >= W::LANES) }
    (group * W::LANES) & (N - 1)
}

/// Plain arithmetic, for every processor.
#[derive(Clone, Copy)]
pub(super) struct Plain;

#[inline(always)]
fn zip<T: Copy, R>(a: [T; 8], b: [T; 8], f: impl Fn(T, T) -> R) -> [R; 8] {
    std::array::from_fn(|i| f(a[i], b[i]))
}

impl Wide for Plain {
    const LANES: usize = 8;
    type F = [f32; 8];
    type Mask = [bool; 8];

    #[inline(always)]
    fn load<const N: usize>(self, from: &[f32; N], group: usize) -> Self::F {
        let at = place::<Self, N>(group);
        std::array::from_fn(|i| from[at + i])
    }

    #[inline(always)]
    fn store<const N: usize>(self, a: Self::F, to: &mut [f32; N], group: usize) {
        let at = place::<Self, N>(group);
        to[at..at + Self::LANES].copy_from_slice(&a);
    }

    #[inline(always)]
    fn splat(self, x: f32) -> Self::F {
        [x; 8]
    }

    #[inline(always)]
    fn sub(self, a: Self::F, b: Self::F) -> Self::F {
        zip(a, b, |a, b| a - b)
    }

    #[inline(always)]
    fn mul(self, a: Self::F, b: Self::F) -> Self::F {
        zip(a, b, |a, b| a * b)
    }

    #[inline(always)]
    fn div(self, a: Self::F, b: Self::F) -> Self::F {
        zip(a, b, |a, b| a / b)
    }

    #[inline(always)]
    fn mul_add(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F {
        zip(zip(a, b, |a, b| a * b), c, |ab, c| ab + c)
    }

    #[inline(always)]
    fn min(self, a: Self::F, b: Self::F) -> Self::F {
        zip(a, b, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn max(self, a: Self::F, b: Self::F) -> Self::F {
        zip(a, b, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn sign(self, a: Self::F) -> Self::F {
        a.map(|a| f32::from_bits(a.to_bits() & 0x8000_0000))
    }

    #[inline(always)]
    fn flip(self, a: Self::F, sign: Self::F) -> Self::F {
        zip(a, sign, |a, s| f32::from_bits(a.to_bits() ^ s.to_bits()))
    }

    #[inline(always)]
    fn below(self, a: Self::F, b: Self::F) -> Self::Mask {
        zip(a, b, |a, b| a < b)
    }

    #[inline(always)]
    fn and(self, a: Self::Mask, b: Self::Mask) -> Self::Mask {
        zip(a, b, |a, b| a & b)
    }

    #[inline(always)]
    fn select(self, mask: Self::Mask, yes: Self::F, no: Self::F) -> Self::F {
        std::array::from_fn(|i| if mask[i] { yes[i] } else { no[i] })
    }

    #[inline(always)]
    fn bits(self, mask: Self::Mask) -> u64 {
        (0..8).fold(0, |bits, i| bits | u64::from(mask[i]) << i)
    }
}

#[cfg(target_arch = "x86_64")]
pub(super) use x86::Avx2;

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    use super::{Wide, place};

    /// Eight lanes in an AVX register, with fused multiply-add.
    #[derive(Clone, Copy)]
    pub(in crate::accel::packet) struct Avx2(());

    impl Avx2 {
        /// # Safety
        /// The processor must have AVX2 and FMA.
        #[inline(always)]
        pub(in crate::accel::packet) unsafe fn assume() -> Self {
            Self(())
        }
    }

    // SAFETY of all calls below: whoever made the value promised the instructions, and `place` keeps loads and
    // stores inside the array.
    impl Wide for Avx2 {
        const LANES: usize = 8;
        type F = __m256;
        type Mask = __m256;

        #[inline(always)]
        fn load<const N: usize>(self, from: &[f32; N], group: usize) -> Self::F {
            unsafe { _mm256_loadu_ps(from.as_ptr().add(place::<Self, N>(group))) }
        }

        #[inline(always)]
        fn store<const N: usize>(self, a: Self::F, to: &mut [f32; N], group: usize) {
            unsafe { _mm256_storeu_ps(to.as_mut_ptr().add(place::<Self, N>(group)), a) }
        }

        #[inline(always)]
        fn splat(self, x: f32) -> Self::F {
            unsafe { _mm256_set1_ps(x) }
        }

        #[inline(always)]
        fn sub(self, a: Self::F, b: Self::F) -> Self::F {
            unsafe { _mm256_sub_ps(a, b) }
        }

        #[inline(always)]
        fn mul(self, a: Self::F, b: Self::F) -> Self::F {
            unsafe { _mm256_mul_ps(a, b) }
        }

        #[inline(always)]
        fn div(self, a: Self::F, b: Self::F) -> Self::F {
            unsafe { _mm256_div_ps(a, b) }
        }

        #[inline(always)]
        fn mul_add(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F {
            unsafe { _mm256_fmadd_ps(a, b, c) }
        }

        #[inline(always)]
        fn min(self, a: Self::F, b: Self::F) -> Self::F {
            unsafe { _mm256_min_ps(a, b) }
        }

        #[inline(always)]
        fn max(self, a: Self::F, b: Self::F) -> Self::F {
            unsafe { _mm256_max_ps(a, b) }
        }

        #[inline(always)]
        fn sign(self, a: Self::F) -> Self::F {
            unsafe { _mm256_and_ps(a, _mm256_set1_ps(-0.0)) }
        }

        #[inline(always)]
        fn flip(self, a: Self::F, sign: Self::F) -> Self::F {
            unsafe { _mm256_xor_ps(a, sign) }
        }

        #[inline(always)]
        fn below(self, a: Self::F, b: Self::F) -> Self::Mask {
            unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(a, b) }
        }

        #[inline(always)]
        fn and(self, a: Self::Mask, b: Self::Mask) -> Self::Mask {
            unsafe { _mm256_and_ps(a, b) }
        }

        #[inline(always)]
        fn select(self, mask: Self::Mask, yes: Self::F, no: Self::F) -> Self::F {
            unsafe { _mm256_blendv_ps(no, yes, mask) }
        }

        #[inline(always)]
        fn bits(self, mask: Self::Mask) -> u64 {
            u64::from(unsafe { _mm256_movemask_ps(mask) } as u32)
        }
    }
}
