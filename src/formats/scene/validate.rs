//! From the native file to a [`Scene`], or an error that says where and how to mend it.
//!
//! For: [`scene`], and [`camera`], which views share.

use super::builder::{DEFAULT_BOUNCES, DEFAULT_RESOLUTION, MAX_COPIES, SceneBuilder};
use super::check::{
    WITHIN_BOUNDS, check_bounces, check_resolution, fits, number, radius, reflectance, turns, vec2, vec3,
};
use super::error::SceneError;
use super::files::Files;
use super::json::{JsonPath, Source, read};
use super::model::Model;
use super::native::{
    CameraFile, FORMAT, MeshFile, SceneFile, SideFile, SphereFile, TriangleFile, VIEW_FORMAT,
};
use super::placement::{Placement, rotation};
use super::spelling::nearest;
use super::tally::Misplaced;
use super::{material, model};
use glam::{DVec3, Vec3};
use octray_engine::scene::{Camera, Scene, Side, Sky, Sphere};
use std::collections::HashMap;
use std::rc::Rc;

const AREA_MEND: &str = "remove the triangle, or move its vertices apart so that they span an area";

/// The accepted form of a native scene text.
pub fn scene(source: &Source, files: &Files, name: String) -> Result<Scene, SceneError> {
    let file: SceneFile = read(source)?;
    let root = JsonPath::Root;
    if file.format != FORMAT {
        let what = format!("the format `{}` is unknown", file.format);
        let mend =
            format!("write \"format\": \"{FORMAT}\", or \"{VIEW_FORMAT}\" for a view of another scene");
        return Err(source.error(&root.key("format"), what, mend));
    }
    let resolution = file.resolution.unwrap_or(DEFAULT_RESOLUTION);
    check_resolution(source, &root.key("resolution"), resolution)?;
    let max_bounces = file.max_bounces.unwrap_or(DEFAULT_BOUNCES);
    check_bounces(source, &root.key("max_bounces"), max_bounces)?;

    let mut builder = SceneBuilder::default();
    let mut names = Names::new();
    let materials = root.key("materials");
    for entry in &file.materials.0 {
        let number = material::material(source, files, &mut builder, entry, &materials.key(&entry.0))?;
        names.insert(&entry.0, number);
    }
    let spheres = root.key("spheres");
    for (i, sphere) in file.spheres.iter().enumerate() {
        add_sphere(source, &mut builder, &names, sphere, &spheres.item(i))?;
    }
    let triangles = root.key("triangles");
    for (i, triangle) in file.triangles.iter().enumerate() {
        add_triangle(source, &mut builder, &names, triangle, &triangles.item(i))?;
    }
    let meshes = root.key("meshes");
    let mut models = Models::of(&file.meshes);
    for (i, mesh) in file.meshes.iter().enumerate() {
        add_mesh(source, files, &mut builder, &names, &mut models, mesh, &meshes.item(i))?;
    }
    if builder.is_empty() {
        let mend = "add an entry to `spheres`, `triangles` or `meshes`";
        return Err(source.error(&root, "the scene holds nothing to see", mend));
    }

    let sky = match &file.sky {
        Some(sky) => material::sky(source, files, &mut builder, sky, &root.key("sky"))?,
        None if builder.emits() => Sky::Color(Vec3::ZERO),
        None => Sky::Color(Vec3::ONE),
    };
    let framed = |position, look_at| builder.framing(position, look_at);
    let camera = camera(source, &root.key("camera"), &file.camera.unwrap_or_default(), framed)?;
    builder.finish(name, camera, resolution, max_bounces, sky).map_err(|error| error.in_file(source.file))
}

/// The camera that a file describes. `default` makes the camera whose values the file leaves out, from the
/// position and target that the file gives.
pub fn camera(
    source: &Source,
    place: &JsonPath,
    file: &CameraFile,
    default: impl FnOnce(Option<Vec3>, Option<Vec3>) -> Camera,
) -> Result<Camera, SceneError> {
    let point =
        |key: &'static str, v: Option<[f64; 3]>| v.map(|v| vec3(source, &place.key(key), v)).transpose();
    let mut camera = default(point("position", file.position)?, point("look_at", file.look_at)?);
    if let Some(up) = point("up", file.up)? {
        camera.up = up;
    }
    if let Some(degrees) = file.vertical_fov {
        camera.vertical_fov = number(source, &place.key("vertical_fov"), degrees)?;
    }
    match camera.fault() {
        Some((key, what, mend)) => Err(source.error(&place.key(key), what, mend)),
        None => Ok(camera),
    }
}

