//! Rays a second, for closest hits and shadow rays, and the same rays through Embree 3.13 where it is installed.
//!
//! One thread; all engines take turns on the same rays, and each figure is made of the best of several turns. Run with
//! `cargo bench -p etalon-geometry --bench traversal -- [NAME] [--rays KIND] [--turns N] [--alone] [--eights]`, where NAME and
//! KIND select scenes and rays by substring; `--alone` leaves Embree out, `--eights` casts eight rays at once, too, where there is a
//! tree. `--builders` compares the two builders of trees instead, on meshes and on balls that move.
#![allow(missing_docs, clippy::print_stdout)] // A bench prints.

mod builders;
mod embree;
mod scenes;

use embree::{Content, Embree, ROBUST, Scene};
use etalon_geometry::{Geometry, Hit, LANES, Primitive, Ray, Rays, SurfacePoint};
use etalon_optics::{Frame, Vec3};
use scenes::{Mesh, Random, balls, instances, placements, spheres};
use std::time::Instant;

/// Pixels a side of the camera.
const SIDE: usize = 320;

struct Options {
    filter: String,
    rays: String,
    turns: usize,
    alone: bool,
    eights: bool,
    builders: bool,
}

fn main() {
    let mut options =
        Options { filter: String::new(), rays: String::new(), turns: 7, alone: false, eights: false, builders: false };
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--bench" => {}
            "--turns" => options.turns = arguments.next().and_then(|n| n.parse().ok()).expect("--turns takes a number"),
            "--rays" => options.rays = arguments.next().expect("--rays takes a kind of rays"),
            "--alone" => options.alone = true,
            "--eights" => options.eights = true,
            "--builders" => options.builders = true,
            name => options.filter = name.to_owned(),
        }
    }
    if options.builders {
        return compare_builders(&options);
    }
    let threads = rayon::current_num_threads();
    let embree = if options.alone { None } else { Embree::load(threads) };
    if embree.is_none() && !options.alone {
        println!("libembree3.so.3 is not installed: no comparison");
    }
    println!("{threads} build threads; Mrays/s of one thread, and the ratio to Embree (above 1: faster than Embree)\n");
    println!(
        "{:<16} {:<17} {:>8} {:>9} {:>8} {:>9} {:>8}",
        "scene", "rays", "Mrays/s", "default", "ratio", "robust", "ratio"
    );
    for (size, label) in [(100_000, "100k"), (1_000_000, "1M"), (10_000_000, "10M")] {
        if label == "10M" && !options.filter.contains(label) {
            // Named, or not at all: it takes gigabytes.
            continue;
        }
        for kind in ["displaced", "gridded", "slivers"] {
            let name = format!("{kind}-{label}");
            if name.contains(&options.filter) {
                let mesh = match kind {
                    "displaced" => Mesh::displaced(size),
                    "gridded" => Mesh::gridded(size),
                    _ => Mesh::slivers(size),
                };
                let content = Content::Triangles(&mesh.vertices, &mesh.faces);
                measure(&name, mesh.primitives(), embree.as_ref().map(|e| (e, content)), &options);
            }
        }
    }
    if "cornell-32".contains(&options.filter) {
        let mesh = Mesh::cornell();
        let content = Content::Triangles(&mesh.vertices, &mesh.faces);
        measure("cornell-32", mesh.primitives(), embree.as_ref().map(|e| (e, content)), &options);
    }
    if "glass-12".contains(&options.filter) {
        // Ten triangles of the same room, and two balls in it.
        let mut primitives = Mesh::cornell().primitives();
        primitives.truncate(10);
        primitives.extend(spheres(&[[-0.6, 0.9, -1.7, 1.0], [0.7, -1.0, -1.7, 1.0]]));
        measure("glass-12", primitives, None, &options);
    }
    if "spheres-10k".contains(&options.filter) {
        let balls = balls(10_000);
        let content = Content::Spheres(&balls);
        measure("spheres-10k", spheres(&balls), embree.as_ref().map(|e| (e, content)), &options);
    }
    if "instances-10k".contains(&options.filter) {
        let (placed, placements, others) = (Mesh::ball(2_500), placements(10_000), Mesh::room());
        let content = Content::Instances { placed: &placed, placements: &placements, others: &others };
        let primitives = instances(&placed, &placements, &others);
        measure("instances-10k", primitives, embree.as_ref().map(|e| (e, content)), &options);
    }
}

