//! Boxes and primitives as the builder moves them.

use crate::frame::{Box32, half_area};
use std::array::from_fn;

/// A box as one vector, so that a union is one maximum: its lower corner negated, a lane for a primitive's index, its upper
/// corner, 1 if it holds a primitive that shares its leaf with no other.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub(crate) struct Span([f32; 8]);

impl Span {
    pub(super) const EMPTY: Self = Self([f32::NEG_INFINITY; 8]);

    /// A box, with zero in the other lanes.
    pub(crate) fn of(b: &Box32) -> Self {
        let [x, y, z] = b.min;
        Self([-x, -y, -z, 0.0, b.max[0], b.max[1], b.max[2], 0.0])
    }

    #[inline(always)]
    pub(crate) fn union(self, o: Self) -> Self {
        Self(from_fn(|i| if self.0[i] > o.0[i] { self.0[i] } else { o.0[i] }))
    }

    /// [`Span::union`] in memory. As a choice the compiler would store it by a mask, which the next that reads it waits for.
    #[inline(always)]
    pub(super) fn add(&mut self, o: Self) {
        *self = Self(from_fn(|i| self.0[i].max(o.0[i])));
    }

    /// Twice the centre.
    #[inline(always)]
    pub(super) fn centre2(self) -> [f32; 4] {
        from_fn(|k| self.0[k + 4] - self.0[k])
    }

    /// The box of twice the centre alone.
    #[inline(always)]
    fn centre(self) -> Self {
        let c = self.centre2();
        Self(from_fn(|i| if i < 4 { -c[i] } else { c[i - 4] }))
    }

    #[inline(always)]
    pub(super) fn lower(self, axis: usize) -> f32 {
        -self.0[axis]
    }

    #[inline(always)]
    pub(super) fn upper(self, axis: usize) -> f32 {
        self.0[axis + 4]
    }

    /// Half the surface area; zero for the empty box.
    #[inline(always)]
    pub(crate) fn half_area(self) -> f32 {
        let sides = self.sides();
        if sides[0] < 0.0 { 0.0 } else { half_area(sides) }
    }

    /// Its sides.
    #[inline(always)]
    pub(crate) fn sides(self) -> [f32; 3] {
        from_fn(|k| self.0[k + 4] + self.0[k])
    }

    /// Its lower corner negated, and its upper one.
    #[inline(always)]
    pub(crate) fn corners(self) -> [f32; 6] {
        from_fn(|i| self.0[if i < 3 { i } else { i + 1 }])
    }

    /// Whether it holds a primitive that shares its leaf with no other.
    #[inline(always)]
    pub(super) fn is_instance_leaf(self) -> bool {
        self.0[7] > 0.0
    }

    pub(crate) fn to_box(self) -> Box32 {
        Box32 { min: from_fn(|k| self.lower(k)), max: from_fn(|k| self.upper(k)) }
    }
}

/// A primitive: its box, and its index in the bits of the lane for it. Items are moved as the tree is built, so that what is
/// read together lies together.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Item(Span);

impl Item {
    /// `instance_leaf`: it shares its leaf with no other.
    pub(crate) fn new(b: &Box32, id: u32, instance_leaf: bool) -> Self {
        let [x, y, z] = b.min;
        Self(Span([-x, -y, -z, f32::from_bits(id), b.max[0], b.max[1], b.max[2], f32::from(u8::from(instance_leaf))]))
    }

    #[inline(always)]
    pub(super) fn span(&self) -> Span {
        self.0
    }

    pub(super) fn id(&self) -> u32 {
        self.0.0[3].to_bits()
    }

    #[inline(always)]
    pub(super) fn centre2(&self, axis: usize) -> f32 {
        self.0.centre2()[axis]
    }

    /// What two primitives are ordered by along an axis: their centres, then their indices. Total.
    pub(super) fn key(&self, axis: usize) -> (u32, u32) {
        let bits = self.centre2(axis).to_bits();
        (if bits >> 31 == 1 { !bits } else { bits | 1 << 31 }, self.id())
    }
}

/// Some primitives' box, and that of their centres.
#[derive(Clone, Copy)]
pub(super) struct Extent {
    pub(super) bounds: Span,
    pub(super) centres: Span,
}

impl Extent {
    pub(super) const EMPTY: Self = Self { bounds: Span::EMPTY, centres: Span::EMPTY };

    #[inline(always)]
    pub(super) fn add(&mut self, item: &Item) {
        self.bounds = self.bounds.union(item.0);
        self.centres = self.centres.union(item.0.centre());
    }

    pub(super) fn of(items: &[Item]) -> Self {
        items.iter().fold(Self::EMPTY, |mut extent, item| {
            extent.add(item);
            extent
        })
    }
}
