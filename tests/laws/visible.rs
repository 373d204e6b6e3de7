//! Law: leaving out what a tile cannot see changes no hit (conservative culling).

use crate::common::rays::Set;
use crate::common::*;
use octray::camera::PreparedCamera;
use octray::math::ViewFrustum;
use octray::rays::{Candidates, Kind};
use octray::sampling::random::mix_bits;

const RESOLUTION: [u32; 2] = [64, 48];
const TILE: u32 = 8;

/// A scene of spheres and triangles of all sizes all around the camera, some of which it stands in.
fn scene(seed: u32, camera: Camera) -> Scene {
    let number = |i: u32| f32::from_bits(mix_bits(seed ^ mix_bits(i)) >> 9 | 0x3f80_0000) - 1.0;
    let point = |i: u32| vec3(number(i), number(i + 1), number(i + 2)) * 40.0 - 20.0;
    let size = |i: u32| 10f32.powf(number(i) * 4.0 - 3.0);
    let ball = |i: u32| sphere(point(8 * i), size(8 * i + 3), 0);
    let triangle = |i: u32| {
        let (i, a) = (16 * i + 100_000, point(16 * i + 100_000));
        let side = |j: u32| (point(i + j) / 20.0) * size(i + j + 3);
        Triangle { vertices: [a, a + side(4), a + side(8)], material: 0 }
    };
    Scene {
        camera,
        spheres: (0..60).map(ball).collect(),
        triangles: (0..60).map(triangle).collect(),
        ..diffuse()
    }
}

/// Primary rays to corners, edges and inner points of a tile's pixels.
fn primary_rays(camera: &PreparedCamera, [x, y]: [u32; 2]) -> Set {
    let steps = [0.0, 0.5, 1.0, 3.25, 4.0, 6.75, 7.0, 8.0];
    let points = steps.iter().flat_map(|dy| steps.map(|dx| (x as f32 + dx, y as f32 + dy)));
    Set::of(&points.map(|(x, y)| camera.rays(x, y)).collect::<Vec<_>>())
}

/// The primitives that are not outside of a frustum.
fn visible(scene: &Scene, frustum: &ViewFrustum) -> Candidates {
    let mut found = Candidates::default();
    scene.geometry().find_in_frustum(&mut found, frustum);
    found
}

#[test]
fn visible_gives_the_hits_of_testing_everything_bit_for_bit() {
    let cameras =
        [(Vec3::ZERO, Vec3::Z, 40.0), (vec3(3.0, -2.0, 5.0), Vec3::X, 1.0), (Vec3::ONE, -Vec3::ONE, 150.0)];
    let (mut skipped, mut found, mut empty_lists) = (0, 0, 0);
    for (seed, (position, towards, vertical_fov)) in
        (1..=12).flat_map(|seed| cameras.map(|camera| (seed, camera)))
    {
        let camera = Camera::pinhole(position, position + towards, vec3(0.1, 1.0, 0.2), vertical_fov);
        let scene = scene(seed, camera);
        let list = List::new(&scene.geometry());
        let camera = PreparedCamera::new(&scene.camera, RESOLUTION);
        for (y, x) in
            (0..RESOLUTION[1]).step_by(8).flat_map(|y| (0..RESOLUTION[0]).step_by(8).map(move |x| (y, x)))
        {
            let visible = visible(&scene, &camera.view_frustum([x, y], [TILE, TILE]));
            let listed = visible.len();
            skipped += 120 - listed;
            empty_lists += usize::from(listed == 0);
            let rays = primary_rays(&camera, [x, y]);
            let trace = |visible: Option<&Candidates>| rays.nearest::<F32x8>(&list, visible);
            let everything = trace(None);
            assert_eq!(trace(Some(&visible)), everything, "seed {seed}, tile at ({x}, {y})");
            found += everything.iter().filter(|hit| hit[1] != octray::math::MISS).count();
        }
    }
    // The test means something only if much is skipped and much is hit.
    assert!(skipped > 150_000, "only {skipped} of 207,360 tests were skipped");
    assert!(found > 20_000, "only {found} of 110,592 rays hit anything");
    assert!(empty_lists > 10, "{empty_lists} of 1,728 tiles see nothing");
}

/// Primary rays through the four edges of a tile, as rounding leaves them.
fn edge_rays(camera: &PreparedCamera, [x, y]: [u32; 2]) -> [Vec<Ray<f32>>; 4] {
    let (left, top, side) = (x as f32, y as f32, TILE as f32);
    let edge = |from: [f32; 2], step: [f32; 2]| {
        let steps = (0..=64).map(|i| i as f32 / 64.0 * side);
        steps.map(|s| camera.rays(from[0] + s * step[0], from[1] + s * step[1])).collect()
    };
    let (right, bottom) = (left + side, top + side);
    [
        edge([left, top], [1.0, 0.0]),
        edge([left, bottom], [1.0, 0.0]),
        edge([left, top], [0.0, 1.0]),
        edge([right, top], [0.0, 1.0]),
    ]
}

