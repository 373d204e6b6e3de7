//! Whole scenes: things of all sizes in one, and surfaces that coincide.

use super::aim::ray;
use super::spheres::{Ball, truth};
use super::{Bound, Dice, Method, Recipe, Tally};
use crate::buffers::{LightChoice, store_triangles};
use crate::kernel::ray_triangle::{TriangleMethod, Woop};
use crate::math::MISS;
use crate::render::{PrimaryHit, Renderer, Settings};
use crate::sampling::Sampler;
use crate::scene::{Camera, Material, MaterialKind, Scene, Side, Sky, Sphere, Triangle};
use crate::traverse::batch::Traversal;
use crate::traverse::{BoxChoice, Methods, SphereChoice, TraversalChoice, TriangleChoice};
use glam::{DQuat, DVec3, Vec3};
use std::f64::consts::TAU;

pub const RECIPES: &[Recipe] = &[
    Recipe {
        name: "scenes-mixed",
        title: "A small ball that lies on a huge one, seen from a thousand times its size away",
        axis: "radius of the huge ball / radius of the small one",
        places: &[1.0, 1e2, 1e3, 1e4, 1e5, 1e6, 3e6, 1e7, 3e7, 1e8],
        failure: "the small ball is not seen where it is a tenth of its radius in front",
        error: None,
        source: "errors that grow with the largest thing hide the smallest",
        cases: 50_000,
        methods: &[
            Method::other("naive", |dice, x, cases| mixed(dice, x, cases, Way::NAIVE)),
            Method::default("robust", |dice, x, cases| mixed(dice, x, cases, Way::NEEDED)),
        ],
        // Along the ray, the huge ball's surface is misplaced by some ε of its radius; above, nothing is promised.
        bound: |ratio| if ratio <= 1e5 { Bound::NO_FAILURE } else { Bound::NONE },
    },
    Recipe {
        name: "scenes-coplanar",
        title: "Triangles that coincide, in any order, at both widths and by every way through the hierarchy",
        axis: "triangles in one place",
        places: &[2.0, 4.0, 16.0, 64.0],
        failure: "not the first of those in one place is seen",
        error: None,
        source: "equal t: whoever is met first or last wins, unless a rule decides",
        cases: 20_000,
        methods: &[
            Method::other("first-met", |dice, x, cases| coplanar(dice, x, cases, first_met)),
            Method::default("lower-index", |dice, x, cases| coplanar(dice, x, cases, renderer)),
        ],
        bound: |_| Bound::NO_FAILURE,
    },
];

/// How a scene is looked at.
#[derive(Clone, Copy)]
pub struct Way {
    methods: Methods,
    lanes: usize,
}

impl Way {
    const fn with(sphere: SphereChoice, triangle: TriangleChoice, traversal: TraversalChoice) -> Self {
        let (lights, sampler) = (LightChoice::Off, Sampler::Sobol);
        let boxes = BoxChoice::PaddedFma;
        Self { methods: Methods { sphere, triangle, boxes, traversal, lights, sampler }, lanes: 8 }
    }
    /// The school's equations.
    const NAIVE: Self =
        Self::with(SphereChoice::Naive, TriangleChoice::MollerTrumbore, TraversalChoice::Linear);
    /// The default equations, every primitive tested.
    pub const LINEAR: Self = Self::with(SphereChoice::Robust, TriangleChoice::Woop, TraversalChoice::Linear);
    /// As pictures are made.
    pub const NEEDED: Self = Self::with(SphereChoice::Robust, TriangleChoice::Woop, TraversalChoice::Needed);
}

/// Nothing, and one matt material.
pub fn empty() -> Scene {
    let matt = Material {
        name: "matt".into(),
        kind: MaterialKind::Diffuse,
        color: Vec3::ONE,
        texture: None,
        roughness_map: None,
        normal_map: None,
        emission: Vec3::ZERO,
    };
    Scene {
        name: "recipe".into(),
        camera: Camera { position: Vec3::ZERO, look_at: Vec3::Z, up: Vec3::Y, vertical_fov: 90.0 },
        resolution: [16, 16],
        max_bounces: 1,
        sky: Sky::Color(Vec3::ONE),
        materials: vec![matt],
        textures: Vec::new(),
        spheres: Vec::new(),
        triangles: Vec::new(),
        uvs: Vec::new(),
        normals: Vec::new(),
        warnings: Vec::new(),
        files: Vec::new(),
    }
}

pub fn triangle(vertices: [Vec3; 3]) -> Triangle {
    Triangle { vertices, material: 0 }
}

/// The scene's camera rays and their answers.
pub fn seen(scene: &Scene, way: Way) -> Vec<PrimaryHit> {
    let settings = Settings { methods: way.methods, lanes: way.lanes, ..Settings::of(scene) };
    Renderer::new(scene, settings).primary_hits(0)
}

