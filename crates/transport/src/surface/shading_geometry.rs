//! What a surface carries besides its shape: normals to shade by and texture coordinates.

use crate::bsdf::Shading;
use crate::frame::{SceneFrame, mapped};
use crate::surface::quadric_uv::RoundCoordinates;
use crate::texture::TexturePoint;
use etalon_geometry::{Geometry, PrimitiveId, SurfaceId};
use etalon_optics::Vec3;
use etalon_optics::colour::rec709_luminance;
use etalon_scene::{ImageTexture, Mesh};
use glam::DMat3;
use std::sync::Arc;

/// How the points of an object come by their texture coordinates and shading normals.
#[derive(Clone, Debug)]
pub(crate) enum Coordinates {
    /// Nothing but the shape.
    None,
    /// A parallelogram's own parameters.
    Parallelogram {
        /// Whether a mirroring transform has swapped its edges.
        swapped: bool,
        /// Its edges as the object states them, before any swap.
        edges: [Vec3<f64>; 2],
    },
    /// A sphere, disk or cylinder.
    Round(RoundCoordinates),
    /// A mesh whose vertices carry them.
    Mesh(MeshCoordinates),
}

/// A hit, as far as coordinates need it.
pub(crate) struct At<'a> {
    pub geometry: &'a Geometry,
    pub surface: SurfaceId,
    /// The primitive's own parameters.
    pub uv: [f64; 2],
    /// Where it is, and its own outward normal.
    pub position: Vec3<f64>,
    pub normal: Vec3<f64>,
    /// When.
    pub time: f64,
}

/// What the vertices of a mesh carry.
#[derive(Clone, Debug)]
pub(crate) struct MeshCoordinates {
    pub mesh: Arc<Mesh>,
    /// The first of its primitives.
    pub first: u32,
    /// For each primitive its triangle, if they are not all there.
    pub kept: Option<Vec<u32>>,
    /// The inverse transpose of the object's transform, to any scale.
    pub normal_to_world: DMat3,
    /// The linear part of the object's transform.
    pub linear: DMat3,
    /// Whether the transform mirrors: then the second and third corner of each primitive are swapped.
    pub swapped: bool,
}

impl Coordinates {
    /// The same in a frame with this many units in a metre, centred on a point of the world.
    pub(crate) fn framed(self, frame: &SceneFrame) -> Self {
        match self {
            Self::None => Self::None,
            Self::Parallelogram { swapped, edges } => {
                Self::Parallelogram { swapped, edges: edges.map(|edge| edge * frame.per_m()) }
            }
            Self::Round(round) => Self::Round(round.framed(frame)),
            Self::Mesh(mesh) => Self::Mesh(MeshCoordinates { linear: mesh.linear * frame.per_m(), ..mesh }),
        }
    }

    /// Texture coordinates; 0 on a surface without.
    #[inline]
    pub(crate) fn uv(&self, at: &At<'_>) -> [f64; 2] {
        match self {
            Self::None => [0.0; 2],
            Self::Parallelogram { swapped, .. } => {
                let [a, b] = at.uv;
                if *swapped { [b, a] } else { [a, b] }
            }
            Self::Round(round) => round.uv(at.geometry.local_point(at.surface, at.position, at.time)),
            Self::Mesh(mesh) => mesh.uv(at.surface.primitive, at.uv),
        }
    }

    /// The point as textures see it.
    #[inline]
    pub(crate) fn texture_point(&self, at: &At<'_>) -> TexturePoint {
        let colour = match self {
            Self::Mesh(mesh) => mesh.colour(at.surface.primitive, at.uv),
            Self::None | Self::Parallelogram { .. } | Self::Round(_) => None,
        };
        let point = TexturePoint::of_uv(self.uv(at));
        TexturePoint { colour: colour.unwrap_or(point.colour), ..point }
    }

