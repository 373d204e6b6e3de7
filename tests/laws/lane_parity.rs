//! The law of the lane module: every operation, and everything written over lanes, gives the same bits at
//! width 1, 8 and 16.
//!
//! Any NaN equals any NaN (which one comes out is not promised); everything else is compared bit for bit,
//! lane by lane, on all pairs of special values and on random bit patterns. Holds in every build; to run it
//! in one without FMA and AVX: `RUSTFLAGS="-C target-cpu=x86-64" cargo test --target-dir target/plain --test
//! laws lane_parity`.

use crate::common::*;
use octray::kernel::ray_box::{BoxRay, Padding, own_box};
use octray::kernel::{bsdf, ray_cone, surface, texture};
use octray::lane::{functions, lane_indices, set_bits};
use octray::math::Vec3;
use octray::methods::{self, BoxMethod};
use octray::primitives;
use octray::sampling::{PixelCoordinates, SampleValues, random, warp};
use std::f32::consts::PI;

/// What an operation may read: three floats, three integers, a truth value.
#[derive(Clone, Copy)]
struct Input<L: Lane> {
    x: L,
    y: L,
    z: L,
    i: L::Bits,
    j: L::Bits,
    k: L::Bits,
    mask: L::Mask,
}

/// What comes out of it.
#[derive(Clone, Copy)]
enum Value<L: Lane> {
    Float(L),
    Integer(L::Bits),
    Truth(L::Mask),
}
use Value::{Float, Integer, Truth};

/// An operation at any width.
trait Operation {
    fn run<L: Lane>(input: Input<L>) -> Vec<Value<L>>;
}

impl<L: Lane> Value<L> {
    /// The bits of one lane, all NaN alike.
    fn get(&self, lane: usize) -> u32 {
        match *self {
            Float(x) if x.get(lane).is_nan() => 0x7fc0_0000,
            Float(x) => x.get(lane).to_bits(),
            Integer(i) => i.get(lane),
            Truth(mask) => mask.bitmask() >> lane & 1,
        }
    }
}

fn vector<L: Lane>(v: Vec3<L>) -> Vec<Value<L>> {
    vec![Float(v.x), Float(v.y), Float(v.z)]
}

type Case = Input<f32>;

/// Of both signs: numbers where something ends, their neighbours, and some that are like others.
fn special() -> Vec<f32> {
    let ends = [0, 22, 23, 24, 31, 32].map(|power| 2f32.powi(power)).map(|x| [x.next_down(), x, x.next_up()]);
    let some =
        [0.0, 0.5, 1.5, 2.5, 7.0, 31.0, 8192.0, PI, 1e-3, 1e30, 1e-30, 1e-38, 3e38, 88.722_84, 87.336_54];
    let limits = [f32::MIN_POSITIVE, f32::MAX, f32::EPSILON, f32::INFINITY, f32::NAN];
    let odd = [1, 0x007f_ffff, 0x7f80_0001, 0x3eaa_aaab].map(f32::from_bits);
    ends.as_flattened().iter().chain(&some).chain(&limits).chain(&odd).flat_map(|&x| [x, -x]).collect()
}

/// All pairs of special values of both signs, and random bit patterns, whole exponent range and near one.
fn cases() -> Vec<Case> {
    let special = special();
    let mut rng = Rng(1);
    let mut cases = Vec::new();
    let mut push = |x: f32, y: f32, z: f32, rng: &mut Rng| {
        let small = |bits: u32| if bits & 3 == 0 { bits >> 29 } else { bits };
        let [i, j] = [small(rng.bits()), small(rng.bits())];
        // Equal integers, and an index for small tables.
        let j = if rng.index(4) == 0 { i } else { j };
        cases.push(Input { x, y, z, i, j, k: rng.bits() >> 29, mask: rng.bits() >> 31 == 1 });
    };
    for (&x, &y) in special.iter().flat_map(|x| special.iter().map(move |y| (x, y))) {
        let z = special[rng.index(special.len())];
        push(x, y, z, &mut rng);
    }
    for _ in 0..40_000 {
        let [x, y, z] = std::array::from_fn(|_| f32::from_bits(rng.bits()));
        push(x, y, z, &mut rng);
        let [x, y, z] = std::array::from_fn(|_| (rng.signed() * rng.scale(1e-3, 1e3)) as f32);
        push(x, y, z, &mut rng);
        let [x, y, z] = std::array::from_fn(|_| rng.unit() as f32);
        push(x, y, z, &mut rng);
    }
    cases.truncate(cases.len() / 16 * 16);
    cases
}

