//! Reads Wavefront MTL: the materials that an OBJ file names.
//!
//! `scenes/README.md` has the table of statements and materials. Statements that are not read or cannot be
//! read give one warning for each kind and library, at the first line.

use super::builder::{SceneBuilder, UvTransform};
use super::error::SceneError;
use super::mtl_map::{Map, is_bump};
use super::notes::Notes;
use super::statements::{Statement, statements, without_comment};
use glam::DVec3;
use octray_engine::scene::{MIN_LENGTH, Material, MaterialKind};
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// Loads the libraries that an OBJ file at `obj` names, on these lines, into the builder. Returns each
/// material's index. A missing library or texture is a warning, as the model's shape is visible without it.
pub fn load(libraries: &[(String, usize)], obj: &Path, builder: &mut SceneBuilder) -> HashMap<String, u32> {
    let files = builder.files().clone();
    let read = |name: &str| {
        files.find(name, [obj, obj], |path| files.read(path).map(|text| (path.to_path_buf(), text)))
    };
    let (mut numbers, mut without_comments) = (HashMap::new(), Vec::new());
    let mut seen = HashSet::new();
    // Each library is read once, however often the model names it.
    for (library, line) in libraries.iter().filter(|(library, _)| seen.insert(library)) {
        // One statement may name several libraries, or one whose name holds spaces.
        let words: Vec<&str> = library.split_whitespace().take_while(|word| !word.starts_with('#')).collect();
        let are_several =
            words.len() > 1 && words.iter().all(|word| word.to_ascii_lowercase().ends_with(".mtl"));
        let names = if are_several || read(library).is_err() { words } else { vec![library.as_str()] };
        for name in names {
            let (path, text) = match read(name) {
                Ok(found) => found,
                Err(reason) => {
                    let obj = obj.display();
                    builder.warn(format!("{obj}:{line}: cannot read the materials `{name}`: {reason}."));
                    continue;
                }
            };
            let entries = parse(&text, &path, &mut builder.notes);
            builder.warn_of_notes(&path, ":");
            for entry in entries {
                let number = entry.add(obj, &path, builder);
                let cut = without_comment(&entry.name).skip(1);
                without_comments.extend(cut.map(|name| (name.to_string(), number)));
                if numbers.insert(entry.name, number).is_some() {
                    builder.notes.add(&entry.line, "a second material of one name replaces the first");
                }
            }
            builder.warn_of_notes(&path, ":");
        }
    }
    for (name, number) in without_comments {
        numbers.entry(name).or_insert(number);
    }
    numbers
}

/// The kinds of values of statements.
enum Reads {
    /// A colour: one number for a grey, or three.
    Color,
    Number,
    /// An image file.
    Map,
    /// A number that is not read, with a warning unless it is 0.
    Layer,
    /// A value that is not read.
    Nothing,
}

/// The statements that are known; all others give a warning.
const STATEMENTS: [(Reads, &[&str]); 5] = [
    (Reads::Color, &["Kd", "Ks", "Ke", "Tf"]),
    (Reads::Number, &["illum", "d", "Tr", "Ni", "Ns", "Pm", "Pr"]),
    (Reads::Map, &["map_Kd", "map_Ke", "map_Pr", "map_Pm", "norm", "map_Kn", BUMP, "map_Ka", "map_d"]),
    (Reads::Layer, &["Pc", "Pcr", "Ps", "aniso", "anisor"]),
    (Reads::Nothing, &["Ka"]),
];

/// The keyword that stands for all those of maps of heights.
const BUMP: &str = "map_Bump";

/// Default index of refraction: window glass.
const IOR: f64 = 1.5;
/// Opacity below which a refractive material is glass, and not a leaf or a curtain.
const CLEAR: f64 = 0.5;

/// A material: the values of its statements by their keywords, with the line of each.
#[derive(Default)]
struct Entry {
    name: String,
    line: usize,
    colors: HashMap<&'static str, (DVec3, usize)>,
    numbers: HashMap<&'static str, (f64, usize)>,
    maps: HashMap<&'static str, Map>,
}

