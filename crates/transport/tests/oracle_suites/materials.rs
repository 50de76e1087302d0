//! Every material, held to every law of a BSDF.

use etalon_optics::spectrum::Outside;
use etalon_optics::{ComplexIndex, Fluorescence, Fluorophore, RefractiveIndex, Spectrum};
use etalon_oracle::{laws, scatters_suite, subjects::Scatters};
use etalon_scene::{
    FacetDistribution, FacetMasking, FilmIndex, FilmLayer, Grating, Grooves, Image, ImageTexture, InternalReflection,
    MaterialKind, Metal, Microfacets, NumberTexture, PolarisingSheet, Side, SpectrumTexture, Texels, ThinFilm,
};

use super::material::Material;

fn lambert() -> Material {
    Material::new(MaterialKind::Lambert { reflectance: Spectrum::rgb_reflectance([0.8, 0.3, 0.1]).unwrap().into() })
}

fn metal(name: &str) -> Material {
    Material::new(MaterialKind::Conductor { metal: Metal::Index(ComplexIndex::named(name).unwrap()), film: None })
}

fn glass(interior: &str, exterior: &str) -> Material {
    let index = |name: &str| RefractiveIndex::named(name).unwrap_or(RefractiveIndex::VACUUM);
    Material::new(MaterialKind::Dielectric {
        interior: index(interior),
        exterior: index(exterior),
        priority: None,
        film: None,
    })
}

fn rough_metal(name: &str, alpha: f64, compensated: bool) -> Material {
    let metal = Metal::Index(ComplexIndex::named(name).unwrap());
    Material::new(MaterialKind::RoughConductor { metal, facets: alpha.into(), compensated, film: None })
}

/// Reflects everything: n → 0 with k > 0.
fn lossless_metal(alpha: f64) -> Material {
    let index = ComplexIndex::tabulated(vec![300.0, 900.0], vec![1e-12; 2], vec![3.0; 2]).unwrap();
    Material::new(MaterialKind::RoughConductor {
        metal: Metal::Index(index),
        facets: alpha.into(),
        compensated: true,
        film: None,
    })
}

fn rough_glass(interior: &str, exterior: &str, alpha: f64, compensated: bool) -> Material {
    let index = |name: &str| RefractiveIndex::named(name).unwrap_or(RefractiveIndex::VACUUM);
    let (interior, exterior) = (index(interior), index(exterior));
    Material::new(MaterialKind::RoughDielectric {
        interior,
        exterior,
        facets: alpha.into(),
        compensated,
        priority: None,
        film: None,
    })
}

/// A layer that absorbs and two that do not.
fn film() -> Option<ThinFilm> {
    let layer = |thickness_nm: f64, index| FilmLayer { thickness_nm: thickness_nm.into(), index };
    let clear = |n| FilmIndex::Transparent(RefractiveIndex::Constant(n));
    let metal = FilmIndex::Absorbing(ComplexIndex::named("Ag").unwrap());
    Some(ThinFilm { layers: vec![layer(90.0, clear(1.38)), layer(8.0, metal), layer(140.0, clear(2.1))], at_nm: None })
}

fn coated_glass(alpha: Option<f64>) -> Material {
    let (interior, exterior) = (RefractiveIndex::Constant(1.52), RefractiveIndex::named("water").unwrap());
    Material::new(match alpha {
        None => MaterialKind::Dielectric { interior, exterior, priority: None, film: film() },
        Some(alpha) => MaterialKind::RoughDielectric {
            interior,
            exterior,
            facets: alpha.into(),
            compensated: false,
            priority: None,
            film: film(),
        },
    })
}

fn coated_metal(alpha: Option<f64>) -> Material {
    let metal = Metal::Index(ComplexIndex::named("Al").unwrap());
    Material::new(match alpha {
        None => MaterialKind::Conductor { metal, film: film() },
        Some(alpha) => MaterialKind::RoughConductor { metal, facets: alpha.into(), compensated: true, film: film() },
    })
}

fn coated_pane() -> Material {
    Material::new(MaterialKind::ThinDielectric { index: RefractiveIndex::Constant(1.5), film: film() })
}

