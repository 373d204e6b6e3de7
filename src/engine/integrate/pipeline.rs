//! Pipelines: the stages in order, compiled for a set of features.

use super::context::TraceContext;
use super::context::has;
use super::generate::generate;
use super::intersect::{Intersected, intersect};
use super::opacity::pass_through;
use super::queue::MAX_EARLIER;
use super::radiance::MAX_TILES;
use super::scratch::Scratch;
use super::shade::{Shaded, shade, shade_last};
use super::shadow_rays::trace_shadow_rays;
use super::stats::Stage;
use crate::buffers::Features;
use crate::camera::Tile;
use crate::lane::{F32x8, Lane, Native};
use std::ops::Range;

/// [`trace_tiles`] at one width, compiled for one set of features.
pub type Pipeline = fn(&TraceContext, &[Tile], u32, &mut Scratch) -> u64;

/// The number of scattering events after which the paths of several tiles are traced together. A tile alone
/// then has few left: one or two packets, half empty, whose steps wait for each other.
const SHARED_FROM: u32 = 2;

/// Takes sample `sample` of every pixel of up to [`MAX_TILES`] tiles into `scratch`'s radiance and
/// returns the number of rays. `N` holds the features that this pipeline is compiled with; it must contain
/// the scene's [`Features`].
pub fn trace_tiles<L: Lane, const N: u64>(
    context: &TraceContext,
    tiles: &[Tile],
    sample: u32,
    scratch: &mut Scratch,
) -> u64 {
    debug_assert!(tiles.len() <= MAX_TILES, "radiance of {} tiles", tiles.len());
    let (mut rays, mut waiting) = (0, 0);
    for (number, &tile) in tiles.iter().enumerate() {
        rays += first_segments::<L, N>(context, (number, tile), sample, scratch, &mut waiting);
        let is_last = number + 1 == tiles.len();
        if context.max_bounces > 0 && (is_last || waiting > MAX_EARLIER) {
            rays += later_segments::<L, N>(context, scratch, waiting);
            waiting = 0;
        }
    }
    rays + std::mem::take(&mut scratch.asked_again)
}

/// Traces the paths of a tile to their event [`SHARED_FROM`], or to the last if that is earlier, and puts
/// them behind the `waiting` ones of earlier tiles at the front of the queue. Returns the number of rays.
fn first_segments<L: Lane, const N: u64>(
    context: &TraceContext,
    (number, tile): (usize, Tile),
    sample: u32,
    scratch: &mut Scratch,
    waiting: &mut usize,
) -> u64 {
    scratch.observer.begin(Some(Stage::Generate));
    let mut paths = generate::<L>(context, (number, tile), sample, *waiting, scratch);
    if context.has_opacity::<N>() {
        pass_through(context, scratch, paths.clone(), 0, true);
    }
    let mut rays = paths.len() as u64;
    if context.max_bounces == 0 {
        scratch.observer.begin_rays::<L>(Stage::Finish, 0, &scratch.queue, &paths);
        shade_last::<L, N, true>(context, scratch, &Intersected::all(paths));
        return rays;
    }
    scratch.observer.begin_rays::<L>(Stage::Shade, 0, &scratch.queue, &paths);
    let last = SHARED_FROM.min(context.max_bounces) - 1;
    let first = paths.start;
    let to = |event| if event == last { *waiting } else { first };
    let mut shaded = shade::<L, N, true>(context, scratch, &Intersected::all(paths.clone()), 0, to(0));
    shadow_rays::<L, N>(context, scratch, &shaded);
    rays += shaded.shadow_rays as u64;
    for bounce in 1..=last {
        paths.end = first + shaded.alive;
        shaded = trace_bounce::<L, N>(context, scratch, &paths, bounce, to(bounce));
        rays += (paths.len() + shaded.shadow_rays) as u64;
    }
    *waiting += shaded.alive;
    rays
}

/// Traces the waiting paths of all tiles to their ends. Returns the number of rays.
fn later_segments<L: Lane, const N: u64>(
    context: &TraceContext,
    scratch: &mut Scratch,
    waiting: usize,
) -> u64 {
    let (mut paths, mut rays) = (0..waiting, 0);
    for bounce in SHARED_FROM..context.max_bounces {
        let shaded = trace_bounce::<L, N>(context, scratch, &paths, bounce, 0);
        rays += (paths.len() + shaded.shadow_rays) as u64;
        paths.end = shaded.alive;
    }
    rays += paths.len() as u64;
    scratch.observer.begin_rays::<L>(Stage::Trace, context.max_bounces, &scratch.queue, &paths);
    let found = intersect::<L, N>(context, scratch, paths, context.max_bounces);
    scratch.observer.begin(Some(Stage::Finish));
    shade_last::<L, N, false>(context, scratch, &found);
    rays
}

