//! An area light of ours as the oracle sees one.

use etalon_geometry::{Geometry, Primitive, PrimitiveId, Ray};
use etalon_optics::Vec3;
use etalon_oracle::{
    laws,
    quadrature::Cone,
    subjects::{Emits, Emitted},
    truths::{lambert_polygon, sphere_irradiance},
};
use etalon_transport::{
    light::{AreaLight, Emitter, Light, Target},
    mis,
    spectral::PathSpectrum,
};

/// One of our area lights, alone in the world.
pub(crate) struct Lamp {
    light: Light,
    geometry: Geometry,
    /// A sphere around the light.
    center: Vec3<f64>,
    radius: f64,
    form: Form,
}

/// What closed forms need to know of a lamp.
pub(crate) enum Form {
    Sphere,
    Polygon(Vec<Vec3<f64>>),
    /// None is held to one here.
    Other,
}

impl Lamp {
    pub(crate) fn new(shape: impl Into<Primitive>, (center, radius): (Vec3<f64>, f64), form: Form) -> Self {
        let shape = shape.into();
        let emitter = Emitter {
            radiance: PathSpectrum::Constant(2.0).into(),
            front: true,
            back: true,
            surface: PrimitiveId(0).into(),
            image: None,
        };
        let light = Light::Area(AreaLight::new(&shape, emitter).unwrap());
        Self { light, geometry: Geometry::build(vec![shape]).unwrap(), center, radius, form }
    }

    pub(crate) fn is_met(&self, from_m: [f64; 3], wi: [f64; 3]) -> bool {
        self.geometry.closest_hit(&Ray::free(Vec3::from_array(from_m), Vec3::from_array(wi))).is_some()
    }
}

impl Emits for Lamp {
    fn sample(&self, from_m: [f64; 3], u: [f64; 2]) -> Option<Emitted> {
        let s = self.light.sample(Vec3::from_array(from_m), u, 0.0)?;
        let (mis::Density::SolidAngle(pdf), Target::Point(target)) = (s.density, s.target) else {
            panic!("an area light has neither a delta nor an infinite distance");
        };
        let distance_m = (target - Vec3::from_array(from_m)).length();
        let radiance = self.light.spectrum().eval(550.0) * s.scale;
        Some(Emitted { wi: s.wi.to_array(), distance_m, radiance, pdf })
    }

    fn pdf(&self, from_m: [f64; 3], wi: [f64; 3]) -> f64 {
        if self.is_met(from_m, wi) {
            self.light.density(Vec3::from_array(from_m), Vec3::from_array(wi), 0.0)
        } else {
            0.0
        }
    }

    fn radiance(&self, from_m: [f64; 3], wi: [f64; 3]) -> f64 {
        if self.is_met(from_m, wi) { 2.0 } else { 0.0 }
    }

    fn extent(&self, from_m: [f64; 3]) -> Cone {
        let toward = self.center - Vec3::from_array(from_m);
        if toward.length() <= self.radius {
            return Cone::SPHERE;
        }
        Cone::new(toward.to_array(), (self.radius / toward.length()).asin())
    }

    fn solid_angle_sr(&self, from_m: [f64; 3]) -> Option<f64> {
        let toward = |v: &Vec3<f64>| (*v - Vec3::from_array(from_m)).to_array();
        match &self.form {
            Form::Sphere => {
                Some(laws::sphere_solid_angle(self.radius, (self.center - Vec3::from_array(from_m)).length()))
            }
            Form::Polygon(corners) => Some(
                (2..corners.len())
                    .map(|i| laws::triangle_solid_angle([&corners[0], &corners[i - 1], &corners[i]].map(toward)))
                    .sum(),
            ),
            Form::Other => None,
        }
    }

    fn irradiance(&self, from_m: [f64; 3], normal: [f64; 3]) -> Option<f64> {
        let toward = self.center - Vec3::from_array(from_m);
        match &self.form {
            Form::Sphere if toward.length() < self.radius => Some(2.0 * std::f64::consts::PI),
            Form::Sphere => {
                let tilt = (toward.dot(Vec3::from_array(normal)) / toward.length()).clamp(-1.0, 1.0).acos();
                Some(2.0 * sphere_irradiance(self.radius, toward.length(), tilt))
            }
            Form::Polygon(corners) => {
                let seen: Vec<_> = corners.iter().map(|c| (*c - Vec3::from_array(from_m)).to_array()).collect();
                Some(2.0 * lambert_polygon(&seen, normal))
            }
            Form::Other => None,
        }
    }
}