fn compare_builders(options: &Options) {
    println!("{} build threads; rays of one thread\n", rayon::current_num_threads());
    type Make = fn() -> Vec<Primitive>;
    let scenes: [(&str, Make); 5] = [
        ("displaced-100k", || Mesh::displaced(100_000).primitives()),
        ("gridded-100k", || Mesh::gridded(100_000).primitives()),
        ("slivers-100k", || Mesh::slivers(100_000).primitives()),
        ("moving-1k", || builders::movers(1_000)),
        ("moving-100k", || builders::movers(100_000)),
    ];
    for (name, make) in scenes.into_iter().filter(|(name, _)| name.contains(&options.filter)) {
        builders::compare(name, &make(), options.turns);
    }
}

fn measure(
    name: &str,
    primitives: Vec<Primitive>,
    embree: Option<(&std::rc::Rc<Embree>, Content<'_>)>,
    options: &Options,
) {
    let (count, mesh_bytes) = (primitives.len(), primitives.capacity() * size_of::<Primitive>());
    let start = Instant::now();
    let geometry = Geometry::build(primitives).expect("primitives that can be built");
    let build = start.elapsed().as_secs_f64();
    let memory = (geometry.memory_bytes() - mesh_bytes) as f64 / count as f64;
    let mut build_text = format!("{name}: {count} primitives, built in {build:.3} s, {memory:.0} bytes a primitive");
    let peers: Vec<Scene> = embree.map_or_else(Vec::new, |(embree, content)| {
        [0, ROBUST]
            .map(|flags| {
                let start = Instant::now();
                let scene = embree.scene(&content, flags);
                build_text += &format!("; Embree {:.3} s", start.elapsed().as_secs_f64());
                scene
            })
            .into()
    });
    for (kind, rays, t_near, shadow) in rays(&geometry).into_iter().filter(|(kind, ..)| kind.contains(&options.rays)) {
        let all = Cast { name, geometry: &geometry, peers: &peers, shadow, turns: options.turns };
        all.compare(kind, &rays, None);
        let agreed = all.agreed(kind, &rays, None);
        if agreed.len() * 100 < rays.len() * 99 {
            // A ray that ends where it starts is soon done.
            all.compare(&format!("{kind}, agreed"), &agreed, None);
            let kind = format!("{kind}, t_near");
            all.compare(&kind, &rays, Some(&t_near));
            all.agreed(&kind, &rays, Some(&t_near));
        }
        if options.eights || count <= 128 {
            eights(name, kind, &geometry, &rays, shadow, options.turns);
        }
    }
    println!("{build_text}\n");
}

/// Rays whose time is taken together: fewer milliseconds than a scheduler's slice.
const CHUNK: usize = 1024;

/// What rays are cast through.
struct Cast<'a> {
    name: &'a str,
    geometry: &'a Geometry,
    peers: &'a [Scene],
    shadow: bool,
    turns: usize,
}

impl Cast<'_> {
    /// Times the engines in turn on the same rays, which Embree's begin at the distances `t_near`, if there are any. Of each chunk
    /// of rays the shortest time of all turns counts, so that what else runs on the machine is seen no more than it must.
    #[inline(never)]
    fn compare(&self, kind: &str, rays: &[Ray<f32>], t_near: Option<&[f32]>) {
        let &Self { name, geometry, peers, shadow, turns } = self;
        let engines = 1 + peers.len();
        let mut best = vec![vec![f64::INFINITY; rays.len().div_ceil(CHUNK)]; engines];
        let mut hits = vec![0_usize; engines];
        let zeros = vec![0.0; rays.len()];
        let t_near = t_near.unwrap_or(&zeros);
        for _ in 0..turns {
            for engine in 0..engines {
                hits[engine] = 0;
                for ((chunk, t_near), best) in rays.chunks(CHUNK).zip(t_near.chunks(CHUNK)).zip(&mut best[engine]) {
                    let start = Instant::now();
                    hits[engine] += match (engine, shadow) {
                        (0, false) => chunk.iter().filter(|r| geometry.closest_hit(r).is_some()).count(),
                        (0, true) => chunk.iter().filter(|r| geometry.occluded(r)).count(),
                        (_, false) => {
                            let peer = &peers[engine - 1];
                            chunk.iter().zip(t_near).filter(|&(r, &t)| peer.closest(r, t).0.is_finite()).count()
                        }
                        (_, true) => {
                            let peer = &peers[engine - 1];
                            chunk.iter().zip(t_near).filter(|&(r, &t)| peer.occluded(r, t)).count()
                        }
                    };
                    *best = best.min(start.elapsed().as_secs_f64());
                }
            }
        }
        let rate = |engine: usize| rays.len() as f64 / best[engine].iter().sum::<f64>() * 1e-6;
        let mut line = format!("{name:<16} {kind:<17} {:>8.2}", rate(0));
        for engine in 1..engines {
            line += &format!(" {:>9.2} {:>8.2}", rate(engine), rate(0) / rate(engine));
        }
        println!("{line}   hits {hits:?} of {}", rays.len());
    }

    /// The rays of which all engines find the same. The others are counted.
    fn agreed(&self, kind: &str, rays: &[Ray<f32>], t_near: Option<&[f32]>) -> Vec<Ray<f32>> {
        let &Self { name, geometry, peers, shadow, .. } = self;
        let zeros = vec![0.0; rays.len()];
        let mut agree = vec![true; rays.len()];
        for (peer, mode) in peers.iter().zip(["default", "robust"]) {
            let (mut false_hits, mut left, mut missed) = (0, 0, 0);
            for ((r, &t_near), agree) in rays.iter().zip(t_near.unwrap_or(&zeros)).zip(&mut agree) {
                let (t, primitive) = peer.closest(r, t_near);
                let ours = geometry.closest_hit(r);
                // What it finds where we find nothing, or nothing so near: what the ray leaves, of which it does not know.
                let is_false = t < r.t_max
                    && !(shadow && geometry.occluded(r))
                    && t < ours.map_or(f32::INFINITY, |hit| hit.t * 0.999);
                false_hits += usize::from(is_false);
                left += usize::from(is_false && primitive == r.leaves.primitive.0);
                missed += usize::from(ours.is_some_and(|hit| hit.t < t_near));
                *agree &= !is_false;
            }
            if false_hits > 0 || missed > 0 {
                println!(
                    "{name:<16} {kind:<17} Embree {mode}: {false_hits} hits where we have none or farther ones, {left} of the \
                     primitive left; {missed} of ours are before t_near"
                );
            }
        }
        rays.iter().zip(agree).filter(|(_, agree)| *agree).map(|(r, _)| *r).collect()
    }
}

