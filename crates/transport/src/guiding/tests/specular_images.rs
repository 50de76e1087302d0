//! Images of lamps are where rays by way of balls find them and bring what they are said to, and directions toward them have their densities.

use super::{draws_are_sound, mean, numbers};
use crate::guiding::specular_image::View;
use crate::guiding::{Ball, DirectionTarget, MAX_SPECULAR_IMAGES, Shows, SpecularImage, VisibleImages};
use crate::warp::uniform_sphere;
use etalon_geometry::SphereSampler;
use etalon_optics::Vec3;

/// A ray that leaves along `wi` by way of a ball about the origin: where it goes on, if it meets the ball. By Snell's law with vectors,
/// and nothing that images are found by.
fn by_way_of(radius: f64, index: Option<f64>, from: Vec3<f64>, wi: Vec3<f64>) -> Option<(Vec3<f64>, Vec3<f64>)> {
    let along = from.dot(wi);
    let chord = along * along - (from.length_squared() - radius * radius);
    let first = from + wi * (-along - (chord >= 0.0).then(|| chord.sqrt())?);
    let n = first / radius;
    let Some(index) = index else { return Some((first, wi - n * (2.0 * wi.dot(n)))) };
    let refract = |d: Vec3<f64>, n: Vec3<f64>, eta: f64| {
        let cos = -d.dot(n);
        d * eta + n * (eta * cos - (1.0 - eta * eta * (1.0 - cos * cos)).sqrt())
    };
    let within = refract(wi, n, 1.0 / index);
    let second = first + within * (-2.0 * first.dot(within));
    Some((second, refract(within, -second / radius, index)))
}

/// What a ball shows of a lamp: a mirror, or glass.
fn image(index: Option<f64>, ball: SphereSampler, lamp: SphereSampler) -> SpecularImage {
    let shows = index.map_or(Shows::Mirrored, |index| Shows::Refracted(index as f32));
    SpecularImage::new(Ball::new(ball, shows), lamp, 1.0)
}

/// What ellipses take in of the directions by which a lamp is seen, and what of an ellipse shows the lamp, over points around a ball: a
/// mirror, or glass.
fn hits(index: Option<f64>) -> (f64, f64) {
    let mut u = numbers(3);
    let (radius, lamp_radius) = (0.8, 0.15);
    let ball = SphereSampler { centre: Vec3::ZERO, radius };
    let (mut shown, mut drawn, mut covered, mut seen) = (0.0, 0.0, 0.0, 0.0);
    for _ in 0..400 {
        let from = uniform_sphere([u(), u()]) * (radius * (1.5 + 4.0 * u()));
        let lamp = SphereSampler { centre: uniform_sphere([u(), u()]) * (3.0 + 5.0 * u()), radius: lamp_radius };
        let n = -from / from.length();
        let image = image(index, ball, lamp);
        let view = image.view(&image.ball.eye(from.cast()), n.cast());
        let shows = |wi: Vec3<f64>| {
            by_way_of(radius, index, from, wi).is_some_and(|(start, onward)| {
                let toward = lamp.centre - start;
                toward.dot(onward) > 0.0 && toward.cross(onward).length() < lamp_radius
            })
        };
        if view.weight > 0.0 {
            for _ in 0..100 {
                drawn += 1.0;
                shown += f64::from(u8::from(shows(view.aim([u(), u()]))));
            }
        }
        // Of all directions that meet the ball.
        for _ in 0..4000 {
            let wi = DirectionTarget::aim(&ball, from, [u(), u()]);
            if shows(wi) {
                seen += 1.0;
                covered += f64::from(u8::from(view.weight > 0.0 && view.density(wi) > 0.0));
            }
        }
    }
    (covered / seen, shown / drawn)
}

/// Images are found where they are: their ellipses take in nearly all of what balls show of lamps, and mostly that. By chance a direction
/// toward the ball shows a lamp with a probability of some 1e-3, and an ellipse anywhere else would take in nothing.
#[test]
fn images_of_lamps_are_where_rays_by_way_of_balls_find_them() {
    let (covered, shown) = hits(None);
    assert!(covered > 0.99 && shown > 0.6, "mirror: {covered}, {shown}");
    let (covered, shown) = hits(Some(1.5));
    assert!(covered > 0.8 && shown > 0.4, "glass: {covered}, {shown}");
}

