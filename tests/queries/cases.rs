//! Meshes and rays that are hard: vertices and edges that rays pass exactly, planes that they lie in, faces
//! that are there twice or have no area, coordinates from 10⁻⁶ to 10⁹, maps, and origins far away.

use crate::rational::{Point, Ray};

/// SplitMix64.
pub struct Rng(pub u64);

impl Rng {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
    pub fn index(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }
    /// A number from −1 to 1.
    pub fn number(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
    pub fn point(&mut self) -> Point {
        [(); 3].map(|()| self.number())
    }
    /// A point with whole coordinates.
    fn grid(&mut self, most: i64) -> Point {
        [(); 3].map(|()| (self.next() % (2 * most as u64 + 1)) as f64 - most as f64)
    }
}

pub struct Mesh {
    pub vertices: Vec<Point>,
    pub faces: Vec<[u32; 3]>,
    pub is_closed: bool,
    /// The extent, and the middle.
    size: f64,
    middle: Point,
}

fn combine(p: Point, weight: f64, q: Point) -> Point {
    std::array::from_fn(|axis| p[axis] + weight * q[axis])
}

fn minus(p: Point, q: Point) -> Point {
    combine(p, -1.0, q)
}

/// An octahedron whose faces are divided once or twice; vertices that edges share are the same.
fn ball(divisions: u32) -> (Vec<Point>, Vec<[u32; 3]>) {
    let axis = |i: usize, sign: f64| std::array::from_fn(|axis| if axis == i { sign } else { 0.0 });
    let mut vertices: Vec<Point> = (0..6).map(|i| axis(i / 2, if i % 2 == 0 { 1.0 } else { -1.0 })).collect();
    let mut faces = vec![];
    for (x, y, z) in (0..8).map(|i| (i & 1, 2 + (i >> 1 & 1), 4 + (i >> 2))) {
        faces.push(if (x + y + z) % 2 == 0 { [x, y, z] } else { [x, z, y] });
    }
    for _ in 0..divisions {
        let mut middle = |p: u32, q: u32| {
            let point = combine(vertices[p as usize], 1.0, vertices[q as usize]);
            let length = point.iter().map(|x| x * x).sum::<f64>().sqrt();
            let point = point.map(|x| x / length);
            let same = vertices.iter().position(|&vertex| vertex == point);
            same.unwrap_or_else(|| {
                vertices.push(point);
                vertices.len() - 1
            }) as u32
        };
        let divided = faces.iter().flat_map(|&[a, b, c]: &[u32; 3]| {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
        });
        faces = divided.collect();
    }
    (vertices, faces)
}

/// A cube of edge 2 with whole coordinates.
pub fn cube() -> (Vec<Point>, Vec<[u32; 3]>) {
    let corner = |i: u32| [0, 1, 2].map(|axis| if i >> axis & 1 == 1 { 1.0 } else { -1.0 });
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    ((0..8).map(corner).collect(), faces.collect())
}

impl Mesh {
    pub fn new(rng: &mut Rng) -> Self {
        let (kind, is_whole) = (rng.index(5), rng.index(2) == 0);
        let (mut vertices, mut faces) = match kind {
            0 => ball(1 + rng.index(2) as u32),
            1 => cube(),
            // A soup with repeated vertices and faces without an area.
            2 => (
                (0..90).map(|_| rng.grid(3)).collect(),
                (0..30).map(|i| [0, 1, 2].map(|k| 3 * i + k)).collect(),
            ),
            // A terrain.
            3 => {
                let height = |rng: &mut Rng| rng.grid(2)[0];
                let vertices = (0..36).map(|i| [(i % 6) as f64, height(rng), (i / 6) as f64]).collect();
                let cells = (0..25).map(|i| i % 5 + i / 5 * 6);
                (vertices, cells.flat_map(|i| [[i, i + 1, i + 7], [i, i + 7, i + 6]]).collect())
            }
            // Any triangles, slivers among them.
            _ => {
                let triangle = |i: u32| {
                    let (a, b) = (rng.point(), rng.point());
                    [a, b, combine(b, if i.is_multiple_of(3) { 1e-9 } else { 1.0 }, rng.point())]
                };
                (
                    (0..30).flat_map(triangle).collect(),
                    (0..30).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
                )
            }
        };
        if rng.index(4) == 0 {
            let again: Vec<_> = faces[..faces.len() / 2].iter().map(|&[a, b, c]| [b, c, a]).collect();
            faces.extend(again);
        }
        // Not with faces that are there twice.
        let is_closed = kind < 2 && [12, 32, 128].contains(&faces.len());
        let exponent = rng.index(16) as i32 - 6;
        let (size, middle) = match rng.index(4) {
            0 => (1.0, [0.0; 3]),
            1 => (if is_whole { 2_f64.powi(3 * exponent) } else { 10_f64.powi(exponent) }, [0.0; 3]),
            // A map: metres, far from 0.
            2 => (10_f64.powi(rng.index(4) as i32 - 1), [512_345.25, 5_403_210.5, 87.125]),
            _ => (10_f64.powi(exponent), rng.point().map(|x| x * 10_f64.powi(exponent + 2))),
        };
        let turn = rng.point();
        for vertex in &mut vertices {
            if !is_whole {
                // A shear, so that rounding leaves no plane and no edge as it was.
                let [x, y, z] = *vertex;
                *vertex = [x + turn[0] * y, y + turn[1] * z, z + turn[2] * x];
            }
            *vertex = combine(middle, size, *vertex);
        }
        Self { vertices, faces, is_closed, size, middle }
    }

