//! Generates meshes of any size, to measure how cost grows with the number of triangles.
//!
//! `terrain:N` is a height field with lakes, `knot:N` a closed tube tied in a trefoil. N is the approximate
//! number of triangles (a knot has at least 18). The shape does not depend on N, only its tessellation does.

use super::builder::{Attributes, DEFAULT_BOUNCES, DEFAULT_RESOLUTION, SceneBuilder};
use super::embedded::PREFIX;
use super::error::SceneError;
use crate::wording::grouped;
use glam::{DVec3, Vec3};
use octray_engine::math::portable;
use octray_engine::scene::{Camera, Material, MaterialKind, Scene, Sky};
use std::f64::consts::TAU;

const FEWEST: usize = 2;
const MOST: usize = 4_000_000;

/// A function that adds about so many pairs of triangles.
type Add = fn(&mut SceneBuilder, usize) -> (Camera, Sky);

const SHAPES: [(&str, Add); 2] = [("terrain", terrain), ("knot", knot)];

/// Returns the names of shapes, as they follow `builtin:` and precede a number.
pub fn words() -> impl Iterator<Item = &'static str> {
    SHAPES.iter().map(|&(word, _)| word)
}

/// Makes the scene of a shape. Returns `None` if the name is not a shape's, and an error if its number is
/// missing or out of range.
pub fn scene(name: &str) -> Result<Option<Scene>, SceneError> {
    let (word, count) = name.split_once(':').unwrap_or((name, ""));
    let Some(&(word, add)) = SHAPES.iter().find(|(known, _)| *known == word) else { return Ok(None) };
    let range = format!("from {} to {}", grouped(FEWEST), grouped(MOST));
    if count.is_empty() || !count.bytes().all(|byte| byte.is_ascii_digit()) {
        return Err(SceneError::new(format!("`{PREFIX}{name}` does not say how many triangles to make"))
            .mend(format!("give {PREFIX}{word}:N with a whole number N {range}")));
    }
    let triangles = count.parse().ok().filter(|triangles| (FEWEST..=MOST).contains(triangles));
    let triangles = triangles.ok_or_else(|| {
        SceneError::new(format!("`{PREFIX}{name}`: {count} is out of range"))
            .mend(format!("give a whole number {range}"))
    })?;
    let mut builder = SceneBuilder::default();
    let (camera, sky) = add(&mut builder, triangles / 2);
    let name = format!("{PREFIX}{name}");
    builder.finish(name, camera, DEFAULT_RESOLUTION, DEFAULT_BOUNCES, sky).map(Some)
}

/// Returns the whole number nearest to a quotient.
fn rounded_quotient(over: usize, under: usize) -> usize {
    (over + under / 2) / under
}

/// Adds a grid of `columns` × `rows` quads, two triangles each, with vertices at `point` and a material for
/// each triangle.
fn add_grid(
    builder: &mut SceneBuilder,
    [columns, rows]: [usize; 2],
    point: impl Fn(usize, usize) -> Vec3,
    material: impl Fn([Vec3; 3]) -> u32,
) {
    let row = |y: usize| (0..=columns).map(|x| point(x, y)).collect::<Vec<Vec3>>();
    let mut lower = row(0);
    for y in 1..=rows {
        let upper = row(y);
        for (low, high) in lower.windows(2).zip(upper.windows(2)) {
            for corners in [[low[0], high[0], high[1]], [low[0], high[1], low[1]]] {
                // Triangles without area are left out.
                let points = corners.map(Vec3::as_dvec3);
                let _ = builder.add_triangle(points, material(corners), Attributes::default());
            }
        }
        lower = upper;
    }
}

fn camera(position: [f32; 3], look_at: [f32; 3]) -> Camera {
    Camera::pinhole(position.into(), look_at.into(), Vec3::Y, 38.0)
}

/// Scene units along x and z.
const TERRAIN_SIDE: f64 = 10.0;
/// Height of the lakes' surface.
const WATER: f64 = 0.42;