/// Whether a ball hands on rays as the laws have it for this index, but for single precision, and what it hands on to a lamp is said to meet it.
fn hands_on(ball_index: Option<f64>, index: Option<f64>) -> bool {
    let mut u = numbers(11);
    let ball = SphereSampler { centre: Vec3::ZERO, radius: 0.8 };
    let (mut met, mut differ, mut farthest, mut lost) = (0, 0, 0.0_f64, 0);
    for _ in 0..60_000 {
        let from = uniform_sphere([u(), u()]) * (1.0 + 4.0 * u());
        let wi = uniform_sphere([u(), u()]);
        let lamp = SphereSampler { centre: uniform_sphere([u(), u()]) * 3.0, radius: 0.5 };
        let image = image(ball_index, ball, lamp);
        let exact = by_way_of(0.8, index, from, wi).filter(|_| from.dot(wi) < 0.0);
        let is_met = image.ball.is_met(from.cast(), wi.cast());
        differ += u32::from(is_met != exact.is_some());
        let Some((start, onward)) = exact.filter(|_| is_met) else { continue };
        met += 1;
        let handed_on = image.ball.hand_on(from.cast(), wi.cast());
        // Near the rim, roots of what is nearly nothing turn it more.
        let rim = from.cross(wi).length() / 0.8;
        let error = (handed_on.direction.to_f64() - onward).length() + (handed_on.start.to_f64() - start).length();
        farthest = farthest.max(error * (1.0 - rim).sqrt());
        let toward = lamp.centre - start;
        let shows = toward.dot(onward) > 0.0 && toward.cross(onward).length() < lamp.radius;
        lost += u32::from(shows && !image.is_shown(&handed_on));
    }
    met > 1500 && differ < 6 && farthest < 2e-5 && lost == 0
}

#[test]
fn balls_hand_on_rays_as_the_laws_have_it_and_not_as_another_glass() {
    for index in [None, Some(1.5)] {
        assert!(hands_on(index, index), "{index:?}");
    }
    assert!(!hands_on(Some(1.499), Some(1.5)));
}

/// What mirrors are said to bring is what rays by way of them find: ∫ cos θ dω over the directions that show the lamp, but for the margin
/// of images. Points from two radii on; the mirroring point is a guess, which near balls promises more. A lamp twice as far away fails.
#[test]
fn mirrored_images_bring_about_what_they_are_said_to() {
    let mut u = numbers(21);
    let (radius, lamp_radius) = (0.8, 0.3);
    let ball = SphereSampler { centre: Vec3::ZERO, radius };
    let (mut said, mut farther, mut brought) = (0.0, 0.0, 0.0);
    for _ in 0..400 {
        let from = uniform_sphere([u(), u()]) * (radius * (2.0 + 3.0 * u()));
        let lamp = SphereSampler { centre: uniform_sphere([u(), u()]) * (3.0 + 5.0 * u()), radius: lamp_radius };
        // Up to 60° from facing the ball's middle.
        let lean = uniform_sphere([u(), u()]) * (0.86 * from.length());
        let n = (lean - from) / (lean - from).length();
        let twice = SphereSampler { centre: lamp.centre * 2.0, ..lamp };
        let weight = |lamp| {
            let image = image(None, ball, lamp);
            f64::from(image.weight_mirrored(&image.ball.eye(from.cast()), n.cast()))
        };
        let per_weight = std::f64::consts::PI / 1.1_f64.powi(2);
        (said, farther) = (said + per_weight * weight(lamp), farther + per_weight * weight(twice));
        let cone = DirectionTarget::density(&ball, from, -from / from.length());
        for _ in 0..4000 {
            let wi = DirectionTarget::aim(&ball, from, [u(), u()]);
            let shows = by_way_of(radius, None, from, wi).is_some_and(|(start, onward)| {
                let toward = lamp.centre - start;
                toward.dot(onward) > 0.0 && toward.cross(onward).length() < lamp_radius
            });
            brought += if shows { n.dot(wi).max(0.0) / cone / 4000.0 } else { 0.0 };
        }
    }
    let is_right = |said: f64| (0.85..1.3).contains(&(said / brought));
    assert!(is_right(said) && !is_right(farther), "{} and {}", said / brought, farther / brought);
}

