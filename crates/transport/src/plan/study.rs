//! Renders of what a scene does not call for, and without what it does: for study.

use super::evidence;
use super::{EffectName, PathLoop, three_channels};
use crate::bsdf::properties;
use crate::texture;
use etalon_optics::colour::{colour_matching, rec709_luminance};
use etalon_optics::spectrum::{Outside, RgbBasis, whole_nm};
use etalon_optics::{ComplexIndex, RefractiveIndex, Spectrum, reference_nm};
use etalon_scene::{
    Filter, Image, ImageTexture, LightSampling, Material, MaterialKind, Medium, Mesh, Metal, Object, ParameterMut,
    PolarisingSheet, Projection, Scene, Shape, SpectrumTexture, Texels,
};
use std::iter;
use std::sync::Arc;

/// What to simulate otherwise than a scene calls for. Empty by default.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Study {
    /// Effects to simulate although nothing calls for them. They change no bit of the picture, but for
    /// [`EffectName::Wavelengths`], which changes the noise.
    pub force: Vec<EffectName>,
    /// Effects to leave out although the scene calls for them: the picture is then an approximation.
    pub without: Vec<EffectName>,
    /// Whether light is to be followed with its polarisation.
    pub polarised: bool,
    /// What paths carry instead of the wavelengths that the plan would give them.
    pub carried: Option<Carried>,
    /// How paths are to be traced; both ways give the same bits.
    pub path_loop: Option<PathLoop>,
    /// Whether diffuse surfaces are to draw all directions by the cosine, without a trial of whether some had better be drawn toward
    /// what casts caustics.
    pub by_cosine_alone: bool,
}

/// What a path may carry for comparison with the wavelengths that a plan gives it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Carried {
    /// A single wavelength.
    OneWavelength,
    /// Four wavelengths.
    FourWavelengths,
    /// Red, green and blue, as renderers without spectra do: every light and every reflectance is replaced by its colour
    /// (linear Rec. 709, cut to the gamut; reflectances under D65), every index of refraction by that of one wavelength. The
    /// picture is then an approximation.
    ThreeChannels,
}

/// Why a study makes no sense.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StudyError {
    /// Forced and left out.
    #[error("{0} cannot be forced and left out at once")]
    Both(EffectName),
    /// Nothing to force.
    #[error("{0} cannot be forced: it changes nothing in a scene that does not need it")]
    NothingToForce(EffectName),
    /// Neighbouring pixels cannot share paths.
    #[error("neighbouring pixels cannot share paths: {0}")]
    PathReuse(&'static str),
    /// The integrator's setting stands against it.
    #[error("{effect} cannot be simulated: {because}")]
    Contradicted {
        /// The effect.
        effect: EffectName,
        /// What stands against it.
        because: String,
    },
}

impl Study {
    /// Whether an effect is left out if the scene calls for it.
    pub(super) fn leaves_out(&self, name: EffectName) -> bool {
        // Wavelengths that differ in nothing go the same way, and none is given back at another.
        let implied = matches!(name, EffectName::Dispersion | EffectName::Fluorescence)
            && self.without.contains(&EffectName::Wavelengths);
        self.without.contains(&name) || implied
    }

    /// How direct light is found, where the scene says `stated`.
    pub(super) fn light_sampling(&self, stated: LightSampling) -> LightSampling {
        match stated {
            _ if self.without.contains(&EffectName::ShadowRays) => LightSampling::Bsdf,
            LightSampling::Mis if self.without.contains(&EffectName::Mis) => LightSampling::Light,
            other => other,
        }
    }

    pub(super) fn check(&self, scene: &Scene) -> Result<(), StudyError> {
        if self.carried == Some(Carried::ThreeChannels) {
            three_channels::check(scene)?;
        }
        for &effect in &self.force {
            if self.leaves_out(effect) {
                return Err(StudyError::Both(effect));
            }
            let Err(because) = evidence::of(effect, scene) else { continue };
            if !effect.can_be_forced() {
                return Err(StudyError::NothingToForce(effect));
            }
            let sampling = scene.integrator.light_sampling;
            let contradicted = match effect {
                EffectName::Mis => sampling != LightSampling::Mis,
                EffectName::ShadowRays => sampling == LightSampling::Bsdf,
                // Where surfaces polarise, following it is no work without a result.
                EffectName::Polarisation => because != evidence::UNPOLARISED,
                EffectName::Lens => matches!(scene.camera.projection, Projection::Orthographic { .. }),
                _ => false,
            };
            if contradicted {
                return Err(StudyError::Contradicted { effect, because });
            }
        }
        Ok(())
    }
}

