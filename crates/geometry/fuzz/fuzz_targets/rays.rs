//! Arbitrary shapes, instances and rays: nothing panics; the tree, and what serves few primitives, one ray or eight at once,
//! answer what the primitives answer one by one; and what they answer makes sense.
#![no_main]

use etalon_geometry::{
    Cylinder, Disk, Geometry, Instance, LANES, Parallelogram, Placement, Primitive, PrimitiveId, Ray, Rays, Sphere,
    SurfaceId, Triangle,
};
use etalon_optics::{Real, Vec3};
use libfuzzer_sys::fuzz_target;
use std::sync::Arc;

/// Numbers made of bytes, zeros after the last.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn byte(&mut self) -> u8 {
        self.take::<1>()[0]
    }

    fn take<const N: usize>(&mut self) -> [u8; N] {
        let mut out = [0; N];
        let n = N.min(self.0.len());
        out[..n].copy_from_slice(&self.0[..n]);
        self.0 = &self.0[n..];
        out
    }

    /// On a coarse grid, so that things coincide; a single or a double of any bits; or a power of two.
    fn number(&mut self) -> f64 {
        match self.byte() {
            0..=119 => f64::from(self.byte() as i8) / 16.0,
            120..=179 => f64::from(i16::from_le_bytes(self.take())) / 4096.0,
            180..=219 => f64::from(f32::from_le_bytes(self.take())),
            220..=239 => f64::from_le_bytes(self.take()),
            240..=247 => 2.0_f64.powi(i32::from(self.byte() as i8)),
            _ => [0.0, -0.0, 1.0, -1.0, f64::NAN, f64::INFINITY, f64::MIN_POSITIVE, f64::MAX][self.byte() as usize % 8],
        }
    }

    fn vector(&mut self) -> Vec3<f64> {
        Vec3::new(self.number(), self.number(), self.number())
    }

    fn shape(&mut self, vertices: &[Vec3<f64>]) -> Option<Primitive> {
        let kind = self.byte();
        let mut corner = || match vertices {
            [] => self.vector(),
            _ => vertices[self.byte() as usize % vertices.len()],
        };
        match kind % 8 {
            0 => Sphere::new(corner(), self.number()).ok().map(Primitive::from),
            1 => Disk::new(corner(), self.vector(), self.number()).ok().map(Primitive::from),
            2 => Cylinder::new(corner(), corner(), self.number(), kind >= 128).ok().map(Primitive::from),
            3 => Parallelogram::new(corner(), self.vector(), self.vector()).ok().map(Primitive::from),
            _ => Triangle::new(corner(), corner(), corner()).ok().map(Primitive::from),
        }
    }

    fn shapes(&mut self) -> Vec<Primitive> {
        let vertices: Vec<_> = (0..self.byte() % 32).map(|_| self.vector()).collect();
        (0..self.byte()).filter_map(|_| self.shape(&vertices)).collect()
    }
}

/// Eight rays at once against each alone, to the bit.
fn check_eight(geometry: &Geometry, rays: &Rays, active: u8) {
    let (hits, any) = (geometry.closest_hits(rays, active), geometry.any_hits(rays, active));
    let points = geometry.surfaces(rays, &hits, hits.mask);
    for lane in 0..LANES {
        let (ray, wanted) = (rays.get(lane), active >> lane & 1 == 1);
        let hit = geometry.closest_hit(&ray).filter(|_| wanted);
        assert_eq!(hits.get(lane), hit, "{ray:?}");
        assert_eq!(any >> lane & 1 == 1, wanted && geometry.occluded(&ray), "{ray:?}");
        if let Some(hit) = hit {
            assert_eq!(format!("{:?}", points.get(lane)), format!("{:?}", geometry.surface(&ray, &hit)), "{ray:?}");
        }
    }
}

