//! How one pixel comes to be: path tracing in f64, from the camera ray to the film. Read it from the top.
//!
//! # The equations
//! The radiance L that leaves a point x in direction ω obeys the *rendering equation* (Kajiya, SIGGRAPH
//! 1986), with Lₑ the emitted radiance, f the BSDF, and x′ what the ray from x along ω′ hits:
//!
//! ```text
//! L(x, ω) = Lₑ(x, ω) + ∫ f(ω, ω′) L(x′, −ω′) |cos θ′| dω′
//! ```
//!
//! The *Monte Carlo estimator* of the integral over all directions is f L |cos θ′| / p for one random
//! direction of density (pdf) p; its mean is the integral. L at x′ is estimated in the same way, and so on:
//! that is a path. The product of its factors f |cos θ′| / p so far is the *throughput* β. The path's
//! radiance is the sum of β Lₑ over its vertices, and the pixel is the mean of such sums.
//!
//! # From ray to film
//! The engine takes the same steps in `src/engine/integrate`, each for all paths of a tile before the next
//! begins, with the equations of `src/engine/kernel`. Steps 1 to 5 are [`Reference::vertices`].
//!
//! | step | here | the engine's stage |
//! |---|---|---|
//! | 1. a ray through random points of the pixel (box filter) and the lens | [`Reference::camera_ray`] | generate: `generate.rs` |
//! | 2. the nearest hit x′ that stops the ray (opacity); on a miss, β · the sky, and the end | [`Reference::closest`] | trace: `intersect.rs`, `opacity.rs` |
//! | 3. point, normals and textures at x′ | `geometry`, `texture` | shade: `surface.rs`, `material.rs` |
//! | 4. β Lₑ joins the radiance | | shade: `emission.rs` |
//! | 5. ω′, by *importance sampling* of the BSDF; β · f \|cos θ′\| / p; the next ray | `lobes` | shade: `bsdf.rs` |
//! | – a light is sampled and tested: *next event estimation* | `lights` | shadow rays: `shadow_rays.rs` |
//! | 6. the mean over samples | [`Reference::pixel`] | finish: `film` |
//!
//! Here a path finds lights by scattering alone: the simplest estimator is the judge. Points, spots and
//! directional lights without a disc, which no ray hits, add up at every vertex. The engine samples lights,
//! and weighs the two techniques by *multiple importance sampling* with the power heuristic (Veach, Guibas,
//! SIGGRAPH 1995): other noise, the same mean. Paths end after `max_bounces` events, and not
//! before by *Russian roulette*. `octray inspect SCENE --pixel X,Y` prints a path, of this file and of the
//! engine, on the same random numbers.

use super::geometry::{Hit, Reference, Surface};
use super::{lobes, rough_glass, texture, values};
use crate::path_vertex::{PathVertex, lobe};
use crate::sampling::dimension::{LENS, LOBE, PIXEL, bounce};
use crate::sampling::random::hit_number;
use crate::sampling::{PixelCoordinates, SampleValues, Sampler};
use crate::scene::{Material, MaterialKind, Side, Sky};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// The inputs of a path besides the scene, the pixel and the sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathSettings {
    /// Pixels: width, height.
    pub resolution: [u32; 2],
    /// Scattering events allowed on a path.
    pub max_bounces: u32,
    /// Of the sample values, as in the engine.
    pub seed: u32,
    /// The sampler that the engine renders with: the same values give the same paths.
    pub sampler: Sampler,
}

/// Offset of a scattered ray's origin along the normal, relative to [`Surface::scale`]: some thousand times
/// the error of the point (a few 2⁻⁵³), and far below the resolution of single precision.
const ORIGIN_OFFSET: f64 = 1e-12;

/// A ray cone meets surfaces at no smaller cosine.
const LEAST_COSINE: f64 = 1e-3;
/// What the widest lobe adds to the angle of a ray cone, as in the engine.
const LOBE_ANGLE: f64 = 0.375;

