//! The law of smooth normals: they bend what a surface does, and let no light through it, nor a ray.

use crate::common::*;
use octray::kernel::normals;

fn furnace(kind: MaterialKind) -> Scene {
    let mut scene = smooth_ball(kind);
    scene.materials[0].color = Vec3::ONE;
    Scene { sky: Sky::Color(Vec3::ONE), ..scene }
}

fn picture(scene: &Scene, max_bounces: u32) -> Vec<[f32; 3]> {
    let settings = Settings { resolution: [60, 40], max_bounces, seed: 4, ..Settings::of(scene) };
    render(scene, settings, 64).pixels
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
fn white_furnace_of_a_smooth_ball_loses_nothing() {
    for kind in KINDS {
        let [smooth, flat] = [furnace(kind), Scene { normals: Vec::new(), ..furnace(kind) }];
        let [smooth, flat] = [smooth, flat].map(|scene| covered(&scene, &picture(&scene, 64)));
        // What flat triangles lose belongs to the lobe.
        assert!(smooth <= 1.003, "{kind:?} makes light: {smooth}");
        let most = if matches!(kind, Glass { .. }) { 1e-4 } else { 2e-3 };
        assert!(flat - smooth <= most, "{kind:?} loses {:.5}", flat - smooth);
    }
}

/// White, with a normal that a map tilts by so many degrees towards x, seen at so many degrees from that
/// side, from above or from below.
fn tilted(kind: MaterialKind, [tilt, view]: [f32; 2], side: f32) -> Scene {
    let from = |degrees: f32| vec3(degrees.to_radians().sin(), degrees.to_radians().cos() * side, 0.0);
    let texel = from(tilt) * 0.5 + 0.5;
    let map = Texels::Float32(vec![[texel.x, 0.5, 0.5 + 0.5 * from(tilt).y.abs(), 0.0]]);
    Scene {
        camera: camera(from(view) * 5.0 + vec3(0.0, 0.0, 1e-3), Vec3::ZERO, 2.0),
        resolution: [8, 8],
        materials: vec![Material { normal_map: Some(0), ..material(kind) }],
        textures: vec![texture([1, 1], Filter::Nearest, map)],
        triangles: vec![triangle(ground(5.0, 0.0), 0)],
        uvs: vec![ground(5.0, 0.0).map(|corner| vec2(corner.x, corner.z))],
        max_bounces: 1,
        ..empty()
    }
}

const VIEWS: [f32; 6] = [0.0, 20.0, -20.0, 60.0, -60.0, -80.0];

fn brightness(scene: &Scene) -> f64 {
    mean(&render(scene, Settings { seed: 3, ..Settings::of(scene) }, 64))
}

#[test]
fn white_furnace_of_tilted_normals_keeps_what_every_lobe_must() {
    let metals = [0.0, 0.001, 0.02, 0.2, 0.5, 1.0].map(|roughness| Metal { roughness });
    let rough = [0.05, 0.5].map(|roughness| MetalRough { roughness, metallic: 1.0, ior: 1.5 });
    let coats = [0.0, 0.3, 0.8].map(|roughness| Plastic { roughness, ior: 1.0001 });
    for [tilt, view] in [5.0, 15.0, 30.0, 60.0].into_iter().flat_map(|tilt| VIEWS.map(|view| [tilt, view])) {
        for side in [1.0, -1.0] {
            for kind in metals.into_iter().chain(rough) {
                let kept = brightness(&tilted(kind, [tilt, view], side));
                assert!((0.975..1.006).contains(&kept), "{kind:?}, {tilt}° from {view}°, {side}: {kept}");
            }
            let closed = f64::midpoint(1.0, f64::from(tilt.to_radians().cos()));
            for kind in coats.into_iter().chain([Diffuse]) {
                let kept = brightness(&tilted(kind, [tilt, view], side));
                assert!((kept / closed - 1.0).abs() < 0.02, "{kind:?}, {tilt}° from {view}°, {side}: {kept}");
            }
        }
    }
}

/// A lamp at 30° lights a base tilted by 60°, from every view and under every coat, as Lambert's law says.
#[test]
fn base_is_that_of_diffuse_materials_from_every_view() {
    let coats = [0.0, 0.5].map(|roughness| Plastic { roughness, ior: 1.0001 });
    for kind in coats.into_iter().chain([Diffuse, MetalRough { roughness: 0.7, metallic: 0.0, ior: 1.0 }]) {
        for view in VIEWS {
            let mut scene = Scene { sky: Sky::Color(Vec3::ZERO), ..tilted(kind, [60.0, view], 1.0) };
            scene.materials.push(lamp(3000.0));
            scene.spheres.push(sphere(60.0 * vec3(0.5, 0.75_f32.sqrt(), 0.0), 1.0, 1));
            let found = brightness(&scene);
            // Of metal-rough the share that grazing light has of it, by Schlick.
            let most = if matches!(kind, MetalRough { .. }) { 0.08 } else { 0.01 };
            let lambert = 3000.0 / 3600.0 * 0.75_f64.sqrt();
            assert!((found / lambert - 1.0).abs() < most, "{kind:?} from {view}°: {found}, {lambert}");
        }
    }
}

/// Between a mirror and the lobes just not narrow enough to be one nothing changes.
#[test]
fn reflections_in_tilted_normals_are_continuous_as_roughness_vanishes() {
    let sky = Sky::Gradient { bottom: Vec3::ZERO, top: Vec3::ONE };
    for [tilt, view] in [15.0, 30.0, 60.0].into_iter().flat_map(|tilt| VIEWS.map(|view| [tilt, view])) {
        let [mirror, narrow, wider] = [0.0, 0.01, 0.02]
            .map(|roughness| brightness(&Scene { sky, ..tilted(Metal { roughness }, [tilt, view], 1.0) }));
        assert!((mirror - narrow).abs().max((mirror - wider).abs()) < 2e-3, "{tilt}° from {view}°");
    }
}

/// A light inside a closed body is not seen outside: no ray that leaves the body starts inside.
#[test]
fn nothing_leaves_below_the_surface() {
    for kind in KINDS.into_iter().filter(|&kind| !material(kind).is_clear()) {
        let dark = furnace(kind);
        let mut lit = dark.clone();
        lit.materials.push(lamp(1e6));
        lit.spheres.push(sphere(Vec3::ZERO, 0.7, 1));
        let [dark, lit] = [dark, lit].map(|scene| {
            let by_chance = with_lights(&scene, LightChoice::Off);
            let settings = Settings { resolution: [60, 40], max_bounces: 9, seed: 4, ..by_chance };
            render(&scene, settings, 64).pixels
        });
        assert!(dark == lit, "{kind:?}");
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
    let [ball, round] = [smooth_ball, round_ball].map(|ball| picture(&lit(ball(Diffuse)), 1));
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
fn flat_meshes_need_no_smooth_normals() {
    let smooth = smooth_ball(Diffuse);
    assert!(Features::of(&smooth).contains(Features::SMOOTH_NORMALS));
    let flat = Scene { normals: vec![[Vec3::ZERO; 3]; 80], ..smooth.clone() };
    assert!(!Features::of(&flat).meets(Features::SHADING_NORMALS));
    assert!(!Features::of(&Scene { normals: Vec::new(), ..smooth }).meets(Features::SHADING_NORMALS));
    assert_eq!(picture(&flat, 4), picture(&Scene { normals: Vec::new(), ..flat.clone() }, 4));
    assert!(!Features::of(&empty()).meets(Features::SHADING_NORMALS));
}
