//! Warps against their densities, and files that are right or wrong.

use super::*;
use proptest::prelude::*;

/// A smooth field of positive numbers that knows no symmetry.
fn field(sizes: &[usize]) -> Vec<f32> {
    let count: usize = sizes.iter().product();
    (0..count).map(|i| 0.6 + 0.5 * (0.7 * i as f32 + 0.3 * (i * i % 11) as f32).sin()).collect()
}

/// Right arrays: two angles, as many azimuths, three wavelengths, 4 × 3 nodes.
fn arrays(phi_i: &[f32]) -> MeasuredArrays {
    let lights = phi_i.len();
    MeasuredArrays {
        theta_i: vec![0.1, 1.5],
        phi_i: phi_i.to_vec(),
        wavelengths_nm: vec![400.0, 500.0, 700.0],
        ndf: ([3, 4], field(&[3, 4])),
        sigma: ([2, 3], field(&[2, 3])),
        vndf: ([lights, 2, 3, 4], field(&[lights, 2, 3, 4])),
        luminance: ([lights, 2, 4, 3], field(&[lights, 2, 4, 3])),
        spectra: ([lights, 2, 3, 4, 3], field(&[lights, 2, 3, 4, 3])),
        jacobian: true,
    }
}

const PI32: f32 = std::f32::consts::PI;
const AZIMUTHS: [f32; 3] = [-PI32, -1.0, 0.0];

