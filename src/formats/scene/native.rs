//! Defines the keys and JSON types of the native scene file, without validation.

use octray_engine::scene::{Filter, LightUnits, Side, Wrap};
use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::collections::HashSet;
use std::fmt;

/// The value of `format` in a scene.
pub const FORMAT: &str = "octray-1";
/// The value of `format` in a view.
pub const VIEW_FORMAT: &str = "octray-view-1";

/// An example of a material, for messages.
pub const MATERIAL: &str = "{ \"type\": \"diffuse\", \"color\": [0.8, 0.1, 0.1] }";

/// Returns an example of a key's value, for messages; `None` if a message of serde explains it better.
pub fn example(key: &str) -> Option<&'static str> {
    Some(match key {
        "camera" => "{ \"position\": [0, 1, 5], \"look_at\": [0, 1, 0] }",
        "origin" | "position" | "center" | "look_at" | "focus_on" | "translate" => "[0, 1, 5]",
        "up" => "[0, 1, 0]",
        "resolution" => "[240, 135]",
        "max_bounces" => "16",
        "sky" => "{ \"color\": [0.7, 0.8, 1] }",
        "color" | "emission" | "bottom" | "top" | "attenuation_color" | "specular_color" => "[0.7, 0.8, 1]",
        "gradient" => "{ \"bottom\": [1, 1, 1], \"top\": [0.5, 0.7, 1] }",
        "materials" => "{ \"red\": { \"type\": \"diffuse\", \"color\": [0.8, 0.1, 0.1] } }",
        "type" => "\"diffuse\"",
        "material" => "\"red\", a name in `materials`",
        "spheres" => "[ { \"center\": [0, 1, 0], \"radius\": 1, \"material\": \"red\" } ]",
        "radius" | "scale" | "texture_size" | "attenuation_distance" => "1",
        "aperture_radius" => "0.05",
        "f_number" => "2.8",
        "focus_distance" | "orthographic_height" => "4",
        "blades" => "6",
        "roughness"
        | "metallic"
        | "transmission"
        | "specular"
        | "clearcoat"
        | "clearcoat_roughness"
        | "opacity"
        | "alpha_cutoff" => "0.5",
        "ior" => "1.5",
        "thin" => "true",
        "vertical_fov" | "turn_degrees" => "40",
        "rotate_degrees" => "[0, 45, 0]",
        "triangles" => "[ { \"vertices\": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], \"material\": \"red\" } ]",
        "portals" => "[ { \"vertices\": [[0, 1, 0], [0, 1, -2], [0, 2, -2], [0, 2, 0]] } ]",
        "vertices" | "normals" | "colors" => "[[0, 0, 1], [1, 0, 1], [0, 1, 1]]",
        "uvs" => "[[0, 0], [1, 0], [0, 1]]",
        "meshes" => "[ { \"model\": \"bunny.obj\", \"scale\": 10 } ]",
        "model" | "obj" => "\"bunny.obj\"",
        "lights" => "[ { \"type\": \"point\", \"position\": [0, 3, 0], \"intensity\": [10, 10, 10] } ]",
        "intensity" => "[10, 10, 10]",
        "irradiance" => "[3, 3, 3]",
        "direction" => "[0.3, -1, 0.2]",
        "range" => "20",
        "inner_degrees" | "outer_degrees" => "30",
        "angular_diameter_degrees" => "0.53",
        "light_units" => "\"radiometric\"",
        "texture" | "roughness_map" | "normal_map" | "emission_map" | "opacity_map" => "\"picture.png\"",
        "filter" => "\"bilinear\"",
        "wrap" => "\"clamp\", \"mirror\" or \"repeat\", or [\"clamp\", \"repeat\"] for u and v",
        "smooth" => "30",
        "picture_from" => "\"inside\"",
        "scene" => "\"scene.json\"",
        "frame" => "1",
        "keyframes" => "[ { \"frame\": 1, \"camera\": { \"position\": [0, 1, 5] } } ]",
        _ => return None,
    })
}

/// An example of the `vertices` of a portal, for messages.
pub const PORTAL: &str = "[[0, 1, 0], [0, 1, -2], [0, 2, -2], [0, 2, 0]]";

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    pub format: String,
    /// The point around which single precision is best. Missing: where the camera stands, or a point of the
    /// scene that it shows.
    pub origin: Option<[f64; 3]>,
    /// Missing: a camera that frames the whole scene.
    pub camera: Option<CameraFile>,
    pub resolution: Option<[u32; 2]>,
    pub max_bounces: Option<u32>,
    /// Missing: black if something in the scene emits, plain white otherwise.
    pub sky: Option<SkyFile>,
    #[serde(default)]
    pub materials: Materials,
    #[serde(default)]
    pub spheres: Vec<SphereFile>,
    #[serde(default)]
    pub triangles: Vec<TriangleFile>,
    #[serde(default)]
    pub meshes: Vec<MeshFile>,
    #[serde(default)]
    pub portals: Vec<PortalFile>,
    #[serde(default)]
    pub lights: Vec<LightFile>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub struct CameraFile {
    /// Missing: far enough from `look_at` to see the whole scene.
    pub position: Option<[f64; 3]>,
    /// Missing: the middle of the scene.
    pub look_at: Option<[f64; 3]>,
    pub up: Option<[f64; 3]>,
    pub vertical_fov: Option<f64>,
    /// Missing, like `f_number`: 0, a pinhole.
    pub aperture_radius: Option<f64>,
    /// The aperture of a lens whose focal length gives a sensor of 24 mm height the field of view, if a scene
    /// unit is a metre.
    pub f_number: Option<f64>,
    /// Missing, like `focus_on`: the distance of `look_at`.
    pub focus_distance: Option<f64>,
    pub focus_on: Option<[f64; 3]>,
    /// Missing: a round aperture.
    pub blades: Option<u32>,
    /// Missing: a perspective camera.
    pub orthographic_height: Option<f64>,
}