/// Index of each material by name.
type Names<'a> = HashMap<&'a str, u32>;

/// Index of the material that a primitive names, or of the default material.
fn named(
    source: &Source,
    builder: &mut SceneBuilder,
    names: &Names,
    name: Option<&String>,
    place: &JsonPath,
) -> Result<u32, SceneError> {
    let Some(name) = name else { return Ok(builder.default_material()) };
    if let Some(&number) = names.get(name.as_str()) {
        return Ok(number);
    }
    let mut known: Vec<&str> = names.keys().copied().collect();
    known.sort_unstable();
    let mend = match nearest(name, known.iter().copied()) {
        Some(near) => format!("did you mean `{near}`?"),
        None if known.is_empty() => "the scene has no `materials`: add this one, or name none".to_string(),
        None => format!("add it to `materials`, or use one of {}", known.join(", ")),
    };
    Err(source.error(&place.key("material"), format!("there is no material `{name}`"), mend))
}

fn add_sphere(
    source: &Source,
    builder: &mut SceneBuilder,
    names: &Names,
    file: &SphereFile,
    place: &JsonPath,
) -> Result<(), SceneError> {
    let turn = turns(source, &place.key("turn_degrees"), file.turn_degrees)?;
    let sphere = Sphere {
        center: vec3(source, &place.key("center"), file.center)?,
        radius: radius(source, &place.key("radius"), file.radius)?,
        material: named(source, builder, names, file.material.as_ref(), place)?,
        texture_turn: turn,
        texture_side: match file.picture_from {
            Some(SideFile::Inside) => Side::Inside,
            Some(SideFile::Outside) | None => Side::Outside,
        },
    };
    builder.spheres.push(sphere);
    Ok(())
}

fn add_triangle(
    source: &Source,
    builder: &mut SceneBuilder,
    names: &Names,
    file: &TriangleFile,
    place: &JsonPath,
) -> Result<(), SceneError> {
    let (at_vertices, at_uvs) = (place.key("vertices"), place.key("uvs"));
    let [a, b, c] = file.vertices;
    let vertices = [
        vec3(source, &at_vertices.item(0), a)?,
        vec3(source, &at_vertices.item(1), b)?,
        vec3(source, &at_vertices.item(2), c)?,
    ];
    let uvs = match file.uvs {
        Some([a, b, c]) => Some([
            vec2(source, &at_uvs.item(0), a)?,
            vec2(source, &at_uvs.item(1), b)?,
            vec2(source, &at_uvs.item(2), c)?,
        ]),
        None => None,
    };
    let normals =
        file.normals.map(|normals| vertex_normals(source, &place.key("normals"), normals)).transpose()?;
    let material = named(source, builder, names, file.material.as_ref(), place)?;
    let has_area = match file.colors {
        None => builder.add_triangle(vertices, material, uvs, normals),
        Some(colors) => {
            let place = place.key("colors");
            let [a, b, c] = colors;
            let colors = [
                reflectance(source, &place.item(0), a)?,
                reflectance(source, &place.item(1), b)?,
                reflectance(source, &place.item(2), c)?,
            ];
            let material = builder.colored(material).ok_or_else(|| {
                let what = "`colors` on a triangle whose material has textures or scatters nothing";
                source.error(&place, what, "remove `colors`, or use a material without textures")
            })?;
            builder.add_colored_triangle(vertices, material, colors, normals)
        }
    };
    if !has_area {
        return Err(source.error(&at_vertices, zero_area(&vertices), AREA_MEND));
    }
    Ok(())
}

/// Normalised vertex normals; the file may give any length but 0.
fn vertex_normals(
    source: &Source,
    place: &JsonPath,
    normals: [[f64; 3]; 3],
) -> Result<[Vec3; 3], SceneError> {
    let mut units = [Vec3::ZERO; 3];
    for (i, normal) in normals.into_iter().enumerate() {
        vec3(source, &place.item(i), normal)?;
        units[i] = DVec3::from(normal).normalize_or_zero().as_vec3();
        if units[i] == Vec3::ZERO {
            let mend = "write a direction away from the surface, or remove `normals`";
            return Err(source.error(&place.item(i), "a normal of length zero", mend));
        }
    }
    Ok(units)
}

