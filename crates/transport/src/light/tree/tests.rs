use super::*;
use proptest::prelude::*;

fn lights() -> impl Strategy<Value = Vec<LightBounds>> {
    let light = (
        [-3.0..3.0_f64, -3.0..3.0_f64, -3.0..3.0_f64],
        [0.0..0.5_f64, 0.0..0.5_f64, 0.0..0.5_f64],
        (-1.0..1.0_f64, 0.0..6.3_f64),
        (prop_oneof![Just(1.0), Just(-1.0), -1.0..1.0_f64], prop_oneof![Just(0.0), 0.0..1.0_f64]),
        any::<bool>(),
        0.1..10.0_f64,
    );
    let bounds = light.prop_map(|(corner, extent, (z, phi), (cos_normals, cos_shines), both_sides, power)| {
        let min = Vec3::from_array(corner);
        let across = (1.0 - z * z).sqrt();
        LightBounds {
            bounds: Aabb { min, max: min + Vec3::from_array(extent) },
            axis: Vec3::new(across * phi.cos(), across * phi.sin(), z),
            cos_normals,
            cos_shines,
            both_sides,
            power,
        }
    });
    proptest::collection::vec(bounds, 1..60)
}

proptest! {
    /// Over evenly spread numbers each light is chosen as often as its probability says, which is the one told with the choice;
    /// all probabilities sum to one, or no light shines.
    #[test]
    fn lights_are_chosen_with_the_probability_that_is_told(
        lights in lights(), p in [-4.0..4.0_f64, -4.0..4.0_f64, -4.0..4.0_f64],
    ) {
        let (tree, p) = (LightTree::new(&lights).unwrap(), Vec3::from_array(p));
        let count = 20_000;
        let mut chosen = vec![0; lights.len()];
        for i in 0..count {
            let Some((light, probability)) = tree.choose(p, (f64::from(i) + 0.5) / f64::from(count)) else { continue };
            prop_assert_eq!(probability, tree.probability(p, light));
            chosen[light as usize] += 1;
        }
        let probabilities: Vec<f64> = (0..lights.len() as u32).map(|light| tree.probability(p, light)).collect();
        let total: f64 = probabilities.iter().sum();
        let told: i32 = chosen.iter().sum();
        // A point in a corner of many bounds may find nothing although the box above promised something.
        prop_assert!((total * f64::from(count) - f64::from(told)).abs() <= lights.len() as f64);
        for (chosen, probability) in chosen.into_iter().zip(probabilities) {
            // A light's numbers are one interval: its ends cut off at most one of them each.
            prop_assert!((f64::from(chosen) - probability * f64::from(count)).abs() <= 1.0 + 1e-6, "{chosen} {probability}");
        }
    }

    /// What any light within it sends somewhere, a node's bound knows of: no light that reaches a point has a probability of zero.
    #[test]
    fn a_light_that_shines_at_a_point_may_be_chosen(
        lights in lights(), p in [-4.0..4.0_f64, -4.0..4.0_f64, -4.0..4.0_f64],
        (at, tilt, turn) in ([0.0..1.0_f64, 0.0..1.0_f64, 0.0..1.0_f64], 0.0..1.0_f64, 0.0..6.3_f64),
    ) {
        let (tree, p) = (LightTree::new(&lights).unwrap(), Vec3::from_array(p));
        for (number, light) in lights.iter().enumerate() {
            // A point of it, and a normal of its cone.
            let e = light.bounds.extent();
            let point = light.bounds.min + Vec3::new(e.x * at[0], e.y * at[1], e.z * at[2]);
            let angle = tilt * light.cos_normals.clamp(-1.0, 1.0).acos();
            let side = if light.axis.x.abs() < 0.6 { Vec3::new(1.0, 0.0, 0.0) } else { Vec3::new(0.0, 1.0, 0.0) };
            let s = light.axis.cross(side).normalized();
            let t = light.axis.cross(s);
            let normal = light.axis * angle.cos() + (s * turn.cos() + t * turn.sin()) * angle.sin();
            let cos = normal.dot((p - point).normalized());
            let cos = if light.both_sides { cos.abs() } else { cos };
            // By more than rounding.
            if cos > light.cos_shines + 1e-9 {
                prop_assert!(tree.probability(p, number as u32) > 0.0, "light {number} sends light there");
            }
        }
    }
}

/// The mutant: the probability seen from the light instead of from where the shadow ray starts.
#[test]
fn probabilities_of_another_point_are_seen_to_be_wrong() {
    let light = |x: f64| LightBounds {
        bounds: Aabb { min: Vec3::new(x, 0.0, 2.0), max: Vec3::new(x + 0.2, 0.2, 2.0) },
        axis: Vec3::new(0.0, 0.0, -1.0),
        cos_normals: 1.0,
        cos_shines: 0.0,
        both_sides: false,
        power: 1.0,
    };
    let tree = LightTree::new(&[light(-1.0), light(0.0), light(3.0)]).unwrap();
    let p = Vec3::new(-1.0, 0.0, 0.0);
    let (chosen, told) = tree.choose(p, 0.3).unwrap();
    let there = tree.probability(Vec3::new(3.0, 0.0, 1.9), chosen);
    assert!(told == tree.probability(p, chosen) && (there / told - 1.0).abs() > 0.5, "{told} {there}");
}

#[test]
fn thousands_of_lights_at_one_place_are_halved() {
    let light = LightBounds {
        bounds: Aabb { min: Vec3::ZERO, max: Vec3::ZERO },
        axis: Vec3::new(0.0, 0.0, 1.0),
        cos_normals: -1.0,
        cos_shines: 0.0,
        both_sides: false,
        power: 1.0,
    };
    let tree = LightTree::new(&vec![light; 5000]).unwrap();
    assert!(tree.ways.iter().all(|&(_, depth)| depth <= 13));
    let p = tree.probability(Vec3::new(1.0, 2.0, 3.0), 4321);
    assert!((p * 5000.0).ln().abs() < 1.0, "{p}");
}
