//! What the shading stages need to know about a hit: where, which way the surface faces, what it wears.

use super::World;
use super::queue::Path;
use crate::buffers::{Abilities, MaterialCode, Needs};
use crate::kernel::light;
use crate::kernel::surface::{latitude_longitude, sphere_normal};
use crate::lane::{Bits, Lane, Mask};
use crate::math::{Hit, Ray, Vec3};

/// Does the feature set `N` hold this feature? Constant for the compiler.
#[inline(always)]
pub const fn needs(n: u32, feature: Needs) -> bool {
    Needs(n).contains(feature)
}

/// What of textures the feature set `N` holds.
#[inline(always)]
pub const fn abilities(n: u32) -> Abilities {
    Abilities { bilinear: needs(n, Needs::BILINEAR), linear: needs(n, Needs::LINEAR_TEXTURES) }
}

/// The surfaces under a packet's hits.
pub struct Surface<L: Lane> {
    /// On the surface as exactly as floats allow.
    pub point: Vec3<L>,
    /// Unit normal: outward on spheres, by the order of the vertices on triangles.
    pub outward: Vec3<L>,
    /// How far leaving rays must start from the surface.
    pub offset: L,
    /// Index of the material.
    pub material: L::Bits,
    is_sphere: L::Mask,
    /// Index of the triangle, where it is one.
    triangle: L::Bits,
    turn: L,
    barycentric: (L, L),
    /// The density with which light sampling at the ray's origin draws the ray's direction, in 1/sr; 0 where it never does.
    pub light_density: L,
}

impl<L: Lane> Surface<L> {
    /// Looks up the surfaces of the lanes in `found`; the others are unspecified.
    #[inline(always)]
    pub fn of<const N: u32>(world: &World, path: &Path<L>, hit: &Hit<L>, found: L::Mask) -> Self {
        let spheres = L::Bits::splat(world.buffers.spheres.len() as u32);
        let zero = L::Bits::splat(0);
        let is_sphere = match (needs(N, Needs::SPHERES), needs(N, Needs::TRIANGLES)) {
            (true, true) => hit.primitive.less(spheres),
            (sphere, _) => L::Mask::splat(sphere),
        };
        let triangle =
            L::Bits::select(found & !is_sphere, hit.primitive.wrapping_add(negative(spheres)), zero);
        let mut surface = Self {
            point: Vec3::zero(),
            outward: Vec3::zero(),
            offset: L::zero(),
            material: zero,
            is_sphere,
            triangle,
            turn: L::zero(),
            barycentric: (hit.u, hit.v),
            light_density: L::zero(),
        };
        if needs(N, Needs::SPHERES) && (!needs(N, Needs::TRIANGLES) || (found & is_sphere).any()) {
            let index = L::Bits::select(found & is_sphere, hit.primitive, zero);
            surface.set_sphere::<N>(world, path, hit, index);
        }
        if needs(N, Needs::TRIANGLES) && (!needs(N, Needs::SPHERES) || (found & !is_sphere).any()) {
            surface.set_triangle::<N>(world, path, hit);
        }
        surface
    }

    #[inline(always)]
    fn set_sphere<const N: u32>(&mut self, world: &World, path: &Path<L>, hit: &Hit<L>, index: L::Bits) {
        let few = !needs(N, Needs::MANY_SPHERES);
        let [x, y, z, radius, offset, material, turn, chance] =
            world.buffers.sphere_rows.fetch::<L>(index, few);
        let center = Vec3::new(x, y, z);
        self.outward = sphere_normal(path.ray.at(hit.t), center);
        self.point = self.outward.mul_add(radius, center);
        self.offset = offset;
        self.material = material.to_bits();
        self.turn = turn;
        if needs(N, Needs::LIGHTS) && L::zero().lt(chance).any() {
            self.light_density = chance * light::sphere_density(center - path.ray.origin, radius);
        }
    }

