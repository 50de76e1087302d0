//! What is left of a run's rays goes to the truths that see the least.

use super::ours::{MORE, THOROUGH_SEES_BY_NAME};

/// What the measurement of a truth has cost, and what it saw.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cost {
    /// Rays of all kinds that its films have taken, and those of them that were not there for another truth already.
    pub rays: u64,
    pub spent: u64,
    /// Times the samples of the first step.
    pub effort: u32,
    /// Relative bias that it would have seen; `None` if more samples are of no use.
    pub sees: Option<f64>,
}

/// Which truths are measured again when there are this many rays for all of them, and with how many times the samples of the first step.
/// The next one is always the one that sees the least. Four times the samples are taken to see twice as much. What is measured again
/// begins anew.
pub(super) fn finer(costs: &[Cost], rays_of_all: u64) -> Vec<(usize, u32)> {
    let mut left = rays_of_all.saturating_sub(costs.iter().map(|cost| cost.spent).sum());
    let mut planned: Vec<Cost> = costs.to_vec();
    loop {
        let open = planned.iter().enumerate().filter_map(|(index, cost)| Some((index, cost.sees?)));
        let Some((worst, sees)) = open.max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
        let cost = &mut planned[worst];
        // What is planned already is not rendered then.
        let instead = if cost.effort > costs[worst].effort { cost.rays } else { 0 };
        let (rays, effort) = (cost.rays.saturating_mul(u64::from(MORE)), cost.effort.saturating_mul(MORE));
        if rays - instead > left || sees <= THOROUGH_SEES_BY_NAME {
            cost.sees = None;
            continue;
        }
        left -= rays - instead;
        *cost = Cost { rays, effort, sees: Some(0.5 * sees), ..*cost };
    }
    let changed = planned.iter().zip(costs).enumerate().filter(|(_, (planned, cost))| planned.effort > cost.effort);
    changed.map(|(index, (planned, _))| (index, planned.effort)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_that_are_left_go_to_what_sees_the_least() {
        let cost = |rays, sees| Cost { rays, spent: rays, effort: 1, sees };
        // 30 are spent. The second is the worst by far: 4 times 10 more, then 16 times instead of 4 times, to a quarter of 8 %.
        let costs = [cost(10, Some(0.01)), cost(10, Some(0.08)), cost(10, None)];
        assert_eq!(finer(&costs, 30 + 39), []);
        assert_eq!(finer(&costs, 30 + 40), [(1, 4)]);
        assert_eq!(finer(&costs, 30 + 160), [(1, 16)]);
        // At 1 % both are alike, and the rest goes to either as far as it lasts.
        assert_eq!(finer(&costs, 30 + 640 + 40), [(0, 4), (1, 64)]);
        // Fine enough.
        assert_eq!(finer(&[cost(10, Some(1e-4))], 1000), []);
    }

    #[test]
    fn rays_that_served_another_truth_already_are_spent_once() {
        let costs = [10, 0].map(|spent| Cost { rays: 10, spent, effort: 1, sees: Some(0.01 / (1.0 + spent as f64)) });
        assert_eq!(finer(&costs, 10 + 39), []);
        assert_eq!(finer(&costs, 10 + 40), [(1, 4)]);
    }
}
