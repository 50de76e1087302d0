//! From a scene to what the kernels trace. After this nothing fails.

use crate::bsdf::Bsdf;
use crate::coordinates::{Coordinates, MeshCoordinates};
use crate::filter::FilterSampler;
use crate::kernel::{Kernel, kernel};
use crate::light::{
    DirectionalLight, DiskLight, Emitter, Light, LightTable, ParallelogramLight, PointLight, SphereLight, TriangleLight,
};
use crate::path::ShadowRays;
use crate::plan::{EffectName, OneLaneFilm, Plan, Study, StudyError, simulated};
use crate::spectral::PathSpectrum;
use crate::surface::{Emission, NO_LIGHT, ObjectSurface, Surfaces};
use crate::wavelength::WavelengthDistribution;
use etalon_geometry::{
    Disk, Geometry, GeometryError, Parallelogram, Primitive, PrimitiveId, ShapeError, Sphere, Triangle,
};
use etalon_optics::{Spectrum, Vec3};
use etalon_scene::{EmissionSides, LightKind, LightSampling, Object, Scene, Shape, Transform};
use std::sync::Arc;

/// A scene that is ready to be rendered.
pub struct Prepared {
    pub(crate) scene: Scene,
    pub(crate) geometry: Geometry,
    pub(crate) surfaces: Surfaces,
    pub(crate) lights: LightTable,
    pub(crate) environments: Vec<PathSpectrum>,
    pub(crate) wavelengths: WavelengthDistribution,
    pub(crate) one_lane: OneLaneFilm,
    pub(crate) filter: FilterSampler,
    plan: Plan,
    warnings: Vec<String>,
}

/// Why a scene cannot be prepared.
#[derive(Debug, thiserror::Error)]
pub enum PrepareError {
    /// A shape that cannot be intersected.
    #[error("object \"{object}\": {source}")]
    Shape {
        /// Name of the object.
        object: String,
        /// What is wrong with it.
        source: ShapeError,
    },
    /// The scene as a whole cannot be built.
    #[error("the scene's geometry: {0}")]
    Geometry(#[from] GeometryError),
    /// What the study asks for makes no sense.
    #[error(transparent)]
    Study(#[from] StudyError),
}

/// Prepares a scene: shapes in world space, the accelerator, the table of lights and the plan.
pub fn prepare(scene: &Scene) -> Result<Prepared, PrepareError> {
    prepare_study(scene, &Study::default())
}

/// As [`prepare`], with effects that the scene does not call for, or without some that it does.
pub fn prepare_study(scene: &Scene, study: &Study) -> Result<Prepared, PrepareError> {
    let plan = Plan::new(scene, study)?;
    let simulated = simulated(scene, study);
    let scene = &simulated;
    let range_nm = scene.integrator.wavelength_range_nm;
    let spectrum = |s: &Spectrum| PathSpectrum::new(s, range_nm);
    let mut builder = Builder::new(range_nm);
    for (index, object) in scene.objects.iter().enumerate() {
        builder
            .add_object(index as u32, object)
            .map_err(|source| PrepareError::Shape { object: object.name.clone(), source })?;
    }
    let Builder { primitives, object_of, mut emitters, warnings, coordinates, .. } = builder;
    let geometry = Geometry::build(primitives)?;
    let radius = geometry.bounds().map_or(0.0, |b| 0.5 * b.extent().length());

    if scene.integrator.light_sampling == LightSampling::Bsdf {
        emitters.clear();
    }
    let mut environments = Vec::new();
    for light in &scene.lights {
        match &light.kind {
            LightKind::Point { position_m, intensity } => {
                let position = Vec3::from_array(*position_m);
                emitters.push(Light::Point(PointLight { position, intensity: spectrum(intensity) }));
            }
            LightKind::Directional { direction, irradiance } => {
                let toward = -Vec3::from_array(*direction);
                emitters.push(Light::Directional(DirectionalLight { toward, irradiance: spectrum(irradiance) }));
            }
            LightKind::Environment { radiance } if radiance.is_zero() => {}
            LightKind::Environment { radiance } => environments.push(spectrum(radiance)),
        }
    }
    if plan.forces(EffectName::Environment) {
        environments.push(PathSpectrum::Constant(0.0));
    }
    let lights = LightTable::new(emitters, radius, range_nm);
    let mut light_of = vec![NO_LIGHT; object_of.len()];
    for (index, light) in lights.lights().iter().enumerate() {
        if let Some(emitter) = light.emitter() {
            light_of[emitter.primitive.0 as usize] = index as u32;
        }
    }
    let surfaces = Surfaces {
        bsdfs: scene.materials.iter().map(|material| Bsdf::new(&material.kind, range_nm)).collect(),
        objects: scene
            .objects
            .iter()
            .zip(coordinates)
            .map(|(o, coordinates)| ObjectSurface {
                material: o.material,
                emission: o.emission.as_ref().map(|e| Emission { radiance: spectrum(&e.radiance), sides: e.sides }),
                coordinates,
            })
            .collect(),
        object_of,
        light_of,
    };
    Ok(Prepared {
        geometry,
        surfaces,
        lights,
        environments,
        wavelengths: WavelengthDistribution::new(range_nm),
        one_lane: OneLaneFilm::new(scene),
        filter: FilterSampler::new(&scene.film.filter),
        plan,
        warnings,
        scene: simulated,
    })
}

impl Prepared {
    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// What will be simulated, and why.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The kernel that the plan chose.
    pub(crate) fn kernel(&self) -> &'static Kernel {
        kernel(self.scene.integrator.precision, self.plan.lane_model)
    }

    /// From which surfaces shadow rays are sent.
    pub(crate) fn shadow_rays(&self) -> ShadowRays {
        match () {
            () if self.plan.forces(EffectName::ShadowRays) => ShadowRays::Everywhere,
            // A lamp may shine in no wavelength that is rendered.
            () if self.plan.runs(EffectName::ShadowRays) && !self.lights.is_empty() => ShadowRays::WhereUseful,
            () => ShadowRays::Never,
        }
    }

    /// What was noticed and is not an error, such as triangles without area that were left out.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// The geometry.
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }
}

