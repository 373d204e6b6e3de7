//! The law of smooth normals: they bend what a surface does, and let no light through it, nor a ray.

use crate::common::*;
use octray::kernel::normals;

const KINDS: [(MaterialKind, f64); 7] = [
    (Diffuse, 0.0),
    (Metal { roughness: 0.0 }, 0.0),
    (Metal { roughness: 0.3 }, 0.0),
    (Plastic { roughness: 0.0, ior: 1.5 }, 0.0),
    (Plastic { roughness: 0.5, ior: 1.5 }, 0.0),
    (MetalRough { roughness: 0.5, metallic: 0.5, ior: 1.5 }, 0.09),
    (Glass { ior: 1.5 }, 0.002),
];

fn furnace(kind: MaterialKind) -> Scene {
    let mut scene = smooth_ball(kind);
    scene.materials[0].color = Vec3::ONE;
    Scene { sky: Sky::Color(Vec3::ONE), ..scene }
}

fn picture(scene: &Scene, max_bounces: u32) -> Vec<[f32; 3]> {
    let settings = Settings { resolution: [60, 40], max_bounces, seed: 4, ..Settings::of(scene) };
    crate::common::render(scene, settings, 64).pixels
}

/// Mean of the pixels that the ball covers.
fn covered(scene: &Scene, pixels: &[[f32; 3]]) -> f64 {
    let mut black = scene.clone();
    black.sky = Sky::Color(Vec3::ONE);
    let mask = picture(&black, 0);
    let inside = pixels.iter().zip(&mask).filter(|(_, mask)| mask[0] == 0.0);
    let (sum, count) = inside.fold((0.0, 0.0), |(sum, count), (p, _)| (sum + f64::from(p[0]), count + 1.0));
    assert!(count > 500.0);
    sum / count
}

#[test]
fn white_furnace_of_a_smooth_ball_loses_what_is_stated() {
    for (kind, most) in KINDS {
        let [smooth, flat] = [furnace(kind), Scene { normals: Vec::new(), ..furnace(kind) }];
        let [smooth, flat] = [smooth, flat].map(|scene| covered(&scene, &picture(&scene, 200)));
        // What flat triangles lose belongs to the lobe.
        assert!(smooth <= 1.003, "{kind:?} makes light: {smooth}");
        assert!(flat - smooth <= most + 2e-3, "{kind:?} loses {:.4}", flat - smooth);
    }
}

/// A light inside a closed body is not seen outside: no ray that leaves the body starts inside.
#[test]
fn nothing_leaves_below_the_surface() {
    for (kind, _) in KINDS.into_iter().filter(|(kind, _)| !matches!(kind, Glass { .. })) {
        let dark = furnace(kind);
        let mut lit = dark.clone();
        lit.materials.push(lamp(1e6));
        lit.spheres.push(sphere(Vec3::ZERO, 0.7, 1));
        let [dark, lit] = [dark, lit].map(|scene| {
            let methods = Methods { lights: LightChoice::Off, ..Methods::default() };
            let settings =
                Settings { resolution: [60, 40], max_bounces: 9, seed: 4, methods, ..Settings::of(&scene) };
            crate::common::render(&scene, settings, 64).pixels
        });
        assert_eq!(dark, lit, "{kind:?}");
    }
}

/// The triangles of a coarse ball do not show where the light grazes it: its picture is that of a sphere.
#[test]
fn terminator_of_a_smooth_ball_is_that_of_a_sphere() {
    let lit = |scene: Scene| {
        let mut scene = Scene { sky: Sky::Color(Vec3::ZERO), ..scene };
        scene.materials[0].color = Vec3::ONE;
        scene.materials.push(lamp(2000.0));
        scene.spheres.push(sphere(vec3(30.0, 8.0, 2.0), 1.0, 1));
        scene
    };
    let ball = smooth_ball(Diffuse);
    let round = Scene {
        triangles: Vec::new(),
        normals: Vec::new(),
        spheres: vec![sphere(Vec3::ZERO, 1.0, 0)],
        ..ball.clone()
    };
    let [ball, round] = [ball, round].map(|scene| picture(&lit(scene), 1));
    // Between the terminator and the brightest part, away from the outlines, which differ.
    let inside = |x: usize, y: usize| {
        let around = (y - 1..=y + 1).flat_map(|y| (x - 1..=x + 1).map(move |x| y * 60 + x));
        around.into_iter().all(|at| ball[at][1] > 0.0 && (0.3..1.2).contains(&round[at][1]))
    };
    let pixels = (1..39).flat_map(|y| (1..59).map(move |x| (x, y))).filter(|&(x, y)| inside(x, y));
    let off: Vec<f32> =
        pixels.map(|(x, y)| (ball[y * 60 + x][1] / round[y * 60 + x][1] - 1.0).abs()).collect();
    let most = off.iter().copied().fold(0.0, f32::max);
    assert!(off.len() > 100);
    // With rays from the triangles themselves: 0.45.
    assert!(most < 0.1, "{most}");
}

