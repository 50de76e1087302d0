//! Material libraries (MTL). A line that cannot be read loses itself, not the library.

use etalon_optics::colour::rec709_from_xyz;

use super::ObjMaterial;
use super::lines::Statements;

/// The materials of a library, and its lines that are not honoured, each with why.
pub(super) fn read_mtl(bytes: &[u8], library: &str) -> (Vec<ObjMaterial>, Vec<String>) {
    let mut reading = Reading::default();
    for (line, text) in Statements::new(bytes) {
        if let Err(why) = reading.statement(&text) {
            reading.left_out.push(format!("{library}: line {line}: {why}"));
        }
    }
    // `Tr` is 1 − `d`, which holds where both are stated.
    for (material, share) in reading.materials.iter_mut().zip(&reading.clear) {
        let Some(share) = share else { continue };
        let stated = *material.dissolve.get_or_insert(*share);
        if (stated - share).abs() > 1e-3 {
            let name = &material.name;
            reading
                .left_out
                .push(format!("{library}: material \"{name}\": Tr and d disagree (Tr should be 1 − d): d is used"));
        }
    }
    (reading.materials, reading.left_out)
}

#[derive(Debug, Default)]
struct Reading {
    materials: Vec<ObjMaterial>,
    /// 1 − `Tr` of each material that states it.
    clear: Vec<Option<f32>>,
    left_out: Vec<String>,
}

impl Reading {
    fn statement(&mut self, text: &str) -> Result<(), String> {
        let (key, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
        let rest = rest.trim();
        if key == "newmtl" {
            self.clear.push(None);
            self.materials.push(ObjMaterial { name: rest.to_owned(), ..ObjMaterial::default() });
            return if rest.is_empty() { Err("a material has no name".to_owned()) } else { Ok(()) };
        }
        let (Some(material), Some(clear)) = (self.materials.last_mut(), self.clear.last_mut()) else {
            return Err(format!("{key} belongs to no material"));
        };
        let file = || if rest.is_empty() { Err(format!("{key} names no image")) } else { Ok(Some(rest.to_owned())) };
        match key.to_ascii_lowercase().as_str() {
            "ka" => material.ambient = Some(colour(key, rest)?),
            "kd" => material.diffuse = Some(colour(key, rest)?),
            "ks" => material.specular = Some(colour(key, rest)?),
            "ke" => material.emissive = Some(colour(key, rest)?),
            "ns" => material.shininess = Some(number(key, rest)?),
            "ni" => material.optical_density = Some(number(key, rest)?),
            "d" => match rest.strip_prefix("-halo") {
                Some(rest) => {
                    material.dissolve = Some(number(key, rest)?);
                    return Err("d -halo becomes d: it is the same at every angle".to_owned());
                }
                None => material.dissolve = Some(number(key, rest)?),
            },
            "tr" => *clear = Some(1.0 - number(key, rest)?),
            "illum" => material.illumination_model = Some(rest.parse().map_err(|_| no_number(key, rest))?),
            "map_ka" => material.ambient_texture = file()?,
            "map_kd" => material.diffuse_texture = file()?,
            "map_ks" => material.specular_texture = file()?,
            "map_ns" => material.shininess_texture = file()?,
            "map_d" => material.dissolve_texture = file()?,
            "map_bump" | "bump" => material.normal_texture = file()?,
            _ => {
                material.unknown_param.insert(key.to_owned(), rest.to_owned());
            }
        }
        Ok(())
    }
}

/// Three numbers, or one for all; of `xyz` the coordinates of CIE.
fn colour(key: &str, rest: &str) -> Result<[f32; 3], String> {
    let (numbers, is_xyz) = match rest.split_once(char::is_whitespace) {
        Some(("xyz", numbers)) => (numbers, true),
        Some(("spectral", _)) => return Err(format!("{key} is a file of a spectrum, which is not read")),
        _ => (rest, false),
    };
    let parsed: Result<Vec<f32>, String> = numbers.split_whitespace().map(|word| number(key, word)).collect();
    let stated = match parsed?[..] {
        [grey] => [grey; 3],
        [a, b, c, ..] => [a, b, c],
        _ => return Err(format!("{key} \"{rest}\" is no colour: it has one number or three")),
    };
    Ok(if is_xyz { rec709_from_xyz(stated.map(f64::from)).map(|v| v as f32) } else { stated })
}

fn number(key: &str, rest: &str) -> Result<f32, String> {
    let word = rest.split_whitespace().next().unwrap_or_default();
    word.parse().ok().filter(|v: &f32| v.is_finite()).ok_or_else(|| no_number(key, word))
}

fn no_number(key: &str, word: &str) -> String {
    format!("{key} \"{}\" is no number", word.chars().take(40).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_one_number_three_or_those_of_cie() {
        assert_eq!(colour("Kd", "0.5"), Ok([0.5; 3]));
        assert_eq!(colour("Kd", "0.5 0.25 1"), Ok([0.5, 0.25, 1.0]));
        // The white of sRGB.
        let white = colour("Kd", "xyz 0.9505 1 1.0891").unwrap();
        assert!(white.iter().all(|v| (v - 1.0).abs() < 1e-3), "{white:?}");
        for wrong in ["", "0.5 0.5", "x", "spectral a.rfl 1", "nan"] {
            assert!(colour("Kd", wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_line_that_cannot_be_read_loses_itself() {
        let text =
            b"Kd 1\nnewmtl a\nKd spectral a.rfl\nKs 0.5 \\\n 0.25 1\nd -halo 0.25\nNs x\nnewmtl b\nkd 0.5\nTr 0.75\n";
        let (materials, left_out) = read_mtl(text, "m.mtl");
        assert_eq!(materials.len(), 2);
        assert_eq!((materials[0].diffuse, materials[0].specular), (None, Some([0.5, 0.25, 1.0])));
        assert_eq!((materials[0].dissolve, materials[1].diffuse), (Some(0.25), Some([0.5; 3])));
        assert_eq!(materials[1].dissolve, Some(0.25));
        let lines: Vec<&str> = left_out.iter().filter_map(|what| what.split(": ").nth(1)).collect();
        assert_eq!(lines, ["line 1", "line 3", "line 6", "line 7"], "{left_out:?}");
    }
}