fn parse(text: &[u8], path: &Path, notes: &mut Notes) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    for statement in statements(text, path) {
        let (keyword, line) = (statement.keyword(), statement.line);
        if keyword == b"newmtl" {
            entries.push(Entry { name: statement.name(), line, ..Entry::default() });
            continue;
        }
        let Some(entry) = entries.last_mut() else {
            notes.add(&line, "statements before the first `newmtl` are not read");
            continue;
        };
        let known = STATEMENTS.iter().find_map(|(reads, keywords)| {
            let is_known = |known: &&&str| known.as_bytes() == keyword || **known == BUMP && is_bump(keyword);
            Some((*keywords.iter().find(is_known)?, reads))
        });
        let result = match known {
            Some((keyword, Reads::Color)) => {
                color(&statement).map(|color| entry.colors.extend([(keyword, (color, line))]))
            }
            Some((keyword, Reads::Number)) => {
                number(&statement, notes).map(|x| entry.numbers.extend([(keyword, (x, line))]))
            }
            Some((keyword, Reads::Map)) => {
                Map::read(&statement, notes).map(|map| entry.maps.extend([(keyword, map)]))
            }
            Some((_, Reads::Layer)) if number(&statement, notes).is_ok_and(|x| x == 0.0) => Ok(()),
            Some((_, Reads::Nothing)) => Ok(()),
            _ => {
                notes.add(&line, format!("{} is not read", statement.shown()));
                Ok(())
            }
        };
        result.unwrap_or_else(|fault| notes.add_fault(&statement.shown(), fault));
    }
    entries.iter().for_each(|entry| entry.note_ignored(notes));
    entries
}

fn number(statement: &Statement, notes: &mut Notes) -> Result<f64, SceneError> {
    let mut words = statement.words().peekable();
    // The base opacity follows the option.
    if words.next_if(|word| word == b"-halo").is_some() {
        notes.add(&statement.line, "the option `-halo` of `d` is not read");
    }
    statement.numbers(&mut words, "this statement").map(|[number]| number)
}

fn color(statement: &Statement) -> Result<DVec3, SceneError> {
    let mut words = statement.words();
    let color = match statement.words().count() {
        1 => DVec3::splat(statement.numbers::<1>(&mut words, "a colour")?[0]),
        _ => DVec3::from(statement.numbers(&mut words, "a colour")?),
    };
    if color.min_element() < 0.0 {
        return Err(statement.fault("a colour is negative", "write numbers of 0 or more"));
    }
    Ok(color)
}

impl Entry {
    fn number(&self, keyword: &str) -> Option<f64> {
        self.numbers.get(keyword).map(|&(number, _)| number)
    }
    fn color(&self, keyword: &str) -> Option<DVec3> {
        self.colors.get(keyword).map(|&(color, _)| color)
    }
    /// Returns the opacity, of which 1 is opaque, and its line; `None` without `d` and `Tr`.
    fn opacity(&self) -> Option<(f64, usize)> {
        let transparency = self.numbers.get("Tr").filter(|&&(x, _)| x != 1.0);
        self.numbers.get("d").copied().or(transparency.map(|&(x, line)| (1.0 - x, line)))
    }
    /// Tests whether the material, with `illum 4` or `illum 9`, is stated to let light through.
    fn is_clear(&self) -> bool {
        match (self.number("d"), self.number("Tr")) {
            (Some(opacity), _) => opacity < 1.0,
            (None, Some(transparency)) => transparency > 0.0,
            (None, None) => self.color("Tf").is_some_and(|filter| filter != DVec3::ONE),
        }
    }
    /// Returns the kind of the material, by the table of `scenes/README.md`.
    fn kind(&self) -> MaterialKind {
        let opacity = self.opacity().map(|(opacity, _)| opacity);
        let ior = self.number("Ni");
        let refracts = ior.is_some_and(|ior| ior > 1.0);
        let exponent = self.number("Ns").unwrap_or(0.0);
        let is_shiny = self.color("Ks").is_some_and(|color| color != DVec3::ZERO) && exponent >= 1.0;
        let roughness = self.number("Pr").map(|x| x.clamp(0.0, 1.0));
        let roughness = roughness.or(self.maps.get("map_Pr").map(|_| 1.0));
        let ior_of_coat = || ior.filter(|&ior| ior > 1.0 && ior <= 3.0).unwrap_or(IOR) as f32;
        let metal = |unstated: f64| match self.maps.contains_key("map_Pm") {
            // A share of 0 would make the map useless.
            true => MaterialKind::MetalRough {
                roughness: roughness.unwrap_or(0.5) as f32,
                metallic: self.number("Pm").filter(|&x| x > 0.0).unwrap_or(1.0).min(1.0) as f32,
                ior: ior_of_coat(),
            },
            false => MaterialKind::Metal { roughness: roughness.unwrap_or(unstated) as f32 },
        };
        let glass = || {
            let ior = ior.filter(|&ior| ior >= MIN_LENGTH).unwrap_or(IOR);
            MaterialKind::Glass { ior: ior as f32 }
        };
        let plastic = || {
            // Alpha is roughness squared. For a highlight with an exponent it is √(2 / (exponent + 2)):
            // Walter et al., "Microfacet Models for Refraction through Rough Surfaces", 2007, §5.
            let roughness = roughness.unwrap_or((2.0 / (exponent + 2.0)).sqrt().sqrt());
            MaterialKind::Plastic { roughness: roughness as f32, ior: ior_of_coat() }
        };
        match self.number("illum").map(|model| model as u32) {
            Some(3) => metal(0.0),
            Some(6 | 7) => glass(),
            Some(4 | 9) if self.is_clear() => glass(),
            _ if refracts && opacity.is_some_and(|opacity| opacity < CLEAR) => glass(),
            _ if self.maps.contains_key("map_Pm") => metal(0.5),
            _ if self.number("Pm").is_some_and(|metallic| metallic >= 0.5) => metal(0.5),
            _ if roughness.is_some() => plastic(),
            Some(2 | 4 | 9) | None if is_shiny => plastic(),
            _ => MaterialKind::Diffuse,
        }
    }

