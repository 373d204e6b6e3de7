//! The tree of nodes, flattened: meshes and a camera with their transforms.
//!
//! For: [`place`], [`note_ignored`].

use super::super::error::SceneError;
use super::super::json::JsonPath;
use super::super::notes::Notes;
use super::bytes::broken;
use glam::{DMat4, DQuat, DVec3};
use gltf_json::Root;
use gltf_json::scene::Node;

/// What the nodes of a scene show, in the coordinates of the file.
#[derive(Default)]
pub struct Placed {
    /// Index of each mesh, which exists, and its transform.
    pub meshes: Vec<(usize, DMat4)>,
    /// Index of the first camera, which exists, and its transform.
    pub camera: Option<(usize, DMat4)>,
}

/// Visits the nodes of the file's scene; without a scene, all nodes that are no node's child.
pub fn place(place: &JsonPath, root: &Root) -> Result<Placed, SceneError> {
    let nodes = place.key("nodes");
    let scene = root.scene.map_or(0, |scene| scene.value());
    let mut open: Vec<(usize, DMat4)> = match root.scenes.get(scene) {
        Some(scene) => scene.nodes.iter().map(|node| (node.value(), DMat4::IDENTITY)).collect(),
        None if root.scene.is_some() => {
            return Err(broken(&place.key("scene"), format!("there is no scene {scene}")));
        }
        None => {
            let mut is_child = vec![false; root.nodes.len()];
            for child in root.nodes.iter().flat_map(|node| node.children.iter().flatten()) {
                if let Some(is_child) = is_child.get_mut(child.value()) {
                    *is_child = true;
                }
            }
            let roots = (0..root.nodes.len()).filter(|&node| !is_child[node]);
            roots.map(|node| (node, DMat4::IDENTITY)).collect()
        }
    };
    // The first ones first.
    open.reverse();
    let mut seen = vec![false; root.nodes.len()];
    let mut placed = Placed::default();
    while let Some((index, parent)) = open.pop() {
        let Some(node) = root.nodes.get(index) else {
            return Err(broken(&nodes, format!("there is no node {index}")));
        };
        // A tree has neither; without this, children could be shared without end.
        if std::mem::replace(&mut seen[index], true) {
            let what = format!("node {index} is the child of two nodes, or of itself");
            return Err(broken(&nodes.item(index), what));
        }
        let transform = parent * local(node);
        if let Some(mesh) = node.mesh.map(|mesh| mesh.value()) {
            if mesh >= root.meshes.len() {
                return Err(broken(&nodes.item(index).key("mesh"), format!("there is no mesh {mesh}")));
            }
            placed.meshes.push((mesh, transform));
        }
        if let Some(camera) = node.camera.map(|camera| camera.value())
            && placed.camera.is_none()
        {
            if camera >= root.cameras.len() {
                return Err(broken(&nodes.item(index).key("camera"), format!("there is no camera {camera}")));
            }
            placed.camera = Some((camera, transform));
        }
        open.extend(node.children.iter().flatten().rev().map(|child| (child.value(), transform)));
    }
    if placed.meshes.is_empty() {
        return Err(broken(&nodes, "no node shows a mesh"));
    }
    Ok(placed)
}

fn local(node: &Node) -> DMat4 {
    if let Some(matrix) = node.matrix {
        return DMat4::from_cols_array(&matrix.map(f64::from));
    }
    let vector = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
    let [x, y, z, w] = node.rotation.unwrap_or_default().0.map(f64::from);
    let length = (x * x + y * y + z * z + w * w).sqrt();
    let rotation = match length > 0.0 {
        true => DQuat::from_xyzw(x / length, y / length, z / length, w / length),
        false => DQuat::IDENTITY,
    };
    DMat4::from_scale_rotation_translation(
        node.scale.map_or(DVec3::ONE, vector),
        rotation,
        node.translation.map_or(DVec3::ZERO, vector),
    )
}

/// Notes what of the file's nodes is left out.
pub fn note_ignored(place: &JsonPath, root: &Root, notes: &mut Notes) {
    for (index, _) in root.animations.iter().enumerate() {
        notes.add(&place.key("animations").item(index), "animations are not played");
    }
    for (index, node) in root.nodes.iter().enumerate() {
        let list = place.key("nodes");
        let place = list.item(index);
        if node.skin.is_some() {
            let what = "skins are not read: the mesh is shown as it is without bones";
            notes.add(&place.key("skin"), what);
        }
    }
    if root.scenes.len() > 1 {
        notes.add(&place.key("scenes"), "the file has several scenes: one is shown");
    }
    if root.cameras.len() > 1 {
        notes.add(&place.key("cameras"), "the file has several cameras: the first one of a node counts");
    }
}
