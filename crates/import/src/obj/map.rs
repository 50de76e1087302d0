//! Images of MTL and their options.

use std::path::Path;

use serde_json::{Value, json};

use crate::{Builder, extension};

/// The kinds of files that images may be.
const KINDS: [&str; 6] = ["png", "jpg", "jpeg", "bmp", "exr", "hdr"];

/// What `map_Kd` states: an image of the format without its factor; `None`, and a note, if it cannot be read.
pub(super) fn image(words: &str, place: &str, builder: &mut Builder<'_>) -> Option<Value> {
    let words = words.replace('\\', "/");
    let options = Options::of(&words);
    let file = file(options.name, place, builder)?;
    for option in &options.ignored {
        builder.leave_out(place, format!("the option {option} of map_Kd is ignored"));
    }
    let mut image = json!({ "type": "image", "file": file });
    if options.scale != [1.0; 2] {
        image["uv_scale"] = json!(options.scale);
    }
    if options.offset != [0.0; 2] {
        image["uv_offset"] = json!(options.offset);
    }
    if options.clamped {
        image["wrap"] = json!("clamp");
        builder.approximate(place, "-clamp of map_Kd: beyond its edges the image continues its outermost texels");
    }
    Some(image)
}

/// The words before the name of an image.
#[derive(Debug, PartialEq)]
struct Options<'a> {
    name: &'a str,
    /// Factors on the texture coordinates, and what is added after that.
    scale: [f64; 2],
    offset: [f64; 2],
    clamped: bool,
    /// Options that change the image and are not honoured.
    ignored: Vec<&'a str>,
}

impl<'a> Options<'a> {
    fn of(words: &'a str) -> Self {
        let mut found =
            Self { name: words.trim(), scale: [1.0; 2], offset: [0.0; 2], clamped: false, ignored: Vec::new() };
        while let Some(option) = first_word(found.name).filter(|word| word.starts_with('-')) {
            // `-mm` and those for one number or a word have what follows; `-s`, `-o` and `-t` up to three numbers.
            let values = match option {
                "-s" | "-o" | "-t" => 3,
                "-mm" => 2,
                _ => 1,
            };
            let mut rest = found.name[option.len()..].trim_start();
            let mut numbers = Vec::new();
            let mut word = None;
            for _ in 0..values {
                // What is no number may be the name already, if more numbers may follow.
                let Some(next) = first_word(rest).filter(|next| values == 1 || next.parse::<f64>().is_ok()) else {
                    break;
                };
                numbers.extend(next.parse::<f64>().ok().filter(|number| number.is_finite()));
                word = Some(next);
                rest = rest[next.len()..].trim_start();
            }
            if rest.is_empty() {
                // The image has the name of an option.
                break;
            }
            let uv = |default: f64| [0, 1].map(|k: usize| numbers.get(k).copied().unwrap_or(default));
            match option {
                "-s" => found.scale = uv(1.0),
                "-o" => found.offset = uv(0.0),
                "-clamp" => found.clamped = word == Some("on"),
                // Nothing, or how an image is filtered.
                "-blendu" | "-blendv" | "-texres" | "-boost" => {}
                "-t" if numbers.iter().all(|number| *number == 0.0) => {}
                "-mm" if numbers == [0.0, 1.0] => {}
                "-cc" if word == Some("off") => {}
                "-bm" if numbers == [1.0] => {}
                _ => found.ignored.push(option),
            }
            found.name = rest;
        }
        found
    }
}

fn first_word(words: &str) -> Option<&str> {
    words.split_whitespace().next()
}

/// The file of an image in the scene.
fn file(name: &str, place: &str, builder: &mut Builder<'_>) -> Option<String> {
    if let Some(known) = builder.known.get(name) {
        return known.clone();
    }
    let kind = extension(Path::new(name));
    let added = match (builder.near)(name) {
        Ok(bytes) if KINDS.contains(&kind.as_str()) => Some(builder.add_file("image", &kind, bytes)),
        Ok(_) => {
            builder.leave_out(place, format!("map_Kd \"{name}\" is not PNG, JPEG, BMP, EXR or HDR"));
            None
        }
        Err(why) => {
            builder.leave_out(place, format!("map_Kd \"{name}\" cannot be read: {why}"));
            None
        }
    };
    builder.known.insert(name.to_owned(), added.clone());
    added
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_come_before_the_name() {
        let plain = |name| Options { name, scale: [1.0; 2], offset: [0.0; 2], clamped: false, ignored: Vec::new() };
        assert_eq!(Options::of(" my tiles.png "), plain("my tiles.png"));
        assert_eq!(Options::of("-s 2 my tiles.png"), Options { scale: [2.0, 1.0], ..plain("my tiles.png") });
        assert_eq!(
            Options::of("-s 2 3 1 -o 0.5 -0.25 0 -blendu on -mm 0 1 -clamp on a.png"),
            Options { scale: [2.0, 3.0], offset: [0.5, -0.25], clamped: true, ..plain("a.png") }
        );
        let odd = Options::of("-t 0.1 0 -bm 2 -imfchan r -clamp off a.png");
        assert_eq!(odd, Options { ignored: vec!["-t", "-bm", "-imfchan"], ..plain("a.png") });
        assert_eq!(Options::of("-s 1 1").name, "-s 1 1");
    }
}