    pub fn triangle(&self, face: usize) -> [Point; 3] {
        self.faces[face].map(|vertex| self.vertices[vertex as usize])
    }

    /// A ray at a place that is hard.
    pub fn ray(&self, rng: &mut Rng) -> Ray {
        let [a, b, c] = self.triangle(rng.index(self.faces.len()));
        let third = |p: Point, q: Point| combine(p, 0.5, minus(q, p));
        let target = match rng.index(6) {
            0 => a,
            1 => third(a, b),
            2 => combine(b, 0.25, minus(c, b)),
            3 => third(third(a, b), c),
            4 => combine(self.middle, self.size, rng.point()),
            _ => combine(a, 1e-15, minus(c, b)),
        };
        let far = 10_f64.powi([0, 0, 1, 2, 4, 9, 20][rng.index(7)]);
        let (origin, direction) = match rng.index(9) {
            // Whole steps, which rounding seldom changes.
            0 | 1 => {
                let direction = rng.grid(2).map(|x| x * self.size);
                (combine(target, -2.0, direction), direction)
            }
            // Along an edge, and in a plane.
            2 => (combine(a, -3.0, minus(b, a)), minus(b, a)),
            3 => (combine(third(a, b), -2.0, minus(c, target)), minus(c, target)),
            // From the surface.
            4 => (target, minus(third(b, c), target)),
            5 => (target, rng.point()),
            6 => {
                let axis = rng.index(3);
                let direction = [0, 1, 2].map(|i| if i == axis { self.size } else { 0.0 });
                (combine(target, -far.min(1e4), direction), direction)
            }
            _ => {
                let origin = combine(target, self.size * far, rng.point());
                (origin, minus(target, origin))
            }
        };
        let unit = 1.0 / direction.map(|x| x * x).iter().sum::<f64>().sqrt();
        let unit = if unit.is_finite() { unit } else { 1.0 };
        let length = [1.0, unit, unit * (1.0 + 3e-7), 1e-3, 1e5][rng.index(5)];
        let mut direction = direction.map(|x| x * length);
        if rng.index(16) == 0 {
            // Rotations leave such components.
            direction[rng.index(3)] = 2.3e-49;
        }
        let end = |rng: &mut Rng| [0.0, 1.0, 2.0, 1.0 / length, 2.0 / length, 0.5][rng.index(6)];
        let range = match rng.index(3) {
            0 => [end(rng), f64::INFINITY],
            1 => [0.0, end(rng)],
            _ => [0.0, f64::INFINITY],
        };
        Ray { origin, direction, range }
    }
}
