//! The kinds of primitives.
//!
//! Each kind has a folder with its geometry, its test in a leaf of a hierarchy (`leaf`), and its tests in a
//! list (`list`). The code that distinguishes kinds is [`crate::geometry::Shape`],
//! [`crate::traverse::hierarchy`] and [`crate::traverse::List`].

mod leaf;
pub mod sphere;
pub mod triangle;

pub use crate::numbering::{Kind, KindCounts};
pub use leaf::{LEAF, Leaf};
pub use sphere::Sphere;

use crate::lane::{Bits, Lane, Mask};
use crate::math::Hit;

/// Returns a limit that admits hits at `t` itself: among equal distances the lowest number wins, in any order
/// of tests.
#[inline(always)]
pub(crate) fn inclusive(t: f32) -> f32 {
    // Not next_up: its special cases cost branches. t is positive, or −∞ for rays that are done.
    if (0.0..f32::INFINITY).contains(&t) { f32::from_bits(t.to_bits() + 1) } else { t }
}

/// Keeps hits that are nearer, or equally near with a lower number. Returns whether any lane's hit was kept.
#[inline(always)]
pub fn keep_if_nearer<L: Lane>(mask: L::Mask, primitive: u32, [t, u, v]: [L; 3], hit: &mut Hit<L>) -> bool {
    // MISS is the largest number: plus one it wraps to 0, below all others, so a hit at t_max is a miss.
    let (number, one) = (L::Bits::splat(primitive), L::Bits::splat(1));
    let lower = number.wrapping_add(one).less(hit.primitive.wrapping_add(one));
    let nearer = mask & (t.lt(hit.t) | (t.eq(hit.t) & lower));
    hit.replace(nearer, &Hit { t, primitive: number, u, v });
    nearer.any()
}
