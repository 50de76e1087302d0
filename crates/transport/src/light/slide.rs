//! A slide: an image before a lamp at a point, which sends nothing beside it.
//!
//! I is the intensity of the lamp alone, C the colour of the image, θ the angle to the slide's middle. Through a slide the intensity is
//! I(ω)·C(u, v), or I(ω)·C(u, v)/cos³θ for even screens. A screen across the slide's direction at the distance d receives I·cos³θ/d² from a
//! bare lamp. So it receives I·C/d² through a slide for even screens.

use super::tree::LightBounds;
use super::{Light, LightSample, LightSource};
use crate::media::Way;
use crate::spectral::{Colour, PathSpectrum};
use etalon_optics::Vec3;
use etalon_optics::colour::rec709_luminance;
use etalon_scene::{EvenOn, ImageTexture};

/// A lamp with a slide.
#[derive(Clone, Debug)]
pub struct SlideLight {
    lamp: Light,
    slide: Slide,
}

/// The slide alone.
#[derive(Clone, Debug)]
struct Slide {
    position: Vec3<f64>,
    /// Unit vectors through its middle, to its right and up.
    direction: Vec3<f64>,
    right: Vec3<f64>,
    up: Vec3<f64>,
    /// Tangents of the angles to its right and upper edge.
    tangents: [f64; 2],
    image: ImageTexture,
    even_on: EvenOn,
}

/// What a slide does to the intensity in a direction.
#[derive(Clone, Copy, Debug)]
struct Passes {
    colour: [f64; 3],
    factor: f64,
}

impl Slide {
    /// `None` beside the slide, and where it lets nothing pass.
    fn passes(&self, away: Vec3<f64>) -> Option<Passes> {
        let cos = away.dot(self.direction);
        if cos <= 0.0 || cos.is_nan() {
            return None;
        }
        let x = away.dot(self.right) / (cos * self.tangents[0]);
        let y = away.dot(self.up) / (cos * self.tangents[1]);
        if x.abs() > 1.0 || y.abs() > 1.0 {
            return None;
        }
        let colour = self.image.eval([0.5 + 0.5 * x, 0.5 + 0.5 * y]);
        let factor = match self.even_on {
            EvenOn::Screen => 1.0 / (cos * cos * cos),
            EvenOn::Sphere => 1.0,
        };
        (colour != [0.0; 3]).then_some(Passes { colour, factor })
    }

    /// The part of a way that lies in its pyramid.
    fn part(&self, way: &Way) -> Option<[f64; 2]> {
        let from = way.origin - self.position;
        let along = |axis: Vec3<f64>| [from.dot(axis), way.direction.dot(axis)];
        let ([depth, deepens], sides) = (along(self.direction), [along(self.right), along(self.up)]);
        let [mut first, mut last] = [0.0, way.length];
        for (tangent, [aside, moves]) in self.tangents.into_iter().zip(sides) {
            for sign in [1.0, -1.0] {
                // Within where tangent·depth − sign·aside is not below 0.
                let (within, grows) = (tangent * depth - sign * aside, tangent * deepens - sign * moves);
                match grows {
                    _ if grows > 0.0 => first = f64::max(first, -within / grows),
                    _ if grows < 0.0 => last = f64::min(last, -within / grows),
                    _ if within < 0.0 => return None,
                    _ => {}
                }
            }
        }
        (last > first).then_some([first, last])
    }
}

impl SlideLight {
    /// `lamp` is at a point.
    pub(super) fn new(lamp: Light, of: &etalon_scene::SlideLight) -> Option<Self> {
        let [direction, right, up] = [of.direction, of.right, of.up].map(Vec3::from_array);
        let slide = Slide {
            position: lamp.position()?,
            direction,
            right,
            up,
            tangents: of.tangents,
            image: of.image.clone(),
            even_on: of.even_on,
        };
        Some(Self { lamp, slide })
    }
}

impl LightSource for SlideLight {
    fn sample(&self, from: Vec3<f64>, u: [f64; 2], time: f64) -> Option<LightSample> {
        let sample = self.lamp.sample(from, u, time)?;
        let Passes { colour, factor } = self.slide.passes(-sample.wi)?;
        Some(LightSample { scale: sample.scale * factor, colour: Some(Colour::Rgb(colour)), ..sample })
    }

