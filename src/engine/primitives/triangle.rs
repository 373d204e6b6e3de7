//! Triangles in shading: their rows, the surfaces at hits, and triangles as lights.

use super::flat::{self, FlatLight};
use super::light::{LightTable, SampledAs, SampledPrimitives};
use super::{PrimitiveTables, Surface, SurfaceTables};
use crate::buffers::rows::Rows;
use crate::buffers::{Features, has};
use crate::kernel::normals;
use crate::kernel::surface::{self, inset, near_edge, triangle_normal, triangle_offset};
use crate::lane::{Bits, Lane, Mask};
use crate::math::{Hit, Ray, Vec3};
use crate::rays::Kind;
use crate::scene::{Scene, Triangle};

/// The tables of a scene's triangles.
pub struct TriangleTables {
    /// Two rows of eight per triangle: see [`TriangleRow`].
    pub rows: Rows,
    /// Whether all triangles are parallel: none then hides another that shares an edge with it.
    pub are_parallel: bool,
    /// One row of eight per triangle: u and v of the three vertices, v downwards, and
    /// [`surface::texture_density`]; empty without texture coordinates.
    uvs: Rows,
    /// Two rows of eight per triangle: normals of the first two vertices, 0, 0; normal of the third, 0. Empty
    /// without vertex normals.
    normals: Rows,
    /// One row of eight per triangle: unit tangent along growing u, handedness (+1 or −1: v grows to its
    /// left, or right, seen from outside), 0; all 0 if u has no direction. Empty if no triangle has a normal
    /// map.
    tangents: Rows,
}

impl TriangleTables {
    /// Flattens the triangles of a scene. `light` returns how the primitive with a number is sampled.
    pub(super) fn new(scene: &Scene, light: impl Fn(usize) -> SampledAs) -> Self {
        let normal = |triangle: &Triangle| triangle_normal(triangle.vertices);
        let first = scene.triangles.first().map(normal).unwrap_or_default();
        let numbered = (scene.counts().first(Kind::Triangle)..).zip(&scene.triangles);
        let packed = numbered.flat_map(|(number, triangle)| rows(triangle, light(number)));
        Self {
            rows: Rows::new(packed),
            are_parallel: scene.triangles.iter().map(normal).all(|n| n == first || n == -first),
            uvs: Rows::new(uv_rows(scene)),
            normals: Rows::new(scene.normals.iter().flat_map(normal_rows)),
            tangents: Rows::new(tangent_rows(scene)),
        }
    }

    /// Tests whether triangles have texture coordinates of their own.
    #[inline(always)]
    pub(super) fn have_uvs(&self) -> bool {
        !self.uvs.is_empty()
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
fn rows(triangle: &Triangle, light: SampledAs) -> [[f32; 8]; 2] {
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
            material: SampledPrimitives::<L>::material(material),
            near_edge,
            light: SampledPrimitives { column, material },
        }
    }
}

/// Returns the two rows of a triangle in [`TriangleTables::normals`].
fn normal_rows([a, b, c]: &[glam::Vec3; 3]) -> [[f32; 8]; 2] {
    [[a.x, a.y, a.z, b.x, b.y, b.z, 0.0, 0.0], [c.x, c.y, c.z, 0.0, 0.0, 0.0, 0.0, 0.0]]
}

/// Returns the rows of [`TriangleTables::uvs`].
fn uv_rows(scene: &Scene) -> impl Iterator<Item = [f32; 8]> {
    let repeats: Vec<bool> =
        scene.materials.iter().map(|material| material.repeats(&scene.textures)).collect();
    scene.triangles.iter().zip(&scene.uvs).map(move |(triangle, uvs)| {
        let along = |corners: [f64; 3]| match repeats[triangle.material as usize] {
            true => surface::remove_shared_repeats(corners),
            false => corners.map(|corner| corner as f32),
        };
        let [au, bu, cu] = along(uvs.map(|uv| f64::from(uv.x)));
        let [av, bv, cv] = along(uvs.map(|uv| 1.0 - f64::from(uv.y)));
        [au, av, bu, bv, cu, cv, surface::texture_density(triangle.vertices, *uvs), 0.0]
    })
}

