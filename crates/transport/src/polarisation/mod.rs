//! Polarised light: the Stokes vector that arrives at the eye, carried as a product of Mueller matrices.
//!
//! Light that an unpolarised source sends along a path arrives as S = M₁M₂…M_k·(L, 0, 0, 0). The path is walked from the eye,
//! so the product grows on its right. Each matrix is kept divided by its first element, which the scalar throughput has.
//!
//! **Frames.** Stokes components refer to a unit vector x at right angles to the ray and to y = k × x, k the direction in
//! which light travels: S₁ = I_x − I_y, S₂ = I₄₅ − I₋₄₅ (45° from x toward y), S₃ is right-handed less left-handed light as
//! Born & Wolf (§1.4.2) have it, clockwise seen against the light: S₂ + iS₃ = 2E_xE_y* for fields that go as exp(i(kz − ωt)).
//! A frame is turned to the next by the double angle's cosine and sine, which are algebraic in those of the angle: no
//! trigonometry.
//!
//! What surfaces do is in [`mueller`].

pub mod mueller;

use etalon_optics::{Frame, Lanes, Real, Vec3};
use mueller::Mueller;

/// Whether and how a path carries polarisation.
pub trait Polarisation<const N: usize>: Copy {
    /// Whether it does.
    const FOLLOWED: bool;

    /// At the camera, whose picture's right is along `right`.
    fn at_camera(direction: Vec3<f64>, right: Vec3<f64>) -> Self;

    /// Unpolarised light comes in at the path's end and would be worth `light` if nothing polarised. Returns what it is
    /// worth in S₀.
    fn receive(&mut self, light: Lanes<f64, N>) -> Lanes<f64, N>;

    /// The path goes on from a surface that light leaves along `wo` and meets along −`wi`; `mueller` is what it does, `None`
    /// if it depolarises.
    fn follow(&mut self, wo: Vec3<f64>, wi: Vec3<f64>, mueller: impl FnOnce() -> Option<Mueller<N>>);

    /// As [`Polarisation::receive`], of light that comes along −`wi` to a surface at the path's end.
    fn receive_scattered(
        &mut self,
        wo: Vec3<f64>,
        wi: Vec3<f64>,
        mueller: impl FnOnce() -> Option<Mueller<N>>,
        light: Lanes<f64, N>,
    ) -> Lanes<f64, N>;

    /// What linearly polarised light that comes along the path's last ray is worth, with the lanes weighed by their throughput; `None` if
    /// polarisation is not carried.
    fn linear_worth(&self, beta: &Lanes<f64, N>) -> Option<LinearWorth>;

    /// Divides what is carried by what unpolarised light is worth in S₀, and returns that, for the throughput.
    fn normalise(&mut self) -> Lanes<f64, N>;

    /// What one unit of unpolarised light that comes in at the path's end is worth in S₀, S₁, S₂ and S₃.
    fn of_unpolarised(&self) -> [Lanes<f64, N>; 4];

    /// Receives S₁, S₂ and S₃ that were worked out elsewhere.
    fn record(&mut self, stokes: [Lanes<f64, N>; 3]);

    /// S₁, S₂ and S₃ received so far, W·m⁻²·sr⁻¹·nm⁻¹; `None` if polarisation is not carried.
    fn received(&self) -> Option<[Lanes<f64, N>; 3]>;
}

/// What S₁ and S₂ of light on a ray are worth in S₀ at the camera.
#[derive(Clone, Copy, Debug)]
pub struct LinearWorth {
    /// Over what S₀ is worth.
    pub s: [f64; 2],
    /// The x of their frame: a unit vector at right angles to the ray.
    pub x: Vec3<f64>,
}

/// Light is taken for unpolarised at every surface.
#[derive(Clone, Copy)]
pub struct Averaged;

impl<const N: usize> Polarisation<N> for Averaged {
    const FOLLOWED: bool = false;

    #[inline(always)]
    fn at_camera(_: Vec3<f64>, _: Vec3<f64>) -> Self {
        Self
    }

    #[inline(always)]
    fn receive(&mut self, light: Lanes<f64, N>) -> Lanes<f64, N> {
        light
    }

    #[inline(always)]
    fn follow(&mut self, _: Vec3<f64>, _: Vec3<f64>, _: impl FnOnce() -> Option<Mueller<N>>) {}

    #[inline(always)]
    fn receive_scattered(
        &mut self,
        _: Vec3<f64>,
        _: Vec3<f64>,
        _: impl FnOnce() -> Option<Mueller<N>>,
        light: Lanes<f64, N>,
    ) -> Lanes<f64, N> {
        light
    }

    #[inline(always)]
    fn linear_worth(&self, _: &Lanes<f64, N>) -> Option<LinearWorth> {
        None
    }

    #[inline(always)]
    fn normalise(&mut self) -> Lanes<f64, N> {
        Lanes::ONE
    }

