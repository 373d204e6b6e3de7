//! Law: leaving out what a tile cannot see changes no hit (conservative culling).

use glam::Vec3;
use octray::buffers::Buffers;
use octray::camera::Pinhole;
use octray::lane::F32x8;
use octray::math::{Hit, Ray};
use octray::sampling::random::mix;
use octray::scene::{Camera, Material, MaterialKind, Scene, Sky, Sphere, Triangle};
use octray::traverse::{Batch, Methods, Primitives, Visible};

const RESOLUTION: [u32; 2] = [64, 48];
const TILE: u32 = 8;

/// A scene of spheres and triangles of all sizes all around the camera, some of which it stands in.
fn scene(seed: u32, camera: Camera) -> Scene {
    let number = |i: u32| f32::from_bits(mix(seed ^ mix(i)) >> 9 | 0x3f80_0000) - 1.0;
    let point = |i: u32| Vec3::new(number(i), number(i + 1), number(i + 2)) * 40.0 - 20.0;
    let size = |i: u32| 10f32.powf(number(i) * 4.0 - 3.0);
    let sphere = |i: u32| Sphere { center: point(8 * i), radius: size(8 * i + 3), material: 0, turn: 0.0 };
    let triangle = |i: u32| {
        let (i, a) = (16 * i + 100_000, point(16 * i + 100_000));
        let side = |j: u32| (point(i + j) / 20.0) * size(i + j + 3);
        Triangle { vertices: [a, a + side(4), a + side(8)], material: 0 }
    };
    Scene {
        name: "random".into(),
        camera,
        resolution: RESOLUTION,
        max_bounces: 1,
        sky: Sky::Color(Vec3::ONE),
        materials: vec![Material {
            name: "clay".into(),
            kind: MaterialKind::Diffuse,
            color: Vec3::ONE,
            texture: None,
            emission: Vec3::ZERO,
        }],
        textures: vec![],
        spheres: (0..60).map(sphere).collect(),
        triangles: (0..60).map(triangle).collect(),
        uvs: vec![],
        normals: vec![],
        warnings: vec![],
    }
}

/// Primary rays to corners, edges and inner points of a tile's pixels, and what they hit.
struct Primary<'a> {
    camera: Pinhole,
    corner: [u32; 2],
    hits: &'a mut Vec<[u32; 4]>,
}

impl Batch<F32x8> for Primary<'_> {
    fn run(self, closest: impl Fn(&Ray<F32x8>) -> Hit<F32x8>) {
        use octray::lane::Lane;
        let steps = [0.0, 0.5, 1.0, 3.25, 4.0, 6.75, 7.0, 8.0];
        for dy in steps {
            let x = F32x8::from_fn(|lane| self.corner[0] as f32 + steps[lane]);
            let y = F32x8::splat(self.corner[1] as f32 + dy);
            let hit = closest(&self.camera.rays(x, y));
            self.hits.extend((0..8).map(|lane| {
                use octray::lane::Bits;
                let bits = |x: F32x8| x.get(lane).to_bits();
                [bits(hit.t), hit.primitive.get(lane), bits(hit.u), bits(hit.v)]
            }));
        }
    }
}

#[test]
fn visible_gives_the_hits_of_testing_everything_bit_for_bit() {
    let cameras = [
        (Vec3::ZERO, Vec3::Z, 40.0),
        (Vec3::new(3.0, -2.0, 5.0), Vec3::X, 1.0),
        (Vec3::ONE, -Vec3::ONE, 150.0),
    ];
    let (mut skipped, mut found) = (0, 0);
    for (seed, (position, towards, vertical_fov)) in
        (1..=12).flat_map(|seed| cameras.map(|camera| (seed, camera)))
    {
        let camera =
            Camera { position, look_at: position + towards, up: Vec3::new(0.1, 1.0, 0.2), vertical_fov };
        let scene = scene(seed, camera);
        let (buffers, primitives) = (Buffers::new(&scene), Primitives::new(&scene, Methods::default()));
        let camera = Pinhole::new(&scene.camera, RESOLUTION);
        for (y, x) in
            (0..RESOLUTION[1]).step_by(8).flat_map(|y| (0..RESOLUTION[0]).step_by(8).map(move |x| (y, x)))
        {
            let visible = Visible::of(&scene, &camera.pyramid([x, y], [TILE, TILE]));
            skipped += 120 - visible.spheres.len() - visible.triangles.len();
            let trace = |visible: Option<&Visible>| {
                let mut hits = Vec::new();
                primitives.for_batch(&buffers, visible, Primary { camera, corner: [x, y], hits: &mut hits });
                hits
            };
            let everything = trace(None);
            assert_eq!(trace(Some(&visible)), everything, "seed {seed}, tile at ({x}, {y})");
            found += everything.iter().filter(|hit| hit[1] != octray::math::MISS).count();
        }
    }
    // The test means something only if much is skipped and much is hit.
    assert!(skipped > 150_000, "only {skipped} of 207,360 tests were skipped");
    assert!(found > 20_000, "only {found} of 110,592 rays hit anything");
}

#[test]
fn visible_keeps_what_the_camera_stands_in_and_drops_what_is_behind() {
    let camera = Camera { position: Vec3::ZERO, look_at: Vec3::NEG_Z, up: Vec3::Y, vertical_fov: 40.0 };
    let mut scene = scene(1, camera);
    let sphere =
        |z: f32, radius: f32| Sphere { center: Vec3::new(0.0, 0.0, z), radius, material: 0, turn: 0.0 };
    scene.spheres = vec![sphere(0.0, 100.0), sphere(5.0, 1.0), sphere(-5.0, 1.0), sphere(5.0, 6.0)];
    scene.triangles.clear();
    let pyramid = Pinhole::new(&camera, RESOLUTION).pyramid([28, 20], [TILE, TILE]);
    assert_eq!(Visible::of(&scene, &pyramid).spheres, [0, 2, 3]);
}
