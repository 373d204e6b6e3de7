//! Draws the minimap: the scene from above, with the camera and its field of view.

use super::camera_controller::CameraController;
use super::display_mode::{encode, rgb};
use glam::{DVec2, DVec3};
use octray_formats::scene::{Camera, MaterialKind, Primitive, Projection, Scene};

/// Side of the minimap in pixels.
const SIDE: u32 = 160;
/// Margin in pixels.
const MARGIN: f64 = 10.0;
/// Largest bounding radius of a primitive that must fit the map, relative to the camera's distance from its
/// centre. A larger one is a ground under the camera.
const LARGEST: f64 = 0.9;
/// Largest distance of a camera that must fit the map, in widths of the scene. One farther away is drawn at
/// the map's edge.
const FAR: f64 = 8.0;
const GROUND: u32 = 0x20_2428;
const HERE: u32 = 0xff_ff40;

/// A minimap, whose scene is drawn once, and whose camera in every frame.
pub struct Minimap {
    /// The map without the camera.
    ground: Vec<u32>,
    /// Unit vectors to the minimap's right and down, in scene space.
    right: DVec3,
    down: DVec3,
    center: DVec3,
    /// Pixels per scene unit.
    scale: f64,
}

/// Returns the balls, centres and radius, whose convex hull contains a primitive.
fn balls(primitive: Primitive) -> impl Iterator<Item = (DVec3, f64)> + Clone {
    let (points, radius) = primitive.hull();
    points.iter().map(move |point| (point.as_dvec3(), radius.into()))
}

/// Returns the centre and the radius of a ball around a primitive.
fn ball(primitive: Primitive) -> (DVec3, f64) {
    let balls = balls(primitive);
    let center = balls.clone().map(|(corner, _)| corner).sum::<DVec3>() / balls.clone().count() as f64;
    (center, balls.map(|(corner, radius)| corner.distance(center) + radius).fold(0.0, f64::max))
}

impl Minimap {
    /// Draws the scene along its camera's up axis. The camera's line of sight points to the top of the map.
    pub fn new(scene: &Scene) -> Self {
        let (forward, up) = CameraController::new(scene).forward_and_up();
        let camera = scene.camera.position.as_dvec3();
        let mut minimap = Self {
            ground: vec![GROUND; (SIDE * SIDE) as usize],
            right: forward.cross(up),
            down: -forward,
            center: DVec3::ZERO,
            scale: 1.0,
        };
        minimap.frame(scene, camera);
        // The highest are drawn last. A sphere around the camera, or one wider than the map, would hide the
        // others.
        let most = f64::from(SIDE) / (2.0 * minimap.scale);
        let is_seen =
            |(center, radius): (DVec3, f64)| radius == 0.0 || radius < center.distance(camera).min(most);
        let mut primitives: Vec<Primitive> = scene.all_primitives().collect();
        primitives.retain(|&primitive| balls(primitive).all(is_seen));
        let height = |primitive: &Primitive| {
            balls(*primitive).map(|(corner, radius)| corner.dot(up) + radius).fold(f64::MIN, f64::max)
        };
        primitives.sort_by(|a, b| height(a).total_cmp(&height(b)));
        for primitive in primitives {
            let material = &scene.materials[primitive.material() as usize];
            let shown = match material.kind {
                MaterialKind::Emitter => material.emission,
                _ => material.color,
            };
            let color = rgb(shown.to_array().map(|x| 0.1 + 0.55 * encode(x)));
            let corners: Vec<DVec2> = balls(primitive).map(|(corner, _)| minimap.place(corner)).collect();
            let (_, radius) = primitive.hull();
            fill(&mut minimap.ground, &corners, f64::from(radius) * minimap.scale, color);
        }
        minimap
    }

