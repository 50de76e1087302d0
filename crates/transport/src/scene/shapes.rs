//! The scene's shapes as the accelerator wants them, and the lights that they are.

use crate::frame::{Affine, SceneFrame};
use crate::light::{AreaLight, Emitter, ImageOf, Light, Link, MovingLight};
use crate::scene::motion::motion;
use crate::scene::prepare_error::PrepareError;
use crate::spectral::PathSpectrum;
use crate::surface::quadric_uv::RoundCoordinates;
use crate::surface::shading_geometry::{Coordinates, MeshCoordinates};
use etalon_geometry::{
    Aabb, Cylinder, Disk, Geometry, Instance, Parallelogram, Placement, Primitive, PrimitiveId, ShapeError, Sphere,
    SurfaceId, Triangle,
};
use etalon_optics::Vec3;
use etalon_scene as scene;
use etalon_scene::{EmissionSides, Object, Scene, Shape};
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::Arc;

/// All shapes of a scene. Objects are numbered through: the scene's own, then those of each group.
pub(crate) struct SceneShapes {
    pub frame: SceneFrame,
    /// In the frame. Its label is 0, those of the groups count from 1.
    pub geometry: Geometry,
    /// By label: the object of each primitive, [`NO_OBJECT`] for an instance.
    pub object_of: Vec<Vec<u32>>,
    /// In the frame.
    pub emitters: Vec<Light>,
    /// By the number of the object.
    pub coordinates: Vec<Coordinates>,
    pub warnings: Vec<String>,
    /// Of each group, for a later frame of a sequence.
    pub groups: Vec<Arc<GroupShapes>>,
}

/// The shapes of a group, in its own coordinates.
#[derive(Debug)]
pub(crate) struct GroupShapes {
    geometry: Arc<Geometry>,
    /// The object of each primitive.
    object_of: Vec<u32>,
    /// Of each of its objects.
    coordinates: Vec<Coordinates>,
    warnings: Vec<String>,
    /// Whether it is placed anywhere; if it is not, its geometry is empty.
    placed: bool,
}

/// An earlier frame of a sequence: its scene, and what was made of its groups.
pub(crate) type EarlierGroups<'a> = (&'a Scene, &'a [Arc<GroupShapes>]);

const NO_OBJECT: u32 = u32::MAX;
/// Shapes that a thread is given at once, at least.
const CHUNK: usize = 1 << 13;

/// The scene's objects, numbered as in [`SceneShapes`].
pub(crate) fn objects(scene: &Scene) -> impl Iterator<Item = &Object> {
    scene.objects.iter().chain(scene.groups.iter().flat_map(|group| &group.objects))
}

