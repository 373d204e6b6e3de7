//! The lights that next event estimation samples, and the probability of choosing each. The tables are built
//! here and sampled in [`crate::light_sampling`].

use super::environment_light::EnvironmentLight;
use super::features::Features;
use super::light_power::{Emitted, has_texture, pieces, sky_power};
use super::overlaps;
use super::quads;
use super::rows::Rows;
use crate::choice::choices;
use crate::lane::{Bits, Lane};
use crate::math::MISS;
use crate::scene::{MaterialKind, Primitive, Scene};
use glam::DVec3;
use std::collections::HashMap;
use std::f32::consts::PI;

choices! {
    /// Which emitters next event estimation samples. Paths also hit emitters by scattering.
    pub enum LightChoice {
        #[default]
        Auto = "auto",
            "Emitters whose sampling pays: no sphere around the scene, none where all is mirrors and glass.";
        On = "on", "Every emitter that can be sampled.";
        Power = "power",
            "As auto, but chosen by power alone, every triangle by itself.";
        Off = "off", "None: paths hit emitters by scattering alone.";
    }
}

/// The lights that next event estimation samples.
///
/// Two triangles that make a parallelogram are one light; a triangle whose texture is much brighter in places
/// is a light for each of its pieces. Each is chosen with a probability of its share of all power, but at
/// least `MIN_SHARE`, in constant time by an alias table: Walker, "An Efficient Method for Generating
/// Discrete Random Variables with General Distributions", ACM TOMS 3(3), 1977; the table by Vose, IEEE TSE
/// 17(9), 1991.
#[derive(Clone, Debug, Default)]
pub struct Lights {
    /// Two rows of eight a light. Sphere: centre, radius, emission, probability; 0 (seven times), offset of
    /// shadow rays that end there. Triangle: a, 0, emission, probability; ab, ac, 1 if it is continued to the
    /// parallelogram with these edges, else 0, offset. Sky, the last one: 0 (three times), [`SKY_RADIUS`], 0
    /// (three times), probability; zeros.
    pub(crate) rows: Rows,
    pub(crate) alias_table: AliasTable,
    /// What [`Lights::compare`] and [`Lights::resample`] weigh lights by; empty if they are chosen by power
    /// alone: one light, or more than [`Lights::MAX_COMPARED`] and at most `MAX_SHARED`. One row of eight a
    /// light: centre, radius of a sphere around it, unit normal of a flat one or else 0, and its power over
    /// 4π, or over 2π of a flat one. The sky, the last one: 0 (three times), [`SKY_RADIUS`], 0 (three times),
    /// the mean irradiance.
    pub(crate) importance_rows: Rows,
    /// The probability of choosing the light that each primitive of the scene is or belongs to, spheres
    /// first, and the sky; empty without lights.
    pub probabilities: Vec<f32>,
    /// Of each triangle that is half of a parallelogram: one more than the index of the vertex opposite the
    /// other half; else 0. Empty where no triangle is.
    pub diagonals: Vec<u8>,
    /// The environment light, if it is one of the lights, and the probability of choosing it.
    pub sky: Option<(EnvironmentLight, f32)>,
    /// The light that is the first piece of each triangle sampled in pieces; the others follow.
    pub(crate) first_pieces: HashMap<usize, u32>,
    /// Pieces along an edge of such a triangle.
    pub(crate) pieces_side: usize,
    /// The two primitives that each light is, or twice the one; [`MISS`] of the sky. Only where a light has a
    /// texture, or lies in another primitive's surface: what a shadow ray hits then decides what it adds.
    primitives: Vec<u32>,
}

/// One slot of equal width a light: a number within the slot's width chooses the slot's own light below
/// `threshold`, its alias from there on.
#[derive(Clone, Debug, Default)]
pub(crate) struct AliasTable {
    /// Fractions of the slot's width, as bits.
    pub(crate) threshold: Vec<u32>,
    pub(crate) alias: Vec<u32>,
}

/// In the place of a radius: marks the environment light.
const SKY_RADIUS: f32 = -1.0;
/// From this [`EnvironmentLight::contrast`] on it pays to sample the sky's bright regions.
const MIN_CONTRAST: f64 = 2.0;

/// The least probability of choosing a light, as a share of the average. Random numbers have 24 binary
/// digits: a light that few or none of them choose is sampled more or less often than its probability, and
/// only at some of its points. A light beside one 10⁹ times as bright would contribute 59 times its power
/// (`tests/laws/choosing.rs`). Costs no more than this share of all shadow rays.
const MIN_SHARE: f64 = 1.0 / 64.0;

