//! The scene flattened into aligned structure-of-arrays buffers, and the features that it needs.
//!
//! Shading reads *row tables* ([`rows::Rows`]) of eight floats a row, each lane at its own index: rows are
//! fetched and transposed into packets in registers. What intersection reads is in [`crate::traverse`].

mod environment_light;
pub mod features;
mod geometry;
mod light_power;
mod lights;
mod mip_chain;
mod overlaps;
mod quads;
pub mod rows;
mod texels;

pub use environment_light::EnvironmentLight;
pub use features::Features;
pub use geometry::quadric_surface;
pub use lights::{LightChoice, Lights};
pub use texels::{Abilities, Textures};

use crate::kernel::bsdf::{metal_rough, plastic};
use crate::kernel::surface::{self, triangle_normal, triangle_offset};
use crate::scene::{self, MaterialKind, Scene};
use glam::Vec3;
use rows::Rows;

/// Everything that shading reads of a scene.
pub struct Buffers {
    /// The features that the scene uses.
    pub needs: Features,
    /// The number of the first triangle: of primitives, quadrics come first.
    pub first_triangle: u32,
    /// One row of eight a quadric. Of a sphere: centre, one over the radius, offset of spawned rays, material
    /// (bits), texture turn, probability of being chosen as a light. The turn's sign bit is set where the
    /// texture is oriented to be seen from outside: with the angle's sign flipped by it, the angle plus this
    /// number is u on both sides.
    pub quadric_rows: Rows,
    /// Two rows of eight a triangle: a, ab, offset, material and [`Lights::diagonals`] (bits, see
    /// [`DIAGONAL_SHIFT`]); ac, unit normal, probability of being chosen as a light, [`surface::near_edge`].
    pub triangle_rows: Rows,
    /// Whether all triangles are parallel: then none hides another that it shares an edge with.
    pub are_parallel: bool,
    /// One row of eight a triangle: u and v of the three vertices, v downwards, and
    /// [`surface::texture_density`]; empty without texture coordinates.
    pub uv_rows: Rows,
    /// One row of eight a material: colour, parameter, emission, kind and texture (bits; see
    /// [`MaterialCode`]).
    pub material_rows: Rows,
    /// Two rows of eight a triangle: normals of the first two vertices, 0, 0; of the third, 0. Empty without
    /// vertex normals.
    pub normal_rows: Rows,
    /// One row of eight a triangle: unit tangent along growing u, handedness (+1 or −1: v grows to its left,
    /// or right, seen from outside), 0; all 0 where u has no direction. Empty where no triangle has a normal
    /// map.
    pub tangent_rows: Rows,
    /// One row of eight a material, read where the pipeline has some of [`Features::DETAILS`]: index of
    /// refraction, mean transmittance of plastic's coat, roughness map, normal map and emission map (bits:
    /// index + 1, 0 for none), 0. Of metal-rough the first two are the dielectric's reflectance at normal
    /// incidence and the metallic share.
    pub material_extra: Rows,
    /// Whether any triangle has texture coordinates of its own.
    pub has_uvs: bool,
    /// All textures, encoded for lookups.
    pub textures: Textures,
    /// What rays see that hit nothing.
    pub sky: Sky,
    /// The lights that are sampled.
    pub lights: Lights,
}

/// Above a triangle's material, in bits: what half of a quadrilateral it is, see [`Lights::diagonals`].
pub const DIAGONAL_SHIFT: u32 = 30;

/// The sky as shading reads it.
#[derive(Clone, Copy, Debug)]
pub struct Sky {
    /// Radiance straight down, or of a uniform sky, or the factor of the texture.
    pub bottom: Vec3,
    /// Radiance straight up minus `bottom`; zero without a gradient.
    pub rise: Vec3,
    /// Index of the texture, where [`Features::SKY_TEXTURE`] holds.
    pub texture: u32,
    /// Turns of the texture: added to u.
    pub turn: f32,
}

/// A material's kind and texture in one number: kind in the lowest byte, above it texture index + 1, 0 for
/// none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MaterialCode(pub u32);