/// Iterates over the rows of [`TriangleTables::tangents`].
fn tangent_rows(scene: &Scene) -> impl Iterator<Item = [f32; 8]> {
    let mapped = |triangle: &Triangle| scene.materials[triangle.material as usize].normal_map.is_some();
    let any = scene.triangles.iter().any(mapped);
    scene.triangles.iter().zip(&scene.uvs).filter(move |_| any).map(|(triangle, uvs)| {
        let (tangent, hand) = surface::triangle_tangent(triangle.vertices, *uvs);
        [tangent.x, tangent.y, tangent.z, hand, 0.0, 0.0, 0.0, 0.0]
    })
}

/// The data of lanes on triangles that shading keeps.
pub struct OnTriangle<L: Lane> {
    /// The index among the triangles; 0 in other lanes.
    index: L::Bits,
    barycentric: (L, L),
    /// The edges from the first vertex to the second, and to the third.
    edges: [Vec3<L>; 2],
}

impl<L: Lane> OnTriangle<L> {
    /// Stores the index and the weights of hits.
    #[inline(always)]
    pub(super) fn new(index: L::Bits, hit: &Hit<L>) -> Self {
        Self { index, barycentric: (hit.u, hit.v), edges: [Vec3::zero(); 2] }
    }
}

impl<L: Lane> Surface<L> {
    /// Overwrites the lanes on triangles.
    #[inline(always)]
    pub(super) fn set_triangle<const N: u64>(&mut self, tables: &SurfaceTables, ray: &Ray<L>, hit: &Hit<L>) {
        let fits_registers = !has(N, Features::MANY_TRIANGLES);
        let triangle =
            TriangleRow::fetch(&tables.primitives.triangles.rows, self.triangle.index, fits_registers);
        let (mut u, mut v) = self.triangle.barycentric;
        let at_edge = hit.least_weight().lt(triangle.near_edge);
        if at_edge.any() {
            let moved = inset((u, v), triangle.edges, triangle.offset);
            (u, v) = (L::select(at_edge, moved.0, u), L::select(at_edge, moved.1, v));
        }
        let [ab, ac] = triangle.edges;
        let point = ab.mul_add(u, ac.mul_add(v, triangle.a));
        self.triangle.edges = triangle.edges;
        let keep = !self.kinds.0[Kind::Triangle as usize];
        self.point = Vec3::select(keep, self.point, point);
        self.ng = Vec3::select(keep, self.ng, triangle.ng);
        self.offset = L::select(keep, self.offset, triangle.offset);
        self.material = L::Bits::select(keep, self.material, triangle.material);
        if has(N, Features::LIGHTS) {
            let mut pdf = L::zero();
            if (!keep & triangle.light.are_sampled()).any() {
                pdf = triangle_pdf::<L, N>(tables.lights, &triangle, ray, hit, !keep);
            }
            // Lanes on triangles that are no lights hold the pdf of some sphere and are overwritten, too.
            self.light_pdf = L::select(keep, self.light_pdf, pdf);
        }
    }

