//! One path again, vertex by vertex.

use crate::film::Counters;
use crate::integrator::film_entry::Received;
use crate::integrator::observer::{End, Found, Observer};
use crate::integrator::tracer::Tracer;
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::polarisation::Polarisation;
use crate::scene::prepare::Prepared;
use etalon_optics::{Lanes, Vec3};
use serde::Serialize;

/// All that happened on one path.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Replay {
    /// Wavelengths, nm; the first is the hero.
    pub wavelengths_nm: Vec<f64>,
    /// What happened, in order.
    pub events: Vec<Event>,
    /// The radiance estimate at each wavelength, W·m⁻²·sr⁻¹·nm⁻¹.
    pub radiance: Vec<f64>,
    /// S₁, S₂ and S₃ at each wavelength, where polarisation is carried: S₁ is light along the picture's right less that along
    /// its up, S₂ along the diagonal that rises to the right less the other, seen from the eye, `radiance` is S₀.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stokes: Option<[Vec<f64>; 3]>,
    /// What the light paths of this sample add to the pixel, CIE XYZ, where such are traced.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub light_paths_xyz: Option<[f64; 3]>,
    /// What the camera path adds to the pixel, CIE XYZ.
    pub xyz: [f64; 3],
}

/// Something that happened on a path.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "event", rename_all = "snake_case")]
pub enum Event {
    /// A surface was met.
    Vertex {
        /// Its number along the path, from 0.
        vertex: u32,
        /// Name of the object.
        object: String,
        /// Position, m.
        position_m: [f64; 3],
        /// Throughput of the path up to here at each wavelength.
        beta: Vec<f64>,
    },
    /// A medium scattered the path.
    Scattering {
        /// Its number along the path, from 0.
        vertex: u32,
        /// Position, m.
        position_m: [f64; 3],
        /// Throughput of the path up to here at each wavelength.
        beta: Vec<f64>,
    },
    /// A surface fluoresced: before it light had these wavelengths.
    Fluorescence {
        /// At which vertex.
        vertex: u32,
        /// Wavelengths that excite it, nm; the first is the hero.
        excitation_nm: Vec<f64>,
    },
    /// Light was added.
    Light {
        /// At which vertex.
        vertex: u32,
        /// How it was found: `emitter`, `environment`, `medium`, `shadow-ray to light k` or `specular-connection to light k`.
        found: String,
        /// How much, at each wavelength.
        radiance: Vec<f64>,
        /// Its part of the sample's Y: those of all light add up to it.
        luminance: f64,
    },
    /// The path ended.
    End {
        /// Why.
        because: &'static str,
    },
}

/// [`Prepared::replay`] by one kernel.
pub(crate) fn replay<M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
    prepared: &Prepared,
    x: u32,
    y: u32,
    sample: u32,
) -> Replay {
    let mut recorder = Recorder { prepared, events: Vec::new() };
    let tracer = Tracer::new(prepared);
    let mut observer: &mut dyn Observer<N> = &mut recorder;
    let path = tracer.sample::<M, P, N>(x, y, sample, &mut Counters::default(), &mut observer);
    let Received { wavelengths, radiance, stokes } = path.received();
    for event in &mut recorder.events {
        if let Event::Light { radiance, luminance, .. } = event {
            *luminance = M::to_xyz(prepared, &wavelengths, Lanes::from_fn(|lane| radiance[lane]))[1];
        }
    }
    Replay {
        wavelengths_nm: wavelengths.lambda_nm.0.to_vec(),
        events: recorder.events,
        radiance: widen(radiance),
        stokes: stokes.map(|stokes| stokes.map(widen)),
        light_paths_xyz: None,
        xyz: M::to_xyz(prepared, &wavelengths, radiance),
    }
}

struct Recorder<'a> {
    prepared: &'a Prepared,
    events: Vec<Event>,
}

fn widen<const N: usize>(lanes: Lanes<f64, N>) -> Vec<f64> {
    lanes.0.to_vec()
}

impl<const N: usize> Observer<N> for Recorder<'_> {
    fn vertex(&mut self, vertex: u32, position: Vec3<f64>, object: u32, beta: Lanes<f64, N>) {
        self.events.push(Event::Vertex {
            vertex,
            object: self.prepared.object(object).map_or_else(String::new, |object| object.name.clone()),
            position_m: self.prepared.frame.to_world_m(position).to_array(),
            beta: widen(beta),
        });
    }

    fn scattering(&mut self, vertex: u32, position: Vec3<f64>, beta: Lanes<f64, N>) {
        let position_m = self.prepared.frame.to_world_m(position).to_array();
        self.events.push(Event::Scattering { vertex, position_m, beta: widen(beta) });
    }

    fn fluoresces(&mut self, vertex: u32, excitation_nm: Lanes<f64, N>) {
        self.events.push(Event::Fluorescence { vertex, excitation_nm: widen(excitation_nm) });
    }

    fn light(&mut self, vertex: u32, how: Found, radiance: Lanes<f64, N>) {
        let found = match how {
            Found::Emitter => "emitter".to_owned(),
            Found::Environment => "environment".to_owned(),
            Found::Medium => "medium".to_owned(),
            Found::ShadowRay { light } => format!("shadow-ray to light {light}"),
            Found::SpecularConnection { light } => format!("specular-connection to light {light}"),
        };
        // The luminance follows once the wavelengths are known that the path has kept.
        self.events.push(Event::Light { vertex, found, radiance: widen(radiance), luminance: 0.0 });
    }

    fn end(&mut self, end: End) {
        let because = match end {
            End::Escaped => "escaped",
            End::Blocked => "blocked by the lens",
            End::Absorbed => "absorbed",
            End::Vanished => "throughput below the floor",
            End::Roulette => "roulette",
            End::Depth => "limit on depth",
            End::NonFinite => "throughput not finite",
        };
        self.events.push(Event::End { because });
    }
}
