//! Meters.

use std::ops::Bound;

use glam::DVec3;

use crate::json::{Code, Direction, Optional, Reader, Required, Span, Spanned, Whole};
use crate::linear::unit;
use crate::model::{Meter, MeterKind};

/// Most readings of all meters together.
pub(crate) const MAX_READINGS: u64 = 65_536;

crate::number! {
    /// The full angle of a cone of at most a half-space, degrees.
    pub(crate) struct ConeAngle in (Bound::Included(0.0), Bound::Included(180.0));
}

crate::record! {
    /// Irradiance and illuminance at a point.
    pub(crate) struct IrradianceMeter + comment {
        /// Its name in tables.
        name: Optional<String>,
        /// Position, m.
        position_m: Required<[f64; 3]>,
        /// Light is measured that arrives on the side of this vector; only the direction counts.
        normal: Required<Direction>,
    }
}

crate::record! {
    /// Irradiance and illuminance at the centres of the cells of a parallelogram, on the side of u × v.
    pub(crate) struct IrradianceGridMeter + comment {
        /// Its name in tables.
        name: Optional<String>,
        /// A corner, m.
        origin_m: Required<[f64; 3]>,
        /// One edge from the corner, m.
        u_m: Required<[f64; 3]>,
        /// The other edge from the corner, m.
        v_m: Required<[f64; 3]>,
        /// Cells along u.
        columns: Required<Whole<1, MAX_READINGS>>,
        /// Cells along v.
        rows: Required<Whole<1, MAX_READINGS>>,
    }
}

crate::record! {
    /// Flux that arrives on the side of u × v of a parallelogram, and passes it.
    pub(crate) struct FluxMeter + comment {
        /// Its name in tables.
        name: Optional<String>,
        /// A corner, m.
        origin_m: Required<[f64; 3]>,
        /// One edge from the corner, m.
        u_m: Required<[f64; 3]>,
        /// The other edge from the corner, m.
        v_m: Required<[f64; 3]>,
    }
}

crate::record! {
    /// Mean radiance and luminance that arrive at a point from a cone of directions.
    pub(crate) struct RadianceMeter + comment {
        /// Its name in tables.
        name: Optional<String>,
        /// Position, m.
        position_m: Required<[f64; 3]>,
        /// Where it looks; only the direction counts.
        direction: Required<Direction>,
        /// Full angle of the cone, degrees; 0 is a single direction.
        full_angle_deg: Required<ConeAngle> = "1",
    }
}

crate::variants! {
    /// A meter. It is in nobody's way: no ray meets it. `etalon measure` reads it.
    pub(crate) enum MeterForm by "type" {
        "irradiance" => Irradiance(IrradianceMeter),
        "irradiance-grid" => IrradianceGrid(IrradianceGridMeter),
        "flux" => Flux(FluxMeter),
        "radiance" => Radiance(RadianceMeter),
    }
}

/// Below this sine of the angle between two edges, their normal hangs on digits that nobody meant.
const PARALLEL: f64 = 1e-6;

/// The edges of a parallelogram, if they span one.
fn edges(u: [f64; 3], v: [f64; 3], at: Span, reader: &mut Reader<'_>) -> Option<[[f64; 3]; 2]> {
    let sine = unit(DVec3::from(u)).zip(unit(DVec3::from(v))).map_or(0.0, |(u, v)| u.cross(v).length());
    let longest = u.iter().chain(&v).fold(0.0_f64, |m, c| m.max(c.abs()));
    if sine < PARALLEL || longest > 1e150 {
        reader.error(Code::OutOfRange, at, "\"u_m\" and \"v_m\" span no parallelogram");
        return None;
    }
    Some([u, v])
}

/// The meter of a form, the `index`-th of the file.
fn meter(form: &MeterForm, index: usize, reader: &mut Reader<'_>) -> Option<Meter> {
    let (name, kind) = match form {
        MeterForm::Irradiance(form) => {
            (&form.name, MeterKind::Irradiance { position_m: form.position_m?, normal: form.normal?.0 })
        }
        MeterForm::IrradianceGrid(form) => {
            let edges_m = edges(form.u_m?, form.v_m?, form.at.head(), reader)?;
            // Within the range declared above.
            let cells = [form.columns?.0 as u32, form.rows?.0 as u32];
            (&form.name, MeterKind::IrradianceGrid { origin_m: form.origin_m?, edges_m, cells })
        }
        MeterForm::Flux(form) => {
            let edges_m = edges(form.u_m?, form.v_m?, form.at.head(), reader)?;
            (&form.name, MeterKind::Flux { origin_m: form.origin_m?, edges_m })
        }
        MeterForm::Radiance(form) => {
            let half_angle_rad = 0.5 * form.full_angle_deg?.0.to_radians();
            let (position_m, direction) = (form.position_m?, form.direction?.0);
            (&form.name, MeterKind::Radiance { position_m, direction, half_angle_rad })
        }
    };
    let name = name.clone().checked()?.unwrap_or_else(|| format!("meters[{index}]"));
    Some(Meter { name, kind })
}

/// The meters of a file.
pub(crate) fn meters(
    forms: &Spanned<crate::json::List<Box<MeterForm>>>,
    reader: &mut Reader<'_>,
) -> Option<Vec<Meter>> {
    let made: Vec<Option<Meter>> = forms
        .value
        .0
        .iter()
        .enumerate()
        .map(|(index, form)| form.as_ref().and_then(|form| meter(form, index, reader)))
        .collect();
    let made: Vec<Meter> = made.into_iter().collect::<Option<_>>()?;
    let readings: u64 = made.iter().map(|meter| meter.kind.reading_count()).fold(0, u64::saturating_add);
    if readings > MAX_READINGS {
        let message = format!("the meters have {readings} readings; at most {MAX_READINGS} are possible");
        reader.error(Code::OutOfRange, forms.at.head(), message);
        return None;
    }
    Some(made)
}
