//! The denoiser's AOVs: of surfaces seen in mirrors and through glass, and of several points of edge pixels.
//!
//! At a delta lobe the path continues as the likelier of the estimator's paths does: along the reflection, or
//! at glass along the likelier one of reflection and refraction. Normal, lobe and albedo are those of the
//! first surface with another lobe; distances add up, colours multiply, and the object id combines those on
//! the way, so that an object and its reflection are two. Metal that is nearly a mirror is followed, too.
//! Source: Áfra, Open Image Denoise, documentation (albedos and normals of perfect specular surfaces).

use super::aovs::{ALL, Aovs, Plane, Seen};
use super::bsdf::follow_delta;
use super::context::TraceContext;
use super::material::scattered_cone;
use super::opacity::closest_seen;
use super::queue::Path;
use super::scratch::Scratch;
use super::stats::RayKind;
use crate::buffers::MaterialCode;
use crate::camera::MAX_PIXELS;
use crate::lane::{Bits, F32x8, Lane, Mask};
use crate::math::MISS;

type L = F32x8;
type B = <L as Lane>::Bits;

/// The largest number of mirrors and glass surfaces that are followed.
const MAX_FOLLOWED: u32 = 8;
/// Metal whose lobe is no wider than this is followed as a mirror: on curved surfaces its images are sharp.
const NARROW_METAL: f32 = 0.03;
/// The points of a pixel at an edge, from its upper left corner: a rotated grid.
pub const POINTS: [[f32; 2]; EDGE_POINTS] = [[0.375, 0.125], [0.875, 0.375], [0.125, 0.625], [0.625, 0.875]];
/// The number of points sampled in an edge pixel.
pub const EDGE_POINTS: usize = 4;
/// A pixel is at an edge if a neighbour's unit normal or albedo differs by more than this (length of the
/// difference).
const NORMAL_STEP: f32 = 0.4;
const ALBEDO_STEP: f32 = 0.05;
/// The bit of combined object ids, which no object's id has: see [`combine`]. `MISS` also has bit 31, which
/// combined ids lack.
const COMBINED: u32 = 1 << 30;
/// The bit of a path's key that marks glass, rough metal or opacity: the estimator chooses at random.
pub(super) const CHOSEN: u32 = 1 << 31;

/// The surface or environment seen at a point of the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EdgeSample {
    /// The object at the point.
    pub object: u32,
    /// The shading normal.
    pub normal: [f32; 3],
    /// The reflectance; the radiance if the object emits.
    pub albedo: [f32; 3],
    /// Whether the albedo is the radiance, without noise.
    pub emits: bool,
}

/// A pixel whose neighbours show something else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgePixel {
    /// The column of the pixel.
    pub x: u32,
    /// The sample at each point.
    pub samples: [EdgeSample; EDGE_POINTS],
}

/// The denoiser's AOVs: see the top of this file.
#[derive(Clone, Debug, Default)]
pub struct DenoiserAovs {
    /// The AOVs of pixel centres. For pixels on mirrors and glass, [`Plane::Distance`], normal, albedo, lobe,
    /// [`Plane::Scale`] and object are those of the surface seen in them. A scale above 0 means no noise;
    /// behind glass and narrow lobes it is 0, and the albedo of emitters is the radiance.
    pub(crate) centers: Aovs,
    /// The edge pixels of each row, from the left.
    pub(crate) edges: Vec<Vec<EdgePixel>>,
}

impl DenoiserAovs {
    /// The largest number of words of a row, for each of its pixels: see [`DenoiserAovs::row_words`].
    pub const MAX_WORDS: usize = Plane::ALL.len() + EDGE_WORDS;

