//! An emitter within something that moves: at each time it is the light that it would be if it stood still there.
//!
//! A parallelogram or triangle is put in its place and sampled there. Any other shape is only ever placed by similarities; they
//! leave solid angles as they are, so it is sampled in its own coordinates, seen from where the reference point is in them.

use super::{AreaLight, Emitter, LightSample, LightSource, Target};
use crate::spectral::PathSpectrum;
use etalon_geometry::{Motion, Placement, PlanarSampler, ShapeSampler};
use etalon_optics::Vec3;
use std::sync::Arc;

/// One of the placements of an emitter within each other.
#[derive(Clone, Debug)]
pub(crate) enum Link {
    /// Stands still.
    Still(Placement),
    /// Moves.
    Moving(Arc<Motion>),
}

/// An emitter that moves.
#[derive(Clone, Debug)]
pub struct MovingLight {
    /// How it is placed, the outermost first.
    chain: Arc<[Link]>,
    /// In its own coordinates.
    own: Box<AreaLight>,
}

/// From an emitter's own coordinates to the frame at one time: p ↦ L·p + T.
struct Place {
    /// Rows of L.
    linear: [Vec3<f64>; 3],
    translation: Vec3<f64>,
}

impl Place {
    fn vector(&self, v: Vec3<f64>) -> Vec3<f64> {
        Vec3::from_array(self.linear.map(|row| row.dot(v)))
    }

    fn point(&self, p: Vec3<f64>) -> Vec3<f64> {
        self.vector(p) + self.translation
    }

    /// Lᵀ·v.
    fn transposed(&self, v: Vec3<f64>) -> Vec3<f64> {
        self.linear[0] * v.x + self.linear[1] * v.y + self.linear[2] * v.z
    }

    /// The square of the factor of a similarity.
    fn square(&self) -> f64 {
        self.linear.iter().map(|row| row.length_squared()).sum::<f64>() / 3.0
    }

    /// A point of the frame in the emitter's own coordinates, of a similarity.
    fn inward(&self, p: Vec3<f64>) -> Vec3<f64> {
        self.transposed(p - self.translation) / self.square()
    }

    fn planar(&self, own: &PlanarSampler) -> PlanarSampler {
        let edges = own.edges.map(|edge| self.vector(edge));
        let across = edges[0].cross(edges[1]);
        let twice = across.length();
        // A map that mirrors turns the product of the edges about; the outward side stays outward.
        let mirrors = self.linear[0].cross(self.linear[1]).dot(self.linear[2]) < 0.0;
        let turned = own.edges[0].cross(own.edges[1]).dot(own.normal) < 0.0;
        let side = if mirrors != turned { -1.0 } else { 1.0 };
        PlanarSampler {
            corner: self.point(own.corner),
            edges,
            normal: across * (side / twice),
            area: if own.half { 0.5 * twice } else { twice },
            ..*own
        }
    }
}

impl MovingLight {
    /// The light `own` in its own coordinates, placed by a chain of placements, the outermost first.
    pub(crate) fn new(chain: Arc<[Link]>, own: AreaLight) -> Self {
        Self { chain, own: Box::new(own) }
    }

    fn place(&self, time: f64) -> Place {
        let nowhere = Place {
            linear: [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)],
            translation: Vec3::ZERO,
        };
        self.chain.iter().rev().fold(nowhere, |inner, link| {
            let moved;
            let outer = match link {
                Link::Still(placement) => placement,
                Link::Moving(motion) => {
                    moved = motion.at(time);
                    &moved
                }
            };
            let [a, b, c] = inner.linear;
            Place {
                linear: outer.linear().map(|row| a * row.x + b * row.y + c * row.z),
                translation: outer.point(inner.translation),
            }
        })
    }

    /// The area in the middle of the shutter's time over that in its own coordinates.
    fn area_factor(&self) -> f64 {
        let place = self.place(0.5);
        match &self.own.shape {
            ShapeSampler::Planar(own) => place.planar(own).area / own.area,
            _ => place.square(),
        }
    }
}

impl LightSource for MovingLight {
    fn sample(&self, from: Vec3<f64>, u: [f64; 2], time: f64) -> Option<LightSample> {
        let place = self.place(time);
        if let ShapeSampler::Planar(own) = &self.own.shape {
            return self.own.emitter.sample(&place.planar(own).sample(from, u));
        }
        let sample = self.own.sample(place.inward(from), u, time)?;
        let target = match sample.target {
            Target::Point(point) => Target::Point(place.point(point)),
            Target::Infinity => Target::Infinity,
        };
        Some(LightSample { wi: place.vector(sample.wi).normalized(), target, ..sample })
    }

    fn density(&self, from: Vec3<f64>, wi: Vec3<f64>, time: f64) -> f64 {
        let place = self.place(time);
        match &self.own.shape {
            ShapeSampler::Planar(own) => self.own.emitter.density(&place.planar(own).density(from, wi)),
            _ => self.own.density(place.inward(from), place.transposed(wi).normalized(), time),
        }
    }

    fn spectrum(&self) -> &PathSpectrum {
        self.own.spectrum()
    }

    fn emitter(&self) -> Option<&Emitter> {
        self.own.emitter()
    }

