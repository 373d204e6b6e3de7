//! Law: a picture on a sphere reads from left to right for an eye on the side that the scene names, and is
//! mirrored from the other; the sky reads right from where everybody sees it. Columns of red 0, 1, 2, … stand
//! for the letters of a text.
//!
//! And whole repeats of a picture on triangles are nothing.

use crate::common::*;

const COLUMNS: u32 = 64;

fn columns() -> Texture {
    let texel = |i: u32| [(i % COLUMNS) as f32, 1.0, 1.0, 0.0];
    texture([COLUMNS, 2], Filter::Nearest, Texels::Float32((0..2 * COLUMNS).map(texel).collect()))
}

/// A shining ball of radius 1 with the picture on it.
fn ball(texture_side: Side) -> Scene {
    Scene {
        sky: Sky::Color(Vec3::ZERO),
        materials: vec![Material { texture: Some(0), emission: Vec3::ONE, ..material(Emitter) }],
        textures: vec![columns()],
        spheres: vec![Sphere { texture_side, texture_turn: 0.1, ..sphere(Vec3::ZERO, 1.0, 0) }],
        ..empty()
    }
}

fn sky() -> Scene {
    Scene {
        sky: Sky::Texture { texture: 0, color: Vec3::ONE, turn: 0.1 },
        textures: vec![columns()],
        ..empty()
    }
}

/// What stands in a row of pixels, from left to right; the packets, the scalar path and the judge agree on
/// it.
fn row(scene: &Scene) -> Vec<f32> {
    let settings = Settings { resolution: [31, 1], max_bounces: 0, ..Settings::of(scene) };
    let [scalar, packets @ ..] = WIDTHS.map(|lanes| {
        let pixels = render(scene, Settings { lanes, ..settings }, 1).pixels;
        pixels.iter().map(|pixel| pixel[0]).collect::<Vec<_>>()
    });
    assert!(packets.iter().all(|row| *row == scalar));
    let judge = Reference::new(scene);
    let path = path_settings(settings);
    let judged: Vec<f32> = (0..31).map(|x| judge.pixel(path, x, 0, 1)[0] as f32).collect();
    // A point near the edge of a column may round into its neighbour.
    let apart = scalar.iter().zip(&judged).map(|(a, b)| (a - b).rem_euclid(COLUMNS as f32));
    let near = |apart: f32| apart <= 1.0 || apart >= COLUMNS as f32 - 1.0;
    assert!(apart.clone().all(near), "the judge reads another picture: {scalar:?}, {judged:?}");
    assert!(apart.filter(|&apart| apart != 0.0).count() <= 3, "{scalar:?}, {judged:?}");
    scalar
}

/// Does the text run to the right, whatever the side one looks from? Asserts that it runs one way.
fn reads_right(scene: &Scene, eye_distance: f32) -> bool {
    let answers = [0.3, 1.7, 2.9, 4.4, 5.8].map(|angle: f32| {
        let away = vec3(angle.cos(), 0.0, angle.sin());
        let position = away * eye_distance;
        let camera = camera(position, position - away, 0.3);
        let row = row(&Scene { camera, ..scene.clone() });
        // From one pixel to the next by less than half the picture, over the seam too.
        let steps = row.windows(2).map(|pair| {
            let step = (pair[1] - pair[0]).rem_euclid(COLUMNS as f32);
            if step > COLUMNS as f32 / 2.0 { step - COLUMNS as f32 } else { step }
        });
        let steps: Vec<f32> = steps.collect();
        assert!(steps.iter().any(|&step| step != 0.0), "{row:?}");
        let (right, left) = (steps.iter().all(|&step| step >= 0.0), steps.iter().all(|&step| step <= 0.0));
        assert!(right != left, "{row:?}");
        right
    });
    assert!(answers.iter().all(|&right| right == answers[0]), "{answers:?}");
    answers[0]
}

