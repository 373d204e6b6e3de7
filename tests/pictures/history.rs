//! Laws of temporal reprojection: where points were seen before, what counts, what is forgotten, and that a
//! camera that stands ends at its film.

use crate::common::*;
use octray::camera::PreparedCamera;
use octray::display::History;
use octray::integrate::aovs::Aovs;

const SIZE: [u32; 2] = [64, 40];

/// A camera that renders its scene from place to place.
struct Window {
    scene: Scene,
    renderer: Renderer,
    guides: Aovs,
    seed: u32,
}

impl Window {
    /// Looks from the scene's own camera.
    fn new(scene: Scene) -> Self {
        let renderer = Renderer::new(&scene, Settings { resolution: SIZE, ..Settings::of(&scene) });
        let (camera, guides) = (scene.camera, Aovs::default());
        let mut window = Self { scene, renderer, guides, seed: 0 };
        window.look(camera);
        window
    }
    fn look(&mut self, camera: Camera) {
        self.renderer.set_view(&camera, SIZE, 4);
        self.renderer.aovs_into(&mut self.guides);
    }
    /// The mean of so many samples of a seed of its own.
    fn frame(&mut self, samples: u32) -> Picture {
        self.seed += 1;
        self.renderer.set_seed(self.seed);
        let mut film = self.renderer.film();
        self.renderer.add_samples(&mut film, samples);
        film.picture()
    }
    fn advance<'a>(&self, history: &'a mut History, fresh: &Picture, samples: u32) -> &'a Picture {
        history.reproject(fresh, samples, &self.guides, self.renderer.camera())
    }
}

fn moved(camera: Camera, by: Vec3) -> Camera {
    Camera { position: camera.position + by, look_at: camera.look_at + by, ..camera }
}

fn flat(value: f32) -> Picture {
    Picture { width: SIZE[0], height: SIZE[1], pixels: vec![[value; 3]; (SIZE[0] * SIZE[1]) as usize] }
}

/// A ball before a wall, and the sky above it.
fn scene() -> Scene {
    let wall = [vec3(-60.0, -20.0, -4.0), vec3(60.0, -20.0, -4.0), vec3(0.0, 4.0, -4.0)];
    Scene {
        sky: Sky::Gradient { bottom: Vec3::ONE, top: vec3(0.2, 0.4, 1.0) },
        spheres: vec![sphere(Vec3::ZERO, 1.0, 0)],
        triangles: vec![Triangle { vertices: wall, material: 0 }],
        ..diffuse()
    }
}

#[test]
fn project_inverts_rays() {
    let mut rng = Rng::of("history", [1, 0]);
    for _ in 0..2_000 {
        let [position, look_at] = [(); 2].map(|()| rng.in_cube().as_vec3() * 50.0);
        let mut number = |range: f64| (rng.signed() * range) as f32;
        let (up, vertical_fov) = (vec3(0.1, 1.0, -0.2), 70.0 + number(60.0));
        let camera = Camera::pinhole(position, look_at, up, vertical_fov);
        let pinhole = PreparedCamera::new(&camera, [4_096, 2_160]);
        let x = F32x8::from_fn(|_| 2_048.0 + number(2_048.0));
        let y = F32x8::from_fn(|_| 1_080.0 + number(1_080.0));
        let direction = pinhole.rays(x, y).direction;
        let (u, v, ahead) = pinhole.project(direction * F32x8::splat(10.0 + number(9.0)));
        assert!(ahead.all());
        for lane in 0..8 {
            let off = (u.get(lane) - x.get(lane)).abs().max((v.get(lane) - y.get(lane)).abs());
            // Four times what was measured.
            assert!(off < 4e-3, "{off} of a pixel, {camera:?}");
        }
        assert!(!pinhole.project(-direction).2.any(), "behind the camera");
    }
}

#[test]
fn history_of_a_camera_that_stands_is_the_mean_of_its_frames() {
    let (mut window, mut history) = (Window::new(scene()), History::default());
    let mut sum = vec![0.0f64; flat(0.0).pixels.as_flattened().len()];
    for number in 1..=10 {
        let fresh = window.frame(2);
        let shown = window.advance(&mut history, &fresh, 2);
        for (sum, x) in sum.iter_mut().zip(fresh.pixels.as_flattened()) {
            *sum += f64::from(*x);
        }
        let off = |(at, shown): (usize, &f32)| {
            let x = at / 3;
            let sky = window.guides.pixel(x as u32 % SIZE[0], x as u32 / SIZE[0]).distance.is_infinite();
            let off = (f64::from(*shown) - sum[at] / f64::from(number)).abs();
            if sky { [0.0, off] } else { [off, 0.0] }
        };
        let worse = |a: [f64; 2], b: [f64; 2]| [a[0].max(b[0]), a[1].max(b[1])];
        let [surface, sky] = shown.pixels.as_flattened().iter().enumerate().map(off).fold([0.0; 2], worse);
        // Where a place is rounded to 1e-5 of a pixel beside its own, a little of the neighbour comes in.
        assert!(surface < 2e-3, "{surface}");
        // Pixels of the sky at silhouettes are kept within what those around show at the moment.
        assert!(sky < 0.1, "{sky}");
        assert!(history.counts().iter().all(|&count| (count - (2 * number) as f32).abs() < 1e-2));
    }
}

