//! The law of lower bounds: a ray that is traced again, each time with its last hit as the exclusive lower
//! bound, finds every hit of every primitive, each once and in order, in every structure.

use crate::common::rays::Set;
use crate::common::*;
use octray::rays::{Geometry, Hits, Rays, Structure, Tracer};
use octray::scene::Coordinates;

/// A hit: t and primitive.
type Found = (f32, u32);

/// All hits of each ray, by asking again; `world` asks in world coordinates.
fn all_hits(structure: &Structure, set: &Set, world: bool) -> Vec<Vec<Found>> {
    let (count, mut tracer) = (set.len(), Tracer::new());
    let (mut bound, mut of_bound) = (vec![0.0; count], vec![MISS; count]);
    let mut found = vec![Vec::new(); count];
    loop {
        let (mut t, mut primitive) = (set.t_max.clone(), vec![MISS; count]);
        let [mut u, mut v] = [(); 2].map(|()| vec![0.0; count]);
        let mut hits = Hits { t: &mut t, primitive: &mut primitive, u: &mut u, v: &mut v };
        let rays = set.rays().until(&set.t_max).beyond(&bound, &of_bound);
        match world {
            true => tracer.closest(structure, &rays, &mut hits),
            false => tracer.closest_in_scene(structure, &rays, &mut hits),
        }
        assert_eq!(occluded(structure, &rays, set), primitive.iter().map(|&p| p != MISS).collect::<Vec<_>>());
        for at in (0..count).filter(|&at| primitive[at] != MISS) {
            found[at].push((t[at], primitive[at]));
            (bound[at], of_bound[at]) = (t[at], primitive[at]);
        }
        if primitive.iter().all(|&primitive| primitive == MISS) {
            return found;
        }
        // Rays without a further hit have none beyond any hit.
        for at in (0..count).filter(|&at| primitive[at] == MISS) {
            bound[at] = f32::INFINITY;
        }
    }
}

fn occluded(structure: &Structure, rays: &Rays, set: &Set) -> Vec<bool> {
    let (mut t, mut primitive) = (set.t_max.clone(), vec![MISS; set.len()]);
    let [mut u, mut v] = [(); 2].map(|()| vec![0.0; set.len()]);
    let mut hits = Hits { t: &mut t, primitive: &mut primitive, u: &mut u, v: &mut v };
    Tracer::new().occluded(structure, rays, &mut hits);
    primitive.into_iter().map(|primitive| primitive != MISS).collect()
}

/// The hits of each ray with every primitive by itself. The second hit of a sphere, where one is expected, is
/// computed in f64.
fn expected(geometry: &Geometry, set: &Set) -> Vec<Vec<(Found, Option<f64>)>> {
    let mut hits = vec![Vec::new(); set.len()];
    for (number, shape) in geometry.shapes().enumerate() {
        let alone = Structure::list(&geometry.only(|other, _| other == number), 1);
        for (at, [t, primitive, ..]) in set.nearest_in(&alone).into_iter().enumerate() {
            let vector =
                |columns: &[Vec<f32>; 3]| DVec3::from_array([0, 1, 2].map(|axis| columns[axis][at].into()));
            let (origin, direction) = (vector(&set.origin), vector(&set.direction));
            if primitive == MISS {
                continue;
            }
            let second =
                shape.balls().next().filter(|&(_, radius)| radius > 0.0).and_then(|(center, radius)| {
                    let (to, direction) = (center - origin, direction.normalize());
                    let middle = to.dot(direction);
                    let half = (radius * radius - (to - middle * direction).length_squared()).max(0.0).sqrt();
                    (to.length() > radius).then_some(middle + half)
                });
            hits[at].push(((f32::from_bits(t), number as u32), second));
        }
    }
    hits
}

