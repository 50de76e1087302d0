//! Rough surfaces as mirrors too small to see: the GGX distribution of their normals (Trowbridge & Reitz 1975; Walter et al.
//! 2007, *Microfacet Models for Refraction through Rough Surfaces*) or [Beckmann's](beckmann), with Smith's masking.
//!
//! Everything is in the surface's frame, z along the normal, in `f64`: near a delta the half vector needs it. The width α is
//! as Walter et al. define it: the slopes have the density of a Student t with scale α, or of a Gaussian of variance α²/2. A surface with a
//! grain has two widths, along its tangent x and along y (Heitz 2014, §5.4): the slopes are those of width 1, stretched by each along its axis.

use super::Shading;
use etalon_optics::{Frame, Real, Vec3};
use etalon_scene::{FacetDistribution, FacetMasking, Microfacets};
use std::f64::consts::FRAC_1_PI;
use std::sync::LazyLock;

mod anisotropic;
mod beckmann;

/// A distribution of microfacet normals, and how facets hide each other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Distribution {
    /// Widths along x and y, each above 0.
    alpha: [f64; 2],
    /// Cosine and sine of the angle of x from growing u.
    rotation: [f64; 2],
    kind: FacetDistribution,
    masking: FacetMasking,
}

impl Distribution {
    /// The facets of a scene's material.
    pub(crate) fn new(facets: &Microfacets) -> Self {
        let (sin, cos) = facets.rotation_rad.sin_cos();
        Self { alpha: facets.alpha, rotation: [cos, sin], kind: facets.distribution, masking: facets.masking }
    }

    /// Their widths along x and y.
    pub(crate) fn alpha(&self) -> [f64; 2] {
        self.alpha
    }

    /// Of what kind they are.
    pub(crate) fn kind(&self) -> (FacetDistribution, FacetMasking) {
        (self.kind, self.masking)
    }

    /// Their width, if it is the same along x and y.
    pub(crate) fn isotropic_alpha(&self) -> Option<f64> {
        let [x, y] = self.alpha;
        (x == y).then_some(x)
    }

    /// Density D of facet normals, sr⁻¹ of normals per unit of surface: GGX's is 1/(π α_x α_y e²), e = x²/α_x² + y²/α_y² + z².
    pub(crate) fn density(&self, h: Vec3<f64>) -> f64 {
        if self.kind == FacetDistribution::Beckmann {
            return beckmann::of_normal(self.alpha, h);
        }
        let [x2, y2] = self.alpha.map(|alpha| alpha * alpha);
        let slopes = if x2 == y2 { (h.x * h.x + h.y * h.y) / x2 } else { h.x * h.x / x2 + h.y * h.y / y2 };
        let e = slopes + h.z * h.z;
        FRAC_1_PI / (self.alpha[0] * self.alpha[1] * e * e)
    }

    /// S = c(1 + 2Λ), so that Smith's masking is G₁ = 2c/(c + S), c = |cos θ|; of GGX √(z² + α_x² x² + α_y² y²).
    pub(crate) fn stretch(&self, w: Vec3<f64>) -> f64 {
        let spread = self.spread(w);
        match self.kind {
            FacetDistribution::Ggx => (w.z * w.z + spread).sqrt(),
            FacetDistribution::Beckmann => beckmann::stretch(w.z.abs(), spread.sqrt()),
        }
    }

    /// α_x² x² + α_y² y².
    #[inline]
    fn spread(&self, w: Vec3<f64>) -> f64 {
        let [x2, y2] = self.alpha.map(|alpha| alpha * alpha);
        if x2 == y2 { x2 * (w.x * w.x + w.y * w.y) } else { x2 * w.x * w.x + y2 * w.y * w.y }
    }

    /// G₂/G₁ of the direction from which facets are seen, of another on the same side: of the cosines `mu` and `mu_i` > 0 and stretches.
    #[inline]
    fn mirrored(&self, (mu, stretch): (f64, f64), (mu_i, stretch_i): (f64, f64)) -> f64 {
        match self.masking {
            FacetMasking::Correlated => mu_i * (mu + stretch) / (mu * stretch_i + mu_i * stretch),
            FacetMasking::Separable => 2.0 * mu_i / (mu_i + stretch_i),
        }
    }

    /// The surface's frame at a point, around the normal `n` turned toward `wo`; `None` for a `wo` exactly along the surface.
    pub(crate) fn facing(&self, at: &Shading<'_>, n: Vec3<f64>, wo: Vec3<f64>) -> Option<Facing> {
        match self.isotropic_alpha() {
            Some(_) => Facing::new(n, wo),
            None => Facing::along(at.rotated_tangent(n, self.rotation), n, wo),
        }
    }

