//! Builds a [`Scene`] from the materials and primitives of any format.

use super::check::{has_area, warn_of_size};
use super::error::SceneError;
use super::files::Files;
use super::notes::Notes;
use super::placement::Placement;
use super::portal;
use super::smooth;
use super::texture::Textures;
use super::vertex_colors::VertexColors;
use glam::{DVec2, DVec3, Vec2, Vec3};
use octray_engine::scene::{Camera, Coordinates, Material, MaterialKind, Scene, Sky, Sphere, Triangle};
use std::path::Path;

/// Default resolution, at which speed is measured.
pub const DEFAULT_RESOLUTION: [u32; 2] = [240, 135];
/// Default number of scattering events on a path.
pub const DEFAULT_BOUNCES: u32 = 4;
/// Most spheres and triangles of a scene: 11 GB of vertices. A hierarchy has room for four times as many.
pub const MAX_PRIMITIVES: usize = 1 << 28;
/// Most triangles of all copies of meshes: 2.4 GB of vertices. A small file can ask for many copies.
pub const MAX_COPIES: usize = 1 << 26;
/// Most materials of a scene.
const MAX_MATERIALS: usize = 1 << 20;
/// Most warnings that are kept; the others are counted.
const MAX_WARNINGS: usize = 1_000;

/// The attributes of a triangle's vertices besides their positions.
#[derive(Clone, Copy, Default)]
pub struct Attributes {
    /// Texture coordinates; planar ones if missing.
    pub uvs: Option<[Vec2; 3]>,
    /// Normals of unit length; that of the plane if missing.
    pub normals: Option<[Vec3; 3]>,
    /// Linear colours in [0, 1], which multiply the material's.
    pub colors: Option<[Vec3; 3]>,
}

/// A scale and then an offset of texture coordinates.
#[derive(Clone, Copy, PartialEq)]
pub struct UvTransform {
    pub scale: DVec2,
    pub offset: DVec2,
}

impl UvTransform {
    pub const IDENTITY: Self = Self { scale: DVec2::ONE, offset: DVec2::ZERO };

    /// Returns the transformed coordinates; 0 for those beyond single precision.
    fn apply(&self, uvs: [Vec2; 3]) -> [Vec2; 3] {
        let uvs = uvs.map(|uv| (uv.as_dvec2() * self.scale + self.offset).as_vec2());
        if uvs.iter().all(|uv| uv.is_finite()) { uvs } else { [Vec2::ZERO; 3] }
    }
}

/// The mapping of a material's textures onto triangles.
#[derive(Clone, Copy)]
struct Mapping {
    /// Scene units that one repeat of a texture covers on a triangle without `uvs`.
    texture_size: f64,
    transform: UvTransform,
}

/// A scene under construction.
#[derive(Default)]
pub struct SceneBuilder {
    /// The mapping of each material's textures.
    mappings: Vec<Mapping>,
    default_material: Option<u32>,
    /// The origin of the scene's coordinates, if it is known before them.
    pub origin: Option<DVec3>,
    has_coordinates: bool,
    /// The unrounded points of triangles, if they are kept.
    points: Option<Vec<[DVec3; 3]>>,
    pub textures: Textures,
    /// Materials, primitives and warnings so far.
    pub scene: Scene,
    colors: VertexColors,
    /// Notes about the file that is being read.
    pub notes: Notes,
    /// Number of warnings that were not kept.
    more_warnings: usize,
}