    /// The point as scattering sees it.
    #[inline]
    pub(crate) fn at(&self, at: &At<'_>) -> Shading<'static> {
        let flat = Shading::flat(at.normal);
        match self {
            Self::None => flat,
            Self::Parallelogram { .. } => flat.with_uv(self.uv(at)),
            Self::Round(_) => flat.with_uv(self.uv(at)),
            Self::Mesh(mesh) => {
                let normal = mesh.normal(at.surface.primitive, at.uv);
                let flat = if mesh.mesh.uvs.is_empty() { flat } else { flat.with_uv(self.uv(at)) };
                let flat = match mesh.colour(at.surface.primitive, at.uv) {
                    Some(colour) => flat.with_colour(colour),
                    None => flat,
                };
                match normal.map(|normal| at.geometry.placed_normal(at.surface, normal, at.time)) {
                    // Opposite normals may cancel: then the triangle's own stands for them.
                    Some(normal) if normal.length_squared() > 0.0 => flat.bent_to(normal.normalized()),
                    _ => flat,
                }
            }
        }
    }

    /// About the mean luminance of an image over a primitive: by a grid of points as fine as its texels, up to some thousand. On
    /// what is round, over texture coordinates instead of over the surface.
    pub(crate) fn mean_luminance(&self, primitive: PrimitiveId, texture: &ImageTexture) -> f64 {
        const FINEST: f64 = 64.0;
        let size = [texture.image.width, texture.image.height];
        // Corner and edges in texture coordinates, and whether the half beyond the diagonal counts.
        let (corner, [along_u, along_v], square) = match self {
            Self::Mesh(mesh) if !mesh.mesh.uvs.is_empty() => {
                let [a, b, c] = mesh.corners(primitive).map(|i| mesh.mesh.uvs[i].map(f64::from));
                (a, [[b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]], false)
            }
            _ => ([0.0; 2], [[1.0, 0.0], [0.0, 1.0]], true),
        };
        let longest =
            [along_u, along_v].map(|along| texture.uv_map.texels_along(along, size)).into_iter().fold(1.0, f64::max);
        let steps = longest.min(FINEST).ceil() as u32;
        let (mut sum, mut count) = (0.0, 0.0);
        for i in 0..steps {
            for j in 0..steps {
                let mut shares = [i, j].map(|k| (f64::from(k) + 0.5) / f64::from(steps));
                if !square && shares[0] + shares[1] > 1.0 {
                    shares = shares.map(|share| 1.0 - share);
                }
                let uv = [0, 1].map(|k| corner[k] + shares[0] * along_u[k] + shares[1] * along_v[k]);
                sum += rec709_luminance(texture.eval(uv));
                count += 1.0;
            }
        }
        sum / count
    }

    /// How the point moves with u and with v, in units of the frame; `None` where it does not with both.
    pub(crate) fn tangents(&self, at: &At<'_>) -> Option<[Vec3<f64>; 2]> {
        let local = match self {
            Self::None => None,
            Self::Parallelogram { edges, .. } => Some(*edges),
            Self::Round(round) => round.tangents(at.geometry.local_point(at.surface, at.position, at.time)),
            Self::Mesh(mesh) => mesh.tangents(at.surface.primitive),
        };
        local.map(|vectors| vectors.map(|v| at.geometry.placed_vector(at.surface, v, at.time)))
    }
}

impl MeshCoordinates {
    /// The corners of a primitive, and the weights of a point of it.
    #[inline]
    fn corners(&self, primitive: PrimitiveId) -> [usize; 3] {
        let index = primitive.0 - self.first;
        let triangle = self.kept.as_ref().map_or(index, |kept| kept[index as usize]);
        self.mesh.triangles[triangle as usize].map(|i| i as usize)
    }

    #[inline]
    fn weights(&self, [second, third]: [f64; 2]) -> [f64; 3] {
        let [second, third] = if self.swapped { [third, second] } else { [second, third] };
        [1.0 - second - third, second, third]
    }

