//! What is compiled in: everything, but in the builds that measure what an effect costs a scene that does not need it.
//!
//! Each feature `without-…` of this crate takes the code of one effect out. Nothing but that measurement turns one on; the
//! pictures of scenes that call for the effect are then wrong. See `docs/effects.md`, "The cost of not needing".

pub(crate) const DISPERSION: bool = !cfg!(feature = "without-dispersion");
pub(crate) const LENS: bool = !cfg!(feature = "without-lens");
pub(crate) const SHADOW_RAYS: bool = !cfg!(feature = "without-shadow-rays");
pub(crate) const MIS: bool = !cfg!(feature = "without-mis");
pub(crate) const ENVIRONMENT: bool = !cfg!(feature = "without-environment");
pub(crate) const SPECULAR_CHAINS: bool = !cfg!(feature = "without-specular-chains");
pub(crate) const NESTED_DIELECTRICS: bool = !cfg!(feature = "without-nested-dielectrics");
pub(crate) const ABSORPTION: bool = !cfg!(feature = "without-absorption");
pub(crate) const TEXTURES: bool = !cfg!(feature = "without-textures");
pub(crate) const SHADING_NORMALS: bool = !cfg!(feature = "without-shading-normals");
pub(crate) const MASKS: bool = !cfg!(feature = "without-masks");
pub(crate) const MOTION: bool = !cfg!(feature = "without-motion");
pub(crate) const BANDS: bool = !cfg!(feature = "without-bands");
pub(crate) const WIDE_FILTER: bool = !cfg!(feature = "without-wide-filter");
