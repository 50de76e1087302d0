//! Animations of glTF: what nodes do while a shutter is open.

use std::collections::HashMap;

use glam::{DAffine3, DMat3, DQuat, DVec3};
use gltf::animation::{Interpolation, Property};
use gltf::json::validation::Checked;
use gltf::{Document, Node};

use super::accessor::numbers;
use crate::{Builder, Moment};

/// A cubic curve is followed by this many pieces between two keyframes: straight ones, or turns about fixed axes. They are off by at most
/// 1/8·(1/16)² = 5·10⁻⁴ of the curve's second derivative times the square of the time between the keyframes.
const CUBIC_PIECES: usize = 16;
/// A step takes this share of the shutter's time, since what moves cannot jump.
const STEP_SHARE: f64 = 1.0 / 1048576.0;
/// Neighbouring keyframes whose rotations are further apart get one between them: half a turn does not say which way.
const LARGEST_TURN_RAD: f64 = 2.5;

pub(super) const SECOND: &str = "it is the second channel of the same property of the same node";

/// Where a node is within its parent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pose {
    pub translation: DVec3,
    /// A unit quaternion, x y z w.
    pub rotation: [f64; 4],
    pub scale: DVec3,
}

/// Numbers over time.
#[derive(Debug)]
pub(super) struct Track {
    property: Property,
    times_s: Vec<f64>,
    /// One for each time; of a cubic curve three: the slope before, the value, the slope after.
    pub(super) values: Vec<[f64; 4]>,
    interpolation: Interpolation,
}

/// What the animation that is asked for does to nodes.
#[derive(Debug, Default)]
pub(super) struct Animated {
    tracks: HashMap<usize, Vec<Track>>,
    /// The weights of the morph targets of nodes when the shutter opens.
    pub(super) weights: HashMap<usize, Vec<f64>>,
    /// When the shutter opens and when it closes, s.
    pub shutter_s: [f64; 2],
}

impl Animated {
    /// Reads the animation that a moment asks for; the others are listed, and all without a moment.
    ///
    /// `counted`: for each animation, the index in the file of each channel kept. Channels that lead to no node were removed before.
    pub(super) fn read(
        file: &Document,
        counted: &[Vec<usize>],
        buffers: &[Vec<u8>],
        moment: Option<&Moment>,
        builder: &mut Builder<'_>,
    ) -> Result<Self, String> {
        let label = |animation: &gltf::Animation<'_>| match animation.name() {
            Some(name) => format!("the animation \"{name}\""),
            None => "the animation".to_owned(),
        };
        let asked = match moment {
            None => None,
            Some(moment) => Some(asked(file, moment)?),
        };
        for other in file.animations().filter(|other| Some(other.index()) != asked) {
            let why = if asked.is_some() { "another one is asked for" } else { "no time is asked for" };
            let what = format!("{} is ignored: {why} (--time and --animation of `etalon import`)", label(&other));
            builder.leave_out(format!("$.animations[{}]", other.index()), what);
        }
        let (Some(asked), Some(moment)) = (asked.and_then(|index| file.animations().nth(index)), moment) else {
            return Ok(Self::default());
        };
        let mut animated = Self { shutter_s: [moment.opens_s, moment.opens_s + moment.shutter_s], ..Self::default() };
        for (i, channel) in asked.channels().enumerate() {
            let number = counted.get(asked.index()).and_then(|numbers| numbers.get(i)).unwrap_or(&i);
            let place = format!("$.animations[{}].channels[{number}]", asked.index());
            // The library takes both for granted.
            let target = &file.as_json().animations[asked.index()].channels[i].target;
            if matches!(target.path, Checked::Invalid) {
                builder.leave_out(place, "its target is not known");
                continue;
            }
            if target.node.value() >= file.nodes().count() {
                return Err(format!(
                    "{place}: it names node {}; there are {}",
                    target.node.value(),
                    file.nodes().count()
                ));
            }
            let property = channel.target().property();
            if property == Property::MorphTargetWeights {
                animated.read_weights(&channel, &place, buffers, builder)?;
                continue;
            }
            let track = Track::read(&channel, property, buffers).map_err(|why| format!("{place}: {why}"))?;
            let tracks = animated.tracks.entry(channel.target().node().index()).or_default();
            if tracks.iter().any(|known| known.property == property) {
                return Err(format!("{place}: {SECOND}"));
            }
            tracks.push(track);
        }
        Ok(animated)
    }

    /// The transform of a node within its parent at a time.
    pub(super) fn local(&self, node: &Node<'_>, time_s: f64) -> DAffine3 {
        match self.tracks.get(&node.index()) {
            None => {
                // The last row of a matrix that moves and turns things is 0 0 0 1.
                let columns = node.transform().matrix().map(|[x, y, z, _]| [x, y, z].map(f64::from));
                DAffine3::from_cols_array_2d(&columns)
            }
            Some(tracks) => pose(node, tracks, time_s).map(),
        }
    }

    /// The poses of a node through the time of the shutter, between which it moves in proportion to time and turns about fixed axes;
    /// `None` if it rests.
    pub(super) fn motion(&self, node: &Node<'_>) -> Option<Vec<(f64, Pose)>> {
        let tracks = self.tracks.get(&node.index())?;
        let [opens, closes] = self.shutter_s;
        let within = |time: f64| opens < time && time < closes;
        let mut times = vec![opens, closes];
        for track in tracks {
            times.extend(track.times_s.iter().copied().filter(|time| within(*time)));
            match track.interpolation {
                Interpolation::Linear => {}
                Interpolation::Step => {
                    let before = |time: &f64| time - STEP_SHARE * (closes - opens);
                    times.extend(track.times_s.iter().filter(|time| within(**time)).map(before));
                }
                Interpolation::CubicSpline => {
                    for pair in track.times_s.windows(2).filter(|pair| pair[0] < closes && pair[1] > opens) {
                        let at = |k: usize| pair[0] + (pair[1] - pair[0]) * k as f64 / CUBIC_PIECES as f64;
                        times.extend((1..CUBIC_PIECES).map(at).filter(|time| within(*time)));
                    }
                }
            }
        }
        times.retain(|time| *time == opens || *time == closes || within(*time));
        times.sort_by(f64::total_cmp);
        times.dedup();
        let mut poses: Vec<(f64, Pose)> = Vec::new();
        for time in times {
            let next = pose(node, tracks, time);
            if let Some((before, last)) = poses.last().copied()
                && angle_rad(last.rotation, next.rotation) > LARGEST_TURN_RAD
            {
                poses.push((0.5 * (before + time), last.between(&next, 0.5)));
            }
            poses.push((time, next));
        }
        poses.windows(2).any(|pair| pair[0].1 != pair[1].1).then_some(poses)
    }
}

