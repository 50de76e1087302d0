//! Normal maps and bump maps: the normals that an image makes a surface scatter around. What becomes of a normal that
//! contradicts the surface is said in `bsdf/shading.rs`.

use crate::bsdf::Shading;
use etalon_optics::Vec3;
use etalon_scene::{Bitangent, ImageTexture, Relief};

/// The point with the normal that an image gives it, from how it moves with u and with v, in units of the frame.
///
/// **Normal maps.** The image's vector stands in the frame (t, b, n): n the normal that is there already, t the direction
/// across it in which u grows, b the one across both in which v does, or n × t.
///
/// **Bump maps** (Blinn 1978). The surface moved by h along its normal has the normal n − ∇h up to its length, with the gradient
/// ∇h = h_u·(p_v × n)/J + h_v·(n × p_u)/J along the surface, J = n·(p_u × p_v).
pub(crate) fn bend<'a>(
    relief: &Relief,
    shading: Shading<'a>,
    [along_u, along_v]: [Vec3<f64>; 2],
    per_m: f64,
) -> Shading<'a> {
    let n = shading.shading_normal();
    let normal = match relief {
        Relief::Normals { texture, strength, bitangent, .. } => {
            let [x, y, z] = texture.eval(shading.uv).map(|v| 2.0 * v - 1.0);
            let across = along_u - n * n.dot(along_u);
            if across.length_squared() == 0.0 {
                return shading;
            }
            let t = across.normalized();
            let b = n.cross(t);
            let b = if *bitangent == Bitangent::AlongV && b.dot(along_v) < 0.0 { -b } else { b };
            t * (x * strength[0]) + b * (y * strength[1]) + n * z
        }
        Relief::Heights { texture, height_m, .. } => {
            let [slope_u, slope_v] = slopes(texture, shading.uv).map(|slope| slope * height_m * per_m);
            let jacobian = n.dot(along_u.cross(along_v));
            if jacobian == 0.0 {
                return shading;
            }
            n - (along_v.cross(n) * slope_u + n.cross(along_u) * slope_v) / jacobian
        }
    };
    let squared = normal.length_squared();
    match squared > 0.0 && squared.is_finite() {
        true => shading.mapped_to(normal.normalized(), relief.terminator()),
        false => shading,
    }
}

