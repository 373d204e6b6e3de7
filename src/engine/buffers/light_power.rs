//! The power of emitters, by which next event estimation chooses among them.

use super::environment_light::EnvironmentLight;
use super::mip_chain::halve;
use crate::math::portable;
use crate::scene::{Filter, Material, MaterialKind, Primitive, Scene, Sphere, Texture};
use glam::{DVec2, DVec3, Vec2, Vec3};
use std::collections::{HashMap, HashSet};
use std::f32::consts::PI;

/// What the primitives of a scene emit.
pub(super) struct Emitted<'a> {
    scene: &'a Scene,
    /// By the index of a texture that multiplies emission.
    textures: HashMap<u32, BlockMeans<'a>>,
}

impl<'a> Emitted<'a> {
    pub(super) fn by(scene: &'a Scene) -> Self {
        let used: HashSet<u32> = scene.all_primitives().map(|primitive| primitive.material()).collect();
        let materials = used.into_iter().map(|material| &scene.materials[material as usize]);
        let emitters = materials.filter(|material| material.emission != Vec3::ZERO);
        let used: HashSet<u32> = emitters.filter_map(emission_texture).collect();
        let means = |index| (index, BlockMeans::of(&scene.textures[index as usize]));
        Self { scene, textures: used.into_iter().map(means).collect() }
    }

    /// The power that a primitive emits; 0 of a sphere around the camera, unless `surrounding` ones count.
    pub(super) fn power(&self, number: usize, surrounding: bool) -> f64 {
        match self.scene.primitive(number) {
            Primitive::Sphere(sphere) if !surrounding && surrounds(self.scene, sphere) => 0.0,
            primitive => primitive.unit_power() * self.mean_radiance(number),
        }
    }

    /// The emitted radiance of a primitive, the mean of its points and channels.
    fn mean_radiance(&self, number: usize) -> f64 {
        let material = &self.scene.materials[self.scene.primitive(number).material() as usize];
        let Some(texture) = self.texture(material) else {
            return f64::from(material.emission.element_sum()) / 3.0;
        };
        let (mut mean, mut weights) = (DVec3::ZERO, 0.0);
        let mut add = |weight: f64, texel: DVec3| {
            mean += weight * texel;
            weights += weight;
        };
        match self.scene.primitive(number) {
            Primitive::Triangle(_) => {
                let triangle = number - self.scene.first_triangle();
                let Some(uvs) = self.scene.uvs.get(triangle) else { return 0.0 };
                let (level, counts) = texture.points(sides(uvs), GRID);
                grid(counts).map(inside).for_each(|at| add(1.0, texture.mean(level, blend(uvs, at))));
            }
            _ => {
                let (level, counts) = texture.points([DVec2::X, DVec2::Y], GRID);
                // By the circumferences of its circles of latitude.
                let circle = |at: DVec2| portable::sin_cos(f64::from(PI) * at.y).0;
                grid(counts).for_each(|at| add(circle(at), texture.mean(level, at)));
            }
        }
        (material.emission.as_dvec3() * mean).element_sum() / (3.0 * weights)
    }

    /// The shares of a textured triangle's power that its [`pieces`] emit; `None` of other primitives, and of
    /// triangles that are about as bright everywhere, or whose brightness depends on the level of detail.
    pub(super) fn piece_shares(&self, number: usize, side: usize) -> Option<Vec<f64>> {
        let uvs = self.scene.uvs.get(number.checked_sub(self.scene.first_triangle())?)?;
        let material = &self.scene.materials[self.scene.primitive(number).material() as usize];
        let (texture, emission) = (self.texture(material)?, material.emission.as_dvec3());
        if texture.texture.filter == Filter::Trilinear {
            return None;
        }
        let (level, counts) = texture.points(sides(uvs).map(|whole| whole / side as f64), PIECE_GRID);
        let lookup = |uv| match texture.texture.filter {
            Filter::Bilinear if level == 0 => texture.bilinear(uv),
            _ => texture.mean(level, uv),
        };
        let radiance = |[column, row]: [usize; 2]| {
            let corner = DVec2::new(column as f64, row as f64);
            let points = grid(counts).map(|at| if column + row + 1 == side { inside(at) } else { at });
            let texels = points.map(|at| lookup(blend(uvs, (corner + at) / side as f64)));
            texels.map(|texel| texel.dot(emission)).sum::<f64>()
        };
        let area = |[column, row]: [usize; 2]| if column + row + 1 == side { 0.5 } else { 1.0 };
        let powers: Vec<f64> = pieces(side).map(|piece| area(piece) * radiance(piece)).collect();
        let mean = powers.iter().sum::<f64>() / (0.5 * (side * side) as f64);
        let floored = |(power, piece): (&f64, _)| power.max(MIN_PIECE * area(piece) * mean);
        let floored: Vec<f64> = powers.iter().zip(pieces(side)).map(floored).collect();
        let total: f64 = floored.iter().sum();
        let pays = powers
            .iter()
            .zip(pieces(side))
            .any(|(power, piece)| power / area(piece) > MIN_PIECE_CONTRAST * mean);
        pays.then(|| floored.into_iter().map(|power| power / total).collect())
    }

