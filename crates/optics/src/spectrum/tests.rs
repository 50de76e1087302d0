use super::*;
use crate::colour::{rec709_from_xyz, xyz_of};

#[test]
fn rgb_emission_comes_back_in_linear_rec709() {
    for white in Illuminant::ALL {
        let rgb = [1.0, 0.5, 0.2];
        let light = RgbEmission::new(rgb, white).unwrap();
        let back = rec709_from_xyz(xyz_of(|nm| light.eval(nm)));
        for c in 0..3 {
            assert!((back[c] - rgb[c]).abs() < 1e-9);
        }
    }
}
