//! Reads the scene format of the thesis: its keys, its display colours, its axes.
//!
//! In the thesis's axes, y points down and x grows to the left of the picture. Inverting the scene through
//! the origin, p' = −p, makes y point up and x point right for a camera that looks along −z. With n' = −n it
//! follows:
//!
//! - The thesis's camera at (2, −2.5, −365.63) is at (−2, 2.5, 365.63) in ours. Its yaw of −4.7 rad, 0.0124
//!   rad more than −3π/2, looks along (cos −4.7, 0, sin −4.7) = (−0.0124, 0, 0.9999), which becomes (0.0124,
//!   0, −0.9999). Right is forward × up, about +x, the thesis's −x.
//! - A sphere's u = atan2(n.z, n.x) / 2π is ours plus half a turn. Its row from the top, 1 − acos(n.y) / π,
//!   is our acos(n'.y) / π.
//! - A triangle's planar mapping is computed before the inversion and kept by its vertices.

use super::builder::{Attributes, DEFAULT_BOUNCES, DEFAULT_RESOLUTION, SceneBuilder};
use super::check::MAX_NUMBER;
use super::error::SceneError;
use super::files::Files;
use super::json::{JsonPath, Source, read};
use super::notes::Notes;
use super::texture::Lookup;
use glam::{DVec3, Vec2, Vec3};
use octray_engine::math::portable;
use octray_engine::scene::{
    Camera, Coordinates, Filter, Material, MaterialKind, Scene, Side, Sky, Sphere, TexelKind, srgb_to_linear,
};
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

/// The thesis's rough reflections add a vector of length `roughness` to a reflected direction of this length.
const REFLECTED_LENGTH: f64 = 2000.0;
/// Scene units that one repeat of a texture covers on a triangle.
const TEXTURE_SIZE: f64 = 100.0;
/// The thesis's camera, in its own axes.
const CAMERA: DVec3 = DVec3::new(2.0, -2.5, -365.63);
/// Its yaw in radians, from +x towards +z.
const YAW: f64 = -4.7;
/// Tangent of half the horizontal field of view: half the picture's width over its focal length, which is 200
/// pixels for every 68 of width.
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
    /// normalize(s0 × s1), which is accepted and ignored.
    #[serde(rename = "normal")]
    _normal: Option<IgnoredAny>,
    color: Option<[f64; 3]>,
    emission: Option<f64>,
    roughness: Option<f64>,
    texture: Option<String>,
    #[serde(flatten)]
    unknown: Unknown,
}

/// Reads a scene text in the thesis's format.
pub fn scene(source: &Source, files: &Files, name: String) -> Result<Scene, SceneError> {
    let file: SceneFile = read(source)?;
    let root = source.root();
    let mut loader = Loader { builder: SceneBuilder::new(files), ..Loader::default() };

    let resolution = match file.res {
        Some(resolution) => whole_resolution(&root.key("res"), resolution)?,
        None => DEFAULT_RESOLUTION,
    };
    for (i, sphere) in file.sphere.iter().enumerate() {
        loader.add_sphere(sphere, &root.key("sphere").item(i))?;
    }
    for (i, triangle) in file.triangle.iter().enumerate() {
        loader.add_triangle(triangle, &root.key("triangle").item(i))?;
    }
    let mut builder = loader.builder;
    if builder.scene.primitives() == 0 {
        let mend = "add an entry to `sphere` or `triangle`";
        return Err(root.error("the scene holds nothing to see", mend));
    }
    let sky = root.key("sky").each(file.sky.unwrap_or_default(), |place, channel| {
        if (0.0..=MAX_NUMBER).contains(&channel) {
            return Ok(srgb_to_linear(channel) as f32);
        }
        let what = format!("the sky's channel {channel} is not a display value");
        Err(place.error(what, "write a number from 0 to 1"))
    })?;
    note_unknown(&mut builder.notes, &file, &root);
    builder.warn_of_notes(source.file, ": ");

    let camera = camera(resolution);
    debug_assert!(camera.fault().is_none());
    builder
        .finish(name, camera, resolution, DEFAULT_BOUNCES, Sky::Color(Vec3::from(sky)))
        .map_err(|error| error.in_file(source.file))
}

