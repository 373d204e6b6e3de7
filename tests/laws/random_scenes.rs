//! Law: every valid scene has the same bits at every width, traversal and pipeline, and a picture of finite
//! numbers of 0 or more. Random scenes of everything: sizes from 1e-6 to 1e6, far from the origin, slivers,
//! cameras on surfaces and in spheres, textures of one texel, lights of any strength.

use crate::common::*;
use octray::scene::{Lens, LightShape, Portal, Projection, Wrap};
use std::ops::Range;

/// One of the list.
fn of<T: Copy>(rng: &mut Rng, list: &[T]) -> T {
    list[rng.index(list.len())]
}

/// True once in `times`.
fn once_in(rng: &mut Rng, times: usize) -> bool {
    rng.index(times) == 0
}

/// From 0 to 1, its ends and their neighbours often.
fn fraction(rng: &mut Rng) -> f32 {
    let any = rng.unit() as f32;
    of(rng, &[0.0, 1.0, 1e-6, 0.999_999_94, any, any, any, any])
}

fn fractions(rng: &mut Rng) -> Vec3 {
    vec3(fraction(rng), fraction(rng), fraction(rng))
}

/// A unit vector, along an axis once in three.
fn direction(rng: &mut Rng) -> DVec3 {
    match rng.index(3) {
        0 => of(rng, &[DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z]),
        _ => rng.direction(),
    }
}

fn kind(rng: &mut Rng) -> MaterialKind {
    let (roughness, metallic) = (fraction(rng), fraction(rng));
    let ior = rng.scale(1.0, 3.0) as f32;
    match rng.index(8) {
        0 | 1 => Diffuse,
        2 => Metal { roughness },
        3 => Plastic { roughness, ior },
        4 => {
            let ior = of(rng, &[ior, ior, 1.0, 1e6]);
            MetalRough { roughness, metallic, ior }
        }
        5 => {
            let ior = of(rng, &[ior, 1.0 / ior, 1.0, 1e-3, 1e3]);
            let rough = |thin| RoughGlass { roughness, ior, thin };
            of(rng, &[Glass { ior }, ThinGlass { ior }, rough(false), rough(true)])
        }
        6 => FuzzyMirror { roughness: rng.scale(1e-3, 1e3) as f32 },
        _ => Emitter,
    }
}

fn material(rng: &mut Rng, textures: usize, transparent: bool) -> Material {
    let kind = kind(rng);
    let emitter = kind == Emitter;
    let emission = match emitter || once_in(rng, 5) {
        true => fractions(rng) * rng.scale(1e-6, 1e6) as f32,
        false => Vec3::ZERO,
    };
    let color = if emitter { Vec3::ONE } else { fractions(rng) };
    let absorbs = matches!(kind, Glass { .. } | RoughGlass { thin: false, .. }) && emission == Vec3::ZERO;
    let mut extras = MaterialExtras::default();
    if matches!(kind, MetalRough { .. }) && once_in(rng, 2) {
        extras.transmission = fraction(rng);
        extras.thin = extras.transmission > 0.0 && once_in(rng, 2);
        (extras.specular, extras.specular_color) = (fraction(rng), 2.0 * fractions(rng));
        (extras.clearcoat, extras.clearcoat_roughness) = (fraction(rng), fraction(rng));
    } else if absorbs && once_in(rng, 2) {
        extras.attenuation =
            Some(Attenuation { color: fractions(rng), distance: rng.scale(1e-2, 1e2) as f32 });
    }
    let mut map = |times: usize, fits: bool| {
        let wanted = fits && textures > 0 && once_in(rng, times);
        wanted.then(|| rng.index(textures) as u32)
    };
    Material {
        texture: map(2, true),
        roughness_map: map(3, kind.has_roughness()),
        normal_map: map(3, !emitter),
        emission_map: map(3, !emitter && emission != Vec3::ZERO),
        opacity_map: map(2, transparent),
        emission,
        extras,
        opacity: if transparent { fraction(rng) } else { 1.0 },
        alpha_cutoff: once_in(rng, 2).then(|| fraction(rng)),
        ..Material::new("m", kind, color)
    }
}

