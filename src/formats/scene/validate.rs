//! From the native file to a [`Scene`], or an error that says where and how to mend it.
//!
//! For: [`scene`], and the limits that every format shares. May import: scene's own files. Must never know: where the
//! text came from.

use super::check::{WITHIN_BOUNDS, fits, nearest, number, radius, vec2, vec3};
use super::draft::{BOUNCES, Draft, RESOLUTION};
use super::file::{CameraFile, FORMAT, MeshFile, SceneFile, SideFile, SphereFile, TriangleFile, read};
use super::files::Files;
use super::obj::Misplaced;
use super::place::{Place, Source};
use super::{Camera, MAX_BOUNCES, MAX_SIDE, Scene, SceneError, Side, Sky, Sphere, material, obj, view};
use glam::{DMat3, DVec3, Vec3};
use std::collections::HashMap;

const AREA_MEND: &str = "remove the triangle, or move its vertices apart so that they span an area";

/// The accepted form of a native scene text.
pub fn scene(source: &Source, files: &Files, name: String) -> Result<Scene, SceneError> {
    let file: SceneFile = read(source)?;
    let root = Place::Root;
    if file.format != FORMAT {
        let what = format!("the format `{}` is unknown", file.format);
        let mend =
            format!("write \"format\": \"{FORMAT}\", or \"{}\" for a view of another scene", view::FORMAT);
        return Err(source.error(&root.key("format"), what, mend));
    }
    let resolution = file.resolution.unwrap_or(RESOLUTION);
    check_resolution(source, &root.key("resolution"), resolution)?;
    let max_bounces = file.max_bounces.unwrap_or(BOUNCES);
    check_bounces(source, &root.key("max_bounces"), max_bounces)?;

    let mut draft = Draft::default();
    let mut names = Names::new();
    let materials = root.key("materials");
    for entry in &file.materials.0 {
        let number = material::material(source, files, &mut draft, entry, &materials.key(&entry.0))?;
        names.insert(&entry.0, number);
    }
    let spheres = root.key("spheres");
    for (i, sphere) in file.spheres.iter().enumerate() {
        add_sphere(source, &mut draft, &names, sphere, &spheres.item(i))?;
    }
    let triangles = root.key("triangles");
    for (i, triangle) in file.triangles.iter().enumerate() {
        add_triangle(source, &mut draft, &names, triangle, &triangles.item(i))?;
    }
    let meshes = root.key("meshes");
    for (i, mesh) in file.meshes.iter().enumerate() {
        add_mesh(source, files, &mut draft, &names, mesh, &meshes.item(i))?;
    }
    if draft.is_empty() {
        let mend = "add an entry to `spheres`, `triangles` or `meshes`";
        return Err(source.error(&root, "the scene holds nothing to see", mend));
    }

    let sky = match &file.sky {
        Some(sky) => material::sky(source, files, &mut draft, sky, &root.key("sky"))?,
        None if draft.shines() => Sky::Color(Vec3::ZERO),
        None => Sky::Color(Vec3::ONE),
    };
    let framed = |position, look_at| draft.framing(position, look_at);
    let camera = camera(source, &root.key("camera"), &file.camera.unwrap_or_default(), framed)?;
    draft.finish(name, camera, resolution, max_bounces, sky).map_err(|error| error.in_file(source.file))
}

pub fn check_resolution(source: &Source, place: &Place, resolution: [u32; 2]) -> Result<(), SceneError> {
    for (i, side) in resolution.into_iter().enumerate() {
        if !(1..=MAX_SIDE).contains(&side) {
            let what = format!("a picture cannot be {side} pixels {}", ["wide", "high"][i]);
            return Err(source.error(&place.item(i), what, format!("write a number from 1 to {MAX_SIDE}")));
        }
    }
    Ok(())
}

pub fn check_bounces(source: &Source, place: &Place, bounces: u32) -> Result<(), SceneError> {
    if bounces > MAX_BOUNCES {
        let mend = format!("write a number from 0 to {MAX_BOUNCES}");
        return Err(source.error(place, format!("{bounces} bounces are too many"), mend));
    }
    Ok(())
}

