//! The interface: what input may be, what odd input gives, and both precisions beside their neighbours.

use crate::cases::{Rng, cube};
use crate::rational::Point;
use octray_rays::query::{
    AllHits, Error, HitColumns, HitsMut, Intersector, MISS, Precision, Rays, Surfaces, Threads,
};
use octray_rays::{Geometry, Hits, Structure, Tracer};
use std::slice::from_ref;

pub const BOTH: [Precision; 2] = [Precision::Single, Precision::Exact];
const INFINITE: f64 = f64::INFINITY;

pub fn built(meshes: &[(Vec<Point>, Vec<[u32; 3]>)], precision: Precision) -> Intersector {
    let mut surfaces = Surfaces::new();
    for (number, (vertices, faces)) in meshes.iter().enumerate() {
        assert_eq!(surfaces.add_mesh(vertices, faces), Ok(number));
    }
    surfaces.build(precision).unwrap()
}

/// Triangles in a cube of edge 4, as numbers that f32 holds, each twice.
pub fn crowd(rng: &mut Rng, count: u32) -> (Vec<Point>, Vec<[u32; 3]>) {
    let corners = |rng: &mut Rng| {
        let center = rng.point().map(|x| 2.0 * x);
        [(); 3].map(|()| {
            let offset = rng.point();
            [0, 1, 2].map(|axis| f64::from((center[axis] + offset[axis]) as f32))
        })
    };
    let vertices = (0..count).flat_map(|_| corners(rng)).collect();
    (vertices, (0..2 * count).map(|i| [0, 1, 2].map(|k| 3 * (i % count) + k)).collect())
}

/// Rays from in and around that cube towards it, in f32, some of unit length.
fn rays_to_crowd(rng: &mut Rng) -> [Vec<[f32; 3]>; 2] {
    let ray = |i: usize| {
        let far = [1.0, 6.0][i % 2];
        let (origin, target) = (rng.point().map(|x| x * far), rng.point().map(|x| 2.0 * x));
        let direction = glam::DVec3::from(target) - glam::DVec3::from(origin);
        let direction = if i.is_multiple_of(3) { direction.normalize() } else { direction };
        (origin.map(|x| x as f32), direction.as_vec3().to_array())
    };
    let (origins, directions) = (0..5000).map(ray).unzip();
    [origins, directions]
}

#[test]
fn single_precision_is_that_of_the_tracer() {
    let mut rng = Rng(1);
    for count in [5, 400] {
        let mesh = crowd(&mut rng, count);
        let corner = |&vertex: &u32| glam::DVec3::from(mesh.0[vertex as usize]).as_vec3();
        let triangles = mesh.1.iter().map(|face| face.each_ref().map(corner)).collect();
        let structure = Structure::new(&Geometry { triangles, ..Geometry::default() });
        let [origins, directions] = rays_to_crowd(&mut rng);
        let t_max: Vec<f32> = (0..origins.len()).map(|i| [f32::INFINITY, 0.7, 3.0][i % 3]).collect();
        let column = |of: &[[f32; 3]], axis: usize| of.iter().map(|row| row[axis]).collect::<Vec<f32>>();
        let [o, d] = [&origins, &directions].map(|rows| [0, 1, 2].map(|axis| column(rows, axis)));
        let old = octray_rays::Rays::new(o.each_ref().map(|c| &c[..]), d.each_ref().map(|c| &c[..]));
        let (mut t, mut primitive) = (t_max.clone(), vec![MISS; t_max.len()]);
        let [mut u, mut v] = [(); 2].map(|()| vec![0.0; t_max.len()]);
        let mut hits = Hits { t: &mut t, primitive: &mut primitive, u: &mut u, v: &mut v };
        Tracer::new().closest(&structure, &old, &mut hits);
        let single = built(&[mesh], Precision::Single);
        let rays = Rays::new(&origins, &directions).until(&t_max);
        let found = single.closest(&rays).unwrap();
        assert_eq!(found.primitive, primitive);
        assert!(primitive.iter().filter(|&&primitive| primitive != MISS).count() > 100);
        for at in (0..t.len()).filter(|&at| primitive[at] != MISS) {
            assert_eq!([t[at], u[at], v[at]], [found.t[at] as f32, found.u[at] as f32, found.v[at] as f32]);
        }
        let occluded: Vec<bool> = primitive.iter().map(|&primitive| primitive != MISS).collect();
        assert_eq!(single.occluded(&rays), Ok(occluded));
        // Asking again behind each hit finds all of them.
        let AllHits { offsets, hits } = single.all_hits(&rays).unwrap();
        let mut next: Vec<usize> = offsets[..offsets.len() - 1].to_vec();
        let mut t_min = vec![0.0; next.len()];
        while next.iter().zip(&offsets[1..]).any(|(next, end)| next < end) {
            let after = single.closest(&rays.after(&t_min)).unwrap();
            for at in 0..next.len() {
                let hit = (next[at] < offsets[at + 1]).then_some(next[at]);
                assert_eq!(after.primitive[at], hit.map_or(MISS, |hit| hits.primitive[hit]));
                if let Some(first) = hit {
                    assert_eq!(after.t[at], hits.t[first]);
                    let same =
                        (first..offsets[at + 1]).take_while(|&hit| hits.t[hit] == hits.t[first]).count();
                    (t_min[at], next[at]) = (hits.t[first], first + same);
                } else {
                    t_min[at] = INFINITE;
                }
            }
        }
        assert!(single.all_hits(&rays).unwrap().hits.len() > 100);
    }
}

