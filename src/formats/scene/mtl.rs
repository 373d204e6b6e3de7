//! Wavefront MTL: the materials that an OBJ file names.
//!
//! For: [`load`].
//!
//! Reads Kd (linear reflectance), map_Kd, Ke (radiance), `norm` (a normal map), and the statements that
//! decide the type of the material:
//!
//! | statements | material |
//! |---|---|
//! | `illum 3` | metal with reflectance Ks, or Kd where Ks is missing; a mirror unless `Pr` says otherwise |
//! | `illum 6`, `illum 7` (refraction) | glass |
//! | `illum 4`, `illum 9` ("glass on"), unless it is stated to be opaque | glass |
//! | opacity below a half and `Ni` above 1 | glass |
//! | `Pm` of a half or more | metal with reflectance Kd |
//! | `Pr` or `map_Pr` | plastic |
//! | `illum 2`, or none, with Ks above 0 and `Ns` of 1 or more | plastic |
//! | everything else | diffuse |
//!
//! The first row that fits decides. The roughness of metal and plastic is `Pr` times `map_Pr`. Where both are
//! missing, plastic gets the roughness of a highlight with exponent `Ns`: alpha = √(2 / (Ns + 2)) (Walter et
//! al., "Microfacet Models for Refraction through Rough Surfaces", 2007, §5), and metal is a mirror after
//! `illum 3`, else of roughness ½. Plastic's index of refraction is `Ni` if above 1 and at most 3, else 1.5;
//! the brightness of its highlight follows from the index and not from Ks.
//!
//! Opacity is `d`, or else 1 − `Tr`. A `Tr` of exactly 1 is ignored: some programs write it for opaque
//! materials. Glass has the index `Ni` (1.5 where missing or 0) and the colour `Tf` (white where missing or
//! black). It fills its mesh: a pane needs two sides.
//!
//! Other highlights (Ks, Ns), ambient light (Ka), and clear coats, sheen and anisotropy of 0 are ignored
//! without a warning. Every other ignored statement gives one warning for each kind and library, at its first
//! line.

use super::builder::SceneBuilder;
use super::error::SceneError;
use super::files::Files;
use super::notes::Notes;
use super::statements::{Fault, logical_lines, name, numbers, words};
use glam::{DVec3, Vec3};
use octray_engine::scene::{Filter, MIN_LENGTH, Material, MaterialKind, TexelKind};
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// Loads the libraries that an OBJ file at `obj` names into the builder; returns each material's index. A
/// missing library or texture is a warning: the model's shape is visible without it.
pub fn load(
    libraries: &[String],
    obj: &Path,
    files: &Files,
    builder: &mut SceneBuilder,
) -> Result<HashMap<String, u32>, SceneError> {
    let folder = obj.parent().unwrap_or(Path::new(""));
    let mut numbers = HashMap::new();
    let mut seen = HashSet::new();
    // Each once, however often the model names it.
    for library in libraries.iter().filter(|library| seen.insert(*library)) {
        // One statement may name several libraries, or one whose name holds spaces.
        let whole = [library.as_str()];
        let names = if files.exists(&folder.join(library)) {
            whole.to_vec()
        } else {
            library.split_whitespace().collect()
        };
        for name in names {
            let path = folder.join(name);
            match files.read(&path) {
                Ok(text) => {
                    let mut notes = Notes::new(":");
                    let entries = parse(&text, &path, &mut notes)?;
                    notes.warn(&path, builder);
                    for entry in entries {
                        let number = entry.add(name, &path, files, builder);
                        numbers.insert(entry.name, number);
                    }
                }
                Err(reason) => {
                    let (obj, path) = (obj.display(), path.display());
                    builder.warn(format!("{obj}: cannot read the materials at {path}: {reason}."));
                }
            }
        }
    }
    Ok(numbers)
}

/// Keywords that are ignored without a warning.
const SILENT: [&[u8]; 3] = [b"Ka", b"sharpness", b"map_Ka"];
/// Keywords that are ignored without a warning if their value is 0.
const LAYERS: [&[u8]; 5] = [b"Pc", b"Pcr", b"Ps", b"aniso", b"anisor"];
/// Default index of refraction: window glass.
const IOR: f64 = 1.5;
/// A refractive material with an opacity below this is glass, and not a leaf or a curtain.
const CLEAR: f64 = 0.5;

