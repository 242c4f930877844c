//! The lanes of x86-64.
//!
//! Every `unsafe` block here calls one intrinsic, and for each the reason is the same: a value of the
//! implementing type exists, so the processor has its instructions: only [`avx2`] and [`avx512`] make one, for which
//! their callers promise that. SSE2 is part of the target.

use std::arch::x86_64::*;

use super::{F4, Lanes, Task, quad::Exact};

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

/// 2^84 and 2^52: with these exponents the last 32 bits of a number count from 2^32 and from 1.
const UPPER: f64 = 19_342_813_113_834_066_795_298_816.0;
const LOWER: f64 = 4_503_599_627_370_496.0;

/// Instructions for four f64 in a single register.
macro_rules! one_register_of_f64 {
    ($lanes:ty) => {
        impl Exact for $lanes {
            type D4 = __m256d;

            #[inline(always)]
            fn load_f64(self, from: &[f64; 4]) -> Self::D4 {
                unsafe { _mm256_loadu_pd(from.as_ptr()) }
            }

            #[inline(always)]
            fn store_f64(self, a: Self::D4) -> [f64; 4] {
                let mut out = [0.0; 4];
                unsafe { _mm256_storeu_pd(out.as_mut_ptr(), a) };
                out
            }

            #[inline(always)]
            fn add(self, a: Self::D4, b: Self::D4) -> Self::D4 {
                unsafe { _mm256_add_pd(a, b) }
            }

            #[inline(always)]
            fn sub(self, a: Self::D4, b: Self::D4) -> Self::D4 {
                unsafe { _mm256_sub_pd(a, b) }
            }

            #[inline(always)]
            fn mul(self, a: Self::D4, b: Self::D4) -> Self::D4 {
                unsafe { _mm256_mul_pd(a, b) }
            }

            #[inline(always)]
            fn div(self, a: Self::D4, b: Self::D4) -> Self::D4 {
                unsafe { _mm256_div_pd(a, b) }
            }

            #[inline(always)]
            fn sqrt(self, a: Self::D4) -> Self::D4 {
                unsafe { _mm256_sqrt_pd(a) }
            }

            #[inline(always)]
            fn below(self, a: Self::D4, b: Self::D4) -> Self::D4 {
                unsafe { _mm256_cmp_pd::<_CMP_LT_OQ>(a, b) }
            }

            #[inline(always)]
            fn differs(self, a: Self::D4, b: Self::D4) -> Self::D4 {
                unsafe { _mm256_cmp_pd::<_CMP_NEQ_UQ>(a, b) }
            }

            #[inline(always)]
            fn and(self, a: Self::D4, b: Self::D4) -> Self::D4 {
                unsafe { _mm256_and_pd(a, b) }
            }

            #[inline(always)]
            fn or(self, a: Self::D4, b: Self::D4) -> Self::D4 {
                unsafe { _mm256_or_pd(a, b) }
            }

            #[inline(always)]
            fn signs(self, a: Self::D4) -> u32 {
                unsafe { _mm256_movemask_pd(a) as u32 }
            }

            type U4 = __m256i;

            #[inline(always)]
            fn load_u64(self, from: &[u64; 4]) -> Self::U4 {
                unsafe { _mm256_loadu_si256(from.as_ptr().cast()) }
            }

            #[inline(always)]
            fn xor(self, a: Self::U4, b: Self::U4) -> Self::U4 {
                unsafe { _mm256_xor_si256(a, b) }
            }

            #[inline(always)]
            fn add_words(self, a: Self::U4, b: Self::U4) -> Self::U4 {
                unsafe { _mm256_add_epi64(a, b) }
            }

            #[inline(always)]
            fn mul_words(self, a: Self::U4, b: Self::U4) -> Self::U4 {
                // Halves of 32 bits; the product of both upper ones is beyond what is asked for.
                unsafe {
                    let low = _mm256_mul_epu32(a, b);
                    let upper_a = _mm256_mul_epu32(_mm256_srli_epi64::<32>(a), b);
                    let upper_b = _mm256_mul_epu32(a, _mm256_srli_epi64::<32>(b));
                    let upper = _mm256_add_epi64(upper_a, upper_b);
                    _mm256_add_epi64(low, _mm256_slli_epi64::<32>(upper))
                }
            }

            #[inline(always)]
            fn shift<const N: i32>(self, a: Self::U4) -> Self::U4 {
                unsafe { _mm256_srli_epi64::<N>(a) }
            }

            #[inline(always)]
            fn to_f64(self, a: Self::U4) -> Self::D4 {
                // With an exponent before them, 32 bits are a number more than 2^52 or 2^84.
                unsafe {
                    let exponents = [_mm256_set1_pd(UPPER), _mm256_set1_pd(LOWER)];
                    let upper = _mm256_castsi256_pd(_mm256_srli_epi64::<32>(a));
                    let upper = _mm256_sub_pd(_mm256_or_pd(upper, exponents[0]), exponents[0]);
                    let lower = _mm256_blend_epi32::<0b1010_1010>(a, _mm256_castpd_si256(exponents[1]));
                    let lower = _mm256_sub_pd(_mm256_castsi256_pd(lower), exponents[1]);
                    _mm256_add_pd(upper, lower)
                }
            }
        }
    };
}

one_register_of_f64!(Avx2);
one_register_of_f64!(Avx512);

impl Exact for Sse2 {
    type D4 = [__m128d; 2];

