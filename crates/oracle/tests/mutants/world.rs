//! The small renderer's own reader of the oracle's scenes.

use std::cell::Cell;

use serde_json::Value;

use crate::{
    shapes::Shape,
    vector::{Vec3, dot, minus, plus, times, unit},
};

pub(crate) enum Material {
    Lambert(f64),
    Mirror(f64),
    Conductor(f64, f64),
    /// With the width of its facets, 0 where it is smooth.
    Dielectric {
        inside: f64,
        outside: f64,
        alpha: f64,
    },
    Black,
}

pub(crate) struct Primitive {
    pub(crate) shape: Shape,
    pub(crate) object: usize,
}

pub(crate) struct Object {
    pub(crate) material: Material,
    /// Share of the light that meets it.
    pub(crate) opacity: f64,
    pub(crate) radiance: f64,
    pub(crate) front: bool,
    pub(crate) back: bool,
    /// Sampled by shadow rays: a black body that shines outward. All others are found by BSDF rays.
    pub(crate) sampled: bool,
}

pub(crate) struct World {
    pub(crate) fault: &'static str,
    pub(crate) primitives: Vec<Primitive>,
    pub(crate) objects: Vec<Object>,
    pub(crate) lights: Vec<Light>,
    pub(crate) sky: f64,
    pub(crate) most_edges: u64,
    /// Paths cut by a fault that says so, and the largest throughput of one.
    pub(crate) cut: Cell<(u64, f64)>,
    pub(crate) camera: Value,
    pub(crate) aspect: f64,
}

pub(crate) enum Light {
    Primitive(usize),
    Point { at: Vec3, intensity: f64 },
    Directional { along: Vec3, irradiance: f64 },
}

pub(crate) fn vec3(value: &Value) -> Vec3 {
    [0, 1, 2].map(|i| value[i].as_f64().expect("a number"))
}

pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

/// Index of refraction in the middle of the band; blackbodies and other tables are not read here.
fn index(value: &Value, wavelength_nm: f64) -> f64 {
    if value.is_null() {
        return 1.0;
    }
    value.as_f64().unwrap_or_else(|| {
        let square = (wavelength_nm * 1e-3).powi(2);
        let term = |i: usize| number(&value["b"][i]) * square / (square - number(&value["c_um2"][i]));
        (1.0 + (0..3).map(term).sum::<f64>()).sqrt()
    })
}

impl World {
    /// The scene at one wavelength; by default in the middle of its band.
    pub(crate) fn read(json: &str, fault: &'static str, wavelength_nm: Option<f64>) -> Result<Self, String> {
        let scene: Value = serde_json::from_str(json).map_err(|error| error.to_string())?;
        let band = &scene["integrator"]["wavelength_range_nm"];
        let middle = if band.is_null() { 550.0 } else { 0.5 * (number(&band[0]) + number(&band[1])) };
        let mut wavelength_nm = wavelength_nm.unwrap_or(middle);
        if fault == "the index of the d line at every wavelength" {
            wavelength_nm = 587.5618;
        }
        let film = &scene["film"];
        let mut world = Self {
            fault,
            primitives: Vec::new(),
            objects: Vec::new(),
            lights: Vec::new(),
            sky: 0.0,
            most_edges: scene["integrator"]["max_depth"].as_u64().unwrap_or(u64::MAX),
            cut: Cell::default(),
            camera: scene["camera"].clone(),
            aspect: number(&film["width"]) / number(&film["height"]),
        };
        if fault == "one edge more" {
            world.most_edges = world.most_edges.saturating_add(1);
        }
        for object in scene["objects"].as_array().into_iter().flatten() {
            world.add(object, wavelength_nm)?;
        }
        for light in scene["lights"].as_array().into_iter().flatten() {
            match light["type"].as_str() {
                Some("environment") => world.sky += number(&light["radiance"]),
                Some("point") => {
                    let (at, intensity) = (vec3(&light["position_m"]), number(&light["intensity"]));
                    world.lights.push(Light::Point { at, intensity });
                }
                _ => {
                    let (along, irradiance) = (unit(vec3(&light["direction"])), number(&light["irradiance"]));
                    world.lights.push(Light::Directional { along, irradiance });
                }
            }
        }
        Ok(world)
    }

