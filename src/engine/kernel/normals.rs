//! Shading normals: interpolated vertex normals, and those of normal maps.
//!
//! The geometric normal `ng` decides sides: which side a ray arrives on, and whether it leaves. The shading
//! normal `ns` only changes what happens there. It must cause neither light leaks nor black seams where one
//! of the two normals faces the light and the other does not.
//!
//! One rule for all lobes ([`super::bsdf::LobeNormals`]):
//!
//! - Specular lobes scatter about `ns`, turned towards the ray if it faces away ([`facing`]). Light that they
//!   send below the horizon leaves along the direction mirrored in the horizon's plane: mirrors and the
//!   roughest lobes lose nothing, and pdfs count both directions. Glass refracts below the surface by the
//!   same rule.
//! - Diffuse lobes scatter about `ns` from every view and under every coat. Samples below the horizon are
//!   absorbed, and light close above it is faded by [`shadow_terminator`].
//! - The horizon of delta lobes is the plane of `ng`. Other lobes use that of the interpolated normal, and
//!   their rays start on the suggested smooth surface ([`bulge`]; Hanika, "Hacking the Shadow Terminator",
//!   Ray Tracing Gems II ch. 4, 2021), so that coarse triangles show no edges in grazing light. Such a ray
//!   may hit the body that it leaves, from outside.
//!
//! `octray stability --only scattering-glossy` charts other rules: bent normals (Keller et al., "The Iray
//! Light Transport Simulation and Rendering System", 2017, §A.3) lose up to half of a rough lobe's light, and
//! a factor on all lobes (Chiang, Li, Burley, "Taming the Shadow Terminator", SIGGRAPH Talks 2019) makes
//! glossy ones black. Microfacets (Schüßler et al., "Microfacet-based Normal Mapping for Robust Monte Carlo
//! Path Tracing", 2017) return all light as mirroring does, by a second facet and more cases to sample.

use crate::lane::Lane;
use crate::math::Vec3;

/// The squared length below which a blend of normals has no direction, because opposite normals cancelled.
const MIN_LENGTH2: f32 = 1e-4;

/// Returns the unit vector along `v`, and the lanes in which there is one.
#[inline(always)]
fn try_normalize<L: Lane>(v: Vec3<L>) -> (Vec3<L>, L::Mask) {
    let length2 = v.dot(v);
    (v * (L::one() / length2.sqrt()), L::splat(MIN_LENGTH2).lt(length2))
}

/// Returns the interpolated normal, the unit vector along `blended` (the [`blend`] of vertex normals) on the
/// side of `ng`, and the lanes in which there is one: zero vectors mark flat triangles.
#[inline(always)]
pub fn interpolated<L: Lane>(blended: Vec3<L>, ng: Vec3<L>) -> (Vec3<L>, L::Mask) {
    let (ns, valid) = try_normalize(blended);
    (ns.flip_sign(ns.dot(ng)), valid)
}

/// Blends vertex normals at the barycentrics (u, v); the result has any length.
#[inline(always)]
pub fn blend<L: Lane>([a, b, c]: [Vec3<L>; 3], (u, v): (L, L)) -> Vec3<L> {
    (b - a).mul_add(u, (c - a).mul_add(v, a))
}

/// Returns the vector from a point of a triangle to the smooth surface that its vertex normals suggest:
/// towards the planes of the vertices that lie above the point, each by the weight of its vertex. It is zero
/// on the concave side, and if it would point below the triangle.
///
/// The edges are a to b and a to c. `ng` is the geometric normal on the side on which rays leave; the sign of
/// `side` is that of `ng` against the vertex normals.
///
/// Domain: unit normals. The result is no longer than the longest edge.
/// Source: Hanika, "Hacking the Shadow Terminator", Ray Tracing Gems II ch. 4, 2021.
#[inline(always)]
pub fn bulge<L: Lane>(
    normals: [Vec3<L>; 3],
    [ab, ac]: [Vec3<L>; 2],
    (u, v): (L, L),
    ng: Vec3<L>,
    side: L,
) -> Vec3<L> {
    let from_a = ab.mul_add(u, ac * v);
    let corners = [from_a, from_a - ab, from_a - ac].into_iter().zip([L::one() - u - v, u, v]);
    let mut bulge = Vec3::zero();
    for ((from_corner, weight), n) in corners.zip(normals) {
        let n = n.flip_sign(side);
        let below = (-from_corner.dot(n)).max(L::zero());
        bulge = n.mul_add(below * weight, bulge);
    }
    Vec3::select(bulge.dot(ng).lt(L::zero()), Vec3::zero(), bulge)
}

