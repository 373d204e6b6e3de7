//! Key bindings: one table for the state machine and the help.
//!
//! For: [`Key`], `Action`, `action_of`, [`help`].

use super::display_mode::DisplayMode;

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

/// A motion that lasts while a key is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Motion {
    Forward,
    Back,
    Left,
    Right,
    Up,
    Down,
    TurnLeft,
    TurnRight,
    TurnUp,
    TurnDown,
    /// Makes the other motions four times as fast.
    Fast,
}

impl Motion {
    pub const COUNT: usize = Self::Fast as usize + 1;
}

/// A command that runs once when a key goes down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Command {
    NextScene,
    PreviousScene,
    Reload,
    /// Resets the camera to the scene's.
    Home,
    Narrower,
    Wider,
    FewerBounces,
    MoreBounces,
    Coarser,
    Finer,
    NextTarget,
    NextThreads,
    SwitchLanes,
    NextMethods,
    NextTraversal,
    Brighter,
    Darker,
    NextTone,
    Show(DisplayMode),
    SwitchReprojection,
    NextFilter,
    SwitchDenoiser,
    Screenshot,
    SwitchMinimap,
    SwitchOverlay,
    SwitchHelp,
    /// Releases the mouse.
    ReleaseMouse,
}

/// The effect of a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Action {
    Hold(Motion),
    Do(Command),
}

/// A line of the help: keys with one action or with opposite ones.
pub(crate) struct Binding {
    pub keys: &'static [(Key, Action)],
    /// The keys' names in the help.
    pub label: &'static str,
    pub meaning: &'static str,
}

const fn hold(key: Key, motion: Motion) -> (Key, Action) {
    (key, Action::Hold(motion))
}
const fn on(key: Key, command: Command) -> (Key, Action) {
    (key, Action::Do(command))
}
const fn letter(letter: char, command: Command) -> (Key, Action) {
    on(Key::Char(letter), command)
}

/// All bindings, in the order of the help.
pub(crate) const BINDINGS: &[Binding] = &[
    Binding {
        keys: &[
            hold(Key::Char('w'), Motion::Forward),
            hold(Key::Char('s'), Motion::Back),
            hold(Key::Char('a'), Motion::Left),
            hold(Key::Char('d'), Motion::Right),
        ],
        label: "W A S D",
        meaning: "walk",
    },
    Binding {
        keys: &[
            hold(Key::Char(' '), Motion::Up),
            hold(Key::Shift, Motion::Down),
            hold(Key::Char('z'), Motion::Down),
        ],
        label: "Space, Shift, Z",
        meaning: "rise, sink",
    },
    Binding {
        keys: &[
            hold(Key::Left, Motion::TurnLeft),
            hold(Key::Right, Motion::TurnRight),
            hold(Key::Up, Motion::TurnUp),
            hold(Key::Down, Motion::TurnDown),
        ],
        label: "arrows, mouse",
        meaning: "turn; a click captures the mouse, Esc releases it",
    },
    Binding {
        keys: &[hold(Key::Control, Motion::Fast)],
        label: "Ctrl",
        meaning: "four times as fast while held",
    },
    Binding {
        keys: &[letter('+', Command::Narrower), letter('=', Command::Narrower), letter('-', Command::Wider)],
        label: "+ -, wheel",
        meaning: "narrower, wider field of view",
    },
    Binding { keys: &[on(Key::Home, Command::Home)], label: "Home", meaning: "the scene's own camera" },
    Binding {
        keys: &[
            on(Key::PageDown, Command::NextScene),
            on(Key::PageUp, Command::PreviousScene),
            letter('.', Command::NextScene),
            letter(',', Command::PreviousScene),
        ],
        label: "PgDn PgUp or . ,",
        meaning: "next, previous scene",
    },
    Binding {
        keys: &[letter('r', Command::Reload), on(Key::F5, Command::Reload)],
        label: "R",
        meaning: "reload the scene's files (changes reload them too)",
    },
    Binding {
        keys: &[
            letter('1', Command::Show(DisplayMode::Picture)),
            letter('2', Command::Show(DisplayMode::Normals)),
            letter('3', Command::Show(DisplayMode::Albedo)),
            letter('4', Command::Show(DisplayMode::Depth)),
            letter('5', Command::Show(DisplayMode::Barycentrics)),
            letter('6', Command::Show(DisplayMode::Lambert)),
            letter('7', Command::Show(DisplayMode::Bounces)),
            letter('8', Command::Show(DisplayMode::Cost)),
            letter('9', Command::Show(DisplayMode::Samples)),
            letter('0', Command::Show(DisplayMode::Lanes)),
        ],
        label: "1 to 9, 0",
        meaning: "picture, normals, albedo, depth, barycentrics, n·l, bounces, cost, samples, lanes",
    },
    Binding {
        keys: &[letter('t', Command::SwitchReprojection)],
        label: "T",
        meaning: "temporal reprojection while moving, or not",
    },
    Binding {
        keys: &[letter('f', Command::NextFilter)],
        label: "F",
        meaning: "antialiasing of what is shown: none, 3×3 blur, FXAA",
    },
    Binding { keys: &[letter('n', Command::SwitchDenoiser)], label: "N", meaning: "denoiser, or none" },
    Binding {
        keys: &[letter('[', Command::FewerBounces), letter(']', Command::MoreBounces)],
        label: "[ ]",
        meaning: "fewer, more bounces",
    },
    Binding {
        keys: &[letter('j', Command::Coarser), letter('k', Command::Finer)],
        label: "J K",
        meaning: "lower, higher resolution",
    },
    Binding {
        keys: &[letter('g', Command::NextTarget)],
        label: "G",
        meaning: "frame rate to hold by a lower resolution: none, 15, 30, 60",
    },
    Binding {
        keys: &[letter('c', Command::NextThreads)],
        label: "C",
        meaning: "threads: 1, 2, 4 and so on, all",
    },
    Binding { keys: &[letter('l', Command::SwitchLanes)], label: "L", meaning: "SIMD or scalar" },
    Binding {
        keys: &[letter('x', Command::NextMethods)],
        label: "X",
        meaning: "intersection methods: as requested, robust, fast, naive",
    },
    Binding {
        keys: &[letter('v', Command::NextTraversal)],
        label: "V",
        meaning: "traversal: needed, linear, scalar, single, packet, stream, hybrid",
    },
    Binding {
        keys: &[letter('e', Command::Brighter), letter('q', Command::Darker)],
        label: "E Q",
        meaning: "brighter, darker",
    },
    Binding {
        keys: &[letter('o', Command::NextTone)],
        label: "O",
        meaning: "tone mapping: clamp, Reinhard, ACES",
    },
    Binding { keys: &[letter('m', Command::SwitchMinimap)], label: "M", meaning: "map from above" },
    Binding {
        keys: &[on(Key::Tab, Command::Screenshot), letter('p', Command::Screenshot)],
        label: "Tab, P",
        meaning: "screenshot: PNG, EXR, and a view file to render it again",
    },
    Binding { keys: &[letter('i', Command::SwitchOverlay)], label: "I", meaning: "figures, or none" },
    Binding {
        keys: &[letter('h', Command::SwitchHelp), on(Key::F1, Command::SwitchHelp)],
        label: "H",
        meaning: "this help",
    },
    Binding { keys: &[on(Key::Escape, Command::ReleaseMouse)], label: "Esc", meaning: "release the mouse" },
];

