//! Converts a native file to a [`Scene`], or reports its faults.

use super::builder::{Attributes, DEFAULT_BOUNCES, DEFAULT_RESOLUTION, MAX_COPIES, SceneBuilder};
use super::camera::camera;
use super::check::{bring_near, is_within_bounds};
use super::error::{MAX_FAULTS, SceneError};
use super::faults::read_all;
use super::files::Files;
use super::glass::note_glass_in_glass;
use super::json::{JsonPath, Source};
use super::light::light;
use super::material;
use super::mesh::Unusable;
use super::model::{self, Model};
use super::native::{FORMAT, MeshFile, PortalFile, SceneFile, SphereFile, TriangleFile, VIEW_FORMAT};
use super::placement::Placement;
use super::portal::portal;
use super::spelling::nearest;
use glam::{DVec3, Vec3};
use octray_engine::scene::{Camera, Coordinates, MAX_COORDINATE, Scene, Sky, Sphere};
use std::collections::HashMap;
use std::path::Path;
use std::rc::Rc;

/// Field of view in degrees below which rounding relative to the camera shows in the picture.
const NARROW: f64 = 1.0;
/// Least size that coordinates are chosen for, relative to the distance from the origin to the scene's end.
/// The end is then at 1/16 of the largest coordinate.
const LEAST_SIZE: f64 = 16.0 / MAX_COORDINATE;

/// Reads a native scene text. The error has all faults of keys and types, and the first other fault of each
/// part.
pub fn scene(source: &Source, files: &Files, name: String) -> Result<Scene, SceneError> {
    let (file, faults): (SceneFile, _) = read_all(source)?;
    let root = source.root();
    if file.format != FORMAT {
        let what = format!("the format `{}` is unknown", file.format);
        let mend =
            format!("write \"format\": \"{FORMAT}\", or \"{VIEW_FORMAT}\" for a view of another scene");
        return Err(root.key("format").error(what, mend));
    }
    let is_mended = !faults.is_empty();
    let mut faults = Faults(faults);
    let resolution = file.resolution.unwrap_or(DEFAULT_RESOLUTION);
    let resolution = faults.record(root.key("resolution").resolution(resolution))?;
    let max_bounces = file.max_bounces.unwrap_or(DEFAULT_BOUNCES);
    let max_bounces = faults.record(root.key("max_bounces").bounces(max_bounces))?;

    faults.record(file.origin.map_or(Ok(Vec3::ZERO), |origin| root.key("origin").vec3(origin)))?;
    let seeks_camera = file.camera.is_none();
    let mut loader =
        Loader { builder: SceneBuilder::new(files), is_mended, seeks_camera, ..Loader::default() };
    set_coordinates(&file, &mut loader.builder);
    for entry in &file.materials.0 {
        let place = root.key("materials");
        let number = material::material(&mut loader.builder, entry, &place.key(&entry.0));
        let number = faults.record(number.map(Some))?;
        loader.materials.insert(&entry.0, number.unwrap_or_else(|| loader.builder.default_material()));
    }
    for (i, sphere) in file.spheres.iter().enumerate() {
        faults.record(loader.add_sphere(sphere, &root.key("spheres").item(i)))?;
    }
    for (i, triangle) in file.triangles.iter().enumerate() {
        faults.record(loader.add_triangle(triangle, &root.key("triangles").item(i)))?;
    }
    for name in file.meshes.iter().filter_map(|mesh| mesh.model.as_ref().or(mesh.obj.as_ref())) {
        *loader.uses.entry(name).or_default() += 1;
    }
    for (i, mesh) in file.meshes.iter().enumerate() {
        faults.record(loader.add_mesh(mesh, &root.key("meshes").item(i)))?;
    }
    for (i, portal) in file.portals.iter().enumerate() {
        faults.record(loader.add_portal(portal, &root.key("portals").item(i)))?;
    }
    for (i, one) in file.lights.iter().enumerate() {
        let light = light(one, &root.key("lights").item(i), &loader.builder.scene.coordinates);
        loader.builder.scene.lights.extend(faults.record(light.map(Some))?);
    }
    let (mut builder, own_camera) = (loader.builder, loader.camera);
    let sky = match &file.sky {
        Some(sky) => faults.record(material::sky(&mut builder, sky, &root.key("sky")).map(Some))?,
        None => None,
    };
    if builder.scene.primitives() == 0 {
        let mend = "add an entry to `spheres`, `triangles` or `meshes`";
        return Err(faults.all().unwrap_or(root.error("the scene holds nothing to see", mend)));
    }
    let camera_file = file.camera.unwrap_or_default();
    let camera = match own_camera {
        Some((camera, _)) => Some(camera),
        None => faults.record(camera(&root.key("camera"), &camera_file, &builder.scene, None).map(Some))?,
    };
    let own_resolution = own_camera.and_then(|(_, aspect)| aspect).map(model::resolution);
    let resolution = file.resolution.or(own_resolution).unwrap_or(resolution);
    let Some(camera) = camera.filter(|_| faults.0.is_empty()) else {
        return Err(faults.all().expect("without a fault there is a camera"));
    };
    note_glass_in_glass(&mut builder, &root.key("spheres"));
    builder.warn_of_notes(source.file, ": ");
    let plain = if builder.scene.emits() { Vec3::ZERO } else { Vec3::ONE };
    let sky = sky.unwrap_or(Sky::Color(plain));
    builder.finish(name, camera, resolution, max_bounces, sky).map_err(|error| error.in_file(source.file))
}

