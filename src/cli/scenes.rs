//! Loads the scenes of commands.

use super::error::CliError;
use super::numbers::{clamp, exposure, samples};
use super::terminal;
use crate::scene::{self, Loaded, Rendering, view_fault};
use std::ffi::{OsStr, OsString};
use std::fmt::Display;

/// Loads a scene by name, if `unrounded` for the reference. Every command refuses a view with numbers out of
/// range, also a command that does not use them.
pub fn load(name: &OsStr, unrounded: bool) -> Result<Loaded, CliError> {
    let scene = scene::load_as(name, unrounded)?;
    let view = of_view(&scene);
    check(&scene, "samples", view.samples, samples)?;
    check(&scene, "exposure", view.exposure, exposure)?;
    check(&scene, "clamp", view.clamp, clamp)?;
    Ok(scene)
}

/// Checks a number of a view with the parser of the option of the same name.
fn check<T: Display>(
    scene: &Loaded,
    key: &str,
    number: Option<T>,
    parse: fn(&str) -> Result<T, String>,
) -> Result<(), CliError> {
    let Some(text) = number.map(|number| number.to_string()) else { return Ok(()) };
    let fault = |instead| view_fault(scene, key, format!("`{key}` cannot be {text}"), instead).into();
    parse(&text).map(drop).map_err(fault)
}

/// Loads a scene as [`load`] does, and prints its warnings.
pub fn load_with_warnings(name: &OsStr, unrounded: bool) -> Result<Loaded, CliError> {
    let scene = load(name, unrounded)?;
    scene.warnings.iter().for_each(|warning| terminal::warn(warning));
    Ok(scene)
}

/// Returns the names given, or those of `built_in` scenes if none is given.
///
/// Several scenes are all loaded once here and dropped, so that a fault in the last one shows before the
/// others take their time, and only one is in memory at a time.
pub fn checked(
    names: &[OsString],
    built_in: impl Iterator<Item = &'static str>,
) -> Result<Vec<OsString>, CliError> {
    if names.len() > 1 {
        names.iter().try_for_each(|name| load(name, false).map(drop))?;
    }
    Ok(or_built_in(names, built_in))
}

/// Returns the names given, or those of `built_in` scenes if none is given.
pub fn or_built_in(names: &[OsString], built_in: impl Iterator<Item = &'static str>) -> Vec<OsString> {
    match names {
        [] => built_in.map(|name| format!("builtin:{name}").into()).collect(),
        some => some.to_vec(),
    }
}

/// Returns the options in the view that the scene was loaded through, if it was loaded through one.
pub fn of_view(scene: &Loaded) -> Rendering {
    scene.view.as_ref().map(|view| view.render).unwrap_or_default()
}
