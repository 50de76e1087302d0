//! The state of the paths of a set, between two vertices and at one.

use super::rows::{Mask, Row, Rows3, W};
use super::tables::{Form, SLOTS, Slot, Tables};
#[cfg(test)]
use super::tests::{Fault, is_wrong};
use crate::model::WavelengthModel;
use crate::reuse::Gathered;
use crate::sampler::{Sampler, Samplers};
use crate::spectral::PathSpectrum;
use crate::surface::Scattering;
use crate::wavelength::Wavelengths;
use etalon_geometry::{Hit, PrimitiveId, SurfaceId, SurfacePoint};
use etalon_optics::Lanes;

/// All paths of a set.
pub(super) const ALL: Mask = ((1_u64 << W) - 1) as Mask;

/// See the module; names are those of the plain loop.
pub(super) struct Paths<'a, M, const N: usize> {
    /// Which paths there are.
    pub alive: Mask,
    /// Numbers of the samples.
    pub number: [u32; W],
    pub samplers: Samplers<W>,
    pub vertex: [u32; W],
    /// Shadow rays sent so far.
    pub shadow_rays: [u32; W],
    /// The ray, which leaves the surface `leaves`.
    pub origin: Rows3,
    pub direction: Rows3,
    pub leaves: [SurfaceId; W],
    /// The paths whose last step was drawn with `density`, from `from`, where a shadow ray was sent too.
    pub shared: Mask,
    pub from: Rows3,
    pub density: Row,
    pub eta_squared: Row,
    pub aim_factor: Row,
    pub beta: [Lanes<f64, N>; W],
    pub radiance: [Lanes<f64, N>; W],
    pub model: [M; W],
    /// The paths whose lanes have had densities of their own.
    pub parted: Mask,
    pub wavelengths: [Wavelengths<N>; W],
    pub known: Known<N>,
    /// Whether neighbouring pixels share paths, and then what each path brings in.
    pub shares: bool,
    pub gathered: [Gathered<N>; W],
    /// The vertex that each path is at.
    pub at: Vertices<'a>,
}

/// The surfaces that paths have met.
pub(super) struct Vertices<'a> {
    /// Ray parameters, surfaces and their own parameters.
    pub t: Row,
    pub surface: [SurfaceId; W],
    pub uv: [Row; 2],
    pub labels: [u32; W],
    pub position: Rows3,
    pub error: Row,
    pub normal: Rows3,
    /// Of which objects they are.
    pub object: [u32; W],
    /// What they do to light.
    pub form: [Form; W],
    /// That of those without a row form.
    pub scattering: [Option<Scattering<'a>>; W],
}

impl Vertices<'_> {
    /// The point that a path is at.
    #[inline(always)]
    pub(super) fn point(&self, lane: usize) -> SurfacePoint<f64> {
        SurfacePoint {
            position: self.position.at(lane),
            position_error: self.error.0[lane],
            normal: self.normal.at(lane),
            surface: self.surface[lane],
            label: self.labels[lane],
            time: 0.0,
        }
    }

    /// What brought it there.
    #[inline(always)]
    pub(super) fn hit(&self, lane: usize) -> Hit<f64> {
        let uv = [self.uv[0].0[lane], self.uv[1].0[lane]];
        Hit { t: self.t.0[lane], surface: self.surface[lane], uv }
    }
}

