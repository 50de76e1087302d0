//! What a path meets next.
//!
//! Where no surface lets light pass and no solids are nested, that is the closest hit. Elsewhere surfaces may coincide: a decal
//! on a table, glass that holds water. All surfaces at one place, up to the errors of their positions, are one **group**, and
//! a path meets its members in this order, whatever order rounding finds them in:
//!
//! 1. surfaces that bound no solid and let a part of the light pass; of several, the object that comes later in the scene first;
//! 2. then an opaque surface that bounds no solid;
//! 3. then the boundaries of solids, all of them as one interface (see [`media`](crate::media)).
//!
//! A path that goes on through a member keeps its ray and meets the rest of the group, each member once. A ray that leaves a
//! member after scattering leaves the whole group: it starts beyond all of them.

use crate::film::Counters;
use crate::media::{Interface, Media, MediumStack, PlacedMedia};
use crate::scene::shading_tables::{BsdfKind, SmoothInterface};
use crate::scene::world::{ShadowRays, World};
use crate::surface::{Scattering, Surface};
use etalon_geometry::{Hit, Passed, Ray, SurfacePoint};
use etalon_optics::Vec3;

/// A surface that a path meets, as BSDFs and lights see it.
pub(crate) struct SurfaceInteraction<'a> {
    pub hit: Hit<f64>,
    pub point: SurfacePoint<f64>,
    /// Toward where the path came from; a unit vector.
    pub wo: Vec3<f64>,
    pub surface: Surface<'a>,
    /// The media on both sides; `None` where the material itself says.
    pub interface: Option<Interface<'a>>,
    /// Whether a path that goes on through it crosses boundaries of solids.
    pub crosses: bool,
    /// Whether it is no surface, only a place where one medium ends and another begins.
    pub is_open: bool,
    pub kind: BsdfKind,
    /// What it reflects of red, green and blue, where [`BsdfKind::Lambert`] asks for it.
    pub colour: [f64; 3],
    /// Whether shadow rays are sent from here.
    pub sees_lights: bool,
    /// What it does to light, where that is general and has been prepared.
    scattering: Option<Scattering<'a>>,
}

impl<'a> SurfaceInteraction<'a> {
    /// Where a ray hits a surface that bounds no solid among others.
    #[inline(always)]
    pub(crate) fn new(ray_direction: Vec3<f64>, hit: Hit<f64>, point: SurfacePoint<f64>, surface: Surface<'a>) -> Self {
        Self {
            hit,
            point,
            wo: -ray_direction,
            surface,
            interface: None,
            crosses: false,
            is_open: false,
            kind: BsdfKind::General,
            colour: [0.0; 3],
            sees_lights: false,
            scattering: None,
        }
    }

    /// The white plate of a meter, seen along its normal. No ray has found it.
    pub(crate) fn of_receiver(point: SurfacePoint<f64>, surface: Surface<'a>) -> Self {
        let hit = Hit { t: 0.0, surface: point.surface, uv: [0.0; 2] };
        Self::new(-point.normal, hit, point, surface)
    }

    /// The same surface, seen from another direction.
    pub(crate) fn seen_from(&self, wo: Vec3<f64>) -> Self {
        Self { wo, ..*self }
    }

    /// Becomes another one, as [`SurfaceInteraction::new`] has it.
    #[inline(always)]
    pub(crate) fn renew(
        &mut self,
        ray_direction: Vec3<f64>,
        hit: Hit<f64>,
        point: SurfacePoint<f64>,
        surface: Surface<'a>,
    ) {
        (self.hit, self.point, self.wo, self.surface) = (hit, point, -ray_direction, surface);
        (self.interface, self.crosses, self.is_open) = (None, false, false);
    }

