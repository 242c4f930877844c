//! Eight f32 or four f64 at once, on whatever the processor offers. What is computed with f32 is conservative, and with f64
//! exact ([`quad`]), so which of these runs never shows in a picture.

#![allow(unsafe_code)]

mod quad;
#[cfg(test)]
mod tests;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use quad::{Exact, Four, Mask, Words};

use super::four::F4;

/// Sets of instructions for the conservative tests, the plainest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Simd {
    /// Plain arithmetic, for every processor.
    Portable,
    /// Two registers of four lanes (every x86-64).
    #[cfg(target_arch = "x86_64")]
    Sse2,
    /// One register of eight lanes and fused multiply-add (x86-64 with AVX2).
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// The same with twice the registers and with masks (x86-64 with AVX-512VL).
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Simd {
    /// The fastest that this processor has. The environment variable `RTSCRIPT_SIMD` names another, for tests that
    /// compare: `portable`, `sse2`, `avx2` or `avx512`; what the processor lacks is not taken.
    #[inline]
    #[must_use]
    pub fn detect() -> Self {
        static FOUND: std::sync::OnceLock<Simd> = std::sync::OnceLock::new();
        *FOUND.get_or_init(|| {
            let wish = std::env::var_os("RTSCRIPT_SIMD");
            let wish = match wish.as_ref().and_then(|name| name.to_str()) {
                Some("portable") => Self::Portable,
                #[cfg(target_arch = "x86_64")]
                Some("sse2") => Self::Sse2,
                #[cfg(target_arch = "x86_64")]
                Some("avx512") => Self::Avx512,
                _ => Self::FASTEST,
            };
            wish.min(Self::best())
        })
    }

    /// What is taken where the processor has it. The wider registers of AVX-512 hold one ray's eight boxes no better
    /// than those of AVX2, and measured 1 to 4 % slower.
    #[cfg(target_arch = "x86_64")]
    const FASTEST: Self = Self::Avx2;
    #[cfg(not(target_arch = "x86_64"))]
    const FASTEST: Self = Self::Portable;

    /// All that this processor has.
    #[cfg(test)]
    pub(super) fn all() -> Vec<Self> {
        let all = [
            Self::Portable,
            #[cfg(target_arch = "x86_64")]
            Self::Sse2,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2,
            #[cfg(target_arch = "x86_64")]
            Self::Avx512,
        ];
        all.into_iter().filter(|simd| *simd <= Self::best()).collect()
    }

    #[cfg(not(target_arch = "x86_64"))]
    fn best() -> Self {
        Self::Portable
    }

    #[cfg(target_arch = "x86_64")]
    fn best() -> Self {
        let avx2 = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("lzcnt");
        let avx512 = is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512vl")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512bw");
        match (avx2, avx512) {
            (true, true) => Self::Avx512,
            (true, false) => Self::Avx2,
            _ => Self::Sse2,
        }
    }
}

/// What is to be done with the instructions at hand.
pub trait Task {
    /// What comes of it.
    type Output;
    /// Does it. To be compiled with those instructions it has to be inlined, and so has what it calls.
    fn run<L: Lanes>(self, lanes: L) -> Self::Output;
}

impl Simd {
    /// Does a task with these instructions, which the processor must have: [`Simd::detect`] names no others.
    #[inline(always)]
    #[cfg_attr(
        not(target_arch = "x86_64"),
        allow(unused_unsafe, reason = "portable lanes need no instructions")
    )]
    pub(in crate::accel) fn run<T: Task>(self, task: T) -> T::Output {
        // Asked first: a branch that can be foreseen, where four ways would be a jump through a table.
        #[cfg(target_arch = "x86_64")]
        if self == Self::Avx2 {
            // SAFETY: only what the processor has is ever named.
            return unsafe { x86::avx2(task) };
        }
        // SAFETY: as above.
        unsafe {
            match self {
                Self::Portable => portable(task),
                #[cfg(target_arch = "x86_64")]
                Self::Sse2 => x86::sse2(task),
                #[cfg(target_arch = "x86_64")]
                Self::Avx2 => x86::avx2(task),
                #[cfg(target_arch = "x86_64")]
                Self::Avx512 => x86::avx512(task),
            }
        }
    }
}

