//! Bounds and checks of numbers that every format shares.
//!
//! For: [`number`], [`vec3`], [`radiance`] and the like.

use super::error::SceneError;
use super::json::{JsonPath, Source};
use glam::{DVec3, Vec2, Vec3};
use octray_engine::scene::{MAX_BOUNCES, MAX_SIDE, MIN_LENGTH};

/// Largest absolute value of any number in a scene. Squared distances (3 · (2 · 1e18)² ≈ 1e37) and cross
/// products of two edges stay below f32's maximum, 3.4e38; at 1e19 they would not.
pub const MAX_NUMBER: f64 = 1e18;

pub const WITHIN_BOUNDS: &str =
    "write a number from -1e18 to 1e18; beyond that, squares overflow single precision";

/// Whether a scene may hold the number. False for NaN.
pub fn fits(x: f64) -> bool {
    x.abs() <= MAX_NUMBER
}

pub fn number(source: &Source, place: &JsonPath, x: f64) -> Result<f32, SceneError> {
    if fits(x) {
        Ok(x as f32)
    } else {
        Err(source.error(place, format!("{x:e} is too large"), WITHIN_BOUNDS))
    }
}

pub fn vec3(source: &Source, place: &JsonPath, v: [f64; 3]) -> Result<Vec3, SceneError> {
    for (i, x) in v.into_iter().enumerate() {
        number(source, &place.item(i), x)?;
    }
    Ok(DVec3::from(v).as_vec3())
}

pub fn vec2(source: &Source, place: &JsonPath, v: [f64; 2]) -> Result<Vec2, SceneError> {
    Ok(Vec2::new(number(source, &place.item(0), v[0])?, number(source, &place.item(1), v[1])?))
}

/// Degrees as a fraction of a whole turn, in [0, 1); 0 where missing.
pub fn turns(source: &Source, place: &JsonPath, degrees: Option<f64>) -> Result<f32, SceneError> {
    let degrees = degrees.unwrap_or(0.0);
    number(source, place, degrees)?;
    // A fraction that rounds up to 1.0 becomes 0.
    Ok(Some((degrees / 360.0).rem_euclid(1.0) as f32).filter(|&turns| turns < 1.0).unwrap_or(0.0))
}

/// A number of at least 0.
pub fn not_negative(source: &Source, place: &JsonPath, x: f64) -> Result<f32, SceneError> {
    if x < 0.0 {
        return Err(source.error(place, format!("{x} is negative"), "write a number of 0 or more"));
    }
    number(source, place, x)
}

/// A number from 0 to 1.
pub fn fraction(source: &Source, place: &JsonPath, x: f64) -> Result<f32, SceneError> {
    if !(0.0..=1.0).contains(&x) {
        let what = format!("{x} is outside 0 to 1");
        return Err(source.error(place, what, "write a number from 0 to 1"));
    }
    Ok(x as f32)
}

/// A reflectance: each channel from 0 to 1.
pub fn reflectance(source: &Source, place: &JsonPath, color: [f64; 3]) -> Result<Vec3, SceneError> {
    for (i, x) in color.into_iter().enumerate() {
        if !(0.0..=1.0).contains(&x) {
            let what = format!("the colour channel {x} is outside 0 to 1");
            let mend = "a surface cannot return more light than it gets: write a number from 0 to 1; \
                        to make it emit light use `emission`";
            return Err(source.error(&place.item(i), what, mend));
        }
    }
    Ok(DVec3::from(color).as_vec3())
}

/// A radiance: no channel below 0.
pub fn radiance(source: &Source, place: &JsonPath, color: [f64; 3]) -> Result<Vec3, SceneError> {
    for (i, x) in color.into_iter().enumerate() {
        not_negative(source, &place.item(i), x)?;
    }
    Ok(DVec3::from(color).as_vec3())
}

pub fn radius(source: &Source, place: &JsonPath, x: f64) -> Result<f32, SceneError> {
    if x < MIN_LENGTH {
        let what =
            if x > 0.0 { format!("the radius {x:e} is too small") } else { format!("the radius is {x}") };
        return Err(source.error(place, what, "a radius is at least 1e-18"));
    }
    number(source, place, x)
}

/// Whether the triangle, its vertices already rounded to f32, has an area that f32 can express.
pub fn has_area(vertices: &[Vec3; 3]) -> bool {
    let [a, b, c] = vertices.map(Vec3::as_dvec3);
    let doubled = (b - a).cross(c - a).length() as f32;
    doubled.is_normal()
}

pub fn check_resolution(source: &Source, place: &JsonPath, resolution: [u32; 2]) -> Result<(), SceneError> {
    for (i, side) in resolution.into_iter().enumerate() {
        if !(1..=MAX_SIDE).contains(&side) {
            let what = format!("a picture cannot be {side} pixels {}", ["wide", "high"][i]);
            return Err(source.error(&place.item(i), what, format!("write a number from 1 to {MAX_SIDE}")));
        }
    }
    Ok(())
}

pub fn check_bounces(source: &Source, place: &JsonPath, bounces: u32) -> Result<(), SceneError> {
    if bounces > MAX_BOUNCES {
        let mend = format!("write a number from 0 to {MAX_BOUNCES}");
        return Err(source.error(place, format!("{bounces} bounces are too many"), mend));
    }
    Ok(())
}