/// The small ball fills the picture's height, down to where it touches the huge one.
fn mixed(dice: &mut Dice, ratio: f64, cases: usize, way: Way) -> Tally {
    let mut tally = Tally::default();
    while tally.tested < cases {
        let small = dice.scale(1e-3, 1.0);
        let (up, contact) = (dice.direction(), dice.in_cube() * small);
        let ball = |height: f64, radius: f64| Ball {
            center: (contact + up * height).as_vec3(),
            radius: radius as f32,
        };
        let balls = [ball(-ratio * small, ratio * small), ball(small, small)];
        let along = up.cross(dice.direction()).normalize();
        let eye = contact + (up * dice.scale(0.5, 5.0) + along).normalize() * (1000.0 * small);
        let mut scene = empty();
        scene.spheres = balls.map(|Ball { center, radius }| sphere(center, radius)).into();
        let (position, look_at) = (eye.as_vec3(), balls[1].center);
        scene.camera = Camera { position, look_at, up: along.cross(up).as_vec3(), vertical_fov: 0.12 };
        for hit in seen(&scene, way) {
            let ray = ray(hit.origin.into(), hit.direction.into());
            let [ground, nearest] = balls.map(|ball| truth(ball, &ray).unwrap_or(f64::INFINITY));
            if nearest + 0.1 * small < ground && tally.tested < cases {
                tally.count(hit.primitive != 1);
            }
        }
    }
    tally
}

/// A ball of the first material.
pub fn sphere(center: Vec3, radius: f32) -> Sphere {
    Sphere { center, radius, material: 0, texture_turn: 0.0, texture_side: Side::Outside }
}

/// Triangles in different places of a wall, several in each, shuffled; and which place each is in.
fn wall(dice: &mut Dice, copies: f64) -> (Scene, Vec<usize>) {
    const PLACES: usize = 12;
    let (depth, slope) = (dice.scale(1.0, 100.0), dice.direction());
    let corner = |dice: &mut Dice| {
        let (x, y) = (1.2 * depth * dice.signed(), 1.2 * depth * dice.signed());
        DVec3::new(x, y, depth + 0.3 * (slope.x * x + slope.y * y)).as_vec3()
    };
    let places: Vec<[Vec3; 3]> = (0..PLACES).map(|_| [(); 3].map(|()| corner(dice))).collect();
    let mut order: Vec<usize> = (0..PLACES * copies as usize).map(|number| number % PLACES).collect();
    shuffle(&mut order, dice);
    (Scene { triangles: order.iter().map(|&place| triangle(places[place])).collect(), ..empty() }, order)
}

/// Source: Knuth, The Art of Computer Programming vol. 2, algorithm P.
fn shuffle<T>(values: &mut [T], dice: &mut Dice) {
    for last in (1..values.len()).rev() {
        values.swap(last, dice.index(last + 1));
    }
}

/// `look` answers the rays of hits with the triangles that it sees.
fn coplanar(
    dice: &mut Dice,
    copies: f64,
    cases: usize,
    look: fn(&mut Dice, &Scene, &[PrimaryHit]) -> Vec<u32>,
) -> Tally {
    let mut tally = Tally::default();
    while tally.tested < cases {
        let (scene, order) = wall(dice, copies);
        let base = seen(&scene, Way { lanes: 1, ..Way::LINEAR });
        let answers = look(dice, &scene, &base);
        let met = base.iter().zip(answers).filter(|(hit, _)| hit.primitive != MISS);
        for (hit, answer) in met.take(cases - tally.tested) {
            let place = order[hit.primitive as usize];
            let first = order.iter().position(|&other| other == place).map(|index| index as u32);
            tally.count(Some(answer) != first);
        }
    }
    tally
}

/// In some order, as a hierarchy meets them, and only what is nearer replaces what was found.
fn first_met(dice: &mut Dice, scene: &Scene, rays: &[PrimaryHit]) -> Vec<u32> {
    let mut order: Vec<usize> = (0..scene.triangles.len()).collect();
    shuffle(&mut order, dice);
    let stored = store_triangles::<Woop>(scene);
    let answer = |hit: &PrimaryHit| {
        let prepared = Woop::prepare::<f32>(&ray(hit.origin.into(), hit.direction.into()));
        let (mut nearest, mut primitive) = (f32::INFINITY, MISS);
        for &index in &order {
            let found = Woop::test(&prepared, &stored[index], f32::INFINITY);
            if found.mask && found.t < nearest {
                (nearest, primitive) = (found.t, index as u32);
            }
        }
        primitive
    };
    rays.iter().map(answer).collect()
}

/// The renderer at one of its widths, by one of its ways.
fn renderer(dice: &mut Dice, scene: &Scene, _: &[PrimaryHit]) -> Vec<u32> {
    let ways = [Traversal::Single, Traversal::Packet, Traversal::Stream, Traversal::Hybrid];
    let choices = [TraversalChoice::Linear, TraversalChoice::Through(ways[dice.index(4)])];
    let way = Way::with(SphereChoice::Robust, TriangleChoice::Woop, choices[dice.index(2)]);
    let way = Way { lanes: [1, 8][dice.index(2)], ..way };
    seen(scene, way).iter().map(|hit| hit.primitive).collect()
}

/// A tilted box of twelve triangles; the unit vectors towards three of its walls.
pub fn put_box(scene: &mut Scene, dice: &mut Dice, center: DVec3, size: f64) -> [DVec3; 3] {
    let axis = dice.direction();
    let tilt = DQuat::from_axis_angle(axis, TAU * dice.unit());
    let sign = |bit: usize| if bit == 0 { -1.0 } else { 1.0 };
    let corner =
        |i: usize| (center + tilt * (DVec3::new(sign(i & 1), sign(i & 2), sign(i & 4)) * size)).as_vec3();
    for [a, b, c, d] in [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]] {
        scene.triangles.extend([[a, b, c], [a, c, d]].map(|face| triangle(face.map(corner))));
    }
    DVec3::AXES.map(|axis| tilt * axis)
}
