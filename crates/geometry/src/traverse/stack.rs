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
