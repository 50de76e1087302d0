//! Groups of objects that are defined once, and the instances that place them.

use super::geometry::{Step, check_instance_similarity, transform};
use super::motion::{KeyframeForm, Placed, Stretch, motion};
use super::names::Names;
use super::scene::ObjectForm;
use crate::json::{Code, List, NamedEntry, Optional, Place, Reader, Required, Spanned};
use crate::linear::is_similarity;
use crate::model::{Group, Instance, Object, Transform};

/// Most groups within each other: rays descend through them by recursion.
pub(crate) const MAX_NESTING: usize = 16;
/// Most placed groups, instances within instances counted each time.
pub(crate) const MAX_PLACED: u64 = 1 << 30;

crate::record! {
    /// Objects, and instances of other groups, that are placed together. By itself a group is not in the scene.
    pub(crate) struct GroupForm + comment {
        /// Things with a surface, in the group's coordinates.
        objects: Required<List<Box<ObjectForm>>> = "[]",
        /// Other groups placed in this one.
        instances: Required<List<Box<InstanceForm>>> = "[]",
    }
}

crate::record! {
    /// A group placed in the scene, or in another group.
    pub(crate) struct InstanceForm + comment {
        /// Its name, for messages; "instances[i]" if left out.
        name: Optional<String>,
        /// The name of one of "groups".
        group: Required<Spanned<String>>,
        /// From the group's coordinates to those where it is placed: steps, the first of which is applied first.
        transform: Optional<Spanned<List<Box<Step>>>>,
        /// Several placements at once: a transform for each.
        transforms: Optional<Spanned<List<Spanned<List<Box<Step>>>>>>,
        /// A placement that moves, instead: its transform at some times.
        keyframes: Optional<Spanned<List<Box<KeyframeForm>>>>,
    }
}