/// The rule t_min < t < t_max holds to the last bit, as t and the ends are rounded.
#[test]
fn ends_one_bit_beside_a_hit_decide() {
    let mut rng = Rng(7);
    let mesh = crowd(&mut rng, 100);
    let [origins, directions] = rays_to_crowd(&mut rng);
    let rays = Rays::new(&origins, &directions);
    let intersector = built(from_ref(&mesh), Precision::Single);
    let HitColumns { t, primitive, .. } = intersector.closest(&rays).unwrap();
    let moved = |by: fn(f64) -> f64| t.iter().map(|&t| by(t)).collect::<Vec<_>>();
    let (below, above) = (moved(f64::next_down), moved(f64::next_up));
    let after = |ends: &Vec<f64>| intersector.closest(&rays.after(ends)).unwrap().primitive;
    let before = |ends: &Vec<f64>| intersector.occluded(&rays.until(ends)).unwrap();
    let (found, behind, at_end, behind_it) = (after(&below), after(&t), before(&t), before(&above));
    for at in (0..t.len()).filter(|&at| primitive[at] != MISS) {
        assert!(found[at] == primitive[at] && behind[at] != primitive[at], "{}", t[at]);
        assert!(!at_end[at] && behind_it[at], "{}", t[at]);
    }
}

#[test]
fn both_precisions_agree_away_from_edges() {
    let mut rng = Rng(2);
    let mesh = crowd(&mut rng, 400);
    let [origins, directions] = rays_to_crowd(&mut rng);
    let rays = Rays::new(&origins, &directions);
    let [single, exact] = BOTH.map(|precision| built(from_ref(&mesh), precision).closest(&rays).unwrap());
    let same = single.primitive.iter().zip(&exact.primitive).filter(|(a, b)| a == b).count();
    assert!(same + 5 > origins.len(), "{same}");
    for at in (0..origins.len()).filter(|&at| single.primitive[at] == exact.primitive[at]) {
        let is_miss = single.primitive[at] == MISS;
        assert!(is_miss || (single.t[at] - exact.t[at]).abs() < 1e-3 * exact.t[at], "ray {at}");
    }
}

#[test]
fn slices_of_any_form_and_any_threads_give_the_same() {
    let mut rng = Rng(3);
    let mesh = crowd(&mut rng, 100);
    let [origins, directions] = rays_to_crowd(&mut rng);
    let wide = |rows: &[[f32; 3]]| rows.iter().map(|row| row.map(f64::from)).collect::<Vec<_>>();
    let column = |rows: &[[f32; 3]], axis: usize| rows.iter().map(|row| row[axis]).collect::<Vec<f32>>();
    for precision in BOTH {
        let intersector = built(from_ref(&mesh), precision);
        let all = |intersector: &Intersector, rays: &Rays| {
            let answers = (intersector.closest(rays), intersector.occluded(rays), intersector.all_hits(rays));
            (answers, intersector.count(rays))
        };
        let expected = all(&intersector, &Rays::new(&origins, &directions));
        let (o, d) = (wide(&origins), wide(&directions));
        assert_eq!(all(&intersector, &Rays::new(&o, &d)), expected);
        let [o, d] = [&origins, &directions].map(|rows| [0, 1, 2].map(|axis| column(rows, axis)));
        let columns = Rays::new(o.each_ref(), d.each_ref());
        assert_eq!(all(&intersector, &columns), expected);
        let alone = intersector.clone().with_threads(Threads::Caller);
        assert_eq!(all(&alone, &columns), expected);
        assert_eq!(alone.contains(&origins), intersector.contains(&wide(&origins)));
    }
}

