//! Media of pbrt: measured ones by their names, and grids of numbers and colours.

use etalon_import::Imported;
use etalon_scene::{AlbedoGrid, DensityGrid, Medium, MediumDensity};

use super::{imported, refusal, said, scene};

fn file(medium: &str) -> String {
    format!(
        "Camera \"perspective\"\nWorldBegin\nMakeNamedMedium \"m\" {medium}\nMediumInterface \"m\" \"\"\nMaterial \"interface\"\nShape \"sphere\"\n"
    )
}

fn read(medium: &str) -> (Medium, Imported) {
    let imported = imported("pbrt", &file(medium));
    let scene = scene(&imported);
    let medium = scene.materials[scene.objects[0].material].medium.clone();
    (*medium.unwrap_or_else(|| panic!("{:?}", said(&imported))), imported)
}

fn near(found: f64, known: f64) {
    assert!((found - known).abs() <= 1e-6 * known.abs(), "{found} is not {known}");
}

fn grid(medium: &Medium) -> &DensityGrid {
    let MediumDensity::Grid(grid) = &medium.density else { panic!("{:?}", medium.density) };
    grid
}

/// What a grid is in a point of its box, by its definition: in proportion between the middles of the cells, and the same from there to the
/// faces.
fn density(grid: &DensityGrid, p: [f64; 3]) -> f64 {
    let along = |k: usize| {
        let [low, high] = [grid.box_m[0][k], grid.box_m[1][k]];
        let last = grid.cells[k] as usize - 1;
        let at = ((p[k] - low) / (high - low) * f64::from(grid.cells[k]) - 0.5).clamp(0.0, last as f64);
        let before = (at as usize).min(last);
        [(before, 1.0 - at + before as f64), ((before + 1).min(last), at - before as f64)]
    };
    let mut sum = 0.0;
    for (z, c) in along(2) {
        for (y, b) in along(1) {
            for (x, a) in along(0) {
                let cell = (z * grid.cells[1] as usize + y) * grid.cells[0] as usize + x;
                sum += a * b * c * f64::from(grid.values[cell]);
            }
        }
    }
    sum
}

#[test]
fn measured_media_have_the_coefficients_that_were_published() {
    for (name, scattering, absorption) in [
        ("Wholemilk", [2.55, 3.21, 3.77], [0.0011, 0.0024, 0.014]),
        ("Ketchup", [0.18, 0.07, 0.03], [0.061, 0.97, 1.45]),
        ("Espresso", [0.72378, 0.84557, 1.0247], [4.7984, 6.5751, 8.8493]),
        ("Pacific Ocean Surface Water", [0.0001764, 0.00032095, 0.00019617], [0.031845, 0.031324, 0.030147]),
    ] {
        let rgb = |[r, g, b]: [f64; 3]| format!("[ {r} {g} {b} ]");
        // Coefficients beside a name count for nothing.
        let named = format!(
            "\"string type\" \"homogeneous\" \"string preset\" \"{name}\" \"float scale\" 10 \"float g\" 0.5 \"float sigma_a\" 7"
        );
        let (named, imported) = read(&named);
        let stated =
            format!("\"rgb sigma_s\" {} \"rgb sigma_a\" {} \"float scale\" 10", rgb(scattering), rgb(absorption));
        let (stated, _) = read(&stated);
        for nm in [450.0, 500.0, 550.0, 600.0, 650.0] {
            near(named.scattering.eval(nm), stated.scattering.eval(nm));
            near(named.absorption.eval(nm), stated.absorption.eval(nm));
        }
        assert_eq!(said(&imported), Vec::<String>::new());
    }
}

#[test]
fn an_unknown_name_of_a_medium_is_listed_and_changes_nothing() {
    let (medium, imported) = read("\"string preset\" \"Ginger Ale\" \"float sigma_s\" 3");
    // What is not stated is 1 there.
    assert_eq!((medium.absorption.eval(500.0), medium.scattering.eval(500.0)), (1.0, 3.0));
    let said = said(&imported);
    assert!(said.len() == 1 && said[0].contains("the medium \"Ginger Ale\" is not known"), "{said:?}");
}

#[test]
fn light_of_a_medium_is_its_source_radiance() {
    let (medium, imported) = read("\"float sigma_a\" 2 \"rgb Le\" [ 1 1 1 ] \"float Lescale\" 3");
    assert!(medium.source.is_some() && said(&imported).is_empty(), "{:?}", said(&imported));
}

#[test]
fn media_that_cannot_be_read_are_named_once_with_what_that_changes() {
    for kind in ["nanovdb", "cloud", "smog"] {
        let imported = imported("pbrt", &file(&format!("\"string type\" \"{kind}\" \"float density\" 4")));
        let said = said(&imported);
        assert_eq!(said.len(), 1, "{said:?}");
        assert!(said[0].starts_with(&format!("line 3: a medium of the kind \"{kind}\" cannot be read")), "{said:?}");
        assert!(said[0].contains("what \"m\" should fill stays clear"), "{said:?}");
        assert!(scene(&imported).materials.iter().all(|material| material.medium.is_none()));
    }
    // A name that nothing defines is another matter.
    let text = file("\"float sigma_a\" 1").replace("MediumInterface \"m\"", "MediumInterface \"n\"");
    let said = said(&imported("pbrt", &text));
    assert!(said.len() == 1 && said[0].contains("there is no medium \"n\""), "{said:?}");
}

