//! The command line: one file a command, with its options and their help; exit codes.

mod bench;
mod chart;
mod checkpoint;
mod compare;
mod convert;
mod denoise;
mod error;
mod ground_truth;
mod inspect;
mod interrupt;
mod jobs;
mod limits;
mod machine_check;
mod memory;
mod merge;
mod methods;
mod numbers;
mod options;
mod outputs;
mod progress;
mod ray_dump;
mod rays;
mod render;
mod scenes;
mod stability;
mod terminal;
mod trace;
#[cfg(feature = "viewer")]
mod view;

use clap::error::{ContextKind, ContextValue};
use clap::{Parser, Subcommand};
use error::{BAD_INPUT, CliError};
use std::ffi::OsString;
use std::process::ExitCode;

/// A data-oriented path tracer for CPUs.
///
/// Traces 8 or 16 rays at a time with SIMD instructions, and one at a time to check that both give the same
/// picture, bit by bit.
///
/// A SCENE is one of: a scene file (.json, in octray's own format or in the thesis's); a view (.json, format
/// octray-view-1), which names another scene, a camera and options of render: all commands use its camera
/// (rays with --camera scene), and render and view its options; a model (.obj, .gltf, .glb or .ply, framed
/// automatically under a plain sky unless it has a camera); or a built-in scene (builtin:NAME). `octray
/// inspect SCENE` shows what a scene contains.
///
/// Exit codes: 0 success; 1 a check failed; 2 the input cannot be used; 130 Ctrl-C or a signal came before
/// the end.
#[derive(Debug, Parser)]
#[command(name = "octray", version, max_term_width = 110, after_help = after_help())]
struct Args {
    #[command(subcommand)]
    command: Option<Command>,
}

/// Returns the built-in scenes.
fn after_help() -> String {
    let names: Vec<String> = crate::scene::builtin_names().map(|name| format!("builtin:{name}")).collect();
    format!(
        "Built-in scenes: {}; meshes of about N triangles: builtin:knot:N, builtin:terrain:N.",
        names.join(", ")
    )
}

#[derive(Debug, Subcommand)]
enum Command {
    Bench(bench::Options),
    Compare(compare::Options),
    Render(jobs::RenderOptions),
    Merge(merge::Options),
    Rays(rays::Options),
    Chart(chart::Options),
    #[cfg(feature = "viewer")]
    View(view::Options),
    Stability(stability::Options),
    Convert(convert::Options),
    Inspect(inspect::Options),
    Methods(methods::Options),
}

const WELCOME: &str = "\
octray traces paths through scenes on the CPU, 8 or 16 rays at a time. Try:

  octray bench                                    frames per second, SIMD beside scalar
  octray compare                                  check that SIMD and scalar agree, bit by bit
  octray render builtin:three -o three.png        a picture
  octray merge part-*.part -o picture.png         a picture from the shards of several runs
  octray view                                     walk through the scenes, live
  octray rays builtin:knot:100000                 rays per second, by traversal
  octray chart builtin:three -o charts            speed against accuracy, charted
  octray stability                                where methods fail, and which are robust
  octray inspect builtin:three                    what a scene contains
  octray convert model.obj scene.json             a scene file from a mesh
  octray methods                                  what options choose among

octray --help lists everything; octray COMMAND --help explains one command.
";

/// Runs the program on the process's arguments.
pub fn main() -> ExitCode {
    // First, because all that follows may use instructions that this machine lacks.
    let advice = match machine_check::check() {
        Ok(advice) => advice,
        Err(error) => return report(&error),
    };
    // Exits on wrong usage with code 2, and after --help and --version with 0.
    let args = Args::try_parse_from(arguments(std::env::args_os()))
        .unwrap_or_else(|error| without_tip(error).exit());
    match run(args, advice) {
        Ok(code) => code,
        // The reader closed the pipe, as `head` does: not an error.
        Err(CliError::Stdout(error)) if error.kind() == std::io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(error) => report(&error),
    }
}

/// Turns `octray help COMMAND`, with any options, into `octray COMMAND --help`.
fn arguments(given: impl Iterator<Item = OsString>) -> Vec<OsString> {
    let mut given: Vec<_> = given.collect();
    if given.get(1).is_some_and(|first| first == "help") {
        given.retain(|word| word != "help" && !word.to_string_lossy().starts_with('-'));
        given.push("--help".into());
    }
    given
}

/// Returns the error without clap's tip to pass an unknown option as a value: no scene is named like an
/// option.
fn without_tip(mut error: clap::Error) -> clap::Error {
    if let Some(ContextValue::StyledStrs(tips)) = error.get(ContextKind::Suggested) {
        let others = tips.iter().filter(|tip| !tip.to_string().contains("as a value")).cloned().collect();
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(others));
    }
    error
}

fn run(args: Args, advice: Option<String>) -> Result<ExitCode, CliError> {
    let Some(command) = args.command else {
        terminal::print(WELCOME)?;
        return Ok(ExitCode::SUCCESS);
    };
    // The speed of the others does not matter.
    if !matches!(command, Command::Merge(_) | Command::Convert(_) | Command::Inspect(_) | Command::Methods(_))
    {
        advice.iter().for_each(|advice| terminal::warn(advice));
    }
    match command {
        Command::Bench(options) => bench::run(options),
        Command::Compare(options) => compare::run(options),
        Command::Render(options) => render::run(options),
        Command::Merge(options) => merge::run(options),
        Command::Rays(options) => rays::run(options),
        Command::Chart(options) => chart::run(options),
        #[cfg(feature = "viewer")]
        Command::View(options) => view::run(options),
        Command::Stability(options) => stability::run(options),
        Command::Convert(options) => convert::run(options),
        Command::Inspect(options) => inspect::run(options),
        Command::Methods(options) => methods::run(options),
    }
}

/// Writes the error and its causes to standard error.
fn report(error: &CliError) -> ExitCode {
    terminal::note(&format!("error: {}", error::describe(error)));
    ExitCode::from(BAD_INPUT)
}
