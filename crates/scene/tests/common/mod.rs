//! Scenes to test with.
#![allow(dead_code, unreachable_pub, reason = "each test binary uses a part")]

/// A right scene, in parts that a test can replace; each stands in a line of its own.
pub struct Parts<'a> {
    pub etalon: &'a str,
    pub camera: &'a str,
    pub film: &'a str,
    pub spectra: &'a str,
    pub materials: &'a str,
    pub objects: &'a str,
    pub lights: &'a str,
    pub integrator: &'a str,
}

pub const RIGHT: Parts<'static> = Parts {
    etalon: "1",
    camera: r#"{"type": "perspective", "position_m": [0, 0, 5], "look_at_m": [0, 0, 0], "vertical_fov_deg": 40}"#,
    film: r#"{"width": 64, "height": 48}"#,
    spectra: r#"{"grey": 0.5}"#,
    materials: r#"{"white": {"type": "lambert", "reflectance": "grey"}}"#,
    objects: r#"[{"shape": {"type": "sphere", "radius_m": 1}, "material": "white"}]"#,
    lights: r#"[{"type": "environment", "radiance": 1}]"#,
    integrator: "{}",
};

impl Parts<'_> {
    pub fn text(&self) -> String {
        let Self { etalon, camera, film, spectra, materials, objects, lights, integrator } = self;
        format!(
            "{{\n\"etalon\": {etalon},\n\"camera\": {camera},\n\"film\": {film},\n\"spectra\": {spectra},\n\
             \"materials\": {materials},\n\"objects\": {objects},\n\"lights\": {lights},\n\"integrator\": {integrator}\n}}"
        )
    }
}

/// A scene with every key of the format.
pub const EVERYTHING: &str = include_str!("everything.json");
