//! Defines the objects of a glTF file, with the keys that are read, as in the standard's schema.
//!
//! Parts that are not read may have any content: keys that are not here, and entries of lists that are not
//! used.

use serde::de::{DeserializeOwned, Error, IgnoredAny};
use serde::{Deserialize, Deserializer};
use serde_json::value::RawValue;
use serde_json::{Number, Value};
use std::collections::HashMap;

/// A value; `None` if it is missing or does not follow the schema, which is no fault until it is used.
#[derive(Clone)]
pub struct Lenient<T>(pub Option<T>);

impl<T> Default for Lenient<T> {
    fn default() -> Self {
        Self(None)
    }
}

impl<'de, T: DeserializeOwned> Deserialize<'de> for Lenient<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let value = <&RawValue>::deserialize(deserializer)?;
        Ok(Self(serde_json::from_str(value.get()).ok()))
    }
}

/// A list whose faulty entries are faults only if they are used.
pub type List<T> = Lenient<Vec<Lenient<T>>>;

impl<T> List<T> {
    /// Returns the number of entries.
    pub fn len(&self) -> usize {
        self.0.as_ref().map_or(0, Vec::len)
    }
    /// Returns the entry of this index, if it follows the schema.
    pub fn get(&self, index: usize) -> Option<&T> {
        self.0.as_ref()?.get(index)?.0.as_ref()
    }
    /// Returns all entries that follow the schema, with their indices.
    pub fn iter(&self) -> impl Iterator<Item = (usize, &T)> {
        (0..self.len()).filter_map(|index| Some((index, self.get(index)?)))
    }
}

/// A whole number: an index, a size or a code. It may be written as `24.0`.
#[derive(Clone, Copy, Default, PartialEq)]
pub struct Whole(pub usize);

impl<'de> Deserialize<'de> for Whole {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let number = Number::deserialize(deserializer)?;
        let real = number.as_f64().filter(|real| *real >= 0.0 && real.fract() == 0.0);
        let whole = number.as_u64().or(real.map(|real| real as u64));
        let whole = whole.map(|whole| Self(usize::try_from(whole).unwrap_or(usize::MAX)));
        whole.ok_or_else(|| D::Error::custom(format!("invalid value: {number}, expected a JSON number")))
    }
}

