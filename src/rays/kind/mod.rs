//! The kinds of primitives.
//!
//! Each kind has a folder: its geometry, its test in a leaf of a hierarchy (`leaf`), and its tests in a list
//! (`list`). What differs from kind to kind is asked of them by [`crate::geometry::Shape`],
//! [`crate::traverse::hierarchy`] and [`crate::traverse::List`].

mod leaf;
pub mod sphere;
pub mod triangle;

pub use crate::numbering::{Kind, KindCounts};
pub use leaf::{LEAF, Leaf};
pub use sphere::Sphere;

use crate::lane::{Bits, Lane, Mask};
use crate::math::Hit;

/// Returns the limit that lets hits at `t` itself pass: among equal distances the lowest number wins, in any
/// order of tests.
#[inline(always)]
pub(crate) fn inclusive(t: f32) -> f32 {
    // Not next_up: its special cases would cost branches. t is positive, or −∞ for rays that are done.
    if (0.0..f32::INFINITY).contains(&t) { f32::from_bits(t.to_bits() + 1) } else { t }
}

/// Keeps hits that are nearer, or as near and of a lower number. Returns whether any lane's hit was kept.
#[inline(always)]
pub fn keep_if_nearer<L: Lane>(mask: L::Mask, primitive: u32, [t, u, v]: [L; 3], hit: &mut Hit<L>) -> bool {
    // MISS is the largest number: plus one it is 0, below every other, so that a hit at t_max itself is none.
    let (number, one) = (L::Bits::splat(primitive), L::Bits::splat(1));
    let lower = number.wrapping_add(one).less(hit.primitive.wrapping_add(one));
    let nearer = mask & (t.lt(hit.t) | (t.eq(hit.t) & lower));
    hit.replace(nearer, &Hit { t, primitive: number, u, v });
    nearer.any()
}