#[test]
fn bulge_leads_to_the_sphere_and_never_inside() {
    let scene = smooth_ball(Diffuse);
    let lane = |v: Vec3| math::Vec3::<f32>::splat(v);
    let mut rng = Rng(92);
    for (triangle, normals) in scene.triangles.iter().zip(&scene.normals) {
        let [a, b, c] = triangle.vertices;
        let ng = (b - a).cross(c - a).normalize();
        for _ in 0..50 {
            let (x, y) = (rng.unit() as f32, rng.unit() as f32);
            let (u, v) = if x + y < 1.0 { (x, y) } else { (1.0 - x, 1.0 - y) };
            let point = a + (b - a) * u + (c - a) * v;
            let bulge = |side: f32| {
                let edges = [b - a, c - a].map(lane);
                normals::bulge(normals.map(lane), edges, (u, v), lane(ng * side), side).get(0)
            };
            let (depth, height) = (1.0 - point.length(), (point + bulge(1.0)).length() - 1.0);
            assert!(-1e-6 <= height && height <= depth + 1e-6, "{depth} below, {height} above");
            assert_eq!(bulge(-1.0), Vec3::ZERO, "from inside, the ball is concave");
        }
    }
}

#[test]
fn bent_normals_mirror_above_the_surface_and_face_the_ray() {
    let lane = |v: Vec3| math::Vec3::<f32>::splat(v);
    let mut rng = Rng(91);
    for _ in 0..200_000 {
        let own = rng.direction().as_vec3();
        let mut d = rng.direction().as_vec3();
        let mut normal = rng.direction().as_vec3();
        // All angles of arrival, down to grazing ones.
        d = (d - own * d.dot(own)).normalize() - own * rng.scale(1e-5, 10.0) as f32;
        d = d.normalize();
        normal *= normal.dot(own).signum();
        let bent = normals::bend_for_reflection(lane(d), lane(normal), lane(own)).get(0);
        assert!((bent.length() - 1.0).abs() < 1e-5, "{d}, {normal}, {own}: {bent}");
        let mirrored = d - bent * (2.0 * d.dot(bent));
        // Half of the sine of arrival.
        let sine = (-d.dot(own)).max(1e-6);
        let off = 2e-6;
        let least = (0.5 * sine).min(0.01) - off;
        assert!(mirrored.dot(own) >= least, "{d}, {normal}, {own}: {bent}, {}", mirrored.dot(own));
        assert!(bent.dot(d) <= off, "{d}, {normal}, {own}: {bent}");
        // One that need not be bent stays as it is.
        let straight = d - normal * (2.0 * d.dot(normal));
        assert!(straight.dot(own) < 0.0101 || bent == normal);
        let towards = rng.direction().as_vec3();
        let g = normals::shadow_terminator(lane(towards), lane(bent), lane(own));
        assert!((0.0..=1.0).contains(&g) && (towards.dot(own) > 0.0 || g == 0.0), "{g}");
    }
}

#[test]
fn flat_meshes_need_no_smooth_normals() {
    let smooth = smooth_ball(Diffuse);
    assert!(Features::of(&smooth).contains(Features::SMOOTH_NORMALS));
    let flat = Scene { normals: vec![[Vec3::ZERO; 3]; 80], ..smooth.clone() };
    assert!(!Features::of(&flat).meets(Features::SHADING_NORMALS));
    assert!(!Features::of(&Scene { normals: Vec::new(), ..smooth }).meets(Features::SHADING_NORMALS));
    assert_eq!(picture(&flat, 4), picture(&Scene { normals: Vec::new(), ..flat.clone() }, 4));
    assert!(!Features::of(&empty()).meets(Features::SHADING_NORMALS));
}
