//! The configurations of the renderer that a chart compares.
//!
//! Each differs from the default in one setting, whose cost and benefit the chart shows.

use crate::buffers::Features;
use crate::lane::WIDTHS;
use crate::lights::LightChoice;
use crate::methods;
use crate::rays::Traversal;
use crate::render::{PipelineChoice, Renderer, Settings, SphereChoice, TraversalChoice, TriangleChoice};
use crate::sampling::Sampler;
use crate::scene::{Filter, Scene};
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
}

impl Configuration {
    /// Tests whether pictures must have the bits of the default.
    pub(crate) fn has_same_bits(&self) -> bool {
        matches!(Group::of(self.name), None | Some(Group::Speed))
    }
    /// Tests whether its intersection methods are the robust ones. A picture's error hardly shows it, so a
    /// configuration that is faster and not robust does not count as better.
    pub(crate) fn is_robust(&self) -> bool {
        self.settings.methods.are_robust()
    }
    /// Returns a renderer of the scene with these settings but this resolution and number of threads.
    pub(crate) fn renderer(&self, scene: &Scene, resolution: [u32; 2], threads: usize) -> Renderer {
        let settings = Settings { resolution, threads, ..self.settings };
        if !self.levels_of_detail {
            return methods::renderer(scene, settings);
        }
        let mut scene = scene.clone();
        for texture in scene.textures.iter_mut().filter(|texture| texture.filter == Filter::Bilinear) {
            texture.filter = Filter::Trilinear;
        }
        methods::renderer(&scene, settings)
    }
}

/// The configuration with which all others are compared.
pub const DEFAULT: &str = "default";

/// Kinds of configurations; each is a panel of a drawing.
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
                "padded Sobol",
                "the errors of neighbouring pixels are independent, not blue noise: --sampler padded-sobol",
            ),
            ("adaptive", "more samples where the estimated error is larger: --target-error"),
            ("no next event estimation", "paths meet lights by scattering alone: --lights off"),
            ("all lights", "next event estimation of every emitter that can be sampled: --lights on"),
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
    /// Returns the group of a configuration; `None` for the default.
    pub fn of(configuration: &str) -> Option<Self> {
        let has = |named: &[(&str, &str)]| named.iter().any(|(name, _)| *name == configuration);
        GROUPS.into_iter().find(|(_, named)| has(named)).map(|(group, _)| group)
    }
}

/// Largest cost of testing every primitive that is charted, in sphere tests as `list_cost` counts.
const MOST_LINEAR: usize = 4_000;

/// Returns the configurations that can differ on this scene, first the default, which has these settings.
pub fn of_scene(scene: &Scene, settings: Settings) -> Vec<Configuration> {
    let default = Configuration { name: DEFAULT, settings, levels_of_detail: false, adaptive: false };
    let first_sample = |renderer: &Renderer| {
        let mut film = renderer.film();
        renderer.add_samples(&mut film, 1);
        film.picture()
    };
    let renderer = Renderer::new(scene, settings);
    let default_picture = first_sample(&renderer);
    let hierarchy = settings.methods.traversal_of(scene, settings.lanes).is_some();
    let linear = scene.counts().list_cost() <= MOST_LINEAR;

    let mut all = vec![default.clone()];
    let mut add = |name, applies: bool, change: &dyn Fn(&mut Configuration)| {
        let mut one = Configuration { name, ..default.clone() };
        change(&mut one);
        // Without emitters, light sampling changes nothing; without a texture in view, no filter does.
        let changes_nothing = Group::of(name) == Some(Group::Sampling)
            && !one.adaptive
            && first_sample(&one.renderer(scene, settings.resolution, settings.threads)) == default_picture;
        if applies && !changes_nothing {
            all.push(one);
        }
    };
    add("scalar", true, &|one| one.settings.lanes = 1);
    for (name, lanes) in [("16 lanes", 16), ("8 lanes", 8)] {
        let applies = WIDTHS.contains(&lanes) && lanes != settings.lanes;
        add(name, applies, &|one| one.settings.lanes = lanes);
    }
    let is_special = renderer.features() != Features::ALL;
    add("general pipeline", is_special, &|one| one.settings.pipeline = PipelineChoice::General);
    add("padded Sobol", true, &|one| one.settings.methods.sampler = Sampler::PaddedSobol);
    add("random numbers", true, &|one| one.settings.methods.sampler = Sampler::Random);
    add("no next event estimation", true, &|one| one.settings.methods.lights = LightChoice::Off);
    add("all lights", true, &|one| one.settings.methods.lights = LightChoice::On);
    add("lights by power", true, &|one| one.settings.methods.lights = LightChoice::Power);
    add("adaptive", true, &|one| one.adaptive = true);
    add("trilinear", true, &|one| one.levels_of_detail = true);

    let mut through = |name, applies, traversal| {
        add(name, applies, &|one| one.settings.methods.traversal = traversal);
    };
    through("every primitive tested", hierarchy && linear, TraversalChoice::Linear);
    through("hierarchy", !hierarchy, TraversalChoice::Through(Traversal::Hybrid));
    through("streams", hierarchy, TraversalChoice::Through(Traversal::Stream));
    through("packets", hierarchy, TraversalChoice::Through(Traversal::Packet));
    through("single rays", hierarchy, TraversalChoice::Through(Traversal::Single));

    let [spheres, triangles] = [scene.spheres.is_empty(), scene.triangles.is_empty()]
        .map(|is_empty| linear && !hierarchy && !is_empty);
    add("naive spheres", spheres, &|one| one.settings.methods.sphere = SphereChoice::Naive);
    let triangle = TriangleChoice::MollerTrumbore;
    add("Möller–Trumbore", triangles, &|one| one.settings.methods.triangle = triangle);
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lane::NATIVE_WIDTH;

    #[test]
    fn configurations_are_those_that_a_scene_can_tell_apart() {
        let load = |name: &str| octray_formats::scene::load(name).unwrap();
        let mut smooth = load("builtin:thesis");
        smooth.textures.iter_mut().for_each(|texture| texture.filter = Filter::Bilinear);
        let scenes: [(Scene, &[&str], &[&str]); 5] = [
            (
                load("builtin:three"),
                &["naive spheres", "hierarchy"],
                &["Möller–Trumbore", "streams", "all lights"],
            ),
            // Auto samples all emitters.
            (load("builtin:cornell"), &["no next event estimation"], &["naive spheres", "all lights"]),
            (load("builtin:terrain:2000"), &["streams"], &["every primitive tested"]),
            (smooth, &["trilinear"], &[]),
            // Its textures are read at the nearest texel.
            (load("builtin:thesis"), &[], &["trilinear"]),
        ];
        for (scene, present, absent) in &scenes {
            let settings = Settings { resolution: [16, 9], ..Settings::of(scene) };
            let names: Vec<_> = of_scene(scene, settings).iter().map(|one| one.name).collect();
            assert_eq!(names[..2], [DEFAULT, "scalar"]);
            assert_eq!(names.contains(&"8 lanes"), NATIVE_WIDTH > 8, "where 8 lanes are not the default");
            assert!(present.iter().all(|name| names.contains(name)), "{}: {names:?}", scene.name);
            assert!(!absent.iter().any(|name| names.contains(name)), "{}: {names:?}", scene.name);
            assert!(names.iter().all(|name| Group::of(name).is_none() == (*name == DEFAULT)), "{names:?}");
        }
    }
}
