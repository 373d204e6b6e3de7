//! The law of ray and triangle: away from edges every method agrees with f64; limits, directions that are
//! none, rays in the plane. `tests/pictures/stability.rs` tests which methods leak,
//! `tests/laws/watertight.rs` that traversals do not.

use crate::common::*;
use glam::Vec3Swizzles;
use octray::kernel::ray_triangle::{PairHit, TriangleHit, WoopRay, WoopTriangle};
use octray::measure::stability::triangles::{intersect, reference_tuv, well_shaped};
use octray::methods::{BaldwinWeber, MollerTrumbore, MollerTrumboreEpsilon, Plucker, Woop, WoopContracted};

/// Calls a function with each method as its type parameter.
macro_rules! for_every_method {
    ($check:ident) => {
        $check::<Woop>();
        $check::<WoopContracted>();
        $check::<MollerTrumbore>();
        $check::<MollerTrumboreEpsilon>();
        $check::<BaldwinWeber>();
        $check::<Plucker>();
    };
}

/// Away from edges every method agrees with f64: hit or miss, t, u and v within `bound` times the largest
/// length involved. Returns the largest error in these units and how many rays hit.
fn agrees<T: TriangleMethod>(center: DVec3, distance: f64, bound: f64) -> (f64, usize) {
    let mut rng = Rng(12);
    let (mut worst, mut hits) = (0.0_f64, 0);
    let largest = distance + center.abs().max_element() + 1.0;
    let margin = bound * largest;
    for _ in 0..20_000 {
        let (triangle, ray) = well_shaped(&mut rng, center, distance, 1.0);
        let [t, u, v] = reference_tuv(triangle, &ray);
        let inside = u.min(v).min(1.0 - u - v);
        let found = intersect::<T>(triangle, &ray, f32::INFINITY);
        if inside > margin {
            let found = found.unwrap_or_else(|| panic!("missed {triangle:?} with {ray:?}"));
            let errors = [0, 1, 2].map(|i| (f64::from(found[i]) - [t, u, v][i]).abs());
            worst = errors.into_iter().fold(worst, f64::max);
            hits += 1;
        } else if inside < -margin {
            assert_eq!(found, None, "hit {triangle:?} with {ray:?}");
        }
    }
    (worst / largest, hits)
}

/// ε is half the distance from 1 to the next float.
const EPSILON: f64 = 1.0 / (1 << 24) as f64;

#[test]
fn all_methods_agree_with_f64_away_from_edges() {
    for (center, distance) in [(DVec3::ZERO, 3.0), (dvec3(20.0, -30.0, 10.0), 5.0), (DVec3::ZERO, 300.0)] {
        // A few roundings, which heights above 0.3 and angles below 70° magnify by some ten times at most;
        // measured: 3 to 10 ε.
        let bound = 30.0 * EPSILON;
        let all = [
            agrees::<Woop>(center, distance, bound),
            agrees::<WoopContracted>(center, distance, bound),
            agrees::<MollerTrumbore>(center, distance, bound),
            agrees::<MollerTrumboreEpsilon>(center, distance, bound),
            agrees::<BaldwinWeber>(center, distance, bound),
            agrees::<Plucker>(center, distance, bound),
        ];
        for (worst, hits) in all {
            assert!(worst <= bound && hits > 2000, "{center}, {distance}: {all:?}, bound {bound:e}");
        }
    }
}

#[test]
fn barycentrics_and_t_name_the_same_point() {
    fn check<T: TriangleMethod>() {
        let mut rng = Rng(13);
        let mut hits = 0;
        for _ in 0..20_000 {
            let (triangle, ray) = well_shaped(&mut rng, DVec3::ZERO, 3.0, 1.0);
            let Some([t, u, v]) = intersect::<T>(triangle, &ray, f32::INFINITY) else { continue };
            let [a, b, c] = triangle.map(|vertex| vertex.as_dvec3());
            let [t, u, v] = [t, u, v].map(f64::from);
            let on_triangle = a + (b - a) * u + (c - a) * v;
            let on_ray = ray.origin.get(0).as_dvec3() + ray.direction.get(0).as_dvec3() * t;
            assert!((on_triangle - on_ray).length() < 30.0 * 4.0 * EPSILON, "{triangle:?}, {ray:?}");
            assert!(u >= -1e-6 && v >= -1e-6 && u + v <= 1.0 + 1e-6, "{u} {v}");
            hits += 1;
        }
        assert!(hits > 2000);
    }
    for_every_method!(check);
}

#[test]
fn zero_and_nan_directions_miss() {
    fn check<T: TriangleMethod>() {
        let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
        for origin in [vec3(0.2, 0.3, 1.0), vec3(0.2, 0.3, 0.0), Vec3::ZERO, vec3(-1.0, 2.0, -3.0)] {
            for direction in [Vec3::ZERO, -Vec3::ZERO, Vec3::NAN, vec3(0.0, f32::NAN, -1.0)] {
                for limit in [1.0, f32::INFINITY] {
                    let hit = intersect::<T>(triangle, &ray(origin, direction), limit);
                    assert_eq!(hit, None, "{origin} along {direction}");
                }
            }
        }
    }
    for_every_method!(check);
}

