//! Where samples are summed: in `f64`, in the order of their numbers, nothing clamped.

use etalon_optics::colour;

/// A rectangle of pixels, `x0 ≤ x < x1` and `y0 ≤ y < y1`, y counted from the top.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelRect {
    /// First column.
    pub x0: u32,
    /// First row.
    pub y0: u32,
    /// Column after the last.
    pub x1: u32,
    /// Row after the last.
    pub y1: u32,
}

impl PixelRect {
    /// Number of pixels.
    pub fn area(&self) -> u64 {
        u64::from(self.x1 - self.x0) * u64::from(self.y1 - self.y0)
    }

    /// The pixels, row by row.
    pub fn pixels(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let r = *self;
        (r.y0..r.y1).flat_map(move |y| (r.x0..r.x1).map(move |x| (x, y)))
    }

    /// Cuts the rectangle into tiles of at most `size` × `size`, row by row.
    pub fn tiles(&self, size: u32) -> Vec<Self> {
        let mut tiles = Vec::new();
        for y0 in (self.y0..self.y1).step_by(size as usize) {
            for x0 in (self.x0..self.x1).step_by(size as usize) {
                tiles.push(Self { x0, y0, x1: (x0 + size).min(self.x1), y1: (y0 + size).min(self.y1) });
            }
        }
        tiles
    }
}

/// What one pixel has gathered.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelSum {
    /// Sum of the samples' CIE XYZ.
    pub xyz: [f64; 3],
    /// Finite samples summed.
    pub count: u32,
}

/// A sample that was not a finite number: excluded from the sums, and reported so that it can be replayed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct NonFinite {
    /// Row from the top.
    pub y: u32,
    /// Column.
    pub x: u32,
    /// Number of the sample.
    pub sample: u32,
}

/// Non-finite samples are counted without limit, and located up to this many.
pub const NONFINITE_LOCATED: usize = 16;

/// What a render counted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Camera paths.
    pub paths: u64,
    /// Rays that looked for the nearest surface.
    pub rays: u64,
    /// Rays that asked whether a light is in sight.
    pub shadow_rays: u64,
    /// Points drawn on a lens.
    pub lens_draws: u64,
    /// Times that a light at infinity was asked for its radiance.
    pub environment_lookups: u64,
    /// Vertices at which weights of the lanes were carried, because dispersion may part them.
    pub lane_weights: u64,
    /// Paths cut at the internal limit on vertices rather than ended by the scene: each may lack light.
    pub cut_paths: u64,
    /// Samples that were not finite.
    pub nonfinite: u64,
    /// The first of them, in the order of rows, columns and samples.
    pub nonfinite_at: Vec<NonFinite>,
}

impl Counters {
    /// Records a sample that is not finite.
    pub fn record_nonfinite(&mut self, at: NonFinite) {
        self.nonfinite += 1;
        self.locate(&[at]);
    }

    /// Adds another count to this one.
    pub fn merge(&mut self, other: &Self) {
        self.paths += other.paths;
        self.rays += other.rays;
        self.shadow_rays += other.shadow_rays;
        self.lens_draws += other.lens_draws;
        self.environment_lookups += other.environment_lookups;
        self.lane_weights += other.lane_weights;
        self.cut_paths += other.cut_paths;
        self.nonfinite += other.nonfinite;
        self.locate(&other.nonfinite_at);
    }

    fn locate(&mut self, at: &[NonFinite]) {
        if !at.is_empty() {
            self.nonfinite_at.extend_from_slice(at);
            self.nonfinite_at.sort_unstable();
            self.nonfinite_at.truncate(NONFINITE_LOCATED);
        }
    }
}

/// An image in the making.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    width: u32,
    height: u32,
    pixels: Vec<PixelSum>,
    /// What was counted on the way.
    pub counters: Counters,
}

impl Film {
    /// A black film.
    pub fn new(width: u32, height: u32) -> Self {
        let pixels = vec![PixelSum::default(); width as usize * height as usize];
        Self { width, height, pixels, counters: Counters::default() }
    }

    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All pixels, row by row from the top.
    pub fn pixels(&self) -> &[PixelSum] {
        &self.pixels
    }

    pub(crate) fn index(&self, x: u32, y: u32) -> usize {
        y as usize * self.width as usize + x as usize
    }

    pub(crate) fn put(&mut self, rect: PixelRect, sums: &[PixelSum]) {
        for ((x, y), sum) in rect.pixels().zip(sums) {
            let index = self.index(x, y);
            self.pixels[index] = *sum;
        }
    }

    /// Mean CIE XYZ of each pixel, Y = 1 for a constant radiance of 1 W·m⁻²·sr⁻¹·nm⁻¹; zero where nothing was sampled.
    pub fn xyz(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        self.pixels.iter().map(|p| p.xyz.map(|v| if p.count == 0 { 0.0 } else { v / f64::from(p.count) }))
    }

    /// Linear Rec. 709 of each pixel, row by row from the top.
    pub fn linear_rec709(&self) -> Vec<[f32; 3]> {
        self.xyz().map(|xyz| colour::rec709_from_xyz(xyz).map(|v| v as f32)).collect()
    }

    /// Mean Y over a rectangle: the mean radiance where the scene is the same at every wavelength.
    pub fn mean_y(&self, rect: PixelRect) -> f64 {
        let (mut sum, mut count) = (0.0, 0_u64);
        for (x, y) in rect.pixels() {
            let p = &self.pixels[self.index(x, y)];
            sum += p.xyz[1];
            count += u64::from(p.count);
        }
        sum / count as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_every_pixel_once() {
        let rect = PixelRect { x0: 3, y0: 1, x1: 40, y1: 38 };
        let mut seen: Vec<_> = rect.tiles(16).iter().flat_map(PixelRect::pixels).collect();
        seen.sort_unstable();
        let mut all: Vec<_> = rect.pixels().collect();
        all.sort_unstable();
        assert_eq!(seen, all);
        assert_eq!(rect.area(), all.len() as u64);
    }

    #[test]
    fn located_samples_do_not_depend_on_the_order_of_merging() {
        let at = |i: u32| NonFinite { y: i % 7, x: i % 5, sample: i };
        let count = |order: &mut dyn Iterator<Item = u32>| {
            let mut total = Counters::default();
            for i in order {
                let mut one = Counters::default();
                one.record_nonfinite(at(i));
                total.merge(&one);
            }
            total
        };
        let forward = count(&mut (0..100));
        assert_eq!(forward, count(&mut (0..100).rev()));
        assert_eq!((forward.nonfinite, forward.nonfinite_at.len()), (100, NONFINITE_LOCATED));
    }
}