#[test]
fn pictures_read_right_from_the_side_they_are_for() {
    assert!(reads_right(&ball(Side::Outside), 5.0), "a globe");
    assert!(!reads_right(&ball(Side::Outside), 0.0), "a globe from inside");
    assert!(reads_right(&ball(Side::Inside), 0.0), "a sphere as sky");
    assert!(!reads_right(&ball(Side::Inside), 5.0), "a sphere as sky from outside");
    assert!(reads_right(&sky(), 0.0), "the sky");
}

/// The spheres that are the skies of the thesis's scenes are seen from inside.
#[test]
fn builtin_skies_on_spheres_read_right_from_inside() {
    for name in ["builtin:thesis", "builtin:chess"] {
        let scene = load(name).unwrap();
        let sky = scene.spheres.iter().find(|sphere| sphere.radius == 1000.0).unwrap();
        assert_eq!(sky.texture_side, Side::Inside, "{name}");
    }
}

#[test]
fn whole_repeats_of_a_triangles_picture_change_no_bit() {
    let corners = [vec3(-4.0, -4.0, 0.0), vec3(4.0, -4.0, 0.0), vec3(0.0, 5.0, 0.0)];
    // A step of single precision near 10⁶ is a sixteenth.
    let uvs = [vec2(0.0, 0.25), vec2(0.75, 0.0), vec2(0.5, 0.9375)];
    let shifted = |by: Vec2| {
        let mut scene = Scene { triangles: vec![triangle(corners, 0)], ..ball(Side::Outside) };
        scene.spheres.clear();
        scene.uvs = vec![uvs.map(|uv| uv + by)];
        render(&scene, Settings::of(&scene), 2)
    };
    let near = shifted(Vec2::ZERO);
    assert!(near.pixels.iter().any(|pixel| pixel[0] != near.pixels[0][0]), "the picture shows");
    for by in [vec2(1.0, -7.0), vec2(-1e6, 1e6)] {
        assert!(shifted(by) == near, "{by}");
    }
}

/// A wall with coordinates from −2 to 3, shining, in a mirror, and as relief.
#[test]
fn clamped_and_mirrored_textures_are_the_references() {
    let corners = [vec3(-8.0, -8.0, 0.0), vec3(8.0, -8.0, 0.0), vec3(0.0, 8.0, 0.0)];
    for (filter, wrap) in
        [Filter::Nearest, Filter::Bilinear, Filter::Trilinear].into_iter().flat_map(|filter| {
            [[Wrap::Clamp; 2], [Wrap::Mirror; 2], [Wrap::Clamp, Wrap::Repeat], [Wrap::Repeat, Wrap::Mirror]]
                .map(|wrap| (filter, wrap))
        })
    {
        let mut rng = Rng(7);
        let textures = [[5, 4], [8, 3]].map(|[width, height]| noise(&mut rng, width, height, filter));
        let scene = Scene {
            sky: Sky::Gradient { bottom: Vec3::ZERO, top: Vec3::ONE },
            materials: vec![Material {
                texture: Some(0),
                roughness_map: Some(1),
                ..material(Metal { roughness: 0.5 })
            }],
            textures: textures.map(|texture| Texture { wrap, ..texture }).to_vec(),
            triangles: vec![triangle(corners, 0)],
            uvs: vec![[vec2(-1.1, -2.0), vec2(2.1, -1.2), vec2(0.4, 3.0)]],
            ..empty()
        };
        crate::judged::assert_is_the_references(&format!("{filter:?} {wrap:?}"), &scene, 2);
        let repeating =
            scene.textures.iter().map(|texture| Texture { wrap: [Wrap::Repeat; 2], ..texture.clone() });
        let repeating = Scene { textures: repeating.collect(), ..scene.clone() };
        let [wrapped, repeated] = [&scene, &repeating].map(|scene| render(scene, Settings::of(scene), 2));
        assert!(wrapped != repeated, "{filter:?} {wrap:?}");
    }
}