    fn uv(&self, primitive: PrimitiveId, uv: [f64; 2]) -> [f64; 2] {
        if self.mesh.uvs.is_empty() {
            return [0.0; 2];
        }
        let weights = self.weights(uv);
        let [a, b, c] = self.corners(primitive).map(|i| self.mesh.uvs[i]);
        let mean =
            |k: usize| weights[0] * f64::from(a[k]) + weights[1] * f64::from(b[k]) + weights[2] * f64::from(c[k]);
        [mean(0), mean(1)]
    }

    /// The colour between those of the corners, if they have any.
    fn colour(&self, primitive: PrimitiveId, uv: [f64; 2]) -> Option<[f64; 3]> {
        if self.mesh.colours.is_empty() {
            return None;
        }
        let weights = self.weights(uv);
        let [a, b, c] = self.corners(primitive).map(|i| self.mesh.colours[i].map(f64::from));
        Some([0, 1, 2].map(|k| weights[0] * a[k] + weights[1] * b[k] + weights[2] * c[k]))
    }

    /// The interpolated normal of any length, in the coordinates of the geometry.
    fn normal(&self, primitive: PrimitiveId, uv: [f64; 2]) -> Option<Vec3<f64>> {
        if self.mesh.normals.is_empty() {
            return None;
        }
        let weights = self.weights(uv);
        let [a, b, c] = self.corners(primitive).map(|i| Vec3::from_array(self.mesh.normals[i].map(f64::from)));
        let local = a * weights[0] + b * weights[1] + c * weights[2];
        Some(mapped(&self.normal_to_world, local))
    }

