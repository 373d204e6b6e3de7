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
use super::notes::Notes;
use super::statements::{Statement, statements};
use glam::{DVec3, Vec3};
use octray_engine::scene::{Filter, MIN_LENGTH, Material, MaterialKind, TexelKind};
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// Loads the libraries that an OBJ file at `obj` names into the builder; returns each material's index. A
/// missing library or texture is a warning: the model's shape is visible without it.
pub fn load(
    libraries: &[String],
    obj: &Path,
    builder: &mut SceneBuilder,
) -> Result<HashMap<String, u32>, SceneError> {
    let mut numbers = HashMap::new();
    let mut seen = HashSet::new();
    // Each once, however often the model names it.
    for library in libraries.iter().filter(|library| seen.insert(*library)) {
        // One statement may name several libraries, or one whose name holds spaces.
        let whole = [library.as_str()];
        let names = if builder.files().exists(&obj.with_file_name(library)) {
            whole.to_vec()
        } else {
            library.split_whitespace().collect()
        };
        for name in names {
            let path = obj.with_file_name(name);
            match builder.files().read(&path) {
                Ok(text) => {
                    let entries = parse(&text, &path, &mut builder.notes)?;
                    builder.warn_of_notes(&path, ":");
                    for entry in entries {
                        let number = entry.add(name, &path, builder);
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

/// What is read of a statement.
enum Reads {
    /// A colour: one number for a grey, or three.
    Color,
    /// A filter colour, where it is three numbers.
    Filter,
    Number,
    /// An image file.
    Map,
    /// Nothing. A warning unless the number is 0.
    Layer,
    Nothing,
}

/// The statements that are known; all others give a warning.
const STATEMENTS: [(Reads, &[&str]); 6] = [
    (Reads::Color, &["Kd", "Ks", "Ke"]),
    (Reads::Filter, &["Tf"]),
    (Reads::Number, &["illum", "d", "Tr", "Ni", "Ns", "Pm", "Pr"]),
    (Reads::Map, &["map_Kd", "map_Pr", "norm", "map_Kn"]),
    (Reads::Layer, &["Pc", "Pcr", "Ps", "aniso", "anisor"]),
    (Reads::Nothing, &["Ka", "sharpness", "map_Ka"]),
];

/// Default index of refraction: window glass.
const IOR: f64 = 1.5;
/// A refractive material with an opacity below this is glass, and not a leaf or a curtain.
const CLEAR: f64 = 0.5;

/// A material: what its statements say, by their keywords.
#[derive(Default)]
struct Entry {
    name: String,
    colors: HashMap<&'static str, DVec3>,
    /// With the line of each.
    numbers: HashMap<&'static str, (f64, usize)>,
    maps: HashMap<&'static str, String>,
}

fn parse(text: &[u8], path: &Path, notes: &mut Notes) -> Result<Vec<Entry>, SceneError> {
    let mut entries: Vec<Entry> = Vec::new();
    for statement in statements(text, path) {
        let keyword = statement.keyword();
        if keyword == b"newmtl" {
            entries.push(Entry { name: statement.name(), ..Entry::default() });
            continue;
        }
        // Statements before the first `newmtl` are ignored.
        let Some(entry) = entries.last_mut() else { continue };
        let known = STATEMENTS.iter().find_map(|(reads, keywords)| {
            Some((*keywords.iter().find(|known| known.as_bytes() == keyword)?, reads))
        });
        match known {
            Some((keyword, Reads::Color)) => {
                entry.colors.insert(keyword, color(&statement)?);
            }
            Some((keyword, Reads::Filter)) => {
                entry.colors.extend(statement.numbers("a colour").map(|color| (keyword, DVec3::from(color))));
            }
            Some((keyword, Reads::Number)) => {
                entry.numbers.insert(keyword, (number(&statement)?, statement.line));
            }
            Some((keyword, Reads::Map)) => {
                entry.maps.extend(image_file(&statement, notes).map(|file| (keyword, file)));
            }
            Some((_, Reads::Layer)) if number(&statement).is_ok_and(|x| x == 0.0) => {}
            Some((_, Reads::Nothing)) => {}
            None if keyword.starts_with(b"#") => {}
            _ => {
                let keyword = String::from_utf8_lossy(keyword);
                notes.add(&statement.line, format!("`{keyword}` is not read"));
            }
        }
    }
    entries.iter().for_each(|entry| entry.note_ignored(notes));
    Ok(entries)
}

fn number(statement: &Statement) -> Result<f64, SceneError> {
    // `d -halo` varies the opacity with the angle; the base opacity follows.
    match statement.words().find(|word| word != b"-halo") {
        Some(word) => statement.number(word),
        None => Err(statement.fault("this statement needs 1 numbers", "write 1 numbers on this line")),
    }
}

fn color(statement: &Statement) -> Result<DVec3, SceneError> {
    let color = match statement.words().count() {
        1 => DVec3::splat(statement.numbers::<1>("a colour")?[0]),
        _ => DVec3::from(statement.numbers("a colour")?),
    };
    if color.min_element() < 0.0 {
        return Err(statement.fault("a colour is negative", "write numbers of 0 or more"));
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
fn image_file(statement: &Statement, notes: &mut Notes) -> Option<String> {
    let rest = statement.name();
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
            let keyword = String::from_utf8_lossy(statement.keyword());
            notes.add(&statement.line, format!("the option `{option}` of `{keyword}` is not read"));
        }
    }
    Some(rest.to_string()).filter(|rest| !rest.is_empty())
}

impl Entry {
    fn number(&self, keyword: &str) -> Option<f64> {
        self.numbers.get(keyword).map(|&(number, _)| number)
    }
    /// 1 is opaque, with the line that says so; `None` where neither `d` nor `Tr` does.
    fn opacity(&self) -> Option<(f64, usize)> {
        let transparency = self.numbers.get("Tr").filter(|&&(x, _)| x != 1.0);
        self.numbers.get("d").copied().or(transparency.map(|&(x, line)| (1.0 - x, line)))
    }
    /// By the table at the head of this file.
    fn kind(&self) -> MaterialKind {
        let opacity = self.opacity().map(|(opacity, _)| opacity);
        let ior = self.number("Ni");
        let refracts = ior.is_some_and(|ior| ior > 1.0);
        let exponent = self.number("Ns").unwrap_or(0.0);
        let is_shiny = self.colors.get("Ks").is_some_and(|&color| color != DVec3::ZERO) && exponent >= 1.0;
        let roughness = self.number("Pr").map(|x| x.clamp(0.0, 1.0));
        let roughness = roughness.or(self.maps.get("map_Pr").map(|_| 1.0));
        let metal = |unstated| MaterialKind::Metal { roughness: roughness.unwrap_or(unstated) as f32 };
        let glass = || {
            let ior = ior.filter(|&ior| ior >= MIN_LENGTH).unwrap_or(IOR);
            MaterialKind::Glass { ior: ior as f32 }
        };
        let plastic = || {
            // alpha is roughness squared.
            let roughness = roughness.unwrap_or((2.0 / (exponent + 2.0)).sqrt().sqrt());
            let ior = ior.filter(|&ior| ior > 1.0 && ior <= 3.0).unwrap_or(IOR);
            MaterialKind::Plastic { roughness: roughness as f32, ior: ior as f32 }
        };
        match self.number("illum").map(|model| model as u32) {
            Some(3) => metal(0.0),
            Some(6 | 7) => glass(),
            Some(4 | 9) if opacity.is_none_or(|opacity| opacity < 1.0) => glass(),
            _ if refracts && opacity.is_some_and(|opacity| opacity < CLEAR) => glass(),
            _ if self.number("Pm").is_some_and(|metallic| metallic >= 0.5) => metal(0.5),
            _ if roughness.is_some() => plastic(),
            Some(2) | None if is_shiny => plastic(),
            _ => MaterialKind::Diffuse,
        }
    }

    /// Notes statements about the material's kind that cannot be followed.
    fn note_ignored(&self, notes: &mut Notes) {
        let (illumination, opacity) = (self.numbers.get("illum").copied(), self.opacity());
        let mut note = |line: usize, what: &str| notes.add(&line, what.to_string());
        if let MaterialKind::Glass { .. } = self.kind() {
            if let Some(&(_, line)) = self.numbers.get("Ni").filter(|&&(ior, _)| ior == 1.0) {
                note(line, "glass with `Ni 1` does not refract and is invisible");
            }
            if self.maps.contains_key("map_Kd") {
                let line = illumination.or(opacity).map_or(1, |(_, line)| line);
                note(line, "glass is shown without its `map_Kd`");
            }
            return;
        }
        if let Some((_, line)) = opacity.filter(|&(opacity, _)| opacity < 1.0) {
            note(line, "a partly transparent material that is not glass is shown opaque");
        }
        if let (MaterialKind::Diffuse | MaterialKind::Plastic { .. }, Some((model, line))) =
            (self.kind(), illumination)
            && [4.0, 5.0, 8.0, 9.0].contains(&model)
        {
            let what = format!("`illum {model}` is shown diffuse: a mirror is `illum 3`, glass `illum 7`");
            note(line, &what);
        }
    }

    /// Adds the material to the builder. `library` is the MTL's name in the OBJ file, `path` the file that
    /// was found.
    fn add(&self, library: &str, path: &Path, builder: &mut SceneBuilder) -> u32 {
        let [diffuse, specular, filter] = ["Kd", "Ks", "Tf"].map(|keyword| self.colors.get(keyword).copied());
        let [color_map, roughness_map, norm, map_kn] =
            ["map_Kd", "map_Pr", "norm", "map_Kn"].map(|keyword| self.maps.get(keyword));
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
        let place = path.display();
        if color.max_element() > 1.0 {
            builder.warn(format!("{place}: the colour of `{}` is above 1 and was clamped to 1.", self.name));
        }
        let mut load = |image: Option<&String>, texel_kind| {
            let image = image?;
            let slashed = image.replace('\\', "/");
            let spelt = if builder.files().exists(&path.with_file_name(image)) { image } else { &slashed };
            let (file, shown) = (path.with_file_name(spelt), Path::new(library).with_file_name(spelt));
            let shown = shown.to_string_lossy();
            let loaded = builder.textures.load(&file, &shown, Filter::Bilinear, texel_kind);
            if let Err(reason) = &loaded {
                let name = &self.name;
                builder.warn(format!("{place}: the texture `{image}` of `{name}` is left out: {reason}."));
            }
            loaded.ok()
        };
        let is_glass = matches!(kind, MaterialKind::Glass { .. });
        let material = Material {
            texture: load(color_map.filter(|_| !is_glass), TexelKind::Color),
            roughness_map: load(roughness_map.filter(|_| kind.has_roughness()), TexelKind::Data),
            normal_map: load(norm.or(map_kn), TexelKind::Data),
            emission: self.colors.get("Ke").map_or(Vec3::ZERO, |emission| emission.as_vec3()),
            ..Material::new(&self.name, kind, color.clamp(DVec3::ZERO, DVec3::ONE).as_vec3())
        };
        builder.add_material(material, 1.0)
    }
}