/// Orders that all leave, some that leave at some angles alone, and one that never does.
fn grating(transmits: bool) -> Material {
    let orders = vec![(0, 0.3), (1, 0.25), (-1, 0.15), (2, 0.1), (-3, 0.05), (9, 0.05)];
    let grating = Grating { period_nm: 1600.0, orders, grooves: Grooves::Straight(0.4), transmits, at_nm: None };
    Material::new(MaterialKind::Grating { reflectance: Spectrum::Constant(0.8).into(), grating })
}

/// What it does to light that keeps its wavelength.
fn fluorescent() -> Material {
    let band = |from, to| Spectrum::tabulated(vec![from, to], vec![0.3; 2], Outside::Zero).unwrap();
    let dye = Fluorophore::new(band(380.0, 450.0), band(500.0, 600.0), 0.9, [360.0, 830.0]).unwrap();
    let (reflectance, fluorescence) = (Spectrum::Constant(0.6).into(), Fluorescence::Fluorophores(vec![dye]));
    Material::new(MaterialKind::Fluorescent { reflectance, fluorescence })
}

scatters_suite!(fluorescent, fluorescent());
scatters_suite!(reflection_grating, grating(false));
scatters_suite!(transmission_grating, grating(true));
scatters_suite!(coated_glass, coated_glass(None));
scatters_suite!(coated_rough_glass, coated_glass(Some(0.3)));
scatters_suite!(coated_metal, coated_metal(None));
scatters_suite!(coated_rough_metal, coated_metal(Some(0.3)));
scatters_suite!(coated_pane, coated_pane());

scatters_suite!(lambert, lambert());
scatters_suite!(gold, metal("Au"));
scatters_suite!(glass_in_water, glass("N-BK7", "water"));
scatters_suite!(rough_gold, rough_metal("Au", 0.3, true));
scatters_suite!(lossless_metal_furnace, lossless_metal(1.0));
scatters_suite!(rough_silver_without_compensation, rough_metal("Ag", 0.3, false));
scatters_suite!(rough_glass, rough_glass("N-BK7", "vacuum", 0.4, true));
scatters_suite!(very_rough_diamond_in_water, rough_glass("diamond", "water", 1.0, true));

fn plastic(rho: f64, alpha: f64) -> Material {
    let (reflectance, coat) = (Spectrum::Constant(rho).into(), RefractiveIndex::Constant(1.5));
    Material::new(MaterialKind::Plastic {
        reflectance,
        coat,
        facets: (alpha > 0.0).then(|| alpha.into()),
        internal_reflection: InternalReflection::Coloured,
        compensated: true,
    })
}

/// As if its ground were white from the second reflection on.
fn coloured_once(rho: f64, alpha: f64) -> Material {
    let (reflectance, coat) = (Spectrum::Constant(rho).into(), RefractiveIndex::Constant(1.5));
    let (facets, internal_reflection) = ((alpha > 0.0).then(|| alpha.into()), InternalReflection::Uncoloured);
    Material::new(MaterialKind::Plastic { reflectance, coat, facets, internal_reflection, compensated: true })
}

fn oren_nayar(rho: f64, roughness: f64) -> Material {
    Material::new(MaterialKind::OrenNayar { reflectance: Spectrum::Constant(rho).into(), roughness })
}

/// Green is passed, and more of it than is reflected.
fn leaf() -> Material {
    Material::new(MaterialKind::Translucent {
        reflectance: Spectrum::rgb_reflectance([0.1, 0.3, 0.05]).unwrap().into(),
        transmittance: Spectrum::rgb_reflectance([0.05, 0.6, 0.0]).unwrap().into(),
    })
}

fn pane() -> Material {
    Material::new(MaterialKind::ThinDielectric { index: RefractiveIndex::Constant(1.5), film: None })
}

fn mixture() -> Material {
    let first = MaterialKind::Mirror { reflectance: Spectrum::Constant(0.8).into() };
    let second = MaterialKind::OrenNayar { reflectance: Spectrum::Constant(0.6).into(), roughness: 0.5 };
    Material::new(MaterialKind::blend(first, second, 0.3))
}

