//! What a primitive is made of: scattering, emission and the light it belongs to.

mod bump_mapping;
pub(crate) mod quadric_uv;
pub(crate) mod shading_geometry;

use crate::bsdf::{Bsdf, BsdfSample, FluorescentPart, Lobe, Properties, Shading};
use crate::media::{Interface, PlacedSolid, StatedMedia};
use crate::polarisation::mueller::Mueller;
use crate::spectral::PathSpectrum;
use crate::surface::shading_geometry::{At, Coordinates};
use crate::texture::TexturePoint;
use etalon_geometry::{Geometry, Hit, SurfaceId, SurfacePoint};
use etalon_optics::{Lanes, Vec3};
use etalon_scene::{EmissionSides, ImageTexture, OpacityImage};

/// What belongs to one object.
#[derive(Clone, Debug)]
pub(crate) struct ObjectSurface {
    pub material: usize,
    pub emission: Option<Emission>,
    /// Share of light that meets the surface at all; the rest passes.
    pub opacity: f64,
    /// An image of that share.
    pub opacity_image: Option<OpacityImage>,
    /// An image of other normals to scatter around.
    pub relief: Option<Relief>,
    pub coordinates: Coordinates,
    /// The axis of a polarising sheet, in the coordinates of the object's group. What absorbs lies across it along the sheet, so
    /// that a transform takes it to its place as it does a normal.
    pub axis: Option<Vec3<f64>>,
}

/// An image of normals or heights.
#[derive(Clone, Debug)]
pub(crate) struct Relief {
    pub image: etalon_scene::Relief,
    /// Units of the frame in a metre.
    pub per_m: f64,
}

/// What a surface emits.
#[derive(Clone, Debug)]
pub(crate) struct Emission {
    /// With an image, that of its white.
    pub radiance: PathSpectrum,
    pub sides: EmissionSides,
    /// An image of shares of white.
    pub image: Option<ImageTexture>,
}

/// What shines at a point of a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Emitted<'a> {
    /// With a colour, that of its white.
    pub radiance: &'a PathSpectrum,
    /// What an image shows there, in shares of the white.
    pub colour: Option<[f64; 3]>,
}

impl Emission {
    /// What it emits at texture coordinates, which it asks for where it needs them.
    #[inline]
    fn at(&self, uv: impl FnOnce() -> [f64; 2]) -> Emitted<'_> {
        let colour = self.image.as_ref().map(|image| image.eval(uv()));
        Emitted { radiance: &self.radiance, colour }
    }
}

/// Look-up from primitives to what they are made of.
#[derive(Clone, Debug)]
pub(crate) struct Surfaces {
    /// Scattering of each material.
    pub bsdfs: Vec<Bsdf>,
    /// Properties of each material.
    pub properties: Vec<Properties>,
    /// How light leaves that surfaces give back at another wavelength: as from a white Lambertian one.
    pub white: Bsdf,
    /// What lies on both sides of each material that states it itself or is filled.
    pub stated_media: Vec<Option<Box<StatedMedia>>>,
    pub objects: Vec<ObjectSurface>,
    /// Object of each primitive, for each geometry by its label.
    pub object_of: Vec<Vec<u32>>,
    /// The surfaces that shadow rays aim at, in their order, and the number of the light.
    pub light_of: Vec<(SurfaceId, u32)>,
}

/// The surface at a point.
#[derive(Clone, Copy)]
pub(crate) struct Surface<'a> {
    pub object: u32,
    /// The material that decides how it scatters: its own, or another object's whose boundary coincides with it.
    pub material: usize,
    own: &'a ObjectSurface,
    surfaces: &'a Surfaces,
}

impl Surfaces {
    #[inline]
    pub(crate) fn of(&self, point: &SurfacePoint<f64>) -> Surface<'_> {
        let object = self.object_of[point.label as usize][point.surface.primitive.0 as usize];
        let of_object = &self.objects[object as usize];
        Surface { object, material: of_object.material, own: of_object, surfaces: self }
    }
}