fn assert_parity<O: Operation>(name: &str) {
    assert_parity_at::<F32x8, O>(name);
    assert_parity_at::<F32x16, O>(name);
}

fn assert_parity_at<L: Lane, O: Operation>(name: &str) {
    for cases in cases().chunks_exact(L::WIDTH) {
        let float = |of: fn(&Case) -> f32| L::from_fn(|lane| of(&cases[lane]));
        let integer = |of: fn(&Case) -> u32| L::Bits::from_fn(|lane| of(&cases[lane]));
        let wide = O::run(Input::<L> {
            x: float(|case| case.x),
            y: float(|case| case.y),
            z: float(|case| case.z),
            i: integer(|case| case.i),
            j: integer(|case| case.j),
            k: integer(|case| case.k),
            mask: integer(|case| u32::from(case.mask)).equals(L::Bits::splat(1)),
        });
        for (lane, case) in cases.iter().enumerate() {
            // Opaque, so that neither side is computed at compile time.
            let single = O::run(std::hint::black_box(*case));
            assert_eq!(single.len(), wide.len());
            for (number, (single, wide)) in single.iter().zip(&wide).enumerate() {
                let (single, wide) = (single.get(0), wide.get(lane));
                let Input { x, y, z, i, j, k, mask } = *case;
                assert!(
                    single == wide,
                    "{name}, value {number}, lane {lane}: {single:#010x} ({:?}) at width 1, {wide:#010x} ({:?}) at width {}\n\
                     of x {x:?}, y {y:?}, z {z:?}, i {i:#x}, j {j:#x}, k {k}, mask {mask}",
                    f32::from_bits(single),
                    f32::from_bits(wide),
                    L::WIDTH,
                );
            }
        }
    }
}

/// Each line is a test: a name, and what is computed of the [`Input`].
macro_rules! same_at_every_width {
    ($($name:ident: |$input:ident| $values:expr;)*) => {$(
        #[test]
        fn $name() {
            struct This;
            impl Operation for This {
                #[inline(always)]
                fn run<L: Lane>($input: Input<L>) -> Vec<Value<L>> {
                    $values.into()
                }
            }
            assert_parity::<This>(stringify!($name));
        }
    )*};
}

