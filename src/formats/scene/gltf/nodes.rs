//! Flattens the tree of nodes to meshes and a camera with their transforms.

use super::super::error::SceneError;
use super::super::notes::Notes;
use super::bytes::{Document, broken};
use super::schema::{Extras, Lenient, Node, NodeLight};
use glam::{DMat4, DQuat, DVec3};

/// The meshes and the camera of a scene's nodes, in the coordinates of the file.
#[derive(Default)]
pub struct Placed {
    /// Index of each mesh, which exists, and its transform.
    pub meshes: Vec<(usize, DMat4)>,
    /// Index of each node that is a portal, of its mesh, and its transform.
    pub portals: Vec<(usize, Option<usize>, DMat4)>,
    /// Index of the first camera, and its transform.
    pub camera: Option<(usize, DMat4)>,
    /// Index of each node with a light, the index of the light, and its transform.
    pub lights: Vec<(usize, usize, DMat4)>,
    /// Indices of the nodes with a skin.
    skinned: Vec<usize>,
}

/// Visits the nodes of the file's scene or, without a scene, all nodes that are no node's child.
pub fn place(document: &Document) -> Result<Placed, SceneError> {
    let (root, place) = (document.root, document.source.root());
    let nodes = place.key("nodes");
    let roots: Vec<usize> = match root.scene {
        None if root.scenes.len() == 0 => {
            let mut is_child = vec![false; root.nodes.len()];
            for child in root.nodes.iter().flat_map(|(_, node)| node.children.iter().flatten()) {
                if let Some(is_child) = is_child.get_mut(child.0) {
                    *is_child = true;
                }
            }
            (0..root.nodes.len()).filter(|&node| !is_child[node]).collect()
        }
        named => {
            let shown =
                || root.scenes.iter().find(|(_, scene)| scene.nodes.is_some()).map(|(index, _)| index);
            let index = named.map(|scene| scene.0).or_else(shown).unwrap_or(0);
            let scene = document.get(&root.scenes, "scenes", index, &place.key("scene"))?;
            scene.nodes.iter().flatten().map(|node| node.0).collect()
        }
    };
    // The last entry is visited next, so that the order of nodes is that of the file.
    let mut open: Vec<(usize, DMat4)> = roots.into_iter().rev().map(|node| (node, DMat4::IDENTITY)).collect();
    let mut seen = vec![false; root.nodes.len()];
    let mut placed = Placed::default();
    while let Some((index, parent)) = open.pop() {
        let node = document.get(&root.nodes, "nodes", index, &nodes)?;
        // A node with two parents is an error, as shared children could multiply without end.
        if std::mem::replace(&mut seen[index], true) {
            let what = format!("node {index} is the child of two nodes, or of itself");
            return Err(broken(&nodes.item(index), what));
        }
        let transform = parent * local(node);
        let is_portal = node.extras.0.as_ref().is_some_and(Extras::is_portal);
        if is_portal {
            placed.portals.push((index, node.mesh.map(|mesh| mesh.0), transform));
        }
        if let Some(mesh) = node.mesh {
            document.get(&root.meshes, "meshes", mesh.0, &nodes.item(index).key("mesh"))?;
            if !is_portal {
                placed.meshes.push((mesh.0, transform));
                placed.skinned.extend(node.skin.map(|_| index));
            }
        }
        if let Some(camera) = node.camera {
            placed.camera.get_or_insert((camera.0, transform));
        }
        if let Some(Lenient(Some(NodeLight { light }))) = &node.extensions.light {
            placed.lights.push((index, light.0, transform));
        }
        open.extend(node.children.iter().flatten().rev().map(|child| (child.0, transform)));
    }
    if placed.meshes.is_empty() {
        return Err(broken(&nodes, "no node shows a mesh"));
    }
    Ok(placed)
}

/// Returns the transform of a node relative to its parent.
fn local(node: &Node) -> DMat4 {
    if let Some(matrix) = node.matrix {
        return DMat4::from_cols_array(&matrix);
    }
    let [x, y, z, w] = node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let length = (x * x + y * y + z * z + w * w).sqrt();
    let rotation = match length > 0.0 {
        true => DQuat::from_xyzw(x / length, y / length, z / length, w / length),
        false => DQuat::IDENTITY,
    };
    let scale = node.scale.map_or(DVec3::ONE, DVec3::from);
    DMat4::from_scale_rotation_translation(scale, rotation, node.translation.unwrap_or_default().into())
}

/// Notes the parts of the file's nodes that are left out.
pub fn note_ignored(document: &Document, placed: &Placed, notes: &mut Notes) {
    let (root, place) = (document.root, document.source.root());
    for index in 0..root.animations.len() {
        notes.add(&place.key("animations").item(index), "animations are not played");
    }
    let length = |rotation: [f64; 4]| rotation.map(|x| x * x).iter().sum::<f64>().sqrt();
    let turned = root.nodes.iter().filter_map(|(index, node)| Some((index, length(node.rotation?))));
    for (index, length) in turned.filter(|(_, length)| (length - 1.0).abs() > 0.01) {
        let used = if length > 0.0 { "it is scaled to length 1" } else { "the node is not turned" };
        let what = format!("a rotation has length {length:.3} and not 1: {used}");
        notes.add(&place.key("nodes").item(index), what);
    }
    for &node in &placed.skinned {
        let what = "skins are not read: the mesh is shown as it is without bones";
        notes.add(&place.key("nodes").item(node).key("skin"), what);
    }
    if root.scenes.len() > 1 {
        notes.add(&place.key("scenes"), "the file has several scenes: only one is shown");
    }
    if root.cameras.len() > 1 {
        let what = "the file has several cameras: the first one that a node names is used";
        notes.add(&place.key("cameras"), what);
    }
}
