//! Lenses of many surfaces: their shape, and what paraxial optics says of them.

use etalon_optics::RefractiveIndex;

/// A lens whose surfaces are centred on one axis, in air, before a film.
#[derive(Clone, Debug, PartialEq)]
pub struct CompoundLens {
    /// From the scene to the film; exactly one is the stop.
    pub surfaces: Vec<LensSurface>,
    /// What coats the glass.
    pub coating: LensCoating,
    /// From the vertex of the last surface to the film, m; above 0.
    pub film_distance_m: f64,
    /// Height of the film, m.
    pub film_height_m: f64,
    /// The wavelength for which the film is focused and the exposure stated, nm: the helium line d, or what is nearest to it among the
    /// wavelengths that are rendered.
    pub reference_nm: f64,
}

/// A surface of a lens.
///
/// Its sag, which counts from the vertex toward the film, is s(ρ) = cρ²/(1 + √(1 − (1 + κ)c²ρ²)) + Σ A₂ₖρ²ᵏ, k from 2, at the distance ρ
/// from the axis.
#[derive(Clone, Debug, PartialEq)]
pub struct LensSurface {
    /// Curvature c at the vertex, m⁻¹: positive where the centre lies toward the film, 0 where it is flat.
    pub curvature_per_m: f64,
    /// Conic constant κ: 0 is a sphere, −1 a paraboloid.
    pub conic: f64,
    /// A₄, A₆, A₈ …, m⁻³, m⁻⁵, m⁻⁷ ….
    pub aspheric: Vec<f64>,
    /// From its vertex to that of the next surface, m; 0 for the last.
    pub thickness_m: f64,
    /// What is behind it, toward the film.
    pub medium: RefractiveIndex,
    /// The largest distance from the axis at which light passes, m.
    pub semi_aperture_m: f64,
    /// Whether its aperture is the stop of the lens.
    pub is_stop: bool,
}

/// What coats the surfaces of a lens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LensCoating {
    /// Nothing: each interface reflects a part of the light, by Fresnel's equations.
    Bare,
    /// A coating that reflects nothing.
    Ideal,
}

/// An axial ray matrix: it takes (y, n·u) of a paraxial ray, u its slope, from one plane to another.
#[derive(Clone, Copy, Debug, PartialEq)]
struct RayMatrix([[f64; 2]; 2]);

impl RayMatrix {
    const NOTHING: Self = Self([[1.0, 0.0], [0.0, 1.0]]);

    /// This one after `first`.
    fn after(self, first: Self) -> Self {
        let (a, b) = (self.0, first.0);
        Self([0, 1].map(|i| [0, 1].map(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j])))
    }
}

impl LensSurface {
    /// The sag at a square of the distance from the axis, m; NaN where the surface has ended.
    pub fn sag_m(&self, squared_height_m2: f64) -> f64 {
        let (c, q) = (self.curvature_per_m, squared_height_m2);
        let root = (1.0 - (1.0 + self.conic) * c * c * q).sqrt();
        // Horner's scheme from the last coefficient; A₄ multiplies q².
        let polynomial = self.aspheric.iter().rev().fold(0.0, |sum, a| sum * q + a) * q * q;
        c * q / (1.0 + root) + polynomial
    }

    /// How the sag grows with the square of the distance from the axis, m⁻¹.
    pub fn sag_slope_per_m(&self, squared_height_m2: f64) -> f64 {
        let (c, q) = (self.curvature_per_m, squared_height_m2);
        let root = (1.0 - (1.0 + self.conic) * c * c * q).sqrt();
        let terms = self.aspheric.iter().enumerate().rev();
        let polynomial = terms.fold(0.0, |sum, (k, a)| sum * q + (k as f64 + 2.0) * a) * q;
        0.5 * c / root + polynomial
    }
}

impl CompoundLens {
    /// What is before a surface, toward the scene.
    pub fn medium_before(&self, surface: usize) -> &RefractiveIndex {
        surface.checked_sub(1).map_or(&RefractiveIndex::VACUUM, |before| &self.surfaces[before].medium)
    }

    /// Number of the stop.
    pub fn stop(&self) -> usize {
        self.surfaces.iter().position(|surface| surface.is_stop).unwrap_or(0)
    }

    /// The glass that disperses, if there is one.
    pub fn dispersive_medium(&self) -> Option<&RefractiveIndex> {
        self.surfaces.iter().map(|surface| &surface.medium).find(|medium| medium.is_dispersive())
    }

    /// From the vertex of the first surface to that of the last, m.
    pub fn length_m(&self) -> f64 {
        self.surfaces.iter().map(|surface| surface.thickness_m).sum()
    }

    /// Effective focal length at a wavelength, m: negative where the lens diverges light, infinite where it has no power.
    pub fn focal_length_m(&self, wavelength_nm: f64) -> f64 {
        let RayMatrix([_, [c, _]]) = self.matrix(0..self.surfaces.len(), wavelength_nm);
        -1.0 / c
    }

    /// Where paraxial rays from a point on the axis meet again: its distance behind the last vertex, m, for a point `object_m` before the
    /// first. `None` if there is no such place behind the lens.
    pub fn image_distance_m(&self, object_m: f64, wavelength_nm: f64) -> Option<f64> {
        let RayMatrix([[a, b], [c, d]]) = self.matrix(0..self.surfaces.len(), wavelength_nm);
        // Divided by the distance, which may be very large.
        let distance_m = -(a + b / object_m) / (c + d / object_m);
        (distance_m > 0.0 && distance_m.is_finite()).then_some(distance_m)
    }

