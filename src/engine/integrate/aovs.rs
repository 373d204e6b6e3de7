//! AOVs (arbitrary output variables): depth, normal, albedo and more of the surface at the centre of every
//! pixel. Input of the denoiser, of temporal reprojection, and of the viewer's views of the scene.

use super::context::TraceContext;
use super::emission::environment_radiance;
use super::generate::pixel_centers;
use super::intersect::closest_of_queue;
use super::material::MaterialSample;
use super::queue::Path;
use super::scratch::Scratch;
use super::stats::RayKind;
use super::surface::Surface;
use crate::buffers::{Features, MaterialCode};
use crate::camera::MAX_PIXELS;
use crate::lane::{Bits, F32x8, Lane, Mask, Mask8};
use crate::math::{Hit, MISS, Ray, Vec3};
use crate::rays::Kind;

/// Lanes of the pass. AOVs are the same at any width.
type L = F32x8;
type B = <L as Lane>::Bits;
pub(super) const ALL: u32 = Features::ALL.0;

/// One variable of every pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plane {
    /// Along the ray from the camera; infinite where it hits nothing.
    Distance,
    /// Unit shading normal, facing the camera; zero where there is no surface.
    NormalX,
    /// y of the shading normal.
    NormalY,
    /// z of the shading normal.
    NormalZ,
    /// Albedo, textures included, in [0, 1]. Of emissive surfaces and of the environment the radiance, scaled
    /// down where a channel is above 1.
    AlbedoRed,
    /// Green of the albedo.
    AlbedoGreen,
    /// Blue of the albedo.
    AlbedoBlue,
    /// Barycentric weights of a triangle's second and third vertex; 0 elsewhere.
    WeightU,
    /// The barycentric weight of the third vertex.
    WeightV,
    /// Width of the lobe, in [0, 1]: alpha (the square of the roughness) of metal and of the metallic share
    /// of metal-rough, roughness of the fuzzy mirror; 0 of mirrors and glass; 1 of every other surface and
    /// share, and where there is none.
    Lobe,
    /// Of emissive surfaces and of the environment, radiance over albedo; 0 of every other surface.
    Scale,
    /// Bits of [`AovSample::object`].
    Object,
}

const PLANES: usize = Plane::Object as usize + 1;

/// The surface at the centre of a pixel: see [`Plane`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AovSample {
    /// Distance from the camera; infinite for a miss.
    pub distance: f32,
    /// The shading normal; zero for a miss.
    pub normal: glam::Vec3,
    /// Reflectance in linear RGB.
    pub albedo: [f32; 3],
    /// Barycentric weights of a triangle's second and third vertex.
    pub weights: [f32; 2],
    /// Width of the lobe: see [`Plane::Lobe`].
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
    pub(super) const PLANES: usize = PLANES;

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
    /// The sample of a pixel of the tile.
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
    /// As many pixels and the same values as another one.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        (self.resolution, self.stride) = (other.resolution, other.stride);
        self.values.clear();
        self.values.extend_from_slice(&other.values);
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
        closest_of_queue(context, None, scratch, 0..count, RayKind::Primary);
        for at in (0..count).step_by(L::WIDTH) {
            for (plane, values) in aovs(context, scratch, at, count).into_iter().enumerate() {
                values.store(&mut row[plane * stride + left + at..]);
            }
        }
    }
}

/// The planes of the packet at `at`.
fn aovs(context: &TraceContext, scratch: &Scratch, at: usize, count: usize) -> [L; PLANES] {
    let cone = context.primary_cone::<L, ALL>();
    let ray = Ray { origin: context.camera.origin(), direction: scratch.queue.primary::<L>(at).0 };
    let path = Path::primary(ray, B::splat(0), B::splat(0), cone);
    Seen::of(context, &path, &scratch.queue.hit(at), <L as Lane>::Mask::first(count - at)).planes(context)
}

/// What a packet of rays sees.
pub(super) struct Seen {
    hit: Hit<L>,
    pub found: Mask8,
    /// Where some lane is in `found`.
    pub surface: Option<(Surface<L>, MaterialSample<L>)>,
    pub normal: Vec3<L>,
    pub albedo: Vec3<L>,
    pub scale: L,
    pub lobe: L,
    pub object: B,
}

impl Seen {
    pub fn of(context: &TraceContext, path: &Path<L>, hit: &Hit<L>, active: Mask8) -> Self {
        let (zero, one) = (L::zero(), L::one());
        let direction = path.ray.direction;
        let found = hit.found() & active;
        let (albedo, scale) = (Vec3::repeat(one), one);
        let (normal, lobe, object) = (Vec3::zero(), one, B::splat(MISS));
        let mut seen = Self { hit: *hit, found, surface: None, normal, albedo, scale, lobe, object };
        if !found.all() {
            let radiance =
                environment_radiance::<L, ALL>(context, direction, path.cone.angle, active & !found);
            (seen.albedo, seen.scale) = displayable(radiance);
        }
        if found.any() {
            let surface = Surface::of::<ALL>(context, path, hit, found);
            let material = MaterialSample::of::<ALL>(context, &surface, found);
            let is = |kind: u32| material.kind.equals(B::splat(kind));
            let (emitted, of_emitter) = displayable(material.emission);
            let color = Vec3::select(is(MaterialCode::EMITTER), emitted, material.color);
            let of_color = of_emitter.only(is(MaterialCode::EMITTER));
            let away = zero.lt(material.ns.dot(direction));
            let facing = Vec3::select(away, -material.ns, material.ns);
            let width = material.roughness_or_ior.min(one);
            let width = L::select(is(MaterialCode::GGX) | is(MaterialCode::FUZZY_MIRROR), width, one);
            let width = L::select(is(MaterialCode::MIRROR) | is(MaterialCode::GLASS), zero, width);
            // The dielectric's base is diffuse.
            let metallic = material.transmitted;
            let metal_rough = metallic.mul_add(material.roughness_or_ior, one - metallic);
            let width = L::select(is(MaterialCode::METAL_ROUGH), metal_rough, width);
            seen.normal = Vec3::select(found, facing, normal);
            seen.albedo = Vec3::select(found, color, seen.albedo);
            seen.scale = L::select(found, of_color, seen.scale);
            seen.lobe = L::select(found, width, lobe);
            seen.object = B::select(found, surface.object(context, hit), object);
            seen.surface = Some((surface, material));
        }
        seen
    }

    fn planes(&self, context: &TraceContext) -> [L; PLANES] {
        let Self { hit, found, normal, albedo, scale, lobe, object, .. } = self;
        let distance = L::select(*found, hit.t, L::splat(f32::INFINITY));
        let on_triangle = *found & context.buffers.ranges.are_of_kind(Kind::Triangle, hit.primitive);
        let weight = |weight| L::select(on_triangle, weight, L::zero());
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
            *lobe,
            *scale,
            L::from_bits(*object),
        ]
    }
}

/// Radiance scaled so that no channel is above 1, and one over that scale.
fn displayable(radiance: Vec3<L>) -> (Vec3<L>, L) {
    let most = radiance.x.max(radiance.y).max(radiance.z).max(L::one());
    (radiance * (L::one() / most), most)
}
