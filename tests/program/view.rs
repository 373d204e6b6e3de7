//! `octray view` where there is nothing to show, or nothing to show it on.

use crate::desk::Desk;

#[test]
fn what_cannot_be_shown_is_refused() {
    let desk = Desk::new();
    desk.write("empty/readme.md", "no scene");
    desk.refuses("view empty", &["no scene", "empty", "name a folder that holds some"]);
    desk.refuses("view nowhere.json", &["nowhere.json"]);
    desk.refuses("view builtin:nowhere", &["builtin:nowhere"]);
    desk.refuses("view --frames 0", &["--frames", "from 1 to"]);
    let words = ["draws in a terminal", "standard output is not one", "octray render"];
    desk.refuses("view scene.json --terminal", &words);
}

/// Elsewhere a window needs no variable to be set.
#[cfg(all(feature = "window", unix, not(target_vendor = "apple")))]
#[test]
fn without_a_display_it_says_what_works_there() {
    let desk = Desk::new();
    for display in [None, Some(("DISPLAY", ":9999")), Some(("WAYLAND_SOCKET", "77"))] {
        let mut view = desk.octray("view scene.json");
        view.envs(display);
        let refused = view.assert().code(2).stdout("");
        let said = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
        for words in ["error: there is no display", "octray view --terminal", "octray render"] {
            assert!(said.contains(words), "{display:?}: {said}");
        }
        assert!(!said.contains("panicked"), "{said}");
    }
}
