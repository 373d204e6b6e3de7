//! `octray stability`: where methods fail, as a table, as JSON and as charts.

use super::error::{CHECK_FAILED, CliError};
use super::options::StabilityOptions;
use super::progress::Tasks;
use super::terminal;
use crate::machine::Machine;
use crate::measure::stability::Effort;
use crate::output::{self, Existing};
use crate::report::stability::figures;
use crate::report::stability_table::{Report, table, verdict};
use std::path::Path;
use std::process::ExitCode;

const JSON: &str = "stability.json";

/// Runs the command.
pub fn run(options: StabilityOptions) -> Result<ExitCode, CliError> {
    if let Some(folder) = &options.output {
        output::make_folder(folder)?;
        output::check(&folder.join(JSON), Existing::Replace)?;
    }
    let mut report = Report {
        schema: "octray-stability-1",
        machine: Machine::current(),
        holds: true,
        recipes: Vec::with_capacity(options.recipes.len()),
    };
    if !options.json {
        terminal::print(&format!("{}\n", report.machine))?;
    }
    let tasks = Tasks::new(options.recipes.len());
    for recipe in &options.recipes {
        tasks.begin(recipe.name);
        let outcome = recipe.run(Effort::FULL);
        tasks.done(|| if options.json { Ok(()) } else { terminal::print(&table(&outcome)) })?;
        report.holds &= outcome.holds;
        report.recipes.push(outcome);
    }
    tasks.end();
    if let Some(folder) = &options.output {
        write(folder, &report)?;
    }
    if options.json {
        terminal::print_json(&report)?;
    } else {
        terminal::print(&verdict(&report))?;
        if let Some(folder) = &options.output {
            terminal::print(&format!("Charts and {JSON} are in {}.\n", folder.display()))?;
        }
    }
    Ok(if report.holds { ExitCode::SUCCESS } else { ExitCode::from(CHECK_FAILED) })
}

fn write(folder: &Path, report: &Report) -> Result<(), CliError> {
    for (name, figure) in report.recipes.iter().flat_map(figures) {
        output::save_text(&folder.join(format!("{name}.svg")), &figure.svg())?;
    }
    Ok(output::save_json(&folder.join(JSON), report)?)
}
