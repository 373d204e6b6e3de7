//! Normals for shading that are not the surface's own: interpolated ones, and those of normal maps.
//!
//! The surface's own normal decides sides: which one a ray arrives at, and whether it leaves. A normal for shading only bends what
//! happens there. Two things must not come of that: light that leaks through, and black seams where one normal faces the light and
//! the other does not.
//!
//! - What reflects gets a normal bent back towards the surface's own, just so far that the mirror direction stays above the surface
//!   ([`bend`]; Keller et al., "The Iray Light Transport Simulation and Rendering System", 2017, §A.3).
//! - Every lobe but a delta lobe is shadowed by [`terminator`] (Chiang, Li, Burley, "Taming the Shadow Terminator", SIGGRAPH Talks
//!   2019): smoothly to black where the surface itself turns away. What is drawn below the surface is absorbed.
//!
//! Both only take light away: on a smooth ball of 80 triangles, whose normals are up to 21° off, 3.9 % of what a white matt one
//! scatters, 2.9 to 4.4 % with a coat or as rough metal, nothing as a mirror, 0.2 % as glass (measured, `tests/smooth.rs`).

use crate::lane::Lane;
use crate::math::Vec3;

/// Normals shorter than this have no direction: opposite ones were blended.
const SHORTEST2: f32 = 1e-4;

/// The unit vector along `v`, and where there is one.
#[inline(always)]
fn unit<L: Lane>(v: Vec3<L>) -> (Vec3<L>, L::Mask) {
    let length2 = v.dot(v);
    (v * (L::one() / length2.sqrt()), L::splat(SHORTEST2).lt(length2))
}

/// The blend of a triangle's vertex normals at (u, v) as a unit vector on the side of `outward`, and where it has one: vectors of
/// length zero are no normals.
#[inline(always)]
pub fn smooth<L: Lane>([a, b, c]: [Vec3<L>; 3], (u, v): (L, L), outward: Vec3<L>) -> (Vec3<L>, L::Mask) {
    let (normal, some) = unit((b - a).mul_add(u, (c - a).mul_add(v, a)));
    (normal.flip_sign(normal.dot(outward)), some)
}

/// The normal that a map's `texel` means around the unit normal `n`, and where it means one. `tangent` runs along growing u; `hand` is +1
/// where v grows along n × tangent, −1 where against it.
#[inline(always)]
pub fn mapped<L: Lane>(texel: Vec3<L>, n: Vec3<L>, tangent: Vec3<L>, hand: L) -> (Vec3<L>, L::Mask) {
    let (tangent, framed) = unit(n.mul_add(-tangent.dot(n), tangent));
    let bitangent = n.cross(tangent) * hand;
    let signed = |x: L| L::splat(2.0).mul_add(x, -L::one());
    let (x, y, z) = (signed(texel.x), signed(texel.y), signed(texel.z).max(L::zero()));
    let (normal, some) = unit(tangent.mul_add(x, bitangent.mul_add(y, n * z)));
    (normal, framed & some)
}

/// The unit vector along growing u on a sphere with outward normal `n`, and the hand of the frame, for a picture that reads right from
/// outside, or, where `inside`, from inside. At the poles u grows nowhere: any direction serves.
#[inline(always)]
pub fn sphere_tangent<L: Lane>(n: Vec3<L>, inside: L::Mask) -> (Vec3<L>, L) {
    let around2 = n.x.mul_add(n.x, n.z * n.z);
    let pole = around2.lt(L::splat(1e-12));
    let scale = L::one() / around2.sqrt();
    let east = Vec3::new(n.z * scale, L::zero(), -(n.x * scale));
    let east = Vec3::select(pole, Vec3::new(L::one(), L::zero(), L::zero()), east);
    let hand = L::select(inside, -L::one(), L::one());
    (east * hand, hand)
}

/// `normal`, or as much of it as keeps the mirror direction of `d` above the surface, whose own normal is `own`, with d · own < 0.
///
/// Above: at half the angle (its sine) at which d arrives, and no more than 0.01. Error: 2e-6 of the sine (measured 0.9e-6, `tests/smooth.rs`), so
/// that closer than that to the surface some point below it: whoever leaves asks again.
#[inline(always)]
pub fn bend<L: Lane>(d: Vec3<L>, normal: Vec3<L>, own: Vec3<L>) -> Vec3<L> {
    let mirrored = d.reflect(normal);
    let above = mirrored.dot(own);
    let least = (L::splat(-0.5) * d.dot(own)).min(L::splat(0.01)).max(L::splat(1e-6));
    let raised = own.mul_add(least - above, mirrored).normalize();
    // Half way between d and where it shall go. Two unit vectors' difference is perpendicular to their sum; of grazing ones it is short, and what
    // rounding leaves along the sum would turn it.
    let (half, sum) = (raised - d, raised + d);
    let along = half.dot(sum) / sum.dot(sum).max(L::splat(1e-3));
    let half = sum.mul_add(-along, half);
    let length2 = half.dot(half);
    let bent = half * (L::one() / length2.sqrt());
    let bent = Vec3::select(L::splat(1e-10).lt(length2), bent, own);
    Vec3::select(above.lt(least), bent, normal)
}

/// How much of the light towards `w` the surface lets pass whose own normal is `own`: 0 below it, 1 where `normal` is `own`.
#[inline(always)]
pub fn terminator<L: Lane>(w: Vec3<L>, normal: Vec3<L>, own: Vec3<L>) -> L {
    let cosines = w.dot(normal) * normal.dot(own);
    let g = (w.dot(own).max(L::zero()) / cosines.max(L::splat(1e-12))).min(L::one());
    // −g³ + g² + g
    (L::one() - g).mul_add(g, L::one()) * g
}
