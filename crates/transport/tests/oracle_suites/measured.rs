//! Measured BRDFs, held to every law but reciprocity: what was measured need not have it, and what is made up here does not.

use etalon_oracle::{laws, statistics::Budget};
use etalon_scene::{MaterialKind, MeasuredArrays, MeasuredBrdf, MeasuredSurface, Side};
use std::sync::{Arc, LazyLock};

use super::material::Material;

/// Positive numbers that know no symmetry, on a grid of the square for each light: where facets are dense around the normal, as visible ones
/// are, and elsewhere. The first `even` grids are the same at all azimuths.
fn tables(lights: usize, [columns, rows]: [usize; 2], salt: f32, pole: bool, even: usize) -> Vec<f32> {
    let node = |k: usize| {
        let (light, cell) = (k / (columns * rows), k % (columns * rows));
        let y = if light < even { 0.0 } else { (cell / columns) as f32 };
        let x = (cell % columns) as f32 / (columns - 1) as f32;
        let wave = 1.0 + 0.6 * (salt + 1.3 * light as f32 + 3.0 * x + 1.7 * y).sin();
        if pole { wave * (x * x * x + 0.02 * x) * (1.3 - x) } else { wave }
    };
    (0..lights * columns * rows).map(node).collect()
}

fn surface(phi_i: &[f32]) -> MeasuredSurface {
    let lights = 3 * phi_i.len();
    // What looks the same from all sides does so along the normal, too.
    let even = usize::from(phi_i.len() == 1);
    let shape = |columns: usize, rows: usize| [phi_i.len(), 3, rows, columns];
    let spectra = tables(2 * lights, [5, 4], 0.3, false, 2 * even).iter().map(|value| 0.05 * value).collect();
    let arrays = MeasuredArrays {
        theta_i: vec![0.0, 0.6, 1.5],
        phi_i: phi_i.to_vec(),
        wavelengths_nm: vec![450.0, 650.0],
        ndf: ([3, 4], tables(1, [4, 3], 0.1, false, even)),
        sigma: ([3, 4], tables(1, [4, 3], 0.7, false, even)),
        vndf: (shape(9, 5), tables(lights, [9, 5], 0.2, true, even)),
        luminance: (shape(5, 4), tables(lights, [5, 4], 0.9, false, even)),
        spectra: ([phi_i.len(), 3, 2, 4, 5], spectra),
        jacobian: true,
    };
    let brdf = MeasuredBrdf::new(arrays).expect("right arrays");
    MeasuredSurface { brdf: Arc::new(brdf), rotation_rad: 0.5, at_nm: None }
}

const PI: f32 = std::f32::consts::PI;

fn two_sided(phi_i: &[f32]) -> Material {
    Material::new(MaterialKind::Measured { surface: surface(phi_i) })
}

fn one_sided() -> Material {
    let kind = MaterialKind::Measured { surface: surface(&[0.0]) };
    Material::new(MaterialKind::one_sided(kind, Side::Front))
}

/// Half of the surface.
fn with_clay() -> Material {
    let clay = MaterialKind::OrenNayar { reflectance: etalon_optics::Spectrum::Constant(0.6).into(), roughness: 0.5 };
    Material::new(MaterialKind::blend(MaterialKind::Measured { surface: surface(&[-PI, -1.5, 0.0]) }, clay, 0.5))
}

macro_rules! laws_of {
    ($name:ident, $subject:expr) => {
        mod $name {
            use super::*;

            static SUBJECT: LazyLock<Material> = LazyLock::new(|| $subject);
            static ALBEDOS: LazyLock<laws::Albedos> = LazyLock::new(|| laws::Albedos::new(&*SUBJECT, 1));

            #[test]
            fn f_and_pdf_are_proper() {
                laws::f_and_pdf_are_proper(&*SUBJECT, 1).assert();
            }

            #[test]
            fn sample_is_consistent() {
                laws::sample_is_consistent(&*SUBJECT, 1).assert();
            }

            #[test]
            fn energy_is_not_created() {
                ALBEDOS.create_no_energy().assert();
            }

            #[test]
            fn pdf_integrates_to_one() {
                laws::pdf_integrates_to_one(&*SUBJECT, Budget::for_tests(3), 1).assert();
            }

            #[test]
            fn samples_follow_pdf() {
                laws::samples_follow_pdf(&*SUBJECT, Budget::for_tests(3), 1).assert();
            }

            #[test]
            fn furnace_agrees() {
                ALBEDOS.agree_with_samples(&*SUBJECT, Budget::for_tests(3)).assert();
            }
        }
    };
}

laws_of!(isotropic, two_sided(&[0.0]));
laws_of!(half_a_turn, two_sided(&[-PI, -1.5, 0.0]));
laws_of!(two_mirrors, two_sided(&[-PI, -2.5, -0.5 * PI]));
laws_of!(no_symmetry, two_sided(&[-PI, -1.0, 1.0, PI]));
laws_of!(one_side, one_sided());
laws_of!(blended, with_clay());

/// However an isotropic surface is turned, it is the same.
#[test]
fn isotropic_surfaces_have_no_grain() {
    laws::is_isotropic(&two_sided(&[0.0]), 1).assert();
}
