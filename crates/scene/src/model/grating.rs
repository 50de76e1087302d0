//! Diffraction gratings.

/// A grating: grooves so fine that light leaves in a few directions, each wavelength in its own.
///
/// With ĝ the unit vector across the grooves in the surface, Λ the period and m the order, the parts along the surface of the unit vectors
/// toward viewer and light add up to mλ/Λ·ĝ. In the plane across the grooves that is mλ = Λ(sin θᵢ + sin θₘ), both angles on one side of
/// the normal positive.
#[derive(Clone, Debug, PartialEq)]
pub struct Grating {
    /// Λ, nm, above 0.
    pub period_nm: f64,
    /// The orders m that carry light, each once, and the share of the light that goes into each; together at most 1.
    pub orders: Vec<(i32, f64)>,
    /// How the grooves run.
    pub grooves: Grooves,
    /// Whether light passes the surface or is reflected.
    pub transmits: bool,
    /// Given, every wavelength goes where this one does, nm: for pictures without dispersion.
    pub at_nm: Option<f64>,
}

/// How the grooves of a grating run over a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Grooves {
    /// Straight, across a direction that is turned from that of growing u toward that of growing v, rad.
    Straight(f64),
    /// In circles about the middle of the texture coordinates, (½, ½), which are taken to grow alike.
    Circles,
}

impl Grating {
    /// The share of light that goes into all orders.
    pub fn efficiency(&self) -> f64 {
        self.orders.iter().map(|(_, efficiency)| efficiency).sum()
    }
}