/// Does a task with the fastest instructions that the processor has.
#[inline(always)]
pub fn run<T: Task>(task: T) -> T::Output {
    Simd::detect().run(task)
}

/// A function of its own: where it is not taken it must not take room on the stack.
#[inline(never)]
fn portable<T: Task>(task: T) -> T::Output {
    task.run(Portable)
}

/// Eight lanes of f32, what four lanes can do besides their own, and four exact lanes of f64.
///
/// A value of an implementing type is the proof that the processor has its instructions: only `Simd::run` makes one.
pub trait Lanes: Exact {
    /// Eight lanes.
    type F8: Copy;
    /// Eight numbers from memory.
    fn load(self, from: &[f32; 8]) -> Self::F8;
    /// One number in all lanes.
    fn splat(self, x: f32) -> Self::F8;
    /// `a * b + c`, rounded once or twice.
    fn mul_add(self, a: Self::F8, b: Self::F8, c: Self::F8) -> Self::F8;
    /// The smaller of each lane; the second where either is NaN.
    fn min(self, a: Self::F8, b: Self::F8) -> Self::F8;
    /// The larger of each lane; the second where either is NaN.
    fn max(self, a: Self::F8, b: Self::F8) -> Self::F8;
    /// One bit for each lane where `a <= b`; clear where either is NaN.
    fn at_most(self, a: Self::F8, b: Self::F8) -> u32;
    /// The lanes as an array.
    fn store(self, a: Self::F8) -> [f32; 8];
    /// The first four lanes and the last four.
    fn halves(self, a: Self::F8) -> [F4; 2];
    /// Eight lanes of four and four.
    fn join(self, halves: [F4; 2]) -> Self::F8;
    /// `a * b + c`, rounded once or twice.
    fn mul_add4(self, a: F4, b: F4, c: F4) -> F4;
    /// `a * b - c`, rounded once or twice.
    fn mul_sub4(self, a: F4, b: F4, c: F4) -> F4;
}

/// Plain arithmetic.
#[derive(Clone, Copy, Debug)]
pub(in crate::accel) struct Portable;

#[inline(always)]
fn zip(a: [f32; 8], b: [f32; 8], f: impl Fn(f32, f32) -> f32) -> [f32; 8] {
    std::array::from_fn(|i| f(a[i], b[i]))
}

impl Lanes for Portable {
    type F8 = [f32; 8];

    #[inline(always)]
    fn load(self, from: &[f32; 8]) -> Self::F8 {
        *from
    }

    #[inline(always)]
    fn splat(self, x: f32) -> Self::F8 {
        [x; 8]
    }

    #[inline(always)]
    fn mul_add(self, a: Self::F8, b: Self::F8, c: Self::F8) -> Self::F8 {
        zip(zip(a, b, |a, b| a * b), c, |ab, c| ab + c)
    }

    #[inline(always)]
    fn min(self, a: Self::F8, b: Self::F8) -> Self::F8 {
        zip(a, b, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn max(self, a: Self::F8, b: Self::F8) -> Self::F8 {
        zip(a, b, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn at_most(self, a: Self::F8, b: Self::F8) -> u32 {
        (0..8).fold(0, |mask, i| mask | u32::from(a[i] <= b[i]) << i)
    }

    #[inline(always)]
    fn store(self, a: Self::F8) -> [f32; 8] {
        a
    }

    #[inline(always)]
    fn halves(self, [a, b, c, d, e, f, g, h]: Self::F8) -> [F4; 2] {
        [F4::from_array([a, b, c, d]), F4::from_array([e, f, g, h])]
    }

    #[inline(always)]
    fn join(self, halves: [F4; 2]) -> Self::F8 {
        let [[a, b, c, d], [e, f, g, h]] = halves.map(F4::to_array);
        [a, b, c, d, e, f, g, h]
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

/// Asks for the cache line at `at` before it is needed; hides memory latency in large scenes.
#[inline(always)]
pub fn prefetch<T>(at: *const T) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: a hint; it never faults, whatever the address.
    unsafe {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        _mm_prefetch::<_MM_HINT_T0>(at.cast());
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = at;
}
