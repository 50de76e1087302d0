//! CIELAB.

/// δ of CIELAB: the cube root turns into a line below δ³.
const DELTA: f64 = 6.0 / 29.0;

/// CIELAB (L*, a*, b*) of an XYZ beside a white (CIE 15:2018, §8.2.1).
pub fn lab_from_xyz(xyz: [f64; 3], white: [f64; 3]) -> [f64; 3] {
    let f: [f64; 3] = std::array::from_fn(|c| {
        let v = xyz[c] / white[c];
        if v > DELTA * DELTA * DELTA { v.cbrt() } else { v / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
    });
    [116.0 * f[1] - 16.0, 500.0 * (f[0] - f[1]), 200.0 * (f[1] - f[2])]
}

/// XYZ of a CIELAB colour beside a white: the inverse of [`lab_from_xyz`].
pub fn xyz_from_lab([l, a, b]: [f64; 3], white: [f64; 3]) -> [f64; 3] {
    let y = (l + 16.0) / 116.0;
    let f = [y + a / 500.0, y, y - b / 200.0];
    std::array::from_fn(|c| {
        let v = if f[c] > DELTA { f[c] * f[c] * f[c] } else { 3.0 * DELTA * DELTA * (f[c] - 4.0 / 29.0) };
        white[c] * v
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_black_and_grey_are_known_and_every_colour_comes_back() {
        let white = [0.95, 1.0, 1.09];
        let lab = lab_from_xyz(white, white);
        assert!((lab[0] - 100.0).abs() < 1e-12 && lab[1].abs() < 1e-12 && lab[2].abs() < 1e-12);
        assert!(lab_from_xyz([0.0; 3], white).iter().all(|v| v.abs() < 1e-13));
        // 18.4186 % reflectance is the middle of the scale.
        assert!((lab_from_xyz(white.map(|v| 0.184_186_518_51 * v), white)[0] - 50.0).abs() < 1e-6);
        for xyz in [[0.2, 0.1, 0.6], [0.001, 0.002, 0.003], [0.9, 0.8, 0.1], [-0.01, 0.2, 0.0]] {
            let back = xyz_from_lab(lab_from_xyz(xyz, white), white);
            assert!((0..3).all(|c| (back[c] - xyz[c]).abs() < 1e-14), "{xyz:?} {back:?}");
        }
    }
}