    fn add(&mut self, object: &Value, wavelength_nm: f64) -> Result<(), String> {
        let material = match object["material"]["type"].as_str() {
            Some("lambert") => Material::Lambert(number(&object["material"]["reflectance"])),
            Some("mirror") => Material::Mirror(number(&object["material"]["reflectance"])),
            Some("conductor") => {
                Material::Conductor(number(&object["material"]["n"][0]), number(&object["material"]["k"][0]))
            }
            Some("dielectric") => Material::Dielectric {
                inside: index(&object["material"]["interior"], wavelength_nm),
                outside: index(&object["material"]["exterior"], wavelength_nm),
                alpha: object["material"]["alpha"].as_f64().unwrap_or(0.0),
            },
            _ => Material::Black,
        };
        let emission = &object["emission"];
        let radiance = if emission.is_null() {
            0.0
        } else {
            emission["radiance"].as_f64().ok_or("only constant spectra are read")?
        };
        let sides = emission["sides"].as_str().unwrap_or("front");
        let (mut front, back) = (sides != "back", sides != "front");
        if self.fault == "lights shine on both sides" {
            front = true;
        }
        let both = self.fault == "lights shine on both sides" || back;
        let sampled = radiance > 0.0 && matches!(material, Material::Black) && sides != "back";
        let index = self.objects.len();
        let opacity = object["opacity"].as_f64().unwrap_or(1.0);
        self.objects.push(Object { material, opacity, radiance, front, back: both, sampled });
        let shape = &object["shape"];
        let mut shapes = Vec::new();
        match shape["type"].as_str() {
            Some("sphere") => {
                shapes.push(Shape::Sphere { center: vec3(&shape["center_m"]), radius: number(&shape["radius_m"]) })
            }
            Some("disk") => shapes.push(Shape::Disk {
                center: vec3(&shape["center_m"]),
                normal: unit(vec3(&shape["normal"])),
                radius: number(&shape["radius_m"]),
            }),
            Some("cylinder") => {
                let (start, end, radius) = (vec3(&shape["start_m"]), vec3(&shape["end_m"]), number(&shape["radius_m"]));
                let along = minus(end, start);
                let axis = unit(along);
                shapes.push(Shape::Tube { start, axis, length: dot(along, along).sqrt(), radius });
                if shape["capped"] == true && self.fault != "tubes without their ends" {
                    shapes.push(Shape::Disk { center: start, normal: times(-1.0, axis), radius });
                    shapes.push(Shape::Disk { center: end, normal: axis, radius });
                }
            }
            Some("parallelogram") => shapes.push(Shape::Quad {
                origin: vec3(&shape["origin_m"]),
                u: vec3(&shape["u_m"]),
                v: vec3(&shape["v_m"]),
            }),
            Some("box") => {
                let (low, high) = (vec3(&shape["min_m"]), vec3(&shape["max_m"]));
                for axis in 0..3 {
                    let edge = |i: usize| {
                        let mut e = [0.0; 3];
                        e[(axis + i) % 3] = high[(axis + i) % 3] - low[(axis + i) % 3];
                        e
                    };
                    let top = plus(low, 1.0, edge(0));
                    shapes.push(Shape::Quad { origin: low, u: edge(2), v: edge(1) });
                    shapes.push(Shape::Quad { origin: top, u: edge(1), v: edge(2) });
                }
            }
            _ => {
                let vertices: Vec<Vec3> =
                    shape["vertices_m"].as_array().ok_or("no vertices")?.iter().map(vec3).collect();
                for triangle in shape["triangles"].as_array().ok_or("no triangles")? {
                    let corner = |i: usize| vertices[triangle[i].as_u64().expect("an index") as usize];
                    shapes.push(Shape::Triangle([corner(0), corner(1), corner(2)]));
                }
            }
        }
        for shape in shapes {
            if sampled {
                self.lights.push(Light::Primitive(self.primitives.len()));
            }
            self.primitives.push(Primitive { shape, object: index });
        }
        Ok(())
    }
}