/// Where rough metal loses light below the surface, the leaf shows the light that it passes.
fn rough_silver_before_a_leaf() -> Material {
    Material::new(MaterialKind::blend(rough_metal("Ag", 1.0, false).kind, leaf().kind, 0.5))
}

/// An image of one texel.
fn texel(rgb: [f32; 3]) -> ImageTexture {
    ImageTexture::new(Image::new(1, 1, Texels::F32(vec![rgb])))
}

/// Smooth below a roughness of 0.2, rougher from there on; at 0.7 now, between two rough ones.
fn metal_of_varied_roughness() -> Material {
    let metal = Metal::Reflectance(Spectrum::rgb_reflectance([0.9, 0.6, 0.3]).unwrap().into());
    let rough = |alpha: f64| MaterialKind::RoughConductor {
        metal: metal.clone(),
        facets: alpha.into(),
        compensated: true,
        film: None,
    };
    let parts = vec![
        (0.2, MaterialKind::Conductor { metal: metal.clone(), film: None }),
        (0.55, rough(0.3)),
        (0.9, rough(0.81)),
    ];
    Material::new(MaterialKind::Blend { parts, by: NumberTexture::Image(texel([0.7; 3])) })
}

/// Glass in water, as smooth as an image says: between a smooth interface and a rough one.
fn glass_of_varied_roughness() -> Material {
    let index = |name: &str| RefractiveIndex::named(name).unwrap();
    let (interior, exterior) = (index("N-BK7"), index("water"));
    let smooth =
        MaterialKind::Dielectric { interior: interior.clone(), exterior: exterior.clone(), priority: None, film: None };
    let rough = MaterialKind::RoughDielectric {
        interior,
        exterior,
        facets: 0.5.into(),
        compensated: true,
        priority: None,
        film: None,
    };
    Material::new(MaterialKind::Blend {
        parts: vec![(0.0, smooth), (0.7, rough)],
        by: NumberTexture::Image(texel([0.5; 3])),
    })
}

/// A ground and a coat by images.
fn painted_plastic() -> Material {
    let reflectance = SpectrumTexture::Image(texel([0.9, 0.2, 0.4]));
    Material::new(MaterialKind::Plastic {
        reflectance,
        coat: RefractiveIndex::Constant(1.5),
        facets: Some(0.3.into()),
        internal_reflection: InternalReflection::Coloured,
        compensated: true,
    })
}

/// Metal that reflects all that a metal of a given reflectance can.
fn white_metal(alpha: f64) -> Material {
    let metal = Metal::Reflectance(Spectrum::Constant(1.0).into());
    Material::new(MaterialKind::RoughConductor { metal, facets: alpha.into(), compensated: true, film: None })
}

scatters_suite!(varied_metal, metal_of_varied_roughness());
scatters_suite!(varied_glass, glass_of_varied_roughness());
scatters_suite!(painted_plastic, painted_plastic());
scatters_suite!(white_metal, white_metal(0.7));

scatters_suite!(smooth_plastic, plastic(0.7, 0.0));
scatters_suite!(white_smooth_plastic, plastic(1.0, 0.0));
scatters_suite!(white_rough_plastic, plastic(1.0, 0.4));
scatters_suite!(smooth_plastic_coloured_once, coloured_once(0.7, 0.0));
scatters_suite!(rough_plastic_coloured_once, coloured_once(0.7, 0.4));
scatters_suite!(oren_nayar, oren_nayar(0.5, 0.4));
scatters_suite!(white_oren_nayar, oren_nayar(1.0, 1.0));
scatters_suite!(leaf, leaf());
scatters_suite!(pane, pane());

/// A tinted polariser that is not quite one.
fn polariser() -> Material {
    let transmittance = Spectrum::rgb_reflectance([0.8, 0.7, 0.9]).unwrap();
    let sheet = PolarisingSheet::Polariser { transmittance, extinction: 0.1 };
    Material::new(MaterialKind::PolarisingSheet { axis: [1.0, 0.0, 0.0], sheet })
}

scatters_suite!(polariser, polariser());
scatters_suite!(mirror_and_clay, mixture());
scatters_suite!(rough_silver_before_a_leaf, rough_silver_before_a_leaf());