/// Traces a segment of paths after `bounce` bounces, shades their hits, and traces the shadow rays. Paths
/// that continue are stored from `to` on.
#[inline(always)]
fn trace_bounce<L: Lane, const N: u64>(
    context: &TraceContext,
    scratch: &mut Scratch,
    paths: &Range<usize>,
    bounce: u32,
    to: usize,
) -> Shaded {
    scratch.observer.begin_rays::<L>(Stage::Trace, bounce, &scratch.queue, paths);
    if bounce.is_multiple_of(RENORMALIZATION_INTERVAL) {
        scratch.queue.normalize_directions::<L>(paths.clone());
    }
    let found = intersect::<L, N>(context, scratch, paths.clone(), bounce);
    scratch.observer.begin(Some(Stage::Shade));
    let shaded = shade::<L, N, false>(context, scratch, &found, bounce, to);
    shadow_rays::<L, N>(context, scratch, &shaded);
    shaded
}

/// Traces the shadow rays that `shade` queued.
#[inline(always)]
fn shadow_rays<L: Lane, const N: u64>(context: &TraceContext, scratch: &mut Scratch, shaded: &Shaded) {
    if has(N, Features::LIGHTS) && shaded.shadow_rays > 0 {
        trace_shadow_rays::<L>(context, scratch, shaded.shadow_rays);
    }
}

/// The number of scattering events after which directions are brought back to unit length.
///
/// A mirror whose normal has the length 1 + δ, |δ| ≤ 2 ε, multiplies a direction's length by up to 1 + 4 δ,
/// and rounds by up to 9 ε, without FMA: 3 ε of d·n, doubled, go along the normal, 2 ε come from the product
/// with it, ε from the sum. The total is 17 ε or 1.0e-6 per event, always with the same sign between two
/// mirrors. Eight events stay below 8.2e-6; the robust sphere test needs 1e-5. Measured: 5e-5 after 1,024
/// events without renormalisation, `tests/laws/long_paths.rs`.
pub const RENORMALIZATION_INTERVAL: u32 = 8;

/// A pipeline at the widths 1, 8 and the widest one.
type Widths = [Pipeline; 3];

/// The compiled pipelines: sets of features, smallest first. A scene gets the first one that holds its
/// features.
///
/// Each costs two to eight seconds of compilation and 100 to 200 kB of program for its three widths, so only
/// sets with a measured gain are here. Speed-up over the general pipeline, measured: `three` 1.7, `thesis`
/// 1.5, `balls` 1.3, a scanned mesh 1.2, `materials` and `spheres` 1.05, boxes with area lights 1.0 to 1.06,
/// where triangle tests take most of the time. All share the loops that test every primitive.
#[cfg(not(octray_general_only))]
const PIPELINES: &[(Features, Widths)] = &[
    pipeline::<{ DIFFUSE_AND_MIRROR_SPHERES.0 }>(),
    pipeline::<{ FEW_TEXTURED.0 }>(),
    pipeline::<{ UNTEXTURED.0 }>(),
    pipeline::<{ ALL_LOBES.0 }>(),
    pipeline::<{ Features::ALL.0 }>(),
];
/// The one pipeline of `--cfg octray_general_only`, with which `.ci/run` checks other processors faster.
#[cfg(octray_general_only)]
const PIPELINES: &[(Features, Widths)] = &[pipeline::<{ Features::ALL.0 }>()];

#[cfg(not(octray_general_only))]
const DIFFUSE_AND_MIRROR_SPHERES: Features =
    Features::SPHERES.with(Features::DIFFUSE).with(Features::MIRROR).with(Features::SKY_GRADIENT);

/// The kind of scene in the thesis: a handful of textured spheres and triangles.
#[cfg(not(octray_general_only))]
const FEW_TEXTURED: Features = Features::SPHERES
    .with(Features::TRIANGLES)
    .with(Features::DIFFUSE)
    .with(Features::MIRROR)
    .with(Features::FUZZY_MIRROR)
    .with(Features::EMISSION)
    .with(Features::TEXTURES);

/// Any number of untextured surfaces under an untextured sky: meshes, boxes with area lights, glass.
#[cfg(not(octray_general_only))]
const UNTEXTURED: Features = Features::SPHERES
    .with(Features::TRIANGLES)
    .with(Features::MANY_SPHERES)
    .with(Features::MANY_TRIANGLES)
    .with(Features::MANY_MATERIALS)
    .with(Features::HIERARCHY)
    .with(Features::DIFFUSE)
    .with(Features::MIRROR)
    .with(Features::GLASS)
    .with(Features::EMISSION)
    .with(Features::SKY_GRADIENT);

/// Every lobe, without textures, vertex normals, or more lights than a register table holds.
#[cfg(not(octray_general_only))]
const ALL_LOBES: Features = UNTEXTURED
    .with(Features::LIGHTS)
    .with(Features::GGX)
    .with(Features::FUZZY_MIRROR)
    .with(Features::PLASTIC)
    .with(Features::METAL_ROUGH);

const fn pipeline<const N: u64>() -> (Features, Widths) {
    (Features(N), [trace_tiles::<f32, N>, trace_tiles::<F32x8, N>, trace_tiles::<Native, N>])
}

/// Returns the pipeline for the features that a scene needs at one of [`crate::lane::WIDTHS`], and the
/// features that it is compiled with.
pub fn pipeline_for(needs: Features, lanes: usize) -> (Features, Pipeline) {
    let (features, widths) =
        PIPELINES.iter().find(|(set, _)| set.contains(needs)).expect("the last pipeline has every feature");
    let width = match lanes {
        1 => 0,
        8 => 1,
        _ => 2,
    };
    (*features, widths[width])
}
