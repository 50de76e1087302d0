//! Embree 3, loaded at run time if the machine has it (Debian: `libembree3-3`): the measure, never a part of the product.
//!
//! Only what the bench needs is bound; the layouts are those of Embree 3.13's public headers.
#![allow(unsafe_code)] // A foreign library has no other door.

use crate::scenes::Mesh;
use libloading::{Library, Symbol};
use std::ffi::{c_char, c_void};
use std::rc::Rc;

const INVALID: u32 = u32::MAX;

#[repr(C, align(16))]
#[derive(Clone, Copy)]
pub(crate) struct Ray {
    origin: [f32; 3],
    t_near: f32,
    direction: [f32; 3],
    time: f32,
    t_far: f32,
    mask: u32,
    id: u32,
    flags: u32,
}

#[repr(C, align(16))]
#[derive(Clone, Copy)]
struct Hit {
    normal: [f32; 3],
    uv: [f32; 2],
    primitive: u32,
    geometry: u32,
    instance: [u32; 1],
}

#[repr(C)]
#[derive(Clone, Copy)]
pub(crate) struct RayHit {
    ray: Ray,
    hit: Hit,
}

#[repr(C)]
struct Context {
    flags: u32,
    filter: *const c_void,
    instances: [u32; 1],
    min_width_distance_factor: f32,
    // Room for build options of the library that this binding does not know.
    spare: [u64; 4],
}

impl Context {
    fn new() -> Self {
        Self { flags: 0, filter: std::ptr::null(), instances: [INVALID], min_width_distance_factor: 0.0, spare: [0; 4] }
    }
}

/// The library.
pub(crate) struct Embree {
    library: &'static Library,
    device: *mut c_void,
}

/// What a scene is made of.
pub(crate) enum Content<'a> {
    /// Indexed triangles.
    Triangles(&'a [[f32; 3]], &'a [[u32; 3]]),
    /// Centres and radii.
    Spheres(&'a [[f32; 4]]),
    /// Triangles placed by affine maps (rows of three numbers and a translation), among triangles that are not.
    Instances { placed: &'a Mesh, placements: &'a [[f32; 12]], others: &'a Mesh },
}

/// A committed scene.
pub(crate) struct Scene {
    embree: Rc<Embree>,
    scene: *mut c_void,
    /// What is placed in it.
    placed: Option<Box<Scene>>,
    intersect: unsafe extern "C" fn(*mut c_void, *mut Context, *mut RayHit),
    occluded: unsafe extern "C" fn(*mut c_void, *mut Context, *mut Ray),
}

/// The flag that asks for robust intersections.
pub(crate) const ROBUST: u32 = 1 << 2;

impl Embree {
    /// Loads the library with a number of build threads; `None` where it is missing.
    pub(crate) fn load(threads: usize) -> Option<Rc<Self>> {
        // SAFETY: Embree's initialisers have no preconditions; the signature is that of the header.
        unsafe {
            // Never unloaded: its worker threads outlive the device.
            let library: &'static Library = Box::leak(Box::new(Library::new("libembree3.so.3").ok()?));
            let new_device: Symbol<'_, unsafe extern "C" fn(*const c_char) -> *mut c_void> =
                library.get(b"rtcNewDevice\0").ok()?;
            let config = std::ffi::CString::new(format!("threads={threads}")).ok()?;
            let device = new_device(config.as_ptr());
            (!device.is_null()).then(|| Rc::new(Self { library, device }))
        }
    }

    /// Builds a scene.
    pub(crate) fn scene(self: &Rc<Self>, content: &Content<'_>, flags: u32) -> Scene {
        type P = *mut c_void;
        // SAFETY: signatures and calling order are those of the header; buffers are written within the sizes asked for.
        unsafe {
            let new_scene: Symbol<'_, unsafe extern "C" fn(P) -> P> = self.symbol("rtcNewScene");
            let set_flags: Symbol<'_, unsafe extern "C" fn(P, u32)> = self.symbol("rtcSetSceneFlags");
            let new_geometry: Symbol<'_, unsafe extern "C" fn(P, u32) -> P> = self.symbol("rtcNewGeometry");
            type SetBuffer = unsafe extern "C" fn(P, u32, u32, u32, usize, usize) -> *mut c_void;
            let set_buffer: Symbol<'_, SetBuffer> = self.symbol("rtcSetNewGeometryBuffer");
            let commit_geometry: Symbol<'_, unsafe extern "C" fn(P)> = self.symbol("rtcCommitGeometry");
            let attach: Symbol<'_, unsafe extern "C" fn(P, P) -> u32> = self.symbol("rtcAttachGeometry");
            let release: Symbol<'_, unsafe extern "C" fn(P)> = self.symbol("rtcReleaseGeometry");
            let commit: Symbol<'_, unsafe extern "C" fn(P)> = self.symbol("rtcCommitScene");
            let scene = new_scene(self.device);
            set_flags(scene, flags);
            let fill = |geometry: P, kind: u32, format: u32, bytes: &[u8], stride: usize| {
                let target = set_buffer(geometry, kind, 0, format, stride, bytes.len() / stride);
                std::ptr::copy_nonoverlapping(bytes.as_ptr(), target.cast(), bytes.len());
            };
            let triangles = |vertices: &[[f32; 3]], faces: &[[u32; 3]]| {
                let geometry = new_geometry(self.device, 0);
                fill(geometry, 1, 0x9003, bytemuck::cast_slice(vertices), 12);
                fill(geometry, 0, 0x5003, bytemuck::cast_slice(faces), 12);
                commit_geometry(geometry);
                attach(scene, geometry);
                release(geometry);
            };
            let mut inner = None;
            match content {
                Content::Triangles(vertices, faces) => triangles(vertices, faces),
                Content::Instances { placed, placements, others } => {
                    triangles(&others.vertices, &others.faces);
                    let place: Symbol<'_, unsafe extern "C" fn(P, P)> = self.symbol("rtcSetGeometryInstancedScene");
                    type SetTransform = unsafe extern "C" fn(P, u32, u32, *const f32);
                    let set_transform: Symbol<'_, SetTransform> = self.symbol("rtcSetGeometryTransform");
                    let placed = self.scene(&Content::Triangles(&placed.vertices, &placed.faces), flags);
                    for placement in *placements {
                        let geometry = new_geometry(self.device, 121);
                        place(geometry, placed.scene);
                        set_transform(geometry, 0, 0x9134, placement.as_ptr());
                        commit_geometry(geometry);
                        attach(scene, geometry);
                        release(geometry);
                    }
                    inner = Some(Box::new(placed));
                }
                Content::Spheres(spheres) => {
                    let geometry = new_geometry(self.device, 50);
                    fill(geometry, 1, 0x9004, bytemuck::cast_slice(spheres), 16);
                    commit_geometry(geometry);
                    attach(scene, geometry);
                    release(geometry);
                }
            }
            commit(scene);
            Scene {
                embree: Rc::clone(self),
                scene,
                placed: inner,
                intersect: *self.symbol("rtcIntersect1"),
                occluded: *self.symbol("rtcOccluded1"),
            }
        }
    }

    /// # Safety
    /// `T` must be the symbol's type.
    unsafe fn symbol<T>(&self, name: &str) -> Symbol<'_, T> {
        // SAFETY: passed on to the caller.
        unsafe { self.library.get(name.as_bytes()) }.unwrap_or_else(|e| panic!("Embree has no {name}: {e}"))
    }
}

