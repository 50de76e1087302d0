//! What camera rays meet first: for compositing and denoising, beside the picture and apart from it.
//!
//! Features are a function of the scene and its seed alone. They are found by the camera rays of a pixel's first samples after
//! the picture is done, so that a render without them does nothing for them.

use crate::film::{Counters, PixelRect};
use crate::integrator::tracer::Tracer;
use crate::render::ThreadError;
use crate::scene::prepare::Prepared;
use crate::wavelength::WavelengthDistribution;
use etalon_optics::colour::{colour_matching, rec709_from_xyz};
use etalon_optics::spectrum::Illuminant;
use etalon_optics::{Lanes, Spectrum};
use rayon::prelude::*;

/// Camera rays of a pixel, at most: the first of its samples.
pub const FEATURE_SAMPLES: u32 = 64;
/// Wavelengths at which an albedo is known.
const WAVELENGTHS: usize = 16;

/// What the camera rays of a pixel meet first.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Features {
    /// Share of light that the surface scatters, in linear Rec. 709 under D65, mean over all rays; 0 on a miss.
    pub albedo: [f32; 3],
    /// Unit normal to shade by, in the world, on the side of the camera: mean over all rays; 0 on a miss.
    pub normal: [f32; 3],
    /// Position in the world, m: mean over rays that meet something.
    pub position_m: [f32; 3],
    /// Distance along the camera's viewing direction, m: mean over rays that meet something.
    pub depth_m: f32,
    /// Texture coordinates: mean over rays that meet something.
    pub uv: [f32; 2],
    /// The object that most rays meet, the first of those that as many do: its number on paths plus one; 0 where most meet
    /// none.
    pub object: f32,
}

impl Features {
    /// Numbers of a pixel.
    pub const NUMBERS: usize = 13;

    /// All numbers, in the order of the fields.
    pub fn to_array(&self) -> [f32; Self::NUMBERS] {
        let ([a, b, c], [d, e, f], [g, h, i], [k, l]) = (self.albedo, self.normal, self.position_m, self.uv);
        [a, b, c, d, e, f, g, h, i, self.depth_m, k, l, self.object]
    }

    /// From the numbers of [`Features::to_array`].
    pub fn from_array([a, b, c, d, e, f, g, h, i, depth_m, k, l, object]: [f32; Self::NUMBERS]) -> Self {
        Self { albedo: [a, b, c], normal: [d, e, f], position_m: [g, h, i], depth_m, uv: [k, l], object }
    }
}

/// What turns a reflectance at some wavelengths into linear Rec. 709 under D65: equal shares of what the eye sees.
struct Observer {
    lambda_nm: Lanes<f64, WAVELENGTHS>,
    /// CIE XYZ of each share.
    xyz: [[f64; 3]; WAVELENGTHS],
}

impl Observer {
    /// Over the wavelengths that are rendered.
    fn new(range_nm: [f64; 2]) -> Self {
        let d65 = Spectrum::illuminant(Illuminant::D65, 1.0).expect("a standard illuminant");
        let distribution = WavelengthDistribution::new(range_nm);
        let mut observer = Self { lambda_nm: Lanes::ZERO, xyz: [[0.0; 3]; WAVELENGTHS] };
        const FINE: usize = 64;
        let mut white = [0.0; 3];
        for share in 0..WAVELENGTHS {
            let (mut weight, mut mean_nm) = (0.0, 0.0);
            for i in 0..FINE {
                let u = (share * FINE + i) as f64 + 0.5;
                let (nm, pdf) = distribution.sample(u / (WAVELENGTHS * FINE) as f64);
                let matching = colour_matching(nm);
                let power = d65.eval(nm) / pdf;
                (0..3).for_each(|c| observer.xyz[share][c] += power * matching[c]);
                // Where the eye sees it, or anywhere if it sees nothing.
                let seen = power * matching.iter().sum::<f64>() + f64::MIN_POSITIVE;
                weight += seen;
                mean_nm += seen * nm;
            }
            observer.lambda_nm[share] = mean_nm / weight;
            (0..3).for_each(|c| white[c] += observer.xyz[share][c]);
        }
        // White is (1, 1, 1), whatever range of wavelengths is rendered.
        let rec709_white = rec709_white_xyz();
        for xyz in &mut observer.xyz {
            (0..3).for_each(|c| xyz[c] *= if white[c] > 0.0 { rec709_white[c] / white[c] } else { 0.0 });
        }
        observer
    }

