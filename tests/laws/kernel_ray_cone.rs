//! Laws: ray cones and levels of detail are those of f64, and the same bits at every width.

use crate::common::*;
use octray::kernel::ray_cone::{Cone, footprint, level_of_detail, sphere_density};
use octray::math::Vec3;
use std::f64::consts::PI;

/// A number of any size between the powers of ten.
fn sized(rng: &mut Rng, [least, most]: [f64; 2]) -> f32 {
    10f64.powf(least + (most - least) * rng.unit()) as f32
}

/// Of 16 inputs: the same function at every width.
#[track_caller]
fn at_every_width<const N: usize>(
    inputs: &[[f32; N]; 16],
    one: impl Fn([f32; N]) -> f32,
    eight: impl Fn([F32x8; N]) -> F32x8,
    sixteen: impl Fn([F32x16; N]) -> F32x16,
) -> [f32; 16] {
    let all = sixteen(std::array::from_fn(|i| F32x16::from_fn(|lane| inputs[lane][i])));
    std::array::from_fn(|at| {
        let half = eight(std::array::from_fn(|i| F32x8::from_fn(|lane| inputs[at / 8 * 8 + lane][i])));
        let alone = one(inputs[at]);
        for (wide, lanes) in [(half.get(at % 8), 8), (all.get(at), 16)] {
            assert_eq!(wide.to_bits(), alone.to_bits(), "{lanes} lanes, {:?}: {wide}, {alone}", inputs[at]);
        }
        alone
    })
}

fn level<L: Lane>([footprint, texels, last]: [L; 3]) -> L {
    level_of_detail(footprint, texels, last)
}

#[test]
fn level_of_detail_is_half_the_binary_logarithm_of_the_texels_in_the_footprint() {
    let mut rng = Rng(7);
    let mut worst = 0.0f64;
    for _ in 0..2_000 {
        let inputs: [[f32; 3]; 16] = std::array::from_fn(|_| {
            [sized(&mut rng, [-12.0, 3.0]), sized(&mut rng, [0.0, 8.4]), (rng.unit() * 14.0).floor() as f32]
        });
        let levels = at_every_width(&inputs, level, level, level);
        for ([footprint, texels, last], level) in inputs.into_iter().zip(levels) {
            let exact = 0.5 * (f64::from(footprint) * f64::from(texels)).log2();
            worst = worst.max((f64::from(level) - exact.clamp(0.0, f64::from(last))).abs());
        }
    }
    assert!(worst <= 1.5e-6, "{worst:e} levels");
}

#[test]
fn level_of_detail_is_0_below_a_texel_and_the_last_one_for_any_large_footprint() {
    for texels in [1.0, 512.0 * 512.0, 7.0] {
        assert_eq!(level([1.0 / texels, texels, 9.0]), 0.0, "a texel");
        assert_eq!(level([0.99 / texels, texels, 9.0]), 0.0);
        assert_eq!(level([4.0 / texels, texels, 9.0]), 1.0, "two by two");
    }
    for nothing in [0.0, f32::from_bits(1), f32::NAN, -1.0] {
        assert_eq!(level([nothing, 1e6, 9.0]), 0.0, "{nothing}");
    }
    for all in [f32::INFINITY, f32::MAX, 1.0] {
        assert_eq!(level([all, 1e6, 9.0]), 9.0, "{all}");
    }
    assert_eq!(level([1.0, 1e6, 0.0]), 0.0, "a texture without levels");
}

fn area<L: Lane>([width, spread, t, cosine, density]: [L; 5]) -> L {
    footprint(Cone { width, spread }.width_at(t), cosine, density)
}

fn density<L: Lane>([x, y, z, curvature]: [L; 4]) -> L {
    sphere_density(Vec3::new(x, y, z), curvature)
}

fn spread<L: Lane>([spread, width, cosine, curvature, lobe]: [L; 5]) -> L {
    Cone { width: L::zero(), spread }.scattered(width, cosine, curvature, lobe).spread
}

#[test]
fn cones_are_those_of_f64() {
    let mut rng = Rng(8);
    let near = |value: f32, exact: f64, scale: f64, what: &str| {
        assert!((f64::from(value) - exact).abs() <= 1e-6 * scale, "{what}: {value}, {exact}");
    };
    for _ in 0..500 {
        let inputs: [[f32; 5]; 16] = std::array::from_fn(|_| {
            let cosine = sized(&mut rng, [-4.0, 0.0]) * if rng.unit() < 0.5 { -1.0 } else { 1.0 };
            let (width, spread) = (sized(&mut rng, [-4.0, 1.0]), sized(&mut rng, [-4.0, 0.0]));
            [width, spread, sized(&mut rng, [-2.0, 4.0]), cosine, sized(&mut rng, [-6.0, 2.0])]
        });
        for (input, area) in inputs.into_iter().zip(at_every_width(&inputs, area, area, area)) {
            let [width, spread, t, cosine, density] = input.map(f64::from);
            let exact = (width + spread * t).powi(2) / cosine.abs().max(1e-3) * density;
            near(area, exact, exact, "footprint");
        }
        let inputs: [[f32; 5]; 16] = std::array::from_fn(|_| {
            let signed = [rng.signed(), rng.signed()].map(|x| x as f32);
            let width = sized(&mut rng, [-4.0, 1.0]);
            [0.3 * signed[0], width, sized(&mut rng, [-4.0, 0.0]), 3.0 * signed[1], rng.unit() as f32]
        });
        for (input, spread) in inputs.into_iter().zip(at_every_width(&inputs, spread, spread, spread)) {
            let [before, width, cosine, curvature, lobe] = input.map(f64::from);
            let bent = 2.0 * width * curvature / cosine.max(1e-3);
            near(spread, (before + bent + 0.375 * lobe).clamp(-1.0, 1.0), 1.0, "spread");
        }
        let inputs: [[f32; 4]; 16] = std::array::from_fn(|_| {
            let n = rng.in_cube().normalize().as_vec3();
            [n.x, n.y, n.z, sized(&mut rng, [-3.0, 3.0])]
        });
        for (input, density) in inputs.into_iter().zip(at_every_width(&inputs, density, density, density)) {
            let [x, _, z, curvature] = input.map(f64::from);
            let exact = 1.0 / (2.0 * PI / curvature * x.hypot(z) * PI / curvature);
            near(density, exact, exact, "density");
        }
    }
}
