//! Published dispersion formulas of named media.
//!
//! Catalogues and papers measure in air: their n is relative to air and their λ is the wavelength in air, both 1.00027 to
//! 1.00029 times off those in vacuum in the visible. Here they are taken as they stand, so a scene's surrounding medium of
//! index 1 stands for air, and index and colour of a glass in true vacuum would be off by 3·10⁻⁴.

/// A medium by Sellmeier's formula.
pub(super) struct Glass {
    pub(super) name: &'static str,
    /// (B, C in µm²).
    pub(super) terms: &'static [(f64, f64)],
    /// Wavelengths for which the formula was published, nm.
    pub(super) range_nm: [f64; 2],
}

pub(super) const GLASSES: [Glass; 5] = [
    // SCHOTT optical glass data sheet N-BK7 517642.251 (2014); catalogue fits hold where the glass transmits.
    Glass {
        name: "N-BK7",
        terms: &[(1.039_612_12, 0.006_000_698_67), (0.231_792_344, 0.020_017_914_4), (1.010_469_45, 103.560_653)],
        range_nm: [300.0, 2500.0],
    },
    // SCHOTT optical glass data sheet N-SF11 785257.322 (2014).
    Glass {
        name: "N-SF11",
        terms: &[(1.737_596_95, 0.013_188_707), (0.313_747_346, 0.062_306_814_2), (1.898_781_01, 155.236_29)],
        range_nm: [370.0, 2500.0],
    },
    // I. H. Malitson, Interspecimen comparison of the refractive index of fused silica, J. Opt. Soc. Am. 55, 1205 (1965).
    Glass {
        name: "fused-silica",
        terms: &[
            (0.696_166_3, 0.068_404_3 * 0.068_404_3),
            (0.407_942_6, 0.116_241_4 * 0.116_241_4),
            (0.897_479_4, 9.896_161 * 9.896_161),
        ],
        range_nm: [210.0, 3710.0],
    },
    // F. Peter, Über Brechungsindizes und Absorptionskonstanten des Diamanten zwischen 644 und 226 mµ, Z. Phys. 15, 358
    // (1923); the fit is quoted from 226 to 760 nm.
    Glass { name: "diamond", terms: &[(0.330_6, 0.175 * 0.175), (4.335_6, 0.106 * 0.106)], range_nm: [226.0, 760.0] },
    // M. Daimon and A. Masumura, Measurement of the refractive index of distilled water from the near-infrared region to
    // the ultraviolet region, Appl. Opt. 46, 3811 (2007), at 20.0 °C.
    Glass {
        name: "water",
        terms: &[
            (0.568_402_756_5, 0.005_101_829_712),
            (0.172_617_739_1, 0.018_211_539_36),
            (0.020_861_895_78, 0.026_207_222_93),
            (0.113_074_868_8, 10.697_927_21),
        ],
        range_nm: [182.0, 1129.0],
    },
];
