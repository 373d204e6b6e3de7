//! Display modes: the picture, or a false-colour image of normals, depth, cost and the like.
//!
//! For: [`DisplayMode`], and [`paint`], which fills a frame's pixels with one.

use glam::Vec3;
use octray_engine::integrate::aovs::{AovSample, Aovs, Plane};
use octray_engine::integrate::probe::PathShape;
use octray_engine::math::MISS;
use octray_engine::render::aovs::{Cost, Map};

/// What a frame shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DisplayMode {
    #[default]
    Picture,
    Normals,
    Albedo,
    Depth,
    Barycentrics,
    Lambert,
    Bounces,
    Cost,
    Samples,
    Lanes,
}

impl DisplayMode {
    #[cfg(test)]
    pub const ALL: [Self; 10] = [
        Self::Picture,
        Self::Normals,
        Self::Albedo,
        Self::Depth,
        Self::Barycentrics,
        Self::Lambert,
        Self::Bounces,
        Self::Cost,
        Self::Samples,
        Self::Lanes,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Picture => "picture",
            Self::Normals => "normals",
            Self::Albedo => "albedo",
            Self::Depth => "depth",
            Self::Barycentrics => "barycentrics",
            Self::Lambert => "n·l",
            Self::Bounces => "bounces",
            Self::Cost => "cost",
            Self::Samples => "samples",
            Self::Lanes => "lanes",
        }
    }

    /// What the colours mean.
    pub fn legend(self) -> &'static str {
        match self {
            Self::Picture => "",
            Self::Normals => "x red, y green, z blue, from -1 to 1",
            Self::Albedo => "reflectance of the surface",
            Self::Depth => {
                "from the nearest, white, to what nine tenths of the pixels are nearer than, black"
            }
            Self::Barycentrics => "a triangle's first vertex red, second green, third blue; grey on spheres",
            Self::Lambert => "normals against a light from above, behind and left of the camera",
            Self::Bounces => "black none, white all that are allowed, of the last sample",
            Self::Cost => "tests of boxes and primitives for the camera's ray: black 1, white 1,024 and more",
            Self::Samples => "samples behind each pixel: black 1, white 65,536 and more",
            Self::Lanes => {
                "active lanes of the packets of a pixel's path, each tile traced alone: black 0, white all"
            }
        }
    }
}

/// What display modes are painted from.
pub struct ModeInput<'a> {
    pub aovs: &'a Aovs,
    pub shapes: &'a Map<PathShape>,
    pub costs: &'a Map<Cost>,
    /// Samples behind each pixel, row by row.
    pub samples: &'a [f32],
    /// Direction towards the light of [`DisplayMode::Lambert`], of unit length.
    pub light: Vec3,
    /// The distances that [`DisplayMode::Depth`] shows as white and as black: see [`depth_range`].
    pub range: [f32; 2],
    /// Bounces allowed, and lanes of a packet.
    pub max_bounces: u32,
    pub lanes: usize,
}

/// Fills pixels (0x00RRGGBB, row by row from the top) in a mode other than the picture.
pub fn paint(mode: DisplayMode, from: &ModeInput, pixels: &mut [u32]) {
    let width = from.aovs.resolution()[0] as usize;
    for (at, pixel) in pixels.iter_mut().enumerate() {
        let guide = || from.aovs.pixel((at % width) as u32, (at / width) as u32);
        *pixel = match mode {
            DisplayMode::Picture => continue,
            DisplayMode::Normals => normal(&guide()),
            DisplayMode::Albedo => rgb(guide().albedo.map(encode)),
            DisplayMode::Depth => grey(depth(&guide(), from.range)),
            DisplayMode::Barycentrics => barycentrics(&guide()),
            DisplayMode::Lambert => n_dot_l(&guide(), from.light),
            DisplayMode::Bounces => {
                let bounces = from.shapes.pixels[at].segments.saturating_sub(1);
                heat_map(bounces as f32 / from.max_bounces.max(1) as f32)
            }
            DisplayMode::Cost => {
                let Cost { boxes, primitives } = from.costs.pixels[at];
                heat_map(((boxes + primitives) as f32).max(1.0).log2() / 10.0)
            }
            DisplayMode::Samples => heat_map(from.samples[at].max(1.0).log2() / 16.0),
            DisplayMode::Lanes => {
                let PathShape { segments, lanes } = from.shapes.pixels[at];
                heat_map(lanes as f32 / (segments.max(1) * from.lanes as u32) as f32)
            }
        };
    }
}

fn normal(guide: &AovSample) -> u32 {
    match guide.object {
        MISS => 0,
        _ => rgb((guide.normal * 0.5 + 0.5).to_array()),
    }
}

fn depth(guide: &AovSample, [near, far]: [f32; 2]) -> f32 {
    // Logarithmic. Infinite distances are black, and so is everything if all distances are equal.
    let near = near.max(far * 1e-3);
    ((far / guide.distance).ln() / (far / near).ln().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0)
}

/// The smallest distance and the 90th percentile. `memory` is working memory.
pub fn depth_range(guides: &Aovs, memory: &mut Vec<f32>) -> [f32; 2] {
    memory.clear();
    let rows = (0..guides.resolution()[1]).flat_map(|y| guides.row(Plane::Distance, y));
    memory.extend(rows.copied().filter(|distance| distance.is_finite()));
    if memory.is_empty() {
        return [0.0; 2];
    }
    let last = memory.len() - 1;
    let (nearer, far, _) = memory.select_nth_unstable_by(last * 9 / 10, f32::total_cmp);
    let far = *far;
    [nearer.iter().copied().fold(far, f32::min), far]
}