    fn texture(&self, material: &Material) -> Option<&BlockMeans<'a>> {
        emission_texture(material).and_then(|index| self.textures.get(&index))
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
fn emission_texture(material: &Material) -> Option<u32> {
    let of_emitter = material.texture.filter(|_| material.kind == MaterialKind::Emitter);
    material.emission_map.or(of_emitter)
}

/// Whether a texture multiplies what a primitive emits.
pub(super) fn has_texture(scene: &Scene, number: usize) -> bool {
    number < scene.primitives() && {
        let material = scene.primitive(number).material();
        emission_texture(&scene.materials[material as usize]).is_some()
    }
}

/// Points along each side of a grid over a primitive at which its texture is read, and how many times as many
/// along a side that has more texels.
const GRID: usize = 16;
const MOST_FINER: f64 = 16.0;

/// The centres of the cells of a grid of columns and rows over the unit square.
fn grid([columns, rows]: [usize; 2]) -> impl Iterator<Item = DVec2> {
    let center = move |cell| DVec2::new((cell % columns) as f64 + 0.5, (cell / columns) as f64 + 0.5);
    (0..columns * rows).map(move |cell| center(cell) / DVec2::new(columns as f64, rows as f64))
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

/// The differences of texture coordinates along two sides of a triangle.
fn sides([a, b, c]: &[Vec2; 3]) -> [DVec2; 2] {
    [*b - *a, *c - *a].map(|side| side.as_dvec2())
}

/// A texture and the means of its blocks of 2, 4, 8 … texels a side: where points that read it are farther
/// apart than texels, no bright texel lies between them.
struct BlockMeans<'a> {
    texture: &'a Texture,
    levels: Vec<([u32; 2], Vec<[f32; 3]>)>,
}

impl<'a> BlockMeans<'a> {
    fn of(texture: &'a Texture) -> Self {
        let mut levels: Vec<([u32; 2], Vec<[f32; 3]>)> = Vec::new();
        for size in texture.halved_sizes() {
            let means = match levels.last() {
                None => halve([texture.width, texture.height], size, |at| texture.texels.linear(at)),
                Some((before, means)) => halve(*before, size, |at| means[at].map(f64::from)),
            };
            levels.push((size, means.into_iter().map(|mean| mean.map(|x| x as f32)).collect()));
        }
        Self { texture, levels }
    }

    /// How to read a parallelogram of texture coordinates with these sides: the level whose blocks lie as
    /// close as the points, and how many points there are along each side, `count` or more along the longer.
    fn points(&self, sides: [DVec2; 2], count: usize) -> (usize, [usize; 2]) {
        let size = DVec2::new(f64::from(self.texture.width), f64::from(self.texture.height));
        let texels = sides.map(|side| side.abs() * size / count as f64);
        let steps = texels.map(|texels| texels.max_element());
        let finer = steps[0].min(steps[1]).max(1.0);
        let more = steps.map(|step| (step / finer).ceil().clamp(1.0, MOST_FINER));
        let step = (texels[0] / more[0] + texels[1] / more[1]).max_element();
        let block = (step.ceil() as u32).clamp(1, 1 << 16).next_power_of_two();
        ((block.ilog2() as usize).min(self.levels.len()), more.map(|more| count * more as usize))
    }

    /// The mean of the block around texture coordinates; on level 0 the texel.
    fn mean(&self, level: usize, uv: DVec2) -> DVec3 {
        let above = level.checked_sub(1).map(|above| &self.levels[above]);
        let [width, height] = above.map_or([self.texture.width, self.texture.height], |(size, _)| *size);
        let at = |x: f64, count: u32| (x.rem_euclid(1.0) * f64::from(count)) as usize % count as usize;
        let index = at(1.0 - uv.y, height) * width as usize + at(uv.x, width);
        DVec3::from_array(match above {
            None => self.texture.texels.linear(index),
            Some((_, means)) => means[index].map(f64::from),
        })
    }

    /// The mix of the four texels around texture coordinates.
    fn bilinear(&self, uv: DVec2) -> DVec3 {
        let size = DVec2::new(f64::from(self.texture.width), f64::from(self.texture.height));
        let (half, part) = (0.5 / size, (uv * size - 0.5).fract_gl());
        let at = |right: f64, up: f64| self.mean(0, uv + half * DVec2::new(right, up));
        let row = |up: f64| at(-1.0, up).lerp(at(1.0, up), part.x);
        row(-1.0).lerp(row(1.0), part.y)
    }
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