    fn of_unpolarised(&self) -> [Lanes<f64, N>; 4] {
        [Lanes::ONE, Lanes::ZERO, Lanes::ZERO, Lanes::ZERO]
    }

    fn record(&mut self, _: [Lanes<f64, N>; 3]) {}

    fn received(&self) -> Option<[Lanes<f64, N>; 3]> {
        None
    }
}

/// Followed by the product of the path's Mueller matrices.
#[derive(Clone, Copy)]
pub struct Followed<const N: usize> {
    /// Columns of the product, each matrix over its first element; the rows are the camera's.
    columns: [[Lanes<f64, N>; 4]; 4],
    /// The frame's x on the path's last ray.
    x: Vec3<f64>,
    received: [Lanes<f64, N>; 3],
}

impl<const N: usize> Polarisation<N> for Followed<N> {
    const FOLLOWED: bool = true;

    fn at_camera(direction: Vec3<f64>, right: Vec3<f64>) -> Self {
        let columns = std::array::from_fn(|j| std::array::from_fn(|i| if i == j { Lanes::ONE } else { Lanes::ZERO }));
        Self { columns, x: across(right, direction), received: [Lanes::ZERO; 3] }
    }

    fn receive(&mut self, light: Lanes<f64, N>) -> Lanes<f64, N> {
        let [s0, others @ ..] = self.columns[0];
        (0..3).for_each(|i| self.received[i] += light * others[i]);
        light * s0
    }

    fn follow(&mut self, wo: Vec3<f64>, wi: Vec3<f64>, mueller: impl FnOnce() -> Option<Mueller<N>>) {
        let Some(Mueller { rows, x }) = mueller() else {
            (1..4).for_each(|j| self.columns[j] = [Lanes::ZERO; 4]);
            // Any x will do where nothing is polarised.
            self.x = across(self.x, wi);
            return;
        };
        let left = across(x, wo);
        let (cos, sin) = (self.x.dot(left), self.x.dot(wo.cross(left)));
        let squared = cos * cos + sin * sin;
        let (cos_2, sin_2) = ((cos * cos - sin * sin) / squared, 2.0 * cos * sin / squared);
        // From the frame of the surface to that of the ray.
        let [n0, n1, n2, n3] = self.columns;
        let turned: [[Lanes<f64, N>; 4]; 4] = [
            n0,
            std::array::from_fn(|i| n1[i] * cos_2 - n2[i] * sin_2),
            std::array::from_fn(|i| n1[i] * sin_2 + n2[i] * cos_2),
            n3,
        ];
        self.columns = std::array::from_fn(|j| {
            std::array::from_fn(|i| {
                turned[0][i] * rows[0][j]
                    + turned[1][i] * rows[1][j]
                    + turned[2][i] * rows[2][j]
                    + turned[3][i] * rows[3][j]
            })
        });
        self.x = across(x, wi);
    }

    fn receive_scattered(
        &mut self,
        wo: Vec3<f64>,
        wi: Vec3<f64>,
        mueller: impl FnOnce() -> Option<Mueller<N>>,
        light: Lanes<f64, N>,
    ) -> Lanes<f64, N> {
        let mut aside = *self;
        aside.follow(wo, wi, mueller);
        let received = aside.receive(light);
        self.received = aside.received;
        received
    }

    fn linear_worth(&self, beta: &Lanes<f64, N>) -> Option<LinearWorth> {
        let [s0, s1, s2] = [0, 1, 2].map(|j| (self.columns[j][0] * *beta).sum());
        Some(LinearWorth { s: [s1, s2].map(|s| if s0 > 0.0 { s / s0 } else { 0.0 }), x: self.x })
    }

    fn normalise(&mut self) -> Lanes<f64, N> {
        let s0 = self.columns[0][0];
        // Where unpolarised light is worth nothing no light is: a Mueller matrix takes no light beyond full polarisation.
        let over = Lanes::from_fn(|lane| if s0[lane] > 0.0 { 1.0 / s0[lane] } else { 0.0 });
        self.columns = self.columns.map(|column| column.map(|row| row * over));
        s0
    }

    fn of_unpolarised(&self) -> [Lanes<f64, N>; 4] {
        self.columns[0]
    }

    fn record(&mut self, stokes: [Lanes<f64, N>; 3]) {
        (0..3).for_each(|i| self.received[i] += stokes[i]);
    }

    fn received(&self) -> Option<[Lanes<f64, N>; 3]> {
        Some(self.received)
    }
}

