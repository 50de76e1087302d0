//! What the rest of the renderer asks of a material: each file of this folder states it of its own.

use etalon_scene::Microfacets;

/// Properties of the scattering at a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Properties {
    /// Light from any direction may be scattered toward the camera: shadow rays are of use.
    pub solid_angle: bool,
    /// It reflects light in a single direction (a delta).
    pub delta_reflection: bool,
    /// It transmits light in a single direction (a delta).
    pub delta_transmission: bool,
    /// Light passes it straight on, as if it were not there but for what it takes away: a pane.
    pub passes_straight: bool,
    /// It is known to scatter no light at all.
    pub dark: bool,
    /// It may polarise unpolarised light by an axis of its own.
    pub polarising_axis: bool,
    /// What it does depends on the directions in which texture coordinates grow.
    pub takes_tangents: bool,
    /// What it does depends on the medium that it stands in.
    pub takes_medium: bool,
    /// Light of other wavelengths is given back at those of the path.
    pub fluoresces: bool,
    /// What it is called where a delta is the reason for something.
    pub smooth_name: &'static str,
}

impl Properties {
    /// Of a surface without deltas.
    pub(super) const SOLID_ANGLE: Self = Self {
        solid_angle: true,
        delta_reflection: false,
        delta_transmission: false,
        passes_straight: false,
        dark: false,
        polarising_axis: false,
        takes_tangents: false,
        takes_medium: false,
        fluoresces: false,
        smooth_name: "",
    };

    /// Of a rough surface.
    pub(super) fn of_facets(facets: &Microfacets) -> Self {
        Self { takes_tangents: !facets.is_isotropic(), ..Self::SOLID_ANGLE }
    }

    /// Of a surface that only reflects, in a single direction.
    pub(super) const fn mirror(smooth_name: &'static str) -> Self {
        Self { solid_angle: false, delta_reflection: true, smooth_name, ..Self::SOLID_ANGLE }
    }

    /// Of a surface that only transmits, in a single direction.
    pub(super) const fn sheet(smooth_name: &'static str) -> Self {
        Self { delta_reflection: false, delta_transmission: true, ..Self::mirror(smooth_name) }
    }

    /// Of a surface that reflects and transmits, each in a single direction.
    pub(super) const fn pane(smooth_name: &'static str) -> Self {
        Self { delta_transmission: true, ..Self::mirror(smooth_name) }
    }

    /// Whether some light goes on in a single direction.
    pub fn has_delta(&self) -> bool {
        self.delta_reflection || self.delta_transmission
    }

    /// Whether all light goes on in single directions.
    pub fn is_specular(&self) -> bool {
        self.has_delta() && !self.solid_angle
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Bsdf, Shading, properties};
    use super::*;
    use crate::mis::Density;
    use etalon_optics::{ComplexIndex, Lanes, RefractiveIndex, Spectrum, Vec3};
    use etalon_scene::{
        FilmIndex, FilmLayer, InternalReflection, MaterialKind, MeasuredArrays, MeasuredBrdf, MeasuredSurface, Metal,
        PolarisingSheet as Sheet, PrincipledLobes, Side, ThinFilm,
    };

    /// A measured BRDF whose tables have one value each.
    fn measured(spectra: f32) -> MaterialKind {
        let arrays = MeasuredArrays {
            theta_i: vec![0.0],
            phi_i: vec![0.0],
            wavelengths_nm: vec![550.0],
            ndf: ([2, 2], vec![1.0; 4]),
            sigma: ([2, 2], vec![1.0; 4]),
            vndf: ([1, 1, 2, 2], vec![1.0; 4]),
            luminance: ([1, 1, 2, 2], vec![1.0; 4]),
            spectra: ([1, 1, 1, 2, 2], vec![spectra; 4]),
            jacobian: true,
        };
        let brdf = MeasuredBrdf::new(arrays).unwrap();
        MaterialKind::Measured { surface: MeasuredSurface { brdf: brdf.into(), rotation_rad: 0.0, at_nm: None } }
    }

