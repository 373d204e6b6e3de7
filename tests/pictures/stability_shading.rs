//! What shading normals cost: the naive methods let rays through, the default ones lose little. (How often
//! other methods fail: `stability`.)

use crate::stability;
use octray::measure::stability::{Effort, Point};

/// One method at one place of a test case's axis, with a tenth of the inputs.
fn at(name: &str, method: &str, x: f64) -> Point {
    stability::at(name, method, x, Effort(0.1))
}

/// The naive method fails in at least this share of inputs, the default one never.
#[track_caller]
fn fails_and_holds(name: &str, x: f64, [naive, default]: [&str; 2], least: f64) {
    let [naive, default] = [naive, default].map(|method| at(name, method, x));
    assert!(naive.rate() >= least, "{name} at {x:e}: {}", naive.rate());
    assert_eq!(default.failures, 0, "{name} at {x:e}");
}

#[test]
fn normals_for_shading_let_rays_through_or_lose_light_unless_it_is_mirrored() {
    fails_and_holds("scattering-diffuse", 20.0, ["unchecked", "faded"], 0.95);
    fails_and_holds("scattering-diffuse", 3.0, ["absorbed", "faded"], 0.95);
    fails_and_holds("scattering-glossy", 40.0, ["unchecked", "mirrored"], 0.3);
    // The factor of Chiang et al., at the median: 8 % of diffuse light, and the most of many glossy lobes.
    let lost = |name, method, x| at(name, method, x).p50.unwrap();
    let p99 = |method, x| at("scattering-glossy", method, x).p99.unwrap();
    assert!(lost("scattering-diffuse", "absorbed-and-shadowed", 20.0) > 0.06);
    assert!(lost("scattering-diffuse", "faded", 20.0).abs() < 0.005);
    for method in ["absorbed", "bent-and-shadowed"] {
        assert!(p99(method, 20.0) > 0.5, "{method}");
    }
    assert!(p99("bent", 40.0) > 0.2 && p99("mirrored", 40.0) < 0.1);
}
