//! What the camera sees besides light: the surface under the middle of every pixel. Filters and views of the scene are guided by it.

use super::World;
use super::extend::meet;
use crate::camera::MAX_PIXELS;
use super::queue::{Path, Work};
use super::shade::sky_radiance;
use super::stats::RayKind;
use super::surface::{MaterialSample, Surface};
use crate::buffers::{Features, MaterialCode};
use crate::lane::{Bits, F32x8, Lane, Mask, lane_indices};
use crate::math::{Hit, MISS, Vec3};

/// Lanes of the pass. Aovs are the same at any width.
type L = F32x8;
const ALL: u32 = Features::ALL.0;

/// One of the numbers of every pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plane {
    /// From the camera along the ray; infinite where it meets nothing.
    Distance,
    /// The unit normal that shading takes, facing the camera; zero where there is no surface.
    NormalX,
    NormalY,
    NormalZ,
    /// The share of light that the surface gives back, its picture included, in [0, 1]. Of what shines, and of the sky, its radiance, scaled
    /// down where it is above 1.
    AlbedoRed,
    AlbedoGreen,
    AlbedoBlue,
    /// Barycentric weights of a triangle's second and third vertex; 0 elsewhere.
    WeightU,
    WeightV,
    /// How far the surface spreads what it reflects, in [0, 1]: the width of the lobe, which is the square of a metal's roughness; 0 of mirrors
    /// and glass, 1 of what is matt, shines, or is not there.
    Lobe,
    /// Bits of [`Guide::object`].
    Object,
}

const PLANES: usize = Plane::Object as usize + 1;

/// The surface under the middle of a pixel: see [`Plane`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guide {
    pub distance: f32,
    pub normal: glam::Vec3,
    pub albedo: [f32; 3],
    pub weights: [f32; 2],
    pub lobe: f32,
    /// The same for pixels on one sphere, or on triangles of one material; [`MISS`] where there is none.
    pub object: u32,
}

/// The guides of a picture: row by row, in each row plane by plane, so that filters load whole packets.
#[derive(Clone, Debug, Default)]
pub struct Aovs {
    resolution: [u32; 2],
    /// From one plane of a row to the next: a packet more than pixels, so that the last packet may be read and stored whole.
    stride: usize,
    numbers: Vec<f32>,
}

impl Aovs {
    /// Takes memory only where the picture grows. What the guides hold afterwards is unspecified.
    pub fn resize(&mut self, resolution: [u32; 2]) {
        let [width, height] = resolution.map(|side| side as usize);
        self.resolution = resolution;
        self.stride = width + L::WIDTH;
        self.numbers.resize(self.stride * PLANES * height, 0.0);
    }
    /// Pixels: width, height.
    pub fn resolution(&self) -> [u32; 2] {
        self.resolution
    }
    /// One plane of a row of pixels, from the left.
    #[inline(always)]
    pub fn row(&self, plane: Plane, y: u32) -> &[f32] {
        let start = (y as usize * PLANES + plane as usize) * self.stride;
        &self.numbers[start..start + self.resolution[0] as usize]
    }
    /// [`Guide::object`] of a row of pixels.
    #[inline(always)]
    pub fn objects(&self, y: u32) -> &[u32] {
        bytemuck::cast_slice(self.row(Plane::Object, y))
    }
    pub fn pixel(&self, x: u32, y: u32) -> Guide {
        let at = |plane| self.row(plane, y)[x as usize];
        Guide {
            distance: at(Plane::Distance),
            normal: glam::Vec3::new(at(Plane::NormalX), at(Plane::NormalY), at(Plane::NormalZ)),
            albedo: [at(Plane::AlbedoRed), at(Plane::AlbedoGreen), at(Plane::AlbedoBlue)],
            weights: [at(Plane::WeightU), at(Plane::WeightV)],
            lobe: at(Plane::Lobe),
            object: at(Plane::Object).to_bits(),
        }
    }
    /// The rows, to be filled by [`look`], each by itself.
    pub(crate) fn rows(&mut self) -> (usize, &mut [f32]) {
        (self.stride * PLANES, &mut self.numbers)
    }
}

