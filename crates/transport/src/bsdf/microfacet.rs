//! Rough surfaces as mirrors too small to see: the GGX distribution of their normals (Trowbridge & Reitz 1975; Walter et al.
//! 2007, *Microfacet Models for Refraction through Rough Surfaces*) with Smith's masking.
//!
//! Everything is in the surface's frame, z along the normal, in `f64`: near a delta the half vector needs it. The width α is
//! as Walter et al. define it: the slopes have the density of a Student t with scale α.

use etalon_optics::{Frame, Real, Vec3};
use std::f64::consts::FRAC_1_PI;
use std::sync::LazyLock;

/// A GGX distribution of microfacet normals.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ggx {
    alpha: f64,
}

impl Ggx {
    /// Facets of width `alpha`, above 0.
    pub(crate) fn new(alpha: f64) -> Self {
        Self { alpha }
    }

    /// Their width.
    pub(crate) fn alpha(&self) -> f64 {
        self.alpha
    }

    /// Density D of facet normals, sr⁻¹ of normals per unit of surface: 1/(π α² e²), e = sin²θ/α² + cos²θ.
    pub(crate) fn density(&self, h: Vec3<f64>) -> f64 {
        let a2 = self.alpha * self.alpha;
        let e = (h.x * h.x + h.y * h.y) / a2 + h.z * h.z;
        FRAC_1_PI / (a2 * e * e)
    }

    /// S = √(cos²θ + α² sin²θ), so that Smith's masking is G₁ = 2c/(c + S), c = |cos θ|.
    pub(crate) fn stretch(&self, w: Vec3<f64>) -> f64 {
        let a2 = self.alpha * self.alpha;
        (w.z * w.z + a2 * (w.x * w.x + w.y * w.y)).sqrt()
    }

    /// A facet normal that `wo` (z > 0) sees, with density G₁(wo) D(h) (wo·h)/cos θ_o: a cap of the sphere, stretched
    /// (Heitz 2018; in the form of Dupuy & Benyoub 2023, *Sampling Visible GGX Normals with Spherical Caps*, listing 3).
    pub(crate) fn visible_normal(&self, wo: Vec3<f64>, u: [f64; 2]) -> Vec3<f64> {
        let squeezed = Vec3::new(self.alpha * wo.x, self.alpha * wo.y, wo.z).normalized();
        let (sin_phi, cos_phi) = f64::sin_cos_turns(u[0]);
        let z = (1.0 - u[1]) * (1.0 + squeezed.z) - squeezed.z;
        let sin = ((1.0 - z) * (1.0 + z)).sqrt_nonnegative();
        let cap = Vec3::new(sin * cos_phi, sin * sin_phi, z) + squeezed;
        Vec3::new(self.alpha * cap.x, self.alpha * cap.y, cap.z).normalized()
    }

    /// Reflection between two directions on the same side: (D·G₂/(4 cos θ_o cos θ_i), density of drawing `wi` by reflecting
    /// `wo` about a visible normal, cosine between either and the normal they share).
    ///
    /// Smith's G₂ is height-correlated (Heitz 2014): with S as in [`Ggx::stretch`] the first is D/(2(c_o S_i + c_i S_o)) and
    /// the second D/(2(c_o + S_o)). The first is symmetric in the directions, bit for bit.
    pub(crate) fn reflection(&self, wo: Vec3<f64>, wi: Vec3<f64>) -> Reflection {
        let sum = wo + wi;
        let length = sum.length();
        let d = self.density(sum / length);
        let (s_o, s_i) = (self.stretch(wo), self.stretch(wi));
        let (c_o, c_i) = (wo.z.abs(), wi.z.abs());
        Reflection {
            term: 0.5 * d / (c_o * s_i + c_i * s_o),
            density: 0.5 * d / (c_o + s_o),
            cos: (0.5 * length).min(1.0),
        }
    }

