//! Suggestions for misspelt names.

/// Longest name that is compared, in bytes: the time grows with the product of two lengths.
const LONGEST: usize = 200;

/// The known name nearest to a misspelt one, if any is within a third of its length; else the one known name
/// that a word of two letters or more abbreviates: that begins with it (`rough`), holds it (`fov`), or begins
/// what is written (`roughness_of_metal`).
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    if name.len() > LONGEST {
        return None;
    }
    let name = name.to_lowercase();
    let known: Vec<&str> = known.into_iter().filter(|known| known.len() <= LONGEST).collect();
    let limit = (name.chars().count() / 3).max(1);
    let near = known.iter().map(|&known| (strsim::levenshtein(&name, &known.to_lowercase()), known));
    let near = near.filter(|&(distance, _)| distance <= limit).min_by_key(|&(distance, _)| distance);
    near.map(|(_, known)| known).or_else(|| abbreviated(&name, &known))
}

/// The name that a word in small letters abbreviates, if it is the only one.
fn abbreviated<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    if name.chars().count() < 2 {
        return None;
    }
    let rules: [fn(&str, &str) -> bool; 3] = [
        |name, known| known.starts_with(name),
        |name, known| known.contains(name),
        |name, known| known.len() > 2 && name.starts_with(known),
    ];
    rules.iter().find_map(|rule| {
        let mut fitting = known.iter().filter(|known| rule(name, &known.to_lowercase()));
        fitting.next().filter(|_| fitting.next().is_none()).copied()
    })
}

/// What keys and types of materials are called in *Ray Tracing in One Weekend*, Mitsuba, pbrt, Blender and
/// glTF, in small letters without signs between them. The first of our names that is known where the word
/// stands is meant.
const SYNONYMS: [(&str, &[&str]); 28] = [
    ("position location translation translate origin from pos", &["position", "center", "translate"]),
    ("toworld transform matrix", &["translate", "center", "position"]),
    ("rotation euler rotationeuler", &["rotate_degrees", "turn_degrees"]),
    ("lookfrom eye camerapos cameraposition", &["position"]),
    ("center centre point3", &["center", "position", "look_at"]),
    ("lookat target at lookto to direction", &["look_at"]),
    ("vfov fov fovy yfov angle", &["vertical_fov"]),
    ("vup viewup", &["up"]),
    ("imagesize size imagewidth imageheight width height aspectratio aspect film", &["resolution"]),
    ("depth maxdepth maxpathlength bounces", &["max_bounces"]),
    ("samplesperpixel samplecount numsamples pixelsamples spp", &["samples"]),
    ("background backgroundcolor environment envmap infinite", &["sky"]),
    ("objects shapes primitives hittables", &["spheres"]),
    ("bsdfs", &["materials"]),
    ("bsdf mat", &["material"]),
    ("albedo reflectance basecolor colour rgb kd diffuse diffusereflectance attenuation", &["color"]),
    ("r diameter", &["radius"]),
    ("fuzz fuzziness alpha roughnessfactor", &["roughness"]),
    ("metalness", &["metallic"]),
    ("refidx refractionindex refractiveindex indexofrefraction eta intior", &["ior"]),
    (
        "emissive emit emits light diffuselight arealight radiance le power intensity strength",
        &["emission", "emitter"],
    ),
    ("image imagetexture bitmap filename file path map", &["texture", "model"]),
    ("bump bumpmap normaltexture", &["normal_map"]),
    ("lambertian lambert matte diffusebsdf diffusetransmission", &["diffuse"]),
    ("dielectric thindielectric transparent refractive glassbsdf roughdielectric", &["glass"]),
    ("conductor roughconductor mirror glossy glossybsdf specular chrome", &["metal"]),
    ("coateddiffuse roughplastic glossydiffuse phong blinnphong", &["plastic"]),
    ("principled principledbsdf disney pbr metallicroughness", &["metal-rough"]),
];

/// What octray has in place of other programs' keys, or of its own names that stand elsewhere.
const INSTEAD: [(&str, &str); 8] = [
    ("lights lamps ambient", "materials with `emission` are the lights, and `sky`"),
    ("world", "`spheres`, `triangles` and `meshes` hold the objects, `sky` is the light around them"),
    (
        "quad quads box boxes cube plane planes rectangle disk cylinder",
        "write `triangles`, or name a model in `meshes`",
    ),
    (
        "defocusangle focusdist focusdistance focaldistance aperture apertureradius lensradius fstop dof",
        "the camera is a pinhole, all is in focus; scenes/book/README.md shows how frames make a lens",
    ),
    (
        "time time0 time1 shutter shutteropen shutterclose motionblur center1 center2",
        "nothing moves in a picture",
    ),
    ("opacity transparency transmission", "the type `glass` lets light through"),
    ("samples", "give samples as an option: octray render --samples N"),
    ("seed exposure tone threads sampler integrator", "that is an option: see octray render --help"),
];
/// Keys that other programs write elsewhere, and where they stand.
const PLACES: [(&[&str], &str); 2] = [
    (&["resolution", "max_bounces", "sky", "materials", "spheres", "triangles", "meshes"], "of the scene"),
    (&["position", "look_at", "up", "vertical_fov"], "of `camera`"),
];

/// In small letters without signs between them.
fn plain(name: &str) -> String {
    name.chars().filter(char::is_ascii_alphanumeric).collect::<String>().to_ascii_lowercase()
}

/// Our names for another program's word.
fn meant_by<'a>(name: &str) -> impl Iterator<Item = &'a str> + use<'a> {
    let name = plain(name);
    let meant = SYNONYMS.iter().filter(move |(words, _)| words.split(' ').any(|word| word == name));
    meant.flat_map(|(_, ours)| *ours).copied()
}

/// The beginning of a remedy: the known name that may be meant, by another program's word or by its spelling;
/// empty if there is none.
pub fn did_you_mean(name: &str, known: &[&str]) -> String {
    let meant = meant_by(name).find(|ours| known.contains(ours));
    let meant = meant.or_else(|| nearest(name, known.iter().copied()));
    meant.map(|meant| format!("did you mean `{meant}`? ")).unwrap_or_default()
}

/// The same where no known name is meant: what octray has instead, or the place of the key; empty if unknown.
pub fn instead(name: &str) -> String {
    let plain = plain(name);
    let meant: Vec<&str> = meant_by(name).chain([name, &plain]).collect();
    let said = INSTEAD.iter().find(|(words, _)| words.split(' ').any(|word| meant.contains(&word)));
    if let Some((_, sentence)) = said {
        return format!("{sentence}; ");
    }
    let place = |(keys, place): &(&[&str], _)| {
        let ours = keys.iter().find(|key| meant.contains(key))?;
        Some(format!("did you mean `{ours}` {place}? "))
    };
    PLACES.iter().find_map(place).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_finds_what_a_word_abbreviates_unless_it_could_be_two() {
        let known = ["roughness", "vertical_fov", "texture", "texture_size", "translate"];
        for (name, wanted) in [
            ("rough", "roughness"),
            ("FOV", "vertical_fov"),
            ("roughness_of_metal", "roughness"),
            ("trans", "translate"),
        ] {
            assert_eq!(nearest(name, known), Some(wanted), "{name}");
        }
        assert_eq!([nearest("te", known), nearest("t", known), nearest("size_of", known)], [None; 3]);
    }
}