fn whole_resolution(place: &JsonPath, resolution: [f64; 2]) -> Result<[u32; 2], SceneError> {
    let whole = place.each(resolution, |place, side| match side.fract() == 0.0 {
        // The cast saturates, so that a side out of range stays out of range.
        true => Ok(side as u32),
        false => {
            let what = format!("{side} is not a whole number of pixels");
            Err(place.error(what, "write a whole number of pixels"))
        }
    })?;
    place.resolution(whole)
}

/// Returns the thesis's camera in our axes.
fn camera([width, height]: [u32; 2]) -> Camera {
    let half_height = HALF_WIDTH * f64::from(height) / f64::from(width);
    // The point at z = 0 in the middle of the picture.
    let (sin, cos) = portable::sin_cos(YAW);
    let target = CAMERA + DVec3::new(cos / sin, 0.0, 1.0) * -CAMERA.z;
    Camera::pinhole(
        inverted(CAMERA).as_vec3(),
        inverted(target).as_vec3(),
        Vec3::Y,
        (2.0 * portable::atan(half_height)).to_degrees() as f32,
    )
}

/// Converts a point to our axes. Subtracting from zero leaves no negative zeros.
fn inverted(p: DVec3) -> DVec3 {
    DVec3::ZERO - p
}

#[derive(Default)]
struct Loader {
    builder: SceneBuilder,
    /// Index of each material, by its properties without its name.
    known: HashMap<String, u32>,
    /// Index of each texture by its path; `None` for a missing one.
    textures: HashMap<String, Option<u32>>,
}

