//! A material of ours as the oracle sees one.

use etalon_optics::{Lanes, Spectrum, Vec3, fresnel};
use etalon_oracle::{
    laws,
    subjects::{DeltaLobe, Density, Scattered, Scatters},
};
use etalon_scene::{Grooves, InternalReflection, MaterialKind, Metal, PolarisingSheet, SpectrumTexture, ThinFilm};
use etalon_transport::{
    bsdf::{Bsdf, Shading},
    mis,
};

const RANGE_NM: [f64; 2] = [380.0, 780.0];
const UP: [f64; 3] = [0.0, 0.0, 1.0];

/// One of our materials, with what the oracle cannot ask a [`Bsdf`] for.
pub(crate) struct Material {
    pub(super) kind: MaterialKind,
    bsdf: Bsdf,
}

fn uniform(texture: &SpectrumTexture) -> &Spectrum {
    match texture {
        SpectrumTexture::Uniform(spectrum) => spectrum,
        SpectrumTexture::Image(_) | SpectrumTexture::VertexColours { .. } => {
            panic!("these materials are the same everywhere")
        }
    }
}

impl Material {
    pub(crate) fn new(kind: MaterialKind) -> Self {
        Self { bsdf: Bsdf::new(&kind, RANGE_NM), kind }
    }

    /// A place whose u grows along x, its v along y.
    fn place() -> Shading<'static> {
        Shading::flat(Vec3::from_f64(UP))
            .with_tangents([Vec3::from_f64([1.0, 0.0, 0.0]), Vec3::from_f64([0.0, 1.0, 0.0])])
    }

    fn eval(&self, wo: [f64; 3], wi: [f64; 3], wavelength_nm: f64) -> (f64, f64) {
        let lambda = Lanes([wavelength_nm]);
        let (f_cos, pdf) = self.bsdf.eval(&lambda, &Self::place(), Vec3::from_f64(wo), Vec3::from_f64(wi));
        (f_cos[0], pdf[0])
    }
}

impl Scatters for Material {
    fn f(&self, wo: [f64; 3], wi: [f64; 3], wavelength_nm: f64) -> f64 {
        let cos = wi[2].abs();
        if cos == 0.0 { 0.0 } else { self.eval(wo, wi, wavelength_nm).0 / cos }
    }

    fn pdf(&self, wo: [f64; 3], wi: [f64; 3], wavelength_nm: f64) -> f64 {
        self.eval(wo, wi, wavelength_nm).1
    }

    fn sample(&self, wo: [f64; 3], u: [f64; 3], wavelength_nm: f64) -> Option<Scattered> {
        let lambda = Lanes([wavelength_nm]);
        let s = self.bsdf.sample(&lambda, &Self::place(), Vec3::from_f64(wo), u)?;
        let wi = s.wi.to_array();
        let density = match s.density {
            mis::Density::SolidAngle(pdf) => Density::SolidAngle(pdf),
            mis::Density::Delta => {
                let nearest = self.deltas(wo, wavelength_nm).into_iter().min_by(|a, b| {
                    let off = |lobe: &DeltaLobe| (Vec3::from_array(lobe.wi) - Vec3::from_array(wi)).length();
                    off(a).total_cmp(&off(b))
                });
                Density::Delta(nearest.map_or(f64::NAN, |lobe| lobe.probability))
            }
        };
        Some(Scattered { wi, weight: s.weight[0], density })
    }

    fn deltas(&self, wo: [f64; 3], wavelength_nm: f64) -> Vec<DeltaLobe> {
        deltas(&self.kind, wo, wavelength_nm)
    }

    fn index(&self, above: bool, wavelength_nm: f64) -> f64 {
        index(&self.kind, above, wavelength_nm)
    }

    fn wavelengths_nm(&self) -> Vec<f64> {
        match &self.kind {
            // Seconds a wavelength.
            MaterialKind::Tinted { .. }
            | MaterialKind::RoughConductor { .. }
            | MaterialKind::Measured { .. }
            | MaterialKind::Principled { .. }
            | MaterialKind::RoughDielectric { .. }
            | MaterialKind::Plastic { .. }
            | MaterialKind::Blend { .. } => vec![550.0],
            _ => vec![400.0, 550.0, 700.0],
        }
    }

    fn epsilon(&self) -> f64 {
        f64::EPSILON
    }
}