    /// Notes the statements that the material's kind cannot express.
    fn note_ignored(&self, notes: &mut Notes) {
        let (illumination, opacity) = (self.numbers.get("illum").copied(), self.opacity());
        let mut note = |line: usize, what: &str| notes.add(&line, what.to_string());
        if let Some(map) = self.maps.get("map_Ka")
            && self.maps.get("map_Kd").is_none_or(|other| other.file != map.file)
        {
            note(map.line, "`map_Ka` is not read");
        }
        let normals = ["norm", "map_Kn"].map(|key| self.maps.contains_key(key));
        if let Some(map) = self.maps.get(BUMP).filter(|_| normals.contains(&true)) {
            note(map.line, "`map_Bump` is left out beside a normal map");
        }
        if let MaterialKind::Glass { .. } = self.kind() {
            if let Some(&(_, line)) = self.numbers.get("Ni").filter(|&&(ior, _)| ior == 1.0) {
                note(line, "glass with `Ni 1` does not refract and is invisible");
            }
            let roughness = self.numbers.get("Pr").filter(|&&(roughness, _)| roughness > 0.0);
            let maps =
                ["map_Kd", "map_Pr", "map_Pm", "map_d"].map(|key| Some((key, self.maps.get(key)?.line)));
            for (key, line) in maps.into_iter().chain([roughness.map(|&(_, line)| ("Pr", line))]).flatten() {
                note(line, &format!("glass is shown without its `{key}`"));
            }
            return;
        }
        if let Some((_, line)) = opacity.filter(|&(opacity, _)| opacity <= 0.0) {
            note(line, "a material without opacity is invisible");
        }
        if let Some(&(filter, line)) = self.colors.get("Tf")
            && ![DVec3::ZERO, DVec3::ONE].contains(&filter)
        {
            note(line, "`Tf` is read only for glass");
        }
        let Some((model, line)) = illumination else { return };
        let reflects = self.color("Ks").is_some_and(|color| color != DVec3::ZERO);
        let is_lost = match self.kind() {
            MaterialKind::Diffuse if [4.0, 9.0].contains(&model) => reflects,
            MaterialKind::Diffuse | MaterialKind::Plastic { .. } => [5.0, 8.0].contains(&model),
            _ => false,
        };
        if is_lost {
            let what = format!("`illum {model}` is shown diffuse: a mirror is `illum 3`, glass `illum 7`");
            note(line, &what);
        } else if !(1.0..=9.0).contains(&model) {
            note(line, &format!("`illum {model}` is not read"));
        }
    }

