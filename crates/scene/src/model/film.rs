//! What the film records.

/// Image size and reconstruction.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Pixel filter, sampled by importance so that every sample belongs to one pixel.
    pub filter: Filter,
    /// Whether pixels at the edges get light from beyond the film. If not, the part of their filter that lies on the film is all of it.
    pub sample_border: bool,
    /// Whether S₁, S₂ and S₃ are recorded beside the radiance.
    pub stokes: bool,
    /// Bands of wavelengths that the film keeps apart, beside its colour.
    pub bands: Option<Bands>,
}

/// Bands of wavelengths, each as wide as their centres are apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bands {
    /// Centre of the first, nm.
    pub first_nm: f64,
    /// From centre to centre, nm.
    pub step_nm: f64,
    /// How many.
    pub count: u32,
}

/// Most bands of a film.
pub const MOST_BANDS: u32 = 512;

/// Why there are no such bands.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BandsError {
    /// Numbers that make no bands.
    #[error(
        "bands are the first centre, the last centre and the step in nm, and the last centre must be a whole number of steps from the first"
    )]
    Malformed,
    /// Too many.
    #[error("{0} bands; at most {MOST_BANDS} are possible")]
    TooMany(u64),
    /// Wavelengths that are not rendered.
    #[error("the bands reach from {} to {} nm, but only wavelengths from {} to {} nm are rendered", bands[0], bands[1], range[0], range[1])]
    OutOfRange {
        /// First and last edge, nm.
        bands: [f64; 2],
        /// What is rendered, nm.
        range: [f64; 2],
    },
}

impl Bands {
    /// Bands from the centre of the first to that of the last, in steps, within the wavelengths that are rendered.
    ///
    /// # Errors
    /// [`BandsError`].
    pub fn new([first_nm, last_nm, step_nm]: [f64; 3], range_nm: [f64; 2]) -> Result<Self, BandsError> {
        let steps = (last_nm - first_nm) / step_nm;
        let positive = |value: f64| value > 0.0 && value.is_finite();
        // Steps such as 0.1 are not exact; a millionth of a step is.
        if !positive(first_nm)
            || !positive(step_nm)
            || !(0.0..1e9).contains(&steps)
            || (steps - steps.round()).abs() > 1e-6
        {
            return Err(BandsError::Malformed);
        }
        let count = steps.round() as u64 + 1;
        if count > u64::from(MOST_BANDS) {
            return Err(BandsError::TooMany(count));
        }
        let bands = Self { first_nm, step_nm, count: count as u32 };
        let edges = [bands.edge_nm(0), bands.edge_nm(bands.count)];
        if edges[0] < range_nm[0] || edges[1] > range_nm[1] {
            return Err(BandsError::OutOfRange { bands: edges, range: range_nm });
        }
        Ok(bands)
    }

    /// Where band `index` begins and the one before it ends, nm.
    pub fn edge_nm(&self, index: u32) -> f64 {
        self.first_nm + (f64::from(index) - 0.5) * self.step_nm
    }

    /// The band that a wavelength falls into: each has its lower edge.
    pub fn at(&self, nm: f64) -> Option<u32> {
        let from = (nm - self.edge_nm(0)) / self.step_nm;
        // Within the range after the comparison.
        (0.0..f64::from(self.count)).contains(&from).then_some(from as u32)
    }

    /// Centre of band `index`, nm.
    pub fn centre_nm(&self, index: u32) -> f64 {
        self.first_nm + f64::from(index) * self.step_nm
    }
}

/// Pixel filter.
#[derive(Clone, Debug, PartialEq)]
pub enum Filter {
    /// The pixel's own square.
    Box,
    /// A tent of this radius, in pixels.
    Tent {
        /// Radius, pixels.
        radius_px: f64,
    },
    /// A Gaussian of this standard deviation, cut at three of them.
    Gaussian {
        /// Standard deviation, pixels.
        sigma_px: f64,
    },
    /// The cubic of Mitchell and Netravali, which is negative away from the pixel.
    Mitchell {
        /// Radius, pixels.
        radius_px: f64,
        /// How much of it is a B-spline.
        b: f64,
        /// How far it is negative.
        c: f64,
    },
    /// Lanczos's windowed sine.
    Lanczos {
        /// Radius, pixels: the zeros of the sine to each side, with that of the window.
        lobes: u32,
    },
}
