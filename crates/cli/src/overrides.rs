//! Settings of a scene that the command line may override.

use std::ops::Deref;

use clap::parser::ValueSource;
use clap::{ArgMatches, Args, Command, FromArgMatches, ValueEnum};
use etalon_scene::{Bands, LightSampling, LightTracing, MOST_REPLICATES, PathReuse, SamplerKind, Scene};
use etalon_transport::{Carried, EffectName, PathLoop, Study};
use miette::miette;

use crate::args::{BandsArg, Size};
use crate::failure::Failure;

/// What the command line decides instead of the scene, and how it was said.
pub(crate) struct Overrides {
    settings: Settings,
    words: Vec<String>,
}

/// The heading of the scene's settings in `--help`.
const SETTINGS: &str = "Settings of the scene (default: what the scene says)";

/// The heading of options that change how a scene is traced in `--help`.
const STUDY: &str = "For study";

/// The list of all options that may decide something instead of the scene. Farm jobs and hints repeat those that were given.
#[derive(Args)]
pub(crate) struct Settings {
    /// Samples per pixel, such as 64 or 1e3.
    #[arg(long, value_name = "N", help_heading = SETTINGS, value_parser = crate::args::samples)]
    spp: Option<u32>,
    /// Number of independent replicates. Their scatter gives the error bars; 1 disables error bars.
    #[arg(long, value_name = "N", help_heading = SETTINGS, value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST_REPLICATES)))]
    replicates: Option<u32>,
    /// Seed of the random numbers.
    #[arg(long, value_name = "N", help_heading = SETTINGS)]
    seed: Option<u64>,
    /// Width and height of the picture in pixels, such as 640x480.
    #[arg(long, value_name = "WxH", help_heading = SETTINGS)]
    size: Option<Size>,
    /// Value of a parameter of a Mitsuba scene, in the place of its <default>. The option may be repeated.
    #[arg(short = 'D', long = "define", value_name = "NAME=VALUE", help_heading = SETTINGS, value_parser = crate::args::parameter)]
    define: Vec<(String, String)>,
    /// Sequence of random numbers.
    #[arg(long, value_enum, help_heading = SETTINGS)]
    sampler: Option<SamplerArg>,
    /// How paths find light.
    #[arg(long, value_enum, help_heading = SETTINGS)]
    light_sampling: Option<LightSamplingArg>,
    /// Paths from the lamps, for what mirrors and smooth glass throw on the scene.
    #[arg(long, value_enum, value_name = "WHEN", help_heading = SETTINGS)]
    light_tracing: Option<LightTracingArg>,
    /// Blocks of neighbouring pixels that share paths. There is less noise, but the errors within a block are correlated.
    #[arg(long, value_enum, value_name = "BLOCK", help_heading = SETTINGS)]
    path_reuse: Option<PathReuseArg>,
    /// Largest number of path edges from the camera to a light: 1 shows only emitters, 2 adds direct light.
    #[arg(long, value_name = "N", help_heading = SETTINGS, value_parser = clap::value_parser!(u32).range(1..))]
    max_depth: Option<u32>,
    /// Keep spectral bands beside the colour, such as 400:700:10. FIRST and LAST are centres of bands. STEP is the width of each band and
    /// the distance between centres. All are in nm. The EXR channels are S0.400,000000nm and so on.
    #[arg(long, value_name = "FIRST:LAST:STEP", help_heading = SETTINGS)]
    bands: Option<BandsArg>,
    /// Trace the polarisation of light. Without it, surfaces average s and p polarisation.
    #[arg(long, help_heading = SETTINGS)]
    polarised: bool,
    /// Simulate an effect that the scene does not need (see `etalon explain`).
    #[arg(long, value_name = "EFFECT", value_delimiter = ',', help_heading = STUDY)]
    force: Vec<EffectName>,
    /// Leave out an effect that the scene needs. The picture is then an approximation, and its file says so.
    #[arg(long, value_name = "EFFECT", value_delimiter = ',', help_heading = STUDY)]
    without: Vec<EffectName>,
    /// What each path carries. Default: as many wavelengths as the scene needs.
    #[arg(long, value_enum, value_name = "WHAT", help_heading = STUDY)]
    carry: Option<CarryArg>,
    /// Trace one path at a time, or many at once. Both give the same picture, bit for bit. Default: the faster one.
    #[arg(long = "loop", value_enum, value_name = "WHICH", help_heading = STUDY)]
    path_loop: Option<PathLoopArg>,
    /// Try nothing before the picture: sample diffuse directions by the cosine, and wavelengths alike in every pixel. Light paths are then traced only with --light-tracing always.
    #[arg(long, help_heading = STUDY)]
    by_cosine: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum PathLoopArg {
    /// One path at a time.
    Scalar,
    /// Many paths at once.
    Batch,
}

impl From<PathLoopArg> for PathLoop {
    fn from(arg: PathLoopArg) -> Self {
        match arg {
            PathLoopArg::Scalar => Self::Scalar,
            PathLoopArg::Batch => Self::Batch,
        }
    }
}

#[derive(Clone, Copy, ValueEnum)]
enum PathReuseArg {
    /// Pixels share no paths.
    None,
    /// Blocks of 2 × 2 pixels.
    #[value(name = "2x2")]
    Block2x2,
    /// Blocks of 4 × 2 pixels.
    #[value(name = "4x2")]
    Block4x2,
    /// Blocks of 4 × 4 pixels.
    #[value(name = "4x4")]
    Block4x4,
}

impl From<PathReuseArg> for PathReuse {
    fn from(arg: PathReuseArg) -> Self {
        match arg {
            PathReuseArg::None => Self::None,
            PathReuseArg::Block2x2 => Self::Block2x2,
            PathReuseArg::Block4x2 => Self::Block4x2,
            PathReuseArg::Block4x4 => Self::Block4x4,
        }
    }
}

#[derive(Clone, Copy, ValueEnum)]
enum SamplerArg {
    /// Owen-scrambled Sobol points.
    Sobol,
    /// Independent pseudorandom numbers.
    Independent,
}

#[derive(Clone, Copy, ValueEnum)]
enum LightSamplingArg {
    /// Shadow rays and BSDF sampling, combined by multiple importance sampling.
    Mis,
    /// Shadow rays only.
    Light,
    /// BSDF sampling only.
    Bsdf,
}

#[derive(Clone, Copy, ValueEnum)]
enum LightTracingArg {
    /// If a trial before the picture finds less noise for the time.
    Auto,
    /// Never.
    Never,
    /// Wherever light paths are possible.
    Always,
}

impl From<LightTracingArg> for LightTracing {
    fn from(arg: LightTracingArg) -> Self {
        match arg {
            LightTracingArg::Auto => Self::Auto,
            LightTracingArg::Never => Self::Never,
            LightTracingArg::Always => Self::Always,
        }
    }
}

#[derive(Clone, Copy, ValueEnum)]
enum CarryArg {
    /// One wavelength.
    OneWavelength,
    /// Four wavelengths.
    FourWavelengths,
    /// Red, green and blue. The colour of each light and surface replaces its spectrum, so the picture is an approximation.
    ThreeChannels,
}

impl From<CarryArg> for Carried {
    fn from(carry: CarryArg) -> Self {
        match carry {
            CarryArg::OneWavelength => Self::OneWavelength,
            CarryArg::FourWavelengths => Self::FourWavelengths,
            CarryArg::ThreeChannels => Self::ThreeChannels,
        }
    }
}

impl Settings {
    /// Whether polarisation is asked for.
    pub(crate) fn polarised(&self) -> bool {
        self.polarised
    }