/// The instances of a list; each transform of `transforms` makes one. The second part tells whether none was wrong.
fn instances<'f>(
    forms: &'f List<Box<InstanceForm>>,
    place: &str,
    names: &Names<'_>,
    shutter_s: [f64; 2],
    reader: &mut Reader<'_>,
) -> (Vec<(Instance, &'f InstanceForm)>, bool) {
    let mut all = Vec::new();
    let mut right = true;
    for (i, form) in forms.0.iter().enumerate() {
        let made = form.as_ref().and_then(|form| {
            let name = form.name.clone().checked().map(|name| name.unwrap_or_else(|| format!("{place}instances[{i}]")));
            let group = form.group.as_ref().and_then(|name| names.find(name, reader));
            let transforms = placements(form, shutter_s, reader);
            let (name, group) = (name?, group?);
            let mut transforms = transforms?;
            if let [_] = transforms.as_slice() {
                let (transform, motion) = transforms.pop()?;
                return Some(vec![(Instance { name, group, transform, motion }, &**form)]);
            }
            let numbered = transforms.into_iter().enumerate();
            let one = |(k, (transform, motion))| {
                (Instance { name: format!("{name}[{k}]"), group, transform, motion }, &**form)
            };
            Some(numbered.map(one).collect())
        });
        match made {
            Some(made) => all.extend(made),
            None => right = false,
        }
    }
    (all, right)
}

fn placements(form: &InstanceForm, shutter_s: [f64; 2], reader: &mut Reader<'_>) -> Option<Vec<Placed>> {
    let moving = match &form.keyframes {
        Optional::Absent => None,
        Optional::Invalid => return None,
        Optional::Given(keyframes) => {
            let transform = form.transform.given().map(|given| ("transform", given.at));
            let other = transform.or(form.transforms.given().map(|given| ("transforms", given.at)));
            if let Some((key, at)) = other {
                let message = format!("\"{key}\" and \"keyframes\" exclude each other");
                let label = (at.head(), "the other one");
                reader.error_related(Code::KeyConflict, keyframes.at.head(), message, "keep one of them", label);
                return None;
            }
            Some(motion(keyframes, shutter_s, Stretch::Allowed, reader)?)
        }
    };
    match (&form.transform, &form.transforms) {
        (Optional::Absent, Optional::Absent) => Some(vec![moving.unwrap_or((Transform::IDENTITY, None))]),
        (Optional::Given(steps), Optional::Absent) => {
            transform(&steps.value, steps.at.head(), reader).map(|transform| vec![(transform, None)])
        }
        (Optional::Absent, Optional::Given(several)) => {
            if several.value.0.is_empty() {
                let hint = "add a transform for each placement, or leave the key out to place the group once";
                reader.error_hint(Code::WrongLength, several.at.head(), "the instance is placed nowhere", hint);
                return None;
            }
            let made: Vec<_> = several
                .value
                .0
                .iter()
                .map(|steps| steps.as_ref().and_then(|steps| transform(&steps.value, steps.at.head(), reader)))
                .map(|transform| transform.map(|transform| (transform, None)))
                .collect();
            made.into_iter().collect()
        }
        (Optional::Given(one), Optional::Given(several)) => {
            let message = "\"transform\" and \"transforms\" exclude each other";
            let label = (one.at.head(), "the other one");
            reader.error_related(Code::KeyConflict, several.at.head(), message, "keep one of them", label);
            None
        }
        (Optional::Invalid, _) | (_, Optional::Invalid) => None,
    }
}

/// The groups, each after those that it places, and the scene's own instances; `None` if anything was wrong.
pub(crate) fn groups<'f>(
    entries: &'f [NamedEntry<Box<GroupForm>>],
    top: Option<&List<Box<InstanceForm>>>,
    shutter_s: [f64; 2],
    mut object: impl FnMut(&'f ObjectForm, String, &mut Reader<'_>) -> Option<Object>,
    reader: &mut Reader<'_>,
) -> Option<(Vec<Group>, Vec<Instance>)> {
    let names = Names::new("group", "groups", Place::Group, entries);
    let mut right = true;
    // In the order of the file.
    let mut members: Vec<Members<'f>> = Vec::new();
    for entry in entries {
        let mut group = Members::default();
        match entry.value.as_deref() {
            Some(form) => {
                let place = format!("groups.{}.", entry.name);
                for (i, form) in form.objects.iter().flat_map(|list| list.0.iter().enumerate()) {
                    let name = format!("{place}objects[{i}]");
                    match form.as_ref().and_then(|form| object(form, name, reader)) {
                        Some(object) => group.objects.push(object),
                        None => right = false,
                    }
                }
                if let Some(list) = &form.instances {
                    let (made, all_right) = instances(list, &place, &names, shutter_s, reader);
                    group.instances = made;
                    right &= all_right;
                }
                right &= form.objects.is_some() && form.instances.is_some();
            }
            None => right = false,
        }
        members.push(group);
    }
    let top = top.map(|list| instances(list, "", &names, shutter_s, reader));
    let order = order(&members, reader)?;
    let (top, all_right) = top?;
    if !(right && all_right) {
        return None;
    }
    check(&members, &order, &top, reader)?;
    // From places in the file to places in the model.
    let mut number = vec![0; members.len()];
    order.iter().enumerate().for_each(|(new, &old)| number[old] = new);
    let renumbered = |list: Vec<(Instance, &InstanceForm)>| -> Vec<Instance> {
        list.into_iter().map(|(i, _)| Instance { group: number[i.group], ..i }).collect()
    };
    let mut taken: Vec<Option<Members<'f>>> = members.into_iter().map(Some).collect();
    let groups = order.iter().filter_map(|&old| {
        let Members { objects, instances } = taken[old].take()?;
        Some(Group { name: entries[old].name.clone(), objects, instances: renumbered(instances) })
    });
    Some((groups.collect(), renumbered(top)))
}

