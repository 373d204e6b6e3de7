//! What rays hit that run along the very sides of a tile's frustum, or start at the very side of a box: there
//! rounding decides between a hit and none, and only the frustum's padding keeps the traversals' law.

use crate::common::rays::Set;
use crate::common::*;
use octray::rays::traverse::tile::TILE;

/// Steps of a tile's rays across: 16 by 16, from −1 to 1.
fn steps(i: usize) -> [f64; 2] {
    [i % 16, i / 16 % 16].map(|i| i as f64 / 7.5 - 1.0)
}

/// The numbers of a tile's outermost rays.
fn outermost() -> impl Iterator<Item = usize> {
    (0..TILE).filter(|&i| steps(i).iter().any(|step| step.abs() == 1.0))
}

/// The view along an axis, forwards or backwards.
struct Along {
    towards: DVec3,
    /// The other two axes.
    across: [usize; 2],
}

impl Along {
    /// Of six: x, y, z forwards, then backwards.
    fn axis(axis: usize) -> Self {
        let mut towards = DVec3::ZERO;
        towards[axis % 3] = [1.0, -1.0][axis / 3];
        Self { towards, across: [(axis + 1) % 3, (axis + 2) % 3] }
    }
    fn at(&self, depth: f64, across: [f64; 2]) -> DVec3 {
        let mut at = self.towards * depth;
        let [a, b] = self.across;
        [at[a], at[b]] = across;
        at
    }
    /// A tile of rays around a slope.
    fn tile(&self, origin: DVec3, slope: [f64; 2], spread: [f64; 2]) -> Set {
        let mut set = Set::default();
        for i in 0..TILE {
            let direction =
                self.at(1.0, std::array::from_fn(|axis| slope[axis] + spread[axis] * steps(i)[axis]));
            set.push(origin.as_vec3(), direction.normalize().as_vec3(), f32::INFINITY);
        }
        set
    }
    /// A tile of rays from so far before the world's origin.
    fn tile_from_afar(&self, rng: &mut Rng, away: f64, spread: f64) -> Set {
        self.tile(rng.direction() * 0.1 - self.towards * away, [0.0; 2], [spread; 2])
    }
    /// Away from the tile's middle, across the view, at one of its outermost rays.
    fn outwards(&self, i: usize) -> DVec3 {
        self.at(0.0, steps(i).map(|step| if step.abs() == 1.0 { step } else { 0.0 }))
    }
    /// A triangle around the axis, whose corners lie at these depths.
    fn triangle(&self, depths: [f64; 3], size: f64, turn: f64) -> [Vec3; 3] {
        std::array::from_fn(|i| {
            let (sin, cos) = (turn + i as f64 * std::f64::consts::TAU / 3.0).sin_cos();
            self.at(depths[i], [size * cos, size * sin]).as_vec3()
        })
    }
}

/// Asserts the law where a tile goes in a frustum; returns how many rays hit something.
fn check(set: &Set, scene: &Scene, what: &str) -> usize {
    assert!(set.goes_in_a_frustum(&Hierarchy::new(&scene.geometry(), Trees::WideAndBinary)), "{what}");
    set.check(scene, what)
}

/// How a camera's tile sees a scene: from how far away of the scene's middle, how deep, and between which
/// slopes.
#[derive(Clone, Copy, Debug)]
struct View {
    axis: usize,
    away: f64,
    depth: f64,
    slope: f64,
    spread: f64,
}

/// A camera's tile that sees specks right at its outermost rays, and triangles beyond them that touch them
/// with an edge.
fn at_the_sides(rng: &mut Rng, view: View, spheres: bool) -> usize {
    let View { axis, away, depth, slope, spread } = view;
    let along = Along::axis(axis);
    let origin = (rng.direction() * away).as_vec3().as_dvec3();
    let set = along.tile(origin, [slope, -slope], [spread; 2]);
    let mut scene = diffuse();
    for i in outermost() {
        let d = DVec3::from_array(set.direction.each_ref().map(|column| f64::from(column[i])));
        let depth = depth * rng.scale(0.25, 1.5);
        let point = origin + d * depth;
        if spheres && i % 2 == 0 {
            scene.spheres.push(sphere(point.as_vec3(), (1e-6 * depth) as f32, 0));
            continue;
        }
        let out = along.outwards(i);
        let size = depth * rng.scale(1e-6, 1e-2);
        let beside = d.cross(out).normalize() * size;
        let vertices = [point - beside, point + beside, point + out * size].map(|v| v.as_vec3());
        if has_area(vertices) {
            scene.triangles.push(triangle(vertices, 0));
        }
    }
    check(&set, &scene, &format!("{view:?}"))
}

#[test]
fn frustum_keeps_what_its_outermost_rays_hit() {
    let mut rng = Rng(91);
    let mut hits = 0;
    for axis in 0..6 {
        for (away, depth) in [
            (1.0, 1.0),
            (1e-3, 1.0),
            (100.0, 100.0),
            (100.0, 0.1),
            (1e3, 10.0),
            (1e6, 1e6),
            (1e6, 1e4),
            (1e6, 1e3),
        ] {
            for (slope, spread) in [(0.0, 0.5), (0.3, 0.1), (0.0, 1e-3), (0.0, 1e-6), (3.0, 1.0), (1e3, 1.0)]
            {
                for spheres in [false, true] {
                    hits += at_the_sides(&mut rng, View { axis, away, depth, slope, spread }, spheres);
                }
            }
        }
    }
    assert!(hits > 10_000, "{hits}");
}

