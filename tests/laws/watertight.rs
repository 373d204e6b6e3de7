//! Watertight by default: rays from inside closed meshes, aimed at points on shared edges, at shared vertices
//! and anywhere, hit the mesh, through every traversal. A leak is a ray that hits nothing, or what is
//! outside.
//!
//! A million rays: `cargo test -p octray-tests --test laws watertight -- --ignored --nocapture`.

use crate::common::rays::Set;
use crate::common::*;
use octray::measure::stability::meshes::bumpy_ball;
use octray::rays::kind::triangle::Layout;
use octray::rays::traverse::tile::TILE;
use rayon::prelude::*;
use std::collections::HashMap;
use std::time::Instant;

type Corners = [Vec3; 3];

/// A closed mesh, and how to get inside.
struct Mesh {
    name: &'static str,
    triangles: Vec<Corners>,
    /// Triangles that are around `triangles` but none of the mesh: to hit them is to leak.
    outside: Vec<Corners>,
    inside: Inside,
}

enum Inside {
    /// In the middle of a star: so far around a point.
    Ball(DVec3, f64),
    /// This far behind any triangle.
    Behind(f64),
}

/// Every edge is there once in each direction, and nothing has no area.
fn assert_closed(name: &str, triangles: &[Corners]) {
    let mut edges: HashMap<[[u32; 3]; 2], i32> = HashMap::new();
    let bits = |v: Vec3| v.to_array().map(|x| (x + 0.0).to_bits());
    for &[a, b, c] in triangles {
        let [x, y, z] = [a, b, c].map(Vec3::as_dvec3);
        assert!((y - x).cross(z - x).length() > 0.0, "{name}: no area");
        for [from, to] in [[a, b], [b, c], [c, a]] {
            *edges.entry([bits(from), bits(to)]).or_default() += 1;
            *edges.entry([bits(to), bits(from)]).or_default() -= 1;
        }
    }
    assert!(edges.values().all(|&surplus| surplus == 0), "{name} is not closed");
}

fn moved(triangles: &[Corners], by: impl Fn(DVec3) -> DVec3) -> Vec<Corners> {
    triangles.iter().map(|corners| corners.map(|corner| by(corner.as_dvec3()).as_vec3())).collect()
}

fn cuboid(half: DVec3, turned: bool) -> Vec<Corners> {
    let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 0.8, 0.5);
    let corner = |i: usize| {
        let sign = |bit: usize| if i & bit == 0 { -1.0 } else { 1.0 };
        let corner = half * dvec3(sign(1), sign(2), sign(4));
        (if turned { turn * corner } else { corner }).as_vec3()
    };
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).map(|corners| corners.map(corner)).collect()
}

fn meshes() -> Vec<Mesh> {
    let ball = bumpy_ball(40);
    let mesh = |name, triangles, inside| Mesh { name, triangles, outside: Vec::new(), inside };
    let around = |radius: f64| Inside::Ball(DVec3::ZERO, radius);
    let scaled = |by: DVec3| moved(&ball, |point| point * by);
    let flattened = |by: DVec3| moved(&bumpy_ball(24), |point| point * by);
    let knot = octray::scene::load("builtin:knot:20000").unwrap();
    let knot = knot.triangles.iter().map(|triangle| triangle.vertices).collect();
    // Shells in each other over twelve powers of ten: who is in the innermost hits it and none of the others.
    // Coarse ones: padding goes by the largest, so that every triangle near the middle is tested.
    let coarse = bumpy_ball(5);
    let shells = [1e-6, 1e-3, 1.0, 1e3, 1e6].map(|scale| moved(&coarse, |point| point * scale));
    let far = dvec3(500.0, -300.0, 700.0);
    vec![
        mesh("ball", ball.clone(), around(0.6)),
        mesh("needles", flattened(dvec3(1.0, 1e-4, 1e3)), around(5e-5)),
        mesh("slices", flattened(dvec3(1e-3, 30.0, 1e-3)), around(5e-4)),
        mesh("tiny", scaled(DVec3::splat(1e-6)), around(6e-7)),
        mesh("huge", scaled(DVec3::splat(1e6)), around(6e5)),
        mesh("far", moved(&ball, |point| point + far), Inside::Ball(far, 0.6)),
        mesh("box along the axes", cuboid(dvec3(1.0, 2.0, 0.5), false), around(0.4)),
        mesh("turned box", cuboid(dvec3(1.0, 1e-3, 3.0), true), around(5e-4)),
        mesh("knot", knot, Inside::Behind(0.08)),
        Mesh {
            name: "shells",
            triangles: shells[0].clone(),
            outside: shells[1..].concat(),
            inside: around(5e-7),
        },
    ]
}

impl Mesh {
    fn scene(&self) -> Scene {
        let triangles = self.triangles.iter().chain(&self.outside).map(|&corners| triangle(corners, 0));
        Scene { triangles: triangles.collect(), ..diffuse() }
    }

    /// A point inside, near this triangle where the mesh is no star.
    fn origin(&self, rng: &mut Rng, near: usize) -> Vec3 {
        match self.inside {
            Inside::Ball(center, radius) => (center + rng.direction() * (radius * rng.unit())).as_vec3(),
            Inside::Behind(depth) => {
                let [a, b, c] = self.triangles[near].map(Vec3::as_dvec3);
                let inwards = -(b - a).cross(c - a).normalize();
                ((a + b + c) / 3.0 + inwards * (depth * (0.5 + rng.unit()))).as_vec3()
            }
        }
    }

