//! Eight f32 at once, on whatever the processor offers. The box tests built from them are conservative, so which
//! of these runs never shows in a picture.

#![allow(unsafe_code)]

/// Instructions for the box tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Simd {
    /// Plain arithmetic, for every processor.
    Portable,
    /// Eight lanes in one AVX register (x86-64 with AVX2).
    #[cfg(target_arch = "x86_64")]
    Avx2,
}

impl Simd {
    /// The best that this processor has. The environment variable `RTSCRIPT_SIMD=portable` forces the plain one,
    /// for tests that compare.
    #[must_use]
    pub fn detect() -> Self {
        static FOUND: std::sync::OnceLock<Simd> = std::sync::OnceLock::new();
        *FOUND.get_or_init(|| {
            #[cfg(target_arch = "x86_64")]
            if is_x86_feature_detected!("avx2")
                && is_x86_feature_detected!("bmi1")
                && is_x86_feature_detected!("lzcnt")
                && std::env::var_os("RTSCRIPT_SIMD").is_none_or(|wish| wish != "portable")
            {
                return Self::Avx2;
            }
            Self::Portable
        })
    }
}

/// Eight lanes of f32.
///
/// # Safety
/// The functions may only be called where the processor has the instructions of the implementing type.
pub(super) unsafe trait Lanes: Copy {
    type F: Copy;
    unsafe fn load(from: &[f32; 8]) -> Self::F;
    unsafe fn splat(x: f32) -> Self::F;
    unsafe fn sub(a: Self::F, b: Self::F) -> Self::F;
    unsafe fn mul(a: Self::F, b: Self::F) -> Self::F;
    unsafe fn min(a: Self::F, b: Self::F) -> Self::F;
    unsafe fn max(a: Self::F, b: Self::F) -> Self::F;
    /// One bit for each lane where `a <= b`.
    unsafe fn at_most(a: Self::F, b: Self::F) -> u32;
    unsafe fn store(a: Self::F) -> [f32; 8];
}

#[derive(Clone, Copy)]
pub(super) struct Portable;

#[inline(always)]
fn zip(a: [f32; 8], b: [f32; 8], f: impl Fn(f32, f32) -> f32) -> [f32; 8] {
    std::array::from_fn(|i| f(a[i], b[i]))
}

// SAFETY: plain arithmetic.
unsafe impl Lanes for Portable {
    type F = [f32; 8];

    #[inline(always)]
    unsafe fn load(from: &[f32; 8]) -> Self::F {
        *from
    }

    #[inline(always)]
    unsafe fn splat(x: f32) -> Self::F {
        [x; 8]
    }

    #[inline(always)]
    unsafe fn sub(a: Self::F, b: Self::F) -> Self::F {
        zip(a, b, |a, b| a - b)
    }

    #[inline(always)]
    unsafe fn mul(a: Self::F, b: Self::F) -> Self::F {
        zip(a, b, |a, b| a * b)
    }

    #[inline(always)]
    unsafe fn min(a: Self::F, b: Self::F) -> Self::F {
        zip(a, b, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    unsafe fn max(a: Self::F, b: Self::F) -> Self::F {
        zip(a, b, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    unsafe fn at_most(a: Self::F, b: Self::F) -> u32 {
        (0..8).fold(0, |mask, i| mask | u32::from(a[i] <= b[i]) << i)
    }

    #[inline(always)]
    unsafe fn store(a: Self::F) -> [f32; 8] {
        a
    }
}

#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
pub(super) struct Avx2;

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    use super::{Avx2, Lanes};

    // SAFETY: each function is one AVX instruction.
    unsafe impl Lanes for Avx2 {
        type F = __m256;

        #[inline(always)]
        unsafe fn load(from: &[f32; 8]) -> Self::F {
            unsafe { _mm256_loadu_ps(from.as_ptr()) }
        }

        #[inline(always)]
        unsafe fn splat(x: f32) -> Self::F {
            unsafe { _mm256_set1_ps(x) }
        }

        #[inline(always)]
        unsafe fn sub(a: Self::F, b: Self::F) -> Self::F {
            unsafe { _mm256_sub_ps(a, b) }
        }

        #[inline(always)]
        unsafe fn mul(a: Self::F, b: Self::F) -> Self::F {
            unsafe { _mm256_mul_ps(a, b) }
        }

        #[inline(always)]
        unsafe fn min(a: Self::F, b: Self::F) -> Self::F {
            unsafe { _mm256_min_ps(a, b) }
        }

        #[inline(always)]
        unsafe fn max(a: Self::F, b: Self::F) -> Self::F {
            unsafe { _mm256_max_ps(a, b) }
        }

        #[inline(always)]
        unsafe fn at_most(a: Self::F, b: Self::F) -> u32 {
            unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(a, b)) as u32 }
        }

        #[inline(always)]
        unsafe fn store(a: Self::F) -> [f32; 8] {
            let mut out = [0.0; 8];
            unsafe { _mm256_storeu_ps(out.as_mut_ptr(), a) };
            out
        }
    }
}

/// Asks for the cache line at `at` before it is needed; hides memory latency in large scenes.
#[inline(always)]
pub(super) fn prefetch<T>(at: *const T) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: a hint; it never faults, whatever the address.
    unsafe {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        _mm_prefetch::<_MM_HINT_T0>(at.cast());
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = at;
}