    /// The same all over a triangle: (e₁, e₂) = (∂p/∂u, ∂p/∂v)·(Δuv₁, Δuv₂), solved for the derivatives.
    fn tangents(&self, primitive: PrimitiveId) -> Option<[Vec3<f64>; 2]> {
        if self.mesh.uvs.is_empty() {
            return None;
        }
        let corners = self.corners(primitive);
        let [a, b, c] = corners.map(|i| Vec3::from_array(self.mesh.vertices[i]));
        let [s, t, r] = corners.map(|i| self.mesh.uvs[i].map(f64::from));
        let (first, second) = (mapped(&self.linear, b - a), mapped(&self.linear, c - a));
        let ([du1, dv1], [du2, dv2]) = ([t[0] - s[0], t[1] - s[1]], [r[0] - s[0], r[1] - s[1]]);
        let determinant = du1 * dv2 - du2 * dv1;
        let along = [(first * dv2 - second * dv1) / determinant, (second * du1 - first * du2) / determinant];
        // Where all corners have the same coordinates, or those on a line, there is no direction.
        along.iter().all(|v| v.length_squared().is_finite() && v.length_squared() > 0.0).then_some(along)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_scene::{Image, Texels, TextureFilter, UvMap};

    fn image(width: u32, height: u32, uv_scale: [f64; 2], of: impl Fn(u32, u32) -> [f32; 3]) -> ImageTexture {
        let texels = (0..width * height).map(|i| of(i % width, i / width)).collect();
        ImageTexture {
            filter: TextureFilter::Nearest,
            uv_map: UvMap::scaled(uv_scale, [0.0; 2]),
            ..ImageTexture::new(Image::new(width, height, Texels::F32(texels)))
        }
    }

    fn mesh(vertices: Vec<[f64; 3]>, uvs: Vec<[f32; 2]>, linear: DMat3) -> MeshCoordinates {
        let triangles = vec![[0, 1, 2]];
        let mesh = Arc::new(Mesh { vertices, triangles, normals: Vec::new(), uvs, colours: Vec::new() });
        MeshCoordinates { mesh, first: 5, kept: None, normal_to_world: DMat3::IDENTITY, linear, swapped: false }
    }

    const THE_TRIANGLE: PrimitiveId = PrimitiveId(5);

    #[test]
    fn an_image_has_the_mean_luminance_of_the_part_that_is_shown() {
        // Each channel alone is worth what Rec. 709 says, and white 1.
        for (rgb, want) in
            [([1.0, 0.0, 0.0], 0.2126), ([0.0, 1.0, 0.0], 0.7152), ([0.0, 0.0, 1.0], 0.0722), ([1.0, 1.0, 1.0], 1.0)]
        {
            let plain = image(1, 1, [1.0; 2], |_, _| rgb);
            assert!((Coordinates::None.mean_luminance(PrimitiveId(0), &plain) - want).abs() < 1e-12, "{rgb:?}");
        }
        // Whole squares: as many columns or rows as there are texels, whatever the scale; half of them, or a row of four, shine.
        for scale in [1.0, -1.0, 3.0] {
            let columns = image(2, 1, [scale, 1.0], |column, _| [[0.0, 1.0][column as usize]; 3]);
            let rows = image(1, 4, [1.0, scale], |_, row| [if row == 1 { 4.0 } else { 0.0 }; 3]);
            for (texture, want) in [(columns, 0.5), (rows, 1.0)] {
                let got = Coordinates::None.mean_luminance(PrimitiveId(0), &texture);
                assert!((got - want).abs() < 1e-12, "{scale}: {got} is not {want}");
            }
        }
        // Triangles, by their area on either side of u = ½ + a and v = ½ + b in an image of 64²: (corners, share of the lit part).
        let half = |by_row: bool| {
            image(64, 64, [1.0; 2], move |c, r| [if (if by_row { r } else { c }) < 32 { 0.0 } else { 1.0 }; 3])
        };
        for (uvs, by_row, want) in [
            (vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]], false, 0.75),
            (vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], false, 0.25),
            (vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], true, 0.75),
            (vec![[0.5, 0.25], [1.0, 0.5], [0.75, 0.75]], false, 1.0),
            (vec![[0.25, 0.75], [0.45, 1.0], [0.45, 0.5]], false, 0.0),
            (vec![[0.25, 0.5], [0.75, 0.75], [0.75, 0.25]], true, 0.5),
        ] {
            let coordinates = Coordinates::Mesh(mesh(vec![[0.0; 3]; 3], uvs.clone(), DMat3::IDENTITY));
            let got = coordinates.mean_luminance(THE_TRIANGLE, &half(by_row));
            // A grid of 64² at most, of which a line cuts off cells along its length.
            assert!((got - want).abs() < 0.03, "{uvs:?}: {got} is not {want}");
        }
    }

    #[test]
    fn a_triangle_moves_with_u_and_v_as_its_corners_say() {
        let linear = DMat3::from_cols_array(&[1.0, -0.5, 0.0, 0.5, 2.0, 0.1, 0.0, 0.3, 1.5]);
        // p = o + u·a + v·b at each corner, for any a and b and corners anywhere.
        let (origin, a, b) = (Vec3::new(1.0, 2.0, 3.0), Vec3::new(0.5, 1.0, -0.25), Vec3::new(-1.0, 0.75, 2.0));
        let uvs = vec![[0.25, 0.5], [1.0, 0.75], [0.5, 2.0]];
        let vertices = uvs.iter().map(|[u, v]: &[f32; 2]| (origin + a * f64::from(*u) + b * f64::from(*v)).to_array());
        let got = mesh(vertices.collect(), uvs.clone(), linear).tangents(THE_TRIANGLE).unwrap();
        for (got, want) in got.into_iter().zip([a, b]) {
            let want = mapped(&linear, want);
            assert!((got - want).length() < 1e-12, "{got:?} is not {want:?}");
        }
        // Coordinates on a line, or all the same, say nothing of a direction.
        for flat in [vec![[0.0, 0.0], [0.5, 0.5], [1.0, 1.0]], vec![[0.5; 2]; 3]] {
            let vertices = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
            assert!(mesh(vertices, flat, DMat3::IDENTITY).tangents(THE_TRIANGLE).is_none());
        }
    }
}
