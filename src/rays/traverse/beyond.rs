//! Finds hits beyond an exclusive lower bound ([`Rays::beyond`]), one ray at a time.
//!
//! Every hit of a primitive is visited, not only the nearest; those at the bound or before it are passed
//! over. Boxes are culled as for other rays: a bound never makes a ray miss a box.

use super::counter::Counter;
use super::single::descend;
use super::stack::Stack;
use super::structure::Primitives;
use crate::columns::{Hits, LowerBounds, Rays};
use crate::kind::keep_if_nearer;
use crate::math::{Hit, MISS};
use crate::prepared::SingleRay;

/// One plus four roundings.
pub(super) const ROUNDING: f32 = 1.0 + 4.0 * f32::EPSILON;

/// Replaces each ray's hit by the nearest hit beyond its bound, if that is nearer; with `ANY`, a ray in a
/// hierarchy ends at the first one found. A bound of t means t · `scale(ray)` in the structure. Hits are
/// ordered by the t that callers get, rounded after division by the scale, so that none hides another.
///
/// # Panics
/// If the structure has the caller's tests, which find one hit of each primitive at most.
pub(super) fn improve<const ANY: bool>(
    (primitives, stack): (&Primitives, &mut Stack),
    bounds: LowerBounds,
    rays: &Rays,
    hits: &mut Hits,
    scale: impl Fn(usize) -> f64,
    counter: Option<&Counter>,
) {
    for at in 0..rays.len() {
        let (mut nearest, scale) = (hits.get(at), scale(at));
        let rounded = |t: f32| (f64::from(t) / scale) as f32;
        // Boxes are culled by the greatest t that rounds to that of the nearest hit.
        let slack = if scale == 1.0 { 1.0 } else { ROUNDING };
        let mut hit = Hit { t: nearest.t * slack, ..nearest };
        let mut accept = |found: Hit<f32>, hit: &mut Hit<f32>| {
            let mut key = Hit { t: rounded(nearest.t), ..nearest };
            let is_beyond = bounds.are_below(at, rounded(found.t), found.primitive);
            if is_beyond && keep_if_nearer(true, found.primitive, [rounded(found.t), 0.0, 0.0], &mut key) {
                nearest = found;
                *hit = Hit { t: found.t * slack, ..found };
            }
        };
        let ray = |padding| SingleRay::new(rays.packet(at), padding);
        match primitives {
            Primitives::List(list) => {
                if let Some(counter) = counter {
                    counter.list(list.counts(), 1, 1);
                }
                let ray = ray(list.padding());
                list.visit(&ray, &mut |found| accept(found, &mut hit));
            }
            Primitives::Tree(tree, _) => {
                let ray = ray(tree.padding);
                let visit = |leaf, hit: &mut Hit<f32>| {
                    tree.visit_leaf(leaf, &ray, &mut |found| accept(found, hit));
                    ANY && hit.primitive != MISS
                };
                match counter {
                    Some(counter) => descend(tree, &ray, stack, &mut hit, counter, visit),
                    None => descend(tree, &ray, stack, &mut hit, (), visit),
                }
            }
            Primitives::Custom(_) => panic!("the caller's tests know no lower bounds"),
        }
        hits.set(at, &nearest);
    }
}
