//! Rows of the table of lights, their form over lanes, and samples of lights.
//!
//! Units: pdfs per solid angle, in 1/sr.

use super::{flat, sphere};
use crate::buffers::rows::Rows;
use crate::buffers::{Features, has};
use crate::lane::{Bits, Lane, Mask, functions};
use crate::math::Vec3;

/// The way in which next event estimation samples a primitive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum SampledAs {
    /// The primitive is not sampled.
    #[default]
    Nothing,
    /// The primitive is a light, chosen with this probability.
    Whole(f32),
    /// The primitive is half of a parallelogram that is a light: the probability of choosing that light, and
    /// the index of the vertex opposite the other half.
    Half(f32, usize),
    /// Each piece of the primitive is a light: the index of the first one.
    Pieces(u32),
}

/// The position, in bits, of the vertex opposite the other half in the column of a triangle's material.
const VERTEX_SHIFT: u32 = 30;

impl SampledAs {
    /// Returns the column of the probability, and the number that is added to the column of the material:
    /// above [`VERTEX_SHIFT`], one more than the index of the vertex of [`SampledAs::Half`]. For pieces the
    /// probability is replaced by −1 minus the index of the first light, below 2²⁴.
    pub(super) fn pack(self) -> (f32, u32) {
        match self {
            Self::Nothing => (0.0, 0),
            Self::Whole(probability) => (probability, 0),
            Self::Half(probability, vertex) => (probability, (vertex as u32 + 1) << VERTEX_SHIFT),
            Self::Pieces(first) => (-((first + 1) as f32), 0),
        }
    }
}

/// The [`SampledAs`] of a primitive in each lane.
#[derive(Clone, Copy)]
pub struct SampledPrimitives<L: Lane> {
    pub(super) column: L,
    /// The column of the material, or 0 for primitives that are never halves.
    pub(super) material: L::Bits,
}

impl<L: Lane> SampledPrimitives<L> {
    /// Returns the index of the material from its column of a triangle's row.
    #[inline(always)]
    pub(super) fn material(column: L::Bits) -> L::Bits {
        column & L::Bits::splat((1 << VERTEX_SHIFT) - 1)
    }
    /// Returns the lanes whose primitive is sampled.
    #[inline(always)]
    pub fn are_sampled(&self) -> L::Mask {
        !self.column.eq(L::zero())
    }
    /// Returns the probabilities of choosing the light, 0 if there is none. Domain: not for pieces.
    #[inline(always)]
    pub fn probability(&self) -> L {
        self.column
    }
    /// Returns the lanes of [`SampledAs::Pieces`].
    #[inline(always)]
    pub fn are_in_pieces(&self) -> L::Mask {
        self.column.lt(L::zero())
    }
    /// Returns the index of the light that is the first piece, in the lanes of [`Self::are_in_pieces`].
    #[inline(always)]
    pub fn first_piece(&self) -> L::Bits {
        (-L::one() - self.column).truncate_to_int()
    }
    /// Returns, for each vertex, the lanes of halves in which that vertex is opposite the other half.
    #[inline(always)]
    pub fn opposite_vertex(&self) -> [L::Mask; 3] {
        let vertex = self.material.shr(VERTEX_SHIFT);
        [1, 2, 3].map(|code| vertex.equals(L::Bits::splat(code)))
    }
}

/// The kind of a light, as stored in its row.
#[derive(Clone, Copy, Default)]
pub(crate) enum LightKind {
    Sphere,
    Triangle,
    Parallelogram,
    Portal,
    /// A point or a spot.
    Point,
    /// A directional light.
    Distant,
    #[default]
    Environment,
}

impl LightKind {
    const ALL: [Self; 7] = [
        Self::Sphere,
        Self::Triangle,
        Self::Parallelogram,
        Self::Portal,
        Self::Point,
        Self::Distant,
        Self::Environment,
    ];
}