impl Surfaces {
    /// The surface of a meter's white plate: the last object, where there are meters.
    pub(crate) fn white_receiver(&self) -> Surface<'_> {
        let object = self.objects.len() - 1;
        let of_object = &self.objects[object];
        Surface { object: object as u32, material: of_object.material, own: of_object, surfaces: self }
    }

    /// What an object emits at a point of one of its surfaces that a shadow ray aims at.
    pub(crate) fn emitted(
        &self,
        object: u32,
        geometry: &Geometry,
        (surface, position): (SurfaceId, Vec3<f64>),
        time: f64,
    ) -> Option<Emitted<'_>> {
        let object = &self.objects[object as usize];
        // No texture coordinates hang on the normal.
        let normal = Vec3::ZERO;
        let uv = || {
            let uv = geometry.parameters(surface, position, time);
            object.coordinates.uv(&At { geometry, surface, uv, position, normal, time })
        };
        Some(object.emission.as_ref()?.at(uv))
    }

    /// The object of a point where it is placed: a solid, if the object is the boundary of one.
    pub(crate) fn placed_solid(&self, point: &SurfacePoint<f64>) -> PlacedSolid {
        (self.of(point).object, point.surface.instance)
    }

    /// The material of an object.
    pub(crate) fn material_of(&self, object: u32) -> usize {
        self.objects[object as usize].material
    }
}

fn at<'a>(geometry: &'a Geometry, point: &SurfacePoint<f64>, hit: &Hit<f64>) -> At<'a> {
    At { geometry, surface: hit.surface, uv: hit.uv, position: point.position, normal: point.normal, time: point.time }
}

impl<'a> Surface<'a> {
    /// How it scatters.
    pub(crate) fn bsdf(&self) -> &'a Bsdf {
        &self.surfaces.bsdfs[self.material]
    }

    /// The number of the light that it is, if shadow rays aim at it.
    #[inline]
    pub(crate) fn light(&self, surface: SurfaceId) -> Option<u32> {
        let light_of = &self.surfaces.light_of;
        let place = light_of.binary_search_by_key(&surface, |&(surface, _)| surface).ok()?;
        Some(light_of[place].1)
    }

    /// Whether it emits light.
    pub(crate) fn shines(&self) -> bool {
        self.own.emission.is_some()
    }

    /// What lies on both its sides, where it states this itself or is filled.
    pub(crate) fn stated_media(&self) -> Option<&'a StatedMedia> {
        self.surfaces.stated_media[self.own.material].as_deref()
    }

    /// Share of light that meets the surface at all; the rest passes.
    #[inline]
    pub(crate) fn opacity(&self, geometry: &Geometry, point: &SurfacePoint<f64>, hit: &Hit<f64>) -> f64 {
        match &self.own.opacity_image {
            None => self.own.opacity,
            Some(image) => self.own.opacity * image.eval(self.own.coordinates.uv(&at(geometry, point, hit))),
        }
    }

    /// Scattering at a point of it; `interface` has the media on both sides where the place decides them.
    #[inline]
    pub(crate) fn scattering(
        &self,
        geometry: &Geometry,
        point: &SurfacePoint<f64>,
        hit: &Hit<f64>,
        interface: Option<Interface<'a>>,
    ) -> Scattering<'a> {
        let place = at(geometry, point, hit);
        let mut shading = self.own.coordinates.at(&place);
        let takes_tangents = self.surfaces.properties[self.material].takes_tangents;
        if (self.own.relief.is_some() || takes_tangents)
            && let Some(tangents) = self.own.coordinates.tangents(&place)
        {
            if let Some(relief) = &self.own.relief {
                shading = bump_mapping::bend(&relief.image, shading, tangents, relief.per_m);
            }
            if takes_tangents {
                shading = shading.with_tangents(tangents);
            }
        }
        if let Some(axis) = self.own.axis {
            shading = shading.with_axis(geometry.placed_normal(hit.surface, axis, point.time).normalized());
        }
        Scattering { bsdf: self.bsdf(), at: shading.between(interface) }
    }

    /// What it reflects of red, green and blue at a point of it, if that is diffuse and shown by an image or by vertices.
    pub(crate) fn diffuse_colour(&self, geometry: &Geometry, point: &SurfacePoint<f64>, hit: &Hit<f64>) -> [f64; 3] {
        let place = self.own.coordinates.texture_point(&at(geometry, point, hit));
        self.bsdf().lambert().and_then(|lambert| lambert.colour(place)).expect("the kind of surface says that it is so")
    }

    /// Whether it gives light back at other wavelengths.
    pub(crate) fn fluoresces(&self) -> bool {
        self.surfaces.properties[self.material].fluoresces
    }

    /// Whether what the surface does depends on the medium that it stands in.
    pub(crate) fn takes_medium(&self) -> bool {
        self.surfaces.properties[self.material].takes_medium
    }

    /// What is emitted along `wo` at a point of it, if that side emits.
    #[inline]
    pub(crate) fn emission_along(
        &self,
        geometry: &Geometry,
        point: &SurfacePoint<f64>,
        hit: &Hit<f64>,
        wo: Vec3<f64>,
    ) -> Option<Emitted<'a>> {
        let emission = self.own.emission.as_ref()?;
        let front = point.normal.dot(wo) > 0.0;
        let emits = match emission.sides {
            EmissionSides::Front => front,
            EmissionSides::Back => !front,
            EmissionSides::Both => true,
        };
        emits.then(|| emission.at(|| self.own.coordinates.uv(&at(geometry, point, hit))))
    }
}