    /// Adds the material to the builder. `obj` is the model that names the library at `path`.
    fn add(&self, obj: &Path, path: &Path, builder: &mut SceneBuilder) -> u32 {
        let [diffuse, specular, filter] = ["Kd", "Ks", "Tf"].map(|keyword| self.color(keyword));
        let color_map = self.maps.get("map_Kd");
        let diffuse = diffuse.filter(|&color| color_map.is_none() || color != DVec3::ZERO);
        let kind = self.kind();
        let color = match kind {
            MaterialKind::Glass { .. } => {
                filter.filter(|filter| filter.max_element() > 0.0).unwrap_or(DVec3::ONE)
            }
            MaterialKind::Metal { .. } => {
                let mirrored = specular.filter(|&color| color != DVec3::ZERO && self.number("Pm").is_none());
                mirrored.or(diffuse).unwrap_or(DVec3::ONE)
            }
            // A textured material without Kd shows its texture unchanged.
            _ => diffuse.unwrap_or(if color_map.is_some() { DVec3::ONE } else { DVec3::splat(0.8) }),
        };
        if color.max_element() > 1.0 {
            let what = format!("the colour of `{}` is above 1 and was clamped to 1", self.name);
            builder.notes.add(&self.line, what);
        }
        let material = Material::new(&self.name, kind, color.clamp(DVec3::ZERO, DVec3::ONE).as_vec3());
        let (material, uvs) = self.with_maps(material, [path, obj], builder);
        let number = builder.add_material(material, 1.0);
        builder.transform_uvs(number, uvs);
        number
    }

    /// Loads the maps that the material's kind has, and its emission. Returns the material, and the transform
    /// of its texture coordinates: that of its first map.
    fn with_maps(
        &self,
        material: Material,
        beside: [&Path; 2],
        builder: &mut SceneBuilder,
    ) -> (Material, UvTransform) {
        let kind = material.kind;
        let is_glass = matches!(kind, MaterialKind::Glass { .. });
        let is_packed = matches!(kind, MaterialKind::MetalRough { .. });
        let mut uvs = None;
        let mut map = |keyword, is_used| {
            let map = self.maps.get(keyword).filter(|_| is_used)?;
            if *uvs.get_or_insert(map.uvs) != map.uvs {
                let what =
                    "a texture is left out: its `-s` and `-o` are not those of the material's first one";
                builder.notes.add(&map.line, what);
                return None;
            }
            Some(map)
        };
        let texture = map("map_Kd", !is_glass);
        let (metallic, rough) = (map("map_Pm", is_packed), map("map_Pr", kind.has_roughness()));
        let normals = map("norm", true).or_else(|| map("map_Kn", true)).or_else(|| map(BUMP, true));
        let (glow, dissolve) = (map("map_Ke", true), map("map_d", !is_glass));
        // A map of emission without a colour, or with a black one beside it, shows its own colours.
        let emission = self.color("Ke").filter(|&color| glow.is_none() || color != DVec3::ZERO);
        let emission = emission.unwrap_or(if glow.is_some() { DVec3::ONE } else { DVec3::ZERO });
        let material = Material {
            texture: texture.and_then(|map| map.color(beside, builder)),
            roughness_map: match metallic {
                Some(metallic) => metallic.packed_with(rough, beside, builder),
                None => rough.and_then(|map| map.numbers(beside, builder)),
            },
            normal_map: normals.and_then(|map| map.normals(beside, builder)),
            emission_map: glow.and_then(|map| map.color(beside, builder)),
            ..material
        };
        let known = builder.textures.list.len();
        let opacity_map = dissolve.and_then(|map| map.opacity(beside, builder));
        let opacity_map = builder.opacity_map(opacity_map, known);
        let opacity =
            self.opacity().filter(|_| !is_glass).map_or(1.0, |(opacity, _)| opacity.clamp(0.0, 1.0));
        let material = Material { opacity: opacity as f32, opacity_map, ..material };
        // A missing file emits nothing.
        let is_dark = glow.is_some() && material.emission_map.is_none();
        let emission = if is_dark { self.color("Ke").unwrap_or_default() } else { emission };
        (Material { emission: emission.as_vec3(), ..material }, uvs.unwrap_or(UvTransform::IDENTITY))
    }
}