fn terrain(builder: &mut SceneBuilder, cells: usize) -> (Camera, Sky) {
    let mut add = |name: &str, kind, color: [f32; 3]| {
        builder.add_material(Material::new(name, kind, Vec3::from(color)), 1.0)
    };
    let grass = add("grass", MaterialKind::Diffuse, [0.19, 0.25, 0.08]);
    let rock = add("rock", MaterialKind::Diffuse, [0.34, 0.29, 0.25]);
    let snow = add("snow", MaterialKind::Diffuse, [0.88, 0.9, 0.93]);
    let water = add("water", MaterialKind::Metal { roughness: 0.12 }, [0.32, 0.45, 0.52]);
    let columns = ((cells as f64).sqrt().round() as usize).max(1);
    let rows = rounded_quotient(cells, columns).max(1);
    let at = |i: usize, count: usize| (i as f64 / count as f64 - 0.5) * TERRAIN_SIDE;
    let point = |x: usize, y: usize| {
        let (x, z) = (at(x, columns), at(y, rows));
        DVec3::new(x, height(x, z).max(WATER), z).as_vec3()
    };
    add_grid(builder, [columns, rows], point, |[a, b, c]| {
        let upwards = (b - a).cross(c - a).normalize_or(Vec3::Y).y;
        let top = a.y.max(b.y).max(c.y);
        match () {
            () if f64::from(top) <= WATER => water,
            () if top + 0.6 * upwards > 1.75 => snow,
            () if upwards > 0.75 && top < 1.2 => grass,
            () => rock,
        }
    });
    let sky = Sky::Gradient { bottom: Vec3::new(1.15, 0.95, 0.8), top: Vec3::new(0.35, 0.6, 1.1) };
    (camera([2.6, 2.6, 5.4], [0.3, 0.6, 0.0]), sky)
}

/// Returns the height of the ground in scene units: a ridged multifractal of sums and products alone, so that
/// every machine gives the same bits.
///
/// Source: Musgrave, in Ebert et al., Texturing and Modeling, 3ed ch. 16.
fn height(x: f64, z: f64) -> f64 {
    let (mut sum, mut weight, mut scale) = (0.0, 1.0, 0.22);
    for octave in 0..11 {
        let ridge = 1.0 - noise(x * scale, z * scale, octave).abs();
        let signal = ridge * ridge * weight;
        sum += signal * portable::powi(0.55, octave);
        // Low signals damp the next octave, so that valleys stay smooth.
        weight = (1.6 * signal).min(1.0);
        scale *= 2.03;
    }
    1.35 * sum - 0.75
}

/// Returns value noise in [−1, 1]: random numbers at whole coordinates, interpolated by a polynomial with two
/// continuous derivatives.
fn noise(x: f64, z: f64, octave: u32) -> f64 {
    let (left, near) = (x.floor(), z.floor());
    let smooth = |t: f64| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let (u, v) = (smooth(x - left), smooth(z - near));
    let value = |dx: i64, dz: i64| {
        let hash = mix((left as i64 + dx) as u32 ^ mix((near as i64 + dz) as u32 ^ mix(octave + 1)));
        f64::from(hash) / f64::from(u32::MAX) * 2.0 - 1.0
    };
    let blend = |a: f64, b: f64, t: f64| a + (b - a) * t;
    blend(blend(value(0, 0), value(1, 0), u), blend(value(0, 1), value(1, 1), u), v)
}

/// Hashes an integer, independently of the renderer's sampling hash. Source: C. Wellons, "Prospecting for
/// hash functions", 2018.
fn mix(mut x: u32) -> u32 {
    x = (x ^ (x >> 15)).wrapping_mul(0x2c1b_3c6d);
    x = (x ^ (x >> 12)).wrapping_mul(0x297a_2d39);
    x ^ (x >> 15)
}

/// Windings of the trefoil around a torus's axis, and around the torus's ring.
const WINDINGS: [f64; 2] = [2.0, 3.0];
/// Radii of the ring, of the torus around it, and of the tube; scene units.
const RING: f64 = 1.0;
const TORUS: f64 = 0.45;
const TUBE: f64 = 0.28;

