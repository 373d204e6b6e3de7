//! The rows of spheres and triangles: packed from a scene, and unpacked over lanes.

use super::rows::Rows;
use crate::kernel::surface::{near_edge, triangle_normal, triangle_offset};
use crate::lane::{Bits, Lane};
use crate::math::Vec3;
use crate::scene::{Side, Sphere, Triangle};

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
    fn pack(self) -> (f32, u32) {
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
    column: L,
    material: L::Bits,
}

impl<L: Lane> SampledPrimitives<L> {
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

/// A sphere in each lane.
pub struct SphereRow<L: Lane> {
    /// The centre.
    pub center: Vec3<L>,
    /// One over the radius.
    pub inverse_radius: L,
    /// The distance from the surface at which spawned rays start.
    pub offset: L,
    /// The index of the material.
    pub material: L::Bits,
    /// The rotation of the texture, in turns. Its sign bit is set if the texture is oriented to be seen from
    /// outside: with the angle's sign flipped by it, the angle plus this number is u on both sides.
    pub turn: L,
    /// The way in which the sphere is sampled as a light.
    pub light: SampledPrimitives<L>,
}

/// Returns the row of a sphere: centre, one over the radius, offset, material (bits), texture turn,
/// probability of being chosen as a light.
pub(super) fn sphere_row(sphere: &Sphere, offset: f32, light: SampledAs) -> [f32; 8] {
    let [x, y, z] = sphere.center.to_array();
    let is_inside = sphere.texture_side == Side::Inside;
    // A turn of 0 has a sign too.
    let turn = sphere.texture_turn.abs().copysign(if is_inside { 1.0 } else { -1.0 });
    [x, y, z, 1.0 / sphere.radius, offset, f32::from_bits(sphere.material), turn, light.pack().0]
}

impl<L: Lane> SphereRow<L> {
    /// Fetches the rows of spheres: see [`Rows::fetch`].
    #[inline(always)]
    pub fn fetch(rows: &Rows, index: L::Bits, fits_registers: bool) -> Self {
        let [x, y, z, inverse_radius, offset, material, turn, column] =
            rows.fetch::<L>(index, fits_registers);
        Self {
            center: Vec3::new(x, y, z),
            inverse_radius,
            offset,
            material: material.to_bits(),
            turn,
            light: SampledPrimitives { column, material: L::Bits::splat(0) },
        }
    }
}

/// A triangle in each lane.
pub struct TriangleRow<L: Lane> {
    /// The first vertex.
    pub a: Vec3<L>,
    /// The edges from there to the second vertex and to the third.
    pub edges: [Vec3<L>; 2],
    /// The unit normal.
    pub ng: Vec3<L>,
    /// The distance from the surface at which spawned rays start.
    pub offset: L,
    /// The index of the material.
    pub material: L::Bits,
    /// See [`near_edge`].
    pub near_edge: L,
    /// The way in which the triangle is sampled as a light.
    pub light: SampledPrimitives<L>,
}

/// Returns the two rows of a triangle: a, ab, offset, material with the number of [`SampledAs::pack`] (bits);
/// ac, unit normal, probability of being chosen as a light, [`near_edge`].
pub(super) fn triangle_rows(triangle: &Triangle, light: SampledAs) -> [[f32; 8]; 2] {
    let [a, b, c] = triangle.vertices;
    let (ab, ac) = (b - a, c - a);
    let n = triangle_normal(triangle.vertices);
    let offset = triangle_offset(triangle.vertices);
    let (column, vertex) = light.pack();
    let near_edge = near_edge(triangle.vertices, offset);
    [
        [a.x, a.y, a.z, ab.x, ab.y, ab.z, offset, f32::from_bits(triangle.material | vertex)],
        [ac.x, ac.y, ac.z, n.x, n.y, n.z, column, near_edge],
    ]
}

impl<L: Lane> TriangleRow<L> {
    /// Fetches the rows of triangles: see [`Rows::fetch`].
    #[inline(always)]
    pub fn fetch(rows: &Rows, index: L::Bits, fits_registers: bool) -> Self {
        let first = index.shl(1);
        let [ax, ay, az, abx, aby, abz, offset, material] = rows.fetch::<L>(first, fits_registers);
        let [acx, acy, acz, nx, ny, nz, column, near_edge] =
            rows.fetch::<L>(first | L::Bits::splat(1), fits_registers);
        let material = material.to_bits();
        Self {
            a: Vec3::new(ax, ay, az),
            edges: [Vec3::new(abx, aby, abz), Vec3::new(acx, acy, acz)],
            ng: Vec3::new(nx, ny, nz),
            offset,
            material: material & L::Bits::splat((1 << VERTEX_SHIFT) - 1),
            near_edge,
            light: SampledPrimitives { column, material },
        }
    }
}
