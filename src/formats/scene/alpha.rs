//! Makes opacity maps of pictures.

use super::texture::{Decoded, display_texels};
use image::{DynamicImage, GenericImageView};
use octray_engine::scene::{TexelKind, Texels};

/// Makes the texels of an opacity map of a picture's alpha channel. Without one they are 1, or those of its
/// grey values.
pub fn alpha_texels(picture: DynamicImage, texel_kind: TexelKind) -> Decoded {
    let (width, height) = picture.dimensions();
    if !picture.color().has_alpha() {
        return match texel_kind {
            TexelKind::AlphaOrGrey => (width, height, display_texels(picture.grayscale(), TexelKind::Data)),
            TexelKind::Color | TexelKind::Data | TexelKind::Alpha => {
                (1, 1, Texels::Unorm8(vec![[255, 255, 255, 0]]))
            }
        };
    }
    let texels = match picture {
        DynamicImage::ImageLumaA16(_) | DynamicImage::ImageRgba16(_) => {
            let texel = |pixel: &image::Rgba<u16>| {
                let alpha = f32::from(pixel[3]) / 65_535.0;
                [alpha, alpha, alpha, 0.0]
            };
            Texels::Float32(picture.into_rgba16().pixels().map(texel).collect())
        }
        _ => {
            let texel = |pixel: &image::Rgba<u8>| [pixel[3], pixel[3], pixel[3], 0];
            Texels::Unorm8(picture.into_rgba8().pixels().map(texel).collect())
        }
    };
    (width, height, texels)
}