/// A number, and the line that sets it.
type Stated = Option<(f64, usize)>;

#[derive(Default)]
struct Entry {
    name: String,
    diffuse: Option<DVec3>,
    specular: DVec3,
    emission: DVec3,
    texture: Option<String>,
    illumination: Stated,
    /// `d`.
    opacity: Stated,
    /// `Tr`.
    transparency: Stated,
    ior: Stated,
    /// `Ns`.
    specular_exponent: f64,
    /// `Pm`.
    metallic: Stated,
    /// `Pr`.
    roughness: Option<f64>,
    roughness_map: Option<String>,
    normal_map: Option<String>,
    /// `Tf`, where it is three numbers.
    filter: Option<DVec3>,
}

fn parse(text: &[u8], path: &Path, notes: &mut Notes) -> Result<Vec<Entry>, SceneError> {
    let mut entries: Vec<Entry> = Vec::new();
    for (line, content) in logical_lines(text) {
        let fault =
            |(what, mend): Fault| SceneError::new(what).in_file(path).at(format!("line {line}")).mend(mend);
        let content = content.trim_ascii();
        let end = content.iter().position(u8::is_ascii_whitespace).unwrap_or(content.len());
        let (keyword, rest) = (&content[..end], &content[end..]);
        if keyword == b"newmtl" {
            entries.push(Entry { name: name(rest), ..Entry::default() });
            continue;
        }
        // Statements before the first `newmtl` are ignored.
        let Some(entry) = entries.last_mut() else { continue };
        let stated =
            |rest: &[u8]| numbers::<1>(rest, "this statement").map(|[x]| Some((x, line))).map_err(fault);
        match keyword {
            b"Kd" => entry.diffuse = Some(color(rest).map_err(fault)?),
            b"Ks" => entry.specular = color(rest).map_err(fault)?,
            b"Ke" => entry.emission = color(rest).map_err(fault)?,
            b"map_Kd" => entry.texture = texture_path(keyword, rest, line, notes),
            b"illum" => entry.illumination = stated(rest)?,
            // `-halo` varies the opacity with the angle; the base opacity follows it.
            b"d" => entry.opacity = stated(rest.trim_ascii().strip_prefix(b"-halo").unwrap_or(rest))?,
            b"Tr" => entry.transparency = stated(rest)?,
            b"Ni" => entry.ior = stated(rest)?,
            b"Ns" => [entry.specular_exponent] = numbers::<1>(rest, "this statement").map_err(fault)?,
            b"Pm" => entry.metallic = stated(rest)?,
            b"Pr" => entry.roughness = stated(rest)?.map(|(x, _)| x.clamp(0.0, 1.0)),
            b"map_Pr" => entry.roughness_map = texture_path(keyword, rest, line, notes),
            b"norm" | b"map_Kn" => entry.normal_map = texture_path(keyword, rest, line, notes),
            _ if LAYERS.contains(&keyword) && numbers::<1>(rest, "a layer") == Ok([0.0]) => {}
            b"Tf" => entry.filter = numbers::<3>(rest, "a colour").ok().map(DVec3::from),
            _ if SILENT.contains(&keyword) || keyword.is_empty() || keyword.starts_with(b"#") => {}
            _ => notes.add(&line, format!("`{}` is not read", String::from_utf8_lossy(keyword))),
        }
    }
    entries.iter().for_each(|entry| entry.note_ignored(notes));
    Ok(entries)
}

fn color(rest: &[u8]) -> Result<DVec3, Fault> {
    // One number means a grey.
    let color = match words(rest).count() {
        1 => DVec3::splat(numbers::<1>(rest, "a colour")?[0]),
        _ => DVec3::from(numbers::<3>(rest, "a colour")?),
    };
    if color.min_element() < 0.0 {
        return Err(("a colour is negative".to_string(), "write numbers of 0 or more".to_string()));
    }
    Ok(color)
}

