//! Lights with a row form, one for each path, and what paths see of them.

use super::level::{Level, stages};
use super::rows::{Mask, Row, Rows3, W};
use crate::light::{Light, LightSample};
use etalon_geometry::{PlanarSampler, ShapeSample, ShapeSampler, SphereSampler, SurfaceId};
use etalon_optics::Vec3;

/// Flat lights, one for each path.
pub(super) struct PlanarLights {
    /// Which of them are parallelograms or triangles, and which are disks.
    pub mask: Mask,
    pub disks: Mask,
    corner: Rows3,
    edges: [Rows3; 2],
    normal: Rows3,
    area: Row,
    half: [bool; W],
    front: [bool; W],
    back: [bool; W],
}

/// Spheres that shine, one for each path.
pub(super) struct SphereLights {
    /// Which of them are spheres at all.
    pub mask: Mask,
    centre: Rows3,
    radius: Row,
    /// Whether their outside emits.
    front: [bool; W],
}

/// What paths see of a light.
pub(super) struct LightSamples {
    pub point: Rows3,
    pub wi: Rows3,
    pub density: Row,
    lit: [bool; W],
}

impl PlanarLights {
    pub(super) const NONE: Self = Self {
        mask: 0,
        disks: 0,
        corner: Rows3::ZERO,
        edges: [Rows3::ZERO; 2],
        normal: Rows3::ZERO,
        area: Row::ZERO,
        half: [false; W],
        front: [false; W],
        back: [false; W],
    };

    #[inline(always)]
    pub(super) fn forget(&mut self, lane: usize) {
        self.mask &= !(1 << lane);
        self.disks &= !(1 << lane);
    }

    /// The light that a path looks at, if it is flat.
    #[inline(always)]
    pub(super) fn put(&mut self, lane: usize, light: &Light) {
        let Some(light) = light.area() else { return };
        match &light.shape {
            ShapeSampler::Planar(shape) => {
                self.mask |= 1 << lane;
                self.set(lane, shape);
            }
            ShapeSampler::Disk(disk) => {
                self.disks |= 1 << lane;
                self.set(lane, &disk.sampler());
            }
            _ => return,
        }
        (self.front[lane], self.back[lane]) = (light.emitter.front, light.emitter.back);
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, shape: &PlanarSampler) {
        self.corner.set(lane, shape.corner);
        self.edges[0].set(lane, shape.edges[0]);
        self.edges[1].set(lane, shape.edges[1]);
        self.normal.set(lane, shape.normal);
        self.area.0[lane] = shape.area;
        self.half[lane] = shape.half;
    }

    #[inline(always)]
    fn at(&self, lane: usize) -> PlanarSampler {
        PlanarSampler {
            corner: self.corner.at(lane),
            edges: [self.edges[0].at(lane), self.edges[1].at(lane)],
            normal: self.normal.at(lane),
            area: self.area.0[lane],
            half: self.half[lane],
        }
    }

    /// Whether a sample sees a side that emits.
    #[inline(always)]
    fn is_lit(&self, lane: usize, sample: &ShapeSample) -> bool {
        sample.valid & if sample.front { self.front[lane] } else { self.back[lane] }
    }
}

impl SphereLights {
    pub(super) const NONE: Self = Self { mask: 0, centre: Rows3::ZERO, radius: Row::ZERO, front: [false; W] };

    #[inline(always)]
    pub(super) fn forget(&mut self, lane: usize) {
        self.mask &= !(1 << lane);
    }

    /// The light that a path looks at, if it is a sphere.
    #[inline(always)]
    pub(super) fn put(&mut self, lane: usize, light: &Light) {
        let Some(light) = light.area() else { return };
        if let ShapeSampler::Sphere(sphere) = &light.shape {
            let SphereSampler { centre, radius } = sphere.sampler();
            self.mask |= 1 << lane;
            self.centre.set(lane, centre);
            (self.radius.0[lane], self.front[lane]) = (radius, light.emitter.front);
        }
    }

    #[inline(always)]
    fn at(&self, lane: usize) -> SphereSampler {
        SphereSampler { centre: self.centre.at(lane), radius: self.radius.0[lane] }
    }
}

impl LightSamples {
    pub(super) const NONE: Self = Self { point: Rows3::ZERO, wi: Rows3::ZERO, density: Row::ZERO, lit: [false; W] };

    #[inline(always)]
    fn put(&mut self, lane: usize, sample: &ShapeSample, lit: bool) {
        self.point.set(lane, sample.point);
        self.wi.set(lane, sample.wi);
        self.density.0[lane] = sample.density;
        self.lit[lane] = lit;
    }

    /// The same if `condition` holds, without a branch.
    #[inline(always)]
    fn put_if(&mut self, condition: bool, lane: usize, sample: &ShapeSample, lit: bool) {
        let number = |a: f64, b: f64| if condition { a } else { b };
        let vector = |a: Vec3<f64>, b: Vec3<f64>| Vec3::new(number(a.x, b.x), number(a.y, b.y), number(a.z, b.z));
        self.point.set(lane, vector(sample.point, self.point.at(lane)));
        self.wi.set(lane, vector(sample.wi, self.wi.at(lane)));
        self.density.0[lane] = number(sample.density, self.density.0[lane]);
        self.lit[lane] = (condition & lit) | (!condition & self.lit[lane]);
    }

    /// What a path sees of the light of this surface; `None` where that is dark.
    #[inline(always)]
    pub(super) fn sample(&self, lane: usize, surface: SurfaceId) -> Option<LightSample> {
        let (point, wi, density) = (self.point.at(lane), self.wi.at(lane), self.density.0[lane]);
        self.lit[lane].then_some(LightSample::on_surface(point, wi, density, surface))
    }
}

stages! {
    /// Points of lights as they are seen.
    fn aim(from: &Rows3, u: [&[f64; W]; 2], lights: &PlanarLights, light_samples: &mut LightSamples) {
        for lane in 0..W {
            let sample = lights.at(lane).sample(from.at(lane), [u[0][lane], u[1][lane]]);
            light_samples.put(lane, &sample, lights.is_lit(lane, &sample));
        }
    }

    /// Points of disks as they are seen, in place of those that are there.
    fn aim_at_disks(from: &Rows3, u: [&[f64; W]; 2], lights: &PlanarLights, light_samples: &mut LightSamples) {
        for lane in 0..W {
            let sample = lights.at(lane).sample_disk(from.at(lane), [u[0][lane], u[1][lane]]);
            light_samples.put_if(lights.disks >> lane & 1 == 1, lane, &sample, lights.is_lit(lane, &sample));
        }
    }

    /// Points of spheres as they are seen from outside, in place of those that are there; and who is outside.
    fn aim_at_spheres(from: &Rows3, u: [&[f64; W]; 2], lights: &SphereLights, light_samples: &mut LightSamples, outside: &mut [bool; W]) {
        for lane in 0..W {
            let sphere = lights.at(lane);
            let sample = sphere.sample(from.at(lane), [u[0][lane], u[1][lane]]);
            outside[lane] = sphere.is_outside(from.at(lane));
            light_samples.put_if(lights.mask >> lane & 1 == 1, lane, &sample, lights.front[lane] & sample.valid);
        }
    }
}
