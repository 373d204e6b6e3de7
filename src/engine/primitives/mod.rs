//! The kinds of primitives in shading: their tables, the surfaces at hits, and their light.
//!
//! Each kind is a file. The code that distinguishes kinds is in this one and, for kinds of lights, in
//! [`light`]; both name every kind, so that the compiler finds each place when one is added.
//!
//! Shapes: `WIDTH` hits, or lit points with a light each; vectors of samples are relative to the lit point.
//! Domain: u and v are uniform in [0, 1).

pub mod flat;
pub mod light;
pub mod sphere;
pub mod triangle;

pub use flat::FlatLight;
pub use light::{ChosenLight, LightKinds, LightSample, LightTable, SampledAs, SampledPrimitives};
pub use sphere::SphereRow;
pub use triangle::TriangleRow;

use crate::buffers::block_means::BlockMeans;
use crate::buffers::rows::Rows;
use crate::buffers::{Features, has};
use crate::kernel::ray_cone::{self, Cone};
use crate::kernel::texture::TexturePoint;
use crate::lane::{Bits, Lane, Mask};
use crate::math::{Hit, Ray, Vec3};
use crate::rays::{Kind, KindRanges};
use crate::scene::{Primitive, Scene};
use glam::DVec3;
use light::LightRow;
use sphere::OnSphere;
use triangle::{OnTriangle, TriangleTables};

/// The primitives of a scene in the form that shading reads.
pub struct PrimitiveTables {
    /// The number ranges of each kind of primitive.
    pub ranges: KindRanges,
    /// The numbers of primitives that are objects of their own: see [`Surface::object`].
    objects: u32,
    /// One row of eight per sphere: see [`SphereRow`].
    pub spheres: Rows,
    /// The tables of triangles.
    pub triangles: TriangleTables,
}

impl PrimitiveTables {
    /// Flattens the primitives of a scene. `light` returns how the primitive with a number is sampled.
    pub fn new(scene: &Scene, light: impl Fn(usize) -> SampledAs) -> Self {
        Self {
            ranges: KindRanges::new(scene.counts()),
            objects: scene.spheres.len() as u32,
            spheres: sphere::rows(scene, &light),
            triangles: TriangleTables::new(scene, &light),
        }
    }

    /// Returns the index of the material of an object: see [`Surface::object`].
    pub(crate) fn material_of_object(&self, scene: &Scene, object: u32) -> u32 {
        match object.checked_sub(self.objects) {
            Some(material) => material,
            None => scene.primitive(object as usize).material(),
        }
    }
}

/// Returns the power that a primitive emits on all sides at a radiance of 1.
pub(crate) fn unit_power(primitive: Primitive) -> f64 {
    match primitive {
        Primitive::Sphere(sphere) => sphere::unit_power(sphere),
        Primitive::Triangle(triangle) => flat::unit_power(triangle),
    }
}

/// Returns the weighted sum of a texture's texels over a primitive, and the sum of the weights. Returns
/// `None` if the primitive has no texture coordinates.
pub(crate) fn sum_of_texels(scene: &Scene, number: usize, texture: &BlockMeans) -> Option<(DVec3, f64)> {
    match scene.counts().place(number) {
        (Kind::Sphere, _) => Some(sphere::sum_of_texels(texture)),
        (Kind::Triangle, index) => scene.uvs.get(index).map(|uvs| flat::sum_of_texels(texture, uvs)),
    }
}

/// Returns the rows of a whole primitive as a light with this power.
pub(crate) fn light_rows(primitive: Primitive, power: f64) -> (LightRow, [f32; 8]) {
    match primitive {
        Primitive::Sphere(sphere) => sphere::light(sphere, power),
        Primitive::Triangle(triangle) => flat::Flat::new(triangle, None).light(power),
    }
}

/// The tables that look-ups of surfaces read.
pub struct SurfaceTables<'a> {
    /// The primitives.
    pub primitives: &'a PrimitiveTables,
    /// The lights.
    pub lights: &'a LightTable,
    /// Whether paths carry ray cones.
    pub cones: bool,
}

/// The lanes whose hit is on a primitive of each kind. If the pipeline has one kind, all lanes are of it.
#[derive(Clone, Copy)]
struct HitKinds<L: Lane>([L::Mask; Kind::ALL.len()]);

impl<L: Lane> HitKinds<L> {
    #[inline(always)]
    fn of<const N: u64>(ranges: KindRanges, primitive: L::Bits) -> Self {
        let mut kinds = [L::Mask::splat(false); Kind::ALL.len()];
        for (kind, lanes) in Kind::ALL.into_iter().zip(&mut kinds) {
            if Features(N).has_only_kind(kind) {
                *lanes = L::Mask::splat(true);
            } else if has(N, Features::of_kind(kind)) {
                *lanes = ranges.are_of_kind(kind, primitive);
            }
        }
        Self(kinds)
    }
}

