//! The lobes of a [principled](super::principled) surface in closed form, by vectors and by angles.

use std::f64::consts::{FRAC_PI_2, PI};

use serde_json::{Value, json};

use crate::{
    laws::fresnel_exact,
    quadrature::rectangle,
    vector::{Vec3, add, dot, normalize},
};

/// A surface whose base is grey.
#[derive(Clone, Copy)]
pub(super) struct Surface {
    pub(super) base: f64,
    pub(super) index: f64,
    /// Along u, turned toward v by an angle, and across it.
    pub(super) alpha: [f64; 2],
    pub(super) turned_deg: f64,
    pub(super) metallic: f64,
    pub(super) specular_tint: f64,
    pub(super) flatness: f64,
    pub(super) sheen: f64,
    pub(super) coat: f64,
    pub(super) coat_alpha: f64,
}

/// Diffuse, and nothing else: a surface of index 1 reflects nothing as a dielectric.
pub(super) const DIFFUSE: Surface = Surface {
    base: 0.6,
    index: 1.0,
    alpha: [0.36; 2],
    turned_deg: 0.0,
    metallic: 0.0,
    specular_tint: 0.0,
    flatness: 0.0,
    sheen: 0.0,
    coat: 0.0,
    coat_alpha: 0.1,
};

/// All that reflects as a dielectric does.
pub(super) const GLOSSY: Surface = Surface { base: 0.0, index: 1.6, ..DIFFUSE };

/// (1 − c)⁵.
pub(super) fn grazing(c: f64) -> f64 {
    (1.0 - c).powi(5)
}

pub(super) fn schlick(head_on: f64, c: f64) -> f64 {
    head_on + (1.0 - head_on) * grazing(c)
}

impl Surface {
    pub(super) fn json(&self) -> Value {
        let mut material = json!({ "type": "principled", "reflectance": self.base, "index": self.index });
        if self.alpha[0] == self.alpha[1] {
            material["alpha"] = json!(self.alpha[0]);
        } else {
            (material["alpha_u"], material["alpha_v"]) = (json!(self.alpha[0]), json!(self.alpha[1]));
            material["tangent_rotation_deg"] = json!(self.turned_deg);
        }
        let numbers = [
            ("metallic", self.metallic),
            ("specular_tint", self.specular_tint),
            ("flatness", self.flatness),
            ("sheen", self.sheen),
            ("clear_coat", self.coat),
        ];
        numbers.into_iter().filter(|(_, number)| *number > 0.0).for_each(|(key, number)| material[key] = json!(number));
        if self.coat > 0.0 {
            material["clear_coat_alpha"] = json!(self.coat_alpha);
        }
        material
    }

    pub(super) fn roughness(&self) -> f64 {
        (self.alpha[0] * self.alpha[1]).powf(0.25)
    }

    /// f without the two lobes of facets, of cosines to the normal and to the facet half way.
    pub(super) fn base_lobes(&self, o: f64, i: f64, d: f64) -> f64 {
        let [v_o, v_i] = [o, i].map(grazing);
        let r = 2.0 * self.roughness() * d * d;
        let burley = (1.0 - v_o / 2.0) * (1.0 - v_i / 2.0) + r * (v_o + v_i + v_o * v_i * (r - 1.0));
        let inner = (1.0 + (r / 2.0 - 1.0) * v_o) * (1.0 + (r / 2.0 - 1.0) * v_i);
        let below = 1.25 * (inner * (1.0 / (o + i) - 0.5) + 0.5);
        let diffuse = self.base / PI * ((1.0 - self.flatness) * burley + self.flatness * below);
        (1.0 - self.metallic) * (diffuse + self.sheen * grazing(d))
    }

    pub(super) fn fresnel(&self, d: f64) -> f64 {
        let head_on = ((self.index - 1.0) / (self.index + 1.0)).powi(2);
        let dielectric = (1.0 - self.specular_tint) * fresnel_exact(d.min(1.0), self.index).reflectance()
            + self.specular_tint * schlick(head_on, d);
        (1.0 - self.metallic) * dielectric + self.metallic * schlick(self.base, d)
    }

    /// f cos θ_i by vectors: the facet's slopes along both axes of the grain.
    pub(super) fn f_cos(&self, o: Vec3, i: Vec3) -> f64 {
        let h = normalize(add(o, i));
        let d = dot(o, h);
        let (sin, cos) = self.turned_deg.to_radians().sin_cos();
        let along = |w: Vec3| [cos * w[0] + sin * w[1], cos * w[1] - sin * w[0]];
        let square =
            |w: Vec3| along(w).iter().zip(self.alpha).map(|(x, alpha)| (x / w[2] * alpha).powi(2)).sum::<f64>();
        let slopes = along(h).iter().zip(self.alpha).map(|(x, alpha)| (x / h[2] / alpha).powi(2)).sum::<f64>();
        let ggx = 1.0 / (PI * self.alpha[0] * self.alpha[1] * h[2].powi(4) * (1.0 + slopes).powi(2));
        let masking = |w: Vec3| 2.0 / (1.0 + (1.0 + square(w)).sqrt());
        let specular = self.fresnel(d) * ggx * masking(o) * masking(i) / (4.0 * o[2]);
        self.base_lobes(o[2], i[2], d) * i[2] + specular + self.coated(o[2], i[2], d, h[2]) * i[2]
    }