/// A keyframe of a view.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KeyframeFile {
    pub frame: u32,
    /// Missing keys are those of the view's camera.
    pub camera: CameraFile,
}

/// A sky: `color`, `gradient`, or `texture`, which `color` multiplies.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SkyFile {
    pub color: Option<[f64; 3]>,
    pub gradient: Option<GradientFile>,
    pub texture: Option<String>,
    pub filter: Option<Filter>,
    pub turn_degrees: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GradientFile {
    pub bottom: [f64; 3],
    pub top: [f64; 3],
}

/// The wraps along u and along v, or one for both.
#[derive(Deserialize, Clone, Copy)]
#[serde(
    untagged,
    expecting = "\"repeat\", \"clamp\" or \"mirror\", or two of them, for u and v, expected \"clamp\""
)]
pub enum WrapsFile {
    Both(Wrap),
    Each([Wrap; 2]),
}

/// A material with the keys of all types. `material` checks which of them belong to `type`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialFile {
    pub r#type: String,
    pub color: Option<[f64; 3]>,
    pub emission: Option<[f64; 3]>,
    pub roughness: Option<f64>,
    pub metallic: Option<f64>,
    pub ior: Option<f64>,
    pub thin: Option<bool>,
    pub transmission: Option<f64>,
    pub attenuation_color: Option<[f64; 3]>,
    pub attenuation_distance: Option<f64>,
    pub specular: Option<f64>,
    pub specular_color: Option<[f64; 3]>,
    pub clearcoat: Option<f64>,
    pub clearcoat_roughness: Option<f64>,
    pub texture: Option<String>,
    pub roughness_map: Option<String>,
    pub normal_map: Option<String>,
    pub emission_map: Option<String>,
    /// The share of rays that are stopped.
    pub opacity: Option<f64>,
    pub opacity_map: Option<String>,
    /// Missing: the opacity is blended.
    pub alpha_cutoff: Option<f64>,
    /// Scene units that one repeat of the texture covers on triangles without `uvs`.
    pub texture_size: Option<f64>,
    pub filter: Option<Filter>,
    pub wrap: Option<WrapsFile>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SphereFile {
    pub center: [f64; 3],
    pub radius: f64,
    pub material: Option<String>,
    pub turn_degrees: Option<f64>,
    /// The side from which the texture is not mirrored. Missing: outside.
    pub picture_from: Option<Side>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TriangleFile {
    pub vertices: [[f64; 3]; 3],
    pub uvs: Option<[[f64; 2]; 3]>,
    /// Missing: the triangle is flat.
    pub normals: Option<[[f64; 3]; 3]>,
    /// Reflectances that multiply the material's colour.
    pub colors: Option<[[f64; 3]; 3]>,
    pub material: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeshFile {
    /// The path of a model of any format.
    pub model: Option<String>,
    /// An older name of `model`, from when OBJ was the only format.
    pub obj: Option<String>,
    /// Missing: the model's own materials.
    pub material: Option<String>,
    pub translate: Option<[f64; 3]>,
    /// About the x axis, then the y axis, then the z axis.
    pub rotate_degrees: Option<[f64; 3]>,
    /// Missing: the model's own normals.
    pub smooth: Option<f64>,
    pub scale: Option<f64>,
    /// Whether the model's lights come along. Missing: they do.
    pub lights: Option<bool>,
    /// Whether the model's camera may be the scene's. Missing: it may, if the scene has none.
    pub camera: Option<bool>,
    /// Missing: decided by the program that wrote the model.
    pub light_units: Option<LightUnits>,
}

/// A light with the keys of all types. `light` checks which of them belong to `type`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LightFile {
    pub r#type: String,
    pub position: Option<[f64; 3]>,
    pub direction: Option<[f64; 3]>,
    /// The point towards which a spot shines, in place of `direction`.
    pub look_at: Option<[f64; 3]>,
    pub intensity: Option<[f64; 3]>,
    pub irradiance: Option<[f64; 3]>,
    /// Missing: without a limit.
    pub range: Option<f64>,
    pub inner_degrees: Option<f64>,
    pub outer_degrees: Option<f64>,
    /// Missing: no disc.
    pub angular_diameter_degrees: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PortalFile {
    /// The corners of a parallelogram, anticlockwise as seen from the room.
    pub vertices: [[f64; 3]; 4],
}

/// Materials and their names, in file order. A name that occurs twice is refused.
#[derive(Default)]
pub struct Materials(pub Vec<(String, MaterialFile)>);

impl<'de> Deserialize<'de> for Materials {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Entries;
        impl<'de> Visitor<'de> for Entries {
            type Value = Materials;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("materials by their names")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Materials, A::Error> {
                let (mut entries, mut seen) = (Vec::new(), HashSet::new());
                while let Some((name, material)) = map.next_entry::<String, MaterialFile>()? {
                    if !seen.insert(name.clone()) {
                        return Err(A::Error::custom(format!("the name `{name}` occurs twice")));
                    }
                    entries.push((name, material));
                }
                Ok(Materials(entries))
            }
        }
        deserializer.deserialize_map(Entries)
    }
}
