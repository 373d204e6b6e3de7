//! The report of `octray inspect`: what a scene contains and how it is rendered, as text or as JSON.

use super::camera::{CameraReport, vector};
use super::methods::{DefaultReport, HierarchyReport, TraversalReport};
use super::punctual;
use super::settings::{as_options, json};
use super::text::item;
use crate::buffers::Features;
use crate::lights::{EnvironmentLight, LightChoice, Lights};
use crate::openings;
use crate::rays::Structure;
use crate::render::{TraversalChoice, features_of};
use crate::scene::{
    Filter, Loaded, Material, MaterialKind, Primitive, Rendering, Scene, Sky, Texture, Wrap, point_in_file,
};
use crate::wording::{counted, grouped};
use glam::Vec3;
use indicatif::DecimalBytes;
use serde::{Serialize, Serializer};

#[derive(Debug, Serialize)]
pub struct Inspection {
    schema: &'static str,
    scene: String,
    /// Short name: `builtin:three`, or the name of the file.
    name: String,
    view: Option<ViewReport>,
    /// Width and height in pixels, without an option.
    resolution: [u32; 2],
    max_bounces: u32,
    spheres: usize,
    triangles: usize,
    /// Triangles with vertex normals.
    smooth_triangles: usize,
    /// How many there are of each type, used or not; then emissive, textured and transparent ones of any
    /// type.
    #[serde(serialize_with = "as_map")]
    materials: Vec<(&'static str, usize)>,
    textures: Vec<TextureReport>,
    sky: SkyReport,
    /// The point of the file relative to which coordinates are rounded, and a length of 1 in single
    /// precision.
    origin: [f64; 3],
    unit: f64,
    camera: CameraReport,
    /// The box around everything; `None` for a scene of sky alone.
    bounds: Option<Bounds>,
    /// Features that the scene's pipeline must have.
    needs: Vec<&'static str>,
    lights: LightReport,
    /// Points, spots and directional lights.
    punctual_lights: Vec<String>,
    /// Bytes of the scene's lists and texels, without buffers and hierarchy.
    memory_bytes: usize,
    /// The default one, and why.
    traversal: TraversalReport,
    /// The default methods that matter to this scene.
    defaults: Vec<DefaultReport>,
    hierarchy: Option<HierarchyReport>,
    warnings: Vec<String>,
}

/// A texture, its size in texels.
#[derive(Debug, Serialize)]
struct TextureReport {
    name: String,
    width: u32,
    height: u32,
    filter: &'static str,
    /// Along u and along v.
    wrap: [&'static str; 2],
    memory_bytes: usize,
}

#[derive(Debug, Serialize)]
#[serde(tag = "type", rename_all = "lowercase")]
enum SkyReport {
    Color { color: [f32; 3] },
    Gradient { bottom: [f32; 3], top: [f32; 3] },
    Texture { texture: String, color: [f32; 3], turn_degrees: f32 },
}

/// The emitters that next event estimation samples; paths hit the others by scattering alone.
#[derive(Debug, Serialize)]
struct LightReport {
    /// Emissive spheres and triangles.
    emitters: usize,
    /// Emissive spheres and triangles that are sampled.
    sampled: usize,
    /// Whether the environment map is sampled.
    sky: bool,
    /// The mean square of the environment map over the square of its mean, over all directions.
    sky_contrast: Option<f64>,
    /// Portals through which the sky is sampled.
    portals: usize,
}

/// Points in the coordinates of the file.
#[derive(Debug, Serialize)]
struct Bounds {
    lower: [f64; 3],
    upper: [f64; 3],
}

/// The content of a view, except its camera.
#[derive(Debug, Serialize)]
struct ViewReport {
    /// The scene, as the view names it.
    of: String,
    /// Options of `octray render`.
    render: Rendering,
}

impl Inspection {
    pub fn of(spec: String, scene: &Loaded) -> Self {
        let traversal = TraversalReport::of(scene);
        let has_hierarchy = traversal.primary != TraversalChoice::Linear.name();
        let lights = Lights::new(scene, LightChoice::default());
        let in_file = |point| point_in_file(point, &scene.coordinates).into();
        let is_smooth = |normals: &&[Vec3; 3]| normals.iter().any(|normal| *normal != Vec3::ZERO);
        Self {
            schema: "octray-inspect-1",
            scene: spec,
            name: scene.name.clone(),
            view: scene.view.as_ref().map(|view| ViewReport { of: view.scene.clone(), render: view.render }),
            resolution: scene.resolution,
            max_bounces: scene.max_bounces,
            spheres: scene.spheres.len(),
            triangles: scene.triangles.len(),
            smooth_triangles: scene.normals.iter().filter(is_smooth).count(),
            materials: materials(&scene.materials),
            textures: scene.textures.iter().map(TextureReport::of).collect(),
            sky: SkyReport::of(scene),
            origin: scene.coordinates.origin.into(),
            unit: scene.coordinates.unit,
            camera: CameraReport::of(scene),
            bounds: (scene.primitives() > 0).then(|| scene.bounds()).map(|(lower, upper)| Bounds {
                lower: in_file(lower.as_vec3()),
                upper: in_file(upper.as_vec3()),
            }),
            needs: Features::of(scene).with(features_of(scene)).with(lights.needs()).names(),
            lights: LightReport::of(scene, &lights),
            punctual_lights: scene
                .lights
                .iter()
                .map(|light| punctual::text(light, &scene.coordinates))
                .collect(),
            memory_bytes: memory(scene),
            hierarchy: has_hierarchy.then(|| HierarchyReport::of(scene)),
            traversal,
            defaults: DefaultReport::all(scene),
            warnings: scene.warnings.iter().cloned().chain(opening(scene)).collect(),
        }
    }

