//! Every material and every area light, held to the oracle's whole suite for its kind.

use etalon_geometry::{Disk, Geometry, Parallelogram, Primitive, PrimitiveId, Ray, Sphere, Triangle};
use etalon_optics::{ComplexIndex, Lanes, Real, RefractiveIndex, Spectrum, Vec3, fresnel};
use etalon_oracle::laws::SINGLE;
use etalon_oracle::quadrature::Cone;
use etalon_oracle::subjects::{DeltaLobe, Density, Emits, Emitted, Scattered, Scatters};
use etalon_oracle::{emits_suite, scatters_suite};
use etalon_scene::MaterialKind;
use etalon_transport::bsdf::{Bsdf, Shading};
use etalon_transport::light::{DiskLight, Emitter, Light, ParallelogramLight, SphereLight, Target, TriangleLight};
use etalon_transport::mis;
use etalon_transport::spectral::PathSpectrum;
use std::marker::PhantomData;

const RANGE_NM: [f64; 2] = [380.0, 780.0];
const UP: [f64; 3] = [0.0, 0.0, 1.0];

/// One of our materials in scalar type `R`, with what the oracle cannot ask a [`Bsdf`] for.
struct Material<R> {
    kind: MaterialKind,
    bsdf: Bsdf,
    scalar: PhantomData<R>,
}

impl<R: Real> Material<R> {
    fn new(kind: MaterialKind) -> Self {
        Self { bsdf: Bsdf::new(&kind, RANGE_NM), kind, scalar: PhantomData }
    }

    fn eval(&self, wo: [f64; 3], wi: [f64; 3], wavelength_nm: f64) -> (f64, f64) {
        let lambda = Lanes([wavelength_nm]);
        let (f_cos, pdf) =
            self.bsdf.eval::<R, 1>(&lambda, &Shading::flat(Vec3::from_f64(UP)), Vec3::from_f64(wo), Vec3::from_f64(wi));
        (f_cos[0].to_f64(), pdf[0].to_f64())
    }
}

impl<R: Real> Scatters for Material<R> {
    fn f(&self, wo: [f64; 3], wi: [f64; 3], wavelength_nm: f64) -> f64 {
        let cos = R::from_f64(wi[2]).to_f64().abs();
        if cos == 0.0 { 0.0 } else { self.eval(wo, wi, wavelength_nm).0 / cos }
    }

    fn pdf(&self, wo: [f64; 3], wi: [f64; 3], wavelength_nm: f64) -> f64 {
        self.eval(wo, wi, wavelength_nm).1
    }

    fn sample(&self, wo: [f64; 3], u: [f64; 3], wavelength_nm: f64) -> Option<Scattered> {
        let lambda = Lanes([wavelength_nm]);
        // Rounding up to 1 would leave the interval that a sampler promises.
        let u = u.map(|u| R::from_f64(u).min(R::ONE_MINUS_EPSILON));
        let s = self.bsdf.sample::<R, 1>(&lambda, &Shading::flat(Vec3::from_f64(UP)), Vec3::from_f64(wo), u)?;
        let wi = s.wi.to_f64().to_array();
        let density = match s.density {
            mis::Density::SolidAngle(pdf) => Density::SolidAngle(pdf.to_f64()),
            mis::Density::Delta => {
                let nearest = self.deltas(wo, wavelength_nm).into_iter().min_by(|a, b| {
                    let off = |lobe: &DeltaLobe| (Vec3::from_array(lobe.wi) - Vec3::from_array(wi)).length();
                    off(a).total_cmp(&off(b))
                });
                Density::Delta(nearest.map_or(f64::NAN, |lobe| lobe.probability))
            }
        };
        Some(Scattered { wi, weight: s.weight[0].to_f64(), density })
    }

