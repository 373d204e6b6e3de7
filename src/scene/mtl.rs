//! Wavefront MTL: the materials that an OBJ file names.
//!
//! For: [`load`]. May import: `draft`, `files`, `obj` (its reading of lines). Must never know: triangles.
//!
//! Read are Kd (linear reflectance), map_Kd, Ke (radiance), and of the illumination models only 3, a mirror that
//! reflects Ks; everything else a material may say means nothing here.

use super::draft::Draft;
use super::files::Files;
use super::obj::{Fault, logical_lines, name, numbers, words};
use super::{Filter, Material, MaterialKind, SceneError};
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
                    for entry in parse(&text, &path)? {
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

#[derive(Default)]
struct Entry {
    name: String,
    diffuse: Option<DVec3>,
    specular: DVec3,
    emission: DVec3,
    picture: Option<String>,
    mirror: bool,
}

fn parse(text: &[u8], path: &Path) -> Result<Vec<Entry>, SceneError> {
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
        match keyword {
            b"Kd" => entry.diffuse = Some(color(rest).map_err(fault)?),
            b"Ks" => entry.specular = color(rest).map_err(fault)?,
            b"Ke" => entry.emission = color(rest).map_err(fault)?,
            b"map_Kd" => entry.picture = picture(rest),
            b"illum" => entry.mirror = words(rest).next() == Some(b"3"),
            _ => {}
        }
    }
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

impl Entry {
    /// Adds the material to the draft; `library` is the MTL's name as the OBJ has it, `path` where it was found.
    fn add(&self, library: &str, path: &Path, files: &Files, draft: &mut Draft) -> u32 {
        let mirror_color = if self.specular == DVec3::ZERO { None } else { Some(self.specular) };
        let given = if self.mirror { mirror_color.or(self.diffuse) } else { self.diffuse };
        // A textured material without Kd shows its picture as it is.
        let plain = if self.picture.is_some() || self.mirror { DVec3::ONE } else { DVec3::splat(0.8) };
        let color = given.unwrap_or(plain);
        if color.max_element() > 1.0 {
            let (path, name) = (path.display(), &self.name);
            draft.warn(format!("{path}: the colour of `{name}` is above 1 and was lowered to 1."));
        }
        let texture = self.picture.as_ref().and_then(|picture| {
            let folder = path.parent().unwrap_or(Path::new(""));
            let slashed = picture.replace('\\', "/");
            let spelt = if files.exists(&folder.join(picture)) { picture } else { &slashed };
            let shown = Path::new(library).parent().unwrap_or(Path::new("")).join(spelt);
            let shown = shown.to_string_lossy();
            let loaded = draft.textures.load(files, &folder.join(spelt), &shown, Filter::Bilinear);
            loaded
                .map_err(|reason| {
                    let (path, name) = (path.display(), &self.name);
                    draft.warn(format!("{path}: the texture `{picture}` of `{name}` is left out: {reason}."));
                })
                .ok()
        });
        let kind = if self.mirror { MaterialKind::Metal { roughness: 0.0 } } else { MaterialKind::Diffuse };
        let material = Material {
            name: self.name.clone(),
            kind,
            color: color.min(DVec3::ONE).as_vec3(),
            texture,
            emission: self.emission.as_vec3().max(Vec3::ZERO),
        };
        draft.add_material(material, 1.0)
    }
}
