//! The step of a path at a surface that fluoresces: its lanes go on at other wavelengths.
//!
//! The radiance that leaves at λₒ is what the surface reflects of L(λₒ), and ∫ Φ(λᵢ, λₒ) L(λᵢ) dλᵢ, both as a Lambertian surface scatters it
//! (Glassner 1994, *A Model for Fluorescence and Phosphorescence*). A path goes on with one of the two. For the latter it draws N new
//! wavelengths λᵢ, stratified over all that excites the surface. **Each counts for every lane of the camera**: lane k there receives
//! 1/N Σᵢ Φ(λᵢ, λₖ) L(λᵢ)/p(λᵢ). So the path carries a matrix from its lanes to those of the camera, to which the next surface that fluoresces
//! multiplies its own.
//!
//! **Wavelengths and MIS.** The hero of the new wavelengths is drawn independently of that of the old ones. So the density of each pair of heroes
//! is a product, and so is the mean over all pairs. The weight of the path so far goes into the matrix, and the lanes' own densities begin anew.

use super::Path;
use super::observer::Observer;
use super::wavelength_lanes::WavelengthModel;
use crate::bsdf::FluorescentPart;
use crate::polarisation::Polarisation;
use crate::sampler::Sampler;
use crate::scene::interaction::SurfaceInteraction;
use crate::scene::world::World;
use crate::wavelength::Wavelengths;
use etalon_optics::Lanes;

/// What a path has at the camera while its own lanes are at other wavelengths.
pub(super) struct Reradiated<P, const N: usize> {
    /// The wavelengths of the film.
    pub(super) wavelengths: Wavelengths<N>,
    /// What has been received.
    pub(super) polarisation: P,
    /// What one unit of radiance in each lane of the path is worth in the lanes of the camera, over its throughput. One matrix for S₀, and where
    /// polarisation is followed one more each for S₁, S₂ and S₃.
    shares: Vec<[Lanes<f64, N>; N]>,
}

impl<P: Polarisation<N>, const N: usize> Reradiated<P, N> {
    /// What light in the lanes of the path is in S₀ in those of the camera, which receives it.
    fn receive(&mut self, light: Lanes<f64, N>) -> Lanes<f64, N> {
        let at_camera = |shares: &[Lanes<f64, N>; N]| {
            let mut sum = Lanes::ZERO;
            (0..N).for_each(|lane| sum += shares[lane] * light[lane]);
            sum
        };
        if let [_, others @ ..] = &self.shares[..]
            && let Ok(others) = <&[_; 3]>::try_from(others)
        {
            self.polarisation.record(others.each_ref().map(at_camera));
        }
        at_camera(&self.shares[0])
    }
}

impl<'a, M: WavelengthModel<N>, P: Polarisation<N>, const N: usize> Path<'a, M, P, N> {
    /// Adds light that its lanes have found. Returns what that is in the lanes of the camera.
    #[inline(always)]
    pub(super) fn gather(&mut self, found: Lanes<f64, N>) -> Lanes<f64, N> {
        let at_camera = match &mut self.reradiated {
            None => found,
            Some(reradiated) => reradiated.receive(found),
        };
        self.radiance += at_camera;
        at_camera
    }

    /// Chooses at a surface that fluoresces whether the path goes on by reflection, or at wavelengths that excite it. The surface is then a white
    /// Lambertian one.
    pub(super) fn fluoresce(
        &mut self,
        world: &World<'a>,
        vertex: &mut SurfaceInteraction<'a>,
        sampler: &Sampler,
        observer: &mut impl Observer<N>,
    ) {
        if !vertex.surface.fluoresces() {
            return;
        }
        let [u_choice, u_wavelength, u_part, _] = sampler.fluorescence_set(self.vertex);
        let scattering = vertex.scattering_at(world);
        let Some(part) = scattering.fluorescent_part(vertex.wo, u_part) else { return };
        let FluorescentPart { share, reradiation, reflection } = part;
        let lambda_nm = self.wavelengths.lambda_nm;
        let (excitation_nm, width_nm) = reradiation.draw::<N>(u_wavelength);
        let between = reradiation.between(&excitation_nm, &lambda_nm);

        // How much would go on either way under white light: no choice then makes the lanes together worth more than they were.
        let mean_width = |lane: usize| share * width_nm[lane] / N as f64;
        let mut given_back = Lanes::ZERO;
        (0..N).for_each(|lane| given_back += between[lane] * mean_width(lane));
        let reflectance = reflection.reflectance(&lambda_nm, scattering.texture_point());
        let reflected = Lanes::splat(1.0 - share) + reflectance * share;
        let [given_back, reflected] = [given_back, reflected].map(|lanes| (self.beta * lanes).sum());
        let probability = if given_back > 0.0 { given_back / (given_back + reflected) } else { 0.0 };
        if u_choice >= probability {
            self.beta /= 1.0 - probability;
            return;
        }

        // The light of all lanes so far, in the lanes of the camera, for each unit of power per nanometre and lane that comes back.
        let before = self.beta * (self.lanes.weight() / probability);
        let through = |of_camera: &[Lanes<f64, N>; N]| -> [Lanes<f64, N>; N] {
            std::array::from_fn(|new| {
                let mut sum = Lanes::ZERO;
                (0..N).for_each(|old| sum += of_camera[old] * (before[old] * between[new][old] * mean_width(new)));
                sum
            })
        };
        let shares = match &self.reradiated {
            Some(reradiated) => reradiated.shares.iter().map(through).collect(),
            None => {
                let stokes = self.polarisation.of_unpolarised();
                let kept = if P::FOLLOWED { &stokes[..] } else { &stokes[..1] };
                let diagonal = |worth: &Lanes<f64, N>| -> [Lanes<f64, N>; N] {
                    std::array::from_fn(|lane| Lanes::from_fn(|other| if other == lane { worth[lane] } else { 0.0 }))
                };
                kept.iter().map(|worth| through(&diagonal(worth))).collect::<Vec<_>>()
            }
        };
        self.go_on_at(excitation_nm, shares, vertex);
        vertex.scatter_as(scattering.with(&world.surfaces.white));
        self.spectra.forget(&self.wavelengths.lambda_nm, false);
        observer.fluoresces(self.vertex, excitation_nm);
    }

    /// Takes other wavelengths, of which `shares` says what they are worth at the camera.
    fn go_on_at(
        &mut self,
        excitation_nm: Lanes<f64, N>,
        mut shares: Vec<[Lanes<f64, N>; N]>,
        vertex: &SurfaceInteraction<'a>,
    ) {
        // Throughput is the most that a lane is worth to any lane of the camera, as roulette wants it.
        self.beta = Lanes::from_fn(|lane| shares[0][lane].max_lane());
        for of_parameter in &mut shares {
            for (lane, share) in of_parameter.iter_mut().enumerate() {
                *share = if self.beta[lane] > 0.0 { *share / self.beta[lane] } else { Lanes::ZERO };
            }
        }
        // Light leaves the surface unpolarised, whatever comes to it.
        let anew = P::at_camera(-vertex.wo, vertex.point.normal);
        let polarisation = std::mem::replace(&mut self.polarisation, anew);
        let wavelengths = std::mem::replace(&mut self.wavelengths, Wavelengths::fixed(excitation_nm.0));
        match &mut self.reradiated {
            // What was received since the last such surface has gone to the camera.
            Some(reradiated) => reradiated.shares = shares,
            none => *none = Some(Box::new(Reradiated { wavelengths, polarisation, shares })),
        }
        self.lanes = M::start(&self.wavelengths);
    }
}
