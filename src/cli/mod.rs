//! The command line: raw arguments, validated options, one file a command, exit codes.
//!
//! For: [`main`], all that the program's `main` does. May import: everything. Must never know: equations.
//!
//! | file | what it does |
//! |---|---|
//! | [`args`], [`choices`] | what the user typed: the arguments' names, shapes and help |
//! | [`options`], [`methods`], [`numbers`], [`limits`] | what we accept: names known, numbers in range |
//! | [`asked`] | what options or a view ask of a still |
//! | [`render`], [`convert`], [`inspect`], [`mod@bench`], [`compare`], [`rays`], [`stability`], [`chart`] | the commands |
//! | [`render`], [`convert`], [`inspect`], [`mod@bench`], [`compare`], [`rays`], [`stability`], [`chart`], `view` | the commands |
//! | [`truths`] | truths that were rendered before, for `chart` |
//! | [`scenes`] | the scenes that commands take |
//! | [`routes`], [`defaults`] | which way a scene's rays go and which methods it gets, for `inspect` |
//! | [`machine_check`] | refuses to start where the program's instructions do not exist |
//! | [`memory`] | refuses pictures that do not fit |
//! | [`terminal`] | the only writer to standard output and standard error |
//! | [`stats`] | the tables of `--stats` |
//! | [`interrupt`] | Ctrl-C |
//! | [`trace`] | takes samples until a limit is reached |
//! | [`samples_map`] | a picture of how many samples pixels have had |
//! | [`progress`] | how far a rendering is |
//! | [`error`] | what can go wrong |

pub mod args;
pub mod asked;
pub mod bench;
pub mod chart;
pub mod choices;
pub mod compare;
pub mod convert;
pub mod defaults;
pub mod error;
pub mod inspect;
pub mod interrupt;
pub mod limits;
pub mod machine_check;
pub mod memory;
pub mod methods;
pub mod numbers;
pub mod options;
mod picture;
pub mod progress;
pub mod ray_dump;
pub mod rays;
pub mod render;
pub mod routes;
pub mod samples_map;
pub mod scenes;
pub mod stability;
pub mod stats;
pub mod terminal;
pub mod trace;
pub mod truths;
#[cfg(feature = "viewer")]
pub mod view;

pub use error::CliError;

use args::{Args, Command};
use clap::Parser;
use std::process::ExitCode;

/// A check found what should not be: pictures that differ, say.
pub const CHECK_FAILED: u8 = 1;
/// The input cannot be used: arguments, a scene, an output file, the machine.
pub const BAD_INPUT: u8 = 2;
/// Ctrl-C came before the end.
pub const INTERRUPTED: u8 = 130;

const WELCOME: &str = "\
octray traces paths through scenes on the CPU, eight rays at a time. Try:

  octray bench                                    frames per second, SIMD beside scalar
  octray compare                                  do SIMD and scalar agree, bit by bit?
  octray render builtin:three -o three.png        a picture
  octray view                                     a window to walk through them
  octray rays builtin:knot:100000                 rays per second, every way of tracing them
  octray chart builtin:three -o charts            speed against accuracy, charted
  octray stability                                where methods fail, and which hold
  octray inspect builtin:three                    what a scene holds
  octray convert model.obj scene.json             a scene to edit from a mesh

octray --help lists everything; octray COMMAND --help explains one command.
";

/// Runs the program on the process's arguments.
pub fn main() -> ExitCode {
    // Before anything else: what follows may already be compiled to instructions this machine has not got.
    let verdict = machine_check::verdict();
    if let Err(error) = verdict.require() {
        return report(&error);
    }
    // Wrong usage ends here with exit code 2; --help and --version with 0.
    let args = Args::parse();
    match run(args, &verdict) {
        Ok(code) => code,
        // Whoever read our output has seen enough.
        Err(CliError::Stdout(error)) if error.kind() == std::io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(error) => report(&error),
    }
}

fn run(args: Args, verdict: &machine_check::Verdict) -> Result<ExitCode, CliError> {
    let Some(command) = args.command else {
        terminal::print(WELCOME)?;
        return Ok(ExitCode::SUCCESS);
    };
    match command {
        Command::Bench(args) => {
            let options = args.try_into()?;
            verdict.advise();
            bench::run(options)
        }
        Command::Compare(args) => {
            let options = args.try_into()?;
            verdict.advise();
            compare::run(options)
        }
        Command::Render(args) => {
            let options = args.try_into()?;
            verdict.advise();
            render::run(options)
        }
        Command::Rays(args) => {
            let options = args.try_into()?;
            verdict.advise();
            rays::run(options)
        }
        Command::Chart(args) => {
            let options = args.try_into()?;
            verdict.advise();
            chart::run(options)
        }
        #[cfg(feature = "viewer")]
        Command::View(args) => {
            let options = args.try_into()?;
            verdict.advise();
            view::run(options)
        }
        Command::Stability(args) => {
            let options = args.into();
            verdict.advise();
            stability::run(options)
        }
        Command::Convert(args) => convert::run(args.into()),
        Command::Inspect(args) => inspect::run(args.into()),
    }
}

/// Says on standard error what went wrong and why.
fn report(error: &CliError) -> ExitCode {
    let mut text = format!("error: {error}");
    let mut cause = std::error::Error::source(error);
    while let Some(error) = cause {
        text.push_str(&format!("\n  because: {error}"));
        cause = error.source();
    }
    terminal::note(&text);
    ExitCode::from(BAD_INPUT)
}