// `ALL` has every kind, and the last one at its end.
const _: () = match LightKind::ALL[LightKind::ALL.len() - 1] {
    LightKind::Sphere | LightKind::Triangle | LightKind::Parallelogram => panic!("a kind is lacking"),
    LightKind::Portal | LightKind::Point | LightKind::Distant => panic!("a kind is lacking"),
    LightKind::Environment => assert!(LightKind::Environment as usize + 1 == LightKind::ALL.len()),
};

/// A light of the table without its probability. [`ChosenLight`] explains the fields.
#[derive(Clone, Copy, Default)]
pub(crate) struct LightRow {
    pub kind: LightKind,
    pub at: glam::Vec3,
    pub radius: f32,
    pub edges: [glam::Vec3; 2],
    pub emission: glam::Vec3,
    pub offset: f32,
}

impl LightRow {
    /// Returns the two rows of a light that is chosen with this probability.
    pub fn pack(self, probability: f32) -> [[f32; 8]; 2] {
        let Self { kind, at, radius, edges: [ab, ac], emission: e, offset } = self;
        let kind = f32::from_bits(kind as u32);
        [
            [at.x, at.y, at.z, radius, e.x, e.y, e.z, probability],
            [ab.x, ab.y, ab.z, ac.x, ac.y, ac.z, kind, offset],
        ]
    }
}

/// The lanes of each kind of light. Code that differs by kind names every field, so that the compiler finds
/// it when a kind is added.
pub struct LightKinds<L: Lane> {
    /// The lanes with spheres.
    pub sphere: L::Mask,
    /// The lanes with triangles, parallelograms and pieces.
    pub flat: L::Mask,
    /// The lanes with portals.
    pub portal: L::Mask,
    /// The lanes with points and spots.
    pub point: L::Mask,
    /// The lanes with directional lights.
    pub distant: L::Mask,
    /// The lanes with the environment.
    pub environment: L::Mask,
}

impl<L: Lane> LightKinds<L> {
    /// Returns the lanes to which lights of this kind belong.
    #[inline(always)]
    fn lanes_of(&mut self, kind: LightKind) -> &mut L::Mask {
        match kind {
            LightKind::Sphere => &mut self.sphere,
            LightKind::Triangle | LightKind::Parallelogram => &mut self.flat,
            LightKind::Portal => &mut self.portal,
            LightKind::Point => &mut self.point,
            LightKind::Distant => &mut self.distant,
            LightKind::Environment => &mut self.environment,
        }
    }
    /// Returns the lanes whose light is the sky.
    #[inline(always)]
    pub fn are_sky<const N: u64>(&self) -> L::Mask {
        if has(N, Features::PORTALS) { self.portal | self.environment } else { self.environment }
    }
}

/// A light for each lane.
pub struct ChosenLight<L: Lane> {
    /// The index of the light.
    pub index: L::Bits,
    /// The kind of the light.
    pub kinds: LightKinds<L>,
    /// The centre of a sphere, the first vertex of a flat light or a portal, the place of a point, or the
    /// unit vector towards the middle of a distant light.
    pub at: Vec3<L>,
    /// The radius of a sphere; one over the range of a point; 1 − cos of the half angle of a distant light.
    pub radius: L,
    /// The edges of a flat light to the second vertex and to the third, of a portal to the fourth; the unit
    /// axis of a spot and the numbers of its falloff: see [`crate::lights::punctual`].
    pub edges: [Vec3<L>; 2],
    /// The lanes of flat lights that are the parallelogram which continues the triangle.
    pub is_quad: L::Mask,
    /// The radiance of the light, the intensity of a point, or the irradiance of a distant light without a
    /// disc. It is 1 for primitives if [`crate::lights::Lights::needs_hits`], and 0 for the environment and
    /// portals: the sky has its own.
    pub emission: Vec3<L>,
    /// The light's error bound: shadow rays end at this distance from its surface.
    pub offset: L,
    /// The probability of choosing the light by power.
    pub probability: L,
    /// The factor of the light's contribution: 1 if it was chosen by power, else the probability by power
    /// over that by irradiance.
    pub weight: L,
}

impl<L: Lane> ChosenLight<L> {
    /// Returns the lanes whose light no scattered ray can hit.
    #[inline(always)]
    pub fn is_delta(&self) -> L::Mask {
        self.kinds.point | (self.kinds.distant & self.radius.eq(L::zero()))
    }