#[test]
fn parts_of_answers_are_those_of_the_whole() {
    let mut rng = Rng(5);
    let mesh = crowd(&mut rng, 100);
    let [origins, directions] = rays_to_crowd(&mut rng);
    let [t_min, t_max] = [0.25, 2.0].map(|end| vec![end; origins.len()]);
    for precision in BOTH {
        let intersector = built(from_ref(&mesh), precision);
        let rays = Rays::new(&origins, &directions);
        let ends = rays.after(&t_min).until(&t_max);
        let same = rays.after(0.25).until(2.0);
        assert_eq!(intersector.all_hits(&same), intersector.all_hits(&ends));
        let all = intersector.all_hits(&rays).unwrap();
        let of_ray = |hits: &AllHits, ray: usize| {
            hits.hits.primitive[hits.offsets[ray]..hits.offsets[ray + 1]].to_vec()
        };
        for most in 0..4 {
            let first = intersector.first_hits(&rays, most).unwrap();
            for ray in 0..rays.len() {
                let whole = of_ray(&all, ray);
                assert_eq!(of_ray(&first, ray), whole[..most.min(whole.len())], "{most} of ray {ray}");
            }
        }
        let counts = intersector.count(&rays).unwrap();
        let closest = intersector.closest(&rays).unwrap();
        for (ray, count) in counts.into_iter().enumerate() {
            let whole = of_ray(&all, ray);
            assert_eq!(count as usize, whole.len());
            assert_eq!(closest.primitive[ray], whole.first().copied().unwrap_or(MISS));
        }
        let (mut primitive, mut v) = (vec![7; rays.len()], vec![7.0; rays.len()]);
        let hits = HitsMut { primitive: &mut primitive, v: &mut v, ..HitsMut::default() };
        intersector.closest_to(&rays, hits).unwrap();
        assert_eq!((primitive, v), (closest.primitive, closest.v));
        let short = HitsMut { t: &mut [0.0], ..HitsMut::default() };
        assert!(matches!(
            intersector.closest_to(&rays, short),
            Err(Error::Length { of: "hits", found: 1, .. })
        ));
    }
}

/// Rays of one batch are converted and traced together, whatever they are.
#[test]
fn answers_do_not_depend_on_the_rays_beside() {
    let mut rng = Rng(6);
    let (mut vertices, faces) = crowd(&mut rng, 100);
    vertices.iter_mut().for_each(|vertex| *vertex = vertex.map(|x| x + 3.0));
    let ray = |i: usize| {
        let distance = [1.0, 1e2, 1e5, 1e9, 1e18][i % 5];
        let target = rng.point().map(|x| 2.0 * x + 3.0);
        let (origin, target) = (glam::DVec3::from(rng.point()) * distance, glam::DVec3::from(target));
        let length = [1.0, 1e-20, 1e18, f64::NAN, 0.0, INFINITE][[0, 0, 0, 1, 2, 3, 4, 5][i / 5 % 8]];
        (origin.to_array(), ((target - origin).normalize() * length).to_array())
    };
    let (origins, directions): (Vec<Point>, Vec<Point>) = (0..400).map(ray).unzip();
    for precision in BOTH {
        let intersector = built(&[(vertices.clone(), faces.clone())], precision);
        let together = Rays::new(&origins, &directions);
        let [closest, alone] = [(); 2].map(|()| intersector.closest(&together).unwrap());
        assert_eq!(closest, alone);
        let (counts, occluded) =
            (intersector.count(&together).unwrap(), intersector.occluded(&together).unwrap());
        for at in 0..origins.len() {
            let ray = Rays::new(from_ref(&origins[at]), from_ref(&directions[at]));
            let hit = intersector.closest(&ray).unwrap();
            let numbers = |hits: &HitColumns, at: usize| [hits.t[at], hits.u[at], hits.v[at]];
            assert_eq!(hit.primitive[0], closest.primitive[at], "{ray:?}");
            assert_eq!(numbers(&hit, 0), numbers(&closest, at), "{ray:?}");
            assert_eq!(intersector.count(&ray).unwrap(), [counts[at]], "{ray:?}");
            assert_eq!(intersector.occluded(&ray).unwrap(), [occluded[at]], "{ray:?}");
            let cannot = directions[at].iter().any(|x| !x.is_finite()) || directions[at] == [0.0; 3];
            assert!(!(cannot && occluded[at]), "{ray:?}");
        }
        assert!(occluded.iter().filter(|&&hits| hits).count() > 100);
    }
}

