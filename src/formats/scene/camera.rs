//! Converts the camera of a native file.

use super::check::is_near;
use super::error::SceneError;
use super::json::JsonPath;
use super::native::CameraFile;
use glam::{DVec3, Vec3};
use octray_engine::scene::{Camera, Lens, MIN_LENGTH, Projection, Scene, VERTICAL_FOV};

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
    camera.projection = projection(place, file, &camera, scene)?;
    if let Projection::Orthographic { .. } = camera.projection {
        camera.vertical_fov = VERTICAL_FOV;
    }
    match camera.fault() {
        Some((key, what, mend)) => Err(place.key(key).error(what, mend)),
        None => Ok(camera),
    }
}

/// Returns the points from which rays start. Keys of a lens make an orthographic camera perspective, and keep
/// what they do not say of an earlier lens.
fn projection(
    place: &JsonPath,
    file: &CameraFile,
    camera: &Camera,
    scene: &Scene,
) -> Result<Projection, SceneError> {
    let CameraFile { aperture_radius, f_number, focus_distance, focus_on, blades, .. } = *file;
    let unit = scene.coordinates.unit;
    let length = |key: &'static str, x: f64| Ok((f64::from(place.key(key).number(x)?) / unit) as f32);
    let of_lens = [
        ("aperture_radius", aperture_radius.is_some()),
        ("f_number", f_number.is_some()),
        ("focus_distance", focus_distance.is_some()),
        ("focus_on", focus_on.is_some()),
        ("blades", blades.is_some()),
    ];
    let given = of_lens.iter().find(|(_, is_given)| *is_given).map(|&(key, _)| key);
    if let Some(height) = file.orthographic_height {
        if let Some(key) = given.or(file.vertical_fov.map(|_| "vertical_fov")) {
            let what = format!("an orthographic camera has no `{key}`");
            return Err(place.key(key).error(what, "leave it out, or `orthographic_height`"));
        }
        return Ok(Projection::Orthographic { height: length("orthographic_height", height)? });
    }
    for pair in [["aperture_radius", "f_number"], ["focus_distance", "focus_on"]] {
        if pair.iter().all(|key| of_lens.contains(&(key, true))) {
            let what = format!("`{}` and `{}` say the same in two ways", pair[0], pair[1]);
            return Err(place.key(pair[1]).error(what, "leave out one of them"));
        }
    }
    let (Some(key), perspective) = (given, Camera { projection: Projection::default(), ..*camera }) else {
        let is_perspective = file.vertical_fov.is_some();
        return Ok(if is_perspective { Projection::Perspective(camera.lens()) } else { camera.projection });
    };
    let mut lens = camera.lens();
    if let Some(radius) = aperture_radius {
        lens.radius = length("aperture_radius", radius)?;
    } else if let Some(number) = f_number {
        if place.key("f_number").number(number)? <= 0.0 {
            let mend = "write a number above 0, such as 2.8; the larger, the more is in focus";
            return Err(place
                .key("f_number")
                .error(format!("an aperture of f/{number} is impossible"), mend));
        }
        lens.radius = (perspective.f_number_or_radius(number) / unit) as f32;
    } else if lens == Lens::default() {
        let what = format!("`{key}` has no effect: all is in focus without an aperture");
        return Err(place.key(key).error(what, "add `aperture_radius`, or an `f_number` such as 2.8"));
    }
    if let Some(distance) = focus_distance {
        lens.focus = Some(length("focus_distance", distance)?);
    } else if let Some(point) = focus_on {
        let from = place.key("focus_on").point(point, &scene.coordinates)? - camera.position.as_dvec3();
        let along = from.dot((camera.look_at.as_dvec3() - camera.position.as_dvec3()).normalize_or_zero());
        if along < MIN_LENGTH {
            let what = "the point is not in front of the camera";
            return Err(place.key("focus_on").error(what, "write a point that the camera sees"));
        }
        lens.focus = Some(along as f32);
    }
    lens.blades = blades.unwrap_or(lens.blades);
    Ok(Projection::Perspective(lens))
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