/// The scene that is simulated: what a study leaves out is taken from it.
pub(crate) fn simulated(scene: &Scene, study: &Study) -> Scene {
    let mut scene = scene.clone();
    scene.integrator.light_sampling = study.light_sampling(scene.integrator.light_sampling);
    for &effect in &study.without {
        leave_out(effect, &mut scene);
    }
    if study.carried == Some(Carried::ThreeChannels) {
        three_channels::replace(&mut scene);
    }
    scene
}

fn leave_out(effect: EffectName, scene: &mut Scene) {
    let range_nm = scene.integrator.wavelength_range_nm;
    match effect {
        EffectName::Wavelengths => {
            for material in &mut scene.materials {
                turn_grey(&mut material.kind, range_nm);
            }
            for medium in media_mut(scene) {
                let Medium { absorption, scattering, source, albedo, .. } = medium;
                if let Some(grid) = albedo {
                    Arc::make_mut(grid).turn_grey(rec709_luminance);
                }
                for spectrum in [absorption, scattering].into_iter().chain(source) {
                    *spectrum = grey(spectrum, range_nm);
                }
            }
            leave_out(EffectName::Fluorescence, scene);
            leave_out(EffectName::Dispersion, scene);
            lights_mut(scene).for_each(|spectrum| *spectrum = grey(spectrum, range_nm));
            for emission in objects_mut(scene).filter_map(|object| object.emission.as_mut()) {
                emission.image = emission.image.as_ref().map(grey_image);
            }
            for light in &mut scene.lights {
                if let Some(image) = light.kind.image_mut() {
                    image.image = Arc::new(luminances(&image.image, [1.0; 3]));
                }
                if let Some(slide) = light.kind.slide_mut() {
                    slide.image = grey_image(&slide.image);
                }
            }
        }
        EffectName::Dispersion => {
            scene.materials.iter_mut().for_each(|material| fix_indices(&mut material.kind, range_nm));
            fix_lens(scene);
        }
        EffectName::Interference => scene.materials.iter_mut().for_each(|material| material.kind.remove_films()),
        EffectName::Fluorescence => scene.materials.iter_mut().for_each(|material| material.kind.remove_fluorescence()),
        EffectName::Lens => match &mut scene.camera.projection {
            Projection::Perspective { lens, .. } => *lens = None,
            Projection::Orthographic { .. } => {}
            Projection::CompoundLens(lens) => {
                let vertical_fov_rad = 2.0 * lens.half_view().atan();
                scene.camera.projection = Projection::Perspective { vertical_fov_rad, lens: None };
            }
        },
        EffectName::ShadowRays => scene.lights.retain(|light| !light.kind.is_delta()),
        // The integrator's setting, which `Study::light_sampling` has changed.
        EffectName::Mis => {}
        EffectName::Environment => scene.lights.retain(|light| light.kind.is_delta()),
        // Strategies of the integrator, which the plan leaves out.
        EffectName::SpecularConnections | EffectName::RefractedShadows => {}
        EffectName::SpecularChains => scene.materials.iter_mut().for_each(|material| blacken(&mut material.kind)),
        EffectName::NestedDielectrics => {
            for material in &mut scene.materials {
                if let MaterialKind::Dielectric { priority, .. }
                | MaterialKind::RoughDielectric { priority, .. }
                | MaterialKind::Boundary { priority } = material.kind.untinted_mut()
                {
                    *priority = None;
                }
            }
        }
        EffectName::Absorption => media_mut(scene).for_each(|medium| {
            medium.absorption = Spectrum::Constant(0.0);
            medium.albedo = None;
        }),
        EffectName::Scattering => media_mut(scene).for_each(|medium| {
            /// White is 1 but for rounding, and what rounding leaves must not end an endless way.
            const ROUNDED: f64 = 1e-12;
            // What a grid leaves to be absorbed is, by its mean.
            if let Some(grid) = medium.albedo.take() {
                let basis = RgbBasis::get();
                let (mean, [first, last]) = (grid.mean(), range_nm);
                let mut nm: Vec<f64> = iter::once(first).chain(whole_nm(range_nm)).chain([last]).collect();
                nm.dedup();
                let rest = |nm: f64| match 1.0 - basis.reflectance(mean, nm) {
                    rest if rest > ROUNDED => medium.scattering.eval(nm) * rest,
                    _ => 0.0,
                };
                let values = nm.iter().map(|&nm| medium.absorption.eval(nm) + rest(nm)).collect();
                medium.absorption = Spectrum::tabulated(nm, values, Outside::Hold).expect("sums of what is valid");
            }
            medium.scattering = Spectrum::Constant(0.0);
        }),
        // Sheets do to unpolarised light what they do, and no more.
        EffectName::Polarisation => scene.film.stokes = false,
        EffectName::Textures => {
            let colours = mean_vertex_colours(scene);
            for (material, colour) in scene.materials.iter_mut().zip(colours) {
                material.kind.flatten(&texture::mean_colour, &|factor| texture::vertex_colour(factor, colour));
            }
            for emission in objects_mut(scene).filter_map(|object| object.emission.as_mut()) {
                if let Some(image) = emission.image.take() {
                    emission.radiance = texture::mean_emission(&image);
                }
            }
        }
        EffectName::ShadingNormals => {
            for object in objects_mut(scene) {
                object.relief = None;
                if let Shape::Mesh(mesh) = &mut object.shape
                    && !mesh.normals.is_empty()
                {
                    *mesh = Arc::new(Mesh { normals: Vec::new(), ..Mesh::clone(mesh) });
                }
            }
        }
        EffectName::Masks => {
            for object in objects_mut(scene) {
                (object.opacity, object.opacity_image) = (1.0, None);
            }
        }
        EffectName::Instances => scene.instances.clear(),
        EffectName::Motion => {
            scene.camera.motion = None;
            let grouped = scene.groups.iter_mut().flat_map(|group| &mut group.instances);
            scene.instances.iter_mut().chain(grouped).for_each(|instance| instance.motion = None);
        }
        EffectName::WideFilter => scene.film.filter = Filter::Box,
        EffectName::Bands => scene.film.bands = None,
    }
}