impl Loader {
    fn add_sphere(&mut self, file: &SphereFile, place: &JsonPath) -> Result<(), SceneError> {
        let &SphereFile { center, radius, color, emission, roughness, ref texture, .. } = file;
        place.key("center").vec3(center)?;
        let radius = place.key("radius").radius(radius, &Coordinates::default())?;
        let center = inverted(center.into());
        let sphere = Sphere {
            center: center.as_vec3(),
            radius: radius as f32,
            material: self.material(place, color, emission, roughness, texture.as_deref())?,
            texture_turn: 0.5,
            // The thesis's program maps every sphere's texture as seen from inside, which is right for skies
            // and mirrored on balls.
            texture_side: Side::Inside,
        };
        self.builder.add_sphere(sphere, (center, radius));
        Ok(())
    }
    fn add_triangle(&mut self, file: &TriangleFile, place: &JsonPath) -> Result<(), SceneError> {
        let &TriangleFile { center, s0, s1, color, emission, roughness, ref texture, .. } = file;
        for (key, v) in [("center", center), ("s0", s0), ("s1", s1)] {
            place.key(key).vec3(v)?;
        }
        let [center, s0, s1] = [center, s0, s1].map(DVec3::from);
        let corners = [center, center + s0, center + s1];
        if let Some(far) = corners.iter().find(|corner| corner.abs().max_element() > MAX_NUMBER) {
            let what = format!("the triangle reaches {far}, too far from the origin");
            return Err(place.error(what, "move it or make it smaller: numbers stay within ±1e18"));
        }
        let material = self.material(place, color, emission, roughness, texture.as_deref())?;
        let attributes = Attributes { uvs: Some(planar_uvs(corners)), ..Attributes::default() };
        if !self.builder.add_triangle(corners.map(inverted), material, attributes) {
            self.builder.notes.add(place, "a triangle of zero area is left out");
        }
        Ok(())
    }
    /// Adds the material of a primitive, unless it is known. Its colour has display values from 0 to 255.
    fn material(
        &mut self,
        place: &JsonPath,
        color: Option<[f64; 3]>,
        emission: Option<f64>,
        roughness: Option<f64>,
        texture: Option<&str>,
    ) -> Result<u32, SceneError> {
        let texture = texture.and_then(|path| self.texture(path));
        let emission = place.key("emission").number(emission.unwrap_or(0.0))?;
        let roughness = place.key("roughness").not_negative(roughness.unwrap_or(0.0))?;
        let color = color.unwrap_or([255.0; 3]);
        if color.iter().any(|channel| !(0.0..=255.0).contains(channel)) {
            self.builder.notes.add(&place.key("color"), "a channel outside 0 to 255 is clamped");
        }
        let color = DVec3::from(color.map(|channel| srgb_to_linear(channel.clamp(0.0, 255.0) / 255.0)));
        let (kind, emission, color) = if emission > 0.0 {
            (MaterialKind::Emitter, (color * f64::from(emission)).as_vec3(), Vec3::ONE)
        } else if roughness == 0.0 {
            (MaterialKind::Metal { roughness }, Vec3::ZERO, color.as_vec3())
        } else {
            let roughness = (f64::from(roughness) / REFLECTED_LENGTH) as f32;
            (MaterialKind::FuzzyMirror { roughness }, Vec3::ZERO, color.as_vec3())
        };
        let mut material = Material { texture, emission, ..Material::new("", kind, color) };
        let key = format!("{material:?}");
        if let Some(&number) = self.known.get(&key) {
            return Ok(number);
        }
        material.name = place.to_string();
        let number = self.builder.add_material(material, TEXTURE_SIZE);
        self.known.insert(key, number);
        Ok(number)
    }
    /// Loads the texture at a path relative to any of several folders. A path without a file is a warning.
    fn texture(&mut self, path: &str) -> Option<u32> {
        if path.is_empty() {
            return None;
        }
        if let Some(&known) = self.textures.get(path) {
            return known;
        }
        let files = self.builder.files();
        let found = candidates(files, path).into_iter().find(|path| files.read(path).is_ok());
        let loaded = match found {
            Some(found) => {
                self.builder.textures.load(&found, path, Lookup::repeating(Filter::Nearest, TexelKind::Color))
            }
            None => {
                let reason =
                    "no such file beside the scene, in the folders above it or in the working folder";
                Err(reason.to_string())
            }
        };
        if let Err(reason) = &loaded {
            self.builder.warn(format!("The texture `{path}` is left out: {reason}."));
        }
        let loaded = loaded.ok();
        self.textures.insert(path.to_string(), loaded);
        loaded
    }
}

/// Computes the texture coordinates of the thesis's triangles: distances from the first vertex along two
/// directions in the plane, with [`TEXTURE_SIZE`] scene units to one repeat. The texture's rows follow each
/// other along the second direction, so that v, which points up, runs against it. The mapping is affine and
/// therefore determined by its values at the vertices.
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

/// Returns the files that a texture path may stand for: relative to the scene's folder, to each folder above
/// it and to the working folder, as written and with slashes in the place of backslashes.
fn candidates(files: &Files, path: &str) -> Vec<PathBuf> {
    let spellings = [path.to_string(), path.replace('\\', "/")];
    let Some(folder) = files.folder() else { return spellings.map(|path| files.resolve(&path)).to_vec() };
    let absolute = std::path::absolute(folder.join(".")).unwrap_or_else(|_| folder.to_path_buf());
    let folders = absolute.ancestors().chain([Path::new("")]);
    folders.flat_map(|folder| spellings.iter().map(move |path| folder.join(path))).collect()
}

/// Notes the unknown keys of a file.
fn note_unknown(notes: &mut Notes, file: &SceneFile, root: &JsonPath) {
    let mut note = |place: &JsonPath, unknown: &Unknown| {
        for key in unknown.keys() {
            notes.add(&place.key(key), format!("the key `{key}` is unknown and ignored"));
        }
    };
    note(root, &file.unknown);
    let (spheres, triangles) = (root.key("sphere"), root.key("triangle"));
    file.sphere.iter().enumerate().for_each(|(i, sphere)| note(&spheres.item(i), &sphere.unknown));
    file.triangle.iter().enumerate().for_each(|(i, triangle)| note(&triangles.item(i), &triangle.unknown));
}