impl Reference {
    /// The average of the pixel's samples 0 to `samples` − 1, in linear RGB; black without samples.
    pub fn pixel(&self, settings: PathSettings, x: u32, y: u32, samples: u32) -> [f64; 3] {
        let sum: DVec3 =
            (0..samples).map(|sample| DVec3::from_array(self.path(settings, x, y, sample))).sum();
        (sum / f64::from(samples.max(1))).to_array()
    }

    /// The radiance that sample `sample` of pixel (x, y) carries, in linear RGB.
    pub fn path(&self, settings: PathSettings, x: u32, y: u32, sample: u32) -> [f64; 3] {
        self.vertices(settings, x, y, sample).last().map_or([0.0; 3], |vertex| vertex.radiance)
    }

    /// The path of that sample: the end of each segment, and the radiance up to there.
    pub fn vertices(&self, settings: PathSettings, x: u32, y: u32, sample: u32) -> Vec<PathVertex<f64>> {
        let key = settings.sampler.key::<u32>(settings.seed, y * settings.resolution[0] + x, sample);
        let numbers = |first| numbers(settings, key, [x, y], sample, first);
        // 1. The camera ray.
        let (first, [x, y]) = (numbers(PIXEL), [x, y].map(f64::from));
        let (on_film, on_lens) = ([x + first(0), y + first(1)], [first(LENS), first(LENS + 1)]);
        let (mut origin, mut direction) = self.camera_ray(settings.resolution, on_film, on_lens);
        let (mut throughput, mut radiance) = (DVec3::ONE, DVec3::ZERO);
        let mut vertices = Vec::new();
        let (mut width, mut cone_angle) = self.camera_cone(settings.resolution[1]);
        for b in 0..=settings.max_bounces {
            // 2. The nearest hit.
            let vertex = PathVertex { throughput: throughput.into(), ..PathVertex::default() };
            let passing = |hit| f64::from(hit_number(key, sample, b, hit));
            let Some(hit) = self.first_stop((origin, direction), (width, cone_angle), passing) else {
                let emitted = throughput * (self.sky(direction, cone_angle) + self.suns(direction));
                radiance += emitted;
                vertices.push(PathVertex { emitted: emitted.into(), radiance: radiance.into(), ..vertex });
                break;
            };
            // 3. The surface and its material.
            let primitive = self.primitive(hit.primitive).expect("the primitive that was hit");
            let surface = primitive.surface(origin + direction * hit.t, hit.u, hit.v);
            let material = &self.materials[surface.material];
            let cosine = -direction.dot(surface.ng);
            width += cone_angle * hit.t;
            // The longer side of what the cone covers.
            let length = width / cosine.abs().max(LEAST_COSINE);
            let area = width * length * surface.density;
            let texel = self.lookup(material.texture, surface.uv, surface.wraps, area);
            let (kind, roughness) = self.mapped_kind(material, &surface, area);
            let normals = self.facing_normals(material, &surface, area, direction);
            if cosine < 0.0 {
                throughput *= rough_glass::left_after(hit.t, &material.extras);
            }
            // 4. Emission.
            let emitted = throughput * self.emission(material, &surface, area);
            radiance += emitted;
            vertices.push(PathVertex {
                primitive: Some(hit.primitive),
                distance: hit.t,
                point: surface.point.into(),
                normal: normals.ns_diffuse.into(),
                emitted: emitted.into(),
                radiance: radiance.into(),
                ..vertex
            });
            if b == settings.max_bounces {
                break;
            }
            // 5. The scattered ray.
            let color = material.color.as_dvec3() * texel;
            let (numbers, extras) = (numbers(bounce(b)), &material.extras);
            let (kind, color, rest) = rough_glass::part(kind, extras, color, numbers(LOBE));
            let number = |dimension| if dimension == LOBE { rest } else { numbers(dimension) };
            let (d, normals) = (direction, &normals);
            let event = lobes::Event { d, normals, number: &number, given: None, extras };
            let leave = |is_delta, side| leaving_point(&surface, kind, normals.ng, is_delta, side);
            if !self.lights.is_empty() {
                let value = |w| values::value(kind, roughness, color, event, w);
                let from = |side| leave(false, side);
                let light = throughput * self.direct_light(kind, normals.ng, from, value);
                radiance += light;
                let vertex = &mut vertices[b as usize];
                (vertex.light, vertex.radiance) = (Some(light.into()), radiance.into());
            }
            let sample = lobes::sample(kind, roughness, color, event);
            let sample = sample.filter(|(_, weight, _)| throughput * *weight != DVec3::ZERO);
            let Some((scattered, weight, is_delta)) = sample else { break };
            throughput *= weight;
            let spread = if is_delta { 0.0 } else { LOBE_ANGLE * lobes::width(kind, roughness) };
            // Refraction at a sphere bends otherwise.
            let bend = if lobes::is_glass(kind) { 0.0 } else { 2.0 * surface.curvature.copysign(cosine) };
            cone_angle = (cone_angle + bend * length + spread).clamp(-1.0, 1.0);
            direction = scattered.normalize();
            vertices[b as usize].lobe = Some(lobe(is_delta, direction.dot(normals.ns_diffuse)));
            origin = leave(is_delta, 1.0_f64.copysign(direction.dot(normals.ng)));
        }
        vertices
    }