impl MaterialCode {
    /// Emits and scatters nothing.
    pub const EMITTER: u32 = 0;
    /// Lambertian.
    pub const DIFFUSE: u32 = 1;
    /// A perfect mirror.
    pub const MIRROR: u32 = 2;
    /// A rough metal.
    pub const GGX: u32 = 3;
    /// A smooth dielectric.
    pub const GLASS: u32 = 4;
    /// The thesis's lobe.
    pub const FUZZY_MIRROR: u32 = 5;
    /// A coat over a diffuse base.
    pub const PLASTIC: u32 = 6;
    /// glTF's metallic-roughness.
    pub const METAL_ROUGH: u32 = 7;
    /// Position of the texture index, in bits.
    pub const TEXTURE_SHIFT: u32 = 8;
    /// Masks the kind.
    pub const KIND: u32 = 0xff;

    /// The code of a material, and its parameter: alpha of GGX, plastic's coat and metal-rough, index of
    /// refraction of glass (negated: thin glass), roughness of the fuzzy mirror.
    fn of(material: &scene::Material) -> (Self, f32) {
        let (kind, parameter) = match material.kind {
            MaterialKind::Emitter => (Self::EMITTER, 0.0),
            MaterialKind::Diffuse => (Self::DIFFUSE, 0.0),
            MaterialKind::Metal { roughness: 0.0 } => (Self::MIRROR, 0.0),
            MaterialKind::Metal { roughness } => (Self::GGX, roughness * roughness),
            MaterialKind::Glass { ior } => (Self::GLASS, ior),
            MaterialKind::ThinGlass { ior } => (Self::GLASS, -ior),
            MaterialKind::FuzzyMirror { roughness } => (Self::FUZZY_MIRROR, roughness),
            MaterialKind::Plastic { roughness, .. } => (Self::PLASTIC, roughness * roughness),
            MaterialKind::MetalRough { roughness, .. } => (Self::METAL_ROUGH, roughness * roughness),
        };
        let texture = material.texture.map_or(0, |texture| texture + 1);
        (Self(kind | texture << Self::TEXTURE_SHIFT), parameter)
    }
}

impl Buffers {
    /// With the lights of [`LightChoice::Auto`].
    pub fn new(scene: &Scene) -> Self {
        Self::with_lights(scene, LightChoice::default())
    }

    /// With the lights that the choice selects.
    pub fn with_lights(scene: &Scene, choice: LightChoice) -> Self {
        let lights = Lights::new(scene, choice);
        let probability = |number: usize| lights.chance(number);
        let quadrics = scene.all_primitives().take(scene.first_triangle()).enumerate();
        let triangles = scene.triangles.iter().enumerate();
        let diagonal = |number: usize| lights.diagonals.get(number).copied().unwrap_or(0);
        let (mut first_normal, mut are_parallel) = (None, true);
        let triangle_rows = Rows::new(triangles.flat_map(|(number, triangle)| {
            let number_of_all = scene.first_triangle() + number;
            let rows = triangle_rows(triangle, probability(number_of_all), diagonal(number));
            let n = Vec3::new(rows[1][3], rows[1][4], rows[1][5]);
            are_parallel &= *first_normal.get_or_insert(n) == n || first_normal == Some(-n);
            rows
        }));
        Self {
            needs: Features::of(scene).with(lights.needs()),
            first_triangle: scene.first_triangle() as u32,
            quadric_rows: Rows::new(quadrics.map(|(number, one)| one.quadric_row(probability(number)))),
            are_parallel,
            triangle_rows,
            uv_rows: Rows::new(scene.triangles.iter().zip(&scene.uvs).map(uv_row)),
            material_rows: Rows::new(scene.materials.iter().map(material_row)),
            normal_rows: Rows::new(scene.normals.iter().flat_map(normal_rows)),
            tangent_rows: Rows::new(tangent_rows(scene)),
            material_extra: Rows::new(scene.materials.iter().map(detail_row)),
            has_uvs: !scene.uvs.is_empty(),
            textures: Textures::new(&scene.textures),
            sky: Sky::new(scene.sky),
            lights,
        }
    }

