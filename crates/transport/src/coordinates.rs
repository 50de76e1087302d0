//! What a surface carries besides its shape: normals to shade by and texture coordinates.

use crate::bsdf::Shading;
use etalon_geometry::PrimitiveId;
use etalon_optics::Vec3;
use etalon_scene::Mesh;
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
    },
    /// A mesh whose vertices carry them.
    Mesh(MeshCoordinates),
}

/// What the vertices of a mesh carry.
#[derive(Clone, Debug)]
pub(crate) struct MeshCoordinates {
    pub mesh: Arc<Mesh>,
    /// The first of its primitives.
    pub first: u32,
    /// For each primitive its triangle, if they are not all there.
    pub kept: Option<Vec<u32>>,
    /// Rows of the inverse transpose of the object's transform, to any scale.
    pub normal_to_world: [Vec3<f64>; 3],
    /// Whether the transform mirrors: then the second and third corner of each primitive are swapped.
    pub swapped: bool,
}

impl Coordinates {
    /// The point of `primitive` whose own normal is `normal` and whose surface parameters are `uv`; `outward` takes a normal
    /// from the coordinates of the primitive to those of `normal`.
    #[inline]
    pub(crate) fn at(
        &self,
        normal: Vec3<f64>,
        primitive: PrimitiveId,
        uv: [f64; 2],
        outward: impl FnOnce(Vec3<f64>) -> Vec3<f64>,
    ) -> Shading<'static> {
        match self {
            Self::None => Shading::flat(normal),
            Self::Parallelogram { swapped } => {
                let [a, b] = uv;
                Shading::flat(normal).with_uv(if *swapped { [b, a] } else { [a, b] })
            }
            Self::Mesh(mesh) => mesh.at(normal, primitive, uv, outward),
        }
    }
}

impl MeshCoordinates {
    fn at(
        &self,
        normal: Vec3<f64>,
        primitive: PrimitiveId,
        uv: [f64; 2],
        outward: impl FnOnce(Vec3<f64>) -> Vec3<f64>,
    ) -> Shading<'static> {
        let index = primitive.0 - self.first;
        let triangle = self.kept.as_ref().map_or(index, |kept| kept[index as usize]);
        let corners = self.mesh.triangles[triangle as usize].map(|i| i as usize);
        let [second, third] = uv;
        let [second, third] = if self.swapped { [third, second] } else { [second, third] };
        let weights = [1.0 - second - third, second, third];
        let mut shading = Shading::flat(normal);
        if !self.mesh.uvs.is_empty() {
            let [a, b, c] = corners.map(|i| self.mesh.uvs[i]);
            let mean =
                |k: usize| weights[0] * f64::from(a[k]) + weights[1] * f64::from(b[k]) + weights[2] * f64::from(c[k]);
            shading = shading.with_uv([mean(0), mean(1)]);
        }
        if !self.mesh.normals.is_empty() {
            let [a, b, c] = corners.map(|i| Vec3::from_array(self.mesh.normals[i].map(f64::from)));
            let local = a * weights[0] + b * weights[1] + c * weights[2];
            let world = outward(Vec3::from_array(self.normal_to_world.map(|row| row.dot(local))));
            // Opposite normals may cancel: then the triangle's own stands for them.
            if world.length_squared() > 0.0 {
                shading = shading.bent_to(world.normalized());
            }
        }
        shading
    }
}
