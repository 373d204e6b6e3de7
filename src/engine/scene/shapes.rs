//! The kinds of primitives: spheres and triangles.

use glam::Vec3;

/// A sphere. A point with outward unit normal n has the texture coordinates acos(n.y) / π from the top and,
/// with a = atan2(n.z, n.x) / 2π, u = a + `texture_turn` if the texture reads right from inside (as the sky's
/// does), and u = −(a + `texture_turn`) if from outside; both wrapped to [0, 1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Its centre.
    pub center: Vec3,
    /// Above 0.
    pub radius: f32,
    /// Index of its material.
    pub material: u32,
    /// Rotation of the texture around the vertical axis, in whole turns, anticlockwise seen from above, in
    /// [0, 1).
    pub texture_turn: f32,
    /// The side from which the texture is not mirrored.
    pub texture_side: Side,
}

/// A side of a sphere.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Side {
    /// As on a globe.
    #[default]
    Outside,
    /// As in a sky.
    Inside,
}

/// A triangle with an area above 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// Its corners.
    pub vertices: [Vec3; 3],
    /// Index of its material.
    pub material: u32,
}

/// A primitive of a scene: see [`super::Scene::primitive`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Primitive<'a> {
    /// A sphere.
    Sphere(&'a Sphere),
    /// A triangle, and its number among the triangles.
    Triangle(&'a Triangle, usize),
}