/// Sets the coordinates of a scene, or only their origin if all primitives are in models.
///
/// The origin is that of the file, or else the camera's position, relative to which rounding does not show in
/// the picture. If the field of view is [`NARROW`] or the camera orthographic, it is the nearest point in the
/// picture instead. Without a position it is the point that the camera looks at, a corner of a triangle, or
/// the centre of the smallest sphere. It depends on the direction of sight, and not on the distance of the
/// point that the camera looks at.
fn set_coordinates(file: &SceneFile, builder: &mut SceneBuilder) {
    let camera = file.camera.as_ref().map_or([None; 2], |camera| [camera.position, camera.look_at]);
    let [position, look_at] = camera.map(|point| point.map(DVec3::from));
    let vertices = file.triangles.iter().flat_map(|triangle| triangle.vertices).map(|vertex| (vertex, 0.0));
    let balls = file.spheres.iter().map(|sphere| (sphere.center, sphere.radius)).chain(vertices);
    let balls: Vec<(DVec3, f64)> = balls.map(|(center, radius)| (center.into(), radius)).collect();
    // Half the height of the picture at a distance, if it is small: rounding must not depend on the distance.
    let camera = file.camera.as_ref();
    let fov = camera.and_then(|camera| camera.vertical_fov).filter(|&fov| fov < NARROW);
    let height = camera.and_then(|camera| camera.orthographic_height);
    let half = height.map(|height| [0.5 * height, 0.0]).or(fov.map(|fov| [0.0, fov.to_radians() / 2.0]));
    let seen = match (position, look_at, half) {
        (Some(position), Some(look_at), Some([half, slope])) => {
            let sight = (look_at - position).normalize_or_zero();
            let (along, distance) = (|c: DVec3| (c - position).dot(sight), |c: DVec3| c.distance(position));
            let off_axis = |c: DVec3| (c - position - sight * along(c)).length();
            let shown = balls.iter().filter(|&&(c, r)| off_axis(c) + r < half + along(c) * slope);
            let nearest = shown.min_by(|a, b| distance(a.0).total_cmp(&distance(b.0))).map(|ball| ball.0);
            nearest.or((!balls.is_empty()).then_some(position))
        }
        (Some(position), ..) => Some(position),
        (None, ..) => {
            let smallest = file.spheres.iter().min_by(|a, b| a.radius.total_cmp(&b.radius));
            let corner = file.triangles.first().map(|triangle| triangle.vertices[0].into());
            look_at.or(corner).or(smallest.map(|sphere| sphere.center.into()))
        }
    };
    builder.origin = file.origin.map(DVec3::from).or(seen);
    let Some(origin) = builder.origin else { return };
    let reach = balls.iter().map(|(center, radius)| origin.distance(*center) + radius.abs()).reduce(f64::max);
    // The distance of sight stands for the size, unless it is far beyond the scene or nearly 0.
    let sight = position.zip(look_at).map(|(position, look_at)| position.distance(look_at));
    let size = reach.map(|reach| sight.map_or(reach, |sight| sight.clamp(reach * LEAST_SIZE, reach)));
    size.into_iter().for_each(|size| builder.set_coordinates(Coordinates::around(origin, size)));
}

