//! The table of lights: their rows, the probability of choosing each, and how each primitive is sampled.

use super::alias_table::AliasTable;
use super::parallelograms::Half;
use super::select::Selection;
use super::{EnvironmentLight, LightChoice, Portals, Sun, portals, punctual};
use crate::buffers::Features;
use crate::buffers::rows::Rows;
use crate::lane::{Bits, Lane};
use crate::math::MISS;
use crate::primitives::light::{LightKind, LightRow, LightTable, SampledAs};
use crate::scene::{MaterialKind, Scene};
use glam::Vec3;
use std::collections::HashMap;

/// The lights that next event estimation samples.
///
/// Two triangles that make a parallelogram are one light; a triangle whose texture is much brighter in places
/// is a light for each of its pieces. The probability of choosing a light is its share of all power, but at
/// least `MIN_SHARE`.
#[derive(Clone, Debug, Default)]
pub struct Lights {
    /// The rows of the lights.
    pub table: LightTable,
    pub(super) alias_table: AliasTable,
    /// The rows of eight by which [`Lights::compare`] and [`Lights::resample`] weigh lights; empty if lights
    /// are chosen only by power: one light, or more than [`Lights::MAX_COMPARED`] and at most `MAX_SHARED`.
    pub(super) importance_rows: Rows,
    /// The probability of choosing the light that each primitive of the scene is or belongs to, spheres
    /// first; empty without lights.
    pub probabilities: Vec<f32>,
    /// The environment light, if it is one of the lights, and the probability of choosing it.
    pub sky: Option<(EnvironmentLight, f32)>,
    /// The portals, which follow the lights of primitives.
    pub portals: Portals,
    /// The discs of directional lights, sampled or not.
    pub suns: Vec<Sun>,
    /// The triangles that are halves of parallelograms.
    halves: HashMap<usize, Half>,
    /// The light that is the first piece of each triangle sampled in pieces; the others follow.
    first_pieces: HashMap<usize, u32>,
    /// The two primitives of each light, or twice the one; stored only if [`Lights::needs_hits`].
    primitives: Vec<u32>,
}

/// From this [`EnvironmentLight::contrast`] on, sampling the sky's bright regions pays.
const MIN_CONTRAST: f64 = 2.0;

/// The least probability of choosing a light, as a share of the average. Random numbers have 24 binary
/// digits: a light that few or none of them choose is sampled more or less often than its probability, and
/// only at some of its points. A light beside one 10⁹ times as bright would contribute 59 times its power
/// (`tests/laws/choosing.rs`). The limit costs no more than this share of all shadow rays.
const MIN_SHARE: f64 = 1.0 / 64.0;

impl Lights {
    /// The largest number of lights for which the number that chooses a light has enough binary digits left
    /// for a point on it: 18 on average, and 12 for a light of the least probability ([`MIN_SHARE`]).
    pub(super) const MAX_SHARED: usize = 64;
    /// The largest number of lights that are compared one by one: 1.5 to 1.9 times less time to equal error
    /// in a room with 3 to 8 lights, and with 16 of them 0.9 (rough metal) to 1.35.
    pub const MAX_COMPARED: usize = Rows::FEW;