    /// Tests whether the hierarchy, if there is one, is valid.
    pub fn is_valid(&self) -> bool {
        self.hierarchy.as_ref().is_none_or(|hierarchy| hierarchy.fault.is_none())
    }

    /// Returns the report for people: the name and the text of each fact; with `why`, the reasons for
    /// methods too.
    pub fn text(&self, why: bool) -> String {
        let [width, height] = self.resolution;
        let smooth = match self.smooth_triangles {
            0 => String::new(),
            count => format!(" ({} with vertex normals)", grouped(count)),
        };
        let mut lines = vec![("scene", self.name.clone())];
        if let Some(ViewReport { of, render }) = &self.view {
            let options = as_options(json(render).as_object().into_iter().flatten());
            lines.push(("view of", of.clone()));
            lines.extend((!options.is_empty()).then_some(("render", options)));
        }
        lines.extend([
            ("resolution", format!("{width}×{height}")),
            ("bounces", format!("up to {}", self.max_bounces)),
            ("spheres", grouped(self.spheres)),
            ("triangles", format!("{}{smooth}", grouped(self.triangles))),
            ("materials", materials_text(&self.materials)),
        ]);
        lines.extend(self.textures.iter().map(|texture| ("texture", texture.text())));
        let origin = vector(self.origin);
        let bounds = match self.bounds {
            Some(Bounds { lower, upper }) => format!("{} to {}", vector(lower), vector(upper)),
            None => "none: the scene is sky alone".into(),
        };
        let unit = if self.unit == 1.0 { String::new() } else { format!(", in units of {:e}", self.unit) };
        lines.extend([
            ("sky", self.sky.text()),
            ("camera", self.camera.text()),
            ("bounds", bounds),
            ("origin", format!("{origin}: coordinates are rounded relative to it{unit}")),
            ("needs", self.needs.join(", ")),
            ("lights", self.lights.text()),
        ]);
        lines.extend(self.punctual_lights.iter().map(|light| ("light", light.clone())));
        lines.extend([
            ("memory", DecimalBytes(self.memory_bytes as u64).to_string()),
            ("traversal", self.traversal.text()),
        ]);
        if why {
            lines.push(("why", self.traversal.why()));
            lines.extend(self.defaults.iter().map(|default| ("default", default.text())));
        }
        lines.extend(self.hierarchy.as_ref().map(|hierarchy| ("hierarchy", hierarchy.text())));
        lines.extend(self.warnings.iter().map(|warning| ("warning", warning.clone())));
        lines.into_iter().map(|(name, value)| item(name, 11, &value)).collect()
    }
}

/// The largest number of primitives of scenes whose openings are looked for: a structure is built for it.
const MAX_SEARCHED: usize = 50_000;

/// Returns a warning about the opening through which the sky lights a room.
fn opening(scene: &Scene) -> Option<String> {
    let is_searched = !scene.sky.is_black() && scene.portals.is_empty() && scene.primitives() <= MAX_SEARCHED;
    let advice = is_searched.then(|| openings::advice(scene, &Structure::new(&scene.geometry())))??;
    Some(format!("{}{}.", advice[..1].to_uppercase(), &advice[1..]))
}

/// The types of materials.
const TYPES: [&str; 7] = ["diffuse", "metal", "glass", "scatter", "plastic", "metal-rough", "emitter"];

fn materials(all: &[Material]) -> Vec<(&'static str, usize)> {
    let of_type = |name| all.iter().filter(|material| type_of(material.kind) == name).count();
    let emissive = all.iter().filter(|material| material.emits()).count();
    let textured = all.iter().filter(|material| material.texture.is_some()).count();
    let types = TYPES.into_iter().map(|name| (name, of_type(name)));
    let transparent = all.iter().filter(|material| !material.is_opaque()).count();
    types.chain([("emissive", emissive), ("textured", textured), ("transparent", transparent)]).collect()
}

/// Returns the name of a material type, as in scene files.
pub fn type_of(kind: MaterialKind) -> &'static str {
    match kind {
        MaterialKind::Diffuse => "diffuse",
        MaterialKind::Metal { .. } => "metal",
        MaterialKind::Glass { .. } | MaterialKind::ThinGlass { .. } | MaterialKind::RoughGlass { .. } => {
            "glass"
        }
        MaterialKind::FuzzyMirror { .. } => "scatter",
        MaterialKind::Plastic { .. } => "plastic",
        MaterialKind::MetalRough { .. } => "metal-rough",
        MaterialKind::Emitter => "emitter",
    }
}

fn as_map<S: Serializer>(counts: &[(&str, usize)], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(counts.iter().copied())
}

fn materials_text(counts: &[(&str, usize)]) -> String {
    let (types, traits) = counts.split_at(TYPES.len());
    let listed = |counts: &[(&str, usize)]| -> Vec<String> {
        let present = counts.iter().filter(|(_, count)| *count > 0);
        present.map(|(name, count)| format!("{count} {name}")).collect()
    };
    let total: usize = types.iter().map(|(_, count)| count).sum();
    let types = if total == 0 { "0".into() } else { format!("{total}: {}", listed(types).join(", ")) };
    std::iter::once(types).chain(listed(traits)).collect::<Vec<_>>().join("; ")
}

impl TextureReport {
    fn of(texture: &Texture) -> Self {
        Self {
            name: texture.name.clone(),
            width: texture.width,
            height: texture.height,
            filter: match texture.filter {
                Filter::Nearest => "nearest",
                Filter::Bilinear => "bilinear",
                Filter::Trilinear => "trilinear",
            },
            wrap: texture.wrap.map(Wrap::name),
            memory_bytes: texture.bytes(),
        }
    }

