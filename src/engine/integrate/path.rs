//! Records one path as vertices. A path of at most n events is the beginning of a longer one with the same
//! random numbers. The pipeline therefore traces the pixel with at most 0, 1, 2 … events, and each time
//! leaves the last segment and the last shadow ray in its queues. No stage is changed for it.

use super::aovs::ALL;
use super::context::TraceContext;
use super::emission::{missed_radiance, surface_radiance};
use super::material::MaterialSample;
use super::opacity;
use super::pipeline::pipeline_for;
use super::scratch::Scratch;
use super::shadow_rays::{arriving_radiance, find_occluders};
use crate::buffers::Features;
use crate::camera::Tile;
use crate::math::{Hit, Vec3};
use crate::path_vertex::{PathVertex, lobe};

/// Returns the vertices of sample `sample` of pixel (x, y). The film gets the last one's radiance.
pub fn trace_path(context: &mut TraceContext, [x, y]: [u32; 2], sample: u32) -> Vec<PathVertex<f32>> {
    let tile = Tile { number: usize::MAX, x, y, width: 1, height: 1 };
    let (_, pipeline) = pipeline_for(Features::ALL, 1);
    let (most, mut scratch) = (context.max_bounces, Scratch::new());
    let (mut vertices, mut shadow_rays) = (Vec::<PathVertex<f32>>::new(), 0);
    for events in 0..=most {
        context.max_bounces = events;
        scratch.start_stats();
        pipeline(context, &[tile], sample, &mut scratch);
        let stats = scratch.take_stats();
        if stats.segments.len() > events as usize {
            push_end(context, &scratch, &mut vertices);
        }
        if stats.shadow_rays.rays > shadow_rays {
            shadow_rays = stats.shadow_rays.rays;
            // Traces the last shadow ray again; this overwrites the hit.
            let (vertex, scratch) = (&mut vertices[events as usize - 1], &mut *scratch);
            let (rays, mut hits) = scratch.shadow_queue.queries(&mut scratch.queue, 1);
            find_occluders(context, &mut scratch.tracer, &rays, &mut hits);
            vertex.light_direction = Some(array(rays.packet::<f32>(0).direction));
            let hit = hits.get(0);
            let Scratch { tracer, shadow_queue, .. } = scratch;
            let (arrives, radiance) = if context.has_opacity::<ALL>() {
                (true, opacity::arriving_radiance(context, tracer, shadow_queue, 0, hit).0)
            } else {
                let (arrives, (_, radiance)) = arriving_radiance(context, shadow_queue, 0, &hit, true);
                (arrives, radiance)
            };
            vertex.light = Some(if arrives { array(radiance) } else { [0.0; 3] });
        }
    }
    context.max_bounces = most;
    let mut sum = [0.0; 3];
    for vertex in &mut vertices {
        let (emitted, light) = (vertex.emitted, vertex.light.unwrap_or_default());
        sum = std::array::from_fn(|channel| sum[channel] + emitted[channel] + light[channel]);
        vertex.radiance = sum;
    }
    vertices
}

fn array(v: Vec3<f32>) -> [f32; 3] {
    v.get(0).to_array()
}

/// Adds the end of the segment at the front of the queue.
fn push_end(context: &TraceContext, scratch: &Scratch, vertices: &mut Vec<PathVertex<f32>>) {
    let (queue, hit): (_, Hit<f32>) = (&scratch.queue, scratch.queue.hit(0));
    let mut path = context.path::<f32, ALL, true>(queue, 0);
    if let Some(before) = vertices.last_mut() {
        path = context.path::<f32, ALL, false>(queue, 0);
        let cosine = path.ray.direction.get(0).dot(before.normal.into());
        before.lobe = Some(lobe(path.inv_pdf == 0.0, cosine.into()));
    }
    let mut vertex = PathVertex { throughput: array(path.throughput), ..PathVertex::default() };
    vertex.emitted = array(missed_radiance::<f32, ALL, false>(context, &path, !hit.found()));
    if hit.found() {
        let surface = context.surface::<_, ALL>(&path, &hit, true);
        let material = MaterialSample::of::<ALL>(context, &surface, true);
        (vertex.primitive, vertex.distance) = (Some(hit.primitive), hit.t);
        vertex.point = array(surface.point);
        vertex.normal = array(material.ns.flip_sign(surface.facing));
        vertex.emitted = array(surface_radiance::<f32, ALL, false>(&path, &surface, &material));
    }
    vertices.push(vertex);
}