impl SceneBuilder {
    /// Starts a scene whose other files come from `files`.
    pub fn new(files: &Files) -> Self {
        let mut builder = Self::default();
        builder.textures.files = files.clone();
        builder.scene.unrounded = files.unrounded.then(Box::default);
        builder
    }
    pub fn files(&self) -> &Files {
        &self.textures.files
    }
    pub fn add_material(&mut self, material: Material, texture_size: f64) -> u32 {
        self.scene.materials.push(material);
        self.mappings.push(Mapping { texture_size, transform: UvTransform::IDENTITY });
        (self.scene.materials.len() - 1) as u32
    }
    /// Sets the transform of texture coordinates on triangles of a material that are still to come.
    pub fn transform_uvs(&mut self, material: u32, transform: UvTransform) {
        self.mappings[material as usize].transform = transform;
    }
    /// Returns the material of primitives that name none.
    pub fn default_material(&mut self) -> u32 {
        self.default_material.unwrap_or_else(|| {
            let number =
                self.add_material(Material::new("default", MaterialKind::Diffuse, Vec3::splat(0.8)), 1.0);
            self.default_material = Some(number);
            number
        })
    }
    /// Sets the coordinates of the scene.
    pub fn set_coordinates(&mut self, coordinates: Coordinates) {
        self.scene.coordinates = coordinates;
        self.has_coordinates = true;
    }
    /// Converts a placement of a model's points in the coordinates of the file to one in those of the scene.
    /// A scene without coordinates gets some around its origin, or else around the model's first point.
    pub fn within_scene(
        &mut self,
        placement: &Placement,
        points: impl Iterator<Item = DVec3> + Clone,
    ) -> Placement {
        if !self.has_coordinates {
            let points = points.map(|point| placement.point(point));
            let first = points.clone().next().unwrap_or_default();
            // The offset from the translation has the few digits of single precision: the sum is exact.
            let origin = self.origin.unwrap_or(match placement.translate {
                DVec3::ZERO => first,
                translate => translate + (first - translate).as_vec3().as_dvec3(),
            });
            let size = points.map(|point| point.distance_squared(origin)).fold(0.0, f64::max).sqrt();
            self.set_coordinates(Coordinates::around(origin, size));
        }
        let coordinates = &self.scene.coordinates;
        let (scale, translate) =
            (placement.scale / coordinates.unit, coordinates.to_scene(placement.translate));
        Placement { rotation: placement.rotation, scale, translate }
    }
    /// Adds a sphere, and its centre and radius before they were rounded.
    pub fn add_sphere(&mut self, sphere: Sphere, unrounded: (DVec3, f64)) {
        self.scene.spheres.push(sphere);
        self.scene.unrounded.iter_mut().for_each(|all| all.spheres.push(unrounded));
    }
    /// Adds a triangle and returns true, or returns false because it has no area in single precision. Texture
    /// coordinates are kept only if the material has textures, and vertex normals only if they differ from
    /// the geometric normal. Vertex colours are kept where the material can be [`Self::colored`].
    #[must_use]
    pub fn add_triangle(&mut self, unrounded: [DVec3; 3], material: u32, attributes: Attributes) -> bool {
        let vertices = unrounded.map(DVec3::as_vec3);
        if !has_area(&vertices) {
            return false;
        }
        let before = self.scene.triangles.len();
        let colored = attributes.colors.and_then(|colors| Some((self.colored(material)?, colors)));
        let (material, uvs) = match colored {
            Some((material, colors)) => {
                self.colors.add(before, colors);
                (material, Some([Vec2::ZERO; 3]))
            }
            None => (material, attributes.uvs),
        };
        let is_textured = self.scene.materials[material as usize].textures().next().is_some();
        let Mapping { texture_size, transform } = self.mappings[material as usize];
        let planar = || {
            let repeats = self.scene.materials[material as usize].repeats(&self.textures.list);
            self.planar_uvs(vertices, texture_size, repeats)
        };
        let uvs = is_textured.then(|| uvs.unwrap_or_else(planar));
        let uvs = uvs.map(|uvs| if transform == UvTransform::IDENTITY { uvs } else { transform.apply(uvs) });
        let normals = attributes.normals.filter(|normals| is_smooth(vertices, *normals));
        push_at(&mut self.scene.uvs, before, uvs);
        push_at(&mut self.scene.normals, before, normals);
        self.scene.triangles.push(Triangle { vertices, material });
        self.points.iter_mut().for_each(|points| points.push(unrounded));
        self.scene.unrounded.iter_mut().for_each(|all| all.triangles.push(unrounded));
        true
    }
    /// Returns the variant of a material for triangles with vertex colours, which multiply the emission of an
    /// emitter. Returns `None` if the material has textures.
    pub fn colored(&mut self, material: u32) -> Option<u32> {
        if let Some(&known) = self.colors.materials.get(&material) {
            return Some(known);
        }
        let plain = &self.scene.materials[material as usize];
        if plain.textures().next().is_some() {
            return None;
        }
        let texture = Some(self.colors.texture(&mut self.textures));
        let colored = self.add_material(Material { texture, ..plain.clone() }, 1.0);
        self.colors.materials.insert(material, colored);
        Some(colored)
    }
    /// Computes planar texture coordinates: positions in the triangle's plane, in the file's coordinates,
    /// with `size` of its units to one repeat.
    ///
    /// They depend only on the plane, so that the texture is continuous across coplanar neighbours. On planes
    /// flatter than [`FLAT`], the texture's upper edge points to −z, and the texture is not mirrored seen
    /// from above. On steeper planes the upper edge points to +y, and the texture is not mirrored seen from
    /// +z or, if the normal has no z, from +x.
    fn planar_uvs(&self, vertices: [Vec3; 3], size: f64, repeats: bool) -> [Vec2; 3] {
        let [a, b, c] = vertices.map(|vertex| self.scene.coordinates.to_file(vertex.as_dvec3()));
        let n = (b - a).cross(c - a).normalize();
        let flat = n.y.abs() > FLAT;
        let (front, up) = if flat { (DVec3::Y, DVec3::NEG_Z) } else { (DVec3::new(0.3, 0.0, 1.0), DVec3::Y) };
        let n = if n.dot(front) < 0.0 { -n } else { n };
        let up = (up - n * n.dot(up)).normalize();
        let right = up.cross(n);
        let uvs = [a, b, c].map(|p| DVec2::new(p.dot(right), p.dot(up)) / size);
        // Whole repeats are invisible. Without them, single precision has more digits for the fraction.
        let whole = if repeats { uvs[0].min(uvs[1]).min(uvs[2]).floor() } else { DVec2::ZERO };
        uvs.map(|uv| (uv - whole).as_vec2())
    }
    pub fn warn(&mut self, warning: impl Into<String>) {
        match self.scene.warnings.len() < MAX_WARNINGS {
            true => self.scene.warnings.push(warning.into()),
            false => self.more_warnings += 1,
        }
    }
    /// Begins to keep the points of added triangles, for [`SceneBuilder::smooth`].
    pub fn keep_points(&mut self) {
        self.points = Some(Vec::new());
    }
    /// Replaces the normals of the triangles that were added since [`SceneBuilder::keep_points`] by smooth
    /// ones, over edges of at most so many degrees.
    pub fn smooth(&mut self, degrees: f64) {
        let points = self.points.take().unwrap_or_default();
        let first = self.scene.triangles.len() - points.len();
        self.scene.normals.truncate(first);
        for (number, normals) in (first..).zip(smooth::normals(&points, degrees)) {
            let is_whole = !normals.contains(&Vec3::ZERO);
            let vertices = self.scene.triangles[number].vertices;
            let normals = Some(normals).filter(|normals| is_whole && is_smooth(vertices, *normals));
            push_at(&mut self.scene.normals, number, normals);
        }
    }
    /// Returns an opacity map that was just loaded, or removes it if it is 1 everywhere, as in many models:
    /// opaque materials are faster. The scene had `known` textures before.
    pub fn opacity_map(&mut self, map: Option<u32>, known: usize) -> Option<u32> {
        let texels = &self.textures.list[map? as usize].texels;
        if (0..texels.len()).any(|index| texels.linear(index)[0] < 1.0) {
            return map;
        }
        self.textures.truncate(known);
        None
    }
    /// Turns the notes about a file into warnings, with `separator` between the file's name and the place.
    pub fn warn_of_notes(&mut self, path: &Path, separator: &str) {
        for warning in std::mem::take(&mut self.notes).warnings(path, separator) {
            self.warn(warning);
        }
    }
    /// Checks that a scene may hold its materials and its primitives, with so many triangles more.
    pub fn check_room(&self, triangles: usize) -> Result<(), SceneError> {
        let primitives = self.scene.primitives() + triangles;
        for (count, most, what) in [
            (primitives, MAX_PRIMITIVES, "spheres and triangles"),
            (self.scene.materials.len(), MAX_MATERIALS, "materials"),
        ] {
            if count > most {
                let error = SceneError::new(format!("the scene holds {count} {what}"));
                return Err(error.mend(format!("leave at most {most}")));
            }
        }
        Ok(())
    }
    /// Returns the scene, or an error if it has too many primitives or materials.
    pub fn finish(
        mut self,
        name: String,
        camera: Camera,
        resolution: [u32; 2],
        max_bounces: u32,
        sky: Sky,
    ) -> Result<Scene, SceneError> {
        self.check_room(0)?;
        if let Some((what, mend)) = portal::too_many(&self.scene) {
            return Err(SceneError::new(what).mend(mend));
        }
        let unit = self.scene.coordinates.unit;
        for attenuation in self.scene.materials.iter_mut().filter_map(|it| it.extras.attenuation.as_mut()) {
            attenuation.distance = (f64::from(attenuation.distance) / unit) as f32;
        }
        self.colors.lay_out(&mut self.textures.list, &mut self.scene.uvs)?;
        self.textures.take_left_out().into_iter().for_each(|what| self.warn(what));
        if sky.is_black() && !self.scene.emits() {
            self.warn("Nothing in the scene emits light and the sky is black: the picture will be black.");
        }
        portal::warning(&self.scene, &sky, camera.position).into_iter().for_each(|what| self.warn(what));
        warn_of_size(&self.scene, &[camera]).into_iter().for_each(|what| self.warn(what));
        if self.more_warnings > 0 {
            self.scene.warnings.push(format!("{} more warnings are left out.", self.more_warnings));
        }
        Ok(Scene { name, camera, resolution, max_bounces, sky, textures: self.textures.list, ..self.scene })
    }
}

/// Appends a triangle's item to a list, which stays empty until the first triangle has one.
fn push_at<T: Copy + Default>(list: &mut Vec<T>, triangle: usize, item: Option<T>) {
    if item.is_some() || !list.is_empty() {
        list.resize(triangle, T::default());
        list.push(item.unwrap_or_default());
    }
}

/// Tests whether a vertex normal differs from the geometric normal, on either side, by more than 2·10⁻⁴.
/// Models round their normals by less.
fn is_smooth(vertices: [Vec3; 3], normals: [Vec3; 3]) -> bool {
    let [a, b, c] = vertices.map(Vec3::as_dvec3);
    let flat = (b - a).cross(c - a).normalize();
    normals.iter().any(|normal| normal.as_dvec3().cross(flat).length() > 2e-4)
}

/// Cosine of the steepest slope (40°) that is textured like a floor. At a common slope of buildings, rounding
/// would give neighbouring triangles different mappings.
const FLAT: f64 = 0.77;
