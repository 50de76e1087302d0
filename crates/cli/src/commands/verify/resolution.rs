//! What a run has seen: how small a bias, and which of the known mistakes.

use std::collections::BTreeMap;

use serde::Serialize;

use super::report::Row;

/// How finely all truths together were seen.
#[derive(Serialize)]
pub(super) struct Resolution {
    /// Truths whose value is not 0, so that a bias has a relative size.
    truths: usize,
    /// How many of them would have shown a relative bias of 5, 1, 0.2 and 0.02 %.
    saw_5_percent: usize,
    saw_1_percent: usize,
    saw_0_2_percent: usize,
    saw_0_02_percent: usize,
    /// The relative bias that half of them would have shown, and that all would.
    median: f64,
    worst: f64,
    /// The names of those that see the least, the worst first.
    least_fine: Vec<String>,
    /// Mistakes that the truths know of, and how many of them would have been seen.
    mistakes: usize,
    mistakes_seen: usize,
    /// The others, each after its truth.
    mistakes_unseen: Vec<String>,
    /// What scenes need beyond the basics, the least finely seen first.
    abilities: Vec<Ability>,
}

/// How finely the truths were seen whose scenes need something.
#[derive(Serialize)]
struct Ability {
    name: &'static str,
    truths: usize,
    /// The relative bias that half of them would have shown, and that the finest would.
    median: f64,
    finest: f64,
}

impl Resolution {
    /// Of these rows; `None` if none has a relative resolution.
    pub(super) fn of(rows: &[Row]) -> Option<Self> {
        let mut seen: Vec<(&Row, f64)> =
            rows.iter().filter_map(|row| Some((row, row.relative_resolution()?))).collect();
        seen.sort_by(|a, b| b.1.total_cmp(&a.1));
        let below = |bias: f64| seen.iter().filter(|(_, sees)| *sees <= bias).count();
        let unseen = rows.iter().flat_map(|row| row.unseen_mistakes().map(|what| format!("{}: {what}", row.name())));
        let mistakes_unseen: Vec<String> = unseen.collect();
        let mistakes = rows.iter().map(Row::mistakes).sum();
        Some(Self {
            truths: seen.len(),
            saw_5_percent: below(0.05),
            saw_1_percent: below(0.01),
            saw_0_2_percent: below(2e-3),
            saw_0_02_percent: below(2e-4),
            median: seen.get(seen.len() / 2)?.1,
            worst: seen.first()?.1,
            least_fine: seen.iter().take(5).map(|(row, _)| row.name().to_owned()).collect(),
            mistakes,
            mistakes_seen: mistakes - mistakes_unseen.len(),
            mistakes_unseen,
            abilities: abilities(&seen),
        })
    }

    /// In words, for people.
    pub(super) fn lines(&self) -> Vec<String> {
        let ability = |ability: &Ability| {
            let Ability { name, truths, median, finest } = ability;
            format!("{name} {} % ({truths}; the finest {} %)", percent(*median), percent(*finest))
        };
        let by_ability: Vec<String> = self.abilities.iter().map(ability).collect();
        let unseen = match self.mistakes_unseen.as_slice() {
            [] => String::new(),
            unseen => format!("; not {}", unseen.join(", ")),
        };
        let mut lines = vec![
            format!(
                "a bias of 5 % would have been seen in {} of {} truths, of 1 % in {}, of 0.2 % in {}, of 0.02 % in {}; half see {:.2} %, the worst {:.2} %",
                self.saw_5_percent,
                self.truths,
                self.saw_1_percent,
                self.saw_0_2_percent,
                self.saw_0_02_percent,
                100.0 * self.median,
                100.0 * self.worst
            ),
            format!("least fine: {}", self.least_fine.join(", ")),
            format!("of {} known mistakes {} would have been seen{unseen}", self.mistakes, self.mistakes_seen),
        ];
        if !by_ability.is_empty() {
            lines.push(format!("half of the truths that need an ability see: {}", by_ability.join(", ")));
        }
        lines
    }
}

/// Groups rows, those that see the least first, by what their scenes need.
fn abilities(seen: &[(&Row, f64)]) -> Vec<Ability> {
    let mut by_name: BTreeMap<&'static str, Vec<f64>> = BTreeMap::new();
    for (row, sees) in seen {
        row.abilities().iter().for_each(|name| by_name.entry(name).or_default().push(*sees));
    }
    let ability = |(name, sees): (&'static str, Vec<f64>)| {
        let finest = *sees.last().expect("a name has come with a number");
        Ability { name, truths: sees.len(), median: sees[sees.len() / 2], finest }
    };
    let mut abilities: Vec<Ability> = by_name.into_iter().map(ability).collect();
    abilities.sort_by(|a, b| b.median.total_cmp(&a.median));
    abilities
}

/// A share in per cent, with two digits.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    let digits = (1.0 - percent.abs().log10().floor()).clamp(0.0, 6.0);
    format!("{percent:.*}", digits as usize)
}

#[cfg(test)]
mod tests {
    use etalon_oracle::statistics::Estimate;
    use etalon_oracle::subjects::Reading;
    use etalon_oracle::truths::{Truth, truths};

    use super::*;

    #[test]
    fn mistakes_count_as_seen_where_the_noise_is_small_beside_them() {
        let all = truths();
        let truth = all.iter().find(|truth| truth.name == "disk-lamp-behind-a-plate").expect("there is such a truth");
        let row = |relative_error: f64| {
            let estimate = Estimate::new(truth.value(), relative_error * truth.value());
            Row::new(truth, Ok(Reading { estimate, nonfinite: 0, cut_bias: 0.0 }), 1e-6)
        };
        let of = |rows: &[Row]| Resolution::of(rows).expect("it has a relative resolution");
        let known = truth.mistakes().len();
        let [fine, noisy] = [1e-6, 10.0].map(|error| of(&[row(error)]));
        assert!(known > 1 && fine.mistakes == known && fine.mistakes_seen == known && fine.mistakes_unseen.is_empty());
        assert_eq!((noisy.mistakes_seen, noisy.mistakes_unseen.len()), (0, known));
        let first = format!("{}: {}", truth.name, truth.mistakes()[0].what);
        assert!(noisy.mistakes_unseen.contains(&first) && noisy.lines().join(" ").contains(&format!("; not {first}")));
        // What is no number excludes nothing.
        let broken = Row::new(truth, Err("why".to_owned()), 1e-6);
        assert_eq!(of(&[row(1e-6), broken]).mistakes_seen, known);
    }

    #[test]
    fn abilities_are_listed_with_what_half_of_their_truths_see() {
        let all = truths();
        let needs_masks = |truth: &&Truth| truth.claims.iter().any(|claim| claim.name() == "masks");
        let rows: Vec<Row> = all
            .iter()
            .filter(needs_masks)
            .filter(|truth| truth.value() != 0.0)
            .take(3)
            .zip([1e-5, 1e-3, 1e-4])
            .map(|(truth, error)| {
                let estimate = Estimate::new(truth.value(), error * truth.value().abs());
                Row::new(truth, Ok(Reading { estimate, nonfinite: 0, cut_bias: 0.0 }), 1e-6)
            })
            .collect();
        let seen = Resolution::of(&rows).expect("they have relative resolutions");
        let masks = seen.abilities.iter().find(|ability| ability.name == "masks").expect("they need masks");
        let of = |row: usize| rows[row].relative_resolution().expect("it has one");
        assert_eq!((masks.truths, masks.finest, masks.median), (3, of(0), of(2)));
        assert_eq!([0.123, 0.0123, 2e-7].map(percent), ["12", "1.2", "0.000020"]);
    }
}
