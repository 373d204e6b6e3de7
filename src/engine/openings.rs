//! Finds the openings through which the sky lights a room, where scattered rays find them rarely: a portal
//! there takes noise away.
//!
//! Rays leave what the camera sees, and what those rays hit. In a room, few of them reach the sky, and all of
//! those cross small parts of the faces of the box around the room. Rooms whose walls are not parallel to the
//! axes are not recognised.

use crate::camera::PreparedCamera;
use crate::lights::EnvironmentLight;
use crate::math::{MISS, portable};
use crate::rays::{Hits, Rays, Structure, Tracer};
use crate::scene::{Primitive, Scene, Sky};
use glam::{DVec3, Vec3};

/// The primary rays along the width and the height of the picture.
const PRIMARY: [usize; 2] = [16, 12];
/// The number of rays from each point.
const SCATTERED: usize = 24;
/// Points that see the sky in a larger share of their rays are taken as outside.
const OUTSIDE: f64 = 0.25;
/// The largest share of rays in a room that reach the sky, and of the room's surface that is open.
const LARGEST: f64 = 0.1;
/// The least number of rays through an opening.
const LEAST: usize = 24;

/// A point of a surface, and the rays from there that miss everything.
struct Seen {
    point: Vec3,
    sky: Vec<Vec3>,
}

/// Returns the clause that advises portals, with their corners in the coordinates of the file; `None` unless
/// the camera is in a room that the sky lights through small openings, and brighter than its emitters do.
pub fn advice(scene: &Scene, structure: &Structure) -> Option<String> {
    if scene.sky.is_black() || !scene.portals.is_empty() {
        return None;
    }
    let camera = PreparedCamera::new(&scene.camera, scene.resolution);
    let [across, down] = PRIMARY;
    let [width, height] = scene.resolution.map(|side| side as f32);
    let primary: Vec<(Vec3, Vec3)> = (0..across * down)
        .map(|at| {
            let x = ((at % across) as f32 + 0.5) * width / across as f32;
            let y = ((at / across) as f32 + 0.5) * height / down as f32;
            let ray = camera.rays::<f32>(x, y);
            (ray.origin.get(0), ray.direction.get(0))
        })
        .collect();
    let found = trace(structure, &primary).into_iter().zip(&primary);
    let first: Vec<_> = found.filter_map(|(hit, ray)| surface(scene, hit, ray)).collect();
    let mut light = [0.0; 2];
    let (mut seen, hits) = scatter(scene, structure, &first, &mut light);
    // As many points again, in all parts of the room.
    let step = (hits.len() / (across * down)).max(1);
    let second: Vec<_> = hits.into_iter().step_by(step).collect();
    seen.extend(scatter(scene, structure, &second, &mut light).0);
    let points = seen.len();
    seen.retain(|seen| seen.sky.len() as f64 <= OUTSIDE * SCATTERED as f64);
    let reached: usize = seen.iter().map(|seen| seen.sky.len()).sum();
    let share = reached as f64 / (seen.len() * SCATTERED) as f64;
    // Three points in four are in the room.
    if light[0] < light[1] || 4 * seen.len() < 3 * points || reached < LEAST || share > LARGEST {
        return None;
    }
    let openings: Vec<String> =
        openings(scene, &seen)?.iter().map(|corners| portal_text(scene, corners)).collect();
    let percent = (100.0 * share).ceil();
    Some(format!(
        "only {percent} % of the rays in the room find the opening through which the sky lights it: add \"portals\": [{}] to \
         the scene",
        openings.join(", ")
    ))
}

