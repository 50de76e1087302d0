//! The oracle's own uniform numbers, so that it shares no generator with what it judges.

/// SplitMix64 (Steele, Lea & Flood 2014): a counter through a mixing function. Equal seeds give equal sequences on every
/// machine.
#[derive(Clone, Debug)]
pub struct Uniform {
    state: u64,
}

impl Uniform {
    /// A sequence for a seed.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// The next 64 random bits.
    pub const fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = self.state;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }

    /// The next number, uniform on [0, 1): a multiple of 2⁻²⁴, so that an f32 subject receives it unrounded.
    pub const fn number(&mut self) -> f64 {
        (self.bits() >> 40) as f64 / 16_777_216.0
    }

    /// Three numbers at once.
    pub const fn triple(&mut self) -> [f64; 3] {
        [self.number(), self.number(), self.number()]
    }

    /// Uniform between two values.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.number()
    }

    /// Log-uniform between two positive values.
    pub fn log_between(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// A unit vector, uniform over the sphere.
    pub fn direction(&mut self) -> [f64; 3] {
        let z = self.between(-1.0, 1.0);
        let (sin_phi, cos_phi) = self.between(0.0, std::f64::consts::TAU).sin_cos();
        let r = (1.0 - z * z).max(0.0).sqrt();
        [r * cos_phi, r * sin_phi, z]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sequence_is_the_published_one() {
        // First outputs of SplitMix64 for seed 1234567, as the reference implementation prints them.
        let mut sequence = Uniform::new(1_234_567);
        let first: Vec<u64> = (0..3).map(|_| sequence.bits()).collect();
        assert_eq!(first, [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423]);
    }

    #[test]
    fn numbers_survive_single_precision() {
        let mut sequence = Uniform::new(1);
        for _ in 0..1000 {
            let u = sequence.number();
            let single = f64::from(u as f32);
            assert_eq!(single, u);
            assert!((0.0..1.0).contains(&u));
        }
    }
}