    /// Returns the AOVs at pixel centres.
    pub fn centers(&self) -> &Aovs {
        &self.centers
    }
    /// Returns the edge pixels of a row, from the left.
    pub fn edges(&self, y: u32) -> &[EdgePixel] {
        &self.edges[y as usize]
    }
    /// Changes the size. The values are unspecified afterwards, until [`DenoiserAovs::set_row`] sets them.
    pub fn resize(&mut self, resolution: [u32; 2]) {
        self.centers.resize(resolution);
        self.edges.clear();
        self.edges.resize(resolution[1] as usize, Vec::new());
    }
    /// Returns a row as words: the planes of its pixels, then its edge pixels.
    pub fn row_words(&self, y: u32) -> Vec<u32> {
        let planes = Plane::ALL.iter().flat_map(|&plane| self.centers.row(plane, y));
        let mut words: Vec<u32> = planes.map(|value| value.to_bits()).collect();
        for EdgePixel { x, samples } in self.edges(y) {
            words.push(*x);
            for EdgeSample { object, normal, albedo, emits } in samples {
                words.extend([*object, u32::from(*emits)]);
                words.extend(normal.iter().chain(albedo).map(|value| value.to_bits()));
            }
        }
        words
    }
    /// Sets a row from [`DenoiserAovs::row_words`]. Returns whether they can be those of a row.
    pub fn set_row(&mut self, y: u32, words: &[u32]) -> bool {
        let [width, height] = self.centers.resolution();
        let Some((planes, edges)) = words.split_at_checked(Plane::ALL.len() * width as usize) else {
            return false;
        };
        if y >= height || edges.len() % EDGE_WORDS != 0 {
            return false;
        }
        for (&plane, values) in Plane::ALL.iter().zip(planes.chunks_exact(width as usize)) {
            let row = self.centers.row_mut(plane, y);
            row.iter_mut().zip(values).for_each(|(value, &word)| *value = f32::from_bits(word));
        }
        let sample = |words: &[u32]| {
            let number = |at: usize| f32::from_bits(words[at]);
            let [normal, albedo] = [2, 5].map(|first| [0, 1, 2].map(|axis| number(first + axis)));
            EdgeSample { object: words[0], emits: words[1] == 1, normal, albedo }
        };
        let pixel = |words: &[u32]| EdgePixel {
            x: words[0],
            samples: std::array::from_fn(|point| sample(&words[1 + point * SAMPLE_WORDS..])),
        };
        self.edges[y as usize] = edges.chunks_exact(EDGE_WORDS).map(pixel).collect();
        self.edges[y as usize].iter().all(|edge| edge.x < width)
    }
}

/// The number of words of an [`EdgeSample`], and of an [`EdgePixel`].
const SAMPLE_WORDS: usize = 8;
const EDGE_WORDS: usize = 1 + EDGE_POINTS * SAMPLE_WORDS;

/// Replaces the AOVs of mirrors and glass in a row by those of the surfaces seen in them.
pub(crate) fn follow_row(context: &TraceContext, y: u32, row: &mut [f32], scratch: &mut Scratch) {
    let stride = row.len() / Aovs::PLANES;
    let width = context.width as usize;
    let place = |plane: Plane, x: usize| plane as usize * stride + x;
    for left in (0..width).step_by(MAX_PIXELS) {
        let mut points = Points::new();
        for x in left..width.min(left + MAX_PIXELS) {
            let object = row[place(Plane::Object, x)].to_bits();
            if row[place(Plane::Lobe, x)] <= NARROW_METAL && object != MISS {
                points.push([x as f32 + 0.5, y as f32 + 0.5], x - left);
            }
        }
        points.trace(context, scratch, |x, shown| {
            let x = left + x;
            let mut set = |plane, value| row[place(plane, x)] = value;
            set(Plane::Distance, shown.distance);
            set(Plane::NormalX, shown.normal[0]);
            set(Plane::NormalY, shown.normal[1]);
            set(Plane::NormalZ, shown.normal[2]);
            set(Plane::AlbedoRed, shown.albedo[0]);
            set(Plane::AlbedoGreen, shown.albedo[1]);
            set(Plane::AlbedoBlue, shown.albedo[2]);
            set(Plane::Lobe, shown.lobe);
            set(Plane::Scale, shown.scale);
            set(Plane::Object, f32::from_bits(shown.object));
        });
    }
}

/// Finds the edge pixels of a row, and samples their points.
pub(crate) fn edge_row(
    context: &TraceContext,
    centers: &Aovs,
    y: u32,
    edges: &mut Vec<EdgePixel>,
    scratch: &mut Scratch,
) {
    edges.clear();
    find_edges(centers, y, |x| edges.push(EdgePixel { x, samples: Default::default() }));
    for part in edges.chunks_mut(MAX_PIXELS / EDGE_POINTS) {
        let mut points = Points::new();
        for (at, pixel) in part.iter().enumerate() {
            for (number, [right, down]) in POINTS.into_iter().enumerate() {
                points.push([pixel.x as f32 + right, y as f32 + down], at * EDGE_POINTS + number);
            }
        }
        points.trace(context, scratch, |at, shown| {
            let emits = shown.scale > 0.0;
            let scale = if emits { shown.scale } else { 1.0 };
            part[at / EDGE_POINTS].samples[at % EDGE_POINTS] = EdgeSample {
                object: shown.object,
                normal: shown.normal,
                albedo: shown.albedo.map(|channel| channel * scale),
                emits,
            };
        });
    }
}

