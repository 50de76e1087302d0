//! A stack on the stack, without the cost of clearing it for every ray.
#![allow(unsafe_code)] // To read back what was pushed; see the block.

use std::mem::MaybeUninit;

/// Room for up to `N` entries of a [`Stack`]. It aligns the frame of the function that holds it, where compilers that run out of registers
/// would else put vectors across cache lines.
#[repr(align(64))]
pub(super) struct Room<T, const N: usize>([MaybeUninit<T>; N]);

impl<T, const N: usize> Room<T, N> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self([const { MaybeUninit::uninit() }; N])
    }
}

/// Up to `N` entries. Their number lies apart from them, so that it can be kept in a register.
pub(super) struct Stack<'a, T, const N: usize> {
    entries: &'a mut [MaybeUninit<T>; N],
    /// The entries below are initialised, always.
    length: usize,
}

impl<'a, T: Copy, const N: usize> Stack<'a, T, N> {
    #[inline(always)]
    pub(super) fn new(room: &'a mut Room<T, N>) -> Self {
        Self { entries: &mut room.0, length: 0 }
    }

    /// Panics if the stack is full, which the depth of trees rules out.
    #[inline(always)]
    pub(super) fn push(&mut self, entry: T) {
        self.entries[self.length].write(entry);
        self.length += 1;
    }

    #[inline(always)]
    pub(super) fn pop(&mut self) -> Option<T> {
        self.length = self.length.checked_sub(1)?;
        // SAFETY: the entry lies below what the length was, so it has been pushed.
        Some(unsafe { self.entries[self.length].assume_init() })
    }

    #[inline(always)]
    pub(super) fn len(&self) -> usize {
        self.length
    }
}

impl<T: Copy + Ord, const N: usize> Stack<'_, T, N> {
    /// Pushes an entry below those from `base` on that are smaller, which lie in order.
    #[inline(always)]
    pub(super) fn insert(&mut self, base: usize, entry: T) {
        self.push(entry);
        let mut at = self.length - 1;
        while at > base {
            // SAFETY: `at - 1` is below the length.
            let below = unsafe { self.entries[at - 1].assume_init() };
            if below >= entry {
                break;
            }
            self.entries[at].write(below);
            at -= 1;
        }
        self.entries[at].write(entry);
    }
}

#[cfg(test)]
mod tests {
    use super::{Room, Stack};

    #[test]
    fn entries_come_back_last_first() {
        let mut room = Room::<u64, 4>::new();
        let mut stack = Stack::new(&mut room);
        assert_eq!(stack.pop(), None);
        for round in 0..3 {
            (0..4).for_each(|i| stack.push(10 * round + i));
            assert_eq!(stack.len(), 4);
            (0..4).rev().for_each(|i| assert_eq!(stack.pop(), Some(10 * round + i)));
            assert_eq!(stack.pop(), None);
        }
    }

    #[test]
    fn inserted_entries_lie_in_order_above_the_base() {
        let mut room = Room::<u32, 8>::new();
        let mut stack = Stack::new(&mut room);
        // The base is below all that is inserted, whatever it is.
        [5, 0].into_iter().for_each(|entry| stack.push(entry));
        [3, 9, 1, 9, 4, 2].into_iter().for_each(|entry| stack.insert(2, entry));
        let popped: Vec<u32> = std::iter::from_fn(|| stack.pop()).collect();
        assert_eq!(popped, [1, 2, 3, 4, 9, 9, 0, 5]);
    }

    #[test]
    #[should_panic(expected = "index out of bounds")]
    fn a_full_stack_panics() {
        let mut room = Room::<u8, 1>::new();
        let mut stack = Stack::new(&mut room);
        stack.push(1);
        stack.push(2);
    }
}
