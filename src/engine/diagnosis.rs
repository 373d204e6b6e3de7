//! Explains why a picture is black, nearly black, white, or lacks light, and names the option that helps.
//!
//! Thresholds are conservative, because a scene may be dark on purpose. A picture is black if all of it is 0;
//! nearly black if 95 % of it is darker than `DARK` and no pixel is brighter than `DIM`, as stars or a light
//! would be; white if half of it is brighter than `BURNT`, which a white background is not. `Loss::is_large`
//! decides about light lost at the bounce limit.

use crate::camera::Tile;
use crate::film::{Film, TileSums};
use crate::math::MISS;
use crate::openings;
use crate::render::Renderer;
use crate::scene::{MAX_BOUNCES, Scene, Sphere};
use crate::tone::{MAX_EXPOSURE, Tone};

/// Thresholds of displayed intensity, with white at 1: the first two are sRGB 25 and 137 of 255.
const DARK: f32 = 0.01;
const DIM: f32 = 0.25;
const BURNT: f32 = 1.5;
/// The approximate number of tiles in which paths are traced again with more bounces.
const PROBED_TILES: usize = 36;
/// Limits below this number of bounces are taken as intended.
const LEAST_BOUNCES: u32 = 2;
/// The number of neighbouring paths that must lose light together, because one alone may be noise.
const BLOCK: usize = 16;

/// Returns one warning for each problem found in the scene's film. `tone` is the display's; a linear file has
/// none. Traces two samples of some tiles, and changes no bit of the picture.
pub fn warnings(renderer: &mut Renderer, scene: &Scene, film: &Film, tone: Option<Tone>) -> Vec<String> {
    // A scene without light has its own warning.
    if film.pixels_begun() < film.pixels() || scene.sky.is_black() && !scene.emits() {
        return Vec::new();
    }
    let brightness = Brightness::of(film);
    let bounces = renderer.settings().max_bounces;
    let more = (4 * bounces).clamp(4, MAX_BOUNCES);
    let loss = (bounces < more).then(|| Loss::measure(renderer, 4.0 * brightness.bright, more));
    if brightness.most == 0.0 {
        let more = loss.filter(|loss| loss.total > 0.0).map(|_| more);
        return vec![format!("the picture is black: {}", why_black(renderer, scene, film, more))];
    }
    let loss = loss.filter(|loss| bounces >= LEAST_BOUNCES && loss.is_large()).map(|loss| {
        let [total, blocks] = [loss.total, loss.blocks].map(|share| 100.0 * share);
        format!(
            "paths end after {bounces} bounces, which loses {total:.0} % of the light, and most of it in {blocks:.0} % of \
             the picture: try --bounces {more}"
        )
    });
    let opening = openings::advice(scene, renderer.structure());
    loss.into_iter().chain(tone.and_then(|tone| brightness.wrong_exposure(tone))).chain(opening).collect()
}

/// Returns the likeliest reason for a picture without any light. `more` bounces would bring some.
fn why_black(renderer: &Renderer, scene: &Scene, film: &Film, more: Option<u32>) -> String {
    let bounces = renderer.settings().max_bounces;
    let camera = renderer.camera().position();
    let is_around = |sphere: &Sphere| {
        let material = &scene.materials[sphere.material as usize];
        let is_opaque = !material.is_clear() && !material.emits() && material.is_opaque();
        is_opaque && sphere.center.distance(camera) < sphere.radius
    };
    if let Some(more) = more {
        format!("no light is reached within {bounces} bounces: try --bounces {more}")
    } else if let Some(index) = scene.spheres.iter().position(is_around) {
        format!("the camera is inside spheres[{index}]: move its `position` out of the ball")
    } else if renderer.primary_hits(0).iter().all(|hit| hit.primitive == MISS) {
        "nothing is in view: let `look_at` name a point of the scene, or leave out `camera`".to_string()
    } else if film.rays() == film.pixel_samples() && bounces > 0 {
        // No path continued after its first ray.
        "nothing in view reflects light: give its materials a brighter `color`".to_string()
    } else {
        "no path has found a light: make it larger, or move away what is in front of it".to_string()
    }
}

/// The brightness of a film's pixels, by their brightest channel.
struct Brightness {
    most: f32,
    /// The 95 % quantile, rounded down to two bits.
    bright: f32,
    /// The median of the pixels' darkest channels, rounded down to two bits.
    half: f32,
}