/// Scattering at one point.
#[derive(Clone, Copy)]
pub(crate) struct Scattering<'a> {
    bsdf: &'a Bsdf,
    at: Shading<'a>,
}

impl<'a> Scattering<'a> {
    /// See [`Bsdf::fluorescent_part`].
    pub(crate) fn fluorescent_part(&self, wo: Vec3<f64>, u: f64) -> Option<FluorescentPart<'a>> {
        self.bsdf.fluorescent_part(&self.at, wo, u)
    }

    /// Another BSDF at the same point.
    pub(crate) fn with(self, bsdf: &'a Bsdf) -> Self {
        Self { bsdf, ..self }
    }
}

impl Scattering<'_> {
    /// See [`Bsdf::eval`].
    #[inline]
    pub(crate) fn eval<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        wo: Vec3<f64>,
        wi: Vec3<f64>,
    ) -> (Lanes<f64, N>, Lanes<f64, N>) {
        self.bsdf.eval(lambda_nm, &self.at, wo, wi)
    }

    /// See [`Bsdf::reflection_probability`].
    pub(crate) fn reflection_probability(&self, wavelength_nm: f64, wo: Vec3<f64>) -> Option<f64> {
        self.bsdf.reflection_probability(wavelength_nm, &self.at, wo)
    }

    /// The reflectance, if it is Lambert's around the surface's own normal.
    #[inline]
    pub(crate) fn diffuse<const N: usize>(&self, lambda_nm: &Lanes<f64, N>) -> Option<Lanes<f64, N>> {
        match self.bsdf {
            Bsdf::Lambert(lambert) if !self.at.is_bent() => {
                Some(lambert.reflectance(lambda_nm, self.at.texture_point()))
            }
            _ => None,
        }
    }

    /// The unit normal to scatter around, on the surface's own outward side.
    pub(crate) fn shading_normal(&self) -> Vec3<f64> {
        self.at.shading_normal()
    }

    /// Where textures are read.
    pub(crate) fn texture_point(&self) -> TexturePoint {
        self.at.texture_point()
    }

    /// Texture coordinates.
    pub(crate) fn uv(&self) -> [f64; 2] {
        self.at.uv
    }

    /// See [`Bsdf::mueller`].
    pub(crate) fn mueller<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        wo: Vec3<f64>,
        wi: Vec3<f64>,
        lobe: Lobe,
    ) -> Option<Mueller<N>> {
        self.bsdf.mueller(lambda_nm, &self.at, wo, wi, lobe)
    }

    /// See [`Bsdf::sample_viewer`].
    pub(crate) fn sample_viewer<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        wi: Vec3<f64>,
        u: [f64; 3],
        u_way: [f64; 2],
    ) -> Option<(BsdfSample<N>, f64)> {
        self.bsdf.sample_viewer(lambda_nm, &self.at, wi, u, u_way)
    }

    /// See [`Bsdf::sample`].
    #[inline]
    pub(crate) fn sample<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        wo: Vec3<f64>,
        u: [f64; 3],
    ) -> Option<BsdfSample<N>> {
        self.bsdf.sample(lambda_nm, &self.at, wo, u)
    }
}