same_at_every_width! {
    add_is_the_same_at_every_width: |o| [Float(o.x + o.y)];
    sub_is_the_same_at_every_width: |o| [Float(o.x - o.y)];
    mul_is_the_same_at_every_width: |o| [Float(o.x * o.y)];
    div_is_the_same_at_every_width: |o| [Float(o.x / o.y)];
    neg_is_the_same_at_every_width: |o| [Integer((-o.x).to_bits())];
    mul_add_is_the_same_at_every_width: |o| [Float(o.x.mul_add(o.y, o.z))];
    neg_mul_add_is_the_same_at_every_width: |o| [Float(o.x.neg_mul_add(o.y, o.z))];
    sqrt_is_the_same_at_every_width: |o| [Float(o.x.sqrt()), Float(o.x.abs().sqrt())];
    comparisons_are_the_same_at_every_width: |o| [
        Truth(o.x.lt(o.y)), Truth(o.x.le(o.y)), Truth(o.x.eq(o.y)), Truth(o.x.gt(o.y)), Truth(o.x.ge(o.y)),
        Truth(o.x.lt(o.x)), Truth(o.x.le(o.x)), Truth(o.x.eq(o.x)), Truth(o.x.gt(o.x)), Truth(o.x.ge(o.x)),
    ];
    select_is_the_same_at_every_width: |o| [
        Integer(L::select(o.mask, o.x, o.y).to_bits()), Integer(o.x.only(o.mask).to_bits()),
    ];
    bits_of_floats_are_the_same_at_every_width: |o| [Integer(o.x.to_bits()), Integer(L::from_bits(o.i).to_bits())];
    truncate_to_int_is_the_same_at_every_width: |o| [Integer(o.x.truncate_to_int())];
    from_int_is_the_same_at_every_width: |o| [
        Float(L::from_int(o.i)), Float(L::from_int(o.i.shr(8))), Float(L::from_int(o.k)),
    ];
    pick_is_the_same_at_every_width: |o| {
        let table = [1.0, -0.0, f32::INFINITY, f32::from_bits(1), 0.25, -7.5, f32::MAX, 8.0];
        [Float(L::pick(&table, o.k))]
    };
    pick_of_16_is_the_same_at_every_width: |o| {
        let table = std::array::from_fn(|i| [0.5, -0.0, f32::INFINITY, f32::from_bits(1)][i % 4] + i as f32);
        [Float(L::pick_of_16(&table, o.i.shr(28))), Float(L::pick_of_16(&table, o.k))]
    };
    gather_rows_is_the_same_at_every_width: |o| {
        const fn table<const N: usize>() -> [[f32; N]; 11] {
            let mut table = [[0.0; N]; 11];
            let mut number = 0;
            while number < 11 * N {
                table[number / N][number % N] = number as f32 + 0.5;
                number += 1;
            }
            table
        }
        let index = o.k.wrapping_add(o.i.shr(31)).wrapping_add(o.j.shr(31));
        let mut values = Vec::new();
        values.extend(L::gather_rows::<8>(&table::<8>(), index).map(Float));
        values.extend(L::gather_rows::<4>(&table::<4>(), index).map(Float));
        values.extend(L::gather_rows::<3>(&table::<3>(), index).map(Float));
        values
    };
    min_and_max_are_the_same_at_every_width: |o| [
        Integer(o.x.min(o.y).to_bits()), Integer(o.x.max(o.y).to_bits()),
    ];
    abs_is_the_same_at_every_width: |o| [Integer(o.x.abs().to_bits())];
    sign_operations_are_the_same_at_every_width: |o| [
        Integer(o.x.sign_bit().to_bits()), Integer(o.x.flip_sign(o.y).to_bits()), Integer(o.x.copysign(o.y).to_bits()),
        Truth(o.x.is_sign_negative()),
    ];
    floor_is_the_same_at_every_width: |o| [Float(o.x.floor())];
    is_finite_is_the_same_at_every_width: |o| [Truth(o.x.is_finite())];
    constants_are_the_same_at_every_width: |_o| [
        Float(L::zero()), Float(L::one()), Float(L::splat(0.1)), Integer(L::Bits::splat(0x8000_0001)),
        Truth(L::Mask::splat(true)), Truth(L::Mask::splat(false)),
    ];

    integer_arithmetic_is_the_same_at_every_width: |o| [
        Integer(o.i.wrapping_add(o.j)), Integer(o.i.wrapping_mul(o.j)),
        Integer(o.i.shl(0)), Integer(o.i.shl(1)), Integer(o.i.shl(23)), Integer(o.i.shl(31)),
        Integer(o.i.shr(0)), Integer(o.i.shr(1)), Integer(o.i.shr(23)), Integer(o.i.shr(31)),
    ];
    integer_comparisons_are_the_same_at_every_width: |o| [
        Truth(o.i.equals(o.j)), Truth(o.i.less(o.j)), Truth(o.i.le_signed(o.j)),
        Integer(o.i.min_signed(o.j)), Integer(o.i.max_signed(o.j)),
    ];
    integer_logic_is_the_same_at_every_width: |o| [
        Integer(o.i & o.j), Integer(o.i | o.j), Integer(o.i ^ o.j), Integer(!o.i),
        Integer(L::Bits::select(o.mask, o.i, o.j)),
    ];
    mask_logic_is_the_same_at_every_width: |o| {
        let other = o.x.lt(o.y);
        [Truth(o.mask & other), Truth(o.mask | other), Truth(o.mask ^ other), Truth(!o.mask)]
    };

    sin_cos_is_the_same_at_every_width: |o| {
        let (sin, cos) = functions::sin_cos(o.x);
        [Float(sin), Float(cos), Float(functions::sin(o.x)), Float(functions::cos(o.x))]
    };
    sin_cos_turns_is_the_same_at_every_width: |o| {
        let (sin, cos) = functions::sin_cos_turns(o.x);
        [Float(sin), Float(cos)]
    };
    atan2_is_the_same_at_every_width: |o| [Float(functions::atan2(o.y, o.x))];
    exp_is_the_same_at_every_width: |o| [Float(functions::exp(o.x))];
    ln_is_the_same_at_every_width: |o| [Float(functions::ln(o.x))];
    powf_is_the_same_at_every_width: |o| [Float(functions::powf(o.x, o.y)), Float(functions::powf(o.x.abs(), o.y))];

    random_numbers_are_the_same_at_every_width: |o| {
        let key = random::path_key(7, o.i, 12);
        [
            Integer(random::mix_bits(o.i)), Integer(key), Integer(random::path_key(u32::MAX, o.j, u32::MAX)),
            Float(random::uniform::<L>(key, 0)), Float(random::uniform::<L>(o.i, 77)),
        ]
    };
    samplers_are_the_same_at_every_width: |o| {
        let mut values = Vec::new();
        for sampler in [Sampler::Sobol, Sampler::Random] {
            let key = sampler.key(7, o.i, 12);
            let [some, other] = [SampleValues::new(sampler, 7, 12, 8), SampleValues::new(sampler, u32::MAX, u32::MAX, 16)];
            let of_pixels = some.at_pixels(key, PixelCoordinates::<L>::Any { x: o.i, y: o.j });
            let (first, second) = (of_pixels.get_2d(2), other.at_keys::<L>(o.j).get_2d(0));
            values.extend([first.0, first.1, second.0, second.1, of_pixels.get_1d(5)].map(Float));
            values.push(Integer(key));
        }
        values
    };
    warps_are_the_same_at_every_width: |o| {
        let n = Vec3::new(o.x, o.y, o.z);
        let unit = n.normalize();
        let (u, v) = (random::uniform::<L>(o.i, 0), random::uniform::<L>(o.j, 1));
        let mut values = Vec::new();
        for vectors in [warp::orthonormal_basis(n), warp::orthonormal_basis(unit)] {
            values.extend(vector(vectors.0));
            values.extend(vector(vectors.1));
        }
        values.extend(vector(warp::sample_cosine_hemisphere(unit, u, v)));
        values.extend(vector(warp::sample_uniform_sphere(u, v)));
        values.extend(vector(warp::sample_uniform_sphere(o.x, o.y)));
        values
    };
    vectors_are_the_same_at_every_width: |o| {
        let (a, b) = (Vec3::new(o.x, o.y, o.z), Vec3::new(o.z, -o.x, o.y));
        let mut values = vec![Float(a.dot(b))];
        for v in [a.cross(b), a.mul_add(o.y, b), a.normalize(), a.flip_sign(o.y), a.reflect(b), a + b, a - b, a * b, -a] {
            values.extend(vector(v));
        }
        values.extend(vector(Vec3::select(o.mask, a, b)));
        values
    };

    scattering_is_the_same_at_every_width: |o| {
        let n = Vec3::new(o.x, o.y, o.z).normalize();
        let d = Vec3::new(o.y, -o.z, o.x).normalize();
        let d = d.flip_sign(-L::zero().lt(d.dot(n)).bitmask_sign::<L>());
        let (u, v) = (random::uniform::<L>(o.i, 0), random::uniform::<L>(o.j, 1));
        let (alpha, ior) = (L::from_int(o.k.wrapping_add(L::Bits::splat(1))) * L::splat(0.125), L::splat(1.5));
        let horizon = bsdf::Horizon { bent: o.mask, normal: n, ng: n };
        let normals = &bsdf::LobeNormals::bent(d, Vec3::new(o.y, o.z, o.x).normalize(), horizon);
        let n = normals.specular;
        let mut values = Vec::new();
        for drawn in [
            bsdf::diffuse::sample(normals, u, v),
            bsdf::mirror::sample(d, n),
            normals.raise_sample(bsdf::fuzzy_mirror::sample(d, n, alpha, u, v), |wi| wi.dot(n)),
            bsdf::ggx::sample(d, n, alpha, u, v),
            bsdf::glass::sample(d, normals, o.mask, ior, u),
        ] {
            values.extend(vector(drawn.wi));
            values.extend([Float(drawn.weight), Float(drawn.pdf), Truth(drawn.alive)]);
        }
        let towards = Vec3::new(o.z, o.x, -o.y).normalize();
        for lobe in [
            bsdf::diffuse::evaluate(normals, towards),
            bsdf::fuzzy_mirror::evaluate(d, n, alpha, towards),
            bsdf::ggx::evaluate(d, n, alpha, towards),
        ] {
            values.extend([Float(lobe.value), Float(lobe.pdf)]);
        }
        let color = Vec3::new(u, v, L::splat(0.5));
        values.extend(vector(bsdf::albedo::compensated(color, d, n, alpha)));
        let plastic = bsdf::plastic::Plastic { color, alpha, ior, transmitted: L::splat(0.9) };
        let view = plastic.view(d, n);
        let (drawn, weight) = plastic.sample(&view, d, normals, [v, u, v]);
        values.extend(vector(drawn.wi).into_iter().chain(vector(weight)));
        values.extend([Float(drawn.pdf), Truth(drawn.alive)]);
        let lobe = plastic.evaluate(&view, d, normals, towards);
        values.extend(vector(lobe.value));
        values.push(Float(lobe.pdf));
        values
    };
    surfaces_are_the_same_at_every_width: |o| {
        let n = Vec3::new(o.x, o.y, o.z);
        let center = Vec3::new(o.y, o.z, o.x);
        let (point, normal) = surface::sphere_surface(n, center, o.x, L::Mask::splat(true));
        let mut values = vector(point);
        values.extend(vector(normal));
        let (u, v) = surface::latitude_longitude(n);
        values.extend([Float(u), Float(v)]);
        values
    };
    ray_cones_are_the_same_at_every_width: |o| {
        let cone = ray_cone::Cone { width: o.x, angle: o.y };
        let n = Vec3::new(o.z, o.x, o.y).normalize();
        [
            Float(ray_cone::level_of_detail(o.x, o.y, L::from_int(o.k))),
            Float(ray_cone::footprint(cone.width_at(o.z), o.y, o.x)), Float(ray_cone::sphere_density(n, o.z)),
            Float(cone.scattered(o.z, o.y, o.x, random::uniform::<L>(o.i, 0)).angle),
        ]
    };
    light_samples_are_the_same_at_every_width: |o| {
        let [a, ab] = [Vec3::new(o.x, o.y, o.z), Vec3::new(o.y, -o.z, o.x)];
        let (u, v) = (random::uniform::<L>(o.i, 0), random::uniform::<L>(o.j, 1));
        let flat = primitives::FlatLight { a, ab, ac: ab.cross(a), is_quad: o.mask };
        let mut values = Vec::new();
        for sample in [primitives::flat::sample(&flat, u, v), primitives::sphere::sample(a, o.x.abs() * u, u, v)] {
            let is_seen = L::zero().lt(sample.pdf);
            values.extend([Float(sample.pdf), Truth(is_seen)]);
            values.extend(vector(Vec3::select(is_seen, sample.wi, a)));
        }
        values
    };
    spheres_are_the_same_at_every_width: |o| {
        let (ray, target) = aimed(&o);
        let mut values = Vec::new();
        fn hit<S: SphereMethod, L: Lane>(ray: &Ray<L>, center: Vec3<L>, limit: L, values: &mut Vec<Value<L>>) {
            let (mask, t) = S::test(&S::precalculate(ray), center, L::splat(0.25), limit);
            values.extend([Truth(mask), Float(t.only(mask))]);
        }
        hit::<methods::Robust, L>(&ray, target, o.x.abs() * L::splat(8.0), &mut values);
        hit::<methods::RobustAnyLength, L>(&ray, target, L::splat(f32::INFINITY), &mut values);
        hit::<methods::Naive, L>(&ray, target, o.x.abs() * L::splat(8.0), &mut values);
        values
    };
    triangles_are_the_same_at_every_width: |o| {
        let (ray, _) = aimed(&o);
        let mut values = Vec::new();
        fn hit<T: TriangleMethod, L: Lane>(ray: &Ray<L>, limit: L, values: &mut Vec<Value<L>>) {
            let corners = [[0.1, 0.0, 0.3], [1.0, 0.1, 0.2], [0.0, 0.9, 0.4]].map(glam::Vec3::from);
            let hit = T::test(&T::precalculate(ray), &T::store(corners), limit);
            values.push(Truth(hit.mask));
            values.extend([hit.t, hit.u, hit.v].map(|x| Float(x.only(hit.mask))));
        }
        hit::<methods::Woop, L>(&ray, o.x.abs() * L::splat(8.0), &mut values);
        hit::<methods::WoopContracted, L>(&ray, L::splat(f32::INFINITY), &mut values);
        hit::<methods::MollerTrumbore, L>(&ray, o.x.abs() * L::splat(8.0), &mut values);
        hit::<methods::MollerTrumboreEpsilon, L>(&ray, L::splat(f32::INFINITY), &mut values);
        hit::<methods::BaldwinWeber, L>(&ray, L::splat(f32::INFINITY), &mut values);
        hit::<methods::Plucker, L>(&ray, L::splat(f32::INFINITY), &mut values);
        values
    };
    boxes_are_the_same_at_every_width: |o| {
        let (ray, target) = aimed(&o);
        let (a, b) = (target, Vec3::new(o.x, o.z, L::splat(0.5)));
        let of = |pick: fn(L, L) -> L| Vec3::new(pick(a.x, b.x), pick(a.y, b.y), pick(a.z, b.z));
        let (lo, hi) = (of(L::min), of(L::max));
        let mut values = Vec::new();
        for padding in [Padding::new(1.0), Padding::new(1.0).with_spheres()] {
            let slabs = BoxRay::new(&ray, padding);
            let (near, far) = slabs.pass(lo, hi);
            let (hit, t) = own_box(&slabs, (lo, hi), o.mask, o.y, o.x.abs());
            values.extend([Float(near), Float(far), Truth(hit), Float(t)]);
        }
        fn pass<B: BoxMethod, L: Lane>(ray: &Ray<L>, [lo, hi]: [Vec3<L>; 2], values: &mut Vec<Value<L>>) {
            let (near, far) = B::pass(&B::precalculate(ray, Padding::new(1.0)), lo, hi);
            values.extend([Float(near), Float(far)]);
        }
        pass::<methods::Padded, L>(&ray, [lo, hi], &mut values);
        pass::<methods::BySign, L>(&ray, [lo, hi], &mut values);
        pass::<methods::BySignWidened, L>(&ray, [lo, hi], &mut values);
        pass::<methods::Contracted, L>(&ray, [lo, hi], &mut values);
        pass::<methods::X86MinMax, L>(&ray, [lo, hi], &mut values);
        pass::<methods::IeeeMinMax, L>(&ray, [lo, hi], &mut values);
        values
    };
    texels_are_the_same_at_every_width: |o| {
        let size = |i: L::Bits| L::from_int(i.wrapping_add(L::Bits::splat(1)));
        let grid = texture::Grid::<L> { width: size(o.k), height: size(o.i.shr(28)), first: L::Bits::splat(5) };
        let (texels, right, lower) = grid.bilinear(o.x, o.y, o.mask);
        let mut values = vec![Integer(grid.nearest(o.x, o.y, o.mask)), Float(right), Float(lower)];
        values.extend(texels.map(Integer));
        values.extend(vector(texture::srgb_to_linear::<L>(o.i)));
        values
    };
}