/// Most pieces of all triangles together, and along an edge of one.
const MAX_PIECES: usize = 1 << 16;
const MAX_SIDE: usize = 16;

/// A light before it is a row.
#[derive(Clone, Copy)]
struct Light {
    /// The primitive, or the first half of a parallelogram.
    number: usize,
    power: f64,
    /// The vertex opposite the other half.
    corner: Option<usize>,
    /// Column and row of a piece.
    piece: Option<[usize; 2]>,
}

impl Lights {
    /// Most lights whose rows fit the register form.
    pub const FEW: usize = Rows::FEW / 2;
    /// Most lights for which the number that chooses a light has binary digits enough left for a point on it:
    /// 18 on average, and 12 for a light of the least probability ([`MIN_SHARE`]).
    pub(crate) const MAX_SHARED: usize = 64;
    /// Most lights that are compared one by one: 1.5 to 1.9 times less time to equal error in a room with 3
    /// to 8 lights, and with 16 of them 0.9 (rough metal) to 1.35.
    pub const MAX_COMPARED: usize = Rows::FEW;

    /// The lights of a scene that the choice selects.
    pub fn new(scene: &Scene, choice: LightChoice) -> Self {
        let primitives = scene.primitives();
        if choice == LightChoice::Off || !anything_scatters(scene) {
            return Self::default();
        }
        let all = choice == LightChoice::On;
        let emitted = Emitted::by(scene);
        let mut powers: Vec<f64> = (0..primitives).map(|number| emitted.power(number, all)).collect();
        let sky = EnvironmentLight::of(scene).filter(|sky| all || sky.contrast >= MIN_CONTRAST);
        powers.push(sky.as_ref().map_or(0.0, |sky| sky_power(scene, sky)));
        let total: f64 = powers.iter().sum();
        if total <= 0.0 || !total.is_finite() {
            return Self::default();
        }
        let quadrics = scene.first_triangle();
        let merge = choice != LightChoice::Power;
        let is_textured = |&number: &usize| merge && powers[number] > 0.0 && has_texture(scene, number);
        let textured: Vec<usize> = (quadrics..primitives).filter(is_textured).collect();
        let mut side = MAX_SIDE;
        while textured.len() * side * side > MAX_PIECES {
            side /= 2;
        }
        let shares_of = |&number: &usize| Some((number, emitted.piece_shares(number, side)?));
        let in_pieces: HashMap<usize, Vec<f64>> =
            if side > 1 { textured.iter().filter_map(shares_of).collect() } else { HashMap::new() };
        let whole = |triangle: usize| match in_pieces.get(&(quadrics + triangle)) {
            Some(_) => 0.0,
            None => powers[quadrics + triangle],
        };
        let halves = if merge { quads::find(scene, whole) } else { HashMap::new() };
        // The first half of each parallelogram stands for both.
        let partner =
            |number: usize| halves.get(&number.wrapping_sub(quadrics)).map(|half| quadrics + half.partner);
        let first = |number: usize| partner(number).map_or(number, |other| number.min(other));
        let mut light_powers = vec![0.0; powers.len()];
        powers.iter().enumerate().for_each(|(number, power)| light_powers[first(number)] += power);
        let mut lights = Vec::new();
        let mut first_pieces = HashMap::new();
        for number in (0..=primitives).filter(|&number| light_powers[number] > 0.0) {
            let corner = halves.get(&number.wrapping_sub(quadrics)).map(|half| half.corner);
            let light = Light { number, power: light_powers[number], corner, piece: None };
            // Triangles store the number of their first piece as a float.
            if let Some(shares) = in_pieces.get(&number)
                && lights.len() < 1 << f32::MANTISSA_DIGITS
            {
                first_pieces.insert(number, lights.len() as u32);
                let of_piece =
                    |(share, piece)| Light { power: light.power * share, piece: Some(piece), ..light };
                lights.extend(shares.iter().zip(pieces(side)).map(of_piece));
            } else {
                lights.push(light);
            }
        }
        let shares = shares(lights.iter().map(|light| light.power / total).collect());
        let mut probabilities = vec![0.0; powers.len()];
        lights.iter().zip(&shares).for_each(|(light, &share)| probabilities[light.number] += share as f32);
        (0..powers.len()).for_each(|number| probabilities[number] = probabilities[first(number)]);
        let mut diagonals = vec![0; if halves.is_empty() { 0 } else { scene.triangles.len() }];
        halves.iter().for_each(|(&triangle, half)| diagonals[triangle] = half.corner as u8 + 1);
        let is_few = (2..=Self::MAX_COMPARED).contains(&lights.len());
        let hits_decide = lights.iter().any(|light| has_texture(scene, light.number))
            || overlaps::exist(scene, |number| powers[number] > 0.0);
        let primitives_of = |light: &Light| match light.number {
            sky if sky == primitives => [MISS; 2],
            number => [number, partner(number).unwrap_or(number)].map(|number| number as u32),
        };
        let by_irradiance = merge && (is_few || lights.len() > Self::MAX_SHARED);
        let important = lights.iter().filter(|_| by_irradiance);
        Self {
            importance_rows: Rows::new(
                important.map(|light| importance_row(scene, light, light.flat(scene, side), sky.as_ref())),
            ),
            rows: Rows::new(lights.iter().zip(&shares).flat_map(|(light, &share)| {
                let offset =
                    partner(light.number).map_or(0.0, |other| scene.primitive(other).shape().offset());
                rows(scene, light.number, share as f32, light.flat(scene, side), offset)
            })),
            first_pieces,
            pieces_side: side,
            alias_table: AliasTable::new(&shares),
            sky: sky.map(|sky| (sky, probabilities[primitives])),
            probabilities,
            diagonals,
            primitives: if hits_decide {
                lights.iter().flat_map(primitives_of).collect()
            } else {
                Vec::new()
            },
        }
    }
    /// What triangles store: the probability of choosing the primitive, or of one sampled in pieces minus one
    /// more than the light that is its first piece.
    pub(crate) fn chance(&self, number: usize) -> f32 {
        match self.first_pieces.get(&number) {
            Some(&first) => -((first + 1) as f32),
            None => self.probabilities.get(number).copied().unwrap_or(0.0),
        }
    }
    /// Whether what shadow rays hit decides what they add, and not whether something is in their way.
    pub fn hits_decide(&self) -> bool {
        !self.primitives.is_empty()
    }
    /// Whether each light is this primitive, or ([`MISS`]) the sky. Domain: [`Lights::hits_decide`].
    pub(crate) fn are<L: Lane>(&self, light: L::Bits, primitive: L::Bits) -> L::Mask {
        let first = light.shl(1);
        let [one, other] = [first, first | L::Bits::splat(1)].map(|at| L::gather_bits(&self.primitives, at));
        primitive.equals(one) | primitive.equals(other)
    }
    /// Whether [`Lights::compare`] or [`Lights::resample`] chooses among them, and not [`Lights::choose`].
    #[inline(always)]
    pub fn are_chosen_by_irradiance(&self) -> bool {
        !self.importance_rows.is_empty()
    }
    /// The features that sampling them needs of a pipeline.
    pub fn needs(&self) -> Features {
        match self.len() {
            0 => Features::NONE,
            count if count > Self::FEW => Features::LIGHTS.with(Features::MANY_LIGHTS),
            _ => Features::LIGHTS,
        }
    }
    /// The number of lights that are sampled.
    pub fn len(&self) -> usize {
        self.alias_table.alias.len()
    }
    /// Whether no light is sampled.
    pub fn is_empty(&self) -> bool {
        self.alias_table.alias.is_empty()
    }
    /// Memory of the tables.
    pub fn bytes(&self) -> usize {
        self.rows.bytes()
            + self.importance_rows.bytes()
            + size_of_val(self.alias_table.alias.as_slice()) * 2
            + size_of_val(self.probabilities.as_slice())
            + size_of_val(self.diagonals.as_slice())
            + size_of_val(self.primitives.as_slice())
            + self.sky.as_ref().map_or(0, |(sky, _)| sky.bytes())
    }
}

