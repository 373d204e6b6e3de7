//! ꟻLIP: the difference of two pictures as perceived when a screen alternates between them.
//!
//! Source: Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild, "FLIP: A Difference Evaluator
//! for Alternating Images", Proceedings of the ACM on Computer Graphics and Interactive Techniques 3(2), 2020
//! (HPG), section 4; the low-dynamic-range form. Written from the paper; the test `flip` compares it with the
//! authors' program. Two differences do not affect the result: filters are separable, in x and then in y, and
//! opponent colours lack their constant factors, as filters are linear.
//!
//! 1. Colour (section 4.1): contrast sensitivity filters blur details that the eye cannot resolve, in
//!    opponent colours; then the HyAB distance in L*a*b*, corrected for the Hunt effect and mapped to [0, 1].
//! 2. Features (section 4.2): difference of edges and points, in [0, 1].
//! 3. The difference of a pixel (section 4.3) is colour^(1 − feature): features increase a colour difference.

mod filters;

use crate::film::Picture;
use crate::scene::srgb_to_linear;
use crate::tone::Tone;
use filters::{Kernel, columns, rows};
use glam::{DMat3, DVec3, Vec3};
use std::f64::consts::PI;
use std::sync::LazyLock;

/// A screen 3840 pixels and 0.7 m wide, seen from 0.7 m (section 4.1).
pub const PIXELS_PER_DEGREE: f64 = 67.0;

/// The eye's contrast sensitivity as a sum of Gaussians a √(π/b) exp(−π² x²/b), x in degrees: pairs of a and
/// b for achromatic, red-green and blue-yellow (table 1).
const ACHROMATIC: (f64, f64) = (1.0, 0.0047);
const RED_GREEN: (f64, f64) = (1.0, 0.0053);
const BLUE_YELLOW: [(f64, f64); 2] = [(34.1, 0.04), (13.5, 0.025)];

/// Section 4.1: the exponent of colour differences (qc), and the share of the largest one (pc) that maps to
/// `HIGH` (pt).
const COLOR_EXPONENT: f32 = 0.7;
const LOW: f32 = 0.4;
const HIGH: f32 = 0.95;
/// The width of a feature in degrees (w), and the exponent of their difference (qf): section 4.2.
const FEATURE_DEGREES: f64 = 0.082;
const FEATURE_EXPONENT: f32 = 0.5;

/// One picture, prepared for comparison with many.
#[derive(Clone, Debug)]
pub struct Flip {
    tone: Tone,
    eye: Eye,
    reference: Filtered,
}

impl Flip {
    /// Prepares a picture with the default tone mapping, at [`PIXELS_PER_DEGREE`].
    pub fn of(reference: &Picture) -> Self {
        Self::with(reference, Tone::default(), PIXELS_PER_DEGREE)
    }

    /// Prepares a picture with this tone mapping and this many pixels per degree of the field of view.
    pub fn with(reference: &Picture, tone: Tone, pixels_per_degree: f64) -> Self {
        let eye = Eye::at(pixels_per_degree);
        Self { tone, reference: eye.filter(reference, &tone), eye }
    }

    /// Returns the mean difference of the pixels: 0 for equal pictures, 1 for green against blue. It is that
    /// of their .png files, at eight bits a channel.
    ///
    /// # Panics
    /// If the pictures differ in size.
    pub fn against(&self, picture: &Picture) -> f64 {
        let (ours, theirs) = (&self.reference, self.eye.filter(picture, &self.tone));
        assert_eq!(ours.size, theirs.size, "pictures of one size");
        let pixels = (0..ours.colors.len()).map(|i| {
            let color = to_unit(hyab(ours.colors[i], theirs.colors[i]));
            let [edges, points] =
                [0, 1].map(|kind| (ours.features[kind][i] - theirs.features[kind][i]).abs());
            let feature = (edges.max(points) * std::f32::consts::FRAC_1_SQRT_2).powf(FEATURE_EXPONENT);
            f64::from(color.powf(1.0 - feature))
        });
        pixels.sum::<f64>() / ours.colors.len() as f64
    }
}