    /// Returns the first hit of a ray that stops it: its random number, by [`hit_number`], is below the
    /// opacity. `cone` is the ray cone at the origin: its width and its angle.
    fn first_stop(
        &self,
        (origin, direction): (DVec3, DVec3),
        cone: (f64, f64),
        number: impl Fn(u32) -> f64,
    ) -> Option<Hit> {
        if self.materials.iter().all(Material::is_opaque) {
            return self.closest(origin, direction);
        }
        let layers = self.layers((origin, direction), cone);
        layers.into_iter().find(|&(_, event, opacity)| number(event) < opacity).map(|(hit, ..)| hit)
    }

    /// Returns the share of light that is left at a distance along a ray. Maps have their finest texels.
    pub(super) fn left(&self, origin: DVec3, direction: DVec3, distance: f64) -> f64 {
        if self.materials.iter().all(Material::is_opaque) {
            let is_free = self.closest(origin, direction).is_none_or(|hit| hit.t >= distance);
            return f64::from(u8::from(is_free));
        }
        let layers = self.layers((origin, direction), (0.0, 0.0)).into_iter();
        layers.filter(|(hit, ..)| hit.t < distance).map(|(.., opacity)| 1.0 - opacity).product()
    }

    /// Returns all hits of a ray, the nearest first, with a number for the event and the opacity of each. The
    /// two hits of a sphere are two events.
    fn layers(&self, (origin, direction): (DVec3, DVec3), cone: (f64, f64)) -> Vec<(Hit, u32, f64)> {
        let all = (0..).map_while(|number| Some((number, self.primitive(number)?)));
        let layers = all.flat_map(|(primitive, shape)| {
            shape.hits(origin, direction).into_iter().map(move |(t, u, v)| {
                let surface = shape.surface(origin + direction * t, u, v);
                let cosine = -direction.dot(surface.ng);
                let width = cone.0 + cone.1 * t;
                let area = width * width / cosine.abs().max(LEAST_COSINE) * surface.density;
                let opacity = self.opacity(&self.materials[surface.material], &surface, area);
                (Hit { primitive, t, u, v }, 2 * primitive + u32::from(cosine < 0.0), opacity)
            })
        });
        let mut layers: Vec<_> = layers.collect();
        // Of equal t, the lower index stays first.
        layers.sort_by(|a, b| a.0.t.total_cmp(&b.0.t));
        layers
    }

    /// Returns the share of rays that a surface stops.
    fn opacity(&self, material: &Material, surface: &Surface, area: f64) -> f64 {
        if material.is_opaque() {
            return 1.0;
        }
        let texel = self.lookup(material.opacity_map, surface.uv, surface.wraps, area).x.min(1.0);
        let opacity = f64::from(material.opacity) * texel;
        match material.alpha_cutoff.filter(|_| material.opacity_map.is_some()) {
            Some(cutoff) if opacity < f64::from(cutoff) => 0.0,
            Some(_) => 1.0,
            None => opacity,
        }
    }

