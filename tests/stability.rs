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
