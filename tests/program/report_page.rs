//! The page of `octray chart` in a real browser: it needs no other file, fits a phone, and prints.
//!
//! Skipped, saying so, where no browser is installed (Chromium or Chrome; `OCTRAY_BROWSER` names another of
//! their family), unless `CI` is `true`.

use crate::chart::SMALL;
use crate::desk::{Desk, list};
use crate::skipped::skip;
use octray::measure::chart::configurations::{GROUPS, of_scene};
use octray::measure::stability::methods::MEANINGS;
use octray::render::Settings;
use octray::scene::load;
use serde_json::Value;
use std::path::Path;
use std::process::Command;

const BROWSERS: [&str; 5] =
    ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome-headless-shell"];

/// A browser without a window; `None` where there is none.
fn browser() -> Option<Command> {
    let named = std::env::var("OCTRAY_BROWSER").ok();
    let names = named.iter().map(String::as_str).chain(BROWSERS);
    let works = |name: &&str| {
        Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success())
    };
    let mut browser = Command::new(names.into_iter().find(works)?);
    browser.args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"]);
    browser.args(["--hide-scrollbars", "--no-first-run", "--disable-background-networking"]);
    Some(browser)
}

/// Returns the page as the browser has it after its scripts have run.
fn dom(file: &Path, width: u32) -> Option<String> {
    let output = browser()?
        .arg(format!("--window-size={width},900"))
        .args(["--virtual-time-budget=2000", "--dump-dom"])
        .arg(format!("file://{}", file.display()))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(String::from_utf8(output.stdout).unwrap())
}

/// The page needs nothing beside it, and explains what it shows of a scene.
pub fn assert_stands_alone(page: &str, report: &Value, scene: &str) {
    for outside in ["src=", "href=", "url(", "<script", "@import", "<link"] {
        assert!(!page.contains(outside), "{outside}");
    }
    let drawings = "three measures, frames, display and motion; methods for spheres and for boxes";
    assert_eq!(page.matches("<svg ").count(), 6 + 2, "{drawings}");
    let scene = load(scene).unwrap();
    for one in of_scene(&scene, Settings::of(&scene)) {
        assert!(page.contains(one.name), "{}", one.name);
    }
    let lines = list(&report["scenes"][0]["pictures"]);
    for (name, meaning) in GROUPS.into_iter().flat_map(|(_, named)| named) {
        let shown = lines.iter().any(|line| line["configuration"] == *name);
        assert_eq!(page.contains(meaning), shown, "{name} is explained where it is shown");
    }
    for kernel in list(&report["kernels"]) {
        let meaning = MEANINGS.into_iter().find(|(name, _)| kernel["method"] == *name).unwrap().1;
        assert!(page.contains(meaning), "{kernel} is explained");
    }
    for word in ["relMSE", "trimmed", "FLIP", "FXAA", "dominated", "taken", "p99"] {
        assert!(page.contains(&format!("<td>{word}</td>")), "{word} is explained");
    }
    let commit = report["settings"]["machine"]["commit"].as_str().unwrap();
    assert!(page.contains(commit) && page.contains(r#"name="viewport""#));
}

#[test]
fn browser_shows_the_page_on_a_phone_and_prints_it() {
    if browser().is_none() {
        return skip("no browser is installed; `apt-get install chromium` gives one");
    }
    let desk = Desk::new();
    desk.run(SMALL);
    let [file, pdf] = ["new/charts/report.html", "report.pdf"].map(|name| desk.path(name));
    // The page itself runs no script; this one looks at it. Texts that touch are told apart by their ink.
    let probe = "<script>
        const figures = [...document.querySelectorAll('figure svg')].filter(svg => svg.getBoundingClientRect().width > 0);
        const narrow = Math.min(...figures.map(svg => svg.getBoundingClientRect().width));
        const covers = (a, b) => a.left + 1 < b.right && b.left + 1 < a.right && a.top + 4 < b.bottom && b.top + 4 < a.bottom;
        const faults = figures.flatMap(svg => {
            const [frame, texts] = [svg.getBoundingClientRect(), [...svg.querySelectorAll('text')]];
            const boxes = texts.map(text => text.getBoundingClientRect());
            const bad = (box, at) => box.left < frame.left - 1 || box.right > frame.right + 1 || boxes.slice(0, at).some(other => covers(box, other));
            return texts.filter((_, at) => bad(boxes[at], at)).map(text => text.textContent);
        });
        const cut = Math.max(...[...document.querySelectorAll('.wide')].map(table => table.scrollWidth - table.clientWidth));
        const text = document.createElement('p');
        text.textContent = `width ${document.documentElement.scrollWidth} of ${innerWidth}, ${figures.length} figures, narrowest ${Math.round(narrow)}, ${cut} of a table outside; texts: ${faults.join(', ')}.`;
        document.body.append(text);
    </script>";
    let page = desk.text("new/charts/report.html");
    let drawings = page.matches("<svg ").count();
    desk.write("new/charts/report.html", page.replace("</body>", &format!("{probe}</body>")));
    for width in [500, 800, 1_400] {
        let dom = dom(&file, width).unwrap();
        let (_, seen) = dom.rsplit_once("<p>width ").expect("the script has run");
        let numbers = seen.split(|c: char| !c.is_ascii_digit()).filter_map(|digits| digits.parse().ok());
        let numbers: Vec<usize> = numbers.take(5).collect();
        let [needed, given, figures, narrowest, cut] = numbers[..] else { panic!("{seen}") };
        assert!(needed <= given, "the page is wider than the window: {seen}");
        assert_eq!(figures, drawings, "{seen}");
        assert!(narrowest >= 800.min(given), "figures keep their letters readable, and scroll: {seen}");
        assert!(cut == 0 || given < 800, "tables show all columns from 800 pixels on: {seen}");
        assert!(seen.contains("texts: ."), "texts leave their drawing or cover each other: {seen}");
    }
    let printed =
        browser().unwrap().arg(format!("--print-to-pdf={}", pdf.display())).arg(&file).output().unwrap();
    assert!(printed.status.success());
    let pdf = std::fs::read(pdf).unwrap();
    assert!(pdf.starts_with(b"%PDF") && pdf.len() > 20_000, "{} bytes", pdf.len());
}
