//! Arrays in large pages.
#![allow(unsafe_code)] // One view of bytes as items, checked once instead of for every ray; see the block.

use bytemuck::Pod;
use memmap2::MmapMut;
use std::fmt::{Debug, Formatter};
use std::ptr::NonNull;

/// An array of fixed length in memory of its own, in large pages where the system has them: a ray touches a page or two
/// for every node, and each small page costs a walk through the page table.
pub(crate) struct Pages<T> {
    /// The memory; none for an empty array.
    map: Option<MmapMut>,
    /// Its items.
    items: NonNull<T>,
    length: usize,
}

// SAFETY: the items belong to the array alone, as a vector's do.
unsafe impl<T: Send> Send for Pages<T> {}
// SAFETY: as above.
unsafe impl<T: Sync> Sync for Pages<T> {}

impl<T: Pod> Pages<T> {
    /// An array of zeros. Panics if the system has no memory left, as any allocation does.
    pub(crate) fn new(length: usize) -> Self {
        let mut pages = Self { map: None, items: NonNull::dangling(), length };
        if length > 0 {
            let map = MmapMut::map_anon(length * size_of::<T>()).expect("memory for the accelerator");
            // A hint: without large pages all is the same, only slower.
            #[cfg(target_os = "linux")]
            let _ = map.advise(memmap2::Advice::HugePage);
            let bytes = &mut pages.map.insert(map)[..length * size_of::<T>()];
            // The alignment and the length are checked here.
            pages.items = NonNull::from(bytemuck::cast_slice_mut::<u8, T>(bytes)).cast();
        }
        pages
    }

    /// The items.
    #[inline(always)]
    pub(crate) fn as_slice(&self) -> &[T] {
        // SAFETY: `length` items were seen there, the mapping lives as long as `self` and is not accessed in another way.
        unsafe { std::slice::from_raw_parts(self.items.as_ptr(), self.length) }
    }

    /// The items.
    pub(crate) fn as_mut_slice(&mut self) -> &mut [T] {
        // SAFETY: as above, and `self` is borrowed mutably.
        unsafe { std::slice::from_raw_parts_mut(self.items.as_ptr(), self.length) }
    }
}

impl<T> Debug for Pages<T> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} items in {:?} bytes", self.length, self.map.as_ref().map(|map| map.len()))
    }
}
