//! Law: the primitives that shadow rays leave out lie between no surface and no light, judged in f64; and
//! pictures are the same through a hierarchy.

use crate::common::*;
use glam::DMat3;
use octray::rays::{Candidates, Kind};

const DIFFUSE: u32 = 0;
const LAMP: u32 = 1;

fn dark() -> Scene {
    let materials = vec![material(Diffuse), lamp(1.0)];
    Scene { sky: Sky::Color(Vec3::ZERO), materials, ..empty() }
}

/// The two triangles of a parallelogram.
fn quad(corner: DVec3, [ab, ac]: [DVec3; 2], material: u32) -> [Triangle; 2] {
    let [a, b, c, d] = [corner, corner + ab, corner + ac, corner + ab + ac].map(|v| v.as_vec3());
    [triangle([a, b, d], material), triangle([a, d, c], material)]
}

/// A turned and shifted room of twelve triangles with a lamp of two in it or in its ceiling, and furniture.
fn room(rng: &mut Rng) -> Scene {
    let axes = DMat3::from_axis_angle(rng.direction(), rng.unit() * 6.0);
    let corner = rng.in_cube() * rng.scale(0.1, 10.0);
    let [x, y, z] = [axes.x_axis, axes.y_axis * rng.scale(0.5, 2.0), axes.z_axis];
    let mut scene = dark();
    let zero = DVec3::ZERO;
    for (from, edges) in
        [(zero, [x, y]), (zero, [y, z]), (zero, [z, x]), (z, [x, y]), (x, [y, z]), (y, [z, x])]
    {
        scene.triangles.extend(quad(corner + from, edges, DIFFUSE));
    }
    let height = [1.0, 0.999, 0.7][rng.index(3)];
    scene.triangles.extend(quad(corner + x * 0.4 + z * 0.4 + y * height, [x * 0.2, z * 0.2], LAMP));
    for _ in 0..rng.index(3) {
        let inside = |rng: &mut Rng| corner + x * rng.unit() + y * rng.unit() + z * rng.unit();
        let vertices = [inside(rng), inside(rng), inside(rng)].map(|v| v.as_vec3());
        scene.triangles.push(triangle(vertices, rng.index(2) as u32));
        let material = rng.index(2) as u32;
        scene.spheres.push(sphere(inside(rng).as_vec3(), rng.scale(0.01, 0.3) as f32, material));
    }
    if rng.index(3) == 0 {
        scene.spheres.push(sphere((corner + (x + y + z) * 0.5).as_vec3(), 3.0, DIFFUSE));
    }
    scene
}

/// A point on a primitive.
fn point(rng: &mut Rng, scene: &Scene, number: usize) -> DVec3 {
    match scene.spheres.get(number) {
        Some(ball) => ball.center.as_dvec3() + rng.direction() * f64::from(ball.radius),
        None => {
            let [a, b, c] = scene.triangles[number - scene.spheres.len()].vertices.map(|v| v.as_dvec3());
            let [u, v, w] = rng.barycentrics();
            a * u + b * v + c * w
        }
    }
}

/// Whether the only primitive of a scene lies between two points, neither of which is on it.
fn separates(alone: &Scene, from: DVec3, to: DVec3) -> bool {
    let off = |end: DVec3| match alone.spheres.first() {
        Some(ball) => (end - ball.center.as_dvec3()).length() - f64::from(ball.radius),
        None => {
            let [a, b, c] = alone.triangles[0].vertices.map(|v| v.as_dvec3());
            (b - a).cross(c - a).normalize().dot(end - a)
        }
    };
    let hit = || Reference::new(alone).closest(from, to - from);
    let is_apart = [from, to].into_iter().all(|end| off(end).abs() >= 1e-5);
    is_apart && hit().is_some_and(|hit| (1e-6..1.0 - 1e-6).contains(&hit.t))
}