/// Whether some surface scatters light into other directions than those of mirror reflection and refraction.
fn anything_scatters(scene: &Scene) -> bool {
    scene.materials.iter().any(|material| match material.kind {
        MaterialKind::Emitter | MaterialKind::Glass { .. } | MaterialKind::ThinGlass { .. } => false,
        MaterialKind::Metal { roughness } => roughness > 0.0,
        _ => true,
    })
}

impl Light {
    /// Of a flat light: its first vertex, the edges from there, and whether it is a parallelogram.
    fn flat(&self, scene: &Scene, side: usize) -> Option<([DVec3; 3], bool)> {
        let triangle = self.number.checked_sub(scene.first_triangle())?;
        let vertices = scene.triangles.get(triangle)?.vertices;
        let vertex = |index: usize| vertices[(self.corner.unwrap_or(0) + index) % 3].as_dvec3();
        let (a, ab, ac) = (vertex(0), vertex(1) - vertex(0), vertex(2) - vertex(0));
        let Some([column, row]) = self.piece else { return Some(([a, ab, ac], self.corner.is_some())) };
        let part = 1.0 / side as f64;
        let first = a + (ab * column as f64 + ac * row as f64) * part;
        Some(([first, ab * part, ac * part], column + row + 1 < side))
    }
}

