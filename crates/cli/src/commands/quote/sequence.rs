//! The cost of a sequence: some of its frames are piloted, and each stands for those near it.

use std::fmt::Write;

use etalon_transport::prepare_frame;
use miette::{Report, miette};
use serde::Serialize;

use super::{CostEstimateJson, QuoteArgs, QuoteJson, quote, threads};
use crate::failure::{Failure, Outcome};
use crate::frames::{FirstFrame, FrameList};
use crate::load::LoadedScene;
use crate::machine::Clock;
use crate::print;
use crate::progress::{duration, percent, two_digits};

/// Most frames that are piloted.
const MOST_PILOTS: usize = 5;

#[derive(Serialize)]
struct SequenceQuoteJson {
    scene: String,
    scene_sha256: String,
    fps: String,
    /// How many frames.
    frames: usize,
    piloted: Vec<PilotedJson>,
    /// Samples of each pixel in the mean over the frames; seconds of all frames together.
    estimates: Vec<CostEstimateJson>,
    /// Seconds before the first samples of all frames.
    prepare_seconds: f64,
}

/// A frame that was piloted.
#[derive(Serialize)]
struct PilotedJson {
    frame: u32,
    /// How many frames it stands for, itself among them.
    stands_for: usize,
    quote: QuoteJson,
}

/// Quotes a sequence.
pub(super) fn run(args: &QuoteArgs, list: &FrameList, mut loaded: LoadedScene) -> Outcome {
    let numbers = list.numbers();
    let chosen = spread(numbers.len());
    let first = FirstFrame::of(&loaded.scene);
    let (mut earlier, mut piloted) = (None, Vec::new());
    for &(place, stands_for) in &chosen {
        let frame = numbers[place];
        args.frames.set(&mut loaded.scene, first, frame);
        let clock = Clock::start(args.clock, threads(args));
        let prepared = prepare_frame(&loaded.scene, &args.overrides.study(), earlier.take())
            .map_err(|error| Failure::input(Report::from_err(error).wrap_err(format!("frame {frame}"))))?;
        let prepare_seconds = clock.seconds();
        let pilot_seconds = args.pilot / chosen.len() as f64;
        let quote =
            quote(args, &loaded, &prepared, (&clock, pilot_seconds, prepare_seconds)).map_err(|mut failure| {
                failure.add(Failure::run(miette!(code = "frame", "this was frame {frame} of the sequence")));
                failure
            })?;
        piloted.push(PilotedJson { frame, stands_for, quote });
        earlier = Some(prepared);
    }
    let weighted = |of: &dyn Fn(&QuoteJson) -> f64| {
        piloted.iter().map(|piloted| piloted.stands_for as f64 * of(&piloted.quote)).sum::<f64>()
    };
    let count = numbers.len() as f64;
    let estimates = (0..args.errors.len()).map(|i| CostEstimateJson {
        relative_rmse: args.errors[i],
        samples: weighted(&|quote| quote.estimates[i].samples) / count,
        samples_interval: [0, 1].map(|end| weighted(&|quote| quote.estimates[i].samples_interval[end]) / count),
        seconds: weighted(&|quote| quote.estimates[i].seconds),
        seconds_interval: [0, 1].map(|end| weighted(&|quote| quote.estimates[i].seconds_interval[end])),
    });
    let sequence = SequenceQuoteJson {
        scene: args.scene.display().to_string(),
        scene_sha256: loaded.sha256.clone(),
        fps: args.frames.fps.to_string(),
        frames: numbers.len(),
        estimates: estimates.collect(),
        prepare_seconds: weighted(&|quote| quote.prepare_seconds),
        piloted,
    };
    if args.json {
        print::json(&sequence);
    } else {
        print::line(&describe(&sequence));
    }
    Ok(())
}

/// Some frames out of this many, evenly spread from the first to the last: the place of each, and how many frames are nearest to it.
fn spread(frames: usize) -> Vec<(usize, usize)> {
    let pilots = frames.min(MOST_PILOTS);
    let places: Vec<usize> = (0..pilots)
        .map(|i| if pilots < 2 { 0 } else { (2 * i * (frames - 1) + pilots - 1) / (2 * (pilots - 1)) })
        .collect();
    let mut stand_for = vec![0; pilots];
    for frame in 0..frames {
        let nearest = (0..pilots).min_by_key(|&i| places[i].abs_diff(frame)).unwrap_or(0);
        stand_for[nearest] += 1;
    }
    places.into_iter().zip(stand_for).collect()
}

fn describe(sequence: &SequenceQuoteJson) -> String {
    let one = &sequence.piloted[0].quote;
    let between = |[low, high]: [f64; 2], show: &dyn Fn(f64) -> String| format!("{} to {}", show(low), show(high));
    let mut text = format!(
        "{}, {} frames of {} × {} pixels, on {} threads of {}, {}\n\n{:>8} {:>10} {:>14}  {:<26} {}\n",
        sequence.scene,
        sequence.frames,
        one.width,
        one.height,
        one.machine.threads,
        one.machine.processor,
        one.machine.software,
        "error",
        "samples",
        "all frames",
        "(95 % sure)",
        "one frame",
    );
    for (i, estimate) in sequence.estimates.iter().enumerate() {
        let of_one = sequence.piloted.iter().map(|piloted| piloted.quote.estimates[i].seconds);
        let range = of_one.fold([f64::INFINITY, 0.0], |[low, high], s| [s.min(low), s.max(high)]);
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{:>8} {:>10} {:>14}  {:<26} {}",
            percent(estimate.relative_rmse),
            two_digits(estimate.samples),
            duration(estimate.seconds),
            between(estimate.seconds_interval, &duration),
            between(range, &duration),
        );
    }
    let frames: Vec<String> = sequence.piloted.iter().map(|piloted| piloted.frame.to_string()).collect();
    let _ = write!(
        text,
        "\nThe error is that of each frame. Frames {} were piloted, and each stands for the frames near it. Preparing all\n\
         frames takes {} more. `etalon render --error` finds the number of samples itself, for about {} of these times more.",
        frames.join(", "),
        duration(sequence.prepare_seconds),
        percent(one.settling_share),
    );
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn piloted_frames_are_spread_evenly_and_stand_for_all() {
        assert_eq!(spread(1), [(0, 1)]);
        assert_eq!(spread(2), [(0, 1), (1, 1)]);
        assert_eq!(spread(5), [(0, 1), (1, 1), (2, 1), (3, 1), (4, 1)]);
        let places: Vec<usize> = spread(101).iter().map(|&(place, _)| place).collect();
        assert_eq!(places, [0, 25, 50, 75, 100]);
        for frames in 1..200 {
            let spread = spread(frames);
            assert_eq!(spread.iter().map(|&(_, stands_for)| stands_for).sum::<usize>(), frames);
            assert!(spread.windows(2).all(|pair| pair[0].0 < pair[1].0) && spread.last().unwrap().0 == frames - 1);
        }
    }
}
