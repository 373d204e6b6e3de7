//! `octray methods`: the methods that options choose among, a sentence each.

use super::error::CliError;
use super::terminal::Printer;
use crate::buffers::LightChoice;
use crate::choice::Choice;
use crate::render::{LaneChoice, PipelineChoice};
use crate::report::text::item;
use crate::sampling::Sampler;
use crate::tone::Operator;
use crate::traverse::{SphereChoice, TraversalChoice, TriangleChoice};
use serde::Serialize;
use std::process::ExitCode;

/// List the methods that options choose among.
///
/// Intersection methods, traversals, estimators, samplers, and what else has names, with a sentence each. The
/// defaults have an asterisk. --sphere naive and --triangle moller-trumbore have no hierarchy: they test
/// every primitive.
#[derive(Debug, clap::Parser)]
#[command(after_help = "Example:\n  octray methods --json")]
pub struct Options {
    /// Print the list as JSON (schema octray-methods-1).
    #[arg(long)]
    json: bool,
}

/// The JSON report.
#[derive(Debug, Serialize)]
struct Report {
    schema: &'static str,
    options: Vec<Chosen>,
}

/// What an option chooses.
#[derive(Debug, Serialize)]
struct Chosen {
    option: &'static str,
    what: &'static str,
    methods: Vec<Method>,
}

#[derive(Debug, Serialize)]
struct Method {
    name: &'static str,
    default: bool,
    about: &'static str,
}

impl Chosen {
    fn of<C: Choice + Default>(option: &'static str, what: &'static str) -> Self {
        let method = |&it: &C| Method { name: it.name(), default: it == C::default(), about: it.about() };
        Self { option, what, methods: C::all().iter().map(method).collect() }
    }

    fn text(&self) -> String {
        let mark = |method: &Method| if method.default { " *" } else { "" };
        let line = |method: &Method| item(&format!("  {}{}", method.name, mark(method)), 18, method.about);
        let lines: String = self.methods.iter().map(line).collect();
        format!("--{}: {}\n{lines}", self.option, self.what)
    }
}

/// Runs the command.
pub fn run(options: Options) -> Result<ExitCode, CliError> {
    let all = vec![
        Chosen::of::<SphereChoice>("sphere", "ray-sphere intersection"),
        Chosen::of::<TriangleChoice>("triangle", "ray-triangle intersection"),
        Chosen::of::<TraversalChoice>("traversal", "how rays find primitives; the picture stays the same"),
        Chosen::of::<LightChoice>(
            "lights",
            "lights that next event estimation samples; the mean stays the same",
        ),
        Chosen::of::<Sampler>("sampler", "source of random numbers; the mean stays the same"),
        Chosen::of::<PipelineChoice>("pipeline", "features compiled in; the picture stays the same"),
        Chosen::of::<LaneChoice>("lanes", "rays traced at a time; the picture stays the same"),
        Chosen::of::<Operator>("tone", "tone mapping of what is displayed"),
    ];
    let out = Printer { json: options.json };
    out.text(&all.iter().map(Chosen::text).collect::<Vec<_>>().join("\n"))?;
    out.report(&Report { schema: "octray-methods-1", options: all })?;
    Ok(ExitCode::SUCCESS)
}
