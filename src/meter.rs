//! How much memory a thread holds: an allocator that counts, for programs that run scripts of others.
//!
//! ```
//! use rtscript::meter::Meter;
//!
//! #[global_allocator]
//! static ALLOCATOR: Meter = Meter::new();
//! ```
//!
//! A program that installs it, as the command `rtscript` does, gets
//! [`Limits::script_memory`](crate::Limits::script_memory). Without it nothing is counted and that limit never ends a
//! script: what a script holds is then bounded only by its limits on single values, on variables, on steps and on time,
//! which can be many gigabytes.
//!
//! What is counted is what the thread has allocated and not freed. A script runs on a thread of its own, so that is
//! the script's, whatever the rest of the program does meanwhile. An allocation costs two additions more.
#![allow(
    unsafe_code,
    reason = "an allocator is unsafe to implement; every call is handed on unchanged"
)]

use std::{
    alloc::{GlobalAlloc, Layout, System},
    cell::Cell,
};

thread_local! {
    /// Bytes that this thread has allocated less those that it has freed, also those of other threads. Without a
    /// destructor, and made at compile time, so that an allocator may use it at any time.
    static HELD: Cell<isize> = const { Cell::new(0) };
}

/// An allocator that counts what each thread holds and leaves the work to another.
#[derive(Clone, Copy, Debug, Default)]
pub struct Meter<A = System> {
    inner: A,
}

impl Meter {
    /// The system's allocator, counted.
    #[must_use]
    pub const fn new() -> Self {
        Self { inner: System }
    }
}

impl<A> Meter<A> {
    /// Another allocator, counted.
    ///
    /// ```
    /// use std::alloc::System;
    /// use rtscript::meter::Meter;
    ///
    /// // In place of `System`, the allocator that the program uses otherwise.
    /// #[global_allocator]
    /// static ALLOCATOR: Meter<System> = Meter::around(System);
    ///
    /// # fn main() {
    /// let before = rtscript::meter::held();
    /// let kilobyte = vec![0u8; 1024];
    /// assert_eq!(rtscript::meter::held() - before, 1024);
    /// drop(kilobyte);
    /// # }
    /// ```
    #[must_use]
    pub const fn around(inner: A) -> Self {
        Self { inner }
    }
}

/// Bytes that the current thread holds; 0 where no [`Meter`] is installed. Below 0 where it frees what others allocated.
///
/// ```
/// // Nothing is counted where no `Meter` is the program's allocator.
/// assert_eq!(rtscript::meter::held(), 0);
/// ```
#[inline]
#[must_use]
pub fn held() -> isize {
    HELD.get()
}

#[inline]
fn count(bytes: usize) {
    HELD.set(HELD.get().wrapping_add_unsigned(bytes));
}

#[inline]
fn discount(bytes: usize) {
    HELD.set(HELD.get().wrapping_sub_unsigned(bytes));
}

// SAFETY: each method hands its arguments to the same method of `inner` and returns what that returns, so the contract
// is `inner`'s. Counting neither allocates nor unwinds: `HELD` is a plain thread-local without a destructor or an
// initializer that runs, and its arithmetic wraps.
unsafe impl<A: GlobalAlloc> GlobalAlloc for Meter<A> {
    #[inline]
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promise for `layout` is the one that `inner` asks for.
        let pointer = unsafe { self.inner.alloc(layout) };
        if !pointer.is_null() {
            count(layout.size());
        }
        pointer
    }

    #[inline]
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as for `alloc`.
        let pointer = unsafe { self.inner.alloc_zeroed(layout) };
        if !pointer.is_null() {
            count(layout.size());
        }
        pointer
    }

    #[inline]
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        discount(layout.size());
        // SAFETY: `pointer` came from `inner` with this layout, because all that `self` gives away does.
        unsafe { self.inner.dealloc(pointer, layout) }
    }

    #[inline]
    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, new_size: usize) -> *mut u8 {
        // SAFETY: `pointer` came from `inner` with this layout, and the caller's promise for `new_size` is the one that
        // `inner` asks for.
        let moved = unsafe { self.inner.realloc(pointer, layout, new_size) };
        if !moved.is_null() {
            discount(layout.size());
            count(new_size);
        }
        moved
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_allocation_is_counted_once_until_it_is_freed() {
        let meter = Meter::new();
        let before = held();
        let layout = Layout::from_size_align(1000, 8).unwrap();
        let larger = Layout::from_size_align(3000, 8).unwrap();
        // SAFETY: the layouts are not empty; what is allocated is resized and freed once, with the layout it then has.
        unsafe {
            let a = meter.alloc(layout);
            assert_eq!(held() - before, 1000);
            let a = meter.realloc(a, layout, 3000);
            assert_eq!(held() - before, 3000);
            let b = meter.alloc_zeroed(layout);
            assert_eq!(held() - before, 4000);
            meter.dealloc(a, larger);
            assert_eq!(held() - before, 1000);
            meter.dealloc(b, layout);
        }
        assert_eq!(held(), before);
    }

    #[test]
    fn what_another_thread_allocates_is_not_counted() {
        let meter = Meter::new();
        let layout = Layout::from_size_align(1000, 8).unwrap();
        let before = held();
        let there = std::thread::spawn(move || {
            let before = held();
            // SAFETY: the layout is not empty; what is allocated is freed once, with the same layout.
            unsafe {
                let pointer = meter.alloc(layout);
                let counted = held() - before;
                meter.dealloc(pointer, layout);
                counted
            }
        });
        assert_eq!(there.join().unwrap(), 1000);
        assert_eq!(held(), before);
    }
}
