//! Directions toward casters of caustics, for the paths that are at diffuse surfaces.

use super::level::{Level, Set, stages};
use super::rows::{Row, Rows3, W};
use crate::bsdf::lambert;
use crate::caustics::{
    Caster, Casters, Image, MOST_TARGETS, Mixture, Shows, Target, View, density_of, is_within, place_within, share_of,
    share_of_image,
};
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
    shares: [Row; MOST_TARGETS],
    is_aimed: [bool; W],
    aimed: Rows3,
}

impl Drawn {
    pub(super) const NONE: Self = Self {
        diffuse: [false; W],
        u1: Row::ZERO,
        factor: Row::ZERO,
        total: Row::ZERO,
        shares: [Row::ZERO; MOST_TARGETS],
        is_aimed: [false; W],
        aimed: Rows3::ZERO,
    };

    /// The direction of a path is this one, if a target `takes` it.
    #[inline(always)]
    fn put(&mut self, lane: usize, (takes, wi): (bool, Vec3<f64>)) {
        let there = self.aimed.at(lane);
        let choose = |a: f64, b: f64| if takes { a } else { b };
        self.aimed.set(lane, Vec3::new(choose(wi.x, there.x), choose(wi.y, there.y), choose(wi.z, there.z)));
        self.is_aimed[lane] |= takes;
    }

    /// Draws the directions that go toward casters.
    #[inline(always)]
    pub(super) fn aim(
        &mut self,
        level: Level,
        casters: &Casters,
        surface: (&Rows3, &Rows3, &Rows3),
        u: [&[f64; W]; 2],
        views: &mut [Views],
    ) {
        let (bodies, each) = casters.bodies_aimed_at();
        let mut taken = Taken { number: [0; W], place: [0.0; W], is: [false; W] };
        for (number, body) in bodies.iter().enumerate() {
            match body {
                Caster::Sphere(round) => portion(level, round, (number, each), surface, u[0], &mut taken, self),
                Caster::Box(body) => portion(level, body, (number, each), surface, u[0], &mut taken, self),
            }
        }
        // Few paths: one by one.
        for lane in 0..W {
            if taken.is[lane] {
                let (from, u) = (surface.0.at(lane), [taken.place[lane], u[1][lane]]);
                let wi = match &bodies[usize::from(taken.number[lane])] {
                    Caster::Sphere(round) => Target::aim(round, from, u),
                    Caster::Box(body) => body.aim(from, u),
                };
                self.put(lane, (true, wi));
            }
        }
        let mut light = Row32([0.0; W]);
        let mut points = Points { from: [Row32([0.0; W]); 3], normal: [Row32([0.0; W]); 3], weight: Row32([0.0; W]) };
        if !views.is_empty() {
            stand(level, surface, &self.diffuse, &mut points);
        }
        for (image, views) in casters.images_aimed_at().iter().zip(views.iter_mut()) {
            match image {
                Image::Mirrored(image) => look(level, image, &points, views, &mut light),
                Image::Refracted(image) => look(level, image, &points, views, &mut light),
            }
        }
        if !views.is_empty() {
            let mut taken = Taken { number: [0; W], place: [0.0; W], is: [false; W] };
            for (number, views) in views.iter().enumerate() {
                deal(level, (&views.weight, &light), (number, casters.share), u[0], &mut taken, self);
            }
            // One direction a path, whichever image has taken it.
            let mut chosen = Views::NONE;
            for lane in 0..W {
                chosen.set(lane, &views[usize::from(taken.number[lane]) % views.len()].at(lane));
            }
            aim_at_image(level, &chosen, &taken, u[1], self);
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
        views: &[Views],
        (wi, cos): (&mut Rows3, &mut Row),
    ) {
        put(level, surface, self, wi, cos);
        for (number, body) in casters.bodies_aimed_at().0.iter().enumerate() {
            match body {
                Caster::Sphere(round) => weigh(level, round, number, surface.0, wi, self),
                Caster::Box(body) => weigh(level, body, number, surface.0, wi, self),
            }
        }
        for (number, views) in views.iter().enumerate() {
            weigh_image(level, views, number, wi, self);
        }
        finish(level, cos, self);
    }
}

/// The target that has taken each path, and where in its share its number is.
pub(super) struct Taken {
    number: [u8; W],
    place: [f64; W],
    is: [bool; W],
}

/// A number in single precision for each path.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct Row32([f32; W]);

/// The points that paths are at, and 1 for those whose directions may be drawn toward images.
pub(super) struct Points {
    from: [Row32; 3],
    normal: [Row32; 3],
    weight: Row32,
}

/// The views of an image from the points that paths are at.
#[derive(Clone, Copy)]
pub(super) struct Views {
    axis: [Row32; 3],
    in_plane: [Row32; 3],
    half: [Row32; 2],
    weight: Row32,
}

impl Views {
    pub(super) const NONE: Self = {
        let zero = Row32([0.0; W]);
        Self { axis: [zero; 3], in_plane: [zero; 3], half: [zero; 2], weight: zero }
    };

