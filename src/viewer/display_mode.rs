//! Computes the colours of the display modes: false-colour images of normals, depth, cost and the like.

use glam::Vec3;
use octray_engine::integrate::aovs::{AovSample, Aovs, Plane};
use octray_engine::integrate::meter::PathShape;
use octray_engine::math::MISS;
use octray_engine::render::aovs::Cost;
use octray_engine::tone::srgb_byte;
use octray_formats::scene::Camera;

/// The content of a frame.
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
    /// Returns its name and the meaning of its colours.
    pub fn name_and_legend(self) -> (&'static str, &'static str) {
        match self {
            Self::Picture => ("picture", ""),
            Self::Normals => ("normals", "x red, y green, z blue, from -1 to 1"),
            Self::Albedo => ("albedo", "reflectance of the surface"),
            Self::Depth => (
                "depth",
                "logarithmic: white at the nearest pixel, black at the distance of the 90th percentile",
            ),
            Self::Barycentrics => {
                ("barycentrics", "a triangle's first vertex red, second green, third blue; grey on spheres")
            }
            Self::Lambert => ("n·l", "normals against a light from above, behind and left of the camera"),
            Self::Bounces => ("bounces", "bounces of the last sample: black 0, white the maximum"),
            Self::Cost => {
                ("cost", "box and primitive tests of the camera's ray: black 1, white the largest number")
            }
            Self::Samples => ("samples", "samples behind each pixel: black 1, white 65,536 and more"),
            Self::Lanes => ("lanes", "active lanes of the packets of a pixel's path: black 0, white all"),
        }
    }
}

pub fn normal(aov: &AovSample) -> u32 {
    match aov.object {
        MISS => 0,
        _ => rgb((aov.normal * 0.5 + 0.5).to_array()),
    }
}

pub fn albedo(aov: &AovSample) -> u32 {
    rgb(aov.albedo.map(encode))
}

/// Returns white at the distance `near`, black at `far`, and greys between on a logarithmic scale.
pub fn depth(aov: &AovSample, [near, far]: [f32; 2]) -> u32 {
    // Infinite distances are black, and so is everything if all distances are equal.
    let near = near.max(far * 1e-3);
    grey((far / aov.distance).ln() / (far / near).ln().max(f32::MIN_POSITIVE))
}

/// Returns the smallest distance and the 90th percentile. `memory` is working memory.
pub fn depth_range(aovs: &Aovs, memory: &mut Vec<f32>) -> [f32; 2] {
    memory.clear();
    let rows = (0..aovs.resolution()[1]).flat_map(|y| aovs.row(Plane::Distance, y));
    memory.extend(rows.copied().filter(|distance| distance.is_finite()));
    if memory.is_empty() {
        return [0.0; 2];
    }
    let last = memory.len() - 1;
    let (nearer, far, _) = memory.select_nth_unstable_by(last * 9 / 10, f32::total_cmp);
    let far = *far;
    [nearer.iter().copied().fold(far, f32::min), far]
}

pub fn barycentrics(aov: &AovSample) -> u32 {
    match aov.weights {
        _ if aov.object == MISS => 0,
        [0.0, 0.0] => grey(0.3),
        [u, v] => rgb([1.0 - u - v, u, v]),
    }
}

/// Shades by the cosine between the normal and `light`, a unit vector: see [`light_behind`].
pub fn n_dot_l(aov: &AovSample, light: Vec3) -> u32 {
    grey(encode(aov.normal.dot(light)))
}

/// Returns the direction towards a light above, behind and left of the camera.
pub fn light_behind(camera: &Camera) -> Vec3 {
    let up = camera.up.normalize();
    let sight = (camera.look_at - camera.position).normalize();
    (up * 0.8 - sight * 0.5 - sight.cross(up).normalize_or(Vec3::ZERO) * 0.4).normalize()
}

pub fn bounces(shape: &PathShape, max_bounces: u32) -> u32 {
    heat_map(shape.segments.saturating_sub(1) as f32 / max_bounces.max(1) as f32)
}

/// Returns the colour of a path's mean share of active lanes; `width` is the number of lanes of a packet.
pub fn lanes(&PathShape { segments, lanes }: &PathShape, width: usize) -> u32 {
    heat_map(lanes as f32 / (segments.max(1) * width as u32) as f32)
}

/// Returns the number of box and primitive tests of a pixel.
pub fn tests(cost: &Cost) -> u32 {
    cost.boxes + cost.primitives
}

/// Returns the colour of a number of tests on a logarithmic scale; `most` tests are white.
pub fn cost(cost: &Cost, most: u32) -> u32 {
    heat_map((tests(cost).max(1) as f32).log2() / (most.max(2) as f32).log2())
}

pub fn samples(count: f32) -> u32 {
    heat_map(count.max(1.0).log2() / 16.0)
}

/// Returns the display value of an intensity, both from 0 to 1.
pub fn encode(linear: f32) -> f32 {
    f32::from(srgb_byte(linear)) / 255.0
}

/// Returns the pixel of display values from 0 to 1.
pub fn rgb([r, g, b]: [f32; 3]) -> u32 {
    let byte = |x: f32| (x.clamp(0.0, 1.0) * 255.0 + 0.5) as u32;
    byte(r) << 16 | byte(g) << 8 | byte(b)
}

fn grey(x: f32) -> u32 {
    rgb([x; 3])
}

/// Maps 0 to 1 to black, blue, red, yellow and white, with growing brightness.
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
    fn heat_map_means_what_the_legends_say() {
        let half = [0.0, 0.5, 1.0].map(heat_map);
        let shapes = [(1, 0), (2, 1), (2, 2)].map(|(segments, lanes)| PathShape { segments, lanes });
        let costs = [(0, 1), (16, 16), (1_000, 24)].map(|(boxes, primitives)| Cost { boxes, primitives });
        assert_eq!([1.0, 256.0, 65_536.0].map(samples), half);
        assert_eq!(costs.map(|tests| cost(&tests, 1_024)), half);
        assert_eq!([1, 4, 16].map(|primitives| cost(&Cost { boxes: 0, primitives }, 16)), half);
        assert_eq!(shapes.map(|shape| lanes(&shape, 1)), half);
        assert_eq!(shapes.map(|shape| bounces(&shape, 2)), [0.0, 0.5, 0.5].map(heat_map));
    }

    #[test]
    fn aovs_are_painted_as_their_legends_say() {
        let aov = AovSample {
            distance: 2.0,
            normal: Vec3::new(0.0, 1.0, -1.0),
            albedo: [1.0; 3],
            weights: [1.0, 0.0],
            lobe: 1.0,
            object: 0,
        };
        assert_eq!(normal(&aov), 0x80ff00);
        assert_eq!(barycentrics(&aov), 0x00ff00);
        assert_eq!(barycentrics(&AovSample { weights: [0.0, 0.0], ..aov }), 0x4d4d4d);
        assert_eq!(n_dot_l(&aov, Vec3::Y), 0xffffff);
        assert_eq!(n_dot_l(&aov, Vec3::NEG_Y), 0);
        let at = |distance| depth(&AovSample { distance, ..aov }, [2.0, 10.0]);
        assert_eq!([2.0, 10.0, 99.0].map(at), [0xffffff, 0, 0]);
        assert_eq!(at(20f32.sqrt()), 0x808080, "half way in ratios");
        let nothing = AovSample { distance: f32::INFINITY, object: MISS, ..aov };
        assert_eq!((normal(&nothing), barycentrics(&nothing), depth(&nothing, [2.0, 10.0])), (0, 0, 0));
    }
}
