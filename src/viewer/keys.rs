//! Key bindings: one table of keys, what they do, and the help.

use super::camera_controller::Motion;
use super::controls::{Controls, Filter, cycle};
use super::display_mode::DisplayMode;
use super::playlist::Playlist;
use Action::{Hold, Scene, Step, Switch, Zoom};
use Entry::{Help, On};
use Key::Char;
use crossterm::event::ModifierKeyCode::{LeftControl, LeftShift};

/// A key of a window or a terminal. Letters are lower case; letters for walking follow the physical key where
/// it is known. Both keys of a modifier are the left one; terminals do not report them.
pub use crossterm::event::KeyCode as Key;
use octray_engine::tone::Operator;

/// What a key does.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Action {
    /// Moves the camera while the key is down.
    Hold(Motion),
    /// Changes a setting, again and again while the key is down.
    Step(fn(&mut Controls)),
    /// Narrows the field of view by steps, again and again while the key is down.
    Zoom(f64),
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

/// A line of the help, or a key that the line before is about.
enum Entry {
    /// The names of keys, and what they do.
    Help(&'static str, &'static str),
    On(Key, Action),
}

/// All keys, in the order of the help.
const TABLE: &[Entry] = &[
    Help("W A S D", "walk"),
    On(Char('w'), Hold(Motion::Forward)),
    On(Char('s'), Hold(Motion::Back)),
    On(Char('a'), Hold(Motion::Left)),
    On(Char('d'), Hold(Motion::Right)),
    Help("Space, Shift, Z", "rise, sink"),
    On(Char(' '), Hold(Motion::Up)),
    On(Key::Modifier(LeftShift), Hold(Motion::Down)),
    On(Char('z'), Hold(Motion::Down)),
    Help("arrows, mouse", "turn; a click captures the mouse, Esc releases it"),
    On(Key::Left, Hold(Motion::TurnLeft)),
    On(Key::Right, Hold(Motion::TurnRight)),
    On(Key::Up, Hold(Motion::TurnUp)),
    On(Key::Down, Hold(Motion::TurnDown)),
    Help("Ctrl", "four times as fast while held"),
    On(Key::Modifier(LeftControl), Hold(Motion::Fast)),
    Help("+ -, wheel", "narrower, wider field of view"),
    On(Char('+'), Zoom(1.0)),
    On(Char('='), Zoom(1.0)),
    On(Char('-'), Zoom(-1.0)),
    Help("Home", "the scene's own camera"),
    On(Key::Home, Action::Home),
    Help("PgDn PgUp or . ,", "next, previous scene"),
    On(Key::PageDown, Scene(Playlist::next)),
    On(Key::PageUp, Scene(Playlist::previous)),
    On(Char('.'), Scene(Playlist::next)),
    On(Char(','), Scene(Playlist::previous)),
    Help("R", "reload the scene's files (changes reload them too)"),
    On(Char('r'), Action::Reload),
    On(Key::F(5), Action::Reload),
    Help("1 to 9, 0", "picture, normals, albedo, depth, barycentrics, n·l, bounces, cost, samples, lanes"),
    On(Char('1'), Switch(|set| set.mode = DisplayMode::Picture)),
    On(Char('2'), Switch(|set| set.mode = DisplayMode::Normals)),
    On(Char('3'), Switch(|set| set.mode = DisplayMode::Albedo)),
    On(Char('4'), Switch(|set| set.mode = DisplayMode::Depth)),
    On(Char('5'), Switch(|set| set.mode = DisplayMode::Barycentrics)),
    On(Char('6'), Switch(|set| set.mode = DisplayMode::Lambert)),
    On(Char('7'), Switch(|set| set.mode = DisplayMode::Bounces)),
    On(Char('8'), Switch(|set| set.mode = DisplayMode::Cost)),
    On(Char('9'), Switch(|set| set.mode = DisplayMode::Samples)),
    On(Char('0'), Switch(|set| set.mode = DisplayMode::Lanes)),
    Help("T", "temporal reprojection while moving, or not"),
    On(Char('t'), Switch(|set| set.reprojection = !set.reprojection)),
    Help("F", "antialiasing of what is shown: none, 3×3 blur, FXAA"),
    On(Char('f'), Switch(|set| cycle(&mut set.filter, &Filter::ALL))),
    Help("N", "denoiser, or none"),
    On(Char('n'), Switch(|set| set.denoiser = !set.denoiser)),
    Help("[ ]", "fewer, more bounces"),
    On(Char('['), Step(|set| set.add_bounces(-1))),
    On(Char(']'), Step(|set| set.add_bounces(1))),
    Help("J K", "lower, higher resolution"),
    On(Char('j'), Step(|set| set.add_scale(-1))),
    On(Char('k'), Step(|set| set.add_scale(1))),
    Help("G", "frame rate to hold by a lower resolution: none, 15, 30, 60"),
    On(Char('g'), Switch(|set| cycle(&mut set.target, &[None, Some(15), Some(30), Some(60)]))),
    Help("C", "threads: 1, 2, 4 and so on, all"),
    On(Char('c'), Switch(Controls::next_threads)),
    Help("L", "SIMD or scalar"),
    On(Char('l'), Switch(|set| set.scalar = !set.scalar)),
    Help("X", "intersection methods: as requested, robust, naive"),
    On(Char('x'), Switch(|set| cycle(&mut set.preset, &[None, Some(0), Some(1)]))),
    Help("V", "traversal: auto, linear, scalar, single, packet, stream, hybrid"),
    On(Char('v'), Switch(Controls::next_traversal)),
    Help("E Q", "brighter, darker"),
    On(Char('e'), Step(|set| set.add_exposure(0.5))),
    On(Char('q'), Step(|set| set.add_exposure(-0.5))),
    Help("O", "tone mapping: clamp, Reinhard, ACES"),
    On(Char('o'), Switch(|set| cycle(&mut set.tone.operator, &Operator::ALL))),
    Help("M", "map from above"),
    On(Char('m'), Switch(|set| set.minimap = !set.minimap)),
    Help("Tab, P", "screenshot: PNG, EXR, and a view file to render it again"),
    On(Key::Tab, Action::Screenshot),
    On(Char('p'), Action::Screenshot),
    Help("I", "figures, or none"),
    On(Char('i'), Switch(|set| set.overlay = !set.overlay)),
    Help("H", "this help"),
    On(Char('h'), Switch(|set| set.help = !set.help)),
    On(Key::F(1), Switch(|set| set.help = !set.help)),
    Help("Esc", "release the mouse"),
    On(Key::Esc, Action::ReleaseMouse),
];

