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
use crate::math::{Hit, MISS, Ray};

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

    /// Improves the hits of rays in the coordinates of the scene's file. Directions may have any length above
    /// 0, in which `t` counts. A ray ends at its t_max ([`Rays::until`]), or at the `t` that its hit comes
    /// with if that is less. Otherwise as [`Tracer::trace_in_scene`], for which it copies the rays.
    pub fn trace<const ANY: bool>(
        &mut self,
        traversal: Traversal,
        hierarchy: &Hierarchy,
        rays: &Rays,
        hits: &mut Hits,
        counter: Option<&Counter>,
    ) {
        let (mut columns, mut ends) = ([const { Vec::new() }; 6], Vec::new());
        for at in 0..rays.len() {
            let Ray { origin, direction } = rays.packet::<f32>(at);
            let origin = hierarchy.coordinates.to_scene(origin.get(0).into()).as_vec3().to_array();
            let direction = direction.get(0).as_dvec3();
            let length = Some(direction.length()).filter(|length| (length - 1.0).abs() > 1e-6).unwrap_or(1.0);
            let of_ray = origin.into_iter().chain((direction / length).as_vec3().to_array());
            columns.iter_mut().zip(of_ray).for_each(|(column, x)| column.push(x));
            let (end, scale) = (rays.t_max::<f32>(at), length / hierarchy.coordinates.unit);
            let end = if end > hits.t[at] { hits.t[at] } else { end };
            // A NaN, as of a direction of length 0, is no hit.
            hits.t[at] = if length > 0.0 { (f64::from(end) * scale) as f32 } else { f32::NAN };
            ends.push((end, hits.t[at], scale));
        }
        let [x, y, z, dx, dy, dz] = &columns;
        self.trace_in_scene::<ANY>(traversal, hierarchy, &Rays::new([x, y, z], [dx, dy, dz]), hits, counter);
        for (at, (end, before, scale)) in ends.into_iter().enumerate() {
            let is_new = hits.primitive[at] != MISS && hits.t[at] != before;
            hits.t[at] = if is_new { (f64::from(hits.t[at]) / scale) as f32 } else { end };
        }
    }

    /// Improves the hits of all rays, in the coordinates of the scene and with directions of unit length.
    /// They end at the `t` that their hits come with, and nowhere else. With `ANY`, each ray ends at the
    /// first hit found: then only whether `primitive` is [`MISS`] is defined. Without a binary tree,
    /// [`Traversal::Scalar`] is [`Traversal::Single`]: the hits are the same. A `counter` counts the tests.
    pub fn trace_in_scene<const ANY: bool>(
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
            Traversal::Scalar if !hierarchy.bvh.binary.is_empty() => {
                one_by_one(hierarchy, rays, hits, move |ray, hit| {
                    scalar::trace::<ANY>(hierarchy, ray, hit, counter)
                });
            }
            Traversal::Scalar | Traversal::Single => {
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
