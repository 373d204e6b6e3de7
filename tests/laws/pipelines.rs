//! The law of pipelines: one that is compiled for a few features gives the bits of the one that has them all,
//! for every single feature beside a plain scene, so that no feature hides behind another.

use crate::common::*;

/// A feature that a plain scene of one material gets: its name, and how.
type Extra = (&'static str, fn(&mut Scene));

const EXTRAS: [Extra; 20] = [
    ("nothing", |_| ()),
    ("triangles", add_floor),
    ("smooth normals", |scene| *scene = Scene { sky: scene.sky, ..smooth_ball(scene.materials[0].kind) }),
    ("emission", |scene| scene.materials[0].emission = vec3(0.1, 0.2, 0.3)),
    ("emission map", |scene| {
        let map = add_texture(scene, Filter::Bilinear);
        scene.materials[0].emission = Vec3::ONE;
        scene.materials[0].emission_map = (scene.materials[0].kind != Emitter).then_some(map);
    }),
    ("nearest texture", |scene| scene.materials[0].texture = Some(add_texture(scene, Filter::Nearest))),
    ("bilinear texture", |scene| scene.materials[0].texture = Some(add_texture(scene, Filter::Bilinear))),
    ("trilinear texture", |scene| scene.materials[0].texture = Some(add_texture(scene, Filter::Trilinear))),
    ("clamped texture", |scene| {
        let map = add_texture(scene, Filter::Nearest);
        scene.textures[map as usize].wrap = [Wrap::Clamp, Wrap::Mirror];
        add_floor(scene);
        scene.uvs.push([Vec2::ZERO, vec2(7.0, -2.0), vec2(-1.0, 5.0)]);
        scene.materials[0].texture = Some(map);
    }),
    ("roughness map", |scene| {
        let map = add_texture(scene, Filter::Nearest);
        scene.materials[0].roughness_map = scene.materials[0].kind.has_roughness().then_some(map);
    }),
    ("normal map", |scene| {
        add_floor(scene);
        scene.uvs.push([Vec2::ZERO, Vec2::X, Vec2::Y]);
        scene.materials[0].normal_map = Some(add_texture(scene, Filter::Nearest));
    }),
    ("opacity", |scene| scene.materials[0].opacity = 0.5),
    ("opacity map", |scene| scene.materials[0].opacity_map = Some(add_texture(scene, Filter::Nearest))),
    ("gradient", |scene| scene.sky = Sky::Gradient { bottom: Vec3::ONE, top: vec3(0.5, 0.7, 1.0) }),
    ("nearest sky", |scene| set_sky(scene, Filter::Nearest)),
    ("bilinear sky", |scene| set_sky(scene, Filter::Bilinear)),
    ("trilinear sky", |scene| set_sky(scene, Filter::Trilinear)),
    ("a sphere light", |scene| {
        scene.materials.push(emitter(vec3(5.0, 4.0, 3.0)));
        scene.spheres.push(sphere(vec3(-1.0, 1.5, 0.5), 0.2, 1));
    }),
    ("triangle lights", |scene| {
        scene.materials.push(emitter(vec3(5.0, 4.0, 3.0)));
        add_floor(scene);
        let lights = (0..6).map(|number| vec3(0.5 * number as f32 - 1.5, 1.5, 0.5));
        let lights = lights.map(|at| triangle([at, at + 0.3 * Vec3::X, at + 0.3 * Vec3::Z], 1));
        scene.triangles.extend(lights);
    }),
    ("many spheres", |scene| {
        let mut rng = Rng(91);
        scene.spheres.extend((0..60).map(|_| sphere((rng.in_cube() * 2.0).as_vec3(), 0.2, 0)));
    }),
];

fn add_floor(scene: &mut Scene) {
    scene.triangles.push(triangle(ground(9.0, -1.0), 0));
}

/// Adds a texture; returns its number.
fn add_texture(scene: &mut Scene, filter: Filter) -> u32 {
    scene.textures.push(noise(&mut Rng(91), 5, 7, filter));
    scene.textures.len() as u32 - 1
}

fn set_sky(scene: &mut Scene, filter: Filter) {
    scene.sky = Sky::Texture { texture: add_texture(scene, filter), color: Vec3::ONE, turn: 0.3 };
}

/// Two balls of a kind of material.
fn plain(kind: MaterialKind) -> Scene {
    Scene {
        camera: Camera { position: vec3(0.3, 0.4, 4.0), ..empty().camera },
        materials: vec![Material { color: vec3(0.9, 0.8, 0.7), ..material(kind) }],
        spheres: vec![sphere(Vec3::ZERO, 0.9, 0), sphere(vec3(1.2, 0.3, 0.4), 0.5, 0)],
        sky: Sky::Color(vec3(0.5, 0.6, 0.7)),
        ..empty()
    }
}

#[test]
fn every_feature_alone_gives_the_bits_of_all_features_together() {
    let lights = [LightChoice::On, LightChoice::Off];
    for kind in KINDS.into_iter().chain([Emitter]) {
        for ((extra, add), lights) in
            EXTRAS.into_iter().flat_map(|extra| lights.map(|lights| (extra, lights)))
        {
            let mut scene = plain(kind);
            add(&mut scene);
            let needed = Settings { resolution: [24, 16], max_bounces: 3, ..with_lights(&scene, lights) };
            let general = Settings { pipeline: PipelineChoice::General, ..needed };
            let [needed, general] = [needed, general].map(|settings| render(&scene, settings, 2));
            assert!(needed == general, "{kind:?}, {extra}, {lights:?}");
        }
    }
}