    /// Returns the emitted radiance.
    fn emission(&self, material: &Material, surface: &Surface, area: f64) -> DVec3 {
        let is_emitter = material.kind == MaterialKind::Emitter;
        let map = if is_emitter { material.texture } else { material.emission_map };
        material.emission.as_dvec3() * self.lookup(map, surface.uv, surface.wraps, area)
    }

    /// Returns the kind of material, and the factor of its roughness, that the roughness map gives.
    fn mapped_kind(&self, material: &Material, surface: &Surface, area: f64) -> (MaterialKind, f64) {
        let map = self.lookup(material.roughness_map, surface.uv, surface.wraps, area).min(DVec3::ONE);
        match material.kind {
            MaterialKind::MetalRough { roughness, metallic, ior } => {
                let metallic = (f64::from(metallic) * map.z) as f32;
                (MaterialKind::MetalRough { roughness, metallic, ior }, map.y)
            }
            kind => (kind, map.x),
        }
    }

    /// Returns the normals of a surface, with those of maps, on the side of a ray in direction `d`.
    fn facing_normals(&self, material: &Material, surface: &Surface, area: f64, d: DVec3) -> lobes::Normals {
        let ns = self.mapped_normal(material.normal_map, surface, area).or(surface.ns);
        lobes::Normals::facing(d, surface.ng, ns, surface.ns)
    }

    /// The shading normal of a normal map, on the outward side; `None` without a map or a tangent.
    fn mapped_normal(&self, map: Option<u32>, surface: &Surface, area: f64) -> Option<DVec3> {
        let texel = self.lookup(Some(map?), surface.uv, surface.wraps, area);
        let around = surface.ns.unwrap_or(surface.ng);
        let right = surface.right - around * surface.right.dot(around);
        if right.length() < 0.01 {
            return None;
        }
        let right = right.normalize();
        let up = around.cross(right) * surface.hand;
        let [x, y, z] = (texel * 2.0 - 1.0).to_array();
        let normal = right * x + up * y + around * z.max(0.0);
        (normal.length() > 0.01).then(|| normal.normalize())
    }

    /// The radiance of the sky in the unit direction `d`, in a cone of the angle `cone_angle`.
    fn sky(&self, d: DVec3, cone_angle: f64) -> DVec3 {
        match self.sky {
            Sky::Color(color) => color.as_dvec3(),
            Sky::Gradient { bottom, top } => bottom.as_dvec3().lerp(top.as_dvec3(), 0.5 * (d.y + 1.0)),
            Sky::Texture { texture, color, turn } => {
                let at = texture::on_sphere(d, f64::from(turn), Side::Inside);
                let area = cone_angle * cone_angle / (TAU * PI * d.x.hypot(d.z));
                color.as_dvec3() * self.lookup(Some(texture), at, false, area)
            }
        }
    }
}

/// Returns the function from dimensions to the numbers of a sample with this key, in [0, 1), for the event
/// that begins at dimension `first`.
fn numbers(
    settings: PathSettings,
    key: u32,
    [x, y]: [u32; 2],
    sample: u32,
    first: u32,
) -> impl Fn(u32) -> f64 {
    let numbers = SampleValues::new(settings.sampler, settings.seed, sample, first);
    move |dimension| {
        let numbers = match first < bounce(1) {
            true => numbers.at_pixels::<f32>(key, PixelCoordinates::Block { x, y }),
            false => numbers.at_keys(key),
        };
        f64::from(numbers.get_1d(dimension))
    }
}

/// Returns the origin of a ray that leaves a surface on a side of its normal; a ray by a delta lobe, or at
/// glass, leaves the flat triangle.
fn leaving_point(surface: &Surface, kind: MaterialKind, ng: DVec3, is_delta: bool, side: f64) -> DVec3 {
    let is_flat = is_delta || lobes::is_glass(kind);
    let bulge = if is_flat { DVec3::ZERO } else { surface.bulge[usize::from(ng != surface.ng)] };
    surface.point + bulge + ng * (side * ORIGIN_OFFSET * surface.scale)
}
