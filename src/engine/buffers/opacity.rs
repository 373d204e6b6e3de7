//! The opacities of materials, and the primitives that rays may pass.

use super::rows::Rows;
use crate::scene::{Material, Scene};

/// The opacities of a scene's materials; empty if all are opaque.
pub struct Opacities {
    /// One row of eight per material: opacity, least opaque value (0: none, the opacity is blended), map
    /// (bits: index + 1, 0 for none), 0.
    rows: Rows,
    /// One bit per primitive: whether its material is not opaque.
    primitives: Vec<u64>,
}

/// The opacity of a material.
#[derive(Clone, Copy, Debug)]
pub struct Opacity {
    /// The factor of the map, or the opacity without one.
    pub factor: f32,
    /// The index of the map, plus 1; 0 for none.
    pub map: u32,
    /// The least opaque value; 0 blends.
    cutoff: f32,
}

impl Opacities {
    pub(super) fn new(scene: &Scene) -> Self {
        let may_pass = |material: u32| !scene.materials[material as usize].is_opaque();
        let mut primitives = Vec::new();
        for (number, primitive) in scene.all_primitives().enumerate() {
            if may_pass(primitive.material()) {
                primitives.resize(scene.primitives().div_ceil(64), 0);
                primitives[number / 64] |= 1 << (number % 64);
            }
        }
        let materials = scene.materials.iter().filter(|_| !primitives.is_empty());
        Self { rows: Rows::new(materials.map(row)), primitives }
    }

    /// Tests whether rays may pass a primitive. The number of a miss is beyond all primitives.
    #[inline(always)]
    pub fn may_pass(&self, primitive: u32) -> bool {
        let word = self.primitives.get(primitive as usize / 64);
        word.is_some_and(|word| word >> (primitive % 64) & 1 == 1)
    }

    /// Returns the opacity of a material of primitives that rays may pass.
    #[inline(always)]
    pub fn of_material(&self, material: u32) -> Opacity {
        let [factor, cutoff, map, ..] = self.rows.fetch::<f32>(material, false);
        Opacity { factor, map: map.to_bits(), cutoff }
    }
}

impl Opacity {
    /// Returns the share of rays that are stopped where the map has this value.
    #[inline(always)]
    pub fn at(&self, texel: f32) -> f32 {
        let alpha = self.factor * texel.min(1.0);
        match self.cutoff > 0.0 {
            true => f32::from(u8::from(alpha >= self.cutoff)),
            false => alpha,
        }
    }
}

/// Returns a row of [`Opacities::rows`].
fn row(material: &Material) -> [f32; 8] {
    let cutoff = material.alpha_cutoff.filter(|_| material.opacity_map.is_some()).unwrap_or(0.0);
    let map = material.opacity_map.map_or(0, |index| index + 1);
    [material.opacity, cutoff, f32::from_bits(map), 0.0, 0.0, 0.0, 0.0, 0.0]
}
