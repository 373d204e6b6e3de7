use octray::measure::stability::{Effort, recipes};

#[test]
fn zz_print() {
    for recipe in recipes().filter(|recipe| !recipe.name.starts_with("spheres")) {
        let start = std::time::Instant::now();
        let outcome = recipe.run(Effort(0.1));
        println!("## {} ({:.2?})", recipe.name, start.elapsed());
        for curve in &outcome.curves {
            println!("   {}{}", curve.method, if curve.default { " *" } else { "" });
            for p in &curve.points {
                let q = |x: Option<f64>| x.map_or("-".into(), |x| format!("{x:.1e}"));
                println!(
                    "      {:9.2e} {:8} {:9.5}% p50 {} p99 {} max {} {:?} {}",
                    p.x,
                    p.tested,
                    p.rate() * 100.0,
                    q(p.p50),
                    q(p.p99),
                    q(p.max),
                    p.bound.and_then(|b| b.p99),
                    if p.holds() { "" } else { "BROKEN" }
                );
            }
        }
    }
}