/// A ray towards a point near the origin, if its numbers are such.
fn aimed<L: Lane>(o: &Input<L>) -> (Ray<L>, Vec3<L>) {
    let (origin, target) = (Vec3::new(o.x, o.y, o.z), Vec3::new(o.y, o.z, o.x));
    let aside = Vec3::new(random::uniform::<L>(o.i, 0), random::uniform::<L>(o.j, 1), L::zero());
    (Ray { origin, direction: (target - origin + aside * L::splat(0.6)).normalize() }, target)
}

/// A truth value as a sign, for the tests' own use.
trait Sign {
    fn bitmask_sign<L: Lane<Mask = Self>>(self) -> L;
}
impl<M: Mask> Sign for M {
    fn bitmask_sign<L: Lane<Mask = M>>(self) -> L {
        L::select(self, L::one(), -L::one())
    }
}

#[test]
fn packing_moves_the_lanes_of_every_mask_to_the_front() {
    fn check<L: Lane>() {
        let (floats, integers) =
            (L::from_fn(|lane| lane as f32 + 0.5), L::Bits::from_fn(|lane| lane as u32 + 100));
        for bits in 0..1u32 << L::WIDTH {
            let mask = mask_of::<L>(bits);
            let (packed, packed_bits) = (floats.compress(mask), integers.compress(mask));
            let chosen = (0..L::WIDTH).filter(|lane| bits >> lane & 1 == 1);
            assert_eq!(mask.count(), chosen.clone().count());
            for (to, from) in chosen.enumerate() {
                assert_eq!(packed.get(to), floats.get(from), "mask {bits:#b}");
                assert_eq!(packed_bits.get(to), integers.get(from), "mask {bits:#b}");
            }
        }
    }
    check::<F32x8>();
    check::<F32x16>();
    // At width one the only lane is the first.
    assert_eq!((7.5_f32.compress(true), 9.compress(true)), (7.5, 9));
}

