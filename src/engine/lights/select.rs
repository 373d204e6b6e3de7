//! Selects the lights of a scene: which emitters are sampled, which triangles are one light, and which are
//! many.

use super::flat::Flat;
use super::importance::Importance;
use super::parallelograms::{self, Half};
use super::power::{Emitted, has_texture};
use super::table::LightRow;
use super::{EnvironmentLight, LightChoice, overlaps, pieces, sphere};
use crate::math::MISS;
use crate::rays::Kind;
use crate::scene::{MaterialKind, Primitive, Scene, Sphere};
use std::collections::HashMap;

/// From this [`EnvironmentLight::contrast`] on it pays to sample the sky's bright regions.
const MIN_CONTRAST: f64 = 2.0;

/// A light before it is a row of the table.
#[derive(Clone, Copy)]
pub(super) struct Light<'a> {
    pub shape: Shape<'a>,
    /// The two primitives that it is, or twice the one that it is or is a piece of; [`MISS`] of the
    /// environment.
    pub primitives: [u32; 2],
    /// As a share of the power of all lights.
    pub share: f64,
    power: f64,
}

/// What a light is, by its kind.
#[derive(Clone, Copy)]
pub(super) enum Shape<'a> {
    Sphere(&'a Sphere),
    Flat(Flat),
    Environment(&'a EnvironmentLight),
}

impl Light<'_> {
    /// Returns its row of the table, but for its probability.
    pub fn row(&self, scene: &Scene) -> LightRow {
        let [first, second] = self.primitives;
        let offset = |number: u32| scene.primitive(number as usize).shape().offset();
        let row = match self.shape {
            Shape::Sphere(sphere) => sphere::row(sphere, offset(first)),
            // The halves of a parallelogram agree within the offset of either.
            Shape::Flat(flat) if second != first => flat.row(offset(first) + offset(second)),
            Shape::Flat(flat) => flat.row(offset(first)),
            Shape::Environment(_) => return EnvironmentLight::row(),
        };
        let material = scene.primitive(first as usize).material();
        LightRow { emission: scene.materials[material as usize].emission, ..row }
    }

    /// Returns what it is weighed by.
    pub fn importance(&self) -> Importance {
        match self.shape {
            Shape::Sphere(sphere) => sphere::importance(sphere, self.power),
            Shape::Flat(flat) => flat.importance(self.power),
            Shape::Environment(sky) => sky.importance(),
        }
    }
}

/// The lights of a scene.
#[derive(Default)]
pub(super) struct Selection<'a> {
    /// In the order of their primitives; the environment is the last one.
    pub lights: Vec<Light<'a>>,
    /// Of each primitive that is half of a parallelogram, the vertex opposite the other half.
    pub halves: HashMap<usize, usize>,
    /// The light that is the first piece of each primitive sampled in pieces; the others follow.
    pub first_pieces: HashMap<usize, u32>,
    /// Pieces along an edge of such a triangle.
    pub pieces_side: usize,
    /// See [`super::Lights::needs_hits`].
    pub needs_hits: bool,
}

impl<'a> Selection<'a> {
    /// Selects lights. `sky` is the environment light that [`environment`] returned.
    pub fn new(scene: &'a Scene, sky: Option<&'a EnvironmentLight>, choice: LightChoice) -> Self {
        let emitted = Emitted::by(scene);
        let power = |number: usize| emitted.power(number, choice == LightChoice::On);
        let powers: Vec<f64> = (0..scene.primitives()).map(power).collect();
        let sky = sky.map(|sky| (sky, sky.power(scene)));
        let total = powers.iter().sum::<f64>() + sky.map_or(0.0, |(_, power)| power);
        if total <= 0.0 || !total.is_finite() {
            return Self::default();
        }
        let mut found = Self::default();
        found.add_primitives(&emitted, &powers, choice != LightChoice::Power);
        if let Some((sky, power)) = sky.filter(|(_, power)| *power > 0.0) {
            found.lights.push(Light {
                shape: Shape::Environment(sky),
                primitives: [MISS; 2],
                share: 0.0,
                power,
            });
        }
        found.lights.iter_mut().for_each(|light| light.share = light.power / total);
        found.needs_hits = (0..powers.len()).any(|number| powers[number] > 0.0 && has_texture(scene, number))
            || overlaps::exist(scene, |number| powers[number] > 0.0);
        found
    }