/// The action bound to a key.
pub(crate) fn action_of(key: Key) -> Option<Action> {
    let all = BINDINGS.iter().flat_map(|binding| binding.keys);
    all.into_iter().find(|(bound, _)| *bound == key).map(|&(_, action)| action)
}

/// The help: one line per binding, keys and meaning.
pub fn help() -> impl Iterator<Item = String> {
    let width = BINDINGS.iter().map(|binding| binding.label.chars().count()).max().unwrap_or(0);
    BINDINGS.iter().map(move |Binding { label, meaning, .. }| format!("{label:width$}  {meaning}"))
}

/// The help for this many columns and lines: one line per binding if they fit, else compact.
pub(crate) fn help_in(columns: usize, lines: usize) -> Vec<String> {
    let help: Vec<String> = help().collect();
    let fits = help.len() <= lines && help.iter().all(|line| line.chars().count() <= columns);
    if fits { help } else { short_help(columns) }
}

/// The compact help: bindings one after another in lines of `width` characters, broken between words.
fn short_help(width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    let mut write = |word: &str, gap: &str, room: usize| {
        let line = lines.last_mut().expect("there is a line from the start");
        let used = line.chars().count() + gap.len();
        if line.is_empty() || used + room <= width {
            let gap = if line.is_empty() { "" } else { gap };
            *line += &format!("{gap}{word}");
        } else {
            lines.push(word.to_string());
        }
    };
    for Binding { label, meaning, .. } in BINDINGS {
        let text = format!("{label}: {meaning}");
        let whole = text.chars().count().min(width);
        for (at, word) in text.split(' ').enumerate() {
            // A binding that does not fit starts a new line.
            let (gap, room) = if at == 0 { ("   ", whole) } else { (" ", word.chars().count()) };
            write(word, gap, room);
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_key_does_one_thing() {
        let keys: Vec<Key> = BINDINGS.iter().flat_map(|binding| binding.keys).map(|&(key, _)| key).collect();
        let distinct: BTreeSet<Key> = keys.iter().copied().collect();
        assert_eq!(distinct.len(), keys.len());
    }

    #[test]
    fn short_help_says_the_same_in_the_room_of_a_small_terminal() {
        for width in [80, 100, 40, 20] {
            let lines = short_help(width);
            assert!(lines.iter().all(|line| line.chars().count() <= width.max(20)), "{lines:#?}");
            let (words, all) = (lines.join(" "), help().collect::<Vec<_>>().join(" "));
            let count = |text: &str| text.split_whitespace().count();
            assert_eq!(count(&words), count(&all), "each word once");
            let short = |text: &String| text.chars().count() <= width;
            for text in BINDINGS.iter().map(|Binding { label, meaning, .. }| format!("{label}: {meaning}")) {
                let whole = lines.iter().any(|line| line.contains(&text));
                assert!(whole || !short(&text), "{text} is in one line of {width}");
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
        let mut names = Vec::new();
        for (at, mode) in DisplayMode::ALL.into_iter().enumerate() {
            let digit = char::from_digit((at as u32 + 1) % 10, 10).unwrap();
            assert_eq!(action_of(Key::Char(digit)), Some(Action::Do(Command::Show(mode))));
            names.push(mode.name());
        }
        assert!(help().any(|line| line.contains(&names.join(", "))), "{}", names.join(", "));
    }
}
