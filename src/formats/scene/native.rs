//! The native scene file as the user wrote it: keys and JSON types, without validation.
//!
//! For: [`SceneFile`] and its parts.

use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::collections::HashSet;
use std::fmt;
use std::marker::PhantomData;

/// The value of `format` that this program reads.
pub const FORMAT: &str = "octray-1";
/// The value of `format` in a view.
pub const VIEW_FORMAT: &str = "octray-view-1";

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with `format`")]
pub struct SceneFile {
    pub format: String,
    /// Missing: a camera that frames the whole scene.
    pub camera: Option<CameraFile>,
    pub resolution: Option<[u32; 2]>,
    pub max_bounces: Option<u32>,
    /// Missing: black if something in the scene emits, plain white otherwise.
    pub sky: Option<SkyFile>,
    #[serde(default)]
    pub materials: Named<MaterialFile>,
    #[serde(default)]
    pub spheres: Vec<SphereFile>,
    #[serde(default)]
    pub triangles: Vec<TriangleFile>,
    #[serde(default)]
    pub meshes: Vec<MeshFile>,
}

#[derive(Deserialize, Default)]
#[serde(
    deny_unknown_fields,
    expecting = "an object such as { \"position\": [0, 1, 5], \"look_at\": [0, 1, 0] }"
)]
pub struct CameraFile {
    /// Missing: far enough from `look_at` to see the whole scene.
    pub position: Option<[f64; 3]>,
    /// Missing: the middle of the scene.
    pub look_at: Option<[f64; 3]>,
    pub up: Option<[f64; 3]>,
    pub vertical_fov: Option<f64>,
}

/// Of a view.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with `frame` and `camera`")]
pub struct KeyframeFile {
    pub frame: u32,
    /// What it leaves out is as in the view.
    pub camera: CameraFile,
}

/// `color`, or `gradient`, or `texture` (which `color` then multiplies).
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with `color`, `gradient` or `texture`")]
pub struct SkyFile {
    pub color: Option<[f64; 3]>,
    pub gradient: Option<GradientFile>,
    pub texture: Option<String>,
    pub filter: Option<FilterFile>,
    pub turn_degrees: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with `bottom` and `top`")]
pub struct GradientFile {
    pub bottom: [f64; 3],
    pub top: [f64; 3],
}

#[derive(Deserialize, Clone, Copy)]
#[serde(rename_all = "lowercase")]
pub enum FilterFile {
    Nearest,
    Bilinear,
    Trilinear,
}

/// The keys of all types; `material` checks which belong to `type`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with a `type`")]
pub struct MaterialFile {
    pub r#type: String,
    pub color: Option<[f64; 3]>,
    pub emission: Option<[f64; 3]>,
    pub roughness: Option<f64>,
    pub metallic: Option<f64>,
    pub ior: Option<f64>,
    pub texture: Option<String>,
    pub roughness_map: Option<String>,
    pub normal_map: Option<String>,
    pub emission_map: Option<String>,
    /// Scene units that one repeat of the texture covers on triangles without `uvs`.
    pub texture_size: Option<f64>,
    pub filter: Option<FilterFile>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with `center` and `radius`")]
pub struct SphereFile {
    pub center: [f64; 3],
    pub radius: f64,
    pub material: Option<String>,
    pub turn_degrees: Option<f64>,
    /// Missing: outside.
    pub picture_from: Option<SideFile>,
}

#[derive(Deserialize, Clone, Copy)]
#[serde(rename_all = "lowercase")]
pub enum SideFile {
    Outside,
    Inside,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with `vertices`")]
pub struct TriangleFile {
    pub vertices: [[f64; 3]; 3],
    pub uvs: Option<[[f64; 2]; 3]>,
    /// Missing: flat.
    pub normals: Option<[[f64; 3]; 3]>,
    /// Reflectances that multiply the material's colour.
    pub colors: Option<[[f64; 3]; 3]>,
    pub material: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with `model`")]
pub struct MeshFile {
    /// The path of a model of any format.
    pub model: Option<String>,
    /// The same; the name from when OBJ was the only format.
    pub obj: Option<String>,
    /// Missing: the model's own materials.
    pub material: Option<String>,
    pub translate: Option<[f64; 3]>,
    /// About the x axis, then the y axis, then the z axis.
    pub rotate_degrees: Option<[f64; 3]>,
    pub scale: Option<f64>,
}

/// An object whose keys are user-chosen names: kept in file order, duplicates refused.
pub struct Named<T>(pub Vec<(String, T)>);

impl<T> Default for Named<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Named<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Entries<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for Entries<T> {
            type Value = Named<T>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object of names")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut entries: Vec<(String, T)> = Vec::new();
                let mut seen = HashSet::new();
                while let Some((name, value)) = map.next_entry::<String, T>()? {
                    if !seen.insert(name.clone()) {
                        return Err(A::Error::custom(format!("the name `{name}` occurs twice")));
                    }
                    entries.push((name, value));
                }
                Ok(Named(entries))
            }
        }
        deserializer.deserialize_map(Entries(PhantomData))
    }
}
