//! Normal maps and bump maps: the normals that an image makes a surface scatter around. What becomes of a normal that
//! contradicts the surface is said in `bsdf/shading.rs`.

use crate::bsdf::Shading;
use etalon_optics::Vec3;
use etalon_scene::{ImageTexture, Relief};

/// The point with the normal that an image gives it, from how it moves with u and with v, in units of the frame.
///
/// **Normal maps.** The image's vector stands in the frame (t, b, n): n the normal that is there already, t the direction
/// across it in which u grows, b the one across both in which v does.
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
        Relief::Normals { texture, strength } => {
            let [x, y, z] = texture.eval(shading.uv).map(|v| 2.0 * v - 1.0);
            let across = along_u - n * n.dot(along_u);
            if across.length_squared() == 0.0 {
                return shading;
            }
            let t = across.normalized();
            let b = n.cross(t);
            let b = if b.dot(along_v) < 0.0 { -b } else { b };
            t * (x * strength) + b * (y * strength) + n * z
        }
        Relief::Heights { texture, height_m } => {
            let [slope_u, slope_v] = slopes(texture, shading.uv).map(|slope| slope * height_m * per_m);
            let jacobian = n.dot(along_u.cross(along_v));
            if jacobian == 0.0 {
                return shading;
            }
            n - (along_v.cross(n) * slope_u + n.cross(along_u) * slope_v) / jacobian
        }
    };
    let squared = normal.length_squared();
    if squared > 0.0 && squared.is_finite() { shading.bent_to(normal.normalized()) } else { shading }
}

/// Derivatives of the first channel by u and v: central differences over a texel, exact where the image is linear.
fn slopes(texture: &ImageTexture, [u, v]: [f64; 2]) -> [f64; 2] {
    let size = [texture.image.width, texture.image.height].map(f64::from);
    let step = |k: usize| 0.5 / (size[k] * texture.uv_scale[k].abs().max(f64::MIN_POSITIVE));
    let height = |u: f64, v: f64| texture.eval([u, v])[0];
    let (du, dv) = (step(0), step(1));
    let slope = |difference: f64, step: f64| if step.is_finite() { difference / (2.0 * step) } else { 0.0 };
    [slope(height(u + du, v) - height(u - du, v), du), slope(height(u, v + dv) - height(u, v - dv), dv)]
}
