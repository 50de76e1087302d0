//! One path from a lamp, by way of specular objects, to the surfaces that it lights; each of them is connected to the camera.

use crate::bsdf::lambert;
use crate::film::{Counters, PixelRect};
use crate::guiding::SpecularObjects;
use crate::integrator::tracer::Tracer;
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::integrator::{Direction, MOST_VERTICES, Path, Start};
use crate::light::{LightSample, Target};
use crate::media::MediumStack;
use crate::mis::Density;
use crate::polarisation::Polarisation;
use crate::sampler::Sampler;
use crate::scene::interaction::SurfaceInteraction;
use crate::scene::shading_tables::BsdfKind;
use etalon_geometry::{Hit, Ray, SurfaceId};
use etalon_optics::{Lanes, Vec3};

/// The pixels of the film end before this number: light paths have random numbers of their own.
const LIGHT_PATHS: u64 = 1 << 63;

/// What a light path brings to the picture at one of its vertices.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Connection {
    /// The place on the film, in pixels from its upper left corner.
    pub place_px: [f64; 2],
    /// What a pixel receives there whose filter has a density of 1 at this place, CIE XYZ.
    pub xyz: [f64; 3],
}

/// Where a light path begins: on a specular object, lit by a lamp.
struct Beginning<'a, const N: usize> {
    vertex: SurfaceInteraction<'a>,
    /// The power that it stands for at each wavelength, if it is the only one of its sample.
    power: Lanes<f64, N>,
}

/// Follows light path number `number` of the `of` of a sample, in the place of `path`. What it brings to the pixels of a rectangle is given to `put`.
pub(crate) fn trace_light_path<'a, M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
    tracer: &Tracer<'a>,
    path: &mut Path<'a, M, P, N>,
    specular_objects: &SpecularObjects,
    (number, of): (u64, u64),
    (sample, rect): (u32, PixelRect),
    counters: &mut Counters,
    put: &mut dyn FnMut(Connection),
) {
    let (world, integrator) = (&tracer.world, &tracer.prepared.scene.integrator);
    let sampler = Sampler::new(integrator.sampler, tracer.seed, LIGHT_PATHS | number, sample, integrator.replicates);
    let [u_wavelength, ..] = sampler.set(1);
    let wavelengths = M::wavelengths_of_light(tracer.prepared, u_wavelength);
    let (ray, right) = (Ray::free(Vec3::ZERO, Vec3::new(0.0, 0.0, 1.0)), Vec3::new(1.0, 0.0, 0.0));
    let polarisation = P::at_camera(ray.direction, right);
    path.begin(
        world,
        &Start { ray, stack: Some(MediumStack::NOTHING), wavelengths, polarisation, weight: 1.0, hero_only: false },
    );
    let Some(Beginning { mut vertex, power }) = begin(tracer, specular_objects, path, (number, of), &sampler, counters)
    else {
        return;
    };
    let mut lights = false;
    loop {
        let is_specular = specular_objects.contains(vertex.surface.object);
        // Straight from the lamp, shadow rays of camera paths find it.
        lights |= !is_specular;
        if lights
            && let Some(connection) = connect(tracer, path, &vertex, (power / of as f64, rect), &sampler, counters)
        {
            put(connection);
        }
        if path.vertex + 2 >= MOST_VERTICES {
            return;
        }
        let [u_lobe, u1, u2, u_roulette] = sampler.vertex_set(path.vertex, 0);
        let u = [u_lobe, u1, u2];
        let Some(direction) = sample_direction(tracer, path, &vertex, (is_specular, u), &sampler) else { return };
        let Some(wi) = step(tracer, path, &vertex, direction, (is_specular, u_lobe)) else { return };
        // From the lamp to each vertex, to the next, and to the camera.
        if path.edges(3) > world.max_depth {
            return;
        }
        if !path.survives(world, 1.0, u_roulette, &mut ()) {
            return;
        }
        counters.rays += 1;
        let ray = vertex.point.spawn(wi);
        let Some(met) = world.intersect(&ray, &mut path.walk, &mut path.stack, counters) else { return };
        vertex = met;
        vertex.prepare_scattering(world);
    }
}

/// Draws a point of the specular objects, and a lamp that lights it.
fn begin<'a, M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
    tracer: &Tracer<'a>,
    specular_objects: &SpecularObjects,
    path: &mut Path<'a, M, P, N>,
    (path_number, of): (u64, u64),
    sampler: &Sampler,
    counters: &mut Counters,
) -> Option<Beginning<'a, N>> {
    let world = &tracer.world;
    let [u1, u2, u_place, u_light] = sampler.set(0);
    // The paths of a sample are spread evenly over the area.
    let u_place = (path_number as f64 + u_place) / of as f64;
    let (surface, position) = specular_objects.point(world.geometry, u_place, [u1, u2])?;
    let hit = Hit { t: 0.0, surface, uv: world.geometry.parameters(surface, position, 0.0) };
    let point = world.geometry.surface(&Ray::free(position, Vec3::new(0.0, 0.0, 1.0)), &hit);

    // As a shadow ray finds it. The faint part of a sky is left to camera paths.
    let [_, light_1, light_2, _] = sampler.vertex_set(0, 1);
    let (number, probability) = world.lights.choose(point.position, u_light)?;
    let light = &world.lights.lights()[number];
    if light.source().is_some() && !specular_objects.finds_sources {
        return None;
    }
    let sample = light.sample(point.position, [light_1, light_2], point.time)?;
    let LightSample { wi: toward_lamp, density, scale, target, colour, .. } = sample;
    let mut vertex = SurfaceInteraction::new(-toward_lamp, hit, point, world.surfaces.of(&point));
    path.visibility(world, &vertex, &sample, counters)?;
    let density = match density {
        Density::Delta => 1.0,
        Density::SolidAngle(density) => density,
    };
    let cos = point.normal.dot(toward_lamp).abs();
    let colour = colour.or_else(|| world.colour_of_emitter(number as u32, target, point.time));
    let white = path.spectrum_of_light(world, number as u32);
    let scale = scale * light.bright_share(toward_lamp);
    let power = path.coloured(white, colour) * (scale * cos * specular_objects.area() / (density * probability));
    vertex.prepare_scattering(world);
    Some(Beginning { vertex, power })
}

