//! IES LM-63 files (ANSI/IES LM-63-19 and before): photometry of type C.
//!
//! After a line that names the version and lines of keywords comes `TILT=`, then numbers: lamps, lumens of a lamp, a factor, counts of angles,
//! type, units, size, two more factors, watts, the angles and the intensities.

use super::{MOST_VALUES, Photometry};

/// The intensities of a file.
///
/// # Errors
/// A sentence that says what is wrong with it.
pub(crate) fn read_ies(bytes: &[u8]) -> Result<Photometry, String> {
    // Names of makers may be in any encoding; numbers are in ASCII.
    let text = String::from_utf8_lossy(bytes);
    let version_2 = ["IESNA:LM-63-1995", "IESNA:LM-63-2002", "IES:LM-63-2019"];
    let mut lines = text.lines();
    let first = lines.clone().next().unwrap_or_default().trim().trim_start_matches('\u{feff}');
    let is_tilt = |line: &str| line.trim_start().to_ascii_uppercase().starts_with("TILT=");
    let tilt = lines.by_ref().find(|line| is_tilt(line)).ok_or("this is no IES file: there is no line TILT=")?;
    let tilt = tilt.trim().split_once('=').map_or("", |(_, what)| what.trim()).to_ascii_uppercase();
    let rest: Vec<&str> =
        lines.flat_map(|line| line.split([' ', '\t', ',', '\r'])).filter(|word| !word.is_empty()).collect();
    let mut numbers = Numbers { words: &rest, at: 0 };
    match tilt.as_str() {
        "NONE" => {}
        "INCLUDE" => {
            numbers.next("the lamp's position")?;
            let count = numbers.count("angles of tilt")?;
            let factors = numbers.many(2 * count, "angles of tilt and their factors")?.split_off(count);
            if factors.iter().any(|factor| *factor != 1.0) {
                return Err("the light depends on the luminaire's tilt (TILT=INCLUDE), which is not read".to_owned());
            }
        }
        other => return Err(format!("TILT={other} refers to another file, which is not read; TILT=NONE is")),
    }
    numbers.next("the number of lamps")?;
    numbers.next("the lumens of a lamp")?;
    let factor = numbers.next("the factor on the intensities")?;
    let vertical = numbers.count("vertical angles")?;
    let horizontal = numbers.count("horizontal angles")?;
    let kind = numbers.next("the type of photometry")?;
    if kind != 1.0 {
        return Err(format!(
            "its photometry is of type {}; type C (1) is read",
            if kind == 2.0 { "B (2)".to_owned() } else { format!("{kind}") }
        ));
    }
    numbers.many(4, "units and size of the luminaire")?;
    let ballast = numbers.next("the ballast factor")?;
    let further = numbers.next("the factor after that")?;
    numbers.next("the watts")?;
    // From 1995 on the second is kept for future use.
    let factor = factor * ballast * if version_2.contains(&first) { 1.0 } else { further };
    if !(factor > 0.0 && factor.is_finite()) {
        return Err(format!("the product of its factors is {factor}: it must be above 0"));
    }
    let values = vertical.checked_mul(horizontal).filter(|count| *count <= MOST_VALUES);
    let values = values.ok_or_else(|| format!("{vertical} × {horizontal} intensities are more than {MOST_VALUES}"))?;
    let polar_deg = numbers.many(vertical, "vertical angles")?;
    let azimuth_deg = numbers.many(horizontal, "horizontal angles")?;
    let intensities: Vec<f64> = numbers.many(values, "intensities")?.iter().map(|value| value * factor).collect();
    Photometry::new(&polar_deg, &azimuth_deg, &intensities)
}

/// Numbers one after the other.
struct Numbers<'t> {
    words: &'t [&'t str],
    at: usize,
}

impl Numbers<'_> {
    fn next(&mut self, what: &str) -> Result<f64, String> {
        let word = self.words.get(self.at).ok_or_else(|| format!("the file ends before {what}"))?;
        self.at += 1;
        let number = word.parse().ok().filter(|number: &f64| number.is_finite());
        number.ok_or_else(|| {
            format!("\"{}\" is no number: {what} should be here", crate::problem::shortened((*word).to_owned()))
        })
    }

    fn count(&mut self, what: &str) -> Result<usize, String> {
        let number = self.next(&format!("the number of {what}"))?;
        if !((1.0..=MOST_VALUES as f64).contains(&number) && number.fract() == 0.0) {
            return Err(format!("it says that it has {number} {what}"));
        }
        Ok(number as usize)
    }

    fn many(&mut self, count: usize, what: &str) -> Result<Vec<f64>, String> {
        // A hostile file may announce more than it has.
        if self.words.len() - self.at < count {
            return Err(format!("the file ends before its last {what}: {count} of them are announced"));
        }
        (0..count).map(|_| self.next(what)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "IESNA:LM-63-2002\r\n[TEST] 1\r\n[MANUFAC] none\r\nTILT=NONE\r\n1 -1 2 3 2 1 2 0.1 0.2 0\r\n0.5 1 10\r\n\
                        0 45 90\r\n0 90\r\n10 20 30\r\n40, 50, 60\r\n";

    #[test]
    fn a_file_is_read_with_its_factors() {
        let table = read_ies(FILE.as_bytes()).unwrap();
        assert_eq!([table.eval(0.0, 0.0), table.eval(0.125, 0.25), table.eval(0.25, 0.75)], [10.0, 50.0, 60.0]);
        // Before 1995 there was a second factor.
        let old = FILE.replace("IESNA:LM-63-2002", "IESNA91").replace("0.5 1 10", "0.5 0.1 10");
        assert_eq!(read_ies(old.as_bytes()).unwrap().eval(0.25, 0.25), 6.0);
        let tilted = FILE.replace("NONE", "INCLUDE\n1 2 0 90 1 1");
        assert_eq!(read_ies(tilted.as_bytes()).unwrap(), table);
    }

    #[test]
    fn what_is_wrong_with_a_file_is_said() {
        let wrong = |text: &str, says: &str| {
            let why = read_ies(text.as_bytes()).expect_err(says);
            assert!(why.contains(says), "{why}");
        };
        wrong("IESNA91\n", "no line TILT=");
        wrong(&FILE.replace("NONE", "lamp.tlt"), "refers to another file");
        wrong(&FILE.replace("NONE", "INCLUDE\n1 2 0 90 1 0.5"), "depends on the luminaire's tilt");
        wrong(&FILE.replace("1 2 0.1", "2 2 0.1"), "type B (2)");
        wrong(&FILE.replace("40, 50, 60", "40 50"), "ends before its last intensities");
        wrong(&FILE.replace("3 2 1", "3e9 2 1"), "3000000000 vertical angles");
        wrong(&FILE.replace("50", "-50"), "intensity number 5");
        wrong(&FILE.replace("0 90\r\n10", "0 80\r\n10"), "run from 0 to 80");
        wrong(&FILE.replace("0 45 90", "0 45 45"), "vertical angles are not");
        wrong(&FILE.replace("20", "x"), "\"x\" is no number");
        wrong(&FILE.replace("0.5 1 10", "0 1 10"), "must be above 0");
    }
}
