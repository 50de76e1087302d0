//! How surfaces scatter light: one material a file, one door, [`Bsdf`].
//!
//! `wo` points toward the camera, `wi` toward the light; both are unit vectors that leave the surface. Each material
//! knows one unit normal, on the surface's own outward side; [`Shading`] is what the door knows of the point, and says how
//! a normal that is not the surface's own is dealt with. Radiance is what travels: transmission carries the factor 1/η² with
//! η = n_transmitted / n_incident along the walk from the camera.

mod albedo;
mod blend;
mod clear_coat;
mod conductor;
pub(crate) mod dielectric;
mod film;
mod fluorescent;
mod glass_losses;
mod grating;
pub(crate) mod lambert;
mod measured;
mod metal;
mod microfacet;
mod mirror;
mod mueller;
mod oren_nayar;
mod plastic;
mod polarising_sheet;
mod principled;
mod properties;
mod rough_boundary;
mod rough_conductor;
mod rough_dielectric;
mod sample;
mod shading;
mod table_store;
#[cfg(test)]
mod tests;
mod thin_dielectric;
mod tinted;
mod translucent;
mod two_sided;

pub use blend::Blend;
pub use conductor::Conductor;
pub use dielectric::Dielectric;
pub use film::PathFilm;
pub(crate) use fluorescent::FluorescentPart;
pub use fluorescent::{Fluorescent, Reradiation};
pub use grating::Grating;
pub use lambert::Lambert;
pub use measured::Measured;
pub use metal::PathMetal;
pub use mirror::Mirror;
pub use mueller::Lobe;
pub use oren_nayar::OrenNayar;
pub use plastic::Plastic;
pub use polarising_sheet::PolarisingSheet;
pub use principled::Principled;
pub use properties::Properties;
pub use rough_conductor::RoughConductor;
pub use rough_dielectric::RoughDielectric;
pub use sample::BsdfSample;
pub use shading::Shading;
pub use table_store::keep_tables;
pub use thin_dielectric::ThinDielectric;
pub use tinted::Tinted;
pub use translucent::Translucent;
pub use two_sided::TwoSided;

use crate::texture::PathTexture;
use etalon_optics::{Lanes, Vec3};
use etalon_scene::MaterialKind;
use sample::Drawn;

/// Scattering at a surface.
#[derive(Clone, Debug)]
pub enum Bsdf {
    /// Ideal diffuse reflection.
    Lambert(Lambert),
    /// Ideal mirror.
    Mirror(Mirror),
    /// Smooth metal.
    Conductor(Conductor),
    /// Smooth interface of two transparent media.
    Dielectric(Dielectric),
    /// Rough metal.
    RoughConductor(RoughConductor),
    /// Rough interface of two transparent media.
    RoughDielectric(RoughDielectric),
    /// Rough diffuse reflection.
    OrenNayar(OrenNayar),
    /// Diffuse reflection and transmission.
    Translucent(Translucent),
    /// A coated diffuse surface.
    Plastic(Plastic),
    /// A thin pane.
    ThinDielectric(ThinDielectric),
    /// A polariser or a retarder.
    PolarisingSheet(PolarisingSheet),
    /// A diffraction grating.
    Grating(Grating),
    /// A diffuse surface that also gives light back at other wavelengths.
    Fluorescent(Fluorescent),
    /// A measured surface.
    Measured(Measured),
    /// A surface of several lobes that are added.
    Principled(Box<Principled>),
    /// A mixture of others.
    Blend(Blend),
    /// Another on each side.
    TwoSided(TwoSided),
    /// Another whose light is coloured.
    Tinted(Tinted),
    /// No scattering at all.
    Black,
}

