//! The node hierarchy: which nodes the scene shows, and where they are.

use super::super::fault::Checked;
use super::super::report::Report;
use super::document::{Document, Node};
use super::index::Index;
use super::place::Entry;
use crate::error::{Place, escape_controls};
use crate::geometry::{DAffine3, DMat3, DVec3};
use crate::scene::Label;

/// A node of the scene.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placed<'a> {
    pub(super) index: usize,
    pub(super) node: &'a Node<'a>,
    /// The place of the node that it is a child of, among those that the scene shows.
    pub(super) parent: Option<usize>,
    pub(super) world_from_node: DAffine3,
}

impl Placed<'_> {
    pub(super) fn entry(&self) -> Entry {
        Entry::new("nodes", self.index)
    }

    /// The node's name, or else that of what it places, if either has one.
    pub(super) fn name(&self, other: Option<&str>) -> Option<String> {
        let names = [self.node.name.as_deref(), other].into_iter().flatten();
        names.map(escape_controls).find(|name| !name.is_empty())
    }
}

/// A path is cut at its beginning where it would have more bytes: nodes may form long chains.
const LONGEST_PATH: usize = 512;

/// The label of the node at a place among those that the scene shows: its index and its path, the
/// names of the nodes from the root on. A node without a name is called by its index.
pub(super) fn label(placed: &[Placed<'_>], place: usize) -> Label {
    let mut names = Vec::new();
    let mut bytes = 0;
    let mut next = Some(place);
    while let Some(node) = next.and_then(|place| placed.get(place)) {
        let name = node.name(None);
        let name = name.unwrap_or_else(|| format!("node {}", node.index));
        bytes += name.len() + 1;
        if bytes > LONGEST_PATH && !names.is_empty() {
            names.push("...".to_owned());
            break;
        }
        names.push(name);
        next = node.parent;
    }
    names.reverse();
    let number = placed.get(place).map_or(0, |node| node.index as u64);
    Label { number, name: names.join("/").into() }
}

/// The nodes of the scene that the document shows: its default scene, else its first, else all
/// nodes that are no node's children. Depth first, children in their order.
pub(super) fn walk<'a>(
    document: &'a Document<'a>,
    report: &mut Report,
) -> Checked<Vec<Placed<'a>>> {
    let mut found: Vec<Placed<'a>> = Vec::new();
    let mut reached = vec![false; document.nodes.len()];
    // Explicit: a chain of nodes may be longer than the call stack.
    let roots = roots(document).into_iter().rev();
    let mut stack: Vec<(Root, Option<usize>)> = roots.map(|root| (root, None)).collect();
    while let Some(((Index(index), world_from_parent, from, place), parent)) = stack.pop() {
        let Some(node) = document.nodes.get(index) else {
            continue;
        };
        if let Some(reached) = reached.get_mut(index)
            && std::mem::replace(reached, true)
        {
            let list = if from.list == "nodes" { "children" } else { "nodes" };
            let what = format!("node {index} is reached twice: nodes must form trees");
            return Err(from.fault(format!("{list}/{place}"), what));
        }
        let entry = Entry::new("nodes", index);
        let world_from_node = world_from_parent * local(node, entry, report);
        let children = node.children.iter().enumerate().rev();
        let this = found.len();
        let child = |(k, &child)| ((child, world_from_node, entry, k), Some(this));
        stack.extend(children.map(child));
        found.push(Placed { index, node, parent, world_from_node });
    }
    Ok(found)
}

/// A node that is to be placed: its index, where its parent is, and which entry of which list names
/// it.
type Root = (Index, DAffine3, Entry, usize);

