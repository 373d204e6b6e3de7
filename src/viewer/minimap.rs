//! The minimap: the scene from above, with the camera and its field of view.

use super::camera_controller::CameraController;
use super::display_mode::{encode, rgb};
use glam::{DVec2, DVec3};
use octray_formats::scene::{Camera, MaterialKind, Primitive, Scene};

/// Side of the minimap in pixels.
const SIDE: u32 = 160;
/// Margin in pixels.
const MARGIN: f64 = 10.0;
/// Largest radius of what the map shows as a whole, over the distance of its centre from the camera: a camera
/// that stands on a sphere, and not far above it, sees a ground.
const LARGEST: f64 = 0.9;
/// A camera that is as many times as far from the scene as the scene is wide stands at the map's edge.
const FAR: f64 = 8.0;
const GROUND: u32 = 0x20_2428;
const HERE: u32 = 0xff_ff40;

/// A minimap: the scene is drawn once, the camera in every frame.
pub struct Minimap {
    ground: Vec<u32>,
    /// Unit vectors to the minimap's right and down, in scene space.
    right: DVec3,
    down: DVec3,
    center: DVec3,
    /// Pixels per scene unit.
    scale: f64,
}

/// A primitive: its [`Primitive::hull`].
struct Shape {
    corners: Vec<DVec3>,
    radius: f64,
    material: u32,
}

fn shapes(scene: &Scene) -> Vec<Shape> {
    let shape = |primitive: Primitive| {
        let (points, radius) = primitive.hull();
        let corners = points.iter().map(|point| point.as_dvec3()).collect();
        Shape { corners, radius: radius.into(), material: primitive.material() }
    };
    scene.all_primitives().map(shape).collect()
}

impl Shape {
    /// Centre and radius of a ball around it.
    fn ball(&self) -> (DVec3, f64) {
        let center = self.corners.iter().sum::<DVec3>() / self.corners.len() as f64;
        let reach = self.corners.iter().map(|corner| corner.distance(center)).fold(0.0, f64::max);
        (center, self.radius + reach)
    }
    /// Its greatest height.
    fn height(&self, up: DVec3) -> f64 {
        self.corners.iter().map(|corner| corner.dot(up)).fold(f64::MIN, f64::max) + self.radius
    }
}

impl Minimap {
    /// Draws the scene along its camera's up axis; the camera's line of sight points to the top.
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
        let mut shapes = shapes(scene);
        minimap.frame(&shapes, camera);
        // The highest last. A sphere around the camera, or one wider than the map, would hide the others.
        let most = f64::from(SIDE) / (2.0 * minimap.scale);
        let seen = |radius: f64, center: DVec3| radius < most && radius < center.distance(camera);
        shapes.retain(|shape| shape.radius == 0.0 || seen(shape.radius, shape.corners[0]));
        shapes.sort_by(|a, b| a.height(up).total_cmp(&b.height(up)));
        for shape in shapes {
            let material = &scene.materials[shape.material as usize];
            let shown = match material.kind {
                MaterialKind::Emitter => material.emission.min(glam::Vec3::ONE),
                _ => material.color,
            };
            let color = rgb(shown.to_array().map(|x| 0.1 + 0.55 * encode(x)));
            let corners: Vec<DVec2> = shape.corners.iter().map(|&corner| minimap.place(corner)).collect();
            fill(&mut minimap.ground, &corners, shape.radius * minimap.scale, color);
        }
        minimap
    }

    /// Sets centre and scale so that the camera, unless it is [`FAR`], and the primitives fit whose bounding
    /// radius is below [`LARGEST`] of their distance from it. Larger ones (a floor, a planet-sized ball, a
    /// sky) are cut off, unless there are no others.
    fn frame(&mut self, shapes: &[Shape], camera: DVec3) {
        let flat = |point: DVec3| DVec2::new(point.dot(self.right), point.dot(self.down));
        let balls: Vec<(DVec3, f64)> = shapes.iter().map(Shape::ball).collect();
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

    fn place(&self, point: DVec3) -> DVec2 {
        let from = point - self.center;
        DVec2::new(from.dot(self.right), from.dot(self.down)) * self.scale + f64::from(SIDE) / 2.0
    }

    /// The minimap with the camera and its field of view, in a frame's pixel format.
    pub fn draw_into(&self, camera: &Camera, aspect: f64, pixels: &mut Vec<u32>) {
        pixels.clear();
        pixels.extend_from_slice(&self.ground);
        let here = self.place(camera.position.as_dvec3());
        let edge = f64::from(SIDE) - 3.0;
        let here = here.clamp(DVec2::splat(2.0), DVec2::splat(edge));
        let sight = camera.look_at.as_dvec3() - camera.position.as_dvec3();
        let way = DVec2::new(sight.dot(self.right), sight.dot(self.down)).normalize_or_zero();
        let half = ((f64::from(camera.vertical_fov).to_radians() / 2.0).tan() * aspect).atan();
        for side in [-half, half] {
            let edge = DVec2::from_angle(side).rotate(way);
            for step in 0..40 {
                dot(pixels, here + edge * f64::from(step) * 0.7, HERE);
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
            if inside(corners, radius, at) {
                // A rim, so that balls are visible on a floor of their own colour.
                let rim = radius > 3.0 && corners[0].distance(at) > radius - 1.2;
                pixels[(y * SIDE + x) as usize] = if rim { GROUND } else { color };
            }
        }
    }
    corners.iter().for_each(|&corner| dot(pixels, corner, color));
}

fn inside(corners: &[DVec2], radius: f64, at: DVec2) -> bool {
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

    /// Two balls of radius 1 at these places, before a camera that looks along -z; the first is black, the
    /// second white.
    fn balls(centers: [[f32; 3]; 2]) -> Scene {
        let mut scene = load("builtin:three").unwrap();
        let [position, look_at] = [10.0, 0.0].map(|z| Vec3::new(0.0, 1.0, z));
        scene.camera = Camera { position, look_at, up: Vec3::Y, vertical_fov: 40.0 };
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
    fn what_is_higher_lies_over_what_is_lower() {
        let [black, white] = [[2.0, 0.5], [0.5, 2.0]].map(|heights| {
            let minimap = Minimap::new(&balls(heights.map(|y| [0.0, y, 0.0])));
            color(&minimap.ground, minimap.place(DVec3::ZERO) + 2.0)
        });
        assert!(black < white, "{black:x} {white:x}");
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