    /// f of the coat.
    pub(super) fn coated(&self, o: f64, i: f64, d: f64, h: f64) -> f64 {
        let a2 = self.coat_alpha.powi(2);
        let gtr = (a2 - 1.0) / (PI * a2.ln() * (1.0 + (a2 - 1.0) * h * h));
        let masking = |c: f64| 2.0 / (1.0 + (1.0 + 0.0625 * (1.0 / (c * c) - 1.0)).sqrt());
        0.25 * self.coat * schlick(0.04, d) * gtr * masking(o) * masking(i)
    }

    /// The same of one width, by angles: of spherical triangles instead of vectors, and Fresnel's equations by Snell's angles.
    pub(super) fn by_angles(&self, o_deg: f64, i_deg: f64, apart_deg: f64) -> f64 {
        let [o, i, apart] = [o_deg, i_deg, apart_deg].map(f64::to_radians);
        // The angle between both is twice that of incidence on the facet, whose height is that of their sum over its length.
        let d = 0.5 * (o.cos() * i.cos() + o.sin() * i.sin() * apart.cos()).acos();
        let h = ((o.cos() + i.cos()) / (2.0 * d.cos())).acos();
        let alpha = self.alpha[0];
        let ggx = alpha * alpha / (PI * (h.cos().powi(2) * (alpha * alpha + h.tan().powi(2))).powi(2));
        let lambda = |theta: f64| 0.5 * ((1.0 + (alpha * theta.tan()).powi(2)).sqrt() - 1.0);
        let inside = (d.sin() / self.index).asin();
        let share = |reflected: f64| reflected * reflected;
        let exact = if self.index == 1.0 {
            0.0
        } else {
            0.5 * (share((d - inside).sin() / (d + inside).sin()) + share((d - inside).tan() / (d + inside).tan()))
        };
        let head_on = ((self.index - 1.0) / (self.index + 1.0)).powi(2);
        let dielectric = exact + self.specular_tint * (schlick(head_on, d.cos()) - exact);
        let fresnel = dielectric + self.metallic * (schlick(self.base, d.cos()) - dielectric);
        let facets = fresnel * ggx / ((1.0 + lambda(o)) * (1.0 + lambda(i)) * 4.0 * o.cos() * i.cos());
        let rest = self.base_lobes(o.cos(), i.cos(), d.cos()) + self.coated(o.cos(), i.cos(), d.cos(), h.cos());
        (facets + rest) * i.cos()
    }
}

/// Everything at once.
pub(super) const ALL: Surface = Surface {
    base: 0.5,
    index: 1.5,
    metallic: 0.3,
    specular_tint: 0.4,
    flatness: 0.25,
    sheen: 0.5,
    coat: 0.8,
    ..DIFFUSE
};

/// A direction at `tilt_deg` off +z, `turn_deg` from +x toward +y.
pub(super) fn direction(tilt_deg: f64, turn_deg: f64) -> Vec3 {
    let ((sin, cos), (sin_turn, cos_turn)) = (tilt_deg.to_radians().sin_cos(), turn_deg.to_radians().sin_cos());
    [sin * cos_turn, sin * sin_turn, cos]
}

/// ∫ f cos θ_i dω over the sky.
pub(super) fn sky(surface: &Surface, tilt_deg: f64) -> f64 {
    let o = direction(tilt_deg, 0.0);
    // About the mirror direction, where facets crowd.
    let ring = |theta: f64, phi: f64| {
        theta.sin() * surface.f_cos(o, [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()])
    };
    let part = |from: f64, to: f64| rectangle(ring, [from, to], [0.0, PI], 1e-7, 200_000).value;
    let edge = tilt_deg.to_radians();
    2.0 * (part(0.0, edge) + part(edge, FRAC_PI_2 - 1e-12))
}

/// The same over facets: dω_i is 4 cos θ_d dω_h.
pub(super) fn sky_by_facets(surface: &Surface, tilt_deg: f64) -> f64 {
    pub(super) const STEPS: u32 = 1200;
    let o = direction(tilt_deg, 0.0);
    let at = |step: u32| (f64::from(step) + 0.5) / f64::from(STEPS);
    let mut sum = 0.0;
    for x in (0..STEPS).map(at) {
        // Close together around the normal.
        let theta = FRAC_PI_2 * x * x;
        for phi in (0..STEPS).map(|step| PI * at(step)) {
            let h = [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()];
            let d = dot(o, h);
            let i = [0, 1, 2].map(|k| 2.0 * d * h[k] - o[k]);
            if d > 0.0 && i[2] > 0.0 {
                sum += surface.f_cos(o, i) * theta.sin() * 4.0 * d * 2.0 * x * FRAC_PI_2;
            }
        }
    }
    2.0 * sum * PI / f64::from(STEPS).powi(2)
}
