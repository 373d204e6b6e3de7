//! Vectors of lanes.

use crate::lane::Lane;
use std::ops::{Add, Mul, Neg, Sub};

/// `WIDTH` vectors, points or colours, one per lane, component by component (structure of arrays).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vec3<L> {
    /// The first component.
    pub x: L,
    /// The second component.
    pub y: L,
    /// The third component.
    pub z: L,
}

impl Vec3<f32> {
    /// Returns references to the components, for [`Vec3::broadcast`].
    #[inline(always)]
    pub fn each_ref(&self) -> Vec3<&f32> {
        Vec3 { x: &self.x, y: &self.y, z: &self.z }
    }
}

impl Vec3<&f32> {
    /// Returns the same vector in every lane: [`Lane::broadcast`] of each component.
    #[inline(always)]
    pub fn broadcast<L: Lane>(self) -> Vec3<L> {
        Vec3::new(L::broadcast(self.x), L::broadcast(self.y), L::broadcast(self.z))
    }
}

impl<L: Lane> Vec3<L> {
    /// Creates a vector from its components.
    #[inline(always)]
    pub fn new(x: L, y: L, z: L) -> Self {
        Self { x, y, z }
    }
    /// Returns the same vector in every lane.
    #[inline(always)]
    pub fn splat(v: glam::Vec3) -> Self {
        Self::new(L::splat(v.x), L::splat(v.y), L::splat(v.z))
    }
    /// Returns the same number in all three components.
    #[inline(always)]
    pub fn repeat(x: L) -> Self {
        Self::new(x, x, x)
    }
    /// Returns the zero vector.
    #[inline(always)]
    pub fn zero() -> Self {
        Self::repeat(L::zero())
    }
    /// Returns the vector of one lane.
    #[inline(always)]
    pub fn get(self, lane: usize) -> glam::Vec3 {
        glam::Vec3::new(self.x.get(lane), self.y.get(lane), self.z.get(lane))
    }
    /// Returns the scalar product.
    #[inline(always)]
    pub fn dot(self, other: Self) -> L {
        self.x.mul_add(other.x, self.y.mul_add(other.y, self.z * other.z))
    }
    /// Returns the vector product.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        Self::new(
            self.z.neg_mul_add(other.y, self.y * other.z),
            self.x.neg_mul_add(other.z, self.z * other.x),
            self.y.neg_mul_add(other.x, self.x * other.y),
        )
    }
    /// Returns `self · factor + addend` with one factor for all components.
    #[inline(always)]
    pub fn mul_add(self, factor: L, addend: Self) -> Self {
        Self::new(
            self.x.mul_add(factor, addend.x),
            self.y.mul_add(factor, addend.y),
            self.z.mul_add(factor, addend.z),
        )
    }
    /// Scales to length 1. Domain: a length between 1e-19 and 1e19; a zero vector gives NaN.
    #[inline(always)]
    pub fn normalize(self) -> Self {
        self * (L::one() / self.dot(self).sqrt())
    }
    /// Selects one of two vectors in each lane.
    #[inline(always)]
    pub fn select(mask: L::Mask, if_true: Self, if_false: Self) -> Self {
        Self::new(
            L::select(mask, if_true.x, if_false.x),
            L::select(mask, if_true.y, if_false.y),
            L::select(mask, if_true.z, if_false.z),
        )
    }
    /// Negates the vector where `sign` has its sign bit set.
    #[inline(always)]
    pub fn flip_sign(self, sign: L) -> Self {
        Self::new(self.x.flip_sign(sign), self.y.flip_sign(sign), self.z.flip_sign(sign))
    }
    /// Reflects an arriving direction d at a surface with unit normal `n`: d − 2 (d·n) n.
    #[inline(always)]
    pub fn reflect(self, n: Self) -> Self {
        n.mul_add(L::splat(-2.0) * self.dot(n), self)
    }
}

impl<L: Lane> Add for Vec3<L> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl<L: Lane> Sub for Vec3<L> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

/// Multiplies component by component, the product of colours.
impl<L: Lane> Mul for Vec3<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self::new(self.x * other.x, self.y * other.y, self.z * other.z)
    }
}

impl<L: Lane> Mul<L> for Vec3<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: L) -> Self {
        Self::new(self.x * factor, self.y * factor, self.z * factor)
    }
}

impl<L: Lane> Neg for Vec3<L> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}