    /// Returns interpolated vertex normals, and the lanes of `found` that have them; geometric normals
    /// elsewhere. The third result is the vector to the smooth surface, on the side from which the ray
    /// arrives: see [`normals::bulge`].
    #[inline(always)]
    pub fn interpolated_normal<const N: u64>(
        &self,
        primitives: &PrimitiveTables,
        found: L::Mask,
    ) -> (Vec3<L>, L::Mask, Vec3<L>) {
        let on_triangle = found & self.kinds.0[Kind::Triangle as usize];
        if !on_triangle.any() {
            return (self.ng, L::Mask::splat(false), Vec3::zero());
        }
        let fits_registers = !has(N, Features::MANY_TRIANGLES);
        let first = self.triangle.index.shl(1);
        let second = first | L::Bits::splat(1);
        let [ax, ay, az, bx, by, bz, ..] = primitives.triangles.normals.fetch::<L>(first, fits_registers);
        let [cx, cy, cz, ..] = primitives.triangles.normals.fetch::<L>(second, fits_registers);
        let corners = [Vec3::new(ax, ay, az), Vec3::new(bx, by, bz), Vec3::new(cx, cy, cz)];
        let blended = normals::blend(corners, self.triangle.barycentric);
        let (normal, exists) = normals::interpolated(blended, self.ng);
        let interpolated = on_triangle & exists;
        let ng = self.ng.flip_sign(self.facing);
        let bulge =
            normals::bulge(corners, self.triangle.edges, self.triangle.barycentric, ng, blended.dot(ng));
        let bulge = Vec3::select(interpolated, bulge, Vec3::zero());
        (Vec3::select(interpolated, normal, self.ng), interpolated, bulge)
    }

    /// Overwrites the tangents of the lanes in `on_triangle`.
    #[inline(always)]
    pub(super) fn triangle_tangent<const N: u64>(
        &self,
        primitives: &PrimitiveTables,
        on_triangle: L::Mask,
        (tangent, hand): (Vec3<L>, L),
    ) -> (Vec3<L>, L) {
        let fits_registers = !has(N, Features::MANY_TRIANGLES);
        let index = L::Bits::select(on_triangle, self.triangle.index, L::Bits::splat(0));
        let [x, y, z, w, ..] = primitives.triangles.tangents.fetch::<L>(index, fits_registers);
        let keep = !self.kinds.0[Kind::Triangle as usize];
        (Vec3::select(keep, tangent, Vec3::new(x, y, z)), L::select(keep, hand, w))
    }

    /// Overwrites texture coordinates and the density of the texture in the lanes on triangles.
    #[inline(always)]
    pub(super) fn triangle_coordinates<const N: u64>(
        &self,
        tables: &SurfaceTables,
        ((u, v), density): ((L, L), L),
    ) -> ((L, L), L) {
        let fits_registers = !has(N, Features::MANY_TRIANGLES);
        let [au, av, bu, bv, cu, cv, of_triangle, _] =
            tables.primitives.triangles.uvs.fetch::<L>(self.triangle.index, fits_registers);
        let (s, t) = self.triangle.barycentric;
        let blend = |a: L, b: L, c: L| (b - a).mul_add(s, (c - a).mul_add(t, a));
        let keep = !self.kinds.0[Kind::Triangle as usize];
        let u = L::select(keep, u, blend(au, bu, cu));
        let v = L::select(keep, v, blend(av, bv, cv));
        ((u, v), L::select(keep, density, of_triangle))
    }
}

/// Returns the pdf with which light sampling at a ray's origin samples its direction, if the ray hits a
/// triangle: that of the light that the triangle is, is half of, or has a piece of at the hit. Only for
/// the lanes of `mask`.
#[inline(always)]
fn triangle_pdf<L: Lane, const N: u64>(
    lights: &LightTable,
    triangle: &TriangleRow<L>,
    ray: &Ray<L>,
    hit: &Hit<L>,
    mask: L::Mask,
) -> L {
    let mut light = FlatLight::from_triangle(triangle, ray.origin);
    let mut probability = triangle.light.probability();
    let in_pieces = mask & triangle.light.are_in_pieces();
    if has(N, Features::MANY_LIGHTS) && in_pieces.any() {
        let piece = lights.piece_at(triangle.light.first_piece(), (hit.u, hit.v), in_pieces);
        light = FlatLight::select(in_pieces, piece.flat(ray.origin), light);
        probability = L::select(in_pieces, piece.probability, probability);
    }
    probability * flat::pdf(&light, ray.direction, hit.t)
}
