//! Diffraction gratings.

use std::ops::Bound;

use super::super::spectra::{Role, Spectra};
use super::super::spectrum::SpectrumForm;
use super::Share;
use crate::files::Files;
use crate::json::{Code, List, Optional, Reader, Required, Spanned};
use crate::model::{Grating, Grooves, MaterialKind};

/// The most orders of a grating.
const MOST_ORDERS: usize = 64;

crate::number! {
    /// A period of a grating, nm, from 50 nm to 1 mm.
    pub(crate) struct Period in (Bound::Included(50.0), Bound::Included(1e6));
}

crate::number! {
    /// An order of diffraction, from −1000 to 1000.
    pub(crate) struct Order in (Bound::Included(-1e3), Bound::Included(1e3));
}

crate::record! {
    /// An order of diffraction.
    pub(crate) struct OrderForm + comment {
        /// Its number m, a whole one: 0 is what a mirror or a window would do.
        order: Required<Spanned<Order>>,
        /// The share of the light that goes into it, from 0 to 1.
        efficiency: Required<Share>,
    }
}

/// How the grooves run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum GroovesForm {
    Straight,
    Circles,
}

crate::keywords!(GroovesForm {
    /// Straight, along growing v: light is spread along growing u.
    "straight" => Self::Straight,
    /// In circles about the middle of the texture coordinates, (0.5, 0.5), as on a disc.
    "circles" => Self::Circles,
});

/// Where the light of a grating goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum GratingLight {
    Reflected,
    Transmitted,
}

crate::keywords!(GratingLight {
    /// Back, to the side that it came from.
    "reflected" => Self::Reflected,
    /// On, to the other side.
    "transmitted" => Self::Transmitted,
});

crate::record! {
    /// A diffraction grating, the same on both sides and seen from vacuum: each order of each wavelength leaves in a direction of its own.
    pub(crate) struct GratingMaterial + comment {
        /// Distance from groove to groove, nm, from 50 to 1000000.
        period_nm: Required<Period>,
        /// The orders that carry light; efficiencies add up to at most 1.
        orders: Required<Spanned<List<OrderForm>>>,
        /// Factor on all efficiencies at each wavelength, from 0 to 1.
        reflectance: Required<SpectrumForm> = "1",
        /// Whether light is reflected or passes.
        light: Required<GratingLight> = r#""reflected""#,
        /// How the grooves run.
        grooves: Required<GroovesForm> = r#""straight""#,
        /// By how much straight grooves are turned, from growing u toward growing v, degrees.
        groove_rotation_deg: Optional<Spanned<f64>>,
    }
}

/// The grating of a form.
pub(super) fn grating<'f>(
    form: &'f GratingMaterial,
    spectra: &mut Spectra<'f>,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<MaterialKind> {
    let reflectance =
        form.reflectance.as_ref().and_then(|form| spectra.resolve_texture(form, Role::Reflectance, files, reader));
    let orders = form.orders.as_ref().and_then(|orders| self::orders(orders, reader));
    let rotation = form.groove_rotation_deg.clone().checked()?;
    let grooves = match (form.grooves?, rotation) {
        (GroovesForm::Straight, rotation) => Grooves::Straight(rotation.map_or(0.0, |deg| deg.value.to_radians())),
        (GroovesForm::Circles, None) => Grooves::Circles,
        (GroovesForm::Circles, Some(rotation)) => {
            reader.error_hint(Code::KeyConflict, rotation.at, "circles cannot be turned", "leave it out");
            return None;
        }
    };
    let transmits = form.light? == GratingLight::Transmitted;
    let grating = Grating { period_nm: form.period_nm.as_ref()?.0, orders: orders?, grooves, transmits, at_nm: None };
    Some(MaterialKind::Grating { reflectance: reflectance?, grating })
}

fn orders(form: &Spanned<List<OrderForm>>, reader: &mut Reader<'_>) -> Option<Vec<(i32, f64)>> {
    let List(list) = &form.value;
    if list.is_empty() || list.len() > MOST_ORDERS {
        let message = format!("a grating of {} orders", list.len());
        reader.error_hint(Code::WrongLength, form.at, message, format!("it has from 1 to {MOST_ORDERS}"));
        return None;
    }
    let mut orders: Vec<(i32, f64)> = Vec::with_capacity(list.len());
    for order in list {
        let order = order.as_ref()?;
        let (number, at) = order.order.as_ref().map(|order| (order.value.0, order.at))?;
        let efficiency = order.efficiency.as_ref()?.0;
        let wrong = match number {
            _ if number.fract() != 0.0 => format!("the order {number} is not a whole number"),
            _ if orders.iter().any(|(known, _)| f64::from(*known) == number) => {
                format!("the order {number} comes twice")
            }
            _ => {
                orders.push((number as i32, efficiency));
                continue;
            }
        };
        reader.error(Code::OutOfRange, at, wrong);
        return None;
    }
    let sum: f64 = orders.iter().map(|(_, efficiency)| efficiency).sum();
    // What ten decimal shares add up to may be one rounding more.
    if sum > 1.0 + 1e-12 {
        let message = format!("the efficiencies add up to {sum}, which is more than all light");
        reader.error(Code::OutOfRange, form.at, message);
        return None;
    }
    Some(orders)
}