/// Builds the geometry of a scene and of each of its groups. Groups that are the same in an earlier frame are taken over from it.
pub(crate) fn build(
    scene: &Scene,
    range_nm: [f64; 2],
    earlier: Option<EarlierGroups<'_>>,
) -> Result<SceneShapes, PrepareError> {
    let mut warnings = Vec::new();
    let shutter_s = scene.camera.shutter_s;
    let mut object_of = vec![Vec::new()];
    let mut shared: Vec<Arc<Geometry>> = Vec::with_capacity(scene.groups.len());
    let placed = placed(scene);
    let mut first_object = scene.objects.len();
    let mut grouped_coordinates = Vec::new();
    let mut groups: Vec<Arc<GroupShapes>> = Vec::with_capacity(scene.groups.len());
    let mut same = vec![false; scene.groups.len()];
    for (index, group) in scene.groups.iter().enumerate() {
        let kept = earlier.and_then(|earlier| same_group(index, (scene, &placed), &same, earlier));
        same[index] = kept.is_some();
        let made = match kept {
            Some(kept) => kept,
            None => {
                let (mut collected, mut warnings) = (Collected::default(), Vec::new());
                if placed[index] {
                    let instances = (group.instances.as_slice(), shutter_s);
                    collected.add_all(first_object, &group.objects, instances, &shared, &mut warnings)?;
                }
                collected.coordinates.resize(group.objects.len(), Coordinates::None);
                let Collected { primitives, object_of, coordinates } = collected;
                let geometry = Arc::new(Geometry::build(primitives)?.with_label(index as u32 + 1));
                Arc::new(GroupShapes { geometry, object_of, coordinates, warnings, placed: placed[index] })
            }
        };
        warnings.extend_from_slice(&made.warnings);
        grouped_coordinates.extend_from_slice(&made.coordinates);
        first_object += group.objects.len();
        object_of.push(made.object_of.clone());
        shared.push(made.geometry.clone());
        groups.push(made);
    }
    let mut collected = Collected::default();
    collected.add_all(0, &scene.objects, (&scene.instances, shutter_s), &shared, &mut warnings)?;
    let Collected { mut primitives, object_of: own, mut coordinates } = collected;
    coordinates.append(&mut grouped_coordinates);
    // In an order that does not depend on the number of threads, as a million shapes are worth it.
    let bounds_of = |shapes: &[Primitive]| shapes.iter().map(Primitive::bounds).reduce(Aabb::union);
    let bounds: Vec<Option<Aabb>> = primitives.par_chunks(CHUNK).map(bounds_of).collect();
    let bounds = bounds.into_iter().flatten().reduce(Aabb::union);
    let frame = bounds.map_or(SceneFrame::WORLD, SceneFrame::around);
    coordinates[..scene.objects.len()].iter_mut().for_each(|one| *one = one.clone().framed(&frame));
    let name = |i: usize| own.get(i).and_then(|&o| scene.objects.get(o as usize)).map_or("", |o| o.name.as_str());
    let into_frame = |(i, shape): (usize, &mut Primitive)| match frame.shape(shape) {
        Ok(framed) => {
            *shape = framed;
            None
        }
        Err(source) => Some((i, source)),
    };
    let wrong = primitives.par_iter_mut().enumerate().with_min_len(CHUNK).filter_map(into_frame);
    if let Some((i, source)) = wrong.min_by_key(|&(i, _)| i) {
        return Err(PrepareError::Shape { object: name(i).to_owned(), source });
    }
    object_of[0] = own;
    let geometry = Geometry::build(primitives)?;

    let objects: Vec<&Object> = objects(scene).collect();
    let emits =
        |label: usize| object_of[label].iter().any(|&o| o != NO_OBJECT && objects[o as usize].emission.is_some());
    let mut lit: Vec<bool> = (0..object_of.len()).map(emits).collect();
    for (index, group) in scene.groups.iter().enumerate() {
        // Groups place only groups before them.
        lit[index + 1] |= group.instances.iter().any(|instance| lit[instance.group + 1]);
    }
    lit[0] |= scene.instances.iter().any(|instance| lit[instance.group + 1]);
    let mut lamps = Lamps {
        objects: &objects,
        object_of: &object_of,
        coordinates: &coordinates,
        lit: &lit,
        range_nm,
        chain: Vec::new(),
        means: HashMap::new(),
        lights: Vec::new(),
    };
    lamps.add(&geometry, 0, &Affine::IDENTITY)?;
    let emitters = lamps.lights;
    Ok(SceneShapes { frame, geometry, object_of, emitters, coordinates, warnings, groups })
}

/// The shapes of a group in an earlier frame, if they are those of this one: of the same objects with the same numbers, and of groups
/// that are the same (`same`) and stand still in the same places.
fn same_group(
    index: usize,
    (scene, placed): (&Scene, &[bool]),
    same: &[bool],
    (earlier, made): EarlierGroups<'_>,
) -> Option<Arc<GroupShapes>> {
    let (group, before, made) = (&scene.groups[index], earlier.groups.get(index)?, made.get(index)?);
    let counts = |scene: &Scene| -> Vec<usize> {
        let groups = scene.groups[..index].iter().map(|group| group.objects.len());
        std::iter::once(scene.objects.len()).chain(groups).collect()
    };
    let numbered_alike = counts(scene) == counts(earlier);
    let still = stand_still(&group.instances, scene) && stand_still(&before.instances, earlier);
    let within = group.instances.iter().all(|instance| same[instance.group]);
    let equal = made.placed == placed[index] && group.objects == before.objects && group.instances == before.instances;
    (numbered_alike && still && within && equal).then(|| made.clone())
}

/// Whether none of some instances moves while the shutter is open.
pub(crate) fn stand_still(instances: &[scene::Instance], scene: &Scene) -> bool {
    !instances.iter().any(|instance| instance.moves(scene.camera.shutter_s))
}

