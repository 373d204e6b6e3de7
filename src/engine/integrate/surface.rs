//! What the shading stages need to know about a hit: where, which way the surface faces, what it has_lobe.

use super::World;
use super::queue::Path;
use crate::buffers::{Abilities, Features, MaterialCode};
use crate::kernel::surface::{latitude_longitude, sphere_normal};
use crate::kernel::{light, normals};
use crate::lane::{Bits, Lane, Mask};
use crate::math::{Hit, Ray, Vec3};
use crate::scene::TexelKind;

/// Does the feature set `N` hold this feature? Constant for the compiler.
#[inline(always)]
pub const fn has(n: u32, feature: Features) -> bool {
    Features(n).contains(feature)
}

/// What of textures the feature set `N` holds.
#[inline(always)]
pub const fn abilities(n: u32) -> Abilities {
    Abilities { bilinear: has(n, Features::BILINEAR), linear: has(n, Features::LINEAR_TEXTURES) }
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
    pub light_pdf: L,
}

impl<L: Lane> Surface<L> {
    /// Looks up the surfaces of the lanes in `found`; the others are unspecified.
    #[inline(always)]
    pub fn of<const N: u32>(world: &World, path: &Path<L>, hit: &Hit<L>, found: L::Mask) -> Self {
        let spheres = L::Bits::splat(world.buffers.spheres.len() as u32);
        let zero = L::Bits::splat(0);
        let is_sphere = match (has(N, Features::SPHERES), has(N, Features::TRIANGLES)) {
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
            light_pdf: L::zero(),
        };
        if has(N, Features::SPHERES) && (!has(N, Features::TRIANGLES) || (found & is_sphere).any()) {
            let index = L::Bits::select(found & is_sphere, hit.primitive, zero);
            surface.set_sphere::<N>(world, path, hit, index);
        }
        if has(N, Features::TRIANGLES) && (!has(N, Features::SPHERES) || (found & !is_sphere).any()) {
            surface.set_triangle::<N>(world, path, hit);
        }
        surface
    }

    /// A number for what is seen as one thing: each sphere, and all triangles of a material.
    #[inline(always)]
    pub fn object(&self, world: &World, hit: &Hit<L>) -> L::Bits {
        let of_material = self.material.wrapping_add(L::Bits::splat(world.buffers.spheres.len() as u32));
        L::Bits::select(self.is_sphere, hit.primitive, of_material)
    }

    #[inline(always)]
    fn set_sphere<const N: u32>(&mut self, world: &World, path: &Path<L>, hit: &Hit<L>, index: L::Bits) {
        let few = !has(N, Features::MANY_SPHERES);
        let [x, y, z, radius, offset, material, turn, chance] =
            world.buffers.sphere_rows.fetch::<L>(index, few);
        let center = Vec3::new(x, y, z);
        self.outward = sphere_normal(path.ray.at(hit.t), center);
        self.point = self.outward.mul_add(radius, center);
        self.offset = offset;
        self.material = material.to_bits();
        self.turn = turn;
        if has(N, Features::LIGHTS) && L::zero().lt(chance).any() {
            self.light_pdf = chance * light::sphere_pdf(center - path.ray.origin, radius);
        }
    }

    /// Overwrites the lanes on triangles.
    #[inline(always)]
    fn set_triangle<const N: u32>(&mut self, world: &World, path: &Path<L>, hit: &Hit<L>) {
        let few = !has(N, Features::MANY_TRIANGLES);
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
        if has(N, Features::LIGHTS) {
            let mut density = L::zero();
            if (!keep & L::zero().lt(chance)).any() {
                let Ray { origin, direction } = path.ray;
                let a = Vec3::new(ax, ay, az) - origin;
                density = chance * light::triangle_pdf(a, ab, ac, direction, hit.t);
            }
            // Triangles that are no lamps too: their lanes hold what some sphere would have there.
            self.light_pdf = L::select(keep, self.light_pdf, density);
        }
    }

