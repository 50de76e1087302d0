//! What an EXR holds beside its picture: spectral bands, first-hit features, metadata.

use std::path::Path;

use etalon_optics::{Illuminant, Spectrum};
use etalon_picture::{Attribute, ExrFile};

use crate::support::{etalon_line, pixel_bits, scene};

fn render(name: &str, options: &str, output: &Path) -> ExrFile {
    etalon_line(&format!("render {{}} -o {{}} --quiet {options}"), [&scene(name), output]).expect(0);
    pixel_bits(output).1
}

fn names(file: &ExrFile) -> Vec<&str> {
    file.picture.channels().iter().map(|channel| channel.name.as_str()).collect()
}

#[test]
fn a_spectral_file_follows_the_layout_and_a_grey_scene_has_its_light_in_every_band() {
    let folder = tempfile::tempdir().unwrap();
    // A furnace under half of D65: one lane, and every number known. Between 400 and 405 nm its table is a line.
    let file = render("furnace.json", "--size 16x12 --spp 4 --bands 401:404:1", &folder.path().join("x.exr"));
    let d65 = Spectrum::illuminant(Illuminant::D65, 0.5).unwrap();
    for centre in 401..=404 {
        let of = |prefix: &str| file.picture.require(&format!("{prefix}S0.{centre},000000nm")).unwrap();
        let expected = d65.eval(f64::from(centre)) as f32;
        assert!(of("").iter().all(|&value| (value - expected).abs() < 1e-6), "{centre}");
        assert!(of("Error.").iter().all(|&error| error < 1e-6));
        assert!(of("samples.").iter().all(|&count| count == 4.0));
    }
    let text = |text: &str| Attribute::Text(text.to_owned());
    assert_eq!(file.attributes["spectralLayoutVersion"], text("1.0"));
    assert_eq!(file.attributes["emissiveUnits"], text("W.m^-2.sr^-1"));
    assert_eq!(file.attributes["EV"], Attribute::Float(0.0));

    let line = "render {} -o {} --size 16x12 --spp 4 --bands 300:700:10";
    etalon_line(line, [&scene("furnace.json"), Path::new("x.exr")]).expect(2).says(["295 to 705 nm", "360 to 830 nm"]);
    for malformed in ["400:700", "400:705:10", "700:400:10", "400:700:0", "400:700:x", "400:700:-10"] {
        let line = format!("render {{}} -o {{}} --bands={malformed}");
        etalon_line(&line, [&scene("furnace.json"), Path::new("x.exr")]).expect(2).says(["bands"]);
    }
}

#[test]
fn bands_survive_a_division_into_parts() {
    let folder = tempfile::tempdir().unwrap();
    let options =
        "--size 40x40 --spp 8 --bands 400:760:40 --aov albedo,normal,position,depth,uv,object,variance,samples";
    for name in ["prism.json", "furnace.json"] {
        let whole = folder.path().join(format!("{name}.exr"));
        render(name, options, &whole);
        let parts = [1, 2].map(|k| folder.path().join(format!("{name}.{k}.part")));
        for (k, part) in parts.iter().enumerate() {
            let line = format!("render {{}} -o {{}} --quiet {options} --shard {}/2", k + 1);
            etalon_line(&line, [&scene(name), part]).expect(0);
        }
        let merged = folder.path().join(format!("{name}.merged.exr"));
        etalon_line("merge {} {} -o {} --quiet", [&parts[0], &parts[1], &merged]).expect(0);
        assert_eq!(pixel_bits(&merged).0, pixel_bits(&whole).0);
    }
}

#[test]
fn features_come_beside_the_picture_or_alone_and_change_nothing_in_it() {
    let folder = tempfile::tempdir().unwrap();
    let size = "--size 32x32 --spp 8";
    let plain = render("cornell.json", size, &folder.path().join("plain.exr"));
    let all = "--aov albedo,normal,position,depth,uv,object,variance,samples";
    let file = render("cornell.json", &format!("{size} {all}"), &folder.path().join("all.exr"));
    for channel in plain.picture.channels() {
        assert_eq!(file.picture.require(&channel.name).unwrap(), channel.samples, "{}", channel.name);
    }
    let alone = render("cornell.json", &format!("{size} --aov normal,depth --only"), &folder.path().join("alone.exr"));
    assert_eq!(names(&alone), ["N.X", "N.Y", "N.Z", "Z"]);
    for channel in alone.picture.channels() {
        assert_eq!(file.picture.require(&channel.name).unwrap(), channel.samples);
    }
    let error = file.picture.require("Error.G").unwrap();
    let variance = file.picture.require("Variance.G").unwrap();
    assert!(error.iter().zip(variance).all(|(e, v)| (e * e - v).abs() <= 1e-6 * v));
    let ids = file.picture.require("ObjectId").unwrap();
    let Attribute::Text(names) = &file.attributes["objectNames"] else { panic!("names are text") };
    let names: Vec<String> = serde_json::from_str(names).unwrap();
    assert!(names.len() > 3 && ids.iter().all(|&id| (0.0..=names.len() as f32).contains(&id)));

    // A position seen through the matrices is the pixel's: where all rays of a pixel meet one plane, their mean is on it.
    let Attribute::Matrix4(matrix) = &file.attributes["worldToNDC"] else { panic!("a matrix") };
    let position = ["P.X", "P.Y", "P.Z"].map(|name| file.picture.require(name).unwrap());
    let mut off: Vec<f64> = Vec::new();
    for pixel in (0..32 * 32).filter(|&pixel| ids[pixel] > 0.0) {
        let row = [0, 1, 2, 3].map(|c| if c < 3 { f64::from(position[c][pixel]) } else { 1.0 });
        let image: [f64; 4] = std::array::from_fn(|c| (0..4).map(|r| row[r] * f64::from(matrix[4 * r + c])).sum());
        let seen = [0, 1].map(|c| 32.0 * image[c] / image[3]);
        off.push((seen[0] - (pixel % 32) as f64 - 0.5).abs().max((seen[1] - (pixel / 32) as f64 - 0.5).abs()));
    }
    off.sort_by(f64::total_cmp);
    // The rays of a pixel are about its centre by the filter's σ of half a pixel, eight of them stratified.
    let median = off[off.len() / 2];
    assert!(off.len() > 700 && median < 0.25, "{median}");
}