    /// What lies on both its sides, where it states this itself or is filled.
    pub(crate) fn stated_media(&self) -> Option<PlacedMedia<'a>> {
        Some((self.surface.stated_media()?, self.point.surface.instance))
    }

    /// Whether the path met the side that the normal points into.
    #[inline(always)]
    pub(crate) fn meets_front(&self) -> bool {
        self.point.normal.dot(self.wo) > 0.0
    }

    /// The share of light that meets it.
    #[inline(always)]
    pub(crate) fn opacity(&self, world: &World<'a>) -> f64 {
        if self.is_open { 0.0 } else { self.surface.opacity(world.geometry, &self.point, &self.hit) }
    }

    /// The same, known without a look where there are no masks.
    #[inline(always)]
    pub(crate) fn share_that_stops(&self, world: &World<'a>) -> f64 {
        if world.masks { self.opacity(world) } else { 1.0 }
    }

    /// Whether a direction leads to the other side of the surface.
    #[inline(always)]
    pub(crate) fn goes_through(&self, wi: Vec3<f64>) -> bool {
        self.point.normal.dot(wi) * self.point.normal.dot(self.wo) < 0.0
    }

    /// Whether all light that meets it is reflected or goes through, each in one direction.
    pub(crate) fn is_glass(&self, world: &World<'a>) -> bool {
        world.tables.is_glass(self.surface.material)
    }

    /// Looks up what it does to light.
    #[inline(always)]
    pub(crate) fn prepare_scattering(&mut self, world: &World<'a>) {
        let Surface { object, material, .. } = self.surface;
        self.kind = world.tables.kind(object, material);
        self.sees_lights = match world.shadow_rays {
            ShadowRays::Never => false,
            ShadowRays::WhereUseful => world.tables.has_solid_angle_part(material),
            ShadowRays::Everywhere => true,
        };
        match self.kind {
            BsdfKind::General => {
                self.scattering = Some(self.surface.scattering(world.geometry, &self.point, &self.hit, self.interface));
            }
            BsdfKind::Lambert(None) => {
                self.colour = self.surface.diffuse_colour(world.geometry, &self.point, &self.hit);
            }
            BsdfKind::Lambert(Some(_)) | BsdfKind::Mirror(_) | BsdfKind::Dielectric(_) => {}
        }
    }

    /// What it does to light, of any kind.
    pub(crate) fn scattering_at(&self, world: &World<'a>) -> Scattering<'a> {
        match (self.kind, self.scattering) {
            (BsdfKind::General, Some(prepared)) => prepared,
            _ => self.surface.scattering(world.geometry, &self.point, &self.hit, self.interface),
        }
    }

    /// Does this to light from now on.
    pub(crate) fn scatter_as(&mut self, scattering: Scattering<'a>) {
        (self.kind, self.scattering) = (BsdfKind::General, Some(scattering));
    }

    /// What it does to light, where its kind is general.
    #[inline(always)]
    pub(crate) fn scattering(&self) -> &Scattering<'a> {
        self.scattering.as_ref().expect("general scattering is prepared on arrival")
    }

    /// The indices behind and before the outward normal of a smooth interface, at a wavelength.
    #[inline(always)]
    pub(crate) fn indices(&self, of_material: &SmoothInterface, wavelength_nm: f64) -> [f64; 2] {
        match &self.interface {
            None => of_material.constant.unwrap_or_else(|| of_material.glass.indices(wavelength_nm)),
            Some(media) => {
                let [near, far] = [media.incident, media.transmitted].map(|medium| medium.eval(wavelength_nm));
                if self.meets_front() { [far, near] } else { [near, far] }
            }
        }
    }
}

/// How far a path has come along its ray.
pub(crate) struct Walk<'a> {
    passed: Passed,
    /// The surfaces of the group that was met last, those already passed among them.
    group: Vec<Member>,
    /// The media behind the interface of solids that it met last.
    beyond: MediumStack<'a>,
    /// Boundaries of solids on the way to what it met last that change no medium, by their distance, and the media before each. Kept where
    /// a medium may scatter the path before them.
    crossed: Vec<(f64, MediumStack<'a>)>,
}

impl Default for Walk<'_> {
    fn default() -> Self {
        Self { passed: Passed::default(), group: Vec::new(), beyond: MediumStack::NOTHING, crossed: Vec::new() }
    }
}

/// A surface of a group.
struct Member {
    hit: Hit<f64>,
    point: SurfacePoint<f64>,
    passed: bool,
}