/// Returns the normal that a normal map's `texel` encodes in the tangent frame of the unit normal `n`, and
/// the lanes in which it encodes one. `tangent` points along growing u; `hand` is +1 if v grows along n ×
/// tangent, −1 if against it.
#[inline(always)]
pub fn apply_normal_map<L: Lane>(
    texel: Vec3<L>,
    n: Vec3<L>,
    tangent: Vec3<L>,
    hand: L,
) -> (Vec3<L>, L::Mask) {
    let (tangent, has_tangent) = try_normalize(n.mul_add(-tangent.dot(n), tangent));
    let bitangent = n.cross(tangent) * hand;
    let signed = |x: L| L::splat(2.0).mul_add(x, -L::one());
    let (x, y, z) = (signed(texel.x), signed(texel.y), signed(texel.z).max(L::zero()));
    let (normal, valid) = try_normalize(tangent.mul_add(x, bitangent.mul_add(y, n * z)));
    (normal, has_tangent & valid)
}

/// Returns the tangent frame of a sphere with outward normal `n`: the unit vector along growing u, and the
/// hand of [`apply_normal_map`]. The texture reads right from outside, or from inside in lanes of `inside`.
/// At the poles, where u is undefined, the tangent is x.
#[inline(always)]
pub fn sphere_tangent<L: Lane>(n: Vec3<L>, inside: L::Mask) -> (Vec3<L>, L) {
    let radius2 = n.x.mul_add(n.x, n.z * n.z);
    let pole = radius2.lt(L::splat(1e-12));
    let scale = L::one() / radius2.sqrt();
    let east = Vec3::new(n.z * scale, L::zero(), -(n.x * scale));
    let east = Vec3::select(pole, Vec3::new(L::one(), L::zero(), L::zero()), east);
    let hand = L::select(inside, -L::one(), L::one());
    (east * hand, hand)
}

/// Returns `ns`, turned to face the ray of direction `d` at least half as much as `ng` does, with which
/// mirror directions are about at the horizon. If `ns` faces away by more than that, it turns to face the ray
/// by as much: nothing jumps where a bumpy surface turns from the eye.
#[inline(always)]
pub fn facing<L: Lane>(d: Vec3<L>, ns: Vec3<L>, ng: Vec3<L>) -> Vec3<L> {
    let (least, away) = (L::splat(-0.5) * d.dot(ng), d.dot(ns));
    let turned = d.mul_add(-(away.abs().max(least) + away), ns).normalize();
    Vec3::select((-away).lt(least), turned, ns)
}

/// Returns a factor for the light along `w` that diffuse lobes about `ns` see: less close above the horizon,
/// the plane of `ng`, and more further up. It is 0 at the horizon, where a lobe of the light's cosine would
/// have an edge; up to 1.25 where `ns` adds four times the height above the horizon to that cosine; and 1
/// where it adds no more than twice the height.
///
/// Uniform light is preserved: a lobe tilted by θ has the share (1 + cos θ) / 2 above the horizon, of which
/// the factor takes at most 0.4 %, up to θ = 85°, or adds 0.2 %.
#[inline(always)]
pub fn shadow_terminator<L: Lane>(w: Vec3<L>, ns: Vec3<L>, ng: Vec3<L>) -> L {
    let height = w.dot(ng);
    let added = ns.dot(ng).neg_mul_add(height, w.dot(ns));
    let x = (L::splat(2.0) * height / added.max(L::splat(1e-12))).min(L::one()).max(L::zero());
    let rest = L::one() - x;
    (rest * rest).neg_mul_add(L::splat(-4.0).mul_add(x, L::one()), L::one())
}
