//! Rays against triangles in integers of any size: every double is an integer times a power of two.

use num_bigint::{BigInt, Sign};
use std::cmp::Ordering;

pub type Point = [f64; 3];
type Vector = [BigInt; 3];

/// A ray and the range of its hits.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    pub origin: Point,
    pub direction: Point,
    pub range: [f64; 2],
}

/// A number of the form n / d, with d above 0.
#[derive(Clone, Debug)]
pub struct Ratio {
    n: BigInt,
    d: BigInt,
}

impl Ratio {
    pub fn compare(&self, other: &Self) -> Ordering {
        (&self.n * &other.d).cmp(&(&other.n * &self.d))
    }
    pub fn compare_double(&self, x: f64) -> Ordering {
        if x == f64::INFINITY {
            return Ordering::Less;
        }
        let (mantissa, exponent) = parts(x);
        let (n, d) = match exponent {
            0.. => (self.n.clone(), &self.d * (mantissa << exponent)),
            _ => (&self.n << -exponent, &self.d * mantissa),
        };
        n.cmp(&d)
    }
    /// Tests whether a double is at most `units` of its last place away.
    pub fn is_near(&self, x: f64, units: f64) -> bool {
        let unit = x.next_up() - x;
        self.compare_double(x - units * unit).is_ge() && self.compare_double(x + units * unit).is_le()
    }
}

/// A hit of a closed triangle.
#[derive(Clone, Debug)]
pub struct Hit {
    pub t: Ratio,
    /// The weights of the second and the third corner.
    pub weights: [Ratio; 2],
}

/// Returns a double as an integer times a power of two.
fn parts(x: f64) -> (BigInt, i64) {
    let (bits, sign) = (x.abs().to_bits(), if x < 0.0 { -1 } else { 1 });
    let (field, fraction) = ((bits >> 52) as i64, (bits & ((1 << 52) - 1)) as i64);
    let (mantissa, exponent) =
        if field == 0 { (fraction, -1074) } else { (fraction | 1 << 52, field - 1075) };
    let zeros = if mantissa == 0 { 0 } else { i64::from(mantissa.trailing_zeros()) };
    (BigInt::from(sign * (mantissa >> zeros)), if mantissa == 0 { 0 } else { exponent + zeros })
}

fn dot(p: &Vector, q: &Vector) -> BigInt {
    &p[0] * &q[0] + &p[1] * &q[1] + &p[2] * &q[2]
}

fn cross(p: &Vector, q: &Vector) -> Vector {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &p[i] * &q[j] - &p[j] * &q[i])
}

fn difference(p: &Vector, q: &Vector) -> Vector {
    [0, 1, 2].map(|axis| &p[axis] - &q[axis])
}

/// A ray and a triangle, all times the same power of two.
struct Pair {
    origin: Vector,
    direction: Vector,
    triangle: [Vector; 3],
}

/// The place of a crossing: the edge functions, N and D, with D ≥ 0.
struct Crossing {
    edges: [BigInt; 3],
    n: BigInt,
    d: BigInt,
}

impl Pair {
    fn new(ray: &Ray, triangle: &[Point; 3]) -> Self {
        let points = [ray.origin, ray.direction, triangle[0], triangle[1], triangle[2]];
        let least = points.as_flattened().iter().map(|&x| parts(x).1).min().unwrap();
        let integer = |x: f64| {
            let (mantissa, exponent) = parts(x);
            mantissa << (exponent - least)
        };
        let [origin, direction, a, b, c] = points.map(|point| point.map(integer));
        Self { origin, direction, triangle: [a, b, c] }
    }

    /// Moves the origin by 2⁻⁹⁰⁰, 2⁻¹⁸⁰⁰ and 2⁻²⁷⁰⁰ units along the axes: determinants of these integers
    /// have less than 900 bits.
    fn moved(mut self) -> Self {
        let all = [&mut self.origin, &mut self.direction].into_iter().chain(&mut self.triangle);
        all.flatten().for_each(|x| {
            assert!(x.bits() < 295);
            *x <<= 2700;
        });
        (0..3).for_each(|axis| self.origin[axis] += BigInt::from(1) << (1800 - 900 * axis));
        self
    }

    fn crossing(&self) -> Crossing {
        let [a, b, c] = self.triangle.each_ref().map(|corner| difference(corner, &self.origin));
        let normal = cross(&difference(&b, &a), &difference(&c, &a));
        let edges = [(&b, &c), (&c, &a), (&a, &b)].map(|(p, q)| dot(&self.direction, &cross(p, q)));
        let (n, d) = (dot(&a, &normal), dot(&self.direction, &normal));
        match d.sign() {
            Sign::Minus => Crossing { edges: edges.map(|edge| -edge), n: -n, d: -d },
            _ => Crossing { edges, n, d },
        }
    }
}

impl Crossing {
    fn is_inside(&self) -> bool {
        self.d.sign() == Sign::Plus && self.edges.iter().all(|edge| edge.sign() != Sign::Minus)
    }
    fn t(&self) -> Ratio {
        Ratio { n: self.n.clone(), d: self.d.clone() }
    }
    fn is_within(&self, [t_min, t_max]: [f64; 2]) -> bool {
        self.t().compare_double(t_min).is_gt() && self.t().compare_double(t_max).is_lt()
    }
}

/// Returns the hit of the closed triangle, and whether the ray, moved by an infinitesimal vector, crosses the
/// triangle.
pub fn judge(ray: &Ray, triangle: &[Point; 3]) -> (Option<Hit>, bool) {
    if is_certain_miss(ray, triangle) {
        return (None, false);
    }
    let pair = Pair::new(ray, triangle);
    let crossing = pair.crossing();
    if !crossing.is_inside() {
        return (None, false);
    }
    let (t, zero) = (crossing.t(), BigInt::ZERO);
    let is_special =
        crossing.edges.contains(&zero) || ray.range.iter().any(|&end| t.compare_double(end).is_eq());
    let crosses = match is_special {
        true => {
            let moved = pair.moved().crossing();
            moved.is_inside() && moved.is_within(ray.range)
        }
        false => crossing.is_within(ray.range),
    };
    let weight = |edge: &BigInt| Ratio { n: edge.clone(), d: crossing.d.clone() };
    let hit = Hit { t, weights: [weight(&crossing.edges[1]), weight(&crossing.edges[2])] };
    (crossing.is_within(ray.range).then_some(hit), crosses)
}

/// Tests in doubles, with a bound of error that is larger than it must be.
fn is_certain_miss(ray: &Ray, triangle: &[Point; 3]) -> bool {
    let o = ray.origin;
    let [a, b, c] = triangle.map(|p| [p[0] - o[0], p[1] - o[1], p[2] - o[2]]);
    let d = ray.direction;
    let edges = [(b, c), (c, a), (a, b)].map(|(p, q): (Point, Point)| {
        let x = d[0] * p[1] * q[2] + d[1] * p[2] * q[0] + d[2] * p[0] * q[1];
        x - (d[0] * p[2] * q[1] + d[1] * p[0] * q[2] + d[2] * p[1] * q[0])
    });
    let largest = |point: &[f64]| point.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let size = largest([a, b, c].as_flattened());
    let bound = 1e-13 * largest(&d) * size * size;
    edges.iter().any(|&edge| edge > bound) && edges.iter().any(|&edge| edge < -bound)
}
