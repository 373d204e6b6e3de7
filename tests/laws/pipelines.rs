//! The law of pipelines: one that is compiled for a few features gives the bits of the one that has them all,
//! for every single feature beside a plain scene, so that no feature hides behind another.

use crate::common::*;

/// What a scene has besides one thing of one material, one at a time.
#[derive(Clone, Copy, Debug)]
enum Extra {
    None,
    Triangles,
    Smooth,
    Shine,
    Glow,
    Picture(Filter),
    Roughness,
    Normals,
    Gradient,
    SkyPicture(Filter),
    RoundLamp,
    Lamps,
    Crowd,
}

const EXTRAS: [Extra; 17] = [
    Extra::None,
    Extra::Triangles,
    Extra::Smooth,
    Extra::Shine,
    Extra::Glow,
    Extra::Picture(Filter::Nearest),
    Extra::Picture(Filter::Bilinear),
    Extra::Picture(Filter::Trilinear),
    Extra::Roughness,
    Extra::Normals,
    Extra::Gradient,
    Extra::SkyPicture(Filter::Nearest),
    Extra::SkyPicture(Filter::Bilinear),
    Extra::SkyPicture(Filter::Trilinear),
    Extra::RoundLamp,
    Extra::Lamps,
    Extra::Crowd,
];

fn with(kind: MaterialKind, extra: Extra) -> Scene {
    let mut rng = Rng(91);
    let floor = ground(9.0, -1.0);
    let mut scene = Scene {
        camera: Camera { position: vec3(0.3, 0.4, 4.0), ..empty().camera },
        materials: vec![Material { color: vec3(0.9, 0.8, 0.7), ..material(kind) }],
        spheres: vec![sphere(Vec3::ZERO, 0.9, 0), sphere(vec3(1.2, 0.3, 0.4), 0.5, 0)],
        sky: Sky::Color(vec3(0.5, 0.6, 0.7)),
        ..empty()
    };
    let lamp = emitter(vec3(5.0, 4.0, 3.0));
    match extra {
        Extra::None => {}
        Extra::Triangles => scene.triangles.push(triangle(floor, 0)),
        Extra::Smooth => scene = Scene { sky: scene.sky, ..smooth_ball(kind) },
        Extra::Shine => scene.materials[0].emission = vec3(0.1, 0.2, 0.3),
        Extra::Glow => {
            scene.textures = vec![noise(&mut rng, 5, 7, Filter::Bilinear)];
            scene.materials[0].emission = Vec3::ONE;
            scene.materials[0].emission_map = (kind != Emitter).then_some(0);
        }
        Extra::Picture(filter) => {
            scene.textures = vec![noise(&mut rng, 5, 7, filter)];
            scene.materials[0].texture = Some(0);
        }
        Extra::Roughness => {
            scene.textures = vec![noise(&mut rng, 5, 7, Filter::Nearest)];
            scene.materials[0].roughness_map = kind.has_roughness().then_some(0);
        }
        Extra::Normals => {
            scene.triangles.push(triangle(floor, 0));
            scene.uvs.push([Vec2::ZERO, Vec2::X, Vec2::Y]);
            scene.textures = vec![noise(&mut rng, 5, 7, Filter::Nearest)];
            scene.materials[0].normal_map = Some(0);
        }
        Extra::Gradient => scene.sky = Sky::Gradient { bottom: Vec3::ONE, top: vec3(0.5, 0.7, 1.0) },
        Extra::SkyPicture(filter) => {
            scene.textures = vec![noise(&mut rng, 5, 7, filter)];
            scene.sky = Sky::Texture { texture: 0, color: Vec3::ONE, turn: 0.3 };
        }
        Extra::RoundLamp => {
            scene.materials.push(lamp);
            scene.spheres.push(sphere(vec3(-1.0, 1.5, 0.5), 0.2, 1));
        }
        Extra::Lamps => {
            scene.materials.push(lamp);
            scene.triangles.push(triangle(floor, 0));
            for number in 0..6 {
                let at = vec3(0.5 * number as f32 - 1.5, 1.5, 0.5);
                scene.triangles.push(triangle([at, at + 0.3 * Vec3::X, at + 0.3 * Vec3::Z], 1));
            }
        }
        Extra::Crowd => {
            for _ in 0..60 {
                scene.spheres.push(sphere((rng.in_cube() * 2.0).as_vec3(), 0.2, 0));
            }
        }
    }
    scene
}

#[test]
fn every_feature_alone_gives_the_bits_of_all_features_together() {
    let lights = [LightChoice::On, LightChoice::Off];
    for kind in KINDS.into_iter().chain([Emitter]) {
        for (extra, lights) in EXTRAS.into_iter().flat_map(|extra| lights.map(|lights| (extra, lights))) {
            let scene = with(kind, extra);
            let methods = Methods { lights, ..Methods::default() };
            let needed = Settings { methods, resolution: [24, 16], max_bounces: 3, ..Settings::of(&scene) };
            let general = Settings { pipeline: PipelineChoice::General, ..needed };
            let [needed, general] = [needed, general].map(|settings| render(&scene, settings, 2));
            assert!(needed == general, "{kind:?}, {extra:?}, {lights:?}");
        }
    }
}