/// There a cell outside of the grid is empty: at a face of the box the density is half of that of the outermost cell, in a corner an eighth.
#[test]
fn the_density_of_a_grid_falls_to_half_at_the_faces_of_its_box() {
    let (medium, imported) = read(
        "\"string type\" \"uniformgrid\" \"integer nx\" 2 \"float density\" [ 8 4 ] \"point3 p0\" [ 3 1 1 ] \"point3 p1\" [ 1 2 2 ]",
    );
    let grid = grid(&medium);
    for (place, known) in [
        ([1.5, 1.5, 1.5], 8.0),
        ([2.0, 1.5, 1.5], 6.0),
        ([1.0, 1.5, 1.5], 4.0),
        ([1.0, 1.0, 2.0], 1.0),
        ([2.75, 1.25, 1.5], 4.0 * 0.75 * 0.75),
    ] {
        near(density(grid, place), known);
    }
    let said_of = said(&imported);
    assert!(said_of.len() == 1 && said_of[0].contains("fades out over half a cell beyond the box"), "{said_of:?}");
    // One that is empty at its faces needs nothing around it.
    let inner: String = (0..27).map(|i| if i == 13 { " 5" } else { " 0" }).collect();
    let text = format!(
        "\"string type\" \"uniformgrid\" \"integer nx\" 3 \"integer ny\" 3 \"integer nz\" 3 \"float density\" [{inner} ]"
    );
    let (medium, imported) = read(&text);
    let MediumDensity::Grid(grid) = &medium.density else { panic!("{:?}", medium.density) };
    assert_eq!((grid.cells, said(&imported)), ([3; 3], vec![]));
}

/// A sphere that is stretched becomes a group, with which what fills it is placed. The grid has coordinates of the world there.
#[test]
fn a_grid_stays_in_the_world_where_its_sphere_is_stretched() {
    let smoke = "\"string type\" \"uniformgrid\" \"float density\" [ 0 ]";
    let text = file(smoke);
    let plain = grid(&read(smoke).0).clone();
    let stretched = text.replace("Shape", "Translate 1 2 3 Rotate 30 1 1 0 Scale 1 2 3 Shape");
    let made = scene(&imported("pbrt", &stretched));
    let [group] = made.groups.as_slice() else { panic!("{:?}", made.groups) };
    let material = &made.materials[group.objects[0].material];
    let within = grid(material.medium.as_ref().expect("it is filled")).transform.affine();
    let placed = made.instances[0].transform.affine() * within;
    assert!(placed.abs_diff_eq(plain.transform.affine(), 1e-12), "{placed:?}");
}

#[test]
fn grids_that_are_placed_with_an_object_are_listed() {
    let text = |medium: &str| {
        format!(
            "{}ObjectInstance \"o\"\n",
            file(medium).replace("Shape \"sphere\"", "ObjectBegin \"o\" Shape \"sphere\" ObjectEnd")
        )
    };
    let listed = said(&imported("pbrt", &text("\"string type\" \"uniformgrid\" \"float density\" [ 0 ]")));
    assert!(listed.len() == 1 && listed[0].contains("the grid of its medium is placed with the body"), "{listed:?}");
    assert_eq!(said(&imported("pbrt", &text("\"float sigma_a\" 1"))), Vec::<String>::new());
}

/// Four cells in a row, of which the outermost are empty.
fn row(absorbed: &str, scattered: &str, further: &str) -> String {
    let row = |cells: &str| {
        let empty = "0 0 0  0 0 0  0 0 0  0 0 0  0 0 0  0 0 0  0 0 0  0 0 0  0 0 0  0 0 0  0 0 0  0 0 0";
        format!("{empty}  0 0 0  0 0 0  0 0 0  0 0 0  0 0 0  {cells}  0 0 0  0 0 0  0 0 0  0 0 0  0 0 0  {empty}")
    };
    format!(
        "\"string type\" \"rgbgrid\" \"integer nx\" 4 \"integer ny\" 3 \"integer nz\" 3 \"rgb sigma_a\" [ {} ] \"rgb sigma_s\" [ {} ] {further}",
        row(absorbed),
        row(scattered)
    )
}

fn albedo(medium: &Medium) -> &AlbedoGrid {
    medium.albedo.as_deref().expect("a grid of albedos")
}