/// Defines objects with these keys, which have camel case in the file.
macro_rules! objects {
    ($($(#[$meta:meta])* $name:ident { $($(#[$key_meta:meta])* $key:ident: $type:ty),* $(,)? })*) => { $(
        #[derive(Clone, Deserialize)]
        #[serde(rename_all = "camelCase", expecting = "an object")]
        $(#[$meta])*
        pub struct $name { $($(#[$key_meta])* pub $key: $type),* }
    )* };
}

/// Defines objects of which every key is optional.
macro_rules! optional {
    ($($name:ident $keys:tt)*) => { objects! { $(#[derive(Default)] #[serde(default)] $name $keys)* } };
}

optional! {
    Root {
        asset: Asset, extensions_required: Vec<String>, scene: Option<Whole>, scenes: List<Scene>,
        nodes: List<Node>, cameras: List<Camera>, meshes: List<Mesh>, accessors: List<Accessor>,
        buffer_views: List<View>, buffers: List<Buffer>, materials: List<Material>, textures: List<Texture>,
        images: List<Image>, samplers: List<Sampler>, animations: List<IgnoredAny>,
        extensions: RootExtensions,
    }
    Asset { version: Option<String>, min_version: Option<String>, generator: Lenient<String> }
    Scene { nodes: Option<Vec<Whole>> }
    Node {
        children: Option<Vec<Whole>>, mesh: Option<Whole>, camera: Option<Whole>, skin: Option<IgnoredAny>,
        matrix: Option<[f64; 16]>, extensions: NodeExtensions,
        rotation: Option<[f64; 4]>, scale: Option<[f64; 3]>, translation: Option<[f64; 3]>,
        extras: Lenient<Extras>,
    }
    Extras { portal: Value }
    NodeExtensions { #[serde(rename = "KHR_lights_punctual")] light: Option<Lenient<NodeLight>> }
    RootExtensions { #[serde(rename = "KHR_lights_punctual")] lights: Lenient<Lights> }
    Lights { lights: List<Light> }
    // Angles are in radians, from the light's axis.
    Spot { inner_cone_angle: Option<f64>, outer_cone_angle: Option<f64> }
    Camera { perspective: Option<Perspective>, orthographic: Option<Orthographic> }
    Image { uri: Option<String>, buffer_view: Option<Whole> }
    Texture { source: Option<Whole>, sampler: Option<Whole>, extensions: ImageExtensions }
    ImageExtensions { #[serde(rename = "EXT_texture_webp")] webp: OtherImage }
    OtherImage { source: Option<Whole> }
    Sampler { mag_filter: Option<Whole>, wrap_s: Option<Whole>, wrap_t: Option<Whole> }
    Material {
        name: Lenient<String>, alpha_mode: Option<String>, alpha_cutoff: Option<f64>,
        pbr_metallic_roughness: MetallicRoughness, emissive_factor: Option<[f64; 3]>,
        normal_texture: Option<TextureInfo>, occlusion_texture: Option<IgnoredAny>,
        emissive_texture: Option<TextureInfo>, extensions: MaterialExtensions,
    }
    MetallicRoughness {
        base_color_factor: Option<[f64; 4]>, base_color_texture: Option<TextureInfo>,
        metallic_factor: Option<f64>, roughness_factor: Option<f64>,
        metallic_roughness_texture: Option<TextureInfo>,
    }
    MaterialExtensions {
        #[serde(rename = "KHR_materials_clearcoat")] clearcoat: Extension,
        #[serde(rename = "KHR_materials_ior")] ior: Extension,
        #[serde(rename = "KHR_materials_specular")] specular: Extension,
        #[serde(rename = "KHR_materials_emissive_strength")] emissive_strength: Extension,
        #[serde(rename = "KHR_materials_transmission")] transmission: Extension,
        #[serde(rename = "KHR_materials_unlit")] unlit: Option<IgnoredAny>,
        #[serde(rename = "KHR_materials_volume")] volume: Extension,
    }
    // The keys of all extensions of materials.
    Extension {
        ior: Option<f64>, emissive_strength: Option<f64>, transmission_factor: f64,
        transmission_texture: Option<TextureInfo>, thickness_factor: f64,
        thickness_texture: Option<TextureInfo>, attenuation_distance: Option<f64>,
        attenuation_color: Option<[f64; 3]>, specular_factor: Option<f64>,
        specular_color_factor: Option<[f64; 3]>, specular_texture: Option<IgnoredAny>,
        specular_color_texture: Option<IgnoredAny>, clearcoat_factor: f64,
        clearcoat_roughness_factor: f64, clearcoat_texture: Option<IgnoredAny>,
        clearcoat_roughness_texture: Option<IgnoredAny>, clearcoat_normal_texture: Option<IgnoredAny>,
    }
    TextureExtensions { #[serde(rename = "KHR_texture_transform")] transform: TextureTransform }
}

objects! {
    #[derive(Copy, Default, PartialEq)] #[serde(default)]
    TextureTransform {
        offset: [f64; 2],
        // In radians.
        rotation: f64,
        scale: Option<[f64; 2]>, tex_coord: Option<Whole>,
    }
    NodeLight { light: Whole }
    Light {
        #[serde(rename = "type")] kind: String, color: Option<[f64; 3]>, intensity: Option<f64>, range: Option<f64>,
        #[serde(default)] spot: Spot,
    }
    Perspective { yfov: f64, aspect_ratio: Option<f64> }
    // Half the width and half the height of the picture.
    Orthographic { xmag: f64, ymag: f64 }
    Mesh { primitives: Vec<Primitive> }
    Primitive {
        #[serde(default)] attributes: HashMap<String, Lenient<Whole>>,
        indices: Option<Whole>, material: Option<Whole>, mode: Option<Whole>,
        #[serde(default)] targets: Lenient<Vec<IgnoredAny>>,
    }
    Accessor {
        buffer_view: Option<Whole>, #[serde(default)] byte_offset: Whole, component_type: Whole, count: Whole,
        #[serde(rename = "type")] kind: String, #[serde(default)] normalized: bool, sparse: Option<Sparse>,
    }
    Sparse { count: Whole, indices: SparsePart, values: SparsePart }
    SparsePart {
        buffer_view: Whole, #[serde(default)] byte_offset: Whole,
        // Only indices have it.
        #[serde(default)] component_type: Whole,
    }
    View {
        buffer: Whole, #[serde(default)] byte_offset: Whole, byte_length: Whole, byte_stride: Option<Whole>,
    }
    Buffer { uri: Option<String>, byte_length: Whole }
    // Normal textures have a scale.
    TextureInfo {
        index: Whole, #[serde(default)] tex_coord: Whole, scale: Option<f64>,
        #[serde(default)] extensions: TextureExtensions,
    }
}

impl Extras {
    /// Tests whether the node is a portal: `true` or, as some programs write it, 1.
    pub fn is_portal(&self) -> bool {
        !matches!(&self.portal, Value::Null | Value::Bool(false)) && self.portal.as_f64() != Some(0.0)
    }
}

impl Texture {
    /// Returns the index of its image: the WebP one, or else the one for readers without WebP.
    pub fn image(&self) -> Option<usize> {
        self.extensions.webp.source.or(self.source).map(|index| index.0)
    }
}