/// Collects primitives in world space, and a light for each that emits.
struct Builder {
    range_nm: [f64; 2],
    primitives: Vec<Primitive>,
    object_of: Vec<u32>,
    emitters: Vec<Light>,
    /// Of each object.
    coordinates: Vec<Coordinates>,
    warnings: Vec<String>,
}

impl Builder {
    fn new(range_nm: [f64; 2]) -> Self {
        Self {
            range_nm,
            primitives: Vec::new(),
            object_of: Vec::new(),
            emitters: Vec::new(),
            coordinates: Vec::new(),
            warnings: Vec::new(),
        }
    }

    fn add_object(&mut self, index: u32, object: &Object) -> Result<(), ShapeError> {
        let to_world = Affine::new(&object.transform);
        let mut coordinates = Coordinates::None;
        match &object.shape {
            Shape::Sphere { center, radius_m } => {
                let shape = Sphere::new(to_world.point(*center), radius_m * to_world.uniform_scale())?;
                self.add(index, shape, object, |shape, emitter| Light::Sphere(SphereLight::new(shape, emitter)));
            }
            Shape::Parallelogram { origin, u, v } => {
                let (u, v) = to_world.oriented(to_world.vector(*u), to_world.vector(*v));
                let shape = Parallelogram::new(to_world.point(*origin), u, v)?;
                coordinates = Coordinates::Parallelogram { swapped: to_world.mirrors };
                self.add(index, shape, object, |shape, emitter| {
                    Light::Parallelogram(ParallelogramLight::new(shape, emitter))
                });
            }
            Shape::Disk { center, normal, radius_m } => {
                let normal = to_world.vector(*normal).normalized();
                let shape = Disk::new(to_world.point(*center), normal, radius_m * to_world.uniform_scale())?;
                self.add(index, shape, object, |shape, emitter| Light::Disk(DiskLight::new(shape, emitter)));
            }
            Shape::Mesh(mesh) => {
                let vertices: Vec<_> = mesh.vertices.iter().map(|v| to_world.point(*v)).collect();
                let first = self.primitives.len() as u32;
                let mut dropped = Vec::new();
                for (number, triangle) in mesh.triangles.iter().enumerate() {
                    let [a, b, c] = triangle.map(|i| vertices[i as usize]);
                    let (b, c) = to_world.oriented(b, c);
                    match Triangle::new(a, b, c) {
                        Ok(shape) => self.add(index, shape, object, |shape, emitter| {
                            Light::Triangle(TriangleLight::new(shape, emitter))
                        }),
                        Err(ShapeError::NoArea) => dropped.push(number as u32),
                        Err(other) => return Err(other),
                    }
                }
                if !(mesh.normals.is_empty() && mesh.uvs.is_empty()) {
                    coordinates = Coordinates::Mesh(MeshCoordinates {
                        mesh: Arc::clone(mesh),
                        first,
                        kept: (!dropped.is_empty()).then(|| {
                            (0..mesh.triangles.len() as u32).filter(|i| dropped.binary_search(i).is_err()).collect()
                        }),
                        normal_to_world: to_world.normal_matrix(),
                        swapped: to_world.mirrors,
                    });
                }
                if !dropped.is_empty() {
                    self.warnings.push(format!(
                        "object \"{}\": {} of {} triangles have no area and were left out",
                        object.name,
                        dropped.len(),
                        mesh.triangles.len()
                    ));
                }
            }
        }
        self.coordinates.push(coordinates);
        Ok(())
    }

