//! The checksums of a scene that checkpoints and reports record.

use glam::{Vec2, Vec3};
use octray::checkpoint::Fingerprint;
use octray::scene::{
    Filter, Lens, LightShape, Portal, Projection, PunctualLight, Scene, Side, Sky, Texels, Texture, Triangle,
    Wrap, load,
};

fn light() -> PunctualLight {
    let shape = LightShape::Point { position: Vec3::Y, intensity: Vec3::ONE, range: f32::INFINITY };
    shape.into()
}

#[test]
fn each_change_of_a_scene_changes_one_checksum() {
    let mut scene = load("builtin:thesis").unwrap();
    scene.textures.truncate(1);
    for texels in [Texels::Srgb8(vec![[5; 4]]), Texels::Float32(vec![[0.5, 0.25, 0.125, 0.0]])] {
        let filter = Filter::Nearest;
        scene.textures.push(Texture {
            name: "t".into(),
            width: 1,
            height: 1,
            filter,
            wrap: Default::default(),
            texels,
        });
    }
    scene.triangles = vec![Triangle { vertices: [Vec3::ZERO, Vec3::X, Vec3::Y], material: 0 }];
    (scene.uvs, scene.normals) = (vec![[Vec2::ZERO; 3]], vec![[Vec3::Z; 3]]);
    let sums = |scene: &Scene| serde_json::to_value(Fingerprint::from_scene(scene)).unwrap();
    let own = sums(&scene);
    type Change = fn(&mut Scene);
    let changes: [(Change, &str); 22] = [
        (|scene| scene.name.push('x'), ""),
        (|scene| scene.resolution[0] += 1, ""),
        (|scene| scene.camera.position.x += 1e-3, "camera"),
        (|scene| scene.camera.projection = Projection::Orthographic { height: 1.0 }, "camera"),
        (
            |scene| {
                scene.camera.projection = Projection::Perspective(Lens { radius: 0.1, ..Lens::default() })
            },
            "camera",
        ),
        (|scene| scene.sky = Sky::Color(Vec3::splat(0.123)), "sky"),
        (|scene| scene.portals.push(Portal { vertices: [Vec3::ZERO; 4] }), "sky"),
        (|scene| scene.materials[0].color.y *= 0.5, "materials"),
        (|scene| scene.materials[0].opacity = 0.5, "materials"),
        (|scene| scene.textures[0].width += 1, "textures"),
        (|scene| scene.textures[1].texels = Texels::Srgb8(vec![[5, 4, 5, 5]]), "textures"),
        (|scene| scene.textures[1].filter = Filter::Bilinear, "textures"),
        (|scene| scene.textures[1].wrap[1] = Wrap::Clamp, "textures"),
        (|scene| scene.textures[2].texels = Texels::Float32(vec![[0.5, 0.25, 0.25, 0.0]]), "textures"),
        (|scene| scene.lights.push(light()), "lights"),
        (|scene| scene.spheres[0].radius *= 1.000_001, "spheres"),
        (|scene| scene.spheres[0].texture_turn += 0.5, "spheres"),
        (|scene| scene.spheres[0].texture_side = Side::Outside, "spheres"),
        (|scene| scene.spheres[0].material += 1, "spheres"),
        (|scene| scene.triangles[0].vertices[2].y = 2.0, "triangles"),
        (|scene| scene.uvs[0][1].x = 1.0, "vertices"),
        (|scene| scene.normals[0][1] = Vec3::X, "vertices"),
    ];
    for (number, (change, part)) in changes.into_iter().enumerate() {
        let mut other = scene.clone();
        change(&mut other);
        let other = sums(&other);
        let parts = own.as_object().unwrap().keys().filter(|part| own[*part] != other[*part]);
        assert_eq!(parts.cloned().collect::<Vec<_>>().join(" "), part, "change {number}");
    }
}