/// The camera that a file describes; `otherwise` is what it leaves out, made for the position and the target that it gives.
pub fn camera(
    source: &Source,
    place: &Place,
    file: &CameraFile,
    otherwise: impl FnOnce(Option<Vec3>, Option<Vec3>) -> Camera,
) -> Result<Camera, SceneError> {
    let point =
        |key: &'static str, v: Option<[f64; 3]>| v.map(|v| vec3(source, &place.key(key), v)).transpose();
    let mut camera = otherwise(point("position", file.position)?, point("look_at", file.look_at)?);
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

/// The number of each material by its name.
type Names<'a> = HashMap<&'a str, u32>;

/// The number of the material that a primitive names.
fn named(
    source: &Source,
    draft: &mut Draft,
    names: &Names,
    name: Option<&String>,
    place: &Place,
) -> Result<u32, SceneError> {
    let Some(name) = name else { return Ok(draft.default_material()) };
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
    draft: &mut Draft,
    names: &Names,
    file: &SphereFile,
    place: &Place,
) -> Result<(), SceneError> {
    let turn = file.turn_degrees.unwrap_or(0.0);
    number(source, &place.key("turn_degrees"), turn)?;
    // Rounding up to a whole turn means no turn.
    let turn = Some((turn / 360.0).rem_euclid(1.0) as f32).filter(|&turn| turn < 1.0).unwrap_or(0.0);
    let sphere = Sphere {
        center: vec3(source, &place.key("center"), file.center)?,
        radius: radius(source, &place.key("radius"), file.radius)?,
        material: named(source, draft, names, file.material.as_ref(), place)?,
        texture_turn: turn,
        texture_side: match file.picture_from {
            Some(SideFile::Inside) => Side::Inside,
            Some(SideFile::Outside) | None => Side::Outside,
        },
    };
    draft.spheres.push(sphere);
    Ok(())
}

fn add_triangle(
    source: &Source,
    draft: &mut Draft,
    names: &Names,
    file: &TriangleFile,
    place: &Place,
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
    let material = named(source, draft, names, file.material.as_ref(), place)?;
    if !draft.add_triangle(vertices, material, uvs, normals) {
        return Err(source.error(&at_vertices, zero_area(&vertices), AREA_MEND));
    }
    Ok(())
}

/// Of any length but 0; here they get length 1.
fn vertex_normals(source: &Source, place: &Place, normals: [[f64; 3]; 3]) -> Result<[Vec3; 3], SceneError> {
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

fn add_mesh(
    source: &Source,
    files: &Files,
    draft: &mut Draft,
    names: &Names,
    file: &MeshFile,
    place: &Place,
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
        Some(_) => Some(named(source, draft, names, file.material.as_ref(), place)?),
        None => None,
    };
    let placement = Placement { turn: rotation(rotate), scale, translate: DVec3::from(translate) };
    let path = files.resolve(&file.obj);
    let text = files.read(&path).map_err(|reason| {
        let what = format!("cannot read the mesh `{}`: {reason}", file.obj);
        let mend = format!(
            "it was looked for at {}: give the path of an .obj file relative to the scene file",
            path.display()
        );
        source.error(&place.key("obj"), what, mend)
    })?;
    let mesh = obj::parse(&text, &path)?;
    match obj::add(&mesh, &path, files, draft, material, &placement)? {
        Some(Misplaced::NoArea) => {
            let what =
                format!("nothing of the mesh `{}` can be seen: all its faces have zero area", file.obj);
            let mend = "use a larger `scale`, a smaller `translate`, or export the model again: single precision must \
                        tell its vertices apart";
            Err(source.error(place, what, mend))
        }
        Some(Misplaced::TooFar(point)) => {
            let what = format!("the mesh reaches {point}, too far from the origin");
            Err(source.error(place, what, format!("use a smaller `scale` or `translate`: {WITHIN_BOUNDS}")))
        }
        None => Ok(()),
    }
}

/// Where a mesh stands: scaled, then turned, then moved.
pub struct Placement {
    pub turn: DMat3,
    pub scale: f64,
    pub translate: DVec3,
}

impl Placement {
    /// As the model's file has it.
    pub const AS_IT_IS: Self = Self { turn: DMat3::IDENTITY, scale: 1.0, translate: DVec3::ZERO };

    pub fn point(&self, p: DVec3) -> DVec3 {
        self.turn * (p * self.scale) + self.translate
    }
}

/// Turns about the x axis, then the y axis, then the z axis; counterclockwise seen from the axis' tip.
fn rotation([x, y, z]: [f64; 3]) -> DMat3 {
    let quarter = |degrees: f64| {
        // Right angles are exact: a mesh turned by 90° keeps its flat faces flat.
        let (sin, cos) = degrees.to_radians().sin_cos();
        match degrees.rem_euclid(360.0) {
            0.0 => (0.0, 1.0),
            90.0 => (1.0, 0.0),
            180.0 => (0.0, -1.0),
            270.0 => (-1.0, 0.0),
            _ => (sin, cos),
        }
    };
    let ((sx, cx), (sy, cy), (sz, cz)) = (quarter(x), quarter(y), quarter(z));
    let about_x = DMat3::from_cols_array(&[1.0, 0.0, 0.0, 0.0, cx, sx, 0.0, -sx, cx]);
    let about_y = DMat3::from_cols_array(&[cy, 0.0, -sy, 0.0, 1.0, 0.0, sy, 0.0, cy]);
    let about_z = DMat3::from_cols_array(&[cz, sz, 0.0, -sz, cz, 0.0, 0.0, 0.0, 1.0]);
    about_z * about_y * about_x
}