/// Every medium.
fn media_mut(scene: &mut Scene) -> impl Iterator<Item = &mut Medium> {
    scene.materials.iter_mut().flat_map(Material::media_mut).chain(&mut scene.medium)
}

/// Every object, where it is defined.
fn objects_mut(scene: &mut Scene) -> impl Iterator<Item = &mut Object> {
    let grouped = scene.groups.iter_mut().flat_map(|group| &mut group.objects);
    scene.objects.iter_mut().chain(grouped)
}

/// The spectrum of every lamp and light.
pub(super) fn lights_mut(scene: &mut Scene) -> impl Iterator<Item = &mut Spectrum> {
    let grouped = scene.groups.iter_mut().flat_map(|group| &mut group.objects);
    let lamps = scene.objects.iter_mut().chain(grouped).filter_map(|object| object.emission.as_mut());
    let lights = scene.lights.iter_mut().map(|light| light.kind.spectrum_mut());
    lamps.map(|emission| &mut emission.radiance).chain(lights)
}

/// Makes a material treat all wavelengths alike.
fn turn_grey(kind: &mut MaterialKind, range_nm: [f64; 2]) {
    for parameter in kind.parameters_mut() {
        match parameter {
            ParameterMut::Reflectance(reflectance) | ParameterMut::Metal(Metal::Reflectance(reflectance)) => {
                *reflectance = grey_texture(reflectance, range_nm);
            }
            ParameterMut::Metal(Metal::Index(index)) => *index = grey_metal(index, range_nm),
            ParameterMut::Coat(index) | ParameterMut::Principled(index) => *index = index_at_reference(index, range_nm),
            ParameterMut::Sheet(PolarisingSheet::Polariser { transmittance, .. }) => {
                *transmittance = grey(transmittance, range_nm);
            }
            ParameterMut::Sheet(PolarisingSheet::Retarder { retardance_rad, at_nm }) => {
                if let Some(at_nm) = at_nm.take() {
                    *retardance_rad *= at_nm / reference_nm(range_nm);
                }
            }
            // See `fix_indices`.
            ParameterMut::Grating(_) => {}
            // Taken away before.
            ParameterMut::Fluorescence(_) => {}
            ParameterMut::Film(film) => film.at_nm = Some(reference_nm(range_nm)),
            ParameterMut::Measured(surface) => surface.at_nm = Some(reference_nm(range_nm)),
            // See `fix_indices`.
            ParameterMut::Interface(_) => {}
        }
    }
}