/// Calls `edge` for every pixel of a row that differs from a neighbour: in object, normal or albedo from the
/// four next to it, in albedo also from the diagonal ones and those two pixels away. If a texture is finer
/// than pixels, neighbours may agree by chance.
fn find_edges(aovs: &Aovs, y: u32, mut edge: impl FnMut(u32)) {
    let lines: [Line; 5] = std::array::from_fn(|at| Line::of(aovs, (y + at as u32).saturating_sub(2)));
    let [above_2, above, own, below, below_2] = &lines;
    let width = aovs.resolution()[0] as i32;
    for at in (0..width).step_by(L::WIDTH) {
        let (object, values) = own.packet(at);
        let mut differs = <L as Lane>::Mask::splat(false);
        let square = |from: usize, others: &[L; 6]| {
            let [x, y, z] = [0, 1, 2].map(|axis| values[from + axis] - others[from + axis]);
            x.mul_add(x, y.mul_add(y, z * z))
        };
        for (line, at) in [(own, at - 1), (own, at + 1), (above, at), (below, at)] {
            let (other, others) = line.packet(at);
            differs = differs
                | !other.equals(object)
                | L::splat(NORMAL_STEP * NORMAL_STEP).lt(square(0, &others))
                | L::splat(ALBEDO_STEP * ALBEDO_STEP).lt(square(3, &others));
        }
        for (line, at) in [
            (above, at - 1),
            (above, at + 1),
            (below, at - 1),
            (below, at + 1),
            (own, at - 2),
            (own, at + 2),
            (above_2, at),
            (below_2, at),
        ] {
            let (other, others) = line.packet(at);
            let texture = L::splat(ALBEDO_STEP * ALBEDO_STEP).lt(square(3, &others));
            differs = differs | (other.equals(object) & texture);
        }
        let differs = differs & <L as Lane>::Mask::first((width - at) as usize);
        differs.lanes().for_each(|lane| edge((at + lane as i32) as u32));
    }
}

/// A row of AOVs: object, normal, albedo.
struct Line<'a> {
    objects: &'a [u32],
    values: [&'a [f32]; 6],
}

impl<'a> Line<'a> {
    /// Returns the row with this number, or the picture's last one.
    fn of(aovs: &'a Aovs, y: u32) -> Self {
        const VALUES: [Plane; 6] = [
            Plane::NormalX,
            Plane::NormalY,
            Plane::NormalZ,
            Plane::AlbedoRed,
            Plane::AlbedoGreen,
            Plane::AlbedoBlue,
        ];
        let y = y.min(aovs.resolution()[1] - 1);
        Self { objects: aovs.objects(y), values: VALUES.map(|plane| aovs.row(plane, y)) }
    }

    /// Returns the packet from column `at` on; columns outside the row have its first or last pixel.
    #[inline(always)]
    fn packet(&self, at: i32) -> (B, [L; 6]) {
        let last = self.objects.len() as i32 - 1;
        if at >= 0 && at + L::WIDTH as i32 - 1 <= last {
            let at = at as usize;
            return (B::load(&self.objects[at..]), self.values.map(|row| L::load(&row[at..])));
        }
        let place = |lane: usize| (at + lane as i32).clamp(0, last) as usize;
        let value = |row: &[f32]| L::from_fn(|lane| row[place(lane)]);
        (B::from_fn(|lane| self.objects[place(lane)]), self.values.map(value))
    }
}

/// The surface or environment at the end of a path that starts at the camera.
struct Shown {
    /// The distance along the path.
    distance: f32,
    normal: [f32; 3],
    albedo: [f32; 3],
    lobe: f32,
    scale: f32,
    object: u32,
}

/// Points of the picture whose paths are followed together.
struct Points {
    count: usize,
    x: [f32; LENGTH],
    y: [f32; LENGTH],
    slots: [u32; LENGTH],
}

/// The largest number of points, and a packet more.
const LENGTH: usize = MAX_PIXELS + L::WIDTH;

impl Points {
    fn new() -> Self {
        Self { count: 0, x: [0.0; LENGTH], y: [0.0; LENGTH], slots: [0; LENGTH] }
    }
    fn push(&mut self, [x, y]: [f32; 2], slot: usize) {
        (self.x[self.count], self.y[self.count], self.slots[self.count]) = (x, y, slot as u32);
        self.count += 1;
    }

