//! EULUMDAT files (`.ldt`): a number or a text a line, in a fixed order (Stockmar 1990).

use super::{MOST_VALUES, Photometry};

/// Lines before the data of the lamps.
const HEAD: usize = 26;
/// Lines of each set of lamps, and of the direct ratios after them.
const OF_LAMPS: usize = 6;
const RATIOS: usize = 10;

/// The intensities of a file.
///
/// # Errors
/// A sentence that says what is wrong with it.
pub(crate) fn read_eulumdat(bytes: &[u8]) -> Result<Photometry, String> {
    let text = String::from_utf8_lossy(bytes);
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    // Some programs write a comma for the point.
    let number = |line: usize, what: &str| -> Result<f64, String> {
        let text = lines.get(line - 1).ok_or_else(|| format!("the file ends before line {line}, {what}"))?;
        let number = text.replace(',', ".").parse().ok().filter(|number: &f64| number.is_finite());
        let shown = || crate::problem::shortened((*text).to_owned());
        number.ok_or_else(|| format!("line {line}, {what}, is \"{}\", no number", shown()))
    };
    let count = |line: usize, what: &str, most: usize| -> Result<usize, String> {
        let value = number(line, what)?;
        let possible = (0.0..=most as f64).contains(&value) && value.fract() == 0.0;
        possible.then_some(value as usize).ok_or_else(|| format!("line {line}, {what}, is {value}"))
    };
    let symmetry = count(3, "the symmetry", 4)?;
    let planes = count(4, "the number of planes", MOST_VALUES)?;
    let angles = count(6, "the number of angles of a plane", MOST_VALUES)?;
    let conversion = number(24, "the conversion factor")?;
    let sets = count(HEAD, "the number of sets of lamps", 1000)?;
    if planes == 0 || angles < 2 || sets == 0 {
        return Err(format!("it has {planes} planes of {angles} angles, and {sets} sets of lamps"));
    }
    // Of several sets the first counts.
    let flux_lm = number(HEAD + 3, "the flux of the lamps")?;
    let stored = match symmetry {
        0 => planes,
        1 => 1,
        2 | 3 if planes % 2 == 0 => planes / 2 + 1,
        4 if planes % 4 == 0 => planes / 4 + 1,
        _ => return Err(format!("{planes} planes cannot have the symmetry {symmetry}")),
    };
    if stored.checked_mul(angles).is_none_or(|count| count > MOST_VALUES) {
        return Err(format!("{stored} × {angles} intensities are more than {MOST_VALUES}"));
    }
    let first = HEAD + OF_LAMPS * sets + RATIOS + 1;
    let needed = first - 1 + planes + angles + stored * angles;
    // A hostile file may announce more than it has.
    if lines.len() < needed {
        return Err(format!("it has {} lines; its planes and angles need {needed}", lines.len()));
    }
    let many = |from: usize, count: usize, what: &str| -> Result<Vec<f64>, String> {
        (from..from + count).map(|line| number(line, what)).collect()
    };
    let all_planes_deg = many(first, planes, "the angle of a plane")?;
    let polar_deg = many(first + planes, angles, "an angle of a plane")?;
    let factor = conversion * flux_lm / 1000.0;
    if !(factor > 0.0 && factor.is_finite()) {
        return Err(format!("its factor and its flux of {flux_lm} lm make {factor}: this must be above 0"));
    }
    let values = many(first + planes + angles, stored * angles, "an intensity")?;
    let mut intensities: Vec<f64> = values.iter().map(|value| value * factor).collect();
    let azimuth_deg: Vec<f64> = match symmetry {
        0 => {
            // The last plane is the first one again.
            intensities.extend_from_within(..angles);
            all_planes_deg.iter().copied().chain([360.0]).collect()
        }
        1 => vec![0.0],
        3 => all_planes_deg[planes / 4..].iter().copied().take(stored).collect(),
        _ => all_planes_deg[..stored].to_vec(),
    };
    Photometry::new(&polar_deg, &azimuth_deg, &intensities)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file of four planes, three angles and one set of 2000 lm.
    fn file(symmetry: u32, intensities: &[f64]) -> String {
        let mut lines: Vec<String> =
            ["maker", "1", &symmetry.to_string(), "4", "90", "3", "45"].map(str::to_owned).to_vec();
        lines.extend(["report", "name", "number", "file", "date"].map(str::to_owned));
        lines.extend((0..9).map(|_| "100".to_owned()));
        lines.extend(["100", "80", "0,5", "0", "1"].map(str::to_owned));
        lines.extend(["1", "lamp", "2000", "3000K", "80", "20"].map(str::to_owned));
        lines.extend((0..10).map(|_| "0.5".to_owned()));
        lines.extend(["0", "90", "180", "270", "0", "45", "90"].map(str::to_owned));
        lines.extend(intensities.iter().map(f64::to_string));
        lines.join("\r\n")
    }

    #[test]
    fn symmetries_are_read_as_planes() {
        let plane = |a: f64| [100.0, 50.0, a];
        let at = |table: &Photometry| [0.0, 0.25, 0.5, 0.75, 1.0].map(|turns| table.eval(0.25, turns));
        let read = |symmetry, planes: &[f64]| {
            let values: Vec<f64> = planes.iter().flat_map(|a| plane(*a)).collect();
            read_eulumdat(file(symmetry, &values).as_bytes()).unwrap()
        };
        assert_eq!(at(&read(0, &[1.0, 2.0, 3.0, 4.0])), [1.0, 2.0, 3.0, 4.0, 1.0]);
        assert_eq!(at(&read(1, &[7.0])), [7.0; 5]);
        assert_eq!(at(&read(2, &[1.0, 2.0, 3.0])), [1.0, 2.0, 3.0, 2.0, 1.0]);
        assert_eq!(at(&read(3, &[2.0, 3.0, 4.0])), [3.0, 2.0, 3.0, 4.0, 3.0]);
        assert_eq!(at(&read(4, &[1.0, 2.0])), [1.0, 2.0, 1.0, 2.0, 1.0]);
        // 100 cd/klm · 2 klm · 0.5.
        assert_eq!(read(1, &[7.0]).eval(0.0, 0.3), 100.0);
    }

    #[test]
    fn what_is_wrong_with_a_file_is_said() {
        let wrong = |text: &str, says: &str| {
            let why = read_eulumdat(text.as_bytes()).expect_err(says);
            assert!(why.contains(says), "{why}");
        };
        let right = file(1, &[100.0, 50.0, 7.0]);
        wrong("maker\n1\n", "ends before line 3");
        wrong(&right.replace("maker\r\n1\r\n1", "maker\r\n1\r\n9"), "the symmetry, is 9");
        wrong(&right.replace("\r\n4\r\n90", "\r\n5\r\n90"), "need 53");
        wrong(&file(4, &[1.0]), "need 55");
        wrong(
            &right.replace("\r\n4\r\n90", "\r\n6\r\n90").replace("maker\r\n1\r\n1", "maker\r\n1\r\n4"),
            "cannot have the symmetry 4",
        );
        wrong(&right.replace("\r\n2000", "\r\n0"), "this must be above 0");
        wrong(&right.replace("\r\n7", "\r\n-7"), "intensity number 3");
        wrong(&right.replace("\r\n3\r\n45", "\r\nx\r\n45"), "no number");
    }
}