/// The properties of a material; of a blend, all that its parts have.
pub fn properties(kind: &MaterialKind) -> Properties {
    match kind {
        MaterialKind::Lambert { reflectance } => Lambert::properties(reflectance),
        MaterialKind::Mirror { reflectance } => Mirror::properties(reflectance),
        MaterialKind::Conductor { metal, film } => Conductor::properties(metal, film.is_some()),
        MaterialKind::Dielectric { .. } => Dielectric::properties(),
        MaterialKind::RoughConductor { facets, .. } => RoughConductor::properties(facets),
        MaterialKind::RoughDielectric { facets, .. } => RoughDielectric::properties(facets),
        MaterialKind::OrenNayar { reflectance, .. } => OrenNayar::properties(reflectance),
        MaterialKind::Translucent { reflectance, transmittance } => Translucent::properties(reflectance, transmittance),
        MaterialKind::Plastic { facets, .. } => Plastic::properties(facets.as_ref()),
        MaterialKind::ThinDielectric { .. } => ThinDielectric::properties(),
        MaterialKind::PolarisingSheet { sheet, .. } => PolarisingSheet::properties(sheet),
        MaterialKind::Grating { grating, .. } => Grating::properties(grating),
        MaterialKind::Fluorescent { reflectance, .. } => Fluorescent::properties(reflectance),
        MaterialKind::Measured { surface } => Measured::properties(surface),
        MaterialKind::Principled { facets, .. } => Principled::properties(facets),
        MaterialKind::TwoSided { front, back } => TwoSided::properties([properties(front), properties(back)]),
        MaterialKind::Tinted { kind, .. } => Tinted::properties(properties(kind)),
        MaterialKind::Blend { parts, .. } => Blend::properties(parts.iter().map(|(_, part)| properties(part))),
        MaterialKind::Boundary { .. } | MaterialKind::Black => {
            Properties { solid_angle: false, dark: true, ..Properties::SOLID_ANGLE }
        }
    }
}

impl Bsdf {
    /// The scattering that a material of a scene stands for, at wavelengths within `range_nm`.
    pub fn new(kind: &MaterialKind, range_nm: [f64; 2]) -> Self {
        match kind {
            MaterialKind::Lambert { reflectance } => {
                Self::Lambert(Lambert::new(PathTexture::new(reflectance, range_nm)))
            }
            MaterialKind::Mirror { reflectance } => Self::Mirror(Mirror::new(PathTexture::new(reflectance, range_nm))),
            MaterialKind::Conductor { metal, film } => {
                let film = PathFilm::of(film.as_ref());
                Self::Conductor(Conductor::new(PathMetal::new(metal, range_nm), film))
            }
            MaterialKind::Dielectric { interior, exterior, film, .. } => {
                let film = PathFilm::of(film.as_ref());
                Self::Dielectric(Dielectric::new(interior.clone(), exterior.clone(), film))
            }
            MaterialKind::RoughConductor { metal, facets, compensated, film } => {
                let (metal, film) = (PathMetal::new(metal, range_nm), PathFilm::of(film.as_ref()));
                Self::RoughConductor(RoughConductor::new(metal, film, facets, *compensated, range_nm))
            }
            MaterialKind::RoughDielectric { interior, exterior, facets, compensated, film, .. } => {
                let (interior, exterior, film) = (interior.clone(), exterior.clone(), PathFilm::of(film.as_ref()));
                let compensated = *compensated && film.is_none();
                let glass = RoughDielectric::new(interior, exterior, facets, compensated, range_nm);
                Self::RoughDielectric(glass.coated(film))
            }
            MaterialKind::OrenNayar { reflectance, roughness } => {
                Self::OrenNayar(OrenNayar::new(PathTexture::new(reflectance, range_nm), *roughness))
            }
            MaterialKind::Translucent { reflectance, transmittance } => {
                let [reflectance, transmittance] =
                    [reflectance, transmittance].map(|texture| PathTexture::new(texture, range_nm));
                Self::Translucent(Translucent::new(reflectance, transmittance))
            }
            MaterialKind::Plastic { reflectance, coat, facets, internal_reflection, compensated } => {
                let reflectance = PathTexture::new(reflectance, range_nm);
                let facets = facets.as_ref().map(|facets| (facets, *compensated));
                Self::Plastic(Plastic::new(reflectance, coat.clone(), facets, *internal_reflection, range_nm))
            }
            MaterialKind::ThinDielectric { index, film } => {
                let film = PathFilm::of(film.as_ref());
                Self::ThinDielectric(ThinDielectric::new(index.clone(), film, range_nm))
            }
            MaterialKind::PolarisingSheet { sheet, .. } => Self::PolarisingSheet(PolarisingSheet::new(sheet, range_nm)),
            MaterialKind::Grating { reflectance, grating } => {
                Self::Grating(Grating::new(PathTexture::new(reflectance, range_nm), grating.clone()))
            }
            MaterialKind::Fluorescent { reflectance, fluorescence } => {
                let reflectance = PathTexture::new(reflectance, range_nm);
                Self::Fluorescent(Fluorescent::new(reflectance, fluorescence, range_nm))
            }
            MaterialKind::Measured { surface } => Self::Measured(Measured::new(surface)),
            MaterialKind::Principled { reflectance, index, facets, lobes } => {
                Self::Principled(Box::new(Principled::new(reflectance, index.clone(), facets, **lobes, range_nm)))
            }
            MaterialKind::Blend { parts, by } => {
                let parts = parts.iter().map(|(place, part)| (*place, Self::new(part, range_nm)));
                Self::Blend(Blend::new(parts, by.clone()))
            }
            MaterialKind::TwoSided { front, back } => {
                Self::TwoSided(TwoSided::new(Self::new(front, range_nm), Self::new(back, range_nm)))
            }
            MaterialKind::Tinted { kind, reflected, transmitted } => {
                let [reflected, transmitted] =
                    [reflected, transmitted].map(|texture| PathTexture::new(texture, range_nm));
                match Self::new(kind, range_nm) {
                    Self::Plastic(plastic) => Self::Plastic(plastic.with_tint(reflected, range_nm)),
                    bsdf => Self::Tinted(Tinted::new(bsdf, reflected, transmitted)),
                }
            }
            // Paths pass a boundary before they ask what it does.
            MaterialKind::Boundary { .. } | MaterialKind::Black => Self::Black,
        }
    }

