//! Objects in the same place as an earlier one.
//!
//! Files repeat themselves, and some do so to keep a renderer busy: a thousand objects in one place
//! would be a thousand tests for every ray, and the first of them wins them all. Queries that ask
//! for all hits visit them after the first.

use std::collections::HashMap;
use std::sync::Arc;

use super::Object;
use super::joined::ObjectTree;
use crate::geometry::Bounds;
use crate::shape::Shape;

/// The most earlier objects with equal bounds that an object is compared with.
const MOST: usize = 4;

/// The objects whose every hit an earlier one has too, at the same `t`. No ray meets them first, so
/// they are left out of trees.
#[derive(Debug, Clone, Default)]
#[doc(hidden)]
pub struct Duplicates {
    is_duplicate: Vec<bool>,
    /// The duplicates of each object, by its index.
    of: HashMap<u32, Vec<u32>>,
}

impl Duplicates {
    /// An object that shares a tree has none, and is none.
    pub(super) fn new(objects: &[Object], trees: &[ObjectTree], bounds: &[Bounds]) -> Self {
        let mut found = Self { is_duplicate: vec![false; objects.len()], of: HashMap::new() };
        let ends = |&[_, index]: &[u32; 2]| ends(&bounds[index as usize]);
        let asked = (0..).zip(objects.iter().zip(trees));
        let asked =
            asked.filter(|(_, (object, tree))| !object.is_hidden() && tree.group().is_none());
        // Equal boxes have equal sums. To sort them takes a tenth of the memory of a map.
        let mut asked: Vec<[u32; 2]> =
            asked.map(|(index, _)| [check_sum(ends(&[0, index])), index]).collect();
        asked.sort_unstable();
        for alike in asked.chunk_by_mut(|[one, _], [other, _]| one == other) {
            if alike.len() > 1 {
                alike.sort_by_key(ends);
                for equal in alike.chunk_by(|one, other| ends(one) == ends(other)) {
                    found.compare(objects, equal.iter().map(|&[_, index]| index));
                }
            }
        }
        found
    }

    /// Finds the duplicates among objects with equal bounds, in the order of their numbers.
    fn compare(&mut self, objects: &[Object], equal: impl Iterator<Item = u32>) {
        let mut earlier: Vec<u32> = Vec::new();
        for index in equal {
            let object = &objects[index as usize];
            let is_same = |&&other: &&u32| covers(&objects[other as usize], object);
            if let Some(&other) = earlier.iter().find(is_same) {
                self.is_duplicate[index as usize] = true;
                self.of.entry(other).or_default().push(index);
            } else if earlier.len() < MOST && !object.has_cutouts() {
                // An object with cut-outs covers nothing.
                earlier.push(index);
            }
        }
    }

    /// Builds the lists from pairs of an object and its duplicate; `None` where an index is out of
    /// range, the first is the later one, or an object is a duplicate of two.
    pub(super) fn from_pairs(objects: usize, pairs: &[[u32; 2]]) -> Option<Self> {
        let mut found = Self { is_duplicate: vec![false; objects], of: HashMap::new() };
        for &[first, other] in pairs {
            let is_duplicate = found.is_duplicate.get_mut(other as usize)?;
            if first >= other || *is_duplicate {
                return None;
            }
            *is_duplicate = true;
            found.of.entry(first).or_default().push(other);
        }
        let is_first = |first: &u32| !found.contains(*first);
        found.of.keys().all(is_first).then_some(found)
    }

    /// Pairs of an object and its duplicate, in the order of the duplicates.
    pub fn pairs(&self) -> Vec<[u32; 2]> {
        let of = self.of.iter();
        let pairs = of.flat_map(|(&first, others)| others.iter().map(move |&other| [first, other]));
        let mut pairs: Vec<[u32; 2]> = pairs.collect();
        pairs.sort_unstable_by_key(|&[_, other]| other);
        pairs
    }

    pub(super) fn is_empty(&self) -> bool {
        self.of.is_empty()
    }

    /// Whether an object is in the place of an earlier one.
    #[inline]
    pub fn contains(&self, object: u32) -> bool {
        // Of one that is new it was not asked.
        self.is_duplicate.get(object as usize).is_some_and(|&is_duplicate| is_duplicate)
    }

    /// The objects in the place of one.
    #[inline]
    pub fn of(&self, object: u32) -> &[u32] {
        self.of.get(&object).map_or(&[], Vec::as_slice)
    }
}

/// The bits of a box.
fn ends(bounds: &Bounds) -> [u64; 6] {
    let [[a, b, c], [d, e, f]] = [bounds.low, bounds.high].map(|end| end.to_array());
    [a, b, c, d, e, f].map(f64::to_bits)
}

/// Another number for nearly every other box.
fn check_sum(ends: [u64; 6]) -> u32 {
    let mix =
        |sum: u64, bits: u64| (sum ^ bits).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(32);
    (ends.into_iter().fold(0, mix) >> 32) as u32
}

/// Whether two objects are the same surface at the same place, to the last bit.
fn covers(a: &Object, b: &Object) -> bool {
    let is_same = match (a.shape(), b.shape()) {
        (Shape::Mesh(a), Shape::Mesh(b)) => Arc::ptr_eq(a, b) || a.is_congruent(b),
        (a, b) => a == b,
    };
    is_same && a.transform() == b.transform()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{DAffine3, DVec3, Transform};
    use crate::scene::{AlphaMode, Material};
    use crate::shape::{Mesh, Positions, Sphere};

    fn triangle(z: f64) -> Object {
        let corners = vec![[0.0, 0.0, z], [1.0, 0.0, z], [0.0, 1.0, z]];
        let mesh = Mesh::new(Positions::compact(corners), vec![[0, 1, 2]]).unwrap();
        Object::new(Arc::new(mesh))
    }

    #[test]
    fn only_what_an_earlier_object_hides_wholly_is_covered() {
        let ball = Object::new(Sphere::new(DVec3::ZERO, 1.0).unwrap());
        let moved = |object: &Object, z: f64| {
            let transform = Transform::translation(DVec3::new(0.0, 0.0, z)).unwrap();
            object.clone().placed(transform)
        };
        let glass = Material { alpha_mode: AlphaMode::Mask { cutoff: 0.5 }, ..Material::default() };
        let holes = triangle(0.0).with_materials([glass]);
        let half_turn = DAffine3::from_scale(DVec3::new(-1.0, -1.0, 1.0));
        let objects = [
            holes.clone(),
            triangle(0.0),
            triangle(0.0).colored(DVec3::ONE),
            holes,
            triangle(1.0),
            moved(&triangle(1.0), 1.0),
            ball.clone(),
            moved(&ball, 1.0),
            ball.clone(),
            // In the same bounds, and still not the same to the last bit.
            ball.placed(Transform::new(half_turn).unwrap()),
        ];
        let bounds: Vec<Bounds> = objects.iter().map(Object::bounds).collect();
        let expected = [false, false, true, true, false, false, false, false, true, false];
        let duplicates = Duplicates::new(&objects, &vec![ObjectTree::None; objects.len()], &bounds);
        assert_eq!(duplicates.is_duplicate, expected);
        assert_eq!(duplicates.of(1), [2, 3]);
        assert_eq!(duplicates.of(6), [8]);
        assert!(duplicates.of(0).is_empty());
    }
}