#[test]
fn what_shadow_rays_leave_out_occludes_no_light() {
    let (mut left_out, mut rooms, mut occluded) = (0, 0, 0);
    for seed in 0..120 {
        let mut rng = Rng::of("occluders", [seed, 0]);
        let scene = room(&mut rng);
        let lights = Lights::new(&scene, LightChoice::On);
        let Some(list) = occluders(&scene, &lights) else { continue };
        let spheres = scene.spheres.len();
        let count = spheres + scene.triangles.len();
        let listed: Vec<usize> = (list.of_kind(Kind::Sphere).iter().map(|&index| index as usize))
            .chain(list.of_kind(Kind::Triangle).iter().map(|&index| spheres + index as usize))
            .collect();
        (rooms, left_out) = (rooms + 1, left_out + count - listed.len());
        let spheres_alone = scene.spheres.iter().map(|&ball| Scene { spheres: vec![ball], ..dark() });
        let one = |&one: &Triangle| Scene { triangles: vec![one], ..dark() };
        let alone: Vec<Scene> = spheres_alone.chain(scene.triangles.iter().map(one)).collect();
        let sampled: Vec<usize> = (0..count).filter(|&number| lights.probabilities[number] > 0.0).collect();
        for _ in 0..2000 {
            let (surface, light) = (rng.index(count), sampled[rng.index(sampled.len())]);
            let (from, to) = (point(&mut rng, &scene, surface), point(&mut rng, &scene, light));
            // Far sides of sphere lights are no ends of shadow rays.
            if let Some(ball) = scene.spheres.get(light)
                && (to - ball.center.as_dvec3()).dot(to - from) > 0.0
                && from.distance(ball.center.as_dvec3()) > f64::from(ball.radius)
            {
                continue;
            }
            for (number, alone) in alone.iter().enumerate() {
                let separates = separates(alone, from, to);
                occluded += usize::from(separates);
                let ends = [(surface, from), (light, to)];
                assert!(!separates || listed.contains(&number), "seed {seed}: {number} between {ends:?}");
            }
        }
    }
    assert!(rooms >= 100 && left_out > 9 * rooms, "{left_out} primitives left out in {rooms} rooms");
    assert!(occluded > 20_000, "{occluded}");
}

/// Returns the primitives that shadow rays to these lights are tested against, if not all.
fn occluders(scene: &Scene, lights: &Lights) -> Option<Candidates> {
    Methods::default().structure(scene, &scene.geometry(), 8, lights, None).occluders().cloned()
}

/// Indices of the spheres and triangles that can occlude a light; all if none is left out.
fn listed(scene: &Scene) -> Option<[Vec<u32>; 2]> {
    let lights = Lights::new(scene, LightChoice::On);
    occluders(scene, &lights).map(|found| Kind::ALL.map(|kind| found.of_kind(kind).to_vec()))
}

