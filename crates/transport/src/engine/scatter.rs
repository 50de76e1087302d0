//! The walk's next step: a direction from each surface, what it is worth, and whether the path goes on.

use super::Engine;
use super::direct::vertex_numbers;
use super::level::{Level, stages};
use super::rows::{Mask, Row, Rows3, W, lanes};
use super::tables::Form;
#[cfg(test)]
use super::tests::{Fault, is_wrong};
use crate::bsdf::dielectric::{self, Turn};
use crate::bsdf::lambert;
use crate::mis::Density;
use crate::model::WavelengthModel;
use crate::path::{ROULETTE_FROM_VERTEX, ROULETTE_THROUGHPUT, THROUGHPUT_FLOOR};
use etalon_geometry::{SurfaceId, SurfacePoint};
use etalon_optics::{Lanes, Vec3};

impl<M: WavelengthModel<N>, const N: usize> Engine<'_, M, N> {
    /// Takes the next step of each of `scatters`; a shadow ray was sent from those that are also `shared`.
    #[inline(always)]
    pub(super) fn scatter(&mut self, scatters: Mask, shared: Mask) {
        if scatters == 0 {
            return;
        }
        let paths = &mut self.paths;
        let mut numbers = [[0.0; W]; 4];
        // Lambert's reflection has one lobe.
        let lobes = lanes(scatters).any(|lane| !matches!(paths.at.form[lane], Form::Lambert(_)));
        let wanted = [true, true, lobes, self.world.roulette];
        vertex_numbers(self.level, &paths.samplers, &paths.vertex, 0, wanted, &mut numbers);
        let [u1, u2, u_lobe, u_roulette] = &numbers;
        let (mut wi, mut cos) = (Rows3::ZERO, Row::ZERO);
        let casters = self.world.casters;
        let casting = &mut self.casting;
        let aims = casters.aim();
        if aims {
            casting.diffuse = 0;
            for lane in lanes(scatters) {
                casting.diffuse |= Mask::from(matches!(paths.at.form[lane], Form::Lambert(_))) << lane;
            }
            let surface = (&paths.at.position, &paths.at.normal, &paths.direction);
            casting.deal(self.level, casters, surface, u1);
            let u = [&casting.u1.0, u2];
            lambert_directions(self.level, (&paths.at.normal, &paths.direction), u, &mut wi, &mut cos);
            casting.take(self.level, casters, surface, [u1, u2], (&mut wi, &mut cos));
        } else {
            lambert_directions(self.level, (&paths.at.normal, &paths.direction), [u1, u2], &mut wi, &mut cos);
        }
        let mut turns = Turns::NONE;
        for lane in lanes(scatters) {
            match paths.at.form[lane] {
                Form::Mirror(_) => turns.put_mirror(lane),
                Form::Dielectric(number) => {
                    let interface = &self.tables.interfaces[usize::from(number)];
                    let hero_nm = paths.wavelengths[lane].lambda_nm[0];
                    turns.put(lane, interface.constant.unwrap_or_else(|| interface.glass.indices(hero_nm)));
                }
                Form::Lambert(_) | Form::Other => {}
            }
        }
        if turns.count >= FEWEST_TURNS {
            turn(self.level, (&paths.at.normal, &paths.direction), u_lobe, &mut turns, &mut wi);
        } else if turns.count > 0 {
            for lane in lanes(scatters) {
                if turns.is[lane] {
                    turns.take(lane, (paths.at.normal.at(lane), -paths.direction.at(lane)), u_lobe[lane], &mut wi);
                }
            }
        }

        let mut goes_on = 0;
        paths.shared = 0;
        for lane in lanes(scatters) {
            // What the path's throughput was, and is to be, multiplied by for its direction not being drawn by the cosine alone.
            let mut aim = 1.0;
            let lambda_nm = &paths.wavelengths[lane].lambda_nm;
            let density = match paths.at.form[lane] {
                Form::Lambert(slot) => {
                    if cos.0[lane] <= 0.0 || cos.0[lane].is_nan() {
                        continue;
                    }
                    paths.beta[lane] *= paths.known.spectrum(lane, slot, self.tables, &paths.wavelengths[lane]);
                    if aims {
                        aim = casting.factor.0[lane];
                        paths.aim_factor.0[lane] = casting.factor.0[lane].min(1.0);
                    }
                    // As if it had followed lanes that are all alike.
                    let mean_of_hero =
                        if paths.parted >> lane & 1 == 1 { paths.model[lane].follow(Lanes::ONE) } else { 1.0 };
                    Density::SolidAngle(lambert::density(cos.0[lane]) * mean_of_hero)
                }
                Form::Mirror(slot) => {
                    paths.beta[lane] *= paths.known.spectrum(lane, slot, self.tables, &paths.wavelengths[lane]);
                    if paths.parted >> lane & 1 == 1 {
                        // As if it had followed lanes that are all alike.
                        paths.model[lane].follow(Lanes::ONE);
                    }
                    Density::Delta
                }
                Form::Dielectric(number) => {
                    let glass = &self.tables.interfaces[usize::from(number)].glass;
                    let eta = if turns.reflects[lane] { 1.0 } else { turns.eta.0[lane] };
                    let lane_density = match turns.reflects[lane] {
                        _ if !glass.is_dispersive() => Lanes::ONE,
                        true => {
                            let incidence = (turns.cos.0[lane], turns.from_outside[lane]);
                            glass.relative_reflectances(lambda_nm, incidence, turns.reflectance.0[lane])
                        }
                        false => Lanes::ONE.hero_only(),
                    };
                    paths.beta[lane] *= if turns.reflects[lane] { lane_density } else { lane_density / (eta * eta) };
                    let parts = lane_density != Lanes::ONE;
                    paths.parted |= Mask::from(parts) << lane;
                    if paths.parted >> lane & 1 == 1 {
                        paths.model[lane].follow(lane_density);
                    }
                    paths.eta_squared.0[lane] *= eta * eta;
                    Density::Delta
                }
                Form::Other => {
                    let scattering = paths.at.scattering[lane].as_ref().expect("what is not Lambert's has been made");
                    let u = [u_lobe[lane], u1[lane], u2[lane]];
                    let (point, wo) = (paths.at.point(lane), -paths.direction.at(lane));
                    let Some((next, mixture)) = casters.sample(&point, scattering, lambda_nm, wo, u) else {
                        continue;
                    };
                    wi.set(lane, next.wi);
                    paths.beta[lane] *= next.weight;
                    aim = mixture.factor(1.0);
                    let mean_of_hero = paths.model[lane].follow(next.lane_density);
                    paths.parted |= Mask::from(next.lane_density != Lanes::ONE) << lane;
                    paths.eta_squared.0[lane] *= next.eta * next.eta;
                    match next.density {
                        Density::SolidAngle(density) => {
                            paths.aim_factor.0[lane] = mixture.aim_factor();
                            Density::SolidAngle(density * mean_of_hero)
                        }
                        Density::Delta => Density::Delta,
                    }
                }
            };
            if let Density::SolidAngle(density) = density {
                paths.density.0[lane] = density;
                paths.shared |= shared & 1 << lane;
            }
            let unaimed = paths.beta[lane];
            paths.beta[lane] *= aim;
            let beta = paths.beta[lane];
            if !beta.is_finite() {
                // Shown to the film, which counts and locates it.
                paths.radiance[lane] = beta;
                continue;
            }
            if paths.shares && matches!(density, Density::SolidAngle(_)) && paths.gathered[lane].begins() {
                let diffuse =
                    self.tables.objects[paths.at.object[lane] as usize].diffuse && paths.model[lane].together();
                let (point, wo) = (paths.at.point(lane), -paths.direction.at(lane));
                let state = (&mut paths.radiance[lane], &mut paths.beta[lane], &mut paths.eta_squared.0[lane]);
                paths.gathered[lane].leave(paths.vertex[lane], &point, wo, diffuse, (&unaimed, aim), state);
            }
            let beta = paths.beta[lane];
            let throughput = (beta.max_lane() * paths.model[lane].weight()) * paths.eta_squared.0[lane];
            if throughput < THROUGHPUT_FLOOR {
                continue;
            }
            if self.world.roulette && paths.vertex[lane] + 1 >= ROULETTE_FROM_VERTEX {
                let survival = (throughput / (paths.aim_factor.0[lane] * ROULETTE_THROUGHPUT)).min(1.0);
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

/// Fewest paths at mirrors and smooth interfaces for which all of a set are computed at once.
const FEWEST_TURNS: u32 = 3;

/// Where mirrors and smooth interfaces send the paths that are at one.
pub(super) struct Turns {
    /// How many there are.
    count: u32,
    is: [bool; W],
    is_mirror: [bool; W],
    /// Indices behind and before the outward normal, at the hero's wavelength.
    interior: Row,
    exterior: Row,
    /// The cosine of incidence, n_transmitted / n_incident, and the share that is reflected.
    cos: Row,
    eta: Row,
    reflectance: Row,
    from_outside: [bool; W],
    reflects: [bool; W],
}

impl Turns {
    const NONE: Self = Self {
        count: 0,
        is: [false; W],
        is_mirror: [false; W],
        interior: Row([1.0; W]),
        exterior: Row([1.0; W]),
        cos: Row::ZERO,
        eta: Row::ZERO,
        reflectance: Row::ZERO,
        from_outside: [false; W],
        reflects: [false; W],
    };

    /// The direction of a path, in place of that which is there, if it is at an interface; without branches.
    #[inline(always)]
    fn take(&mut self, lane: usize, (n, wo): (Vec3<f64>, Vec3<f64>), u_lobe: f64, wi: &mut Rows3) {
        let from_outside = n.dot(wo) > 0.0;
        let (interior, exterior) = (self.interior.0[lane], self.exterior.0[lane]);
        let (inward, outward) = (interior / exterior, exterior / interior);
        let eta = if from_outside { inward } else { outward };
        // Below any reflectance: a mirror.
        let u = if self.is_mirror[lane] { -1.0 } else { u_lobe };
        let Turn { wi: turned, reflects, reflectance, cos } = dielectric::turn(n, wo, eta, u);
        self.from_outside[lane] = from_outside;
        self.reflects[lane] = reflects;
        (self.cos.0[lane], self.eta.0[lane], self.reflectance.0[lane]) = (cos, eta, reflectance);
        let there = wi.at(lane);
        let choose = |a: f64, b: f64| if self.is[lane] { a } else { b };
        wi.set(lane, Vec3::new(choose(turned.x, there.x), choose(turned.y, there.y), choose(turned.z, there.z)));
    }

    #[inline(always)]
    fn put_mirror(&mut self, lane: usize) {
        self.count += 1;
        (self.is[lane], self.is_mirror[lane]) = (true, true);
    }

    #[inline(always)]
    fn put(&mut self, lane: usize, [interior, exterior]: [f64; 2]) {
        #[cfg(test)]
        let (interior, exterior) =
            if is_wrong(Fault::InsideOut) && lane == 3 { (exterior, interior) } else { (interior, exterior) };
        self.count += 1;
        self.is[lane] = true;
        (self.interior.0[lane], self.exterior.0[lane]) = (interior, exterior);
    }
}

stages! {
    /// The directions of [`Turns`], in place of those that are there.
    fn turn(surface: (&Rows3, &Rows3), u_lobe: &[f64; W], turns: &mut Turns, wi: &mut Rows3) {
        let (normal, direction) = surface;
        for lane in 0..W {
            turns.take(lane, (normal.at(lane), -direction.at(lane)), u_lobe[lane], wi);
        }
    }

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