/// The faults found so far.
struct Faults(Vec<SceneError>);

impl Faults {
    /// Returns the value, or its default after recording its fault; an error once there are enough faults.
    fn record<T: Default>(&mut self, found: Result<T, SceneError>) -> Result<T, SceneError> {
        let Err(fault) = found else { return found };
        // A fault that only follows from one inside the same value is not recorded.
        let place = fault.place().to_string();
        let is_inside = |known: &SceneError| {
            known.place().strip_prefix(&place).is_some_and(|rest| rest.starts_with(['.', '[']))
        };
        if !self.0.iter().any(is_inside) {
            self.0.push(fault);
        }
        if self.0.len() < MAX_FAULTS { Ok(T::default()) } else { self.all().map_or(Ok(T::default()), Err) }
    }
    /// Returns all faults as one error.
    fn all(&mut self) -> Option<SceneError> {
        SceneError::join(std::mem::take(&mut self.0))
    }
}

#[derive(Default)]
struct Loader<'a> {
    builder: SceneBuilder,
    /// Index of each material by name.
    materials: HashMap<&'a str, u32>,
    /// How often each model is named.
    uses: HashMap<&'a str, usize>,
    /// The models that are named more than once, and read once.
    models: HashMap<&'a str, Rc<Model>>,
    /// Number of triangles of all copies of models.
    copies: usize,
    /// Whether parts of the file, perhaps its materials, were left out because of faults.
    is_mended: bool,
    /// Whether the scene takes the first camera of a model.
    seeks_camera: bool,
    /// That camera, and the aspect ratio that it names.
    camera: Option<(Camera, Option<f64>)>,
}

impl<'a> Loader<'a> {
    /// Returns the index of the material that a primitive names, or of the default material.
    fn material(&mut self, name: Option<&String>, place: &JsonPath) -> Result<u32, SceneError> {
        let Some(name) = name else { return Ok(self.builder.default_material()) };
        if let Some(&number) = self.materials.get(name.as_str()) {
            return Ok(number);
        }
        if self.is_mended && self.materials.is_empty() {
            return Ok(self.builder.default_material());
        }
        let mut known: Vec<&str> = self.materials.keys().copied().collect();
        known.sort_unstable();
        let mend = match nearest(name, known.iter().copied()) {
            Some(near) => format!("did you mean `{near}`?"),
            None if known.is_empty() => {
                "the scene has no `materials`: add this one, or name none".to_string()
            }
            None => format!("add it to `materials`, or use one of {}", known.join(", ")),
        };
        Err(place.key("material").error(format!("there is no material `{name}`"), mend))
    }