/// The index of the animation that is asked for.
fn asked(file: &Document, moment: &Moment) -> Result<usize, String> {
    let list = || {
        let names: Vec<String> = file
            .animations()
            .map(|animation| {
                animation.name().map_or_else(|| animation.index().to_string(), |name| format!("\"{name}\""))
            })
            .collect();
        if names.is_empty() { "it has none".to_owned() } else { format!("it has {}", names.join(", ")) }
    };
    let found = match &moment.animation {
        None => file.animations().next(),
        Some(wanted) => {
            let by_name = file.animations().find(|animation| animation.name() == Some(wanted));
            by_name.or_else(|| file.animations().nth(wanted.parse().ok()?))
        }
    };
    found.map(|animation| animation.index()).ok_or_else(|| match &moment.animation {
        Some(wanted) => format!("there is no animation \"{wanted}\": {}", list()),
        None => "a time is asked for, but it has no animations".to_owned(),
    })
}

impl Track {
    fn read(channel: &gltf::animation::Channel<'_>, property: Property, buffers: &[Vec<u8>]) -> Result<Self, String> {
        let sampler = channel.sampler();
        let times_s: Vec<f64> = numbers::<1>(&sampler.input(), buffers)?.iter().map(|[time]| *time).collect();
        let values: Vec<[f64; 4]> = match property {
            Property::Rotation => numbers::<4>(&sampler.output(), buffers)?,
            _ => numbers::<3>(&sampler.output(), buffers)?.iter().map(|[x, y, z]| [*x, *y, *z, 0.0]).collect(),
        };
        let track = Self::new(property, times_s, values, sampler.interpolation());
        track.check()?;
        Ok(track)
    }

    /// One that is to be checked.
    pub(super) fn new(
        property: Property,
        times_s: Vec<f64>,
        values: Vec<[f64; 4]>,
        interpolation: Interpolation,
    ) -> Self {
        Self { property, times_s, values, interpolation }
    }