impl<M: WavelengthModel<N>, const N: usize> Paths<'_, M, N> {
    /// None yet; numbers will be drawn by samplers of the kind of this one.
    pub(super) fn new(sampler: Sampler, shares: bool) -> Self {
        let nowhere = SurfaceId::from(PrimitiveId::NONE);
        Self {
            alive: 0,
            number: [0; W],
            samplers: Samplers::new(sampler),
            vertex: [0; W],
            shadow_rays: [0; W],
            origin: Rows3::ZERO,
            direction: Rows3::ZERO,
            leaves: [nowhere; W],
            shared: 0,
            from: Rows3::ZERO,
            density: Row::ZERO,
            eta_squared: Row::ZERO,
            aim_factor: Row::ZERO,
            beta: [Lanes::ZERO; W],
            radiance: [Lanes::ZERO; W],
            model: [M::start(); W],
            parted: 0,
            wavelengths: [Wavelengths::fixed([0.0; N]); W],
            known: Known::new(),
            shares,
            gathered: [Gathered::NOTHING; W],
            at: Vertices {
                t: Row::ZERO,
                surface: [nowhere; W],
                uv: [Row::ZERO; 2],
                labels: [0; W],
                position: Rows3::ZERO,
                error: Row::ZERO,
                normal: Rows3::ZERO,
                object: [0; W],
                form: [Form::Other; W],
                scattering: [const { None }; W],
            },
        }
    }
}

/// Values of spectra at the wavelengths of paths: of those that no cells know, evaluated when they are asked for first.
pub(super) struct Known<const N: usize> {
    valid: [u32; W],
    values: [[Lanes<f64, N>; SLOTS]; W],
    /// How far wavelengths are from the whole nanometre before.
    past_nm: [Lanes<f64, N>; W],
}

impl<const N: usize> Known<N> {
    fn new() -> Self {
        Self { valid: [0; W], values: [[Lanes::ZERO; SLOTS]; W], past_nm: [Lanes::ZERO; W] }
    }

    /// Another path, of these wavelengths, takes the place.
    #[inline(always)]
    pub(super) fn forget(&mut self, lane: usize, lambda_nm: &Lanes<f64, N>) {
        #[cfg(test)]
        if is_wrong(Fault::StaleSpectra) && lane == 5 {
            return;
        }
        self.valid[lane] = 0;
        self.past_nm[lane] = lambda_nm.map(past_whole);
    }

    /// A spectrum with a place at the wavelengths of a path.
    #[inline(always)]
    pub(super) fn spectrum(
        &mut self,
        lane: usize,
        slot: u8,
        tables: &Tables,
        wavelengths: &Wavelengths<N>,
    ) -> Lanes<f64, N> {
        let slot = usize::from(slot) % SLOTS;
        if let Some(table) = &tables.by_cells[slot] {
            let [value, step] = table.at(&wavelengths.place);
            return value + self.past_nm[lane] * step;
        }
        if self.valid[lane] >> slot & 1 == 0 {
            self.values[lane][slot] = tables.spectra[slot].lanes(&wavelengths.lambda_nm);
            self.valid[lane] |= 1 << slot;
        }
        self.values[lane][slot]
    }

    /// A spectrum at the wavelengths of a path, with a place or not.
    #[inline(always)]
    pub(super) fn of(
        &mut self,
        lane: usize,
        slot: Slot,
        spectrum: &PathSpectrum,
        tables: &Tables,
        wavelengths: &Wavelengths<N>,
    ) -> Lanes<f64, N> {
        match slot {
            Some(slot) => self.spectrum(lane, slot, tables, wavelengths),
            None => spectrum.lanes(&wavelengths.lambda_nm),
        }
    }
}

/// How far a number is from the whole one before, exactly; in 0 to 2⁵¹.
#[inline(always)]
fn past_whole(x: f64) -> f64 {
    // No double of this size has a fraction: rounded to the nearest whole number.
    const WHOLE: f64 = (1_u64 << 52) as f64;
    let nearest = (x + WHOLE) - WHOLE;
    x - if nearest > x { nearest - 1.0 } else { nearest }
}

#[cfg(test)]
mod tests {
    #[test]
    fn what_is_past_a_whole_number_is_its_fraction() {
        for x in [0.0, 0.25, 0.5, 1.0_f64.next_down(), 1.0, 1.5, 360.0, 360.0_f64.next_up(), 555.49, 555.5, 829.999] {
            assert_eq!(super::past_whole(x), x.fract(), "{x}");
        }
    }
}
