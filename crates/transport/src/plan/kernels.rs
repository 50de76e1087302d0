//! The kinds of kernels: what a path carries. Each costs build time and size; what can be a branch at run time stays one.

use super::{Carried, LaneModel};

/// Wavelengths that a path carries where they differ.
pub(crate) const LANES: usize = 8;

/// What the paths of a kernel carry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct KernelKind {
    /// The model and the number of lanes.
    pub name: &'static str,
    pub lanes: LaneModel,
    /// Lanes of a path.
    pub lane_count: usize,
    /// Whether they carry Stokes vectors.
    pub polarised: bool,
    /// Whether neighbouring pixels can share paths.
    pub shares_paths: bool,
    /// The study that it is for; no plan chooses it otherwise.
    carried: Option<Carried>,
}

const fn kind(name: &'static str, lanes: LaneModel, lane_count: usize) -> KernelKind {
    KernelKind { name, lanes, lane_count, polarised: false, shares_paths: false, carried: None }
}

const fn shared(kind: KernelKind) -> KernelKind {
    KernelKind { shares_paths: true, ..kind }
}

const fn polarised(kind: KernelKind) -> KernelKind {
    KernelKind { polarised: true, ..kind }
}

const fn of_study(carried: Carried, kind: KernelKind) -> KernelKind {
    KernelKind { carried: Some(carried), ..kind }
}

pub(crate) static ONE_LANE: KernelKind = shared(kind("one-lane", LaneModel::One, 1));
pub(crate) static SHARED: KernelKind = shared(kind("shared-8", LaneModel::Shared, LANES));
pub(crate) static HERO: KernelKind = shared(kind("hero-8", LaneModel::Hero, LANES));
pub(crate) static POLARISED_SHARED: KernelKind = polarised(kind("polarised-shared-8", LaneModel::Shared, LANES));
pub(crate) static POLARISED_HERO: KernelKind = polarised(kind("polarised-hero-8", LaneModel::Hero, LANES));
pub(crate) static ONE_WAVELENGTH: KernelKind = of_study(Carried::OneWavelength, kind("hero-1", LaneModel::Hero, 1));
pub(crate) static FOUR_WAVELENGTHS: KernelKind = of_study(Carried::FourWavelengths, kind("hero-4", LaneModel::Hero, 4));
pub(crate) static THREE_CHANNELS: KernelKind =
    of_study(Carried::ThreeChannels, kind("three-channels", LaneModel::ThreeChannels, 3));

/// All of them.
pub(crate) static ALL: [&KernelKind; 8] = [
    &ONE_LANE,
    &SHARED,
    &HERO,
    &POLARISED_SHARED,
    &POLARISED_HERO,
    &ONE_WAVELENGTH,
    &FOUR_WAVELENGTHS,
    &THREE_CHANNELS,
];

/// The kind that a plan chooses; a study says what paths carry instead.
pub(super) fn choose(lanes: LaneModel, polarised: bool, carried: Option<Carried>) -> &'static KernelKind {
    let fits = |kind: &&&KernelKind| match carried {
        None => kind.carried.is_none() && kind.lanes == lanes && kind.polarised == polarised,
        Some(_) => kind.carried == carried,
    };
    ALL.iter().find(fits).expect("there is one for every model of wavelengths")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn there_is_a_kind_for_every_choice_and_each_has_a_name_of_its_own() {
        let names: HashSet<_> = ALL.iter().map(|kind| kind.name).collect();
        assert_eq!(names.len(), ALL.len());
        for lanes in [LaneModel::One, LaneModel::Shared, LaneModel::Hero] {
            assert_eq!(choose(lanes, false, None).lanes, lanes);
        }
        for lanes in [LaneModel::Shared, LaneModel::Hero] {
            assert!(choose(lanes, true, None).polarised);
        }
        for carried in [Carried::OneWavelength, Carried::FourWavelengths, Carried::ThreeChannels] {
            assert_eq!(choose(LaneModel::Hero, false, Some(carried)).carried, Some(carried));
        }
    }
}