    /// Overwrites the lanes on triangles.
    #[inline(always)]
    fn set_triangle<const N: u32>(&mut self, world: &World, path: &Path<L>, hit: &Hit<L>) {
        let few = !needs(N, Needs::MANY_TRIANGLES);
        let first = self.triangle.shl(1);
        let [ax, ay, az, abx, aby, abz, offset, material] =
            world.buffers.triangle_rows.fetch::<L>(first, few);
        let second = first | L::Bits::splat(1);
        let [acx, acy, acz, nx, ny, nz, chance, _] = world.buffers.triangle_rows.fetch::<L>(second, few);
        let (u, v) = self.barycentric;
        let (ab, ac) = (Vec3::new(abx, aby, abz), Vec3::new(acx, acy, acz));
        let point = ab.mul_add(u, ac.mul_add(v, Vec3::new(ax, ay, az)));
        let keep = self.is_sphere;
        self.point = Vec3::select(keep, self.point, point);
        self.outward = Vec3::select(keep, self.outward, Vec3::new(nx, ny, nz));
        self.offset = L::select(keep, self.offset, offset);
        self.material = L::Bits::select(keep, self.material, material.to_bits());
        if needs(N, Needs::LIGHTS) && (!keep & L::zero().lt(chance)).any() {
            let Ray { origin, direction } = path.ray;
            let a = Vec3::new(ax, ay, az) - origin;
            let density = chance * light::triangle_density(a, ab, ac, direction, hit.t);
            self.light_density = L::select(keep, self.light_density, density);
        }
    }

    /// Texture coordinates of the lanes in `textured`, v from the top, and where v must not wrap.
    #[inline(always)]
    fn texture_coordinates<const N: u32>(&self, world: &World, textured: L::Mask) -> ((L, L), L::Mask) {
        let mut coordinates = (L::zero(), L::zero());
        if needs(N, Needs::SPHERES) && (textured & self.is_sphere).any() {
            let (u, v) = latitude_longitude(self.outward);
            coordinates = (u.flip_sign(self.turn) + self.turn, v);
        }
        if needs(N, Needs::TRIANGLES) && (textured & !self.is_sphere).any() && world.buffers.has_uvs {
            let few = !needs(N, Needs::MANY_TRIANGLES);
            let [au, av, bu, bv, cu, cv, ..] = world.buffers.uv_rows.fetch::<L>(self.triangle, few);
            let (u, v) = self.barycentric;
            let blend = |a: L, b: L, c: L| (b - a).mul_add(u, (c - a).mul_add(v, a));
            let keep = self.is_sphere;
            coordinates.0 = L::select(keep, coordinates.0, blend(au, bu, cu));
            coordinates.1 = L::select(keep, coordinates.1, blend(av, bv, cv));
        }
        (coordinates, self.is_sphere)
    }
}

#[inline(always)]
fn negative<B: Bits>(x: B) -> B {
    (!x).wrapping_add(B::splat(1))
}

/// What the surfaces wear, textures looked up.
pub struct Worn<L: Lane> {
    /// One of [`MaterialCode`]'s kinds.
    pub kind: L::Bits,
    pub color: Vec3<L>,
    pub parameter: L,
    pub emission: Vec3<L>,
    /// Plastic's index of refraction, and how much its coat lets in.
    pub ior: L,
    pub transmitted: L,
}

impl<L: Lane> Worn<L> {
    /// The materials of the lanes in `found`; the others are unspecified.
    #[inline(always)]
    pub fn of<const N: u32>(world: &World, surface: &Surface<L>, found: L::Mask) -> Self {
        let few = !needs(N, Needs::MANY_MATERIALS);
        let index = L::Bits::select(found, surface.material, L::Bits::splat(0));
        let [r, g, b, parameter, er, eg, eb, code] = world.buffers.material_rows.fetch::<L>(index, few);
        let code = code.to_bits();
        let kind = code & L::Bits::splat(MaterialCode::KIND);
        let (color, emission) = (Vec3::new(r, g, b), Vec3::new(er, eg, eb));
        let (ior, transmitted) = (L::one(), L::one());
        let mut worn = Self { kind, color, parameter, emission, ior, transmitted };
        if needs(N, Needs::PLASTIC) && world.buffers.needs.contains(Needs::PLASTIC) {
            [worn.ior, worn.transmitted, ..] = world.buffers.detail_rows.fetch::<L>(index, few);
        }
        if needs(N, Needs::TEXTURES) {
            let texture = code.shr(MaterialCode::TEXTURE_SHIFT);
            let textured = found & !texture.equals(L::Bits::splat(0));
            if textured.any() {
                let (coordinates, clamp_v) = surface.texture_coordinates::<N>(world, textured);
                let index = texture.wrapping_add(L::Bits::splat(u32::MAX));
                let textures = &world.buffers.textures;
                let texel = textures.sample(index, coordinates, clamp_v, textured, abilities(N));
                let texel = Vec3::select(textured, texel, Vec3::repeat(L::one()));
                let shines = kind.equals(L::Bits::splat(MaterialCode::EMITTER));
                worn.emission = Vec3::select(shines, worn.emission * texel, worn.emission);
                worn.color = worn.color * texel;
            }
        }
        worn
    }
}