/// The triangles of one thing, around the origin and of about size 1.
fn thing(rng: &mut Rng) -> Vec<[DVec3; 3]> {
    let [a, b, c] = [(); 3].map(|()| rng.in_cube());
    match rng.index(6) {
        // A quad, its diagonal shared.
        0 => {
            let [x, y] = [direction(rng), direction(rng)];
            vec![[-x - y, x - y, x + y], [-x - y, x + y, y - x]]
        }
        // A sliver: all corners nearly on a line.
        1 => vec![[a, b, a + (b - a) * rng.scale(1e-3, 1.0) + c * rng.scale(1e-6, 1e-2)]],
        // A tetrahedron.
        2 => {
            let d = rng.in_cube();
            vec![[a, b, c], [a, c, d], [a, d, b], [b, d, c]]
        }
        // Flat, along an axis.
        3 => {
            let flat = of(rng, &[dvec3(0.0, 1.0, 1.0), dvec3(1.0, 0.0, 1.0), dvec3(1.0, 1.0, 0.0)]);
            vec![[a, b, c].map(|corner| corner * flat)]
        }
        _ => vec![[a, b, c]],
    }
}

fn add_triangles(rng: &mut Rng, scene: &mut Scene, center: DVec3, size: f64) {
    let materials = scene.materials.len();
    let smooth = once_in(rng, 3);
    // Some scenes are large enough for a hierarchy.
    let things = if once_in(rng, 4) { 10 + rng.index(60) } else { rng.index(5) };
    let mut shape = thing(rng);
    for _ in 0..things {
        // Copies of one thing, or another one.
        if once_in(rng, 2) {
            shape = thing(rng);
        }
        let place = center + rng.in_cube() * size;
        let scale = size * rng.scale(1e-3, 10.0);
        let material = rng.index(materials) as u32;
        for corners in &shape {
            let vertices = corners.map(|corner| (place + corner * scale).as_vec3());
            let [a, b, c] = vertices.map(Vec3::as_dvec3);
            let flat = (b - a).cross(c - a);
            // As the formats check it.
            if !(flat.length() as f32).is_normal() {
                continue;
            }
            scene.triangles.push(triangle(vertices, material));
            let repeats = rng.scale(1e-2, 1e3);
            let uv = |rng: &mut Rng| vec2((rng.signed() * repeats) as f32, (rng.signed() * repeats) as f32);
            let same = uv(rng);
            let uvs = [(); 3].map(|()| uv(rng));
            scene.uvs.push(if once_in(rng, 8) { [same; 3] } else { uvs });
            let bent = 2.0 * rng.unit();
            let normals =
                [(); 3].map(|()| (flat.normalize() + rng.direction() * bent).normalize_or(DVec3::X));
            let is_flat = once_in(rng, 3);
            scene.normals.push(if is_flat { [Vec3::ZERO; 3] } else { normals.map(DVec3::as_vec3) });
        }
    }
    if !scene.materials.iter().any(|material| material.textures().next().is_some()) {
        scene.uvs.clear();
    }
    if !smooth {
        scene.normals.clear();
    }
}

/// A pinhole, a lens of any size, or parallel rays.
fn projection(rng: &mut Rng, size: f64) -> Projection {
    let blades = of(rng, &[0, 3, 6, 16]);
    let radius = (size * of(rng, &[0.0, 1e-6, 0.1, 10.0])) as f32;
    let focus = of(rng, &[None, Some(1e-3), Some(1.0), Some(1e18)]);
    let focus = focus.map(|focus| (size * focus) as f32);
    match rng.index(6) {
        0 => Projection::Perspective(Lens { radius, focus, blades }),
        1 => Projection::Orthographic { height: (size * rng.scale(1e-6, 1e3)) as f32 },
        _ => Projection::default(),
    }
}

