//! Rays as renderers meet them, in prepared arrays: from the camera, and from what those hit.
//!
//! For: [`RaySet`], [`Answers`], and both together, [`Prepared`]. May import: everything above it. Must never know: clocks, files.
//!
//! Three kinds ([`Kind`]). Primary rays go through the pixels' middles. From each of their hits one shadow ray and one diffuse ray
//! leave on the side from which the primary ray came, cosine-weighted around the normal, from a point that stands off the surface by
//! the house's error bound ([`crate::kernel::surface`]). Their random numbers are a function of seed and pixel alone.

use crate::camera::{Pinhole, Tile};
use crate::kernel::surface::{sphere_normal, sphere_offset, triangle_normal, triangle_offset};
use crate::math::{Hit, MISS, Ray, Vec3};
use crate::sampling::dimension::{DIRECTION, bounce};
use crate::sampling::random::{path_key, uniform};
use crate::sampling::warp::sample_cosine_hemisphere;
use crate::scene::Scene;
use crate::traverse::rays::{Hits, Rays};
use serde::Serialize;

/// Pixels of a tile: width, height. A tile's rays stand together in the arrays.
pub const TILE: [u32; 2] = [16, 16];
/// Pixels of a packet.
const BLOCK: [u32; 2] = [4, 2];
/// Shadow rays reach so many diagonals of the scene.
const SHADOW_REACH: f64 = 0.25;

/// Where rays come from, and what is asked of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// From the camera: the nearest hit.
    Primary,
    /// From surfaces, of limited reach: any hit. Ambient occlusion.
    Shadow,
    /// From surfaces: the nearest hit.
    Diffuse,
}

impl Kind {
    /// As reports and files name it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Shadow => "shadow",
            Self::Diffuse => "diffuse",
        }
    }
    /// Is it enough to know whether there is a hit?
    pub fn any_hit(self) -> bool {
        self == Self::Shadow
    }
}

/// Rays of one kind as columns of equal length.
#[derive(Clone, Debug)]
pub struct RaySet {
    pub kind: Kind,
    pub origin: [Vec<f32>; 3],
    pub direction: [Vec<f32>; 3],
    /// Hits count up to here, in units of t: directions have unit length, so a distance.
    pub t_max: Vec<f32>,
}

/// The pixels of a picture in the order of primary rays: tile by tile, and in a tile block by block. Tiles that the picture's edge
/// cuts come last, so that all others start at a multiple of their size.
pub fn pixels(size: [u32; 2]) -> Vec<[u32; 2]> {
    let whole = |tile: &Tile| [tile.width, tile.height] == TILE;
    let (whole, cut): (Vec<Tile>, Vec<Tile>) = Tile::cover(size, TILE).partition(whole);
    let mut pixels = Vec::with_capacity(size[0] as usize * size[1] as usize);
    for tile in whole.iter().chain(&cut) {
        for block in Tile::cover([tile.width, tile.height], BLOCK) {
            let (left, top) = (tile.x + block.x, tile.y + block.y);
            let rows = top..top + block.height;
            pixels.extend(rows.flat_map(|y| (left..left + block.width).map(move |x| [x, y])));
        }
    }
    pixels
}

impl RaySet {
    fn with_capacity(kind: Kind, rays: usize) -> Self {
        let column = || Vec::with_capacity(rays);
        let columns = || [column(), column(), column()];
        Self { kind, origin: columns(), direction: columns(), t_max: column() }
    }

    fn push(&mut self, ray: Ray<f32>, t_max: f32) {
        let Ray { origin, direction } = ray;
        self.origin.iter_mut().zip([origin.x, origin.y, origin.z]).for_each(|(column, x)| column.push(x));
        let components = [direction.x, direction.y, direction.z];
        self.direction.iter_mut().zip(components).for_each(|(column, x)| column.push(x));
        self.t_max.push(t_max);
    }

    /// The rays through the middles of these pixels.
    pub fn primary(camera: &Pinhole, pixels: &[[u32; 2]]) -> Self {
        let mut set = Self::with_capacity(Kind::Primary, pixels.len());
        for pixel in pixels {
            let [x, y] = pixel.map(|x| x as f32 + 0.5);
            set.push(camera.rays(x, y), f32::INFINITY);
        }
        set
    }