    /// The tangent of half the vertical angle that the film sees of a distant scene, by the paraxial ray through the middle of the stop.
    pub fn half_view(&self) -> f64 {
        let wavelength_nm = self.reference_nm;
        let stop = self.stop();
        let RayMatrix([[a, _], _]) = self.to_stop(wavelength_nm);
        let RayMatrix([[_, b], [_, d]]) = self.matrix(stop..self.surfaces.len(), wavelength_nm);
        (a * 0.5 * self.film_height_m / (b + self.film_distance_m * d)).abs()
    }

    /// From before the first surface to before the stop.
    fn to_stop(&self, wavelength_nm: f64) -> RayMatrix {
        let stop = self.stop();
        let Some(last) = stop.checked_sub(1) else { return RayMatrix::NOTHING };
        let gap = &self.surfaces[last];
        let n = gap.medium.eval(wavelength_nm);
        RayMatrix([[1.0, gap.thickness_m / n], [0.0, 1.0]]).after(self.matrix(0..stop, wavelength_nm))
    }

    /// The refracting power of a surface, m⁻¹.
    fn power(&self, surface: usize, wavelength_nm: f64) -> f64 {
        let [before, behind] =
            [self.medium_before(surface), &self.surfaces[surface].medium].map(|m| m.eval(wavelength_nm));
        (behind - before) * self.surfaces[surface].curvature_per_m
    }

    /// From before the first of some surfaces to behind the last.
    fn matrix(&self, surfaces: std::ops::Range<usize>, wavelength_nm: f64) -> RayMatrix {
        let end = surfaces.end;
        surfaces.fold(RayMatrix::NOTHING, |matrix, i| {
            let refracted = RayMatrix([[1.0, 0.0], [-self.power(i, wavelength_nm), 1.0]]).after(matrix);
            if i + 1 == end {
                return refracted;
            }
            let LensSurface { thickness_m, medium, .. } = &self.surfaces[i];
            RayMatrix([[1.0, thickness_m / medium.eval(wavelength_nm)], [0.0, 1.0]]).after(refracted)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const D_NM: f64 = 587.5618;

    /// A lens of two spheres around glass of 1.5168.
    fn lens(radii_m: [f64; 2], thickness_m: f64) -> CompoundLens {
        let surface = |radius_m: f64, thickness_m, index| LensSurface {
            curvature_per_m: 1.0 / radius_m,
            conic: 0.0,
            aspheric: Vec::new(),
            thickness_m,
            medium: RefractiveIndex::constant(index).unwrap(),
            semi_aperture_m: 0.01,
            is_stop: index > 1.0,
        };
        CompoundLens {
            surfaces: vec![surface(radii_m[0], thickness_m, 1.5168), surface(radii_m[1], 0.0, 1.0)],
            coating: LensCoating::Ideal,
            film_distance_m: 0.05,
            film_height_m: 0.024,
            reference_nm: D_NM,
        }
    }

    /// 1/f = (n − 1)(1/R₁ − 1/R₂ + (n − 1)d/(n R₁R₂)).
    #[test]
    fn thick_lenses_have_the_focal_length_of_the_lensmaker() {
        let biconvex = lens([0.05, -0.05], 0.005);
        assert!((biconvex.focal_length_m(D_NM) - 0.049_213).abs() < 5e-7, "{}", biconvex.focal_length_m(D_NM));
        for (radii, d) in [([0.03, 0.2], 0.008), ([f64::INFINITY, -0.04], 0.003), ([-0.05, 0.07], 0.002)] {
            let n = 1.5168;
            let power = (n - 1.0) * (1.0 / radii[0] - 1.0 / radii[1] + (n - 1.0) * d / (n * radii[0] * radii[1]));
            let found = lens(radii, d).focal_length_m(D_NM);
            // A dozen roundings.
            assert!((found * power - 1.0).abs() < 1e-14, "{found}");
        }
    }

    /// Newton's equation x·x′ = f², both distances counted from the foci.
    #[test]
    fn images_lie_where_newton_says() {
        let lens = lens([0.03, 0.2], 0.008);
        let f = lens.focal_length_m(D_NM);
        let back = lens.image_distance_m(1e30, D_NM).unwrap();
        // The front focus: parallel rays backwards, which is the lens turned round.
        let mut turned = lens.clone();
        let [c, d] = [0, 1].map(|i| lens.surfaces[i].curvature_per_m);
        (turned.surfaces[0].curvature_per_m, turned.surfaces[1].curvature_per_m) = (-d, -c);
        let front = turned.image_distance_m(1e30, D_NM).unwrap();
        for object_m in [0.1, 0.5, 20.0] {
            let image = lens.image_distance_m(object_m, D_NM).unwrap();
            let product = (object_m - front) * (image - back);
            // `image − back` loses three digits for the farthest point.
            assert!((product / (f * f) - 1.0).abs() < 1e-11, "{product}");
        }
        assert_eq!(lens.image_distance_m(0.5 * f, D_NM), None);
    }

    #[test]
    fn slopes_are_the_derivatives_of_sags() {
        let mut surface = lens([0.05, -0.05], 0.005).surfaces.swap_remove(0);
        (surface.conic, surface.aspheric) = (-0.7, vec![30.0, -2e4, 1e8]);
        for q in [1e-6, 4e-5, 1e-4] {
            let h = 1e-4 * q;
            let difference = (surface.sag_m(q + h) - surface.sag_m(q - h)) / (2.0 * h);
            // The third derivative over 6, times h²; and roundings over h.
            assert!((surface.sag_slope_per_m(q) / difference - 1.0).abs() < 1e-7, "{q}");
        }
        surface.conic = 0.0;
        surface.aspheric.clear();
        let exact = 0.05 - (0.05_f64.powi(2) - 1e-4).sqrt();
        // The difference of square roots loses two digits.
        assert!((surface.sag_m(1e-4) / exact - 1.0).abs() < 1e-13);
    }
}