/// What a group holds.
#[derive(Default)]
struct Members<'f> {
    objects: Vec<Object>,
    instances: Vec<(Instance, &'f InstanceForm)>,
}

/// The groups sorted so that each comes after those that it places; `None`, and an error, if they place each other in a
/// circle.
fn order(members: &[Members<'_>], reader: &mut Reader<'_>) -> Option<Vec<usize>> {
    #[derive(Clone, Copy, PartialEq)]
    enum State {
        New,
        Open,
        Done,
    }
    let mut state = vec![State::New; members.len()];
    let mut order = Vec::with_capacity(members.len());
    let mut right = true;
    for root in 0..members.len() {
        if state[root] != State::New {
            continue;
        }
        // A stack of its own: a hostile file may name millions of groups, one within the other.
        state[root] = State::Open;
        let mut stack = vec![(root, 0)];
        while let Some((group, next)) = stack.pop() {
            let Some((instance, form)) = members[group].instances.get(next) else {
                state[group] = State::Done;
                order.push(group);
                continue;
            };
            stack.push((group, next + 1));
            match state[instance.group] {
                State::New => {
                    state[instance.group] = State::Open;
                    stack.push((instance.group, 0));
                }
                State::Open => {
                    right = false;
                    let at = form.group.as_ref().map_or(form.at.head(), |name| name.at);
                    reader.error(Code::Circular, at, "this group contains itself");
                }
                State::Done => {}
            }
        }
    }
    right.then_some(order)
}

/// What follows from how groups are placed within each other.
#[derive(Clone, Copy, Default)]
struct Summary {
    /// Groups within each other, itself included.
    nesting: usize,
    /// Groups placed, itself included.
    placed: u64,
    /// The shape of an emitter that only similarities keep what it is.
    round_emitter: Option<&'static str>,
}

fn check(
    members: &[Members<'_>],
    order: &[usize],
    top: &[(Instance, &InstanceForm)],
    reader: &mut Reader<'_>,
) -> Option<()> {
    let before = reader.error_count();
    let mut summaries = vec![Summary::default(); members.len()];
    let place = |list: &[(Instance, &InstanceForm)], summaries: &[Summary], reader: &mut Reader<'_>| {
        let mut sum = Summary { placed: 1, nesting: 1, round_emitter: None };
        for (instance, form) in list {
            let of = &summaries[instance.group];
            sum.nesting = sum.nesting.max(of.nesting + 1);
            sum.placed = sum.placed.saturating_add(of.placed);
            sum.round_emitter = sum.round_emitter.or(of.round_emitter);
            if let Some(what) = of.round_emitter {
                let moving = instance.motion.iter().flat_map(|motion| &motion.keyframes).map(|key| &key.transform);
                // The first that is none is enough.
                if let Some(other) =
                    moving.chain([&instance.transform]).find(|transform| !is_similarity(&transform.affine().matrix3))
                {
                    check_instance_similarity(what, other, form.at.head(), reader);
                }
            }
        }
        sum
    };
    for &group in order {
        let mut sum = place(&members[group].instances, &summaries, reader);
        let emitters = members[group].objects.iter().filter(|object| object.emission.is_some());
        sum.round_emitter = emitters.filter_map(|object| object.shape.round_name()).next().or(sum.round_emitter);
        summaries[group] = sum;
    }
    let sum = place(top, &summaries, reader);
    // The scene itself is no group.
    let (nesting, placed) = (sum.nesting - 1, sum.placed - 1);
    let at = top.first().map(|(_, form)| form.at.head());
    if let Some(at) = at.filter(|_| nesting > MAX_NESTING) {
        reader.error(Code::Limit, at, format!("groups are nested {nesting} deep; at most {MAX_NESTING}"));
    }
    if let Some(at) = at.filter(|_| placed > MAX_PLACED) {
        reader.error(Code::Limit, at, format!("{placed} placed groups; at most {MAX_PLACED}"));
    }
    (reader.error_count() == before).then_some(())
}