    fn add_sphere(&mut self, file: &SphereFile, place: &JsonPath) -> Result<(), SceneError> {
        let coordinates = self.builder.scene.coordinates;
        let center = place.key("center").point(file.center, &coordinates)?;
        let radius = place.key("radius").radius(file.radius, &coordinates)?;
        let sphere = Sphere {
            texture_turn: place.key("turn_degrees").turns(file.turn_degrees)?,
            center: center.as_vec3(),
            radius: radius as f32,
            material: self.material(file.material.as_ref(), place)?,
            texture_side: file.picture_from.unwrap_or_default(),
        };
        self.builder.add_sphere(sphere, (center, radius));
        Ok(())
    }

    fn add_triangle(&mut self, file: &TriangleFile, place: &JsonPath) -> Result<(), SceneError> {
        let (at_vertices, at_uvs) = (place.key("vertices"), place.key("uvs"));
        let (at_normals, at_colors) = (place.key("normals"), place.key("colors"));
        let coordinates = self.builder.scene.coordinates;
        let vertices = at_vertices.each(file.vertices, |place, vertex| place.point(vertex, &coordinates))?;
        let uvs = file.uvs.map(|uvs| at_uvs.each(uvs, |place, uv| place.vec2(uv))).transpose()?;
        let normals = file.normals.map(|normals| at_normals.each(normals, normal)).transpose()?;
        let material = self.material(file.material.as_ref(), place)?;
        let reflectance = |place: &JsonPath, color| place.reflectance(color);
        let colors = file.colors.map(|colors| at_colors.each(colors, reflectance)).transpose()?;
        if colors.is_some() && self.builder.colored(material).is_none() {
            let what = "`colors` on a triangle whose material has textures";
            return Err(at_colors.error(what, "remove `colors`, or use a material without textures"));
        }
        if self.builder.add_triangle(vertices, material, Attributes { uvs, normals, colors }) {
            return Ok(());
        }
        let [a, b, c] = vertices.map(DVec3::as_vec3);
        let why = match a == b || b == c || c == a {
            true => "two of its vertices are the same in single precision",
            false => "its vertices lie on one line",
        };
        let mend = "remove the triangle, or move its vertices apart so that they span an area";
        Err(at_vertices.error(format!("the triangle has zero area: {why}"), mend))
    }

    fn add_portal(&mut self, file: &PortalFile, place: &JsonPath) -> Result<(), SceneError> {
        let (place, coordinates) = (place.key("vertices"), self.builder.scene.coordinates);
        let points = place.each(file.vertices, |place, vertex| place.point(vertex, &coordinates))?;
        let portal = portal(points, &coordinates).map_err(|(what, mend)| place.error(what, mend))?;
        self.builder.scene.portals.push(portal);
        Ok(())
    }

    /// Adds the lights of a mesh's model, and takes its camera if the scene seeks one.
    fn take_along(
        &mut self,
        file: &MeshFile,
        model: &Model,
        path: &Path,
        placement: &Placement,
        place: &JsonPath,
    ) -> Result<(), SceneError> {
        if file.lights == Some(false) && file.light_units.is_some() {
            let what = "`light_units` of lights that are left out";
            return Err(place.key("light_units").error(what, "remove it, or remove `lights`"));
        }
        let Model::Gltf(gltf) = model else { return Ok(()) };
        if file.lights != Some(false) {
            gltf.add_lights(path, &mut self.builder, placement, file.light_units)?;
        }
        if file.camera != Some(false) && self.seeks_camera && self.camera.is_none() {
            self.camera = gltf.camera(path, &mut self.builder, placement)?;
        }
        Ok(())
    }

