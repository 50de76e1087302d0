//! Interfaces that coincide although nothing says what fills the place between them.
//!
//! A dielectric that states the media on both its sides expects to be met alone. Where two of them lie closer to each other than
//! positions can be told apart, rounding decides which one a path meets, and light is lost or refracted as nowhere in nature.
//! Solids with priorities may touch (see [`interaction`](crate::scene::interaction)); these may not, so a render says where they do.

use crate::scene::prepare::Prepared;
use etalon_geometry::{Hit, SurfacePoint};
use std::collections::BTreeMap;

/// Lines through the picture along each side of it.
const LINES: u32 = 32;
/// Pairs that are named, at most.
const MOST_NAMED: usize = 8;

/// Two objects whose interfaces coincide.
struct Pair {
    /// Lines through the picture that cross them where they coincide.
    lines: u32,
    /// How far apart they are, at most, and how far apart they would have to be, in units of the frame.
    apart: f64,
    needed: f64,
}

/// A message for each pair of objects whose interfaces coincide somewhere along a grid of lines through the picture.
pub(crate) fn warnings(prepared: &Prepared) -> Vec<String> {
    if !prepared.surfaces.stated_media.iter().any(Option::is_some) {
        return Vec::new();
    }
    let camera = prepared.tracing_camera();
    let mut pairs = BTreeMap::<(u32, u32), Pair>::new();
    for line in 0..LINES * LINES {
        let at = |number: u32| 2.0 * (f64::from(number) + 0.5) / f64::from(LINES) - 1.0;
        let ray = camera.ray_at([at(line % LINES), at(line / LINES)], [0.5; 2], 0.5);
        let mut hits: Vec<Hit<f64>> = Vec::new();
        prepared.geometry.all_hits(&ray, 0.0, |hit| {
            hits.push(hit);
            ray.t_max
        });
        hits.sort_by(|a, b| a.t.total_cmp(&b.t));
        let points = hits.iter().map(|hit| prepared.geometry.surface(&ray, hit));
        // Interfaces, and their objects.
        let interfaces: Vec<(u32, SurfacePoint<f64>)> = points
            .filter_map(|point| {
                let surface = prepared.surfaces.of(&point);
                surface.stated_media().map(|_| (surface.object, point))
            })
            .collect();
        for neighbours in interfaces.windows(2) {
            let [(a, first), (b, second)] = neighbours else { continue };
            let same = a == b && first.surface.instance == second.surface.instance;
            let apart = (second.position - first.position).dot(first.normal).abs();
            let needed = 2.0 * (first.position_error + second.position_error);
            // They are as far apart as they look only where they face alike.
            let parallel = first.normal.dot(second.normal).abs() > 0.999;
            if !same && parallel && apart <= needed {
                let pair = pairs.entry((*a.min(b), *a.max(b))).or_insert(Pair { lines: 0, apart: 0.0, needed: 0.0 });
                pair.lines += 1;
                pair.apart = pair.apart.max(apart);
                pair.needed = pair.needed.max(needed);
            }
        }
    }
    let more = pairs.len().saturating_sub(MOST_NAMED);
    let mut messages: Vec<String> =
        pairs.iter().take(MOST_NAMED).map(|(&objects, pair)| message(prepared, objects, pair)).collect();
    if more > 0 {
        messages.push(format!("{more} more pairs of objects have interfaces that coincide"));
    }
    messages
}

fn message(prepared: &Prepared, (a, b): (u32, u32), pair: &Pair) -> String {
    let name = |object: u32| prepared.object(object).map_or_else(String::new, |object| object.name.clone());
    let metre = prepared.frame.per_m();
    format!(
        "the interfaces of objects \"{}\" and \"{}\" coincide: on {} of {} test rays through the picture they are at most {:.1e} m apart, \
         but need to be more than {:.1e} m apart to be distinguished. Light between them is lost or refracted wrongly. Give both \
         materials a \"priority\" in place of \"exterior\", so that they share one interface, or leave a gap",
        name(a),
        name(b),
        pair.lines,
        LINES * LINES,
        pair.apart / metre,
        pair.needed / metre,
    )
}
