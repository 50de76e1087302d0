//! Directions toward guided targets of caustics, for the paths that are at diffuse surfaces.

use super::level::{Level, stages};
use super::rows::{Mask, Row, Rows3, W, lanes};
use crate::bsdf::lambert;
use crate::guiding::{
    Aimed, Ball, DirectionTarget, Eye, GuidedTarget, GuidedTargets, MAX_SPECULAR_IMAGES, MOST_BODIES, Mixture, Shows,
    SpecularImage, VisibleImages, density_of, is_within, place_within, share_of, specular_image_share,
};
use etalon_geometry::SphereSampler;
use etalon_optics::Vec3;

/// What guided targets make of the directions of a set. Kept from vertex to vertex.
pub(super) struct GuidedDirections {
    /// Whose directions may be drawn toward them.
    pub diffuse: Mask,
    /// The first number of each direction by the cosine.
    pub u1: Row,
    /// What the weight of each direction is to be multiplied by.
    pub factor: Row,
    /// The part of the numbers that guided targets take.
    part: Row,
    bodies: Bodies,
    images: SpecularImages,
}

/// The bodies that paths aim at.
struct Bodies {
    /// The share that each body has.
    shares: [Row; MOST_BODIES],
    /// The paths that one has taken.
    taken: Mask,
}

/// The images that paths aim at; in single precision, twice as many in a register.
pub(super) struct SpecularImages {
    points: Points,
    eyes: Eyes,
    weights: [Row32; MAX_SPECULAR_IMAGES],
    light: Row32,
    /// The share that all have together, and where it begins.
    share: Row,
    begin: Row,
    /// The paths that one has taken, and the directions of those that were not drawn in vain.
    taken: Mask,
    aimed: [Option<Aimed>; W],
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

/// How they look at a ball.
pub(super) struct Eyes {
    toward: [Row32; 3],
    distance: Row32,
    rim: Row32,
    most: Row32,
}

impl Row32 {
    const ZERO: Self = Self([0.0; W]);
}

impl Points {
    #[inline(always)]
    fn at(&self, lane: usize) -> (Vec3<f32>, Vec3<f32>) {
        let Self { from: [x, y, z], normal: [nx, ny, nz], .. } = self;
        (Vec3::new(x.0[lane], y.0[lane], z.0[lane]), Vec3::new(nx.0[lane], ny.0[lane], nz.0[lane]))
    }
}

impl Eyes {
    #[inline(always)]
    fn at(&self, lane: usize) -> Eye {
        let [x, y, z] = &self.toward;
        let toward = Vec3::new(x.0[lane], y.0[lane], z.0[lane]);
        Eye { toward, distance: self.distance.0[lane], rim: self.rim.0[lane], most: self.most.0[lane] }
    }
}

impl SpecularImages {
    /// What a path sees of images.
    #[inline(always)]
    fn seen<'a>(
        &self,
        lane: usize,
        guided_targets: &'a GuidedTargets,
        weights: &'a mut [f32; MAX_SPECULAR_IMAGES],
    ) -> VisibleImages<'a> {
        let images = guided_targets.specular_images_aimed_at();
        for (weight, row) in weights.iter_mut().zip(&self.weights).take(images.len()) {
            *weight = row.0[lane];
        }
        let (from, n) = self.points.at(lane);
        VisibleImages { images, from, n, weights, share: self.share.0[lane] }
    }
}

impl GuidedDirections {
    pub(super) fn new() -> Self {
        let zero = Row32::ZERO;
        Self {
            diffuse: 0,
            u1: Row::ZERO,
            factor: Row::ZERO,
            part: Row::ZERO,
            bodies: Bodies { shares: [Row::ZERO; MOST_BODIES], taken: 0 },
            images: SpecularImages {
                points: Points { from: [zero; 3], normal: [zero; 3], weight: zero },
                eyes: Eyes { toward: [zero; 3], distance: zero, rim: zero, most: zero },
                weights: [zero; MAX_SPECULAR_IMAGES],
                light: zero,
                share: Row::ZERO,
                begin: Row::ZERO,
                taken: 0,
                aimed: [None; W],
            },
        }
    }

