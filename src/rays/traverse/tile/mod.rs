//! Traces primary rays in packets, one tile at a time.
//!
//! The frustum around the whole tile traverses the tree first, level by level, until it has up to
//! [`MAX_ENTRY_POINTS`] entry points: nodes and leaves that together hold all that the tile can see, sorted
//! by distance. A tile without entry points is empty. Each packet, with a frustum of its own, then traverses
//! in order the entry points that its frustum meets, and below them nearest first. In a leaf the triangles
//! outside the frustum are culled; the packet is tested against the rest one by one, and once more against
//! those that a ray hits.
//!
//! A packet pays as much for a triangle that one of its rays meets as for one that all meet. Streams trace
//! tiles that see many leaves so small or thin that few rays of a packet share each: see [`Packets`].
//!
//! Source: Reshetov, Soupikov, Hurley, "Multi-Level Ray Tracing Algorithm", SIGGRAPH 2005: entry points for
//! tiles.

mod entry_points;
mod sharing;

pub use entry_points::{MAX_ENTRY_POINTS, Packets};

use super::counter::CounterSink;
use super::frustum::{Frustum, FrustumAxis, greatest};
use super::hierarchy::Hierarchy;
use super::stack::{Stack, pop_within};
use crate::bvh::{Child, WIDE};
use crate::columns::{Hits, Rays};
use crate::kind::Kind;
use crate::lane::{Bits, F32x8, F32x16, Lane, Mask, U32x8, set_bits};
use crate::math::Hit;
use crate::prepared::Packet;
use entry_points::EntryPoints;
use sharing::SeenTile;

/// The largest number of rays of a tile.
pub const TILE: usize = 256;
/// The largest number of rows of slopes of a tile.
const ROWS: usize = TILE / ROW;
/// The number of slopes in a row.
const ROW: usize = F32x8::WIDTH;

/// The traversal of one packet.
struct PacketTraversal<'a, L: Lane, C> {
    tile: &'a TileTraversal<'a, C>,
    frustum: &'a Frustum,
    packet: Packet<L>,
    hit: Hit<L>,
    /// The rays' distances along the frustum axis at t = 1.
    depths: L,
    /// The distance along the frustum axis beyond which there is no nearer hit.
    limit: f32,
    /// Whether any ray found a nearer hit.
    closer: bool,
}

impl<'a, L: Lane, C: CounterSink> PacketTraversal<'a, L, C> {
    #[inline(always)]
    fn new(
        tile: &'a TileTraversal<'a, C>,
        frustum: &'a Frustum,
        rays: &Rays,
        hits: &Hits,
        at: usize,
    ) -> Self {
        let hit = hits.packet(at);
        let (packet, depths) = (Packet::new(rays.packet::<L>(at)), tile.axis.depths(rays, at));
        Self { tile, frustum, packet, hit, depths, limit: f32::INFINITY, closer: false }
    }

    /// Visits the entry points that are set in `meets`. Before each visit it fetches one of `unread`, which
    /// no packet met before.
    #[inline(always)]
    fn run(
        mut self,
        meets: u64,
        mut unread: impl Iterator<Item = usize>,
        hits: &mut Hits,
        at: usize,
        stack: &mut Stack,
    ) {
        let TileTraversal { hierarchy, entry_points, .. } = *self.tile;
        // The mask lets the compiler drop the bounds checks.
        for entry in set_bits(meets).map(|entry| entry & (MAX_ENTRY_POINTS - 1)) {
            // The tile's frustum and the packet's have one axis, so the distances hold for the packet; they
            // ascend.
            if entry_points.near[entry] > self.limit {
                break;
            }
            entry_points.prefetch_next(hierarchy, &mut unread);
            self.visit(entry_points.children[entry], stack);
        }
        if self.closer {
            hits.store(at, &self.hit);
        }
    }

    /// Visits a child of a node and its subtree.
    #[inline(always)]
    fn visit(&mut self, child: Child, stack: &mut Stack) {
        if child.is_leaf() {
            self.leaf(child);
        } else {
            self.subtree(child, stack);
        }
    }

    fn subtree(&mut self, child: Child, stack: &mut Stack) {
        let mut next = child;
        let mut len = 0;
        loop {
            if next.is_leaf() {
                self.leaf(next);
            } else {
                let node = &self.tile.hierarchy.bvh.wide[next.index()];
                self.tile.counter.node(node, 1);
                let (near, meets) = self.frustum.pass_boxes(node.boxes(), self.limit);
                if meets.any() {
                    len += stack.push(len, node.children(), near, meets);
                }
            }
            match pop_within(&mut len, self.limit, |at| stack.get(at)) {
                Some(child) => next = child,
                None => return,
            }
        }
    }

    #[inline(always)]
    fn leaf(&mut self, leaf: Child) {
        let closer = if leaf.kind() == Kind::Triangle {
            self.triangles(leaf)
        } else {
            self.tile.counter.packet(self.tile.hierarchy, leaf, L::WIDTH);
            self.tile.hierarchy.intersect_packet(leaf, &self.packet.ray, &mut self.hit)
        };
        if closer {
            self.shorten();
        }
    }