/// The surfaces at a packet's hits.
pub struct Surface<L: Lane> {
    /// The point on the surface, as exactly as floats allow.
    pub point: Vec3<L>,
    /// The unit geometric normal: outward on spheres, by the order of the vertices on triangles.
    pub ng: Vec3<L>,
    /// The distance from the surface at which spawned rays must start.
    pub offset: L,
    /// The index of the material.
    pub material: L::Bits,
    kinds: HitKinds<L>,
    sphere: OnSphere<L>,
    triangle: OnTriangle<L>,
    /// The cosine at which the ray arrives; negative from behind `ng`.
    pub facing: L,
    /// The width of the ray cone at the hit; 0 unless paths carry cones.
    pub cone_width: L,
    /// The pdf with which light sampling at the ray's origin samples the ray's direction, in 1/sr; 0 if it
    /// never does.
    pub light_pdf: L,
}

impl<L: Lane> Surface<L> {
    /// Looks up the surfaces of the lanes in `found`; the others are unspecified.
    #[inline(always)]
    pub fn of<const N: u64>(
        tables: &SurfaceTables,
        (ray, cone): (&Ray<L>, &Cone<L>),
        hit: &Hit<L>,
        found: L::Mask,
    ) -> Self {
        let (ranges, zero) = (tables.primitives.ranges, L::Bits::splat(0));
        let kinds = HitKinds::of::<N>(ranges, hit.primitive);
        let HitKinds([sphere, triangle]) = kinds;
        let occurs = |kind: Kind, lanes: L::Mask| {
            let is_there = || Features(N).has_only_kind(kind) || (found & lanes).any();
            has(N, Features::of_kind(kind)) && is_there()
        };
        let index = ranges.index_in_kind(Kind::Triangle, hit.primitive);
        let index = L::Bits::select(found & triangle, index, zero);
        let mut surface = Self {
            point: Vec3::zero(),
            ng: Vec3::zero(),
            offset: L::zero(),
            material: zero,
            kinds,
            sphere: OnSphere::default(),
            triangle: OnTriangle::new(index, hit),
            facing: L::zero(),
            cone_width: L::zero(),
            light_pdf: L::zero(),
        };
        if occurs(Kind::Sphere, sphere) {
            surface.set_sphere::<N>(tables, ray, hit, found & sphere);
        }
        if occurs(Kind::Triangle, triangle) {
            surface.set_triangle::<N>(tables, ray, hit);
        }
        surface.facing = -ray.direction.dot(surface.ng);
        if tables.cones {
            surface.cone_width = cone.width_at(hit.t);
        }
        surface
    }

    /// Returns the object id: one for each sphere, and one for all triangles of a material.
    #[inline(always)]
    pub fn object(&self, primitives: &PrimitiveTables, hit: &Hit<L>) -> L::Bits {
        let of_material = self.material.wrapping_add(L::Bits::splat(primitives.objects));
        let HitKinds([sphere, _triangle]) = self.kinds;
        L::Bits::select(sphere, hit.primitive, of_material)
    }

    /// Returns the tangent along growing u in the lanes of `mapped`, and the frame's handedness: +1 if v
    /// grows along normal × tangent, −1 if against it.
    #[inline(always)]
    pub fn tangent<const N: u64>(&self, primitives: &PrimitiveTables, mapped: L::Mask) -> (Vec3<L>, L) {
        let mut frame = (Vec3::zero(), L::zero());
        let HitKinds([sphere, triangle]) = self.kinds;
        if has(N, Features::SPHERES) && (mapped & sphere).any() {
            frame = self.sphere_tangent();
        }
        let on_triangle = mapped & triangle;
        if has(N, Features::TRIANGLES) && on_triangle.any() {
            frame = self.triangle_tangent::<N>(primitives, on_triangle, frame);
        }
        frame
    }

    /// Returns the points at which textures are read in the lanes of `textured`.
    #[inline(always)]
    pub fn texture_point<const N: u64>(&self, tables: &SurfaceTables, textured: L::Mask) -> TexturePoint<L> {
        let mut found = ((L::zero(), L::zero()), L::zero());
        let HitKinds([sphere, triangle]) = self.kinds;
        if has(N, Features::SPHERES) && (textured & sphere).any() {
            found = self.sphere_coordinates(tables);
        }
        let on_triangle = textured & triangle;
        if has(N, Features::TRIANGLES) && on_triangle.any() && tables.primitives.triangles.have_uvs() {
            found = self.triangle_coordinates::<N>(tables, found);
        }
        let ((u, v), density) = found;
        let mut footprint = L::zero();
        if tables.cones {
            footprint = ray_cone::footprint(self.cone_width, self.facing, density);
        }
        TexturePoint { u, v, clamp_v: sphere, footprint }
    }
}
