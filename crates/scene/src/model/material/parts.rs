//! What materials are made of: the parts of blends, the numbers of each part, the media that they part.

use super::{MaterialKind, Microfacets, Side};
use crate::model::{NumberTexture, Parameter, ParameterMut, SpectrumTexture, ThinFilm};
use crate::texture::ImageTexture;
use etalon_optics::{RefractiveIndex, Spectrum};

impl MaterialKind {
    /// The index, if it has one of its own, and the priority of the closed solid that it bounds, if it bounds one.
    pub fn solid(&self) -> Option<(Option<&RefractiveIndex>, u32)> {
        match self {
            Self::Dielectric { interior, priority: Some(priority), .. }
            | Self::RoughDielectric { interior, priority: Some(priority), .. } => Some((Some(interior), *priority)),
            Self::Boundary { priority: Some(priority) } => Some((None, *priority)),
            Self::Tinted { kind, .. } => kind.solid(),
            _ => None,
        }
    }

    /// The facets of it and of its parts.
    pub fn microfacets(&self) -> impl Iterator<Item = &Microfacets> {
        self.parts().into_iter().filter_map(|part| match part {
            Self::RoughConductor { facets, .. }
            | Self::RoughDielectric { facets, .. }
            | Self::Principled { facets, .. }
            | Self::Plastic { facets: Some(facets), .. } => Some(facets),
            _ => None,
        })
    }

    /// Whether what it does, or a part of it, depends on the direction in which u grows on the surface.
    pub fn has_grain(&self) -> bool {
        self.parts().into_iter().any(|part| matches!(part, Self::Measured { surface } if !surface.is_isotropic()))
            || self.microfacets().any(|facets| !facets.is_isotropic())
    }

    /// The media before and behind an interface that has no priority; of materials side by side those of all, if they are
    /// interfaces of the same.
    pub fn media(&self) -> Option<[&RefractiveIndex; 2]> {
        match self {
            Self::Dielectric { interior, exterior, priority: None, .. }
            | Self::RoughDielectric { interior, exterior, priority: None, .. } => Some([exterior, interior]),
            Self::Boundary { priority: None } => Some([&RefractiveIndex::VACUUM; 2]),
            Self::Tinted { kind, .. } => kind.media(),
            Self::Blend { parts, .. } => {
                let (_, first) = parts.first()?;
                let media = first.media()?;
                parts.iter().all(|(_, part)| part.media() == Some(media)).then_some(media)
            }
            _ => None,
        }
    }

    /// What it is without a tint.
    pub fn untinted(&self) -> &Self {
        match self {
            Self::Tinted { kind, .. } => kind.untinted(),
            kind => kind,
        }
    }

    /// The same, to be changed.
    pub fn untinted_mut(&mut self) -> &mut Self {
        match self {
            Self::Tinted { kind, .. } => kind.untinted_mut(),
            kind => kind,
        }
    }

    /// Two materials side by side, the second with the share `weight` of the surface.
    pub fn blend(first: Self, second: Self, weight: impl Into<NumberTexture>) -> Self {
        Self::Blend { parts: vec![(0.0, first), (1.0, second)], by: weight.into() }
    }

    /// A material that reflects on one side of the surface and is black on the other.
    pub fn one_sided(kind: Self, side: Side) -> Self {
        let [kind, black] = [kind, Self::Black].map(Box::new);
        match side {
            Side::Front => Self::TwoSided { front: kind, back: black },
            Side::Back => Self::TwoSided { front: black, back: kind },
        }
    }

    /// The materials that it is made of: of a blend those of its parts, of a two-sided one those of the sides that are not black, of any other itself.
    pub fn parts(&self) -> Vec<&Self> {
        match self {
            Self::Blend { parts, .. } => parts.iter().flat_map(|(_, part)| part.parts()).collect(),
            Self::TwoSided { front, back } => {
                [front, back].into_iter().filter(|side| ***side != Self::Black).flat_map(|side| side.parts()).collect()
            }
            Self::Tinted { kind, .. } => kind.parts(),
            other => vec![other],
        }
    }

