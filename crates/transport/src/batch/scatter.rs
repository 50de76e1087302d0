//! The walk's next step: a direction from each surface, what it is worth, and whether the path goes on.

use super::Batch;
use super::level::{Level, stages};
use super::next_event::vertex_numbers;
use super::paths::vertex;
use super::rows::{Mask, Row, Rows3, W, lanes, surface_point};
use crate::bsdf::dielectric::{self, Turn};
use crate::bsdf::lambert;
use crate::integrator::Direction;
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::polarisation::Polarisation;
use crate::scene::shading_tables::BsdfKind;
use etalon_optics::Vec3;

impl<M: WavelengthModel<N>, P: Polarisation<N>, const N: usize> Batch<'_, M, P, N> {
    /// Takes the next step of each of `scatters`.
    #[inline(always)]
    pub(super) fn scatter(&mut self, scatters: Mask) {
        if scatters == 0 {
            return;
        }
        let (paths, world) = (&mut self.paths, self.world);
        let mut diffuse = 0;
        for lane in lanes(scatters) {
            diffuse |= Mask::from(matches!(vertex(&paths.at, lane).kind, BsdfKind::Lambert(_))) << lane;
        }
        let mut numbers = [[0.0; W]; 4];
        // Lambert's reflection has one lobe.
        let wanted = [true, true, diffuse != scatters, world.roulette];
        vertex_numbers(self.level, &paths.samplers, &paths.vertex, 0, wanted, &mut numbers);
        let [u1, u2, u_lobe, u_roulette] = &numbers;
        let (mut wi, mut cos) = (Rows3::ZERO, Row::ZERO);
        let guided_targets = world.guided_targets;
        let guided_directions = &mut self.guided_directions;
        let guided = guided_targets.aim();
        if guided {
            guided_directions.diffuse = diffuse;
            let surface = (&paths.position, &paths.normal, &paths.direction);
            guided_directions.allot(self.level, guided_targets, surface, u1);
            let u = [&guided_directions.u1.0, u2];
            lambert_directions(self.level, (&paths.normal, &paths.direction), u, &mut wi, &mut cos);
            guided_directions.take(self.level, guided_targets, surface, [u1, u2], (&mut wi, &mut cos));
        } else if diffuse != 0 {
            lambert_directions(self.level, (&paths.normal, &paths.direction), [u1, u2], &mut wi, &mut cos);
        }
        let mut turns = Turns::NONE;
        for lane in lanes(scatters & !diffuse) {
            let vertex = vertex(&paths.at, lane);
            match vertex.kind {
                BsdfKind::Mirror(_) => turns.put_mirror(lane),
                BsdfKind::Dielectric(number) => {
                    let of_material = &world.tables.interfaces[usize::from(number)];
                    turns.put(lane, vertex.indices(of_material, paths.paths[lane].hero_nm()));
                }
                BsdfKind::Lambert(_) | BsdfKind::General => {}
            }
        }
        if turns.count >= FEWEST_TURNS {
            turn(self.level, (&paths.normal, &paths.direction), u_lobe, &mut turns, &mut wi);
        } else if turns.count > 0 {
            for lane in lanes(scatters) {
                if turns.is[lane] {
                    turns.take(lane, (paths.normal.at(lane), -paths.direction.at(lane)), u_lobe[lane], &mut wi);
                }
            }
        }

        let mut goes_on = 0;
        for lane in lanes(scatters) {
            let (path, vertex) = (&mut paths.paths[lane], vertex(&paths.at, lane));
            let direction = match vertex.kind {
                BsdfKind::Lambert(_) => {
                    let cos = cos.0[lane];
                    if cos <= 0.0 || cos.is_nan() {
                        continue;
                    }
                    let guiding = if guided { guided_directions.factor.0[lane] } else { 1.0 };
                    Direction::Diffuse { wi: wi.at(lane), cos, guiding }
                }
                BsdfKind::Mirror(_) => Direction::Mirrored(wi.at(lane)),
                BsdfKind::Dielectric(_) => turns.direction(lane, wi.at(lane)),
                BsdfKind::General => {
                    let u = [u_lobe[lane], u1[lane], u2[lane]];
                    let Some(direction) = path.sample_direction(world, vertex, u, &mut ()) else { continue };
                    direction
                }
            };
            let taken = path.scatter(world, vertex, direction, u_lobe[lane]);
            if paths.shares {
                paths.reuse_path[lane].leave(world, path, vertex, taken.delta);
            }
            if !path.survives(world, taken.guiding, u_roulette[lane], &mut ()) {
                continue;
            }
            if vertex.kind == BsdfKind::General {
                // The others are there: to store them again, number by number, would hold up the loads of rows that follow.
                wi.set(lane, taken.wi);
            }
            paths.leaves[lane] = vertex.point.surface;
            paths.vertex[lane] = path.vertex;
            goes_on |= 1 << lane;
        }
        paths.alive &= !(scatters & !goes_on);
        let stays = paths.alive & !scatters;
        if stays == 0 {
            leave(self.level, (&paths.position, &paths.error, &paths.normal), &wi, &mut paths.origin);
            paths.direction = wi;
        } else {
            // Those that pass a surface keep their rays.
            let mut origin = Rows3::ZERO;
            leave(self.level, (&paths.position, &paths.error, &paths.normal), &wi, &mut origin);
            for lane in lanes(goes_on) {
                paths.origin.set(lane, origin.at(lane));
                paths.direction.set(lane, wi.at(lane));
            }
        }
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

    /// Where an interface sends a path.
    #[inline(always)]
    fn direction<const N: usize>(&self, lane: usize, wi: Vec3<f64>) -> Direction<N> {
        let (reflects, reflectance, cos) = (self.reflects[lane], self.reflectance.0[lane], self.cos.0[lane]);
        let turn = Turn { wi, reflects, reflectance, cos };
        Direction::Turned { turn, eta: self.eta.0[lane], from_outside: self.from_outside[lane] }
    }

    #[inline(always)]
    fn put_mirror(&mut self, lane: usize) {
        self.count += 1;
        (self.is[lane], self.is_mirror[lane]) = (true, true);
    }

    #[inline(always)]
    fn put(&mut self, lane: usize, [interior, exterior]: [f64; 2]) {
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
        for lane in 0..W {
            let point = surface_point(surface, lane);
            origin.set(lane, point.spawn(wi.at(lane)).origin);
        }
    }
}