    pub(super) fn times_s(&self) -> &[f64] {
        &self.times_s
    }

    /// Whether it says something at every time.
    pub(super) fn check(&self) -> Result<(), String> {
        let Self { property, times_s, values, interpolation } = self;
        let each = if *interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        if times_s.is_empty() || Some(values.len()) != times_s.len().checked_mul(each) {
            return Err(format!("{} values for {} times", values.len(), times_s.len()));
        }
        if !times_s.iter().chain(values.iter().flatten()).all(|v| v.is_finite()) {
            return Err("a time or a value is not finite".to_owned());
        }
        if times_s.windows(2).any(|pair| pair[0] >= pair[1]) {
            return Err("its times do not increase".to_owned());
        }
        let zero = |value: &[f64; 4]| value.iter().all(|v| *v == 0.0);
        if *property == Property::Rotation && values.iter().skip(each / 2).step_by(each).any(zero) {
            return Err("a rotation is a quaternion of length 0".to_owned());
        }
        Ok(())
    }

    /// The value at a time: before the first and after the last it stays.
    pub(super) fn at(&self, time_s: f64) -> [f64; 4] {
        let last = self.times_s.len() - 1;
        let value = |i: usize| match self.interpolation {
            Interpolation::CubicSpline => self.values[3 * i + 1],
            _ => self.values[i],
        };
        let next = self.times_s.partition_point(|known| *known <= time_s);
        let Some(i) = next.checked_sub(1) else { return value(0) };
        if i == last {
            return value(last);
        }
        let step = self.times_s[i + 1] - self.times_s[i];
        let share = (time_s - self.times_s[i]) / step;
        let (a, b) = (value(i), value(i + 1));
        match self.interpolation {
            Interpolation::Step => a,
            Interpolation::Linear if self.property == Property::Rotation => slerp(unit(a), unit(b), share),
            Interpolation::Linear => std::array::from_fn(|k| a[k] + share * (b[k] - a[k])),
            Interpolation::CubicSpline => {
                // Hermite's curve, as appendix C of the specification states it.
                let (out, into) = (self.values[3 * i + 2], self.values[3 * i + 3]);
                let (s2, s3) = (share * share, share * share * share);
                std::array::from_fn(|k| {
                    (2.0 * s3 - 3.0 * s2 + 1.0) * a[k]
                        + step * (s3 - 2.0 * s2 + share) * out[k]
                        + (3.0 * s2 - 2.0 * s3) * b[k]
                        + step * (s3 - s2) * into[k]
                })
            }
        }
    }
}

fn pose(node: &Node<'_>, tracks: &[Track], time_s: f64) -> Pose {
    let (translation, rotation, scale) = node.transform().decomposed();
    let mut pose = Pose {
        translation: translation.map(f64::from).into(),
        rotation: unit(rotation.map(f64::from)),
        scale: scale.map(f64::from).into(),
    };
    for track in tracks {
        let value @ [x, y, z, _] = track.at(time_s);
        match track.property {
            Property::Translation => pose.translation = DVec3::new(x, y, z),
            Property::Rotation => pose.rotation = unit(value),
            Property::Scale => pose.scale = DVec3::new(x, y, z),
            Property::MorphTargetWeights => {}
        }
    }
    pose
}

impl Pose {
    /// T·R·S.
    pub(super) fn map(&self) -> DAffine3 {
        DAffine3::from_scale_rotation_translation(self.scale, DQuat::from_array(self.rotation), self.translation)
    }

    /// The pose at a time, of poses through time.
    pub(super) fn at(poses: &[(f64, Self)], time_s: f64) -> Self {
        let next = poses.partition_point(|(known, _)| *known <= time_s);
        match (next.checked_sub(1).map(|i| &poses[i]), poses.get(next)) {
            (Some((before, a)), Some((after, b))) => a.between(b, (time_s - before) / (after - before)),
            (Some((_, pose)), None) | (None, Some((_, pose))) => *pose,
            (None, None) => Self { translation: DVec3::ZERO, rotation: [0.0, 0.0, 0.0, 1.0], scale: DVec3::ONE },
        }
    }

    /// The move and the turn of a similarity.
    pub(super) fn rigid(map: &DAffine3) -> Self {
        Self { translation: map.translation, rotation: quaternion(&map.matrix3), scale: DVec3::ONE }
    }

