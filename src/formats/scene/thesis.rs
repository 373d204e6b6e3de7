//! The thesis's scene format: its keys, its display colours, its axes.
//!
//! For: [`scene`].
//!
//! In the thesis's axes y points down and x grows to the left of the picture. Inverting the scene through the
//! origin, p' = −p, makes y point up and x point right for a camera that looks along −z. It follows with n' =
//! −n:
//!
//! - its camera at (2, −2.5, −365.63) stands at (−2, 2.5, 365.63). Its yaw of −4.7 rad, 0.0124 rad more than
//!   −3π/2, looks along (cos −4.7, 0, sin −4.7) = (−0.0124, 0, 0.9999), which becomes (0.0124, 0, −0.9999);
//!   right is forward × up, about +x, the thesis's −x;
//! - a sphere's u = atan2(n.z, n.x) / 2π is ours plus half a turn, and its row from the top, 1 − acos(n.y) /
//!   π, is our acos(n'.y) / π;
//! - a triangle's planar mapping is computed before the inversion and carried by its vertices.

use super::builder::{DEFAULT_BOUNCES, DEFAULT_RESOLUTION, SceneBuilder};
use super::check::{MAX_NUMBER, check_resolution, number, radius, vec3};
use super::error::SceneError;
use super::files::Files;
use super::json::{JsonPath, Source, read};
use glam::{DVec3, Vec2, Vec3};
use octray_engine::math::portable;
use octray_engine::scene::{
    Camera, Filter, Material, MaterialKind, Scene, Side, Sky, Sphere, TexelKind, srgb_to_linear,
};
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::{Path, PathBuf};

/// The thesis's rough reflections add a vector of length `roughness` to a reflected direction of this length.
const REFLECTED_LENGTH: f64 = 2000.0;
/// Scene units that one repeat of a texture covers on a triangle.
const TEXTURE_SIZE: f64 = 100.0;
/// The thesis's camera, in its own axes.
const CAMERA: DVec3 = DVec3::new(2.0, -2.5, -365.63);
/// Its yaw in radians, from +x towards +z.
const YAW: f64 = -4.7;
/// Half the picture's width over its focal length (200 pixels for every 68 of width): tan of half the field
/// of view.
const HALF_WIDTH: f64 = 34.0 / 200.0;

type Unknown = BTreeMap<String, IgnoredAny>;

#[derive(Deserialize)]
struct SceneFile {
    res: Option<[f64; 2]>,
    /// Display values from 0 to 1.
    sky: Option<[f64; 3]>,
    #[serde(default)]
    sphere: Vec<SphereFile>,
    #[serde(default)]
    triangle: Vec<TriangleFile>,
    #[serde(flatten)]
    unknown: Unknown,
}

#[derive(Deserialize)]
struct SphereFile {
    center: [f64; 3],
    radius: f64,
    color: Option<[f64; 3]>,
    emission: Option<f64>,
    roughness: Option<f64>,
    texture: Option<String>,
    #[serde(flatten)]
    unknown: Unknown,
}

#[derive(Deserialize)]
struct TriangleFile {
    center: [f64; 3],
    s0: [f64; 3],
    s1: [f64; 3],
    /// Accepted and ignored: it is normalize(s0 × s1).
    #[serde(rename = "normal")]
    _normal: Option<IgnoredAny>,
    color: Option<[f64; 3]>,
    emission: Option<f64>,
    roughness: Option<f64>,
    texture: Option<String>,
    #[serde(flatten)]
    unknown: Unknown,
}

/// Keys that spheres and triangles share.
struct Surface<'a> {
    /// Display values from 0 to 255.
    color: [f64; 3],
    emission: f64,
    roughness: f64,
    texture: &'a str,
}

impl<'a> Surface<'a> {
    fn new(
        color: Option<[f64; 3]>,
        emission: Option<f64>,
        roughness: Option<f64>,
        texture: Option<&'a String>,
    ) -> Self {
        Self {
            color: color.unwrap_or([255.0; 3]),
            emission: emission.unwrap_or(0.0),
            roughness: roughness.unwrap_or(0.0),
            texture: texture.map_or("", String::as_str),
        }
    }
}

