//! How pictures lie on the sky, on spheres and on triangles, seen through whole paths.

use super::scenes::{empty, numbered, one_pixel, wall};
use crate::common::*;

/// What the scene shows to an eye at `position` that looks at `look_at`.
fn seen(scene: Scene, position: Vec3, look_at: Vec3) -> [f64; 3] {
    let forward = (look_at - position).normalize();
    let up = if forward.y.abs() > 0.9 { Vec3::X } else { Vec3::Y };
    let camera = Camera::pinhole(position, look_at, up, 1e-6);
    Reference::new(&Scene { camera, ..scene }).path(one_pixel(0), 0, 0, 0)
}

fn sky(filter: Filter, direction: Vec3) -> [f64; 3] {
    let scene = Scene {
        sky: Sky::Texture { texture: 0, color: vec3(1.0, 1.0, 0.5), turn: 0.0 },
        textures: vec![numbered(8, 4, filter)],
        ..empty()
    };
    seen(scene, Vec3::ZERO, direction)
}

fn textured_ball(filter: Filter, texture_turn: f32, texture_side: Side) -> Scene {
    Scene {
        materials: vec![Material { texture: Some(0), ..lamp(1.0) }],
        textures: vec![numbered(8, 4, filter)],
        spheres: vec![Sphere { texture_turn, texture_side, ..sphere(Vec3::ZERO, 1.0, 0) }],
        ..empty()
    }
}

/// A ball seen from outside.
fn globe(filter: Filter, turn: f32, side: Side, from: Vec3) -> [f64; 3] {
    seen(textured_ball(filter, turn, side), from * 5.0, Vec3::ZERO)
}

#[track_caller]
fn assert_near(found: [f64; 3], expected: [f64; 3]) {
    let near = (0..3).all(|i| (found[i] - expected[i]).abs() < 1e-6);
    assert!(near, "found {found:?}, expected {expected:?}");
}

/// Horizontal direction at u turns from +x towards +z.
fn at(u: f32) -> Vec3 {
    let angle = u * std::f32::consts::TAU;
    vec3(angle.cos(), 0.0, angle.sin())
}

#[test]
fn nearest_shows_the_texel_under_the_point_at_seams_and_poles() {
    for show in [|d| sky(Filter::Nearest, d), |d| globe(Filter::Nearest, 0.0, Side::Inside, d)] {
        let up = Vec3::Y * 0.01;
        assert_eq!(show(at(0.001) + up)[..2], [0.0, 1.0], "just after the seam, above the horizon");
        assert_eq!(show(at(-0.001) - up)[..2], [7.0, 2.0], "just before the seam, below the horizon");
        assert_eq!(show(at(0.251) + up)[..2], [2.0, 1.0], "+z is a quarter turn");
        assert_eq!(show(Vec3::Y)[1], 0.0, "upper pole");
        assert_eq!(show(-Vec3::Y)[1], 3.0, "lower pole");
    }
    assert_eq!(sky(Filter::Nearest, Vec3::Y)[2], 0.5, "the sky's colour");
}

#[test]
fn bilinear_wraps_columns_and_stops_at_the_poles() {
    for show in [|d| sky(Filter::Bilinear, d), |d| globe(Filter::Bilinear, 0.0, Side::Inside, d)] {
        let blue = show(Vec3::X)[2];
        assert_near(show(at(2.5 / 8.0)), [2.0, 1.5, blue]);
        assert_near(show(at(0.0)), [3.5, 1.5, blue]);
        assert_near(show(at(7.75 / 8.0)), [7.0 * 0.75, 1.5, blue]);
        let steep = vec3(1e-4, 1.0, 1e-4);
        assert_near([0.0, show(steep)[1], 0.0], [0.0; 3]);
        assert_near([0.0, show(-steep)[1], 0.0], [0.0, 3.0, 0.0]);
        assert!(show(Vec3::Y).iter().chain(&show(-Vec3::Y)).all(|channel| channel.is_finite()));
    }
}

#[test]
fn turn_moves_the_picture_around_the_axis() {
    let column = |turn, side, u| globe(Filter::Nearest, turn, side, at(u) + Vec3::Y * 0.01)[0];
    assert_eq!([0.01, 0.51].map(|u| column(0.5, Side::Inside, u)), [4.0, 0.0]);
    // Both kinds turn anticlockwise seen from above: what was at u is at u - 1/4.
    for u in [0.05, 0.3, 0.6, 0.95] {
        for side in [Side::Inside, Side::Outside] {
            assert_eq!(column(0.25, side, u - 0.25), column(0.0, side, u), "{side:?}, {u}");
        }
    }
}

#[test]
fn pictures_from_outside_are_those_from_inside_mirrored() {
    for u in [0.01, 0.3, 0.49, 0.51, 0.99] {
        let [outside, inside] = [Side::Outside, Side::Inside]
            .map(|side| globe(Filter::Nearest, 0.0, side, at(u) + Vec3::Y * 0.01));
        assert_eq!((outside[0], outside[1]), (7.0 - inside[0], inside[1]), "{u}");
    }
}

#[test]
fn a_texture_stays_put_when_seen_from_inside() {
    let ball = textured_ball(Filter::Nearest, 0.0, Side::Inside);
    assert_eq!(seen(ball, Vec3::ZERO, at(0.3) + Vec3::Y * 0.01)[..2], [2.0, 1.0]);
}

/// uv = (x, y) / 9 over the wall, the picture's upper edge at v = 1, repeated in both directions.
#[test]
fn triangles_wrap_both_ways_and_count_rows_from_the_top() {
    let show = |filter, x: f32, y: f32| {
        let mut scene = wall(Emitter);
        scene.materials[0] = Material { texture: Some(0), ..lamp(1.0) };
        scene.textures = vec![numbered(4, 4, filter)];
        scene.uvs = vec![scene.triangles[0].vertices.map(|p| vec2(p.x, p.y) / 9.0)];
        let point = vec3(x, y, 0.0) * 9.0;
        seen(scene, point + Vec3::Z, point)
    };
    assert_eq!(show(Filter::Nearest, 0.3, 0.9), [1.0, 0.0, 1.0]);
    assert_eq!(show(Filter::Nearest, 0.1, 0.1), [0.0, 3.0, 1.0]);
    assert_eq!(show(Filter::Nearest, -0.1, -0.1), [3.0, 0.0, 1.0]);
    assert_eq!(show(Filter::Nearest, 0.1, 1.1), [0.0, 3.0, 1.0]);
    assert_near(show(Filter::Bilinear, 0.375, 0.625), [1.0, 1.0, 1.0]);
    assert_near(show(Filter::Bilinear, 0.25, 0.5), [0.5, 1.5, 1.0]);
    assert_near(show(Filter::Bilinear, 0.125, 1.0), [0.0, 1.5, 1.0]);
}