/// Fills a row of guides.
pub(crate) fn look(world: &World, y: u32, row: &mut [f32], work: &mut Work) {
    let stride = row.len() / PLANES;
    let width = world.width as usize;
    for left in (0..width).step_by(MAX_PIXELS) {
        let count = MAX_PIXELS.min(width - left);
        aim(world, [left as u32, y], count, work);
        match world.primitives.hierarchy() {
            Some((hierarchy, traversal)) => work.trace(hierarchy, traversal, count, RayKind::Primary),
            None => meet::<L>(world, None, work.queue.segments(count)),
        }
        for at in (0..count).step_by(L::WIDTH) {
            for (plane, numbers) in guides(world, work, at, count).into_iter().enumerate() {
                numbers.store(&mut row[plane * stride + left + at..]);
            }
        }
    }
}

/// Rays through the middle of `count` pixels from (x, y) on, into the queue.
pub(super) fn aim(world: &World, [x, y]: [u32; 2], count: usize, work: &mut Work) {
    let y = L::splat(y as f32 + 0.5);
    for at in (0..count).step_by(L::WIDTH) {
        let x = L::from_int(lane_indices::<L>()) + L::splat((x as usize + at) as f32 + 0.5);
        let ray = world.camera.rays(x, y);
        work.queue.store_primary(at, ray.direction, <L as Lane>::Bits::splat(0));
        work.queue.store_origin(at, ray.origin);
    }
}

/// The planes of the packet at `at`.
fn guides(world: &World, work: &Work, at: usize, count: usize) -> [L; PLANES] {
    let (zero, one) = (L::zero(), L::one());
    let ray = work.queue.ray::<L>(at);
    let path = Path {
        ray,
        throughput: Vec3::repeat(one),
        inv_pdf: zero,
        key: <L as Lane>::Bits::splat(0),
        slot: <L as Lane>::Bits::splat(0),
    };
    let hit: Hit<L> = work.queue.hit(at);
    let active = <L as Lane>::Mask::first(count - at);
    let found = hit.found() & active;
    let (mut normal, mut object) = (Vec3::zero(), <L as Lane>::Bits::splat(MISS));
    let (mut albedo, mut lobe) = (Vec3::repeat(one), one);
    if !found.all() {
        albedo = displayable(sky_radiance::<L, ALL>(world, ray.direction, active & !found));
    }
    if found.any() {
        let surface = Surface::of::<ALL>(world, &path, &hit, found);
        let material = MaterialSample::of::<ALL>(world, &surface, found);
        let is = |kind: u32| material.kind.equals(<L as Lane>::Bits::splat(kind));
        let color = Vec3::select(is(MaterialCode::EMITTER), displayable(material.emission), material.color);
        let away = zero.lt(material.normal.dot(ray.direction));
        let facing = Vec3::select(away, -material.normal, material.normal);
        let spread = material.parameter.min(one);
        let spread = L::select(is(MaterialCode::GGX) | is(MaterialCode::SCATTER), spread, one);
        let spread = L::select(is(MaterialCode::MIRROR) | is(MaterialCode::GLASS), zero, spread);
        normal = Vec3::select(found, facing, normal);
        albedo = Vec3::select(found, color, albedo);
        lobe = L::select(found, spread, lobe);
        object = <L as Lane>::Bits::select(found, surface.object(world, &hit), object);
    }
    let distance = L::select(found, hit.t, L::splat(f32::INFINITY));
    let on_triangle =
        found & !hit.primitive.less(<L as Lane>::Bits::splat(world.buffers.spheres.len() as u32));
    let weight = |weight| L::select(on_triangle, weight, zero);
    [
        distance,
        normal.x,
        normal.y,
        normal.z,
        albedo.x,
        albedo.y,
        albedo.z,
        weight(hit.u),
        weight(hit.v),
        lobe,
        L::from_bits(object),
    ]
}

/// Radiance scaled so that no channel is above 1.
fn displayable(radiance: Vec3<L>) -> Vec3<L> {
    let most = radiance.x.max(radiance.y).max(radiance.z).max(L::one());
    radiance * (L::one() / most)
}