    /// Adds the lights among primitives that emit `powers`. Where `merge` is true, triangles are merged into
    /// parallelograms and split into pieces.
    fn add_primitives(&mut self, emitted: &Emitted<'a>, powers: &[f64], merge: bool) {
        let scene = emitted.scene;
        let first_triangle = scene.counts().first(Kind::Triangle);
        let is_textured = |&number: &usize| merge && powers[number] > 0.0 && has_texture(scene, number);
        let textured: Vec<usize> = (first_triangle..powers.len()).filter(is_textured).collect();
        let side = pieces::side(textured.len());
        self.pieces_side = side;
        let shares_of = |&number: &usize| Some((number, emitted.piece_shares(number, side)?));
        let mut in_pieces: HashMap<usize, Vec<f64>> =
            textured.iter().filter(|_| side > 1).filter_map(shares_of).collect();
        let power_of_whole = |triangle: usize| match in_pieces.contains_key(&(first_triangle + triangle)) {
            true => 0.0,
            false => powers[first_triangle + triangle],
        };
        let halves = if merge { parallelograms::find(scene, power_of_whole) } else { HashMap::new() };
        for (number, &power) in powers.iter().enumerate().filter(|(_, power)| **power > 0.0) {
            let whole = Light {
                shape: shape(scene, number, None),
                primitives: [number as u32; 2],
                share: 0.0,
                power,
            };
            match number.checked_sub(first_triangle).and_then(|triangle| halves.get(&triangle)) {
                None => self.add(whole, in_pieces.remove(&number)),
                Some(&Half { partner, corner }) => {
                    let partner = first_triangle + partner;
                    self.halves.insert(number, corner);
                    // The first half stands for both.
                    if number < partner {
                        let shape = shape(scene, number, Some(corner));
                        let primitives = [number as u32, partner as u32];
                        self.lights.push(Light {
                            shape,
                            primitives,
                            power: power + powers[partner],
                            ..whole
                        });
                    }
                }
            }
        }
    }

    /// Adds a light, or one for each of its pieces, which have these shares of its power.
    fn add(&mut self, whole: Light<'a>, pieces: Option<Vec<f64>>) {
        match (whole.shape, pieces) {
            // Triangles store the index of their first piece as a float.
            (Shape::Flat(flat), Some(shares)) if self.lights.len() < 1 << f32::MANTISSA_DIGITS => {
                let first = self.lights.len() as u32;
                self.first_pieces.insert(whole.primitives[0] as usize, first);
                let pieces = flat.pieces(self.pieces_side).zip(shares);
                let light =
                    |(piece, share)| Light { shape: Shape::Flat(piece), power: whole.power * share, ..whole };
                self.lights.extend(pieces.map(light));
            }
            (Shape::Sphere(_) | Shape::Flat(_) | Shape::Environment(_), _) => self.lights.push(whole),
        }
    }
}

/// Returns a primitive as a light; `corner` is that of a half.
fn shape(scene: &Scene, number: usize, corner: Option<usize>) -> Shape<'_> {
    match scene.primitive(number) {
        Primitive::Sphere(sphere) => Shape::Sphere(sphere),
        Primitive::Triangle(triangle) => Shape::Flat(Flat::new(triangle, corner)),
    }
}

/// Returns the environment as a light, if the choice selects it.
pub(super) fn environment(scene: &Scene, choice: LightChoice) -> Option<EnvironmentLight> {
    let pays = |sky: &EnvironmentLight| choice == LightChoice::On || sky.contrast >= MIN_CONTRAST;
    EnvironmentLight::of(scene).filter(pays)
}

/// Tests whether some surface scatters light into other directions than those of mirror reflection and
/// refraction.
pub(super) fn anything_scatters(scene: &Scene) -> bool {
    scene.materials.iter().any(|material| match material.kind {
        MaterialKind::Emitter | MaterialKind::Glass { .. } | MaterialKind::ThinGlass { .. } => false,
        MaterialKind::Metal { roughness } => roughness > 0.0,
        _ => true,
    })
}
