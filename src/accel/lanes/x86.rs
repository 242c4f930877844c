//! The lanes of x86-64.
//!
//! Every `unsafe` block here calls one intrinsic, and for each the reason is the same: a value of the
//! implementing type exists, so the processor has its instructions: only [`avx2`] and [`avx512`] make one, for which
//! their callers promise that. SSE2 is part of the target.

use std::arch::x86_64::*;

use super::{F4, Lanes, Task};

/// Two registers of four lanes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sse2;

/// One register of eight lanes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Avx2(());

/// As [`Avx2`], encoded with thirty-two registers and masks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Avx512(());

/// Does a task.
#[inline(never)]
pub(super) fn sse2<T: Task>(task: T) -> T::Output {
    task.run(Sse2)
}

/// Does a task.
///
/// # Safety
/// The processor has these features.
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt")]
pub(super) unsafe fn avx2<T: Task>(task: T) -> T::Output {
    task.run(Avx2(()))
}

/// Does a task.
///
/// # Safety
/// The processor has these features.
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,avx512f,avx512vl,avx512dq,avx512bw")]
pub(super) unsafe fn avx512<T: Task>(task: T) -> T::Output {
    task.run(Avx512(()))
}

impl Lanes for Sse2 {
    type F8 = [__m128; 2];

    #[inline(always)]
    fn load(self, from: &[f32; 8]) -> Self::F8 {
        let [low, high] = [&from[..4], &from[4..]];
        unsafe { [_mm_loadu_ps(low.as_ptr()), _mm_loadu_ps(high.as_ptr())] }
    }

    #[inline(always)]
    fn splat(self, x: f32) -> Self::F8 {
        unsafe { [_mm_set1_ps(x); 2] }
    }

    #[inline(always)]
    fn mul_add(self, a: Self::F8, b: Self::F8, c: Self::F8) -> Self::F8 {
        unsafe { [0, 1].map(|i| _mm_add_ps(_mm_mul_ps(a[i], b[i]), c[i])) }
    }

    #[inline(always)]
    fn min(self, a: Self::F8, b: Self::F8) -> Self::F8 {
        unsafe { [_mm_min_ps(a[0], b[0]), _mm_min_ps(a[1], b[1])] }
    }

    #[inline(always)]
    fn max(self, a: Self::F8, b: Self::F8) -> Self::F8 {
        unsafe { [_mm_max_ps(a[0], b[0]), _mm_max_ps(a[1], b[1])] }
    }

    #[inline(always)]
    fn at_most(self, a: Self::F8, b: Self::F8) -> u32 {
        let [low, high] = [0, 1].map(|i| unsafe { _mm_movemask_ps(_mm_cmple_ps(a[i], b[i])) as u32 });
        low | high << 4
    }

    #[inline(always)]
    fn store(self, a: Self::F8) -> [f32; 8] {
        let mut out = [0.0; 8];
        unsafe {
            _mm_storeu_ps(out[..4].as_mut_ptr(), a[0]);
            _mm_storeu_ps(out[4..].as_mut_ptr(), a[1]);
        }
        out
    }

    #[inline(always)]
    fn halves(self, a: Self::F8) -> [F4; 2] {
        a.map(F4)
    }

    #[inline(always)]
    fn join(self, halves: [F4; 2]) -> Self::F8 {
        halves.map(|half| half.0)
    }

    #[inline(always)]
    fn mul_add4(self, a: F4, b: F4, c: F4) -> F4 {
        a.mul(b).add(c)
    }

    #[inline(always)]
    fn mul_sub4(self, a: F4, b: F4, c: F4) -> F4 {
        a.mul(b).sub(c)
    }
}

/// What AVX2 and AVX-512VL write alike.
macro_rules! one_register {
    () => {
        type F8 = __m256;

        #[inline(always)]
        fn load(self, from: &[f32; 8]) -> Self::F8 {
            unsafe { _mm256_loadu_ps(from.as_ptr()) }
        }

        #[inline(always)]
        fn splat(self, x: f32) -> Self::F8 {
            unsafe { _mm256_set1_ps(x) }
        }

        #[inline(always)]
        fn mul_add(self, a: Self::F8, b: Self::F8, c: Self::F8) -> Self::F8 {
            unsafe { _mm256_fmadd_ps(a, b, c) }
        }

        #[inline(always)]
        fn min(self, a: Self::F8, b: Self::F8) -> Self::F8 {
            unsafe { _mm256_min_ps(a, b) }
        }

        #[inline(always)]
        fn max(self, a: Self::F8, b: Self::F8) -> Self::F8 {
            unsafe { _mm256_max_ps(a, b) }
        }

        #[inline(always)]
        fn store(self, a: Self::F8) -> [f32; 8] {
            let mut out = [0.0; 8];
            unsafe { _mm256_storeu_ps(out.as_mut_ptr(), a) };
            out
        }

        #[inline(always)]
        fn halves(self, a: Self::F8) -> [F4; 2] {
            unsafe {
                [
                    F4(_mm256_castps256_ps128(a)),
                    F4(_mm256_extractf128_ps::<1>(a)),
                ]
            }
        }

        #[inline(always)]
        fn join(self, [low, high]: [F4; 2]) -> Self::F8 {
            unsafe { _mm256_set_m128(high.0, low.0) }
        }

        #[inline(always)]
        fn mul_add4(self, a: F4, b: F4, c: F4) -> F4 {
            F4(unsafe { _mm_fmadd_ps(a.0, b.0, c.0) })
        }

        #[inline(always)]
        fn mul_sub4(self, a: F4, b: F4, c: F4) -> F4 {
            F4(unsafe { _mm_fmsub_ps(a.0, b.0, c.0) })
        }
    };
}

impl Lanes for Avx2 {
    one_register!();

    #[inline(always)]
    fn at_most(self, a: Self::F8, b: Self::F8) -> u32 {
        unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(a, b)) as u32 }
    }
}

impl Lanes for Avx512 {
    one_register!();

    #[inline(always)]
    fn at_most(self, a: Self::F8, b: Self::F8) -> u32 {
        u32::from(unsafe { _mm256_cmp_ps_mask::<_CMP_LE_OQ>(a, b) })
    }
}
