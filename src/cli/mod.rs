//! The command line: raw arguments, validated options, one file a command, exit codes.
//!
//! For: [`main`], all that the program's `main` does.
//!
//! | file | what it does |
//! |---|---|
//! | `args`, `groups` | raw arguments: names, shapes, help texts |
//! | `options`, `picture`, `methods`, `limits`, `numbers` | validated options: names known, numbers in range |
//! | `overrides` | settings that the command line or a view overrides |
//! | `bench`, `compare`, `render`, `rays`, `chart`, `view` | commands |
//! | `stability`, `merge`, `convert`, `inspect` | commands |
//! | `scenes` | loads the scenes of commands |
//! | `trace`, `interrupt`, `progress` | sampling up to a limit, Ctrl-C, progress lines |
//! | `jobs`, `frames` | of `render`: the pictures or parts of one call, and their files |
//! | `checkpoint` | of `render`: saves the film and resumes from it |
//! | `samples_map` | of `render`: a picture of the number of samples |
//! | `ground_truth` | of `chart`: the cache of ground truths |
//! | `ray_dump` | of `rays`: rays and hits as files |
//! | `machine_check` | refuses a machine without the instructions compiled for |
//! | `memory` | refuses pictures that do not fit into memory |
//! | `terminal` | the only writer to standard output and standard error |
//! | `error` | errors and exit codes |

mod args;
mod bench;
mod chart;
mod checkpoint;
mod compare;
mod convert;
mod error;
mod frames;
mod ground_truth;
mod groups;
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
mod overrides;
mod picture;
mod progress;
mod ray_dump;
mod rays;
mod render;
mod samples_map;
mod scenes;
mod stability;
mod terminal;
mod trace;
#[cfg(feature = "viewer")]
mod view;

use args::{Args, Command};
use clap::Parser;
use clap::error::{ContextKind, ContextValue};
use error::{BAD_INPUT, CliError};
use std::process::ExitCode;

const WELCOME: &str = "\
octray traces paths through scenes on the CPU, 8 or 16 rays at a time. Try:

  octray bench                                    frames per second, SIMD beside scalar
  octray compare                                  check that SIMD and scalar agree, bit by bit
  octray render builtin:three -o three.png        a picture
  octray merge part-*.part -o picture.png         a picture from the shards of several runs
  octray view                                     a window to walk through the scenes
  octray rays builtin:knot:100000                 rays per second, by traversal
  octray chart builtin:three -o charts            speed against accuracy, charted
  octray stability                                where methods fail, and which are robust
  octray inspect builtin:three                    what a scene contains
  octray convert model.obj scene.json             a scene file from a mesh

octray --help lists everything; octray COMMAND --help explains one command.
";

/// Runs the program on the process's arguments.
pub fn main() -> ExitCode {
    // First, because all that follows may use instructions that this machine lacks.
    let verdict = machine_check::verdict();
    if let Err(error) = verdict.require() {
        return report(&error);
    }
    // Exits on wrong usage with code 2, and after --help and --version with 0.
    let args = Args::try_parse().unwrap_or_else(|error| without_tip(error).exit());
    match run(args, &verdict) {
        Ok(code) => code,
        // The reader closed the pipe, as `head` does: not an error.
        Err(CliError::Stdout(error)) if error.kind() == std::io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(error) => report(&error),
    }
}

/// The error without clap's tip to pass an unknown option as a value: no scene is named like an option.
fn without_tip(mut error: clap::Error) -> clap::Error {
    if let Some(ContextValue::StyledStrs(tips)) = error.get(ContextKind::Suggested) {
        let others = tips.iter().filter(|tip| !tip.to_string().contains("as a value")).cloned().collect();
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(others));
    }
    error
}

fn run(args: Args, verdict: &machine_check::Verdict) -> Result<ExitCode, CliError> {
    let Some(command) = args.command else {
        terminal::print(WELCOME)?;
        return Ok(ExitCode::SUCCESS);
    };
    match command {
        Command::Bench(args) => run_measured(args, verdict, bench::run),
        Command::Compare(args) => run_measured(args, verdict, compare::run),
        Command::Render(args) => run_measured(args, verdict, render::run),
        Command::Merge(args) => merge::run(args.try_into()?),
        Command::Rays(args) => run_measured(args, verdict, rays::run),
        Command::Chart(args) => run_measured(args, verdict, chart::run),
        #[cfg(feature = "viewer")]
        Command::View(args) => run_measured(args, verdict, view::run),
        Command::Stability(args) => {
            verdict.advise();
            stability::run(args.into())
        }
        Command::Convert(args) => convert::run(&args),
        Command::Inspect(args) => inspect::run(args),
    }
}

/// Validates the options of a command whose speed matters, warns if a rebuild would be faster, and runs it.
fn run_measured<Args, Options: TryFrom<Args, Error = CliError>>(
    args: Args,
    verdict: &machine_check::Verdict,
    run: fn(Options) -> Result<ExitCode, CliError>,
) -> Result<ExitCode, CliError> {
    let options = Options::try_from(args)?;
    verdict.advise();
    run(options)
}

/// Writes the error and its causes to standard error.
fn report(error: &CliError) -> ExitCode {
    terminal::note(&format!("error: {}", error::describe(error)));
    ExitCode::from(BAD_INPUT)
}
