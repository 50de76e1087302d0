//! Images that vary something over a surface.

mod image_file;

use std::sync::Arc;

pub use image_file::{Channel, Encoding, Image, MAX_IMAGE_BYTES, MAX_IMAGE_SIDE, Texels};

/// What an image shows beyond its edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// The image repeats.
    Repeat,
    /// The image repeats, mirrored every other time.
    Mirror,
    /// The outermost texels continue.
    Clamp,
}

/// What an image shows between the centres of its texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TextureFilter {
    /// Linear interpolation between the four nearest.
    Bilinear,
    /// The nearest.
    Nearest,
}

/// An affine map from the texture coordinates of a surface to those of an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UvMap {
    /// Rows of the matrix that the texture coordinates are multiplied by.
    pub matrix: [[f64; 2]; 2],
    /// Added after that.
    pub offset: [f64; 2],
}

impl UvMap {
    /// Leaves them as they are.
    pub const IDENTITY: Self = Self::scaled([1.0; 2], [0.0; 2]);

    /// Factors on them and what is added after that: a factor of 2 shows the image twice.
    pub const fn scaled([u, v]: [f64; 2], offset: [f64; 2]) -> Self {
        Self { matrix: [[u, 0.0], [0.0, v]], offset }
    }

    /// The coordinates of the image at texture coordinates.
    ///
    /// Where it neither turns nor shears, the zeros of the matrix change no bit.
    #[inline]
    pub fn at(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| self.matrix[k][0] * u + self.matrix[k][1] * v + self.offset[k])
    }

    /// How many texels of an image of this size lie along a change of the texture coordinates.
    pub fn texels_along(&self, [u, v]: [f64; 2], size: [u32; 2]) -> f64 {
        let along = |k: usize| {
            let [of_u, of_v] = self.matrix[k].map(|factor| factor * f64::from(size[k]));
            u * of_u + v * of_v
        };
        along(0).hypot(along(1))
    }
}

/// An image laid over texture coordinates: (0, 0) is the lower left corner of the image, (1, 1) the upper right.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageTexture {
    /// The image.
    pub image: Arc<Image>,
    /// Its file, as the scene names it.
    pub name: String,
    /// Beyond its left and right, and its lower and upper edge.
    pub wrap: [Wrap; 2],
    /// Between texels.
    pub filter: TextureFilter,
    /// How it lies over them.
    pub uv_map: UvMap,
    /// Factor on each channel.
    pub factor: [f64; 3],
}

impl ImageTexture {
    /// An image as it is, once a unit of the texture coordinates, repeated, bilinear between texels.
    pub fn new(image: Image) -> Self {
        Self::of(Arc::new(image))
    }

    /// The same of an image that others may share.
    pub fn of(image: Arc<Image>) -> Self {
        Self {
            image,
            name: String::new(),
            wrap: [Wrap::Repeat; 2],
            filter: TextureFilter::Bilinear,
            uv_map: UvMap::IDENTITY,
            factor: [1.0; 3],
        }
    }

    /// Whether it is black.
    pub fn is_zero(&self) -> bool {
        self.most() == [0.0; 3]
    }

    /// Whether its three channels are the same everywhere.
    pub fn is_grey(&self) -> bool {
        let [r, g, b] = self.factor;
        r == g && g == b && self.image.is_grey()
    }

    /// The largest number of each channel, without its sign, times the factor.
    pub fn most(&self) -> [f64; 3] {
        let most = self.image.most();
        [0, 1, 2].map(|c| most[c] * self.factor[c])
    }

    /// The mean of its texels, times the factor.
    pub fn mean(&self) -> [f64; 3] {
        let mean = self.image.mean();
        [0, 1, 2].map(|c| mean[c] * self.factor[c])
    }

    /// The colour at texture coordinates: what a filter of the image shows there, times the factor.
    ///
    /// Only correctly rounded operations: the same bits on every machine.
    #[inline]
    pub fn eval(&self, uv: [f64; 2]) -> [f64; 3] {
        let size = [self.image.width as usize, self.image.height as usize];
        let [u, v] = self.uv_map.at(uv);
        // Rows count from the top, v from below.
        let [(x0, x1, x), (y0, y1, y)] =
            [place(u, size[0], self.wrap[0], self.filter), place(1.0 - v, size[1], self.wrap[1], self.filter)];
        let texel = |column, row| self.image.texel(column, row);
        let colour = match self.filter {
            TextureFilter::Nearest => texel(x0, y0),
            TextureFilter::Bilinear => {
                let [a, b, c, d] = [texel(x0, y0), texel(x1, y0), texel(x0, y1), texel(x1, y1)];
                let mix = |k: usize| {
                    let (upper, lower) = (a[k] + x * (b[k] - a[k]), c[k] + x * (d[k] - c[k]));
                    upper + y * (lower - upper)
                };
                [mix(0), mix(1), mix(2)]
            }
        };
        [0, 1, 2].map(|k| colour[k] * self.factor[k])
    }
}

