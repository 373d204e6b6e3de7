//! The page of `octray chart` in a real browser: it needs no other file, fits a phone, and prints.
//!
//! Skipped, saying so, where no browser is installed (Chromium or Chrome; `OCTRAY_BROWSER` names another of
//! their family).

use octray::measure::chart::configurations::{GROUPS, of_scene};
use octray::measure::chart::{Plan, kernels};
use octray::measure::stability::methods::MEANINGS;
use octray::report::chart::{Chart, SCHEMA};
use octray::report::page::page;
use octray::report::settings::RunSettings;
use octray::traverse::Methods;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

const BROWSERS: [&str; 5] =
    ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome-headless-shell"];

/// A small chart of one scene, whatever its figures are worth.
fn chart() -> Chart {
    let scene = octray::scene::load("builtin:three").unwrap();
    let plan = Plan {
        size: [16, 9],
        max_bounces: 2,
        seeds: 8,
        threads: 1,
        start: Instant::now(),
        time: Duration::from_millis(500),
        budget: Duration::from_millis(500),
    };
    let truth = plan.ground_truth(&scene);
    let scenes = vec![plan.chart(&scene, &truth, &|_| ())];
    Chart {
        schema: SCHEMA,
        settings: RunSettings { bounces: Some(2), ..RunSettings::of(Methods::default()) },
        budget_s: 0.5,
        seconds: 0.5,
        seeds: 8,
        kernels: kernels::measure(Instant::now()),
        scenes,
    }
}

/// A browser without a window; `None` where there is none.
fn browser() -> Option<Command> {
    let named = std::env::var("OCTRAY_BROWSER").ok();
    let names = named.iter().map(String::as_str).chain(BROWSERS);
    let works = |name: &&str| {
        Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success())
    };
    let mut browser = Command::new(names.into_iter().find(works)?);
    browser.args([
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--disable-dev-shm-usage",
        "--hide-scrollbars",
    ]);
    Some(browser)
}

/// What the browser makes of a page, after its scripts have run.
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

#[test]
fn page_stands_alone_and_holds_all_figures_and_configurations() {
    let chart = chart();
    let page = page(&chart);
    for outside in ["src=", "href=", "url(", "<script", "@import", "<link"] {
        assert!(!page.contains(outside), "{outside}");
    }
    assert_eq!(
        page.matches("<svg ").count(),
        6 + 3,
        "three measures, frames, display and motion; three families of methods"
    );
    let scene = octray::scene::load("builtin:three").unwrap();
    for one in of_scene(&scene, octray::render::Settings::of(&scene)) {
        assert!(page.contains(one.name), "{}", one.name);
    }
    let shown = |name| chart.scenes[0].pictures.iter().any(|line| line.configuration == name);
    for (name, meaning) in GROUPS.into_iter().flat_map(|(_, named)| named) {
        assert_eq!(page.contains(meaning), shown(*name), "{name} is explained where it is shown");
    }
    for kernel in &chart.kernels {
        let meaning = MEANINGS.into_iter().find(|(name, _)| *name == kernel.method).unwrap().1;
        assert!(page.contains(meaning), "{} is explained", kernel.method);
    }
    for word in ["relMSE", "trimmed", "FLIP", "FXAA", "dominated", "p99"] {
        assert!(page.contains(&format!("<td>{word}</td>")), "{word} is explained");
    }
    assert!(page.contains(&chart.settings.machine.commit) && page.contains("name=\"viewport\""));
}

#[test]
fn browser_shows_the_page_on_a_phone_and_prints_it() {
    if browser().is_none() {
        println!("skipped: no browser is installed; `apt-get install chromium` gives one");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let (file, pdf) = (folder.path().join("report.html"), folder.path().join("report.pdf"));
    // The page itself runs no script; this one looks at it.
    let probe = "<script>
        const figures = [...document.querySelectorAll('figure svg')].filter(svg => svg.getBoundingClientRect().width > 0);
        const narrow = Math.min(...figures.map(svg => svg.getBoundingClientRect().width));
        const text = document.createElement('p');
        text.textContent = `width ${document.documentElement.scrollWidth} of ${innerWidth}, ${figures.length} figures, narrowest ${Math.round(narrow)}`;
        document.body.append(text);
    </script>";
    std::fs::write(&file, page(&chart()).replace("</body>", &format!("{probe}</body>"))).unwrap();
    for width in [500, 1_400] {
        let dom = dom(&file, width).unwrap();
        let (_, seen) = dom.rsplit_once("<p>width ").expect("the script has run");
        let numbers: Vec<u32> = seen
            .split(|c: char| !c.is_ascii_digit())
            .filter_map(|digits| digits.parse().ok())
            .take(4)
            .collect();
        let [needed, given, figures, narrowest] = numbers[..] else { panic!("{seen}") };
        println!("{needed} of {given} pixels, {figures} figures, the narrowest {narrowest}");
        assert!(needed <= given, "the page is wider than the window");
        assert!(
            figures >= 9 && narrowest >= 800.min(given),
            "figures keep their letters readable, and scroll"
        );
    }
    let printed =
        browser().unwrap().arg(format!("--print-to-pdf={}", pdf.display())).arg(&file).output().unwrap();
    assert!(printed.status.success());
    let pdf = std::fs::read(pdf).unwrap();
    assert!(pdf.starts_with(b"%PDF") && pdf.len() > 20_000, "{} bytes", pdf.len());
}
