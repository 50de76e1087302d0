//! Lights with a row form, one for each path, and what paths see of them.

use super::level::{Level, stages};
use super::rows::{Mask, Row, Rows3, W};
use crate::light::{Aim, Flat, Light, Round};
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
        if let Some(flat) = light.flat() {
            self.mask |= 1 << lane;
            self.set(lane, &flat);
        } else if let Some(disk) = light.disk() {
            self.disks |= 1 << lane;
            self.set(lane, &disk);
        }
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, light: &Flat) {
        self.corner.set(lane, light.corner);
        self.edges[0].set(lane, light.edges[0]);
        self.edges[1].set(lane, light.edges[1]);
        self.normal.set(lane, light.normal);
        self.area.0[lane] = light.area;
        (self.half[lane], self.front[lane], self.back[lane]) = (light.half, light.front, light.back);
    }

    #[inline(always)]
    fn at(&self, lane: usize) -> Flat {
        Flat {
            corner: self.corner.at(lane),
            edges: [self.edges[0].at(lane), self.edges[1].at(lane)],
            normal: self.normal.at(lane),
            area: self.area.0[lane],
            half: self.half[lane],
            front: self.front[lane],
            back: self.back[lane],
        }
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
        if let Some(light) = light.round() {
            self.mask |= 1 << lane;
            self.centre.set(lane, light.centre);
            (self.radius.0[lane], self.front[lane]) = (light.radius, light.front);
        }
    }
}

impl LightSamples {
    pub(super) const NONE: Self = Self { point: Rows3::ZERO, wi: Rows3::ZERO, density: Row::ZERO, lit: [false; W] };

    #[inline(always)]
    fn put(&mut self, lane: usize, aim: &Aim) {
        self.point.set(lane, aim.point);
        self.wi.set(lane, aim.wi);
        self.density.0[lane] = aim.density;
        self.lit[lane] = aim.lit;
    }

    #[inline(always)]
    pub(super) fn at(&self, lane: usize) -> Aim {
        Aim { point: self.point.at(lane), wi: self.wi.at(lane), density: self.density.0[lane], lit: self.lit[lane] }
    }
}

/// The first if `condition` holds, else the second, without a branch.
#[inline(always)]
fn choose_aim(condition: bool, a: &Aim, b: &Aim) -> Aim {
    let number = |a: f64, b: f64| if condition { a } else { b };
    let vector = |a: Vec3<f64>, b: Vec3<f64>| Vec3::new(number(a.x, b.x), number(a.y, b.y), number(a.z, b.z));
    Aim {
        point: vector(a.point, b.point),
        wi: vector(a.wi, b.wi),
        density: number(a.density, b.density),
        lit: (condition & a.lit) | (!condition & b.lit),
    }
}

stages! {
    /// Points of lights as they are seen.
    fn aim(from: &Rows3, u: [&[f64; W]; 2], lights: &PlanarLights, light_samples: &mut LightSamples) {
        for lane in 0..W {
            light_samples.put(lane, &lights.at(lane).aim(from.at(lane), [u[0][lane], u[1][lane]]));
        }
    }

    /// Points of disks as they are seen, in place of those that are there.
    fn aim_at_disks(from: &Rows3, u: [&[f64; W]; 2], lights: &PlanarLights, light_samples: &mut LightSamples) {
        for lane in 0..W {
            let aim = lights.at(lane).aim_at_disk(from.at(lane), [u[0][lane], u[1][lane]]);
            light_samples.put(lane, &choose_aim(lights.disks >> lane & 1 == 1, &aim, &light_samples.at(lane)));
        }
    }

    /// Points of spheres as they are seen from outside, in place of those that are there; and who is outside.
    fn aim_at_rounds(from: &Rows3, u: [&[f64; W]; 2], lights: &SphereLights, light_samples: &mut LightSamples, outside: &mut [bool; W]) {
        for lane in 0..W {
            let (centre, radius) = (lights.centre.at(lane), lights.radius.0[lane]);
            let round = Round { centre, radius, front: lights.front[lane] };
            let aim = round.aim(from.at(lane), [u[0][lane], u[1][lane]]);
            outside[lane] = round.is_outside(from.at(lane));
            light_samples.put(lane, &choose_aim(lights.mask >> lane & 1 == 1, &aim, &light_samples.at(lane)));
        }
    }
}