    /// What lies between two poses at a share of the time.
    fn between(&self, other: &Self, share: f64) -> Self {
        let mix = |a: DVec3, b: DVec3| a + share * (b - a);
        Self {
            translation: mix(self.translation, other.translation),
            rotation: slerp(self.rotation, other.rotation, share),
            scale: mix(self.scale, other.scale),
        }
    }
}

/// The quaternion of length 1; none of length 0 comes here but between two keyframes of a cubic curve that cross it, where it is as
/// good as any.
fn unit(q: [f64; 4]) -> [f64; 4] {
    let largest = q.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    if largest == 0.0 {
        return [0.0, 0.0, 0.0, 1.0];
    }
    let q = q.map(|v| v / largest);
    let length = q.iter().map(|v| v * v).sum::<f64>().sqrt();
    q.map(|v| v / length)
}

/// The angle between two rotations, rad.
fn angle_rad(a: [f64; 4], b: [f64; 4]) -> f64 {
    // Of the difference and the sum, so that small angles are not lost in a cosine.
    let length = |sign: f64| (0..4).map(|k| (a[k] + sign * b[k]).powi(2)).sum::<f64>().sqrt();
    let (apart, together) = (length(-1.0), length(1.0));
    4.0 * apart.min(together).atan2(apart.max(together))
}

/// The rotation at a share of the shorter way between two, at a constant rate about a fixed axis.
pub(super) fn slerp(a: [f64; 4], b: [f64; 4], share: f64) -> [f64; 4] {
    let dot: f64 = (0..4).map(|k| a[k] * b[k]).sum();
    let b = if dot < 0.0 { b.map(|v| -v) } else { b };
    let half = 0.5 * angle_rad(a, b);
    let sin = half.sin();
    // Next to each other, the chord is the arc.
    let (from, to) = if sin < 1e-9 {
        (1.0 - share, share)
    } else {
        (((1.0 - share) * half).sin() / sin, (share * half).sin() / sin)
    };
    unit(std::array::from_fn(|k| from * a[k] + to * b[k]))
}

/// The rotation of a matrix whose columns are at right angles and of one length.
pub(super) fn quaternion(m: &DMat3) -> [f64; 4] {
    let length = m.x_axis.length();
    let at = |row: usize, column: usize| m.col(column)[row] / length;
    let trace = at(0, 0) + at(1, 1) + at(2, 2);
    // The largest of the four is divided by.
    let squares = [2.0 * at(0, 0) - trace, 2.0 * at(1, 1) - trace, 2.0 * at(2, 2) - trace, trace].map(|v| 1.0 + v);
    let largest = (1..4).fold(0, |best, k| if squares[k] > squares[best] { k } else { best });
    unit(match largest {
        3 => [at(2, 1) - at(1, 2), at(0, 2) - at(2, 0), at(1, 0) - at(0, 1), squares[3]],
        0 => [squares[0], at(1, 0) + at(0, 1), at(0, 2) + at(2, 0), at(2, 1) - at(1, 2)],
        1 => [at(1, 0) + at(0, 1), squares[1], at(2, 1) + at(1, 2), at(0, 2) - at(2, 0)],
        _ => [at(0, 2) + at(2, 0), at(2, 1) + at(1, 2), squares[2], at(1, 0) - at(0, 1)],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quaternion_and_its_matrix_are_inverses() {
        for k in 0..200 {
            let q = unit(std::array::from_fn(|i| (f64::from(k * 7 + 1) * (i as f64 + 1.3)).sin()));
            let map = Pose { translation: DVec3::ZERO, rotation: q, scale: DVec3::splat(2.5) }.map();
            assert!(angle_rad(quaternion(&map.matrix3), q) < 1e-14, "{q:?}");
        }
    }

    #[test]
    fn a_slerp_turns_at_a_constant_rate_the_shorter_way() {
        let turn = |angle: f64| [0.0, 0.0, (0.5 * angle).sin(), (0.5 * angle).cos()];
        for (a, b, share, want) in
            [(0.0, 2.0, 0.25, 0.5), (0.3, -0.5, 0.5, -0.1), (0.0, 6.0, 0.5, 3.0 - std::f64::consts::PI)]
        {
            assert!(angle_rad(slerp(turn(a), turn(b), share), turn(want)) < 1e-14, "{a} {b}");
            assert!(angle_rad(slerp(turn(a), turn(b).map(|v| -v), share), turn(want)) < 1e-14, "{a} {b}");
        }
    }
}