/// The delta lobes of a material, written from the laws, not from what `sample` does.
fn deltas(kind: &MaterialKind, wo: [f64; 3], wavelength_nm: f64) -> Vec<DeltaLobe> {
    let mirrored = [-wo[0], -wo[1], wo[2]];
    let cos = wo[2].abs().min(1.0);
    match kind {
        MaterialKind::Lambert { .. }
        | MaterialKind::Fluorescent { .. }
        | MaterialKind::RoughConductor { .. }
        | MaterialKind::RoughDielectric { .. }
        | MaterialKind::OrenNayar { .. }
        | MaterialKind::Translucent { .. }
        | MaterialKind::Measured { .. }
        | MaterialKind::Principled { .. }
        | MaterialKind::Boundary { .. }
        | MaterialKind::Black => Vec::new(),
        MaterialKind::PolarisingSheet { sheet, .. } => {
            let weight = match sheet {
                PolarisingSheet::Polariser { transmittance, extinction } => {
                    0.5 * transmittance.eval(wavelength_nm) * (1.0 + extinction)
                }
                PolarisingSheet::Retarder { .. } => 1.0,
            };
            vec![DeltaLobe { wi: [-wo[0], -wo[1], -wo[2]], weight, probability: 1.0 }]
        }
        MaterialKind::Grating { reflectance, grating } => {
            let Grooves::Straight(turned) = grating.grooves else { panic!("its directions are those of a place") };
            let share = uniform(reflectance).eval(wavelength_nm);
            let lobe = |&(order, efficiency): &(i32, f64)| {
                let waves = f64::from(order) * wavelength_nm / grating.period_nm;
                let (x, y) = (waves * turned.cos() - wo[0], waves * turned.sin() - wo[1]);
                let z = (1.0 - x * x - y * y).sqrt().copysign(if grating.transmits { -wo[2] } else { wo[2] });
                let probability = efficiency / grating.efficiency();
                (!z.is_nan()).then_some(DeltaLobe { wi: [x, y, z], weight: share * efficiency, probability })
            };
            grating.orders.iter().filter_map(lobe).collect()
        }
        MaterialKind::Plastic { facets: Some(_), .. } => Vec::new(),
        MaterialKind::Plastic { reflectance, coat, internal_reflection, .. } => {
            let (n, rho) = (coat.eval(wavelength_nm), uniform(reflectance).eval(wavelength_nm));
            let weight = laws::fresnel_exact(cos, n).reflectance();
            let passed = 1.0 - etalon_oracle::truths::walsh_reflectance(n);
            let again = |again: f64| passed * rho / (n * n * (1.0 - again * (1.0 - passed / (n * n))));
            let ground = match internal_reflection {
                InternalReflection::Coloured => again(rho),
                InternalReflection::Uncoloured => again(1.0),
                InternalReflection::Lost => passed * rho,
            };
            let probability = weight / (weight + (1.0 - weight) * ground);
            vec![DeltaLobe { wi: mirrored, weight, probability }]
        }
        MaterialKind::ThinDielectric { index, film: Some(film) } => {
            let n = index.eval(wavelength_nm);
            let face = coated(film, 1.0, [n, 0.0], wavelength_nm);
            let (outer, inner) = (face.waves(wavelength_nm, cos), face.from_behind().waves_leaving(wavelength_nm, cos));
            let share = |[re, im]: [f64; 2]| re * re + im * im;
            let of = |p: usize| {
                let (r, inside, t) =
                    (share(outer.reflected[p]), share(inner.reflected[p]), share(outer.transmitted[p]));
                let through = t * t / (1.0 - inside * inside);
                [r + through * inside, through]
            };
            let [weight, through] = [0, 1].map(|k| 0.5 * (of(0)[k] + of(1)[k]));
            let lobe = |wi, weight, both: f64| DeltaLobe { wi, weight, probability: weight / both };
            let both = weight + through;
            vec![lobe(mirrored, weight, both), lobe([-wo[0], -wo[1], -wo[2]], through, both)]
        }
        MaterialKind::ThinDielectric { index, .. } => {
            // s and p each go their way between the faces.
            let face = laws::fresnel_exact(cos, index.eval(wavelength_nm));
            let weight = face.r_s / (1.0 + face.r_s) + face.r_p / (1.0 + face.r_p);
            let through = 0.5 * (face.t_s / (1.0 + face.r_s) + face.t_p / (1.0 + face.r_p));
            vec![
                DeltaLobe { wi: mirrored, weight, probability: weight },
                DeltaLobe { wi: [-wo[0], -wo[1], -wo[2]], weight: through, probability: through },
            ]
        }
        MaterialKind::Blend { parts, by } => {
            let number = by.eval([0.0; 2]);
            let part = |i: usize| {
                // A hat: 1 at its own place, 0 at its neighbours', 1 beyond the first and the last.
                let place = |i: usize| parts[i].0;
                let share = if number < place(i) {
                    if i == 0 { 1.0 } else { 1.0 - (place(i) - number) / (place(i) - place(i - 1)) }
                } else if i + 1 == parts.len() {
                    1.0
                } else {
                    1.0 - (number - place(i)) / (place(i + 1) - place(i))
                };
                let lobes = deltas(&parts[i].1, wo, wavelength_nm);
                let scaled = move |l: DeltaLobe| DeltaLobe {
                    wi: l.wi,
                    weight: l.weight * share,
                    probability: l.probability * share,
                };
                lobes.into_iter().filter(|_| share > 0.0).map(scaled).collect::<Vec<_>>()
            };
            (0..parts.len()).flat_map(part).collect()
        }
        MaterialKind::TwoSided { front, back } => deltas(if wo[2] > 0.0 { front } else { back }, wo, wavelength_nm),
        MaterialKind::Tinted { kind, reflected, transmitted } => {
            let tint = |l: DeltaLobe| {
                let share = if l.wi[2] * wo[2] > 0.0 { reflected } else { transmitted };
                let left = uniform(share).eval(wavelength_nm);
                // A coat that reflects less is drawn less often, beside its ground.
                let probability = match **kind {
                    MaterialKind::Plastic { .. } => l.probability * left / (l.probability * left + 1.0 - l.probability),
                    _ => l.probability,
                };
                DeltaLobe { weight: l.weight * left, probability, ..l }
            };
            deltas(kind, wo, wavelength_nm).into_iter().map(tint).collect()
        }
        MaterialKind::Mirror { reflectance } => {
            vec![DeltaLobe { wi: mirrored, weight: uniform(reflectance).eval(wavelength_nm), probability: 1.0 }]
        }
        MaterialKind::Conductor { metal, film } => {
            let (n, k) = match metal {
                Metal::Index(index) => index.eval(wavelength_nm),
                Metal::Reflectance(reflectance) => {
                    let share = uniform(reflectance).eval(wavelength_nm);
                    // ((n − 1)² + k²)/((n + 1)² + k²) with n = 1.
                    (1.0, (4.0 * share / (1.0 - share)).sqrt())
                }
            };
            let weight = match film {
                Some(film) => coated(film, 1.0, [n, k], wavelength_nm).waves(wavelength_nm, cos).reflectance(),
                None => fresnel::conductor(cos, n, k).reflectance,
            };
            vec![DeltaLobe { wi: mirrored, weight, probability: 1.0 }]
        }
        MaterialKind::Dielectric { film, .. } => {
            let (above, below) = (index(kind, true, wavelength_nm), index(kind, false, wavelength_nm));
            let eta = if wo[2] > 0.0 { below / above } else { above / below };
            let [reflected, passed] = match film {
                Some(film) => {
                    let stack = coated(film, above, [below, 0.0], wavelength_nm);
                    let stack = if wo[2] > 0.0 { stack } else { stack.from_behind() };
                    let waves = stack.waves(wavelength_nm, cos);
                    [waves.reflectance(), waves.transmittance()]
                }
                None => {
                    let reflected = laws::fresnel_exact(cos, eta).reflectance();
                    [reflected, 1.0 - reflected]
                }
            };
            let probability = reflected / (reflected + passed);
            let mut lobes = vec![DeltaLobe { wi: mirrored, weight: reflected, probability }];
            if passed > 0.0 {
                let sin2 = (1.0 - cos * cos) / (eta * eta);
                let z = -(1.0 - sin2).max(0.0).sqrt().copysign(wo[2]);
                let weight = passed / (eta * eta);
                let wi = [-wo[0] / eta, -wo[1] / eta, z];
                lobes.push(DeltaLobe { wi, weight, probability: 1.0 - probability });
            }
            lobes
        }
    }
}

/// The oracle's form of a film between media, seen from its outer side.
fn coated(film: &ThinFilm, incident: f64, substrate: [f64; 2], wavelength_nm: f64) -> laws::CoatedInterface {
    let layers = film.layers.iter().map(|layer| {
        let index = layer.index.eval(wavelength_nm);
        [index.re, index.im, layer.thickness_nm.eval([0.0; 2])]
    });
    laws::CoatedInterface { incident, layers: layers.collect(), substrate }
}

/// Index of refraction above or below a material.
fn index(kind: &MaterialKind, above: bool, wavelength_nm: f64) -> f64 {
    match kind {
        MaterialKind::Dielectric { interior, exterior, .. }
        | MaterialKind::RoughDielectric { interior, exterior, .. } => {
            if above { exterior } else { interior }.eval(wavelength_nm)
        }
        MaterialKind::Blend { parts, .. } => index(&parts[0].1, above, wavelength_nm),
        MaterialKind::Tinted { kind, .. } => index(kind, above, wavelength_nm),
        _ => 1.0,
    }
}
