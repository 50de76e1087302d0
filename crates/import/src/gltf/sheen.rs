//! `KHR_materials_sheen`: fibres over a material.
//!
//! glTF's lobe (Conty & Kulla 2017) sends light back where it comes from, and glows at grazing angles. The `sheen` of a `principled` surface is
//! brightest in the direction of a mirror: no multiple of it lessens the squared difference to glTF's lobe by more than 6 %. The nearest lobe
//! of the format is the flat one of a rough `principled` surface. A share of it that reflects as much in the mean stands for the sheen if it is
//! nearer to glTF's lobe than nothing is: at roughnesses from 0.44.
//!
//! Nearness is the integral of |f − f'| cos cos over all pairs of directions, over that of f cos cos.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::layers::layer;
use super::material::Materials;
use super::number::data_image;
use crate::{Builder, reflectance};

const KEY: &str = "KHR_materials_sheen";

/// Squares of cosines, and azimuths, at which lobes are taken.
const STEPS: usize = 24;
/// The least α of fibres for which this is fine enough; narrower ones are left out all the same.
const LEAST_ALPHA: f64 = 1e-3;

/// How much a lobe of white fibres reflects, and what stands for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fit {
    /// The share of the light that it reflects, in the mean over all directions.
    mean: f64,
    /// The share of a white flat lobe that reflects as much.
    share: f64,
    /// How far that is from the lobe: 1 is as far as nothing.
    distance: f64,
}

impl Fit {
    /// That of fibres of a roughness.
    fn new(roughness: f64) -> Self {
        let alpha = (roughness * roughness).max(LEAST_ALPHA);
        let pairs: Vec<[f64; 2]> =
            directions().map(|(o, i, half)| [fibres(o, i, half, alpha), flat(o, i, half)]).collect();
        let mean = |of: &dyn Fn(&[f64; 2]) -> f64| PI * pairs.iter().map(of).sum::<f64>() / pairs.len() as f64;
        let reflected = mean(&|pair| pair[0]);
        let share = reflected / mean(&|pair| pair[1]);
        let distance = mean(&|pair| (pair[0] - share * pair[1]).abs()) / reflected.max(f64::MIN_POSITIVE);
        Self { mean: reflected, share, distance }
    }
}

/// Pairs of directions, as their cosines to the normal and that to the facet half way. Their squares are uniform: the mean of a lobe over all
/// pairs, times π, is the share of light that it reflects in the mean over directions.
fn directions() -> impl Iterator<Item = (f64, f64, f64)> {
    let cosines = || (0..STEPS).map(|i| ((i as f64 + 0.5) / STEPS as f64).sqrt());
    cosines().flat_map(move |o| {
        cosines().flat_map(move |i| {
            (0..STEPS).map(move |k| {
                let azimuth = PI * (k as f64 + 0.5) / STEPS as f64;
                let between = o * i + ((1.0 - o * o) * (1.0 - i * i)).sqrt() * azimuth.cos();
                (o, i, (0.5 * (1.0 + between)).max(0.0).sqrt())
            })
        })
    })
}

/// glTF's lobe of white fibres.
fn fibres(o: f64, i: f64, of_facet: f64, alpha: f64) -> f64 {
    let sin2 = (1.0 - (0.5 * (o + i) / of_facet).powi(2)).max(0.0);
    let density = (2.0 + 1.0 / alpha) * sin2.powf(0.5 / alpha) / (2.0 * PI);
    density / ((1.0 + hidden(o, alpha) + hidden(i, alpha)) * 4.0 * o * i)
}

/// Conty and Kulla's fit of how fibres hide each other from a direction.
fn hidden(cos: f64, alpha: f64) -> f64 {
    let t = (1.0 - alpha) * (1.0 - alpha);
    let mix = |rough: f64, smooth: f64| rough + t * (smooth - rough);
    let (a, b, c) = (mix(21.5473, 25.3245), mix(3.82987, 3.32435), mix(0.19823, 0.16801));
    let (d, e) = (mix(-1.97760, -1.27393), mix(-4.32054, -4.85967));
    let log = |x: f64| a / (1.0 + b * x.powf(c)) + d * x + e;
    if cos < 0.5 { log(cos).exp() } else { (2.0 * log(0.5) - log(1.0 - cos)).exp() }
}