#[test]
fn numbers_in_memory_are_broadcast_bit_for_bit() {
    fn check<L: Lane>(numbers: &[f32]) {
        for number in numbers {
            let lanes = L::broadcast(number);
            for lane in 0..L::WIDTH {
                assert_eq!(lanes.get(lane).to_bits(), number.to_bits());
            }
        }
    }
    let numbers = special();
    check::<f32>(&numbers);
    check::<F32x8>(&numbers);
    check::<F32x16>(&numbers);
}

fn mask_of<L: Lane>(bits: u32) -> L::Mask {
    L::Bits::from_fn(|lane| bits >> lane & 1).equals(L::Bits::splat(1))
}

#[test]
fn mask_reductions_agree_with_their_lanes() {
    fn check<L: Lane>() {
        let every = (1u32 << L::WIDTH) - 1;
        for bits in 0..=every {
            let mask = mask_of::<L>(bits);
            assert_eq!(mask.bitmask(), bits);
            assert_eq!(mask.any(), bits != 0);
            assert_eq!(mask.all(), bits == every);
            assert_eq!(mask.count(), bits.count_ones() as usize);
            assert_eq!((!mask).bitmask(), bits ^ every);
            let other = mask_of::<L>(bits.wrapping_mul(37) & every);
            assert_eq!((mask & other).bitmask(), bits & other.bitmask());
            assert_eq!((mask | other).bitmask(), bits | other.bitmask());
            assert_eq!((mask ^ other).bitmask(), bits ^ other.bitmask());
        }
    }
    check::<F32x8>();
    check::<F32x16>();
    for mask in [false, true] {
        assert_eq!((mask.any(), mask.all()), (mask, mask));
        assert_eq!((mask.bitmask(), Mask::count(mask)), (u32::from(mask), usize::from(mask)));
    }
}

