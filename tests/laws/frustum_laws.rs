//! Camera rays by the tile find what testing every primitive finds, bit for bit: with reaches, with hits from
//! before, in tiles that are not full, beside rays that are odd, and among primitives that are tiny or far
//! away. The other traversals are held to it as well.

use crate::common::rays::{Set, mixture};
use crate::common::*;
use glam::Vec3Swizzles;
use octray::rays::traverse::stream::BATCH;
use octray::rays::traverse::tile::TILE;

/// Directions of a camera's tile around one axis, forwards or backwards, and where it stands.
struct View {
    main: Vec3,
    right: Vec3,
    up: Vec3,
    origin: Vec3,
    spread: f32,
}

impl View {
    fn along(rng: &mut Rng, axis: usize, spread: f32, offset: f32) -> Self {
        let main = Vec3::AXES[axis % 3] * if axis < 3 { 1.0 } else { -1.0 };
        let (right, up) = (Vec3::AXES[(axis + 1) % 3], Vec3::AXES[(axis + 2) % 3]);
        let origin = -main * 6.0 + offset + rng.direction().as_vec3();
        Self { main, right, up, origin, spread }
    }
    /// Of a tile's ray.
    fn direction(&self, i: usize) -> Vec3 {
        let (x, y) = ((i % 16) as f32 / 8.0 - 1.0, (i / 16 % 16) as f32 / 8.0 - 1.0);
        (self.main + (self.right * x + self.up * y) * self.spread).normalize()
    }
    fn rays(&self, count: usize) -> Set {
        let mut set = Set::default();
        (0..count).for_each(|i| set.push(self.origin, self.direction(i), f32::INFINITY));
        set
    }
}

fn hierarchy(scene: &Scene) -> Hierarchy {
    Hierarchy::new(&scene.geometry(), Trees::WideAndBinary)
}

/// Gives one ray of a set another origin or direction.
fn put(column: &mut [Vec<f32>; 3], at: usize, value: Vec3) {
    (0..3).for_each(|axis| column[axis][at] = value[axis]);
}

#[test]
fn frustum_equals_testing_every_primitive() {
    let mut rng = Rng(12);
    for offset in [0.0, 300.0] {
        let scene = mixture(&mut rng, 900, 60, 1.0, offset);
        for axis in 0..6 {
            for spread in [0.9, 0.1, 0.001] {
                let set = View::along(&mut rng, axis, spread, offset).rays(2 * TILE);
                assert!(set.goes_in_a_frustum(&hierarchy(&scene)), "axis {axis}, spread {spread}");
                set.check(&scene, &format!("axis {axis}, spread {spread}, offset {offset}"));
                // From among the primitives: some boxes begin behind the camera.
                let view = View::along(&mut rng, axis, spread, offset);
                let origin = Vec3::splat(offset) + rng.in_cube().as_vec3();
                let set = View { origin, ..view }.rays(TILE);
                assert!(set.goes_in_a_frustum(&hierarchy(&scene)), "axis {axis}, spread {spread}, within");
                set.check(&scene, &format!("axis {axis}, spread {spread}, offset {offset}, within"));
            }
        }
    }
}

/// One call of more than two batches: tiles that see little, tiles that see much, and rays without order, in
/// turn.
#[test]
fn long_calls_of_all_sorts_of_tiles_find_what_each_would() {
    let mut rng = Rng(68);
    let scene = mixture(&mut rng, 3000, 100, 1.0, 0.0);
    let mut set = Set::default();
    let count = 2 * BATCH + TILE + 3;
    let mut view = View::along(&mut rng, 0, 0.9, 0.0);
    for i in 0..count {
        if i % TILE == 0 {
            view = View::along(&mut rng, i / TILE, [0.9, 0.001][i / TILE % 2], 0.0);
        }
        match i / TILE % 5 {
            4 => set.push(rng.in_cube().as_vec3() * 5.0, rng.direction().as_vec3(), f32::INFINITY),
            _ => set.push(view.origin, view.direction(i), f32::INFINITY),
        }
    }
    assert!(set.check(&scene, "long call") > count / 10);
}

/// So far away that the sides' bounds are infinite, beside fewer boxes than a node holds.
#[test]
fn frustum_of_infinite_bounds_meets_no_box_that_is_not_there() {
    let mut rng = Rng(69);
    let scene = mixture(&mut rng, 2, 0, 0.0, 0.0);
    let mut set = Set::default();
    for (x, y) in [(0, 0), (1, 1), (1, -1), (-1, 1), (-1, -1), (1, 0), (0, 1), (0, 0)] {
        set.push(Vec3::Z * -1e38, vec3(100.0 * x as f32, 100.0 * y as f32, 1.0), f32::INFINITY);
    }
    assert!(set.goes_in_a_frustum(&hierarchy(&scene)));
    set.check(&scene, "from far away");
}

