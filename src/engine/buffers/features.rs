//! What a scene needs: the features that its pipeline must have.

use super::rows::Rows;
use crate::scene::{Filter, Material, MaterialKind, Scene, Sky, Texels};
use glam::Vec3;

/// A set of features. A pipeline is compiled for a set and leaves out what is not in it; any set that contains a scene's needs
/// gives the same bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Features(pub u32);

macro_rules! features {
    ($($(#[$doc:meta])* $name:ident = $bit:literal, $text:literal;)*) => {
        impl Features {
            $($(#[$doc])* pub const $name: Features = Features(1 << $bit);)*
            /// Every feature there is.
            pub const ALL: Features = Features(0 $(| 1 << $bit)*);
            const NAMES: &'static [(Features, &'static str)] = &[$((Features::$name, $text)),*];
        }
    };
}

features! {
    SPHERES = 0, "spheres";
    TRIANGLES = 1, "triangles";
    DIFFUSE = 2, "diffuse";
    MIRROR = 3, "mirror";
    GGX = 4, "ggx";
    GLASS = 5, "glass";
    SCATTER = 6, "scatter";
    /// Some surface shines.
    EMISSION = 7, "emission";
    /// Some surface has a picture.
    TEXTURES = 8, "textures";
    /// Some texture is read between texel centres.
    BILINEAR = 9, "bilinear";
    /// Some texture holds linear light, not display values.
    LINEAR_TEXTURES = 15, "linear-textures";
    SKY_GRADIENT = 10, "sky-gradient";
    SKY_TEXTURE = 11, "sky-texture";
    /// More spheres than a register table holds.
    MANY_SPHERES = 12, "many-spheres";
    /// More triangles than a register table holds.
    MANY_TRIANGLES = 13, "many-triangles";
    /// More materials than a register table holds.
    MANY_MATERIALS = 14, "many-materials";
    /// Testing every primitive costs more than [`Features::MOST_LINEAR_COST`]. Every pipeline can go through a hierarchy, because
    /// any scene may be asked to; a scene that needs one gets it unasked.
    HIERARCHY = 16, "hierarchy";
    /// Paths look for emitters.
    LIGHTS = 17, "lights";
    /// More emitters than a register table holds.
    MANY_LIGHTS = 31, "many-lights";
    PLASTIC = 18, "plastic";
    /// Some triangle has vertex normals.
    SMOOTH_NORMALS = 19, "smooth-normals";
    NORMAL_MAPS = 20, "normal-maps";
    ROUGHNESS_MAPS = 21, "roughness-maps";
}

impl Features {
    pub const NONE: Features = Features(0);
    /// What makes normals for shading differ from those of the surface.
    pub const SHADING_NORMALS: Features = Self::SMOOTH_NORMALS.with(Self::NORMAL_MAPS);
    /// What reads the second table of materials.
    pub const DETAILS: Features = Self::PLASTIC.with(Self::NORMAL_MAPS).with(Self::ROUGHNESS_MAPS);
    /// Up to here primitives are tested one by one, beyond it through a hierarchy: about where that becomes faster. Measured in frames,
    /// either way takes as long for terrains of about 25 triangles (a cost of 100), a box of 34 (136), 170 balls (170), knots of 75 (300).
    pub const MOST_LINEAR_COST: usize = 150;

    /// What testing every primitive costs a ray, in tests of a sphere.
    pub fn linear_cost(scene: &Scene) -> usize {
        scene.spheres.len() + Self::TRIANGLE_COST * scene.triangles.len()
    }
    /// What testing a triangle costs, in tests of a sphere.
    pub const TRIANGLE_COST: usize = 4;

    pub const fn with(self, other: Features) -> Features {
        Features(self.0 | other.0)
    }
    /// Does this set hold every feature of `other`?
    pub const fn contains(self, other: Features) -> bool {
        self.0 & other.0 == other.0
    }
    /// Does this set hold some feature of `other`?
    pub const fn meets(self, other: Features) -> bool {
        self.0 & other.0 != 0
    }
    /// The names of the features, for people and reports.
    pub fn names(self) -> Vec<&'static str> {
        Self::NAMES.iter().filter(|(need, _)| self.contains(*need)).map(|(_, name)| *name).collect()
    }

    /// What a scene needs: of its materials, only those that some primitive has_lobe.
    pub fn of(scene: &Scene) -> Features {
        let mut needs = Features::NONE;
        let mut need = |condition: bool, feature: Features| {
            if condition {
                needs = needs.with(feature);
            }
        };
        need(!scene.spheres.is_empty(), Self::SPHERES);
        need(!scene.triangles.is_empty(), Self::TRIANGLES);
        need(scene.spheres.len() > Rows::FEW, Self::MANY_SPHERES);
        // Two rows a triangle.
        need(2 * scene.triangles.len() > Rows::FEW, Self::MANY_TRIANGLES);
        need(scene.materials.len() > Rows::FEW, Self::MANY_MATERIALS);
        need(Self::linear_cost(scene) > Self::MOST_LINEAR_COST, Self::HIERARCHY);
        need(matches!(scene.sky, Sky::Gradient { .. }), Self::SKY_GRADIENT);
        need(matches!(scene.sky, Sky::Texture { .. }), Self::SKY_TEXTURE);
        let mut texture = |texture: u32| {
            let texture = &scene.textures[texture as usize];
            need(texture.filter == Filter::Bilinear, Self::BILINEAR);
            need(matches!(texture.texels, Texels::Linear(_)), Self::LINEAR_TEXTURES);
        };
        if let Sky::Texture { texture: sky, .. } = scene.sky {
            texture(sky);
        }
        worn_materials(scene).flat_map(Material::pictures).for_each(texture);
        need(scene.normals.iter().any(|normals| normals[0] != Vec3::ZERO), Self::SMOOTH_NORMALS);
        for material in worn_materials(scene) {
            need(material.emission.max_element() > 0.0, Self::EMISSION);
            need(material.texture.is_some(), Self::TEXTURES);
            need(material.normal_map.is_some(), Self::NORMAL_MAPS);
            need(material.roughness_map.is_some() && material.kind.has_roughness(), Self::ROUGHNESS_MAPS);
            match material.kind {
                MaterialKind::Diffuse => need(true, Self::DIFFUSE),
                MaterialKind::Metal { roughness: 0.0 } => need(true, Self::MIRROR),
                MaterialKind::Metal { .. } => need(true, Self::GGX),
                MaterialKind::Glass { .. } => need(true, Self::GLASS),
                MaterialKind::Scatter { .. } => need(true, Self::SCATTER),
                MaterialKind::Plastic { .. } => need(true, Self::PLASTIC),
                MaterialKind::Emitter => {}
            }
        }
        needs
    }
}

/// The materials that some primitive has_lobe.
fn worn_materials(scene: &Scene) -> impl Iterator<Item = &Material> {
    let mut material = vec![false; scene.materials.len()];
    scene.spheres.iter().for_each(|sphere| material[sphere.material as usize] = true);
    scene.triangles.iter().for_each(|triangle| material[triangle.material as usize] = true);
    scene.materials.iter().zip(material).filter(|(_, material)| *material).map(|(material, _)| material)
}