    /// Written from the laws, not from what `sample` does.
    fn deltas(&self, wo: [f64; 3], wavelength_nm: f64) -> Vec<DeltaLobe> {
        let mirrored = [-wo[0], -wo[1], wo[2]];
        let cos = wo[2].abs().min(1.0);
        match &self.kind {
            MaterialKind::Lambert { .. }
            | MaterialKind::RoughConductor { .. }
            | MaterialKind::RoughDielectric { .. }
            | MaterialKind::Black => Vec::new(),
            MaterialKind::Mirror { reflectance } => {
                vec![DeltaLobe { wi: mirrored, weight: reflectance.eval(wavelength_nm), probability: 1.0 }]
            }
            MaterialKind::Conductor { index } => {
                let (n, k) = index.eval(wavelength_nm);
                let weight = fresnel::conductor(cos, n, k).reflectance;
                vec![DeltaLobe { wi: mirrored, weight, probability: 1.0 }]
            }
            MaterialKind::Dielectric { .. } => {
                let (above, below) = (self.index(true, wavelength_nm), self.index(false, wavelength_nm));
                let eta = if wo[2] > 0.0 { below / above } else { above / below };
                let reflected = etalon_oracle::laws::fresnel_exact(cos, eta).reflectance();
                let mut lobes = vec![DeltaLobe { wi: mirrored, weight: reflected, probability: reflected }];
                if reflected < 1.0 {
                    let sin2 = (1.0 - cos * cos) / (eta * eta);
                    let z = -(1.0 - sin2).max(0.0).sqrt().copysign(wo[2]);
                    let weight = (1.0 - reflected) / (eta * eta);
                    let wi = [-wo[0] / eta, -wo[1] / eta, z];
                    lobes.push(DeltaLobe { wi, weight, probability: 1.0 - reflected });
                }
                lobes
            }
        }
    }

    fn index(&self, above: bool, wavelength_nm: f64) -> f64 {
        match &self.kind {
            MaterialKind::Dielectric { interior, exterior, .. }
            | MaterialKind::RoughDielectric { interior, exterior, .. } => {
                if above { exterior } else { interior }.eval(wavelength_nm)
            }
            _ => 1.0,
        }
    }

    fn wavelengths_nm(&self) -> Vec<f64> {
        match &self.kind {
            // Seconds a wavelength.
            MaterialKind::RoughConductor { .. } | MaterialKind::RoughDielectric { .. } => vec![550.0],
            _ => vec![400.0, 550.0, 700.0],
        }
    }

    fn epsilon(&self) -> f64 {
        if size_of::<R>() == 4 { SINGLE } else { f64::EPSILON }
    }
}

fn lambert<R: Real>() -> Material<R> {
    Material::new(MaterialKind::Lambert { reflectance: Spectrum::rgb_reflectance([0.8, 0.3, 0.1]).unwrap() })
}

fn mirror<R: Real>() -> Material<R> {
    Material::new(MaterialKind::Mirror { reflectance: Spectrum::Constant(0.9) })
}

fn metal<R: Real>(name: &str) -> Material<R> {
    Material::new(MaterialKind::Conductor { index: ComplexIndex::named(name).unwrap() })
}

fn glass<R: Real>(interior: &str, exterior: &str) -> Material<R> {
    let index = |name: &str| RefractiveIndex::named(name).unwrap_or(RefractiveIndex::VACUUM);
    Material::new(MaterialKind::Dielectric { interior: index(interior), exterior: index(exterior), priority: None })
}

fn rough_metal<R: Real>(name: &str, alpha: f64, compensated: bool) -> Material<R> {
    let index = ComplexIndex::named(name).unwrap();
    Material::new(MaterialKind::RoughConductor { index, alpha, compensated })
}

/// Reflects everything: n → 0 with k > 0.
fn lossless_metal(alpha: f64) -> Material<f64> {
    let index = ComplexIndex::tabulated(vec![300.0, 900.0], vec![1e-12; 2], vec![3.0; 2]).unwrap();
    Material::new(MaterialKind::RoughConductor { index, alpha, compensated: true })
}

fn rough_glass<R: Real>(interior: &str, exterior: &str, alpha: f64, compensated: bool) -> Material<R> {
    let index = |name: &str| RefractiveIndex::named(name).unwrap_or(RefractiveIndex::VACUUM);
    let (interior, exterior) = (index(interior), index(exterior));
    Material::new(MaterialKind::RoughDielectric { interior, exterior, alpha, compensated })
}

scatters_suite!(lambert_f32, lambert::<f32>());
scatters_suite!(lambert_f64, lambert::<f64>());
scatters_suite!(mirror_f32, mirror::<f32>());
scatters_suite!(mirror_f64, mirror::<f64>());
scatters_suite!(gold_f32, metal::<f32>("Au"));
scatters_suite!(aluminium_f64, metal::<f64>("Al"));
scatters_suite!(glass_f32, glass::<f32>("N-SF11", "vacuum"));
scatters_suite!(glass_f64, glass::<f64>("N-SF11", "vacuum"));
scatters_suite!(glass_in_water_f64, glass::<f64>("N-BK7", "water"));
scatters_suite!(rough_gold_f32, rough_metal::<f32>("Au", 0.3, true));
scatters_suite!(lossless_metal_furnace, lossless_metal(1.0));
scatters_suite!(rough_silver_without_compensation, rough_metal::<f64>("Ag", 0.3, false));
scatters_suite!(rough_glass_f32, rough_glass::<f32>("N-BK7", "vacuum", 0.4, true));
scatters_suite!(very_rough_diamond_in_water, rough_glass::<f64>("diamond", "water", 1.0, true));

