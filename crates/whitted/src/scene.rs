//! What the assignment's scene files say, as plain data. Lengths have no unit there: one scene, one ruler.

use crate::vector::{Vec3, vec3};

/// A whole scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Linear RGB of a camera ray that meets nothing.
    pub background: Vec3,
    /// Linear RGB of the ambient light.
    pub ambient: Vec3,
    /// The camera.
    pub camera: Camera,
    /// Point lights.
    pub lights: Vec<Light>,
    /// Objects; of two at exactly the same distance the earlier one is seen.
    pub objects: Vec<Object>,
}

/// A camera that looks along −z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Perspective (true) or orthographic (false; then the lens is not used).
    pub is_perspective: bool,
    /// Centre of the lens.
    pub position: Vec3,
    /// Field of view in radians. What it spans is half the image's height: see `docs/assignment.md`.
    pub field_of_view_rad: f64,
    /// The plane z = −`focal_length` in world space holds the pixel grid and is in focus.
    pub focal_length: f64,
    /// Half the side of the square lens; 0 is a pinhole.
    pub lens_radius: f64,
}

/// A surface's answer to light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Multiplies the scene's ambient light, channel by channel.
    pub ambient: Vec3,
    /// Weight of the cosine term, a channel each, like the next three.
    pub diffuse: Vec3,
    /// Weight of the highlight.
    pub specular: Vec3,
    /// Weight of the highlights seen by mirror reflection.
    pub mirror: Vec3,
    /// Weight of the highlights seen by refraction.
    pub refraction: Vec3,
    /// The `ri` of equation (1).
    pub refraction_index: f64,
    /// Exponent of the highlight.
    pub shininess: f64,
}

/// A point light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Where it is.
    pub position: Vec3,
    /// Linear RGB at distance 1; it falls with the squared distance.
    pub color: Vec3,
}

/// A shape with its material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Object {
    /// The shape.
    pub shape: Shape,
    /// The material, by value: there is no index that could be wrong.
    pub material: Material,
}

/// A shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A sphere.
    Sphere {
        /// Its centre.
        center: Vec3,
        /// Its radius, positive.
        radius: f64,
    },
    /// The points `origin + a u + b v` with a and b in [0, 1]; its normal is u × v.
    Parallelogram {
        /// A corner.
        origin: Vec3,
        /// One side.
        u: Vec3,
        /// The other side, not parallel to `u`.
        v: Vec3,
    },
}

/// One of the published pictures: the seven spheres with three numbers changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figure {
    /// File name without `.png`.
    pub name: &'static str,
    /// How far along a shadow ray its search begins, as a fraction of the way to the light.
    pub shadow_epsilon: f64,
    /// Half the side of the lens.
    pub lens_radius: f64,
    /// The z of the fourth sphere's centre.
    pub sphere_z: f64,
}

impl Figure {
    /// The 16 published pictures: figures 1 to 4, then the 12 frames of the animation.
    pub const ALL: [Self; 16] = [
        Self::new("figure1_no_epsilon", 0.0, 0.0, -1.0),
        Self::new("figure2_shading_refraction", 0.001, 0.0, -1.0),
        Self::new("figure3_depth_of_field", 0.001, 0.08, -1.0),
        Self::new("figure4_sphere_in_focus", 0.001, 0.08, -5.0),
        Self::new("figure5_frame01", 0.001, 0.08, -1.0),
        Self::new("figure5_frame02", 0.001, 0.08, -2.0),
        Self::new("figure5_frame03", 0.001, 0.08, -3.0),
        Self::new("figure5_frame04", 0.001, 0.08, -4.0),
        Self::new("figure5_frame05", 0.001, 0.08, -5.0),
        Self::new("figure5_frame06", 0.001, 0.08, -6.0),
        Self::new("figure5_frame07", 0.001, 0.08, -6.0),
        Self::new("figure5_frame08", 0.001, 0.08, -5.0),
        Self::new("figure5_frame09", 0.001, 0.08, -4.0),
        Self::new("figure5_frame10", 0.001, 0.08, -3.0),
        Self::new("figure5_frame11", 0.001, 0.08, -2.0),
        Self::new("figure5_frame12", 0.001, 0.08, -1.0),
    ];

    const fn new(name: &'static str, shadow_epsilon: f64, lens_radius: f64, sphere_z: f64) -> Self {
        Self { name, shadow_epsilon, lens_radius, sphere_z }
    }

    /// The figure's scene: the published one, with this figure's lens and sphere.
    pub fn scene(&self) -> Scene {
        let mut scene = Scene::seven_spheres();
        scene.camera.lens_radius = self.lens_radius;
        if let Shape::Sphere { center, .. } = &mut scene.objects[3].shape {
            center.0[2] = self.sphere_z;
        }
        scene
    }
}

impl Scene {
    /// The published scene: seven unit spheres under seven lights.
    #[allow(
        clippy::approx_constant,
        reason = "the published field of view is 0.7854 and not π/4; every pixel would move"
    )]
    pub fn seven_spheres() -> Self {
        let material = Material {
            ambient: vec3(0.0, 0.5, 0.0),
            diffuse: vec3(0.5, 0.5, 0.5),
            specular: vec3(0.2, 0.2, 0.2),
            mirror: vec3(0.7, 0.7, 0.7),
            refraction: vec3(0.0, 0.0, 0.0),
            refraction_index: 1.0,
            shininess: 256.0,
        };
        let light = |x, y| Light { position: vec3(x, y, 0.0), color: vec3(16.0, 16.0, 16.0) };
        let sphere = |x, y, z| Object { shape: Shape::Sphere { center: vec3(x, y, z), radius: 1.0 }, material };
        Self {
            background: vec3(0.3, 0.3, 0.9),
            ambient: vec3(0.2, 0.2, 0.2),
            camera: Camera {
                is_perspective: true,
                position: vec3(0.0, 0.0, 5.0),
                field_of_view_rad: 0.7854,
                focal_length: 5.0,
                lens_radius: 0.08,
            },
            lights: vec![
                light(8.0, 8.0),
                light(6.0, -8.0),
                light(4.0, 8.0),
                light(2.0, -8.0),
                light(0.0, 8.0),
                light(-2.0, -8.0),
                light(-4.0, 8.0),
            ],
            objects: vec![
                sphere(10.0, 0.0, 1.0),
                sphere(7.0, 0.05, -1.0),
                sphere(4.0, 0.1, 1.0),
                sphere(1.0, 0.2, -1.0),
                sphere(-2.0, 0.4, 1.0),
                sphere(-5.0, 0.8, -1.0),
                sphere(-8.0, 1.6, 1.0),
            ],
        }
    }
}