    /// Builds the table of the lights of a scene that the choice selects.
    pub fn new(scene: &Scene, choice: LightChoice) -> Self {
        let none = || Self { suns: punctual::suns(scene, std::iter::empty()), ..Self::default() };
        let is_off = choice == LightChoice::Off;
        if is_off && scene.lights.is_empty() || !anything_scatters(scene) {
            return none();
        }
        let pays = |sky: &EnvironmentLight| choice == LightChoice::On || sky.contrast >= MIN_CONTRAST;
        let sky = EnvironmentLight::of(scene).filter(|_| !is_off);
        let portals = if is_off { Vec::new() } else { portals::lights(scene, sky.as_ref()) };
        let sky = sky.filter(pays);
        let selection = Selection::new(scene, sky.as_ref(), &portals, choice);
        let Selection { lights, total, halves, first_pieces, pieces_side, needs_hits } = selection;
        if lights.is_empty() {
            return none();
        }
        let shares = raised_shares(lights.iter().map(|light| light.power / total).collect());
        let portals = Portals::new(portals, &lights, &shares);
        let (mut probabilities, mut sky_probability) = (vec![0.0; scene.primitives()], 0.0);
        for (light, &share) in lights.iter().zip(&shares) {
            match (light.row.kind, light.primitives.map(|number| number as usize)) {
                (LightKind::Environment, _) => sky_probability = share as f32,
                (LightKind::Portal | LightKind::Point | LightKind::Distant, _) => {}
                (LightKind::Sphere | LightKind::Triangle | LightKind::Parallelogram, [first, second]) => {
                    probabilities[first] += share as f32;
                    probabilities[second] = probabilities[first];
                }
            }
        }
        let is_few = (2..=Self::MAX_COMPARED).contains(&lights.len());
        let by_irradiance = choice != LightChoice::Power && (is_few || lights.len() > Self::MAX_SHARED);
        let important = lights.iter().filter(|_| by_irradiance);
        let identified = lights.iter().filter(|_| needs_hits);
        Self {
            importance_rows: Rows::new(important.map(|light| light.importance)),
            primitives: identified.flat_map(|light| light.primitives).collect(),
            suns: punctual::suns(scene, lights.iter().map(|light| &light.row).zip(shares.iter().copied())),
            // If hits decide, the emission of a primitive is known only when a shadow ray has hit it.
            table: LightTable::new(
                lights.iter().zip(&shares).flat_map(|(light, &share)| match needs_hits {
                    true if light.primitives != [MISS; 2] => {
                        LightRow { emission: Vec3::ONE, ..light.row }.pack(share as f32)
                    }
                    _ => light.row.pack(share as f32),
                }),
                pieces_side,
            ),
            alias_table: AliasTable::new(&shares),
            probabilities,
            halves,
            first_pieces,
            sky: sky.map(|sky| (sky, sky_probability)),
            portals,
        }
    }
    /// Returns how a primitive is sampled.
    pub fn sampled_as(&self, number: usize) -> SampledAs {
        let probability = self.probabilities.get(number).copied().unwrap_or(0.0);
        match (self.first_pieces.get(&number), self.halves.get(&number)) {
            (Some(&first), _) => SampledAs::Pieces(first),
            (None, Some(half)) => SampledAs::Half(probability, half.corner),
            (None, None) if probability > 0.0 => SampledAs::Whole(probability),
            (None, None) => SampledAs::Nothing,
        }
    }
    /// Tests whether shadow rays need the closest hit, and not only whether they are occluded: the hit then
    /// decides their contribution. This is true if a light has a texture, or lies in the surface of another
    /// primitive.
    pub fn needs_hits(&self) -> bool {
        !self.primitives.is_empty()
    }
    /// Tests whether each primitive is one of its lane's light; [`MISS`] represents lights that are no
    /// primitives. Domain: [`Lights::needs_hits`].
    pub fn is_primitive_of_light<L: Lane>(&self, primitive: L::Bits, light: L::Bits) -> L::Mask {
        let first = light.shl(1);
        let [one, other] = [first, first | L::Bits::splat(1)].map(|at| L::gather_bits(&self.primitives, at));
        primitive.equals(one) | primitive.equals(other)
    }
    /// Tests whether [`Lights::compare`] or [`Lights::resample`] chooses among the lights, and not
    /// [`Lights::choose_by_power`].
    #[inline(always)]
    pub fn are_chosen_by_irradiance(&self) -> bool {
        !self.importance_rows.is_empty()
    }
    /// Returns the features that sampling the lights needs of a pipeline.
    pub fn needs(&self) -> Features {
        match self.len() {
            0 => Features::NONE,
            count if count > LightTable::FEW => Features::LIGHTS.with(Features::MANY_LIGHTS),
            _ => Features::LIGHTS,
        }
    }
    /// Returns the number of lights that are sampled.
    pub fn len(&self) -> usize {
        self.alias_table.len()
    }
    /// Tests whether no light is sampled.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Returns the probabilities of lights with these shares of all power: the shares, but none below
/// [`MIN_SHARE`] of the average.
fn raised_shares(mut shares: Vec<f64>) -> Vec<f64> {
    let least = MIN_SHARE / shares.len() as f64;
    shares.iter_mut().for_each(|share| *share = share.max(least));
    let total: f64 = shares.iter().sum();
    shares.into_iter().map(|share| share / total).collect()
}

/// Tests whether some surface scatters light into other directions than those of mirror reflection and
/// refraction.
fn anything_scatters(scene: &Scene) -> bool {
    scene.materials.iter().any(|material| match material.kind {
        MaterialKind::Emitter | MaterialKind::Glass { .. } | MaterialKind::ThinGlass { .. } => false,
        MaterialKind::Metal { roughness } | MaterialKind::RoughGlass { roughness, .. } => roughness > 0.0,
        MaterialKind::Diffuse | MaterialKind::FuzzyMirror { .. } => true,
        MaterialKind::Plastic { .. } | MaterialKind::MetalRough { .. } => true,
    })
}
