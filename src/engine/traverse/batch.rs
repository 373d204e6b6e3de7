//! The ways through a hierarchy, side by side: whole batches of rays by any of them.

use super::hierarchy::Hierarchy;
use super::rays::{Hits, Rays};
use super::scalar;
use super::single::{self, Stack};
use super::stream::{BATCH, PIECE, Stream};
use super::tally::{Counter, Tally};
use super::tile::{self, CUT, TILE};

// A tile is a piece of a stream's batch.
const _: () = assert!(PIECE == TILE);

/// A tile whose cut keeps more nodes than this sees more triangles than its packets can share: its rays go on in streams. Measured on
/// knots, a terrain and scans of 4,000 to 1,000,000 triangles, at two sizes of pictures: 8 to 16 do about as well, 24 loses 10 %.
const FEW_NODES: usize = 12;

/// A way through a hierarchy. All give the same hits, bit for bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Traversal {
    /// One ray on the binary tree: the baseline.
    Scalar,
    /// One ray against eight boxes.
    Single,
    /// Tiles of camera rays in a frustum; other rays as [`Traversal::Stream`] does them.
    Packet,
    /// All rays together down the tree.
    Stream,
    /// What measured fastest for rays like these.
    #[default]
    Hybrid,
}

impl Traversal {
    pub const ALL: [Self; 5] = [Self::Scalar, Self::Single, Self::Packet, Self::Stream, Self::Hybrid];

    /// As the command line and reports name it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scalar => "scalar",
            Self::Single => "single",
            Self::Packet => "packet",
            Self::Stream => "stream",
            Self::Hybrid => "hybrid",
        }
    }
    /// Lanes it works with.
    pub fn lanes(self) -> usize {
        if self == Self::Scalar { 1 } else { 8 }
    }
}

/// Working memory of a thread.
#[derive(Default)]
pub struct Tracer {
    stack: Stack,
    /// A MiB, made when it is first wanted.
    stream: Option<Box<Stream>>,
}

impl Tracer {
    pub fn new() -> Self {
        Self::default()
    }

    /// Improves the hits of all rays. With `ANY`, each ray ends at the first hit found: then only whether `primitive` is
    /// [`crate::math::MISS`] means anything.
    pub fn trace<const ANY: bool>(
        &mut self,
        traversal: Traversal,
        hierarchy: &Hierarchy,
        rays: &Rays,
        hits: &mut Hits,
    ) {
        self.tallied::<ANY>(traversal, hierarchy, rays, hits, ());
    }

    /// The same, and counts what is tested.
    pub fn count<const ANY: bool>(
        &mut self,
        traversal: Traversal,
        hierarchy: &Hierarchy,
        rays: &Rays,
        hits: &mut Hits,
        counter: &Counter,
    ) {
        self.tallied::<ANY>(traversal, hierarchy, rays, hits, counter);
    }

    #[inline(always)]
    fn tallied<const ANY: bool>(
        &mut self,
        traversal: Traversal,
        hierarchy: &Hierarchy,
        rays: &Rays,
        hits: &mut Hits,
        tally: impl Tally,
    ) {
        match traversal {
            Traversal::Scalar => {
                one_by_one(hierarchy, rays, hits, move |ray, hit| {
                    scalar::trace::<ANY>(hierarchy, ray, hit, tally)
                });
            }
            Traversal::Single => {
                let stack = &mut self.stack;
                one_by_one(hierarchy, rays, hits, move |ray, hit| {
                    single::trace::<ANY>(hierarchy, ray, stack, hit, tally)
                });
            }
            Traversal::Stream => self.stream().trace::<ANY>(hierarchy, rays, hits, tally),
            Traversal::Packet => self.tiles::<ANY>(hierarchy, rays, hits, CUT, tally),
            Traversal::Hybrid => self.tiles::<ANY>(hierarchy, rays, hits, FEW_NODES, tally),
        }
    }

    /// Tiles that run together in a frustum, and the others of a batch together in streams.
    fn tiles<const ANY: bool>(
        &mut self,
        hierarchy: &Hierarchy,
        rays: &Rays,
        hits: &mut Hits,
        most_nodes: usize,
        tally: impl Tally,
    ) {
        for first in (0..rays.len()).step_by(BATCH) {
            let batch = first..rays.len().min(first + BATCH);
            let (rays, mut hits) = (rays.range(batch.clone()), hits.range(batch));
            let mut apart = 0u32;
            for (tile, first) in (0..rays.len()).step_by(TILE).enumerate() {
                let range = first..rays.len().min(first + TILE);
                let together = !ANY
                    && tile::trace(
                        hierarchy,
                        &rays.range(range.clone()),
                        &mut hits.range(range),
                        &mut self.stack,
                        most_nodes,
                        tally,
                    );
                apart |= u32::from(!together) << tile;
            }
            if apart != 0 {
                self.stream().trace_pieces::<ANY>(hierarchy, &rays, &mut hits, apart, tally);
            }
        }
    }

    fn stream(&mut self) -> &mut Stream {
        self.stream.get_or_insert_with(Box::default)
    }
}

fn one_by_one(
    hierarchy: &Hierarchy,
    rays: &Rays,
    hits: &mut Hits,
    mut trace: impl FnMut(&super::hierarchy::SingleRay, &mut crate::math::Hit<f32>),
) {
    for at in 0..rays.len() {
        let mut hit = hits.get(at);
        trace(&rays.single(at, hierarchy.padding), &mut hit);
        hits.set(at, &hit);
    }
}