/// The accepted form of a scene text in the thesis's format.
pub fn scene(source: &Source, files: &Files, name: String) -> Result<Scene, SceneError> {
    let file: SceneFile = read(source)?;
    let root = JsonPath::Root;
    let mut loader = Loader {
        source,
        files,
        builder: SceneBuilder::default(),
        known: HashMap::new(),
        missing: HashSet::new(),
    };

    let resolution = resolution(source, &root.key("res"), file.res)?;
    let spheres = root.key("sphere");
    for (i, sphere) in file.sphere.iter().enumerate() {
        loader.add_sphere(sphere, &spheres.item(i))?;
    }
    let triangles = root.key("triangle");
    let mut without_area = Vec::new();
    for (i, triangle) in file.triangle.iter().enumerate() {
        if !loader.add_triangle(triangle, &triangles.item(i))? {
            without_area.push(i);
        }
    }
    if let Some(first) = without_area.first() {
        let count = without_area.len();
        loader
            .builder
            .warn(format!("{count} of zero area among the triangles, first triangle[{first}], left out."));
    }
    if loader.builder.is_empty() {
        let mend = "add an entry to `sphere` or `triangle`";
        return Err(source.error(&root, "the scene holds nothing to see", mend));
    }
    let sky = file.sky.unwrap_or_default();
    for (i, channel) in sky.into_iter().enumerate() {
        if !(0.0..=MAX_NUMBER).contains(&channel) {
            let what = format!("the sky's channel {channel} is not a display value");
            return Err(source.error(&root.key("sky").item(i), what, "write a number from 0 to 1"));
        }
    }
    let sky = Sky::Color(DVec3::from(sky.map(srgb_to_linear)).as_vec3());
    warn_of_unknown(&mut loader.builder, &file);

    let camera = camera(resolution);
    debug_assert!(camera.fault().is_none());
    loader
        .builder
        .finish(name, camera, resolution, DEFAULT_BOUNCES, sky)
        .map_err(|error| error.in_file(source.file))
}

fn resolution(source: &Source, place: &JsonPath, res: Option<[f64; 2]>) -> Result<[u32; 2], SceneError> {
    let Some(res) = res else { return Ok(DEFAULT_RESOLUTION) };
    for (i, side) in res.into_iter().enumerate() {
        if side.fract() != 0.0 {
            let what = format!("{side} is not a whole number of pixels");
            return Err(source.error(&place.item(i), what, "write a whole number of pixels"));
        }
    }
    // A cast that saturates: what is out of range stays out of range.
    let resolution = res.map(|side| side as u32);
    check_resolution(source, place, resolution)?;
    Ok(resolution)
}

/// The thesis's camera in our axes.
fn camera([width, height]: [u32; 2]) -> Camera {
    let half_height = HALF_WIDTH * f64::from(height) / f64::from(width);
    // The point at z = 0 in the middle of the picture.
    let (sin, cos) = portable::sin_cos(YAW);
    let target = CAMERA + DVec3::new(cos / sin, 0.0, 1.0) * -CAMERA.z;
    Camera {
        position: inverted(CAMERA),
        look_at: inverted(target),
        up: Vec3::Y,
        vertical_fov: (2.0 * portable::atan(half_height)).to_degrees() as f32,
    }
}

/// A thesis point in our axes. Subtracting from zero leaves no negative zeros.
fn inverted(p: DVec3) -> Vec3 {
    (DVec3::ZERO - p).as_vec3()
}

struct Loader<'a> {
    source: &'a Source<'a>,
    files: &'a Files,
    builder: SceneBuilder,
    /// Index of each material, by the bits of its properties.
    known: HashMap<([u32; 8], Option<u32>), u32>,
    /// Paths of textures that already have a warning.
    missing: HashSet<String>,
}

