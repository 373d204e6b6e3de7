//! Numbers as a scene may hold them.
//!
//! For: the bounds and the checks that every format shares. May import: `place`. Must never know: a file format.

use super::place::{Place, Source};
use super::{MIN_LENGTH, SceneError};
use glam::{DVec3, Vec2, Vec3};

/// Largest absolute value of any number in a scene. Squared distances (3 · (2 · 1e18)² ≈ 1e37) and cross products of two
/// edges stay below f32's 3.4e38; one power of ten more would not.
pub const MAX_NUMBER: f64 = 1e18;

pub const WITHIN_BOUNDS: &str =
    "write a number from -1e18 to 1e18; beyond that, squares overflow single precision";

/// `Some` when the number can stand in a scene.
pub fn fits(x: f64) -> bool {
    x.abs() <= MAX_NUMBER
}

pub fn number(source: &Source, place: &Place, x: f64) -> Result<f32, SceneError> {
    if fits(x) {
        Ok(x as f32)
    } else {
        Err(source.error(place, format!("{x:e} is too large"), WITHIN_BOUNDS))
    }
}

pub fn vec3(source: &Source, place: &Place, v: [f64; 3]) -> Result<Vec3, SceneError> {
    for (i, x) in v.into_iter().enumerate() {
        number(source, &place.item(i), x)?;
    }
    Ok(DVec3::from(v).as_vec3())
}

pub fn vec2(source: &Source, place: &Place, v: [f64; 2]) -> Result<Vec2, SceneError> {
    Ok(Vec2::new(number(source, &place.item(0), v[0])?, number(source, &place.item(1), v[1])?))
}

/// A number of at least 0.
pub fn not_negative(source: &Source, place: &Place, x: f64) -> Result<f32, SceneError> {
    if x < 0.0 {
        return Err(source.error(place, format!("{x} is negative"), "write a number of 0 or more"));
    }
    number(source, place, x)
}

/// A number from 0 to 1.
pub fn fraction(source: &Source, place: &Place, x: f64) -> Result<f32, SceneError> {
    if !(0.0..=1.0).contains(&x) {
        let what = format!("{x} is outside 0 to 1");
        return Err(source.error(place, what, "write a number from 0 to 1"));
    }
    Ok(x as f32)
}

/// The share of light that a surface returns.
pub fn reflectance(source: &Source, place: &Place, color: [f64; 3]) -> Result<Vec3, SceneError> {
    for (i, x) in color.into_iter().enumerate() {
        if !(0.0..=1.0).contains(&x) {
            let what = format!("the colour channel {x} is outside 0 to 1");
            let mend = "a surface cannot return more light than it gets: write a number from 0 to 1; \
                        to make it shine use `emission`";
            return Err(source.error(&place.item(i), what, mend));
        }
    }
    Ok(DVec3::from(color).as_vec3())
}

/// Light given off: no channel below 0.
pub fn radiance(source: &Source, place: &Place, color: [f64; 3]) -> Result<Vec3, SceneError> {
    for (i, x) in color.into_iter().enumerate() {
        not_negative(source, &place.item(i), x)?;
    }
    Ok(DVec3::from(color).as_vec3())
}

pub fn radius(source: &Source, place: &Place, x: f64) -> Result<f32, SceneError> {
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

/// The known name nearest to a misspelt one, if any is near.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let limit = (name.chars().count() / 3).max(1);
    known
        .into_iter()
        .map(|known| (distance(&name.to_lowercase(), &known.to_lowercase()), known))
        .filter(|&(distance, _)| distance <= limit)
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, known)| known)
}

/// Levenshtein's distance: the fewest insertions, deletions and replacements between two words.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, a) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, &b) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(a != b);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_finds_one_slip_and_refuses_another_word() {
        assert_eq!(nearest("crome", ["clay", "chrome"]), Some("chrome"));
        assert_eq!(nearest("Clay", ["clay", "chrome"]), Some("clay"));
        assert_eq!(nearest("velvet", ["clay", "chrome"]), None);
    }

    #[test]
    fn distance_equals_hand_counts() {
        assert_eq!(distance("kitten", "sitting"), 3);
        assert_eq!(distance("", "abc"), 3);
        assert_eq!(distance("abc", "abc"), 0);
    }
}
