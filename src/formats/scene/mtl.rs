//! Wavefront MTL: the materials that an OBJ file names.
//!
//! For: [`load`]. May import: `check`, `draft`, `files`, `obj` (its reading of lines). Must never know: triangles.
//!
//! Read are Kd (linear reflectance), map_Kd, Ke (radiance), `norm` (a normal map), and what makes a mirror, metal, plastic or glass:
//!
//! | statements | material |
//! |---|---|
//! | `illum 3` | metal that reflects Ks, or Kd where there is none; a mirror unless `Pr` says otherwise |
//! | `illum 6`, `illum 7` (refraction) | glass |
//! | `illum 4`, `illum 9` ("glass on"), unless it is stated to be opaque | glass |
//! | opacity below a half and `Ni` above 1 | glass |
//! | `Pm` of a half or more | metal that reflects Kd |
//! | `Pr` or `map_Pr` | plastic |
//! | `illum 2`, or none, with Ks above 0 and `Ns` of 1 or more | plastic |
//! | everything else | matt |
//!
//! The first line that fits counts. Metal and plastic are as rough as `Pr` times `map_Pr` says; where neither is there, plastic is as
//! rough as a highlight of `Ns`: alpha = √(2 / (Ns + 2)) (Walter et al., "Microfacet Models for Refraction through Rough Surfaces", 2007,
//! §5), and metal a mirror after `illum 3`, else of roughness ½. Plastic's index is `Ni` where that is above 1 and at most 3, else 1.5:
//! how bright its highlight is follows from that and not from Ks.
//!
//! Opacity is `d`, or else 1 − `Tr`; a `Tr` of exactly 1 is what some programs write for opaque things, and counts as nothing
//! said. Glass has the index `Ni` (1.5 where that is missing or 0) and the colour `Tf` (white where that is missing or black);
//! it fills its mesh: a pane needs two sides.
//!
//! Other highlights (Ks, Ns) and ambient light (Ka) are left out of every model and in silence, and so are clear coats, sheen and
//! anisotropy of 0. Whatever else is left out is a
//! warning, once for each kind and library, at the line where it stands first.

use super::draft::Draft;
use super::files::Files;
use super::obj::{Fault, logical_lines, name, numbers, words};
use super::{Filter, MIN_LENGTH, Material, MaterialKind, SceneError, TexelKind};
use glam::{DVec3, Vec3};
use std::collections::HashMap;
use std::path::Path;

/// Loads the libraries that an OBJ file at `obj` names into the draft; gives each material's number. A library or a
/// picture that is missing is a warning: the model's shape can be seen without it.
pub fn load(
    libraries: &[String],
    obj: &Path,
    files: &Files,
    draft: &mut Draft,
) -> Result<HashMap<String, u32>, SceneError> {
    let folder = obj.parent().unwrap_or(Path::new(""));
    let mut numbers = HashMap::new();
    for library in libraries {
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
                    let mut notes = Notes::default();
                    let entries = parse(&text, &path, &mut notes)?;
                    notes.warn(&path, draft);
                    for entry in entries {
                        let number = entry.add(name, &path, files, draft);
                        numbers.insert(entry.name, number);
                    }
                }
                Err(reason) => {
                    let (obj, path) = (obj.display(), path.display());
                    draft.warn(format!("{obj}: cannot read the materials at {path}: {reason}."));
                }
            }
        }
    }
    Ok(numbers)
}

/// Statements of these keywords change nothing, and nobody is told.
const SILENT: [&[u8]; 5] = [b"Ka", b"sharpness", b"map_Ka", b"map_Ks", b"map_Ns"];
/// These change nothing where they say 0.
const LAYERS: [&[u8]; 5] = [b"Pc", b"Pcr", b"Ps", b"aniso", b"anisor"];
/// Where a material does not say it: window glass.
const IOR: f64 = 1.5;
/// Below this much opacity, what bends light is glass, and not a leaf or a curtain.
const CLEAR: f64 = 0.5;

/// What was passed over: each kind once, with the line where it stands first and how often it stands.
#[derive(Default)]
struct Notes(Vec<(String, usize, usize)>);

impl Notes {
    fn add(&mut self, line: usize, what: String) {
        match self.0.iter_mut().find(|(known, ..)| *known == what) {
            Some((.., count)) => *count += 1,
            None => self.0.push((what, line, 1)),
        }
    }
    fn warn(self, path: &Path, draft: &mut Draft) {
        for (what, line, count) in self.0 {
            let more = if count > 1 { format!(" ({} more like it)", count - 1) } else { String::new() };
            draft.warn(format!("{}:{line}: {what}{more}.", path.display()));
        }
    }
}

