//! Laws: texture lookups stay inside their texture, and decoding keeps its documented error.

use octray::kernel::surface::latitude_longitude;
use octray::kernel::texture::{Grid, TexturePoint, WRAP_CODES, srgb_to_linear};
use octray::math::Vec3;
use octray::sampling::random::mix_bits;
use std::f64::consts::{PI, TAU};

#[test]
fn srgb_to_linear_is_within_its_bound_of_the_standard_for_every_byte() {
    let mut worst = 0.0f64;
    for byte in 0..=255u32 {
        let x = f64::from(byte) / 255.0;
        let truth = if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) };
        for shift in [0, 8, 16] {
            let color = srgb_to_linear::<f32>(byte << shift | 0xff00_0000);
            let channels = [color.x, color.y, color.z];
            for (channel, &value) in channels.iter().enumerate() {
                if channel as u32 * 8 == shift {
                    worst = worst.max((f64::from(value) - truth).abs() / truth.max(1e-9));
                } else {
                    assert_eq!(value, 0.0, "byte {byte} at {shift} reaches channel {channel}");
                }
            }
        }
    }
    assert!(worst <= 1.3e-5, "relative error {worst:e}");
}

#[test]
fn nearest_is_the_texel_that_holds_the_point_and_stays_inside_for_any_input() {
    let grid = Grid::<f32> { width: 7.0, height: 5.0, first: 100 };
    assert_eq!(grid.nearest(0.0, 0.0, false), 100);
    assert_eq!(grid.nearest(0.999_999, 0.999_999, true), 134);
    assert_eq!(grid.nearest(-0.01, 0.5, false), 100 + 2 * 7 + 6);
    assert_eq!(grid.nearest(1.5 / 7.0, 3.5 / 5.0, false), 100 + 3 * 7 + 1);
    assert_eq!(grid.nearest(0.0, 1.0, true), 100 + 4 * 7, "v = 1 is the last row where rows do not wrap");
    assert_eq!(grid.nearest(0.0, 1.0, false), 100, "v = 1 is the first row where they do");
    for i in 0..100_000 {
        let [u, v] = [mix_bits(2 * i), mix_bits(2 * i + 1)].map(f32::from_bits);
        // Coordinates of any size, infinities and NaN among them.
        for clamp in [false, true] {
            let texel = grid.nearest(u, v, clamp);
            assert!((100..135).contains(&texel), "({u}, {v}) reads {texel}");
            let (texels, ..) = grid.bilinear(u, v, clamp);
            assert!(texels.iter().all(|texel| (100..135).contains(texel)), "({u}, {v}) reads {texels:?}");
        }
    }
}

#[test]
fn bilinear_blends_the_four_texels_around_and_wraps_where_it_should() {
    let grid = Grid::<f32> { width: 4.0, height: 3.0, first: 0 };
    let (texels, right, lower) = grid.bilinear(0.5, 0.5, false);
    assert_eq!((texels, right, lower), ([5, 6, 9, 10], 0.5, 0.0));
    let (texels, ..) = grid.bilinear(0.0, 0.0, false);
    assert_eq!(texels, [11, 8, 3, 0], "columns and rows wrap");
    let (texels, ..) = grid.bilinear(0.0, 0.0, true);
    assert_eq!(texels, [3, 0, 3, 0], "rows stop at the edge");
    let (texels, ..) = grid.bilinear(0.99, 1.0, true);
    assert_eq!(texels, [11, 8, 11, 8]);
}

#[test]
fn latitude_longitude_is_within_its_bound_of_f64_also_at_poles_and_seams() {
    let check = |n: glam::DVec3| {
        let n = n.as_vec3();
        let (u, v) = latitude_longitude(Vec3::<f32>::splat(n));
        let n = n.as_dvec3();
        let truth = [n.z.atan2(n.x) / TAU, n.x.hypot(n.z).atan2(n.y) / PI];
        // At the seam ½ and −½ are the same column.
        let du = (f64::from(u) - truth[0]).abs();
        // At the pole itself every column is.
        let at_pole = n.x == 0.0 && n.z == 0.0;
        assert!(at_pole || du.min((du - 1.0).abs()) <= 3e-7, "u of {n}: {u}, {}", truth[0]);
        assert!((f64::from(v) - truth[1]).abs() <= 3e-7, "v of {n}: {v}, {}", truth[1]);
        assert!((-0.5..=0.5).contains(&u) && (0.0..=1.0).contains(&v), "({u}, {v})");
    };
    for i in 0..200_000 {
        let number = |j: u32| f64::from(mix_bits(4 * i + j) >> 8) / f64::from(1 << 24);
        let (z, phi) = (2.0 * number(0) - 1.0, TAU * number(1));
        let radius = (1.0 - z * z).sqrt();
        check(glam::DVec3::new(radius * phi.cos(), z, radius * phi.sin()));
        // Within 10⁻³ of a pole, where (P − C)/r has |y| > 1 in a third of the hits.
        let near = 1e-3 * number(2);
        check(glam::DVec3::new(near * phi.cos(), (1.0 + 1e-7f64).copysign(z), near * phi.sin()));
    }
    for (x, y, z) in [
        (0.0, 1.0, 0.0),
        (0.0, -1.0, 0.0),
        (1.0, 0.0, 0.0),
        (-1.0, 0.0, 0.0),
        (-1.0, 0.0, -0.0),
        (0.0, 0.0, 1.0),
    ] {
        check(glam::DVec3::new(x, y, z));
    }
}

/// A ramp of the columns' numbers shows where a lookup is: between neighbours, never across an edge.
#[test]
fn clamped_and_mirrored_lookups_never_blend_across_an_edge() {
    for width in [1u32, 2, 3, 7, 1000, 16_384] {
        let size = f64::from(width);
        let grid = Grid::<f32> { width: width as f32, height: 1.0, first: 0 };
        let edges = (-4..5).flat_map(|edge| [-1e-6, -1e-7, 0.0, 1e-7, 1e-6].map(|by| edge as f32 + by));
        let others = (0..2000).map(|i| (mix_bits(i) as f32 / 4e8) - 5.0);
        for (u, wrap) in edges.chain(others).flat_map(|u| [(u, 1), (u, 2)]) {
            let x = f64::from(u);
            let folded = if wrap == 1 { x.clamp(0.0, 1.0) } else { 1.0 - (1.0 - x.rem_euclid(2.0)).abs() };
            for smooth in [false, true] {
                let at = TexturePoint { u, v: 0.5, clamp_v: false, footprint: 0.0 };
                let at = at.wrapped(&grid, [WRAP_CODES[wrap], 0.0], smooth);
                assert_eq!(at.v, 0.5);
                if !smooth {
                    let wanted = (folded * size).floor().min(size - 1.0);
                    let off = (f64::from(grid.nearest(at.u, at.v, false)) - wanted).abs();
                    assert!(
                        off <= if (folded * size).fract() < 0.01 || width > 1000 { 1.0 } else { 0.0 },
                        "{u}"
                    );
                    continue;
                }
                let ([left, right, ..], weight, _) = grid.bilinear(at.u, at.v, false);
                assert!(right == left + 1 || width == 1, "{u} of {width} reads {left} and {right}");
                let found = f64::from(left) + f64::from(weight) * f64::from(right - left);
                let wanted = (folded * size - 0.5).clamp(0.0, size - 1.0);
                assert!(
                    (found - wanted).abs() <= size / 1_048_576.0,
                    "{u} of {width}: {found}, not {wanted}"
                );
            }
        }
    }
}