    /// The blended vertex normals of the lanes in `found`, and where there are some; elsewhere the surfaces' own.
    #[inline(always)]
    fn smooth_normal<const N: u32>(&self, world: &World, found: L::Mask) -> (Vec3<L>, L::Mask) {
        let on_triangle = found & !self.is_sphere;
        if !on_triangle.any() {
            return (self.outward, L::Mask::splat(false));
        }
        let few = !has(N, Features::MANY_TRIANGLES);
        let first = self.triangle.shl(1);
        let second = first | L::Bits::splat(1);
        let [ax, ay, az, bx, by, bz, ..] = world.buffers.normal_rows.fetch::<L>(first, few);
        let [cx, cy, cz, ..] = world.buffers.normal_rows.fetch::<L>(second, few);
        let corners = [Vec3::new(ax, ay, az), Vec3::new(bx, by, bz), Vec3::new(cx, cy, cz)];
        let (normal, some) = normals::interpolate(corners, self.barycentric, self.outward);
        let bent = on_triangle & some;
        (Vec3::select(bent, normal, self.outward), bent)
    }

    /// The direction of growing u in the lanes of `mapped`, and the hand of the frame (see [`normals::apply_normal_map`]).
    #[inline(always)]
    fn tangent<const N: u32>(&self, world: &World, mapped: L::Mask) -> (Vec3<L>, L) {
        let (mut tangent, mut hand) = (Vec3::zero(), L::zero());
        if has(N, Features::SPHERES) && (mapped & self.is_sphere).any() {
            let inside = self.turn.to_bits().shr(31).equals(L::Bits::splat(0));
            (tangent, hand) = normals::sphere_tangent(self.outward, inside);
        }
        let on_triangle = mapped & !self.is_sphere;
        if has(N, Features::TRIANGLES) && on_triangle.any() {
            let few = !has(N, Features::MANY_TRIANGLES);
            let index = L::Bits::select(on_triangle, self.triangle, L::Bits::splat(0));
            let [x, y, z, w, ..] = world.buffers.tangent_rows.fetch::<L>(index, few);
            tangent = Vec3::select(self.is_sphere, tangent, Vec3::new(x, y, z));
            hand = L::select(self.is_sphere, hand, w);
        }
        (tangent, hand)
    }

