//! The random sequence of the published figures: the additive-feedback generator of the C library, with seed 1.

/// x³¹ + x³ + 1 over 32-bit words: each word is the sum of the words 3 and 31 places before it.
#[derive(Clone, Debug)]
pub struct AdditiveFeedback {
    /// The last 31 words, as a ring.
    words: [u32; 31],
    /// Where the oldest word is, which is also where the next one goes.
    oldest: usize,
}

impl AdditiveFeedback {
    /// The sequence that a process sees when it never calls `srand`: seed 1, the first 310 words thrown away.
    pub fn new() -> Self {
        let mut words = [1_u32; 31];
        for i in 1..31 {
            words[i] = (16807 * u64::from(words[i - 1]) % 2_147_483_647) as u32;
        }
        // The words 31 to 33 repeat the words 0 to 2, so the ring, which starts there, is not moved by them: it is only turned.
        let mut generator = Self { words, oldest: 3 };
        for _ in 0..310 {
            generator.next_word();
        }
        generator
    }

    fn next_word(&mut self) -> u32 {
        let i = self.oldest;
        self.words[i] = self.words[i].wrapping_add(self.words[(i + 28) % 31]);
        self.oldest = (i + 1) % 31;
        self.words[i]
    }

    /// The next output, in [0, 2³¹).
    pub fn next_u31(&mut self) -> u32 {
        self.next_word() >> 1
    }

    /// The next number in [−1, 1], computed in single precision, which leaves it on a coarse grid.
    pub fn next_signed(&mut self) -> f32 {
        2.0 * (self.next_u31() as f32 / 2_147_483_647_u32 as f32) + (-1.0)
    }
}

impl Default for AdditiveFeedback {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_outputs_are_those_every_c_program_without_a_seed_prints() {
        let mut generator = AdditiveFeedback::new();
        let first: Vec<u32> = (0..5).map(|_| generator.next_u31()).collect();
        assert_eq!(first, [1_804_289_383, 846_930_886, 1_681_692_777, 1_714_636_915, 1_957_747_793]);
    }

    #[test]
    fn the_ring_equals_the_recurrence_written_out_as_a_list() {
        let mut r: Vec<u32> = vec![1];
        for i in 1..31 {
            r.push((16807 * u64::from(r[i - 1]) % 2_147_483_647) as u32);
        }
        for i in 31..34 {
            r.push(r[i - 31]);
        }
        for i in 34..5000 {
            r.push(r[i - 3].wrapping_add(r[i - 31]));
        }
        let mut generator = AdditiveFeedback::new();
        for expected in &r[344..] {
            assert_eq!(generator.next_u31(), expected >> 1);
        }
    }
}