impl<'a> Walk<'a> {
    /// Whether it has passed nothing on its ray.
    #[inline(always)]
    pub(crate) fn begins(&self) -> bool {
        self.passed.is_nothing()
    }

    /// Begins a new ray.
    #[inline(always)]
    pub(crate) fn restart(&mut self) {
        if !self.passed.is_nothing() {
            self.passed.clear();
            self.crossed.clear();
        }
    }

    /// Passes a surface as if it were not there; a boundary together with those that coincide with it. `stack` is brought behind it: a hole
    /// in the surface of a body is a way into it.
    pub(crate) fn pass(&mut self, met: &SurfaceInteraction<'a>, stack: &mut MediumStack<'a>) {
        *stack = self.behind(met, stack);
        match met.crosses {
            true => self.pass_group(),
            false => self.passed.pass(&met.hit, self.first_distance()),
        }
    }

    /// The media at a distance on the way to what it met last, if those that were found there are others.
    pub(crate) fn media_before(&self, distance: f64) -> Option<MediumStack<'a>> {
        self.crossed.iter().find(|(crossed, _)| *crossed > distance).map(|(_, before)| *before)
    }

    /// The media behind what it has met last, before which there are those of `stack`.
    #[inline(always)]
    pub(crate) fn behind(&self, met: &SurfaceInteraction<'a>, stack: &MediumStack<'a>) -> MediumStack<'a> {
        match met.crosses {
            true => self.beyond,
            false => stack.behind(met.stated_media(), met.meets_front()),
        }
    }

    fn pass_group(&mut self) {
        let from = self.first_distance();
        for member in self.group.iter().filter(|member| !member.passed) {
            self.passed.pass(&member.hit, from);
        }
    }

    /// The distance of the closest member that is not passed.
    fn first_distance(&self) -> f64 {
        let ahead = self.group.iter().filter(|member| !member.passed);
        ahead.map(|member| member.hit.t).fold(f64::INFINITY, f64::min)
    }
}

