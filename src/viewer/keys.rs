//! Key bindings: one table of keys, what they do, and the help.
//!
//! For: [`Key`], `Action`, `action_of`, [`help`].

use super::camera_controller::Motion;
use super::controls::{Controls, Filter, MethodPreset, cycle};
use super::display_mode::DisplayMode;
use Action::{Hold, Step, Switch, Zoom};
use Key::Char;
use octray_engine::tone::Operator;

/// A key of a window or a terminal. Letters are lower case. Letters for walking follow the physical key where
/// it is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Key {
    /// The character that the key types without Shift; the space bar is `' '`.
    Char(char),
    /// Arrow up.
    Up,
    /// Arrow down.
    Down,
    /// Arrow left.
    Left,
    /// Arrow right.
    Right,
    /// Either Shift key; terminals do not report it.
    Shift,
    /// Either Ctrl key; terminals do not report it.
    Control,
    /// The tabulator key.
    Tab,
    /// The Esc key.
    Escape,
    /// Page up.
    PageUp,
    /// Page down.
    PageDown,
    /// The Home key, Pos 1 on some keyboards.
    Home,
    /// Function key 1.
    F1,
    /// Function key 5.
    F5,
}

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
    NextScene,
    PreviousScene,
    Reload,
    Screenshot,
    ReleaseMouse,
}