/// Derivatives of the first channel by u and v: central differences over a texel, exact where the image is linear.
fn slopes(texture: &ImageTexture, [u, v]: [f64; 2]) -> [f64; 2] {
    let size = [texture.image.width, texture.image.height].map(f64::from);
    // Along u or v, half a texel of the image in the direction in which more of them lie.
    let step = |along: usize| {
        let texels = [0, 1].map(|k| size[k] * texture.uv_map.matrix[k][along].abs().max(f64::MIN_POSITIVE));
        0.5 / texels[0].max(texels[1])
    };
    let height = |u: f64, v: f64| texture.eval([u, v])[0];
    let (du, dv) = (step(0), step(1));
    let slope = |difference: f64, step: f64| if step.is_finite() { difference / (2.0 * step) } else { 0.0 };
    [slope(height(u + du, v) - height(u - du, v), du), slope(height(u, v + dv) - height(u, v - dv), dv)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_scene::{Image, Terminator, Texels, UvMap, Wrap};
    use std::sync::Arc;

    /// Eight columns and four rows, whose heights are told by column and row, both from zero and rows from the top.
    fn heights(of: impl Fn(f64, f64) -> f64, uv_scale: [f64; 2], uv_offset: [f64; 2]) -> ImageTexture {
        let texels = (0..32).map(|i| [of(f64::from(i % 8), f64::from(i / 8)) as f32; 3]).collect();
        ImageTexture {
            wrap: [Wrap::Clamp; 2],
            uv_map: UvMap::scaled(uv_scale, uv_offset),
            ..ImageTexture::new(Image::new(8, 4, Texels::F32(texels)))
        }
    }

    #[test]
    fn slopes_are_those_of_an_even_ramp_and_of_a_step_over_one_texel() {
        for (scale, offset) in [([1.0, 1.0], [0.0, 0.0]), ([2.0, 0.5], [-0.5, 0.25]), ([-0.5, -2.0], [0.75, 1.5])] {
            // Image coordinates ½, ½ are in the middle: those of the texture that are mapped there.
            let middle = [0, 1].map(|k| (0.5 - offset[k]) / scale[k]);
            let even = heights(|column, row| 0.25 * column - 0.5 * row, scale, offset);
            // A texel is 1/8 wide and 1/4 high, and rows count from the top, v from below.
            let want = [0.25 * 8.0 * scale[0], 0.5 * 4.0 * scale[1]];
            let got = slopes(&even, middle);
            // Heights are exact in single precision, and so is the interpolation but for rounding.
            assert!((got[0] - want[0]).abs().max((got[1] - want[1]).abs()) < 1e-12, "{got:?} is not {want:?}");
            // Up by one between the middle columns, and between the middle rows: over a texel, neither more nor less.
            let step = heights(|c, r| f64::from(u8::from(c > 3.5)) + f64::from(u8::from(r < 1.5)), scale, offset);
            let want = [8.0 * scale[0], 4.0 * scale[1]];
            let got = slopes(&step, middle);
            assert!((got[0] - want[0]).abs().max((got[1] - want[1]).abs()) < 1e-12, "{got:?} is not {want:?}");
        }
    }

    #[test]
    fn slopes_of_a_turned_and_sheared_ramp_are_those_of_the_surface() {
        let mut texture = heights(|column, row| 0.25 * column - 0.5 * row, [1.0; 2], [0.0; 2]);
        let [[a, b], [c, d]] = [[0.75, -0.5], [0.25, 1.5]];
        texture.uv_map = UvMap { matrix: [[a, b], [c, d]], offset: [0.25, -0.5] };
        // Slopes 2 along the image and 2 up it, of coordinates that are au + bv and cu + dv: in the middle of it.
        let got = slopes(&texture, [0.6, 0.55]);
        let want = [2.0 * a + 2.0 * c, 2.0 * b + 2.0 * d];
        assert!((got[0] - want[0]).abs().max((got[1] - want[1]).abs()) < 1e-12, "{got:?} is not {want:?}");
    }

    #[test]
    fn heights_bend_a_normal_to_that_of_the_surface_they_raise() {
        // Neither perpendicular nor of unit length.
        let along = [Vec3::new(2.0, 0.3, -0.4), Vec3::new(-0.5, 1.5, 0.2)];
        let n = along[0].cross(along[1]).normalized();
        let texture = heights(|column, row| 0.25 * column - 0.5 * row, [1.0; 2], [0.0; 2]);
        let (height_m, per_m) = (0.1, 4.0);
        let shading = Shading::flat(n).with_uv([0.5, 0.5]);
        let got = bend(&Relief::Heights { texture, height_m, terminator: Terminator::Mirrored }, shading, along, per_m)
            .shading_normal();
        // p + hn moves with u by p_u + h_u n: slopes 2 and 2 of the image.
        let raised = along.map(|v| v + n * (2.0 * height_m * per_m));
        let want = raised[0].cross(raised[1]).normalized();
        assert!((got - want).length() < 1e-14, "{got:?} is not {want:?}");
    }

    #[test]
    fn an_image_of_normals_stands_in_the_frame_of_its_coordinates() {
        let texel = [0.5 + 0.5 * 0.48, 0.5 + 0.5 * 0.36, 0.5 + 0.5 * 0.8].map(|v: f64| v as f32);
        let mut texture = heights(|_, _| 0.0, [1.0; 2], [0.0; 2]);
        texture.image = Arc::new(Image::new(1, 1, Texels::F32(vec![texel])));
        let n = Vec3::new(0.0, 0.0, 1.0);
        // u grows along x, but not across the normal; v against y, or along it. What is across u is y, whatever v does.
        let mut relief = Relief::Normals {
            texture,
            strength: [0.5; 2],
            bitangent: Bitangent::AlongV,
            terminator: Terminator::Mirrored,
        };
        for (bitangent, strength) in [(Bitangent::AlongV, [0.5, 0.5]), (Bitangent::AcrossU, [-0.5, 0.75])] {
            if let Relief::Normals { strength: s, bitangent: b, .. } = &mut relief {
                (*s, *b) = (strength, bitangent);
            }
            for (v, sign) in [(Vec3::new(0.4, -3.0, 0.5), -1.0), (Vec3::new(0.4, 3.0, 0.5), 1.0)] {
                let sign = if bitangent == Bitangent::AlongV { sign } else { 1.0 };
                let along = [Vec3::new(2.0, 0.0, 1.0), v];
                let got = bend(&relief, Shading::flat(n), along, 1.0).shading_normal();
                let want = Vec3::new(strength[0] * 0.48, sign * strength[1] * 0.36, 0.8).normalized();
                // Texels in single precision.
                assert!((got - want).length() < 1e-6, "{got:?} is not {want:?}");
            }
        }
        // Where nothing grows across the normal there is no frame.
        let nowhere = bend(&relief, Shading::flat(n), [n * 2.0, n], 1.0).shading_normal();
        assert_eq!(nowhere, n);
    }
}
