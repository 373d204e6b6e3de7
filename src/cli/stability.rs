//! `octray stability`: where methods fail, as a table, as JSON and as charts.

use super::error::{CHECK_FAILED, CliError};
use super::interrupt;
use super::options::StabilityOptions;
use super::progress::Tasks;
use super::terminal;
use crate::machine::Machine;
use crate::measure::stability::{self, Effort};
use crate::output::{self, Existing};
use crate::report::stability::{Report, drawings, table, verdict};
use std::path::Path;
use std::process::ExitCode;

const JSON: &str = "stability.json";

/// Runs the command.
pub fn run(options: StabilityOptions) -> Result<ExitCode, CliError> {
    if let Some(folder) = &options.output {
        output::make_folder(folder)?;
        output::check(&folder.join(JSON), Existing::Replace)?;
    }
    interrupt::end_with(|| "Ctrl-C: figures come when all recipes are done; --only names a few.".into());
    let tasks = Tasks::new(options.recipes.iter().map(|recipe| recipe.points()).sum());
    let recipes = stability::run(&options.recipes, options.effort, &|| tasks.done());
    tasks.end();
    let report = Report {
        schema: "octray-stability-1",
        machine: Machine::current(),
        thorough: options.effort == Effort::THOROUGH,
        holds: recipes.iter().all(|outcome| outcome.holds),
        recipes,
    };
    if let Some(folder) = &options.output {
        write(folder, &report)?;
    }
    if options.json {
        terminal::print_json(&report)?;
    } else {
        terminal::print(&format!("{}\n\n{}", report.machine, verdict(&report)))?;
        report.recipes.iter().try_for_each(|outcome| terminal::print(&table(outcome)))?;
        if let Some(folder) = &options.output {
            terminal::print(&format!("\nCharts and {JSON} are in {}.\n", folder.display()))?;
        }
    }
    Ok(if report.holds { ExitCode::SUCCESS } else { ExitCode::from(CHECK_FAILED) })
}

fn write(folder: &Path, report: &Report) -> Result<(), CliError> {
    for drawing in report.recipes.iter().flat_map(drawings) {
        output::save_text(&folder.join(format!("{}.svg", drawing.name)), &drawing.svg)?;
    }
    Ok(output::save_json(&folder.join(JSON), report)?)
}
