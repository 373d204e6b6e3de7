//! AOVs (arbitrary output variables): depth, normal, albedo and more of the surface at the centre of every
//! pixel, as seen through the middle of the lens. The denoiser, temporal reprojection, and the viewer's views
//! of the scene read them.

use super::context::TraceContext;
use super::edge_aovs::CHOSEN;
use super::emission::environment_radiance;
use super::generate::pixel_centers;
use super::material::MaterialSample;
use super::opacity::closest_seen;
use super::queue::Path;
use super::scratch::Scratch;
use super::stats::RayKind;
use crate::buffers::{Features, MaterialCode};
use crate::camera::MAX_PIXELS;
use crate::lane::{Bits, F32x8, Lane, Mask, Mask8};
use crate::math::{Hit, MISS, Vec3};
use crate::primitives::Surface;
use crate::rays::Kind;

/// The lanes of the pass. AOVs are the same at any width.
type L = F32x8;
type B = <L as Lane>::Bits;
pub(super) const ALL: u64 = Features::ALL.0;

/// One variable of every pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plane {
    /// The distance along the ray from the camera; infinite if the ray hits nothing.
    Distance,
    /// The x of the unit shading normal, which faces the camera; zero if there is no surface.
    NormalX,
    /// The y of the shading normal.
    NormalY,
    /// The z of the shading normal.
    NormalZ,
    /// The red of the albedo, textures included, in [0, 1]. For emissive surfaces and the environment it is
    /// the radiance, scaled down if a channel is above 1.
    AlbedoRed,
    /// The green of the albedo.
    AlbedoGreen,
    /// The blue of the albedo.
    AlbedoBlue,
    /// The barycentric weight of a triangle's second vertex; 0 elsewhere.
    WeightU,
    /// The barycentric weight of a triangle's third vertex; 0 elsewhere.
    WeightV,
    /// The width of the lobe, in [0, 1]: alpha (the square of the roughness) for metal, rough glass and the
    /// metallic share of metal-rough, roughness for the fuzzy mirror; 0 for mirrors and glass; 1 for every
    /// other surface and share, and for pixels without a surface.
    Lobe,
    /// Radiance over albedo for emitters and the environment; −1 for surfaces that scatter and emit, whose
    /// radiance is not known; 0 for every other surface.
    Scale,
    /// The bits of [`AovSample::object`].
    Object,
}

const PLANES: usize = Plane::Object as usize + 1;

impl Plane {
    /// All planes in their order.
    pub const ALL: [Self; PLANES] = [
        Self::Distance,
        Self::NormalX,
        Self::NormalY,
        Self::NormalZ,
        Self::AlbedoRed,
        Self::AlbedoGreen,
        Self::AlbedoBlue,
        Self::WeightU,
        Self::WeightV,
        Self::Lobe,
        Self::Scale,
        Self::Object,
    ];
}

/// The surface at the centre of a pixel: see [`Plane`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AovSample {
    /// The distance from the camera; infinite for a miss.
    pub distance: f32,
    /// The shading normal; zero for a miss.
    pub normal: glam::Vec3,
    /// The reflectance in linear RGB.
    pub albedo: [f32; 3],
    /// The barycentric weights of a triangle's second and third vertex.
    pub weights: [f32; 2],
    /// The width of the lobe: see [`Plane::Lobe`].
    pub lobe: f32,
    /// The object id, the same on one sphere, or on all triangles of one material; [`MISS`] if there is no
    /// surface.
    pub object: u32,
}

/// The AOVs of a picture: row by row, in each row plane by plane, so that filters load whole packets.
#[derive(Clone, Debug, Default)]
pub struct Aovs {
    resolution: [u32; 2],
    /// The distance from one plane of a row to the next: a packet more than pixels, so that the last packet
    /// may be loaded and stored whole.
    stride: usize,
    values: Vec<f32>,
}

impl Aovs {
    pub(super) const PLANES: usize = PLANES;