/// Times the same rays, in `f64`, alone and eight at once, and the surfaces that they hit.
#[inline(never)]
fn eights(name: &str, kind: &str, geometry: &Geometry, rays: &[Ray<f32>], shadow: bool, turns: usize) {
    let alone: Vec<Ray<f64>> = rays
        .iter()
        .map(|r| Ray {
            origin: r.origin.to_f64(),
            direction: r.direction.to_f64(),
            t_max: f64::from(r.t_max),
            leaves: r.leaves,
            aims_at: r.aims_at,
            time: r.time,
        })
        .collect();
    let (eights, _) = alone.as_chunks::<LANES>();
    let eights: Vec<Rays> = eights
        .iter()
        .map(|eight| {
            let mut rays = Rays::NONE;
            eight.iter().enumerate().for_each(|(lane, ray)| rays.set(lane, ray));
            rays
        })
        .collect();
    const CHUNKS: usize = CHUNK / LANES;
    let (alone, eights) = (&alone[..eights.len() * LANES], &eights[..]);
    let mut best = [(); 4].map(|()| vec![f64::INFINITY; alone.len().div_ceil(CHUNK)]);
    let mut sum = 0.0;
    // Each of them all rays in turn, so that none finds in caches what the one before it fetched for the same rays.
    for i in (0..turns).flat_map(|_| 0..4) {
        for (chunk, (alone, eights)) in alone.chunks(CHUNK).zip(eights.chunks(CHUNKS)).enumerate() {
            let mut time = |run: &mut dyn FnMut() -> f64| {
                let start = Instant::now();
                sum += run();
                best[i][chunk] = best[i][chunk].min(start.elapsed().as_secs_f64());
            };
            match i {
                0 if shadow => time(&mut || alone.iter().filter(|r| geometry.occluded(r)).count() as f64),
                1 if shadow => {
                    time(&mut || eights.iter().map(|r| f64::from(geometry.any_hits(r, 0xFF).count_ones())).sum());
                }
                _ if shadow => {}
                0 => time(&mut || alone.iter().filter_map(|r| geometry.closest_hit(r)).map(|h| h.t).sum()),
                1 => time(&mut || eights.iter().map(|r| geometry.closest_hits(r, 0xFF).t[0]).sum()),
                2 => {
                    let hits: Vec<_> = alone.iter().filter_map(|r| Some((r, geometry.closest_hit(r)?))).collect();
                    time(&mut || hits.iter().map(|(r, h)| geometry.surface(r, h).position_error).sum());
                }
                _ => {
                    let hits: Vec<_> = eights.iter().map(|r| (r, geometry.closest_hits(r, 0xFF))).collect();
                    time(&mut || hits.iter().map(|(r, h)| geometry.surfaces(r, h, h.mask).position_error[0]).sum());
                }
            }
        }
    }
    let ns = best.map(|s| s.iter().sum::<f64>() * 1e9 / alone.len() as f64);
    println!(
        "{name:<16} {kind:<17} f64: {:.1} ns alone, {:.1} eight at once; surface {:.1} and {:.1} ns   ({sum:.1})",
        ns[0], ns[1], ns[2], ns[3]
    );
}