#[test]
fn history_follows_points_and_not_pixels() {
    // What is shown depends on the point alone: a picture of places on the wall and the ball.
    let mut window = Window::new(scene());
    let paint = |window: &Window| {
        let (guides, camera) = (&window.guides, window.renderer.camera());
        let pixels = places(SIZE).map(|(x, y)| {
            let ray = camera.rays(x as f32 + 0.5, y as f32 + 0.5);
            let guide = guides.pixel(x, y);
            let (ball, sky) = (guide.object == 0, guide.distance.is_infinite());
            let point = if sky { ray.direction.get(0) * 5.0 } else { ray.at(guide.distance).get(0) };
            [point.x + 10.0, point.y + 10.0, if ball { 1.0 } else { 0.0 }]
        });
        Picture { pixels: pixels.collect(), ..flat(0.0) }
    };
    let (mut history, mut sum) = (History::default(), 0.0);
    for frame in 0..20 {
        window.look(moved(window.scene.camera, vec3(0.03, 0.01, -0.04) * frame as f32));
        let fresh = paint(&window);
        let shown = window.advance(&mut history, &fresh, 1);
        for (at, (shown, fresh)) in shown.pixels.iter().zip(&fresh.pixels).enumerate() {
            let mixed = (shown[2] - fresh[2]).abs();
            assert!(mixed < 1e-4, "nothing of the ball on the wall, nor of the wall on the ball: {mixed}");
            let guide = window.guides.pixel(at as u32 % SIZE[0], at as u32 / SIZE[0]);
            if guide.object != 0 {
                let off = (shown[0] - fresh[0]).abs().max((shown[1] - fresh[1]).abs());
                // Where taps are missing, at borders and silhouettes, the others stand for them, frame after
                // frame; a pixel is 0.2 of a unit on the wall.
                assert!(off < 0.4, "pixel {at} of frame {frame}: {off}");
                sum += f64::from(off);
            }
        }
    }
    let mean = sum / f64::from(20 * SIZE[0] * SIZE[1]);
    assert!(mean < 0.01, "everywhere else it is where it should be: {mean}");
    let old = history.counts().iter().filter(|&&count| count > 15.0).count();
    assert!(old > history.counts().len() / 2, "{old}");
    assert!(history.counts().contains(&1.0), "what came into view is new");
}

#[test]
fn history_ends_at_other_objects_normals_and_planes() {
    let (window, mut history) = (Window::new(scene()), History::default());
    window.advance(&mut history, &flat(1.0), 8);
    // The ball is a step nearer and larger: its silhouette, its distances, its normals are others; the wall's
    // are not.
    let mut nearer = scene();
    nearer.spheres[0] = sphere(vec3(0.4, 0.0, 0.7), 1.1, 0);
    let window = Window::new(nearer);
    let shown = window.advance(&mut history, &flat(0.0), 1);
    let mut kept = [0; 2];
    for (at, pixel) in shown.pixels.iter().enumerate() {
        let ball = window.guides.pixel(at as u32 % SIZE[0], at as u32 / SIZE[0]).object == 0;
        kept[usize::from(ball)] += usize::from(pixel[0] > 0.0);
        assert!(pixel[0] == 0.0 || (pixel[0] - 8.0 / 9.0).abs() < 1e-3 || ball, "{pixel:?}");
    }
    assert!(kept[0] > 1_000 && kept[1] < 40, "{kept:?}");
    history.reset();
    assert_eq!(window.advance(&mut history, &flat(0.25), 1), &flat(0.25));

    // The same plane: of the same object, whose normals turn by so much of a right angle, and of another one.
    let kept = [(0.1f32, 0), (0.7, 0), (0.0, 1)].map(|(turn, material)| {
        let wall = |normal: Vec3, material: u32| Scene {
            triangles: vec![triangle(
                [vec3(-60.0, -60.0, 0.0), vec3(60.0, -60.0, 0.0), vec3(0.0, 60.0, 0.0)],
                material,
            )],
            normals: vec![[normal; 3]],
            materials: vec![self::material(Diffuse); 2],
            ..diffuse()
        };
        let mut history = History::default();
        let turned = vec3(turn.sin(), 0.0, turn.cos());
        for (normal, material, value) in [(Vec3::Z, 0, 1.0), (turned, material, 0.0)] {
            Window::new(wall(normal, material)).advance(&mut history, &flat(value), 1);
        }
        history.counts().iter().filter(|&&count| count > 1.0).count()
    });
    assert_eq!(kept, [flat(0.0).pixels.len(), 0, 0]);
}

