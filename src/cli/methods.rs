//! `octray methods`: the methods that options choose among, a sentence each.

use super::error::CliError;
use super::terminal::Printer;
use crate::choice::Choice;
use crate::lights::LightChoice;
use crate::render::{LaneChoice, PipelineChoice, SphereChoice, TraversalChoice, TriangleChoice};
use crate::report::text::item;
use crate::sampling::Sampler;
use crate::tone::Operator;
use serde_json::{Value, json};
use std::process::ExitCode;

/// List the methods that options choose among.
///
/// Intersection methods, traversals, estimators, samplers, and what else has names, with a sentence each. The
/// defaults have an asterisk. With --sphere naive or --triangle moller-trumbore, every traversal but linear
/// is stream, and it may miss what these methods hit outside of a primitive.
#[derive(Debug, clap::Parser)]
#[command(after_help = "Example:\n  octray methods --json")]
pub struct Options {
    /// Print the list as JSON (schema octray-methods-1).
    #[arg(long)]
    json: bool,
}

/// Returns the methods of an option, as text and as JSON.
fn of<C: Choice + Default>(option: &str, what: &str) -> (String, Vec<Value>) {
    let is_default = |it: C| it == C::default();
    let name = |it: C| format!("  {}{}", it.name(), if is_default(it) { " *" } else { "" });
    let lines: String = C::all().iter().map(|&it| item(&name(it), 18, it.about())).collect();
    let json = |&it: &C| json!({ "option": option, "name": it.name(), "default": is_default(it), "about": it.about() });
    (format!("--{option}: {what}\n{lines}"), C::all().iter().map(json).collect())
}

pub fn run(options: Options) -> Result<ExitCode, CliError> {
    let all = [
        of::<SphereChoice>("sphere", "ray-sphere intersection"),
        of::<TriangleChoice>("triangle", "ray-triangle intersection"),
        of::<TraversalChoice>("traversal", "how rays find primitives; the picture stays the same"),
        of::<LightChoice>("lights", "lights that next event estimation samples; the mean stays the same"),
        of::<Sampler>("sampler", "source of random numbers; the mean stays the same"),
        of::<PipelineChoice>("pipeline", "features compiled in; the picture stays the same"),
        of::<LaneChoice>("lanes", "rays traced at a time; the picture stays the same"),
        of::<Operator>("tone", "tone mapping of what is displayed"),
    ];
    let (texts, methods): (Vec<_>, Vec<_>) = all.into_iter().unzip();
    let out = Printer { json: options.json };
    out.text(&texts.join("\n"))?;
    out.end(&json!({ "schema": "octray-methods-1", "methods": methods.concat() }), false)
}