    fn rec709(&self, reflectance: &Lanes<f64, WAVELENGTHS>) -> [f64; 3] {
        let mut xyz = [0.0; 3];
        for share in 0..WAVELENGTHS {
            (0..3).for_each(|c| xyz[c] += self.xyz[share][c] * reflectance[share]);
        }
        rec709_from_xyz(xyz)
    }
}

fn rec709_white_xyz() -> [f64; 3] {
    etalon_optics::colour::rec709_to_xyz([1.0; 3])
}

/// Sums over the rays of a pixel.
#[derive(Default)]
struct Sums {
    rays: u32,
    hits: u32,
    albedo: [f64; 3],
    normal: [f64; 3],
    position_m: [f64; 3],
    depth_m: f64,
    uv: [f64; 2],
    /// Rays that met each object, by its number plus one.
    objects: Vec<(u32, u32)>,
}

fn add<const N: usize>(sum: &mut [f64; N], value: [f64; N]) {
    (0..N).for_each(|i| sum[i] += value[i]);
}

impl Sums {
    fn count(&mut self, object: u32) {
        match self.objects.iter_mut().find(|(number, _)| *number == object) {
            Some((_, count)) => *count += 1,
            None => self.objects.push((object, 1)),
        }
    }

    fn finish(mut self) -> Features {
        let mean = |sum: f64, count: u32| if count == 0 { 0.0 } else { (sum / f64::from(count)) as f32 };
        let Self { rays, hits, .. } = self;
        self.objects.sort_unstable_by_key(|&(number, count)| (std::cmp::Reverse(count), number));
        Features {
            albedo: self.albedo.map(|v| mean(v, rays)),
            normal: self.normal.map(|v| mean(v, rays)),
            position_m: self.position_m.map(|v| mean(v, hits)),
            depth_m: mean(self.depth_m, hits),
            uv: self.uv.map(|v| mean(v, hits)),
            // Numbers beyond 2²⁴ are not told apart by 32-bit floats; a scene of this many objects does not fit anywhere.
            object: self.objects.first().map_or(0.0, |&(number, _)| number as f32),
        }
    }
}

impl Prepared {
    /// What the first `samples` camera rays of each pixel of some rectangles meet first, at most [`FEATURE_SAMPLES`]: rectangle
    /// by rectangle, row by row.
    pub fn features(
        &self,
        rects: &[PixelRect],
        samples: u32,
        threads: Option<usize>,
    ) -> Result<Vec<Vec<Features>>, ThreadError> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build()?;
        let observer = Observer::new(self.scene.integrator.wavelength_range_nm);
        let samples = samples.clamp(1, FEATURE_SAMPLES);
        let of = |rect: &PixelRect| {
            let tracer = Tracer::new(self);
            rect.pixels().map(|(x, y)| self.features_of(&tracer, &observer, x, y, samples)).collect()
        };
        Ok(pool.install(|| rects.par_iter().map(of).collect()))
    }

    /// Names of all objects by their number on paths.
    pub fn object_names(&self) -> Vec<String> {
        (0..).map_while(|number| self.object(number).map(|object| object.name.clone())).collect()
    }

    fn features_of(&self, tracer: &Tracer<'_>, observer: &Observer, x: u32, y: u32, samples: u32) -> Features {
        let mut sums = Sums::default();
        let mut counters = Counters::default();
        let camera = &self.scene.camera;
        for sample in 0..samples {
            sums.rays += 1;
            let Some(first) = tracer.first_surface(x, y, sample, &mut counters) else {
                sums.count(0);
                continue;
            };
            sums.hits += 1;
            sums.count(first.object + 1);
            // The mean over directions of what is scattered is the share that is: drawn as the path draws it. Radiance grows with
            // the square of the index where light enters; the share does not.
            if let Some(next) = first.scattering.sample::<WAVELENGTHS>(&observer.lambda_nm, first.wo, first.u) {
                let scattered = next.weight * (next.eta * next.eta);
                add(&mut sums.albedo, observer.rec709(&scattered));
            }
            let normal = first.scattering.shading_normal();
            add(&mut sums.normal, if first.geometric_cos < 0.0 { -normal } else { normal }.to_array());
            let world = self.frame.to_world_m(first.position).to_array();
            add(&mut sums.position_m, world);
            sums.depth_m += (0..3).map(|c| (world[c] - camera.position_m[c]) * camera.forward[c]).sum::<f64>();
            add(&mut sums.uv, first.scattering.uv());
        }
        sums.finish()
    }
}