fn barycentrics(guide: &AovSample) -> u32 {
    match guide.weights {
        _ if guide.object == MISS => 0,
        [0.0, 0.0] => grey(0.3),
        [u, v] => rgb([1.0 - u - v, u, v]),
    }
}

fn n_dot_l(guide: &AovSample, light: Vec3) -> u32 {
    grey(encode(guide.normal.dot(light).max(0.0)))
}

/// Approximates sRGB's curve: these colours are for reading, not for measuring.
fn encode(linear: f32) -> f32 {
    linear.max(0.0).powf(1.0 / 2.2)
}

/// Display values from 0 to 1.
pub fn rgb([r, g, b]: [f32; 3]) -> u32 {
    let byte = |x: f32| (x.clamp(0.0, 1.0) * 255.0 + 0.5) as u32;
    byte(r) << 16 | byte(g) << 8 | byte(b)
}

fn grey(x: f32) -> u32 {
    rgb([x; 3])
}

/// A heat map from 0 to 1: black, blue, red, yellow, white, with growing brightness.
pub fn heat_map(x: f32) -> u32 {
    const STOPS: [[f32; 3]; 6] = [
        [0.0, 0.0, 0.0],
        [0.15, 0.1, 0.5],
        [0.55, 0.1, 0.5],
        [0.9, 0.3, 0.2],
        [1.0, 0.75, 0.2],
        [1.0, 1.0, 1.0],
    ];
    let place = if x.is_nan() { 0.0 } else { x.clamp(0.0, 1.0) * (STOPS.len() - 1) as f32 };
    let below = (place as usize).min(STOPS.len() - 2);
    let share = place - below as f32;
    let [low, high] = [STOPS[below], STOPS[below + 1]];
    rgb(std::array::from_fn(|channel| low[channel] + (high[channel] - low[channel]) * share))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heat_grows_brighter_from_black_to_white() {
        let brightness = |color: u32| {
            let [_, r, g, b] = color.to_be_bytes();
            0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
        };
        assert_eq!(
            (heat_map(-1.0), heat_map(0.0), heat_map(1.0), heat_map(7.0)),
            (0, 0, 0xff_ffff, 0xff_ffff)
        );
        assert_eq!(heat_map(f32::NAN), 0);
        let shades: Vec<f64> = (0..=100).map(|step| brightness(heat_map(step as f32 / 100.0))).collect();
        assert!(shades.is_sorted(), "{shades:?}");
    }

    #[test]
    fn heat_map_means_what_the_legends_say() {
        let (mut guides, mut shapes, mut costs) = (Aovs::default(), Map::default(), Map::default());
        guides.resize([3, 1]);
        shapes.pixels =
            [(1, 0), (2, 1), (2, 2)].map(|(segments, lanes)| PathShape { segments, lanes }).into();
        costs.pixels =
            [(0, 1), (16, 16), (1_000, 24)].map(|(boxes, primitives)| Cost { boxes, primitives }).into();
        let sources = ModeInput {
            aovs: &guides,
            shapes: &shapes,
            costs: &costs,
            samples: &[1.0, 256.0, 65_536.0],
            light: Vec3::Y,
            range: [0.0; 2],
            max_bounces: 2,
            lanes: 1,
        };
        let painted = |mode| {
            let mut pixels = [0; 3];
            paint(mode, &sources, &mut pixels);
            pixels
        };
        let half = [0.0, 0.5, 1.0].map(heat_map);
        assert_eq!([DisplayMode::Cost, DisplayMode::Samples, DisplayMode::Lanes].map(painted), [half; 3]);
        assert_eq!(painted(DisplayMode::Bounces), [0.0, 0.5, 0.5].map(heat_map));
    }

    #[test]
    fn aovs_are_painted_as_their_legends_say() {
        let guide = AovSample {
            distance: 2.0,
            normal: Vec3::new(0.0, 1.0, -1.0),
            albedo: [1.0; 3],
            weights: [1.0, 0.0],
            lobe: 1.0,
            object: 0,
        };
        assert_eq!(normal(&guide), 0x80ff00);
        assert_eq!(barycentrics(&guide), 0x00ff00);
        assert_eq!(barycentrics(&AovSample { weights: [0.0, 0.0], ..guide }), 0x4d4d4d);
        assert_eq!(n_dot_l(&guide, Vec3::Y), 0xffffff);
        assert_eq!(n_dot_l(&guide, Vec3::NEG_Y), 0);
        let at = |distance| depth(&AovSample { distance, ..guide }, [2.0, 10.0]);
        assert_eq!([2.0, 10.0, 99.0].map(at), [1.0, 0.0, 0.0]);
        assert!((at(20f32.sqrt()) - 0.5).abs() < 1e-6, "half way in ratios");
        let nothing = AovSample { distance: f32::INFINITY, object: MISS, ..guide };
        assert_eq!((normal(&nothing), barycentrics(&nothing), depth(&nothing, [2.0, 10.0])), (0, 0, 0.0));
    }
}