/// In [`Precision::Exact`], a hit at t = 0 counts if t_min is negative.
#[test]
fn negative_t_min_counts_hits_at_the_origin() {
    let triangle = (vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]);
    let exact = built(&[triangle], Precision::Exact);
    let rays = Rays::new(&[[0.25, 0.25, 0.0]; 2], &[[0.0, 0.1, 1.0], [0.0, 0.1, -1.0]]);
    assert_eq!(exact.closest(&rays).unwrap().primitive, [MISS; 2]);
    for t_min in [-1.0, -INFINITE, -1e-300] {
        let hits = exact.closest(&rays.after(t_min)).unwrap();
        assert_eq!(hits.primitive, [0; 2]);
        assert!(hits.t.iter().all(|t| t.to_bits() == 0), "0, and not -0: {:?}", hits.t);
        let behind = Rays::new(&[[0.25, 0.25, 1e-9]; 1], &[[0.0, 0.1, 1.0]; 1]).after(t_min);
        assert_eq!(exact.occluded(&behind), Ok(vec![false]));
    }
}

#[test]
fn odd_rays_hit_nothing_and_odd_triangles_are_not_hit() {
    let (vertices, mut faces) = cube();
    // A face twice, a repeated vertex, and a line.
    faces.extend([faces[0], [1, 1, 5], [0, 0, 0]]);
    let (nan, up) = (f64::NAN, [0.0, 0.0, 1.0]);
    let below = [-0.5, 0.25, -3.0];
    for precision in BOTH {
        let intersector = built(&[(vertices.clone(), faces.clone())], precision);
        let count = |origin, direction, t_min: f64, t_max: f64| {
            let (origins, directions, t_min, t_max) = ([origin], [direction], [t_min], [t_max]);
            let rays = Rays::new(&origins, &directions).after(&t_min).until(&t_max);
            let all = intersector.all_hits(&rays).unwrap();
            let is_hit = !all.hits.is_empty();
            assert_eq!(intersector.occluded(&rays), Ok(vec![is_hit]));
            assert_eq!(intersector.closest(&rays).unwrap().t[0] < INFINITE, is_hit);
            assert_eq!(all.offsets, [0, all.hits.len()]);
            all.hits.len()
        };
        // Face 0 is at z = −1 twice; this ray and the longer one hit it and the face above.
        assert_eq!(count(below, up, 0.0, INFINITE), 3, "{precision:?}");
        assert_eq!(count(below, [0.0, 0.0, 1e-9], -1.0, INFINITE), 3);
        assert_eq!(count(below, [0.0, 0.0, 1e30], 0.0, f64::MAX), 3);
        if precision == Precision::Single {
            // These are hit at a t above the largest double.
            assert_eq!(count([-0.5, 0.25, -1e3], [0.0, 0.0, 1e-306], 0.0, INFINITE), 0);
            assert_eq!(count([-0.5, 0.25, -1e3], [0.0, 0.0, 1e-304], 0.0, INFINITE), 3);
        }
        for (t_min, t_max, expected) in [(0.0, 2.0, 0), (0.0, 2.5, 2), (2.0, 4.0, 0), (2.0, 4.5, 1)] {
            assert_eq!(count(below, up, t_min, t_max), expected, "{precision:?}: {t_min} to {t_max}");
        }
        for (t_min, t_max) in [(nan, 9.0), (0.0, nan), (9.0, 1.0), (0.0, -1.0), (INFINITE, INFINITE)] {
            assert_eq!(count(below, up, t_min, t_max), 0, "{t_min} to {t_max}");
        }
        for direction in [[0.0; 3], [0.0, nan, 1.0], [0.0, 0.0, INFINITE]] {
            assert_eq!(count(below, direction, 0.0, INFINITE), 0);
        }
        for origin in [[nan, 0.0, -3.0], [0.0, 0.0, -INFINITE]] {
            assert_eq!(count(origin, up, 0.0, INFINITE), 0);
            assert_eq!(intersector.contains(&[origin]), Ok(vec![false]));
        }
        // In the plane of a face, only the faces beside are hit, at their edges.
        assert!(count([0.25, -1.0, -3.0], up, 0.0, INFINITE) <= 4);
        // Through the repeated vertices, and past them.
        assert_eq!(count([3.0, 3.0, 0.0], [0.0, 1.0, 0.0], 0.0, INFINITE), 0);
        let nothing = built(&[(vec![], vec![])], precision);
        assert_eq!(nothing.closest(&Rays::new(&[below], &[up])).unwrap().surface, [MISS]);
        assert_eq!(nothing.contains(&[below]), Ok(vec![false]));
        assert_eq!(
            intersector.closest(&Rays::new(&[[0.0; 3]; 0], &[[0.0; 3]; 0])),
            Ok(HitColumns::default())
        );
    }
}