fn check<R: Real>(geometry: &Geometry, alone: &[Geometry], bytes: &mut Bytes<'_>) -> Ray<f64> {
    let ids = alone.len() as u32;
    let id = |b: u8| if b < 128 { PrimitiveId::NONE } else { PrimitiveId(u32::from(b) % ids.max(1)) };
    let (leaves, aims_at) = (id(bytes.byte()), id(bytes.byte()));
    let ray = Ray::<R> {
        origin: bytes.vector().cast(),
        direction: bytes.vector().cast(),
        t_max: R::from_f64(bytes.number()),
        leaves: leaves.into(),
        aims_at: aims_at.into(),
        time: 0.0,
    };
    let wide = Ray {
        origin: ray.origin.to_f64(),
        direction: ray.direction.to_f64(),
        t_max: ray.t_max.to_f64(),
        leaves: ray.leaves,
        aims_at: ray.aims_at,
        time: ray.time,
    };
    assert_eq!((geometry.closest_hit(&wide), geometry.occluded(&wide)), geometry.one_by_one(&wide), "{wide:?}");
    let mine = |id: PrimitiveId, i: usize| if id.0 == i as u32 { PrimitiveId(0).into() } else { SurfaceId::NONE };
    let one = |i: usize| Ray { leaves: mine(leaves, i), aims_at: mine(aims_at, i), ..ray };
    // The lowest of the nearest.
    let mut nearest = None;
    for (i, geometry) in alone.iter().enumerate() {
        if let Some(hit) = geometry.closest_hit(&one(i))
            && nearest.is_none_or(|(t, _)| hit.t < t)
        {
            nearest = Some((hit.t, i));
        }
    }
    let hit = geometry.closest_hit(&ray);
    if R::UNIT_ROUNDOFF.to_f64() == f64::UNIT_ROUNDOFF {
        let found = hit.map(|hit| {
            // An instance's own surfaces count as the instance.
            let item = geometry.path(hit.surface).first().map_or(hit.surface.primitive.0, |instance| instance.0);
            (hit.t, item as usize)
        });
        // Distances so small that the units of the ray round them may be equal there and yet differ: the nearest was
        // found by what they were before.
        let told = |(t, item): (R, usize)| (t, Some(item).filter(|_| t.to_f64() >= f64::MIN_POSITIVE));
        assert_eq!(found.map(told), nearest.map(told), "{ray:?}");
    }
    let occluded = alone.iter().enumerate().any(|(i, geometry)| geometry.occluded(&one(i)));
    assert_eq!(geometry.occluded(&ray), occluded, "{ray:?}");
    let Some(hit) = hit else { return wide };
    assert!(hit.t >= R::ZERO && hit.t <= ray.t_max, "{hit:?}");
    assert!(hit.uv.iter().all(|w| (R::ZERO..=R::ONE).contains(w)), "{hit:?}");
    let point = geometry.surface(&ray, &hit);
    assert!(!point.position_error.to_f64().is_nan(), "{ray:?} {hit:?} {point:?}");
    let next = point.spawn(point.normal);
    if let Some(hit) = geometry.closest_hit(&next) {
        geometry.surface(&next, &hit);
    }
    geometry.occluded(&point.spawn_to(ray.origin, SurfaceId::NONE));
    wide
}

fuzz_target!(|data: &[u8]| {
    let mut bytes = Bytes(data);
    let mut shapes = bytes.shapes();
    if bytes.byte() % 4 == 0 {
        let flat_limit = if bytes.byte() % 2 == 0 { 0 } else { 128 };
        let inner = Arc::new(Geometry::build_with(bytes.shapes(), flat_limit).expect("few"));
        for _ in 0..bytes.byte() % 16 {
            let rows = [bytes.vector(), bytes.vector(), bytes.vector()].map(Vec3::to_array);
            let placement = Placement::new(rows, bytes.vector().to_array());
            shapes.extend(placement.and_then(|p| Instance::new(inner.clone(), p)).map(Primitive::from));
        }
    }
    let alone: Vec<Geometry> = shapes.iter().map(|s| Geometry::build(vec![s.clone()]).expect("one")).collect();
    let flat_limit = if bytes.byte() % 2 == 0 { 0 } else { 128 };
    let geometry = Geometry::build_with(shapes, flat_limit).expect("few");
    let mut rays = Rays::NONE;
    for i in 0..16 {
        rays.set(i % LANES, &check::<f64>(&geometry, &alone, &mut bytes));
        check::<f32>(&geometry, &alone, &mut bytes);
        if bytes.0.is_empty() {
            break;
        }
    }
    check_eight(&geometry, &rays, bytes.byte().wrapping_sub(1));
});