    /// Samples a point of each lane's light, as seen from `origin`, in the lanes of `mask`. Lanes with lights
    /// that are no primitives are unspecified.
    #[inline(always)]
    pub fn sample<const N: u64>(&self, origin: Vec3<L>, (u, v): (L, L), mask: L::Mask) -> LightSample<L> {
        let LightKinds { sphere, mut flat, portal, point: _, distant: _, environment: _ } = self.kinds;
        let center = self.at - origin;
        let mut on_flat = self.flat(origin);
        if has(N, Features::PORTALS) {
            flat = flat | portal;
            on_flat.is_quad = on_flat.is_quad | portal;
        }
        let spheres = has(N, Features::SPHERES) && (mask & sphere).any();
        match (spheres, has(N, Features::TRIANGLES) && (mask & flat).any()) {
            (true, false) => sphere::sample(center, self.radius, u, v),
            (false, _) => flat::sample(&on_flat, u, v),
            (true, true) => {
                let on_flat = flat::sample(&on_flat, u, v);
                LightSample::select(sphere, sphere::sample(center, self.radius, u, v), on_flat)
            }
        }
    }
}

/// The rows of all lights.
#[derive(Clone, Debug, Default)]
pub struct LightTable {
    /// Two rows of eight per light: see [`LightRow`].
    rows: Rows,
    /// The number of pieces along an edge of a triangle that is sampled in pieces.
    pieces_side: usize,
}

impl LightTable {
    /// The largest number of lights whose rows fit the register form.
    pub const FEW: usize = Rows::FEW / 2;

    /// Stores the rows of [`LightRow::pack`].
    pub(crate) fn new(rows: impl Iterator<Item = [f32; 8]>, pieces_side: usize) -> Self {
        Self { rows: Rows::new(rows), pieces_side }
    }

    /// Fetches lights by their indices. `fits_registers` promises at most [`LightTable::FEW`].
    #[inline(always)]
    pub fn fetch<L: Lane>(&self, light: L::Bits, weight: L, fits_registers: bool) -> ChosenLight<L> {
        let first = light.shl(1);
        let [x, y, z, radius, r, g, b, probability] = self.rows.fetch::<L>(first, fits_registers);
        let [abx, aby, abz, acx, acy, acz, kind, offset] =
            self.rows.fetch::<L>(first | L::Bits::splat(1), fits_registers);
        let is = |code: LightKind| kind.to_bits().equals(L::Bits::splat(code as u32));
        let none = L::Mask::splat(false);
        let mut kinds = LightKinds {
            sphere: none,
            flat: none,
            portal: none,
            point: none,
            distant: none,
            environment: none,
        };
        for kind in LightKind::ALL {
            let lanes = kinds.lanes_of(kind);
            *lanes = *lanes | is(kind);
        }
        ChosenLight {
            index: light,
            kinds,
            at: Vec3::new(x, y, z),
            radius,
            edges: [Vec3::new(abx, aby, abz), Vec3::new(acx, acy, acz)],
            is_quad: is(LightKind::Parallelogram),
            emission: Vec3::new(r, g, b),
            offset,
            probability,
            weight,
        }
    }

    /// Returns the probability of choosing each light by power.
    #[inline(always)]
    pub fn probability<L: Lane>(&self, light: L::Bits) -> L {
        self.rows.fetch::<L>(light.shl(1), false)[7]
    }

    /// Returns the lights that are the pieces of triangles at barycentrics, in the lanes of `mask`; `first`
    /// is the light of the triangle's first piece.
    #[inline(always)]
    pub fn piece_at<L: Lane>(&self, first: L::Bits, (u, v): (L, L), mask: L::Mask) -> ChosenLight<L> {
        let side = L::splat(self.pieces_side as f32);
        let last = side - L::one();
        let row = (v * side).floor().max(L::zero()).min(last);
        let column = (u * side).floor().max(L::zero()).min(last - row);
        // Row r begins after r rows, each one shorter than the one before.
        let before = row * L::splat(-0.5).mul_add(row - L::one(), side);
        let light = first.wrapping_add((before + column).truncate_to_int());
        self.fetch(L::Bits::select(mask, light, L::Bits::splat(0)), L::one(), false)
    }
}