    /// One ray of this kind from every hit of the primary rays through `pixels`, in their order. `width`: pixels of a row.
    pub fn from_hits(
        kind: Kind,
        scene: &Scene,
        primary: &Prepared,
        pixels: &[[u32; 2]],
        width: u32,
        seed: u32,
    ) -> Self {
        let Prepared { set: rays, nearest: answers } = primary;
        let (lower, upper) = scene.bounds();
        // The two kinds go different ways: each has the numbers of a scattering event of its own.
        let (t_max, event) = match kind {
            Kind::Shadow => ((SHADOW_REACH * (upper - lower).length()) as f32, 0),
            _ => (f32::INFINITY, 1),
        };
        let mut set = Self::with_capacity(kind, answers.count());
        for (at, &[x, y]) in pixels.iter().enumerate() {
            let hit = answers.get(at);
            if hit.primitive != MISS {
                let (origin, normal) = leave(scene, &rays.rays().packet::<f32>(at), &hit);
                let key = path_key(seed, y * width + x, 0);
                let random = |number: u32| uniform::<f32>(key, bounce(event) + DIRECTION + number);
                let direction = sample_cosine_hemisphere(normal, random(0), random(1));
                set.push(Ray { origin, direction }, t_max);
            }
        }
        set
    }

    pub fn len(&self) -> usize {
        self.t_max.len()
    }
    pub fn is_empty(&self) -> bool {
        self.t_max.is_empty()
    }
    /// As traversals read them.
    pub fn rays(&self) -> Rays<'_> {
        Rays {
            origin: self.origin.each_ref().map(Vec::as_slice),
            direction: self.direction.each_ref().map(Vec::as_slice),
        }
    }
}

/// Where a ray may start from what another one hit, and the unit normal on the side from which that one came.
fn leave(scene: &Scene, ray: &Ray<f32>, hit: &Hit<f32>) -> (Vec3<f32>, Vec3<f32>) {
    let number = hit.primitive as usize;
    let (point, outward, offset) = match scene.spheres.get(number) {
        Some(sphere) => {
            let center = Vec3::splat(sphere.center);
            let outward = sphere_normal(ray.at(hit.t), center);
            (outward.mul_add(sphere.radius, center), outward, sphere_offset(sphere.center, sphere.radius))
        }
        None => {
            let vertices = scene.triangles[number - scene.spheres.len()].vertices;
            let [a, b, c] = vertices;
            let (a, ab, ac) = (Vec3::splat(a), Vec3::splat(b - a), Vec3::splat(c - a));
            let point = ab.mul_add(hit.u, ac.mul_add(hit.v, a));
            (point, Vec3::splat(triangle_normal(vertices)), triangle_offset(vertices))
        }
    };
    let normal = outward.flip_sign(-ray.direction.dot(outward));
    (normal.mul_add(offset, point), normal)
}

/// What was found for each ray of a set, as columns.
#[derive(Clone, Debug, PartialEq)]
pub struct Answers {
    /// For a miss, how far the ray reaches.
    pub t: Vec<f32>,
    pub primitive: Vec<u32>,
    pub u: Vec<f32>,
    pub v: Vec<f32>,
}

impl Answers {
    /// Nothing found yet.
    pub fn none(set: &RaySet) -> Self {
        let zeros = || vec![0.0; set.len()];
        Self { t: set.t_max.clone(), primitive: vec![MISS; set.len()], u: zeros(), v: zeros() }
    }
    /// As traversals write them.
    pub fn hits(&mut self) -> Hits<'_> {
        Hits { t: &mut self.t, primitive: &mut self.primitive, u: &mut self.u, v: &mut self.v }
    }
    pub fn get(&self, at: usize) -> Hit<f32> {
        Hit { t: self.t[at], primitive: self.primitive[at], u: self.u[at], v: self.v[at] }
    }
    /// How many rays hit something.
    pub fn count(&self) -> usize {
        self.primitive.iter().filter(|&&primitive| primitive != MISS).count()
    }
}

/// Rays, and the nearest hit of each within its reach.
#[derive(Clone, Debug)]
pub struct Prepared {
    pub set: RaySet,
    pub nearest: Answers,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::Trees;
    use crate::measure::rays::prepare;
    use crate::measure::ways::{Ground, Team};
    use crate::traverse::hierarchy::Hierarchy;
    use octray_formats::scene::load;

    fn prepared(scene: &Scene, size: [u32; 2], seed: u32) -> Vec<Prepared> {
        let ground = Ground::new(scene, Hierarchy::new(scene, Trees::WideAndBinary));
        prepare(scene, &scene.overview().unwrap(), &ground, &Team::new(2), size, seed)
    }

    fn vector([x, y, z]: &[Vec<f32>; 3], at: usize) -> glam::Vec3 {
        glam::Vec3::new(x[at], y[at], z[at])
    }