/// Draws where light goes on to.
fn sample_direction<'a, M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
    tracer: &Tracer<'a>,
    path: &mut Path<'a, M, P, N>,
    vertex: &SurfaceInteraction<'a>,
    (is_specular, u): (bool, [f64; 3]),
    sampler: &Sampler,
) -> Option<Direction<N>> {
    if !is_specular || vertex.kind != BsdfKind::General {
        return path.sample_direction(&tracer.world, vertex, u, &mut ());
    }
    // Around a bent normal, the way back is another.
    let [u_meant, _, _, u_viewer] = sampler.vertex_set(path.vertex, 1);
    let lambda_nm = &path.wavelengths.lambda_nm;
    let (mut sample, power) = vertex.scattering().sample_viewer(lambda_nm, vertex.wo, u, [u_meant, u_viewer])?;
    sample.weight *= power;
    Some(Direction::General { sample, guiding: 1.0 })
}

/// Takes a step along the light: `None` where light paths do not go on.
fn step<'a, M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
    tracer: &Tracer<'a>,
    path: &mut Path<'a, M, P, N>,
    vertex: &SurfaceInteraction<'a>,
    direction: Direction<N>,
    (is_specular, u_lobe): (bool, f64),
) -> Option<Vec3<f64>> {
    let world = &tracer.world;
    let density = match &direction {
        Direction::Diffuse { cos, .. } => Density::SolidAngle(lambert::density(*cos)),
        Direction::Mirrored(_) | Direction::Turned { .. } => Density::Delta,
        Direction::General { sample, .. } => sample.density,
    };
    // Backward and forward, smooth surfaces do the same, but for η², which the path keeps apart.
    let Density::SolidAngle(density) = density else {
        return is_specular.then(|| path.scatter(world, vertex, direction, u_lobe).wi);
    };
    // What light from behind becomes toward the next vertex: the camera's own formula, of power instead of radiance.
    let power = path.beta * path.eta_squared;
    let toward_light = vertex.wo;
    let wi = path.scatter(world, vertex, direction, u_lobe).wi;
    let seen = vertex.seen_from(wi);
    let (f_cos, _) = path.eval(world, &seen, toward_light);
    let [arriving, leaving] = [toward_light, wi].map(|direction| vertex.point.normal.dot(direction).abs());
    path.beta = power * f_cos * (leaving / (arriving * density));
    path.eta_squared = 1.0;
    Some(wi)
}

/// What the camera sees of the light that arrives at a vertex.
fn connect<'a, M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
    tracer: &Tracer<'a>,
    path: &mut Path<'a, M, P, N>,
    vertex: &SurfaceInteraction<'a>,
    (power, rect): (Lanes<f64, N>, PixelRect),
    sampler: &Sampler,
    counters: &mut Counters,
) -> Option<Connection> {
    let world = &tracer.world;
    if !world.tables.has_solid_angle_part(vertex.surface.material) {
        return None;
    }
    let [_, lens_1, lens_2, _] = sampler.vertex_set(path.vertex, 1);
    let seen = tracer.camera.project(vertex.point.position, [lens_1, lens_2])?;
    let film = &tracer.prepared.scene.film;
    let (width, height) = (f64::from(film.width), f64::from(film.height));
    let place_px = [0.5 * (seen.film[0] + 1.0) * width, 0.5 * (1.0 - seen.film[1]) * height];
    let reach = tracer.prepared.filter_reach_px();
    let reaches = |place: f64, first: u32, end: u32| {
        (f64::from(first) + 0.5 - reach..=f64::from(end) - 0.5 + reach).contains(&place)
    };
    if !reaches(place_px[0], rect.x0, rect.x1) || !reaches(place_px[1], rect.y0, rect.y1) {
        return None;
    }
    let (f_cos, _) = path.eval(world, &vertex.seen_from(seen.toward), vertex.wo);
    if f_cos.is_zero() {
        return None;
    }
    let (target, surface) = (Target::Point(seen.origin), SurfaceId::NONE);
    let to_camera = LightSample { wi: seen.toward, density: Density::Delta, target, surface, scale: 1.0, colour: None };
    path.visibility(world, vertex, &to_camera, counters)?;
    // Power arrives on an area of the surface itself, and the film sees that area from its own side.
    let [arriving, leaving] = [vertex.wo, seen.toward].map(|direction| vertex.point.normal.dot(direction).abs());
    let pixels = 0.25 * width * height * seen.magnification;
    let weight = path.lanes.weight() * path.eta_squared * leaving * pixels / arriving;
    let xyz = M::to_xyz(tracer.prepared, &path.wavelengths, power * path.beta * f_cos * weight);
    Some(Connection { place_px, xyz })
}