    /// Changes the size; allocates only if the picture grows. The values are unspecified afterwards.
    pub fn resize(&mut self, resolution: [u32; 2]) {
        let [width, height] = resolution.map(|side| side as usize);
        self.resolution = resolution;
        self.stride = width + L::WIDTH;
        self.values.resize(self.stride * PLANES * height, 0.0);
    }
    /// Returns the width and height in pixels.
    pub fn resolution(&self) -> [u32; 2] {
        self.resolution
    }
    /// Returns one plane of a row of pixels, from the left.
    #[inline(always)]
    pub fn row(&self, plane: Plane, y: u32) -> &[f32] {
        let start = (y as usize * PLANES + plane as usize) * self.stride;
        &self.values[start..start + self.resolution[0] as usize]
    }
    /// Returns one plane of a row of pixels, to be changed.
    pub(crate) fn row_mut(&mut self, plane: Plane, y: u32) -> &mut [f32] {
        let start = (y as usize * PLANES + plane as usize) * self.stride;
        &mut self.values[start..start + self.resolution[0] as usize]
    }
    /// Returns [`AovSample::object`] of a row of pixels.
    #[inline(always)]
    pub fn objects(&self, y: u32) -> &[u32] {
        bytemuck::cast_slice(self.row(Plane::Object, y))
    }
    /// Returns the sample of a pixel.
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
    /// Copies the size and the values of another picture.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        (self.resolution, self.stride) = (other.resolution, other.stride);
        self.values.clear();
        self.values.extend_from_slice(&other.values);
    }
    /// Returns the length of a row, and all rows, for [`render_row`].
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
        closest_seen(context, scratch, 0..count, RayKind::Primary, true);
        for at in (0..count).step_by(L::WIDTH) {
            for (plane, values) in aovs(context, scratch, at, count).into_iter().enumerate() {
                values.store(&mut row[plane * stride + left + at..]);
            }
        }
    }
}

/// Returns the planes of the packet at `at`.
fn aovs(context: &TraceContext, scratch: &Scratch, at: usize, count: usize) -> [L; PLANES] {
    let cone = context.primary_cone::<L, ALL>();
    let (ray, key) = (context.primary_ray::<L, ALL>(&scratch.queue, at), scratch.queue.primary::<L>(at).1);
    let path = Path::primary(ray, key, B::splat(0), cone);
    Seen::of(context, &path, &scratch.queue.hit(at), <L as Lane>::Mask::first(count - at))
        .planes(context, key)
}

/// The surfaces or the environment that a packet of rays sees.
pub(super) struct Seen {
    hit: Hit<L>,
    pub found: Mask8,
    /// The surfaces and their materials, if some lane is in `found`.
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
            let surface = context.surface::<_, ALL>(path, hit, found);
            let material = MaterialSample::of::<ALL>(context, &surface, found);
            let is = |kind: u32| material.kind.equals(B::splat(kind));
            let (emitted, of_emitter) = displayable(material.emission);
            let color = Vec3::select(is(MaterialCode::EMITTER), emitted, material.color);
            let of_color = of_emitter.only(is(MaterialCode::EMITTER));
            let away = zero.lt(material.ns.dot(direction));
            let facing = Vec3::select(away, -material.ns, material.ns);
            let width = material.roughness_or_ior.min(one);
            let is_rough = is(MaterialCode::GGX) | is(MaterialCode::ROUGH_GLASS);
            let width = L::select(is_rough | is(MaterialCode::FUZZY_MIRROR), width, one);
            let width = L::select(is(MaterialCode::MIRROR) | is(MaterialCode::GLASS), zero, width);
            // The dielectric's base is diffuse.
            let metallic = material.transmitted;
            let metal_rough = metallic.mul_add(material.roughness_or_ior, one - metallic);
            let width = L::select(is(MaterialCode::METAL_ROUGH), metal_rough, width);
            seen.normal = Vec3::select(found, facing, normal);
            seen.albedo = Vec3::select(found, color, seen.albedo);
            let emission = material.emission.x + material.emission.y + material.emission.z;
            let glows = zero.lt(emission) & !is(MaterialCode::EMITTER);
            seen.scale = L::select(found, L::select(glows, -one, of_color), seen.scale);
            seen.lobe = L::select(found, width, lobe);
            seen.object = B::select(found, surface.object(&context.primitives, hit), object);
            seen.surface = Some((surface, material));
        }
        seen
    }

    /// Returns the planes of paths with these keys: see [`CHOSEN`].
    fn planes(&self, context: &TraceContext, key: B) -> [L; PLANES] {
        let Self { hit, found, normal, albedo, scale, lobe, object, .. } = self;
        let distance = L::select(*found, hit.t, L::splat(f32::INFINITY));
        let on_triangle = *found & context.primitives.ranges.are_of_kind(Kind::Triangle, hit.primitive);
        let weight = |weight| L::select(on_triangle, weight, L::zero());
        let (is_noisy, zero) = (!(key & B::splat(CHOSEN)).equals(B::splat(0)), L::zero());
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
            L::select(is_noisy & zero.lt(*scale), zero, *scale),
            L::from_bits(*object),
        ]
    }
}

/// Returns radiance scaled so that no channel is above 1, and one over that scale.
fn displayable(radiance: Vec3<L>) -> (Vec3<L>, L) {
    let most = radiance.x.max(radiance.y).max(radiance.z).max(L::one());
    (radiance * (L::one() / most), most)
}