/// Spheres and triangles in a cube of edge 4, each twice, so that hits tie, and rays towards them.
fn crowd(rng: &mut Rng, spheres: usize, triangles: usize) -> (Geometry, Set) {
    let ball = |_| octray::rays::Sphere {
        center: rng.in_cube().as_vec3() * 2.0,
        radius: rng.scale(0.05, 0.8) as f32,
    };
    let spheres: Vec<_> = (0..spheres).map(ball).collect();
    let corners = |_| {
        let center = rng.in_cube() * 2.0;
        [(); 3].map(|()| (center + rng.in_cube()).as_vec3())
    };
    let triangles: Vec<_> = (0..triangles).map(corners).collect();
    let geometry =
        Geometry { spheres: spheres.repeat(2), triangles: triangles.repeat(2), ..Geometry::default() };
    let mut set = Set::default();
    for _ in 0..200 {
        let origin = rng.in_cube() * [1.0, 6.0][rng.index(2)];
        let direction = (rng.in_cube() * 2.0 - origin).normalize();
        set.push(origin.as_vec3(), direction.as_vec3(), [f32::INFINITY, 4.0][rng.index(2)]);
    }
    (geometry, set)
}

#[test]
fn asking_again_finds_every_hit_once_and_in_order() {
    let mut rng = Rng(77);
    for (spheres, triangles) in [(0, 0), (1, 0), (0, 1), (9, 3), (0, 40), (60, 200)] {
        let (geometry, set) = crowd(&mut rng, spheres, triangles);
        let tree = Structure::tree_for_all(&geometry);
        let found = all_hits(&tree, &set, false);
        let expected = expected(&geometry, &set);
        for ((found, expected), &end) in found.iter().zip(&expected).zip(&set.t_max) {
            assert!(found.is_sorted_by(|a, b| a.0 < b.0 || a.0 == b.0 && a.1 < b.1), "{found:?}");
            let mut seconds = found.clone();
            for (first, second) in expected {
                assert!(found.contains(first), "{first:?} of {found:?}");
                seconds.retain(|hit| hit != first);
                let at = |&(t, number): &Found| {
                    second.is_some_and(|second| {
                        (f64::from(t) - second).abs() < 1e-4 * second.abs() && number == first.1
                    })
                };
                let is_due = second.is_some_and(|second| {
                    second < f64::from(end) * 0.999 && second - f64::from(first.0) > 1e-2
                });
                assert!(
                    !is_due || seconds.iter().any(at),
                    "the far side of {first:?} at {second:?}: {found:?}"
                );
                seconds.retain(|hit| !at(hit));
            }
            assert!(seconds.is_empty(), "{seconds:?} is no hit");
        }
        for traversal in Traversal::ALL {
            assert_eq!(all_hits(&tree.with_traversal(traversal), &set, false), found, "{traversal:?}");
        }
        for lanes in WIDTHS {
            assert_eq!(all_hits(&Structure::list(&geometry, lanes), &set, false), found, "{lanes} lanes");
        }
    }
}

/// In world coordinates t is rounded once more: hits that share a t then are ordered by their numbers.
#[test]
fn asking_again_finds_every_hit_in_any_unit_and_for_directions_of_any_length() {
    let mut rng = Rng(78);
    let (mut geometry, mut set) = crowd(&mut rng, 20, 100);
    // A stack of triangles a rounding apart, in another order.
    let stack = (0..60).map(|i| (-2.0_f32).to_bits() + i * 37 % 60).map(f32::from_bits);
    geometry
        .triangles
        .extend(stack.map(|z| [(-1.0, -1.0), (1.0, -1.0), (0.0, 1.0)].map(|(x, y)| vec3(x, y, z))));
    set.push(Vec3::ZERO, -Vec3::Z, f32::INFINITY);
    let here = all_hits(&Structure::tree_for_all(&geometry), &set, false);
    for (unit, length) in [(1.0, 0.3), (1.0, 1.7), (0.5, 1.0), (1.0 / 1024.0, 17.0)] {
        geometry.coordinates = Coordinates { unit, ..Coordinates::default() };
        let scaled = |column: &Vec<f32>, factor: f32| column.iter().map(|x| x * factor).collect::<Vec<_>>();
        let set = Set {
            origin: set.origin.each_ref().map(|column| scaled(column, unit as f32)),
            direction: set.direction.each_ref().map(|column| scaled(column, length)),
            t_max: vec![f32::INFINITY; set.len()],
            ..set.clone()
        };
        let tree = Structure::tree_for_all(&geometry);
        let found = all_hits(&tree, &set, true);
        let in_order = |hits: &Vec<Found>| hits.is_sorted_by(|a, b| a.0 < b.0 || a.0 == b.0 && a.1 < b.1);
        assert!(found.iter().all(in_order));
        let last = found.len() - 1;
        assert!((60..=here[last].len()).contains(&found[last].len()), "{} of the stack", found[last].len());
        for (found, here) in found.iter().zip(&here) {
            let numbers = |hits: &[Found]| hits.iter().map(|hit| hit.1).collect::<Vec<_>>();
            let (found, here) = (numbers(found), numbers(here));
            // Few graze so closely that the direction's rounding decides; ends are not asked for here.
            assert!(
                here.iter().filter(|number| !found.contains(number)).count() <= 1,
                "{found:?} of {here:?}"
            );
        }
        // A ray that ends where its nearest hit is has no hit there; one that ends behind it has.
        let ends = |ends: &dyn Fn(f32) -> f32| {
            let nearest = |hits: &Vec<Found>| ends(hits.first().map_or(1.0, |hit| hit.0));
            Set { t_max: found.iter().map(nearest).collect(), ..set.clone() }
        };
        let hits = |set: &Set, until: &[f32]| {
            let (mut t, mut primitive) = (vec![f32::INFINITY; set.len()], vec![MISS; set.len()]);
            let [mut u, mut v] = [(); 2].map(|()| vec![0.0; set.len()]);
            let mut hits = Hits { t: &mut t, primitive: &mut primitive, u: &mut u, v: &mut v };
            Tracer::new().closest(&tree, &set.rays().until(until), &mut hits);
            let any = occluded(&tree, &set.rays().until(until), set);
            assert!(any.iter().zip(&primitive).all(|(any, primitive)| *any == (*primitive != MISS)));
            primitive
        };
        let at = ends(&|t| t);
        assert!(hits(&at, &at.t_max).iter().all(|&primitive| primitive == MISS));
        let behind = ends(&f32::next_up);
        for (primitive, found) in hits(&behind, &behind.t_max).iter().zip(&found) {
            assert_eq!(*primitive, found.first().map_or(MISS, |hit| hit.1));
        }
    }
}