#[test]
fn surfaces_have_numbers_of_their_own() {
    let moved = |x: f64| cube().0.iter().map(|&[a, b, c]| [a + x, b, c]).collect::<Vec<_>>();
    let mut surfaces = Surfaces::new();
    surfaces.add_mesh(&moved(0.0), &cube().1).unwrap();
    surfaces.add_spheres(&[[20.0, 0.0, 0.0], [30.0, 0.0, 0.0_f32]], &[1.0, 2.0_f32]).unwrap();
    surfaces.add_mesh(&[[0.0; 3]; 0], &[]).unwrap();
    surfaces.add_mesh(&moved(10.0), &cube().1).unwrap();
    surfaces.add_spheres(&[[40.0, 0.0, 0.0]], &[1.0]).unwrap();
    assert_eq!(surfaces.clone().build(Precision::Exact).err(), Some(Error::ExactSpheres));
    let intersector = surfaces.build(Precision::Single).unwrap();
    let rays = Rays::new(&[[-5.0, 0.5, 0.25]], &[[2.0, 0.0, 0.0]]);
    let AllHits { offsets, hits } = intersector.all_hits(&rays).unwrap();
    assert_eq!(offsets, [0, 10]);
    assert_eq!(hits.surface, [0, 0, 3, 3, 1, 1, 1, 1, 4, 4]);
    assert_eq!(hits.primitive[4..], [0, 0, 1, 1, 0, 0]);
    assert_eq!(hits.primitive[..2], hits.primitive[2..4]);
    assert_eq!(hits.t[..4], [2.0, 3.0, 7.0, 8.0]);
    assert_eq!(hits.u[4..], [0.0; 6]);
    let points = [[0.0, 0.0, 0.0], [20.5, 0.0, 0.0], [25.0, 0.0, 0.0], [40.0, 0.5, 0.5]];
    assert_eq!(intersector.contains(&points), Ok(vec![true, true, false, true]));
}

#[test]
fn refitted_structures_answer_as_new_ones() {
    let mut rng = Rng(4);
    let meshes = [crowd(&mut rng, 300), crowd(&mut rng, 200)];
    let mut others = meshes.clone();
    let drift = rng.point();
    for vertex in &mut others[1].0 {
        let jitter = rng.point();
        *vertex = [0, 1, 2].map(|axis| vertex[axis] + drift[axis] * 3.0 + jitter[axis] * 0.2);
    }
    let [origins, directions] = rays_to_crowd(&mut rng);
    let rays = Rays::new(&origins, &directions);
    for precision in BOTH {
        let (before, new) = (built(&meshes, precision), built(&others, precision));
        let old = before.all_hits(&rays).unwrap();
        let mut moved = before.clone();
        moved.move_vertices(1, &others[1].0).unwrap();
        assert_eq!(moved.all_hits(&rays), new.all_hits(&rays));
        assert_eq!(moved.closest(&rays), new.closest(&rays));
        assert_eq!(before.all_hits(&rays).unwrap(), old, "the clone before");
        assert_eq!(moved.move_vertices(2, &others[1].0), Err(Error::Surface(2)));
        let wrong = moved.move_vertices(0, &others[1].0);
        assert_eq!(wrong, Err(Error::Length { of: "vertices", found: 600, expected: 900 }));
    }
}