/// A field of a tensor file: its name, the type of its numbers, its extents and its bytes.
type Field = (&'static str, u8, Vec<u64>, Vec<u8>);

fn floats(name: &'static str, shape: &[usize], values: &[f32]) -> Field {
    let shape = shape.iter().map(|extent| *extent as u64).collect();
    (name, 10, shape, values.iter().flat_map(|value| value.to_le_bytes()).collect())
}

fn fields(arrays: &MeasuredArrays) -> Vec<Field> {
    vec![
        ("description", 1, vec![4], b"test".to_vec()),
        floats("theta_i", &[arrays.theta_i.len()], &arrays.theta_i),
        floats("phi_i", &[arrays.phi_i.len()], &arrays.phi_i),
        floats("wavelengths", &[arrays.wavelengths_nm.len()], &arrays.wavelengths_nm),
        floats("ndf", &arrays.ndf.0, &arrays.ndf.1),
        floats("sigma", &arrays.sigma.0, &arrays.sigma.1),
        floats("vndf", &arrays.vndf.0, &arrays.vndf.1),
        floats("luminance", &arrays.luminance.0, &arrays.luminance.1),
        floats("spectra", &arrays.spectra.0, &arrays.spectra.1),
        ("jacobian", 1, vec![1], vec![u8::from(arrays.jacobian)]),
    ]
}

fn file(fields: &[Field]) -> Vec<u8> {
    let described: usize = fields.iter().map(|(name, _, shape, _)| 13 + name.len() + 8 * shape.len()).sum();
    let mut at = (18 + described) as u64;
    let mut bytes = b"tensor_file\0\x01\0".to_vec();
    bytes.extend((fields.len() as u32).to_le_bytes());
    for (name, kind, shape, numbers) in fields {
        bytes.extend((name.len() as u16).to_le_bytes());
        bytes.extend(name.bytes());
        bytes.extend((shape.len() as u16).to_le_bytes());
        bytes.push(*kind);
        bytes.extend(at.to_le_bytes());
        shape.iter().for_each(|extent| bytes.extend(extent.to_le_bytes()));
        at += numbers.len() as u64;
    }
    fields.iter().for_each(|(.., numbers)| bytes.extend(numbers));
    bytes
}

fn right() -> Vec<Field> {
    fields(&arrays(&AZIMUTHS))
}

#[test]
fn a_file_is_read_as_it_was_written() {
    let (brdf, changed) = read_measured(&file(&right())).expect("it is right");
    assert_eq!(brdf, MeasuredBrdf::new(arrays(&AZIMUTHS)).expect("they are right"));
    assert_eq!((changed, brdf.symmetry(), brdf.is_grey(), brdf.is_zero()), (None, Symmetry::HalfTurn, false, false));
    // Half way between two wavelengths, at a node of angles and places, and beyond the last wavelength.
    let slices = brdf.light(f64::from(0.1_f32), f64::from(-PI32));
    let at = |colour: usize| f64::from(field(&[3, 2, 3, 4, 3])[colour * 12 + 4]);
    let [half, last] = brdf.spectra(&slices, [0.5, 1.0 / 3.0], [450.0, 900.0]);
    assert!((half - 0.5 * (at(0) + at(1))).abs() < 1e-12 && (last - at(2)).abs() < 1e-12, "{half}, {last}");
}

#[test]
fn the_azimuths_of_the_light_say_how_a_material_may_be_turned() {
    let symmetry = |phi_i: &[f32]| MeasuredBrdf::new(arrays(phi_i)).map(|brdf| brdf.symmetry());
    assert_eq!(symmetry(&[0.0]), Ok(Symmetry::Isotropic));
    assert_eq!(symmetry(&[-PI32, PI32]), Ok(Symmetry::Isotropic));
    assert_eq!(symmetry(&[-PI32, -2.0, -0.5 * PI32]), Ok(Symmetry::Mirrors));
    assert_eq!(symmetry(&[-PI32, 0.0, PI32]), Ok(Symmetry::None));
    assert!(symmetry(&[-PI32, -2.0, -1.0]).is_err_and(|why| why.contains("\"phi_i\" reaches from")));
    assert!(symmetry(&[0.0, 1.0, 3.0]).is_err_and(|why| why.contains("it must reach from −π")));
}

fn wrong_bytes(bytes: &[u8], says: &str) {
    let why = read_measured(bytes).expect_err(says);
    assert!(why.contains(says), "{why:?} does not say {says:?}");
}

/// With one field changed.
fn wrong(name: &str, change: impl FnOnce(&mut Field), says: &str) {
    let mut fields = right();
    change(fields.iter_mut().find(|field| field.0 == name).expect("a field"));
    wrong_bytes(&file(&fields), says);
}

#[test]
fn what_is_wrong_with_a_container_is_said() {
    wrong_bytes(b"", "too short");
    wrong_bytes(&[b'x'; 100], "does not begin with");
    wrong_bytes(b"tensor_file\0\x02\0\0\0\0\0", "version 2.0; 1.0 is read");
    wrong_bytes(b"tensor_file\0\x01\0\xff\xff\xff\xff", "4294967295 fields; at most 256");
    wrong_bytes(b"tensor_file\0\x01\0\0\0\0\0", "no field \"spectra\"");
    wrong_bytes(b"tensor_file\0\x01\0\x01\0\0\0\x05\0nd", "within the description of its field 1");
    wrong_bytes(b"tensor_file\0\x01\0\x01\0\0\0\x01\0\xff\0\0\x01\0\0\0\0\0\0\0\0", "no text");
    wrong("ndf", |field| field.1 = 99, "\"ndf\" are of the unknown type 99");
    wrong("ndf", |field| field.1 = 0, "unknown type 0");
    wrong("ndf", |field| field.1 = 5, "\"ndf\" are no floating-point numbers of 32 bits");
    wrong(
        "ndf",
        |field| field.2 = vec![1 << 40, 1 << 40],
        "\"ndf\" of the extents [1099511627776, 1099511627776] does not fit",
    );
    wrong("ndf", |field| field.2 = vec![1; 9], "9 dimensions; at most 8");
    wrong("ndf", |field| field.2 = vec![12], "\"ndf\" has the extents [12]; it has 2");
    wrong("jacobian", |field| field.2 = vec![0], "\"jacobian\" is not one byte");
    wrong("jacobian", |field| field.3 = vec![7], "\"jacobian\" is 7");
    wrong("theta_i", |field| field.0 = "theta", "no field \"theta_i\"");
    wrong("theta_i", |field| field.0 = "phi_i", "two fields \"phi_i\"");
    wrong("spectra", |field| field.0 = "rgb", "colours (\"rgb\") and no spectra");
    let overlapping: Vec<u8> = {
        // Every field begins where the first does.
        let all: Vec<Field> = ["a", "b", "c"].map(|name| (name, 1, vec![400], vec![0; 400])).into();
        let mut bytes = file(&all);
        let first = bytes[18 + 5 + 1..][..8].to_vec();
        (0..3).for_each(|i| bytes[18 + i * 22 + 6..][..8].copy_from_slice(&first));
        bytes.truncate(18 + 3 * 22 + 400);
        bytes
    };
    wrong_bytes(&overlapping, "overlap");
    // Cut anywhere, it is refused and not more.
    let whole = file(&right());
    (0..whole.len()).for_each(|end| assert!(read_measured(&whole[..end]).is_err(), "{end}"));
}

fn wrong_arrays(change: impl FnOnce(&mut MeasuredArrays), says: &str) {
    let mut arrays = arrays(&AZIMUTHS);
    change(&mut arrays);
    let why = MeasuredBrdf::new(arrays).expect_err(says);
    assert!(why.contains(says), "{why:?} does not say {says:?}");
}

#[test]
fn what_is_wrong_with_arrays_is_said() {
    wrong_arrays(|a| a.theta_i.reverse(), "\"theta_i\" does not rise: after 1.5 comes 0.1");
    wrong_arrays(|a| a.theta_i[0] = f32::NAN, "\"theta_i\" does not rise");
    wrong_arrays(|a| a.theta_i[1] = 2.0, "\"theta_i\" has 2, which is not from 0 to 1.57");
    wrong_arrays(|a| a.phi_i[1] = 1.0, "\"phi_i\" does not rise");
    wrong_arrays(|a| a.wavelengths_nm.clear(), "\"wavelengths\" is empty");
    wrong_arrays(|a| a.wavelengths_nm.truncate(2), "\"spectra\" has 3 wavelengths, but \"wavelengths\" has 2");
    wrong_arrays(|a| a.wavelengths_nm[0] = -400.0, "\"wavelengths\" has -400");
    wrong_arrays(|a| a.ndf.1[5] = f32::INFINITY, "value 5 of \"ndf\" is inf");
    wrong_arrays(|a| a.ndf.1[5] = -1.0, "value 5 of \"ndf\" is -1: it must be 0 or above");
    wrong_arrays(|a| a.ndf = ([12, 1], field(&[12])), "\"ndf\" has 1 × 12 values at each angle");
    wrong_arrays(|a| a.sigma.1[4] = 0.0, "\"sigma\" is 0 for a direction");
    wrong_arrays(|a| a.vndf.0 = [2, 3, 3, 4], "\"vndf\" has 2 × 3 directions of the light");
    wrong_arrays(|a| a.vndf.1[12..24].fill(0.0), "\"vndf\" is 0 everywhere for direction 1");
    wrong_arrays(|a| a.vndf.1[3] = f32::NAN, "value 3 of \"vndf\" is NaN");
    wrong_arrays(|a| a.luminance.1.truncate(10), "\"luminance\" needs 6 × 4 × 3 values, but has 10");
    wrong_arrays(|a| a.luminance.0 = [3, 2, usize::MAX, 3], "\"luminance\" needs 6 ×");
    wrong_arrays(|a| a.spectra.1[9] = -0.5, "value 9 of \"spectra\" is -0.5");
    wrong_arrays(|a| a.spectra.0 = [3, 2, 3, 0, 3], "\"spectra\" has 3 × 0 values at each angle");
}

#[test]
fn noise_below_zero_is_counted_and_said() {
    let mut noisy = arrays(&AZIMUTHS);
    (noisy.spectra.1[3], noisy.spectra.1[8]) = (-1e-3, -1e-4);
    let (_, changed) = read_measured(&file(&fields(&noisy))).expect("it is noise");
    let changed = changed.expect("something was changed");
    assert!(changed.starts_with("2 of 216 values of \"spectra\" are negative, the least is -0.001"), "{changed}");
    noisy.spectra.1[3] = -0.1;
    wrong_bytes(&file(&fields(&noisy)), "value 3 of \"spectra\" is -0.1");
}

/// A table of densities with cells and rows that are 0, and the slices of two lights mixed.
fn warp() -> (Warp, Slices) {
    let mut values = field(&[2, 5, 4]);
    values[4..12].fill(0.0);
    values[20..26].fill(0.0);
    let warp = Warp::new("test", Table::new("test", [4, 5], 2, values).expect("a table")).expect("a warp");
    (warp, Slices::of([&[0.0], &[0.0, 1.0]], [0.0, 0.3]))
}

#[test]
fn the_density_of_a_warp_integrates_to_one() {
    let (warp, slices) = warp();
    // Midpoints of equal parts of each cell are exact for bilinear functions.
    let at = |i: usize, of: usize| (i as f64 + 0.5) / of as f64;
    let sum: f64 = (0..16 * 12).map(|i| warp.density(&slices, [at(i % 12, 12), at(i / 12, 16)])).sum();
    assert!((sum / (16.0 * 12.0) - 1.0).abs() < 1e-12, "{sum}");
}

proptest! {
    /// The map and its inverse cancel, the inverse knows the density, and the area of a small square shrinks by it.
    #[test]
    fn a_warp_has_the_density_that_it_states(u in 0.001..0.998_f64, v in 0.001..0.998_f64) {
        let (warp, slices) = warp();
        let [x, y] = warp.sample(&slices, [u, v]);
        let (back, density) = warp.invert(&slices, [x, y]);
        prop_assert!((back[0] - u).abs() < 1e-9 && (back[1] - v).abs() < 1e-9, "{back:?} is not {u}, {v}");
        prop_assert!((density / warp.density(&slices, [x, y]) - 1.0).abs() < 1e-12);
        let step = 1e-6;
        let [right, up] = [[u + step, v], [u, v + step]].map(|place| warp.sample(&slices, place));
        let area = ((right[0] - x) * (up[1] - y) - (right[1] - y) * (up[0] - x)) / (step * step);
        // Across an edge of a cell the density has a kink, and near a 0 it curves.
        prop_assume!(density > 0.05);
        prop_assert!((area * density - 1.0).abs() < 1e-3, "{} is not 1 at {x}, {y}", area * density);
    }
}
