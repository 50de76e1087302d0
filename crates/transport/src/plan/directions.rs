//! What calls for directions in `f64`. Every kernel has them; this says which surface could not do without.

use super::evidence::first_surface;
use super::grey::steps;
use etalon_scene::{MaterialKind, Scene};

/// What calls for directions in `f64` (`Ok`), or why nothing does (`Err`).
pub(super) fn evidence(scene: &Scene) -> Result<String, String> {
    first_surface(scene, |material, range| {
        refraction(&material.kind, range).map(|eta| {
            let beyond = lost_beyond(eta).to_degrees();
            format!("refracts by {eta:.3}; in 24 bits its light beyond {beyond:.2}° would be lost")
        })
    })
    .ok_or_else(|| "no smooth surface refracts; intersections are decided in f64 anyway".to_owned())
}

/// The largest ratio of the indices on both sides of a smooth surface that bends light.
fn refraction(kind: &MaterialKind, range_nm: [f64; 2]) -> Option<f64> {
    match kind {
        MaterialKind::Dielectric { interior, exterior, .. } => {
            let ratio = |nm: f64| interior.eval(nm) / exterior.eval(nm);
            let largest = steps(range_nm).map(ratio).map(|eta| eta.max(1.0 / eta)).fold(1.0, f64::max);
            (largest > 1.0).then_some(largest)
        }
        MaterialKind::Blend { parts, .. } => {
            parts.iter().filter_map(|(_, part)| refraction(part, range_nm)).reduce(f64::max)
        }
        // What a facet, a mirror or a pane does to a direction does not magnify its errors.
        MaterialKind::RoughDielectric { .. }
        | MaterialKind::RoughConductor { .. }
        | MaterialKind::OrenNayar { .. }
        | MaterialKind::Plastic { .. }
        | MaterialKind::ThinDielectric { .. }
        | MaterialKind::PolarisingSheet { .. }
        | MaterialKind::Lambert { .. }
        | MaterialKind::Mirror { .. }
        | MaterialKind::Conductor { .. }
        | MaterialKind::Black => None,
    }
}

/// The angle from the normal, radians, beyond which a direction of 24 bits does not know whether it may leave the denser
/// medium: inside, cos²θₜ = 1 − η² sin²θ changes by 2√(η² − 1) δ at the critical angle when θ does by δ = 2⁻²⁴.
fn lost_beyond(eta: f64) -> f64 {
    let delta = f64::from(f32::EPSILON) / 2.0;
    (2.0 * ((eta - 1.0) * (eta + 1.0)).sqrt() * delta).sqrt().min(1.0).acos()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hard case 23, as single precision was seen to fail it: at 89.99° the light was trapped, at 89.9° it was not.
    #[test]
    fn single_precision_would_lose_the_plate_at_89_99_degrees_but_not_at_89_9() {
        let beyond = lost_beyond(1.5).to_degrees();
        assert!(beyond > 89.9 && beyond < 89.99, "{beyond}");
    }
}
