//! Binds keys to actions. `keys.txt` is the help.

use super::camera_controller::Motion;
use super::controls::{Controls, Filter, cycle};
use super::display_mode::DisplayMode;
use super::playlist::Playlist;
use Action::{Hold, Open, Scene, Step, Switch, Zoom};
use Key::Char;
use crossterm::event::ModifierKeyCode::{LeftControl, LeftShift};
use octray_engine::tone::Operator;

/// A key of a window or a terminal. Letters are lower case; letters for walking follow the physical key where
/// it is known. Both keys of a modifier are reported as the left one; terminals report no modifiers.
pub use crossterm::event::KeyCode as Key;

/// The effect of a key.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Action {
    /// Moves the camera while the key is down.
    Hold(Motion),
    /// Changes a setting, again and again while the key is down.
    Step(fn(&mut Controls)),
    /// Narrows the field of view by steps, again and again while the key is down.
    Zoom(f64),
    /// Opens the aperture by stops, again and again while the key is down.
    Open(f64),
    /// Focuses on what is in the middle of the picture.
    Focus,
    /// Switches between perspective and orthographic.
    Project,
    /// Changes a setting once.
    Switch(fn(&mut Controls)),
    /// Resets the camera to the scene's.
    Home,
    /// Loads the scene that becomes the current one.
    Scene(fn(&mut Playlist)),
    Reload,
    Screenshot,
    ReleaseMouse,
}

/// The action of every key, in the order of the help.
const TABLE: &[(&[Key], Action)] = &[
    (&[Char('w')], Hold(Motion::Forward)),
    (&[Char('s')], Hold(Motion::Back)),
    (&[Char('a')], Hold(Motion::Left)),
    (&[Char('d')], Hold(Motion::Right)),
    (&[Char(' ')], Hold(Motion::Up)),
    (&[Key::Modifier(LeftShift), Char('z')], Hold(Motion::Down)),
    (&[Key::Left], Hold(Motion::TurnLeft)),
    (&[Key::Right], Hold(Motion::TurnRight)),
    (&[Key::Up], Hold(Motion::TurnUp)),
    (&[Key::Down], Hold(Motion::TurnDown)),
    (&[Key::Modifier(LeftControl)], Hold(Motion::Fast)),
    (&[Char('+'), Char('=')], Zoom(1.0)),
    (&[Char('-')], Zoom(-1.0)),
    (&[Char('y')], Open(-1.0)),
    (&[Char('u')], Open(1.0)),
    (&[Char('b')], Action::Focus),
    (&[Key::End], Action::Project),
    (&[Key::Home], Action::Home),
    (&[Key::PageDown, Char('.')], Scene(Playlist::next)),
    (&[Key::PageUp, Char(',')], Scene(Playlist::previous)),
    (&[Char('r'), Key::F(5)], Action::Reload),
    (&[Char('1')], Switch(|set| set.mode = DisplayMode::Picture)),
    (&[Char('2')], Switch(|set| set.mode = DisplayMode::Normals)),
    (&[Char('3')], Switch(|set| set.mode = DisplayMode::Albedo)),
    (&[Char('4')], Switch(|set| set.mode = DisplayMode::Depth)),
    (&[Char('5')], Switch(|set| set.mode = DisplayMode::Barycentrics)),
    (&[Char('6')], Switch(|set| set.mode = DisplayMode::Lambert)),
    (&[Char('7')], Switch(|set| set.mode = DisplayMode::Bounces)),
    (&[Char('8')], Switch(|set| set.mode = DisplayMode::Cost)),
    (&[Char('9')], Switch(|set| set.mode = DisplayMode::Samples)),
    (&[Char('0')], Switch(|set| set.mode = DisplayMode::Lanes)),
    (&[Char('t')], Switch(|set| set.reprojection = !set.reprojection)),
    (&[Char('f')], Switch(|set| cycle(&mut set.filter, &Filter::ALL))),
    (&[Char('n')], Switch(|set| set.denoiser = !set.denoiser)),
    (&[Char('[')], Step(|set| set.add_bounces(-1))),
    (&[Char(']')], Step(|set| set.add_bounces(1))),
    (&[Char('j')], Step(|set| set.add_scale(-1))),
    (&[Char('k')], Step(|set| set.add_scale(1))),
    (&[Char('g')], Switch(|set| cycle(&mut set.target, &[None, Some(15), Some(30), Some(60)]))),
    (&[Char('c')], Switch(Controls::next_threads)),
    (&[Char('l')], Switch(|set| set.scalar = !set.scalar)),
    (&[Char('x')], Switch(|set| cycle(&mut set.preset, &[None, Some(0), Some(1)]))),
    (&[Char('v')], Switch(Controls::next_traversal)),
    (&[Char('e')], Step(|set| set.add_exposure(0.5))),
    (&[Char('q')], Step(|set| set.add_exposure(-0.5))),
    (&[Char('o')], Switch(|set| cycle(&mut set.tone.operator, &Operator::ALL))),
    (&[Char('m')], Switch(|set| set.minimap = !set.minimap)),
    (&[Key::Tab, Char('p')], Action::Screenshot),
    (&[Char('i')], Switch(|set| set.overlay = !set.overlay)),
    (&[Char('h'), Key::F(1)], Switch(|set| set.help = !set.help)),
    (&[Key::Esc], Action::ReleaseMouse),
];