#[test]
fn set_bits_are_told_from_the_lowest_on() {
    for mask in [0, 1, 0x8000_0000, 0x8000_0001, 0b1011_0100, u32::MAX] {
        let expected: Vec<usize> = (0..32).filter(|bit| mask >> bit & 1 == 1).collect();
        assert_eq!(set_bits(mask).collect::<Vec<_>>(), expected, "{mask:b}");
        let twice = u64::from(mask) << 32 | u64::from(mask);
        let again = expected.iter().map(|bit| bit + 32);
        let expected: Vec<usize> = expected.iter().copied().chain(again).collect();
        assert_eq!(set_bits(twice).collect::<Vec<_>>(), expected, "{twice:b}");
    }
}

#[test]
fn first_lanes_are_those_below_the_count() {
    fn check<M: Mask>() {
        for count in 0..40 {
            assert_eq!(M::first(count).bitmask(), (1u32 << count.min(M::WIDTH)) - 1);
        }
        assert_eq!(M::splat(true).bitmask(), (1u32 << M::WIDTH) - 1);
        assert_eq!(M::splat(false).bitmask(), 0);
    }
    check::<bool>();
    check::<<F32x8 as Lane>::Mask>();
    check::<<F32x16 as Lane>::Mask>();
}

#[test]
fn loads_and_stores_keep_bits_and_touch_no_neighbour() {
    fn check<L: Lane>() {
        let integers: Vec<u32> = (0..48).map(|i: u32| i.wrapping_mul(0x9e37_79b9) | 0x7f80_0001).collect();
        let floats: Vec<f32> = integers.iter().map(|&bits| f32::from_bits(bits)).collect();
        let end = 1 + L::WIDTH;
        for at in 0..30 {
            let (loaded, loaded_bits) = (L::load(&floats[at..]), L::Bits::load(&integers[at..]));
            for lane in 0..L::WIDTH {
                assert_eq!(loaded.to_bits().get(lane), integers[at + lane]);
                assert_eq!(loaded_bits.get(lane), integers[at + lane]);
            }
            let (mut to, mut to_bits) = ([1.0_f32; 18], [1_u32; 18]);
            loaded.store(&mut to[1..]);
            loaded_bits.store(&mut to_bits[1..]);
            assert_eq!(to_bits[1..end], integers[at..at + L::WIDTH]);
            assert_eq!(to.map(f32::to_bits)[1..end], integers[at..at + L::WIDTH]);
            assert_eq!((to[0], to[end], to_bits[0], to_bits[end]), (1.0, 1.0, 1, 1));
        }
        assert!((0..L::WIDTH).all(|lane| lane_indices::<L>().get(lane) == lane as u32));
    }
    check::<f32>();
    check::<F32x8>();
    check::<F32x16>();
}

