//! Smoothed pictures: nearer to the truth for the eye, and never taken for a measurement. `tests/denoise.sh` runs this.

use etalon_picture::{Attribute, read_exr, rel_mse};

use crate::support::{etalon_line, scene};

#[test]
fn a_smoothed_picture_is_nearer_to_the_truth_and_says_that_it_is_no_measurement() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    let cornell = scene("cornell.json");
    let render = |name: &str, settings: &str| {
        etalon_line(&format!("render {{}} -o {{}} --size 96x96 {settings}"), [&cornell, &file(name)]).expect(0);
    };
    render("truth.exr", "--spp 2048 --seed 9");
    render("plain.exr", "--spp 16");
    render("guided.exr", "--spp 16 --aov albedo,normal");
    let before = std::fs::read(file("guided.exr")).unwrap();
    let truth = read_exr(&file("truth.exr")).unwrap().picture;
    let error = |name: &str| {
        let picture = read_exr(&file(name)).unwrap().picture;
        ["R", "G", "B"].map(|c| rel_mse(picture.channel(c).unwrap(), truth.channel(c).unwrap())).iter().sum::<f64>()
    };
    for (from, to) in [("plain.exr", "smooth.exr"), ("guided.exr", "guided-smooth.exr")] {
        etalon_line("denoise {} -o {}", [&file(from), &file(to)]).expect(0);
        // The noise of 16 samples is mostly gone, and what is smoothed away is less than it was.
        assert!(error(to) < 0.5 * error(from), "{to}: {} of {}", error(to), error(from));
        let smoothed = read_exr(&file(to)).unwrap();
        assert_eq!(smoothed.picture.channels().len(), 3);
        let Some(Attribute::Text(note)) = smoothed.attributes.get("denoised") else { panic!("it does not say so") };
        assert!(note.contains(from) && note.contains("not measured"), "{note}");
        for key in ["samplesPerPixel", "seed", "sceneSha256", "plan"] {
            assert!(!smoothed.attributes.contains_key(key), "{key} would make it pass for a render");
        }
    }
    assert_eq!(std::fs::read(file("guided.exr")).unwrap(), before, "the measured picture is left as it is");
    // No noise can be told from it, and it cannot be smoothed again.
    let compared = etalon_line("compare {} {}", [&file("smooth.exr"), &file("truth.exr")]).expect(3);
    assert!(compared.stdout.contains("Error.R"), "{}", compared.stdout);
    let again = etalon_line("denoise {} -o {}", [&file("smooth.exr"), &file("again.exr")]).expect(2);
    assert!(again.stderr.contains("denoised already") && !file("again.exr").exists(), "{}", again.stderr);
}