fn roots(document: &Document<'_>) -> Vec<Root> {
    let Index(default) = document.scene.unwrap_or_default();
    if let Some(scene) = document.scenes.get(default) {
        let nodes = scene.nodes.iter().enumerate();
        let entry = Entry::new("scenes", default);
        return nodes.map(|(k, &node)| (node, DAffine3::IDENTITY, entry, k)).collect();
    }
    let mut is_child = vec![false; document.nodes.len()];
    for &Index(child) in document.nodes.iter().flat_map(|node| &node.children) {
        if let Some(is_child) = is_child.get_mut(child) {
            *is_child = true;
        }
    }
    let roots = is_child.iter().enumerate().filter(|(_, is_child)| !**is_child);
    roots.map(|(k, _)| (Index(k), DAffine3::IDENTITY, Entry::new("nodes", k), 0)).collect()
}

/// A node's own transform.
fn local(node: &Node<'_>, entry: Entry, report: &mut Report) -> DAffine3 {
    let Some(matrix) = node.matrix.as_deref() else {
        let rotation = node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]);
        // Three digits are what many files have, and other programs take those as they are.
        let rotation = of_length_one((rotation, 1e-3), || entry.at("rotation"), report);
        let translation = node.translation.unwrap_or_default();
        return affine(translation, rotation, node.scale.unwrap_or([1.0; 3]));
    };
    if node.translation.is_some() || node.rotation.is_some() || node.scale.is_some() {
        report.warn("matrix and parts", &entry.place(), || {
            "has a matrix and a translation, rotation or scale, which exclude each other: \
             the matrix is taken"
                .to_owned()
        });
    }
    let [a, b, c, w0, d, e, f, w1, g, h, i, w2, x, y, z, w3] = *matrix;
    if [w0, w1, w2, w3] != [0.0, 0.0, 0.0, 1.0] {
        report.warn("matrix", &entry.at("matrix"), || {
            format!("the last row must be 0 0 0 1, and is taken to be, not {w0} {w1} {w2} {w3}")
        });
    }
    DAffine3::from_cols_array(&[a, b, c, d, e, f, g, h, i, x, y, z])
}

/// A quaternion made one of length one, if it is off by more than some `rounding`. Those of bytes
/// and of few digits are; more is a warning.
pub(super) fn of_length_one(
    (quaternion, rounding): ([f64; 4], f64),
    place: impl FnOnce() -> Place,
    report: &mut Report,
) -> [f64; 4] {
    let largest = quaternion.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    // Scaled first: squares of very large and very small numbers leave float64.
    let scaled = quaternion.map(|x| x / largest);
    let length = largest * scaled.iter().map(|x| x * x).sum::<f64>().sqrt();
    let off = (length - 1.0).abs();
    if off <= rounding {
        return quaternion;
    }
    let is_usable = largest > 0.0 && largest.is_finite();
    if off > 1e-2 || !is_usable {
        let taken = if is_usable { "is made so" } else { "is taken for no rotation" };
        report.warn("rotation", &place(), || {
            format!("the quaternion {quaternion:?} is not of length one, and {taken}")
        });
    }
    if !is_usable {
        return [0.0, 0.0, 0.0, 1.0];
    }
    scaled.map(|x| x * (largest / length))
}

/// The map that scales, then turns by a quaternion (x, y, z, w), then moves.
pub(super) fn affine(translation: [f64; 3], [x, y, z, w]: [f64; 4], scale: [f64; 3]) -> DAffine3 {
    let rotation = DMat3::from_cols(
        DVec3::new(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)),
        DVec3::new(2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)),
        DVec3::new(2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y)),
    );
    DAffine3 {
        matrix3: rotation * DMat3::from_diagonal(scale.into()),
        translation: translation.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transforms_scale_then_turn_then_move() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        // A quarter turn about z takes x to y.
        let map = affine([1.0, 2.0, 3.0], [0.0, 0.0, half, half], [2.0, 3.0, 4.0]);
        let image = map.transform_point3(DVec3::new(1.0, 1.0, 1.0));
        assert!((image - DVec3::new(1.0 - 3.0, 2.0 + 2.0, 3.0 + 4.0)).length() < 1e-14, "{image}");
    }
}