/// Options of `map_` statements, the most values that each takes, and the values that ask for nothing.
const MAP_OPTIONS: [(&str, usize, &[&str]); 14] = [
    ("-blendu", 1, &["on"]),
    ("-blendv", 1, &["on"]),
    ("-bm", 1, &["1"]),
    ("-boost", 1, &["0"]),
    ("-cc", 1, &["off"]),
    ("-clamp", 1, &["off"]),
    ("-imfchan", 1, &["rgb"]),
    ("-mm", 2, &["0", "1"]),
    ("-o", 3, &["0", "0", "0"]),
    ("-s", 3, &["1", "1", "1"]),
    ("-t", 3, &["0", "0", "0"]),
    ("-texres", 1, &[]),
    ("-type", 1, &[]),
    ("-colorspace", 1, &[]),
];

/// The file name of a `map_` statement, after options such as `-s 1 1 1` and `-clamp on`, which are noted
/// unless they ask for nothing. The name may hold spaces.
fn texture_path(keyword: &[u8], rest: &[u8], line: usize, notes: &mut Notes) -> Option<String> {
    let rest = name(rest);
    let mut rest = rest.as_str();
    while rest.starts_with('-') {
        let (option, after) = rest.split_once(char::is_whitespace)?;
        let Some(&(_, most, idle)) = MAP_OPTIONS.iter().find(|(known, ..)| *known == option) else { break };
        rest = after.trim_start();
        let mut asks = false;
        for value in 0..most {
            let (word, after) = rest.split_once(char::is_whitespace)?;
            // Only the first value is required; further ones are numbers.
            let number = word.parse::<f64>();
            if value > 0 && number.is_err() {
                break;
            }
            let same = |idle: &&str| match idle.parse::<f64>() {
                Ok(idle) => number == Ok(idle),
                Err(_) => word == *idle,
            };
            asks |= !idle.get(value).is_some_and(same);
            rest = after.trim_start();
        }
        if asks {
            let keyword = String::from_utf8_lossy(keyword);
            notes.add(&line, format!("the option `{option}` of `{keyword}` is not read"));
        }
    }
    Some(rest.to_string()).filter(|rest| !rest.is_empty())
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Type {
    Diffuse,
    Metal,
    Plastic,
    Glass,
}

impl Entry {
    /// 1 is opaque; `None` where neither `d` nor `Tr` sets it.
    fn stated_opacity(&self) -> Stated {
        let transparency = self.transparency.filter(|&(x, _)| x != 1.0);
        self.opacity.or(transparency.map(|(x, line)| (1.0 - x, line)))
    }

    /// By the table at the head of this file.
    fn material_type(&self) -> Type {
        let opacity = self.stated_opacity().map(|(opacity, _)| opacity);
        let refracts = self.ior.is_some_and(|(ior, _)| ior > 1.0);
        match self.illumination.map(|(model, _)| model as u32) {
            Some(3) => Type::Metal,
            Some(6 | 7) => Type::Glass,
            Some(4 | 9) if opacity.is_none_or(|opacity| opacity < 1.0) => Type::Glass,
            _ if refracts && opacity.is_some_and(|opacity| opacity < CLEAR) => Type::Glass,
            _ if self.metallic.is_some_and(|(metallic, _)| metallic >= 0.5) => Type::Metal,
            _ if self.roughness.is_some() || self.roughness_map.is_some() => Type::Plastic,
            Some(2) | None if self.specular != DVec3::ZERO && self.specular_exponent >= 1.0 => Type::Plastic,
            _ => Type::Diffuse,
        }
    }

    fn kind(&self) -> MaterialKind {
        let stated = self.roughness.or(self.roughness_map.as_ref().map(|_| 1.0));
        let ior = self.ior.map(|(ior, _)| ior);
        match self.material_type() {
            Type::Diffuse => MaterialKind::Diffuse,
            Type::Metal => {
                let is_mirror = self.illumination.is_some_and(|(model, _)| model as u32 == 3);
                let roughness = stated.unwrap_or(if is_mirror { 0.0 } else { 0.5 });
                MaterialKind::Metal { roughness: roughness as f32 }
            }
            Type::Plastic => {
                // alpha is roughness squared.
                let roughness = stated.unwrap_or((2.0 / (self.specular_exponent + 2.0)).sqrt().sqrt());
                let ior = ior.filter(|&ior| ior > 1.0 && ior <= 3.0).unwrap_or(IOR);
                MaterialKind::Plastic { roughness: roughness as f32, ior: ior as f32 }
            }
            Type::Glass => {
                MaterialKind::Glass { ior: ior.filter(|&ior| ior >= MIN_LENGTH).unwrap_or(IOR) as f32 }
            }
        }
    }

    /// Notes statements about the material's type that cannot be followed.
    fn note_ignored(&self, notes: &mut Notes) {
        let material_type = self.material_type();
        if material_type != Type::Glass
            && let Some((_, line)) = self.stated_opacity().filter(|&(opacity, _)| opacity < 1.0)
        {
            notes.add(&line, "a partly transparent material that is not glass is shown opaque".to_string());
        }
        if let (Type::Diffuse | Type::Plastic, Some((model, line))) = (material_type, self.illumination)
            && [4.0, 5.0, 8.0, 9.0].contains(&model)
        {
            notes.add(
                &line,
                format!("`illum {model}` is shown diffuse: a mirror is `illum 3`, glass `illum 7`"),
            );
        }
        if material_type == Type::Glass
            && let Some((_, line)) = self.ior.filter(|&(ior, _)| ior == 1.0)
        {
            notes.add(&line, "glass with `Ni 1` does not refract and is invisible".to_string());
        }
        if material_type == Type::Glass && self.texture.is_some() {
            let line = [self.illumination, self.stated_opacity()].into_iter().flatten().next();
            notes.add(&line.map_or(1, |(_, line)| line), "glass is shown without its `map_Kd`".to_string());
        }
    }

    /// Adds the material to the builder. `library` is the MTL's name in the OBJ file, `path` the file that
    /// was found.
    fn add(&self, library: &str, path: &Path, files: &Files, builder: &mut SceneBuilder) -> u32 {
        let mirror_color = if self.specular == DVec3::ZERO { None } else { Some(self.specular) };
        let material_type = self.material_type();
        let given = match material_type {
            Type::Diffuse | Type::Plastic => self.diffuse,
            Type::Metal if self.metallic.is_none() => mirror_color.or(self.diffuse),
            Type::Metal => self.diffuse,
            Type::Glass => self.filter.filter(|filter| filter.max_element() > 0.0),
        };
        // A textured material without Kd shows its texture unchanged.
        let is_diffuse = matches!(material_type, Type::Diffuse | Type::Plastic);
        let plain = if self.texture.is_some() || !is_diffuse { DVec3::ONE } else { DVec3::splat(0.8) };
        let color = given.unwrap_or(plain);
        if color.max_element() > 1.0 {
            let (path, name) = (path.display(), &self.name);
            builder.warn(format!("{path}: the colour of `{name}` is above 1 and was clamped to 1."));
        }
        let mut load = |texture: &Option<String>, texel_kind| {
            let texture = texture.as_ref()?;
            let folder = path.parent().unwrap_or(Path::new(""));
            let slashed = texture.replace('\\', "/");
            let spelt = if files.exists(&folder.join(texture)) { texture } else { &slashed };
            let shown = Path::new(library).parent().unwrap_or(Path::new("")).join(spelt);
            let shown = shown.to_string_lossy();
            let loaded =
                builder.textures.load(files, &folder.join(spelt), &shown, Filter::Bilinear, texel_kind);
            loaded
                .map_err(|reason| {
                    let (path, name) = (path.display(), &self.name);
                    builder
                        .warn(format!("{path}: the texture `{texture}` of `{name}` is left out: {reason}."));
                })
                .ok()
        };
        let kind = self.kind();
        let texture = if material_type == Type::Glass { None } else { load(&self.texture, TexelKind::Color) };
        let roughness_map =
            if kind.has_roughness() { load(&self.roughness_map, TexelKind::Data) } else { None };
        let normal_map = load(&self.normal_map, TexelKind::Data);
        let material = Material {
            texture,
            roughness_map,
            normal_map,
            emission: self.emission.as_vec3().max(Vec3::ZERO),
            ..Material::new(&self.name, kind, color.clamp(DVec3::ZERO, DVec3::ONE).as_vec3())
        };
        builder.add_material(material, 1.0)
    }
}
