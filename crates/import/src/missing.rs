//! Shapes and lights of other programs that the format does not have, and what a picture lacks without them.

pub(crate) fn shape(plugin: &str) -> String {
    let kind = match plugin {
        "bsplinecurve" | "linearcurve" | "curve" | "hair" => "curves",
        "sdfgrid" => "a grid of distances",
        "ellipsoids" | "ellipsoidsmesh" => "ellipsoids",
        "heightfield" => "a height field",
        _ => return format!("the shape \"{plugin}\" is not known, and is left out"),
    };
    format!("the shape \"{plugin}\" ({kind}) is not seen and has no shadow")
}

pub(crate) fn emitter(plugin: &str) -> String {
    match plugin {
        "sunsky" | "timed_sunsky" | "sky" | "sun" => {
            format!("the emitter \"{plugin}\" (a computed sky) gives no light")
        }
        _ => format!("the emitter \"{plugin}\" is not known, and is left out"),
    }
}
