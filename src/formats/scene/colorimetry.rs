//! Converts the colours of picture files to linear Rec. 709, the primaries of scenes.

use crate::openexr::Chromaticities;
use glam::{DMat3, DVec3, Vec3};
use image::{DynamicImage, Rgb};
use moxcms::{
    Chromaticity, CicpProfile, ColorPrimaries, ColorProfile, ToneReprCurve, TransferCharacteristics,
};
use octray_engine::scene::{Texels, srgb_to_linear};

const REC709: Chromaticities = [[0.64, 0.33], [0.3, 0.6], [0.15, 0.06], [0.3127, 0.329]];
/// Largest difference in a linear channel of colours or curves that count as the same: files round them.
const SAME: f64 = 2e-3;

/// Returns the matrix from linear RGB to CIE XYZ. Source: SMPTE RP 177.
fn to_xyz(file: Chromaticities) -> DMat3 {
    let xyz = |[x, y]: [f32; 2]| DVec3::new(x.into(), y.into(), 1.0 - f64::from(x) - f64::from(y));
    let [red, green, blue, white] = file.map(xyz);
    let primaries = DMat3::from_cols(red, green, blue);
    primaries * DMat3::from_diagonal(primaries.inverse() * (white / white.y))
}

/// Returns the matrix from CIE XYZ to linear Rec. 709.
pub fn xyz_to_rec709() -> DMat3 {
    to_xyz(REC709).inverse()
}

/// Returns the matrix from linear RGB of these primaries to linear Rec. 709; `None` if they span no colours.
/// White is not adapted, because a picture of radiance has no viewer.
pub fn to_rec709(file: Chromaticities) -> Option<DMat3> {
    let found = xyz_to_rec709() * to_xyz(file);
    found.is_finite().then_some(found)
}

/// Converts linear colours, unless the matrix is nearly the identity.
pub fn convert(pixels: &mut [[f32; 3]], matrix: DMat3) {
    if !matrix.abs_diff_eq(DMat3::IDENTITY, SAME) {
        for pixel in pixels {
            let color = matrix * DVec3::from(pixel.map(f64::from));
            *pixel = color.min(DVec3::splat(f32::MAX.into())).as_vec3().to_array();
        }
    }
}

/// Returns the profile of code points for video; `None` if their values are not relative to white.
pub fn cicp(codes: png::CodingIndependentCodePoints) -> Option<ColorProfile> {
    let transfer = TransferCharacteristics::try_from(codes.transfer_function).ok()?;
    let is_absolute = [TransferCharacteristics::Smpte2084, TransferCharacteristics::Hlg].contains(&transfer);
    (codes.is_video_full_range_image && !is_absolute).then_some(ColorProfile::new_from_cicp(CicpProfile {
        color_primaries: codes.color_primaries.try_into().ok()?,
        transfer_characteristics: transfer,
        matrix_coefficients: codes.matrix_coefficients.try_into().ok()?,
        full_range: true,
    }))
}

/// Returns the profile of an exponent and of primaries; those of sRGB stand for missing ones.
pub fn chromatic(gamma: Option<f32>, primaries: Option<Chromaticities>) -> ColorProfile {
    let mut profile = ColorProfile::new_srgb();
    if let Some(file) = primaries.filter(|file| to_rec709(*file).is_some()) {
        let [red, green, blue, white] = file.map(|[x, y]| Chromaticity { x, y });
        profile.update_rgb_colorimetry(white.to_xyyb(), ColorPrimaries { red, green, blue });
    }
    if let Some(curve) = gamma.map(|gamma| Some(ToneReprCurve::Parametric(vec![gamma]))) {
        (profile.red_trc, profile.green_trc, profile.blue_trc) = (curve.clone(), curve.clone(), curve);
    }
    profile
}

/// Converts a picture to linear texels, clipped to Rec. 709. Returns `Some(None)` if the profile is sRGB, and
/// `None` if it has no curves, as profiles of tables and those of other colours than RGB or grey.
pub fn linear(profile: &ColorProfile, picture: &DynamicImage) -> Option<Option<Texels>> {
    let grey = profile.gray_trc.as_ref();
    let rows = profile.transform_matrix(&ColorProfile::new_srgb()).v;
    let to_rec709 = grey.map_or(DMat3::from_cols_array_2d(&rows).transpose(), |_| DMat3::IDENTITY);
    let curve = |own: &Option<ToneReprCurve>| grey.or(own.as_ref())?.make_linear_evaluator().ok();
    let curves = [curve(&profile.red_trc)?, curve(&profile.green_trc)?, curve(&profile.blue_trc)?];
    let differs = |x: u8| {
        let (x, srgb) = (f32::from(x) / 255.0, srgb_to_linear(f64::from(x) / 255.0));
        curves.iter().any(|curve| (f64::from(curve.evaluate_value(x)) - srgb).abs() > SAME)
    };
    if to_rec709.abs_diff_eq(DMat3::IDENTITY, SAME) && !(0..=u8::MAX).any(differs) {
        return Some(None);
    }
    let tables: [Vec<f32>; 3] =
        curves.map(|curve| (0..=u16::MAX).map(|x| curve.evaluate_value(f32::from(x) / 65_535.0)).collect());
    let value = |&Rgb(pixel): &Rgb<u16>| std::array::from_fn(|at| tables[at][usize::from(pixel[at])]);
    let mut pixels: Vec<[f32; 3]> = picture.to_rgb16().pixels().map(value).collect();
    convert(&mut pixels, to_rec709);
    let texel = |pixel: [f32; 3]| Vec3::from(pixel).clamp(Vec3::ZERO, Vec3::ONE).extend(0.0).to_array();
    to_rec709.is_finite().then(|| Some(Texels::Float32(pixels.into_iter().map(texel).collect())))
}
