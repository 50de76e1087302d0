//! Interfaces with thin films, twice: by the reflections between faces, layer after layer (Rouard 1937, after Airy 1833), and by the
//! wave equation, integrated through the layers in small steps.

use std::f64::consts::TAU;

/// A complex number.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Wave {
    re: f64,
    im: f64,
}

const fn wave(re: f64, im: f64) -> Wave {
    Wave { re, im }
}

impl Wave {
    fn plus(self, o: Self) -> Self {
        wave(self.re + o.re, self.im + o.im)
    }

    fn minus(self, o: Self) -> Self {
        wave(self.re - o.re, self.im - o.im)
    }

    fn times(self, o: Self) -> Self {
        wave(self.re * o.re - self.im * o.im, self.re * o.im + self.im * o.re)
    }

    fn over(self, o: Self) -> Self {
        let squared = o.re * o.re + o.im * o.im;
        let product = self.times(wave(o.re, -o.im));
        wave(product.re / squared, product.im / squared)
    }

    /// By polar coordinates; of arguments in the upper half plane, into the first quadrant. Of a real number it is real or imaginary.
    fn root(self) -> Self {
        if self.im == 0.0 {
            let root = self.re.abs().sqrt();
            return if self.re < 0.0 { wave(0.0, root) } else { wave(root, 0.0) };
        }
        let (length, angle) = (self.re.hypot(self.im).sqrt(), 0.5 * self.im.atan2(self.re));
        wave(length * angle.cos(), length * angle.sin())
    }

    /// e^(i·self).
    fn phase(self) -> Self {
        let decay = (-self.im).exp();
        wave(decay * self.re.cos(), decay * self.re.sin())
    }
}

/// A layer: n, k, and its thickness in nm.
pub type FilmLayer = [f64; 3];

/// An interface between a transparent medium and another medium, with layers from the outermost to the innermost.
#[derive(Clone, Debug, PartialEq)]
pub struct CoatedInterface {
    /// Index on the side that light comes from.
    pub incident: f64,
    /// The layers, met in this order.
    pub layers: Vec<FilmLayer>,
    /// n and k behind them.
    pub substrate: [f64; 2],
}

/// Complex amplitudes of s and p, real and imaginary parts, in fields that run as e^(−iωt). Squares are shares of power; r_p = −r_s at
/// normal incidence on a bare interface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmWaves {
    /// Reflected.
    pub reflected: [[f64; 2]; 2],
    /// Transmitted.
    pub transmitted: [[f64; 2]; 2],
}

impl FilmWaves {
    /// Share of unpolarised light that is reflected.
    #[must_use]
    pub fn reflectance(&self) -> f64 {
        0.5 * self.reflected.as_flattened().iter().map(|part| part * part).sum::<f64>()
    }

    /// Share that is transmitted.
    #[must_use]
    pub fn transmittance(&self) -> f64 {
        0.5 * self.transmitted.as_flattened().iter().map(|part| part * part).sum::<f64>()
    }
}

impl CoatedInterface {
    /// Of one layer between two transparent media.
    #[must_use]
    pub fn single(incident: f64, layer: FilmLayer, substrate: f64) -> Self {
        Self { incident, layers: vec![layer], substrate: [substrate, 0.0] }
    }

    /// The same seen from behind, where the substrate is transparent.
    #[must_use]
    pub fn from_behind(&self) -> Self {
        let layers = self.layers.iter().rev().copied().collect();
        Self { incident: self.substrate[0], layers, substrate: [self.incident, 0.0] }
    }

    /// (n + ik)², and the normal component q of the wave in units of its number in vacuum, of light that runs at the cosine `cos` in a
    /// medium of the index `of`.
    fn medium([n, k]: [f64; 2], [of, cos]: [f64; 2]) -> (Wave, Wave) {
        let square = wave(n, k).times(wave(n, k));
        let known = of * of;
        // q² = (n + ik)² − n₁²(1 − cos²), in an order that keeps every digit of cos in the medium where it is known.
        (square, square.minus(wave(known, 0.0)).plus(wave(known * cos * cos, 0.0)).root())
    }

    /// By the waves that go to and fro in each layer, from the innermost outward.
    #[must_use]
    pub fn waves(&self, wavelength_nm: f64, cos: f64) -> FilmWaves {
        self.waves_along(wavelength_nm, [self.incident, cos])
    }

    /// The same for light whose cosine is known behind the layers, where it leaves into a transparent medium.
    #[must_use]
    pub fn waves_leaving(&self, wavelength_nm: f64, cos: f64) -> FilmWaves {
        self.waves_along(wavelength_nm, [self.substrate[0], cos])
    }

    fn waves_along(&self, wavelength_nm: f64, known: [f64; 2]) -> FilmWaves {
        let outside = [self.incident, 0.0];
        let faces: Vec<[f64; 2]> = std::iter::once(outside)
            .chain(self.layers.iter().map(|[n, k, _]| [*n, *k]))
            .chain([self.substrate])
            .collect();
        let of = |p: bool| {
            // Amplitudes at the face between two media: of E for s, of H for p.
            let face = |from: [f64; 2], to: [f64; 2]| {
                let ((m1, q1), (m2, q2)) = (Self::medium(from, known), Self::medium(to, known));
                let (a, b) = if p { (m2.times(q1), m1.times(q2)) } else { (q1, q2) };
                (a.minus(b).over(a.plus(b)), a.plus(a).over(a.plus(b)))
            };
            let last = faces.len() - 1;
            let (mut r, mut t) = face(faces[last - 1], faces[last]);
            for (j, [n, k, thickness]) in self.layers.iter().enumerate().rev() {
                let (_, q) = Self::medium([*n, *k], known);
                let way = wave(TAU * thickness / wavelength_nm, 0.0).times(q);
                let (once, twice) = (way.phase(), way.plus(way).phase());
                let (r_face, t_face) = face(faces[j], faces[j + 1]);
                let orders = wave(1.0, 0.0).plus(r_face.times(r).times(twice));
                t = t_face.times(t).times(once).over(orders);
                r = r_face.plus(r.times(twice)).over(orders);
            }
            (r, t.times(wave(self.power_scale(p, known), 0.0)))
        };
        Self::gathered(of(false), of(true))
    }