/// The lobe of a white `principled` surface of index 1, `alpha` 1 and `flatness` 1, for cosines to the normal and to the facet half way.
fn flat(o: f64, i: f64, of_facet: f64) -> f64 {
    let grazing = |cos: f64| (1.0 - cos).max(0.0).powi(5);
    let half = of_facet * of_facet - 1.0;
    let s = (1.0 + half * grazing(o)) * (1.0 + half * grazing(i));
    1.25 / PI * (s * (1.0 / (o + i) - 0.5) + 0.5)
}

impl Materials<'_> {
    /// A material with its sheen.
    pub(super) fn with_sheen(
        &mut self,
        below: Value,
        material: &gltf::Material<'_>,
        uv_set: &mut Option<u32>,
        (place, buffers, has_coat): (&str, &[Vec<u8>], bool),
        builder: &mut Builder<'_>,
    ) -> Value {
        let Some(value) = material.extension_value(KEY) else { return below };
        let number = |value: &Value| value.as_f64().filter(|number| number.is_finite()).unwrap_or(0.0).clamp(0.0, 1.0);
        let factor = [0, 1, 2].map(|c| number(&value["sheenColorFactor"][c]));
        if factor == [0.0; 3] {
            return below;
        }
        let place = format!("{place}.extensions.{KEY}");
        let roughness = number(&value["sheenRoughnessFactor"]) * self.mean_alpha(value, &place, buffers, builder);
        let at = format!("{place}.sheenColorTexture");
        let image = value.get("sheenColorTexture").and_then(|info| {
            let (texture, image, set) = self.named(info, &at, buffers, builder)?;
            let (_, mean) = self.source(&texture, &at, buffers, builder)?;
            Some((image, set, mean))
        });
        let mean = image.as_ref().map_or([1.0; 3], |(.., mean)| *mean);
        let colour: [f64; 3] = std::array::from_fn(|c| factor[c] * mean[c]);
        let strongest = (1..3).fold(0, |best, c| if colour[c] > colour[best] { c } else { best });
        let Some(most) = Some(colour[strongest]).filter(|most| *most > 0.0) else { return below };
        // In steps of 0.01: a file may state any number of roughnesses.
        let step = (100.0 * roughness).round() as u32;
        let fit = *self.fits.entry(step).or_insert_with(|| Fit::new(f64::from(step) / 100.0));
        if fit.distance >= 1.0 {
            let what = format!(
                "it is left out: no surface here is like fibres of the roughness {roughness:.2}; they would reflect {:.3} of the light, in \
                 the mean over all directions",
                most * fit.mean
            );
            builder.leave_out(place, what);
            return below;
        }
        let what = format!(
            "it becomes a share of a flat lobe, which reflects as much in the mean over all directions, {:.3} of the light; {:.0} % of \
             it in other directions than glTF's lobe",
            most * fit.mean,
            50.0 * fit.distance
        );
        builder.approximate(&place, what);
        if has_coat {
            builder.approximate(&place, "it lies over the clear coat, not below");
        }
        let fibres = json!({
            "type": "principled", "reflectance": reflectance(colour.map(|channel| channel / most)), "index": 1, "alpha": 1,
            "flatness": 1,
        });
        let mut blend = json!({ "type": "blend", "first": below, "second": layer(fibres, "sheen") });
        match image {
            Some((image, set, _)) if *uv_set.get_or_insert(set) == set => {
                // What is strongest says how much there is, of the mean colour.
                let mut weight = data_image(image);
                weight["encoding"] = json!("srgb");
                weight["channel"] = json!(["red", "green", "blue"][strongest]);
                weight["factor"] = json!(fit.share * factor[strongest]);
                blend["weight_image"] = weight;
                builder.approximate(at, "it says how strong the sheen is; its colour is the mean of the image");
            }
            other => {
                if other.is_some() {
                    let what = "it uses another set of texture coordinates than the first image: its mean is used";
                    builder.approximate(at, what);
                }
                blend["weight"] = json!(fit.share * most);
            }
        }
        blend
    }

    /// The mean of the image that the roughness of fibres is multiplied by.
    fn mean_alpha(&mut self, value: &Value, place: &str, buffers: &[Vec<u8>], builder: &mut Builder<'_>) -> f64 {
        let Some(info) = value.get("sheenRoughnessTexture") else { return 1.0 };
        let at = format!("{place}.sheenRoughnessTexture");
        let texture = self.texture(info, &at, builder);
        let Some((_, alpha)) = texture.and_then(|texture| self.means(&texture, buffers, builder)) else {
            builder.leave_out(at, "it cannot be read: the factor alone says the roughness");
            return 1.0;
        };
        builder.approximate(at, "the mean of its alpha is used");
        alpha
    }
}

