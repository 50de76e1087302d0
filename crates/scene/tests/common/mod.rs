//! Scenes to test with.

/// A right scene, in parts that a test can replace; each stands in a line of its own.
pub(crate) struct Parts<'a> {
    pub(crate) etalon: &'a str,
    pub(crate) camera: &'a str,
    pub(crate) film: &'a str,
    pub(crate) spectra: &'a str,
    pub(crate) materials: &'a str,
    pub(crate) objects: &'a str,
    pub(crate) lights: &'a str,
    pub(crate) integrator: &'a str,
}

pub(crate) const RIGHT: Parts<'static> = Parts {
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
    pub(crate) fn text(&self) -> String {
        let Self { etalon, camera, film, spectra, materials, objects, lights, integrator } = self;
        format!(
            "{{\n\"etalon\": {etalon},\n\"camera\": {camera},\n\"film\": {film},\n\"spectra\": {spectra},\n\
             \"materials\": {materials},\n\"objects\": {objects},\n\"lights\": {lights},\n\"integrator\": {integrator}\n}}"
        )
    }
}

/// A scene with every key of the format.
pub(crate) const EVERYTHING: &str = include_str!("everything.json");
