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

/// Improves the hits of rays with hits beyond their bounds; with `ANY`, each ray ends at the first one found.
/// A ray's bound is in units of `1 / scale(ray)`.
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
        let (mut hit, scale) = (hits.get(at), scale(at));
        let accept = |found: Hit<f32>, hit: &mut Hit<f32>| {
            let t = (f64::from(found.t) / scale) as f32;
            if bounds.are_below(at, t, found.primitive) {
                keep_if_nearer(true, found.primitive, [found.t, found.u, found.v], hit);
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
        hits.set(at, &hit);
    }
}
