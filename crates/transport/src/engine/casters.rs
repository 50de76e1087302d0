//! Directions toward casters of caustics, for the paths that are at diffuse surfaces.

use super::level::{Level, Set, stages};
use super::rows::{Row, Rows3, W};
use crate::bsdf::lambert;
use crate::caustics::{Caster, Casters, MOST_CASTERS, Mixture, Target, density_of, is_within, place_within, share_of};
use etalon_optics::Vec3;

/// What casters make of the directions of a set.
pub(super) struct Drawn {
    /// Whose directions may be drawn toward them.
    pub diffuse: [bool; W],
    /// The first number of each direction by the cosine.
    pub u1: Row,
    /// What the weight of each direction is to be multiplied by.
    pub factor: Row,
    /// The part of the numbers that casters take.
    total: Row,
    shares: [Row; MOST_CASTERS],
    is_aimed: [bool; W],
    aimed: Rows3,
}

impl Drawn {
    pub(super) const NONE: Self = Self {
        diffuse: [false; W],
        u1: Row::ZERO,
        factor: Row::ZERO,
        total: Row::ZERO,
        shares: [Row::ZERO; MOST_CASTERS],
        is_aimed: [false; W],
        aimed: Rows3::ZERO,
    };

    /// Draws the directions that go toward casters.
    #[inline(always)]
    pub(super) fn aim(
        &mut self,
        level: Level,
        casters: &Casters,
        surface: (&Rows3, &Rows3, &Rows3),
        u: [&[f64; W]; 2],
    ) {
        for (number, body) in casters.aimed_at().iter().enumerate() {
            match body {
                Caster::Sphere(round) => aim(level, round, (number, casters.each), surface, u, self),
                Caster::Box(body) => aim(level, body, (number, casters.each), surface, u, self),
            }
        }
        leave_rest(level, u[0], self);
    }

    /// Puts them in place of those drawn by the cosine, and weighs all.
    #[inline(always)]
    pub(super) fn take(
        &mut self,
        level: Level,
        casters: &Casters,
        surface: (&Rows3, &Rows3, &Rows3),
        wi: &mut Rows3,
        cos: &mut Row,
    ) {
        put(level, surface, self, wi, cos);
        for (number, body) in casters.aimed_at().iter().enumerate() {
            match body {
                Caster::Sphere(round) => weigh(level, round, number, surface.0, wi, self),
                Caster::Box(body) => weigh(level, body, number, surface.0, wi, self),
            }
        }
        finish(level, cos, self);
    }
}

stages! {
    /// The share that a body has at each point, and the directions that fall into it.
    fn aim [T: Target][T] (
        caster: &T,
        numbered: (usize, f64),
        surface: (&Rows3, &Rows3, &Rows3),
        u: [&[f64; W]; 2],
        drawn: &mut Drawn,
    ) {
        let ((number, each), (position, normal, direction)) = (numbered, surface);
        for lane in 0..W {
            let (from, wo) = (position.at(lane), -direction.at(lane));
            let share = share_of(caster, each, from, lambert::toward(normal.at(lane), wo));
            let share = if drawn.diffuse[lane] { share } else { 0.0 };
            let begin = drawn.total.0[lane];
            let takes = is_within(u[0][lane], begin, share);
            let wi = caster.aim(from, [place_within(u[0][lane], begin, share), u[1][lane]]);
            let there = drawn.aimed.at(lane);
            let choose = |a: f64, b: f64| if takes { a } else { b };
            drawn.aimed.set(
                lane,
                Vec3::new(choose(wi.x, there.x), choose(wi.y, there.y), choose(wi.z, there.z)),
            );
            drawn.is_aimed[lane] |= takes;
            drawn.shares[number].0[lane] = share;
            drawn.total.0[lane] = begin + share;
        }
    }

    /// The first numbers of the directions that are left to the cosine.
    fn leave_rest(u1: &[f64; W], drawn: &mut Drawn) {
        for lane in 0..W {
            let total = drawn.total.0[lane];
            drawn.u1.0[lane] = place_within(u1[lane], total, 1.0 - total);
        }
    }

    /// The directions of both kinds and their cosines.
    fn put(surface: (&Rows3, &Rows3, &Rows3), drawn: &mut Drawn, wi: &mut Rows3, cos: &mut Row) {
        let (_, normal, direction) = surface;
        for lane in 0..W {
            let (a, b) = (drawn.aimed.at(lane), wi.at(lane));
            let choose = |a: f64, b: f64| if drawn.is_aimed[lane] { a } else { b };
            let chosen = Vec3::new(choose(a.x, b.x), choose(a.y, b.y), choose(a.z, b.z));
            wi.set(lane, chosen);
            cos.0[lane] = lambert::toward(normal.at(lane), -direction.at(lane)).dot(chosen);
            drawn.factor.0[lane] = 0.0;
        }
    }

    /// What a body adds to the densities.
    fn weigh [T: Target][T] (caster: &T, number: usize, position: &Rows3, wi: &Rows3, drawn: &mut Drawn) {
        for lane in 0..W {
            drawn.factor.0[lane] += density_of(caster, drawn.shares[number].0[lane], position.at(lane), wi.at(lane));
        }
    }

    /// From what bodies have added to the factors.
    fn finish(cos: &Row, drawn: &mut Drawn) {
        for lane in 0..W {
            let of_casters = drawn.factor.0[lane];
            drawn.factor.0[lane] = Mixture { own: lambert::density(cos.0[lane]), part: drawn.total.0[lane], of_casters }.factor(1.0);
        }
    }
}
