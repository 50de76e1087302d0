//! How far a prism of 60° turns each wavelength, and what it loses by reflection:
//! `cargo run --release -p etalon-optics --example prism -- N-SF11`

#![allow(clippy::print_stdout)]

use etalon_optics::fresnel::dielectric;
use etalon_optics::snell::refract;
use etalon_optics::{RefractiveIndex, Vec3};

/// Fraunhofer's lines C, d, F and g, nm.
const LINES: [(&str, f64); 4] = [("C", 656.27), ("d", 587.56), ("F", 486.13), ("g", 435.84)];

fn main() -> Result<(), String> {
    let name = std::env::args().nth(1).unwrap_or("N-BK7".to_owned());
    let names = || RefractiveIndex::names().collect::<Vec<_>>().join(", ");
    let glass = RefractiveIndex::named(&name).ok_or_else(|| format!("{name}: unknown glass; use {}", names()))?;
    println!("{name}, Abbe number {:.2}", glass.abbe_number());

    // Normals of the two faces, 60° apart, both away from the glass.
    let (sin, cos) = 30_f64.to_radians().sin_cos();
    let [first, second] = [Vec3::new(-cos, sin, 0.0), Vec3::new(cos, sin, 0.0)];
    // Light that goes right and up, 60° from the first normal. `wi` leaves the surface toward where light comes from.
    let (sin, cos) = (150_f64 + 60.0).to_radians().sin_cos();
    let wi = Vec3::new(cos, sin, 0.0);
    for (line, nm) in LINES {
        let n = glass.eval(nm);
        let transmittance =
            |cosine: f64, eta| dielectric(cosine.abs(), eta).map_or(0.0, |fresnel| fresnel.transmittance);
        let inside = refract(wi, first, n).ok_or("light always enters glass")?;
        let Some(out) = refract(-inside, second, 1.0 / n) else {
            println!("{line} {nm} nm: n {n:.5}, totally reflected");
            continue;
        };
        let turned = (-wi).dot(out).acos().to_degrees();
        let through = transmittance(wi.dot(first), n) * transmittance(inside.dot(second), 1.0 / n);
        println!("{line} {nm} nm: n {n:.5}, turned by {turned:.3}°, {:.1} % passes", 100.0 * through);
    }
    Ok(())
}