/// The distance along a direction at which a renderer that casts through Embree must let a ray begin, lest it meet the surface that
/// it leaves: where the ray is clear of it if the origin lies behind it, by the error bound of the origin in `f32` and by the
/// rounding, also in `f32`, of an intersection with a shape of that size at that place.
fn t_near(geometry: &Geometry, point: &SurfacePoint<f32>, direction: Vec3<f32>) -> f32 {
    let radius = match geometry.primitive(point.surface.primitive) {
        Primitive::Sphere(sphere) => sphere.radius(),
        _ => 0.0,
    };
    let (d, n) = (direction.to_f64(), point.normal.to_f64());
    let reach = point.position.to_f64().abs().max_component() + radius;
    let depth = f64::from(point.position_error) + 8.0 * f64::from(f32::EPSILON) * 0.5 * reach;
    let cos = (d.dot(n) / d.length()).abs();
    // The root of s² + 2·cos·r·s = 2·depth·r: how far a ray that starts so deep within a sphere is from its surface.
    let curvature = if radius > 0.0 { 1.0 / radius } else { 0.0 };
    let distance = 2.0 * depth / (cos + (cos * cos + 2.0 * depth * curvature).sqrt());
    (distance / d.length()) as f32
}

/// Rays of a kind, where Embree's may begin, and whether they are shadow rays.
type Kind = (&'static str, Vec<Ray<f32>>, Vec<f32>, bool);

/// Primary rays, shadow rays from what they hit, and the rays of the first and the third diffuse bounce.
fn rays(geometry: &Geometry) -> Vec<Kind> {
    let eye = Vec3::new(2.6_f32, -2.7, 0.9);
    let frame = Frame::from_normal((-eye).normalized());
    // In tiles, as a renderer would.
    let mut primary = Vec::with_capacity(SIDE * SIDE);
    for tile in 0..(SIDE / 8) * (SIDE / 8) {
        for pixel in 0..64 {
            let x = (tile % (SIDE / 8)) * 8 + pixel % 8;
            let y = (tile / (SIDE / 8)) * 8 + pixel / 8;
            let at = |p: usize| (p as f32 + 0.5) / SIDE as f32 * 1.2 - 0.6;
            primary.push(Ray::free(eye, frame.to_world(Vec3::new(at(x), at(y), 1.0))));
        }
    }
    let mut random = Random(21);
    let lamp = Vec3::new(0.5_f64, 0.3, 2.6);
    let surfaces = |rays: &[Ray<f32>]| -> Vec<(SurfacePoint<f32>, Ray<f32>)> {
        rays.iter()
            .filter_map(|ray| {
                let hit: Hit<f32> = geometry.closest_hit(ray)?;
                Some((geometry.surface(ray, &hit), *ray))
            })
            .collect()
    };
    let spawned = |p: &SurfacePoint<f32>, ray: Ray<f32>| (ray, t_near(geometry, p, ray.direction));
    let mut bounce = |points: &[(SurfacePoint<f32>, Ray<f32>)]| -> (Vec<Ray<f32>>, Vec<f32>) {
        points
            .iter()
            .map(|(p, ray)| {
                let n = if p.normal.dot(ray.direction) > 0.0 { -p.normal } else { p.normal };
                // Lambert: the normal plus a point of the unit sphere.
                spawned(p, p.spawn((n.to_f64() + random.direction()).cast()))
            })
            .unzip()
    };
    let first_points = surfaces(&primary);
    let (first, first_near) = bounce(&first_points);
    let (second, _) = bounce(&surfaces(&first));
    let (third, third_near) = bounce(&surfaces(&second));
    let mut random = Random(22);
    let (shadow, shadow_near) = first_points
        .iter()
        .map(|(p, _)| {
            let jitter = Vec3::new(random.signed(), random.signed(), 0.0) * 0.3;
            spawned(p, p.spawn_to((lamp + jitter).cast(), etalon_geometry::SurfaceId::NONE))
        })
        .unzip();
    let nowhere = vec![0.0; primary.len()];
    vec![
        ("primary", primary, nowhere, false),
        ("shadow", shadow, shadow_near, true),
        ("diffuse-1", first, first_near, false),
        ("diffuse-3", third, third_near, false),
    ]
}