impl Ray {
    fn new(ray: &etalon_geometry::Ray<f32>, t_near: f32) -> Self {
        let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
        Self { origin, t_near, direction, time: 0.0, t_far: ray.t_max, mask: u32::MAX, id: 0, flags: 0 }
    }
}

impl Scene {
    /// The closest hit's distance from `t_near` on, infinite for none, and its primitive.
    pub(crate) fn closest(&self, ray: &etalon_geometry::Ray<f32>, t_near: f32) -> (f32, u32) {
        let hit = Hit { normal: [0.0; 3], uv: [0.0; 2], primitive: INVALID, geometry: INVALID, instance: [INVALID] };
        let mut ray = RayHit { ray: Ray::new(ray, t_near), hit };
        // SAFETY: the scene is committed and alive; the ray and the context are laid out as the header says.
        unsafe { (self.intersect)(self.scene, &mut Context::new(), &mut ray) };
        (if ray.hit.geometry == INVALID { f32::INFINITY } else { ray.ray.t_far }, ray.hit.primitive)
    }

    /// Whether anything is hit from `t_near` on.
    pub(crate) fn occluded(&self, ray: &etalon_geometry::Ray<f32>, t_near: f32) -> bool {
        let mut ray = Ray::new(ray, t_near);
        // SAFETY: as above.
        unsafe { (self.occluded)(self.scene, &mut Context::new(), &mut ray) };
        ray.t_far < 0.0
    }
}

impl Drop for Scene {
    fn drop(&mut self) {
        // SAFETY: the handle is ours and not used again.
        unsafe {
            let release: Symbol<'_, unsafe extern "C" fn(*mut c_void)> = self.embree.symbol("rtcReleaseScene");
            release(self.scene);
        }
        // Held by the scene until now.
        drop(self.placed.take());
    }
}

impl Drop for Embree {
    fn drop(&mut self) {
        // SAFETY: every scene holds a reference to `self`, so none is left.
        unsafe {
            let release: Symbol<'_, unsafe extern "C" fn(*mut c_void)> = self.symbol("rtcReleaseDevice");
            release(self.device);
        }
    }
}