/// Points at vertices, on edges and faces, and inside of eight cubes that fill a larger one, and the cubes
/// that contain them.
#[test]
fn solids_that_share_faces_contain_each_point_once() {
    let cubes: Vec<Intersector> = (0..8)
        .map(|i| {
            let offset = [0, 1, 2].map(|axis| if i >> axis & 1 == 1 { 1.0 } else { -1.0 });
            let vertices = cube().0.iter().map(|v| [0, 1, 2].map(|axis| v[axis] + offset[axis])).collect();
            built(&[(vertices, cube().1)], Precision::Exact)
        })
        .collect();
    let at = |i: usize| (i % 9) as f64 * 0.5 - 2.0;
    let points: Vec<Point> = (0..729).map(|i| [at(i), at(i / 9), at(i / 81)]).collect();
    let answers: Vec<_> = cubes.iter().map(|cube| cube.contains(&points).unwrap()).collect();
    for (i, point) in points.iter().enumerate() {
        let count = answers.iter().filter(|inside| inside[i]).count();
        let is_inside = point.iter().all(|x| (-2.0..2.0).contains(x));
        assert_eq!(count, usize::from(is_inside), "{point:?}");
    }
    // The parts of a cut ray cross as many as the whole.
    let (origins, directions) = (vec![[-3.0, -3.0, -3.0]; 80], vec![[1.0, 1.0, 1.0]; 80]);
    let cuts: Vec<f64> = (0..80).map(|i| f64::from(i) / 16.0).collect();
    for cube in &cubes {
        let rays = Rays::new(&origins, &directions);
        let parts = [rays.until(&cuts), rays.after(&cuts)].map(|rays| cube.count(&rays).unwrap());
        let whole = cube.count(&rays).unwrap();
        assert!((0..80).all(|i| parts[0][i] + parts[1][i] == whole[i]), "{parts:?}");
    }
}

#[test]
fn triangles_that_share_vertices_take_a_hundred_bytes() {
    let side = 400_u32;
    let height = |i: u32| ((f64::from(i % side) / 9.0).sin() + (f64::from(i / side) / 7.0).cos()) * 5.0;
    let vertex = |i: u32| [f64::from(i % side), height(i), f64::from(i / side)];
    let cells = (0..side * side).filter(|i| i % side + 1 < side && i / side + 1 < side);
    let faces: Vec<_> = cells.flat_map(|i| [[i, i + 1, i + side + 1], [i, i + side + 1, i + side]]).collect();
    let terrain = ((0..side * side).map(vertex).collect(), faces.clone());
    let bytes = built(&[terrain], Precision::Exact).bytes() as f64 / faces.len() as f64;
    assert!((40.0..100.0).contains(&bytes), "{bytes} bytes");
}

#[test]
fn what_cannot_be_answered_is_named() {
    let (vertices, faces) = cube();
    let with = |number: f64| {
        let mut vertices = vertices.clone();
        vertices[5][1] = number;
        let mut surfaces = Surfaces::new();
        surfaces.add_mesh(&vertices, &faces).unwrap_err()
    };
    for number in [f64::INFINITY, 1e37, 1e-37] {
        assert_eq!(with(number), Error::Point { surface: 0, index: 5, number });
    }
    assert!(with(f64::NAN).to_string().contains("vertex or sphere 5: NaN is no coordinate"));
    let mut surfaces = Surfaces::new();
    let face = surfaces.add_mesh(&vertices, &[[0, 1, 2], [3, 8, 4]]);
    assert_eq!(face, Err(Error::Face { surface: 0, index: 1, vertex: 8 }));
    assert_eq!(
        surfaces.add_spheres(&[[0.0; 3]], &[-1.0]),
        Err(Error::Radius { surface: 0, index: 0, number: -1.0 })
    );
    let length = |of, found| Err(Error::Length { of, found, expected: 1 });
    assert_eq!(surfaces.add_spheres(&[[0.0; 3]], &[1.0; 2]), length("radii", 2).map(|()| 0));
    assert_eq!(surfaces.add_mesh(&vertices, &faces), Ok(0), "errors leave nothing behind");
    let intersector = surfaces.build(Precision::Exact).unwrap();
    let (one, two) = ([[1.0; 3]], [[1.0; 3]; 2]);
    assert_eq!(intersector.count(&Rays::new(&one, &two)).map(|_| ()), length("directions", 2));
    assert_eq!(intersector.count(&Rays::new(&one, &one).until(&[1.0; 2])).map(|_| ()), length("t_max", 2));
    let far = [[1.0; 3], [0.0, 1e40, 0.0]];
    let error = Error::Ray { index: 1, number: 1e40 };
    assert_eq!(intersector.occluded(&Rays::new(&two, &far)), Err(error.clone()));
    assert_eq!(intersector.contains(&far), Err(error));
}