#[test]
fn rays_in_the_plane_of_a_triangle_give_no_infinite_t() {
    fn check<T: TriangleMethod>() {
        let mut rng = Rng(15);
        for _ in 0..20_000 {
            let triangle = [(); 3].map(|()| vec3(rng.signed() as f32, rng.signed() as f32, 0.0));
            let turned = triangle.map(|v| [v, v.zxy(), v.yzx()][rng.0 as usize % 3]);
            let towards = turned[0].lerp(turned[1].lerp(turned[2], rng.unit() as f32), rng.unit() as f32);
            let origin = turned[0] + (turned[1] - turned[2]) * 2.0;
            let t = intersect::<T>(turned, &ray(origin, towards - origin), f32::INFINITY).map(|[t, ..]| t);
            assert!(t.is_none_or(|t| t > 0.0 && t.is_finite()), "{t:?}");
        }
    }
    for_every_method!(check);
}

#[test]
fn hits_lie_below_the_limit() {
    fn check<T: TriangleMethod>() {
        let (mut rng, mut hits) = (Rng(16), 0);
        for _ in 0..10_000 {
            let (triangle, _) = well_shaped(&mut rng, DVec3::ZERO, 3.0, 1.0);
            let centroid = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
            let origin = (rng.direction() * 4.0).as_vec3();
            let ray = ray(origin, centroid + rng.in_cube().as_vec3() * 0.3 - origin);
            let Some(hit) = intersect::<T>(triangle, &ray, f32::INFINITY) else { continue };
            let t = hit[0];
            for (limit, hit) in [(0.0, None), (0.9 * t, None), (t, None), (t.next_up(), Some(hit))] {
                assert_eq!(intersect::<T>(triangle, &ray, limit), hit, "limit {limit}");
            }
            hits += 1;
        }
        assert!(hits > 1000);
    }
    for_every_method!(check);
}

/// The vertices of a fan: triangles i are a, v[i], v[i + 1].
fn fan(a: Vec3, rim: &[Vec3]) -> Vec<[Vec3; 3]> {
    rim.windows(2).map(|edge| [a, edge[0], edge[1]]).collect()
}

#[test]
fn neighbours_are_linked_in_pairs_where_the_second_continues_the_first() {
    let links = |triangles: &[[Vec3; 3]]| {
        let mut stored: Vec<_> = triangles.iter().map(|&triangle| WoopTriangle::new(triangle)).collect();
        WoopTriangle::link_pairs(&mut stored);
        stored.iter().map(WoopTriangle::is_linked).collect::<Vec<_>>()
    };
    let [a, b, c, d, e] = std::array::from_fn(|i| vec3(i as f32, (i * i) as f32, 1.0));
    assert_eq!(links(&fan(a, &[b, c, d])), [true, false]);
    assert_eq!(links(&fan(a, &[b, c, d, e])), [true, false, false], "no triangle is in two pairs");
    assert_eq!(links(&fan(a, &[b, c, d, e, b])), [true, false, true, false]);
    assert_eq!(links(&[[a, b, c], [a, d, c], [b, c, d], [a, b, c]]), [false; 4]);
    assert_eq!(links(&[]), [false; 0]);
}

#[test]
fn pairs_give_the_bits_of_their_triangles_at_every_width() {
    fn check<L: Lane>() {
        let mut rng = Rng(31);
        let (mut hits, mut undecided) = ([0; 2], 0);
        for number in 0..16_000 {
            // On a grid, so that rays meet vertices and edges exactly and edge functions vanish.
            let whole = rng.index(2) == 0;
            let mut corner = || {
                let point = rng.in_cube() * 3.0;
                if whole { point.round().as_vec3() } else { point.as_vec3() }
            };
            let [a, b, c, d] = std::array::from_fn(|_| corner());
            // Half of the packets meet the common edge by chance alone: they can be decided. Single rays have
            // every target, too.
            let (first, turn) = ([0, 3][number / 8 % 2], number % 8);
            let rays: [Ray<f32>; 16] = std::array::from_fn(|lane| {
                let origin = corner();
                let targets = [a, c, (a + c) * 0.5, d, (a + b + c) / 3.0, (a + c + d) / 3.0, corner(), b];
                let target = targets[first + (lane + turn) % (8 - first)];
                ray(origin, target - origin)
            });
            let mut stored: Vec<_> = fan(a, &[b, c, d]).into_iter().map(WoopTriangle::new).collect();
            WoopTriangle::link_pairs(&mut stored);
            assert!(stored[0].is_linked());
            let woop = WoopRay::new(&Ray::<L>::from_lanes(&rays));
            let far = L::splat(f32::INFINITY);
            let alone =
                [0, 1].map(|number| woop.test(&stored[number]).unwrap_or_else(|| TriangleHit::none(far)));
            let Some(PairHit { hit, is_second }) = woop.test_pair([&stored[0], &stored[1]]) else {
                undecided += 1;
                continue;
            };
            let of_second = is_second & hit.mask;
            assert_eq!(of_second.bitmask(), alone[1].mask.bitmask(), "{a} {b} {c} {d}");
            assert_eq!(hit.mask.bitmask() ^ of_second.bitmask(), alone[0].mask.bitmask(), "{a} {b} {c} {d}");
            for (number, alone) in alone.iter().enumerate() {
                for lane in alone.mask.lanes() {
                    let bits = |hit: &TriangleHit<L>| [hit.t, hit.u, hit.v].map(|x| x.get(lane).to_bits());
                    assert_eq!(bits(&hit), bits(alone), "{:?}", rays[lane]);
                }
                hits[number] += alone.mask.count();
            }
        }
        assert!(undecided > 100, "rays aimed at the common edge: {undecided}");
        assert!(hits.iter().all(|&hits| hits > 1_000), "{hits:?}");
    }
    check::<f32>();
    check::<F32x8>();
    check::<F32x16>();
}
