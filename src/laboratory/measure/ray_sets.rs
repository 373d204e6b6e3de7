//! Rays of a real picture in prepared arrays: camera rays, and secondary rays from their hits.
//!
//! Three kinds ([`Kind`]). Primary rays pass through pixel centres. From each of their hits one shadow ray
//! and one diffuse ray leave on the side from which the primary ray arrives, cosine-weighted around the
//! normal, from a point that is offset from the surface by the renderer's error bound
//! ([`crate::kernel::surface`]). Their random numbers are a function of seed and pixel alone.

use crate::camera::{PreparedCamera, Tile};
use crate::math::{MISS, Ray, Vec3};
use crate::rays::{Hits, Rays};
use crate::sampling::dimension::{DIRECTION, bounce};
use crate::sampling::random::{path_key, uniform};
use crate::sampling::warp::sample_cosine_hemisphere;
use crate::scene::Scene;
use serde::Serialize;

/// Pixels of a tile: width, height. A tile's rays are contiguous in the arrays.
pub(crate) const TILE: [u32; 2] = [16, 16];
/// t_max of shadow rays, in diagonals of the scene's bounds.
const SHADOW_T_MAX: f64 = 0.25;

/// Origin of the rays, and their query.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Rays from the camera: the nearest hit.
    Primary,
    /// Rays from surfaces, with a finite t_max: any hit. Ambient occlusion.
    Shadow,
    /// Rays from surfaces: the nearest hit.
    Diffuse,
}

impl Kind {
    /// Returns the name in reports and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Shadow => "shadow",
            Self::Diffuse => "diffuse",
        }
    }
    /// Tests whether the query is for any hit.
    pub fn any_hit(self) -> bool {
        self == Self::Shadow
    }
}

/// Rays of one kind as columns of equal length.
#[derive(Clone, Debug)]
pub struct RaySet {
    /// Kind of all rays of the set.
    pub kind: Kind,
    /// Columns x, y, z; scene units.
    pub origin: [Vec<f32>; 3],
    /// Columns x, y, z; unit length.
    pub direction: [Vec<f32>; 3],
    /// End of each ray in units of t: a distance, as directions have unit length.
    pub t_max: Vec<f32>,
}

/// Returns the pixels of a picture in the order of primary rays: tile by tile, and in a tile as in frames.
/// Tiles clipped by the picture's edge come last, so that all others start at a multiple of their size.
pub(crate) fn pixels(size: [u32; 2]) -> Vec<[u32; 2]> {
    let whole = |tile: &Tile| [tile.width, tile.height] == TILE;
    let (whole, cut): (Vec<Tile>, Vec<Tile>) = Tile::cover(size, TILE).partition(whole);
    let mut pixels = Vec::with_capacity(size[0] as usize * size[1] as usize);
    for tile in whole.iter().chain(&cut) {
        pixels.extend(tile.places());
    }
    pixels
}

impl RaySet {
    /// Collects rays, each with its t_max.
    fn of(kind: Kind, rays: impl Iterator<Item = (Ray<f32>, f32)>) -> Self {
        let columns = || [const { Vec::new() }; 3];
        let mut set = Self { kind, origin: columns(), direction: columns(), t_max: Vec::new() };
        for (Ray { origin, direction }, t_max) in rays {
            for (columns, vector) in [(&mut set.origin, origin), (&mut set.direction, direction)] {
                columns.iter_mut().zip(vector.get(0).to_array()).for_each(|(column, x)| column.push(x));
            }
            set.t_max.push(t_max);
        }
        set
    }

    /// Returns the rays through the centres of these pixels.
    pub fn primary(camera: &PreparedCamera, pixels: &[[u32; 2]]) -> Self {
        let ray = |pixel: &[u32; 2]| {
            let [x, y] = pixel.map(|x| x as f32 + 0.5);
            (camera.rays(x, y), f32::INFINITY)
        };
        Self::of(Kind::Primary, pixels.iter().map(ray))
    }

