//! The power of emitters, by which next event estimation chooses among them.

use super::environment_light::EnvironmentLight;
use crate::math::portable;
use crate::scene::{Filter, Material, MaterialKind, Primitive, Scene, Sphere, Texture};
use glam::{DVec2, DVec3, Vec2};
use std::f32::consts::PI;

/// The power that a primitive emits; 0 of a sphere around the camera, unless `surrounding` ones count.
pub(super) fn power_of(scene: &Scene, number: usize, surrounding: bool) -> f64 {
    match scene.primitive(number) {
        Primitive::Sphere(sphere) if !surrounding && surrounds(scene, sphere) => 0.0,
        primitive => {
            let material = &scene.materials[primitive.material() as usize];
            primitive.unit_power() * mean_emission(scene, number, material)
        }
    }
}

/// The power that arrives from the sky at a sphere around the scene.
pub(super) fn sky_power(scene: &Scene, sky: &EnvironmentLight) -> f64 {
    let (lower, upper) = scene.bounds();
    let radius = (upper - lower).length() / 2.0;
    4.0 * f64::from(PI) * f64::from(PI) * radius * radius * sky.mean
}

/// Whether the camera is within this sphere: then every ray that misses the other primitives hits it.
fn surrounds(scene: &Scene, sphere: &Sphere) -> bool {
    let to = scene.camera.position.as_dvec3() - sphere.center.as_dvec3();
    to.length() < f64::from(sphere.radius)
}

/// The texture that multiplies a material's emission.
fn emission_texture<'a>(scene: &'a Scene, material: &Material) -> Option<&'a Texture> {
    let of_emitter = material.texture.filter(|_| material.kind == MaterialKind::Emitter);
    material.emission_map.or(of_emitter).map(|index| &scene.textures[index as usize])
}

/// Whether a texture multiplies what a primitive emits.
pub(super) fn has_texture(scene: &Scene, number: usize) -> bool {
    number < scene.primitives() && {
        let material = scene.primitive(number).material();
        emission_texture(scene, &scene.materials[material as usize]).is_some()
    }
}

/// Points along each side of a grid over a primitive at which its texture is read.
const GRID: usize = 16;

/// The centres of the cells of a grid over the unit square.
fn grid(side: usize) -> impl Iterator<Item = DVec2> {
    let center = move |cell| DVec2::new((cell % side) as f64 + 0.5, (cell / side) as f64 + 0.5);
    (0..side * side).map(move |cell| center(cell) / side as f64)
}

/// A point of the unit square in its lower triangle.
fn inside(at: DVec2) -> DVec2 {
    if at.x + at.y > 1.0 { DVec2::ONE - at } else { at }
}

/// The texture coordinates of a triangle at barycentrics.
fn blend(uvs: &[Vec2; 3], at: DVec2) -> DVec2 {
    let [a, b, c] = uvs.map(|uv| uv.as_dvec2());
    a + (b - a) * at.x + (c - a) * at.y
}

/// The texel at texture coordinates.
fn texel(texture: &Texture, uv: DVec2) -> DVec3 {
    let at = |x: f64, count: u32| (x.rem_euclid(1.0) * f64::from(count)) as usize % count as usize;
    let (column, row) = (at(uv.x, texture.width), at(1.0 - uv.y, texture.height));
    DVec3::from_array(texture.texels.linear(row * texture.width as usize + column))
}

/// The mix of the four texels around texture coordinates.
fn bilinear(texture: &Texture, uv: DVec2) -> DVec3 {
    let size = DVec2::new(f64::from(texture.width), f64::from(texture.height));
    let (half, part) = (0.5 / size, (uv * size - 0.5).fract_gl());
    let at = |right: f64, up: f64| texel(texture, uv + half * DVec2::new(right, up));
    let row = |up: f64| at(-1.0, up).lerp(at(1.0, up), part.x);
    row(-1.0).lerp(row(1.0), part.y)
}

