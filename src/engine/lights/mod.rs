//! Next event estimation's lights: which emitters are lights, which light is chosen, and a point on it.
//!
//! Each kind of light is a file: [`sphere`], [`flat`] (a triangle, a parallelogram of two, and a piece of a
//! textured triangle), [`environment`]. Each has the power of its kind, its row of the table, *sample* and
//! *pdf*. A new kind has a field of [`Kinds`]; the compiler then names every place that must know it.
//!
//! Shapes: `WIDTH` lit points with a light each; vectors of samples are relative to the lit point.
//! Units: pdfs per solid angle, in 1/sr; 0 if the light cannot be sampled. Then only scattered rays find it.
//! Domain: u and v are uniform in [0, 1).

mod alias_table;
mod choose;
pub mod environment;
pub mod flat;
mod overlaps;
mod parallelograms;
mod pieces;
mod power;
mod select;
pub mod sphere;
mod table;

pub use environment::EnvironmentLight;
pub use flat::FlatLight;
pub use table::{ChosenLight, Kinds, Lights};

use crate::buffers::{Features, has};
use crate::choice::choices;
use crate::lane::{Lane, Mask};
use crate::math::Vec3;

choices! {
    /// The emitters that next event estimation samples. Paths also hit emitters by scattering.
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

/// A sampled point of a light.
#[derive(Clone, Copy, Debug)]
pub struct LightSample<L: Lane> {
    /// The unit vector towards the point.
    pub wi: Vec3<L>,
    /// The distance to the point, in scene units. It is infinite for the environment, and for all lights if
    /// the hits of shadow rays decide: see [`Lights::needs_hits`].
    pub t: L,
    /// The light's unit normal there, on the lit side; zero for the environment.
    pub n: Vec3<L>,
    /// The pdf of `wi`.
    pub pdf: L,
}

impl<L: Lane> LightSample<L> {
    /// Selects one of two samples in each lane.
    #[inline(always)]
    pub fn select(mask: L::Mask, if_true: Self, if_false: Self) -> Self {
        Self {
            wi: Vec3::select(mask, if_true.wi, if_false.wi),
            t: L::select(mask, if_true.t, if_false.t),
            n: Vec3::select(mask, if_true.n, if_false.n),
            pdf: L::select(mask, if_true.pdf, if_false.pdf),
        }
    }
}

impl Lights {
    /// Samples a point of each lane's light, as seen from `origin`, in the lanes of `mask`.
    #[inline(always)]
    pub fn sample<L: Lane, const N: u32>(
        &self,
        light: &ChosenLight<L>,
        origin: Vec3<L>,
        (u, v): (L, L),
        mask: L::Mask,
    ) -> LightSample<L> {
        let Kinds { sphere, flat, environment } = light.kinds;
        let center = light.at - origin;
        let on_flat = light.flat(origin);
        let spheres = has(N, Features::SPHERES) && (mask & sphere).any();
        let mut sample = match (spheres, has(N, Features::TRIANGLES) && (mask & flat).any()) {
            (true, false) => sphere::sample(center, light.radius, u, v),
            (false, _) => flat::sample(&on_flat, u, v),
            (true, true) => {
                let on_flat = flat::sample(&on_flat, u, v);
                LightSample::select(sphere, sphere::sample(center, light.radius, u, v), on_flat)
            }
        };
        if has(N, Features::SKY_TEXTURE)
            && let Some((sky, _)) = &self.sky
            && (mask & environment).any()
        {
            sample = LightSample::select(environment, sky.sample(u, v), sample);
        }
        if self.needs_hits() {
            sample.t = L::splat(f32::INFINITY);
        }
        sample
    }
}

/// Returns the pdf if it is finite and above 0; else 0.
#[inline(always)]
fn valid_pdf<L: Lane>(pdf: L) -> L {
    pdf.only(L::zero().lt(pdf) & pdf.is_finite())
}
