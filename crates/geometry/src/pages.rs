//! Arrays in large pages.

use bytemuck::Pod;
use memmap2::MmapMut;
use std::fmt::{Debug, Formatter};
use std::marker::PhantomData;

/// An array of fixed length in memory of its own, in large pages where the system has them: a ray touches a page or two
/// for every node, and each small page costs a walk through the page table.
pub(crate) struct Pages<T> {
    /// None for an empty array.
    map: Option<MmapMut>,
    length: usize,
    item: PhantomData<T>,
}

impl<T: Pod> Pages<T> {
    /// An array of zeros. Panics if the system has no memory left, as any allocation does.
    pub(crate) fn new(length: usize) -> Self {
        let map = (length > 0).then(|| {
            let map = MmapMut::map_anon(length * size_of::<T>()).expect("memory for the accelerator");
            // A hint: without large pages all is the same, only slower.
            #[cfg(target_os = "linux")]
            let _ = map.advise(memmap2::Advice::HugePage);
            map
        });
        Self { map, length, item: PhantomData }
    }

    /// The items.
    #[inline(always)]
    pub(crate) fn as_slice(&self) -> &[T] {
        self.map.as_ref().map_or(&[], |map| bytemuck::cast_slice(&map[..self.length * size_of::<T>()]))
    }

    /// The items.
    pub(crate) fn as_mut_slice(&mut self) -> &mut [T] {
        let bytes = self.length * size_of::<T>();
        self.map.as_mut().map_or(&mut [], |map| bytemuck::cast_slice_mut(&mut map[..bytes]))
    }
}

impl<T> Debug for Pages<T> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} items", self.length)
    }
}
