//! The law of stability: in every recipe of `octray stability` the default method keeps its bounds, and the naive ones fail as much as is
//! said of them. Each test throws a part of what the command throws; seeds are fixed.

use octray::measure::stability::{Effort, recipes};

#[test]
fn default_methods_keep_their_bounds_in_every_recipe() {
    for recipe in recipes() {
        let outcome = recipe.run(Effort(0.05));
        let default = outcome.curves.iter().find(|curve| curve.default).expect("one is the default");
        for point in &default.points {
            assert!(point.holds(), "{}, {}: {point:?}", outcome.recipe, default.method);
        }
    }
}

#[test]
fn show() {
    for recipe in recipes() {
        let start = std::time::Instant::now();
        let outcome = recipe.run(Effort(0.25));
        println!("{} {:.2?} {}", outcome.recipe, start.elapsed(), if outcome.holds() { "" } else { "FAILS" });
        for curve in &outcome.curves {
            print!("  {:24}", curve.method);
            for p in &curve.points {
                print!(
                    " | {:.0e}: {:.4}% {:.1e}{}",
                    p.x,
                    100.0 * p.rate(),
                    p.p99.unwrap_or(f64::NAN),
                    if p.holds() { "" } else { " FAILS" }
                );
            }
            println!();
        }
    }
}
