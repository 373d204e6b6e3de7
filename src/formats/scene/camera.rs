//! Converts the camera of a native file.

use super::check::is_near;
use super::error::SceneError;
use super::json::JsonPath;
use super::native::CameraFile;
use glam::{DVec3, Vec3};
use octray_engine::scene::{Camera, MIN_LENGTH, Scene};

/// Least distance to the point that the camera looks at, relative to the camera's distance from the origin.
const LEAST_SIGHT: f64 = 0.5;

/// Converts the camera of a file. Missing keys are those of `own`, or else frame the scene.
pub fn camera(
    place: &JsonPath,
    file: &CameraFile,
    scene: &Scene,
    own: Option<Camera>,
) -> Result<Camera, SceneError> {
    let point = |key: &'static str, v: Option<[f64; 3]>| {
        let point = v.map(|v| place.key(key).point(v, &scene.coordinates)).transpose()?;
        Ok(point.map(|point| point.as_vec3()))
    };
    let position = point("position", file.position)?;
    let sight = file.look_at.map(|look_at| scene.coordinates.to_scene(look_at.into()));
    let look_at = match (position, file.look_at.zip(sight)) {
        // A view keeps its point, unless single precision does not hold it.
        (Some(position), Some((look_at, sight))) if own.is_none() || !is_near(sight) => {
            place.key("look_at").vec3(look_at)?;
            Some(on_sight(position, sight, scene))
        }
        _ => point("look_at", file.look_at)?,
    };
    let mut camera = own.unwrap_or_else(|| scene.framing(position, look_at));
    (camera.position, camera.look_at) =
        (position.unwrap_or(camera.position), look_at.unwrap_or(camera.look_at));
    if let Some(up) = file.up {
        camera.up = place.key("up").vec3(up)?;
    }
    if let Some(degrees) = file.vertical_fov {
        camera.vertical_fov = place.key("vertical_fov").number(degrees)?;
    }
    match camera.fault() {
        Some((key, what, mend)) => Err(place.key(key).error(what, mend)),
        None => Ok(camera),
    }
}

/// Returns the point that a camera looks at, or another point of the line of sight if this one is far beyond
/// the scene, or so near that rounding would turn the line. The other point is at a few distances of the
/// scene's primitives, and is the same for all such points of a line.
fn on_sight(position: Vec3, look_at: DVec3, scene: &Scene) -> Vec3 {
    let (from, (lower, upper)) = (position.as_dvec3(), scene.bounds());
    let (sight, from_origin) = (look_at - from, from.length());
    let reach = (from - lower).abs().max((upper - from).abs()).length();
    if (from_origin * LEAST_SIGHT..=2.0 * reach).contains(&sight.length()) || sight.length() < MIN_LENGTH {
        return look_at.as_vec3();
    }
    let farthest = scene.all_primitives().map(|one| one.shape().distance(from)).fold(from_origin, f64::max);
    (from + sight.normalize() * if farthest > 0.0 { 3.0 * farthest } else { reach }).as_vec3()
}