/// Puts specks on the rays through a tile's edges and triangles between them that lie beside the tile, and
/// asserts that culling keeps whatever is hit. Returns how many rays hit a sphere and how many a triangle,
/// each tried alone.
fn edges_are_kept(view: Camera, resolution: [u32; 2], corner: [u32; 2]) -> [usize; 2] {
    // A power of two, so that points lie exactly on their rays, and specks smaller than most rays stray (half
    // a rounding or so).
    const AWAY: f32 = 8.0;
    const SPECK: f32 = 1e-7;
    let camera = PreparedCamera::new(&view, resolution);
    let edges = edge_rays(&camera, corner);
    let point = |ray: &Ray<f32>| ray.at(AWAY).get(0);
    let middle = camera.rays(corner[0] as f32 + TILE as f32 / 2.0, corner[1] as f32 + TILE as f32 / 2.0);
    let materials = vec![material(Diffuse)];
    let mut specks = Scene { camera: view, materials, ..empty() };
    let mut beside = specks.clone();
    for edge in &edges {
        specks.spheres.extend(edge.iter().map(|ray| sphere(point(ray), SPECK, 0)));
        for pair in edge.windows(4) {
            let [a, b] = [point(&pair[0]), point(&pair[3])];
            let outwards = (a + b - 2.0 * point(&middle)).normalize();
            if (b - a).cross(outwards).length() > 0.0 {
                beside.triangles.push(triangle([a, b, a + outwards], 0));
            }
        }
    }
    let rays = Set::of(&edges.into_iter().flatten().collect::<Vec<Ray<f32>>>());
    [specks, beside].map(|scene| {
        let visible = visible(&scene, &camera.view_frustum(corner, [TILE, TILE]));
        let list = List::new(&scene.geometry());
        let trace = |visible: Option<&Candidates>| rays.nearest::<f32>(&list, visible);
        let everything = trace(None);
        assert_eq!(trace(Some(&visible)), everything, "{view:?}, tile at {corner:?}");
        everything.iter().filter(|&&[_, primitive, ..]| primitive != octray::math::MISS).count()
    })
}

/// Directions all around, none along an axis.
fn views(vertical_fov: f32) -> impl Iterator<Item = Camera> {
    let mut rng = Rng(71);
    (0..8).map(move |_| {
        let look_at = rng.direction().as_vec3();
        Camera::pinhole(Vec3::ZERO, look_at, rng.direction().as_vec3(), vertical_fov)
    })
}

/// Pixels are not much larger than the rounding of a direction: what keeps the hits is the frustum's own
/// margin.
#[test]
fn visible_keeps_what_edge_rays_of_a_narrow_view_hit() {
    for fov in [1e-2, 1e-3, 1e-4] {
        let hits = views(fov).map(|view| edges_are_kept(view, RESOLUTION, [24, 16]));
        let [spheres, triangles] = hits.fold([0, 0], |[a, b], [c, d]| [a + c, b + d]);
        assert!(spheres > 100 && triangles > 100, "{fov}: only {spheres} and {triangles} hits");
    }
}

/// In the middle of a very wide picture, directions are small differences of long vectors: what keeps the
/// hits is the share of a pixel that the camera adds.
#[test]
fn visible_keeps_what_edge_rays_of_a_wide_view_hit() {
    for (fov, resolution) in [(179.9, RESOLUTION), (179.99, [1000, 1000]), (179.99, [16_384, 16_384])] {
        let middle = resolution.map(|side| side / 2);
        let beside = middle.map(|side| side - TILE);
        let tiles = [middle, beside, [middle[0], beside[1]]];
        let hits = views(fov).flat_map(|view| tiles.map(|tile| edges_are_kept(view, resolution, tile)));
        let [spheres, triangles] = hits.fold([0, 0], |[a, b], [c, d]| [a + c, b + d]);
        assert!(spheres > 300 && triangles > 300, "{fov}: only {spheres} and {triangles} hits");
    }
}

/// Tiles change no bit for any choice of equations, also where an equation claims hits far outside its
/// primitive: a tile that sees only what is there would lose them.
#[test]
fn visible_is_not_used_where_equations_stray_from_their_primitives() {
    let camera = camera(Vec3::Z * 2e4, Vec3::ZERO, 0.1);
    let scene = Scene { camera, spheres: vec![sphere(vec3(0.2, 0.1, 0.0), 1.0, 0)], ..diffuse() };
    let hits = |sphere, tile_size| {
        let methods = Methods { sphere, ..Methods::default() };
        let settings = Settings { resolution: [32, 32], methods, tile_size, ..Settings::of(&scene) };
        let mut hits = methods::renderer(&scene, settings).primary_hits(0);
        hits.sort_by_key(|hit| (hit.y, hit.x));
        hits
    };
    for sphere in SphereChoice::ALL {
        assert!(hits(sphere, [16, 16]) == hits(sphere, [2, 2]), "{sphere:?}: the tiles show in the hits");
    }
    // The test means something only if the naive equation does stray here.
    let count = |sphere| hits(sphere, [16, 16]).iter().filter(|hit| hit.primitive == 0).count();
    let [robust, naive] = [SphereChoice::Robust, SphereChoice::Naive].map(count);
    assert!(naive > 2 * robust, "{naive} naive hits, {robust} robust ones");
}

#[test]
fn visible_keeps_what_the_camera_stands_in_and_drops_what_is_behind() {
    let camera = camera(Vec3::ZERO, Vec3::NEG_Z, 40.0);
    let mut scene = scene(1, camera);
    let ball = |z: f32, radius: f32| sphere(Vec3::Z * z, radius, 0);
    scene.spheres = vec![ball(0.0, 100.0), ball(5.0, 1.0), ball(-5.0, 1.0), ball(5.0, 6.0)];
    scene.triangles.clear();
    let frustum = PreparedCamera::new(&camera, RESOLUTION).view_frustum([28, 20], [TILE, TILE]);
    assert_eq!(visible(&scene, &frustum).of_kind(Kind::Sphere), [0, 2, 3]);
}