/// A number, and the line that states it.
type Stated = Option<(f64, usize)>;

#[derive(Default)]
struct Entry {
    name: String,
    diffuse: Option<DVec3>,
    specular: DVec3,
    emission: DVec3,
    picture: Option<String>,
    illumination: Stated,
    /// `d`.
    opacity: Stated,
    /// `Tr`.
    transparency: Stated,
    ior: Stated,
    /// `Ns`.
    shine: f64,
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
        // What stands before the first material belongs to none.
        let Some(entry) = entries.last_mut() else { continue };
        let stated =
            |rest: &[u8]| numbers::<1>(rest, "this statement").map(|[x]| Some((x, line))).map_err(fault);
        match keyword {
            b"Kd" => entry.diffuse = Some(color(rest).map_err(fault)?),
            b"Ks" => entry.specular = color(rest).map_err(fault)?,
            b"Ke" => entry.emission = color(rest).map_err(fault)?,
            b"map_Kd" => entry.picture = picture(rest),
            b"illum" => entry.illumination = stated(rest)?,
            // A halo is denser towards its edge; what it is denser than comes last.
            b"d" => entry.opacity = stated(rest.trim_ascii().strip_prefix(b"-halo").unwrap_or(rest))?,
            b"Tr" => entry.transparency = stated(rest)?,
            b"Ni" => entry.ior = stated(rest)?,
            b"Ns" => [entry.shine] = numbers::<1>(rest, "this statement").map_err(fault)?,
            b"Pm" => entry.metallic = stated(rest)?,
            b"Pr" => entry.roughness = stated(rest)?.map(|(x, _)| x.clamp(0.0, 1.0)),
            b"map_Pr" => entry.roughness_map = picture(rest),
            b"norm" | b"map_Kn" => entry.normal_map = picture(rest),
            _ if LAYERS.contains(&keyword) && numbers::<1>(rest, "a layer") == Ok([0.0]) => {}
            b"Tf" => entry.filter = numbers::<3>(rest, "a colour").ok().map(DVec3::from),
            _ if SILENT.contains(&keyword) || keyword.is_empty() || keyword.starts_with(b"#") => {}
            _ => notes.add(line, format!("`{}` is not read", String::from_utf8_lossy(keyword))),
        }
    }
    entries.iter().for_each(|entry| entry.confess(notes));
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