    /// Refraction between `above` (z > 0), in a medium of index `n_above`, and `below`, in one of `n_below`; `None` where no
    /// facet refracts one into the other.
    ///
    /// Masking is separable, G₁G₁, as in Walter et al.; the height-correlated form would be Euler's beta function
    /// (Heitz 2014), which G₁G₁ bounds.
    pub(crate) fn refraction(
        &self,
        above: Vec3<f64>,
        n_above: f64,
        below: Vec3<f64>,
        n_below: f64,
    ) -> Option<Refraction> {
        let sum = above * n_above + below * n_below;
        let square = sum.length_squared();
        let length = square.sqrt().copysign(sum.z);
        let h = sum / length;
        let (cos_above, cos_below) = (above.dot(h), -below.dot(h));
        if !(length != 0.0 && cos_above > 0.0 && cos_below > 0.0) {
            return None;
        }
        let common = self.density(h) * cos_above * cos_below / square;
        let (s_above, s_below) = (self.stretch(above), self.stretch(below));
        let (g_above, g_below) = (2.0 / (above.z.abs() + s_above), 2.0 / (below.z.abs() + s_below));
        Some(Refraction { common, g_above, g_below, cos_above: cos_above.min(1.0) })
    }
}

/// What [`Ggx::reflection`] finds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reflection {
    /// D·G₂/(4 cos θ_o cos θ_i), sr⁻¹: the BRDF of perfect mirrors.
    pub(crate) term: f64,
    /// Density of the direction, sr⁻¹.
    pub(crate) density: f64,
    /// Cosine of incidence on the facet.
    pub(crate) cos: f64,
}

/// What [`Ggx::refraction`] finds, up to indices and Fresnel's T, which the caller knows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Refraction {
    /// D·|wo·h||wi·h|/(n_o wo·h + n_i wi·h)²: times T·G₁G₁/(cos θ_o cos θ_i)·n_o² it is the BSDF, times T·(G₁/cos θ_o)·n_i² the
    /// density of `wi`.
    pub(crate) common: f64,
    /// G₁/cos θ of the direction above.
    pub(crate) g_above: f64,
    /// G₁/cos θ of the direction below.
    pub(crate) g_below: f64,
    /// Cosine of incidence on the facet from above.
    pub(crate) cos_above: f64,
}

/// Mean over the facets that a direction of cosine `mu` sees of `loss`.
///
/// Midpoints in azimuth, of which half a turn suffices, and an adaptive rule along the cap, divided where the reflected direction meets
/// the horizon: a kink there, square roots where total reflection begins and, at grazing angles, kinks in the azimuth too. Losses by it
/// are too high by 1e-3 of themselves at most, and too low by 1.5e-3 of all light at most (narrow facets seen from inside glass).
pub(crate) fn mean_over_facets(ggx: &Ggx, mu: f64, loss: impl Fn(&Facet) -> f64) -> f64 {
    // Tables ask hundreds of times each: to make it took a fifth of their time.
    static RULE: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| gauss_rule(8));
    let rule = &*RULE;
    let azimuths: u32 = if mu < 0.15 { 72 } else { 24 };
    let wo = Vec3::new(((1.0 - mu) * (1.0 + mu)).sqrt_nonnegative(), 0.0, mu);
    let s_o = ggx.stretch(wo);
    let along = |i: u32| {
        let turns = 0.5 * (f64::from(i) + 0.5) / f64::from(azimuths);
        let facet = |v: f64| {
            let h = ggx.visible_normal(wo, [turns, v]);
            let cos = wo.dot(h).clamp(0.0, 1.0);
            let wi = wo.reflected_about(h);
            let s_i = ggx.stretch(wi);
            let mirrored = if wi.z <= 0.0 { 0.0 } else { wi.z * (mu + s_o) / (mu * s_i + wi.z * s_o) };
            Facet { cos, mirrored, h, wo }
        };
        let upward = |facet: &Facet| facet.mirrored > 0.0;
        // The value, and between which neighbouring nodes light begins or ceases to be reflected upward.
        let panel = |a: f64, b: f64| {
            let (mut sum, mut horizon, mut before) = (0.0, None, None);
            for (x, w) in rule {
                let v = a + (b - a) * x;
                let facet = facet(v);
                sum += w * loss(&facet);
                horizon = match before {
                    Some((last, up)) if up != upward(&facet) => Some([last, v]),
                    _ => horizon,
                };
                before = Some((v, upward(&facet)));
            }
            (sum * (b - a), horizon)
        };
        // Panels yet to be judged, with their values.
        let mut waiting = vec![(0.0, 1.0, panel(0.0, 1.0))];
        let mut sum = 0.0;
        while let Some((a, b, (whole, horizon))) = waiting.pop() {
            let divided = horizon.map_or(0.5 * (a + b), |ends| between(ends, |v| upward(&facet(v))));
            let (left, right) = (panel(a, divided), panel(divided, b));
            let found = left.0 + right.0;
            if (found - whole).abs() <= 1e-6 * (b - a).max(0.05) || b - a < 1e-4 {
                sum += found;
            } else {
                waiting.extend([(a, divided, left), (divided, b, right)]);
            }
        }
        sum
    };
    (0..azimuths).map(along).sum::<f64>() / f64::from(azimuths)
}

