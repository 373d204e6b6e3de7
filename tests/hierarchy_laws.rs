//! Every way through the hierarchy finds what testing every primitive finds, bit for bit.

mod common;

use common::{Dice, empty, material, sphere, triangle};
use glam::Vec3;
use octray::buffers::Buffers;
use octray::bvh::Quality;
use octray::math::{Hit, MISS, Ray};
use octray::scene::{MaterialKind, Scene};
use octray::traverse::batch::{Tracer, Traversal};
use octray::traverse::hierarchy::Hierarchy;
use octray::traverse::rays::{Hits, Rays};
use octray::traverse::single::Stack;
use octray::traverse::tile::{self, CUT};
use octray::traverse::{Batch, Methods, Primitives, TraversalChoice};

#[derive(Default)]
struct Set {
    origin: [Vec<f32>; 3],
    direction: [Vec<f32>; 3],
    reach: Vec<f32>,
}

/// t, primitive, u and v of each ray, as bits.
type Answers = Vec<[u32; 4]>;

impl Set {
    fn push(&mut self, origin: Vec3, direction: Vec3, reach: f32) {
        for axis in 0..3 {
            self.origin[axis].push(origin[axis]);
            self.direction[axis].push(direction[axis]);
        }
        self.reach.push(reach);
    }
    fn rays(&self) -> Rays<'_> {
        Rays {
            origin: self.origin.each_ref().map(Vec::as_slice),
            direction: self.direction.each_ref().map(Vec::as_slice),
        }
    }
    fn through<const ANY: bool>(&self, hierarchy: &Hierarchy, traversal: Traversal) -> Answers {
        let count = self.reach.len();
        let (mut t, mut primitive) = (self.reach.clone(), vec![MISS; count]);
        let (mut u, mut v) = (vec![0.0; count], vec![0.0; count]);
        let mut hits = Hits { t: &mut t, primitive: &mut primitive, u: &mut u, v: &mut v };
        Tracer::new().trace::<ANY>(traversal, hierarchy, &self.rays(), &mut hits);
        (0..count).map(|i| [t[i].to_bits(), primitive[i], u[i].to_bits(), v[i].to_bits()]).collect()
    }
    fn goes_in_a_frustum(&self, hierarchy: &Hierarchy) -> bool {
        let (mut t, mut primitive, mut u, mut v) =
            (vec![f32::INFINITY; 256], vec![MISS; 256], vec![0.0; 256], vec![0.0; 256]);
        let mut hits = Hits { t: &mut t, primitive: &mut primitive, u: &mut u, v: &mut v };
        tile::trace(hierarchy, &self.rays().range(0..256), &mut hits, &mut Stack::new(), CUT, ())
    }
    /// Every primitive tested in order, at a width of one.
    fn linear(&self, scene: &Scene) -> Answers {
        struct All<'a>(&'a Set, &'a mut Answers);
        impl Batch<f32> for All<'_> {
            fn run(self, closest: impl Fn(&Ray<f32>) -> Hit<f32>) {
                let rays = self.0.rays();
                for at in 0..rays.len() {
                    let Hit { t, primitive, u, v } = closest(&rays.packet::<f32>(at));
                    // Testing everything knows no reach: beyond it nothing was to be found.
                    let reach = self.0.reach[at];
                    self.1.push(match primitive != MISS && t < reach {
                        true => [t.to_bits(), primitive, u.to_bits(), v.to_bits()],
                        false => [reach.to_bits(), MISS, 0, 0],
                    });
                }
            }
        }
        let methods = Methods { traversal: TraversalChoice::Linear, ..Methods::default() };
        let mut answers = Vec::new();
        let primitives = Primitives::new(scene, methods, 1);
        primitives.for_batch::<f32>(&Buffers::new(scene), None, All(self, &mut answers));
        answers
    }
    fn check(&self, scene: &Scene, what: &str) -> usize {
        let hierarchy = Hierarchy::new(scene, Quality::default());
        let expected = self.linear(scene);
        for traversal in Traversal::ALL {
            let found = self.through::<false>(&hierarchy, traversal);
            for (at, (found, expected)) in found.iter().zip(&expected).enumerate() {
                let ray = self.rays().packet::<f32>(at);
                assert_eq!(found, expected, "{what}, {}: ray {at}, {ray:?}", traversal.name());
            }
            for (at, (found, expected)) in
                self.through::<true>(&hierarchy, traversal).iter().zip(&expected).enumerate()
            {
                let any = traversal.name();
                assert_eq!(found[1] == MISS, expected[1] == MISS, "{what}, any hit, {any}: ray {at}");
            }
        }
        expected.iter().filter(|answer| answer[1] != MISS).count()
    }
}