/// Which groups are placed somewhere.
fn placed(scene: &Scene) -> Vec<bool> {
    let mut placed = vec![false; scene.groups.len()];
    scene.instances.iter().for_each(|instance| placed[instance.group] = true);
    for (index, group) in scene.groups.iter().enumerate().rev() {
        if placed[index] {
            group.instances.iter().for_each(|instance| placed[instance.group] = true);
        }
    }
    placed
}

/// Primitives, each with the number of its object.
#[derive(Default)]
struct Collected {
    primitives: Vec<Primitive>,
    object_of: Vec<u32>,
    /// Of each object.
    coordinates: Vec<Coordinates>,
}

impl Collected {
    fn add_all(
        &mut self,
        first_object: usize,
        objects: &[Object],
        (instances, shutter_s): (&[scene::Instance], [f64; 2]),
        shared: &[Arc<Geometry>],
        warnings: &mut Vec<String>,
    ) -> Result<(), PrepareError> {
        for (index, object) in objects.iter().enumerate() {
            self.add_object((first_object + index) as u32, object, warnings)
                .map_err(|source| PrepareError::Shape { object: object.name.clone(), source })?;
        }
        for instance in instances {
            let geometry = &shared[instance.group];
            if geometry.is_empty() {
                continue;
            }
            let made = match instance.motion.as_ref().filter(|motion| motion.moves(shutter_s)) {
                None => Placement::new(instance.transform.linear, instance.transform.translation_m)
                    .and_then(|placement| Instance::new(geometry.clone(), placement)),
                Some(moves) => {
                    motion(moves, shutter_s).and_then(|motion| Instance::moving(geometry.clone(), Arc::new(motion)))
                }
            };
            let made = made.map_err(|source| PrepareError::Instance { instance: instance.name.clone(), source })?;
            self.primitives.push(made.into());
            self.object_of.push(NO_OBJECT);
        }
        Ok(())
    }

