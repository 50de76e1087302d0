//! A ball on a floor under a lamp, drawn with characters: one ray to the surface, one from there to the lamp.
//! `cargo run --release -p etalon-geometry --example shadow`

#![allow(clippy::print_stdout)]

use etalon_geometry::{Geometry, Parallelogram, Primitive, Ray, Sphere, SurfaceId};
use etalon_optics::Vec3;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let v = Vec3::<f64>::new;
    let ball = Sphere::new(v(0.0, 1.0, 0.0), 1.0)?;
    let floor = Parallelogram::new(v(-4.0, 0.0, -4.0), v(0.0, 0.0, 8.0), v(8.0, 0.0, 0.0))?;
    let geometry = Geometry::build(vec![Primitive::from(ball), floor.into()])?;

    let (eye, lamp) = (v(0.0, 3.0, 7.0), v(4.0, 6.0, 2.0));
    for row in 0..26 {
        let line: String = (0..72)
            .map(|column| {
                let direction = v((f64::from(column) - 35.5) / 110.0, -0.08 - f64::from(row) / 55.0, -1.0);
                let ray = Ray::free(eye, direction);
                let Some(hit) = geometry.closest_hit(&ray) else { return ' ' };
                let point = geometry.surface(&ray, &hit);
                let to_lamp = lamp - point.position;
                let cosine = to_lamp.normalized().dot(point.normal);
                // The ray leaves the surface by the error bound of the point: there is no epsilon to choose.
                if cosine <= 0.0 || geometry.occluded(&point.spawn_to(lamp, SurfaceId::NONE)) {
                    return '.';
                }
                [':', '-', '=', '+', '*', '#'][((cosine * 6.0) as usize).min(5)]
            })
            .collect();
        println!("{}", line.trim_end());
    }
    Ok(())
}
