//! What a render counted, and the samples that were not numbers.

use serde::{Deserialize, Serialize};

/// A sample that was not a finite number: excluded from the sums, and reported so that it can be replayed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct NonFinite {
    /// Row from the top.
    pub y: u32,
    /// Column.
    pub x: u32,
    /// Number of the sample.
    pub sample: u32,
}

/// Non-finite samples are counted without limit, and located up to this many.
pub const NONFINITE_LOCATED: usize = 16;

/// What a render counted.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Counters {
    /// Camera paths.
    pub paths: u64,
    /// Rays that looked for the nearest surface.
    pub rays: u64,
    /// Rays that asked whether a light is in sight.
    pub shadow_rays: u64,
    /// Points drawn on a lens.
    pub lens_draws: u64,
    /// Times drawn while the shutter is open.
    #[serde(default)]
    pub time_draws: u64,
    /// Times that a light at infinity was asked for its radiance.
    pub environment_lookups: u64,
    /// Vertices at which weights of the lanes were carried, because dispersion may part them.
    pub lane_weights: u64,
    /// Boundaries that contradicted what was known of the media around a path, such as a solid left that was not entered.
    pub lost_media: u64,
    /// Paths, and shadow rays between masks, cut at the internal limit on vertices rather than ended by the scene: each may
    /// lack light.
    pub cut_paths: u64,
    /// The largest throughput with which one of them was cut: what light found beyond would have been multiplied by. A shadow ray, whose
    /// sample is bounded by no radiance, counts as [`f64::MAX`].
    #[serde(default)]
    pub cut_throughput: f64,
    /// Samples that were not finite.
    pub nonfinite: u64,
    /// The first of them, in the order of rows, columns and samples.
    pub nonfinite_at: Vec<NonFinite>,
}

impl Counters {
    /// Records a sample that is not finite.
    pub fn record_nonfinite(&mut self, at: NonFinite) {
        self.nonfinite += 1;
        self.locate(&[at]);
    }

    /// Records that a path was cut which had this throughput, its largest over the wavelengths.
    pub(crate) fn record_cut(&mut self, throughput: f64) {
        self.cut_paths += 1;
        // Not a number is no bound either.
        let bound = if throughput.is_finite() { throughput } else { f64::MAX };
        self.cut_throughput = self.cut_throughput.max(bound);
    }

    /// Adds another count to this one.
    pub fn merge(&mut self, other: &Self) {
        self.paths += other.paths;
        self.rays += other.rays;
        self.shadow_rays += other.shadow_rays;
        self.lens_draws += other.lens_draws;
        self.time_draws += other.time_draws;
        self.environment_lookups += other.environment_lookups;
        self.lane_weights += other.lane_weights;
        self.lost_media += other.lost_media;
        self.cut_paths += other.cut_paths;
        self.cut_throughput = self.cut_throughput.max(other.cut_throughput);
        self.nonfinite += other.nonfinite;
        self.locate(&other.nonfinite_at);
    }

    fn locate(&mut self, at: &[NonFinite]) {
        if !at.is_empty() {
            self.nonfinite_at.extend_from_slice(at);
            self.nonfinite_at.sort_unstable();
            self.nonfinite_at.truncate(NONFINITE_LOCATED);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn located_samples_do_not_depend_on_the_order_of_merging() {
        let at = |i: u32| NonFinite { y: i % 7, x: i % 5, sample: i };
        let count = |order: &mut dyn Iterator<Item = u32>| {
            let mut total = Counters::default();
            for i in order {
                let mut one = Counters::default();
                one.record_nonfinite(at(i));
                total.merge(&one);
            }
            total
        };
        let forward = count(&mut (0..100));
        assert_eq!(forward, count(&mut (0..100).rev()));
        assert_eq!((forward.nonfinite, forward.nonfinite_at.len()), (100, NONFINITE_LOCATED));
    }

    #[test]
    fn the_largest_throughput_of_cut_paths_is_kept_and_what_is_no_number_bounds_nothing() {
        let cut = |throughputs: &[f64]| {
            let mut counters = Counters::default();
            throughputs.iter().for_each(|throughput| counters.record_cut(*throughput));
            counters
        };
        let mut both = cut(&[0.25, 0.5]);
        both.merge(&cut(&[0.125]));
        both.merge(&Counters::default());
        assert_eq!((both.cut_paths, both.cut_throughput), (3, 0.5));
        for nothing in [f64::NAN, f64::INFINITY] {
            both.merge(&cut(&[nothing]));
            assert_eq!(both.cut_throughput, f64::MAX);
        }
    }
}
