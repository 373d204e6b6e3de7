//! Laws: ray cones and levels of detail are those of f64. (The same bits at every width: `lane_parity`.)

use crate::common::*;
use octray::kernel::ray_cone::{Cone, footprint, level_of_detail, sphere_density};
use std::f64::consts::PI;

/// A number of any size between the powers of ten.
fn sized(rng: &mut Rng, [least, most]: [f64; 2]) -> f32 {
    10f64.powf(least + (most - least) * rng.unit()) as f32
}

#[test]
fn level_of_detail_is_half_the_binary_logarithm_of_the_texels_in_the_footprint() {
    let mut rng = Rng(7);
    let mut worst = 0.0f64;
    for _ in 0..32_000 {
        let [footprint, texels] = [[-12.0, 3.0], [0.0, 8.4]].map(|range| sized(&mut rng, range));
        let last = (rng.unit() * 14.0).floor() as f32;
        let exact = 0.5 * (f64::from(footprint) * f64::from(texels)).log2();
        let level = f64::from(level_of_detail(footprint, texels, last));
        worst = worst.max((level - exact.clamp(0.0, f64::from(last))).abs());
    }
    assert!(worst <= 1.5e-6, "{worst:e} levels");
}

#[test]
fn level_of_detail_is_0_below_a_texel_and_the_last_one_for_any_large_footprint() {
    for texels in [1.0, 512.0 * 512.0, 7.0] {
        assert_eq!(level_of_detail(1.0 / texels, texels, 9.0), 0.0, "a texel");
        assert_eq!(level_of_detail(0.99 / texels, texels, 9.0), 0.0);
        assert_eq!(level_of_detail(4.0 / texels, texels, 9.0), 1.0, "two by two");
    }
    for nothing in [0.0, f32::from_bits(1), f32::NAN, -1.0] {
        assert_eq!(level_of_detail(nothing, 1e6, 9.0), 0.0, "{nothing}");
    }
    for all in [f32::INFINITY, f32::MAX, 1.0] {
        assert_eq!(level_of_detail(all, 1e6, 9.0), 9.0, "{all}");
    }
    assert_eq!(level_of_detail(1.0, 1e6, 0.0), 0.0, "a texture without levels");
}

#[test]
fn cones_are_those_of_f64() {
    let mut rng = Rng(8);
    let near = |value: f32, exact: f64, scale: f64, what: &str| {
        assert!((f64::from(value) - exact).abs() <= 1e-6 * scale, "{what}: {value}, {exact}");
    };
    for _ in 0..8_000 {
        let cosine = sized(&mut rng, [-4.0, 0.0]) * if rng.unit() < 0.5 { -1.0 } else { 1.0 };
        let [width, angle, t, per_area] =
            [[-4.0, 1.0], [-4.0, 0.0], [-2.0, 4.0], [-6.0, 2.0]].map(|range| sized(&mut rng, range));
        let area = footprint(Cone { width, angle }.width_at(t), cosine, per_area);
        let [width, angle, t, cosine, per_area] = [width, angle, t, cosine, per_area].map(f64::from);
        let exact = (width + angle * t).powi(2) / cosine.abs().max(1e-3) * per_area;
        near(area, exact, exact, "footprint");

        let [before, curvature] = [0.3, 3.0].map(|most| (most * rng.signed()) as f32);
        let [width, cosine] = [[-4.0, 1.0], [-4.0, 0.0]].map(|range| sized(&mut rng, range));
        let lobe = rng.unit() as f32;
        let cone = Cone { width: 0.0, angle: before };
        let angle = cone.scattered(width, cosine, curvature, lobe).angle;
        let [before, width, cosine, curvature, lobe] =
            [before, width, cosine, curvature, lobe].map(f64::from);
        let bent = 2.0 * width * curvature / cosine.max(1e-3);
        near(angle, (before + bent + 0.375 * lobe).clamp(-1.0, 1.0), 1.0, "angle");

        let (n, curvature) = (rng.direction().as_vec3(), sized(&mut rng, [-3.0, 3.0]));
        let density = sphere_density(math::Vec3::<f32>::splat(n), curvature);
        let [x, z, curvature] = [n.x, n.z, curvature].map(f64::from);
        let exact = 1.0 / (2.0 * PI / curvature * x.hypot(z) * PI / curvature);
        near(density, exact, exact, "density");
    }
}
