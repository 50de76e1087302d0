//! A render from its beginning, or from where it was kept, to its end.

use std::sync::Arc;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use etalon::{Aov, Channels};
use etalon_control::{Canvas, Limits, Reached, SampleAllocation, SettleError, Settled, Shard, render_canvas, settle};
use miette::{Report, miette};

use super::watcher::Watcher;
use super::{Done, Job, RenderArgs};
use crate::machine::Clock;
use crate::print;
use crate::state::{self, Header, Kept, Limited};

/// A render that is ready to go on.
pub(super) struct Run {
    canvas: Canvas,
    settled: Settled,
    limits: Limits,
    clock: Clock,
    /// Seconds spent before the clock was started.
    before_s: f64,
    shard: Shard,
}

impl Run {
    /// Settles how many samples are to be taken, and begins.
    pub(super) fn new(args: &RenderArgs, job: &Job, limits: Limits, watch: &Watcher<'_>) -> Result<Self, SettleError> {
        let clock = Clock::start(args.clock, job.threads);
        let shard = args.shard.map_or(Shard::WHOLE, |shard| shard.0);
        let settled = settle(&job.prepared, job.rect, &limits, Some(job.threads), &|| clock.seconds(), watch)?;
        let canvas = Canvas::new(&job.prepared, job.rect, shard, settled.allocation.as_deref());
        Ok(Self { canvas, settled, limits, clock, before_s: 0.0, shard })
    }

    /// Goes on from what was kept.
    pub(super) fn taken_up(args: &RenderArgs, job: &Job, kept: Kept, limits: Limits) -> Result<Self, SettleError> {
        let clock = Clock::start(args.clock, job.threads);
        let Header { shard, samples, allocation, reaches, seconds, .. } = kept.header;
        let allocation = allocation.map(|weights| Arc::new(SampleAllocation::new(job.rect, weights)));
        let canvas = Canvas::new(&job.prepared, job.rect, shard, allocation.as_deref());
        for (tile, sums, _) in &kept.tiles {
            assert!(canvas.take_up(tile, sums), "the checkpoint was found to fit");
        }
        let reached = if reaches == "error" { Reached::Error } else { Reached::Samples };
        let settled = Settled { samples, allocation, reached, predicted: None, explored: None };
        Ok(Self { canvas, settled, limits, clock, before_s: seconds, shard })
    }

    fn seconds(&self) -> f64 {
        self.before_s + self.clock.seconds()
    }

    fn header(&self, args: &RenderArgs, job: &Job, complete: bool) -> Header {
        let channels = Channels::new(&args.aov, args.only);
        let Limits { samples, relative_rmse, seconds, .. } = self.limits;
        Header {
            subject: job.subject.clone(),
            shard: self.shard,
            limits: Limited {
                samples,
                error: relative_rmse,
                time_s: seconds,
                adaptive: args.adaptive.effective(args.error),
            },
            samples: self.settled.samples,
            allocation: self.settled.allocation.as_ref().map(|allocation| allocation.weights().to_vec()),
            reaches: if self.settled.reached == Reached::Error { "error" } else { "samples" }.to_owned(),
            object_names: channels.has(Aov::Object).then(|| job.prepared.object_names()),
            channels,
            seconds: self.seconds(),
            complete,
        }
    }

    /// Renders to the end, keeping what there is from time to time if that is wanted.
    pub(super) fn finish(self, args: &RenderArgs, job: &Job, watch: &Watcher<'_>) -> Result<Done, SettleError> {
        watch.goes_on_from(self.canvas.with_film(|film| film.counters.paths));
        let path = args.output.first().map(|output| state::checkpoint_path(output));
        let ended = std::thread::scope(|scope| {
            let (ended, end) = mpsc::channel::<()>();
            if let (Some(every), Some(path)) = (args.checkpoint, &path) {
                let run = &self;
                scope.spawn(move || {
                    let mut said = false;
                    // The channel closes when the render has ended.
                    while end.recv_timeout(Duration::from_secs_f64(every)) == Err(RecvTimeoutError::Timeout) {
                        if let Err(error) = state::write(path, &run.header(args, job, false), &run.canvas, &[]) {
                            if !said {
                                print::warnings(&[Report::from_err(error).wrap_err(miette!(
                                    severity = miette::Severity::Warning,
                                    "the checkpoint could not be written; the render goes on and tries again"
                                ))]);
                            }
                            said = true;
                        }
                    }
                });
            }
            let clock = || self.seconds();
            let done = render_canvas(
                &job.prepared,
                &self.canvas,
                &self.settled,
                &self.limits,
                Some(job.threads),
                &clock,
                watch,
            );
            drop(ended);
            done
        })?;
        let complete = ended.reached != Reached::Interrupted;
        let mut header = self.header(args, job, complete);
        // What the report says, to the digit.
        header.seconds = ended.seconds;
        if complete {
            // When time was up it is fewer than were settled.
            header.samples = ended.samples;
        }
        let features = if header.channels.has_features() {
            let tiles: Vec<_> = (0..self.canvas.tiles()).map(|number| self.canvas.tile(number).0.rect).collect();
            job.prepared.features(&tiles, ended.samples, Some(job.threads))?
        } else {
            Vec::new()
        };
        Ok(Done { ended, canvas: self.canvas, header, features, error: None, explored: self.settled.explored })
    }
}
