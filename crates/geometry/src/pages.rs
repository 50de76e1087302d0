//! Arrays in large pages.
#![allow(unsafe_code)] // One view of bytes as items, checked once instead of for every ray; see the block.

use bytemuck::Pod;
use std::fmt::{Debug, Formatter};
use std::ptr::NonNull;

/// An array of fixed length in memory of its own, in large pages where the system has them: a ray touches a page or two
/// for every node, and each small page costs a walk through the page table.
pub(crate) struct Pages<T> {
    /// The memory; none for an empty array.
    map: Option<Map>,
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
        let size = length.checked_mul(size_of::<T>()).expect("an array of fewer bytes than there are addresses");
        if size > 0 {
            let bytes = &mut pages.map.insert(zeros(size))[..size];
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

#[cfg(not(miri))]
type Map = memmap2::MmapMut;

/// Some bytes, all zero.
#[cfg(not(miri))]
fn zeros(size: usize) -> Map {
    let map = Map::map_anon(size).expect("memory for the accelerator");
    // A hint: without large pages all is the same, only slower.
    #[cfg(target_os = "linux")]
    let _ = map.advise(memmap2::Advice::HugePage);
    map
}

/// An allocation in place of the mapping, which Miri does not have: lines of 64 bytes, aligned as those of the cache.
#[cfg(miri)]
struct Map(Vec<Line>);

#[cfg(miri)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(64))]
struct Line([u8; 64]);

#[cfg(miri)]
fn zeros(size: usize) -> Map {
    Map(vec![Line([0; 64]); size.div_ceil(64)])
}

#[cfg(miri)]
impl std::ops::Deref for Map {
    type Target = [u8];
    fn deref(&self) -> &[u8] {
        bytemuck::cast_slice(&self.0)
    }
}

#[cfg(miri)]
impl std::ops::DerefMut for Map {
    fn deref_mut(&mut self) -> &mut [u8] {
        bytemuck::cast_slice_mut(&mut self.0)
    }
}

impl<T> Debug for Pages<T> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} items in {:?} bytes", self.length, self.map.as_ref().map(|map| map.len()))
    }
}

#[cfg(test)]
mod tests {
    use super::Pages;

    #[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
    #[repr(C, align(64))]
    struct Item([u32; 16]);

    #[test]
    fn items_are_zero_and_keep_what_is_written() {
        for length in [0, 1, 5] {
            let mut pages = Pages::<Item>::new(length);
            assert_eq!(pages.as_slice(), vec![Item([0; 16]); length]);
            for (i, item) in pages.as_mut_slice().iter_mut().enumerate() {
                item.0[i] = 7;
            }
            // The memory stays where it is, and may be read and dropped by another thread.
            let pages = std::thread::spawn(move || {
                assert!(pages.as_slice().iter().enumerate().all(|(i, item)| item.0[i] == 7 && item.0[15] == 0));
                pages
            });
            assert_eq!(pages.join().unwrap().as_slice().len(), length);
        }
        // One item, of which a cache line holds several.
        let mut bytes = Pages::<u8>::new(1);
        bytes.as_mut_slice()[0] = 255;
        assert_eq!(bytes.as_slice(), [255]);
    }

    #[test]
    #[should_panic(expected = "fewer bytes than there are addresses")]
    fn a_length_whose_bytes_overflow_panics() {
        // 64 bytes too many to count: unchecked, the product is 64.
        let _ = Pages::<Item>::new(usize::MAX / 64 + 2);
    }
}