    fn power_factor(&self, scene_radius: f64) -> f64 {
        self.own.power_factor(scene_radius) * self.area_factor()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Affine;
    use crate::light::Light;
    use crate::mis::Density;
    use crate::spectral::PathSpectrum;
    use etalon_geometry::{Cylinder, Disk, Parallelogram, Pose, Primitive, PrimitiveId, Sphere, Triangle};
    use proptest::prelude::*;

    fn emitter(front: bool, back: bool) -> Emitter {
        Emitter {
            radiance: PathSpectrum::Constant(1.0).into(),
            front,
            back,
            surface: PrimitiveId(3).into(),
            image: None,
        }
    }

    fn light(shape: &Primitive, emitter: Emitter) -> AreaLight {
        AreaLight::new(shape, emitter).unwrap()
    }

    fn shapes() -> [Primitive; 5] {
        let v = Vec3::new;
        [
            Sphere::new(v(0.5, 0.0, 0.2), 0.4).unwrap().into(),
            Disk::new(v(-0.5, 0.3, 0.0), v(0.0, 0.6, 0.8), 0.7).unwrap().into(),
            Cylinder::new(v(0.0, 0.0, 0.0), v(0.5, 0.4, 0.3), 0.2, true).unwrap().into(),
            Parallelogram::new(v(0.0, 0.0, 0.0), v(1.0, 0.2, 0.0), v(0.1, 0.8, 0.3)).unwrap().into(),
            Triangle::new(v(0.0, 0.0, 0.0), v(1.0, 0.2, 0.0), v(0.1, 0.8, 0.3)).unwrap().into(),
        ]
    }

    /// Two motions and a placement that mirrors within each other; similarities, or a stretch of what may be stretched.
    fn chain(turn: f64, stretch: f64) -> Arc<[Link]> {
        let rows = |m: [[f64; 3]; 3]| m.map(Vec3::from_array);
        let (s, c) = turn.sin_cos();
        let pose = |time, rotation, scale: [f64; 3], x| Pose {
            time,
            translation: Vec3::new(x, 1.0, -2.0),
            rotation: rows(rotation),
            stretch: rows([[scale[0], 0.0, 0.0], [0.0, scale[1], 0.0], [0.0, 0.0, scale[2]]]),
        };
        let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let about_z = [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]];
        let about_x = [[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]];
        let outer = [pose(0.0, identity, [1.0; 3], 0.0), pose(1.0, about_z, [2.0, 2.0, 2.0 * stretch], 3.0)];
        let inner = [pose(-1.0, about_x, [0.5; 3], 1.0), pose(2.0, identity, [1.0, stretch, 1.0], 0.0)];
        let mirror = Placement::new([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], [0.3, 0.0, 0.0]).unwrap();
        let moving = |poses: &[Pose]| Link::Moving(Arc::new(Motion::new(poses).unwrap()));
        [moving(&outer), Link::Still(mirror), moving(&inner)].into()
    }

    proptest! {
        /// At each time it samples as the light does that stands still there, and its density is that one's; a light at the
        /// opening of the shutter is another.
        #[test]
        fn at_each_time_it_is_the_light_that_stands_still_there(
            shape in 0_usize..5, turn in 0.2..3.0_f64, time in 0.1..1.0_f64, u in [0.0..1.0_f64, 0.0..1.0_f64],
            from in [-4.0..4.0_f64, -4.0..4.0_f64, -4.0..4.0_f64], sides in 0..3_u8,
        ) {
            let round = shape < 3;
            let chain = chain(turn, if round { 1.0 } else { 1.7 });
            let emitter = || emitter(sides != 1, sides != 0);
            let own = shapes()[shape].clone();
            let moving = Light::Moving(MovingLight::new(chain.clone(), light(&own, emitter())));
            let still = |time: f64| {
                let to_frame = chain.iter().fold(Affine::IDENTITY, |outer, link| match link {
                    Link::Still(placement) => outer.after(placement),
                    Link::Moving(motion) => outer.after(&motion.at(time)),
                });
                Light::Area(light(&to_frame.shape(&own).unwrap(), emitter()))
            };
            let (there, from) = (still(time), Vec3::from_array(from));
            if let Some(sample) = moving.sample(from, u, time) {
                let Density::SolidAngle(density) = sample.density else { panic!("a surface has a density") };
                let agrees = |a: f64, b: f64| (a - b).abs() <= 1e-6 * a.abs();
                prop_assert!((sample.wi.length() - 1.0).abs() < 1e-14);
                // Along a surface, rounding decides what is seen of it.
                let expected = there.density(from, sample.wi, 0.0);
                prop_assert!(agrees(density, expected) || expected > 1e6, "{} {}", density, expected);
                prop_assert!(agrees(density, moving.density(from, sample.wi, time)) || density > 1e6);
                let Target::Point(target) = sample.target else { panic!("a surface is somewhere") };
                prop_assert!(((target - from).normalized() - sample.wi).length() < 1e-9);
            }
            if !round {
                // The same numbers choose the same point, up to the order of a mirrored light's edges.
                let theirs = there.sample(from, u, 0.0).is_some();
                prop_assert_eq!(moving.sample(from, u, time).is_some(), theirs);
            }
        }
    }

    /// The mutant: a light where it was as the shutter opened.
    #[test]
    fn where_it_was_as_the_shutter_opened_is_seen_to_be_wrong() {
        let from = Vec3::new(1.0, -2.0, 3.0);
        for shape in shapes() {
            let moving = Light::Moving(MovingLight::new(chain(1.0, 1.0), light(&shape, emitter(true, true))));
            let sample = moving.sample(from, [0.3, 0.6], 0.7).unwrap();
            let Density::SolidAngle(density) = sample.density else { panic!("a surface has a density") };
            let stale = moving.density(from, sample.wi, 0.0);
            assert!((stale / density - 1.0).abs() > 0.05, "{stale} {density}");
        }
    }
}
