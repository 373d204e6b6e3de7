//! Suggests names for misspelt ones.

/// Longest name that is compared, in bytes, because the time grows with the product of two lengths.
const LONGEST: usize = 200;

/// Returns the known name nearest to a misspelt one, if its distance is at most a third of the length. Else
/// returns the only known name that begins with this one (`rough`), holds it (`fov`), or begins it
/// (`roughness_of_metal`), unless this one is a single letter.
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

/// Returns the name that a word in lower case abbreviates, if it is the only one.
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

/// Names of keys and of types of materials in *Ray Tracing in One Weekend*, Mitsuba, pbrt, Blender and glTF,
/// as [`plain`] writes them, and our names for them. The first of ours that is known at a place is suggested.
const SYNONYMS: [(&str, &[&str]); 36] = [
    ("position location translation translate origin from pos", &["position", "center", "translate"]),
    ("toworld transform matrix", &["translate", "center", "position"]),
    ("rotation euler rotationeuler", &["rotate_degrees", "turn_degrees"]),
    ("lookfrom eye camerapos cameraposition", &["position"]),
    ("center centre point3", &["center", "position", "look_at"]),
    ("lookat target at lookto to direction", &["look_at"]),
    ("vfov fov fovy yfov angle", &["vertical_fov"]),
    ("vup viewup", &["up"]),
    ("aperture lensradius defocusangle", &["aperture_radius"]),
    ("fstop aperturefstop dof", &["f_number"]),
    ("focusdist focaldistance", &["focus_distance"]),
    ("focusobject focuspoint", &["focus_on"]),
    ("apertureblades bladecount", &["blades"]),
    ("orthographic orthographicscale orthoscale ymag", &["orthographic_height"]),
    ("imagesize size imagewidth imageheight width height aspectratio aspect film", &["resolution"]),
    ("depth maxdepth maxpathlength bounces", &["max_bounces"]),
    ("samplesperpixel samplecount numsamples pixelsamples spp", &["samples"]),
    ("background backgroundcolor environment envmap infinite", &["sky"]),
    ("objects shapes primitives hittables", &["spheres"]),
    ("bsdfs", &["materials"]),
    ("bsdf mat", &["material"]),
    ("albedo reflectance basecolor colour rgb kd diffuse diffusereflectance attenuation", &["color"]),
    ("r diameter", &["radius"]),
    ("fuzz fuzziness roughnessfactor", &["roughness"]),
    ("metalness", &["metallic"]),
    ("refidx refractionindex refractiveindex indexofrefraction eta intior", &["ior"]),
    (
        "emissive emit emits light diffuselight arealight radiance le power intensity strength",
        &["emission", "emitter"],
    ),
    ("transparency alpha dissolve d tr", &["opacity"]),
    ("alphamap alphatexture mapd mask transparencymap", &["opacity_map"]),
    ("image imagetexture bitmap filename file path map", &["texture", "model"]),
    ("bump bumpmap normaltexture", &["normal_map"]),
    ("lambertian lambert matte diffusebsdf diffusetransmission", &["diffuse"]),
    ("dielectric thindielectric transparent refractive glassbsdf roughdielectric", &["glass"]),
    ("conductor roughconductor mirror glossy glossybsdf specular chrome", &["metal"]),
    ("coateddiffuse roughplastic glossydiffuse phong blinnphong", &["plastic"]),
    ("principled principledbsdf disney pbr metallicroughness", &["metal-rough"]),
];

/// Other programs' keys, and what octray has in their place.
const INSTEAD: [(&str, &str); 6] = [
    ("lamps ambient", "`lights`, materials with `emission`, and `sky` are the light"),
    ("world", "`spheres`, `triangles` and `meshes` hold the objects, `sky` is the light around them"),
    (
        "quad quads box boxes cube plane planes rectangle disk cylinder",
        "write `triangles`, or name a model in `meshes`",
    ),
    (
        "time time0 time1 shutter shutteropen shutterclose motionblur center1 center2",
        "nothing moves in a picture",
    ),
    ("samples", "give samples as an option: octray render --samples N"),
    ("seed exposure tone threads sampler integrator", "that is an option: see octray render --help"),
];
/// Keys that other programs have at other places, and their place here.
const PLACES: [(&[&str], &str); 2] = [
    (&["resolution", "max_bounces", "sky", "materials", "spheres", "triangles", "meshes"], "of the scene"),
    (&["position", "look_at", "up", "vertical_fov", "f_number", "orthographic_height"], "of `camera`"),
];

/// Returns a name in lower case without signs.
fn plain(name: &str) -> String {
    name.chars().filter(char::is_ascii_alphanumeric).collect::<String>().to_ascii_lowercase()
}

/// Returns our names for another program's word.
fn meant_by<'a>(name: &str) -> impl Iterator<Item = &'a str> + use<'a> {
    let name = plain(name);
    let meant = SYNONYMS.iter().filter(move |(words, _)| words.split(' ').any(|word| word == name));
    meant.flat_map(|(_, ours)| *ours).copied()
}

/// Returns the beginning of a remedy: a question about the known name that may be meant, by another program's
/// word or by its spelling; empty if there is none.
pub fn did_you_mean(name: &str, known: &[&str]) -> String {
    let meant = meant_by(name).find(|ours| known.contains(ours));
    let meant = meant.or_else(|| nearest(name, known.iter().copied()));
    meant.map(|meant| format!("did you mean `{meant}`? ")).unwrap_or_default()
}

/// Returns the beginning of a remedy if no known name is meant: what octray has instead, or the place of the
/// key; empty if neither is known.
pub fn advice(name: &str) -> String {
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