    /// Samples a pixel, if given.
    pub(crate) fn spp(&self) -> Option<u32> {
        self.spp
    }

    /// Puts them into a scene, or says why that cannot be.
    pub(crate) fn apply(&self, scene: &mut Scene) -> Result<(), Failure> {
        let integrator = &mut scene.integrator;
        if let Some(spp) = self.spp {
            integrator.spp = spp;
        }
        if let Some(replicates) = self.replicates {
            integrator.replicates = replicates;
        }
        if let Some(seed) = self.seed {
            integrator.seed = seed;
        }
        if let Some(sampler) = self.sampler {
            integrator.sampler = match sampler {
                SamplerArg::Sobol => SamplerKind::Sobol,
                SamplerArg::Independent => SamplerKind::Independent,
            };
        }
        if let Some(light_sampling) = self.light_sampling {
            integrator.light_sampling = match light_sampling {
                LightSamplingArg::Mis => LightSampling::Mis,
                LightSamplingArg::Light => LightSampling::Light,
                LightSamplingArg::Bsdf => LightSampling::Bsdf,
            };
        }
        if let Some(light_tracing) = self.light_tracing {
            integrator.light_tracing = light_tracing.into();
        }
        if let Some(path_reuse) = self.path_reuse {
            integrator.path_reuse = path_reuse.into();
        }
        if self.max_depth.is_some() {
            integrator.max_depth = self.max_depth;
        }
        if let Some(BandsArg(numbers)) = self.bands {
            let bands = Bands::new(numbers, integrator.wavelength_range_nm);
            scene.film.bands = Some(bands.map_err(|error| Failure::input(miette!(code = "bands", "{error}")))?);
        }
        Ok(())
    }

