//! Lights without a surface (`KHR_lights_punctual`).

use etalon_scene::linear::unit;
use glam::{DAffine3, DVec3};
use gltf::Node;
use serde_json::json;

use super::Walk;
use crate::light;

impl<'w> Walk<'w, '_> {
    /// Candela and lux become the format's units as they are: a luminance of 1 cd/m² is a radiance of 1.
    pub(super) fn light(&mut self, lamp: &gltf::khr_lights_punctual::Light<'_>, node: &Node<'w>, matrix: &DAffine3) {
        use gltf::khr_lights_punctual::Kind;
        let place = format!("$.extensions.KHR_lights_punctual.lights[{}]", lamp.index());
        let spectrum = light(lamp.color().map(|c| f64::from(c).max(0.0)), f64::from(lamp.intensity()).max(0.0));
        let position = matrix.translation.to_array();
        let name = node.name().map_or_else(|| format!("light {}", lamp.index()), str::to_owned);
        if lamp.range().is_some() {
            self.builder.leave_out(&place, "its range is ignored: light has no range");
        }
        let value = match lamp.kind() {
            Kind::Directional => {
                json!({ "name": name, "type": "directional", "direction": forward(matrix), "irradiance": spectrum })
            }
            Kind::Point => json!({ "name": name, "type": "point", "position_m": position, "intensity": spectrum }),
            Kind::Spot { inner_cone_angle, outer_cone_angle } => {
                self.builder.approximate(&place, "between its two angles the light falls off by another curve");
                let outer = f64::from(outer_cone_angle).to_degrees().clamp(1e-3, 180.0);
                let inner = f64::from(inner_cone_angle).to_degrees().clamp(0.0, outer);
                json!({
                    "name": name, "type": "spot", "position_m": position, "direction": forward(matrix),
                    "intensity": spectrum, "half_angle_deg": outer, "inner_half_angle_deg": inner,
                })
            }
        };
        self.builder.lights.push(value);
    }
}

/// Where a camera or a lamp of a node points.
pub(super) fn forward(matrix: &DAffine3) -> [f64; 3] {
    unit(-matrix.matrix3.z_axis).unwrap_or(DVec3::NEG_Z).to_array()
}