    /// Sets centre and scale. The camera fits the map, unless it is [`FAR`] away, and so do the primitives up
    /// to [`LARGEST`]. Larger ones (a floor, a planet-sized ball, a sky) are cut off, unless all are larger.
    fn frame(&mut self, scene: &Scene, camera: DVec3) {
        let flat = |point: DVec3| DVec2::new(point.dot(self.right), point.dot(self.down));
        let balls: Vec<(DVec3, f64)> = scene.all_primitives().map(ball).collect();
        let fits = |&&(center, radius): &&(DVec3, f64)| radius < LARGEST * center.distance(camera);
        let some = balls.iter().any(|ball| fits(&ball));
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for (center, radius) in balls.iter().filter(|ball| !some || fits(ball)) {
            low = low.min(flat(*center) - *radius);
            high = high.max(flat(*center) + *radius);
        }
        // False where there are no primitives.
        let far = flat(camera).distance((low + high) / 2.0) > FAR * (high - low).max_element();
        if !far {
            (low, high) = (low.min(flat(camera)), high.max(flat(camera)));
        }
        let middle = (low + high) / 2.0;
        self.center = self.right * middle.x + self.down * middle.y;
        let extent = (high - low).max_element().max(1e-12);
        self.scale = (f64::from(SIDE) - 2.0 * MARGIN) / extent;
    }

    /// Returns a point's pixel.
    fn place(&self, point: DVec3) -> DVec2 {
        let from = point - self.center;
        DVec2::new(from.dot(self.right), from.dot(self.down)) * self.scale + f64::from(SIDE) / 2.0
    }

    /// Draws the minimap with the camera and its field of view.
    pub fn draw_into(&self, camera: &Camera, aspect: f64, pixels: &mut Vec<u32>) {
        pixels.clear();
        pixels.extend_from_slice(&self.ground);
        let here = self.place(camera.position.as_dvec3());
        let edge = f64::from(SIDE) - 3.0;
        let here = here.clamp(DVec2::splat(2.0), DVec2::splat(edge));
        let sight = camera.look_at.as_dvec3() - camera.position.as_dvec3();
        let way = DVec2::new(sight.dot(self.right), sight.dot(self.down)).normalize_or_zero();
        let half = camera.half_height() * aspect;
        for side in [-half, half] {
            let (from, edge) = match camera.projection {
                Projection::Perspective(_) => (here, DVec2::from_angle(side.atan()).rotate(way)),
                Projection::Orthographic { .. } => (here + way.perp() * side * self.scale, way),
            };
            for step in 0..40 {
                dot(pixels, from + edge * f64::from(step) * 0.7, HERE);
            }
        }
        for x in -1..=1 {
            for y in -1..=1 {
                dot(pixels, here + DVec2::new(f64::from(x), f64::from(y)), HERE);
            }
        }
    }
}

fn dot(pixels: &mut [u32], at: DVec2, color: u32) {
    let side = f64::from(SIDE);
    if (0.0..side).contains(&at.x) && (0.0..side).contains(&at.y) {
        pixels[(at.y as u32 * SIDE + at.x as u32) as usize] = color;
    }
}

/// Fills a disc or a triangle; one smaller than a pixel fills that pixel.
fn fill(pixels: &mut [u32], corners: &[DVec2], radius: f64, color: u32) {
    let low = corners.iter().copied().reduce(DVec2::min).unwrap_or_default() - radius;
    let high = corners.iter().copied().reduce(DVec2::max).unwrap_or_default() + radius;
    let range =
        |low: f64, high: f64| (low.max(0.0) as u32)..(high.min(f64::from(SIDE) - 1.0).max(-1.0) + 1.0) as u32;
    for y in range(low.y, high.y) {
        for x in range(low.x, high.x) {
            let at = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
            if is_inside(corners, radius, at) {
                // A dark rim keeps balls visible on a floor of their own colour.
                let rim = radius > 3.0 && corners[0].distance(at) > radius - 1.2;
                pixels[(y * SIDE + x) as usize] = if rim { GROUND } else { color };
            }
        }
    }
    corners.iter().for_each(|&corner| dot(pixels, corner, color));
}