/// The two texels around a coordinate along one axis of `size` texels, and the share of the second.
#[inline]
pub(crate) fn place(at: f64, size: usize, wrap: Wrap, filter: TextureFilter) -> (usize, usize, f64) {
    let within = match wrap {
        Wrap::Repeat => at - at.floor(),
        Wrap::Mirror => {
            let t = 2.0 * (0.5 * at - (0.5 * at).floor());
            if t > 1.0 { 2.0 - t } else { t }
        }
        Wrap::Clamp => at.clamp(0.0, 1.0),
    };
    if filter == TextureFilter::Nearest {
        let i = ((within * size as f64) as usize).min(size - 1);
        return (i, i, 0.0);
    }
    let x = within * size as f64 - 0.5;
    let floor = x.floor();
    let share = x - floor;
    // From −1 to size − 1.
    let first = floor as isize;
    let last = size as isize - 1;
    let wrapped = |i: isize| match wrap {
        Wrap::Repeat if i < 0 => last as usize,
        Wrap::Repeat if i > last => 0,
        // Beyond the edge the mirror image, like the outermost texel, begins with the outermost texel.
        _ => i.clamp(0, last) as usize,
    };
    (wrapped(first), wrapped(first + 1), share)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two columns and two rows: red = column, green = 1 in the upper row.
    fn square(wrap: Wrap, filter: TextureFilter) -> ImageTexture {
        let texels = vec![[0.0, 1.0, 0.25], [1.0, 1.0, 0.25], [0.0, 0.0, 0.25], [1.0, 0.0, 0.25]];
        let image = Arc::new(Image::new(2, 2, Texels::F32(texels)));
        ImageTexture { image, name: String::new(), wrap: [wrap; 2], filter, uv_map: UvMap::IDENTITY, factor: [1.0; 3] }
    }

    #[test]
    fn bilinear_weights_are_exact() {
        let t = square(Wrap::Clamp, TextureFilter::Bilinear);
        // Centres of texels, the middle, and a place of weights 1/4 and 3/4 (exact in binary).
        assert_eq!(t.eval([0.25, 0.75]), [0.0, 1.0, 0.25]);
        assert_eq!(t.eval([0.75, 0.25]), [1.0, 0.0, 0.25]);
        assert_eq!(t.eval([0.5, 0.5]), [0.5, 0.5, 0.25]);
        assert_eq!(t.eval([0.375, 0.625]), [0.25, 0.75, 0.25]);
        let nearest = square(Wrap::Clamp, TextureFilter::Nearest);
        assert_eq!(nearest.eval([0.375, 0.625]), [0.0, 1.0, 0.25]);
        assert_eq!(nearest.eval([0.625, 0.125]), [1.0, 0.0, 0.25]);
    }

    #[test]
    fn edges_wrap_as_they_are_told_to() {
        for (wrap, at, red) in [
            (Wrap::Repeat, 0.0, 0.5),
            (Wrap::Repeat, 0.125, 0.25),
            (Wrap::Repeat, 1.25, 0.0),
            (Wrap::Repeat, -0.25, 1.0),
            (Wrap::Repeat, -1e9 + 0.75, 1.0),
            (Wrap::Mirror, 0.0, 0.0),
            (Wrap::Mirror, -0.25, 0.0),
            (Wrap::Mirror, -0.75, 1.0),
            (Wrap::Mirror, 1.25, 1.0),
            (Wrap::Mirror, 2.25, 0.0),
            (Wrap::Mirror, 1.0, 1.0),
            (Wrap::Clamp, -7.0, 0.0),
            (Wrap::Clamp, 0.1, 0.0),
            (Wrap::Clamp, 7.0, 1.0),
        ] {
            let t = square(wrap, TextureFilter::Bilinear);
            assert_eq!(t.eval([at, 0.5])[0], red, "{wrap:?} at {at}");
            // The same along v, which counts from below: green is 1 − red turned about.
            let green = t.eval([0.5, 1.0 - at])[1];
            assert_eq!(green, 1.0 - red, "{wrap:?} at {at}");
            let nearest = square(wrap, TextureFilter::Nearest).eval([at, 0.5])[0];
            assert!(red == 0.5 || red == 0.25 || nearest == red, "{wrap:?} at {at}");
        }
    }

    #[test]
    fn coordinates_are_scaled_then_moved_and_colours_multiplied() {
        let mut t = square(Wrap::Clamp, TextureFilter::Bilinear);
        t.uv_map = UvMap::scaled([2.0, 1.0], [-0.5, 0.0]);
        t.factor = [3.0, 1.0, 2.0];
        assert_eq!(t.eval([0.5, 0.5]), [1.5, 0.5, 0.5]);
        assert_eq!(t.eval([0.625, 0.5]), [3.0, 0.5, 0.5]);
    }

    #[test]
    fn coordinates_are_turned_and_sheared_then_moved() {
        let mut t = square(Wrap::Clamp, TextureFilter::Nearest);
        // A quarter of a turn about the middle: (u, v) shows what is at (1 − v, u).
        t.uv_map = UvMap { matrix: [[0.0, -1.0], [1.0, 0.0]], offset: [1.0, 0.0] };
        for ([u, v], [column, upper]) in [
            ([0.25, 0.25], [1.0, 0.0]),
            ([0.75, 0.25], [1.0, 1.0]),
            ([0.75, 0.75], [0.0, 1.0]),
            ([0.25, 0.75], [0.0, 0.0]),
        ] {
            assert_eq!(t.eval([u, v]), [column, upper, 0.25], "{u} {v}");
        }
        // u is moved along by v.
        t.uv_map = UvMap { matrix: [[1.0, 0.5], [0.0, 1.0]], offset: [-0.25, 0.0] };
        assert_eq!((t.eval([0.625, 0.125])[0], t.eval([0.625, 0.375])[0]), (0.0, 1.0));
        assert_eq!(UvMap { matrix: [[3.0, 1.0], [0.0, 2.0]], offset: [9.0; 2] }.texels_along([0.5, 0.5], [2, 3]), 5.0);
    }
}