#[test]
fn walls_lamps_and_surrounding_spheres_occlude_nothing() {
    let builtin = |name: &str| load(name).expect("a built-in scene");
    // Two boxes stand in the room, their bottoms left out. The five walls and the lamp have two triangles
    // each.
    let [spheres, triangles] = listed(&builtin("builtin:cornell")).expect("walls");
    assert_eq!((spheres.len(), triangles.len()), (0, 20));
    assert_eq!(listed(&builtin("builtin:cornell-spheres")), Some([vec![0, 1], vec![]]));

    let (x, z) = (DVec3::X, DVec3::Z);
    let mut scene = dark();
    scene.triangles.extend(quad(DVec3::ZERO, [x, z], DIFFUSE));
    scene.triangles.extend(quad(DVec3::Y, [x, z], LAMP));
    assert_eq!(listed(&scene), Some([vec![], vec![]]), "a floor and a lamp");

    let with = |change: &dyn Fn(&mut Scene)| {
        let mut scene = scene.clone();
        change(&mut scene);
        listed(&scene)
    };
    let ball = |y: f32, radius, material| sphere(vec3(0.5, y, 0.5), radius, material);
    let pushed = |ball| with(&|scene| scene.spheres.push(ball));
    assert_eq!(pushed(ball(0.5, 0.1, DIFFUSE)), Some([vec![0], vec![]]), "a ball between");
    assert_eq!(pushed(ball(0.5, 5.0, DIFFUSE)), Some([vec![], vec![0, 1]]), "a ball around, shadowed below");
    assert_eq!(pushed(ball(0.1, 0.1, DIFFUSE)), Some([vec![0], vec![]]), "a ball on the floor");
    assert_eq!(pushed(ball(0.1, 0.11, DIFFUSE)), Some([vec![0], vec![0, 1]]), "a ball through the floor");
    assert_eq!(pushed(ball(0.5, 0.1, LAMP)), Some([vec![0], vec![]]), "a second lamp between");
    assert_eq!(pushed(ball(1.5, 0.1, LAMP)), Some([vec![0], vec![2, 3]]), "a lamp behind the lamp");
    assert_eq!(pushed(ball(-1.5, 0.1, LAMP)), Some([vec![0], vec![0, 1]]), "a lamp below the floor");
    let both = |scene: &mut Scene| scene.spheres.extend([ball(-1.5, 0.1, LAMP), ball(1.5, 0.1, DIFFUSE)]);
    assert_eq!(with(&both), None, "a lamp below the floor, and a ball above the other lamp");

    let mut scene = dark();
    scene.spheres.extend([ball(0.0, 1.0, DIFFUSE), ball(0.0, 0.1, LAMP), ball(0.8, 0.1, DIFFUSE)]);
    assert_eq!(listed(&scene), Some([vec![2], vec![]]), "a ball in a hollow one, with the only lamp");
    scene.spheres[2].radius = 0.3;
    assert_eq!(listed(&scene), Some([vec![0, 2], vec![]]), "a ball that reaches out of the hollow one");

    let mut scene = dark();
    scene.triangles.extend(quad(DVec3::ZERO, [x, z], DIFFUSE));
    scene.spheres.push(ball(0.5, 0.1, LAMP));
    assert_eq!(listed(&scene), Some([vec![], vec![]]), "a floor and a lamp that is a sphere");
    scene.normals = vec![[Vec3::Y; 3]; scene.triangles.len()];
    assert_eq!(listed(&scene), None, "rays start above triangles with vertex normals");
}

#[test]
fn every_traversal_leaves_out_the_same() {
    let cornell = load("builtin:cornell").expect("a built-in scene");
    let rooms = (0..6).map(|seed| {
        let mut scene = room(&mut Rng::of("occluders", [seed, 1]));
        let at = scene.triangles[0].vertices[0];
        let middle = (at + scene.triangles[11].vertices[2]) * 0.5;
        scene.camera = Camera::pinhole(middle, at, vec3(0.1, 1.0, 0.2), 60.0);
        scene
    });
    // A surface behind a floor, and so close that it counts as on it, is lit through the floor.
    let mut below = dark();
    for (corner, side, material) in [
        (dvec3(-1000.0, 0.0, -1000.0), 2000.0, DIFFUSE),
        (dvec3(-0.01, -1e-4, -0.01), 0.02, DIFFUSE),
        (dvec3(-1.0, 1.0, -1.0), 2.0, LAMP),
    ] {
        below.triangles.extend(quad(corner, [DVec3::X * side, DVec3::Z * side], material));
    }
    let (position, look_at) = (Vec3::NEG_Y * 5e-5, Vec3::NEG_Y * 1e-4);
    below.camera = Camera::pinhole(position, look_at, Vec3::Z, 40.0);
    assert_eq!(listed(&below), Some([vec![], vec![]]));
    let mut last_is_lit = false;
    for scene in rooms.chain([cornell, below]) {
        let film = |traversal, lanes| {
            let methods = Methods { traversal, lights: LightChoice::On, ..Methods::default() };
            let settings = Settings { resolution: [48, 32], lanes, methods, ..Settings::of(&scene) };
            render(&scene, settings, 8).pixels
        };
        let linear = film(TraversalChoice::Linear, 8);
        last_is_lit = linear.iter().any(|pixel| pixel[0] > 0.0);
        for (traversal, lanes) in
            [(Traversal::Scalar, 1), (Traversal::Stream, 8), (Traversal::Hybrid, NATIVE_WIDTH)]
        {
            assert!(film(TraversalChoice::Through(traversal), lanes) == linear, "{traversal:?}");
        }
    }
    assert!(last_is_lit, "the surface behind the floor");
}