/// From this ratio of the brightest piece to the mean on, sampling a triangle in pieces pays. Choosing among
/// so many lights halves the speed of a small scene; at a ratio of 2 (a chessboard) the time to equal error
/// is the same, at 32 it is a thirteenth.
const MIN_PIECE_CONTRAST: f64 = 4.0;
/// The least power of a piece, as a share of its triangle's mean: its points may have missed a bright texel.
const MIN_PIECE: f64 = 1.0 / 16.0;
/// Points along each side of a piece at which its texture is read.
const PIECE_GRID: usize = 4;

/// The columns and rows of a triangle's pieces: parallelograms, and at the end of each row a triangle.
pub(super) fn pieces(side: usize) -> impl Iterator<Item = [usize; 2]> {
    (0..side).flat_map(move |row| (0..side - row).map(move |column| [column, row]))
}

/// The shares of a textured triangle's power that its [`pieces`] emit; `None` of other primitives, and of
/// triangles that are about as bright everywhere, or whose brightness depends on the level of detail.
pub(super) fn piece_shares(scene: &Scene, number: usize, side: usize) -> Option<Vec<f64>> {
    let uvs = scene.uvs.get(number.checked_sub(scene.first_triangle())?)?;
    let material = &scene.materials[scene.primitive(number).material() as usize];
    let (texture, emission) = (emission_texture(scene, material)?, material.emission.as_dvec3());
    let lookup = match texture.filter {
        Filter::Nearest => texel,
        Filter::Bilinear => bilinear,
        Filter::Trilinear => return None,
    };
    let radiance = |[column, row]: [usize; 2]| {
        let corner = DVec2::new(column as f64, row as f64);
        let points = grid(PIECE_GRID).map(|at| if column + row + 1 == side { inside(at) } else { at });
        let texels = points.map(|at| lookup(texture, blend(uvs, (corner + at) / side as f64)));
        texels.map(|texel| texel.dot(emission)).sum::<f64>()
    };
    let area = |[column, row]: [usize; 2]| if column + row + 1 == side { 0.5 } else { 1.0 };
    let powers: Vec<f64> = pieces(side).map(|piece| area(piece) * radiance(piece)).collect();
    let mean = powers.iter().sum::<f64>() / (0.5 * (side * side) as f64);
    let floored = |(power, piece): (&f64, _)| power.max(MIN_PIECE * area(piece) * mean);
    let floored: Vec<f64> = powers.iter().zip(pieces(side)).map(floored).collect();
    let total: f64 = floored.iter().sum();
    let pays =
        powers.iter().zip(pieces(side)).any(|(power, piece)| power / area(piece) > MIN_PIECE_CONTRAST * mean);
    pays.then(|| floored.into_iter().map(|power| power / total).collect())
}

/// The emitted radiance of a primitive, the mean of its points and channels.
fn mean_emission(scene: &Scene, number: usize, material: &Material) -> f64 {
    let Some(texture) = emission_texture(scene, material) else {
        return f64::from(material.emission.element_sum()) / 3.0;
    };
    let texel = |uv| texel(texture, uv);
    let cells = grid(GRID);
    let (mut mean, mut weights) = (DVec3::ZERO, 0.0);
    let mut add = |weight: f64, texel: DVec3| {
        mean += weight * texel;
        weights += weight;
    };
    match scene.primitive(number) {
        Primitive::Triangle(_) => {
            let Some(uvs) = scene.uvs.get(number - scene.first_triangle()) else { return 0.0 };
            cells.map(inside).for_each(|at| add(1.0, texel(blend(uvs, at))));
        }
        // By the circumferences of its circles of latitude.
        _ => cells.for_each(|at| add(portable::sin_cos(f64::from(PI) * at.y).0, texel(at))),
    }
    (material.emission.as_dvec3() * mean).element_sum() / (3.0 * weights)
}
