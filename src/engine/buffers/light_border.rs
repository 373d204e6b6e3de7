//! The border of a light: the strip around a parallelogram that emits close to a surface.
//!
//! The surface there is lit from so near that it is nearly as bright as the light, as a ceiling around a lamp
//! below it. So a share of the rays that leave diffuse surfaces is sent there: [`crate::kernel::guiding`].

use crate::kernel::border::Strip;
use crate::scene::{Scene, Triangle};
use glam::DVec3;

/// The width of the strip, in distances of the surface: there irradiance falls to a hundredth.
const WIDTH: f64 = 4.0;
/// A surface is close up to this share of the light's shorter edge. Farther away it is less bright and more
/// easily found.
const MAX_DISTANCE: f64 = 0.05;
/// Nearer than this share it is so narrow that little light comes from it.
const MIN_DISTANCE: f64 = 1e-3;
/// The least cosine between the normals of light and surface.
const MIN_COSINE: f64 = 0.9;

impl Strip {
    /// The border of the parallelogram whose one half is the triangle `light`, with the vertex `corner`
    /// opposite the other half; `None` if no surface is close to it, at its centre and beyond each of its
    /// edges.
    pub(super) fn of(scene: &Scene, light: usize, corner: usize) -> Option<Self> {
        let vertices = scene.triangles[light].vertices;
        let [a, b, c] = [0, 1, 2].map(|index| vertices[(corner + index) % 3].as_dvec3());
        let (ab, ac) = (b - a, c - a);
        let area = ab.cross(ac).length();
        let normal = ab.cross(ac) / area;
        // Its two heights.
        let side = (area / ab.length()).min(area / ac.length());
        let center = a + 0.5 * (ab + ac);
        let near = [normal, -normal].map(|direction| (distance(scene, center, direction), direction));
        let (height, direction) = near.into_iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
        if !(MIN_DISTANCE * side..=MAX_DISTANCE * side).contains(&height) {
            return None;
        }
        let width = WIDTH * height;
        // In units of the edges, so that the strip is `width` wide across them.
        let margins = [width * ac.length() / area, width * ab.length() / area];
        let middle = |x: f64, y: f64| a + ab * x + ac * y;
        let beyond = [
            middle(0.5, -0.5 * margins[1]),
            middle(0.5, 1.0 + 0.5 * margins[1]),
            middle(-0.5 * margins[0], 0.5),
            middle(1.0 + 0.5 * margins[0], 0.5),
        ];
        let is_close = |&point: &DVec3| (distance(scene, point, direction) / height - 1.0).abs() < 0.1;
        beyond.iter().all(is_close).then(|| Self::new(a.as_vec3(), ab.as_vec3(), ac.as_vec3(), margins))
    }
}

/// The distance from `point` along the unit vector `direction` to the nearest triangle that lies nearly
/// across and does not emit; infinite without one.
fn distance(scene: &Scene, point: DVec3, direction: DVec3) -> f64 {
    let emits =
        |triangle: &&Triangle| scene.materials[triangle.material as usize].emission.max_element() > 0.0;
    let others = scene.triangles.iter().filter(|triangle| !emits(triangle));
    let hits = others.filter_map(|triangle| {
        let [a, b, c] = triangle.vertices.map(|vertex| vertex.as_dvec3());
        let (ab, ac) = (b - a, c - a);
        let normal = ab.cross(ac);
        let cosine = normal.dot(direction);
        let t = normal.dot(a - point) / cosine;
        let at = point + direction * t - a;
        let (u, v) = (at.cross(ac).dot(normal), ab.cross(at).dot(normal));
        let inside = u >= 0.0 && v >= 0.0 && u + v <= normal.length_squared();
        (cosine.abs() > MIN_COSINE * normal.length() && t > 0.0 && inside).then_some(t)
    });
    hits.fold(f64::INFINITY, f64::min)
}
