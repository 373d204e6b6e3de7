//! Reads numbers in binary files.

/// The type of a number.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Scalar {
    pub kind: Kind,
    /// Its size, at most 8.
    pub bytes: usize,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Signed,
    Unsigned,
    /// IEEE 754, of 4 or 8 bytes.
    Real,
}

impl Scalar {
    /// Returns the number in these bytes, the lowest first.
    #[inline]
    pub fn read(self, bytes: &[u8]) -> f64 {
        let mut raw = [0; 8];
        raw[..self.bytes].copy_from_slice(bytes);
        let bits = u64::from_le_bytes(raw);
        let unused = 64 - 8 * self.bytes;
        match self.kind {
            Kind::Signed => ((bits << unused) as i64 >> unused) as f64,
            Kind::Unsigned => bits as f64,
            Kind::Real if self.bytes == 4 => f32::from_bits(bits as u32).into(),
            Kind::Real => f64::from_bits(bits),
        }
    }
    /// Returns the largest whole number of this type of at most 4 bytes; 1 for real ones, without a scale.
    pub fn largest(self) -> f64 {
        match self.kind {
            Kind::Signed => ((1_u64 << (8 * self.bytes - 1)) - 1) as f64,
            Kind::Unsigned => ((1_u64 << (8 * self.bytes)) - 1) as f64,
            Kind::Real => 1.0,
        }
    }
}