impl Brightness {
    fn of(film: &Film) -> Self {
        let mut most = 0.0_f32;
        // Counts of pixels by exponent and two more bits.
        let [mut highest, mut lowest] = [[0_u64; 1 << 10]; 2];
        for tile in film.tiles() {
            for slot in 0..tile.tile.pixels() {
                let pixel = tile.mean(slot).map(|channel| (channel as f32).max(0.0));
                let ends =
                    [pixel.into_iter().fold(0.0, f32::max), pixel.into_iter().fold(f32::MAX, f32::min)];
                most = most.max(ends[0]);
                highest[(ends[0].to_bits() >> 21) as usize] += 1;
                lowest[(ends[1].to_bits() >> 21) as usize] += 1;
            }
        }
        let quantile = |counts: &[u64], share: f64| {
            let mut below = (share * film.pixels() as f64) as u64;
            let found = counts.iter().position(|&count| {
                let is_here = count > below;
                below = below.saturating_sub(count);
                is_here
            });
            f32::from_bits((found.unwrap_or(0) as u32) << 21)
        };
        Self { most, bright: quantile(&highest, 0.95), half: quantile(&lowest, 0.5) }
    }

    /// Returns a warning and the exposure that helps, if the picture is nearly black or white.
    fn wrong_exposure(&self, tone: Tone) -> Option<String> {
        let Self { most, bright, half } = *self;
        let [shown_most, shown_bright, shown_half] =
            [most, bright, half].map(|radiance| radiance * tone.exposure.exp2());
        // The exposure that shows this radiance as white.
        let mend = |white: f32, lights: &str| {
            let stops = -white.log2().round();
            match stops.abs() <= MAX_EXPOSURE {
                true => format!("try --exposure {stops:+}, or {lights} lights"),
                false => {
                    format!("beyond any --exposure: make all lights {:.0e} times as bright", white.recip())
                }
            }
        };
        // Rounds to two significant digits.
        let digits = |x: f32| match x.log10().floor() {
            exponent if (-4.0..6.0).contains(&exponent) => {
                format!("{x:.0$}", (1.0 - exponent).max(0.0) as usize)
            }
            _ => format!("{x:.1e}"),
        };
        if shown_bright < DARK && shown_most < DIM {
            let mend = mend(if bright > 0.0 { bright } else { most }, "brighter");
            let most = digits(most);
            return Some(format!("the picture is nearly black, its brightest pixel is {most}: {mend}"));
        }
        let is_white = shown_half > BURNT && tone.operator.map(shown_half) > 0.998;
        is_white.then(|| {
            let mend = mend(1.5 * half, "dimmer");
            format!("half of the picture is white, brighter than {}: {mend}", digits(half))
        })
    }
}

/// The light that more bounces would bring.
struct Loss {
    /// The share of all light.
    total: f32,
    /// The share of the blocks of paths that have less than half of their light, three paths in four too.
    blocks: f32,
}

impl Loss {
    /// Compares the same paths with the set number of bounces and with `more`. Brighter paths count as
    /// `most`, unless it is 0, so that no single path decides.
    fn measure(renderer: &mut Renderer, most: f32, more: u32) -> Self {
        let settings = *renderer.settings();
        let step = (Tile::cover(settings.resolution, settings.tile_size).count() / PROBED_TILES).max(1);
        // Scattered, so that not all rows of tiles use the same columns.
        let scattered = |number: usize| (number as u32).wrapping_mul(0x9E37_79B9) >> 16;
        let keep = |number| (scattered(number) as usize).is_multiple_of(step);
        let limit = if most > 0.0 { most } else { f32::MAX };
        let mut light = |max_bounces| -> Vec<f32> {
            renderer.set_bounces(max_bounces);
            let mut film = Film::of_tiles(settings.resolution, settings.tile_size, keep);
            renderer.add_samples(&mut film, 1);
            let of_path = |[r, g, b]: [f64; 3]| ((r + g + b) as f32).min(limit);
            let of_tile = |tile: &TileSums| (0..tile.tile.pixels()).map(|slot| tile.mean(slot)).collect();
            film.tiles().iter().flat_map::<Vec<_>, _>(of_tile).map(of_path).collect()
        };
        let [short, long] = [settings.max_bounces, more].map(&mut light);
        renderer.set_bounces(settings.max_bounces);
        let [short_sum, long_sum] = [&short, &long].map(|light| light.iter().sum::<f32>());
        let halved = |(short, long): (&[f32], &[f32])| {
            let halved = short.iter().zip(long).filter(|(short, long)| 2.0 * **short < **long);
            // Where paths seldom find light, many are halved, but not their sum.
            let [short_sum, long_sum] = [short, long].map(|light| light.iter().sum::<f32>());
            4 * halved.count() >= 3 * short.len() && 2.0 * short_sum < long_sum
        };
        let blocks = || short.chunks(BLOCK).zip(long.chunks(BLOCK));
        Self {
            total: if long_sum > 0.0 { 1.0 - short_sum / long_sum } else { 0.0 },
            blocks: blocks().filter(|block| halved(*block)).count() as f32 / blocks().count() as f32,
        }
    }

    /// Tests whether half of all light is lost, as in a white room, or most of it somewhere, as in nested
    /// glass. Measured: up to 0.002 of the blocks in the built-in scenes with 4 bounces, 0.026 in the book's
    /// scene with a hollow glass ball.
    fn is_large(&self) -> bool {
        self.total >= 0.5 || self.blocks >= 0.015
    }
}