/// Pixels of the sky at the edge of a lamp hold some of its light: who passes by is not to see it drawn
/// along.
#[test]
fn nothing_of_a_lamp_stays_in_the_sky_behind_it() {
    let mut history = History::default();
    let mut window = Window::new(Scene {
        sky: Sky::Color(Vec3::splat(0.25)),
        materials: vec![lamp(40.0)],
        spheres: vec![sphere(Vec3::ZERO, 1.0, 0)],
        ..empty()
    });
    let mut sky = 0;
    for (way, frame) in
        [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y].iter().flat_map(|way| (0..12).map(move |at| (way, at)))
    {
        if frame == 0 {
            history.reset();
        }
        window.look(moved(window.scene.camera, way * 0.04 * frame as f32));
        let fresh = window.frame(4);
        let shown = window.advance(&mut history, &fresh, 4);
        let [width, height] = SIZE.map(|side| side as i32);
        for (x, y) in places(SIZE).map(|(x, y)| (x as i32, y as i32)) {
            let pixel = |x: i32, y: i32| (x.clamp(0, width - 1) + y.clamp(0, height - 1) * width) as usize;
            let around = (-1..=1).flat_map(|down| (-1..=1).map(move |right| pixel(x + right, y + down)));
            // Nothing but sky anywhere near.
            if around.clone().all(|at| fresh.pixels[at] == [0.25; 3]) {
                assert_eq!(shown.pixels[pixel(x, y)], [0.25; 3], "pixel {x}, {y} of frame {frame}");
                sky += 1;
            }
        }
    }
    assert!(sky > 48 * 1_000, "{sky}");
}

#[test]
fn history_forgets_sooner_on_mirrors() {
    let count = |roughness| {
        let mut scene = scene();
        scene.materials.push(material(Metal { roughness }));
        scene.spheres[0].material = 1;
        let (window, mut history) = (Window::new(scene), History::default());
        for _ in 0..100 {
            window.advance(&mut history, &flat(1.0), 1);
        }
        let counts = history.counts();
        (counts[(SIZE[0] * 20 + 32) as usize], counts[(SIZE[0] * 20 + 2) as usize])
    };
    let [mirror, brushed, wall] = [count(0.0).0, count(0.1).0, count(0.0).1];
    assert!(mirror < brushed && brushed < wall, "{mirror}, {brushed}, {wall}");
    assert_eq!((mirror, wall), (9.0, 33.0));
    // 8 and 64 times the square of the roughness, and the fresh sample.
    assert_eq!(count(0.5).0, 25.0);
}

#[test]
fn a_camera_that_stands_ends_at_the_mean_of_its_film() {
    let (mut window, mut history) = (Window::new(scene()), History::default());
    for _ in 0..8 {
        window.advance(&mut history, &flat(1.0), 1);
    }
    let mut last = f32::INFINITY;
    for samples in [1, 4, 16, 48, 63] {
        let shown = history.blend_static(&flat(0.0), samples).pixels[777][0];
        assert!(shown < last && shown > 0.0, "{shown} after {samples}");
        last = shown;
    }
    assert!(last < 0.01, "next to nothing before the end: {last}");
    let film = window.frame(64);
    assert_eq!(history.blend_static(&film, 64), &film, "bit by bit");
    assert!(history.counts().iter().all(|&count| count == 64.0));
    assert_eq!(history.blend_static(&film, 5_000), &film);
    // It moves on with what it has seen standing, and does not remember the film again.
    let shown = window.advance(&mut history, &film, 1);
    let differs = shown.pixels.as_flattened().iter().zip(film.pixels.as_flattened());
    assert!(differs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max) < 2e-3);
    assert!(history.counts()[1_000] > 32.0);
    let none = &mut History::default();
    assert_eq!(none.blend_static(&film, 1), &film, "nothing was known");
}

#[test]
fn history_starts_anew_in_another_resolution_and_gives_the_same_bits_on_any_threads() {
    let shown = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut window = Window::new(scene());
        let mut history = History::default();
        let mut other = Aovs::default();
        other.resize([40, SIZE[0]]);
        let turned = Picture { width: 40, height: SIZE[0], ..flat(9.0) };
        history.reproject(&turned, 1, &other, window.renderer.camera());
        for frame in 0..6 {
            window.look(moved(window.scene.camera, Vec3::X * 0.05 * frame as f32));
            let fresh = window.frame(1);
            let camera = *window.renderer.camera();
            match threads {
                1 => history.reproject(&fresh, 1, &window.guides, &camera),
                _ => pool.install(|| history.reproject(&fresh, 1, &window.guides, &camera)),
            };
        }
        (history.blend_static(&flat(0.5), 3).clone(), history.counts().to_vec())
    };
    let alone = shown(1);
    assert!(alone.0.pixels.as_flattened().iter().all(|&x| x < 4.0), "nothing of the other size");
    assert_eq!(shown(3), alone);
}