/// Directions that divide by zero, or nearly.
fn awkward(dice: &mut Dice) -> Vec3 {
    let tiny = [0.0, -0.0, 1e-17, -1e-17, 1e-40, -1e-40, 1.0, -1.0, 0.3];
    let mut pick = || tiny[(dice.unit() * tiny.len() as f64) as usize];
    loop {
        let d = Vec3::new(pick(), pick(), pick());
        if d.length() > 0.1 {
            return d.normalize();
        }
    }
}

/// Triangles and spheres over `scales` powers of ten around a centre, slivers among them.
fn mixture(dice: &mut Dice, triangles: usize, spheres: usize, scales: f64, offset: f32) -> Scene {
    let mut scene = Scene { materials: vec![material(MaterialKind::Diffuse)], ..empty() };
    let mut number = |range: f64| ((2.0 * dice.unit() - 1.0) * range) as f32;
    let mut point = |range: f32| Vec3::new(number(1.0), number(1.0), number(1.0)) * range;
    for i in 0..triangles + spheres {
        let size = 10f32.powf(-(scales as f32) * (i % 7) as f32 / 6.0);
        let center = point(4.0) + offset;
        if i < spheres {
            scene.spheres.push(sphere(center, 0.3 * size, 0));
        } else {
            let long = if i % 5 == 0 { 1e-4 } else { 1.0 };
            let (a, b) = (point(size), point(size * long));
            if a.cross(b).length() > 0.0 {
                scene.triangles.push(triangle([center, center + a, center + a * 0.5 + b], 0));
            }
        }
    }
    scene
}

#[test]
fn every_traversal_equals_testing_every_primitive() {
    let mut dice = Dice(11);
    let mut hits = 0;
    for (triangles, spheres, scales, offset) in [
        (1, 0, 0.0, 0.0),
        (0, 1, 0.0, 0.0),
        (5, 3, 0.0, 0.0),
        (300, 0, 1.0, 0.0),
        (0, 300, 2.0, 0.0),
        (400, 200, 3.0, 0.0),
        (300, 100, 1.0, 1000.0),
        (2000, 0, 2.0, 0.0),
    ] {
        let scene = mixture(&mut dice, triangles, spheres, scales, offset);
        let mut set = Set::default();
        let corners: Vec<Vec3> = scene.triangles.iter().flat_map(|triangle| triangle.vertices).collect();
        for i in 0..6000 {
            let number = |dice: &mut Dice| (8.0 * dice.unit() - 4.0) as f32;
            let mut origin =
                Vec3::new(number(&mut dice), number(&mut dice), number(&mut dice)) * 1.5 + offset;
            // At a corner, towards a corner, in the plane of a box's face.
            let corner = corners.get((dice.unit() * corners.len() as f64) as usize).copied();
            if let Some(corner) = corner {
                match i % 8 {
                    0 => origin = corner,
                    1 => origin.x = corner.x,
                    _ => {}
                }
            }
            let direction = match i % 3 {
                0 => awkward(&mut dice),
                1 => corner.map_or(dice.direction().as_vec3(), |corner| {
                    (corner - origin).try_normalize().unwrap_or(Vec3::X)
                }),
                _ => dice.direction().as_vec3(),
            };
            let reach = if i % 5 == 0 { (4.0 * dice.unit()) as f32 } else { f32::INFINITY };
            set.push(origin, direction, reach);
        }
        hits += set.check(
            &scene,
            &format!("{triangles} triangles, {spheres} spheres, {scales} decades at {offset}"),
        );
    }
    assert!(hits > 3_000, "only {hits} rays hit anything");
}

#[test]
fn frustum_equals_testing_every_primitive() {
    let mut dice = Dice(12);
    for offset in [0.0, 300.0] {
        let scene = mixture(&mut dice, 900, 60, 1.0, offset);
        for axis in 0..6 {
            // A tile of rays from one origin along each axis, forwards and backwards, wide and narrow.
            for spread in [0.9, 0.1, 0.001] {
                let main = Vec3::AXES[axis % 3] * if axis < 3 { 1.0 } else { -1.0 };
                let (right, up) = (Vec3::AXES[(axis + 1) % 3], Vec3::AXES[(axis + 2) % 3]);
                let origin = -main * 6.0 + offset + dice.direction().as_vec3();
                let mut set = Set::default();
                for i in 0..512 {
                    let (x, y) = ((i % 16) as f32 / 8.0 - 1.0, (i / 16 % 16) as f32 / 8.0 - 1.0);
                    set.push(origin, (main + (right * x + up * y) * spread).normalize(), f32::INFINITY);
                }
                // These are rays for which there is a frustum.
                let hierarchy = Hierarchy::new(&scene, Quality::default());
                assert!(set.goes_in_a_frustum(&hierarchy), "axis {axis}, spread {spread}");
                set.check(&scene, &format!("axis {axis}, spread {spread}, offset {offset}"));
            }
        }
    }
}