/// A point, a spot or a sun: near, on a surface, of no angle and of any strength.
fn light(rng: &mut Rng, center: DVec3, size: f64) -> LightShape {
    let brightness = fractions(rng) * rng.scale(1e-6, 1e6) as f32;
    let position = (center + rng.in_cube() * size).as_vec3();
    let intensity = brightness * (size * size) as f32;
    let range = (size * rng.scale(1e-3, 1e3)) as f32;
    let range = of(rng, &[f32::INFINITY, range]);
    let outer_degrees = of(rng, &[90.0, 30.0, 1e-3]);
    let inner_degrees = outer_degrees * fraction(rng);
    let direction = (direction(rng) * rng.scale(1e-3, 1e3)).as_vec3();
    match rng.index(3) {
        0 => LightShape::Point { position, intensity, range },
        1 => LightShape::Spot { position, direction, intensity, range, inner_degrees, outer_degrees },
        _ => {
            let angular_diameter_degrees = of(rng, &[0.0, 1e-3, 0.5, 180.0]);
            LightShape::Directional { direction, irradiance: brightness, angular_diameter_degrees }
        }
    }
}

/// A parallelogram, a narrow one at times.
fn portal(rng: &mut Rng, center: DVec3, size: f64) -> Portal {
    let corner = center + rng.in_cube() * size;
    let along = direction(rng) * size;
    let across = along.cross(direction(rng) + rng.direction() * 0.01) * rng.scale(1e-3, 3.0);
    let vertices = [corner, corner + along, corner + along + across, corner + across];
    Portal { vertices: vertices.map(DVec3::as_vec3) }
}

/// Somewhere, on a surface, inside a sphere, or level with a triangle.
fn camera(rng: &mut Rng, scene: &Scene, center: DVec3, size: f64) -> Camera {
    loop {
        let target = center + rng.in_cube() * size;
        let position = match rng.index(6) {
            0 if !scene.spheres.is_empty() => {
                let ball = &scene.spheres[rng.index(scene.spheres.len())];
                let part = of(rng, &[0.0, 0.5, 1.0]);
                ball.center.as_dvec3() + direction(rng) * f64::from(ball.radius) * part
            }
            1 if !scene.triangles.is_empty() => {
                let [a, b, c] =
                    scene.triangles[rng.index(scene.triangles.len())].vertices.map(Vec3::as_dvec3);
                let along = of(rng, &[0.5, -1.0, 3.0]);
                a + (b - a) * along + (c - a) * 0.2
            }
            _ => center + direction(rng) * size * rng.scale(1e-2, 30.0),
        };
        let aimed = Camera::pinhole(
            position.as_vec3(),
            target.as_vec3(),
            direction(rng).as_vec3(),
            of(rng, &[40.0, 70.0, 1e-3, 179.0]),
        );
        let aimed = Camera { projection: projection(rng, size), ..aimed };
        if aimed.fault().is_none() {
            return aimed;
        }
    }
}

/// A valid scene.
fn scene(rng: &mut Rng) -> Scene {
    let size = rng.scale(1e-6, 1e6);
    let away = if once_in(rng, 2) { 0.0 } else { size * rng.scale(1e-2, 1e4) };
    let center = direction(rng) * away;
    let textures = rng.index(4);
    let mut scene = Scene { resolution: [5, 4], max_bounces: rng.index(7) as u32, ..empty() };
    for _ in 0..textures {
        let filter = of(rng, &[Filter::Nearest, Filter::Bilinear, Filter::Trilinear]);
        let [width, height] = [(); 2].map(|()| 1 + rng.index(6) as u32);
        let wrap = [(); 2].map(|()| of(rng, &[Wrap::Repeat, Wrap::Repeat, Wrap::Clamp, Wrap::Mirror]));
        scene.textures.push(Texture { wrap, ..noise(rng, width, height, filter) });
    }
    let transparent = once_in(rng, 4);
    let materials = 1 + rng.index(6);
    scene.materials = (0..materials).map(|_| material(rng, textures, transparent)).collect();
    let most = if once_in(rng, 6) { 80 } else { 6 };
    for _ in 0..rng.index(most) {
        let place = (center + rng.in_cube() * size).as_vec3();
        let radius = size * of(rng, &[1e-6, 1e-2, 0.3, 1.0, 1e3]) * rng.scale(0.5, 2.0);
        scene.spheres.push(Sphere {
            texture_turn: rng.unit() as f32,
            texture_side: of(rng, &[Side::Inside, Side::Outside]),
            ..sphere(place, radius as f32, rng.index(scene.materials.len()) as u32)
        });
    }
    add_triangles(rng, &mut scene, center, size);
    if scene.spheres.is_empty() && scene.triangles.is_empty() {
        scene.spheres.push(sphere(center.as_vec3(), size as f32, 0));
    }
    let bright = rng.scale(1e-6, 1e6) as f32;
    scene.sky = match rng.index(4) {
        0 => Sky::Color(Vec3::ZERO),
        1 => Sky::Color(fractions(rng) * bright),
        2 => Sky::Gradient { bottom: fractions(rng) * bright, top: fractions(rng) },
        _ if textures > 0 => {
            let texture = rng.index(textures) as u32;
            Sky::Texture { texture, color: fractions(rng) * bright, turn: rng.unit() as f32 }
        }
        _ => Sky::Color(Vec3::ONE),
    };
    if once_in(rng, 3) {
        scene.lights = (0..1 + rng.index(4)).map(|_| light(rng, center, size).into()).collect();
    }
    if once_in(rng, 3) {
        scene.portals = (0..1 + rng.index(3)).map(|_| portal(rng, center, size)).collect();
    }
    scene.camera = camera(rng, &scene, center, size);
    scene
}