#[test]
fn a_grid_of_one_colour_is_exact() {
    // The second cell has twice of both.
    let (medium, imported) =
        read(&row("0.1 0.2 0.3  0.2 0.4 0.6", "0.6 0.4 0.2  1.2 0.8 0.4", "\"float scale\" 5 \"float g\" 0.25"));
    assert_eq!(said(&imported), Vec::<String>::new());
    assert!(medium.albedo.is_none());
    let (first, _) = read("\"rgb sigma_a\" [ 0.1 0.2 0.3 ] \"rgb sigma_s\" [ 0.6 0.4 0.2 ] \"float scale\" 5");
    for (cell, share) in [(17, 1.0), (18, 2.0)] {
        let d = f64::from(grid(&medium).values[cell]);
        for nm in [450.0, 550.0, 650.0] {
            assert!((d * medium.absorption.eval(nm) - share * first.absorption.eval(nm)).abs() < 1e-6);
            assert!((d * medium.scattering.eval(nm) - share * first.scattering.eval(nm)).abs() < 1e-6);
        }
    }
}

#[test]
fn a_grid_whose_extinction_is_grey_keeps_the_colours_of_its_albedo() {
    // Extinctions of 2 and 2: density and albedo are exact between the cells, too.
    let (medium, imported) = read(&row("1.5 1 0.5  0.5 0.5 1", "0.5 1 1.5  1.5 1.5 1", ""));
    assert_eq!(said(&imported), Vec::<String>::new());
    let d = f64::from(grid(&medium).values[17]);
    near(d * (medium.absorption.eval(500.0) + medium.scattering.eval(500.0)), 2.0);
    let grid = albedo(&medium);
    assert_eq!((grid.cells, grid.box_m, grid.channels), ([4, 3, 3], [[0.0; 3], [1.0; 3]], 3));
    assert_eq!(&grid.values[51..57], [0.25, 0.5, 0.75, 0.75, 0.75, 0.5]);
    // Empty cells around it do not mix in: left of the first cell its own albedo holds.
    assert_eq!(&grid.values[48..51], [0.25, 0.5, 0.75]);
}

#[test]
fn what_a_grid_loses_is_listed_with_its_size() {
    // Extinctions of 1 and 3, albedos of 1 and 0: half-way between them 0.5 are scattered, but half of 2 with the means.
    let (medium, imported) = read(&row("0 0 0  3 3 3", "1 1 1  0 0 0", ""));
    assert_eq!(albedo(&medium).channels, 1);
    let listed = said(&imported);
    // Among the cells above and below, too, density falls by half.
    assert!(listed.len() == 1 && listed[0].contains("differs by up to 17 % of the largest extinction"), "{listed:?}");
    // Red and blue cells of the same mean have grey as their mean: each channel is 1 from 2 or from 0.
    let (medium, imported) = read(&row("2 1 0  0 1 2", "0 0 0  0 0 0", ""));
    near(medium.scattering.eval(500.0) * f64::from(grid(&medium).values[17]), 1.0);
    assert!(albedo(&medium).values.iter().all(|share| *share == 0.0));
    let listed = said(&imported);
    assert!(listed.len() == 1 && listed[0].contains("up to 50 % of the largest extinction"), "{listed:?}");
}

#[test]
fn what_a_grid_of_colours_does_not_state_is_one() {
    let (medium, imported) = read("\"string type\" \"rgbgrid\" \"rgb sigma_s\" [ 3 3 3 ] \"rgb Le\" [ 1 1 1 ]");
    near(medium.scattering.eval(500.0) / medium.absorption.eval(500.0), 3.0);
    let listed = said(&imported).join("\n");
    assert!(medium.source.is_none() && listed.contains("\"Le\" is left out"), "{listed}");
    assert!(listed.contains("\"sigma_a\", which is not stated, is 1 in each cell"), "{listed}");
}

#[test]
fn grids_of_colours_that_make_no_sense_are_refused_with_their_line() {
    for (medium, why) in [
        ("\"string type\" \"rgbgrid\"", "neither \"sigma_a\" nor \"sigma_s\""),
        ("\"string type\" \"rgbgrid\" \"rgb sigma_a\" [ 1 1 ]", "is not a colour for each of 1 cells"),
        (
            "\"string type\" \"rgbgrid\" \"rgb sigma_a\" [ 1 1 1 ] \"integer nx\" 2",
            "is not a colour for each of 2 cells",
        ),
        ("\"string type\" \"rgbgrid\" \"float sigma_a\" [ 1 1 1 ]", "is not a colour for each of 1 cells"),
        ("\"string type\" \"rgbgrid\" \"rgb sigma_a\" [ 1 -1 1 ]", "a number of \"sigma_a\" is negative"),
        ("\"string type\" \"rgbgrid\" \"rgb sigma_a\" [ 1 1 1 ] \"integer nx\" 5000", "1 to 4096 cells are read"),
    ] {
        let found = refusal("pbrt", &file(medium));
        assert!(found.starts_with("line 3: ") && found.contains(why), "{found}");
    }
    let (medium, _) = read("\"string type\" \"rgbgrid\" \"rgb sigma_a\" [ 0 0 0 ] \"rgb sigma_s\" [ 0 0 0 ]");
    assert_eq!((medium.absorption.eval(500.0), medium.scattering.eval(500.0)), (0.0, 0.0));
}
