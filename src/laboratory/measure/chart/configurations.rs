//! The configurations of the renderer that a chart compares.
//!
//! For: [`Configuration`], [`of_scene`], [`Group`].
//!
//! Each differs from the default in one setting, so that the chart shows the cost and the benefit of that
//! setting.

use crate::buffers::{Features, LightChoice};
use crate::lane::WIDTHS;
use crate::render::{PipelineChoice, Renderer, Settings};
use crate::sampling::Sampler;
use crate::scene::{Filter, Scene};
use crate::traverse::batch::Traversal;
use crate::traverse::{Methods, SphereChoice, TraversalChoice, TriangleChoice, list_cost};
use serde::Serialize;

/// Settings under a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Configuration {
    /// The difference from the default.
    pub name: &'static str,
    /// All of them, the changed one included.
    pub(crate) settings: Settings,
    /// Whether textures have levels of detail: bilinear ones become trilinear.
    pub(crate) levels_of_detail: bool,
    /// Whether sampling is adaptive.
    pub(crate) adaptive: bool,
    /// Whether pictures must have the bits of the default.
    pub(crate) same_bits: bool,
    /// Whether its intersection methods are the robust ones. A picture's error hardly shows it, so a
    /// configuration that is faster and not robust does not count as better.
    pub(crate) robust: bool,
}

impl Configuration {
    /// A renderer of the scene with these settings but this resolution and number of threads.
    pub(crate) fn renderer(&self, scene: &Scene, resolution: [u32; 2], threads: usize) -> Renderer {
        let settings = Settings { resolution, threads, ..self.settings };
        if !self.levels_of_detail {
            return Renderer::new(scene, settings);
        }
        let mut scene = scene.clone();
        for texture in scene.textures.iter_mut().filter(|texture| texture.filter == Filter::Bilinear) {
            texture.filter = Filter::Trilinear;
        }
        Renderer::new(&scene, settings)
    }
}

/// The configuration with which all others are compared.
pub const DEFAULT: &str = "default";

/// What the configurations of a drawing have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Group {
    /// Other random numbers, estimators or filters: other pictures with the same mean, or nearly.
    Sampling,
    /// The default's picture, bit by bit, at another speed.
    Speed,
    /// Intersection methods that fail on difficult inputs.
    NotRobust,
}

/// All names but [`DEFAULT`], by group, in the order of every chart, each with what differs from the default
/// and the option that sets it.
pub const GROUPS: [(Group, &[(&str, &str)]); 3] = [
    (
        Group::Sampling,
        &[
            ("random numbers", "independent random numbers instead of Sobol points: --sampler random"),
            (
                "independent pixels",
                "the errors of neighbouring pixels are independent, not blue noise: --sampler padded-sobol",
            ),
            ("adaptive", "more samples where the estimated error is larger: --target-error"),
            ("lights off", "no next event estimation: --lights off"),
            ("lights on", "next event estimation of every emitter that can be sampled: --lights on"),
            ("lights by power", "emitters chosen by power alone, each triangle by itself: --lights power"),
            (
                "trilinear",
                "bilinear textures with levels of detail: the filter trilinear of a scene's textures",
            ),
        ],
    ),
    (
        Group::Speed,
        &[
            ("scalar", "one ray at a time, where there is a hierarchy through a binary tree: --lanes 1"),
            ("8 lanes", "packets of eight: --lanes 8"),
            ("16 lanes", "packets of sixteen: --lanes 16"),
            ("general pipeline", "compiled for every feature: --pipeline general"),
            ("hierarchy", "rays traverse a hierarchy of boxes: --traversal hybrid"),
            ("every primitive tested", "no hierarchy: --traversal linear"),
            ("streams", "all rays traverse the hierarchy in streams: --traversal stream"),
            (
                "packets",
                "camera rays traverse the hierarchy in packets wherever they can, others in streams: \
                 --traversal packet",
            ),
            ("single rays", "each ray traverses the hierarchy alone: --traversal single"),
        ],
    ),
    (
        Group::NotRobust,
        &[
            ("naive spheres", "loses digits on small, distant and huge spheres: --sphere naive"),
            ("Möller–Trumbore", "leaks at edges and vertices of triangles: --triangle moller-trumbore"),
        ],
    ),
];

impl Group {
    /// The group of a configuration; `None` for the default.
    pub fn of(configuration: &str) -> Option<Self> {
        let has = |named: &[(&str, &str)]| named.iter().any(|(name, _)| *name == configuration);
        GROUPS.into_iter().find(|(_, named)| has(named)).map(|(group, _)| group)
    }
}

/// Largest cost of testing every primitive that is charted, in sphere tests as [`list_cost`]
/// counts.
const MOST_LINEAR: usize = 4_000;

