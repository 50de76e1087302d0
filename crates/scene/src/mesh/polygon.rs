//! Polygons as triangles.

use glam::DVec3;

/// Polygons with more corners than this are cut as fans: clipping ears takes time in the cube of the corners.
const MOST_EARS: usize = 256;

/// How polygons are cut into triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cut {
    /// So that flat ones keep their outline, concave ones too.
    Outline,
    /// As fans from the first corner, as Mitsuba does. Concave ones may overlap themselves.
    Fans,
}

impl Cut {
    /// Cuts the polygon whose corners are the vertices `corners` into triangles with the same orientation.
    pub(super) fn triangulate(
        self,
        corners: &[u32],
        position: impl Fn(u32) -> [f64; 3],
        triangles: &mut Vec<[u32; 3]>,
    ) {
        match self {
            Self::Outline => triangulate(corners, position, triangles),
            Self::Fans => fan(corners, triangles),
        }
    }
}

/// Cuts a polygon as a fan.
fn fan(corners: &[u32], triangles: &mut Vec<[u32; 3]>) {
    if let [first, rest @ ..] = corners {
        triangles.extend(rest.windows(2).map(|edge| [*first, edge[0], edge[1]]));
    }
}

/// Cuts the polygon whose corners are the vertices `corners` into triangles with the same orientation.
///
/// A quadrilateral is cut along a diagonal on whose two sides the normals agree; a polygon of more corners by clipping
/// ears (Meisters 1975) in the plane of its mean normal, so concave ones are kept as they are; one that crosses itself, or has more than
/// [`MOST_EARS`] corners, is cut as a fan. Fewer than three corners give nothing.
pub(super) fn triangulate(corners: &[u32], position: impl Fn(u32) -> [f64; 3], triangles: &mut Vec<[u32; 3]>) {
    match *corners {
        [] | [_] | [_, _] => {}
        [a, b, c] => triangles.push([a, b, c]),
        [a, b, c, d] => {
            let [pa, pb, pc, pd] = [a, b, c, d].map(|i| DVec3::from(position(i)));
            let normal = |p: DVec3, q: DVec3, r: DVec3| (q - p).cross(r - p);
            if normal(pa, pb, pc).dot(normal(pa, pc, pd)) < 0.0 {
                triangles.extend([[a, b, d], [b, c, d]]);
            } else {
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        _ => {
            let before = triangles.len();
            if corners.len() > MOST_EARS || !clip_ears(corners, &position, triangles) {
                triangles.truncate(before);
                fan(corners, triangles);
            }
        }
    }
}

/// Clips ears until three corners are left; false if at some point there is none.
fn clip_ears(corners: &[u32], position: &impl Fn(u32) -> [f64; 3], triangles: &mut Vec<[u32; 3]>) -> bool {
    let points: Vec<DVec3> = corners.iter().map(|&i| position(i).into()).collect();
    // Newell's normal: twice the vector area.
    let mut normal = DVec3::ZERO;
    for i in 0..points.len() {
        normal += (points[i] - points[0]).cross(points[(i + 1) % points.len()] - points[0]);
    }
    // Dropping the normal's largest component projects without turning the polygon over, if the other two keep their
    // cyclic order for a positive one.
    let axis = (0..3).max_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs())).unwrap_or(2);
    let (i, j) = if normal[axis] < 0.0 { ((axis + 2) % 3, (axis + 1) % 3) } else { ((axis + 1) % 3, (axis + 2) % 3) };
    let flat: Vec<[f64; 2]> = points.iter().map(|p| [p[i], p[j]]).collect();
    let turn = |a: usize, b: usize, c: usize| {
        let ([ax, ay], [bx, by], [cx, cy]) = (flat[a], flat[b], flat[c]);
        (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    };
    let mut left: Vec<usize> = (0..corners.len()).collect();
    while left.len() > 3 {
        let n = left.len();
        let ear = (0..n).find(|&k| {
            let (a, b, c) = (left[(k + n - 1) % n], left[k], left[(k + 1) % n]);
            let inside = |p: usize| turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
            turn(a, b, c) > 0.0 && !left.iter().any(|&p| p != a && p != b && p != c && inside(p))
        });
        let Some(k) = ear else { return false };
        triangles.push([left[(k + n - 1) % n], left[k], left[(k + 1) % n]].map(|p| corners[p]));
        left.remove(k);
    }
    triangles.push([corners[left[0]], corners[left[1]], corners[left[2]]]);
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(points: &[[f64; 3]]) -> (f64, usize) {
        let corners: Vec<u32> = (0..points.len() as u32).collect();
        let mut triangles = Vec::new();
        triangulate(&corners, |i| points[i as usize], &mut triangles);
        let one = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| DVec3::from(points[i as usize]));
            0.5 * (b - a).cross(c - a).length()
        };
        (triangles.iter().map(one).sum(), triangles.len())
    }

    #[test]
    fn fans_begin_at_the_first_corner() {
        let mut triangles = Vec::new();
        for corners in [&[][..], &[1], &[1, 2], &[4, 5, 6], &[7, 8, 9, 6, 5]] {
            Cut::Fans.triangulate(corners, |_| [0.0; 3], &mut triangles);
        }
        assert_eq!(triangles, [[4, 5, 6], [7, 8, 9], [7, 9, 6], [7, 6, 5]]);
    }

    #[test]
    fn concave_polygons_keep_their_area() {
        // An arrowhead: as a fan from its first corner it would overlap itself.
        let arrow = [[0.0, 2.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]];
        assert_eq!(area(&arrow), (1.0, 2));
        assert_eq!(area(&[arrow[1], arrow[2], arrow[3], arrow[0]]), (1.0, 2));
        // A plus sign of five unit squares, started at each of its corners, seen along each axis.
        let plus: [[f64; 2]; 12] = [
            [1.0, 0.0],
            [2.0, 0.0],
            [2.0, 1.0],
            [3.0, 1.0],
            [3.0, 2.0],
            [2.0, 2.0],
            [2.0, 3.0],
            [1.0, 3.0],
            [1.0, 2.0],
            [0.0, 2.0],
            [0.0, 1.0],
            [1.0, 1.0],
        ];
        for start in 0..12 {
            for lift in
                [|[x, y]: [f64; 2]| [x, y, 0.0], |[x, y]: [f64; 2]| [y, 0.0, x], |[x, y]: [f64; 2]| [0.0, -x, y]]
            {
                let points: Vec<[f64; 3]> = (0..12).map(|i| lift(plus[(start + i) % 12])).collect();
                assert_eq!(area(&points), (5.0, 10), "from {start}");
            }
        }
    }

    #[test]
    fn a_polygon_that_crosses_itself_or_is_flat_still_gives_triangles() {
        assert_eq!(area(&[[0.0; 3]; 5]).1, 3);
        let star: Vec<[f64; 3]> = (0..5)
            .map(|i| {
                let angle = f64::from(i) * 2.0 * std::f64::consts::TAU / 5.0;
                [angle.cos(), angle.sin(), 0.0]
            })
            .collect();
        assert_eq!(area(&star).1, 3);
        assert_eq!(area(&[[0.0; 3]; 300]).1, 298);
        assert_eq!(area(&[[0.0; 3]; 2]).1, 0);
    }
}
