//! Polarised light: the Stokes vector that arrives at the eye, carried as a product of Mueller matrices.
//!
//! Light that an unpolarised source sends along a path arrives as S = M₁M₂…M_k·(L, 0, 0, 0). The path is walked from the eye,
//! so the product grows on its right. Each matrix is kept divided by its first element, which the scalar throughput has.
//!
//! **Frames.** Stokes components refer to a unit vector x at right angles to the ray and to y = k × x, k the direction in
//! which light travels: S₁ = I_x − I_y, S₂ = I₄₅ − I₋₄₅ (45° from x toward y), S₂ + iS₃ = 2E_x*E_y for fields that go as
//! exp(i(kz − ωt)). At a surface x is s, at right angles to the plane of incidence, before and after. A frame is turned to
//! the next by the double angle's cosine and sine, which are algebraic in those of the angle: no trigonometry.
//!
//! Diffuse surfaces depolarise. What a smooth interface or metal does follows from its complex amplitude ratios r_s, r_p or
//! t_s, t_p: with D = |a_s|² + |a_p|², a = (|a_s|² − |a_p|²)/D and c + id = 2a_s*a_p/D, the matrix over its first element is
//! ((1, a), (a, 1)) on (S₀, S₁) and the rotation ((c, −d), (d, c)) on (S₂, S₃).

use etalon_optics::{Lanes, Real, Vec3};

/// A surface's Mueller matrix over its first element, in the frame of the plane of incidence, at each wavelength.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Retarder<R, const N: usize> {
    /// Diattenuation, s over p.
    pub a: Lanes<R, N>,
    pub c: Lanes<R, N>,
    pub d: Lanes<R, N>,
}

/// Whether and how a path carries polarisation.
pub(crate) trait Polarisation<R: Real, const N: usize>: Copy {
    /// At the camera, whose picture's right is along `right`.
    fn at_camera(direction: Vec3<f64>, right: Vec3<f64>) -> Self;

    /// Unpolarised light comes in at the path's end and would be worth `light` if nothing polarised. Returns what it is
    /// worth in S₀.
    fn receive(&mut self, light: Lanes<R, N>) -> Lanes<R, N>;

    /// The path goes on from a surface that light leaves along `wo` and meets along −`wi`; `retarder` is what it does, `None`
    /// if it depolarises.
    fn follow(&mut self, wo: Vec3<f64>, wi: Vec3<f64>, retarder: impl FnOnce() -> Option<Retarder<R, N>>);

    /// S₁, S₂ and S₃ received so far, W·m⁻²·sr⁻¹·nm⁻¹; `None` if polarisation is not carried.
    fn received(&self) -> Option<[Lanes<R, N>; 3]>;
}

/// Light is taken for unpolarised at every surface.
#[derive(Clone, Copy)]
pub(crate) struct Averaged;

impl<R: Real, const N: usize> Polarisation<R, N> for Averaged {
    #[inline(always)]
    fn at_camera(_: Vec3<f64>, _: Vec3<f64>) -> Self {
        Self
    }

    #[inline(always)]
    fn receive(&mut self, light: Lanes<R, N>) -> Lanes<R, N> {
        light
    }

    #[inline(always)]
    fn follow(&mut self, _: Vec3<f64>, _: Vec3<f64>, _: impl FnOnce() -> Option<Retarder<R, N>>) {}

    fn received(&self) -> Option<[Lanes<R, N>; 3]> {
        None
    }
}

/// A Mueller matrix along the path.
#[derive(Clone, Copy)]
pub(crate) struct Mueller<R, const N: usize> {
    /// Columns of the product, each matrix over its first element; the rows are the camera's.
    columns: [[Lanes<R, N>; 4]; 4],
    /// The frame's x on the path's last ray.
    x: Vec3<f64>,
    received: [Lanes<R, N>; 3],
}

impl<R: Real, const N: usize> Polarisation<R, N> for Mueller<R, N> {
    fn at_camera(direction: Vec3<f64>, right: Vec3<f64>) -> Self {
        let columns = std::array::from_fn(|j| std::array::from_fn(|i| if i == j { Lanes::ONE } else { Lanes::ZERO }));
        Self { columns, x: across(right, direction), received: [Lanes::ZERO; 3] }
    }

