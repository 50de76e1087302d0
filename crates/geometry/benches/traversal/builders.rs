//! Build and trace times of both builders, taken in turns.

use crate::{CHUNK, Mesh, rays};
use etalon_geometry::{Geometry, Instance, Motion, Pose, Primitive, Ray, TreeBuilder};
use etalon_optics::Vec3;
use std::sync::Arc;
use std::time::Instant;

const BUILDERS: [TreeBuilder; 2] = [TreeBuilder::Thorough, TreeBuilder::Fast];

/// As many copies of a coarse ball, each on a way of its own.
pub(crate) fn movers(count: usize) -> Vec<Primitive> {
    let ball = Arc::new(Geometry::build(Mesh::ball(80).primitives()).expect("a ball"));
    let unit = [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)];
    let size = unit.map(|row| row * (0.5 / (count as f64).cbrt()));
    let mut random = crate::Random(5);
    let mut one = || {
        let from = Vec3::new(random.signed(), random.signed(), random.signed());
        let to = from + random.direction() * (0.5 / (count as f64).cbrt());
        let pose = |time, translation| Pose { time, translation, rotation: unit, stretch: size };
        let motion = Motion::new(&[pose(0.0, from), pose(1.0, to)]).expect("a motion");
        Primitive::Instance(Box::new(Instance::moving(ball.clone(), Arc::new(motion)).expect("an instance")))
    };
    (0..count).map(|_| one()).collect()
}

/// Of each the best of several turns: times to build and to trace, and after how many rays their sums are equal.
pub(crate) fn compare(name: &str, primitives: &[Primitive], turns: usize) {
    let mut build = [f64::INFINITY; 2];
    let mut built = [None, None];
    for (i, builder) in (0..turns).flat_map(|_| BUILDERS.into_iter().enumerate()) {
        let own = primitives.to_vec();
        let start = Instant::now();
        let geometry = Geometry::build_by(own, builder).expect("primitives that can be built");
        build[i] = build[i].min(start.elapsed().as_secs_f64());
        built[i] = Some(geometry);
    }
    let built = built.map(|geometry| geometry.expect("one turn at least"));
    println!(
        "{name}: {} primitives, built in {:.1} ms; fast: {:.1} ms",
        primitives.len(),
        build[0] * 1e3,
        build[1] * 1e3
    );
    for (kind, mut rays, _, shadow) in rays(&built[0]) {
        let count = rays.len();
        rays.iter_mut().enumerate().for_each(|(i, ray)| ray.time = i as f64 / count as f64);
        let mut best = [(); 2].map(|()| vec![f64::INFINITY; count.div_ceil(CHUNK)]);
        let mut hits = [0; 2];
        let of = |geometry: &Geometry, ray: &Ray<f32>| {
            if shadow { geometry.occluded(ray) } else { geometry.closest_hit(ray).is_some() }
        };
        for i in (0..turns).flat_map(|_| 0..2) {
            hits[i] = 0;
            for (chunk, best) in rays.chunks(CHUNK).zip(&mut best[i]) {
                let start = Instant::now();
                hits[i] += chunk.iter().filter(|ray| of(&built[i], ray)).count();
                *best = best.min(start.elapsed().as_secs_f64());
            }
        }
        assert_eq!(hits[0], hits[1], "both builders find the same hits");
        let ns = best.map(|chunks| chunks.iter().sum::<f64>() / count as f64 * 1e9);
        // Rays after which the builder of faster rays has made up for a slower build.
        let even = (build[0] - build[1]) / (ns[1] - ns[0]) * 1e3;
        let even = if even > 0.0 { format!("equal after {even:.2} million rays") } else { "never equal".to_owned() };
        println!(
            "  {kind:<17} {:>7.1} ns a ray; fast: {:>7.1} ns, {:.2} times as long; {even}",
            ns[0],
            ns[1],
            ns[1] / ns[0]
        );
    }
}
