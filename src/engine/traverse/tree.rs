//! The traversals of a hierarchy, side by side: whole batches of rays by any of them.

use super::counter::{Counter, CounterSink};
use super::hierarchy::Hierarchy;
use super::precalculated::SingleRay;
use super::rays::{Hits, Rays};
use super::stack::Stack;
use super::stream::Stream;
use super::tile::{self, Packets, TILE};
use super::{scalar, single};
use crate::bvh::Trees;
use crate::choice::choices;
use crate::lane::NATIVE_WIDTH;
use crate::math::Hit;

choices! {
    /// A traversal of the hierarchy. All give the same hits, bit for bit.
    pub enum Traversal {
        Scalar = "scalar",
            "One ray at a time through the binary tree, without SIMD: the baseline, and used by --lanes 1.";
        Single = "single", "One ray at a time against the boxes of a node, or the primitives of a leaf, at once.";
        Packet = "packet", "Tiles of camera rays in a frustum; other rays as `stream` traces them.";
        Stream = "stream", "Many rays together down the tree.";
        #[default]
        Hybrid = "hybrid", "The traversal that measured fastest for the rays at hand.";
    }
}

impl Traversal {
    /// Lanes it works with.
    pub fn lanes(self) -> usize {
        if self == Self::Scalar { 1 } else { NATIVE_WIDTH }
    }
    /// The trees that it reads.
    pub fn trees(self) -> Trees {
        if self == Self::Scalar { Trees::WideAndBinary } else { Trees::Wide }
    }
}

/// Working memory of a thread.
#[derive(Default)]
pub struct Tracer {
    stack: Stack,
    /// Two MiB, allocated at first use.
    stream: Option<Box<Stream>>,
}

impl Tracer {
    /// Without memory, which grows at first use.
    pub fn new() -> Self {
        Self::default()
    }

    /// Improves the hits of all rays. With `ANY`, each ray ends at the first hit found: then only whether
    /// `primitive` is [`crate::math::MISS`] is defined. A `counter` counts the tests.
    pub fn trace<const ANY: bool>(
        &mut self,
        traversal: Traversal,
        hierarchy: &Hierarchy,
        rays: &Rays,
        hits: &mut Hits,
        counter: Option<&Counter>,
    ) {
        match counter {
            None => self.trace_counted::<ANY>(traversal, hierarchy, rays, hits, ()),
            Some(counter) => self.trace_counted::<ANY>(traversal, hierarchy, rays, hits, counter),
        }
    }

    #[inline(always)]
    fn trace_counted<const ANY: bool>(
        &mut self,
        traversal: Traversal,
        hierarchy: &Hierarchy,
        rays: &Rays,
        hits: &mut Hits,
        counter: impl CounterSink,
    ) {
        match traversal {
            Traversal::Scalar => {
                one_by_one(hierarchy, rays, hits, move |ray, hit| {
                    scalar::trace::<ANY>(hierarchy, ray, hit, counter)
                });
            }
            Traversal::Single => {
                let stack = &mut self.stack;
                one_by_one(hierarchy, rays, hits, move |ray, hit| {
                    single::trace::<ANY>(hierarchy, ray, stack, hit, counter)
                });
            }
            Traversal::Stream => self.stream().trace::<ANY>(hierarchy, rays, hits, counter),
            Traversal::Packet => self.tiles::<ANY>(hierarchy, rays, hits, Packets::Always, counter),
            Traversal::Hybrid => {
                self.tiles::<ANY>(hierarchy, rays, hits, Packets::WherePaying, counter);
            }
        }
    }

    /// Tiles for which there is a frustum as packets; the others, as far as they follow each other, in
    /// streams.
    fn tiles<const ANY: bool>(
        &mut self,
        hierarchy: &Hierarchy,
        rays: &Rays,
        hits: &mut Hits,
        packets: Packets,
        counter: impl CounterSink,
    ) {
        let mut left = 0..0;
        let tiles = (0..rays.len()).step_by(TILE).map(|first| first..rays.len().min(first + TILE));
        for tile in tiles {
            let is_done = !ANY && {
                let (rays, hits) = (&rays.range(tile.clone()), &mut hits.range(tile.clone()));
                tile::trace(hierarchy, rays, hits, &mut self.stack, packets, counter)
            };
            if is_done {
                let (rays, hits) = (&rays.range(left.clone()), &mut hits.range(left));
                self.stream().trace::<ANY>(hierarchy, rays, hits, counter);
                left = tile.end..tile.end;
            } else {
                left.end = tile.end;
            }
        }
        let (rays, hits) = (&rays.range(left.clone()), &mut hits.range(left));
        self.stream().trace::<ANY>(hierarchy, rays, hits, counter);
    }

    fn stream(&mut self) -> &mut Stream {
        self.stream.get_or_insert_with(Box::default)
    }
}

fn one_by_one(
    hierarchy: &Hierarchy,
    rays: &Rays,
    hits: &mut Hits,
    mut trace: impl FnMut(&SingleRay, &mut Hit<f32>),
) {
    for at in 0..rays.len() {
        let mut hit = hits.get(at);
        trace(&rays.single(at, hierarchy.padding), &mut hit);
        hits.set(at, &hit);
    }
}
