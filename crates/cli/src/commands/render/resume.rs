//! Finding a checkpoint, and whether it is of the same picture.

use etalon::Subject;
use etalon_control::{Canvas, Shard};
use miette::{Report, miette};

use super::RenderArgs;
use crate::failure::Failure;
use crate::state::{self, Kept, StateError};

/// The checkpoint of this render, if there is one. Whatever keeps it from being used goes into `failure`: to begin anew is for
/// the user to decide, by leaving --resume out.
pub(super) fn find(args: &RenderArgs, subject: &Subject, shard: Shard, failure: &mut Failure) -> Option<Kept> {
    let path = state::checkpoint_path(args.output.first()?);
    let kept = match state::read(&path) {
        Ok(kept) => kept,
        Err(StateError::Io { source, .. }) if source.kind() == std::io::ErrorKind::NotFound => return None,
        Err(error) => {
            failure.add(Failure::run(Report::from_err(error)));
            return None;
        }
    };
    let header = &kept.header;
    let mut refuse = |why: String| {
        failure.add(Failure::input(miette!(
            code = "other-picture",
            help = "give the same scene and options as before, or leave --resume out to begin anew",
            "`{}` cannot be resumed: {why}",
            path.display()
        )));
    };
    if let Some(difference) = header.subject.difference(subject) {
        refuse(difference);
    } else if header.shard != shard {
        let name = |shard: Shard| format!("share {}/{}", shard.index + 1, shard.of);
        refuse(format!("it is {}, not {}", name(header.shard), name(shard)));
    } else if let Some(difference) = other_end(args, &kept) {
        refuse(difference);
    } else if !fits(&kept) {
        refuse("its tiles are not those of the picture".to_owned());
    } else {
        return Some(kept);
    }
    None
}

/// What ends the render must be the same, for it decides how many samples there are.
fn other_end(args: &RenderArgs, kept: &Kept) -> Option<String> {
    let limits = kept.header.limits;
    let differs = |name: &str, kept: Option<f64>, now: Option<f64>| {
        let word = |value: Option<f64>| value.map_or_else(|| "not given".to_owned(), |value| value.to_string());
        (kept != now).then(|| format!("{name} was {}, and now is {}", word(kept), word(now)))
    };
    let (adaptive, spp) = (args.adaptive.effective(args.error), args.overrides.spp());
    differs("--error", limits.error, args.error)
        .or_else(|| differs("--time", limits.time_s, args.time))
        .or_else(|| {
            let (kept, now) = (limits.adaptive.word(), adaptive.word());
            (kept != now).then(|| format!("--adaptive was {kept}, and now is {now}"))
        })
        .or_else(|| {
            let given = spp.filter(|&spp| spp != limits.samples);
            given.map(|spp| format!("--spp was {}, and now is {spp}", limits.samples))
        })
}

/// Whether every tile is one of the picture's.
fn fits(kept: &Kept) -> bool {
    let header = &kept.header;
    let allocation = match &header.allocation {
        Some(weights) => match state::allocation(header.subject.crop, weights) {
            Some(allocation) => Some(allocation),
            None => return false,
        },
        None => None,
    };
    let canvas = Canvas::of_share(header.subject.film(), header.subject.crop, header.shard, allocation.as_ref());
    kept.tiles.iter().all(|(tile, sums, _)| canvas.take_up(tile, sums))
}
