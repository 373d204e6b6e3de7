//! Stores colours of vertices in a texture, as the engine has no other colours that vary on a triangle.
//!
//! Each triangle has a patch of 2 × 2 texels, with its corners at the centres of three of them:
//!
//! ```text
//! a  b          the fourth texel is b + c − a, so that the bilinear blend of the four
//! c  b+c−a      is a + x (b − a) + y (c − a), linear over the triangle
//! ```
//!
//! The fourth texel may be negative or above 1, but no point of the triangle is. Rounding mixes in at most a
//! 1024th of a neighbouring patch, the resolution of texture coordinates.

use super::error::SceneError;
use super::texture::Textures;
use glam::{Vec2, Vec3};
use octray_engine::scene::{Filter, MAX_SIDE, Texels, Texture, Wrap};
use std::collections::HashMap;

/// The name of the texture.
pub const NAME: &str = "(vertex colours)";

/// Returns the one of these numbers, in ascending order, that stands for white if colours have these
/// channels. Colours may exceed white a little, but not twofold.
pub fn white(channels: impl Iterator<Item = f32>, numbers: &[f64]) -> f64 {
    let largest = f64::from(channels.filter(|channel| channel.is_finite()).fold(0.0, f32::max));
    let fits = numbers.iter().find(|&&white| largest <= 2.0 * white);
    *fits.unwrap_or(&numbers[numbers.len() - 1])
}

/// The vertex colours of a scene.
#[derive(Default)]
pub struct VertexColors {
    /// Each material's variant with the texture.
    pub materials: HashMap<u32, u32>,
    texture: Option<u32>,
    /// Index of the triangle, and the colours of its vertices.
    triangles: Vec<(usize, [Vec3; 3])>,
}

impl VertexColors {
    /// Returns the index of the texture, which [`Self::lay_out`] fills.
    pub fn texture(&mut self, textures: &mut Textures) -> u32 {
        *self.texture.get_or_insert_with(|| {
            textures.list.push(Texture {
                name: NAME.to_string(),
                width: 1,
                height: 1,
                filter: Filter::Bilinear,
                wrap: [Wrap::Repeat; 2],
                texels: Texels::Float32(vec![[1.0, 1.0, 1.0, 0.0]]),
            });
            (textures.list.len() - 1) as u32
        })
    }
    pub fn add(&mut self, triangle: usize, colors: [Vec3; 3]) {
        self.triangles.push((triangle, colors));
    }
    /// Fills the texture, and the texture coordinates of the triangles that use it.
    pub fn lay_out(&self, textures: &mut [Texture], uvs: &mut [[Vec2; 3]]) -> Result<(), SceneError> {
        let (Some(texture), count) = (self.texture, self.triangles.len()) else { return Ok(()) };
        if count == 0 {
            return Ok(());
        }
        let most = (MAX_SIDE / 2) as usize;
        let columns = ((count as f64).sqrt().ceil() as usize).clamp(1, most);
        let rows = count.div_ceil(columns);
        if rows > most {
            let what = format!("{count} triangles have vertex colours");
            return Err(SceneError::new(what).mend(format!("leave colours on at most {}", most * most)));
        }
        let (width, height) = (2 * columns, 2 * rows);
        let mut texels = vec![[0.0; 4]; width * height];
        let size = Vec2::new(width as f32, height as f32);
        for (patch, &(triangle, [a, b, c])) in self.triangles.iter().enumerate() {
            let (x, y) = (2 * (patch % columns), 2 * (patch / columns));
            let mut set = |right: usize, down: usize, color: Vec3| {
                texels[(y + down) * width + x + right] = color.extend(0.0).to_array();
            };
            set(0, 0, a);
            set(1, 0, b);
            set(0, 1, c);
            set(1, 1, b + c - a);
            let at = |right: usize, down: usize| {
                let texel = Vec2::new((x + right) as f32 + 0.5, (y + down) as f32 + 0.5) / size;
                Vec2::new(texel.x, 1.0 - texel.y)
            };
            uvs[triangle] = [at(0, 0), at(1, 0), at(0, 1)];
        }
        let texture = &mut textures[texture as usize];
        (texture.width, texture.height) = (width as u32, height as u32);
        texture.texels = Texels::Float32(texels);
        Ok(())
    }
}

/// Returns the colours of a triangle with these texture coordinates in the texture.
pub fn read_back(texture: &Texture, uvs: [Vec2; 3]) -> [[f32; 3]; 3] {
    uvs.map(|uv| {
        let x = (uv.x * texture.width as f32) as usize;
        let y = ((1.0 - uv.y) * texture.height as f32) as usize;
        texture.texels.linear(y * texture.width as usize + x).map(|channel| channel as f32)
    })
}