/// See [`Lights::rows`]. `offset` is that of a parallelogram's other half.
fn rows(
    scene: &Scene,
    number: usize,
    probability: f32,
    flat: Option<([DVec3; 3], bool)>,
    offset: f32,
) -> [[f32; 8]; 2] {
    if number == scene.primitives() {
        return [[0.0, 0.0, 0.0, SKY_RADIUS, 0.0, 0.0, 0.0, probability], [0.0; 8]];
    }
    let primitive = scene.primitive(number);
    let (points, radius) = primitive.hull();
    let e = scene.materials[primitive.material() as usize].emission;
    match (primitive, flat) {
        (Primitive::Triangle(_), Some((edges, is_quad))) => {
            let [a, ab, ac] = edges.map(|edge| edge.as_vec3());
            // The halves of a parallelogram agree within the offset of either.
            let offset = primitive.shape().offset() + offset;
            let is_quad = f32::from(u8::from(is_quad));
            [
                [a.x, a.y, a.z, 0.0, e.x, e.y, e.z, probability],
                [ab.x, ab.y, ab.z, ac.x, ac.y, ac.z, is_quad, offset],
            ]
        }
        // All other lights are spheres.
        _ => [
            [points[0].x, points[0].y, points[0].z, radius, e.x, e.y, e.z, probability],
            [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, primitive.shape().offset()],
        ],
    }
}

/// See [`Lights::importance_rows`].
fn importance_row(
    scene: &Scene,
    &Light { number, power, .. }: &Light,
    flat: Option<([DVec3; 3], bool)>,
    sky: Option<&EnvironmentLight>,
) -> [f32; 8] {
    if number == scene.primitives() {
        let irradiance = f64::from(PI) * sky.map_or(0.0, |sky| sky.mean);
        return [0.0, 0.0, 0.0, SKY_RADIUS, 0.0, 0.0, 0.0, irradiance as f32];
    }
    let power = power / f64::from(PI);
    match flat {
        Some(([a, ab, ac], is_quad)) => {
            let (b, c) = (a + ab, a + ac);
            let center = if is_quad { 0.5 * (b + c) } else { (a + b + c) / 3.0 };
            let radius = [a, b, c].map(|vertex| (vertex - center).length()).into_iter().fold(0.0, f64::max);
            let n = ab.cross(ac).normalize().as_vec3();
            let center = center.as_vec3();
            [center.x, center.y, center.z, radius as f32, n.x, n.y, n.z, (0.5 * power) as f32]
        }
        None => {
            let (points, radius) = scene.primitive(number).hull();
            [points[0].x, points[0].y, points[0].z, radius, 0.0, 0.0, 0.0, (0.25 * power) as f32]
        }
    }
}

/// The probabilities of lights with these shares of all power: the shares, but none below [`MIN_SHARE`] of
/// the average.
fn shares(mut shares: Vec<f64>) -> Vec<f64> {
    let least = MIN_SHARE / shares.len() as f64;
    shares.iter_mut().for_each(|share| *share = share.max(least));
    let total: f64 = shares.iter().sum();
    shares.into_iter().map(|share| share / total).collect()
}

impl AliasTable {
    fn new(shares: &[f64]) -> Self {
        let count = shares.len();
        let mut rest: Vec<f64> = shares.iter().map(|share| share * count as f64).collect();
        let mut threshold = vec![1f32.to_bits(); count];
        let mut alias: Vec<u32> = (0..count as u32).collect();
        let (mut small, mut large): (Vec<usize>, Vec<usize>) = (0..count).partition(|&slot| rest[slot] < 1.0);
        while let (Some(&short), Some(&long)) = (small.last(), large.last()) {
            small.pop();
            threshold[short] = (rest[short] as f32).to_bits();
            alias[short] = long as u32;
            rest[long] -= 1.0 - rest[short];
            if rest[long] < 1.0 {
                large.pop();
                small.push(long);
            }
        }
        // The slots left over are full but for rounding.
        Self { threshold, alias }
    }
}