    #[inline(always)]
    fn load_f64(self, from: &[f64; 4]) -> Self::D4 {
        let [low, high] = [&from[..2], &from[2..]];
        unsafe { [_mm_loadu_pd(low.as_ptr()), _mm_loadu_pd(high.as_ptr())] }
    }

    #[inline(always)]
    fn store_f64(self, a: Self::D4) -> [f64; 4] {
        let mut out = [0.0; 4];
        unsafe {
            _mm_storeu_pd(out[..2].as_mut_ptr(), a[0]);
            _mm_storeu_pd(out[2..].as_mut_ptr(), a[1]);
        }
        out
    }

    #[inline(always)]
    fn add(self, a: Self::D4, b: Self::D4) -> Self::D4 {
        unsafe { [_mm_add_pd(a[0], b[0]), _mm_add_pd(a[1], b[1])] }
    }

    #[inline(always)]
    fn sub(self, a: Self::D4, b: Self::D4) -> Self::D4 {
        unsafe { [_mm_sub_pd(a[0], b[0]), _mm_sub_pd(a[1], b[1])] }
    }

    #[inline(always)]
    fn mul(self, a: Self::D4, b: Self::D4) -> Self::D4 {
        unsafe { [_mm_mul_pd(a[0], b[0]), _mm_mul_pd(a[1], b[1])] }
    }

    #[inline(always)]
    fn div(self, a: Self::D4, b: Self::D4) -> Self::D4 {
        unsafe { [_mm_div_pd(a[0], b[0]), _mm_div_pd(a[1], b[1])] }
    }

    #[inline(always)]
    fn sqrt(self, a: Self::D4) -> Self::D4 {
        unsafe { [_mm_sqrt_pd(a[0]), _mm_sqrt_pd(a[1])] }
    }

    #[inline(always)]
    fn below(self, a: Self::D4, b: Self::D4) -> Self::D4 {
        unsafe { [_mm_cmplt_pd(a[0], b[0]), _mm_cmplt_pd(a[1], b[1])] }
    }

    #[inline(always)]
    fn differs(self, a: Self::D4, b: Self::D4) -> Self::D4 {
        unsafe { [_mm_cmpneq_pd(a[0], b[0]), _mm_cmpneq_pd(a[1], b[1])] }
    }

    #[inline(always)]
    fn and(self, a: Self::D4, b: Self::D4) -> Self::D4 {
        unsafe { [_mm_and_pd(a[0], b[0]), _mm_and_pd(a[1], b[1])] }
    }

    #[inline(always)]
    fn or(self, a: Self::D4, b: Self::D4) -> Self::D4 {
        unsafe { [_mm_or_pd(a[0], b[0]), _mm_or_pd(a[1], b[1])] }
    }

    #[inline(always)]
    fn signs(self, a: Self::D4) -> u32 {
        let [low, high] = [0, 1].map(|i| unsafe { _mm_movemask_pd(a[i]) as u32 });
        low | high << 2
    }
    type U4 = [__m128i; 2];

    #[inline(always)]
    fn load_u64(self, from: &[u64; 4]) -> Self::U4 {
        let [low, high] = [&from[..2], &from[2..]];
        unsafe {
            [
                _mm_loadu_si128(low.as_ptr().cast()),
                _mm_loadu_si128(high.as_ptr().cast()),
            ]
        }
    }

    #[inline(always)]
    fn xor(self, a: Self::U4, b: Self::U4) -> Self::U4 {
        unsafe { [_mm_xor_si128(a[0], b[0]), _mm_xor_si128(a[1], b[1])] }
    }

    #[inline(always)]
    fn add_words(self, a: Self::U4, b: Self::U4) -> Self::U4 {
        unsafe { [_mm_add_epi64(a[0], b[0]), _mm_add_epi64(a[1], b[1])] }
    }

    #[inline(always)]
    fn mul_words(self, a: Self::U4, b: Self::U4) -> Self::U4 {
        [0, 1].map(|i| unsafe {
            let (a, b) = (a[i], b[i]);
            let low = _mm_mul_epu32(a, b);
            let upper_a = _mm_mul_epu32(_mm_srli_epi64::<32>(a), b);
            let upper_b = _mm_mul_epu32(a, _mm_srli_epi64::<32>(b));
            let upper = _mm_add_epi64(upper_a, upper_b);
            _mm_add_epi64(low, _mm_slli_epi64::<32>(upper))
        })
    }

    #[inline(always)]
    fn shift<const N: i32>(self, a: Self::U4) -> Self::U4 {
        unsafe { [_mm_srli_epi64::<N>(a[0]), _mm_srli_epi64::<N>(a[1])] }
    }

    #[inline(always)]
    fn to_f64(self, a: Self::U4) -> Self::D4 {
        [0, 1].map(|i| unsafe {
            let exponents = [_mm_set1_pd(UPPER), _mm_set1_pd(LOWER)];
            let upper = _mm_castsi128_pd(_mm_srli_epi64::<32>(a[i]));
            let upper = _mm_sub_pd(_mm_or_pd(upper, exponents[0]), exponents[0]);
            let lower = _mm_castsi128_pd(_mm_srli_epi64::<32>(_mm_slli_epi64::<32>(a[i])));
            let lower = _mm_sub_pd(_mm_or_pd(lower, exponents[1]), exponents[1]);
            _mm_add_pd(upper, lower)
        })
    }
}
