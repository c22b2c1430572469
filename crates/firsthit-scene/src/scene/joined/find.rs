//! Finds the objects that share a tree.

use std::collections::HashMap;
use std::sync::Arc;

use super::Group;
use crate::accel::MeshTree;
use crate::error::Result;
use crate::geometry::{Bounds, DVec3};
use crate::scene::top_tree::LARGEST_SLACK;
use crate::scene::{Object, Scene, extent};
use crate::shape::{Mesh, Positions};

/// Triangles smaller than this share of what all joined objects reach over are left out.
const FINEST: f64 = 1.0 / (1 << 18) as f64;

/// The properties that joined objects have in common: their transform, to the last bit, their mask,
/// and the type of their vertices.
pub(super) type Key = ([u64; 12], u32, bool);

/// `None` for an object that is in no group.
pub(super) fn key(object: &Object) -> Option<Key> {
    let mesh = object.mesh()?;
    let is_plain = !object.has_cutouts() && !object.is_hidden() && !object.is_out_of_range();
    let has_triangles = !mesh.triangles().is_empty();
    let is_sound = object.slack() <= LARGEST_SLACK;
    let transform = object.transform().world_from_object();
    let are_single = matches!(mesh.positions().as_ref(), Positions::Single(_));
    (is_plain && has_triangles && is_sound)
        .then(|| (transform.to_cols_array().map(f64::to_bits), object.mask(), are_single))
}

/// The number of uses of each mesh in the scene, and an object that has it.
fn uses(objects: &[Object]) -> HashMap<*const Mesh, (u32, usize)> {
    let mut uses: HashMap<*const Mesh, (u32, usize)> = HashMap::new();
    let mesh_of = |object: &Object| object.mesh().map(Arc::as_ptr);
    let mut first = 0;
    // Instances mostly stand side by side.
    for same in objects.chunk_by(|one, other| mesh_of(one) == mesh_of(other)) {
        if let Some(mesh) = mesh_of(&same[0]) {
            uses.entry(mesh).or_insert((first, 0)).1 += same.len();
        }
        first += u32::try_from(same.len()).expect("identifiers are numbers of 31 bits");
    }
    uses
}

/// The objects that may be joined, each with its key, in their order.
fn candidates(objects: &[Object]) -> Vec<(u32, Key)> {
    let once = uses(objects).into_values().filter(|&(_, count)| count == 1);
    let with_key = |(index, _): (u32, usize)| Some((index, key(&objects[index as usize])?));
    let mut candidates: Vec<(u32, Key)> = once.filter_map(with_key).collect();
    if candidates.len() < 2 {
        return Vec::new();
    }
    candidates.sort_unstable_by_key(|&(index, _)| index);
    // An object in the place of another has the same box.
    let boxes = extent::in_parts(objects, |_, object| {
        let Bounds { low, high } = object.mesh().map(|_| object.box_around())?;
        Some([low, high].map(|end| end.to_array().map(f64::to_bits)))
    });
    let mut alike: HashMap<_, usize> = HashMap::with_capacity(candidates.len());
    for &(index, _) in &candidates {
        alike.insert(boxes[index as usize], 0);
    }
    for around in &boxes {
        if let Some(count) = alike.get_mut(around) {
            *count += 1;
        }
    }
    candidates.retain(|&(index, _)| alike[&boxes[index as usize]] == 1);
    candidates
}

/// The groups of a scene before that are there still, without the objects that have changed.
pub(in crate::scene) fn kept(
    objects: &[Object],
    before: &Scene,
    is_good_enough: impl Fn(&MeshTree) -> bool,
) -> Vec<Arc<Group>> {
    let groups = before.groups().filter(|group| is_good_enough(&group.tree));
    let groups: Vec<&Arc<Group>> = groups.collect();
    if groups.is_empty() {
        return Vec::new();
    }
    let mesh = |object: u32| objects[object as usize].mesh().map(Arc::as_ptr);
    let there: HashMap<_, (u32, Key)> = candidates(objects)
        .into_iter()
        .filter_map(|(object, key)| Some((mesh(object)?, (object, key))))
        .collect();
    let keep = |group: &Arc<Group>| {
        let found = |object: u32| {
            let mesh = before.objects[object as usize].mesh()?;
            there.get(&Arc::as_ptr(mesh))
        };
        let common = key(&before.objects[group.leader as usize])?;
        let new = |object| {
            let (object, key) = found(object)?;
            (*key == common).then_some(*object)
        };
        if group.members().all(|(object, _)| new(object) == Some(object)) {
            return Some(Arc::clone(group));
        }
        let kept = Group::clone(group).keeping(new);
        kept.filter(Group::is_dense).map(Arc::new)
    };
    groups.into_iter().filter_map(keep).collect()
}

/// Joins objects that `may_join`, and has trees built over them. Those that there is no memory for
/// stay alone.
///
/// # Errors
///
/// [`Error::Interrupted`](crate::error::Error::Interrupted).
pub(in crate::scene) fn found(
    objects: &[Object],
    may_join: impl Fn(u32) -> bool,
    build: &impl Fn(&Mesh) -> Result<MeshTree>,
) -> Result<Vec<Arc<Group>>> {
    let mut by_key: HashMap<Key, Vec<u32>> = HashMap::new();
    let candidates = candidates(objects).into_iter();
    for (object, key) in candidates.filter(|&(object, _)| may_join(object)) {
        by_key.entry(key).or_default().push(object);
    }
    let mut all: Vec<Vec<u32>> = by_key.into_values().collect();
    all.sort_unstable();
    let alike = all.into_iter().flat_map(|members| in_sizes(objects, members));
    let groups = alike.filter_map(|members| Group::build(members, objects, build));
    groups.map(|group| group.map(Arc::new)).collect()
}

/// Whether objects fill the box around them so much that a ray through it is expected to come to
/// one.
fn are_dense(members: &[u32], around: impl Fn(&u32) -> Bounds) -> bool {
    /// Boxes that a ray meets, at least.
    const FEWEST: f64 = 0.5;
    let half_area = |bounds: Bounds| {
        let DVec3 { x, y, z } = bounds.size();
        x * y + y * z + z * x
    };
    let boxes = members.iter().map(&around);
    let whole = boxes.clone().fold(Bounds::EMPTY, Bounds::union);
    boxes.map(half_area).sum::<f64>() >= FEWEST * half_area(whole)
}

/// Parts objects so that float32 tells the triangles of each part from one another. Those that are
/// alone, or far apart, are left out: a ray would come to their tree for nothing.
fn in_sizes(objects: &[Object], mut members: Vec<u32>) -> Vec<Vec<u32>> {
    let mesh = |member: u32| objects[member as usize].mesh();
    let mut parts = Vec::new();
    while members.len() > 1 {
        let around = |&member: &u32| mesh(member).map_or(Bounds::EMPTY, |mesh| mesh.bounds());
        let whole = members.iter().map(around).fold(Bounds::EMPTY, Bounds::union);
        let least = FINEST * whole.size().max_element();
        let is_coarse = |&member: &u32| {
            mesh(member).is_some_and(|mesh| {
                let size = mesh.bounds().size().max_element();
                size >= least * (mesh.triangles().len() as f64).sqrt()
            })
        };
        let (coarse, fine): (Vec<u32>, Vec<u32>) = members.into_iter().partition(is_coarse);
        let is_over = coarse.is_empty();
        if coarse.len() > 1 && are_dense(&coarse, around) {
            parts.push(coarse);
        }
        if is_over {
            break;
        }
        members = fine;
    }
    parts
}