/// A picture after the filters.
#[derive(Clone, Debug)]
struct Filtered {
    size: [u32; 2],
    /// L*a*b* after the blur, with the Hunt effect.
    colors: Vec<Vec3>,
    /// Strength of edges, and of points, at each pixel.
    features: [Vec<f32>; 2],
}

/// The filters at one viewing distance.
#[derive(Clone, Debug)]
struct Eye {
    achromatic: Kernel,
    red_green: Kernel,
    /// Two Gaussians and their shares.
    blue_yellow: [(Kernel, f32); 2],
    /// A Gaussian, its first and its second derivative.
    feature: [Kernel; 3],
}

impl Eye {
    fn at(pixels_per_degree: f64) -> Self {
        assert!(pixels_per_degree > 0.0, "pixels per degree: {pixels_per_degree}");
        // Three standard deviations of the widest one.
        let radius = (3.0 * (BLUE_YELLOW[0].1 / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil();
        let gauss = |b: f64| move |x: f64| (-(PI * x / pixels_per_degree).powi(2) / b).exp();
        let blur = |(_, b): (f64, f64)| Kernel::blur(radius as usize, gauss(b));
        // The sum of the weights in the plane: the square of a row's sum.
        let whole = |(a, b): (f64, f64)| {
            let row: f64 = (-radius as i32..=radius as i32).map(|x| gauss(b)(f64::from(x))).sum();
            a * (PI / b).sqrt() * row * row
        };
        let both: f64 = BLUE_YELLOW.into_iter().map(whole).sum();
        let sigma = 0.5 * FEATURE_DEGREES * pixels_per_degree;
        let radius_of_features = (3.0 * sigma).ceil() as usize;
        let bell = |x: f64| (-(x / sigma).powi(2) / 2.0).exp();
        Self {
            achromatic: blur(ACHROMATIC),
            red_green: blur(RED_GREEN),
            blue_yellow: BLUE_YELLOW.map(|term| (blur(term), (whole(term) / both) as f32)),
            feature: [
                Kernel::blur(radius_of_features, bell),
                Kernel::difference(radius_of_features, |x| -x * bell(x)),
                Kernel::difference(radius_of_features, |x| ((x / sigma).powi(2) - 1.0) * bell(x)),
            ],
        }
    }

    /// Applies steps 1 and 2 to one picture.
    fn filter(&self, picture: &Picture, tone: &Tone) -> Filtered {
        let width = picture.width as usize;
        let [luminance, red_green, blue_yellow] = opponents(&tone.bytes(picture));
        let blur = |values: &[f32], kernel: &Kernel| {
            let [across] = rows(values, width, [kernel]);
            columns(&across, width, kernel)
        };
        let blurred = [blur(&luminance, &self.achromatic), blur(&red_green, &self.red_green)];
        let [wide, narrow] = &self.blue_yellow;
        let (wide, narrow) =
            ((blur(&blue_yellow, &wide.0), wide.1), (blur(&blue_yellow, &narrow.0), narrow.1));
        let color = |i: usize| {
            let blue_yellow = wide.0[i] * wide.1 + narrow.0[i] * narrow.1;
            perceived([blurred[0][i], blurred[1][i], blue_yellow])
        };
        Filtered {
            size: [picture.width, picture.height],
            colors: (0..luminance.len()).map(color).collect(),
            features: self.features(&luminance, width),
        }
    }

    /// Returns the strength of edges and of points at each pixel (section 4.2): the length of the vector of
    /// the derivative filter in x and in y, each blurred in the other direction.
    fn features(&self, luminance: &[f32], width: usize) -> [Vec<f32>; 2] {
        let [bell, edge, point] = &self.feature;
        let [blurred, edges, points] = rows(luminance, width, [bell, edge, point]);
        [(edges, edge), (points, point)].map(|(across, kernel)| {
            let (x, y) = (columns(&across, width, bell), columns(&blurred, width, kernel));
            x.iter().zip(&y).map(|(x, y)| (x * x + y * y).sqrt()).collect()
        })
    }
}

/// Linear sRGB to CIE XYZ, divided by the white point so that white is (1, 1, 1). Source: IEC 61966-2-1
/// (primaries), CIE 15 (D65).
static WHITE_XYZ: LazyLock<DMat3> = LazyLock::new(|| {
    let red = DVec3::new(0.412_386_56, 0.212_636_82, 0.019_330_62);
    let green = DVec3::new(0.357_591_49, 0.715_182_98, 0.119_197_16);
    let blue = DVec3::new(0.180_450_49, 0.072_180_20, 0.950_372_59);
    let xyz = DMat3::from_cols(red, green, blue);
    DMat3::from_diagonal((xyz * DVec3::ONE).recip()) * xyz
});
/// The conversion and its inverse, as f32.
static FROM_RGB: LazyLock<glam::Mat3> = LazyLock::new(|| WHITE_XYZ.as_mat3());
static TO_RGB: LazyLock<glam::Mat3> = LazyLock::new(|| WHITE_XYZ.inverse().as_mat3());

/// Returns Y, X − Y and Y − Z of each pixel, white being (1, 1, 1): the paper's YCxCz is (116 Y − 16, 500 (X
/// − Y), 200 (Y − Z)).
fn opponents(bytes: &[u8]) -> [Vec<f32>; 3] {
    static LINEAR: LazyLock<[f32; 256]> =
        LazyLock::new(|| std::array::from_fn(|byte| srgb_to_linear(byte as f64 / 255.0) as f32));
    let (linear, from_rgb) = (&*LINEAR, *FROM_RGB);
    let mut channels = [(); 3].map(|()| Vec::with_capacity(bytes.len() / 3));
    for pixel in bytes.as_chunks::<3>().0 {
        let xyz = from_rgb * Vec3::from(pixel.map(|byte| linear[usize::from(byte)]));
        let values = [xyz.y, xyz.x - xyz.y, xyz.y - xyz.z];
        channels.iter_mut().zip(values).for_each(|(channel, value)| channel.push(value));
    }
    channels
}

/// Converts blurred opponent colours, clamped to the screen's gamut, to L*a*b* with the Hunt effect.
fn perceived([luminance, red_green, blue_yellow]: [f32; 3]) -> Vec3 {
    let xyz = Vec3::new(luminance + red_green, luminance, luminance - blue_yellow);
    hunt(*FROM_RGB * (*TO_RGB * xyz).clamp(Vec3::ZERO, Vec3::ONE))
}

/// Converts a colour over white to L*a*b* (CIE 15), with chroma times lightness, the Hunt effect: brighter
/// colours look more colourful (section 4.1).
fn hunt(xyz: Vec3) -> Vec3 {
    // Below (6/29)³, the tangent of the cube root.
    const DELTA: f32 = 6.0 / 29.0;
    let root = |t: f32| {
        if t > DELTA * DELTA * DELTA { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
    };
    let (x, y, z) = (root(xyz.x), root(xyz.y), root(xyz.z));
    let lightness = 116.0 * y - 16.0;
    Vec3::new(lightness, 0.01 * lightness * 500.0 * (x - y), 0.01 * lightness * 200.0 * (y - z))
}

/// Returns the HyAB distance: the difference in lightness plus the Euclidean distance in chroma. Source:
/// Abasi, Amani Tehran, Fairchild, "Distance metrics for very large color differences", Color Research and
/// Application 45(2), 2020.
fn hyab(a: Vec3, b: Vec3) -> f32 {
    let apart = a - b;
    apart.x.abs() + apart.y.hypot(apart.z)
}

/// Maps a colour distance to [0, 1]: the power curve, then a line to (pc · largest, pt) and one from there to
/// (largest, 1). The largest distance is that of the screen's green and blue (section 4.1).
fn to_unit(distance: f32) -> f32 {
    static LARGEST: LazyLock<f32> = LazyLock::new(|| {
        let [green, blue] = [Vec3::Y, Vec3::Z].map(|rgb| hunt(*FROM_RGB * rgb));
        hyab(green, blue).powf(COLOR_EXPONENT)
    });
    let share = distance.powf(COLOR_EXPONENT) / *LARGEST;
    if share < LOW { share / LOW * HIGH } else { HIGH + (share - LOW) / (1.0 - LOW) * (1.0 - HIGH) }
}
