//! The configurations of the renderer that a chart compares.
//!
//! For: [`Configuration`], [`of_scene`]. May import: `render`, `traverse`, `buffers`, `sampling`. Must not
//! know: clocks, errors.
//!
//! Each differs from the default in one setting, so that the chart shows the cost and the benefit of that
//! setting.

use crate::buffers::{Features, LightChoice};
use crate::render::{PipelineChoice, Renderer, Settings};
use crate::sampling::Sampler;
use crate::scene::Scene;
use crate::traverse::batch::Traversal;
use crate::traverse::{BoxChoice, Methods, SphereChoice, TraversalChoice, TriangleChoice, linear};

/// Settings under a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Configuration {
    /// The difference from the default.
    pub name: &'static str,
    pub settings: Settings,
    /// Whether sampling is adaptive.
    pub adaptive: bool,
    /// Whether pictures must have the bits of the default.
    pub same_bits: bool,
    /// Whether its intersection methods are the robust ones. A picture's error hardly shows it, so a
    /// configuration that is faster and not robust does not count as better.
    pub robust: bool,
}

/// The configuration with which all others are compared.
pub const DEFAULT: &str = "default";

/// All names, in the order of every chart.
pub const NAMES: [&str; 16] = [
    DEFAULT,
    "scalar",
    "general pipeline",
    "random numbers",
    "lights off",
    "lights on",
    "adaptive",
    "hierarchy",
    "every primitive tested",
    "streams",
    "packets",
    "single rays",
    "boxes without padding",
    "naive spheres",
    "Möller–Trumbore",
    "Baldwin–Weber",
];

/// Largest cost of testing every primitive that is charted, in sphere tests as [`linear::cost`]
/// counts.
const MOST_LINEAR: usize = 4_000;

/// The configurations that can differ on this scene, the default first. `settings` are those of the default.
pub fn of_scene(scene: &Scene, settings: Settings) -> Vec<Configuration> {
    let of = |name, settings: Settings, same_bits| {
        let robust = settings.methods.are_robust();
        Configuration { name, settings, adaptive: false, same_bits, robust }
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
    let renderer = Renderer::new(scene, settings);
    let general = Settings { pipeline: PipelineChoice::General, ..settings };
    add(renderer.features() != Features::ALL, of("general pipeline", general, true));
    add(true, with("random numbers", false, &|methods| methods.sampler = Sampler::Random));
    for (name, lights) in [("lights off", LightChoice::Off), ("lights on", LightChoice::On)] {
        let one = with(name, false, &|methods| methods.lights = lights);
        add(differs(scene, &renderer, one.settings), one);
    }
    add(true, Configuration { adaptive: true, ..of("adaptive", settings, false) });

    let hierarchy = settings.methods.traversal_of(scene, settings.lanes).is_some();
    let linear = linear::cost(scene) <= MOST_LINEAR;
    let through = |name, traversal| with(name, true, &|methods| methods.traversal = traversal);
    add(hierarchy && linear, through("every primitive tested", TraversalChoice::Linear));
    add(!hierarchy, through("hierarchy", TraversalChoice::Through(Traversal::Hybrid)));
    for (name, traversal) in
        [("streams", Traversal::Stream), ("packets", Traversal::Packet), ("single rays", Traversal::Single)]
    {
        add(hierarchy, through(name, TraversalChoice::Through(traversal)));
    }

    let methods_apply = linear && !hierarchy;
    add(hierarchy, with("boxes without padding", false, &|methods| methods.boxes = BoxChoice::Fma));
    let sphere = |sphere| with("naive spheres", false, &|methods: &mut Methods| methods.sphere = sphere);
    add(methods_apply && !scene.spheres.is_empty(), sphere(SphereChoice::Naive));
    for (name, triangle) in
        [("Möller–Trumbore", TriangleChoice::MollerTrumbore), ("Baldwin–Weber", TriangleChoice::BaldwinWeber)]
    {
        let one = with(name, false, &|methods| methods.triangle = triangle);
        add(methods_apply && !scene.triangles.is_empty(), one);
    }
    all
}

/// Whether these settings give another picture than the renderer: without emitters, light sampling changes
/// nothing.
fn differs(scene: &Scene, renderer: &Renderer, settings: Settings) -> bool {
    let first = |renderer: &Renderer| {
        let mut film = renderer.film();
        renderer.add_samples(&mut film, 1);
        film.picture()
    };
    first(renderer) != first(&Renderer::new(scene, settings))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(scene: &str) -> Vec<&'static str> {
        let scene = octray_formats::scene::load(scene).unwrap();
        let settings = Settings { resolution: [16, 9], ..Settings::of(&scene) };
        of_scene(&scene, settings).iter().map(|one| one.name).collect()
    }

    #[test]
    fn configurations_are_those_that_a_scene_can_tell_apart() {
        let three = names("builtin:three");
        assert_eq!(three[..3], [DEFAULT, "scalar", "general pipeline"]);
        for absent in ["lights off", "lights on", "Möller–Trumbore", "streams", "every primitive tested"] {
            assert!(!three.contains(&absent), "{absent}");
        }
        assert!(three.contains(&"naive spheres") && three.contains(&"hierarchy"));
        let cornell = names("builtin:cornell");
        assert!(cornell.contains(&"lights off") && cornell.contains(&"Baldwin–Weber"));
        assert!(
            !cornell.contains(&"naive spheres") && !cornell.contains(&"lights on"),
            "auto samples all emitters"
        );
        let all = three.iter().chain(&cornell);
        assert!(all.clone().all(|name| NAMES.contains(name)), "every configuration has a colour of its own");
        let terrain = names("builtin:terrain:2000");
        assert!(terrain.contains(&"streams") && !terrain.contains(&"every primitive tested"), "{terrain:?}");
    }
}
