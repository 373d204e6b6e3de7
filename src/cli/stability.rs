//! `octray stability`: where methods fail, as a table, as JSON and as charts.

use super::error::CliError;
use super::terminal::Printer;
use super::{interrupt, progress};
use crate::measure::stability::{self, Effort, TestCase, test_cases};
use crate::output::{self, Existing};
use crate::report::stability::{Report, drawings, summary, table, verdict};
use clap::builder::PossibleValuesParser;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::LazyLock;

static NAMES: LazyLock<Vec<&str>> = LazyLock::new(|| test_cases().map(|test_case| test_case.name).collect());
const JSON: &str = "stability.json";

/// Measure where methods fail.
///
/// Runs every method on test cases that are numerically difficult: intersection of spheres, triangles and
/// boxes, offsets of spawned rays, texture lookup, scattering, light sampling, sums of samples, cameras and
/// whole scenes; far away, huge, tiny, at edges, in the planes of faces, close to each other. All methods get
/// the same inputs and are compared with double precision. The verdict comes first, then a row a test case:
/// the largest share of failures and the error (99th percentile) of the default method at the places at which
/// it has a bound, and the same of the best other method. Seeds are fixed: the figures are the same in every
/// run on any number of threads, and differ slightly between builds with and without FMA. Exits with 1 if a
/// default method exceeds its bounds. All test cases take half a minute on two cores.
#[derive(Debug, clap::Parser)]
#[command(after_help = "Examples:
  octray stability
  octray stability --only spheres-far mesh-edges --tables -o charts
  octray stability --json > stability.json")]
pub struct Options {
    /// Print the figures as JSON (schema octray-stability-1).
    #[arg(long)]
    json: bool,
    /// Print all methods by distance, scale or shape.
    #[arg(long)]
    tables: bool,
    /// Also write JSON and charts (SVG) into this folder.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Try ten times as many inputs, for five minutes.
    #[arg(long)]
    thorough: bool,
    /// Run these test cases only.
    #[arg(long, value_name = "NAME", num_args = 1.., value_parser = PossibleValuesParser::new(NAMES.iter()), hide_possible_values = true, long_help = format!("Run these test cases only: {}", NAMES.join(", ")))]
    only: Vec<String>,
}

pub fn run(options: Options) -> Result<ExitCode, CliError> {
    if let Some(folder) = &options.output {
        output::make_folder(folder)?;
        output::check(&folder.join(JSON), Existing::Replace)?;
    }
    interrupt::end_with("Ctrl-C: figures come when all test cases are done; --only names a few.");
    let is_wanted =
        |case: &&TestCase| options.only.is_empty() || options.only.iter().any(|it| it == case.name);
    let test_cases: Vec<&TestCase> = test_cases().filter(is_wanted).collect();
    let effort = if options.thorough { Effort::THOROUGH } else { Effort::STANDARD };
    let tasks = progress::tasks(test_cases.iter().map(|test_case| test_case.points()).sum());
    let test_cases = stability::run(&test_cases, effort, &|| tasks.inc(1));
    tasks.finish_and_clear();
    let report = Report::new(options.thorough, test_cases);
    if let Some(folder) = &options.output {
        for drawing in report.test_cases.iter().flat_map(drawings) {
            output::save_text(&folder.join(format!("{}.svg", drawing.name)), &drawing.svg)?;
        }
        output::save_json(&folder.join(JSON), &report)?;
    }
    let out = Printer { json: options.json };
    out.text(&format!("{}\n\n{}", report.machine, verdict(&report)))?;
    out.text(&summary(&report))?;
    if options.tables {
        report.test_cases.iter().try_for_each(|outcome| out.text(&table(outcome)))?;
        out.text("\nIn brackets: places at which the default method has no bound.\n")?;
    } else {
        out.text("\n--tables prints all methods at all places.\n")?;
    }
    if let Some(folder) = &options.output {
        out.text(&format!("\nCharts and {JSON} are in {}.\n", folder.display()))?;
    }
    out.end(&report, report.has_failed())
}
