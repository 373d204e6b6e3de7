//! The path estimator, as stages over queues.
//!
//! For: [`trace_tile`], one sample of every pixel of a tile. May import: everything above it. Must never know: threads, files.
//!
//! A tile's paths live in a queue in structure-of-arrays form ([`queue`]). Each stage runs over the whole queue before the
//! next starts:
//!
//! ```text
//! generate → ( extend → shade → search )* → finish
//! ```
//!
//! `generate` makes primary rays, `extend` finds what they hit, `shade` adds light and scatters, and packs the paths that go on
//! to the front of the queue, so that packets stay full; where the scene has lights to look for, it draws rays to them, and `search`
//! adds what arrives (`light`). `finish` is the last segment's shading: light, and no scattering.
//!
//! # The estimator
//! Path tracing by sampling each material's lobe: radiance is what sky and emitters add at the end of each segment, times the
//! throughput so far. Random numbers are [`Sampler`]'s. A path has up to `max_bounces` scattering events. Light is found
//! by hitting it, and emitters that are worth it by looking for them too, with multiple importance sampling.

pub mod cost;
mod extend;
mod generate;
pub mod guides;
mod light;
pub mod queue;
pub mod scatter;
mod shade;
pub mod stats;
pub mod surface;

pub use generate::generate;

use crate::buffers::{Buffers, Features};
use crate::camera::{Pinhole, Tile};
use crate::lane::Lane;
use crate::sampling::{Numbers, Sampler, random};
use crate::traverse::{Primitives, Visible};
use queue::Work;
use stats::Stage;

/// All that tracing reads.
pub struct World {
    pub buffers: Buffers,
    pub primitives: Primitives,
    pub camera: Pinhole,
    /// What the primary rays of each tile can meet, by [`Tile::number`]; empty where finding out would not pay.
    pub visible: Vec<Visible>,
    /// Pixels in a row of the picture.
    pub width: u32,
    pub max_bounces: u32,
    pub seed: u32,
    pub sampler: Sampler,
}

/// A pipeline: [`trace_tile`] at one width, compiled for one set of needs.
pub type Pipeline = fn(&World, Tile, u32, &mut Work) -> u64;

/// Takes sample `sample` of every pixel of a tile into `work`'s radiance and returns how many rays that took. `N` holds the
/// features this pipeline is compiled with; it must contain the scene's [`Features`].
pub fn trace_tile<L: Lane, const N: u32>(world: &World, tile: Tile, sample: u32, work: &mut Work) -> u64 {
    work.enter(Some(Stage::Generate));
    let mut count = generate::<L, N>(world, tile, sample, work);
    let mut rays = count as u64;
    let numbers = |bounce: u32| Numbers::new(world.sampler, world.seed, sample, random::bounce(bounce));
    if world.max_bounces == 0 {
        work.enter_with::<L>(Stage::Finish, world, tile, 0, count);
        shade::finish::<L, N, true>(world, work, count);
        return rays;
    }
    work.enter_with::<L>(Stage::Shade, world, tile, 0, count);
    let mut shaded = shade::shade::<L, N, true>(world, work, count, &numbers(0));
    rays += search::<L, N>(world, work, &shaded);
    for bounce in 1..world.max_bounces {
        count = shaded.going_on;
        rays += count as u64;
        work.enter_with::<L>(Stage::Extend, world, tile, bounce, count);
        if bounce.is_multiple_of(RENORMALIZATION_INTERVAL) {
            work.queue.normalize_directions::<L>(count);
        }
        extend::extend::<L, N>(world, work, count);
        work.enter(Some(Stage::Shade));
        shaded = shade::shade::<L, N, false>(world, work, count, &numbers(bounce));
        rays += search::<L, N>(world, work, &shaded);
    }
    count = shaded.going_on;
    work.enter_with::<L>(Stage::Extend, world, tile, world.max_bounces, count);
    extend::extend::<L, N>(world, work, count);
    work.enter(Some(Stage::Finish));
    shade::finish::<L, N, false>(world, work, count);
    rays + count as u64
}

/// Traces the rays to lights and adds what arrives; returns how many there are.
#[inline(always)]
fn search<L: Lane, const N: u32>(world: &World, work: &mut Work, shaded: &shade::Shaded) -> u64 {
    if surface::has(N, Features::LIGHTS) && shaded.searching > 0 {
        light::trace_shadow_rays::<L>(world, work, shaded.searching);
    }
    shaded.searching as u64
}

/// Directions are brought back to unit length after so many events. A mirror whose normal has the length 1 + δ, |δ| ≤ 2 ε, multiplies
/// a direction's length by up to 1 + 4 δ, and rounds by up to 9 ε, without FMA: 3 ε of d·n, doubled, go along the normal, 2 ε come from the
/// product with it, ε from the sum. That is 17 ε or 1.0e-6 an event, always the same way between two mirrors. Eight events stay below
/// 8.2e-6; the robust sphere test asks for 1e-5. Measured: 5e-5 after 1,024 events if nothing is done, `tests/long_paths.rs`.
pub const RENORMALIZATION_INTERVAL: u32 = 8;

/// The pipelines there are: sets of features, smallest first. Each costs two to four seconds of compilation and 100 to 200 kB of program for its
/// two widths, so only sets that measured well are here; a scene gets the first that holds its needs. Against the general one, measured:
/// `three` 1.7, `thesis` 1.5, `balls` 1.3, a scanned mesh 1.2, boxes with lamps 1.0 to 1.06, where testing triangles is most of the time. Other equations than the default ones go through a function that
/// all share: six pairs of methods would be most of a pipeline's code.
const PIPELINES: &[(Features, Pipeline, Pipeline)] = &[
    pipeline::<{ MATT_AND_MIRROR_SPHERES.0 }>(),
    pipeline::<{ FEW_TEXTURED.0 }>(),
    pipeline::<{ PLAIN.0 }>(),
    pipeline::<{ PLAIN.with(Features::LIGHTS).0 }>(),
    pipeline::<{ Features::ALL.0 }>(),
];

const MATT_AND_MIRROR_SPHERES: Features =
    Features::SPHERES.with(Features::DIFFUSE).with(Features::MIRROR).with(Features::SKY_GRADIENT);

/// The thesis's kind of scene: a handful of spheres and triangles with pictures on them.
const FEW_TEXTURED: Features = Features::SPHERES
    .with(Features::TRIANGLES)
    .with(Features::DIFFUSE)
    .with(Features::MIRROR)
    .with(Features::SCATTER)
    .with(Features::EMISSION)
    .with(Features::TEXTURES);

/// Surfaces of even colour under a plain sky, as many as there may be: meshes, boxes with lamps, glass.
const PLAIN: Features = Features::SPHERES
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

const fn pipeline<const N: u32>() -> (Features, Pipeline, Pipeline) {
    (Features(N), trace_tile::<f32, N>, trace_tile::<crate::lane::F32x8, N>)
}

/// The pipeline for a scene's needs at a width of 1 or 8, and the features that it has.
pub fn pipeline_for(needs: Features, lanes: usize) -> (Features, Pipeline) {
    let (features, scalar, packets) =
        PIPELINES.iter().find(|(set, ..)| set.contains(needs)).expect("the last pipeline has every feature");
    (*features, if lanes == 1 { *scalar } else { *packets })
}