/// Directions toward images have the density that is said of them, those apart that are drawn in vain: integrals of (1, x, y, z²) over
/// what is drawn by draws over their densities and by even directions within both balls, and the part that is drawn. Five standard errors.
fn images_are_sound(density: &dyn Fn(&VisibleImages<'_>, Vec3<f64>) -> f64) -> bool {
    let (from, n) = (Vec3::new(0.0, 0.0, -2.0), Vec3::new(0.0, 0.6, 0.8));
    let mirror = SphereSampler { centre: Vec3::new(-0.9, 0.4, 0.0), radius: 0.9 };
    let glass = SphereSampler { centre: Vec3::new(1.0, -0.1, 0.0), radius: 0.8 };
    // As large as they may be, so that few draws tell.
    let lamps = [[-0.5, 3.0, -3.0], [2.0, 0.3, 3.0]]
        .map(|centre| SphereSampler { centre: Vec3::from_array(centre), radius: 1.0 });
    let images = [(None, mirror), (Some(1.5), glass)]
        .into_iter()
        .flat_map(|(index, ball)| lamps.map(|lamp| image(index, ball, lamp)))
        .collect::<Vec<_>>();
    let mut weights = [0.0; MAX_SPECULAR_IMAGES];
    for (image, weight) in images.iter().zip(&mut weights) {
        *weight = image.view(&image.ball.eye(from.cast()), n.cast()).weight;
    }
    assert!(weights.iter().filter(|&&weight| weight > 0.0).count() >= 3, "{weights:?}");
    let seen = VisibleImages { images: &images, from: from.cast(), n: n.cast(), weights: &weights, share: 1.0 };
    let count = 100_000;
    let cones = |wi| 0.5 * (DirectionTarget::density(&mirror, from, wi) + DirectionTarget::density(&glass, from, wi));
    let moments: [fn(Vec3<f64>) -> f64; 4] = [|_| 1.0, |w| w.x, |w| w.y, |w| w.z * w.z];
    let mut sound = true;
    for (seed, of) in moments.into_iter().enumerate() {
        let mut u = numbers(40 + seed as u64);
        let drawn = mean(count, || {
            seen.aim([u(), u()]).map_or(0.0, |aimed| {
                // What is known of it already changes nothing.
                assert_eq!(seen.density(aimed.wi, Some(&aimed)), seen.density(aimed.wi, None));
                let density = density(&seen, aimed.wi);
                if density > 0.0 { of(aimed.wi) / density } else { 0.0 }
            })
        });
        let mut part = (0.0, 0.0);
        let mut even = (0.0, 0.0);
        for of_part in [true, false] {
            let mut u = numbers(60 + seed as u64);
            let found = mean(count, || {
                let wi = DirectionTarget::aim(if u() < 0.5 { &mirror } else { &glass }, from, [u(), u()]);
                let density = density(&seen, wi);
                let value = if of_part { density } else { of(wi) };
                if density > 0.0 { value / cones(wi) } else { 0.0 }
            });
            *(if of_part { &mut part } else { &mut even }) = found;
        }
        let mut u = numbers(80 + seed as u64);
        let hits = mean(count, || f64::from(u8::from(seen.aim([u(), u()]).is_some())));
        sound &= (drawn.0 - even.0).abs() <= 5.0 * drawn.1.hypot(even.1);
        sound &= (hits.0 - part.0).abs() <= 5.0 * hits.1.hypot(part.1);
    }
    sound
}

#[test]
fn directions_drawn_toward_images_have_the_density_of_those_not_in_vain_and_wrong_ones_are_noticed() {
    assert!(images_are_sound(&|seen, wi| seen.density(wi, None)));
    assert!(!images_are_sound(&|seen, wi| 1.1 * seen.density(wi, None)));
    // As if none were drawn in vain.
    assert!(!images_are_sound(&|seen, wi| {
        let total: f32 = seen.weights.iter().sum();
        let of = |(image, weight): (&SpecularImage, &f32)| {
            let view = image.view(&image.ball.eye(seen.from), seen.n);
            if view.weight > 0.0 { f64::from(weight / total) * view.density(wi) } else { 0.0 }
        };
        seen.images.iter().zip(seen.weights).map(of).sum()
    }));
}

#[test]
fn directions_toward_images_have_their_densities_and_wrong_densities_are_noticed() {
    // As wide as images may be, so that few draws tell.
    let ellipse = |axis: [f64; 3], across: [f64; 3], half| View {
        axis: Vec3::from_array(axis).cast(),
        in_plane: Vec3::from_array(across).cast(),
        half,
        weight: 1.0,
    };
    let views = [
        ellipse([0.6, 0.0, 0.8], [0.8, 0.0, -0.6], [0.9, 0.5]),
        ellipse([0.0, -0.28, 0.96], [1.0, 0.0, 0.0], [0.4, 1.0]),
    ];
    for (seed, view) in views.into_iter().enumerate() {
        let seed = 20 * seed as u64 + 50;
        assert!(draws_are_sound(&|u| view.aim(u), &|wi| view.density(wi), seed), "{view:?}");
        assert!(!draws_are_sound(&|u| view.aim(u), &|wi| 1.1 * view.density(wi), seed));
        // As if the plane were the sphere.
        let cos = |wi: Vec3<f64>| wi.dot(view.axis.to_f64());
        assert!(!draws_are_sound(&|u| view.aim(u), &|wi| view.density(wi) * cos(wi).powi(3), seed));
    }
}
