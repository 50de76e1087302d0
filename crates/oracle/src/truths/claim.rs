//! What truths ask of renderers.

/// What a renderer must be able to do, or claims to do, for a truth to apply to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Claim {
    /// Averages the two polarisations at every interface, as renderers that carry plain radiance do.
    AveragesPolarisation,
    /// Carries polarised light from interface to interface.
    CarriesPolarisation,
    /// Renders a band of wavelengths so narrow that it counts as one, read relative to [`Truth::white_scene`](super::Truth::white_scene).
    NarrowBand,
    /// Refracts each wavelength by its own index.
    Dispersion,
    /// Simulates a thin lens.
    ThinLens,
    /// Ends every path at a given number of edges.
    DepthLimit,
    /// Tells the two sides of an interface inside another medium apart.
    NestedMedia,
    /// Its sensor is CIE Y: a wavelength counts as ȳ of the CIE 1931 2° observer.
    PhotometricSensor,
    /// Knows which of several solids fills a place that they share: the one of the highest priority, of equal ones the later.
    Priorities,
    /// Media absorb what goes through them.
    Absorption,
    /// Media scatter what goes through them, emit, and may change from place to place.
    Scattering,
    /// Interfaces carry thin films, in which waves interfere.
    ThinFilms,
    /// Gratings send each order of each wavelength in a direction of its own.
    Gratings,
    /// Surfaces give light back at other wavelengths than those at which they take it in.
    Fluorescence,
    /// Finds the light of lamps without area that mirrors and smooth interfaces hand on.
    SpecularConnections,
    /// Things move while the shutter is open.
    Motion,
    /// Surfaces let a part of the light pass, also where they coincide with others.
    Masks,
    /// Rough dielectrics give back the light that meets several facets.
    LosslessRoughGlass,
    /// Rough metals give back the light that meets several facets.
    LosslessRoughMetal,
    /// Facets have two widths, along the surface's first texture coordinate and across it.
    AnisotropicFacets,
    /// Facets hide each other in reflection by Smith's masking that is correlated in height.
    CorrelatedMasking,
    /// Reads the whole scene format of Etalon, with its files, not the neutral form alone.
    WholeFormat,
    /// Is read where the truth says, not over the whole picture: [`Truth::crop_px`](super::Truth::crop_px).
    StatedPixels,
    /// Says S₁, S₂ and S₃ of the light that arrives: [`Truth::quantity`](super::Truth::quantity).
    StokesParameters,
    /// Reads the meters of a scene: [`Quantity::Meters`](super::Quantity::Meters).
    Meters,
    /// Keeps the mean radiance over bands of wavelengths: [`Quantity::Band`](super::Quantity::Band).
    Bands,
}

impl Claim {
    /// What a renderer meets that has everything but polarisation: plain radiance, averaged at every interface.
    pub const UNPOLARISED: [Self; 22] = [
        Self::AveragesPolarisation,
        Self::NarrowBand,
        Self::Dispersion,
        Self::ThinLens,
        Self::DepthLimit,
        Self::NestedMedia,
        Self::PhotometricSensor,
        Self::Priorities,
        Self::Absorption,
        Self::Scattering,
        Self::ThinFilms,
        Self::Gratings,
        Self::Fluorescence,
        Self::SpecularConnections,
        Self::Motion,
        Self::Masks,
        Self::LosslessRoughGlass,
        Self::LosslessRoughMetal,
        Self::AnisotropicFacets,
        Self::CorrelatedMasking,
        Self::WholeFormat,
        Self::StatedPixels,
    ];
}