/// The action of a key.
pub(crate) fn action_of(key: Key) -> Option<Action> {
    TABLE.iter().find_map(|entry| match entry {
        On(bound, action) if *bound == key => Some(*action),
        _ => None,
    })
}

/// The lines of the help: keys and meaning.
fn help_lines() -> impl Iterator<Item = (&'static str, &'static str)> {
    TABLE.iter().filter_map(|entry| match entry {
        Help(keys, meaning) => Some((*keys, *meaning)),
        On(..) => None,
    })
}

/// The help: one line per binding, keys and meaning.
pub fn help() -> impl Iterator<Item = String> {
    let width = help_lines().map(|(keys, _)| keys.chars().count()).max().unwrap_or(0);
    help_lines().map(move |(keys, meaning)| format!("{keys:width$}  {meaning}"))
}

/// The help for this many columns and lines: one line per binding if they fit, else compact.
pub(crate) fn help_in(columns: usize, lines: usize) -> Vec<String> {
    let help: Vec<String> = help().collect();
    let fits = help.len() <= lines && help.iter().all(|line| line.chars().count() <= columns);
    if fits { help } else { short_help(columns) }
}

/// The compact help: several bindings in a line where they have room.
fn short_help(width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for (keys, meaning) in help_lines() {
        let binding = format!("{keys}: {meaning}");
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
    use octray_engine::render::LaneChoice;
    use octray_engine::tone::Tone;
    use std::collections::HashSet;

    /// The settings after these letters.
    fn after(letters: &str) -> Controls {
        let mut controls = Controls::new(4, 6, LaneChoice::Eight, Tone::default());
        for letter in letters.chars() {
            let Some(Step(change) | Switch(change)) = action_of(Char(letter)) else { panic!("{letter}") };
            change(&mut controls);
        }
        controls
    }

    /// The table that the README links.
    #[test]
    fn keys_txt_is_the_help() {
        let lines: String = help().map(|line| line + "\n").collect();
        assert_eq!(include_str!("keys.txt"), lines);
    }

    #[test]
    fn opposites_bring_everything_back() {
        for both in ["][", "jk", "eq", "ll", "tt", "nn", "mm", "ii", "hh", "81"] {
            assert_ne!(after(&both[..1]), after(""), "{both} does something");
            assert_eq!(after(both), after(""), "{both}");
        }
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
        for entry in TABLE {
            assert!(!matches!(entry, On(key, _) if !seen.insert(*key)), "{seen:?}");
        }
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
        let table: Vec<String> = help().collect();
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