/// The file name at the end of a `map_Kd` statement: options (`-s 1 1 1`, `-clamp on`) stand before it.
fn picture(rest: &[u8]) -> Option<String> {
    let rest = name(rest);
    if !rest.starts_with('-') {
        return Some(rest).filter(|rest| !rest.is_empty());
    }
    rest.split_whitespace().next_back().map(str::to_string)
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Look {
    Matt,
    Metal,
    Plastic,
    Glass,
}

impl Entry {
    /// 1 is opaque; `None` where nothing is said.
    fn stated_opacity(&self) -> Stated {
        let transparency = self.transparency.filter(|&(x, _)| x != 1.0);
        self.opacity.or(transparency.map(|(x, line)| (1.0 - x, line)))
    }

    /// As the table at the head of this file has it.
    fn look(&self) -> Look {
        let opacity = self.stated_opacity().map(|(opacity, _)| opacity);
        let bends = self.ior.is_some_and(|(ior, _)| ior > 1.0);
        match self.illumination.map(|(model, _)| model as u32) {
            Some(3) => Look::Metal,
            Some(6 | 7) => Look::Glass,
            Some(4 | 9) if opacity.is_none_or(|opacity| opacity < 1.0) => Look::Glass,
            _ if bends && opacity.is_some_and(|opacity| opacity < CLEAR) => Look::Glass,
            _ if self.metallic.is_some_and(|(metallic, _)| metallic >= 0.5) => Look::Metal,
            _ if self.roughness.is_some() || self.roughness_map.is_some() => Look::Plastic,
            Some(2) | None if self.specular != DVec3::ZERO && self.shine >= 1.0 => Look::Plastic,
            _ => Look::Matt,
        }
    }

    fn kind(&self) -> MaterialKind {
        let stated = self.roughness.or(self.roughness_map.as_ref().map(|_| 1.0));
        let ior = self.ior.map(|(ior, _)| ior);
        match self.look() {
            Look::Matt => MaterialKind::Diffuse,
            Look::Metal => {
                let is_mirror = self.illumination.is_some_and(|(model, _)| model as u32 == 3);
                let roughness = stated.unwrap_or(if is_mirror { 0.0 } else { 0.5 });
                MaterialKind::Metal { roughness: roughness as f32 }
            }
            Look::Plastic => {
                // alpha is the square of the roughness.
                let roughness = stated.unwrap_or((2.0 / (self.shine + 2.0)).powf(0.25));
                let ior = ior.filter(|&ior| ior > 1.0 && ior <= 3.0).unwrap_or(IOR);
                MaterialKind::Plastic { roughness: roughness as f32, ior: ior as f32 }
            }
            Look::Glass => {
                MaterialKind::Glass { ior: ior.filter(|&ior| ior >= MIN_LENGTH).unwrap_or(IOR) as f32 }
            }
        }
    }

    /// Notes what the material says of its look and does not get.
    fn confess(&self, notes: &mut Notes) {
        let look = self.look();
        if look != Look::Glass
            && let Some((_, line)) = self.stated_opacity().filter(|&(opacity, _)| opacity < 1.0)
        {
            notes.add(line, "what is partly transparent, and no glass, is shown opaque".to_string());
        }
        if let (Look::Matt | Look::Plastic, Some((model, line))) = (look, self.illumination)
            && [4.0, 5.0, 8.0, 9.0].contains(&model)
        {
            notes.add(
                line,
                format!("`illum {model}` is shown matt: what mirrors is `illum 3`, glass `illum 7`"),
            );
        }
        if look == Look::Glass
            && let Some((_, line)) = self.ior.filter(|&(ior, _)| ior == 1.0)
        {
            notes.add(line, "glass with `Ni 1` bends no light and cannot be seen".to_string());
        }
        if look == Look::Glass && self.picture.is_some() {
            let line = [self.illumination, self.stated_opacity()].into_iter().flatten().next();
            notes.add(line.map_or(1, |(_, line)| line), "glass is shown without its `map_Kd`".to_string());
        }
    }

    /// Adds the material to the draft; `library` is the MTL's name as the OBJ has it, `path` where it was found.
    fn add(&self, library: &str, path: &Path, files: &Files, draft: &mut Draft) -> u32 {
        let mirror_color = if self.specular == DVec3::ZERO { None } else { Some(self.specular) };
        let look = self.look();
        let given = match look {
            Look::Matt | Look::Plastic => self.diffuse,
            Look::Metal if self.metallic.is_none() => mirror_color.or(self.diffuse),
            Look::Metal => self.diffuse,
            Look::Glass => self.filter.filter(|filter| filter.max_element() > 0.0),
        };
        // A textured material without Kd shows its picture as it is.
        let is_matt = matches!(look, Look::Matt | Look::Plastic);
        let plain = if self.picture.is_some() || !is_matt { DVec3::ONE } else { DVec3::splat(0.8) };
        let color = given.unwrap_or(plain);
        if color.max_element() > 1.0 {
            let (path, name) = (path.display(), &self.name);
            draft.warn(format!("{path}: the colour of `{name}` is above 1 and was lowered to 1."));
        }
        let mut load = |picture: &Option<String>, texel_kind| {
            let picture = picture.as_ref()?;
            let folder = path.parent().unwrap_or(Path::new(""));
            let slashed = picture.replace('\\', "/");
            let spelt = if files.exists(&folder.join(picture)) { picture } else { &slashed };
            let shown = Path::new(library).parent().unwrap_or(Path::new("")).join(spelt);
            let shown = shown.to_string_lossy();
            let loaded =
                draft.textures.load(files, &folder.join(spelt), &shown, Filter::Bilinear, texel_kind);
            loaded
                .map_err(|reason| {
                    let (path, name) = (path.display(), &self.name);
                    let warning =
                        format!("{path}: the texture `{picture}` of `{name}` is left out: {reason}.");
                    draft.warnings.push(warning);
                })
                .ok()
        };
        let kind = self.kind();
        let texture = if look == Look::Glass { None } else { load(&self.picture, TexelKind::Color) };
        let roughness_map =
            if kind.has_roughness() { load(&self.roughness_map, TexelKind::Data) } else { None };
        let normal_map = load(&self.normal_map, TexelKind::Data);
        let material = Material {
            name: self.name.clone(),
            kind,
            color: color.clamp(DVec3::ZERO, DVec3::ONE).as_vec3(),
            texture,
            roughness_map,
            normal_map,
            emission: self.emission.as_vec3().max(Vec3::ZERO),
        };
        draft.add_material(material, 1.0)
    }
}