/// Traces rays; returns the distance and the primitive of each hit.
fn trace(structure: &Structure, rays: &[(Vec3, Vec3)]) -> Vec<(f32, u32)> {
    // Whole packets.
    let count = rays.len().next_multiple_of(16);
    let columns: [Vec<f32>; 6] = std::array::from_fn(|column| {
        let of = |(origin, direction): &(Vec3, Vec3)| [origin, direction][column / 3][column % 3];
        rays.iter().chain(std::iter::repeat(&rays[0])).take(count).map(of).collect()
    });
    let [x, y, z, dx, dy, dz] = &columns;
    let (mut t, mut primitive) = (vec![f32::INFINITY; count], vec![MISS; count]);
    let (mut u, mut v) = (vec![0.0; count], vec![0.0; count]);
    let mut hits = Hits { t: &mut t, primitive: &mut primitive, u: &mut u, v: &mut v };
    Tracer::new().closest_in_scene(structure, &Rays::new([x, y, z], [dx, dy, dz]), &mut hits);
    t.into_iter().zip(primitive).take(rays.len()).collect()
}

/// Returns a hit's point, just above the surface, and the normal there.
fn surface(scene: &Scene, (t, primitive): (f32, u32), ray: &(Vec3, Vec3)) -> Option<(Vec3, Vec3)> {
    let point = ray.0 + ray.1 * t;
    let n = match (primitive != MISS).then(|| scene.primitive(primitive as usize))? {
        Primitive::Sphere(sphere) => point - sphere.center,
        Primitive::Triangle(triangle) => {
            let [a, b, c] = triangle.vertices;
            (b - a).cross(c - a)
        }
    };
    let n = n.normalize_or_zero() * -n.dot(ray.1).signum();
    Some((point + n * (1e-4 * t), n))
}

/// Traces rays from points with normals, distributed by their cosines. Returns the directions in which each
/// point sees the sky, and the surfaces of all hits; adds the light of the sky and that of emitters.
fn scatter(
    scene: &Scene,
    structure: &Structure,
    from: &[(Vec3, Vec3)],
    light: &mut [f32; 2],
) -> (Vec<Seen>, Vec<(Vec3, Vec3)>) {
    let direction = |number: usize, n: Vec3| {
        // The numbers of the plastic constant are evenly spread.
        let [z, turns] = [0.754_877_666, 0.569_840_291].map(|step| (number as f64 * step).fract());
        let (sin, cos) = portable::sin_cos(turns * std::f64::consts::TAU);
        let z = 1.0 - 2.0 * z;
        let radius = (1.0 - z * z).sqrt();
        (n + DVec3::new(radius * cos, radius * sin, z).as_vec3()).normalize_or(n)
    };
    let numbered = from.iter().flat_map(|&(point, n)| std::iter::repeat_n((point, n), SCATTERED)).enumerate();
    let rays: Vec<_> = numbered.map(|(number, (point, n))| (point, direction(number, n))).collect();
    if rays.is_empty() {
        return Default::default();
    }
    let texture = EnvironmentLight::of(scene).map_or(0.0, |sky| 3.0 * sky.mean as f32);
    let radiance = |direction: Vec3| match scene.sky {
        Sky::Color(color) => color.element_sum(),
        Sky::Gradient { bottom, top } => bottom.lerp(top, 0.5 + 0.5 * direction.y).element_sum(),
        Sky::Texture { .. } => texture,
    };
    let (mut seen, mut hits) = (Vec::new(), Vec::new());
    for (number, (hit, ray)) in trace(structure, &rays).into_iter().zip(&rays).enumerate() {
        if number % SCATTERED == 0 {
            seen.push(Seen { point: ray.0, sky: Vec::new() });
        }
        if hit.1 == MISS {
            light[0] += radiance(ray.1);
            seen.last_mut().expect("the first ray of a point adds it").sky.push(ray.1);
        } else {
            let material = scene.primitive(hit.1 as usize).material();
            light[1] += scene.materials[material as usize].emission.element_sum();
        }
        hits.extend(surface(scene, hit, ray));
    }
    (seen, hits)
}