    /// A direction at right angles to `w` and the normal `n`, to any length: of facets of two widths as their azimuth in the frame says,
    /// which still has one where `w` is along the normal.
    pub(crate) fn s(&self, facing: &Facing, n: Vec3<f64>, w: Vec3<f64>) -> Vec3<f64> {
        if self.isotropic_alpha().is_some() {
            return n.cross(w);
        }
        let local = facing.local(w);
        let (x, y) = if local.x == 0.0 && local.y == 0.0 { (1.0, 0.0) } else { (local.x, local.y) };
        facing.frame.to_world(Vec3::new(-y, x, 0.0))
    }

    /// A facet normal that `wo` (z > 0) sees, with density G₁(wo) D(h) (wo·h)/cos θ_o: of GGX a cap of the sphere, stretched
    /// (Heitz 2018; in the form of Dupuy & Benyoub 2023, *Sampling Visible GGX Normals with Spherical Caps*, listing 3).
    pub(crate) fn visible_normal(&self, wo: Vec3<f64>, u: [f64; 2]) -> Vec3<f64> {
        let [x, y] = self.alpha;
        let squeezed = Vec3::new(x * wo.x, y * wo.y, wo.z).normalized();
        if self.kind == FacetDistribution::Beckmann {
            let h = beckmann::visible_normal(squeezed, u);
            return Vec3::new(x * h.x, y * h.y, h.z).normalized();
        }
        let (sin_phi, cos_phi) = f64::sin_cos_turns(u[0]);
        let z = (1.0 - u[1]) * (1.0 + squeezed.z) - squeezed.z;
        let sin = ((1.0 - z) * (1.0 + z)).sqrt_nonnegative();
        let cap = Vec3::new(sin * cos_phi, sin * sin_phi, z) + squeezed;
        Vec3::new(x * cap.x, y * cap.y, cap.z).normalized()
    }

    /// Reflection between two directions on the same side: (D·G₂/(4 cos θ_o cos θ_i), density of drawing `wi` by reflecting
    /// `wo` about a visible normal, cosine between either and the normal they share).
    ///
    /// Where Smith's G₂ is height-correlated (Heitz 2014), with S as in [`Distribution::stretch`], the first is D/(2(c_o S_i + c_i S_o)),
    /// where it is G₁G₁ it is D/((c_o + S_o)(c_i + S_i)). The second is D/(2(c_o + S_o)). The first is symmetric in the directions, bit for
    /// bit.
    pub(crate) fn reflection(&self, wo: Vec3<f64>, wi: Vec3<f64>) -> Reflection {
        let sum = wo + wi;
        let length = sum.length();
        let d = self.density(sum / length);
        let (s_o, s_i) = (self.stretch(wo), self.stretch(wi));
        let (c_o, c_i) = (wo.z.abs(), wi.z.abs());
        Reflection {
            term: match self.masking {
                FacetMasking::Correlated => 0.5 * d / (c_o * s_i + c_i * s_o),
                FacetMasking::Separable => d / ((c_o + s_o) * (c_i + s_i)),
            },
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

/// What [`Distribution::reflection`] finds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reflection {
    /// D·G₂/(4 cos θ_o cos θ_i), sr⁻¹: the BRDF of perfect mirrors.
    pub(crate) term: f64,
    /// Density of the direction, sr⁻¹.
    pub(crate) density: f64,
    /// Cosine of incidence on the facet.
    pub(crate) cos: f64,
}

/// What [`Distribution::refraction`] finds, up to indices and Fresnel's T, which the caller knows.
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

/// Relative error of the losses that [`mean_over_facets`] finds, where they are above a hundredth of the light: tables are lowered by it.
pub(crate) const MEAN_ERROR: f64 = 1e-4;

/// Mean over the facets that a direction `wo` (z > 0) sees of `loss`, to 5e-6. `eta` is the relative index behind the facets, where
/// light that they refract counts. Of facets of one width only the cosine of the direction counts.
///
/// For facets of two widths see [`anisotropic`]: there `loss` must be smooth but for `mirrored`, as that of facets with no total reflection
/// is. Of one width:
/// The integral is in polar coordinates about the direction: over the cosine c of incidence on a facet, and along the circle of all facets
/// of the same c. Fresnel's equations depend on c alone. Kinks and square roots are at known places: total reflection begins at one c,
/// reflected and refracted light meets the horizon at one place of each circle, and these places begin and end at known c. Gauss's rules
/// between such places, with nodes that crowd at both ends, converge quickly; along c they are divided where needed.
pub(crate) fn mean_over_facets(
    distribution: &Distribution,
    wo: Vec3<f64>,
    eta: Option<f64>,
    loss: impl Fn(&Facet) -> f64,
) -> f64 {
    let Some(alpha) = distribution.isotropic_alpha() else { return anisotropic::mean(distribution, wo, loss) };
    // Tables ask hundreds of times each: to make it took a fifth of their time.
    static RULE: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| gauss_rule(8));
    let view = View::new(distribution, alpha, wo.z, eta);
    let cuts = view.cuts();
    let between = |[first, last]: [f64; 2]| {
        let panel = |a: f64, b: f64| -> f64 {
            let at = |(x, weight): &(f64, f64)| {
                let (share, slope) = crowded(a + (b - a) * x);
                weight * slope * view.on_circle(first + (last - first) * share, &loss)
            };
            (b - a) * (last - first) * RULE.iter().map(at).sum::<f64>()
        };
        refined(panel, 1e-7, 1e-4)
    };
    cuts.windows(2).map(|ends| [ends[0], ends[1]]).filter(|[first, last]| first < last).map(between).sum()
}

/// The integral over [0, 1], of which `panel` says the part between two places: panels are divided until their halves say the same to
/// `tolerance`, or they are narrower than `least`.
fn refined(panel: impl Fn(f64, f64) -> f64, tolerance: f64, least: f64) -> f64 {
    // Panels yet to be judged, with their values.
    let mut waiting = vec![(0.0, 1.0, panel(0.0, 1.0))];
    let mut sum = 0.0;
    while let Some((a, b, whole)) = waiting.pop() {
        let middle = 0.5 * (a + b);
        let (left, right) = (panel(a, middle), panel(middle, b));
        if (left + right - whole).abs() <= tolerance || b - a < least {
            sum += left + right;
        } else {
            waiting.extend([(a, middle, left), (middle, b, right)]);
        }
    }
    sum
}

/// A map of [0, 1] to itself, and its slope, which is 0 at both ends: nodes crowd there, and square roots become smooth.
fn crowded(x: f64) -> (f64, f64) {
    (x * x * (3.0 - 2.0 * x), 6.0 * x * (1.0 - x))
}

/// Facets as one direction sees them.
struct View<'a> {
    distribution: &'a Distribution,
    alpha: f64,
    /// The direction, in the xz plane.
    wo: Vec3<f64>,
    stretch: f64,
    /// Relative index behind the facets, if light that they refract may leave upward or not at all.
    eta: Option<f64>,
}