    /// Builds one ray of this kind from every hit of the primary rays through `pixels`, in their order.
    /// `width`: pixels of a row.
    pub(crate) fn from_hits(
        kind: Kind,
        scene: &Scene,
        primary: &RaysWithHits,
        pixels: &[[u32; 2]],
        width: u32,
        seed: u32,
    ) -> Self {
        let RaysWithHits { set: rays, nearest: answers } = primary;
        let (lower, upper) = scene.bounds();
        // Each kind has the random numbers of another scattering event, and so other directions.
        let (t_max, event) = match kind {
            Kind::Shadow => ((SHADOW_T_MAX * (upper - lower).length()) as f32, 0),
            _ => (f32::INFINITY, 1),
        };
        let ray = |(at, &[x, y]): (usize, &[u32; 2])| {
            let hit = answers.get(at);
            (hit.primitive != MISS).then(|| {
                let (origin, normal) = secondary_origin(scene, &rays.rays().packet::<f32>(at), &hit);
                let key = path_key(seed, y * width + x, 0);
                let random = |number: u32| uniform::<f32>(key, bounce(event) + DIRECTION + number);
                let direction = sample_cosine_hemisphere(normal, random(0), random(1));
                (Ray { origin, direction }, t_max)
            })
        };
        Self::of(kind, pixels.iter().enumerate().filter_map(ray))
    }

    /// Returns the number of rays.
    pub fn len(&self) -> usize {
        self.t_max.len()
    }
    /// Tests whether there is no ray: a camera that sees no surface has no secondary rays.
    pub fn is_empty(&self) -> bool {
        self.t_max.is_empty()
    }
    /// Returns the view that traversals read.
    pub fn rays(&self) -> Rays<'_> {
        let (origin, direction) = (self.origin.each_ref(), self.direction.each_ref());
        Rays::new(origin.map(Vec::as_slice), direction.map(Vec::as_slice)).until(&self.t_max)
    }
}

/// Returns the origin of a secondary ray at a hit, and the unit normal on the side of the first ray.
pub(super) fn secondary_origin(scene: &Scene, ray: &Ray<f32>, hit: &Answer) -> (Vec3<f32>, Vec3<f32>) {
    let primitive = scene.primitive(hit.primitive as usize);
    let (point, outward, offset) = primitive.shape().surface(ray.at(hit.t), [hit.u, hit.v]);
    let normal = outward.flip_sign(-ray.direction.dot(outward));
    (normal.mul_add(offset, point), normal)
}

/// One ray's hit, as in the columns of [`Answers`].
#[derive(Clone, Debug, Serialize)]
pub struct Answer {
    /// Distance of the hit in units of the direction's length; t_max for a miss.
    pub t: f32,
    /// Number of the primitive hit; `u32::MAX` for a miss.
    pub primitive: u32,
    /// Barycentric weight of a triangle's second vertex.
    pub u: f32,
    /// Barycentric weight of a triangle's third vertex.
    pub v: f32,
}

impl Answer {
    /// Tests whether both are a hit; where the nearest one counts, whether all bits are equal.
    pub(super) fn agrees(&self, other: &Self, kind: Kind) -> bool {
        let bits = |Self { t, primitive, u, v }: &Self| (*primitive, [t, u, v].map(|x| x.to_bits()));
        if kind.any_hit() {
            (self.primitive == MISS) == (other.primitive == MISS)
        } else {
            bits(self) == bits(other)
        }
    }
}

/// The hit of each ray of a set, as columns.
#[derive(Clone, Debug, PartialEq)]
pub struct Answers {
    /// Distance of each hit; t_max for a miss.
    pub t: Vec<f32>,
    /// Spheres first, in the scene's order, then triangles; [`MISS`] without a hit.
    pub primitive: Vec<u32>,
    /// Barycentric weight of a triangle's second vertex; 0 on spheres and for misses.
    pub u: Vec<f32>,
    /// Barycentric weight of a triangle's third vertex; 0 on spheres and for misses.
    pub v: Vec<f32>,
}

impl Answers {
    /// Returns a miss for every ray.
    pub fn none(set: &RaySet) -> Self {
        let zeros = || vec![0.0; set.len()];
        Self { t: set.t_max.clone(), primitive: vec![MISS; set.len()], u: zeros(), v: zeros() }
    }
    /// Returns the view that traversals write.
    pub fn hits(&mut self) -> Hits<'_> {
        Hits { t: &mut self.t, primitive: &mut self.primitive, u: &mut self.u, v: &mut self.v }
    }
    /// Returns the hit of ray `at`.
    pub(crate) fn get(&self, at: usize) -> Answer {
        Answer { t: self.t[at], primitive: self.primitive[at], u: self.u[at], v: self.v[at] }
    }
    /// Returns the number of hits.
    pub fn count(&self) -> usize {
        self.primitive.iter().filter(|&&primitive| primitive != MISS).count()
    }
}

/// Rays, and the nearest hit of each before its t_max.
#[derive(Clone, Debug)]
pub struct RaysWithHits {
    /// The rays.
    pub set: RaySet,
    /// Their nearest hits, by the scalar traversal; also for shadow rays.
    pub nearest: Answers,
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
