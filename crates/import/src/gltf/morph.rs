//! Morph targets: differences of the vertices of a mesh, which are added by weights.

use gltf::animation::{Channel, Property};
use gltf::{Mesh, Node, Primitive};

use super::Walk;
use super::accessor::numbers;
use super::animation::{Animated, SECOND, Track};
use crate::Builder;

/// Most targets of a mesh.
const MOST_TARGETS: usize = 4096;
/// Most weights that animations give.
const MOST_WEIGHTS: usize = 1 << 24;

/// The number of morph targets of a mesh; all its primitives have as many.
fn targets(mesh: &Mesh<'_>) -> usize {
    mesh.primitives().next().map_or(0, |primitive| primitive.morph_targets().len())
}

/// The weights that an animation gives when the shutter opens, and whether they change until it closes.
fn animated_weights(
    channel: &Channel<'_>,
    targets: usize,
    buffers: &[Vec<u8>],
    [opens, closes]: [f64; 2],
) -> Result<(Vec<f64>, bool), String> {
    if targets > MOST_TARGETS {
        return Err(format!("{targets} morph targets; at most {MOST_TARGETS} are read"));
    }
    let sampler = channel.sampler();
    let times_s: Vec<f64> = numbers::<1>(&sampler.input(), buffers)?.iter().map(|[time]| *time).collect();
    let values = numbers::<1>(&sampler.output(), buffers)?;
    let frames = values.len() / targets;
    if frames * targets != values.len() {
        return Err(format!("{} weights are no multiple of {targets} morph targets", values.len()));
    }
    // Of four targets at a time.
    let mut track = Track::new(Property::MorphTargetWeights, times_s, Vec::new(), sampler.interpolation());
    let within: Vec<f64> = track.times_s().iter().copied().filter(|time| opens < *time && *time < closes).collect();
    let (mut weights, mut changes) = (Vec::new(), false);
    for first in (0..targets).step_by(4) {
        let of = |frame: usize, k: usize| (first + k < targets).then(|| values[frame * targets + first + k][0]);
        track.values = (0..frames).map(|frame| std::array::from_fn(|k| of(frame, k).unwrap_or(0.0))).collect();
        track.check()?;
        let at_first = track.at(opens);
        changes |= within.iter().chain([&closes]).any(|time| track.at(*time) != at_first);
        weights.extend(at_first.into_iter().take(targets - first));
    }
    Ok((weights, changes))
}

impl Animated {
    /// Reads what a channel says of the weights of morph targets.
    pub(super) fn read_weights(
        &mut self,
        channel: &Channel<'_>,
        place: &str,
        buffers: &[Vec<u8>],
        builder: &mut Builder<'_>,
    ) -> Result<(), String> {
        let node = channel.target().node();
        let targets = node.mesh().map_or(0, |mesh| targets(&mesh));
        if targets == 0 {
            builder.leave_out(place, "its node has no mesh with morph targets");
            return Ok(());
        }
        let (weights, changes) =
            animated_weights(channel, targets, buffers, self.shutter_s).map_err(|why| format!("{place}: {why}"))?;
        if changes {
            let what =
                "the weights of morph targets change while the shutter is open: they stay as they are when it opens";
            builder.approximate(place, what);
        }
        if self.weights.values().map(Vec::len).sum::<usize>() + targets > MOST_WEIGHTS {
            return Err(format!("{place}: animations give more than {MOST_WEIGHTS} weights of morph targets"));
        }
        if self.weights.insert(node.index(), weights).is_some() {
            return Err(format!("{place}: {SECOND}"));
        }
        Ok(())
    }

    /// The weights that the animation gives a node's morph targets.
    pub(super) fn weights(&self, node: &Node<'_>) -> Option<&[f64]> {
        self.weights.get(&node.index()).map(Vec::as_slice)
    }
}

impl Walk<'_, '_> {
    /// The weights of the morph targets of a node's mesh when the shutter opens: those of the animation, of the node or of the mesh; none
    /// where all are 0.
    pub(super) fn weights(&self, node: &Node<'_>, mesh: &Mesh<'_>) -> Result<Vec<f64>, String> {
        let (place, weights) = match (self.animated.weights(node), node.weights()) {
            (Some(weights), _) => (format!("$.nodes[{}]", node.index()), weights.to_vec()),
            (None, Some(own)) => {
                (format!("$.nodes[{}].weights", node.index()), own.iter().map(|w| f64::from(*w)).collect())
            }
            (None, None) => {
                let own: Vec<f64> = mesh.weights().unwrap_or_default().iter().map(|w| f64::from(*w)).collect();
                (format!("$.meshes[{}].weights", mesh.index()), own)
            }
        };
        let targets = targets(mesh);
        if !weights.is_empty() && weights.len() != targets {
            let mesh = mesh.index();
            return Err(format!(
                "{place}: {} weights for the {targets} morph targets of $.meshes[{mesh}]",
                weights.len()
            ));
        }
        if targets > MOST_TARGETS {
            return Err(format!(
                "$.meshes[{}]: {targets} morph targets; at most {MOST_TARGETS} are read",
                mesh.index()
            ));
        }
        Ok(if weights.iter().all(|weight| *weight == 0.0) { Vec::new() } else { weights })
    }

    /// Adds the differences that the morph targets of a primitive state, each times its weight.
    pub(super) fn morph(
        &self,
        primitive: &Primitive<'_>,
        weights: &[f64],
        vertices: &mut [[f64; 3]],
        normals: &mut [[f64; 3]],
        place: &str,
    ) -> Result<(), String> {
        let targets = primitive.morph_targets();
        if targets.len() != weights.len() {
            return Err(format!("{place}: {} morph targets, but {} weights", targets.len(), weights.len()));
        }
        for (k, (target, weight)) in targets.zip(weights).enumerate().filter(|(_, (_, weight))| **weight != 0.0) {
            for (what, accessor, list) in
                [("POSITION", target.positions(), &mut *vertices), ("NORMAL", target.normals(), &mut *normals)]
            {
                // A mesh without normals has those of its triangles, which follow the positions.
                let Some(accessor) = accessor.filter(|_| !list.is_empty()) else { continue };
                let place = format!("{place}.targets[{k}].{what}");
                let differences = numbers::<3>(&accessor, self.buffers).map_err(|why| format!("{place}: {why}"))?;
                if differences.len() != list.len() {
                    return Err(format!("{place}: {} differences for {} vertices", differences.len(), list.len()));
                }
                for (value, difference) in list.iter_mut().flatten().zip(differences.iter().flatten()) {
                    *value += weight * difference;
                }
            }
        }
        Ok(())
    }
}
