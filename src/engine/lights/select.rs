//! Selects the lights of a scene: which emitters are sampled, which triangles are one light, and which are
//! many.

use super::parallelograms::{self, Half};
use super::portals::PortalLight;
use super::power::{Emitted, has_texture};
use super::{EnvironmentLight, LightChoice, overlaps, pieces, punctual};
use crate::math::MISS;
use crate::primitives;
use crate::primitives::flat::Flat;
use crate::primitives::light::LightRow;
use crate::scene::{Primitive, Scene, Triangle};
use std::collections::HashMap;

/// A light before it enters the table.
pub(super) struct Light {
    pub row: LightRow,
    /// The row by which [`super::choose`] weighs the light.
    pub importance: [f32; 8],
    /// The two primitives of the light, or twice the one that it is or is a piece of; [`MISS`] for lights
    /// that are no primitives, which shadow rays reach by hitting nothing.
    pub primitives: [u32; 2],
    pub power: f64,
}

/// The lights of a scene.
#[derive(Default)]
pub(super) struct Selection {
    /// The lights in the order of their primitives, then portals, those of [`Scene::lights`], and the
    /// environment as the last one.
    pub lights: Vec<Light>,
    /// The power of all lights.
    pub total: f64,
    /// See [`super::Lights`] for this field and those below.
    pub halves: HashMap<usize, Half>,
    pub first_pieces: HashMap<usize, u32>,
    pub pieces_side: usize,
    pub needs_hits: bool,
}

impl Selection {
    /// Selects the lights of a scene. Unless all are wanted, a sphere around the camera is excluded; unless
    /// lights are chosen only by power, triangles are merged into parallelograms and split into pieces. If
    /// light sampling is off, only lights are left that paths cannot hit.
    pub fn new(
        scene: &Scene,
        sky: Option<&EnvironmentLight>,
        portals: &[PortalLight],
        choice: LightChoice,
    ) -> Self {
        let emitted = Emitted::by(scene);
        let power = |number: usize| match choice {
            LightChoice::Off => 0.0,
            LightChoice::Auto | LightChoice::On | LightChoice::Power => {
                emitted.power(number, choice == LightChoice::On)
            }
        };
        let powers: Vec<f64> = (0..scene.primitives()).map(power).collect();
        let portal_power: f64 = portals.iter().map(|portal| portal.power).sum();
        // Within rooms, nearly all light of the sky comes through their portals.
        let whole_power =
            |sky: &EnvironmentLight| if portals.is_empty() { sky.power(scene) } else { portal_power };
        let sky_power = sky.map_or(0.0, whole_power);
        let punctual = punctual::lights(scene, choice);
        let others: f64 = punctual.iter().map(|light| light.power).sum();
        let total = powers.iter().sum::<f64>() + portal_power + sky_power + others;
        let mut found = Self { total, ..Self::default() };
        if found.total <= 0.0 || !found.total.is_finite() {
            return Self::default();
        }
        let merge = choice != LightChoice::Power;
        let emitters: Vec<usize> = (0..powers.len()).filter(|&number| powers[number] > 0.0).collect();
        let is_textured = |&number: &usize| has_texture(scene, number);
        let may_be_passed =
            |&number: &usize| !scene.materials[scene.primitive(number).material() as usize].is_opaque();
        found.needs_hits = emitters.iter().any(|number| is_textured(number) || may_be_passed(number))
            || overlaps::exist(scene, |number| powers[number] > 0.0);
        let is_triangle = |&number: &usize| matches!(scene.primitive(number), Primitive::Triangle(_));
        let triangles = emitters.iter().copied().filter(|number| merge && is_triangle(number));
        let textured: Vec<usize> = triangles.filter(is_textured).collect();
        let side = pieces::side(textured.len());
        found.pieces_side = side;
        let shares_of = |&number: &usize| Some((number, emitted.piece_shares(number, side)?));
        let in_pieces: HashMap<usize, Vec<f64>> =
            textured.iter().filter(|_| side > 1).filter_map(shares_of).collect();
        if merge {
            let power = |number| if in_pieces.contains_key(&number) { 0.0 } else { powers[number] };
            found.halves = parallelograms::find(scene, power);
        }
        for number in emitters {
            if let Primitive::Triangle(triangle) = scene.primitive(number) {
                found.add_triangle(scene, (number, triangle), &powers, in_pieces.get(&number));
            } else {
                let light = primitives::light_rows(scene.primitive(number), powers[number]);
                found.add(scene, [number; 2], powers[number], light);
            }
        }
        for portal in portals {
            let (row, importance) = portal.light();
            found.lights.push(Light { row, importance, primitives: [MISS; 2], power: portal.power });
        }
        found.lights.extend(punctual);
        if let Some(sky) = sky.filter(|_| sky_power > 0.0) {
            let (row, importance) = sky.light(!portals.is_empty());
            found.lights.push(Light { row, importance, primitives: [MISS; 2], power: sky_power });
        }
        found
    }

    /// Adds a triangle, or the parallelogram of which it is the first half, or its pieces, which have these
    /// shares of its power.
    fn add_triangle(
        &mut self,
        scene: &Scene,
        (number, triangle): (usize, &Triangle),
        powers: &[f64],
        shares: Option<&Vec<f64>>,
    ) {
        let half = self.halves.get(&number).copied();
        let flat = Flat::new(triangle, half.map(|half| half.corner));
        let power = powers[number];
        match (half, shares) {
            // The first half represents both.
            (Some(Half { partner, .. }), _) if partner < number => {}
            (Some(Half { partner, .. }), _) => {
                let power = power + powers[partner];
                self.add(scene, [number, partner], power, flat.light(power));
            }
            // Triangles store the index of their first piece as a float.
            (None, Some(shares)) if self.lights.len() < 1 << f32::MANTISSA_DIGITS => {
                self.first_pieces.insert(number, self.lights.len() as u32);
                for (piece, share) in flat.pieces(self.pieces_side).zip(shares) {
                    self.add(scene, [number; 2], power * share, piece.light(power * share));
                }
            }
            (None, _) => self.add(scene, [number; 2], power, flat.light(power)),
        }
    }

    /// Adds a light that consists of these primitives, or is a piece of one.
    fn add(
        &mut self,
        scene: &Scene,
        primitives: [usize; 2],
        power: f64,
        (row, importance): (LightRow, [f32; 8]),
    ) {
        let [first, second] = primitives.map(|number| scene.primitive(number));
        let emission = scene.materials[first.material() as usize].emission;
        // The halves of a parallelogram agree within the offset of either.
        let other = if primitives[0] == primitives[1] { 0.0 } else { second.shape().offset() };
        let row = LightRow { emission, offset: first.shape().offset() + other, ..row };
        self.lights.push(Light {
            row,
            importance,
            primitives: primitives.map(|number| number as u32),
            power,
        });
    }
}