    /// As [`MaterialKind::parts`], to be changed.
    pub fn parts_mut(&mut self) -> Vec<&mut Self> {
        match self {
            Self::Blend { parts, .. } => parts.iter_mut().flat_map(|(_, part)| part.parts_mut()).collect(),
            Self::TwoSided { front, back } => {
                let sides = [front, back].into_iter().filter(|side| ***side != Self::Black);
                sides.flat_map(|side| side.parts_mut()).collect()
            }
            Self::Tinted { kind, .. } => kind.parts_mut(),
            other => vec![other],
        }
    }

    /// The first image that varies it over a surface.
    pub fn image(&self) -> Option<&ImageTexture> {
        match self {
            Self::Blend { parts, by } => parts.iter().find_map(|(_, part)| part.image()).or_else(|| by.image()),
            Self::TwoSided { front, back } => front.image().or_else(|| back.image()),
            Self::Tinted { kind, reflected, transmitted } => {
                reflected.image().or_else(|| transmitted.image()).or_else(|| kind.image())
            }
            kind => kind.parameters().into_iter().find_map(Parameter::image),
        }
    }

    /// The factors on the colours of the vertices, of each of its parts that shows these.
    pub fn vertex_colours(&self) -> impl Iterator<Item = [f64; 3]> {
        self.parameters().into_iter().filter_map(|parameter| parameter.reflectance()?.vertex_colours())
    }

    /// The film that coats it, or one of its parts.
    pub fn film(&self) -> Option<&ThinFilm> {
        self.parameters().into_iter().find_map(|parameter| match parameter {
            Parameter::Film(film) => Some(film),
            _ => None,
        })
    }

    /// Takes every film away.
    pub fn remove_films(&mut self) {
        for part in self.parts_mut() {
            if let Self::Conductor { film, .. }
            | Self::RoughConductor { film, .. }
            | Self::Dielectric { film, .. }
            | Self::RoughDielectric { film, .. }
            | Self::ThinDielectric { film, .. } = part
            {
                *film = None;
            }
        }
    }

    /// Makes every surface that fluoresces reflect alone.
    pub fn remove_fluorescence(&mut self) {
        for part in self.parts_mut() {
            if let Self::Fluorescent { reflectance, .. } = part {
                *part = Self::Lambert { reflectance: reflectance.clone() };
            }
        }
    }

    /// Replaces every image that varies something over a surface by one value, for spectra that of `mean` and for numbers the
    /// mean of their texels; and the colours of vertices by that of `of_vertices` of the factor on them.
    pub fn flatten(&mut self, mean: &dyn Fn(&ImageTexture) -> Spectrum, of_vertices: &dyn Fn([f64; 3]) -> Spectrum) {
        self.flatten_shares();
        for parameter in self.parameters_mut() {
            if let ParameterMut::Film(film) = parameter {
                film.flatten();
            } else if let Some(reflectance) = parameter.reflectance() {
                match reflectance {
                    SpectrumTexture::Uniform(_) => {}
                    SpectrumTexture::Image(image) => *reflectance = mean(image).into(),
                    SpectrumTexture::VertexColours { factor, image, .. } => {
                        let mean = image.as_ref().map_or([1.0; 3], |image| image.mean());
                        *reflectance = of_vertices([0, 1, 2].map(|c| factor[c] * mean[c])).into();
                    }
                }
            }
        }
    }

    fn flatten_shares(&mut self) {
        if let Self::Tinted { kind, .. } = self {
            kind.flatten_shares();
        }
        if let Self::TwoSided { front, back } = self {
            front.flatten_shares();
            back.flatten_shares();
        }
        if let Self::Blend { parts, by } = self {
            parts.iter_mut().for_each(|(_, part)| part.flatten_shares());
            *by = by.mean().into();
        }
    }
}