/// Returns the action of a key.
pub(crate) fn action_of(key: Key) -> Option<Action> {
    TABLE.iter().find(|(keys, _)| keys.contains(&key)).map(|(_, action)| *action)
}

/// Returns the help: one line per binding, keys and meaning.
pub fn help() -> impl Iterator<Item = &'static str> {
    include_str!("keys.txt").lines()
}

/// Returns the help for this many columns and lines: one line per binding if they fit, else compact.
pub(crate) fn help_in(columns: usize, lines: usize) -> Vec<String> {
    let fits = help().count() <= lines && help().all(|line| line.chars().count() <= columns);
    if fits { help().map(String::from).collect() } else { short_help(columns) }
}

/// Returns the compact help: several bindings in a line where they have room.
fn short_help(width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for (keys, meaning) in help().filter_map(|line| line.split_once("  ")) {
        let binding = format!("{keys}: {}", meaning.trim_start());
        match lines.last_mut() {
            Some(line) if line.chars().count() + 3 + binding.chars().count() <= width => {
                *line += &format!("   {binding}");
            }
            _ => lines.extend(textwrap::wrap(&binding, width).into_iter().map(String::from)),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    /// The settings after these letters.
    fn after(letters: &str) -> Controls {
        let mut controls = Controls { threads: 6, max_threads: 6, ..Controls::default() };
        for letter in letters.chars() {
            let Some(Step(change) | Switch(change)) = action_of(Char(letter)) else { panic!("{letter}") };
            change(&mut controls);
        }
        controls
    }

    #[test]
    fn circles_close_after_all_of_their_choices() {
        for (letter, choices) in [("g", 4), ("c", 4), ("x", 3), ("v", 7), ("o", 3), ("f", 3)] {
            for times in 1..choices {
                assert_ne!(after(&letter.repeat(times)), after(""), "{letter} {times}");
            }
            assert_eq!(after(&letter.repeat(choices)), after(""), "{letter}");
        }
        assert_eq!(["c", "cc", "ccc", "cccc"].map(|letters| after(letters).threads), [1, 2, 4, 6]);
    }

    #[test]
    fn every_key_does_one_thing() {
        let mut seen = HashSet::new();
        assert!(TABLE.iter().flat_map(|(keys, _)| *keys).all(|key| seen.insert(*key)), "{seen:?}");
    }

    #[test]
    fn short_help_says_the_same_in_the_room_of_a_small_terminal() {
        for width in [80, 100, 40, 20] {
            let lines = short_help(width);
            assert!(lines.iter().all(|line| line.chars().count() <= width), "{lines:#?}");
            let (words, all) = (lines.join(" "), help().collect::<Vec<_>>().join(" "));
            let count = |text: &str| text.split_whitespace().count();
            assert_eq!(count(&words), count(&all), "each word once");
        }
        // With a line for Ctrl-C.
        assert!(short_help(80).len() < 24, "{:#?}", short_help(80));
        let table: Vec<&str> = help().collect();
        assert_eq!(help_in(200, table.len()), table);
        assert_eq!(help_in(200, table.len() - 1), short_help(200));
        assert_eq!(help_in(80, 60), short_help(80));
    }

    #[test]
    fn every_display_mode_has_a_key_and_stands_in_the_help_in_its_order() {
        let digits = ["1", "2", "3", "4", "5", "6", "7", "8", "9", "0"];
        let names = digits.map(|digit| after(digit).mode.name_and_legend().0);
        assert_eq!(HashSet::from(names).len(), names.len());
        assert!(help().any(|line| line.contains(&names.join(", "))), "{}", names.join(", "));
    }
}
