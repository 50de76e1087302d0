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

/// What stands for a material.
pub(crate) fn material(plugin: &str) -> String {
    let kind = match plugin {
        "hair" => "fibres",
        "measured_polarized" => "measured, with polarisation",
        "coating" | "roughcoating" => "a coat over another",
        "difftrans" => "a sheet that scatters light to its back",
        "irawan" => "woven cloth",
        "hk" => "a layer that scatters light",
        "phong" | "ward" => "a glossy surface",
        "mixturebsdf" => "a mixture",
        _ => return format!("the material \"{plugin}\" is not known: it becomes grey"),
    };
    format!("the material \"{plugin}\" ({kind}) cannot be read: grey that scatters half of the light is used")
}

/// What a body lacks into which light should go.
pub(crate) fn subsurface(plugin: &str) -> String {
    format!("the subsurface scattering \"{plugin}\" is left out: the surface alone reflects light")
}

pub(crate) fn emitter(plugin: &str) -> String {
    match plugin {
        "sunsky" | "timed_sunsky" | "sky" | "sun" => {
            format!("the emitter \"{plugin}\" (a computed sky) gives no light")
        }
        _ => format!("the emitter \"{plugin}\" is not known, and is left out"),
    }
}
