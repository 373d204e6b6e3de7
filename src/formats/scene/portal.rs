//! Checks the four points of portals.

use super::write::placed;
use glam::{DVec3, Vec3};
use octray_engine::scene::{Coordinates, MAX_PORTALS, Portal, Scene, Sky};

/// The largest distance of the fourth corner from its place in a parallelogram, relative to the diagonals.
const MOST_SKEW: f64 = 1e-3;

/// Returns the portal of four points in a scene's coordinates, its third corner moved to complete the
/// parallelogram of the others; or the fault, and the remedy in the coordinates of the file.
pub fn portal(points: [DVec3; 4], coordinates: &Coordinates) -> Result<Portal, (&'static str, String)> {
    let [a, b, c, d] = points.map(DVec3::as_vec3).map(Vec3::as_dvec3);
    let size = a.distance(c).max(b.distance(d));
    let normal = (c - a).cross(d - b);
    // Squares of areas are computed in single precision.
    if normal.length() < 1e-6 * size * size || !(normal.length_squared() as f32).is_normal() {
        let mend = "name them in their order around the opening, so that they span an area";
        return Err(("the four points of a portal span no area", mend.to_string()));
    }
    let fourth = b + d - a;
    if fourth.distance(c) <= MOST_SKEW * size {
        return Ok(Portal { vertices: [a, b, fourth, d].map(DVec3::as_vec3) });
    }
    let around = rectangle_around([a, b, c, d], normal).map(|point| placed(point.as_vec3(), coordinates));
    let mend = format!("write the rectangle around them: \"vertices\": [{}]", around.join(", "));
    Err(("the four points of a portal make no parallelogram", mend))
}

/// Returns the smallest rectangle around points that is parallel to one of their sides and faces along a
/// normal.
fn rectangle_around(points: [DVec3; 4], normal: DVec3) -> [DVec3; 4] {
    let n = normal.normalize();
    let height = n * (points.into_iter().sum::<DVec3>().dot(n) / 4.0);
    let along_side = |side: usize| {
        let right =
            (points[(side + 1) % 4] - points[side]).reject_from(n).normalize_or(n.any_orthonormal_vector());
        let axes = [right, n.cross(right)];
        let [[left, right], [low, high]] = axes.map(|axis| {
            let along = points.map(|point| point.dot(axis));
            [along.into_iter().fold(f64::MAX, f64::min), along.into_iter().fold(f64::MIN, f64::max)]
        });
        let corners = [[left, low], [right, low], [right, high], [left, high]];
        ((right - left) * (high - low), corners.map(|[x, y]| axes[0] * x + axes[1] * y + height))
    };
    let smallest = (1..4).map(along_side).fold(along_side(0), |a, b| if b.0 < a.0 { b } else { a });
    smallest.1
}

/// Returns the fault and the remedy of a scene with too many portals.
pub fn too_many(scene: &Scene) -> Option<(String, String)> {
    let count = scene.portals.len();
    let mend = || format!("leave at most {MAX_PORTALS}, for the openings through which most light comes");
    (count > MAX_PORTALS).then(|| (format!("the scene holds {count} portals"), mend()))
}

/// Returns a warning if the portals do nothing under this sky, or for what this camera shows.
pub fn warning(scene: &Scene, sky: &Sky, camera: Vec3) -> Option<&'static str> {
    let is_behind = |&Portal { vertices: [a, b, _, d] }: &Portal| (b - a).cross(d - a).dot(camera - a) < 0.0;
    match scene.portals.is_empty() {
        true => None,
        false if sky.is_black() => Some("The sky is black: no light comes through the scene's portals."),
        false => scene.portals.iter().all(is_behind).then_some(
            "The camera is behind every portal: if it is in the room, reverse the order of their points, which is \
             anticlockwise as seen from the room.",
        ),
    }
}