/// A line of the help: the names of keys, what they do, and the action of each.
type Binding = (&'static str, &'static str, &'static [(Key, Action)]);

/// All bindings, in the order of the help.
const BINDINGS: &[Binding] = &[
    (
        "W A S D",
        "walk",
        &[
            (Char('w'), Hold(Motion::Forward)),
            (Char('s'), Hold(Motion::Back)),
            (Char('a'), Hold(Motion::Left)),
            (Char('d'), Hold(Motion::Right)),
        ],
    ),
    (
        "Space, Shift, Z",
        "rise, sink",
        &[(Char(' '), Hold(Motion::Up)), (Key::Shift, Hold(Motion::Down)), (Char('z'), Hold(Motion::Down))],
    ),
    (
        "arrows, mouse",
        "turn; a click captures the mouse, Esc releases it",
        &[
            (Key::Left, Hold(Motion::TurnLeft)),
            (Key::Right, Hold(Motion::TurnRight)),
            (Key::Up, Hold(Motion::TurnUp)),
            (Key::Down, Hold(Motion::TurnDown)),
        ],
    ),
    ("Ctrl", "four times as fast while held", &[(Key::Control, Hold(Motion::Fast))]),
    (
        "+ -, wheel",
        "narrower, wider field of view",
        &[(Char('+'), Zoom(1.0)), (Char('='), Zoom(1.0)), (Char('-'), Zoom(-1.0))],
    ),
    ("Home", "the scene's own camera", &[(Key::Home, Action::Home)]),
    (
        "PgDn PgUp or . ,",
        "next, previous scene",
        &[
            (Key::PageDown, Action::NextScene),
            (Key::PageUp, Action::PreviousScene),
            (Char('.'), Action::NextScene),
            (Char(','), Action::PreviousScene),
        ],
    ),
    (
        "R",
        "reload the scene's files (changes reload them too)",
        &[(Char('r'), Action::Reload), (Key::F5, Action::Reload)],
    ),
    (
        "1 to 9, 0",
        "picture, normals, albedo, depth, barycentrics, n·l, bounces, cost, samples, lanes",
        &[
            (Char('1'), Switch(|set| set.mode = DisplayMode::Picture)),
            (Char('2'), Switch(|set| set.mode = DisplayMode::Normals)),
            (Char('3'), Switch(|set| set.mode = DisplayMode::Albedo)),
            (Char('4'), Switch(|set| set.mode = DisplayMode::Depth)),
            (Char('5'), Switch(|set| set.mode = DisplayMode::Barycentrics)),
            (Char('6'), Switch(|set| set.mode = DisplayMode::Lambert)),
            (Char('7'), Switch(|set| set.mode = DisplayMode::Bounces)),
            (Char('8'), Switch(|set| set.mode = DisplayMode::Cost)),
            (Char('9'), Switch(|set| set.mode = DisplayMode::Samples)),
            (Char('0'), Switch(|set| set.mode = DisplayMode::Lanes)),
        ],
    ),
    (
        "T",
        "temporal reprojection while moving, or not",
        &[(Char('t'), Switch(|set| set.reprojection = !set.reprojection))],
    ),
    (
        "F",
        "antialiasing of what is shown: none, 3×3 blur, FXAA",
        &[(Char('f'), Switch(|set| cycle(&mut set.filter, &Filter::ALL)))],
    ),
    ("N", "denoiser, or none", &[(Char('n'), Switch(|set| set.denoiser = !set.denoiser))]),
    (
        "[ ]",
        "fewer, more bounces",
        &[(Char('['), Step(|set| set.add_bounces(-1))), (Char(']'), Step(|set| set.add_bounces(1)))],
    ),
    (
        "J K",
        "lower, higher resolution",
        &[(Char('j'), Step(|set| set.add_scale(-1))), (Char('k'), Step(|set| set.add_scale(1)))],
    ),
    (
        "G",
        "frame rate to hold by a lower resolution: none, 15, 30, 60",
        &[(Char('g'), Switch(|set| cycle(&mut set.target, &[None, Some(15), Some(30), Some(60)])))],
    ),
    ("C", "threads: 1, 2, 4 and so on, all", &[(Char('c'), Switch(Controls::next_threads))]),
    ("L", "SIMD or scalar", &[(Char('l'), Switch(|set| set.scalar = !set.scalar))]),
    (
        "X",
        "intersection methods: as requested, robust, fast, naive",
        &[(Char('x'), Switch(|set| cycle(&mut set.preset, &MethodPreset::ALL)))],
    ),
    (
        "V",
        "traversal: needed, linear, scalar, single, packet, stream, hybrid",
        &[(Char('v'), Switch(Controls::next_traversal))],
    ),
    (
        "E Q",
        "brighter, darker",
        &[(Char('e'), Step(|set| set.add_exposure(0.5))), (Char('q'), Step(|set| set.add_exposure(-0.5)))],
    ),
    (
        "O",
        "tone mapping: clamp, Reinhard, ACES",
        &[(Char('o'), Switch(|set| cycle(&mut set.tone.operator, &Operator::ALL)))],
    ),
    ("M", "map from above", &[(Char('m'), Switch(|set| set.minimap = !set.minimap))]),
    (
        "Tab, P",
        "screenshot: PNG, EXR, and a view file to render it again",
        &[(Key::Tab, Action::Screenshot), (Char('p'), Action::Screenshot)],
    ),
    ("I", "figures, or none", &[(Char('i'), Switch(|set| set.overlay = !set.overlay))]),
    (
        "H",
        "this help",
        &[(Char('h'), Switch(|set| set.help = !set.help)), (Key::F1, Switch(|set| set.help = !set.help))],
    ),
    ("Esc", "release the mouse", &[(Key::Escape, Action::ReleaseMouse)]),
];

/// The action of a key.
pub(crate) fn action_of(key: Key) -> Option<Action> {
    let mut all = BINDINGS.iter().flat_map(|(.., keys)| *keys);
    all.find(|(bound, _)| *bound == key).map(|(_, action)| *action)
}

/// The help: one line per binding, keys and meaning.
pub fn help() -> impl Iterator<Item = String> {
    let width = BINDINGS.iter().map(|(keys, ..)| keys.chars().count()).max().unwrap_or(0);
    BINDINGS.iter().map(move |(keys, meaning, _)| format!("{keys:width$}  {meaning}"))
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
    for (keys, meaning, _) in BINDINGS {
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
    use std::collections::BTreeSet;

    /// The settings after these letters.
    fn after(letters: &str) -> Controls {
        let mut controls = Controls::new(4, 6, LaneChoice::Eight, Tone::default());
        for letter in letters.chars() {
            let Some(Step(change) | Switch(change)) = action_of(Char(letter)) else { panic!("{letter}") };
            change(&mut controls);
        }
        controls
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
        for (letter, choices) in [("g", 4), ("c", 4), ("x", 4), ("v", 7), ("o", 3), ("f", 3)] {
            for times in 1..choices {
                assert_ne!(after(&letter.repeat(times)), after(""), "{letter} {times}");
            }
            assert_eq!(after(&letter.repeat(choices)), after(""), "{letter}");
        }
        assert_eq!(["c", "cc", "ccc", "cccc"].map(|letters| after(letters).threads), [1, 2, 4, 6]);
    }

    #[test]
    fn every_key_does_one_thing() {
        let keys: Vec<Key> = BINDINGS.iter().flat_map(|(.., keys)| *keys).map(|(key, _)| *key).collect();
        let distinct: BTreeSet<Key> = keys.iter().copied().collect();
        assert_eq!(distinct.len(), keys.len());
    }

    #[test]
    fn short_help_says_the_same_in_the_room_of_a_small_terminal() {
        for width in [80, 100, 40, 20] {
            let lines = short_help(width);
            assert!(lines.iter().all(|line| line.chars().count() <= width), "{lines:#?}");
            let (words, all) = (lines.join(" "), help().collect::<Vec<_>>().join(" "));
            let count = |text: &str| text.split_whitespace().count();
            assert_eq!(count(&words), count(&all), "each word once");
            for text in BINDINGS.iter().map(|(keys, meaning, _)| format!("{keys}: {meaning}")) {
                let whole = lines.iter().any(|line| line.contains(&text));
                assert!(whole || text.chars().count() > width, "{text} is in one line of {width}");
            }
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
        assert_eq!(BTreeSet::from(names).len(), names.len());
        assert!(help().any(|line| line.contains(&names.join(", "))), "{}", names.join(", "));
    }
}