/// The unit vector at right angles to the unit vector `direction` that is nearest to `v`; any, if `v` is along it.
pub(crate) fn across(v: Vec3<f64>, direction: Vec3<f64>) -> Vec3<f64> {
    let rest = v - direction * direction.dot(v);
    let length = rest.length_squared();
    if length > f64::UNIT_ROUNDOFF * v.length_squared() {
        rest * (1.0 / length.sqrt())
    } else {
        Frame::from_normal(direction).to_world(Vec3::new(1.0, 0.0, 0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn linear(degrees: f64) -> Vec3<f64> {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Vec3::new(cos, sin, 0.0)
    }

    /// What comes to an eye that looks along −z, its right along +x, through plates one behind the other, each a matrix over its
    /// first element and the direction of its x, the one next to the eye first.
    fn through(plates: &[([f64; 2], Vec3<f64>)]) -> [f64; 4] {
        let toward_eye = Vec3::new(0.0, 0.0, 1.0);
        let mut light = Followed::<1>::at_camera(-toward_eye, Vec3::new(1.0, 0.0, 0.0));
        for &([a, retardance], x) in plates {
            let (sin, cos) = retardance.sin_cos();
            let rest = (1.0 - a * a).sqrt();
            let matrix = mueller::pair(a, rest * cos, -rest * sin);
            light.follow(toward_eye, -toward_eye, || Some(Mueller::of([matrix], x)));
        }
        let s0 = light.receive(Lanes::ONE)[0];
        let [s1, s2, s3] = light.received().expect("carried").map(|lanes| lanes[0]);
        [s0, s1, s2, s3]
    }

    /// Malus: between two polarisers whose axes differ by an angle, cos² of it passes; three pass cos² sin² of what one does.
    #[test]
    fn polarisers_obey_malus_and_a_frame_that_is_not_turned_does_not() {
        for degrees in [0.0_f64, 20.0, 60.0, 90.0, 135.0] {
            let cos2 = degrees.to_radians().cos().powi(2);
            let [s0, s1, s2, s3] = through(&[([1.0, 0.0], linear(degrees)), ([1.0, 0.0], linear(0.0))]);
            // Over their first elements two matrices make 1 + cos 2θ.
            assert!((s0 - 2.0 * cos2).abs() < 1e-12 && s3.abs() < 1e-12, "{degrees}: {s0}");
            // What leaves is along the axis of the plate next to the eye.
            let (sin_2, cos_2) = (2.0 * degrees.to_radians()).sin_cos();
            assert!((s1 - s0 * cos_2).abs() < 1e-12 && (s2 - s0 * sin_2).abs() < 1e-12, "{degrees}: {s1} {s2}");
            let [three, ..] =
                through(&[([1.0, 0.0], linear(90.0)), ([1.0, 0.0], linear(degrees)), ([1.0, 0.0], linear(0.0))]);
            assert!((three - 4.0 * cos2 * (1.0 - cos2)).abs() < 1e-12, "{degrees}: {three}");
        }
    }

    /// A quarter-wave plate, fast along x, delays y: light at +45° to it turns anticlockwise seen against the light, which is
    /// left-handed; one at −45° the other way, and two of them are a half-wave plate, which mirrors the plane.
    #[test]
    fn a_quarter_wave_plate_makes_light_circular_with_the_right_hand() {
        use std::f64::consts::FRAC_PI_2;
        for (degrees, hand) in [(45.0, -1.0), (-45.0, 1.0)] {
            let [s0, s1, s2, s3] = through(&[([0.0, FRAC_PI_2], linear(0.0)), ([1.0, 0.0], linear(degrees))]);
            assert!((s0 - 1.0).abs() < 1e-12 && s1.abs() < 1e-12 && s2.abs() < 1e-12 && (s3 - hand).abs() < 1e-12);
        }
        let quarter = ([0.0, FRAC_PI_2], linear(0.0));
        let [_, s1, s2, s3] = through(&[quarter, quarter, ([1.0, 0.0], linear(30.0))]);
        let (sin, cos) = (-60.0_f64).to_radians().sin_cos();
        assert!((s1 - cos).abs() < 1e-12 && (s2 - sin).abs() < 1e-12 && s3.abs() < 1e-12, "{s1} {s2} {s3}");
    }

    /// Between two surfaces that each reflect s alone, whose planes of incidence differ by an angle, cos² of it passes.
    #[test]
    fn reflections_in_planes_at_an_angle_obey_malus() {
        for angle in [0.0_f64, 0.3, 1.0, std::f64::consts::FRAC_PI_2] {
            let up = Vec3::new(0.0, 0.0, 1.0);
            let mut light = Followed::<1>::at_camera(-up, Vec3::new(1.0, 0.0, 0.0));
            // Reflections at 45°: up, aside, up again, the second plane turned by the angle.
            let first = Vec3::new(1.0, 0.0, 0.0);
            let aside = Vec3::new(angle.cos(), angle.sin(), 0.0);
            for (wo, wi) in [(up, first), (-first, up), (-up, aside)] {
                light.follow(wo, wi, || Some(Mueller::of([mueller::pair(1.0, 0.0, 0.0)], wo.cross(wi))));
            }
            let s0 = light.receive(Lanes::ONE)[0];
            // Three matrices over their first elements, the first two parallel: 2·2cos².
            assert!((s0 - 4.0 * angle.cos().powi(2)).abs() < 1e-12, "{angle}: {s0}");
        }
    }
}