#[test]
fn rays_that_are_none_miss_and_a_hit_at_the_reach_is_none() {
    let mut scene = mixture(&mut Dice(14), 40, 1, 0.0, 0.0);
    scene.spheres.push(sphere(Vec3::new(10.0, 0.0, 0.0), 1e-18, 0));
    let mut set = Set::default();
    let (nan, infinity) = (f32::NAN, f32::INFINITY);
    for direction in [Vec3::NAN, Vec3::ZERO, Vec3::new(0.0, 0.0, nan), Vec3::new(nan, 1.0, 0.0)] {
        set.push(Vec3::ONE, direction, infinity);
    }
    for origin in [Vec3::NAN, Vec3::INFINITY, Vec3::new(-20.0, 0.0, 0.0), Vec3::new(0.0, -20.0, 0.0)] {
        set.push(origin, Vec3::X, infinity);
        set.push(origin, Vec3::Y, infinity);
        set.push(origin, Vec3::Z, infinity);
    }
    let mut dice = Dice(15);
    let first = set.reach.len();
    for _ in 0..500 {
        set.push(dice.direction().as_vec3() * 8.0, dice.direction().as_vec3(), infinity);
    }
    set.check(&scene, "no rays at all");
    let answers = set.linear(&scene);
    for (reach, answer) in set.reach[first..].iter_mut().zip(&answers[first..]) {
        *reach = f32::from_bits(answer[0]);
    }
    set.check(&scene, "reaches that end at the hit");
}

/// A closed ball of triangles around the origin: no ray from inside may leave it, above all not through edges and vertices.
#[test]
fn closed_meshes_do_not_leak() {
    let mut scene = Scene { materials: vec![material(MaterialKind::Diffuse)], ..empty() };
    let (rows, columns) = (24, 32);
    let point = |row: usize, column: usize| {
        let (theta, phi) = (
            std::f32::consts::PI * row as f32 / rows as f32,
            std::f32::consts::TAU * (column % columns) as f32 / columns as f32,
        );
        let around = if row == 0 || row == rows { 0.0 } else { theta.sin() };
        Vec3::new(around * phi.cos(), theta.cos(), around * phi.sin()) * 2.0 + Vec3::new(0.1, 0.2, 0.3)
    };
    let mut targets = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let [a, b, c, d] = [
                point(row, column),
                point(row, column + 1),
                point(row + 1, column),
                point(row + 1, column + 1),
            ];
            for corners in [[a, b, c], [b, d, c]] {
                if (corners[1] - corners[0]).cross(corners[2] - corners[0]).length() > 0.0 {
                    scene.triangles.push(triangle(corners, 0));
                    targets.push(corners);
                }
            }
        }
    }
    let hierarchy = Hierarchy::new(&scene, Quality::default());
    let mut dice = Dice(13);
    let mut set = Set::default();
    for i in 0..400_000 {
        let [a, b, _] = targets[(dice.unit() * targets.len() as f64) as usize];
        let target = if i % 3 == 0 { a } else { a.lerp(b, dice.unit() as f32) };
        let origin = (dice.direction() * 0.9 * dice.unit()).as_vec3();
        set.push(origin, (target - origin).normalize(), f32::INFINITY);
    }
    for traversal in Traversal::ALL {
        let leaks =
            set.through::<false>(&hierarchy, traversal).iter().filter(|answer| answer[1] == MISS).count();
        assert_eq!(leaks, 0, "{}", traversal.name());
    }
    // Together from one point, as a camera's rays.
    let mut tile = Set::default();
    for i in 0..40_960 {
        let [a, b, _] = targets[(i * 7 / 256) % targets.len()];
        let target = a.lerp(b, dice.unit() as f32);
        tile.push(Vec3::ZERO, (target).normalize(), f32::INFINITY);
    }
    for traversal in Traversal::ALL {
        let leaks =
            tile.through::<false>(&hierarchy, traversal).iter().filter(|answer| answer[1] == MISS).count();
        assert_eq!(leaks, 0, "{}", traversal.name());
    }
}