impl<'a> View<'a> {
    fn new(distribution: &'a Distribution, alpha: f64, mu: f64, eta: Option<f64>) -> Self {
        let wo = Vec3::new(((1.0 - mu) * (1.0 + mu)).sqrt_nonnegative(), 0.0, mu);
        Self { distribution, alpha, wo, stretch: distribution.stretch(wo), eta: eta.filter(|eta| *eta < 1.0) }
    }

    /// The cosines of incidence between which means along circles are smooth, in order.
    fn cuts(&self) -> Vec<f64> {
        let (sin, mu) = (self.wo.x, self.wo.z);
        // Where the circle is cut off at the horizon, where facets are densest, where reflected light meets the horizon on either side,
        // where total reflection begins and refracted light meets the horizon.
        let [total, refracted] = self.eta.map_or([0.0; 2], |eta| {
            let along = 1.0 - eta * sin;
            [(1.0 - eta * eta).sqrt(), along / (along * along + eta * eta * mu * mu).sqrt()]
        });
        let reflected = [1.0 + sin, 1.0 - sin].map(|square| (0.5 * square).sqrt_nonnegative());
        let mut cuts = vec![0.0, 1.0, sin, mu, reflected[0], reflected[1], total, refracted];
        if self.distribution.kind == FacetDistribution::Beckmann {
            // Without tails that would lead to it, the peak is where slopes are a few widths long.
            for slope in [1.5, 3.0, 6.5].map(|widths| widths * self.alpha) {
                let cos = 1.0 / (1.0 + slope * slope).sqrt();
                cuts.extend([1.0, -1.0].map(|side| (cos * (mu + side * slope * sin)).clamp(0.0, 1.0)));
            }
        }
        cuts.sort_by(f64::total_cmp);
        cuts
    }