    /// Deals out the numbers of directions: to bodies, to images, and to the cosine.
    #[inline(always)]
    pub(super) fn allot(
        &mut self,
        level: Level,
        guided_targets: &GuidedTargets,
        surface: (&Rows3, &Rows3, &Rows3),
        u1: &[f64; W],
    ) {
        (self.part, self.images.light) = (Row::ZERO, Row32::ZERO);
        let (bodies, each) = guided_targets.bodies_aimed_at();
        for (body, shares) in bodies.iter().zip(&mut self.bodies.shares) {
            match body {
                GuidedTarget::Sphere(sphere) => {
                    portion(level, sphere, each, surface, self.diffuse, shares, &mut self.part)
                }
                GuidedTarget::Box(body) => portion(level, body, each, surface, self.diffuse, shares, &mut self.part),
            }
        }
        let images = guided_targets.specular_images_aimed_at();
        if !images.is_empty() {
            stand(level, surface, self.diffuse, &mut self.images.points);
        }
        let SpecularImages { points, eyes, weights, light, .. } = &mut self.images;
        for (number, (image, weights)) in images.iter().zip(weights).enumerate() {
            if number == 0 || images[number - 1].ball != image.ball {
                look(level, &image.ball, points, eyes);
            }
            match image.ball.shows {
                Shows::Mirrored => weigh_mirrored(level, image, points, eyes, weights, light),
                Shows::Refracted(index) => weigh_refracted(level, image, index, points, eyes, weights, light),
            }
        }
        leave_rest(level, guided_targets.share, u1, self);
    }

    /// Draws the directions that are not by the cosine, in place of those that are, and weighs all.
    #[inline(always)]
    pub(super) fn take(
        &mut self,
        level: Level,
        guided_targets: &GuidedTargets,
        surface: (&Rows3, &Rows3, &Rows3),
        u: [&[f64; W]; 2],
        (wi, cos): (&mut Rows3, &mut Row),
    ) {
        let (bodies, _) = guided_targets.bodies_aimed_at();
        let images = guided_targets.specular_images_aimed_at();
        // Few paths: one by one.
        for lane in lanes(self.bodies.taken) {
            let mut begin = 0.0;
            for (body, shares) in bodies.iter().zip(&self.bodies.shares) {
                let share = shares.0[lane];
                if is_within(u[0][lane], begin, share) {
                    let place = place_within(u[0][lane], begin, share);
                    wi.set(lane, body.aim(surface.0.at(lane), [place, u[1][lane]]));
                }
                begin += share;
            }
        }
        let mut weights = [0.0; MAX_SPECULAR_IMAGES];
        for lane in lanes(self.images.taken) {
            let seen = self.images.seen(lane, guided_targets, &mut weights);
            let begin = self.images.begin.0[lane];
            let aimed = seen.aim([place_within(u[0][lane], begin, seen.share), u[1][lane]]);
            if let Some(aimed) = &aimed {
                wi.set(lane, aimed.wi);
            }
            self.images.aimed[lane] = aimed;
        }
        face(level, surface, wi, cos, self);
        for (number, body) in bodies.iter().enumerate() {
            match body {
                GuidedTarget::Sphere(sphere) => {
                    let mut met = [false; W];
                    meet(level, sphere, surface.0, wi, &mut met);
                    for lane in 0..W {
                        let share = self.bodies.shares[number].0[lane];
                        if met[lane] && share > 0.0 {
                            self.factor.0[lane] += density_of(share, sphere.density(surface.0.at(lane), wi.at(lane)));
                        }
                    }
                }
                GuidedTarget::Box(body) => {
                    weigh(level, body, &self.bodies.shares[number], surface.0, wi, &mut self.factor)
                }
            }
        }
        if !images.is_empty() {
            let mut met = [false; W];
            for (number, image) in images.iter().enumerate() {
                if number == 0 || images[number - 1].ball != image.ball {
                    meet_ball(level, &image.ball, &self.images.points, wi, &mut met);
                }
            }
            for lane in lanes(self.diffuse) {
                let aimed = if self.images.taken >> lane & 1 == 1 { self.images.aimed[lane].as_ref() } else { None };
                if met[lane] {
                    let seen = self.images.seen(lane, guided_targets, &mut weights);
                    self.factor.0[lane] += seen.density(wi.at(lane), aimed);
                }
                if self.images.taken >> lane & 1 == 1 && aimed.is_none() {
                    // Drawn in vain.
                    cos.0[lane] = 0.0;
                }
            }
        }
        finish(level, cos, self);
    }
}

