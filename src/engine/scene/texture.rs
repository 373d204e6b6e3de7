//! Textures and their texels.

use crate::math::portable;
use serde::Deserialize;
use std::sync::LazyLock;

/// An image for surfaces or the sky.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// The name of the file.
    pub name: String,
    /// The number of texels in a row.
    pub width: u32,
    /// The number of rows of texels.
    pub height: u32,
    /// The interpolation between texel centres.
    pub filter: Filter,
    /// The continuation beyond the edges, along u and along v.
    pub wrap: [Wrap; 2],
    /// The `width · height` texels, row by row from the top.
    pub texels: Texels,
}

impl Texture {
    /// Iterates over the sizes of the levels of detail after the texture's own texels:
    /// [`Texture::halved_sizes`] for [`Filter::Trilinear`], else none.
    pub fn level_sizes(&self) -> impl Iterator<Item = [u32; 2]> + use<> {
        let has_levels = self.filter == Filter::Trilinear;
        self.halved_sizes().take_while(move |_| has_levels)
    }
    /// Iterates over sizes halved again and again, rounded down and at least 1, down to one texel.
    pub fn halved_sizes(&self) -> impl Iterator<Item = [u32; 2]> + use<> {
        let halved = |size: &[u32; 2]| (*size != [1, 1]).then(|| size.map(|side| (side / 2).max(1)));
        std::iter::successors(Some([self.width, self.height]), halved).skip(1)
    }
    /// Returns the size of the texels in bytes, levels of detail included: these take a third more, or as
    /// much again in a texture of one row.
    pub fn bytes(&self) -> usize {
        let texels = self.level_sizes().map(|[width, height]| width as usize * height as usize);
        self.texels.bytes() + texels.sum::<usize>() * self.texels.bytes_each()
    }
}

/// The texels of a texture, in the smallest format that keeps its accuracy: a texture that fits the cache is
/// read several times as fast.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// 8-bit sRGB: red, green, blue and an unused byte.
    Srgb8(Vec<[u8; 4]>),
    /// 8-bit unorm, byte / 255, for numbers that are not colours: normals, roughness. The fourth byte is
    /// unused.
    Unorm8(Vec<[u8; 4]>),
    /// Linear red, green, blue and an unused number.
    Float32(Vec<[f32; 4]>),
}

impl Texels {
    /// Returns the number of texels.
    pub fn len(&self) -> usize {
        match self {
            Self::Srgb8(texels) | Self::Unorm8(texels) => texels.len(),
            Self::Float32(texels) => texels.len(),
        }
    }
    /// Tests whether there are no texels.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Returns the size of the texels in bytes.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Srgb8(texels) | Self::Unorm8(texels) => size_of_val(texels.as_slice()),
            Self::Float32(texels) => size_of_val(texels.as_slice()),
        }
    }
    /// Returns the size of one texel in bytes.
    fn bytes_each(&self) -> usize {
        match self {
            Self::Srgb8(_) | Self::Unorm8(_) => size_of::<[u8; 4]>(),
            Self::Float32(_) => size_of::<[f32; 4]>(),
        }
    }
    /// Returns one texel, decoded: sRGB by IEC 61966-2-1, other formats as plain numbers.
    pub fn linear(&self, index: usize) -> [f64; 3] {
        match self {
            Self::Srgb8(texels) => {
                let [r, g, b, _] = texels[index];
                [r, g, b].map(|byte| SRGB_BYTES[usize::from(byte)])
            }
            Self::Unorm8(texels) => {
                let [r, g, b, _] = texels[index];
                [r, g, b].map(|byte| f64::from(byte) / 255.0)
            }
            Self::Float32(texels) => {
                let [r, g, b, _] = texels[index];
                [r, g, b].map(f64::from)
            }
        }
    }
}

/// The linear value of each sRGB byte.
static SRGB_BYTES: LazyLock<[f64; 256]> =
    LazyLock::new(|| std::array::from_fn(|byte| srgb_to_linear(byte as f64 / 255.0)));

/// The meaning of an image file's texels, which decides whether they are decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TexelKind {
    /// Colours: sRGB files are decoded.
    Color,
    /// Normals or roughness: never decoded.
    Data,
    /// The alpha channel; 1 if the picture has none.
    Alpha,
    /// The alpha channel; if the picture has none, its grey, which is not decoded.
    AlphaOrGrey,
}

/// Returns the linear value of an sRGB value. Values above 1 follow the same curve. Source: IEC 61966-2-1.
///
/// Every conversion between bytes and linear values is a table of this function, apart from the polynomial of
/// [`crate::kernel::texture`], which decodes texels while paths are traced.
pub fn srgb_to_linear(x: f64) -> f64 {
    if x <= 0.04045 { x / 12.92 } else { portable::pow((x + 0.055) / 1.055, 2.4) }
}

/// The linear values halfway between consecutive sRGB bytes, ascending. The number of borders at or below a
/// linear value is the nearest byte.
pub static SRGB_BORDERS: LazyLock<[f64; 255]> =
    LazyLock::new(|| std::array::from_fn(|byte| srgb_to_linear((byte as f64 + 0.5) / 255.0)));

/// The continuation of a texture beyond its edges on triangles. On spheres and the sky u repeats, and v is
/// clamped, because it stays within [0, 1]. Scene files have these names in lower case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Wrap {
    /// The texture repeats.
    #[default]
    Repeat,
    /// The texels at the edge continue.
    Clamp,
    /// The texture repeats, every second time mirrored.
    Mirror,
}

impl Wrap {
    /// Returns its name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Repeat => "repeat",
            Self::Clamp => "clamp",
            Self::Mirror => "mirror",
        }
    }
    /// Returns the coordinate in [0, 1] at which the texture shows what it shows at `x`.
    pub fn fold(self, x: f64) -> f64 {
        match self {
            Self::Repeat => x.rem_euclid(1.0),
            Self::Clamp => x.clamp(0.0, 1.0),
            Self::Mirror => 1.0 - (1.0 - x.rem_euclid(2.0)).abs(),
        }
    }
}

/// The interpolation between texel centres. Scene files have these names in lower case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Filter {
    /// The nearest texel.
    Nearest,
    /// Interpolated between four texels.
    #[default]
    Bilinear,
    /// Bilinear in the two levels of detail whose texels are about as wide as a path's view of the texture,
    /// blended: [`crate::kernel::ray_cone`]. If texels are wider than that, it is the same as bilinear.
    Trilinear,
}
