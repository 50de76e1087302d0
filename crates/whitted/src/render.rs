//! The renderer. Every expression keeps its published order of operations: do not tidy them.

use std::marker::PhantomData;
use std::num::NonZero;

use crate::random::AdditiveFeedback;
use crate::refraction::{RefractionRule, reflect, refract};
use crate::scene::{Light, Material, Scene, Shape};
use crate::vector::{Arithmetic, Published, Vec3, vec3};

/// How far along its direction a reflected or refracted ray starts.
const SECONDARY_OFFSET: f64 = 0.001;
/// Exponent of the highlights that mirror and refraction rays collect.
const SECONDARY_SHININESS: f64 = 5.0;

/// What is not part of a scene file. [`Settings::default`] is the setting of the published figures 2 to 4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Image width in pixels.
    pub width: NonZero<u32>,
    /// Image height in pixels.
    pub height: NonZero<u32>,
    /// Camera rays a pixel.
    pub rays: NonZero<u32>,
    /// How far along a shadow ray its search begins, as a fraction of the way to the light.
    pub shadow_epsilon: f64,
    /// Most surfaces that a mirror or refraction ray visits.
    pub max_bounce: u32,
    /// How refracted directions are computed.
    pub refraction: RefractionRule,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            width: const { NonZero::new(640).unwrap() },
            height: const { NonZero::new(480).unwrap() },
            rays: const { NonZero::new(5).unwrap() },
            shadow_epsilon: 0.001,
            max_bounce: 10,
            refraction: RefractionRule::AsPublished,
        }
    }
}

/// A rendered image in linear light.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Linear RGB, row by row from the top left.
    pub pixels: Vec<Vec3>,
}

impl Film {
    /// 8-bit RGB, row by row: the values clamped to [0, 1], times 255, rounded half away from zero.
    pub fn to_rgb8(&self) -> Vec<u8> {
        self.pixels.iter().flat_map(|p| p.0).map(|c| (c.clamp(0.0, 1.0) * 255.0).round() as u8).collect()
    }

    /// How many pixels hold a NaN or an infinity, which [`Film::to_rgb8`] cannot show.
    pub fn non_finite(&self) -> usize {
        self.pixels.iter().filter(|p| p.0.iter().any(|c| !c.is_finite())).count()
    }
}

/// Renders a scene with the arithmetic of the published figures.
pub fn render(scene: &Scene, settings: &Settings) -> Film {
    render_with::<Published>(scene, settings, |_| ())
}

/// Renders a scene with a chosen arithmetic, and tells `progress` after each column how many rays a column is.
pub fn render_with<A: Arithmetic>(scene: &Scene, settings: &Settings, mut progress: impl FnMut(u64)) -> Film {
    let tracer = Tracer::<A> { scene, settings, arithmetic: PhantomData };
    let (width, height, rays) = (settings.width.get(), settings.height.get(), settings.rays.get());
    let (w, h) = (f64::from(width), f64::from(height));
    let camera = &scene.camera;
    let scale_y = 2.0 * camera.focal_length * A::tan(camera.field_of_view_rad / 2.0);
    let scale_x = (w / h) * scale_y;
    let origin = vec3(-scale_x, scale_y, -camera.focal_length);
    let step_x = vec3(2.0 / w * scale_x, 0.0, 0.0);
    let step_y = vec3(0.0, -2.0 / h * scale_y, 0.0);

    let mut random = AdditiveFeedback::new();
    let mut pixels = vec![Vec3::default(); width as usize * height as usize];
    for i in 0..width {
        for j in 0..height {
            let pixel = &mut pixels[j as usize * width as usize + i as usize];
            let sample = (origin + f64::from(i) * step_x) + f64::from(j) * step_y;
            for _ in 0..rays {
                let ray = if camera.is_perspective {
                    let lens_x = camera.lens_radius * f64::from(random.next_signed());
                    let lens_y = camera.lens_radius * f64::from(random.next_signed());
                    let origin = camera.position + vec3(lens_x, lens_y, 0.0);
                    Ray { origin, direction: sample - origin }
                } else {
                    let origin = camera.position + vec3(sample.0[0], sample.0[1], 0.0);
                    Ray { origin, direction: vec3(0.0, 0.0, -1.0) }
                };
                *pixel += tracer.color(&ray) / f64::from(rays);
            }
        }
        progress(u64::from(height) * u64::from(rays));
    }
    Film { width, height, pixels }
}

/// A ray; its direction is not normalised.
struct Ray {
    origin: Vec3,
    direction: Vec3,
}

/// Where a ray meets an object.
struct Hit<'a> {
    point: Vec3,
    normal: Vec3,
    /// Squared distance from the ray's origin.
    distance2: f64,
    material: &'a Material,
}

struct Tracer<'a, A> {
    scene: &'a Scene,
    settings: &'a Settings,
    arithmetic: PhantomData<A>,
}