/// Whether a scene's picture shows anything, or what is wrong with it.
fn check(seed: u64) -> Result<bool, String> {
    let mut rng = Rng::of("random scenes", [seed, 0]);
    let scene = scene(&mut rng);
    let lights = of(&mut rng, &[LightChoice::Auto, LightChoice::On, LightChoice::Off]);
    let sampler = of(&mut rng, &[Sampler::default(), Sampler::Random]);
    let mut picture = |lanes: usize| {
        let traversal = of(&mut rng, &TRAVERSALS);
        let settings = Settings {
            lanes,
            methods: Methods { lights, sampler, traversal, ..Methods::default() },
            pipeline: of(&mut rng, &[PipelineChoice::Auto, PipelineChoice::General]),
            seed: seed as u32,
            ..Settings::of(&scene)
        };
        let renderer = Renderer::new(&scene, settings);
        let mut film = renderer.film();
        renderer.add_samples(&mut film, 1);
        (film.picture().pixels, film.discarded())
    };
    let (scalar, discarded) = picture(1);
    let wrong = scalar.iter().flatten().find(|channel| !(channel.is_finite() && **channel >= 0.0));
    if discarded > 0 || wrong.is_some() {
        return Err(format!("{discarded} samples discarded, a pixel of {wrong:?}"));
    }
    let bits = |pixels: &[[f32; 3]]| pixels.iter().map(|pixel| pixel.map(f32::to_bits)).collect::<Vec<_>>();
    for lanes in WIDTHS.into_iter().skip(1) {
        let (packets, _) = picture(lanes);
        let differ = bits(&packets).iter().zip(bits(&scalar)).filter(|(a, b)| **a != *b).count();
        if differ > 0 {
            return Err(format!("{differ} pixels differ between 1 and {lanes} lanes"));
        }
    }
    Ok(scalar.iter().flatten().any(|channel| *channel > 0.0))
}

const TRAVERSALS: [TraversalChoice; 5] = [
    TraversalChoice::Auto,
    TraversalChoice::Linear,
    TraversalChoice::Through(Traversal::Single),
    TraversalChoice::Through(Traversal::Packet),
    TraversalChoice::Through(Traversal::Stream),
];

fn assert_no_fault(seeds: Range<u64>) {
    let count = seeds.end - seeds.start;
    let (mut faults, mut lit) = (Vec::new(), 0);
    for seed in seeds {
        match check(seed) {
            Ok(shows) => lit += u64::from(shows),
            Err(fault) => faults.push(format!("scene {seed}: {fault}")),
        }
    }
    assert!(faults.is_empty(), "{} scenes:\n{}", faults.len(), faults[..faults.len().min(20)].join("\n"));
    // A black picture has the same bits at every width.
    assert!(lit > count / 2, "{lit} of {count} pictures show something");
}

#[test]
fn random_scenes_have_the_same_finite_bits_at_every_width() {
    assert_no_fault(0..500);
}

#[test]
#[ignore = "minutes: run by .ci/run"]
fn two_thousand_random_scenes_have_the_same_finite_bits_at_every_width() {
    assert_no_fault(0..2_000);
}
