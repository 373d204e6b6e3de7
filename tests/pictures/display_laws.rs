//! Laws of what is between a film and a window: tone mapping, blur, smoothed edges, noise removed, the pace
//! of walking.

use crate::common::*;
use octray::display::{Blur, Denoiser, Fxaa, Samples, walking_speed};
use octray::integrate::aovs::Aovs;
use octray::integrate::edge_aovs::DenoiserAovs;
use octray::tone::Operator;

fn picture([width, height]: [u32; 2], pixel: impl FnMut((u32, u32)) -> [f32; 3]) -> Picture {
    Picture { width, height, pixels: places([width, height]).map(pixel).collect() }
}

/// What the denoiser makes of a picture of so many samples.
fn denoised(picture: &Picture, samples: u32, guides: &DenoiserAovs) -> Picture {
    Denoiser::default().filter(picture, Samples::Same(samples), guides).clone()
}

/// The largest difference of two pictures.
fn difference(a: &Picture, b: &Picture) -> f32 {
    let pairs = a.pixels.as_flattened().iter().zip(b.pixels.as_flattened());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

fn grey(value: f32) -> [f32; 3] {
    [value; 3]
}

fn first_hits(scene: &Scene) -> Aovs {
    let mut aovs = Aovs::default();
    Renderer::new(scene, Settings::of(scene)).aovs_into(&mut aovs);
    aovs
}

fn guides(scene: &Scene) -> DenoiserAovs {
    let mut guides = DenoiserAovs::default();
    Renderer::new(scene, Settings::of(scene)).denoiser_aovs_into(&first_hits(scene), &mut guides);
    guides
}

/// The places of pixels at edges.
fn edges(guides: &DenoiserAovs) -> Vec<(u32, u32)> {
    let rows = 0..guides.centers().resolution()[1];
    rows.flat_map(|y| guides.edges(y).iter().map(move |edge| (edge.x, y))).collect()
}

/// The mean square of what a picture has besides a value.
fn noise(picture: &Picture, value: f32) -> f64 {
    let channels = picture.pixels.as_flattened();
    channels.iter().map(|x| f64::from(x - value).powi(2)).sum::<f64>() / channels.len() as f64
}

/// All rows at once, and one after the other: the bits of a filter are the same.
fn assert_same_on_threads<F: Default + Send>(filter: impl Fn(&mut F) -> Picture + Sync) {
    let alone = filter(&mut F::default());
    for threads in [2, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut used = F::default();
        for _ in 0..2 {
            assert_eq!(pool.install(|| filter(&mut used)), alone, "{threads} threads");
        }
    }
}

#[test]
fn blur_is_the_sum_of_nine_and_the_middle_again_over_ten() {
    let picture =
        picture([4, 3], |(x, y)| [(1 + x + 4 * y) as f32, 10.0 * (x * y) as f32, f32::from(x == 3)]);
    let mut blur = Blur::default();
    let shown = blur.filter(&picture);
    // Rows 1 2 3 4, 5 6 7 8, 9 10 11 12 in red.
    assert_eq!(shown.pixels[5][0], (1 + 2 + 3 + 5 + 2 * 6 + 7 + 9 + 10 + 11) as f32 / 10.0);
    let of_nine = (10 + 20 + 20 + 40) as f32 / 10.0;
    assert_eq!(shown.pixels[5][1], of_nine + 1.0, "x·y of nine, and of the middle again");
    // At a corner its own column and row go on.
    assert_eq!(shown.pixels[0][0], (1 + 1 + 2 + 1 + 2 + 2 + 5 + 5 + 6) as f32 / 10.0);
    assert_eq!(shown.pixels[11][0], (7 + 8 + 8 + 11 + 2 * 12 + 12 + 11 + 12 + 12) as f32 / 10.0);
    assert_eq!(shown.pixels[6][2], 0.3);
    assert_eq!(Blur::default().filter(&self::picture([1, 1], |_| grey(0.5))).pixels, [grey(0.5)]);
}

#[test]
fn filters_leave_a_constant_picture_constant() {
    let scene = Scene { resolution: [37, 21], ..empty() };
    let flat = picture(scene.resolution, |_| [0.3, 0.7, 2.5]);
    assert_eq!(Fxaa::default().filter(&flat, &Tone::default()), &flat);
    assert_eq!(denoised(&flat, 1, &guides(&scene)), flat, "the sky stays as it is");
    let near = |shown: &Picture| {
        let pairs = shown.pixels.as_flattened().iter().zip(flat.pixels.as_flattened());
        pairs.into_iter().all(|(a, b)| (a / b - 1.0).abs() < 1e-6)
    };
    assert!(near(Blur::default().filter(&flat)));
    let scene = Scene { resolution: [37, 21], ..floor(Vec3::ZERO, 2.0) };
    assert!(near(&denoised(&flat, 1, &guides(&scene))));
}

#[test]
fn fxaa_keeps_edges_along_rows_and_columns() {
    let size = [32, 24];
    let mut fxaa = Fxaa::default();
    for edge in [
        picture(size, |(x, _)| grey(if x < 13 { 0.1 } else { 0.8 })),
        picture(size, |(_, y)| grey(if y < 7 { 0.9 } else { 0.0 })),
    ] {
        assert_eq!(fxaa.filter(&edge, &Tone::default()), &edge);
    }
}

#[test]
fn fxaa_smooths_a_slanted_edge_towards_what_it_covers() {
    for slope in [0.15f32, 0.25, 0.4] {
        let height = |x: f32| 8.0 + slope * x;
        let size = [48, 32];
        let steps = picture(size, |(x, y)| grey(f32::from(y as f32 + 0.5 > height(x as f32 + 0.5))));
        let covered = picture(size, |(x, y)| {
            let parts = (0..64).filter(|i| {
                let (dx, dy) = ((i % 8) as f32 / 8.0 + 1.0 / 16.0, (i / 8) as f32 / 8.0 + 1.0 / 16.0);
                y as f32 + dy > height(x as f32 + dx)
            });
            grey(parts.count() as f32 / 64.0)
        });
        let mut fxaa = Fxaa::default();
        let smooth = fxaa.filter(&steps, &Tone::default());
        let [error, before] = [smooth, &steps].map(|shown| rmse(shown, &covered).powi(2));
        assert!(error < 0.5 * before, "slope {slope}: {error} of {before}");
        // What is dark to one side is bright to the other: turned upside down, the edge gives the same
        // picture upside down.
        let turned = |of: &Picture| Picture { pixels: of.pixels.iter().rev().copied().collect(), ..*of };
        let again = Fxaa::default().filter(&turned(&steps), &Tone::default()).clone();
        assert!(difference(&turned(smooth), &again) < 1e-5);
    }
}

#[test]
fn fxaa_judges_by_what_is_shown() {
    let dot = picture([9, 9], |place| grey(if place == (4, 4) { 3.0 } else { 2.0 }));
    let mut fxaa = Fxaa::default();
    assert_eq!(fxaa.filter(&dot, &Tone::default()), &dot, "both are white on the screen");
    let dark = Tone { exposure: -2.0, ..Tone::default() };
    assert!(fxaa.filter(&dot, &dark).pixels[40][0] < 2.9);
}

/// Two matt balls of different sizes before a matt wall.
fn balls() -> Scene {
    let wall = floor(Vec3::ZERO, 4.0);
    Scene {
        resolution: [61, 43],
        camera: Camera { vertical_fov: 50.0, ..wall.camera },
        spheres: vec![sphere(vec3(-0.8, 0.5, 0.0), 0.8, 0), sphere(vec3(1.0, 0.8, 0.4), 0.5, 0)],
        ..wall
    }
}

#[test]
fn denoiser_keeps_hard_edges_of_objects_and_removes_noise_on_them() {
    let scene = balls();
    let guides = guides(&scene);
    let levels = |x: u32, y: u32| [0.2, 0.9, 0.5][guides.centers().pixel(x, y).object.min(2) as usize];
    let mut rng = Rng::of("display", [7, 0]);
    let noisy = picture(scene.resolution, |(x, y)| grey(levels(x, y) * (2.0 * rng.unit()) as f32));
    let clean = picture(scene.resolution, |(x, y)| grey(levels(x, y)));
    let shown = denoised(&clean, 1, &guides);
    let mixed = edges(&guides);
    for (place, (a, b)) in places(scene.resolution).zip(shown.pixels.iter().zip(&clean.pixels)) {
        let change = (a[0] / b[0] - 1.0).abs();
        assert!(change < 1e-5 || mixed.contains(&place), "{place:?}: no light crosses an edge");
    }
    let [before, after] = [&noisy, &denoised(&noisy, 1, &guides)].map(|shown| rmse(shown, &clean));
    assert!(after < before / 4.0, "{after} of {before}");
}

/// Two large triangles side by side, left of x = 0.01 and right of it, seen along −z: each by the z of its
/// border and of its tip.
fn two_sides(left: [f32; 2], right: [f32; 2], materials: [u32; 2]) -> Scene {
    let side = |[border, tip]: [f32; 2], x: f32, material| {
        let at = |y, z| vec3(0.01, y, z);
        triangle([at(-90.0, border), at(90.0, border), vec3(x, 0.0, tip)], material)
    };
    Scene {
        resolution: [40, 24],
        materials: vec![material(Diffuse); 2],
        triangles: vec![side(left, -90.0, materials[0]), side(right, 90.0, materials[1])],
        ..empty()
    }
}

#[test]
fn denoiser_stops_at_objects_and_at_normals_and_at_distances() {
    let mut rng = Rng::of("display", [6, 0]);
    for (what, scene) in [
        ("two objects in one plane", two_sides([0.0, 0.0], [0.0, 0.0], [0, 1])),
        ("a corner", two_sides([0.0, 90.0], [0.0, 90.0], [0, 0])),
        ("a step", two_sides([0.0, 0.0], [2.0, 2.0], [0, 0])),
    ] {
        let guides = guides(&scene);
        assert!([1, 38].into_iter().all(|x| guides.centers().pixel(x, 12).distance.is_finite()));
        // One noise on both sides, and a little green on the right one that it hides.
        let noisy = picture(scene.resolution, |(x, _)| {
            [rng.unit() as f32, if x < 20 { 0.0 } else { 0.1 }, rng.unit() as f32]
        });
        let shown = &denoised(&noisy, 1, &guides);
        for (at, (shown, noisy)) in shown.pixels.iter().zip(&noisy.pixels).enumerate() {
            assert!((shown[1] - noisy[1]).abs() < 1e-6, "{what}: pixel {at}, {shown:?}");
        }
        let red =
            |picture: &Picture| picture.pixels.iter().map(|p| f64::from(p[0] - 0.5).powi(2)).sum::<f64>();
        assert!(red(shown) < red(&noisy) / 4.0, "{what}");
    }
}

#[test]
fn denoiser_leaves_many_samples_and_lamps_as_they_are() {
    let mut scene = balls();
    scene.materials.push(lamp(3.0));
    scene.spheres[1].material = 1;
    let guides = guides(&scene);
    let mut rng = Rng::of("display", [9, 0]);
    let noisy = picture(scene.resolution, |_| grey(rng.unit() as f32 + 0.5));
    let mixed = edges(&guides);
    let change = |samples| {
        let shown = denoised(&noisy, samples, &guides);
        let mut changes = [0.0f32; 3];
        for ((x, y), (a, b)) in places(scene.resolution).zip(shown.pixels.iter().zip(&noisy.pixels)) {
            if samples > 1 || !mixed.contains(&(x, y)) {
                let object = guides.centers().pixel(x, y).object;
                let change = &mut changes[object.min(2) as usize];
                *change = change.max((a[0] - b[0]).abs());
            }
        }
        changes
    };
    let [ball, lamp, wall] = change(1);
    assert_eq!(lamp, 0.0, "to the last bit");
    assert!(ball > 0.4 && wall > 0.4);
    // Noise of one in a thousand of what a sample may have, at edges too.
    assert!(change(1_000_000).into_iter().all(|change| change < 0.02));
}

/// A mirror and a glass ball before walls: what they show is filtered with its own guides. Without them their
/// noise would stay: all of it at the mirror's roughness of 0.
#[test]
fn denoiser_filters_what_mirrors_and_glass_show() {
    for kind in [Metal { roughness: 0.0 }, Glass { ior: 1.5 }] {
        let mut scene = balls();
        scene.max_bounces = 6;
        scene.materials.push(material(kind));
        scene.spheres[0].material = 1;
        let (first, guides) = (first_hits(&scene), guides(&scene));
        let at_centers = guides.centers();
        let mut rng = Rng::of("display", [12, 0]);
        let albedo = |(x, y): (u32, u32)| at_centers.pixel(x, y).albedo;
        let clean = picture(scene.resolution, |place| albedo(place).map(|channel| 0.8 * channel));
        let noisy = picture(scene.resolution, |place| {
            let noise = 2.0 * rng.unit() as f32;
            albedo(place).map(|channel| 0.8 * channel * noise)
        });
        let shown = denoised(&noisy, 1, &guides);
        let (mut before, mut after, mut pixels) = (0.0, 0.0, 0);
        for (at, (x, y)) in places(scene.resolution).enumerate() {
            let [shown, noisy] = [&shown, &noisy].map(|picture| picture.pixels[at]);
            let (seen, followed) = (first.pixel(x, y), at_centers.pixel(x, y));
            assert_eq!(seen.object == followed.object, seen.object != 0, "an image is another object");
            if seen.object == 0 && followed.distance.is_finite() {
                assert!(followed.distance > seen.distance && followed.lobe == 1.0);
                let square = |color: [f32; 3]| f64::from(color[0] - clean.pixels[at][0]).powi(2);
                (before, after, pixels) = (before + square(noisy), after + square(shown), pixels + 1);
            }
        }
        assert!(pixels > 100 && after < before / 4.0, "{kind:?}: {after} of {before}, {pixels} pixels");
    }
}

/// Two objects side by side, whose border lies in the middle of a column.
#[test]
fn denoiser_composes_pixels_at_edges_of_what_lies_on_both_sides() {
    let mut scene = two_sides([0.0, 0.0], [0.0, 0.0], [0, 1]);
    let pixel = Renderer::new(&scene, Settings::of(&scene)).camera().pixel_size_at(scene.camera.position.z);
    let aside = Vec3::X * (0.01 + 0.55 * pixel);
    (scene.camera.position, scene.camera.look_at) =
        (scene.camera.position + aside, scene.camera.look_at + aside);
    let guides = guides(&scene);
    let left = guides.centers().pixel(1, 12).object;
    let is_left = |x, y| guides.centers().pixel(x, y).object == left;
    let column = (0..40).find(|&x| !is_left(x, 12)).unwrap();
    let flat = picture(scene.resolution, |(x, y)| grey(if is_left(x, y) { 0.1 } else { 0.9 }));
    let row = |picture: &Picture| {
        [-2, -1, 0, 1].map(|right| picture.pixels[(12 * 40 + column as i32 + right) as usize][0])
    };
    let [outer, before, behind, inner] = row(&denoised(&flat, 1, &guides));
    assert!((outer - 0.1).abs() < 1e-4 && (inner - 0.9).abs() < 1e-4, "{outer} {inner}");
    // The border lies left or right of the centre of one of both pixels, whose points see both sides.
    let mixed = [before, behind].into_iter().filter(|value| (0.2..0.8).contains(value)).count();
    assert_eq!(mixed, 1, "{before} {behind}");
    let many = row(&denoised(&flat, 1_000_000, &guides));
    assert!(many.iter().zip(row(&flat)).all(|(a, b)| (a - b).abs() < 1e-3), "the film's mean: {many:?}");
}

/// Pixels of metal within a quarter of its lobe show nearly the same: at a roughness of 0.2 and 400 rows
/// within four pixels. Smoother metal than 0.17 shows what it reflects: here the sky.
#[test]
fn denoiser_smooths_metal_as_far_as_it_is_rough() {
    let left = |roughness| {
        let metal = material(Metal { roughness });
        let scene = two_sides([-10.0; 2], [-10.0; 2], [0; 2]);
        let guides = guides(&Scene { resolution: [40, 400], materials: vec![metal], ..scene });
        let mut rng = Rng::of("display", [11, 0]);
        let noisy = picture([40, 400], |_| grey(rng.unit() as f32 + 0.5));
        noise(&denoised(&noisy, 1, &guides), 1.0) / noise(&noisy, 1.0)
    };
    let [brushed, rough] = [0.2, 0.5].map(left);
    assert!((0.01..0.1).contains(&brushed) && rough < brushed / 4.0, "{brushed} {rough}");
}

#[test]
fn denoiser_keeps_pictures_on_surfaces_sharp() {
    // Light of one brightness on balls of many colours, which the guides tell.
    let mut scene = balls();
    scene.textures.push(crate::common::noise(&mut Rng::of("display", [4, 0]), 12, 6, Filter::Nearest));
    scene.materials.push(Material { texture: Some(0), ..material(Diffuse) });
    scene.spheres.iter_mut().for_each(|ball| ball.material = 1);
    let guides = guides(&scene);
    let mut rng = Rng::of("display", [3, 0]);
    let albedo = |(x, y): (u32, u32)| guides.centers().pixel(x, y).albedo;
    let mut lit = picture(scene.resolution, |place| albedo(place).map(|channel| 0.8 * channel));
    // At edges the mean of what is in the pixel.
    for y in 0..lit.height {
        for edge in guides.edges(y) {
            let mean = |channel: usize| edge.samples.iter().map(|sample| 0.2 * sample.albedo[channel]).sum();
            lit.pixels[(y * lit.width + edge.x) as usize] = std::array::from_fn(mean);
        }
    }
    let noisy = picture(scene.resolution, |(x, y)| {
        let noise = 2.0 * rng.unit() as f32;
        lit.pixels[(y * lit.width + x) as usize].map(|channel| channel * noise)
    });
    let [unharmed, left] =
        [&lit, &noisy].map(|shown| rmse(&denoised(shown, 1, &guides), &lit) / rmse(&noisy, &lit));
    assert!(unharmed < 0.06, "light that is even on it: {unharmed}");
    assert!(left < 0.5, "{left}");
}

#[test]
fn denoiser_is_the_same_mirrored() {
    let wall = Scene { resolution: [40, 24], ..floor(Vec3::ZERO, 2.0) };
    let guides = guides(&wall);
    let mut rng = Rng::of("display", [5, 0]);
    let noisy = picture([40, 24], |_| [rng.unit() as f32, rng.unit() as f32, 0.5]);
    let mirrored = |of: &Picture| Picture {
        pixels: of.pixels.chunks(40).flat_map(|row| row.iter().rev().copied()).collect(),
        ..*of
    };
    let shown = mirrored(&denoised(&noisy, 1, &guides));
    let worst = difference(&shown, &denoised(&mirrored(&noisy), 1, &guides));
    assert!(worst < 1e-4, "{worst}: distances differ by rounding alone");
    assert!(noise(&shown, 0.5) < noise(&noisy, 0.5) / 2.0, "it did something");
}

#[test]
fn filters_give_the_same_bits_on_any_threads() {
    let scene = balls();
    let guides = guides(&scene);
    let mut rng = Rng::of("display", [11, 0]);
    let noisy = picture(scene.resolution, |_| [rng.unit() as f32, rng.unit() as f32, rng.unit() as f32]);
    assert_same_on_threads(|blur: &mut Blur| blur.filter(&noisy).clone());
    assert_same_on_threads(|fxaa: &mut Fxaa| fxaa.filter(&noisy, &Tone::default()).clone());
    assert_same_on_threads(|denoiser: &mut Denoiser| {
        denoiser.filter(&noisy, Samples::Same(2), &guides).clone()
    });
    // Memory of another size before changes nothing either.
    let mut used = Denoiser::default();
    let large = Scene { resolution: [80, 50], ..balls() };
    used.filter(&picture([80, 50], |_| grey(9.0)), Samples::Same(1), &self::guides(&large));
    let counts = vec![2.0; noisy.pixels.len()];
    assert_eq!(used.filter(&noisy, Samples::Each(&counts), &guides), &denoised(&noisy, 2, &guides));
}

#[test]
fn walking_speed_is_a_quarter_of_the_near_quartile() {
    let speed = |height| walking_speed(&first_hits(&floor(Vec3::ZERO, height)));
    assert!((speed(8.0) / 2.0 - 1.0).abs() < 1e-3, "{}", speed(8.0));
    assert!((speed(800.0) / 200.0 - 1.0).abs() < 1e-3);
    assert_eq!(walking_speed(&first_hits(&empty())), 1.0);
    // A ball twice as near, in less than a quarter of the picture and in more.
    let mut scene = Scene { resolution: [64, 64], ..floor(Vec3::ZERO, 8.0) };
    scene.camera.vertical_fov = 10.0;
    scene.spheres.push(sphere(Vec3::Y * 3.5, 0.5, 0));
    let far = walking_speed(&first_hits(&scene));
    scene.spheres[0] = sphere(Vec3::Y * 3.0, 1.0, 0);
    let near = walking_speed(&first_hits(&scene));
    assert!(far > 1.0 && far < 2.1 && (1.0..1.1).contains(&near), "{near} and {far}");
    // In 22 and 28 hundredths.
    for (radius, pace) in [(0.231, 2.0..2.02), (0.261, 1.2..1.25)] {
        scene.spheres[0] = sphere(Vec3::Y * 3.0, radius, 0);
        let speed = walking_speed(&first_hits(&scene));
        assert!(pace.contains(&speed), "{radius}: {speed}");
    }
}

#[test]
fn operators_rise_from_black_to_white_and_accept_any_number() {
    for operator in Operator::ALL {
        let mut last = 0.0;
        for step in 0..=4_000 {
            let shown = operator.map((step as f32 / 100.0 - 20.0).exp2());
            assert!(shown >= last && shown <= 1.0, "{operator:?} falls or leaves [0, 1] at step {step}");
            last = shown;
        }
        assert_eq!([0.0, -1.0, f32::NEG_INFINITY, f32::NAN].map(|x| operator.map(x)), [0.0; 4]);
        for bright in [last, operator.map(f32::INFINITY), operator.map(f32::MAX)] {
            assert!(bright > 0.999, "{operator:?} ends at {bright}");
        }
    }
}
