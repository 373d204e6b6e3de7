//! Checks numbers against the bounds that every format shares.

use super::error::SceneError;
use super::json::JsonPath;
use super::write::point_in_file;
use glam::{DVec3, Vec2, Vec3};
use octray_engine::scene::{
    Camera, Coordinates, MAX_BOUNCES, MAX_COORDINATE, MAX_SIDE, MIN_LENGTH, Primitive, Projection, Scene,
};

/// Largest absolute value of any number in a scene. Squared distances (3 · (2 · 1e18)² ≈ 1e37) and cross
/// products of two edges stay below f32's maximum, 3.4e38; at 1e19 they would not.
pub const MAX_NUMBER: f64 = 1e18;

pub const WITHIN_BOUNDS: &str =
    "write a number from -1e18 to 1e18; beyond that, squares overflow single precision";

/// Largest offset of rays that leave a primitive, relative to the distance from the camera to `look_at`. At
/// half this offset, pictures of balls on a floor change by less than 1 %.
const MOST_OFFSET: f64 = 1.0 / 32.0;
/// Coarsest rounding of coordinates at `look_at`, relative to its distance from the camera.
const MOST_ROUNDING: f64 = 1e-4;
/// Distance of surfaces from `look_at` from which on their offset is ignored, relative to that of the camera.
const IN_VIEW: f64 = 8.0;

/// Tests whether a scene may hold the number. False for NaN.
pub fn is_within_bounds(x: f64) -> bool {
    x.abs() <= MAX_NUMBER
}

/// Tests whether single precision holds a point of a scene. False for NaN.
pub fn is_near(point: DVec3) -> bool {
    point.to_array().into_iter().all(|x| x.abs() <= MAX_COORDINATE)
}

/// Returns the remedy for a point that is not [near](is_near).
pub fn bring_near(Coordinates { origin, unit }: &Coordinates) -> String {
    let most = MAX_COORDINATE * unit;
    format!("single precision holds this scene up to {most:.1e} around {origin}: move it, or make it smaller")
}

/// Tests whether a triangle, its vertices already rounded to f32, has an area that f32 can express.
pub fn has_area(vertices: &[Vec3; 3]) -> bool {
    let [a, b, c] = vertices.map(Vec3::as_dvec3);
    let doubled = (b - a).cross(c - a).length() as f32;
    doubled.is_normal()
}

/// Returns a warning about the first of these cameras that looks where coordinates are rounded coarsely, or
/// else about primitives in view that are so large that the offset of rays from them shows in the picture.
pub fn warn_of_size(scene: &Scene, cameras: &[Camera]) -> Option<String> {
    let view = |camera: &Camera| match camera.projection {
        Projection::Perspective(_) => f64::from(camera.position.distance(camera.look_at)),
        Projection::Orthographic { height } => f64::from(height),
    };
    let rounding = |camera: &Camera| f64::from(camera.look_at.abs().max_element() * f32::EPSILON);
    if let Some(far) = cameras.iter().find(|camera| rounding(camera) > view(camera) * MOST_ROUNDING) {
        let look_at = point_in_file(far.look_at, &scene.coordinates);
        return Some(format!(
            "The camera's `look_at`, {look_at}, is so far from the scene's origin, {}, that coordinates are rounded to \
             {:.1e} there: write a point near it as `origin` into the scene's file.",
            scene.coordinates.origin,
            rounding(far) * scene.coordinates.unit
        ));
    }
    // Number of the primitive, and its offset relative to the distance from the camera to `look_at`.
    let too_large = |(number, primitive): (usize, Primitive)| {
        let offset = f64::from(primitive.shape().offset());
        let is_near =
            |camera: &&Camera| primitive.shape().distance(camera.look_at.into()) < IN_VIEW * view(camera);
        let mut seen = cameras.iter().filter(|camera| offset > view(camera) * MOST_OFFSET);
        Some((number, offset / view(seen.find(is_near)?)))
    };
    let mut found = scene.all_primitives().enumerate().filter_map(too_large);
    let (number, offset) = found.next()?;
    let (list, index) = scene.place(number);
    let more = found.count();
    let more = if more > 0 { format!(" (as are {more} more)") } else { String::new() };
    Some(format!(
        "{list}[{index}]{more} is too large for single precision here: shadows and reflections near it will be wrong. \
         Make it at least {:.0} times smaller.",
        (offset / MOST_OFFSET).ceil()
    ))
}

