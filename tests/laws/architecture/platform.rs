//! The law of the same bits everywhere: what builds or renders a scene calls no elementary function of the
//! platform, whose last bits depend on the machine and on the compiler.

use super::sources::{Source, sources};

/// Methods of the standard library's numbers that are the platform's. `powi` is in the compiler's hands too;
/// squares alone have one order of products.
const PLATFORM: &str = "sin cos tan asin acos atan atan2 sin_cos sinh cosh tanh exp exp2 exp_m1 ln ln_1p \
                        log log2 log10 powf powi cbrt hypot";

/// What comes after the film (a display, a file), and estimates of noise: the promise ends there.
const BEYOND: [&str; 5] = [
    "src/engine/tone.rs",
    "src/engine/diagnosis.rs",
    "src/engine/display",
    "src/formats/output",
    "src/engine/film/noise.rs",
];

fn calls(source: &Source) -> Vec<&'static str> {
    // Tests stand at the end of a file.
    let code = source.code.split("#[cfg(test)]").next().unwrap().replace(".powi(2)", "");
    PLATFORM.split_whitespace().filter(|name| code.contains(&format!(".{name}("))).collect()
}

#[test]
fn scenes_and_films_use_no_function_of_the_platform() {
    let inside = |source: &&Source| {
        let rendered = source.path.starts_with("src/engine") || source.path.starts_with("src/formats");
        rendered && !BEYOND.iter().any(|beyond| source.path.starts_with(beyond))
    };
    let all = sources();
    let faults: Vec<String> = all
        .iter()
        .filter(inside)
        .map(|source| (source.path.display(), calls(source)))
        .filter(|(_, calls)| !calls.is_empty())
        .map(|(path, calls)| format!("{path}: {}", calls.join(", ")))
        .collect();
    assert!(faults.is_empty(), "use math::portable, or lane::functions:\n{}", faults.join("\n"));
}