/// Hits of an earlier query are improved alike in a list and in a tree, and so are parts of a set of rays.
#[test]
fn earlier_hits_are_kept_unless_another_is_nearer_or_has_a_lower_number() {
    let mut rng = Rng(79);
    let (geometry, set) = crowd(&mut rng, 4, 4);
    let found = all_hits(&Structure::tree_for_all(&geometry), &set, false);
    for before in [0, 1, 2] {
        let known = |(hits, &end): (&Vec<Found>, &f32)| hits.get(before).copied().unwrap_or((end, MISS));
        let answers = [Structure::list(&geometry, 8), Structure::tree_for_all(&geometry)].map(|structure| {
            let (mut t, mut primitive): (Vec<f32>, Vec<u32>) =
                found.iter().zip(&set.t_max).map(known).unzip();
            let [mut u, mut v] = [(); 2].map(|()| vec![0.25; set.len()]);
            let mut hits = Hits { t: &mut t, primitive: &mut primitive, u: &mut u, v: &mut v };
            Tracer::new().improve::<false>(&structure, &set.rays(), &mut hits);
            (t, primitive, u, v)
        });
        assert_eq!(answers[0], answers[1]);
        let nearest: Vec<u32> = found.iter().map(|hits| hits.first().map_or(MISS, |hit| hit.1)).collect();
        assert_eq!(answers[0].1, nearest);
        if before == 0 {
            assert!(answers[0].2.iter().all(|&u| u == 0.25), "what was known already is kept");
        }
    }
    let (bound, of_bound): (Vec<f32>, Vec<u32>) =
        found.iter().map(|hits| hits.first().copied().unwrap_or((0.0, MISS))).unzip();
    let (mut t, mut primitive) = (set.t_max.clone(), vec![MISS; set.len()]);
    let [mut u, mut v] = [(); 2].map(|()| vec![0.0; set.len()]);
    let tree = Structure::tree_for_all(&geometry);
    for part in [0..70, 70..200] {
        let mut hits = Hits { t: &mut t, primitive: &mut primitive, u: &mut u, v: &mut v };
        let rays = set.rays().until(&set.t_max).beyond(&bound, &of_bound).range(part.clone());
        Tracer::new().improve::<false>(&tree, &rays, &mut hits.range(part));
    }
    let second: Vec<u32> = found.iter().map(|hits| hits.get(1).map_or(MISS, |hit| hit.1)).collect();
    assert_eq!(primitive, second);
}