impl<'w> World<'w> {
    /// What the walk along a ray meets next; `stack` is brought before it.
    #[inline(always)]
    pub(crate) fn intersect(
        &self,
        ray: &Ray<f64>,
        walk: &mut Walk<'w>,
        stack: &mut MediumStack<'w>,
        counters: &mut Counters,
    ) -> Option<SurfaceInteraction<'w>> {
        if self.meets_groups {
            let first = self.geometry.next_hit(ray, &walk.passed)?;
            return self.intersect_group(ray, first, walk, stack, counters);
        }
        let hit = self.geometry.closest_hit(ray)?;
        let point = self.geometry.surface(ray, &hit);
        Some(SurfaceInteraction::new(ray.direction, hit, point, self.surfaces.of(&point)))
    }

    /// [`World::intersect`] where surfaces are met in groups; `first` is what the ray hits next.
    pub(crate) fn intersect_group(
        &self,
        ray: &Ray<f64>,
        mut first: Hit<f64>,
        walk: &mut Walk<'w>,
        stack: &mut MediumStack<'w>,
        counters: &mut Counters,
    ) -> Option<SurfaceInteraction<'w>> {
        let media = self.media;
        walk.crossed.clear();
        loop {
            self.gather(ray, walk, first);
            if let Some(number) = self.first_of_group(&walk.group, media) {
                let (hit, point) = leaving_group(&walk.group, number);
                let surface = self.surfaces.of(&point);
                let around = media.filter(|_| surface.takes_medium()).map(|media| media.medium(stack));
                let interface = around.map(|around| Interface { incident: around, transmitted: around });
                return Some(SurfaceInteraction {
                    interface,
                    ..SurfaceInteraction::new(ray.direction, hit, point, surface)
                });
            }
            let media = media.expect("what is no boundary was met above");
            let ahead = walk.group.iter().filter(|member| !member.passed);
            let crossings = ahead.map(|member| {
                (self.surfaces.placed_solid(&member.point), member.point.normal.dot(ray.direction) < 0.0)
            });
            walk.beyond = stack.crossed(crossings, &mut counters.lost_media);
            let deciding = media.deciding(stack, &walk.beyond);
            let is_open =
                deciding.is_none() && self.participating.is_some() && !media.filled_alike(stack, &walk.beyond);
            if is_open || deciding.is_some() {
                let number = walk.group.iter().position(|member| member.hit == first).expect("it is of its group");
                let (hit, point) = leaving_group(&walk.group, number);
                let mut surface = self.surfaces.of(&point);
                if let Some(Some(object)) = deciding {
                    surface.material = self.surfaces.material_of(object);
                }
                let interface = Interface { incident: media.medium(stack), transmitted: media.medium(&walk.beyond) };
                return Some(SurfaceInteraction {
                    interface: Some(interface),
                    crosses: true,
                    is_open,
                    ..SurfaceInteraction::new(ray.direction, hit, point, surface)
                });
            }
            if self.participating.is_some() {
                walk.crossed.push((first.t, *stack));
            }
            *stack = walk.beyond;
            walk.pass_group();
            first = self.geometry.next_hit(ray, &walk.passed)?;
        }
    }

    /// Finds the group of a hit.
    fn gather(&self, ray: &Ray<f64>, walk: &mut Walk<'_>, first: Hit<f64>) {
        let Walk { passed, group, .. } = walk;
        let point = self.geometry.surface(ray, &first);
        group.clear();
        group.push(Member { hit: first, point, passed: false });
        // Each of two positions may be off by its bound. The other's is not known yet: it may be larger, as of what is placed
        // by a transform.
        let reach = 32.0 * point.position_error / point.normal.dot(ray.direction).abs();
        let (from, to) = (first.t - reach, (first.t + reach).min(ray.t_max));
        if !(reach > 0.0 && reach < f64::INFINITY) {
            return;
        }
        self.geometry.all_hits(&Ray { t_max: to, ..*ray }, from.max(0.0), |hit| {
            // A curved surface that is hit twice is two places.
            if group.iter().all(|member| member.hit.surface != hit.surface) {
                let other = self.geometry.surface(ray, &hit);
                if distance(&point, &other) <= 2.0 * (point.position_error + other.position_error) {
                    group.push(Member { hit, point: other, passed: passed.holds(&hit) });
                }
            }
            to
        });
    }

    /// The member of a group that a path meets before the boundaries of solids, if there is one.
    fn first_of_group(&self, group: &[Member], media: Option<&Media>) -> Option<usize> {
        let is_boundary =
            |member: &Member| media.is_some_and(|media| media.is_boundary(self.surfaces.of(&member.point).object));
        let ahead = || group.iter().enumerate().filter(|(_, member)| !member.passed && !is_boundary(member));
        if group.len() == 1 {
            return ahead().next().map(|(number, _)| number);
        }
        let rank = |member: &Member| {
            let surface = self.surfaces.of(&member.point);
            let lets_pass = surface.opacity(self.geometry, &member.point, &member.hit) < 1.0;
            // Of opaque surfaces the closest, of others the last object.
            (lets_pass, if lets_pass { f64::from(surface.object) } else { -member.hit.t }, member.hit.surface)
        };
        let best = ahead().max_by(|(_, a), (_, b)| rank(a).partial_cmp(&rank(b)).expect("distances are numbers"));
        best.map(|(number, _)| number)
    }
}

/// A member of a group, its bound of errors so wide that a ray which leaves its point leaves the group.
fn leaving_group(group: &[Member], number: usize) -> (Hit<f64>, SurfacePoint<f64>) {
    let Member { hit, mut point, .. } = group[number];
    let own = point.position_error;
    for other in group {
        if other.hit.surface != hit.surface {
            point.position_error =
                point.position_error.max(distance(&point, &other.point) + other.point.position_error + own);
        }
    }
    (hit, point)
}

/// How far the plane of one point is from another.
fn distance(point: &SurfacePoint<f64>, other: &SurfacePoint<f64>) -> f64 {
    (other.position - point.position).dot(point.normal).abs()
}