/// Makes every wavelength that a material refracts take the way of one.
pub(super) fn fix_indices(kind: &mut MaterialKind, range_nm: [f64; 2]) {
    for parameter in kind.parameters_mut() {
        match parameter {
            ParameterMut::Interface(media) => {
                media.into_iter().for_each(|index| *index = index_at_reference(index, range_nm));
            }
            ParameterMut::Grating(grating) => grating.at_nm = Some(reference_nm(range_nm)),
            _ => {}
        }
    }
}

/// Makes every wavelength take the way of one through the camera's lens.
pub(super) fn fix_lens(scene: &mut Scene) {
    let range_nm = scene.integrator.wavelength_range_nm;
    if let Projection::CompoundLens(lens) = &mut scene.camera.projection {
        for surface in &mut Arc::make_mut(lens).surfaces {
            surface.medium = index_at_reference(&surface.medium, range_nm);
        }
    }
}

/// Makes black what hands light on in single directions only.
fn blacken(kind: &mut MaterialKind) {
    for part in kind.parts_mut() {
        if properties(part).is_specular() {
            *part = MaterialKind::Black;
        }
    }
}

pub(super) fn index_at_reference(index: &RefractiveIndex, range_nm: [f64; 2]) -> RefractiveIndex {
    RefractiveIndex::constant(index.eval(reference_nm(range_nm))).expect("an index of refraction is positive")
}

/// The mean over the range, weighted by ȳ (plainly, where the eye sees nothing).
fn grey(spectrum: &Spectrum, range_nm: [f64; 2]) -> Spectrum {
    let mean = |weight: &dyn Fn(f64) -> f64| {
        let (sum, total) = whole_nm(range_nm)
            .fold((0.0, 0.0), |(sum, total), nm| (sum + weight(nm) * spectrum.eval(nm), total + weight(nm)));
        (total > 0.0).then(|| sum / total)
    };
    let mean = mean(&|nm| colour_matching(nm)[1]).or_else(|| mean(&|_| 1.0)).unwrap_or(0.0);
    Spectrum::Constant(mean)
}

fn grey_texture(reflectance: &SpectrumTexture, range_nm: [f64; 2]) -> SpectrumTexture {
    match reflectance {
        SpectrumTexture::Uniform(spectrum) => grey(spectrum, range_nm).into(),
        SpectrumTexture::Image(texture) => SpectrumTexture::Image(grey_image(texture)),
        SpectrumTexture::VertexColours { factor, image, .. } => {
            SpectrumTexture::VertexColours { factor: *factor, grey: true, image: image.clone() }
        }
    }
}

/// For each material the mean colour of the vertices of the objects that are made of it; white where they have none.
fn mean_vertex_colours(scene: &Scene) -> Vec<[f64; 3]> {
    let mut sums = vec![([0.0; 3], 0.0); scene.materials.len()];
    for object in scene.placed_objects() {
        let (sum, count) = &mut sums[object.material];
        for colour in object.shape.vertex_colours() {
            (0..3).for_each(|c| sum[c] += f64::from(colour[c]));
            *count += 1.0;
        }
    }
    sums.into_iter().map(|(sum, count)| if count > 0.0 { sum.map(|v| v / count) } else { [1.0; 3] }).collect()
}

/// An image of the luminance of each texel.
fn grey_image(texture: &ImageTexture) -> ImageTexture {
    let image = Arc::new(luminances(&texture.image, texture.factor));
    ImageTexture { image, factor: [1.0; 3], ..texture.clone() }
}

/// The luminance of each texel, times a factor on each channel.
fn luminances(image: &Image, factor: [f64; 3]) -> Image {
    let luminance = |texel: [f64; 3]| [rec709_luminance([0, 1, 2].map(|c| texel[c] * factor[c])) as f32; 3];
    let Image { width, height, .. } = *image;
    Image::new(width, height, Texels::F32(image.linear_texels().map(luminance).collect()))
}

fn grey_metal(index: &ComplexIndex, range_nm: [f64; 2]) -> ComplexIndex {
    let (n, k) = index.eval(reference_nm(range_nm));
    let [first, last] = range_nm;
    ComplexIndex::tabulated(vec![first, last], vec![n; 2], vec![k; 2]).expect("a metal at one wavelength is a metal")
}
