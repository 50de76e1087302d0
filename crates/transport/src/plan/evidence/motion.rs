//! What moves while the shutter is open.

use etalon_scene::{Instance, Keyframe, Motion, Scene};

/// What calls for motion (`Ok`), or why nothing does (`Err`).
pub(super) fn motion(scene: &Scene) -> Result<String, String> {
    let shutter_s = scene.camera.shutter_s;
    if let Some(moving) = scene.camera.motion.as_ref().filter(|moving| moving.moves(shutter_s)) {
        return Ok(format!("the camera {}", travelled(&moving.motion, shutter_s)));
    }
    let mut placed = vec![false; scene.groups.len()];
    scene.instances.iter().for_each(|instance| placed[instance.group] = true);
    // Groups place only groups before them.
    for (index, group) in scene.groups.iter().enumerate().rev() {
        if placed[index] {
            group.instances.iter().for_each(|instance| placed[instance.group] = true);
        }
    }
    let within = scene.groups.iter().zip(placed).filter(|(_, placed)| *placed).flat_map(|(group, _)| &group.instances);
    let moving: Vec<(&Instance, &Motion)> = scene
        .instances
        .iter()
        .chain(within)
        .filter_map(|instance| instance.motion.as_ref().map(|motion| (instance, motion)))
        .filter(|(_, motion)| motion.moves(shutter_s))
        .collect();
    match moving.first() {
        Some((first, motion)) => {
            let others = match moving.len() {
                1 => String::new(),
                count => format!(", the first of {count} that move"),
            };
            Ok(format!("\"{}\" {}{others}", first.name, travelled(motion, shutter_s)))
        }
        None if shutter_s[0] == shutter_s[1] => Err("the shutter is open for an instant".to_owned()),
        None => Err("nothing moves while the shutter is open".to_owned()),
    }
}

/// How far something turns and moves while the shutter is open.
fn travelled(motion: &Motion, [open_s, close_s]: [f64; 2]) -> String {
    // Where it is at each keyframe and at both ends.
    let between = motion.keyframes.iter().map(|key| key.time_s).filter(|time| open_s < *time && *time < close_s);
    let times = std::iter::once(open_s).chain(between).chain([close_s]);
    let stops: Vec<Keyframe> = times.map(|time_s| Keyframe::new(time_s, motion.at(time_s))).collect();
    let (mut angle_deg, mut length_m) = (0.0, 0.0);
    for pair in stops.windows(2) {
        angle_deg += pair[0].angle_to_rad(&pair[1]).to_degrees();
        let (a, b) = (pair[0].transform.translation_m, pair[1].transform.translation_m);
        length_m += (0..3).map(|k| (b[k] - a[k]) * (b[k] - a[k])).sum::<f64>().sqrt();
    }
    let mut does = Vec::new();
    // What rounding leaves of no turn.
    if angle_deg > 1e-9 {
        does.push(format!("turns by {angle_deg:.3}°"));
    }
    if length_m > 0.0 {
        does.push(format!("moves by {length_m:.4} m"));
    }
    if does.is_empty() {
        does.push("is stretched".to_owned());
    }
    format!("{} in {} s", does.join(" and "), close_s - open_s)
}
