//! Next event estimation's lights: which emitters are lights, which light is chosen, and a point on it.
//!
//! The lights of primitives are files of [`crate::primitives`]; [`environment`] and [`portals`] are the sky,
//! whole and through openings, and [`punctual`] has points, spots and directional lights. Each has the power
//! of its kind, its row of the table, *sample* and *pdf*. A new kind has a field of
//! [`crate::primitives::LightKinds`]; the compiler then names every place that must know it.
//!
//! Shapes: `WIDTH` lit points with a light each; vectors of samples are relative to the lit point.
//! Units: pdfs per solid angle, in 1/sr; 0 if the light cannot be sampled. Then only scattered rays find it.
//! Domain: u and v are uniform in [0, 1).

mod alias_table;
mod choose;
pub mod environment;
mod overlaps;
mod parallelograms;
mod pieces;
pub mod portals;
mod power;
pub mod punctual;
mod select;
mod table;

pub use environment::EnvironmentLight;
pub use portals::Portals;
pub use punctual::{Sun, sun_radiance};
pub use table::Lights;

use crate::buffers::{Features, has};
use crate::choice::choices;
use crate::kernel::surface::latitude_longitude;
use crate::lane::{Lane, Mask};
use crate::math::Vec3;
use crate::primitives::light::{ChosenLight, LightKinds, LightSample};

choices! {
    /// The emitters that next event estimation samples. Paths also hit emitters by scattering.
    pub enum LightChoice {
        #[default]
        Auto = "auto",
            "Emitters whose sampling pays: no sphere around the scene, none where all is mirrors and glass.";
        On = "on", "Every emitter that can be sampled.";
        Power = "power",
            "As auto, but chosen by power alone, every triangle by itself.";
        Off = "off", "None but those that paths cannot hit.";
    }
}

impl Lights {
    /// Samples a point of each lane's light, as seen from `origin`, in the lanes of `mask`.
    #[inline(always)]
    pub fn sample<L: Lane, const N: u64>(
        &self,
        light: &ChosenLight<L>,
        origin: Vec3<L>,
        (u, v): (L, L),
        mask: L::Mask,
    ) -> LightSample<L> {
        let mut sample = light.sample::<N>(origin, (u, v), mask);
        let environment = light.kinds.environment;
        if has(N, Features::SKY_TEXTURE)
            && let Some((sky, _)) = &self.sky
            && (mask & environment).any()
        {
            sample = LightSample::select(environment, sky.sample(u, v), sample);
        }
        let LightKinds { portal, point, distant, .. } = light.kinds;
        if has(N, Features::PORTALS) && (mask & portal).any() {
            let through = portals::through_portal(light, origin, &sample);
            sample = LightSample::select(portal, through, sample);
        }
        let lanes = point | distant;
        if has(N, Features::PUNCTUAL_LIGHTS) && (mask & lanes).any() {
            sample = LightSample::select(lanes, punctual::sample(light, origin, (u, v)), sample);
        }
        if self.needs_hits() {
            let endless = L::splat(f32::INFINITY);
            let ends = has(N, Features::PUNCTUAL_LIGHTS);
            sample.t = if ends { L::select(point, sample.t, endless) } else { endless };
        }
        sample
    }

    /// Tests whether several lights with portals among them sample the same sky.
    #[inline(always)]
    pub fn mixes_sky(&self) -> bool {
        !self.portals.is_empty() && self.portals.len() + usize::from(self.sky.is_some()) > 1
    }

    /// Returns the pdf, per solid angle, with which the sky's lights are sampled in a direction from
    /// `origin`, each chosen by power: the sum over all of them, because a direction may pass several
    /// portals. `None` if no light is the sky.
    #[inline(always)]
    pub fn sky_pdf<L: Lane, const N: u64>(&self, origin: Vec3<L>, direction: Vec3<L>) -> Option<L> {
        let mut pdf = None;
        if has(N, Features::SKY_TEXTURE)
            && let Some((sky, probability)) = &self.sky
        {
            pdf = Some(sky.pdf(latitude_longitude(direction)) * L::splat(*probability));
        }
        if has(N, Features::PORTALS) && !self.portals.is_empty() {
            let through = self.portals.pdf(&origin, &direction);
            pdf = Some(pdf.map_or(through, |pdf| pdf + through));
        }
        pdf
    }
}
