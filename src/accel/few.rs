//! A few values on the processor's own stack.

#![allow(unsafe_code)]

use std::mem::MaybeUninit;

/// Up to `N` values, the last to come the first to go. Making it writes nothing, where a list of values for every ray would
/// have to be filled for the few that are looked at.
pub struct Few<T, const N: usize> {
    values: [MaybeUninit<T>; N],
    len: usize,
}

impl<T: Copy, const N: usize> Few<T, N> {
    /// No values.
    #[inline(always)]
    #[must_use]
    pub fn empty() -> Self {
        Self {
            values: [const { MaybeUninit::uninit() }; N],
            len: 0,
        }
    }

    /// Whether there is no room left.
    #[inline(always)]
    #[must_use]
    pub fn is_full(&self) -> bool {
        self.len == N
    }

    /// Adds a value; what there is no room for is dropped.
    #[inline(always)]
    pub fn push(&mut self, value: T) {
        if let Some(place) = self.values.get_mut(self.len) {
            place.write(value);
            self.len += 1;
        }
    }

    /// The values, in the order in which they came.
    #[inline(always)]
    #[must_use]
    pub fn as_slice(&self) -> &[T] {
        let written = self.values.get(..self.len).unwrap_or_default();
        // SAFETY: `push` wrote the first `len` values, and one that may be uninitialized has the layout of one that is not.
        unsafe { &*(std::ptr::from_ref(written) as *const [T]) }
    }

    /// Forgets all values.
    #[inline(always)]
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Takes the value that came last.
    #[inline(always)]
    pub fn pop(&mut self) -> Option<T> {
        let len = self.len.checked_sub(1)?;
        let value = self.values.get(len)?;
        self.len = len;
        // SAFETY: `push` wrote the first `len` values.
        Some(unsafe { value.assume_init() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_come_back_in_the_opposite_order_and_no_more_than_there_is_room_for() {
        let mut few = Few::<u32, 3>::empty();
        assert_eq!(few.pop(), None);
        for value in 0..5 {
            assert_eq!(few.is_full(), value >= 3);
            few.push(value);
        }
        assert_eq!(few.as_slice(), [0, 1, 2]);
        assert_eq!([(); 4].map(|()| few.pop()), [Some(2), Some(1), Some(0), None]);
        few.push(7);
        assert_eq!((few.pop(), few.pop()), (Some(7), None));
        few.push(8);
        few.clear();
        assert!(few.as_slice().is_empty() && few.pop().is_none());
    }
}
