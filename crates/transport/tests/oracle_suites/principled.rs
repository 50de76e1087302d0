//! Principled surfaces, held to every law. They conserve energy where their base is not white and there is little sheen.

use etalon_optics::spectrum::Outside;
use etalon_optics::{RefractiveIndex, Spectrum};
use etalon_oracle::{laws, scatters_suite};
use etalon_scene::{FacetMasking, MaterialKind, Microfacets, PrincipledLobes, Side};

use super::material::Material;

/// α along u and across it.
fn surface(base: f64, alpha: [f64; 2], lobes: PrincipledLobes) -> MaterialKind {
    of(Spectrum::Constant(base), 1.5, alpha, lobes)
}

fn of(base: Spectrum, index: f64, alpha: [f64; 2], lobes: PrincipledLobes) -> MaterialKind {
    MaterialKind::Principled {
        reflectance: base.into(),
        index: RefractiveIndex::Constant(index),
        facets: Microfacets { masking: FacetMasking::Separable, ..Microfacets::ggx(alpha, 0.4) },
        lobes: Box::new(PrincipledLobes { clear_coat_alpha: 0.1, ..lobes }),
    }
}

fn plain() -> Material {
    Material::new(surface(0.4, [0.25; 2], PrincipledLobes::default()))
}

fn all_lobes() -> MaterialKind {
    let lobes = PrincipledLobes {
        metallic: 0.3,
        specular_tint: 0.5,
        flatness: 0.4,
        sheen: 0.2,
        sheen_tint: 0.5,
        clear_coat: 0.8,
        ..PrincipledLobes::default()
    };
    // Its luminance is that of wavelengths beyond the rendered ones, too.
    let base =
        Spectrum::tabulated(vec![400.0, 600.0, 700.0], vec![0.2, 0.35, 0.3], Outside::Hold).expect("it is right");
    of(base, 1.5, [0.3; 2], lobes)
}

fn brushed() -> Material {
    let lobes = PrincipledLobes { metallic: 1.0, clear_coat: 1.0, ..PrincipledLobes::default() };
    Material::new(surface(0.7, [0.1, 0.5], lobes))
}

/// Nothing is seen but by facets that are tilted.
fn black_metal() -> Material {
    Material::new(surface(0.0, [0.5; 2], PrincipledLobes { metallic: 1.0, ..PrincipledLobes::default() }))
}

fn one_sided() -> Material {
    Material::new(MaterialKind::one_sided(all_lobes(), Side::Back))
}

fn with_clay() -> Material {
    let clay = MaterialKind::OrenNayar { reflectance: Spectrum::Constant(0.6).into(), roughness: 0.5 };
    Material::new(MaterialKind::blend(all_lobes(), clay, 0.5))
}

/// Half of it reflects nothing at all.
fn half_of_nothing() -> Material {
    let part = |metallic: f64| {
        of(Spectrum::Constant(0.0), 1.0, [0.3; 2], PrincipledLobes { metallic, ..PrincipledLobes::default() })
    };
    Material::new(MaterialKind::blend(part(0.0), part(1.0), 0.5))
}

scatters_suite!(half_of_nothing, half_of_nothing());
scatters_suite!(plain, plain());
scatters_suite!(all_lobes, Material::new(all_lobes()));
scatters_suite!(brushed, brushed());
scatters_suite!(black_metal, black_metal());
scatters_suite!(one_side, one_sided());
scatters_suite!(blended, with_clay());

/// However a surface of one width is turned, it is the same.
#[test]
fn surfaces_of_one_width_have_no_grain() {
    laws::is_isotropic(&Material::new(all_lobes()), 1).assert();
    assert!(laws::is_isotropic(&brushed(), 1).into_result().is_err());
}

/// What the documentation says of it: a white rough base with sheen is no possible surface.
#[test]
fn a_white_base_with_sheen_creates_light() {
    let lobes = PrincipledLobes { sheen: 1.0, ..PrincipledLobes::default() };
    let white = Material::new(surface(1.0, [1.0; 2], lobes));
    assert!(laws::energy_is_not_created(&white, 1).into_result().is_err());
}