/// Facets of two widths, turned.
fn brushed(u: f64, v: f64) -> Microfacets {
    Microfacets::ggx([u, v], 0.6)
}

fn brushed_gold(compensated: bool) -> Material {
    let metal = Metal::Index(ComplexIndex::named("Au").unwrap());
    Material::new(MaterialKind::RoughConductor { metal, facets: brushed(0.15, 0.5), compensated, film: None })
}

/// Reflects everything: n → 0 with k > 0.
fn lossless_brushed_metal() -> Material {
    let index = ComplexIndex::tabulated(vec![300.0, 900.0], vec![1e-12; 2], vec![3.0; 2]).unwrap();
    let metal = Metal::Index(index);
    Material::new(MaterialKind::RoughConductor { metal, facets: brushed(1.0, 0.2), compensated: true, film: None })
}

fn brushed_glass() -> Material {
    let (interior, exterior) = (RefractiveIndex::named("N-BK7").unwrap(), RefractiveIndex::VACUUM);
    let facets = brushed(0.6, 0.2);
    Material::new(MaterialKind::RoughDielectric {
        interior,
        exterior,
        facets,
        compensated: false,
        priority: None,
        film: None,
    })
}

fn brushed_plastic() -> Material {
    let (reflectance, coat) = (Spectrum::Constant(1.0).into(), RefractiveIndex::Constant(1.5));
    Material::new(MaterialKind::Plastic {
        reflectance,
        coat,
        facets: Some(brushed(0.2, 0.6)),
        internal_reflection: InternalReflection::Coloured,
        compensated: true,
    })
}

/// Two grains that cross.
fn cross_brushed() -> Material {
    let metal = Metal::Reflectance(Spectrum::Constant(0.8).into());
    let part = |rotation_rad| MaterialKind::RoughConductor {
        metal: metal.clone(),
        facets: Microfacets::ggx([0.4, 0.15], rotation_rad),
        compensated: true,
        film: None,
    };
    Material::new(MaterialKind::blend(part(0.0), part(1.2), 0.5))
}

scatters_suite!(brushed_gold, brushed_gold(true));
scatters_suite!(brushed_gold_without_compensation, brushed_gold(false));
scatters_suite!(lossless_brushed_metal_furnace, lossless_brushed_metal());
scatters_suite!(brushed_glass, brushed_glass());
scatters_suite!(white_brushed_plastic, brushed_plastic());
scatters_suite!(cross_brushed, cross_brushed());

/// Facets of Beckmann's distribution.
fn gaussian(facets: Microfacets, masking: FacetMasking) -> Microfacets {
    Microfacets { distribution: FacetDistribution::Beckmann, masking, ..facets }
}

fn beckmann_metal(facets: Microfacets, compensated: bool) -> Material {
    let index = ComplexIndex::tabulated(vec![300.0, 900.0], vec![1e-12; 2], vec![3.0; 2]).unwrap();
    Material::new(MaterialKind::RoughConductor { metal: Metal::Index(index), facets, compensated, film: None })
}

fn beckmann_glass(alpha: f64, masking: FacetMasking, compensated: bool) -> Material {
    let (interior, exterior) = (RefractiveIndex::named("N-BK7").unwrap(), RefractiveIndex::VACUUM);
    let facets = gaussian(alpha.into(), masking);
    Material::new(MaterialKind::RoughDielectric { interior, exterior, facets, compensated, priority: None, film: None })
}

fn beckmann_plastic() -> Material {
    Material::new(MaterialKind::Plastic {
        reflectance: Spectrum::Constant(1.0).into(),
        coat: RefractiveIndex::Constant(1.5),
        facets: Some(gaussian(0.4.into(), FacetMasking::Correlated)),
        internal_reflection: InternalReflection::Coloured,
        compensated: true,
    })
}