    #[test]
    fn pixels_are_all_there_once_whatever_the_size() {
        for size in [[1, 1], [4, 2], [5, 3], [16, 16], [17, 16], [33, 47], [960, 540]] {
            let mut pixels = pixels(size);
            assert_eq!(pixels.len(), (size[0] * size[1]) as usize, "{size:?}");
            pixels.sort_by_key(|&[x, y]| (y, x));
            let rows = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| [x, y]));
            assert!(pixels.into_iter().eq(rows), "{size:?}");
        }
    }

    #[test]
    fn pixels_of_whole_tiles_and_blocks_stand_together() {
        let pixels = pixels([40, 50]);
        let span = |pixels: &[[u32; 2]], axis: usize| {
            let values = || pixels.iter().map(|pixel| pixel[axis]);
            (values().min().unwrap(), values().max().unwrap())
        };
        for tile in pixels[..2 * 3 * 256].chunks(256) {
            for axis in 0..2 {
                let (low, high) = span(tile, axis);
                assert_eq!((low % 16, high), (0, low + 15));
            }
            for block in tile.chunks(8) {
                let ((left, right), (top, bottom)) = (span(block, 0), span(block, 1));
                assert_eq!((left % 4, right, top % 2, bottom), (0, left + 3, 0, top + 1));
            }
        }
    }

    #[test]
    fn rays_leave_from_the_side_on_which_the_primary_ray_arrived_and_miss_their_own_surface() {
        // Convex from outside and from inside: a ball, and the inner side of a box.
        for (name, all_hit) in [("builtin:three", false), ("builtin:cornell", true)] {
            let scene = load(name).unwrap();
            let [primary, shadow, diffuse] = &prepared(&scene, [70, 50], 3)[..] else {
                panic!("three kinds")
            };
            let hits: Vec<usize> =
                (0..primary.set.len()).filter(|&at| primary.nearest.primitive[at] != MISS).collect();
            assert!(hits.len() > 100, "{name}");
            for secondary in [shadow, diffuse] {
                assert_eq!(secondary.set.len(), hits.len(), "{name}");
                for (at, &from) in hits.iter().enumerate() {
                    let hit = primary.nearest.get(from);
                    let ray = primary.set.rays().packet::<f32>(from);
                    let (origin, normal) = leave(&scene, &ray, &hit);
                    assert_eq!(origin.get(0), vector(&secondary.set.origin, at));
                    let direction = vector(&secondary.set.direction, at);
                    assert!(
                        normal.get(0).dot(ray.direction.get(0)) <= 0.0 && normal.get(0).dot(direction) > 0.0
                    );
                    let distance = origin.get(0).distance(ray.at(hit.t).get(0));
                    assert!(distance < 1e-3 * hit.t, "{name}: {distance} at {}", hit.t);
                    assert_ne!(secondary.nearest.primitive[at], hit.primitive, "{name}");
                }
            }
            let (lower, upper) = scene.bounds();
            let t_max = (0.25 * (upper - lower).length()) as f32;
            assert!(shadow.set.t_max.iter().all(|&one| one == t_max));
            assert!(!all_hit || shadow.nearest.t.iter().all(|&t| t <= t_max));
            assert_ne!(shadow.set.direction, diffuse.set.direction);
        }
    }

    #[test]
    fn directions_follow_the_cosine() {
        let scene = load("builtin:terrain:2").unwrap();
        let sets = prepared(&scene, [200, 200], 1);
        for secondary in &sets[1..] {
            // The whole terrain is two triangles: the mean cosine about their normals is 2/3, with a variance of 1/18.
            let hits = (0..sets[0].set.len()).filter(|&at| sets[0].nearest.primitive[at] != MISS);
            let cosines: Vec<f64> = hits
                .enumerate()
                .map(|(at, from)| {
                    let ray = sets[0].set.rays().packet::<f32>(from);
                    let (_, normal) = leave(&scene, &ray, &sets[0].nearest.get(from));
                    f64::from(normal.get(0).dot(vector(&secondary.set.direction, at)))
                })
                .collect();
            let mean = cosines.iter().sum::<f64>() / cosines.len() as f64;
            let error = (1.0 / 18.0 / cosines.len() as f64).sqrt();
            assert!(cosines.len() > 3_000 && (mean - 2.0 / 3.0).abs() < 4.0 * error, "{mean} ± {error}");
        }
    }

    #[test]
    fn sets_are_a_function_of_scene_size_and_seed() {
        let scene = load("builtin:knot:500").unwrap();
        let directions = |seed| prepared(&scene, [60, 40], seed).pop().unwrap().set.direction;
        assert_eq!(directions(5), directions(5));
        assert_ne!(directions(5), directions(6));
    }
}