/// A sampled point of a light.
#[derive(Clone, Copy, Debug)]
pub struct LightSample<L: Lane> {
    /// The unit vector towards the point.
    pub wi: Vec3<L>,
    /// The distance to the point, in scene units. It is infinite for the sky and distant lights, and for all
    /// primitives if the hits of shadow rays decide: see [`crate::lights::Lights::needs_hits`].
    pub t: L,
    /// The light's unit normal there, on the lit side; zero for lights that are no primitives.
    pub n: Vec3<L>,
    /// The pdf of `wi`; for delta lights ([`ChosenLight::is_delta`]) the emission over the irradiance that
    /// arrives across `wi`.
    pub pdf: L,
}

impl<L: Lane> LightSample<L> {
    /// Selects one of two samples in each lane.
    #[inline(always)]
    pub fn select(mask: L::Mask, if_true: Self, if_false: Self) -> Self {
        Self {
            wi: Vec3::select(mask, if_true.wi, if_false.wi),
            t: L::select(mask, if_true.t, if_false.t),
            n: Vec3::select(mask, if_true.n, if_false.n),
            pdf: L::select(mask, if_true.pdf, if_false.pdf),
        }
    }
}

/// Returns the pdf if it is finite and above 0; else 0.
#[inline(always)]
pub(crate) fn valid_pdf<L: Lane>(pdf: L) -> L {
    pdf.only(L::zero().lt(pdf) & pdf.is_finite())
}

/// Returns the row by which a light within a sphere is weighed: centre, radius, unit normal of a flat light
/// or else 0, and its power over 4π, or over 2π for a flat light.
pub(crate) fn bounded_importance(
    center: glam::Vec3,
    radius: f32,
    normal: Option<glam::Vec3>,
    power: f64,
) -> [f32; 8] {
    let n = normal.unwrap_or_default();
    [center.x, center.y, center.z, radius, n.x, n.y, n.z, power as f32]
}

/// Returns the row of a light that brings the same mean irradiance everywhere. A mark replaces the radius.
pub(crate) fn importance_everywhere(irradiance: f64) -> [f32; 8] {
    const MARK: f32 = -1.0;
    [0.0, 0.0, 0.0, MARK, 0.0, 0.0, 0.0, irradiance as f32]
}

/// Returns an estimate, from these rows, of the irradiance of a light at `point` on a surface with the normal
/// `n`, ignoring occlusion. It is above 0 if some of the light is above the horizon.
///
/// Source of the bounds of cosines: A. Conty Estevez, C. Kulla, "Importance Sampling of Many Lights with
/// Adaptive Tree Splitting", HPG 2018, §4.
#[inline(always)]
pub(crate) fn irradiance<L: Lane>(
    rows: &Rows,
    light: L::Bits,
    (point, n): (Vec3<L>, Vec3<L>),
    fits_registers: bool,
) -> L {
    let [x, y, z, radius, nx, ny, nz, power] = rows.fetch::<L>(light, fits_registers);
    let (to, normal) = (Vec3::new(x, y, z) - point, Vec3::new(nx, ny, nz));
    let distance2 = to.dot(to).max(radius * radius).max(L::splat(f32::MIN_POSITIVE));
    let per_distance = functions::approximate_rsqrt(distance2);
    // An angle reduced by that of the bounding sphere has a cosine that is greater by at most the sphere's
    // sine.
    let sine = radius * per_distance;
    let cosine = to.dot(n).mul_add(per_distance, sine).max(L::zero()).min(L::one());
    let facing = (to.dot(normal).abs()).mul_add(per_distance, sine).min(L::one());
    let is_flat = L::zero().lt(normal.dot(normal));
    let bound = power * cosine * L::select(is_flat, facing, L::one()) * (per_distance * per_distance);
    let is_everywhere = radius.lt(L::zero());
    L::select(is_everywhere, power, bound)
}
