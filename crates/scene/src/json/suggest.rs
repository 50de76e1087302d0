//! Guessing what was meant.

/// The candidate that `given` was probably meant to be, if one is near.
///
/// Near means: equal but for case, spaces, hyphens and underscores; the same but for a unit suffix (`radius` for
/// `radius_m`); or at most a third of its letters away by Damerau and Levenshtein's distance.
pub fn did_you_mean<'c>(given: &str, candidates: impl IntoIterator<Item = &'c str>) -> Option<&'c str> {
    let plain = |s: &str| s.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect::<String>();
    let stem = |s: &str| s.rsplit_once('_').map_or_else(|| plain(s), |(stem, _)| plain(stem));
    // Distances take quadratic time, and no name is this long.
    if given.len() > 100 || given.is_empty() {
        return None;
    }
    let wanted = plain(given);
    let mut best: Option<(usize, &str)> = None;
    for candidate in candidates {
        if candidate.len() > 100 {
            continue;
        }
        let name = plain(candidate);
        let distance = if name == wanted {
            0
        } else if stem(candidate) == wanted || (given.contains('_') && stem(given) == stem(candidate)) {
            1
        } else {
            let letters = wanted.chars().count().max(name.chars().count());
            let distance = strsim::damerau_levenshtein(&wanted, &name);
            if distance * 3 > letters {
                continue;
            }
            distance + 1
        };
        if best.is_none_or(|(least, _)| distance < least) {
            best = Some((distance, candidate));
        }
    }
    best.map(|(_, candidate)| candidate)
}

/// The names in quotes, separated by commas; the first twelve of them.
pub fn listed<'c>(names: impl IntoIterator<Item = &'c str>) -> String {
    let mut names = names.into_iter();
    let first: Vec<String> = names.by_ref().take(12).map(|n| format!("\"{n}\"")).collect();
    let more = names.count();
    let list = first.join(", ");
    if more == 0 { list } else { format!("{list} and {more} more") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_names_are_suggested_and_far_ones_are_not() {
        let keys = ["radius_m", "center_m", "type", "vertical_fov_deg", "horizontal_fov_deg"];
        for (given, expected) in [
            ("raduis_m", Some("radius_m")),
            ("radius", Some("radius_m")),
            ("radius_mm", Some("radius_m")),
            ("Radius_M", Some("radius_m")),
            ("centre_m", Some("center_m")),
            ("typ", Some("type")),
            ("verticalFovDeg", Some("vertical_fov_deg")),
            ("horizontal_fov", Some("horizontal_fov_deg")),
            ("colour", None),
            ("", None),
        ] {
            assert_eq!(did_you_mean(given, keys), expected, "{given}");
        }
    }

    #[test]
    fn the_nearest_of_several_wins() {
        assert_eq!(did_you_mean("N-BK", ["N-SF11", "N-BK7", "N-BAK4"]), Some("N-BK7"));
    }

    #[test]
    fn long_lists_are_cut() {
        let names: Vec<String> = (0..20).map(|i| i.to_string()).collect();
        assert!(listed(names.iter().map(String::as_str)).ends_with("\"11\" and 8 more"));
    }
}