    #[inline(always)]
    fn at(&self, lane: usize) -> View {
        let Self { axis: [ax, ay, az], in_plane: [x, y, z], half: [h, k], weight } = self;
        View {
            axis: Vec3::new(ax.0[lane], ay.0[lane], az.0[lane]),
            in_plane: Vec3::new(x.0[lane], y.0[lane], z.0[lane]),
            half: [h.0[lane], k.0[lane]],
            weight: weight.0[lane],
        }
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, view: &View) {
        let Self { axis: [ax, ay, az], in_plane: [x, y, z], half: [h, k], weight } = self;
        (ax.0[lane], ay.0[lane], az.0[lane]) = (view.axis.x, view.axis.y, view.axis.z);
        (x.0[lane], y.0[lane], z.0[lane]) = (view.in_plane.x, view.in_plane.y, view.in_plane.z);
        (h.0[lane], k.0[lane], weight.0[lane]) = (view.half[0], view.half[1], view.weight);
    }
}

stages! {
    /// The share that a body has at each point, and the paths that it takes.
    fn portion [T: Target][T] (
        caster: &T,
        numbered: (usize, f64),
        surface: (&Rows3, &Rows3, &Rows3),
        u1: &[f64; W],
        taken: &mut Taken,
        drawn: &mut Drawn,
    ) {
        let ((number, each), (position, normal, direction)) = (numbered, surface);
        for lane in 0..W {
            let (from, wo) = (position.at(lane), -direction.at(lane));
            let share = share_of(caster, each, from, lambert::toward(normal.at(lane), wo));
            let share = if drawn.diffuse[lane] { share } else { 0.0 };
            let begin = drawn.total.0[lane];
            let takes = is_within(u1[lane], begin, share);
            let place = place_within(u1[lane], begin, share);
            taken.number[lane] = if takes { number as u8 } else { taken.number[lane] };
            taken.place[lane] = if takes { place } else { taken.place[lane] };
            taken.is[lane] |= takes;
            drawn.shares[number].0[lane] = share;
            drawn.total.0[lane] = begin + share;
        }
    }

    /// The points in single precision.
    fn stand(surface: (&Rows3, &Rows3, &Rows3), diffuse: &[bool; W], points: &mut Points) {
        let (position, normal, direction) = surface;
        for lane in 0..W {
            let from: Vec3<f32> = position.at(lane).cast();
            let n: Vec3<f32> = lambert::toward(normal.at(lane), -direction.at(lane)).cast();
            let Points { from: [x, y, z], normal: [nx, ny, nz], weight } = points;
            (x.0[lane], y.0[lane], z.0[lane]) = (from.x, from.y, from.z);
            (nx.0[lane], ny.0[lane], nz.0[lane]) = (n.x, n.y, n.z);
            weight.0[lane] = if diffuse[lane] { 1.0 } else { 0.0 };
        }
    }

    /// What the points see of an image, and the sum of what images bring. All of it in single precision: twice as many in a register.
    fn look [T: Shows][T] (image: &T, points: &Points, views: &mut Views, light: &mut Row32) {
        for lane in 0..W {
            let Points { from: [x, y, z], normal: [nx, ny, nz], weight } = points;
            let from = Vec3::new(x.0[lane], y.0[lane], z.0[lane]);
            let view = image.view(from, Vec3::new(nx.0[lane], ny.0[lane], nz.0[lane]));
            let view = View { weight: view.weight * weight.0[lane], ..view };
            views.set(lane, &view);
            light.0[lane] += view.weight;
        }
    }

    /// The share that an image has at each point, and the paths that it takes.
    fn deal(
        weights: (&Row32, &Row32),
        numbered: (usize, f64),
        u1: &[f64; W],
        taken: &mut Taken,
        drawn: &mut Drawn,
    ) {
        let ((weight, light), (number, most)) = (weights, numbered);
        for lane in 0..W {
            let share = share_of_image(weight.0[lane], light.0[lane], most);
            let begin = drawn.total.0[lane];
            let takes = is_within(u1[lane], begin, share);
            let place = place_within(u1[lane], begin, share);
            taken.number[lane] = if takes { number as u8 } else { taken.number[lane] };
            taken.place[lane] = if takes { place } else { taken.place[lane] };
            taken.is[lane] |= takes;
            drawn.shares[number].0[lane] = share;
            drawn.total.0[lane] = begin + share;
        }
    }

    /// The directions of the paths that images have taken.
    fn aim_at_image(chosen: &Views, taken: &Taken, u2: &[f64; W], drawn: &mut Drawn) {
        for lane in 0..W {
            let wi = chosen.at(lane).aim([taken.place[lane], u2[lane]]);
            drawn.put(lane, (taken.is[lane], wi));
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
            let density = caster.density(position.at(lane), wi.at(lane));
            drawn.factor.0[lane] += density_of(drawn.shares[number].0[lane], density);
        }
    }

    /// What an image adds to the densities.
    fn weigh_image(views: &Views, number: usize, wi: &Rows3, drawn: &mut Drawn) {
        for lane in 0..W {
            let density = views.at(lane).density(wi.at(lane));
            drawn.factor.0[lane] += density_of(drawn.shares[number].0[lane], density);
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