    fn receive(&mut self, light: Lanes<R, N>) -> Lanes<R, N> {
        let [s0, others @ ..] = self.columns[0];
        (0..3).for_each(|i| self.received[i] += light * others[i]);
        light * s0
    }

    fn follow(&mut self, wo: Vec3<f64>, wi: Vec3<f64>, retarder: impl FnOnce() -> Option<Retarder<R, N>>) {
        let Some(Retarder { a, c, d }) = retarder() else {
            (1..4).for_each(|j| self.columns[j] = [Lanes::ZERO; 4]);
            // Any x will do where nothing is polarised.
            self.x = across(self.x, wi);
            return;
        };
        // At right angles to both; where they are parallel any vector across them is, the present x too.
        let normal = wo.cross(wi);
        let s = if normal.length_squared() > 0.0 { normal.normalized() } else { self.x };
        let (cos, sin) = (self.x.dot(s), self.x.dot(wo.cross(s)));
        let squared = cos * cos + sin * sin;
        let (cos_2, sin_2) = ((cos * cos - sin * sin) / squared, 2.0 * cos * sin / squared);
        let [n0, n1, n2, n3] = self.columns;
        let combine = |u: [Lanes<R, N>; 4], p: Lanes<R, N>, v: [Lanes<R, N>; 4], q: Lanes<R, N>| {
            std::array::from_fn::<_, 4, _>(|i| u[i] * p + v[i] * q)
        };
        let (cos_2, sin_2) = (Lanes::splat(R::from_f64(cos_2)), Lanes::splat(R::from_f64(sin_2)));
        let (m1, m2) = (combine(n1, cos_2, n2, Lanes::ZERO - sin_2), combine(n1, sin_2, n2, cos_2));
        self.columns = [
            combine(n0, Lanes::ONE, m1, a),
            combine(n0, a, m1, Lanes::ONE),
            combine(m2, c, n3, d),
            combine(m2, Lanes::ZERO - d, n3, c),
        ];
        self.x = across(s, wi);
    }

    fn received(&self) -> Option<[Lanes<R, N>; 3]> {
        Some(self.received)
    }
}

/// The unit vector at right angles to `direction` that is nearest to `v`; any, if `v` is along it.
fn across(v: Vec3<f64>, direction: Vec3<f64>) -> Vec3<f64> {
    let rest = v - direction * direction.dot(v);
    let length = rest.length_squared();
    if length > f64::UNIT_ROUNDOFF {
        rest * (1.0 / length.sqrt())
    } else {
        etalon_optics::Frame::from_normal(direction).to_world(Vec3::new(1.0, 0.0, 0.0))
    }
}

/// A complex number.
#[derive(Clone, Copy)]
struct Complex(f64, f64);

impl Complex {
    fn over(self, o: Self) -> Self {
        let d = o.0 * o.0 + o.1 * o.1;
        Self((self.0 * o.0 + self.1 * o.1) / d, (self.1 * o.0 - self.0 * o.1) / d)
    }

    fn times(self, o: Self) -> Self {
        Self(self.0 * o.0 - self.1 * o.1, self.0 * o.1 + self.1 * o.0)
    }

    fn plus(self, o: Self) -> Self {
        Self(self.0 + o.0, self.1 + o.1)
    }

    fn minus(self, o: Self) -> Self {
        Self(self.0 - o.0, self.1 - o.1)
    }

    fn squared(self) -> f64 {
        self.0 * self.0 + self.1 * self.1
    }
}

/// (a, c, d) of two complex amplitudes.
fn of_amplitudes(s: Complex, p: Complex) -> [f64; 3] {
    let (ss, pp) = (s.squared(), p.squared());
    let sum = ss + pp;
    if sum == 0.0 {
        // Nothing is reflected: no light, whatever its state.
        return [0.0, 1.0, 0.0];
    }
    let product = Complex(s.0, -s.1).times(p);
    [(ss - pp) / sum, 2.0 * product.0 / sum, 2.0 * product.1 / sum]
}