    /// That of the lamp, which is the white of the slide.
    fn spectrum(&self) -> &PathSpectrum {
        self.lamp.spectrum()
    }

    fn position(&self) -> Option<Vec3<f64>> {
        Some(self.slide.position)
    }

    fn lit_part(&self, way: &Way) -> Option<[f64; 2]> {
        let ([a, b], [c, d]) = (self.lamp.lit_part(way)?, self.slide.part(way)?);
        let (first, last) = (a.max(c), b.min(d));
        (last > first).then_some([first, last])
    }

    fn bounds(&self) -> Option<LightBounds> {
        let [x, y] = self.slide.tangents;
        let cos_corner = 1.0 / (1.0 + x * x + y * y).sqrt();
        Some(LightBounds {
            axis: self.slide.direction,
            cos_normals: cos_corner,
            cos_shines: 1.0,
            ..self.lamp.bounds()?
        })
    }

    /// About, which only decides how often it is aimed at: as if the lamp had the same intensity through all of the slide, times the mean of the
    /// image.
    fn power_factor(&self, scene_radius: f64) -> f64 {
        let of_lamp = self.lamp.power_factor(scene_radius);
        let [x, y] = self.slide.tangents;
        let share = match &self.lamp {
            // Of a sphere, 4xy is about the solid angle of the slide.
            Light::Point(_) => (x * y / std::f64::consts::PI).min(1.0),
            _ => 1.0,
        };
        of_lamp * share * rec709_luminance(self.slide.image.mean())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_scene::{Image, Texels, TextureFilter};
    use proptest::prelude::*;

    /// A slide whose left half is white and whose right half is black, for who looks along its direction.
    fn slide(tangents: [f64; 2], even_on: EvenOn) -> Slide {
        let mut image = ImageTexture::new(Image::new(2, 1, Texels::F32(vec![[1.0; 3], [0.0; 3]])));
        image.filter = TextureFilter::Nearest;
        let (direction, up) = (Vec3::new(0.6, 0.0, -0.8), Vec3::new(0.0, 1.0, 0.0));
        let position = Vec3::new(0.1, 0.2, -0.1);
        Slide { position, direction, right: direction.cross(up), up, tangents, image, even_on }
    }

    proptest! {
        /// Up to an edge, where rounding decides, a way is lit where the slide is met from the lamp.
        #[test]
        fn a_part_holds_what_the_slide_lights(
            from in prop::array::uniform3(-3.0..3.0_f64),
            toward in prop::array::uniform3(-1.0..1.0_f64),
            tangents in prop::array::uniform2(0.05..3.0_f64),
        ) {
            let toward = Vec3::from_array(toward);
            prop_assume!(toward.length() > 0.1);
            let slide = slide(tangents, EvenOn::Sphere);
            let way = Way { origin: Vec3::from_array(from), direction: toward.normalized(), length: 5.0, time: 0.0 };
            let [first, last] = slide.part(&way).unwrap_or([f64::NAN; 2]);
            for i in 0..500 {
                let t = 5.0 * (f64::from(i) + 0.5) / 500.0;
                let away = way.origin + way.direction * t - slide.position;
                let [x, y, depth] = [slide.right, slide.up, slide.direction].map(|axis| away.dot(axis));
                let within = depth > 0.0 && x.abs() <= tangents[0] * depth && y.abs() <= tangents[1] * depth;
                if (t - first).abs() > 1e-6 && (t - last).abs() > 1e-6 {
                    prop_assert_eq!(t > first && t < last, within, "{} {} {}", t, first, last);
                    // Of the two halves, the right one is black.
                    let passes = slide.passes(away / away.length()).is_some();
                    prop_assert_eq!(passes, within && x < 0.0, "{} {}", t, x);
                }
            }
        }
    }

    #[test]
    fn a_screen_is_lit_evenly_and_a_sphere_too() {
        for (even_on, power) in [(EvenOn::Screen, 3), (EvenOn::Sphere, 0)] {
            let slide = slide([1.0; 2], even_on);
            let away = (slide.direction - slide.right * 0.9 + slide.up * 0.3).normalized();
            let factor = slide.passes(away).expect("it is white there").factor;
            let cos = away.dot(slide.direction);
            assert!((factor * cos.powi(power) - 1.0).abs() < 1e-12, "{even_on:?}: {factor}");
        }
    }
}