    fn add_mesh(&mut self, file: &'a MeshFile, place: &JsonPath) -> Result<(), SceneError> {
        // Too many copies are refused already, and no more are made.
        if self.copies > MAX_COPIES {
            return Ok(());
        }
        let translate = file.translate.unwrap_or_default();
        place.key("translate").vec3(translate)?;
        let rotate = file.rotate_degrees.unwrap_or_default();
        place.key("rotate_degrees").vec3(rotate)?;
        let scale = file.scale.unwrap_or(1.0);
        if scale <= 0.0 || !is_within_bounds(scale) {
            let mend = "write one number above 0 and up to 1e18; a mesh cannot be mirrored";
            return Err(place.key("scale").error(format!("a mesh cannot be scaled by {scale}"), mend));
        }
        if let Some(degrees) = file.smooth.filter(|degrees| !(0.0..=180.0).contains(degrees)) {
            let mend = "write the largest angle of an edge that is smooth, from 0 (flat) to 180 degrees";
            return Err(place.key("smooth").error(format!("normals smooth over {degrees}°"), mend));
        }
        let material = file.material.as_ref().map(|name| self.material(Some(name), place)).transpose()?;
        let placement = Placement::new(scale, rotate, DVec3::from(translate));
        let (key, name) = model_of(file, place)?;
        let path = self.builder.files().resolve(name);
        let known = self.models.get(name.as_str()).cloned();
        let is_copy = known.is_some();
        let model = match known {
            Some(model) => model,
            None => {
                let bytes = self.builder.files().read(&path).map_err(|reason| {
                    let mend = format!(
                        "the file searched for is {}: give the path of an .obj, .gltf, .glb or .ply file relative \
                         to the scene file",
                        path.display()
                    );
                    place.key(key).error(format!("cannot read the mesh `{name}`: {reason}"), mend)
                })?;
                Rc::new(model::read(&bytes, &path, self.builder.files())?)
            }
        };
        let before = self.builder.scene.triangles.len();
        if file.smooth.is_some() {
            self.builder.keep_points();
        }
        let added = model.add(&path, &mut self.builder, material, &placement);
        file.smooth.into_iter().for_each(|degrees| self.builder.smooth(degrees));
        if added.is_ok() {
            self.take_along(file, &model, &path, &placement, place)?;
        }
        let uses = self.uses[name.as_str()];
        if uses > 1 && !is_copy {
            self.models.insert(name, model);
            self.copies += (self.builder.scene.triangles.len() - before) * (uses - 1);
            if self.copies > MAX_COPIES {
                let what = format!("copies of models add up to more than {MAX_COPIES} triangles");
                return Err(place.error(what, "name the model fewer times, or simplify it"));
            }
        }
        added.map_err(|unusable| match unusable {
            Unusable::Broken(error) => error,
            Unusable::NoArea => {
                let what = format!("the mesh `{name}` is invisible: all its faces have zero area");
                let mend = "use a larger `scale`, a smaller `translate`, or export the model again: its \
                            vertices must differ in single precision";
                place.error(what, mend)
            }
            Unusable::TooFar(point) => {
                let coordinates = &self.builder.scene.coordinates;
                place.error(format!("the mesh reaches {point}, too far away"), bring_near(coordinates))
            }
        })
    }
}

/// Returns the key of a mesh that names its model, and the name.
fn model_of<'a>(file: &'a MeshFile, place: &JsonPath) -> Result<(&'static str, &'a String), SceneError> {
    match (&file.model, &file.obj) {
        (Some(model), None) => Ok(("model", model)),
        (None, Some(obj)) => Ok(("obj", obj)),
        (None, None) => {
            let mend = "add `model`: the path of an .obj, .gltf, .glb or .ply file";
            Err(place.error("the key `model` is missing", mend))
        }
        (Some(_), Some(_)) => {
            let mend = "remove `obj`: both name the model";
            Err(place.key("obj").error("a mesh with `model` and `obj`", mend))
        }
    }
}

/// Scales a normal of the file, of any length but 0, to length 1.
fn normal(place: &JsonPath, normal: [f64; 3]) -> Result<Vec3, SceneError> {
    place.vec3(normal)?;
    let unit = DVec3::from(normal).normalize_or_zero().as_vec3();
    if unit == Vec3::ZERO {
        let mend = "write a direction away from the surface, or remove `normals`";
        return Err(place.error("a normal of length zero", mend));
    }
    Ok(unit)
}