/// Returns the rectangles through which rays leave the box around the points; `None` if they are large.
fn openings(scene: &Scene, seen: &[Seen]) -> Option<Vec<[Vec3; 4]>> {
    let lower = seen.iter().map(|seen| seen.point).reduce(Vec3::min)?;
    let upper = seen.iter().map(|seen| seen.point).reduce(Vec3::max)?;
    let mut crossings = vec![Vec::new(); 6];
    for (origin, direction) in seen.iter().flat_map(|seen| seen.sky.iter().map(|&sky| (seen.point, sky))) {
        let ends = Vec3::select(direction.cmpgt(Vec3::ZERO), upper, lower);
        let t = ((ends - origin) / direction).map(|t| if t.is_nan() { f32::INFINITY } else { t.max(0.0) });
        let axis = t.min_position();
        crossings[2 * axis + usize::from(direction[axis] > 0.0)].push(origin + direction * t[axis]);
    }
    let all: usize = crossings.iter().map(Vec::len).sum();
    let size = upper - lower;
    let surface = 2.0 * size.dot(Vec3::new(size.y, size.z, size.x));
    let (mut area, mut openings) = (0.0, Vec::new());
    // Openings with few rays are left out.
    for (face, points) in crossings.iter().enumerate().filter(|(_, points)| 10 * points.len() > all) {
        let (axis, count) = (face / 2, points.len());
        let [right, up] = [(axis + 1) % 3, (axis + 2) % 3];
        let height = if face % 2 == 1 { upper[axis] } else { lower[axis] };
        let ends = [right, up].map(|along| {
            let mut places: Vec<f32> = points.iter().map(|point| point[along]).collect();
            places.sort_by(f32::total_cmp);
            let (first, last) = (places[count / 200], places[count - 1 - count / 200]);
            // The outermost rays are as far from the edges as rays are from each other.
            let gap = 2.0 * (last - first) / count as f32;
            [first - gap, last + gap]
        });
        let widths = ends.map(|[first, last]| last - first);
        area += widths[0] * widths[1];
        // Edges are those of the wall, if it has vertices there.
        let snapped = |at: f32, along: usize, margin: f32| {
            let vertices = scene.triangles.iter().flat_map(|triangle| triangle.vertices);
            let near =
                vertices.filter(|vertex| (vertex[axis] - height).abs() < 0.1 * widths[0].min(widths[1]));
            let places = near.map(|vertex| vertex[along]).filter(|place| (place - at).abs() < margin);
            places.min_by(|a, b| (a - at).abs().total_cmp(&(b - at).abs())).unwrap_or(at)
        };
        let height = snapped(height, axis, 0.05 * widths[0].min(widths[1]));
        let [x, y] = [(ends[0], right, widths[0]), (ends[1], up, widths[1])]
            .map(|(ends, along, width)| ends.map(|end| snapped(end, along, 0.1 * width)));
        let mut corners = [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]].map(|[x, y]| {
            let mut corner = Vec3::splat(height);
            (corner[right], corner[up]) = (x, y);
            corner
        });
        if face % 2 == 1 {
            corners.reverse();
        }
        openings.push(corners);
    }
    (area < LARGEST as f32 * surface && !openings.is_empty()).then_some(openings)
}

/// Writes a portal with four digits of its size.
fn portal_text(scene: &Scene, corners: &[Vec3; 4]) -> String {
    let to_file = |corner: Vec3| scene.coordinates.to_file(corner.as_dvec3());
    let size = to_file(corners[0]).distance(to_file(corners[2]));
    let tenths = std::iter::successors(Some(1000.0), |unit| Some(unit / 10.0));
    let digits = tenths.take(300).take_while(|&unit| unit > size).count();
    let number = |x: f64| format!("{x:.digits$}").parse::<f64>().unwrap_or(x) + 0.0;
    let point = |corner: &Vec3| format!("{:?}", to_file(*corner).to_array().map(number));
    format!("{{ \"vertices\": [{}] }}", corners.each_ref().map(point).join(", "))
}