    /// √ of the power that a transmitted amplitude of 1 carries, over that of an incident one.
    fn power_scale(&self, p: bool, known: [f64; 2]) -> f64 {
        let carried = |medium: [f64; 2]| {
            let (m2, q) = Self::medium(medium, known);
            if p { q.over(m2).re } else { q.re }
        };
        (carried(self.substrate) / carried([self.incident, 0.0])).max(0.0).sqrt()
    }

    fn gathered((r_s, t_s): (Wave, Wave), (r_p, t_p): (Wave, Wave)) -> FilmWaves {
        let parts = |wave: Wave| [wave.re, wave.im];
        FilmWaves { reflected: [parts(r_s), parts(r_p)], transmitted: [parts(t_s), parts(t_p)] }
    }

    /// By the wave equation, integrated from behind the layers to before them by the classical rule of fourth order: with z in units of
    /// λ/2π, E′ = iG, G′ = iq²E for s and H′ = im²G, G′ = i(q²/m²)H for p.
    #[must_use]
    pub fn by_wave_equation(&self, wavelength_nm: f64, cos: f64) -> FilmWaves {
        let of = |p: bool| {
            let known = [self.incident, cos];
            let (m2, q) = Self::medium(self.substrate, known);
            let mut fields = [wave(1.0, 0.0), if p { q.over(m2) } else { q }];
            for [n, k, thickness] in self.layers.iter().rev() {
                let (m2, q) = Self::medium([*n, *k], known);
                let q2 = q.times(q);
                let (of_f, of_g) = if p { (m2, q2.over(m2)) } else { (wave(1.0, 0.0), q2) };
                let depth = TAU * thickness / wavelength_nm;
                let steps = (depth * 400.0).ceil().max(1.0);
                // Toward the light.
                let h = -depth / steps;
                let slope =
                    |[f, g]: [Wave; 2]| [wave(0.0, 1.0).times(of_f).times(g), wave(0.0, 1.0).times(of_g).times(f)];
                let moved = |[f, g]: [Wave; 2], [df, dg]: [Wave; 2], by: f64| {
                    [f.plus(df.times(wave(by, 0.0))), g.plus(dg.times(wave(by, 0.0)))]
                };
                for _ in 0..steps as u64 {
                    let a = slope(fields);
                    let b = slope(moved(fields, a, 0.5 * h));
                    let c = slope(moved(fields, b, 0.5 * h));
                    let d = slope(moved(fields, c, h));
                    for (slopes, weight) in [(a, 1.0), (b, 2.0), (c, 2.0), (d, 1.0)] {
                        fields = moved(fields, slopes, h * weight / 6.0);
                    }
                }
            }
            // What arrives, and what goes back.
            let u = if p { cos / self.incident } else { self.incident * cos };
            let f = fields[0].times(wave(u, 0.0));
            let sum = f.plus(fields[1]);
            let t = wave(2.0 * u, 0.0).over(sum);
            (f.minus(fields[1]).over(sum), t.times(wave(self.power_scale(p, known), 0.0)))
        };
        Self::gathered(of(false), of(true))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stacks() -> Vec<CoatedInterface> {
        let of = |incident, layers: &[FilmLayer], substrate| CoatedInterface {
            incident,
            layers: layers.to_vec(),
            substrate,
        };
        vec![
            of(1.0, &[[1.38, 0.0, 99.6]], [1.5, 0.0]),
            of(1.0, &[[2.35, 0.0, 60.0], [1.46, 0.0, 90.0]], [1.52, 0.0]),
            of(1.0, &[[2.4, 0.0, 60.0]], [2.2, 2.9]),
            of(1.52, &[[0.3, 2.8, 15.0], [1.46, 0.0, 90.0]], [1.0, 0.0]),
            of(1.5, &[[1.0, 0.0, 100.0]], [1.5, 0.0]),
        ]
    }

    #[test]
    fn reflections_between_faces_solve_the_wave_equation() {
        for stack in stacks() {
            for cos in [1.0, 0.8, 0.5, 0.3] {
                let (a, b) = (stack.waves(520.0, cos), stack.by_wave_equation(520.0, cos));
                for (x, y) in [(a.reflected, b.reflected), (a.transmitted, b.transmitted)] {
                    for (x, y) in x.as_flattened().iter().zip(y.as_flattened()) {
                        assert!((x - y).abs() < 1e-8, "{stack:?} {cos}: {a:?} {b:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn what_absorbs_nothing_loses_nothing_and_both_ways_pass_as_much() {
        for stack in stacks().into_iter().filter(|stack| stack.substrate[1] == 0.0) {
            let cos: f64 = 0.9;
            let sin = stack.incident / stack.substrate[0] * (1.0 - cos * cos).sqrt();
            let (there, back) = (stack.waves(520.0, cos), stack.from_behind().waves(520.0, (1.0 - sin * sin).sqrt()));
            assert!((there.transmittance() - back.transmittance()).abs() < 1e-12);
            if stack.layers.iter().all(|layer| layer[1] == 0.0) {
                assert!((there.reflectance() + there.transmittance() - 1.0).abs() < 1e-13);
            }
        }
    }
}
