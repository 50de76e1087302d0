//! Transforms of Mitsuba: steps of which the first is applied first.

use etalon_scene::linear::affine_from_rows;
use glam::DAffine3;

use super::element::{Element, numbers};
use crate::matrix::{looking, rotation};

/// The map that a `<transform>` states.
pub(super) fn read(element: &Element) -> Result<DAffine3, String> {
    let mut map = DAffine3::IDENTITY;
    for step in &element.children {
        step.mark();
        map = self::step(step)? * map;
    }
    match map.is_finite() {
        true => Ok(map),
        false => Err(format!("{}: the transform is not finite", element.place)),
    }
}

fn step(step: &Element) -> Result<DAffine3, String> {
    let place = &step.place;
    let stated = |key: &str| {
        let text = step.attribute(key).ok_or_else(|| format!("{place}: it has no \"{key}\""))?;
        numbers(text).map_err(|why| format!("{place}: {why}"))
    };
    let triple = |key: &str| match stated(key)?[..] {
        [x, y, z] => Ok([x, y, z]),
        _ => Err(format!("{place}: \"{key}\" is not three numbers")),
    };
    match step.tag.as_str() {
        "translate" => Ok(DAffine3::from_translation(step.own_triple(0.0)?.into())),
        "scale" => Ok(DAffine3::from_scale(step.own_triple(1.0)?.into())),
        "rotate" => {
            let [angle_deg] = stated("angle")?[..] else { return Err(format!("{place}: \"angle\" is not a number")) };
            rotation(step.own_triple(0.0)?, angle_deg).ok_or_else(|| format!("{place}: its axis has no direction"))
        }
        "lookat" => {
            let up = if step.attribute("up").is_some() { triple("up")? } else { [0.0, 1.0, 0.0] };
            looking(triple("origin")?, triple("target")?, up)
                .ok_or_else(|| format!("{place}: it has no viewing direction, or its up is along it"))
        }
        "matrix" => match stated("value")?[..] {
            [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p] => {
                if [m, n, o] != [0.0; 3] || p == 0.0 {
                    return Err(format!("{place}: the last row is not 0 0 0 1"));
                }
                Ok(affine_from_rows(&[[a, b, c, d], [e, f, g, h], [i, j, k, l]].map(|row| row.map(|v| v / p))))
            }
            [a, b, c, d, e, f, g, h, i] => Ok(affine_from_rows(&[[a, b, c, 0.0], [d, e, f, 0.0], [g, h, i, 0.0]])),
            _ => Err(format!("{place}: a matrix has 16 numbers")),
        },
        other => Err(format!("{place}: <{other}> is not part of a transform")),
    }
}
