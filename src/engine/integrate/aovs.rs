//! AOVs (arbitrary output variables): depth, normal, albedo and more of the surface at the centre of every
//! pixel. Input of the denoiser, of temporal reprojection, and of the viewer's views of the scene.
//!
//! For: [`Aovs`], [`Plane`], [`AovSample`]. May import: `generate`, `intersect`, `material`, `emission` and
//! what stands above them. Must never know: films, filters.

use super::context::TraceContext;
use super::emission::environment_radiance;
use super::generate::pixel_centers;
use super::intersect::intersect_linear;
use super::material::MaterialSample;
use super::queue::Path;
use super::scratch::Scratch;
use super::stats::RayKind;
use super::surface::Surface;
use crate::buffers::{Features, MaterialCode};
use crate::camera::MAX_PIXELS;
use crate::lane::{Bits, F32x8, Lane, Mask};
use crate::math::{Hit, MISS, Vec3};

/// Lanes of the pass. AOVs are the same at any width.
type L = F32x8;
const ALL: u32 = Features::ALL.0;

/// One variable of every pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plane {
    /// Along the ray from the camera; infinite where it hits nothing.
    Distance,
    /// Unit shading normal, facing the camera; zero where there is no surface.
    NormalX,
    NormalY,
    NormalZ,
    /// Albedo, textures included, in [0, 1]. Of emissive surfaces and of the environment the radiance, scaled
    /// down where a channel is above 1.
    AlbedoRed,
    AlbedoGreen,
    AlbedoBlue,
    /// Barycentric weights of a triangle's second and third vertex; 0 elsewhere.
    WeightU,
    WeightV,
    /// Width of the lobe, in [0, 1]: alpha (the square of the roughness) of metal, roughness of `scatter`; 0
    /// of mirrors and glass; 1 of every other surface, and where there is none.
    Lobe,
    /// Bits of [`AovSample::object`].
    Object,
}

const PLANES: usize = Plane::Object as usize + 1;

/// The surface at the centre of a pixel: see [`Plane`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AovSample {
    pub distance: f32,
    pub normal: glam::Vec3,
    pub albedo: [f32; 3],
    pub weights: [f32; 2],
    pub lobe: f32,
    /// Object id: the same on one sphere, or on all triangles of one material; [`MISS`] where there is no
    /// surface.
    pub object: u32,
}

/// The AOVs of a picture: row by row, in each row plane by plane, so that filters load whole packets.
#[derive(Clone, Debug, Default)]
pub struct Aovs {
    resolution: [u32; 2],
    /// From one plane of a row to the next: a packet more than pixels, so that the last packet may be loaded
    /// and stored whole.
    stride: usize,
    values: Vec<f32>,
}

impl Aovs {
    /// Allocates only where the picture grows. The values are unspecified afterwards.
    pub fn resize(&mut self, resolution: [u32; 2]) {
        let [width, height] = resolution.map(|side| side as usize);
        self.resolution = resolution;
        self.stride = width + L::WIDTH;
        self.values.resize(self.stride * PLANES * height, 0.0);
    }
    /// Pixels: width, height.
    pub fn resolution(&self) -> [u32; 2] {
        self.resolution
    }
    /// One plane of a row of pixels, from the left.
    #[inline(always)]
    pub fn row(&self, plane: Plane, y: u32) -> &[f32] {
        let start = (y as usize * PLANES + plane as usize) * self.stride;
        &self.values[start..start + self.resolution[0] as usize]
    }
    /// [`AovSample::object`] of a row of pixels.
    #[inline(always)]
    pub fn objects(&self, y: u32) -> &[u32] {
        bytemuck::cast_slice(self.row(Plane::Object, y))
    }
    pub fn pixel(&self, x: u32, y: u32) -> AovSample {
        let at = |plane| self.row(plane, y)[x as usize];
        AovSample {
            distance: at(Plane::Distance),
            normal: glam::Vec3::new(at(Plane::NormalX), at(Plane::NormalY), at(Plane::NormalZ)),
            albedo: [at(Plane::AlbedoRed), at(Plane::AlbedoGreen), at(Plane::AlbedoBlue)],
            weights: [at(Plane::WeightU), at(Plane::WeightV)],
            lobe: at(Plane::Lobe),
            object: at(Plane::Object).to_bits(),
        }
    }
    /// The length of a row and all rows, for [`render_row`].
    pub(crate) fn rows(&mut self) -> (usize, &mut [f32]) {
        (self.stride * PLANES, &mut self.values)
    }
}

/// Fills a row of AOVs.
pub(crate) fn render_row(context: &TraceContext, y: u32, row: &mut [f32], scratch: &mut Scratch) {
    let stride = row.len() / PLANES;
    let width = context.width as usize;
    for left in (0..width).step_by(MAX_PIXELS) {
        let count = MAX_PIXELS.min(width - left);
        pixel_centers(context, [left as u32, y], count, scratch);
        match context.primitives.hierarchy() {
            Some((hierarchy, traversal)) => {
                scratch.intersect_hierarchy(hierarchy, traversal, count, RayKind::Primary);
            }
            None => intersect_linear::<L>(context, None, scratch.queue.queries(count)),
        }
        for at in (0..count).step_by(L::WIDTH) {
            for (plane, values) in aovs(context, scratch, at, count).into_iter().enumerate() {
                values.store(&mut row[plane * stride + left + at..]);
            }
        }
    }
}

/// The planes of the packet at `at`.
fn aovs(context: &TraceContext, scratch: &Scratch, at: usize, count: usize) -> [L; PLANES] {
    let (zero, one) = (L::zero(), L::one());
    let ray = scratch.queue.ray::<L>(at);
    let path = Path {
        ray,
        throughput: Vec3::repeat(one),
        inv_pdf: zero,
        key: <L as Lane>::Bits::splat(0),
        slot: <L as Lane>::Bits::splat(0),
    };
    let hit: Hit<L> = scratch.queue.hit(at);
    let active = <L as Lane>::Mask::first(count - at);
    let found = hit.found() & active;
    let (mut normal, mut object) = (Vec3::zero(), <L as Lane>::Bits::splat(MISS));
    let (mut albedo, mut lobe) = (Vec3::repeat(one), one);
    if !found.all() {
        albedo = displayable(environment_radiance::<L, ALL>(context, ray.direction, active & !found));
    }
    if found.any() {
        let surface = Surface::of::<ALL>(context, &path, &hit, found);
        let material = MaterialSample::of::<ALL>(context, &surface, found);
        let is = |kind: u32| material.kind.equals(<L as Lane>::Bits::splat(kind));
        let color = Vec3::select(is(MaterialCode::EMITTER), displayable(material.emission), material.color);
        let away = zero.lt(material.ns.dot(ray.direction));
        let facing = Vec3::select(away, -material.ns, material.ns);
        let spread = material.parameter.min(one);
        let spread = L::select(is(MaterialCode::GGX) | is(MaterialCode::SCATTER), spread, one);
        let spread = L::select(is(MaterialCode::MIRROR) | is(MaterialCode::GLASS), zero, spread);
        normal = Vec3::select(found, facing, normal);
        albedo = Vec3::select(found, color, albedo);
        lobe = L::select(found, spread, lobe);
        object = <L as Lane>::Bits::select(found, surface.object(context, &hit), object);
    }
    let distance = L::select(found, hit.t, L::splat(f32::INFINITY));
    let on_triangle =
        found & !hit.primitive.less(<L as Lane>::Bits::splat(context.buffers.spheres.len() as u32));
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