    /// The BSDF's part without deltas, f(wo, wi)·|cos θ_i| in sr⁻¹, and the density in sr⁻¹ with which
    /// [`Bsdf::sample`] would draw `wi` if that lane's wavelength were the hero.
    #[inline]
    pub fn eval<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        wi: Vec3<f64>,
    ) -> (Lanes<f64, N>, Lanes<f64, N>) {
        match at.is_bent() {
            false => self.eval_around(lambda_nm, at.normal, at, wo, wi),
            true => shading::eval(self, lambda_nm, at, wo, wi),
        }
    }

    /// Draws a direction, with `u` = (choice of lobe, two numbers for the direction) in [0, 1)³. `None` absorbs.
    #[inline]
    pub fn sample<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        u: [f64; 3],
    ) -> Option<BsdfSample<N>> {
        match at.is_bent() {
            false => match self.draw_around(lambda_nm, at.normal, at, wo, u)? {
                Drawn::Sample(sample) => Some(sample),
                Drawn::Direction(wi, eta) => {
                    let (f_cos, density) = self.eval_around(lambda_nm, at.normal, at, wo, wi);
                    BsdfSample::scattered(wi, f_cos, density, eta)
                }
            },
            true => shading::sample(self, lambda_nm, at, wo, u),
        }
    }

    /// The probability of reflection, of a surface that reflects or transmits, each in a single direction: where `u[0]` of [`Bsdf::sample`]
    /// is below it, it reflects. `None` of any other surface.
    pub(crate) fn reflection_probability(&self, wavelength_nm: f64, at: &Shading<'_>, wo: Vec3<f64>) -> Option<f64> {
        let wo = at.viewer(wo);
        let at = &*at.seen_by(wo);
        let n = at.shading_normal();
        match self {
            Self::Dielectric(glass) => Some(glass.reflection_probability(wavelength_nm, (n, at.uv), wo, at.media())),
            Self::ThinDielectric(pane) => Some(pane.reflection_probability(wavelength_nm, (n, at.uv), wo)),
            Self::Tinted(tinted) => tinted.bsdf().reflection_probability(wavelength_nm, at, wo),
            _ => None,
        }
    }

    /// Its diffuse reflection, of a surface that is nothing else for light that keeps its wavelength.
    pub(crate) fn lambert(&self) -> Option<&Lambert> {
        match self {
            Self::Lambert(lambert) => Some(lambert),
            Self::Fluorescent(surface) => Some(surface.reflection()),
            _ => None,
        }
    }

    /// Whether it has a [`Bsdf::reflection_probability`].
    pub(crate) fn is_smooth_glass(&self) -> bool {
        matches!(self.untinted(), Self::Dielectric(_) | Self::ThinDielectric(_))
    }

    /// Whether it is a pane: light goes straight on or is reflected, and nothing else.
    pub(crate) fn is_pane(&self) -> bool {
        matches!(self.untinted(), Self::ThinDielectric(_) | Self::PolarisingSheet(_))
    }

    /// What it is without a tint.
    pub(crate) fn untinted(&self) -> &Self {
        match self {
            Self::Tinted(tinted) => tinted.bsdf().untinted(),
            bsdf => bsdf,
        }
    }

    /// The same, to be changed.
    pub(crate) fn untinted_mut(&mut self) -> &mut Self {
        match self {
            Self::Tinted(tinted) => tinted.bsdf_mut().untinted_mut(),
            bsdf => bsdf,
        }
    }

    /// [`Bsdf::eval`] with `n` for the only normal.
    #[inline]
    fn eval_around<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        wi: Vec3<f64>,
    ) -> (Lanes<f64, N>, Lanes<f64, N>) {
        match self {
            Self::Lambert(lambert) => lambert.eval(lambda_nm, n, at.texture_point(), wo, wi),
            Self::RoughConductor(metal) => metal.eval(lambda_nm, n, at, wo, wi),
            Self::RoughDielectric(glass) => glass.eval(lambda_nm, n, at, wo, wi),
            Self::OrenNayar(rough) => rough.eval(lambda_nm, n, at.texture_point(), wo, wi),
            Self::Translucent(sheet) => sheet.eval(lambda_nm, n, at.texture_point(), wo, wi),
            Self::Plastic(plastic) => plastic.eval(lambda_nm, n, at, wo, wi),
            Self::Fluorescent(surface) => surface.eval(lambda_nm, n, at, wo, wi),
            Self::Measured(measured) => measured.eval(lambda_nm, n, at, wo, wi),
            Self::Principled(surface) => surface.eval(lambda_nm, n, at, wo, wi),
            Self::Blend(blend) => blend.eval(lambda_nm, n, at, wo, wi),
            Self::TwoSided(both) => both.eval(lambda_nm, n, at, wo, wi),
            Self::Tinted(tinted) => tinted.eval(lambda_nm, n, at, wo, wi),
            Self::Mirror(_)
            | Self::Conductor(_)
            | Self::Dielectric(_)
            | Self::ThinDielectric(_)
            | Self::PolarisingSheet(_)
            | Self::Grating(_)
            | Self::Black => (Lanes::ZERO, Lanes::ZERO),
        }
    }

    /// [`Bsdf::sample`] backward, at a smooth surface. For light that comes from `wi` it draws a direction to which the surface shows that light,
    /// as `wi` of the sample, and what power is to be multiplied by beside the sample's weight. `u_way` decides where several ways lead there.
    pub(crate) fn sample_viewer<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        at: &Shading<'_>,
        wi: Vec3<f64>,
        u: [f64; 3],
        u_way: [f64; 2],
    ) -> Option<(BsdfSample<N>, f64)> {
        match at.is_bent() {
            true => shading::sample_viewer(self, lambda_nm, at, wi, u, u_way),
            // Reflected or refracted backward, light goes the same way.
            false => self.sample(lambda_nm, at, wi, u).map(|sample| (sample, 1.0)),
        }
    }

    /// The direction of [`Bsdf::sample`], with `n` for the only normal.
    #[inline]
    fn draw_around<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        u: [f64; 3],
    ) -> Option<Drawn<N>> {
        match self {
            Self::Lambert(lambert) => {
                lambert.sample(lambda_nm, n, at.texture_point(), wo, [u[1], u[2]]).map(Drawn::Sample)
            }
            Self::Mirror(mirror) => mirror.sample(lambda_nm, n, at.texture_point(), wo).map(Drawn::Sample),
            Self::Conductor(conductor) => {
                conductor.sample(lambda_nm, n, at.texture_point(), wo, at.media()).map(Drawn::Sample)
            }
            Self::Dielectric(dielectric) => {
                dielectric.sample(lambda_nm, (n, at.uv), wo, u[0], at.media()).map(Drawn::Sample)
            }
            Self::RoughConductor(metal) => metal.draw(n, at, wo, u),
            Self::RoughDielectric(glass) => glass.draw(lambda_nm, n, at, wo, u),
            Self::OrenNayar(_) => OrenNayar::draw(n, wo, [u[1], u[2]]),
            Self::Translucent(sheet) => sheet.sample(lambda_nm, n, at.texture_point(), wo, u).map(Drawn::Sample),
            Self::Plastic(plastic) => plastic.draw(lambda_nm, n, at, wo, u),
            Self::Fluorescent(surface) => surface.sample(lambda_nm, n, at, wo, [u[1], u[2]]).map(Drawn::Sample),
            Self::ThinDielectric(pane) => pane.sample(lambda_nm, (n, at.uv), wo, u[0]).map(Drawn::Sample),
            Self::PolarisingSheet(sheet) => sheet.sample(lambda_nm, wo).map(Drawn::Sample),
            Self::Grating(grating) => grating.sample(lambda_nm, n, at, wo, u[0]).map(Drawn::Sample),
            Self::Measured(measured) => measured.draw(n, at, wo, [u[1], u[2]]),
            Self::Principled(surface) => surface.draw(n, at, wo, u),
            Self::Blend(blend) => blend.draw(lambda_nm, n, at, wo, u),
            Self::TwoSided(both) => both.draw(lambda_nm, n, at, wo, u),
            Self::Tinted(tinted) => tinted.draw(lambda_nm, n, at, wo, u),
            Self::Black => None,
        }
    }
}
