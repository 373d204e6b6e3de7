//! The sets of features that scenes need of their pipelines.

use super::rows::Rows;
use crate::rays::Kind;
use crate::scene::{Filter, Material, MaterialKind, Scene, Sky, Texels, Wrap};
use glam::Vec3;

/// A set of features. A pipeline is compiled for a set and leaves out the code of all others; any set that
/// contains the features of the scene gives the same bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Features(pub u64);

macro_rules! features {
    ($($(#[$doc:meta])* $name:ident = $bit:literal, $text:literal;)*) => {
        impl Features {
            $(#[doc = concat!("Feature: ", $text, ".")] $(#[$doc])* pub const $name: Features = Features(1 << $bit);)*
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
    FUZZY_MIRROR = 6, "fuzzy-mirror";
    /// Some surface emits.
    EMISSION = 7, "emission";
    /// Some surface has a texture.
    TEXTURES = 8, "textures";
    /// Some texture is filtered bilinearly.
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
    /// A hierarchy is faster than testing every primitive: [`crate::render::features_of`] decides. Every
    /// pipeline can trace through a hierarchy, because the traversal may be chosen for any scene.
    HIERARCHY = 16, "hierarchy";
    /// Next event estimation: shadow rays to lights.
    LIGHTS = 17, "lights";
    /// More lights than a register table holds.
    MANY_LIGHTS = 31, "many-lights";
    PLASTIC = 18, "plastic";
    /// Some triangle has vertex normals.
    SMOOTH_NORMALS = 19, "smooth-normals";
    NORMAL_MAPS = 20, "normal-maps";
    ROUGHNESS_MAPS = 21, "roughness-maps";
    METAL_ROUGH = 22, "metal-rough";
    EMISSION_MAPS = 23, "emission-maps";
    /// Some texture is filtered trilinearly: paths carry ray cones.
    LEVELS_OF_DETAIL = 24, "levels-of-detail";
    /// Some surface lets rays through, where it is cut out or partly transparent.
    OPACITY = 27, "opacity";
    ROUGH_GLASS = 28, "rough-glass";
    /// Some metal-rough surface has a clear coat or another reflectance: see
    /// [`crate::scene::MaterialExtras`].
    LAYERS = 29, "layers";
    /// Some glass absorbs light, or some metal-rough surface is partly glass.
    TRANSMISSION = 30, "transmission";
    /// Some texture of a surface is clamped or mirrored beyond its edges.
    WRAPS = 32, "wraps";
    /// The sky is sampled through quads.
    PORTALS = 25, "portals";
    /// Point, spot and directional lights.
    PUNCTUAL_LIGHTS = 26, "punctual-lights";
    /// Camera rays have origins of their own: [`crate::camera::PreparedCamera::needs`]. A test of the camera
    /// before each packet costs 2 %.
    RAY_ORIGINS = 33, "ray-origins";
}

impl Features {
    /// No feature.
    pub const NONE: Features = Features(0);
    /// The features that make shading normals differ from geometric normals.
    pub const SHADING_NORMALS: Features = Self::SMOOTH_NORMALS.with(Self::NORMAL_MAPS);
    /// The features that read [`super::Buffers::material_extra`].
    pub const DETAILS: Features = Self::PLASTIC
        .with(Self::METAL_ROUGH)
        .with(Self::NORMAL_MAPS)
        .with(Self::ROUGHNESS_MAPS)
        .with(Self::EMISSION_MAPS)
        .with(Self::ROUGH_GLASS);

    /// The features that read [`super::Buffers::material_extensions`].
    pub const EXTENSIONS: Features = Self::LAYERS.with(Self::TRANSMISSION);

    /// The features of textures whose lookups are calls: one that may follow every lookup costs 6 % in
    /// textured scenes.
    pub const LONG_LOOKUPS: Features = Self::LEVELS_OF_DETAIL.with(Self::WRAPS);

    /// The features of all kinds of primitives.
    const KINDS: Features = {
        let (mut all, mut kind) = (Self::NONE, 0);
        while kind < Kind::ALL.len() {
            all = all.with(Self::of_kind(Kind::ALL[kind]));
            kind += 1;
        }
        all
    };

    /// Returns the feature of scenes with this kind of primitive.
    pub const fn of_kind(kind: Kind) -> Features {
        match kind {
            Kind::Sphere => Self::SPHERES,
            Kind::Triangle => Self::TRIANGLES,
        }
    }
    /// Tests whether this set holds a kind of primitive and no other kind.
    pub const fn has_only_kind(self, kind: Kind) -> bool {
        self.0 & Self::KINDS.0 == Self::of_kind(kind).0
    }
    /// Returns the features of both sets.
    pub const fn with(self, other: Features) -> Features {
        Features(self.0 | other.0)
    }
    /// Returns the features of this set that are not in the other.
    pub const fn without(self, other: Features) -> Features {
        Features(self.0 & !other.0)
    }
    /// Tests whether this set holds every feature of `other`.
    pub const fn contains(self, other: Features) -> bool {
        self.0 & other.0 == other.0
    }
    /// Tests whether this set holds some feature of `other`.
    pub const fn meets(self, other: Features) -> bool {
        self.0 & other.0 != 0
    }
    /// Returns the names of the features, for people and reports.
    pub fn names(self) -> Vec<&'static str> {
        Self::NAMES.iter().filter(|(need, _)| self.contains(*need)).map(|(_, name)| *name).collect()
    }

    /// Returns the features that shading a scene needs; materials that no primitive has do not count.
    /// Traversal and lights add their own: [`Features::HIERARCHY`], [`crate::lights::Lights::needs`].
    pub fn of(scene: &Scene) -> Features {
        let mut needs = Features::NONE;
        let mut need = |condition: bool, feature: Features| {
            if condition {
                needs = needs.with(feature);
            }
        };
        for (kind, count) in Kind::ALL.into_iter().zip(scene.counts().0) {
            need(count > 0, Self::of_kind(kind));
        }
        need(scene.spheres.len() > Rows::FEW, Self::MANY_SPHERES);
        // A triangle has two rows.
        need(2 * scene.triangles.len() > Rows::FEW, Self::MANY_TRIANGLES);
        need(scene.materials.len() > Rows::FEW, Self::MANY_MATERIALS);
        need(matches!(scene.sky, Sky::Gradient { .. }), Self::SKY_GRADIENT);
        need(!scene.portals.is_empty(), Self::PORTALS);
        need(matches!(scene.sky, Sky::Texture { .. }), Self::SKY_TEXTURE);
        need(!scene.lights.is_empty(), Self::PUNCTUAL_LIGHTS);
        let mut texture = |texture: u32| {
            let texture = &scene.textures[texture as usize];
            need(texture.filter != Filter::Nearest, Self::BILINEAR);
            need(texture.filter == Filter::Trilinear, Self::LEVELS_OF_DETAIL);
            need(texture.wrap != [Wrap::Repeat; 2], Self::WRAPS);
            need(matches!(texture.texels, Texels::Float32(_)), Self::LINEAR_TEXTURES);
        };
        if let Sky::Texture { texture: sky, .. } = scene.sky {
            texture(sky);
        }
        used_materials(scene).flat_map(Material::textures).for_each(texture);
        need(scene.normals.iter().any(|normals| normals[0] != Vec3::ZERO), Self::SMOOTH_NORMALS);
        for material in used_materials(scene) {
            need(material.emission.max_element() > 0.0, Self::EMISSION);
            need(material.texture.is_some(), Self::TEXTURES);
            need(material.normal_map.is_some(), Self::NORMAL_MAPS);
            need(material.roughness_map.is_some() && material.kind.has_roughness(), Self::ROUGHNESS_MAPS);
            need(material.emission_map.is_some(), Self::EMISSION_MAPS);
            let extras = &material.extras;
            need(extras.attenuation.is_some() || extras.transmission > 0.0, Self::TRANSMISSION);
            need(extras.transmission > 0.0, Self::ROUGH_GLASS);
            need(extras.reflects_otherwise(), Self::LAYERS);
            need(!material.is_opaque(), Self::OPACITY);
            match material.kind {
                MaterialKind::Diffuse => need(true, Self::DIFFUSE),
                MaterialKind::Metal { roughness: 0.0 } => need(true, Self::MIRROR),
                MaterialKind::Metal { .. } => need(true, Self::GGX),
                MaterialKind::Glass { .. } | MaterialKind::ThinGlass { .. } => need(true, Self::GLASS),
                MaterialKind::RoughGlass { .. } => need(true, Self::ROUGH_GLASS),
                MaterialKind::FuzzyMirror { .. } => need(true, Self::FUZZY_MIRROR),
                MaterialKind::Plastic { .. } => need(true, Self::PLASTIC),
                MaterialKind::MetalRough { .. } => need(true, Self::METAL_ROUGH),
                MaterialKind::Emitter => {}
            }
        }
        needs
    }
}

/// Tests whether the feature set `n` holds this feature. The compiler sees a constant.
#[inline(always)]
pub const fn has(n: u64, feature: Features) -> bool {
    Features(n).contains(feature)
}

/// Iterates over the materials that some primitive has.
fn used_materials(scene: &Scene) -> impl Iterator<Item = &Material> {
    let mut is_used = vec![false; scene.materials.len()];
    scene.all_primitives().for_each(|primitive| is_used[primitive.material() as usize] = true);
    scene.materials.iter().zip(is_used).filter(|(_, is_used)| *is_used).map(|(material, _)| material)
}