fn knot(builder: &mut SceneBuilder, cells: usize) -> (Camera, Sky) {
    let copper = MaterialKind::Metal { roughness: 0.35 };
    let copper = builder.add_material(Material::new("copper", copper, Vec3::new(0.9, 0.45, 0.24)), 1.0);
    let [around_axis, around_ring] = WINDINGS;
    // Makes quads about square.
    let length = TAU * portable::hypot(around_axis * RING, around_ring * TORUS);
    let around = ((cells as f64 * TAU * TUBE / length).sqrt().round() as usize).max(3);
    let along = rounded_quotient(cells, around).max(3);
    let point = |x: usize, y: usize| {
        // The grid's last vertices are its first, bit for bit: the surface is closed.
        let turn = |i: usize, count: usize| (i % count) as f64 / count as f64 * TAU;
        on_tube(turn(x, along), turn(y, around)).as_vec3()
    };
    add_grid(builder, [along, around], point, |_| copper);
    let sky = Sky::Gradient { bottom: Vec3::new(0.05, 0.06, 0.09), top: Vec3::new(1.2, 1.25, 1.35) };
    (camera([1.2, 3.9, 3.0], [0.0, 0.0, 0.05]), sky)
}

/// Returns the point at an angle `s` along the knot and `t` around the tube, along which ribs wind.
fn on_tube(s: f64, t: f64) -> DVec3 {
    let [around_axis, around_ring] = WINDINGS;
    let ((sin_axis, cos_axis), (sin_ring, cos_ring)) =
        (portable::sin_cos(around_axis * s), portable::sin_cos(around_ring * s));
    let outwards = DVec3::new(cos_axis, 0.0, sin_axis);
    let forwards = DVec3::new(-sin_axis, 0.0, cos_axis);
    let radius = RING + TORUS * cos_ring;
    let center = outwards * radius + DVec3::Y * (TORUS * sin_ring);
    let tangent = forwards * (around_axis * radius)
        + (DVec3::Y * cos_ring - outwards * sin_ring) * (around_ring * TORUS);
    // The torus's normal is perpendicular to every curve on it, and is periodic along the knot.
    let normal = outwards * cos_ring + DVec3::Y * sin_ring;
    let binormal = tangent.normalize().cross(normal);
    let ribs = 1.0 + 0.07 * portable::sin_cos(5.0 * t + 24.0 * s).0;
    let (sin, cos) = portable::sin_cos(t);
    center + (normal * cos + binormal * sin) * (TUBE * ribs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    fn make(name: &str) -> Scene {
        scene(name).unwrap().unwrap()
    }

    #[test]
    fn shapes_have_about_as_many_triangles_as_asked_for() {
        for kind in ["terrain", "knot"] {
            for count in [18, 1_000, 54_321, 200_000] {
                let made = make(&format!("{kind}:{count}")).triangles.len();
                // Half a row of squares.
                let most = ((count / 2) as f64).sqrt().ceil() as usize;
                assert!(made.abs_diff(count) <= most, "{kind}:{count} has {made}");
            }
        }
        assert_eq!(make("terrain:2").triangles.len(), 2);
        assert_eq!(make("terrain:3").triangles.len(), 2);
        assert_eq!(make("knot:2").triangles.len(), 18);
    }

    #[test]
    fn knot_is_closed_and_its_triangles_face_outwards() {
        for count in [18, 5_000] {
            let scene = make(&format!("knot:{count}"));
            let mut edges: HashMap<[[u32; 3]; 2], i32> = HashMap::new();
            let bits = |v: Vec3| v.to_array().map(f32::to_bits);
            let mut volume = 0.0;
            for triangle in &scene.triangles {
                let [a, b, c] = triangle.vertices;
                volume += a.as_dvec3().dot(b.as_dvec3().cross(c.as_dvec3())) / 6.0;
                for [from, to] in [[a, b], [b, c], [c, a]] {
                    *edges.entry([bits(from), bits(to)]).or_default() += 1;
                    *edges.entry([bits(to), bits(from)]).or_default() -= 1;
                }
            }
            assert!(edges.values().all(|&surplus| surplus == 0), "knot:{count} has a gap");
            // The coarsest tessellation has steps so long that it winds the other way.
            assert!(count == 18 || volume > 0.0, "knot:{count} is inside out: {volume}");
        }
    }
}