    fn add<S: Clone + Into<Primitive>>(
        &mut self,
        index: u32,
        shape: S,
        object: &Object,
        light: impl FnOnce(S, Emitter) -> Light,
    ) {
        if let Some(emission) = &object.emission {
            let primitive = PrimitiveId(self.primitives.len() as u32);
            let emitter = Emitter {
                radiance: PathSpectrum::new(&emission.radiance, self.range_nm),
                front: emission.sides != EmissionSides::Back,
                back: emission.sides != EmissionSides::Front,
                primitive,
            };
            self.emitters.push(light(shape.clone(), emitter));
        }
        self.primitives.push(shape.into());
        self.object_of.push(index);
    }
}

/// A transform applied to points, vectors and orientations.
struct Affine {
    matrix: glam::DAffine3,
    mirrors: bool,
}

impl Affine {
    fn new(transform: &Transform) -> Self {
        let row_major = glam::DMat3::from_cols_array_2d(&transform.linear);
        let matrix = glam::DAffine3::from_mat3_translation(row_major.transpose(), transform.translation_m.into());
        Self { matrix, mirrors: matrix.matrix3.determinant() < 0.0 }
    }

    fn point(&self, p: [f64; 3]) -> Vec3<f64> {
        Vec3::from_array(self.matrix.transform_point3(p.into()).into())
    }

    fn vector(&self, v: [f64; 3]) -> Vec3<f64> {
        Vec3::from_array(self.matrix.transform_vector3(v.into()).into())
    }

    /// Rows of the inverse transpose of the linear part, times its determinant: positive multiples of world normals, or
    /// negative ones if the transform mirrors.
    fn normal_matrix(&self) -> [Vec3<f64>; 3] {
        let m = &self.matrix.matrix3;
        let columns = [m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis)];
        let sign = if self.mirrors { -1.0 } else { 1.0 };
        // Scaled so that neither it nor what it maps leaves the numbers of double precision.
        let largest = columns.iter().map(|c| c.abs().max_element()).fold(0.0, f64::max);
        let row = |k: usize| Vec3::from_array(columns.map(|c| sign * c[k] / largest));
        [row(0), row(1), row(2)]
    }

    /// The factor by which a similarity scales lengths.
    fn uniform_scale(&self) -> f64 {
        self.matrix.matrix3.x_axis.length()
    }

    /// A pair in the order that keeps the surface's outward side outward: a mirroring transform swaps it.
    fn oriented<T>(&self, first: T, second: T) -> (T, T) {
        if self.mirrors { (second, first) } else { (first, second) }
    }
}
