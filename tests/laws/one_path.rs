//! The law of one path: what `octray inspect --pixel` shows is in the film, bit by bit, and in the reference.

use crate::common::*;
use octray::scene::builtin_names;

#[test]
fn vertices_are_those_of_the_film_and_of_the_reference() {
    let (mut paths, mut parted, mut lights_found) = (0, 0, 0);
    let builtin = |name: &str| load(&format!("builtin:{name}")).unwrap();
    // A lamp twice in one place: what a shadow ray hits decides what it adds.
    let mut twice = Scene { name: "a lamp twice".into(), ..builtin("cornell") };
    let emits = |triangle: &&Triangle| twice.materials[triangle.material as usize].emits();
    let lamp: Vec<Triangle> = twice.triangles.iter().filter(emits).copied().collect();
    twice.triangles.extend(lamp);
    assert!(Lights::new(&twice, LightChoice::On).needs_hits());
    for scene in builtin_names().map(builtin).chain([twice]) {
        let name = &scene.name;
        let judge = Reference::new(&scene);
        for (lights, sampler) in [(LightChoice::On, Sampler::Sobol), (LightChoice::Off, Sampler::Random)] {
            let methods = Methods { lights, sampler, ..Methods::default() };
            let settings = Settings { resolution: [24, 16], seed: 3, methods, ..Settings::of(&scene) };
            let (picture, mut renderer) = (render(&scene, settings, 1), Renderer::new(&scene, settings));
            for (x, y) in places([24, 16]).step_by(7) {
                let place = format!("{name}, lights {lights:?}, pixel {x},{y}");
                let f32 = renderer.path([x, y], 0);
                let pixel = picture.pixels[(y * 24 + x) as usize];
                assert_eq!(
                    f32.last().unwrap().radiance.map(f32::to_bits),
                    pixel.map(f32::to_bits),
                    "{place}"
                );
                lights_found +=
                    f32.iter().filter_map(|vertex| vertex.light).filter(|l| *l != [0.0; 3]).count();
                let f64 = judge.vertices(path_settings(settings), x, y, 0);
                let radiance = f64.last().unwrap().radiance;
                assert_eq!(radiance, judge.pixel(path_settings(settings), x, y, 1), "{place}");
                let seen = f32.iter().map(|vertex| (vertex.primitive, vertex.lobe));
                let same = f64.iter().map(|vertex| (vertex.primitive, vertex.lobe)).eq(seen);
                (paths, parted) = (paths + 1, parted + usize::from(!same));
                let near =
                    (0..3).all(|c| (radiance[c] - f64::from(pixel[c])).abs() < 0.01 * radiance[c].max(0.01));
                assert!(near || !same || lights == LightChoice::On, "{place}: {radiance:?}, {pixel:?}");
            }
        }
    }
    assert!(lights_found > 100, "only {lights_found} lights");
    assert!(20 * parted < paths, "{parted} of {paths} paths part");
}