fn zero_area([a, b, c]: &[Vec3; 3]) -> &'static str {
    if a == b || b == c || c == a {
        "the triangle has zero area: two of its vertices are the same in single precision"
    } else {
        "the triangle has zero area: its vertices lie on one line"
    }
}

/// The models that a scene names more than once: each is read once.
#[derive(Default)]
struct Models<'a> {
    /// How often a model is named.
    uses: HashMap<&'a str, usize>,
    read: HashMap<&'a str, Rc<Model>>,
    /// Triangles of all copies.
    copies: usize,
}

impl<'a> Models<'a> {
    fn of(meshes: &'a [MeshFile]) -> Self {
        let mut models = Self::default();
        for name in meshes.iter().filter_map(|mesh| mesh.model.as_ref().or(mesh.obj.as_ref())) {
            *models.uses.entry(name).or_default() += 1;
        }
        models
    }
}

fn add_mesh<'a>(
    source: &Source,
    files: &Files,
    builder: &mut SceneBuilder,
    names: &Names,
    models: &mut Models<'a>,
    file: &'a MeshFile,
    place: &JsonPath,
) -> Result<(), SceneError> {
    let translate = file.translate.unwrap_or_default();
    vec3(source, &place.key("translate"), translate)?;
    let rotate = file.rotate_degrees.unwrap_or_default();
    vec3(source, &place.key("rotate_degrees"), rotate)?;
    let scale = file.scale.unwrap_or(1.0);
    if scale <= 0.0 || !fits(scale) {
        let what = format!("a mesh cannot be scaled by {scale}");
        let mend = "write one number above 0 and up to 1e18; a mesh cannot be mirrored";
        return Err(source.error(&place.key("scale"), what, mend));
    }
    let material = match &file.material {
        Some(_) => Some(named(source, builder, names, file.material.as_ref(), place)?),
        None => None,
    };
    let placement = Placement { rotation: rotation(rotate), scale, translate: DVec3::from(translate) };
    let (key, name) = match (&file.model, &file.obj) {
        (Some(model), None) => ("model", model),
        (None, Some(obj)) => ("obj", obj),
        (None, None) => {
            let mend = "add `model`: the path of an .obj, .gltf, .glb or .ply file";
            return Err(source.error(place, "the key `model` is missing", mend));
        }
        (Some(_), Some(_)) => {
            let mend = "remove `obj`: both name the model";
            return Err(source.error(&place.key("obj"), "a mesh with `model` and `obj`", mend));
        }
    };
    let path = files.resolve(name);
    let known = models.read.get(name.as_str()).cloned();
    let missing = |reason| {
        let what = format!("cannot read the mesh `{name}`: {reason}");
        let mend = format!(
            "the file searched for is {}: give the path of an .obj, .gltf, .glb or .ply file relative to the \
             scene file",
            path.display()
        );
        source.error(&place.key(key), what, mend)
    };
    let model = match known {
        Some(model) => model,
        None => Rc::new(model::read(&files.read(&path).map_err(missing)?, &path, files)?),
    };
    let before = builder.triangles();
    let misplaced = model.add(&path, files, builder, material, &placement)?;
    let uses = models.uses[name.as_str()];
    if uses > 1 && !models.read.contains_key(name.as_str()) {
        models.read.insert(name, model);
        models.copies += (builder.triangles() - before) * (uses - 1);
        if models.copies > MAX_COPIES {
            let what = format!("copies of models add up to more than {MAX_COPIES} triangles");
            return Err(source.error(place, what, "name the model fewer times, or simplify it"));
        }
    }
    match misplaced {
        Some(Misplaced::NoArea) => {
            let what = format!("the mesh `{name}` is invisible: all its faces have zero area");
            let mend = "use a larger `scale`, a smaller `translate`, or export the model again: its vertices \
                        must differ in single precision";
            Err(source.error(place, what, mend))
        }
        Some(Misplaced::TooFar(point)) => {
            let what = format!("the mesh reaches {point}, too far from the origin");
            Err(source.error(place, what, format!("use a smaller `scale` or `translate`: {WITHIN_BOUNDS}")))
        }
        None => Ok(()),
    }
}