/// One of our area lights, alone in the world.
struct Lamp {
    light: Light,
    geometry: Geometry,
    /// A sphere around the light.
    center: Vec3<f64>,
    radius: f64,
}

impl Lamp {
    fn new<S: Clone + Into<Primitive>>(
        shape: S,
        (center, radius): (Vec3<f64>, f64),
        light: impl FnOnce(S, Emitter) -> Light,
    ) -> Self {
        let emitter =
            Emitter { radiance: PathSpectrum::Constant(2.0), front: true, back: true, surface: PrimitiveId(0).into() };
        let geometry = Geometry::build(vec![shape.clone().into()]).unwrap();
        Self { light: light(shape, emitter), geometry, center, radius }
    }

    fn is_met(&self, from_m: [f64; 3], wi: [f64; 3]) -> bool {
        self.geometry.closest_hit(&Ray::free(Vec3::from_array(from_m), Vec3::from_array(wi))).is_some()
    }
}

impl Emits for Lamp {
    fn sample(&self, from_m: [f64; 3], u: [f64; 2]) -> Option<Emitted> {
        let s = self.light.sample(Vec3::from_array(from_m), u)?;
        let (mis::Density::SolidAngle(pdf), Target::Point(target)) = (s.density, s.target) else {
            panic!("an area light has neither a delta nor an infinite distance");
        };
        let distance_m = (target - Vec3::from_array(from_m)).length();
        let radiance = self.light.spectrum().eval(550.0) * s.scale;
        Some(Emitted { wi: s.wi.to_array(), distance_m, radiance, pdf })
    }

    fn pdf(&self, from_m: [f64; 3], wi: [f64; 3]) -> f64 {
        if self.is_met(from_m, wi) { self.light.density(Vec3::from_array(from_m), Vec3::from_array(wi)) } else { 0.0 }
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
}

fn sphere_lamp() -> Lamp {
    let (center, radius) = (Vec3::new(0.0, 0.0, 2.0), 0.5);
    Lamp::new(Sphere::new(center, radius).unwrap(), (center, radius), |s, e| Light::Sphere(SphereLight::new(s, e)))
}

fn disk_lamp() -> Lamp {
    let (center, radius) = (Vec3::new(0.3, 0.0, 1.0), 0.7);
    let disk = Disk::new(center, Vec3::new(0.6, 0.0, -0.8), radius).unwrap();
    Lamp::new(disk, (center, radius), |s, e| Light::Disk(DiskLight::new(s, e)))
}

fn parallelogram_lamp() -> Lamp {
    let (corner, a, b) = (Vec3::new(-0.5, -0.4, 1.0), Vec3::new(1.0, 0.2, 0.1), Vec3::new(0.3, 0.9, 0.0));
    let center = corner + (a + b) * 0.5;
    Lamp::new(Parallelogram::new(corner, a, b).unwrap(), (center, 0.5 * (a + b).length()), |s, e| {
        Light::Parallelogram(ParallelogramLight::new(s, e))
    })
}

fn triangle_lamp() -> Lamp {
    let (a, b, c) = (Vec3::new(-0.5, -0.4, 1.0), Vec3::new(0.6, -0.2, 1.1), Vec3::new(0.1, 0.7, 0.8));
    let center = (a + b + c) / 3.0;
    let radius = [a, b, c].map(|v| (v - center).length()).into_iter().fold(0.0, f64::max);
    let light = |s, e| Light::Triangle(TriangleLight::new(s, e));
    Lamp::new(Triangle::new(a, b, c).unwrap(), (center, radius), light)
}

// The quadrature meets the rim of a flat light with the resolution of its grid: 2 % of the integral is what it can tell
// there. A sphere fills its cone.
emits_suite!(sphere_light, sphere_lamp(), from: [[0.0; 3], [1.0, 2.0, 0.0], [0.1, 0.0, 2.2]], pdf_tolerance: 1e-6);
emits_suite!(disk_light, disk_lamp(), from: [[0.0; 3], [1.0, 2.0, 0.0], [0.0, 0.0, 2.0]], pdf_tolerance: 0.02);
emits_suite!(parallelogram_light, parallelogram_lamp(), from: [[0.0; 3], [1.0, 2.0, 0.0]], pdf_tolerance: 0.02);
emits_suite!(triangle_light, triangle_lamp(), from: [[0.0; 3], [1.0, 2.0, 0.0]], pdf_tolerance: 0.02);