/// Lists the sheen of a material that transmits light.
pub(super) fn leave_out(material: &gltf::Material<'_>, place: &str, builder: &mut Builder<'_>) {
    let factor = material.extension_value(KEY).and_then(|value| value["sheenColorFactor"].as_array());
    if factor.is_some_and(|factor| factor.iter().any(|channel| channel.as_f64().is_some_and(|channel| channel > 0.0))) {
        builder.leave_out(format!("{place}.extensions.{KEY}"), "it is left out: what transmits light has no sheen");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫ f cos dω for a direction, by the midpoint rule in θ and φ.
    fn reflected(o: f64, f: impl Fn(f64, f64, f64) -> f64) -> f64 {
        let n = 400;
        let mut sum = 0.0;
        for j in 0..n {
            let theta = 0.5 * PI * (j as f64 + 0.5) / n as f64;
            let (sin, i) = theta.sin_cos();
            for k in 0..n {
                let azimuth = PI * (k as f64 + 0.5) / n as f64;
                sum += f(o, i, azimuth) * i * sin;
            }
        }
        sum * 2.0 * (0.5 * PI / n as f64) * (PI / n as f64)
    }

    #[test]
    fn the_mean_is_that_of_the_lobe_integrated_otherwise() {
        // α = 1: D = 3 sin θ_h/2π. In means over cos² of the direction seen from.
        let alpha = 1.0;
        let fibres = |o: f64, i: f64, azimuth: f64| {
            let (so, si) = ((1.0 - o * o).sqrt(), (1.0 - i * i).sqrt());
            let [x, y, z] = [so + si * azimuth.cos(), si * azimuth.sin(), o + i];
            let sin = (x * x + y * y).sqrt() / (x * x + y * y + z * z).sqrt();
            3.0 * sin / (2.0 * PI) / ((1.0 + hidden(o, alpha) + hidden(i, alpha)) * 4.0 * o * i)
        };
        let n = 24;
        let mean = (0..n).map(|j| reflected(((j as f64 + 0.5) / n as f64).sqrt(), fibres)).sum::<f64>() / n as f64;
        let fit = Fit::new(1.0);
        assert!((fit.mean - mean).abs() < 0.01 * mean, "{fit:?} {mean}");
    }

    #[test]
    fn rough_fibres_have_a_stand_in_and_narrow_ones_none() {
        let mut last = f64::INFINITY;
        for k in 1..=20 {
            let fit = Fit::new(f64::from(k) / 20.0);
            assert!(fit.distance <= last + 1e-9 && fit.distance >= 0.0 && (0.0..1.0).contains(&fit.share), "{fit:?}");
            last = fit.distance;
        }
        assert!(Fit::new(0.43).distance > 1.0 && Fit::new(0.44).distance < 1.0);
        assert!(Fit::new(0.0).distance.is_finite());
    }

    #[test]
    fn the_sheen_of_principled_surfaces_is_another_lobe() {
        for alpha in [0.1, 0.25, 0.5, 1.0] {
            let (mut fibres2, mut sheen2, mut both) = (0.0, 0.0, 0.0);
            for (o, i, of_facet) in directions() {
                let (fibres, sheen) = (fibres(o, i, of_facet, alpha), (1.0 - of_facet).powi(5));
                (fibres2, sheen2, both) = (fibres2 + fibres * fibres, sheen2 + sheen * sheen, both + fibres * sheen);
            }
            // What its best multiple takes from the squared difference.
            assert!(both * both / (fibres2 * sheen2) < 0.06, "{alpha}");
        }
    }
}