    /// Bytes held, without the triangles' intersection data.
    pub fn bytes(&self) -> usize {
        let Self { quadric_rows, triangle_rows, uv_rows, normal_rows, tangent_rows, .. } = self;
        let rows = [quadric_rows, triangle_rows, uv_rows, normal_rows, tangent_rows];
        let rows = rows.into_iter().chain([&self.material_rows, &self.material_extra]);
        rows.map(Rows::bytes).sum::<usize>() + self.textures.bytes() + self.lights.bytes()
    }
}

impl Sky {
    fn new(sky: scene::Sky) -> Self {
        let (bottom, rise, texture, turn) = match sky {
            scene::Sky::Color(color) => (color, Vec3::ZERO, 0, 0.0),
            scene::Sky::Gradient { bottom, top } => (bottom, top - bottom, 0, 0.0),
            scene::Sky::Texture { texture, color, turn } => (color, Vec3::ZERO, texture, turn),
        };
        Self { bottom, rise, texture, turn }
    }
}

/// See [`Buffers::triangle_rows`].
fn triangle_rows(triangle: &scene::Triangle, probability: f32, diagonal: u8) -> [[f32; 8]; 2] {
    let [a, b, c] = triangle.vertices;
    let (ab, ac) = (b - a, c - a);
    let n = triangle_normal(triangle.vertices);
    let offset = triangle_offset(triangle.vertices);
    let material = f32::from_bits(triangle.material | u32::from(diagonal) << DIAGONAL_SHIFT);
    let near_edge = surface::near_edge(triangle.vertices, offset);
    [
        [a.x, a.y, a.z, ab.x, ab.y, ab.z, offset, material],
        [ac.x, ac.y, ac.z, n.x, n.y, n.z, probability, near_edge],
    ]
}

/// See [`Buffers::material_rows`].
fn material_row(material: &scene::Material) -> [f32; 8] {
    let (code, parameter) = MaterialCode::of(material);
    let (color, emission) = (material.color, material.emission);
    [color.x, color.y, color.z, parameter, emission.x, emission.y, emission.z, f32::from_bits(code.0)]
}

/// See [`Buffers::material_extra`].
fn detail_row(material: &scene::Material) -> [f32; 8] {
    let (ior, transmitted) = match material.kind {
        MaterialKind::Plastic { ior, .. } => (ior, plastic::mean_transmittance(ior)),
        MaterialKind::MetalRough { metallic, ior, .. } => (metal_rough::normal_reflectance(ior), metallic),
        _ => (1.0, 1.0),
    };
    let code = |map: Option<u32>| f32::from_bits(map.map_or(0, |index| index + 1));
    let roughness_map = material.roughness_map.filter(|_| material.kind.has_roughness());
    let (normal_map, emission_map) = (code(material.normal_map), code(material.emission_map));
    [ior, transmitted, code(roughness_map), normal_map, emission_map, 0.0, 0.0, 0.0]
}

/// See [`Buffers::normal_rows`].
fn normal_rows([a, b, c]: &[Vec3; 3]) -> [[f32; 8]; 2] {
    [[a.x, a.y, a.z, b.x, b.y, b.z, 0.0, 0.0], [c.x, c.y, c.z, 0.0, 0.0, 0.0, 0.0, 0.0]]
}

/// See [`Buffers::uv_rows`].
fn uv_row((triangle, uvs): (&scene::Triangle, &[glam::Vec2; 3])) -> [f32; 8] {
    let [au, bu, cu] = surface::remove_shared_repeats(uvs.map(|uv| f64::from(uv.x)));
    let [av, bv, cv] = surface::remove_shared_repeats(uvs.map(|uv| 1.0 - f64::from(uv.y)));
    [au, av, bu, bv, cu, cv, surface::texture_density(triangle.vertices, *uvs), 0.0]
}

/// See [`Buffers::tangent_rows`].
fn tangent_rows(scene: &Scene) -> impl Iterator<Item = [f32; 8]> {
    let mapped =
        |triangle: &scene::Triangle| scene.materials[triangle.material as usize].normal_map.is_some();
    let any = scene.triangles.iter().any(mapped);
    scene.triangles.iter().zip(&scene.uvs).filter(move |_| any).map(|(triangle, uvs)| {
        let (tangent, hand) = surface::triangle_tangent(triangle.vertices, *uvs);
        [tangent.x, tangent.y, tangent.z, hand, 0.0, 0.0, 0.0, 0.0]
    })
}