/// Where between two places what holds at one of them alone changes, to a few thousandths of their distance: what a kink that
/// far off changes is the square of that.
fn between([mut a, mut b]: [f64; 2], holds: impl Fn(f64) -> bool) -> f64 {
    let at_a = holds(a);
    for _ in 0..10 {
        let middle = 0.5 * (a + b);
        if holds(middle) == at_a { a = middle } else { b = middle }
    }
    0.5 * (a + b)
}

/// A facet that [`mean_over_facets`] visits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facet {
    /// Cosine of incidence on it.
    pub(crate) cos: f64,
    /// G₂/G₁ of the reflected direction, 0 if it leaves downward.
    pub(crate) mirrored: f64,
    /// Its normal.
    pub(crate) h: Vec3<f64>,
    /// The direction that sees it.
    pub(crate) wo: Vec3<f64>,
}

/// Nodes in (0, 1) and weights, with sum 1, of Gauss's rule of `points` points, by Newton's method on the Legendre recurrence.
pub(crate) fn gauss_rule(points: usize) -> Vec<(f64, f64)> {
    let count = points as f64;
    (0..points)
        .map(|i| {
            // Tricomi's first guess converges for every count.
            let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (count + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..10 {
                let (mut before, mut value) = (1.0, x);
                for k in 2..=points {
                    let k = k as f64;
                    (before, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k);
                }
                slope = count * (x * value - before) / (x * x - 1.0);
                x -= value / slope;
            }
            (0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// The surface's frame with the normal on the side of `wo`, and `wo` in it.
pub(crate) struct Facing {
    frame: Frame<f64>,
    /// `wo` in the frame, z ≥ 0.
    pub(crate) wo: Vec3<f64>,
}

impl Facing {
    /// The frame of normal `n`, turned toward `wo`; `None` for a `wo` exactly along the surface.
    pub(crate) fn new(n: Vec3<f64>, wo: Vec3<f64>) -> Option<Self> {
        let frame = Frame::from_normal(if n.dot(wo) < 0.0 { -n } else { n });
        let wo = frame.to_local(wo);
        (wo.z > 0.0).then_some(Self { frame, wo })
    }

    /// A direction of the world in the frame.
    pub(crate) fn local(&self, w: Vec3<f64>) -> Vec3<f64> {
        self.frame.to_local(w)
    }

    /// A direction of the frame in the world, brought back to unit length.
    pub(crate) fn world(&self, w: Vec3<f64>) -> Vec3<f64> {
        self.frame.to_world(w).renormalized()
    }
}
