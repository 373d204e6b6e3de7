//! Rays of an image are traced in blocks of pixels, and have the answers of rays in any other order.

use crate::cases::Rng;
use crate::interface::{BOTH, built, crowd};
use glam::DVec3;
use octray_rays::query::{HitColumns, Intersector, MISS, Rays};
use std::slice::from_ref;

/// In the crowd, which fills the image.
const EYE: [f64; 3] = [0.1, 0.2, 1.5];

/// Rays from one point through the pixels of an image, row by row.
fn image(width: usize, height: usize) -> Vec<[f64; 3]> {
    let direction = |at: usize| {
        let [x, y] = [at % width, at / width].map(|at| at as f64 + 0.5);
        let down = DVec3::new(x / width as f64 - 0.5, y / height as f64 - 0.5, -1.0);
        if width.is_multiple_of(2) { down.normalize() } else { down * 2.0 }.to_array()
    };
    (0..width * height).map(direction).collect()
}

/// Returns the hits of rays one by one, in the order of another permutation.
fn shuffled(
    intersector: &Intersector,
    origins: &[[f64; 3]],
    directions: &[[f64; 3]],
    t_min: &[f64],
) -> HitColumns {
    let count = origins.len();
    // Coprime to all counts, which are products of smaller primes.
    let order: Vec<usize> = (0..count).map(|at| at * 1_000_003 % count).collect();
    let pick = |rows: &[[f64; 3]]| order.iter().map(|&at| rows[at]).collect::<Vec<_>>();
    let (origins, directions) = (pick(origins), pick(directions));
    let t_min: Vec<f64> = order.iter().map(|&at| t_min[at]).collect();
    let found = intersector.closest(&Rays::new(&origins, &directions).after(&t_min)).unwrap();
    let mut hits = found.clone();
    for (from, &to) in order.iter().enumerate() {
        (hits.t[to], hits.u[to], hits.v[to]) = (found.t[from], found.u[from], found.v[from]);
        (hits.surface[to], hits.primitive[to]) = (found.surface[from], found.primitive[from]);
    }
    hits
}

#[test]
fn rays_of_images_have_the_answers_of_rays_in_any_order() {
    let mesh = crowd(&mut Rng(8), 400);
    for precision in BOTH {
        let intersector = built(from_ref(&mesh), precision);
        for (width, height) in [(16, 9), (17, 60), (40, 17), (61, 23), (447, 80), (5000, 4)] {
            let all = image(width, height);
            // Whole images, and parts that begin and end within rows, also one ray behind a group of eight.
            for (first, last) in [
                (0, all.len()),
                (5, all.len() - 3),
                (width - 1, all.len()),
                (width - 2, all.len() - width + 9),
            ] {
                let directions = &all[first..last];
                let origins = vec![EYE; directions.len()];
                for t_min in [0.0, 1.0] {
                    let t_min = vec![t_min; origins.len()];
                    let expected = shuffled(&intersector, &origins, directions, &t_min);
                    let rays = Rays::new(&origins, directions).after(&t_min);
                    assert_eq!(
                        intersector.closest(&rays),
                        Ok(expected.clone()),
                        "{width}×{height} from {first}"
                    );
                    let occluded: Vec<bool> =
                        expected.primitive.iter().map(|&number| number != MISS).collect();
                    assert_eq!(intersector.occluded(&rays), Ok(occluded.clone()));
                    // Most rays at the end of rows hit, too.
                    let ends = (0..height).map(|row| (row + 1) * width - 1 - first);
                    let hits = ends.clone().filter(|&end| occluded.get(end) == Some(&true));
                    assert!(3 * hits.count() > last / width, "{width}×{height}");
                    if t_min[0] == 0.0 {
                        let endless = Rays::new(&origins, directions);
                        assert_eq!(intersector.closest(&endless), Ok(expected));
                    }
                }
            }
        }
    }
}

/// Rays that look like rows of an image at first, and are not.
#[test]
fn rows_that_end_early_or_late_lose_no_ray() {
    let mesh = crowd(&mut Rng(9), 400);
    let even = image(40, 50);
    let uneven: Vec<_> = (0..50).flat_map(|row| even[row * 40..][..40 - row % 2].to_vec()).collect();
    let there_and_back = (0..50).flat_map(|row| {
        let mut row: Vec<_> = even[row * 40..][..40].to_vec();
        row.reverse();
        row
    });
    for directions in [uneven, there_and_back.collect(), vec![even[0]; 500]] {
        for precision in BOTH {
            let intersector = built(from_ref(&mesh), precision);
            let origins = vec![EYE; directions.len()];
            let expected = shuffled(&intersector, &origins, &directions, &vec![0.0; origins.len()]);
            assert_eq!(intersector.closest(&Rays::new(&origins, &directions)), Ok(expected));
        }
    }
}
