//! The pdf that a hit of a light has is that with which light sampling draws the same direction: the two
//! strategies are weighed by it.

use super::many_lamps;
use crate::common::*;
use octray::buffers::{Buffers, Features};
use octray::camera::PreparedCamera;
use octray::integrate::TraceContext;
use octray::integrate::queue::Path;
use octray::kernel::ray_cone::Cone;
use octray::primitives::PrimitiveTables;
use octray::rays::{Hits, Rays, Structure, Tracer};

const ALL: u64 = Features::ALL.0;

fn context(scene: &Scene) -> TraceContext {
    let lights = Lights::new(scene, LightChoice::On);
    TraceContext {
        buffers: Buffers::new(scene),
        primitives: PrimitiveTables::new(scene, |number| lights.sampled_as(number)),
        structure: Structure::new(&scene.geometry()),
        camera: PreparedCamera::new(&scene.camera, [1, 1]),
        visible: Vec::new(),
        width: 1,
        max_bounces: 1,
        seed: 1,
        sampler: octray::sampling::Sampler::default(),
        lights,
    }
}

/// A lamp of two triangles, the corner opposite their common edge at these places of their vertices.
fn quad(corners: [usize; 2]) -> Scene {
    let mut scene = many_lamps(0);
    scene.materials.push(lamp(3.0));
    let [a, b, c, d] =
        [[-1.0, 2.0, -0.5], [0.5, 2.2, -0.5], [-1.0, 1.8, 0.7], [0.5, 2.0, 0.7]].map(Vec3::from);
    for (mut vertices, corner) in [[a, b, c], [d, c, b]].into_iter().zip(corners) {
        vertices.rotate_right(corner);
        scene.triangles.push(triangle(vertices, 1));
    }
    scene
}

/// Triangles with a texture that is bright in one texel, and other lamps.
fn pieces(count: usize, others: usize) -> Scene {
    let mut scene = many_lamps(others);
    let mut texels = vec![[0.02, 0.02, 0.02, 1.0]; 64];
    texels[50] = [8.0, 8.0, 8.0, 1.0];
    scene.textures.push(texture([8, 8], Filter::Nearest, Texels::Float32(texels)));
    scene.materials.push(Material { texture: Some(0), ..lamp(2.0) });
    let material = scene.materials.len() as u32 - 1;
    scene.uvs = vec![[Vec2::ZERO; 3]; scene.triangles.len()];
    for at in 0..count {
        let place = Vec3::new(-1.5 + at as f32, 2.5, 0.5);
        scene.triangles.push(triangle([place, place + Vec3::X, place + Vec3::Z], material));
        scene.uvs.push([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(Vec2::from));
    }
    scene
}

#[test]
fn hits_of_lights_have_the_pdf_of_sampling_them() {
    let mut rng = Rng(91);
    let quads = (0..3).flat_map(|one| (0..3).map(move |other| quad([one, other])));
    let others = [many_lamps(3), many_lamps(30), pieces(1, 0), pieces(3, 5)];
    for (number, scene) in quads.chain(others).enumerate() {
        let context = context(&scene);
        match number {
            0..9 => assert_eq!(context.lights.len(), 2, "the floor and a parallelogram"),
            11.. => assert!(context.lights.len() > 100, "pieces: {}", context.lights.len()),
            _ => {}
        }
        let mut checked = 0;
        for _ in 0..2000 {
            let origin = math::Vec3::splat((rng.in_cube() * 2.0 + DVec3::Y).as_vec3());
            let [u, first, second, along, across] = [(); 5].map(|()| rng.unit() as f32);
            let (light, _) = context.lights.choose_by_power::<f32>(u, || first, || second, false);
            let sample = context.lights.sample::<f32, ALL>(&light, origin, (along, across), true);
            let ray = Ray { origin, direction: sample.wi };
            let columns = |v: math::Vec3<f32>| v.get(0).to_array().map(|x| [x]);
            let [from, direction] = [columns(origin), columns(sample.wi)];
            let rays = Rays::new(from.each_ref().map(|x| &x[..]), direction.each_ref().map(|x| &x[..]));
            let [mut t, mut v] = [[f32::INFINITY]; 2];
            let (mut primitive, mut u) = ([MISS], [0.0]);
            let mut hits = Hits { t: &mut t, primitive: &mut primitive, u: &mut u, v: &mut v };
            Tracer::new().closest_one_by_one(&context.structure, &rays, &mut hits);
            let hit = hits.get(0);
            let is_light = match context.lights.needs_hits() {
                true => context.lights.is_primitive_of_light::<f32>(hit.primitive, light.index),
                false => (hit.t - sample.t).abs() < 1e-4 * sample.t,
            };
            // At grazing angles and at the rims of balls, rounding decides.
            let cosine = sample.n.dot(sample.wi).abs();
            if hit.primitive == MISS || !is_light || sample.pdf == 0.0 || cosine < 0.05 {
                continue;
            }
            let path = Path::primary(ray, 0, 0, Cone::none());
            let found = context.surface::<f32, ALL>(&path, &hit, true).light_pdf;
            let expected = light.probability * sample.pdf;
            assert!((found / expected - 1.0).abs() < 0.01, "scene {number}: {found}, sampled {expected}");
            checked += 1;
        }
        assert!(checked > 300, "scene {number}: {checked}");
    }
}