impl Loader<'_> {
    fn add_sphere(&mut self, file: &SphereFile, place: &JsonPath) -> Result<(), SceneError> {
        let surface = Surface::new(file.color, file.emission, file.roughness, file.texture.as_ref());
        let center = file.center;
        vec3(self.source, &place.key("center"), center)?;
        let sphere = Sphere {
            center: inverted(DVec3::from(center)),
            radius: radius(self.source, &place.key("radius"), file.radius)?,
            material: self.material(&surface, place)?,
            texture_turn: 0.5,
            // The thesis's program maps every sphere's texture as seen from inside: right for skies, mirrored
            // on balls.
            texture_side: Side::Inside,
        };
        self.builder.spheres.push(sphere);
        Ok(())
    }
    /// Returns false for a triangle without area.
    fn add_triangle(&mut self, file: &TriangleFile, place: &JsonPath) -> Result<bool, SceneError> {
        let surface = Surface::new(file.color, file.emission, file.roughness, file.texture.as_ref());
        for (key, v) in [("center", file.center), ("s0", file.s0), ("s1", file.s1)] {
            vec3(self.source, &place.key(key), v)?;
        }
        let [center, s0, s1] = [file.center, file.s0, file.s1].map(DVec3::from);
        let corners = [center, center + s0, center + s1];
        if let Some(far) = corners.iter().find(|corner| corner.abs().max_element() > MAX_NUMBER) {
            let what = format!("the triangle reaches {far}, too far from the origin");
            return Err(self.source.error(
                place,
                what,
                "move it or make it smaller: numbers stay within ±1e18",
            ));
        }
        let material = self.material(&surface, place)?;
        let uvs = planar_uvs(corners);
        Ok(self.builder.add_triangle(corners.map(inverted), material, Some(uvs), None))
    }
    fn material(&mut self, surface: &Surface, place: &JsonPath) -> Result<u32, SceneError> {
        let texture = self.texture(surface.texture);
        let emission = number(self.source, &place.key("emission"), surface.emission)?;
        let roughness = number(self.source, &place.key("roughness"), surface.roughness)?;
        if roughness < 0.0 {
            let what = format!("{roughness} is negative");
            return Err(self.source.error(
                &place.key("roughness"),
                what,
                "write 0 for a mirror, or a number above it",
            ));
        }
        if surface.color.iter().any(|channel| !(0.0..=255.0).contains(channel)) {
            let color = surface.color;
            self.builder.warn(format!("{place}.color: {color:?} is outside 0 to 255 and was clamped."));
        }
        let color = surface.color.map(|channel| srgb_to_linear(channel.clamp(0.0, 255.0) / 255.0));
        let color = DVec3::from(color);
        let emits = emission > 0.0;
        let kind = if emits {
            MaterialKind::Emitter
        } else if roughness == 0.0 {
            MaterialKind::Metal { roughness: 0.0 }
        } else {
            MaterialKind::Scatter { roughness: (f64::from(roughness) / REFLECTED_LENGTH) as f32 }
        };
        let (emission, color) = match kind {
            MaterialKind::Emitter => ((color * f64::from(emission)).as_vec3(), Vec3::ONE),
            _ => (Vec3::ZERO, color.as_vec3()),
        };
        let roughness = if emits { 0.0 } else { roughness };
        let [e, c] = [emission, color].map(|v| v.to_array().map(f32::to_bits));
        let key = ([e[0], e[1], e[2], c[0], c[1], c[2], roughness.to_bits(), u32::from(emits)], texture);
        if let Some(&number) = self.known.get(&key) {
            return Ok(number);
        }
        let material = Material { texture, emission, ..Material::new(place.to_string(), kind, color) };
        let number = self.builder.add_material(material, TEXTURE_SIZE);
        self.known.insert(key, number);
        Ok(number)
    }
    /// The texture at a path, searched in every folder that the thesis's files may mean. A path that is not
    /// found is a warning.
    fn texture(&mut self, path: &str) -> Option<u32> {
        if path.is_empty() || self.missing.contains(path) {
            return None;
        }
        let found = candidates(self.files, path).into_iter().find(|path| self.files.exists(path));
        let loaded = match found {
            Some(found) => {
                self.builder.textures.load(self.files, &found, path, Filter::Nearest, TexelKind::Color)
            }
            None => {
                Err("no such file beside the scene, in the folders above it or in the working folder"
                    .to_string())
            }
        };
        loaded
            .map_err(|reason| {
                self.builder.warn(format!("The texture `{path}` is left out: {reason}."));
                self.missing.insert(path.to_string());
            })
            .ok()
    }
}

/// Texture coordinates of the thesis's triangles: distances from the first vertex along two directions in the
/// plane, [`TEXTURE_SIZE`] scene units to one repeat. The texture's rows run along the second direction, so
/// v, which points up, runs against it. The mapping is affine and therefore given by its values at the
/// vertices.
fn planar_uvs(vertices: [DVec3; 3]) -> [Vec2; 3] {
    let [a, b, c] = vertices;
    let n = (b - a).cross(c - a).normalize();
    let tangent = if n.x.abs() > n.y.abs() { DVec3::new(n.z, 0.0, -n.x) } else { DVec3::new(0.0, -n.z, n.y) };
    let tangent = tangent.normalize();
    let bitangent = n.cross(tangent).normalize();
    vertices.map(|p| {
        let (u, row) = ((p - a).dot(tangent) / TEXTURE_SIZE, (p - a).dot(bitangent) / TEXTURE_SIZE);
        Vec2::new(u as f32, (1.0 - row) as f32)
    })
}

/// The files that a texture path may mean: relative to the scene's folder, to each folder above it and to the
/// working folder; as written, and with backslashes replaced by slashes.
fn candidates(files: &Files, path: &str) -> Vec<PathBuf> {
    let spellings = [path.to_string(), path.replace('\\', "/")];
    let Some(folder) = files.folder() else { return spellings.map(|path| files.resolve(&path)).to_vec() };
    let absolute = std::path::absolute(folder.join(".")).unwrap_or_else(|_| folder.to_path_buf());
    let folders = absolute.ancestors().chain([Path::new("")]);
    folders.flat_map(|folder| spellings.iter().map(move |path| folder.join(path))).collect()
}

/// One warning for each unknown key, with the first place and the number of others.
fn warn_of_unknown(builder: &mut SceneBuilder, file: &SceneFile) {
    let top = file.unknown.keys().map(|key| (key.as_str(), key.clone()));
    let spheres = (file.sphere.iter().enumerate()).flat_map(|(i, sphere)| {
        sphere.unknown.keys().map(move |key| (key.as_str(), format!("sphere[{i}].{key}")))
    });
    let triangles = (file.triangle.iter().enumerate()).flat_map(|(i, triangle)| {
        triangle.unknown.keys().map(move |key| (key.as_str(), format!("triangle[{i}].{key}")))
    });
    let mut uses: BTreeMap<&str, (String, usize)> = BTreeMap::new();
    for (key, place) in top.chain(spheres).chain(triangles) {
        uses.entry(key).or_insert((place, 0)).1 += 1;
    }
    for (key, (place, count)) in uses {
        let more = if count > 1 { format!(" and {} more", count - 1) } else { String::new() };
        builder.warn(format!("The key `{key}` is unknown and ignored ({place}{more})."));
    }
}