/// The configurations that can differ on this scene, the default first. `settings` are those of the default.
pub fn of_scene(scene: &Scene, settings: Settings) -> Vec<Configuration> {
    let of = |name, settings: Settings, same_bits| {
        let robust = settings.methods.keep_to_their_primitives();
        Configuration { name, settings, levels_of_detail: false, adaptive: false, same_bits, robust }
    };
    let with = |name, same_bits, change: &dyn Fn(&mut Methods)| {
        let mut methods = settings.methods;
        change(&mut methods);
        of(name, Settings { methods, ..settings }, same_bits)
    };
    let mut all = vec![of(DEFAULT, settings, true)];
    let mut add = |applies: bool, one: Configuration| {
        if applies {
            all.push(one);
        }
    };
    add(true, of("scalar", Settings { lanes: 1, ..settings }, true));
    for lanes in WIDTHS.into_iter().rev().filter(|&lanes| lanes > 1) {
        let name = if lanes == 8 { "8 lanes" } else { "16 lanes" };
        add(lanes != settings.lanes, of(name, Settings { lanes, ..settings }, true));
    }
    let renderer = Renderer::new(scene, settings);
    let general = Settings { pipeline: PipelineChoice::General, ..settings };
    add(renderer.features() != Features::ALL, of("general pipeline", general, true));
    add(true, with("independent pixels", false, &|methods| methods.sampler = Sampler::PaddedSobol));
    add(true, with("random numbers", false, &|methods| methods.sampler = Sampler::Random));
    for (name, lights) in [
        ("lights off", LightChoice::Off),
        ("lights on", LightChoice::On),
        ("lights by power", LightChoice::Power),
    ] {
        let one = with(name, false, &|methods| methods.lights = lights);
        add(differs(scene, &renderer, &one), one);
    }
    add(true, Configuration { adaptive: true, ..of("adaptive", settings, false) });
    let trilinear = Configuration { levels_of_detail: true, ..of("trilinear", settings, false) };
    let has_bilinear = scene.textures.iter().any(|texture| texture.filter == Filter::Bilinear);
    add(has_bilinear && differs(scene, &renderer, &trilinear), trilinear);

    let hierarchy = settings.methods.traversal_of(scene, settings.lanes).is_some();
    let linear = list_cost(scene) <= MOST_LINEAR;
    let through = |name, traversal| with(name, true, &|methods| methods.traversal = traversal);
    add(hierarchy && linear, through("every primitive tested", TraversalChoice::Linear));
    add(!hierarchy, through("hierarchy", TraversalChoice::Through(Traversal::Hybrid)));
    for (name, traversal) in
        [("streams", Traversal::Stream), ("packets", Traversal::Packet), ("single rays", Traversal::Single)]
    {
        add(hierarchy, through(name, TraversalChoice::Through(traversal)));
    }

    let methods_apply = linear && !hierarchy;
    let sphere = |sphere| with("naive spheres", false, &|methods: &mut Methods| methods.sphere = sphere);
    add(methods_apply && !scene.spheres.is_empty(), sphere(SphereChoice::Naive));
    let triangle =
        |triangle| with("Möller–Trumbore", false, &|methods: &mut Methods| methods.triangle = triangle);
    add(methods_apply && !scene.triangles.is_empty(), triangle(TriangleChoice::MollerTrumbore));
    all
}

/// Whether a configuration gives another picture than the default's renderer: without emitters, light
/// sampling changes nothing; without a texture in view, no filter does.
fn differs(scene: &Scene, renderer: &Renderer, one: &Configuration) -> bool {
    let first = |renderer: &Renderer| {
        let mut film = renderer.film();
        renderer.add_samples(&mut film, 1);
        film.picture()
    };
    let Settings { resolution, threads, .. } = one.settings;
    first(renderer) != first(&one.renderer(scene, resolution, threads))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lane::NATIVE_WIDTH;

    fn names(scene: &str) -> Vec<&'static str> {
        names_of(&octray_formats::scene::load(scene).unwrap())
    }

    fn names_of(scene: &Scene) -> Vec<&'static str> {
        let settings = Settings { resolution: [16, 9], ..Settings::of(scene) };
        of_scene(scene, settings).iter().map(|one| one.name).collect()
    }

    #[test]
    fn configurations_are_those_that_a_scene_can_tell_apart() {
        let three = names("builtin:three");
        assert_eq!(three[..2], [DEFAULT, "scalar"]);
        assert_eq!(three.contains(&"8 lanes"), NATIVE_WIDTH > 8, "where 8 lanes are not the default");
        for absent in [
            "lights off",
            "lights on",
            "lights by power",
            "Möller–Trumbore",
            "streams",
            "every primitive tested",
        ] {
            assert!(!three.contains(&absent), "{absent}");
        }
        assert!(three.contains(&"naive spheres") && three.contains(&"hierarchy"));
        let cornell = names("builtin:cornell");
        for present in ["lights off", "lights by power", "Möller–Trumbore"] {
            assert!(cornell.contains(&present), "{present}");
        }
        assert!(
            !cornell.contains(&"naive spheres") && !cornell.contains(&"lights on"),
            "auto samples all emitters"
        );
        let terrain = names("builtin:terrain:2000");
        assert!(terrain.contains(&"streams") && !terrain.contains(&"every primitive tested"), "{terrain:?}");
        assert_eq!(terrain.contains(&"8 lanes"), NATIVE_WIDTH > 8, "where 8 lanes are not the default");
        let mut thesis = octray_formats::scene::load("builtin:thesis").unwrap();
        assert!(!names_of(&thesis).contains(&"trilinear"), "its textures are read at the nearest texel");
        thesis.textures.iter_mut().for_each(|texture| texture.filter = Filter::Bilinear);
        assert!(names_of(&thesis).contains(&"trilinear"));
        let thesis = names_of(&thesis);
        for name in three.iter().chain(&cornell).chain(&terrain).chain(&thesis) {
            assert_eq!(Group::of(name).is_none(), *name == DEFAULT, "{name} is in a drawing");
        }
    }
}
