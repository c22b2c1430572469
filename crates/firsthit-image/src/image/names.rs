//! The names behind identifiers.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

/// The names of what identifiers stand for, each table in the order of the identifiers, from 0 on.
/// `None`: no such channel.
///
/// A table has names of 256 KiB at most, some bytes for each entry included: those beyond are left
/// out, and counted in [`Names::left_out`].
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Names {
    /// The objects.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub object: Option<Vec<ObjectNames>>,
    /// The nodes: their paths from the root, such as `truck/wheel`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub node: Option<Vec<String>>,
    /// The meshes; an empty name for one without.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<Vec<String>>,
    /// The materials; an empty name for one without.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<Vec<String>>,
    /// The number of entries that each table lacks, by its channel, where it lacks any.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub left_out: BTreeMap<String, u64>,
}

/// An object, and what it comes from, by identifiers of the other tables.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ObjectNames {
    /// The object's name; may be empty, need not be unique.
    pub name: String,
    /// The identifier of the node, if the object has one.
    pub node: Option<i32>,
    /// The identifier of the mesh, unless the object is another shape.
    pub mesh: Option<i32>,
    /// The identifiers of the materials, in the order of a mesh's slots.
    pub materials: Vec<i32>,
}

/// The most bytes of a table's names, and what an entry counts beside its name.
const MOST_BYTES: usize = 1 << 18;
const ENTRY_BYTES: usize = 8;

impl Names {
    /// The tables of all objects, nodes, meshes and materials, as far as there is room.
    #[doc(hidden)]
    pub fn new<'a>(
        objects: impl ExactSizeIterator<Item = (&'a str, i32, i32, &'a [i32])>,
        [nodes, meshes, materials]: [&[Arc<str>]; 3],
    ) -> Self {
        let mut names = Self::default();
        let mut table = |of: &str, list: &[Arc<str>]| {
            let entries = list.iter().map(|name| (name.len(), name));
            let taken: Vec<String> = taken(entries).map(ToString::to_string).collect();
            names.lack(of, list.len(), &taken);
            Some(taken)
        };
        let tables = [("node", nodes), ("mesh", meshes), ("material", materials)];
        let [node, mesh, material] = tables.map(|(of, list)| table(of, list));
        let count = objects.len();
        let identifier = |number: i32| (number >= 0).then_some(number);
        let entries = objects.map(|entry| (entry.0.len() + ENTRY_BYTES * entry.3.len(), entry));
        let objects = taken(entries).map(|(name, node, mesh, materials)| ObjectNames {
            name: name.to_owned(),
            node: identifier(node),
            mesh: identifier(mesh),
            materials: materials.to_vec(),
        });
        let objects: Vec<ObjectNames> = objects.collect();
        names.lack("object", count, &objects);
        Self { object: Some(objects), node, mesh, material, ..names }
    }

    fn lack<T>(&mut self, of: &str, count: usize, taken: &[T]) {
        if taken.len() < count {
            let lacking = (count - taken.len()) as u64;
            self.left_out.insert(of.to_owned(), lacking);
        }
    }

    /// The tables that a file with these channels takes: those of the channels, and with `object`
    /// those that its entries name. `None` where there is none.
    pub(super) fn of_channels(self, has: impl Fn(&str) -> bool) -> Option<Self> {
        if has("object") {
            return Some(self);
        }
        let names = Self {
            object: None,
            node: self.node.filter(|_| has("node")),
            mesh: self.mesh.filter(|_| has("mesh")),
            material: self.material.filter(|_| has("material")),
            left_out: (self.left_out.into_iter()).filter(|(of, _)| has(of)).collect(),
        };
        let is_none = names.node.is_none() && names.mesh.is_none() && names.material.is_none();
        (!is_none).then_some(names)
    }
}

/// The first entries, as many as there is room for; each comes with the bytes that it takes.
fn taken<T>(entries: impl Iterator<Item = (usize, T)>) -> impl Iterator<Item = T> {
    let mut bytes: usize = 0;
    let fits = move |(length, _): &(usize, T)| {
        bytes = bytes.saturating_add(length + ENTRY_BYTES);
        bytes <= MOST_BYTES
    };
    entries.take_while(fits).map(|(_, entry)| entry)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_end_where_there_is_no_more_room() {
        let long: Arc<str> = "x".repeat(MOST_BYTES - 3 * ENTRY_BYTES).into();
        let nodes = [long, "a".into(), "b".into(), "c".into()];
        let objects = [("", -1, 0, &[][..]), ("ball", 2, -1, &[1, 0])];
        let names = Names::new(objects.into_iter(), [&nodes, &[], &[]]);
        assert_eq!(names.node.as_ref().unwrap().len(), 2);
        assert_eq!(names.left_out, [("node".to_owned(), 2)].into());
        assert_eq!(names.object.as_ref().unwrap().len(), 2);
        let ball = &names.object.as_ref().unwrap()[1];
        assert_eq!((ball.node, ball.mesh), (Some(2), None));
        assert_eq!(ball.materials, [1, 0]);
        let of_meshes = names.clone().of_channels(|name| name == "mesh").unwrap();
        assert_eq!((of_meshes.mesh, of_meshes.node), (Some(vec![]), None));
        assert!(of_meshes.left_out.is_empty());
        assert_eq!(names.clone().of_channels(|name| name == "t"), None);
        assert_eq!(names.clone().of_channels(|name| name == "object"), Some(names));
    }
}
