//! Transforms of Mitsuba: steps of which the first is applied first.

use etalon_scene::linear::affine_from_rows;
use glam::{DAffine3, DMat3, DVec3};

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
            turned(step.own_triple(0.0)?, angle_deg).ok_or_else(|| format!("{place}: its axis has no direction"))
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

/// A rotation about an axis, which Mitsuba takes as it is written: cos θ·1 + (1 − cos θ) a aᵀ + sin θ [a]×. If a is not of length 1, this
/// stretches and shears.
fn turned(axis: [f64; 3], angle_deg: f64) -> Option<DAffine3> {
    let rotation = rotation(axis, angle_deg)?;
    let a = DVec3::from(axis);
    if (a.length() - 1.0).abs() < 1e-6 {
        return Some(rotation);
    }
    let (sin, cos) = angle_deg.to_radians().sin_cos();
    let outer = DMat3::from_cols(a * a.x, a * a.y, a * a.z);
    let cross = DMat3::from_cols(DVec3::new(0.0, a.z, -a.y), DVec3::new(-a.z, 0.0, a.x), DVec3::new(a.y, -a.x, 0.0));
    Some(DAffine3::from_mat3(DMat3::IDENTITY * cos + outer * (1.0 - cos) + cross * sin))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What Mitsuba 3.9.1 prints for `ScalarTransform4f().rotate([1, 2, 0], 40)`.
    #[test]
    fn an_axis_that_is_not_of_length_1_stretches_as_in_mitsuba() {
        let rows = [
            [1.0, 0.467_911_12, 1.285_575_2],
            [0.467_911_12, 1.701_866_6, -0.642_787_6],
            [-1.285_575_2, 0.642_787_6, 0.766_044_44],
        ];
        let read = turned([1.0, 2.0, 0.0], 40.0).unwrap().matrix3.transpose().to_cols_array_2d();
        for (row, published) in read.iter().flatten().zip(rows.iter().flatten()) {
            assert!((row - published).abs() < 1e-6, "{read:?}");
        }
        let unit = turned([0.0, 1.0, 0.0], 30.0).unwrap();
        assert_eq!(Some(unit), rotation([0.0, 1.0, 0.0], 30.0));
        // Near the length 1 both are the same.
        let near = turned([0.0, 1.000_001_1, 0.0], 30.0).unwrap();
        assert!(near.abs_diff_eq(unit, 1e-6));
        assert_eq!(turned([0.0; 3], 30.0), None);
    }
}