    /// Integral along the circle of facets that light meets at the cosine `c`, of their visible density times `loss`.
    fn on_circle(&self, c: f64, loss: &impl Fn(&Facet) -> f64) -> f64 {
        static RULE: LazyLock<Vec<(f64, f64, f64)>> = LazyLock::new(|| {
            let crowd = |(x, weight): &(f64, f64)| (crowded(*x).0, weight * crowded(*x).1);
            gauss_rule(24).iter().map(crowd).map(|(x, weight)| (x, 1.0 - x, weight)).collect()
        });
        let (sin, mu) = (self.wo.x, self.wo.z);
        let (alpha, a2) = (self.alpha, self.alpha * self.alpha);
        // The height of a facet is h_z = `level` + `swing`·cos ψ.
        let s = ((1.0 - c) * (1.0 + c)).sqrt_nonnegative();
        let (level, swing) = (c * mu, s * sin);
        // D = α²/(π(1 − k²h_z²)²) has a peak at ψ = 0. With tan(ψ/2) = q·tan(χ/2), as from true to eccentric anomaly, a factor
        // 1/(1 − k·h_z) becomes constant in χ.
        let k = ((1.0 - alpha) * (1.0 + alpha)).sqrt_nonnegative();
        let off = sin * c - mu * s;
        let least = a2 / (1.0 + k) + k * off * off / (1.0 + level + swing);
        let most = 1.0 - k * (level - swing);
        let q = (least / most).sqrt();
        // t = tan(χ/2) is x/(1 − x), x in [0, 1].
        let place = |height: f64| {
            let cos = ((height - level) / swing).clamp(-1.0, 1.0);
            let t = ((1.0 - cos) / (1.0 + cos)).sqrt() / q;
            if t.is_finite() { t / (1.0 + t) } else { 1.0 }
        };
        let end = if level < swing { place(0.0) } else { 1.0 };
        let reflected = place(mu / (2.0 * c));
        let refracted = self.eta.map_or(1.0, |eta| {
            // The refracted direction is bent·h − wo/η.
            let bent = c / eta - (1.0 - (1.0 - c * c) / (eta * eta)).sqrt_nonnegative();
            place(mu / (eta * bent))
        });
        let cuts = [0.0, reflected.min(refracted).min(end), reflected.max(refracted).min(end), end];
        let mut sum = 0.0;
        for ends in cuts.windows(2).filter(|ends| ends[0] < ends[1]) {
            for (share, rest, weight) in RULE.iter() {
                let x = ends[0] * rest + ends[1] * share;
                let (t, turned) = (q * x, 1.0 - x);
                let per = 1.0 / (t * t + turned * turned);
                let (cos, sin_psi) = ((turned * turned - t * t) * per, 2.0 * t * turned * per);
                let z = level + swing * cos;
                let wi_z = 2.0 * c * z - mu;
                let mirrored = if wi_z <= 0.0 {
                    0.0
                } else {
                    let s_i = match self.distribution.kind {
                        FacetDistribution::Ggx => (wi_z * wi_z + a2 * (1.0 - wi_z * wi_z)).sqrt(),
                        FacetDistribution::Beckmann => {
                            beckmann::stretch(wi_z, alpha * (1.0 - wi_z * wi_z).sqrt_nonnegative())
                        }
                    };
                    self.distribution.mirrored((mu, self.stretch), (wi_z, s_i))
                };
                let h = Vec3::new(c * sin - s * mu * cos, s * sin_psi, z);
                let mut density = 1.0 / ((least + k * swing * (1.0 - cos)) * (1.0 + k * z) * (1.0 + k * z));
                if self.distribution.kind == FacetDistribution::Beckmann {
                    density *= beckmann::over_ggx((1.0 - z) * (1.0 + z) / (a2 * z * z));
                }
                let dx = (ends[1] - ends[0]) * weight / (turned * turned + x * x);
                sum += dx * density * loss(&Facet { cos: c, mirrored, h, wo: self.wo });
            }
        }
        // Both halves of the circle; dχ = 2dx/((1 − x)² + x²); G₁(wo)/µ = 2/(µ + S).
        8.0 * FRAC_1_PI * a2 * c / ((least * most).sqrt() * (mu + self.stretch)) * sum
    }
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
        Self::of(Frame::from_normal(if n.dot(wo) < 0.0 { -n } else { n }), wo)
    }

    /// The same with x along the unit vector `tangent`, at right angles to `n`.
    fn along(tangent: Vec3<f64>, n: Vec3<f64>, wo: Vec3<f64>) -> Option<Self> {
        let n = if n.dot(wo) < 0.0 { -n } else { n };
        Self::of(Frame { s: tangent, t: n.cross(tangent), n }, wo)
    }

    fn of(frame: Frame<f64>, wo: Vec3<f64>) -> Option<Self> {
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
