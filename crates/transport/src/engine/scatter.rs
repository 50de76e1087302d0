//! The walk's next step: a direction from each surface, what it is worth, and whether the path goes on.

use super::Engine;
use super::direct::vertex_numbers;
use super::level::{Level, Set, stages};
use super::rows::{Mask, Row, Rows3, W, lanes};
#[cfg(test)]
use super::tests::{Fault, is_wrong};
use crate::bsdf::lambert;
use crate::mis::Density;
use crate::model::WavelengthModel;
use crate::path::{ROULETTE_FROM_VERTEX, ROULETTE_THROUGHPUT, THROUGHPUT_FLOOR};
use etalon_geometry::{SurfaceId, SurfacePoint};
use etalon_optics::Lanes;

impl<M: WavelengthModel<f64, N>, const N: usize> Engine<'_, M, N> {
    /// Takes the next step of each of `scatters`; a shadow ray was sent from those that are also `shared`.
    #[inline(always)]
    pub(super) fn scatter(&mut self, scatters: Mask, shared: Mask) {
        if scatters == 0 {
            return;
        }
        let paths = &mut self.paths;
        let mut numbers = [[0.0; W]; 4];
        vertex_numbers(self.level, &paths.samplers, &paths.vertex, 0, &mut numbers);
        let [u1, u2, u_lobe, u_roulette] = &numbers;
        let (mut wi, mut cos) = (Rows3::ZERO, Row::ZERO);
        lambert_directions(self.level, (&paths.at.normal, &paths.direction), [u1, u2], &mut wi, &mut cos);

        let mut goes_on = 0;
        paths.shared = 0;
        for lane in lanes(scatters) {
            let lambda_nm = &paths.wavelengths[lane].lambda_nm;
            let density = match paths.at.lambert[lane] {
                Some(slot) => {
                    if cos.0[lane] <= 0.0 || cos.0[lane].is_nan() {
                        continue;
                    }
                    paths.beta[lane] *= paths.known.spectrum(lane, slot, self.tables, lambda_nm);
                    // As if it had followed lanes that are all alike.
                    let mean_of_hero =
                        if paths.parted >> lane & 1 == 1 { paths.model[lane].follow(Lanes::ONE) } else { 1.0 };
                    Density::SolidAngle(lambert::density(cos.0[lane]) * mean_of_hero)
                }
                None => {
                    let scattering = paths.at.scattering[lane].as_ref().expect("what is not Lambert's has been made");
                    let u = [u_lobe[lane], u1[lane], u2[lane]];
                    let Some(next) = scattering.sample(lambda_nm, -paths.direction.at(lane), u) else { continue };
                    wi.set(lane, next.wi);
                    paths.beta[lane] *= next.weight;
                    let mean_of_hero = paths.model[lane].follow(next.lane_density);
                    paths.parted |= Mask::from(next.lane_density != Lanes::ONE) << lane;
                    paths.eta_squared.0[lane] *= next.eta * next.eta;
                    match next.density {
                        Density::SolidAngle(density) => Density::SolidAngle(density * mean_of_hero),
                        Density::Delta => Density::Delta,
                    }
                }
            };
            if let Density::SolidAngle(density) = density {
                paths.density.0[lane] = density;
                paths.shared |= shared & 1 << lane;
            }
            let beta = paths.beta[lane];
            if !beta.is_finite() {
                // Shown to the film, which counts and locates it.
                paths.radiance[lane] = beta;
                continue;
            }
            let throughput = (beta.max_lane() * paths.model[lane].weight()) * paths.eta_squared.0[lane];
            if throughput < THROUGHPUT_FLOOR {
                continue;
            }
            if self.world.roulette && paths.vertex[lane] + 1 >= ROULETTE_FROM_VERTEX {
                let survival = (throughput / ROULETTE_THROUGHPUT).min(1.0);
                #[cfg(test)]
                let survival = if is_wrong(Fault::Undead) && lane == 7 { 1.0 } else { survival };
                if u_roulette[lane] >= survival {
                    continue;
                }
                paths.beta[lane] /= survival;
            }
            paths.leaves[lane] = paths.at.surface[lane];
            paths.vertex[lane] += 1;
            goes_on |= 1 << lane;
        }
        paths.alive = (paths.alive & !scatters) | goes_on;
        paths.from = paths.at.position;
        leave(self.level, (&paths.at.position, &paths.at.error, &paths.at.normal), &wi, &mut paths.origin);
        paths.direction = wi;
    }
}

stages! {
    /// Directions in proportion to the cosine, and their cosines.
    fn lambert_directions(surface: (&Rows3, &Rows3), u: [&[f64; W]; 2], wi: &mut Rows3, cos: &mut Row) {
        let (normal, direction) = surface;
        for lane in 0..W {
            let u = [u[0][lane], u[1][lane]];
            let (drawn, cosine) = lambert::direction(normal.at(lane), -direction.at(lane), u);
            wi.set(lane, drawn);
            cos.0[lane] = cosine;
        }
    }

    /// Where rays begin that leave surfaces along `wi`.
    fn leave(surface: (&Rows3, &Row, &Rows3), wi: &Rows3, origin: &mut Rows3) {
        let (position, error, normal) = surface;
        for lane in 0..W {
            let point = SurfacePoint {
                position: position.at(lane),
                position_error: error.0[lane],
                normal: normal.at(lane),
                surface: SurfaceId::NONE,
                label: 0,
                time: 0.0,
            };
            origin.set(lane, point.spawn(wi.at(lane)).origin);
        }
    }
}