fn is_inside(corners: &[DVec2], radius: f64, at: DVec2) -> bool {
    match corners {
        [center] => center.distance(at) <= radius,
        [a, b, c] => {
            let sides = [(*a, *b), (*b, *c), (*c, *a)].map(|(from, to)| (to - from).perp_dot(at - from));
            sides.iter().all(|&side| side >= 0.0) || sides.iter().all(|&side| side <= 0.0)
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use octray_formats::scene::{builtin_names, load};

    /// Returns a scene of two balls of radius 1, a black and a white one, and a camera that looks along -z.
    fn balls(centers: [[f32; 3]; 2]) -> Scene {
        let mut scene = load("builtin:three").unwrap();
        let [position, look_at] = [10.0, 0.0].map(|z| Vec3::new(0.0, 1.0, z));
        scene.camera = Camera::pinhole(position, look_at, Vec3::Y, 40.0);
        scene.triangles.clear();
        scene.spheres.truncate(2);
        for (number, (sphere, center)) in scene.spheres.iter_mut().zip(centers).enumerate() {
            (sphere.center, sphere.radius, sphere.material) = (center.into(), 1.0, number as u32);
            let material = &mut scene.materials[number];
            (material.kind, material.color) = (MaterialKind::Diffuse, Vec3::splat(number as f32));
        }
        scene
    }
    fn color(pixels: &[u32], at: DVec2) -> u32 {
        pixels[(at.y as u32 * SIDE + at.x as u32) as usize]
    }

    #[test]
    fn what_stands_ahead_is_drawn_above_the_camera_and_what_stands_right_on_its_right() {
        let scene = balls([[0.0, 0.0, -10.0], [8.0, 0.0, 0.0]]);
        let minimap = Minimap::new(&scene);
        let [camera, forward, right] =
            [scene.camera.position, scene.spheres[0].center, scene.spheres[1].center]
                .map(|point| minimap.place(point.as_dvec3()));
        assert!(forward.y < right.y && right.y < camera.y && right.x > forward.x);
        let colors = [forward, right, camera].map(|at| color(&minimap.ground, at));
        assert!(colors[0] != GROUND && colors[1] != GROUND && colors[2] == GROUND);
        let mut pixels = Vec::new();
        minimap.draw_into(&scene.camera, 16.0 / 9.0, &mut pixels);
        assert_eq!(color(&pixels, camera), HERE);
        let yellow = pixels.iter().enumerate().filter(|&(_, &pixel)| pixel == HERE);
        assert!(yellow.clone().count() > 40);
        let above = yellow.filter(|(at, _)| ((*at as u32 / SIDE) as f64) < camera.y - 2.0).count();
        assert!(above > 30, "the field of view opens forward");
    }

    #[test]
    fn every_built_in_scene_has_something_on_its_map() {
        for name in builtin_names() {
            let scene = load(&format!("builtin:{name}")).unwrap();
            let drawn = Minimap::new(&scene).ground.iter().filter(|&&pixel| pixel != GROUND).count();
            assert!(drawn > 50, "{name}: {drawn} pixels");
        }
    }

    #[test]
    fn a_sphere_that_is_the_ground_is_left_out_and_a_planet_is_not() {
        for (height, radius) in [(3.0, 1.0), (1500.0, 1000.0)] {
            let mut scene = balls([[0.0, -1000.0, 0.0], [0.0, 0.0, 0.0]]);
            scene.spheres[0].radius = 1000.0;
            scene.camera.position = Vec3::new(0.0, height, 10.0);
            let minimap = Minimap::new(&scene);
            let pixels = minimap.scale * radius;
            assert!(pixels > 4.0 && pixels < f64::from(SIDE), "{pixels} pixels at {height}");
            let corner = color(&minimap.ground, DVec2::splat(f64::from(SIDE) - 8.0));
            assert_eq!(corner, GROUND);
        }
    }
}