/// Reflection at an interface of relative index `eta`, total or not.
///
/// Beyond the critical angle the refracted wave decays: n·cos_t = i√(sin² − n²) (Born & Wolf, *Principles of Optics*, §1.5.4).
pub(crate) fn dielectric_reflection(cos: f64, eta: f64) -> [f64; 3] {
    match etalon_optics::fresnel::dielectric(cos, eta) {
        Some(fresnel) => of_amplitudes(Complex(fresnel.r_s, 0.0), Complex(fresnel.r_p, 0.0)),
        None => {
            let g = ((1.0 - cos) * (1.0 + cos) - eta * eta).max(0.0).sqrt();
            let ratio = |real: f64| Complex(real, -g).over(Complex(real, g));
            of_amplitudes(ratio(cos), ratio(eta * eta * cos))
        }
    }
}

/// Transmission through an interface of relative index `eta`, met at `cos` and left at `cos_t`: t_s : t_p = 1/k : 1/l with
/// k = c + n·c_t and l = n·c + c_t.
pub(crate) fn dielectric_transmission(cos: f64, eta: f64, cos_t: f64) -> [f64; 3] {
    let (k, l) = (cos + eta * cos_t, eta * cos + cos_t);
    of_amplitudes(Complex(l, 0.0), Complex(k, 0.0))
}

