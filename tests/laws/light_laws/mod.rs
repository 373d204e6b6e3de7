//! Light sampling: directions are drawn as their densities say, what arrives is what closed forms say, and
//! sampling of lights changes no expectation.

mod choice;
mod frames;
mod hits;
mod shapes;

use crate::common::*;

fn vector(v: DVec3) -> math::Vec3<f32> {
    math::Vec3::splat(v.as_vec3())
}

fn double(v: math::Vec3<f32>) -> DVec3 {
    v.get(0).as_dvec3()
}

/// Midpoints of `side` × `side` cells of the unit square.
fn square(side: u32) -> impl Iterator<Item = (f32, f32)> {
    let middle = move |i: u32| (i as f32 + 0.5) / side as f32;
    (0..side).flat_map(move |i| (0..side).map(move |j| (middle(i), middle(j))))
}

/// Lambert's formula for a polygon seen from the origin: half the sum of the edges' angles, each along the
/// normal of its plane.
pub fn polygon_irradiance(corners: &[DVec3]) -> DVec3 {
    let edge = |i: usize| {
        let (a, b) = (corners[i].normalize(), corners[(i + 1) % corners.len()].normalize());
        let normal = a.cross(b);
        normal * (normal.length().atan2(a.dot(b)) / normal.length())
    };
    (0..corners.len()).map(edge).sum::<DVec3>() * 0.5
}

fn render(scene: &Scene, lights: LightChoice, samples: u32, seed: u32) -> Picture {
    crate::common::render(scene, Settings { seed, ..with_lights(scene, lights) }, samples)
}

/// Lamps of both shapes and of all sizes over a floor that shines too: light found on the way from one of its
/// points to itself would show.
fn many_lamps(count: usize) -> Scene {
    let mut scene = Scene { name: format!("{count} lamps"), max_bounces: 3, ..floor(Vec3::ZERO, 2.0) };
    let mut rng = Rng(7);
    for _ in 0..count {
        scene.materials.push(lamp(rng.scale(0.1, 10.0) as f32));
        let number = scene.materials.len() as u32 - 1;
        let at = (rng.in_cube() + DVec3::Y * 1.2).as_vec3();
        if rng.unit() < 0.5 {
            scene.spheres.push(sphere(at, rng.scale(0.05, 0.3) as f32, number));
        } else {
            let corners = [(); 3].map(|()| at + (rng.in_cube() * 0.3).as_vec3());
            scene.triangles.push(triangle(corners, number));
        }
    }
    scene.materials[0].emission = Vec3::splat(1e-3);
    scene.camera.vertical_fov = 30.0;
    scene
}
