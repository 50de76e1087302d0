//! Filters that reconstruct the picture.

use super::{imported, said, scene};
use etalon_scene::Filter;

/// The filter of a scene of Mitsuba, and what is said about it.
fn of_mitsuba(rfilter: &str) -> (Filter, Vec<String>) {
    let imported = imported(
        "xml",
        &format!(
            "<scene version=\"3.0.0\"><sensor type=\"perspective\"><film type=\"hdrfilm\">{rfilter}</film></sensor><shape type=\"sphere\"/></scene>"
        ),
    );
    let about = said(&imported).into_iter().filter(|line| line.contains("filter") || line.contains("is ignored"));
    (scene(&imported).film.filter, about.collect())
}

fn of_pbrt(statement: &str) -> (Filter, Vec<String>) {
    let imported = imported("pbrt", &format!("{statement}\nCamera \"perspective\"\nWorldBegin\nShape \"sphere\"\n"));
    let about = said(&imported).into_iter().filter(|line| line.contains("filter"));
    (scene(&imported).film.filter, about.collect())
}

#[test]
fn filters_that_are_negative_somewhere_arrive_as_they_are() {
    let third = 1.0 / 3.0;
    let mitchell = |radius_px, b, c| Filter::Mitchell { radius_px, b, c };
    for (rfilter, filter) in [
        ("<rfilter type=\"mitchell\"/>", mitchell(2.0, third, third)),
        (
            "<rfilter type=\"mitchell\"><float name=\"B\" value=\"0.25\"/><float name=\"C\" value=\"0.5\"/></rfilter>",
            mitchell(2.0, 0.25, 0.5),
        ),
        ("<rfilter type=\"catmullrom\"/>", mitchell(2.0, 0.0, 0.5)),
        ("<rfilter type=\"lanczos\"/>", Filter::Lanczos { lobes: 3 }),
        ("<rfilter type=\"lanczos\"><integer name=\"lobes\" value=\"2\"/></rfilter>", Filter::Lanczos { lobes: 2 }),
    ] {
        assert_eq!(of_mitsuba(rfilter), (filter, Vec::new()), "{rfilter}");
    }
    let of_pbrt_alone = of_pbrt("PixelFilter \"mitchell\" \"float xradius\" 1.5 \"float yradius\" 1.5 \"float B\" 0.5");
    assert_eq!(of_pbrt_alone, (mitchell(1.5, 0.5, third), Vec::new()));
}

#[test]
fn a_filter_that_no_scene_may_have_becomes_a_gaussian_and_is_listed() {
    for (rfilter, what) in [
        (
            "<rfilter type=\"mitchell\"><float name=\"C\" value=\"-1\"/></rfilter>",
            "with B 0.3333333333333333 and C -1 becomes a Gaussian",
        ),
        (
            "<rfilter type=\"lanczos\"><integer name=\"lobes\" value=\"17\"/></rfilter>",
            "of 17 lobes becomes a Gaussian",
        ),
        ("<rfilter type=\"own\"/>", "the filter \"own\" becomes a Gaussian"),
    ] {
        let (filter, said) = of_mitsuba(rfilter);
        assert!(matches!(filter, Filter::Gaussian { .. }), "{rfilter}");
        assert!(said.iter().any(|line| line.contains(what)), "{rfilter}: {said:?}");
    }
    let (filter, said) = of_pbrt("PixelFilter \"mitchell\" \"float B\" 2");
    assert_eq!(filter, Filter::Gaussian { sigma_px: 0.5 });
    assert!(said.iter().any(|line| line.contains("with B 2 and C 0.3333333333333333 becomes a Gaussian")), "{said:?}");
}