/// Reflection at a metal of relative index `n` + i`k`, from r_s = (c − q)/(c + q) and r_p = (m²c − q)/(m²c + q) with m = n + ik
/// and q = √(m² − sin²), its real part not negative.
pub(crate) fn conductor_reflection(cos: f64, n: f64, k: f64) -> [f64; 3] {
    let m2 = Complex((n - k) * (n + k), 2.0 * n * k);
    let w = Complex(m2.0 - (1.0 - cos) * (1.0 + cos), m2.1);
    let length = w.squared().sqrt();
    let larger = (0.5 * (length + w.0.abs())).sqrt();
    let smaller = if larger == 0.0 { 0.0 } else { 0.5 * w.1 / larger };
    let q = if w.0 >= 0.0 { Complex(larger, smaller) } else { Complex(smaller, larger) };
    let ratio = |u: Complex| u.minus(q).over(u.plus(q));
    of_amplitudes(ratio(Complex(cos, 0.0)), ratio(Complex(m2.0 * cos, m2.1 * cos)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stokes(m: [f64; 3], s: [f64; 4]) -> [f64; 4] {
        let [a, c, d] = m;
        [s[0] + a * s[1], a * s[0] + s[1], c * s[2] - d * s[3], d * s[2] + c * s[3]]
    }

    /// A matrix is physical if it takes no fully polarised light beyond full polarisation; for these, if a² + c² + d² = 1.
    #[test]
    fn every_matrix_is_physical_and_pure() {
        for i in 1..=1000 {
            let cos = f64::from(i) / 1000.0;
            for n in [0.4, 0.7, 1.33, 1.5, 2.4] {
                let mut all = vec![
                    dielectric_reflection(cos, n),
                    conductor_reflection(cos, n, 0.3),
                    conductor_reflection(cos, n, 6.0),
                ];
                if let Some(f) = etalon_optics::fresnel::dielectric(cos, n) {
                    all.push(dielectric_transmission(cos, n, f.cos_t));
                }
                for m in all {
                    assert!((m[0] * m[0] + m[1] * m[1] + m[2] * m[2] - 1.0).abs() < 1e-12, "{cos} {n}: {m:?}");
                }
            }
        }
    }

    #[test]
    fn brewster_polarises_all_that_it_reflects() {
        let n = 1.5_f64;
        let cos = 1.0 / (1.0 + n * n).sqrt();
        let reflected = stokes(dielectric_reflection(cos, n), [1.0, 0.0, 0.0, 0.0]);
        assert!((reflected[1] - 1.0).abs() < 1e-14 && (reflected[0] - 1.0).abs() < 1e-14);
    }

    /// Fresnel's rhomb: two total reflections in glass of 1.51 at 54°37′ (Born & Wolf, §1.5.4) turn light at 45° into circular light, since each
    /// delays p against s by 45°: tan(δ/2) = cos·√(sin² − 1/n²)/sin².
    #[test]
    fn two_total_reflections_of_a_rhomb_make_linear_light_circular() {
        let n = 1.51_f64;
        // sin² at which δ = 45°: tan²(22.5°)·s⁴ = (1 − s²)(s² − 1/n²), the larger root.
        let t2 = (std::f64::consts::FRAC_PI_8).tan().powi(2);
        let (p, q) = (1.0 + 1.0 / (n * n), 1.0 / (n * n));
        let sin2 = (p + (p * p - 4.0 * (1.0 + t2) * q).sqrt()) / (2.0 * (1.0 + t2));
        let minutes = sin2.sqrt().asin().to_degrees() * 60.0;
        assert!((minutes - (54.0 * 60.0 + 37.0)).abs() < 0.5, "{minutes}");
        let m = dielectric_reflection((1.0 - sin2).sqrt(), 1.0 / n);
        let [s0, s1, s2, s3] = stokes(m, stokes(m, [1.0, 0.0, 1.0, 0.0]));
        assert!((s0 - 1.0).abs() < 1e-12 && s1.abs() < 1e-12 && s2.abs() < 1e-9 && (s3.abs() - 1.0).abs() < 1e-9);
        // The mutant: a total reflection without its phase leaves the light linear.
        let [.., mutant] = stokes([0.0, -1.0, 0.0], [1.0, 0.0, 1.0, 0.0]);
        assert_eq!(mutant, 0.0);
    }

    #[test]
    fn metals_have_the_reflectances_of_fresnel_and_the_phases_of_a_limit() {
        for (cos, n, k) in [(0.3, 0.2, 3.4), (0.8, 1.5, 0.0), (0.05, 2.0, 4.0)] {
            let f = etalon_optics::fresnel::conductor(cos, n, k);
            let m = conductor_reflection(cos, n, k);
            let a = (f.reflectance_s - f.reflectance_p) / (f.reflectance_s + f.reflectance_p);
            assert!((m[0] - a).abs() < 1e-12, "{m:?} {a}");
        }
        // A perfect conductor is the ideal mirror; one without absorption is glass.
        let mirror = conductor_reflection(0.4, 1e-9, 1e6);
        assert!((mirror[1] + 1.0).abs() < 1e-5 && mirror[2].abs() < 1e-5, "{mirror:?}");
        let (glass, same) = (dielectric_reflection(0.4, 1.5), conductor_reflection(0.4, 1.5, 0.0));
        (0..3).for_each(|i| assert!((glass[i] - same[i]).abs() < 1e-13, "{glass:?} {same:?}"));
    }

    /// Malus: between two surfaces that each pass s alone, whose planes of incidence differ by an angle, cos² of it passes.
    #[test]
    fn crossed_polarisers_obey_malus_and_a_frame_that_is_not_turned_does_not() {
        let pure = || Some(Retarder::<f64, 1> { a: Lanes::ONE, c: Lanes::ZERO, d: Lanes::ZERO });
        for angle in [0.0_f64, 0.3, 1.0, std::f64::consts::FRAC_PI_2] {
            let up = Vec3::new(0.0, 0.0, 1.0);
            let mut light = Mueller::<f64, 1>::at_camera(-up, Vec3::new(1.0, 0.0, 0.0));
            // Reflections at 45°: up, aside, up again, the second plane turned by the angle.
            let aside = Vec3::new(angle.cos(), angle.sin(), 0.0);
            light.follow(up, Vec3::new(1.0, 0.0, 0.0), pure);
            light.follow(-Vec3::new(1.0, 0.0, 0.0), up, pure);
            light.follow(-up, aside, pure);
            let s0 = light.receive(Lanes::ONE)[0];
            // Three matrices over their first elements, each ½ of the light: 1·1·2cos²·… the first two are parallel.
            assert!((s0 - 4.0 * angle.cos().powi(2)).abs() < 1e-12, "{angle}: {s0}");
        }
    }
}