#[test]
fn gather_rows_panics_when_an_index_of_one_lane_is_outside() {
    fn check<L: Lane>() {
        let gather = || {
            let beyond = L::Bits::from_fn(|lane| if lane == 6 { 4 } else { 0 });
            L::gather_rows::<8>(&[[0.0; 8]; 4], beyond);
        };
        let panicked = std::panic::catch_unwind(gather).unwrap_err();
        let message = panicked.downcast_ref::<String>().unwrap();
        assert!(message.contains("index out of bounds"), "{message}");
    }
    check::<F32x8>();
    check::<F32x16>();
}

#[test]
fn floor_and_rounding_agree_with_std() {
    // Parity alone would be content with both widths wrong.
    for Input { x, y, .. } in cases() {
        let same = |a: f32, b: f32| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
        assert!(same(Lane::floor(x), f32::floor(x)), "floor of {x:?}");
        assert!(same(Lane::abs(x), f32::abs(x)), "{x:?}");
        assert!(same(Lane::copysign(x, y), f32::copysign(x, y)), "{x:?}, {y:?}");
        assert_eq!(Lane::is_finite(x), f32::is_finite(x), "{x:?}");
        let inside = f32::abs(x) < 2_147_483_648.0;
        let integer = if inside { x as i32 as u32 } else { 0x8000_0000 };
        assert_eq!(x.truncate_to_int(), integer, "{x:?}");
        let (least, most) = (Lane::min(x, y), Lane::max(x, y));
        if x.is_nan() || y.is_nan() || x == y {
            // The second operand, as documented; equal numbers may be zeros of different sign.
            assert!(same(least, y) && same(most, y), "{x:?}, {y:?}");
        } else {
            assert!(same(least, f32::min(x, y)) && same(most, f32::max(x, y)), "{x:?}, {y:?}");
        }
    }
}

#[test]
fn users_of_the_library_can_ask_what_it_was_compiled_for() {
    assert_eq!(octray::lane::INSTRUCTIONS.starts_with("AVX"), octray::lane::FUSED);
}
