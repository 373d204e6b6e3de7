//! Random numbers for test cases and tests.

use glam::DVec3;

/// xorshift64*, independent of the engine's random numbers. The state is not 0.
pub struct Rng(pub u64);

impl Rng {
    /// Returns the generator of a part of a test case: a function of its name and the numbers, so that
    /// neither threads nor other test cases change its output.
    pub fn of(name: &str, numbers: [u64; 2]) -> Self {
        // FNV-1a, then the finaliser of SplitMix64 for each number, which decorrelates consecutive numbers.
        let start = name.bytes().fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        });
        let mix = |state: u64, number: u64| {
            let x = (state ^ number).wrapping_add(0x9e37_79b9_7f4a_7c15);
            let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            x ^ (x >> 31)
        };
        Self(numbers.into_iter().fold(start, mix) | 1)
    }
    /// Returns 32 uniform bits: the upper half of the output.
    pub fn bits(&mut self) -> u32 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 32) as u32
    }
    /// Returns a uniform integer below `n`.
    pub fn index(&mut self, n: usize) -> usize {
        ((u64::from(self.bits()) * n as u64) >> 32) as usize
    }
    /// Returns a uniform number in [0, 1), with 48 bits.
    pub fn unit(&mut self) -> f64 {
        let (high, low) = (u64::from(self.bits()), u64::from(self.bits()));
        (high << 16 | low >> 16) as f64 / (1u64 << 48) as f64
    }
    /// Returns a uniform number in [−1, 1).
    pub fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }
    /// Returns a number from `low` to `high`, uniform in the logarithm.
    pub fn scale(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.unit())
    }
    /// Returns a uniform point of the unit sphere.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let v = DVec3::new(self.signed(), self.signed(), self.signed());
            if (1e-4..=1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }
    /// Returns a uniform point of the cube [−1, 1)³.
    pub fn in_cube(&mut self) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed())
    }
    /// Returns the weights of a triangle's vertices, uniform over its area.
    pub fn barycentrics(&mut self) -> [f64; 3] {
        let root = self.unit().sqrt();
        let v = self.unit();
        [1.0 - root, root * (1.0 - v), root * v]
    }
}
