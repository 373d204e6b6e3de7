//! Settings of a still that the command line or a view file may override. Both use the same names; the
//! command line overrides the view.
//!
//! For: [`Overrides`].

use super::error::CliError;
use super::limits::Limits;
use super::methods::MethodOptions;
use super::numbers::{check_clamp, check_exposure, check_samples};
use crate::render::PipelineChoice;
use crate::scene::{Loaded, Rendering, view_fault};
use crate::tone::{Operator, Tone};
use std::fmt::Display;

/// `None` keeps the default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Overrides {
    pub limits: Option<Limits>,
    pub seed: Option<u32>,
    /// In stops.
    pub exposure: Option<f32>,
    pub tone: Option<Operator>,
    /// Largest radiance of a sample in each channel.
    pub clamp: Option<f32>,
    pub methods: MethodOptions,
    pub pipeline: Option<PipelineChoice>,
}

impl Overrides {
    /// Those of the view that the scene was loaded through, if it was loaded through one.
    pub fn of_view(scene: &Loaded) -> Result<Self, CliError> {
        let Some(view) = &scene.view else { return Ok(Self::default()) };
        let Rendering { samples, seed, exposure, tone, clamp, pipeline, .. } = view.render;
        let Rendering { sphere, triangle, boxes, traversal, lights, sampler, .. } = view.render;
        let samples = checked(scene, "samples", samples, check_samples)?;
        Ok(Self {
            limits: samples.map(Limits::of_samples),
            seed,
            exposure: checked(scene, "exposure", exposure, check_exposure)?,
            tone,
            clamp: checked(scene, "clamp", clamp, check_clamp)?,
            methods: MethodOptions { fast: None, sphere, triangle, boxes, traversal, lights, sampler },
            pipeline,
        })
    }

    /// These, and from `weaker` those that are missing here. Limits go together: a time limit here drops
    /// `weaker`'s samples.
    pub fn or(self, weaker: Self) -> Self {
        Self {
            limits: self.limits.or(weaker.limits),
            seed: self.seed.or(weaker.seed),
            exposure: self.exposure.or(weaker.exposure),
            tone: self.tone.or(weaker.tone),
            clamp: self.clamp.or(weaker.clamp),
            methods: self.methods.or(weaker.methods),
            pipeline: self.pipeline.or(weaker.pipeline),
        }
    }

    /// The tone mapping of the displayed picture.
    pub fn tone(&self) -> Tone {
        Tone { exposure: self.exposure.unwrap_or(0.0), operator: self.tone.unwrap_or_default() }
    }
}

/// A number of the view, if it has one and that is in the option's range.
fn checked<T: Copy + Display>(
    scene: &Loaded,
    key: &str,
    number: Option<T>,
    check: fn(T) -> Result<T, String>,
) -> Result<Option<T>, CliError> {
    let Some(number) = number else { return Ok(None) };
    let fault = |why| view_fault(scene, key, format!("`{key}` cannot be {number}"), why).into();
    check(number).map(Some).map_err(fault)
}