    fn text(&self) -> String {
        let Self { name, width, height, filter, wrap: [u, v], memory_bytes } = self;
        let wrap = match (u, v) {
            (&"repeat", &"repeat") => String::new(),
            (u, v) if u == v => format!("{u}, "),
            (u, v) => format!("{u} along u, {v} along v, "),
        };
        format!("{name}: {width}×{height}, {filter}, {wrap}{}", DecimalBytes(*memory_bytes as u64))
    }
}

impl LightReport {
    fn of(scene: &Scene, lights: &Lights) -> Self {
        let emits = |primitive: &Primitive| scene.materials[primitive.material() as usize].emits();
        Self {
            emitters: scene.all_primitives().filter(emits).count(),
            // Two triangles may be one light.
            sampled: lights.probabilities.iter().filter(|&&probability| probability > 0.0).count(),
            sky: lights.sky.is_some(),
            portals: lights.portals.len(),
            sky_contrast: match &lights.sky {
                Some((sky, _)) => Some(sky.contrast),
                None => EnvironmentLight::of(scene).map(|sky| sky.contrast),
            },
        }
    }

    fn text(&self) -> String {
        let emitters = match (self.emitters, self.sampled) {
            (0, _) => "no emitters".to_string(),
            (emitters, sampled) => {
                let emitters = counted(emitters, "emitter", "emitters");
                format!("next event estimation samples {} of {emitters}", grouped(sampled))
            }
        };
        let emitters = match self.portals {
            0 => emitters,
            count => format!("{emitters}; sky sampled through {}", counted(count, "portal", "portals")),
        };
        let Some(contrast) = self.sky_contrast else { return emitters };
        let sky = if self.sky { "sampled" } else { "not sampled" };
        format!("{emitters}; environment map {sky} (contrast {contrast:.1})")
    }
}

impl SkyReport {
    fn of(scene: &Scene) -> Self {
        match scene.sky {
            Sky::Color(color) => Self::Color { color: color.into() },
            Sky::Gradient { bottom, top } => Self::Gradient { bottom: bottom.into(), top: top.into() },
            Sky::Texture { texture, color, turn } => Self::Texture {
                texture: scene.textures[texture as usize].name.clone(),
                color: color.into(),
                turn_degrees: 360.0 * turn,
            },
        }
    }

    fn text(&self) -> String {
        match self {
            Self::Color { color } => vector(*color),
            Self::Gradient { bottom, top } => format!("{} below to {} above", vector(*bottom), vector(*top)),
            Self::Texture { texture, color, turn_degrees } => {
                let turned = match turn_degrees {
                    0.0 => String::new(),
                    _ => format!(", turned by {turn_degrees}°"),
                };
                format!("{texture}, times {}{turned}", vector(*color))
            }
        }
    }
}

/// Returns the bytes of the scene's lists, from which the buffers are built. The buffers are not counted.
fn memory(scene: &Scene) -> usize {
    let texels: usize = scene.textures.iter().map(|texture| texture.texels.bytes()).sum();
    let Scene { spheres, triangles, uvs, normals, materials, .. } = scene;
    let vertices = size_of_val(&triangles[..]) + size_of_val(&uvs[..]) + size_of_val(&normals[..]);
    texels + vertices + size_of_val(&spheres[..]) + size_of_val(&materials[..])
}