stages! {
    /// The share that a body has at each point.
    fn portion [T: DirectionTarget][T] (
        target: &T,
        each: f64,
        surface: (&Rows3, &Rows3, &Rows3),
        diffuse: Mask,
        shares: &mut Row,
        part: &mut Row,
    ) {
        let (position, normal, direction) = surface;
        for lane in 0..W {
            let (from, wo) = (position.at(lane), -direction.at(lane));
            let share = share_of(target, each, from, lambert::toward(normal.at(lane), wo));
            let share = if diffuse >> lane & 1 == 1 { share } else { 0.0 };
            shares.0[lane] = share;
            part.0[lane] += share;
        }
    }

    /// The points in single precision.
    fn stand(surface: (&Rows3, &Rows3, &Rows3), diffuse: Mask, points: &mut Points) {
        let (position, normal, direction) = surface;
        for lane in 0..W {
            let from: Vec3<f32> = position.at(lane).cast();
            let n: Vec3<f32> = lambert::toward(normal.at(lane), -direction.at(lane)).cast();
            let Points { from: [x, y, z], normal: [nx, ny, nz], weight } = points;
            (x.0[lane], y.0[lane], z.0[lane]) = (from.x, from.y, from.z);
            (nx.0[lane], ny.0[lane], nz.0[lane]) = (n.x, n.y, n.z);
            weight.0[lane] = if diffuse >> lane & 1 == 1 { 1.0 } else { 0.0 };
        }
    }

    /// How the points look at a ball.
    fn look(ball: &Ball, points: &Points, eyes: &mut Eyes) {
        let Eyes { toward: [x, y, z], distance, rim, most } = eyes;
        for lane in 0..W {
            let eye = ball.eye(points.at(lane).0);
            (x.0[lane], y.0[lane], z.0[lane]) = (eye.toward.x, eye.toward.y, eye.toward.z);
            (distance.0[lane], rim.0[lane], most.0[lane]) = (eye.distance, eye.rim, eye.most);
        }
    }

    /// What an image that a ball mirrors brings to each point.
    fn weigh_mirrored(image: &SpecularImage, points: &Points, eyes: &Eyes, weights: &mut Row32, light: &mut Row32) {
        for lane in 0..W {
            let weight = image.weight_mirrored(&eyes.at(lane), points.at(lane).1) * points.weight.0[lane];
            weights.0[lane] = weight;
            light.0[lane] += weight;
        }
    }

    /// The same of one that is seen through a ball.
    fn weigh_refracted(
        image: &SpecularImage,
        index: f32,
        points: &Points,
        eyes: &Eyes,
        weights: &mut Row32,
        light: &mut Row32,
    ) {
        for lane in 0..W {
            let view = image.view_refracted(index, &eyes.at(lane), points.at(lane).1);
            let weight = view.weight * points.weight.0[lane];
            weights.0[lane] = weight;
            light.0[lane] += weight;
        }
    }

    /// What is left to images and to the cosine.
    fn leave_rest(most: f64, u1: &[f64; W], guided_directions: &mut GuidedDirections) {
        let GuidedDirections { part, bodies, images, .. } = guided_directions;
        let (mut by_bodies, mut by_images) = ([false; W], [false; W]);
        for lane in 0..W {
            let begin = part.0[lane];
            let share = specular_image_share(images.light.0[lane], most);
            let all = begin + share;
            by_bodies[lane] = u1[lane] < begin;
            by_images[lane] = u1[lane] < all;
            (images.begin.0[lane], images.share.0[lane]) = (begin, share);
            part.0[lane] = all;
            guided_directions.u1.0[lane] = place_within(u1[lane], all, 1.0 - all);
        }
        (bodies.taken, images.taken) = (0, 0);
        for lane in 0..W {
            bodies.taken |= Mask::from(by_bodies[lane]) << lane;
            images.taken |= Mask::from(by_images[lane]) << lane;
        }
        images.taken &= !bodies.taken;
    }

    /// The cosines of directions.
    fn face(surface: (&Rows3, &Rows3, &Rows3), wi: &Rows3, cos: &mut Row, guided_directions: &mut GuidedDirections) {
        let (_, normal, direction) = surface;
        for lane in 0..W {
            cos.0[lane] = lambert::toward(normal.at(lane), -direction.at(lane)).dot(wi.at(lane));
            guided_directions.factor.0[lane] = 0.0;
        }
    }

    /// What a body adds to the densities.
    fn weigh [T: DirectionTarget][T] (target: &T, shares: &Row, position: &Rows3, wi: &Rows3, sum: &mut Row) {
        for lane in 0..W {
            sum.0[lane] += density_of(shares.0[lane], target.density(position.at(lane), wi.at(lane)));
        }
    }

    /// Whether directions meet a sphere.
    fn meet(sphere: &SphereSampler, position: &Rows3, wi: &Rows3, met: &mut [bool; W]) {
        for lane in 0..W {
            met[lane] = sphere.is_met(position.at(lane), wi.at(lane));
        }
    }

    /// Whether directions meet a ball that shows lamps, or have met one before.
    fn meet_ball(ball: &Ball, points: &Points, wi: &Rows3, met: &mut [bool; W]) {
        for lane in 0..W {
            met[lane] |= ball.is_met(points.at(lane).0, wi.at(lane).cast());
        }
    }

    /// From what guided targets have added to the factors.
    fn finish(cos: &Row, guided_directions: &mut GuidedDirections) {
        for lane in 0..W {
            let of_guided_targets = guided_directions.factor.0[lane];
            let own = lambert::density(cos.0[lane]);
            guided_directions.factor.0[lane] = Mixture { own, part: guided_directions.part.0[lane], of_guided_targets }.factor(1.0);
        }
    }
}
