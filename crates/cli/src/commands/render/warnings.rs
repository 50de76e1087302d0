//! What a picture does not show: light that is missing from it.

use etalon_transport::{Counters, Film, MOST_SOLIDS_AT_ONCE, PixelRect};
use miette::{Report, miette};

use super::RenderArgs;
use crate::light::without_light;
use crate::shell;

/// Everything that the film and its counters give reason to warn of.
pub(super) fn of(args: &RenderArgs, film: &Film, rect: PixelRect) -> Vec<Report> {
    counted(args, &film.counters).into_iter().chain(without_light(film, rect)).collect()
}

fn counted(args: &RenderArgs, counters: &Counters) -> Vec<Report> {
    nonfinite(args, counters).into_iter().chain(cut_paths(counters)).chain(lost_media(counters)).collect()
}

/// Says which samples were not finite, and how to see their paths.
fn nonfinite(args: &RenderArgs, counters: &Counters) -> Option<Report> {
    let first = counters.nonfinite_at.first()?;
    let places: Vec<String> =
        counters.nonfinite_at.iter().map(|at| format!("pixel {},{} sample {}", at.x, at.y, at.sample)).collect();
    let more = if counters.nonfinite > counters.nonfinite_at.len() as u64 { ", …" } else { "" };
    Some(miette!(
        severity = miette::Severity::Warning,
        code = "nonfinite",
        help = format!(
            "replay the first: etalon render {} --pixel {},{} --sample {}",
            shell::words(
                std::iter::once(args.scene.display().to_string())
                    .chain(args.frames.frames.iter().flat_map(|list| args.frames.words(list.text())))
                    .chain(args.overrides.as_words().to_vec())
            ),
            first.x,
            first.y,
            first.sample
        ),
        "{} samples were not finite and are left out of the picture: {}{more}",
        counters.nonfinite,
        places.join(", ")
    ))
}

/// Says how many paths the renderer's own limit on vertices has cut.
fn cut_paths(counters: &Counters) -> Option<Report> {
    (counters.cut_paths > 0).then(|| {
        miette!(
            severity = miette::Severity::Warning,
            code = "cut-paths",
            help = "paths end by themselves with Russian roulette, if the surfaces absorb some light",
            "{} of {} paths were cut at the largest number of vertices: the picture may lack light",
            counters.cut_paths,
            counters.paths
        )
    })
}

/// Says how often the media around a path contradicted themselves.
fn lost_media(counters: &Counters) -> Option<Report> {
    (counters.lost_media > 0).then(|| {
        miette!(
            severity = miette::Severity::Warning,
            code = "lost-media",
            help = format!(
                "solids with a priority must be closed, their normals must point outward, and at most {MOST_SOLIDS_AT_ONCE} of them \
                 may overlap in one place"
            ),
            "{} times a path left a solid that it had not entered, or was inside more than {MOST_SOLIDS_AT_ONCE} solids at once \
             ({} paths in all)",
            counters.lost_media,
            counters.paths
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args::PixelAt;
    use clap::Parser;
    use etalon_transport::NonFinite;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        args: RenderArgs,
    }

    fn parse(line: &str) -> RenderArgs {
        Line::try_parse_from(line.split_whitespace()).unwrap_or_else(|error| panic!("{error}")).args
    }

    #[test]
    fn samples_that_are_not_finite_are_named_with_the_command_that_replays_them() {
        let options = "--spp 9 --seed 3 --size 64x48 --sampler independent --loop scalar --polarised";
        let args = parse(&format!("render a.json -o a.exr {options}"));
        assert!(nonfinite(&args, &Counters::default()).is_none());
        let mut counters = Counters::default();
        for sample in [5, 2] {
            counters.record_nonfinite(NonFinite { x: 7, y: 11, sample });
        }
        let warning = nonfinite(&args, &counters).unwrap();
        assert_eq!(warning.severity(), Some(miette::Severity::Warning));
        assert_eq!(
            warning.to_string(),
            "2 samples were not finite and are left out of the picture: pixel 7,11 sample 2, pixel 7,11 sample 5"
        );
        let help = warning.help().unwrap().to_string();
        let replay = parse(help.strip_prefix("replay the first: etalon ").unwrap());
        assert_eq!((replay.pixel, replay.sample), (Some(PixelAt { x: 7, y: 11 }), Some(2)));
        assert_eq!(replay.overrides.as_words(), args.overrides.as_words());
        assert_eq!(args.overrides.as_words().len(), 11);
        for option in options.split(' ') {
            assert!(help.contains(option), "{option} is not in {help}");
        }
    }

    #[test]
    fn more_samples_than_are_located_are_counted_all_the_same() {
        let args = parse("render a.json -o a.exr");
        let mut counters = Counters::default();
        for sample in 0..1000 {
            counters.record_nonfinite(NonFinite { x: 0, y: 0, sample });
        }
        let text = nonfinite(&args, &counters).unwrap().to_string();
        assert!(text.starts_with("1000 samples") && text.ends_with(", …"), "{text}");
    }

    #[test]
    fn paths_that_were_cut_are_counted_in_a_warning_and_none_is_none() {
        let args = parse("render a.json -o a.exr");
        let counters = Counters { paths: 10, cut_paths: 3, ..Counters::default() };
        let warnings = counted(&args, &counters);
        assert_eq!(warnings.len(), 1);
        assert!(warnings[0].to_string().starts_with("3 of 10 paths were cut"), "{}", warnings[0]);
        assert!(counted(&args, &Counters { paths: 10, ..Counters::default() }).is_empty());
    }
}