/// Where a tile stands that sees triangles edge-on: see [`edge_on`].
#[derive(Clone, Copy, Debug)]
struct Beside {
    axis: usize,
    /// How far the scene reaches, and how far from its middle the tile stands.
    extent: f64,
    away: f64,
    /// Slopes across: from the middle one this far to both sides.
    slope: [f64; 2],
    spread: f64,
    /// How often each triangle is there.
    copies: usize,
}

/// Triangles that lie edge-on beside the outermost rays: there rounding decides whether they are hit, up to
/// their own boxes and the padding of these, which in a large scene reaches far beyond the tile's sides. Of
/// copies the first one counts, though padding moves the hits of all before their box.
fn edge_on(rng: &mut Rng, case: Beside) -> usize {
    let Beside { axis, extent, away, slope, spread, copies } = case;
    let along = Along::axis(axis);
    let middle = along.at(1.0, slope);
    let origin = (rng.direction() * 0.01 - middle * away).as_vec3().as_dvec3();
    let set = along.tile(origin, slope, [spread, 1e-3]);
    let mut scene = diffuse();
    let corner = -middle * extent;
    let far = [corner, corner + DVec3::X, corner * 0.9 + DVec3::ONE].map(|v| v.as_vec3());
    scene.triangles.push(triangle(far, 0));
    // Where few are hit, more of them.
    let rare = if copies > 1 || spread > 1.0 || away > 0.0 { 4 } else { 1 };
    // The padding of boxes.
    let room = (extent + away) * 0.5f64.powi(21);
    let sides: Vec<usize> = outermost().collect();
    while scene.triangles.len() < 900 * rare {
        let i = sides[rng.index(sides.len())];
        let [x, y] = steps(i);
        let across = [slope[0] + spread * x, slope[1] + 1e-3 * y];
        let (d, out) = (along.at(1.0, across), along.outwards(i));
        let beside = rng.scale(0.1, 1.5) * room * (1.0 + across[0].abs().max(across[1].abs()));
        let size = rng.scale(1e-2, 10.0) * room;
        let depth = if away > 0.0 { away } else { rng.scale(1.0, 100.0) * room };
        let vertices = [(); 3].map(|()| {
            let across = beside + size * rng.unit();
            (origin + d * (depth + size * rng.unit()) + out * across).as_vec3()
        });
        if has_area(vertices) {
            scene.triangles.extend((0..copies).map(|_| triangle(vertices, 0)));
        }
    }
    check(&set, &scene, &format!("{case:?}"))
}

#[test]
fn frustum_keeps_what_rounding_hits_beside_it() {
    let mut rng = Rng(92);
    let mut hits = 0;
    for axis in 0..6 {
        let plain = Beside { axis, extent: 1e4, away: 0.0, slope: [0.0; 2], spread: 1e-3, copies: 1 };
        for case in [
            plain,
            Beside { extent: 1e6, ..plain },
            Beside { copies: 12, ..plain },
            // The first ray still runs along the axis; most others do not.
            Beside { slope: [8.2, 0.0], spread: 7.5, ..plain },
            Beside { extent: 1.0, away: 1e4, slope: [0.9, -0.9], ..plain },
        ] {
            hits += edge_on(&mut rng, case);
        }
    }
    assert!(hits > 200, "{hits}");
}

/// Copies of triangles, seen from so far away that rounding puts their hits before their boxes, which reach
/// hardly anywhere themselves: the first copy counts, and the frustum must not leave it out because another
/// one has been hit.
#[test]
fn frustum_keeps_the_first_of_copies_seen_from_afar() {
    let mut rng = Rng(93);
    let mut hits = 0;
    const ROUNDS: usize = 108;
    for round in 0..ROUNDS {
        let away = [1e3, 1e4, 1e6][round / 6 % 3];
        // Every other tile is narrower than its directions can tell.
        let spread = if round % 2 == 0 { 0.0 } else { 0.3 / away };
        let view = Along::axis(round % 6);
        let set = view.tile_from_afar(&mut rng, away, spread);
        let mut scene = diffuse();
        for depth in [-0.5, 0.0, 0.5].map(|depth| depth + 0.2 * rng.unit()) {
            let vertices = view.triangle([0.0, 0.01, 0.02].map(|behind| depth + behind), 3.0, 0.0);
            scene.triangles.extend([(); 30].map(|()| triangle(vertices, 0)));
        }
        hits += check(&set, &scene, &format!("round {round}, {away} away"));
    }
    assert_eq!(hits, ROUNDS * TILE);
}

/// Many triangles in a plane across the axis: rounding decides which one a ray meets first, and the frustum
/// must look at all of them, though each begins where the hit so far is.
#[test]
fn frustum_keeps_the_first_of_many_triangles_in_a_plane() {
    let mut rng = Rng(94);
    let mut hits = 0;
    for round in 0..24 {
        let view = Along::axis(round % 6);
        let set = view.tile_from_afar(&mut rng, 5.0, 0.02);
        let mut scene = diffuse();
        for _ in 0..64 {
            let turn = rng.scale(0.1, 6.0);
            let size = rng.scale(2.0, 4.0);
            scene.triangles.push(triangle(view.triangle([0.3; 3], size, turn), 0));
        }
        hits += check(&set, &scene, &format!("round {round}"));
    }
    assert_eq!(hits, 24 * TILE);
}