impl<'a, A: Arithmetic> Tracer<'a, A> {
    /// The colour that a camera ray sees.
    fn color(&self, ray: &Ray) -> Vec3 {
        let Some(hit) = self.nearest(ray) else { return self.scene.background };
        let (m, p) = (hit.material, hit.point);
        let visible = self.visible_lights(p);

        let mut lights = Vec3::default();
        for light in visible.iter() {
            let to_light = light.position - p;
            let cosine = A::dot(A::normalize(to_light), hit.normal).max(0.0);
            let bisector = A::normalize(to_light - ray.direction);
            let highlight = A::pow(A::dot(hit.normal, bisector).max(0.0), m.shininess);
            lights += (cosine * m.diffuse + highlight * m.specular).times(light.color) / A::dot(to_light, to_light);
        }

        let reflected = |d, n| Some(reflect::<A>(d, n));
        let mirror = self.highlights(&hit, ray.direction, &visible, m.mirror, reflected, |_, _| true);
        let refracted = |d, n| refract::<A>(self.settings.refraction, m.refraction_index, d, n);
        let leaves = |d, n| A::dot(d, n) >= 0.0;
        let refraction = self.highlights(&hit, ray.direction, &visible, m.refraction, refracted, leaves);
        ((m.ambient.times(self.scene.ambient) + lights) + mirror) + refraction
    }

    /// The lights that `point` sees. A shadow ray may stop anywhere before its light; the light itself is at distance² |l − p|².
    fn visible_lights(&self, point: Vec3) -> Vec<&'a Light> {
        let lit = |light: &&Light| {
            let to_light = light.position - point;
            let origin = point + self.settings.shadow_epsilon * to_light;
            self.nearest(&Ray { origin, direction: to_light }).is_none_or(|blocker| {
                let to_blocker = blocker.point - point;
                A::dot(to_blocker, to_blocker) >= A::dot(to_light, to_light)
            })
        };
        self.scene.lights.iter().filter(lit).collect()
    }

    /// Follows a mirror or refraction ray and sums the highlights it passes, of the lights visible from its first point.
    fn highlights(
        &self,
        first: &Hit<'_>,
        incoming: Vec3,
        visible: &[&Light],
        weight: Vec3,
        turn: impl Fn(Vec3, Vec3) -> Option<Vec3>,
        is_lit: impl Fn(Vec3, Vec3) -> bool,
    ) -> Vec3 {
        let mut sum = Vec3::default();
        if weight == Vec3::default() {
            return sum;
        }
        let (mut point, mut normal, mut direction) = (first.point, first.normal, incoming);
        for _ in 0..self.settings.max_bounce {
            let Some(turned) = turn(direction, normal) else { break };
            direction = turned;
            let origin = point + SECONDARY_OFFSET * direction;
            let Some(hit) = self.nearest(&Ray { origin, direction }) else { break };
            (point, normal) = (hit.point, hit.normal);
            if !is_lit(direction, normal) {
                continue;
            }
            for light in visible {
                let to_light = light.position - point;
                let bisector = A::normalize(to_light - direction);
                let highlight = A::pow(A::dot(normal, bisector).max(0.0), SECONDARY_SHININESS);
                sum += (highlight * weight).times(light.color) / A::dot(to_light, to_light);
            }
        }
        sum
    }

    /// The nearest hit; of equally near ones, the first in the file.
    fn nearest(&self, ray: &Ray) -> Option<Hit<'a>> {
        let mut nearest: Option<Hit<'a>> = None;
        for object in &self.scene.objects {
            if let Some((point, normal)) = intersect::<A>(&object.shape, ray) {
                let offset = point - ray.origin;
                let distance2 = A::dot(offset, offset);
                if nearest.as_ref().is_none_or(|n| distance2 < n.distance2) {
                    nearest = Some(Hit { point, normal, distance2, material: &object.material });
                }
            }
        }
        nearest
    }
}

/// Where a ray first meets a shape, and the shape's unit normal there (outward on a sphere, also when seen from inside).
fn intersect<A: Arithmetic>(shape: &Shape, ray: &Ray) -> Option<(Vec3, Vec3)> {
    let (o, d) = (ray.origin, ray.direction);
    match *shape {
        Shape::Sphere { center, radius } => {
            let oc = o - center;
            let a = A::dot(d, d);
            let b = 2.0 * A::dot(d, oc);
            let c = A::dot(oc, oc) - radius * radius;
            let discriminant = b * b - 4.0 * a * c;
            if discriminant.is_nan() || discriminant <= 0.0 {
                return None;
            }
            let root = discriminant.sqrt();
            let (t1, t2) = ((-b - root) / (2.0 * a), (-b + root) / (2.0 * a));
            if t1 < 0.0 && t2 < 0.0 {
                return None;
            }
            let point = o + (if t1 >= 0.0 { t1 } else { t2 }) * d;
            Some((point, A::normalize(point - center)))
        }
        Shape::Parallelogram { origin, u, v } => {
            // Cramer's rule for a u + b v − t d = o − origin. A parallel ray divides by 0, and no comparison below holds.
            let (w, area) = (o - origin, u.cross(v));
            let determinant = -A::dot(d, area);
            let t = A::dot(w, area) / determinant;
            let a = A::dot(w, d.cross(v)) / determinant;
            let b = A::dot(u, d.cross(w)) / determinant;
            let inside = |x: f64| (0.0..=1.0).contains(&x);
            (t >= 0.0 && inside(a) && inside(b)).then(|| (o + t * d, A::normalize(area)))
        }
    }
}