    /// Texture coordinates of the lanes in `textured`.
    #[inline(always)]
    fn texture_coordinates<const N: u32>(&self, world: &World, textured: L::Mask) -> Coordinates<L> {
        let mut coordinates = (L::zero(), L::zero());
        if has(N, Features::SPHERES) && (textured & self.is_sphere).any() {
            let (u, v) = latitude_longitude(self.outward);
            coordinates = (u.flip_sign(self.turn) + self.turn, v);
        }
        if has(N, Features::TRIANGLES) && (textured & !self.is_sphere).any() && world.buffers.has_uvs {
            let few = !has(N, Features::MANY_TRIANGLES);
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
pub struct MaterialSample<L: Lane> {
    /// One of [`MaterialCode`]'s kinds.
    pub kind: L::Bits,
    pub color: Vec3<L>,
    pub parameter: L,
    pub emission: Vec3<L>,
    /// Plastic's index of refraction, and how much its coat lets in.
    pub ior: L,
    pub transmitted: L,
    /// Unit normal for scattering, about on the outward side, where `bent`.
    pub normal: Vec3<L>,
    /// Where that is another one than the surface's own.
    pub bent: L::Mask,
}

impl<L: Lane> MaterialSample<L> {
    /// The materials of the lanes in `found`; the others are unspecified.
    #[inline(always)]
    pub fn of<const N: u32>(world: &World, surface: &Surface<L>, found: L::Mask) -> Self {
        let few = !has(N, Features::MANY_MATERIALS);
        let index = L::Bits::select(found, surface.material, L::Bits::splat(0));
        let [r, g, b, parameter, er, eg, eb, code] = world.buffers.material_rows.fetch::<L>(index, few);
        let code = code.to_bits();
        let mut material = Self {
            kind: code & L::Bits::splat(MaterialCode::KIND),
            color: Vec3::new(r, g, b),
            parameter,
            emission: Vec3::new(er, eg, eb),
            ior: L::one(),
            transmitted: L::one(),
            normal: surface.outward,
            bent: L::Mask::splat(false),
        };
        if has(N, Features::SMOOTH_NORMALS) && world.buffers.needs.contains(Features::SMOOTH_NORMALS) {
            (material.normal, material.bent) = surface.smooth_normal::<N>(world, found);
        }
        let none = L::Bits::splat(0);
        let (mut roughness_map, mut normal_map) = (none, none);
        if Features(N).meets(Features::DETAILS) && world.buffers.needs.meets(Features::DETAILS) {
            let [ior, transmitted, roughness, normal, ..] = world.buffers.detail_rows.fetch::<L>(index, few);
            (material.ior, material.transmitted) = (ior, transmitted);
            (roughness_map, normal_map) = (roughness.to_bits(), normal.to_bits());
        }
        if Features(N).meets(PICTURES) {
            let texture = code.shr(MaterialCode::TEXTURE_SHIFT);
            let pictured = found & !(texture | roughness_map | normal_map).equals(none);
            if pictured.any() {
                let coordinates = surface.texture_coordinates::<N>(world, pictured);
                material.apply_color_texture::<N>(world, coordinates, found, texture);
                material.apply_roughness_map::<N>(world, coordinates, found, roughness_map);
                material.apply_normal_map::<N>(world, surface, coordinates, found, normal_map);
            }
        }
        material
    }

    /// Applies the pictures of colour; `code` is index + 1, 0 for none.
    #[inline(always)]
    fn apply_color_texture<const N: u32>(
        &mut self,
        world: &World,
        at: Coordinates<L>,
        found: L::Mask,
        code: L::Bits,
    ) {
        if !has(N, Features::TEXTURES) {
            return;
        }
        let textured = found & !code.equals(L::Bits::splat(0));
        if textured.any() {
            let texel = texel::<L, N>(world, at, textured, code, TexelKind::Color);
            let texel = Vec3::select(textured, texel, Vec3::repeat(L::one()));
            let shines = self.kind.equals(L::Bits::splat(MaterialCode::EMITTER));
            self.emission = Vec3::select(shines, self.emission * texel, self.emission);
            self.color = self.color * texel;
        }
    }

    /// Multiplies roughness, which is the parameter of `scatter` and the root of everybody else's.
    #[inline(always)]
    fn apply_roughness_map<const N: u32>(
        &mut self,
        world: &World,
        at: Coordinates<L>,
        found: L::Mask,
        code: L::Bits,
    ) {
        let mapped = found & !code.equals(L::Bits::splat(0));
        if has(N, Features::ROUGHNESS_MAPS) && mapped.any() {
            let factor = texel::<L, N>(world, at, mapped, code, TexelKind::Data).x.min(L::one());
            let scatters = self.kind.equals(L::Bits::splat(MaterialCode::SCATTER));
            let factor = L::select(scatters, factor, factor * factor);
            self.parameter = L::select(mapped, self.parameter * factor, self.parameter);
        }
    }

    #[inline(always)]
    fn apply_normal_map<const N: u32>(
        &mut self,
        world: &World,
        surface: &Surface<L>,
        at: Coordinates<L>,
        found: L::Mask,
        code: L::Bits,
    ) {
        let mapped = found & !code.equals(L::Bits::splat(0));
        if has(N, Features::NORMAL_MAPS) && mapped.any() {
            let texel = texel::<L, N>(world, at, mapped, code, TexelKind::Data);
            let (tangent, hand) = surface.tangent::<N>(world, mapped);
            let (normal, some) = normals::apply_normal_map(texel, self.normal, tangent, hand);
            let mapped = mapped & some;
            self.normal = Vec3::select(mapped, normal, self.normal);
            self.bent = self.bent | mapped;
        }
    }
}

/// What looks up textures on surfaces.
const PICTURES: Features = Features::TEXTURES.with(Features::ROUGHNESS_MAPS).with(Features::NORMAL_MAPS);

/// Texture coordinates, v from the top, and where v must not wrap.
type Coordinates<L> = ((L, L), <L as Lane>::Mask);

/// The texels of the lanes in `wanted`; `code` is index + 1.
#[inline(always)]
fn texel<L: Lane, const N: u32>(
    world: &World,
    (coordinates, clamp_v): Coordinates<L>,
    wanted: L::Mask,
    code: L::Bits,
    texel_kind: TexelKind,
) -> Vec3<L> {
    let index = code.wrapping_add(L::Bits::splat(u32::MAX));
    world.buffers.textures.sample(index, coordinates, clamp_v, wanted, abilities(N), texel_kind)
}