    fn kinds() -> Vec<MaterialKind> {
        let (interior, exterior) = (RefractiveIndex::Constant(1.5), RefractiveIndex::VACUUM);
        let sheet = |sheet| MaterialKind::PolarisingSheet { axis: [1.0, 0.0, 0.0], sheet };
        let polariser = |t| Sheet::Polariser { transmittance: Spectrum::Constant(t), extinction: 0.0 };
        let mut kinds = vec![
            MaterialKind::Black,
            MaterialKind::Dielectric {
                interior: interior.clone(),
                exterior: exterior.clone(),
                priority: None,
                film: None,
            },
            MaterialKind::RoughDielectric {
                interior: interior.clone(),
                exterior,
                facets: 0.3.into(),
                compensated: false,
                priority: None,
                film: None,
            },
            MaterialKind::ThinDielectric { index: interior.clone(), film: None },
            sheet(Sheet::Retarder { retardance_rad: 1.0, at_nm: None }),
        ];
        for r in [0.0, 0.5] {
            let reflectance = || Spectrum::Constant(r).into();
            let metal = || Metal::Reflectance(reflectance());
            kinds.extend([
                MaterialKind::Lambert { reflectance: reflectance() },
                MaterialKind::Mirror { reflectance: reflectance() },
                MaterialKind::Conductor { metal: metal(), film: None },
                MaterialKind::RoughConductor { metal: metal(), facets: 0.3.into(), compensated: false, film: None },
                MaterialKind::OrenNayar { reflectance: reflectance(), roughness: 0.5 },
                sheet(polariser(r)),
            ]);
        }
        let grained = Microfacets::ggx([0.1, 0.4], 0.5);
        for facets in [None, Some(0.3.into()), Some(grained)] {
            let (reflectance, coat) = (Spectrum::Constant(0.5).into(), interior.clone());
            let internal_reflection = InternalReflection::Coloured;
            kinds.push(MaterialKind::Plastic { reflectance, coat, facets, internal_reflection, compensated: true });
        }
        for kind in [1, 2, 3, 7] {
            let [reflected, transmitted] = [0.5, 0.25].map(|share| Spectrum::Constant(share).into());
            kinds.push(MaterialKind::Tinted { kind: Box::new(kinds[kind].clone()), reflected, transmitted });
        }
        for (kind, side) in [(11, Side::Front), (12, Side::Back), (14, Side::Front)] {
            kinds.push(MaterialKind::one_sided(kinds[kind].clone(), side));
        }
        for (r, t) in [(0.5, 0.25), (0.0, 0.5), (0.0, 0.0)] {
            let [reflectance, transmittance] = [r, t].map(|share| Spectrum::Constant(share).into());
            kinds.push(MaterialKind::Translucent { reflectance, transmittance });
        }
        let both = |first: usize, second: usize| MaterialKind::blend(kinds[first].clone(), kinds[second].clone(), 0.5);
        let blends = [both(0, 1), both(1, 3), both(5, 6), both(0, 0), both(7, 17)];
        kinds.extend(blends);
        kinds.extend([measured(0.5), measured(0.0)]);
        let lobes = PrincipledLobes { clear_coat: 1.0, clear_coat_alpha: 0.1, ..PrincipledLobes::default() };
        kinds.extend([0.0, 0.5].map(|r| MaterialKind::Principled {
            reflectance: Spectrum::Constant(r).into(),
            index: interior.clone(),
            facets: grained,
            lobes: Box::new(lobes),
        }));
        // Some nanometres of silver pass a part and reflect a part; also on a metal that would reflect nothing.
        let film = || {
            let index = FilmIndex::Absorbing(ComplexIndex::named("Ag").unwrap());
            Some(ThinFilm { layers: vec![FilmLayer { thickness_nm: 20.0.into(), index }], at_nm: None })
        };
        let (vacuum, dark) = (RefractiveIndex::VACUUM, || Metal::Reflectance(Spectrum::Constant(0.0).into()));
        let (interior, exterior) = (vacuum.clone(), vacuum);
        kinds.extend([
            MaterialKind::Dielectric { interior, exterior: exterior.clone(), priority: None, film: film() },
            MaterialKind::RoughDielectric {
                interior: RefractiveIndex::Constant(1.5),
                exterior,
                facets: 0.3.into(),
                compensated: false,
                priority: None,
                film: film(),
            },
            MaterialKind::ThinDielectric { index: RefractiveIndex::Constant(1.5), film: film() },
            MaterialKind::Conductor { metal: dark(), film: film() },
            MaterialKind::RoughConductor { metal: dark(), facets: 0.3.into(), compensated: true, film: film() },
        ]);
        kinds
    }

    /// What is stated of a material is what it does: the directions that it draws from both sides are looked at.
    #[test]
    fn materials_have_the_properties_that_they_state() {
        let at = Shading::flat(Vec3::new(0.0, 0.0, 1.0)).with_axis(Vec3::new(1.0, 0.0, 0.0));
        for kind in kinds() {
            let bsdf = Bsdf::new(&kind, [380.0, 780.0]);
            let (mut found, mut light) = (Properties::default(), 0.0);
            // Glass reflects one in thirty here, and half of a blend is glass.
            let number = |i: u32, of: u32| (f64::from(i % of) + 0.5) / f64::from(of);
            for (i, wo) in (0..1024).flat_map(|i| [1.0, -1.0].map(|side| (i, Vec3::new(0.6, 0.0, 0.8 * side)))) {
                let u = [number(i, 64), number(i / 64, 4), number(i / 256, 4)];
                let Some(next) = bsdf.sample(&Lanes([550.0]), &at, wo, u) else { continue };
                light += next.weight[0];
                match next.density {
                    Density::SolidAngle(_) => found.solid_angle = true,
                    Density::Delta if next.wi.z * wo.z > 0.0 => found.delta_reflection = true,
                    Density::Delta => found.delta_transmission = true,
                }
            }
            let stated = properties(&kind);
            let of = |p: Properties| (p.solid_angle, p.delta_reflection, p.delta_transmission);
            assert_eq!(of(stated), of(found), "{kind:?}");
            assert!(!stated.dark || light == 0.0, "{kind:?} scatters {light}");
            assert_eq!(stated.has_delta(), !stated.smooth_name.is_empty(), "{kind:?}");
        }
    }
}