    fn add_object(&mut self, index: u32, object: &Object, warnings: &mut Vec<String>) -> Result<(), ShapeError> {
        let to_world = Affine::new(&object.transform);
        let mut coordinates = Coordinates::None;
        match &object.shape {
            Shape::Sphere { center, radius_m } => {
                coordinates = Coordinates::Round(RoundCoordinates::sphere(*center, *radius_m, &to_world));
                self.add(index, Sphere::new(to_world.point(*center), radius_m * to_world.uniform_scale())?);
            }
            Shape::Parallelogram { origin, u, v } => {
                let edges = [*u, *v].map(|edge| to_world.vector(edge));
                let (u, v) = to_world.oriented(edges[0], edges[1]);
                coordinates = Coordinates::Parallelogram { swapped: to_world.mirrors(), edges };
                self.add(index, Parallelogram::new(to_world.point(*origin), u, v)?);
            }
            Shape::Disk { center, normal, radius_m, coordinates: kind } => {
                let round = RoundCoordinates::disk((*center, *normal, *radius_m), *kind, &to_world);
                coordinates = Coordinates::Round(round);
                let normal = to_world.vector(*normal).normalized();
                self.add(index, Disk::new(to_world.point(*center), normal, radius_m * to_world.uniform_scale())?);
            }
            Shape::Cylinder { start, end, radius_m, capped } => {
                coordinates = Coordinates::Round(RoundCoordinates::cylinder(*start, *end, *radius_m, &to_world));
                let (start, end) = (to_world.point(*start), to_world.point(*end));
                self.add(index, Cylinder::new(start, end, radius_m * to_world.uniform_scale(), *capped)?);
            }
            Shape::Mesh(mesh) => {
                let vertices: Vec<Vec3<f64>> = mesh.vertices.iter().map(|v| to_world.point(*v)).collect();
                let first = self.primitives.len() as u32;
                let mut dropped = Vec::new();
                let made = |triangle: &[u32; 3]| {
                    let [a, b, c] = triangle.map(|i| vertices[i as usize]);
                    let (b, c) = to_world.oriented(b, c);
                    Triangle::new(a, b, c)
                };
                self.primitives.reserve(mesh.triangles.len());
                self.object_of.reserve(mesh.triangles.len());
                // Some at a time, lest all be held twice.
                let mut number = 0;
                for chunk in mesh.triangles.chunks(8 * CHUNK) {
                    let made: Vec<_> = chunk.par_iter().with_min_len(CHUNK).map(made).collect();
                    for triangle in made {
                        match triangle {
                            Ok(shape) => self.add(index, shape),
                            Err(ShapeError::NoArea) => dropped.push(number),
                            Err(other) => return Err(other),
                        }
                        number += 1;
                    }
                }
                if !(mesh.normals.is_empty() && mesh.uvs.is_empty() && mesh.colours.is_empty()) {
                    coordinates = Coordinates::Mesh(MeshCoordinates {
                        mesh: Arc::clone(mesh),
                        first,
                        kept: (!dropped.is_empty()).then(|| {
                            (0..mesh.triangles.len() as u32).filter(|i| dropped.binary_search(i).is_err()).collect()
                        }),
                        normal_to_world: to_world.normal_matrix(),
                        linear: *to_world.matrix(),
                        swapped: to_world.mirrors(),
                    });
                }
                if !dropped.is_empty() {
                    warnings.push(format!(
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

    fn add(&mut self, object: u32, shape: impl Into<Primitive>) {
        self.primitives.push(shape.into());
        self.object_of.push(object);
    }
}

/// Collects a light for each emitting primitive wherever it is placed.
struct Lamps<'a> {
    objects: &'a [&'a Object],
    object_of: &'a [Vec<u32>],
    /// Of each object.
    coordinates: &'a [Coordinates],
    /// By label: whether anything within emits.
    lit: &'a [bool],
    range_nm: [f64; 2],
    /// The placements around what is being added, the outermost first.
    chain: Vec<Link>,
    /// Mean luminances of images over primitives, by the label and the primitive.
    means: HashMap<(usize, usize), f64>,
    lights: Vec<Light>,
}

impl Lamps<'_> {
    /// Adds those of a geometry that is placed by `to_frame` and whose own primitives have the instance number `number`.
    fn add(&mut self, geometry: &Geometry, number: u32, to_frame: &Affine) -> Result<(), PrepareError> {
        let label = geometry.label() as usize;
        if !self.lit[label] {
            return Ok(());
        }
        let moves = self.chain.iter().any(|link| matches!(link, Link::Moving(_)));
        let chain: Arc<[Link]> = if moves { self.chain.clone().into() } else { Arc::default() };
        // One spectrum for each object, not for each of its triangles.
        let mut radiance: Option<(u32, Arc<PathSpectrum>)> = None;
        for (i, &object) in self.object_of[label].iter().enumerate() {
            let primitive = PrimitiveId(i as u32);
            if object == NO_OBJECT {
                continue;
            }
            let number_of_object = object;
            let object = self.objects[object as usize];
            let Some(emission) = &object.emission else { continue };
            let shared = match &radiance {
                Some((of, shared)) if *of == number_of_object => shared.clone(),
                _ => Arc::new(PathSpectrum::new(&emission.radiance, self.range_nm)),
            };
            radiance = Some((number_of_object, shared.clone()));
            let emitter = Emitter {
                radiance: shared,
                front: emission.sides != EmissionSides::Back,
                back: emission.sides != EmissionSides::Front,
                surface: SurfaceId { instance: number, primitive },
                image: emission.image.as_ref().map(|texture| ImageOf {
                    object: number_of_object,
                    // The same wherever its group is placed.
                    mean: *self.means.entry((label, i)).or_insert_with(|| {
                        self.coordinates[number_of_object as usize].mean_luminance(primitive, texture)
                    }),
                }),
            };
            // The scene's own shapes are in place, to the bit.
            let shape = match number {
                _ if moves => geometry.primitive(primitive).clone(),
                0 => geometry.primitive(primitive).clone(),
                _ => to_frame
                    .shape(geometry.primitive(primitive))
                    .map_err(|source| PrepareError::Shape { object: object.name.clone(), source })?,
            };
            let Some(light) = AreaLight::new(&shape, emitter) else { continue };
            self.lights.push(match moves {
                true => Light::Moving(MovingLight::new(chain.clone(), light)),
                false => Light::Area(light),
            });
        }
        for (inner, instance) in geometry.instances() {
            self.chain.push(match instance.motion() {
                None => Link::Still(*instance.placement()),
                Some(motion) => Link::Moving(Arc::clone(motion)),
            });
            self.add(instance.geometry(), number + inner, &to_frame.after(instance.placement()))?;
            self.chain.pop();
        }
        Ok(())
    }
}
