//! Stokes vectors along paths, from the camera on.

use super::{bsdf, glass, metal};
use etalon_optics::{Lanes, Vec3};
use etalon_oracle::Verdict;
use etalon_oracle::laws::{self, Turn, TurnedBy};
use etalon_scene::MaterialKind;
use etalon_transport::bsdf::{Lobe, Shading};
use etalon_transport::polarisation::mueller::{Matrix, Mueller};
use etalon_transport::polarisation::{Followed, Polarisation};

/// Ours along a path of smooth surfaces at any angles to each other, against the field.
fn stokes_of_bsdfs(turns: &[Turn], right: [f64; 3]) -> [f64; 4] {
    let first = turns.first().expect("a path has a turn");
    let mut light = Followed::<1>::at_camera(-Vec3::from_array(first.wo), Vec3::from_array(right));
    for turn in turns {
        let (wo, wi, normal) = (turn.wo, turn.wi, turn.normal).map_all(Vec3::from_array);
        let (kind, normal) = match turn.by {
            TurnedBy::Reflection { n, k: 0.0 } => (glass(n, 1.0), normal),
            TurnedBy::Reflection { n, k } => (MaterialKind::Conductor { metal: metal(n, k), film: None }, normal),
            // The outward side is the light's.
            TurnedBy::Refraction { n } => (glass(n, 1.0), normal),
        };
        let bsdf = bsdf(&kind);
        light.follow(wo, wi, || bsdf.mueller(&Lanes([550.0]), &Shading::flat(normal), wo, wi, Lobe::Delta(0.0)));
    }
    let s0 = light.receive(Lanes::ONE)[0];
    let [s1, s2, s3] = light.received().expect("carried").map(|lanes| lanes[0]);
    [s0, s1, s2, s3]
}

trait MapAll {
    fn map_all(self, f: fn([f64; 3]) -> Vec3<f64>) -> (Vec3<f64>, Vec3<f64>, Vec3<f64>);
}

impl MapAll for ([f64; 3], [f64; 3], [f64; 3]) {
    fn map_all(self, f: fn([f64; 3]) -> Vec3<f64>) -> (Vec3<f64>, Vec3<f64>, Vec3<f64>) {
        (f(self.0), f(self.1), f(self.2))
    }
}

#[test]
fn stokes_vectors_along_paths_are_those_of_the_field() {
    laws::stokes_along_paths_is_exact(stokes_of_bsdfs, 1).assert();
}

/// Mutants, made of our own parts: each must be noticed.
#[test]
fn paths_whose_matrices_are_wrong_are_noticed() {
    let wrong = |change: fn(&mut Matrix)| {
        laws::stokes_along_paths_is_exact(
            |turns, right| {
                let first = turns.first().expect("a path has a turn");
                let mut light = Followed::<1>::at_camera(-Vec3::from_array(first.wo), Vec3::from_array(right));
                for turn in turns {
                    let (wo, wi, normal) = (turn.wo, turn.wi, turn.normal).map_all(Vec3::from_array);
                    let kind = match turn.by {
                        TurnedBy::Reflection { n, k } if k > 0.0 => {
                            MaterialKind::Conductor { metal: metal(n, k), film: None }
                        }
                        TurnedBy::Reflection { n, .. } | TurnedBy::Refraction { n } => glass(n, 1.0),
                    };
                    let at = Shading::flat(normal);
                    let right = bsdf(&kind).mueller(&Lanes([550.0]), &at, wo, wi, Lobe::Delta(0.0)).unwrap();
                    let mut matrix = right.matrix(0);
                    change(&mut matrix);
                    light.follow(wo, wi, || Some(Mueller::of([matrix], right.x)));
                }
                let s0 = light.receive(Lanes::ONE)[0];
                let [s1, s2, s3] = light.received().expect("carried").map(|lanes| lanes[0]);
                [s0, s1, s2, s3]
            },
            1,
        )
    };
    assert!(wrong(|_| ()).pass);
    type Change = fn(&mut Matrix);
    let mutants: [(&str, Change); 4] = [
        ("the other hand", |m| (m[2][3], m[3][2]) = (-m[2][3], -m[3][2])),
        ("s and p swapped", |m| (m[0][1], m[1][0]) = (-m[0][1], -m[1][0])),
        ("no phase", |m| (m[2][3], m[3][2]) = (0.0, 0.0)),
        ("polarises only what comes", |m| m[1][0] = 0.0),
    ];
    for (name, change) in mutants {
        let verdict: Verdict = wrong(change);
        assert!(!verdict.pass, "\"{name}\" survived: {verdict}");
    }
}

/// A camera measures S₁ along the image's right, as far as that is across the ray: what passed an ideal polariser is cos 2φ, φ the
/// angle between the two about a ray far from the middle of the picture.
#[test]
fn a_camera_measures_along_the_right_of_its_picture() {
    let (along, right) = (Vec3::new(0.6, 0.5, -1.0).normalized(), Vec3::new(1.0, 0.0, 0.0));
    let x = (right - along * along.dot(right)).normalized();
    let mut polariser = [[0.0; 4]; 4];
    (0..4).for_each(|k| polariser[k / 2][k % 2] = 1.0);
    for turns in [0.0_f64, 0.1, 0.2, 0.35] {
        let (sin, cos) = (turns * std::f64::consts::TAU).sin_cos();
        let axis = x * cos + along.cross(x) * sin;
        let mut light = Followed::<1>::at_camera(along, right);
        light.follow(-along, along, || Some(Mueller::of([polariser], axis)));
        let s0 = light.receive(Lanes([1.0]))[0];
        let [s1, s2, s3] = light.received().expect("carried").map(|lanes| lanes[0]);
        let (sin_2, cos_2) = (2.0 * turns * std::f64::consts::TAU).sin_cos();
        assert!((s0 - 1.0).abs() < 1e-15 && s3 == 0.0);
        assert!((s1 - cos_2).abs() < 1e-14 && (s2.abs() - sin_2.abs()).abs() < 1e-14, "{turns}: {s1} {s2}");
    }
}