#[test]
fn rays_of_two_origins_go_in_no_frustum() {
    let mut rng = Rng(62);
    let scene = mixture(&mut rng, 900, 60, 1.0, 0.0);
    let hierarchy = hierarchy(&scene);
    for ray in [0, TILE - 1] {
        for axis in 0..3 {
            let mut set = View::along(&mut rng, 4, 0.5, 0.0).rays(TILE);
            assert!(set.goes_in_a_frustum(&hierarchy));
            set.origin[axis][ray] += 1e-3;
            assert!(!set.goes_in_a_frustum(&hierarchy), "ray {ray}, axis {axis}");
        }
    }
}

#[test]
fn frustum_keeps_to_the_reach_of_each_ray() {
    let mut rng = Rng(61);
    let scene = mixture(&mut rng, 900, 60, 1.0, 0.0);
    let mut hits = 0;
    for axis in 0..6 {
        let mut set = View::along(&mut rng, axis, 0.5, 0.0).rays(4 * TILE);
        let nearest = set.linear(&scene);
        for (i, t_max) in set.t_max.iter_mut().enumerate() {
            let t = f32::from_bits(nearest[i][0]);
            // In the second tile all rays are short; in the third only one is long; in the fourth all end at
            // the hit or beside it.
            *t_max = match (i / TILE, i % 8) {
                (0, 0) => 0.0,
                (0, 1) => f32::MIN_POSITIVE,
                (0, _) => (12.0 * rng.unit()) as f32,
                (1, _) => (5.0 + rng.unit()) as f32,
                (2, _) if i % TILE == 77 => f32::INFINITY,
                (2, _) => 0.5,
                (_, 0) => t,
                (_, 1) => t.next_down(),
                (_, 2) => t.next_up(),
                _ => f32::INFINITY,
            };
        }
        assert!(set.goes_in_a_frustum(&hierarchy(&scene)));
        hits += set.check(&scene, &format!("reaches, axis {axis}"));
    }
    assert!(hits > 500, "{hits}");
}

#[test]
fn frustum_improves_hits_from_before() {
    let mut rng = Rng(62);
    let mut scene = mixture(&mut rng, 500, 60, 1.0, 0.0);
    // Every triangle twice: equal distances, of which the lower number wins.
    scene.triangles.extend_from_slice(&scene.triangles.clone());
    let count = scene.spheres.len() + scene.triangles.len();
    for axis in 0..6 {
        let mut set = View::along(&mut rng, axis, 0.5, 0.0).rays(2 * TILE);
        let nearest = set.linear(&scene);
        for (i, &[t, primitive, ..]) in nearest.iter().enumerate() {
            let t = f32::from_bits(t);
            // As near as the nearest, by another number or the same; nearer; further.
            (set.t_max[i], set.primitive[i]) = match i % 6 {
                0 => (t, count as u32 + 7),
                1 => (t, 0),
                2 if primitive != MISS => (t, primitive),
                3 => (0.9 * t, 3),
                4 => (1.1 * t, 3),
                _ => (f32::INFINITY, MISS),
            };
            if set.t_max[i].is_infinite() {
                set.primitive[i] = MISS;
            }
        }
        assert!(set.goes_in_a_frustum(&hierarchy(&scene)));
        set.check(&scene, &format!("hits from before, axis {axis}"));
    }
}

#[test]
fn tiles_need_not_be_full() {
    let mut rng = Rng(63);
    let scene = mixture(&mut rng, 300, 30, 1.0, 0.0);
    for count in [1, 7, 8, 9, 31, 64, 200, 250, 255, 256, 257, 263, 264, 265, 511, 519, 520] {
        let set = View::along(&mut rng, count % 6, 0.7, 0.0).rays(count);
        let whole = count.min(TILE).is_multiple_of(8);
        assert_eq!(set.goes_in_a_frustum(&hierarchy(&scene)), whole, "{count}");
        set.check(&scene, &format!("{count} rays"));
    }
}