    /// Traces the paths of the points; calls `put` with each point's slot and the surface it shows.
    fn trace(&self, context: &TraceContext, scratch: &mut Scratch, mut put: impl FnMut(usize, Shown)) {
        // `inv_pdf` holds distances.
        let columns = context.columns::<ALL>();
        for at in (0..self.count).step_by(L::WIDTH) {
            let ray = context.camera.rays(L::load(&self.x[at..]), L::load(&self.y[at..]));
            let cone = context.primary_cone::<L, ALL>();
            let path = Path::primary(ray, B::splat(0), B::load(&self.slots[at..]), cone);
            scratch.queue.store_path(at, &path, columns);
        }
        let most = MAX_FOLLOWED.min(context.max_bounces);
        let mut count = self.count;
        for followed in 0..=most {
            if count == 0 {
                return;
            }
            let kind = if followed == 0 { RayKind::Primary } else { RayKind::Bounce };
            closest_seen(context, scratch, 0..count, kind, false);
            let mut going_on = 0;
            for at in (0..count).step_by(L::WIDTH) {
                let path = scratch.queue.path::<L>(at, columns);
                let hit = scratch.queue.hit::<L>(at);
                let active = <L as Lane>::Mask::first(count - at);
                let seen = Seen::of(context, &path, &hit, active);
                let mut goes_on = <L as Lane>::Mask::splat(false);
                if followed < most
                    && let Some((surface, material)) = &seen.surface
                {
                    goes_on = material.has_lobe(MaterialCode::MIRROR, seen.found)
                        | material.has_lobe(MaterialCode::GLASS, seen.found);
                    let glossy = material.has_lobe(MaterialCode::GGX, seen.found)
                        & seen.lobe.le(L::splat(NARROW_METAL));
                    goes_on = goes_on | glossy;
                    if goes_on.any() {
                        let (ray, factor, refracts) =
                            follow_delta::<L, ALL>(path.ray.direction, surface, material, goes_on);
                        let id = B::select(refracts, B::splat(COMBINED), B::splat(0));
                        let id = combine(path.key, seen.object.wrapping_add(id));
                        let chosen = material.has_lobe(MaterialCode::GLASS, goes_on) | glossy;
                        let id = id | B::select(chosen, B::splat(CHOSEN), B::splat(0));
                        let next = Path {
                            ray,
                            throughput: path.throughput * factor,
                            // The distance along the path so far.
                            inv_pdf: path.inv_pdf + hit.t,
                            key: id,
                            slot: path.slot,
                            cone: scattered_cone(&path, surface, material, goes_on),
                        };
                        // In place: no more paths continue than were read.
                        let next = next.compress(goes_on, columns);
                        scratch.queue.store_path(going_on, &next, columns);
                        going_on += goes_on.count();
                    }
                }
                put_all(&path, &seen, hit.t, active & !goes_on, &mut put);
            }
            count = going_on;
        }
    }
}

/// Combines the id of an object with those of the mirrors and glass before it, in [`Path::key`].
#[inline(always)]
fn combine(key: B, object: B) -> B {
    let mixed = key.wrapping_add(object).wrapping_add(B::splat(1)).wrapping_mul(B::splat(0x9E37_79B1));
    let mixed = mixed.wrapping_add(mixed.shr(15));
    (mixed & B::splat(COMBINED - 1)) | B::splat(COMBINED) | (key & B::splat(CHOSEN))
}

fn put_all(path: &Path<L>, seen: &Seen, t: L, ends: <L as Lane>::Mask, put: &mut impl FnMut(usize, Shown)) {
    if !ends.any() {
        return;
    }
    let direct = (path.key & B::splat(!CHOSEN)).equals(B::splat(0));
    let chosen = !(path.key & B::splat(CHOSEN)).equals(B::splat(0));
    let object = combine(path.key & B::splat(!CHOSEN), seen.object);
    let object = B::select(direct, seen.object, object);
    // If directions were chosen, the radiance is noisy; the albedo is the radiance along this path.
    let scale = seen.scale.only(!chosen);
    let emits = chosen & L::zero().lt(seen.scale);
    let albedo = seen.albedo * path.throughput * L::select(emits, seen.scale, L::one());
    let distance = L::select(seen.found, path.inv_pdf + t, L::splat(f32::INFINITY));
    for lane in ends.lanes() {
        put(
            path.slot.get(lane) as usize,
            Shown {
                distance: distance.get(lane),
                normal: seen.normal.get(lane).to_array(),
                albedo: albedo.get(lane).to_array(),
                lobe: seen.lobe.get(lane),
                scale: scale.get(lane),
                object: object.get(lane),
            },
        );
    }
}