scatters_suite!(beckmann_metal, beckmann_metal(gaussian(0.8.into(), FacetMasking::Correlated), true));
scatters_suite!(
    beckmann_metal_of_separable_masking,
    beckmann_metal(gaussian(0.8.into(), FacetMasking::Separable), true)
);
scatters_suite!(brushed_beckmann_metal, beckmann_metal(gaussian(brushed(0.2, 0.6), FacetMasking::Correlated), true));
scatters_suite!(beckmann_glass, beckmann_glass(0.4, FacetMasking::Correlated, true));
scatters_suite!(beckmann_glass_of_separable_masking, beckmann_glass(0.4, FacetMasking::Separable, false));
scatters_suite!(white_beckmann_plastic, beckmann_plastic());
scatters_suite!(
    ggx_metal_of_separable_masking,
    beckmann_metal(Microfacets { masking: FacetMasking::Separable, ..0.6.into() }, true)
);

#[test]
fn brushed_materials_are_others_turned_about_their_normal() {
    let subjects: [&dyn Scatters; 4] =
        [&brushed_gold(true), &brushed_gold(false), &brushed_glass(), &brushed_plastic()];
    subjects.into_iter().for_each(|subject| assert!(!laws::is_isotropic(subject, 1).pass));
}

fn one_sided(kind: MaterialKind, side: Side) -> Material {
    Material::new(MaterialKind::one_sided(kind, side))
}

fn clay() -> MaterialKind {
    MaterialKind::OrenNayar { reflectance: Spectrum::Constant(0.6).into(), roughness: 0.5 }
}

fn silvered() -> MaterialKind {
    MaterialKind::Mirror { reflectance: Spectrum::Constant(0.8).into() }
}

scatters_suite!(clay_from_the_front, one_sided(clay(), Side::Front));
scatters_suite!(mirror_from_the_back, one_sided(silvered(), Side::Back));

fn tinted(of: Material) -> Material {
    let [reflected, transmitted] = [0.75, 0.5].map(|share| Spectrum::Constant(share).into());
    Material::new(MaterialKind::Tinted { kind: Box::new(of.kind.clone()), reflected, transmitted })
}

scatters_suite!(tinted_rough_glass, tinted(rough_glass("N-BK7", "vacuum", 0.4, false)));
scatters_suite!(tinted_glass, tinted(glass("N-BK7", "vacuum")));

/// Of whose ground no light comes back from below the coat.
fn without_return(rho: f64, alpha: f64) -> Material {
    let (reflectance, coat) = (Spectrum::Constant(rho).into(), RefractiveIndex::Constant(1.5));
    let (facets, internal_reflection) = ((alpha > 0.0).then(|| alpha.into()), InternalReflection::Lost);
    Material::new(MaterialKind::Plastic { reflectance, coat, facets, internal_reflection, compensated: true })
}

scatters_suite!(plastic_without_return, without_return(1.0, 0.0));
scatters_suite!(rough_plastic_without_return, without_return(1.0, 0.3));
/// Whose facets lose what they hide.
fn hiding(internal_reflection: InternalReflection, alpha: f64) -> Material {
    let (reflectance, coat) = (Spectrum::Constant(0.9).into(), RefractiveIndex::named("N-SF11").expect("a glass"));
    let facets = Some(Microfacets { masking: FacetMasking::Separable, ..alpha.into() });
    Material::new(MaterialKind::Plastic { reflectance, coat, facets, internal_reflection, compensated: false })
}

scatters_suite!(plastic_under_a_lossy_coat, hiding(InternalReflection::Coloured, 0.5));
scatters_suite!(plastic_coloured_once_under_a_lossy_coat, hiding(InternalReflection::Uncoloured, 0.2));
scatters_suite!(tinted_coat, tinted(plastic(0.7, 0.0)));
scatters_suite!(tinted_rough_coat, tinted(plastic(0.7, 0.3)));

/// No other has a grain but the sheets, whose axis is in their Mueller matrices alone.
#[test]
fn every_material_is_the_same_turned_about_its_normal() {
    let subjects: [&dyn Scatters; 10] = [
        &lambert(),
        &rough_metal("Au", 0.3, true),
        &rough_metal("Ag", 0.3, false),
        &rough_glass("N-BK7", "vacuum", 0.4, true),
        &painted_plastic(),
        &plastic(0.7, 0.0),
        &oren_nayar(0.5, 0.4),
        &oren_nayar(1.0, 1.0),
        &mixture(),
        &metal_of_varied_roughness(),
    ];
    subjects.into_iter().for_each(|subject| laws::is_isotropic(subject, 1).assert());
}