    /// Improves the hits with the triangles of a leaf. Returns whether any ray found a nearer hit.
    #[inline(always)]
    fn triangles(&mut self, leaf: Child) -> bool {
        self.tile.hierarchy.with_triangles(leaf.index(), |triangles| {
            let main = triangles.planes(self.frustum.axis());
            let (_, meets) =
                self.frustum.pass(|upper| main[upper & 1], |axis| triangles.planes(axis), self.limit);
            self.tile.counter.packet_triangles(self.tile.hierarchy, leaf, L::WIDTH, meets);
            // All triangles are tested first, without a branch, which would often be mispredicted; those that
            // are hit are tested again. (If rays have different z axes, only the second test runs.)
            let candidates = triangles.candidates_of_packet(meets.bitmask(), &self.packet);
            let Self { tile: TileTraversal { hierarchy, .. }, packet, hit, .. } = self;
            set_bits(candidates).fold(false, |closer, lane| {
                closer | triangles.accept_packet(lane, hierarchy.padding, packet, hit)
            })
        })
    }

    /// Shortens the limit to the furthest of the rays' nearest hits.
    #[inline(always)]
    fn shorten(&mut self) {
        self.closer = true;
        // Rounding is monotone: no box that a ray meets before its hit begins beyond this limit. A t_max of
        // NaN counts as infinite.
        self.limit = greatest((self.depths * self.hit.t).min(L::splat(f32::INFINITY)));
    }
}

/// Returns the least and the greatest of the slopes of each of eight packets, from rows of eight slopes, one
/// or two rows per packet. Lanes of packets behind the last row are unspecified.
#[inline(always)]
fn spans<L: Lane>(rows: &[F32x8]) -> [F32x8; 2] {
    let each = L::WIDTH / ROW;
    let order = U32x8::from_fn(|lane| lane as u32);
    // The packets' least and greatest slopes by lane, then over the lanes.
    let [mut lows, mut highs] = [[F32x8::zero(); 8]; 2];
    for (packet, (low, high)) in lows.iter_mut().zip(&mut highs).enumerate() {
        let row = |row: usize| rows[(packet * each + row).min(rows.len() - 1)];
        (*low, *high) = (row(0), row(0));
        for more in 1..each {
            (*low, *high) = (low.min(row(more)), high.max(row(more)));
        }
    }
    let transposed = |rows: &[F32x8; 8]| F32x8::gather_rows::<8>(bytemuck::cast_slice(rows), order);
    let low = transposed(&lows).into_iter().reduce(F32x8::min);
    let high = transposed(&highs).into_iter().reduce(F32x8::max);
    [low, high].map(|span| span.expect("eight rows"))
}

/// Improves the hits of up to [`TILE`] primary rays, whose `t` are at first the rays' t_max. Returns false
/// and does nothing if the rays are not whole packets, do not run together from one origin, or if packets do
/// not pay.
#[inline(never)]
pub fn trace(
    hierarchy: &Hierarchy,
    rays: &Rays,
    hits: &mut Hits,
    stack: &mut Stack,
    packets: Packets,
    counter: impl CounterSink,
) -> bool {
    let count = rays.len();
    if !count.is_multiple_of(ROW) || !(ROW..=TILE).contains(&count) {
        return false;
    }
    let Some(axis) = FrustumAxis::of(&rays.packet::<f32>(0), hierarchy.padding) else { return false };
    let mut slopes = [[F32x8::zero(); ROWS]; 2];
    let Some(span) = axis.slopes(rays, &mut slopes) else { return false };
    let tile = SeenTile { axis: &axis, span, frustum: axis.frustum(&axis.frusta(span), 0) };
    let Some(entry_points) = EntryPoints::of(hierarchy, &tile, packets, counter) else { return false };
    if entry_points.filled == 0 {
        return true;
    }
    let rows = slopes.each_ref().map(|rows| &rows[..count / ROW]);
    let traversal = TileTraversal { hierarchy, axis: &axis, entry_points: &entry_points, counter };
    if cfg!(target_feature = "avx512f") && count.is_multiple_of(F32x16::WIDTH) {
        traversal.packets::<F32x16>(rays, rows, hits, stack);
    } else {
        traversal.packets::<F32x8>(rays, rows, hits, stack);
    }
    true
}

/// The traversal of the packets of a tile.
struct TileTraversal<'a, C> {
    hierarchy: &'a Hierarchy,
    axis: &'a FrustumAxis,
    entry_points: &'a EntryPoints,
    counter: C,
}

impl<C: CounterSink> TileTraversal<'_, C> {
    /// Traces all packets of the tile. `slopes` has rows of eight rays.
    #[inline(always)]
    fn packets<L: Lane>(&self, rays: &Rays, slopes: [&[F32x8]; 2], hits: &mut Hits, stack: &mut Stack) {
        let Self { hierarchy, axis, entry_points, counter } = *self;
        let packets = rays.len() / L::WIDTH;
        // The entry points that packets have met so far.
        let mut met = 0;
        // Frusta are computed eight at a time.
        for first in (0..packets).step_by(8) {
            let rows = slopes.map(|rows| &rows[first * (L::WIDTH / ROW)..]);
            let frusta = axis.frusta(rows.map(|rows| spans::<L>(rows)));
            for packet in first..packets.min(first + 8) {
                let (frustum, at) = (axis.frustum(&frusta, packet - first), packet * L::WIDTH);
                counter.boxes(entry_points.filled.div_ceil(WIDE), entry_points.filled);
                let meets = entry_points.across(&frustum);
                // Many packets of tiles at silhouettes meet no entry point; they are not prepared.
                if meets != 0 {
                    // The first is fetched while the packet is prepared, another before each visit.
                    let mut unread = set_bits(meets & !met);
                    entry_points.prefetch_next(hierarchy, &mut unread);
                    met |= meets;
                    let packet = PacketTraversal::<L, C>::new(self, &frustum, rays, hits, at);
                    packet.run(meets, unread, hits, at, stack);
                }
            }
        }
    }
}