/// Checks of the value of a file at this place, which return it as a scene holds it.
impl JsonPath<'_> {
    /// Checks every item of an array.
    pub fn each<T: Copy, U: Copy + Default, const N: usize>(
        &self,
        items: [T; N],
        read: impl Fn(&JsonPath, T) -> Result<U, SceneError>,
    ) -> Result<[U; N], SceneError> {
        let mut found = [U::default(); N];
        for (index, item) in items.into_iter().enumerate() {
            found[index] = read(&self.item(index), item)?;
        }
        Ok(found)
    }

    pub fn number(&self, x: f64) -> Result<f32, SceneError> {
        if is_within_bounds(x) {
            Ok(x as f32)
        } else {
            Err(self.error(format!("{x:e} is too large"), WITHIN_BOUNDS))
        }
    }

    pub fn vec2(&self, v: [f64; 2]) -> Result<Vec2, SceneError> {
        self.each(v, |place, x| place.number(x)).map(Vec2::from)
    }

    pub fn vec3(&self, v: [f64; 3]) -> Result<Vec3, SceneError> {
        self.each(v, |place, x| place.number(x)).map(Vec3::from)
    }

    /// Converts a point of the file to the scene's coordinates, unrounded.
    pub fn point(&self, point: [f64; 3], coordinates: &Coordinates) -> Result<DVec3, SceneError> {
        self.vec3(point)?;
        let placed = coordinates.to_scene(DVec3::from(point));
        if is_near(placed) {
            Ok(placed)
        } else {
            Err(self.error(format!("{point:?} is too far away"), bring_near(coordinates)))
        }
    }

    /// Converts degrees to a fraction of a whole turn in [0, 1); 0 if missing.
    pub fn turns(&self, degrees: Option<f64>) -> Result<f32, SceneError> {
        let degrees = degrees.unwrap_or(0.0);
        self.number(degrees)?;
        // A fraction that rounds up to 1.0 becomes 0.
        Ok(Some((degrees / 360.0).rem_euclid(1.0) as f32).filter(|&turns| turns < 1.0).unwrap_or(0.0))
    }

    /// Checks a number of at least 0.
    pub fn not_negative(&self, x: f64) -> Result<f32, SceneError> {
        if x < 0.0 {
            return Err(self.error(format!("{x} is negative"), "write a number of 0 or more"));
        }
        self.number(x)
    }

    /// Checks a number from 0 to 1.
    pub fn fraction(&self, x: f64) -> Result<f32, SceneError> {
        if !(0.0..=1.0).contains(&x) {
            return Err(self.error(format!("{x} is outside 0 to 1"), "write a number from 0 to 1"));
        }
        Ok(x as f32)
    }

    /// Checks a reflectance, whose channels are from 0 to 1.
    pub fn reflectance(&self, color: [f64; 3]) -> Result<Vec3, SceneError> {
        let channel = |place: &JsonPath, x: f64| {
            place.fraction(x).map_err(|_| {
                let mend = "a surface cannot return more light than it gets: write a number from 0 to 1; \
                            to make it emit light use `emission`";
                place.error(format!("the colour channel {x} is outside 0 to 1"), mend)
            })
        };
        self.each(color, channel).map(Vec3::from)
    }

    /// Checks a radiance, no channel of which is below 0.
    pub fn radiance(&self, color: [f64; 3]) -> Result<Vec3, SceneError> {
        self.each(color, |place, x| place.not_negative(x)).map(Vec3::from)
    }

    /// Converts a radius to the scene's coordinates, unrounded.
    pub fn radius(&self, x: f64, coordinates: &Coordinates) -> Result<f64, SceneError> {
        self.number(x)?;
        let radius = x / coordinates.unit;
        if radius < MIN_LENGTH {
            let least =
                format!("in a scene of this size a radius is at least {:e}", MIN_LENGTH * coordinates.unit);
            let (what, mend) = if x > 0.0 {
                (format!("the radius {x:e} is too small"), least)
            } else if x == 0.0 {
                ("the radius is 0".to_string(), least)
            } else {
                let mend = "for a hollow ball of glass, put a smaller sphere of glass with `ior` 0.667 (1 / 1.5) into it";
                (format!("the radius is {x}"), format!("{least}; {mend}"))
            };
            return Err(self.error(what, mend));
        }
        if radius > MAX_COORDINATE {
            return Err(self.error(format!("the radius {x:e} is too large"), bring_near(coordinates)));
        }
        Ok(radius)
    }

    pub fn resolution(&self, resolution: [u32; 2]) -> Result<[u32; 2], SceneError> {
        for (i, side) in resolution.into_iter().enumerate() {
            if !(1..=MAX_SIDE).contains(&side) {
                let what = format!("a picture cannot be {side} pixels {}", ["wide", "high"][i]);
                return Err(self.item(i).error(what, format!("write a number from 1 to {MAX_SIDE}")));
            }
        }
        Ok(resolution)
    }

    pub fn bounces(&self, bounces: u32) -> Result<u32, SceneError> {
        if bounces > MAX_BOUNCES {
            let mend = format!("write a number from 0 to {MAX_BOUNCES}");
            return Err(self.error(format!("{bounces} bounces are too many"), mend));
        }
        Ok(bounces)
    }
}