#[test]
fn one_odd_ray_harms_no_other() {
    let mut rng = Rng(64);
    let scene = mixture(&mut rng, 500, 30, 1.0, 0.0);
    let nan = f32::NAN;
    // Along every axis both ways.
    for round in 0..6 {
        let view = View::along(&mut rng, round, 0.4, 0.0);
        let odd = [
            (view.origin + Vec3::ONE, view.main),
            (Vec3 { x: view.origin.x.next_up(), ..view.origin }, view.main),
            (Vec3::NAN, view.main),
            (Vec3 { y: nan, ..view.origin }, view.main),
            (Vec3::INFINITY, view.main),
            (view.origin, -view.main),
            (view.origin, view.right),
            (view.origin, Vec3::NAN),
            (view.origin, view.main * nan),
            (view.origin, Vec3::ZERO),
        ];
        for (what, (origin, direction)) in odd.into_iter().enumerate() {
            // The first ray, which tells the axis; one within; the last.
            for place in [0, 1 + rng.index(TILE - 2), TILE - 1] {
                let mut set = view.rays(TILE);
                put(&mut set.origin, place, origin);
                put(&mut set.direction, place, direction);
                set.check(&scene, &format!("round {round}, odd ray {what} at {place}"));
            }
        }
    }
}

/// What such rays hit themselves is not asked: their lengths are outside the domain, or they are none.
#[test]
fn rays_without_finite_slopes_harm_no_other() {
    let mut rng = Rng(65);
    let scene = mixture(&mut rng, 500, 0, 1.0, 0.0);
    let hierarchy = hierarchy(&scene);
    for axis in 0..6 {
        let view = View::along(&mut rng, axis, 0.4, 0.0);
        // The first ray, which tells the axis; one along it; one above it; one anywhere; the last.
        for place in [0, 136, 8, 1 + rng.index(TILE - 2), TILE - 1] {
            let own = view.direction(place);
            let lengths = [1e-30, 1e-38, 1e-40, 1e-44, 1e30, 1e38].map(|length| own * length);
            let nan = f32::NAN;
            let nans = [Vec3 { x: nan, ..own }, Vec3 { y: nan, ..own }, Vec3 { z: nan, ..own }];
            for direction in lengths.into_iter().chain(nans) {
                let mut set = view.rays(TILE);
                let expected = set.linear(&scene);
                put(&mut set.direction, place, direction);
                for traversal in Traversal::ALL {
                    let found = set.through::<false>(&hierarchy, traversal);
                    for at in (0..TILE).filter(|&at| at != place) {
                        let name = TraversalChoice::Through(traversal).name();
                        assert_eq!(found[at], expected[at], "{name}: ray {at}, {direction} at {place}");
                    }
                }
            }
        }
    }
}

/// Far spheres make large paddings, tiny ones once made infinite ones.
#[test]
fn tiny_and_far_spheres_among_triangles_change_nothing() {
    let mut rng = Rng(66);
    for (far, tiny) in [(false, true), (true, false), (true, true)] {
        let mut scene = mixture(&mut rng, 300, 20, 1.0, 0.0);
        for i in 0..12 {
            let towards = rng.direction().as_vec3();
            if tiny {
                scene.spheres.push(sphere(towards * 3.0, [1e-18, 1e-9, 1e-5][i % 3], 0));
            }
            if far {
                scene.spheres.push(sphere(towards * 1e6, [1e-18, 1.0, 3e5][i % 3], 0));
            }
        }
        let corner = vec3(2e-3, 1e-3, 0.0);
        scene.triangles.push(triangle([Vec3::ZERO, corner, corner.yzx()], 0));
        for axis in 0..6 {
            for spread in [0.9, 0.01] {
                let view = View::along(&mut rng, axis, spread, 0.0);
                let mut set = view.rays(TILE);
                // Some at the spheres themselves, as far as they lie on the tile's side; not the first, which
                // tells the axis.
                for i in 1..TILE / 2 {
                    let target = scene.spheres[i % scene.spheres.len()].center;
                    let direction = (target - view.origin).normalize();
                    if direction.dot(view.main) > 0.1 {
                        put(&mut set.direction, i, direction);
                    }
                }
                assert!(set.goes_in_a_frustum(&hierarchy(&scene)));
                let what = format!("far {far}, tiny {tiny}, axis {axis}, spread {spread}");
                assert!(set.check(&scene, &what) > 0);
            }
        }
        // And from everywhere to everywhere.
        let mut set = Set::default();
        for i in 0..2000 {
            let origin = rng.direction().as_vec3() * [1e-3, 4.0, 1e5, 2e6][i % 4];
            let target =
                scene.spheres[rng.index(scene.spheres.len())].center + rng.direction().as_vec3() * 1e-3;
            set.push(origin, (target - origin).normalize(), f32::INFINITY);
        }
        set.check(&scene, &format!("far {far}, tiny {tiny}, from everywhere"));
    }
}