    /// What to simulate otherwise than the scene calls for.
    pub(crate) fn study(&self) -> Study {
        Study {
            force: self.force.clone(),
            without: self.without.clone(),
            polarised: self.polarised,
            carried: self.carry.map(Carried::from),
            path_loop: self.path_loop.map(PathLoop::from),
            by_cosine_alone: self.by_cosine,
        }
    }

    /// Parameters of a Mitsuba scene.
    pub(crate) fn parameters(&self) -> &[(String, String)] {
        &self.define
    }

    /// The film's width and height in pixels, which the reader of the scene must know: a camera's angle may follow them.
    pub(crate) fn film_size(&self) -> Option<[u32; 2]> {
        self.size.map(|size| [size.width, size.height])
    }
}

impl Overrides {
    /// Whether spectral bands were asked for.
    pub(crate) fn has_bands(&self) -> bool {
        self.settings.bands.is_some()
    }

    /// The options that were given, as words of a command line.
    pub(crate) fn as_words(&self) -> &[String] {
        &self.words
    }

    /// The words of all options of the list that a command line gives.
    fn words_of(matches: &ArgMatches) -> Vec<String> {
        let list = Settings::augment_args(Command::new("list"));
        let mut words = Vec::new();
        for option in list.get_arguments() {
            let name = option.get_id().as_str();
            let given = matches.value_source(name) == Some(ValueSource::CommandLine);
            let (Some(long), true) = (option.get_long(), given) else { continue };
            let long = format!("--{long}");
            let values = matches.get_raw(name).into_iter().flatten().map(|value| value.to_string_lossy());
            match (option.get_action().takes_values(), option.get_value_delimiter()) {
                (false, _) => words.push(long),
                (true, Some(_)) => words.extend([long, values.collect::<Vec<_>>().join(",")]),
                (true, None) => words.extend(values.flat_map(|value| [long.clone(), value.into_owned()])),
            }
        }
        words
    }
}

impl FromArgMatches for Overrides {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        Ok(Self { settings: Settings::from_arg_matches(matches)?, words: Self::words_of(matches) })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl Args for Overrides {
    fn augment_args(command: Command) -> Command {
        Settings::augment_args(command)
    }

    fn augment_args_for_update(command: Command) -> Command {
        Settings::augment_args_for_update(command)
    }
}

impl Deref for Overrides {
    type Target = Settings;

    fn deref(&self) -> &Settings {
        &self.settings
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        overrides: Overrides,
    }

    fn words(line: &[String]) -> Option<Vec<String>> {
        let line = Line::try_parse_from(std::iter::once(&"line".to_owned()).chain(line)).ok()?;
        Some(line.overrides.as_words().to_vec())
    }

    /// A new option is tried without a change here, as long as it takes one of these values.
    #[test]
    fn every_option_of_the_list_is_repeated_as_it_was_given() {
        let list = Settings::augment_args(Command::new("list"));
        let mut all = Vec::new();
        for option in list.get_arguments() {
            let long = format!("--{}", option.get_long().unwrap());
            let choices: Vec<String> =
                option.get_possible_values().iter().map(|value| value.get_name().to_owned()).collect();
            let values =
                choices.into_iter().chain(["7", "64x48", "400:700:10", "lens,masks", "a=1,2"].map(str::to_owned));
            let lines = std::iter::once(vec![long.clone()]).chain(values.map(|value| vec![long.clone(), value]));
            let line = lines.into_iter().find(|line| words(line).is_some());
            let line = line.unwrap_or_else(|| panic!("no value for {long}"));
            assert_eq!(words(&line).unwrap(), line);
            all.extend(line);
        }
        assert_eq!(words(&all).unwrap(), all);
        assert!(all.join(" ").contains("--loop scalar"), "{all:?}");
        assert_eq!(words(&[]).unwrap(), [""; 0]);
        let twice = ["--define", "a=1,2", "--define", "b= 3"].map(str::to_owned);
        assert_eq!(words(&twice).unwrap(), twice);
        // A value keeps its spaces, and a list of values its order.
        let line = ["--bands", "400: 700:10", "--without", "lens", "--without", "masks"].map(str::to_owned);
        assert_eq!(words(&line).unwrap(), ["--bands", "400: 700:10", "--without", "lens,masks"]);
    }
}