    /// On an edge, at a vertex, or, one time in eight, on a triangle: in f64, where it is on both sides of
    /// the edge.
    fn target(&self, rng: &mut Rng, number: usize) -> DVec3 {
        let mut corners = self.triangles[number].map(Vec3::as_dvec3);
        corners.rotate_left(rng.index(3));
        let [a, b, c] = corners;
        match rng.index(8) {
            0 => {
                let [u, v, w] = rng.barycentrics();
                a * u + b * v + c * w
            }
            1..=3 => a,
            _ => a + (b - a) * rng.unit(),
        }
    }

    /// As many rays; whole tiles from one origin through neighbouring triangles, as a camera's, by turns with
    /// rays that have nothing in common.
    fn rays(&self, rng: &mut Rng, count: usize) -> Set {
        let mut set = Set::default();
        let all = self.triangles.len();
        while set.len() < count {
            let (first, together) = (rng.index(all), rng.index(2) == 0);
            let shared = self.origin(rng, first);
            let towards = |origin: Vec3, target: DVec3| (target - origin.as_dvec3()).normalize();
            // A tile's first ray tells the axis of its frustum, the others run along it.
            let ahead = towards(shared, self.target(rng, first));
            let main = ahead.abs().max_position();
            for i in 0..TILE {
                // The knot hides what is further along it.
                let near = |rng: &mut Rng| (first + rng.index(400.min(all))) % all;
                let ray = if together {
                    let along = |d: &DVec3| i > 0 && d[main] * ahead[main].signum() > 0.01;
                    let mut aim = |_| {
                        let number = near(rng);
                        towards(shared, self.target(rng, number))
                    };
                    (shared, (0..8).map(&mut aim).find(along).unwrap_or(ahead))
                } else {
                    let number = near(rng);
                    let origin = self.origin(rng, number);
                    (origin, towards(origin, self.target(rng, number)))
                };
                set.push(ray.0, ray.1.as_vec3(), f32::INFINITY);
            }
        }
        set
    }
}

/// Traces about so many rays through every traversal; returns how many there were.
fn find_leaks(rays: usize) {
    /// Rays that are made and traced at a time.
    const BATCH: usize = 32 * TILE;
    let meshes = meshes();
    let batches = rays.div_ceil(BATCH * meshes.len());
    for mesh in &meshes {
        assert_closed(mesh.name, &mesh.triangles);
        let start = Instant::now();
        let [hierarchy, compact] = [Layout::Full, Layout::Compact]
            .map(|layout| Hierarchy::in_layout(&mesh.scene().geometry(), Trees::WideAndBinary, Some(layout)));
        let count = mesh.triangles.len() as u32;
        (0..batches).into_par_iter().for_each(|batch| {
            let set = mesh.rays(&mut Rng(0x9e37_79b9_7f4a_7c15 ^ (batch as u64 + 1)), BATCH);
            let full = Traversal::ALL.into_iter().map(|traversal| (&hierarchy, traversal));
            for (hierarchy, traversal) in full.chain([(&compact, Traversal::Hybrid)]) {
                let found =
                    [set.through::<false>(hierarchy, traversal), set.through::<true>(hierarchy, traversal)];
                for (any, found) in found.into_iter().enumerate() {
                    // Any hit may be one of what is outside.
                    let leaks = |[_, primitive, ..]: &[u32; 4]| {
                        *primitive == MISS || (any == 0 && *primitive >= count)
                    };
                    let leaking: Vec<usize> = (0..set.len()).filter(|&at| leaks(&found[at])).collect();
                    let ray = leaking.first().map(|&at| set.rays().packet::<f32>(at));
                    let number = leaking.len();
                    assert_eq!(
                        number,
                        0,
                        "{}, {}, any {any}: {ray:?}",
                        mesh.name,
                        TraversalChoice::Through(traversal).name()
                    );
                }
            }
        });
        println!("{}: {} rays, {:.1?}", mesh.name, batches * BATCH, start.elapsed());
    }
}

/// 8,192 rays at each mesh, through each traversal twice: a method that leaks one ray in 2,700 of any of them
/// is found nineteen times in twenty (Möller–Trumbore's test leaks one in 330 and more).
#[test]
fn aimed_rays_do_not_leak() {
    find_leaks(80_000);
}

/// A leak of one ray in 34,000 is found nineteen times in twenty. `LEAK_RAYS` gives another number of rays:
/// ten million find one in 340,000.
#[test]
#[ignore = "minutes: run by .ci/run"]
fn a_million_aimed_rays_do_not_leak() {
    let rays = std::env::var("LEAK_RAYS").map_or(1_000_000, |rays| rays.parse().expect("a number of rays"));
    find_leaks(rays);
}

/// Half of the tiles are such that there is a frustum: else it would not have been tested.
#[test]
fn tiles_of_aimed_rays_go_in_frusta() {
    for mesh in meshes() {
        let hierarchy = Hierarchy::new(&mesh.scene().geometry(), Trees::WideAndBinary);
        let mut rng = Rng(5);
        let go = (0..100).filter(|_| mesh.rays(&mut rng, TILE).goes_in_a_frustum(&hierarchy)).count();
        assert!(go > 25, "{}: {go} of 100 tiles", mesh.name);
    }
}
