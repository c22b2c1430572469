//! The tree over a scene's objects, and the objects that are in none.

mod packet;

use std::collections::HashMap;

use super::duplicates::Duplicates;
use super::joined::ObjectTree;
use super::{Object, extent};
use crate::accel::{Bvh, Nearby, WalkStack};
use crate::geometry::{Beam, Bounds, DVec3, Ray};
pub use packet::PacketCandidates;

/// The most objects without a tree: the box of each is tested.
const FEW: usize = 4;

/// The most objects for which a beam of rays lists those that it may meet, in place of asking the
/// tree ray by ray. Each is a bit of a number.
const LISTED: usize = 64;

/// A list with more lone shapes, or more other objects, serves no better than the tree.
const MOST_SHAPES: u32 = 16;
const MOST_OTHERS: u32 = 8;

/// The growth of the expected number of boxes that a ray meets at which a refitted tree is built
/// anew. It is compared after changes of one object in 32, since that takes as long as refitting
/// that many.
const WORN: f64 = 1.25;
const CHANGES_EACH: usize = 32;

/// Beyond this share of the coordinates, the rounding of one object's transform (it all but
/// flattens space) would widen the boxes of all objects. Then this object goes without a box.
pub(super) const LARGEST_SLACK: f64 = 1e-8;

/// See [the module](self).
#[derive(Debug, Clone)]
pub(super) struct TopTree {
    tree: Bvh,
    /// The objects that are in no tree: they have no finite box, or only a vague one, or there are
    /// so few that asking the tree would take longer.
    outside: Vec<Candidate>,
    /// All objects that may be met, in a tree or not, lone shapes first; none where there are more
    /// than [`LISTED`].
    listed: Vec<Candidate>,
    /// The number of lone shapes among the candidates.
    lone_shapes: u32,
    pub(super) duplicates: Duplicates,
    /// See [`TopTree::only_object`].
    only_object: Option<u32>,
    /// The number of objects.
    count: usize,
    /// The number of boxes a ray was expected to meet when the tree was built.
    expected_visits: f64,
    /// The number of changes since the expected visits were last compared.
    changes: usize,
}

/// An object, and the box that a ray must meet to be a candidate for it.
#[derive(Debug, Clone)]
pub(crate) struct Candidate {
    object: u32,
    bounds: Bounds,
    /// The widening of the box for a ray from far away, as a share of the coordinates of its
    /// origin.
    slack: f64,
    /// Whether the object is no mesh, and no other is in its place.
    is_lone_shape: bool,
}

impl Candidate {
    fn new(objects: &[Object], duplicates: &Duplicates, index: u32, bounds: Bounds) -> Self {
        let object = &objects[index as usize];
        let slack = object.slack().max(Bvh::OBJECTS);
        let is_vague = is_unbounded(&bounds) || object.slack() > LARGEST_SLACK;
        Self {
            object: index,
            bounds: if is_vague { Bounds::EVERYTHING } else { object.padded(bounds, slack) },
            slack,
            is_lone_shape: object.mesh().is_none() && duplicates.of(index).is_empty(),
        }
    }

    /// Whether a ray may meet the object at a parameter of at most `t_max`.
    #[inline(always)]
    fn may_be_met(&self, ray: &Ray, t_max: f64) -> bool {
        let margin = self.slack * ray.origin.abs().max_element();
        self.bounds.may_be_met(&ray.up_to(t_max), margin)
    }

    /// Whether any of some rays may meet the object.
    fn may_be_met_by(&self, beam: &Beam) -> bool {
        let margin = self.slack * beam.farthest();
        beam.may_meet(&self.bounds, margin)
    }
}

impl TopTree {
    /// Builds the tree of objects, at most `i32::MAX`.
    pub(super) fn new(objects: &[Object], trees: &[ObjectTree]) -> Self {
        let boxes = extent::boxes(objects, trees);
        let duplicates = Duplicates::new(objects, trees, &boxes);
        Self::with_duplicates(objects, trees, boxes, duplicates)
    }

    /// Builds the tree as [`new`](Self::new) does, where a box around each object and the
    /// duplicates are known.
    pub(super) fn with_duplicates(
        objects: &[Object],
        trees: &[ObjectTree],
        mut boxes: Vec<Bounds>,
        duplicates: Duplicates,
    ) -> Self {
        let count = u32::try_from(objects.len()).expect("identifiers are numbers of 31 bits");
        for (leader, together) in boxes_together(trees, &boxes) {
            boxes[leader as usize] = together;
        }
        let could_be_in_tree = |k: u32| !is_loose(objects, k as usize, &boxes[k as usize]);
        let is_out = |k: u32| {
            let group = trees[k as usize].group();
            let follows = group.is_some_and(|group| group.leader() != k);
            follows || duplicates.contains(k) || objects[k as usize].is_hidden()
        };
        let loose = (0..count).filter(|&k| !could_be_in_tree(k) && !is_out(k));
        let candidate = |k: u32| Candidate::new(objects, &duplicates, k, boxes[k as usize]);
        let outside = loose.map(candidate).collect();
        let mut listed = Vec::new();
        if objects.len() <= LISTED {
            listed.extend((0..count).filter(|&k| !is_out(k)).map(candidate));
            listed.sort_by_key(|candidate: &Candidate| !candidate.is_lone_shape);
        }
        let slack = (0..count)
            .filter(|&k| could_be_in_tree(k))
            .map(|k| objects[k as usize].slack())
            .fold(Bvh::OBJECTS, f64::max);
        for (k, (object, bounds)) in (0..).zip(objects.iter().zip(&mut boxes)) {
            let is_in = !is_loose(objects, k as usize, bounds) && !is_out(k);
            *bounds = if is_in { object.padded(*bounds, slack) } else { Bounds::EMPTY };
        }
        let tree = Bvh::of(boxes, slack);
        let mut there = (0..count).filter(|&k| !is_out(k));
        let first = there.next();
        let is_one = duplicates.is_empty() && there.next().is_none();
        Self {
            only_object: first.filter(|_| is_one),
            expected_visits: tree.expected_visits(),
            tree,
            outside,
            lone_shapes: (listed.iter().map(|candidate| u32::from(candidate.is_lone_shape))).sum(),
            listed,
            duplicates,
            count: objects.len(),
            changes: 0,
        }
    }

    /// Fits the tree to objects that have changed: they were moved, hidden, shown, given another
    /// shape, or added at the end. Each takes time in proportion to the tree's depth; the first
    /// call also finds all leaves. The tree is built anew once fitted boxes overlap too much.
    pub(super) fn changed(&mut self, objects: &[Object], trees: &[ObjectTree], changed: &[u32]) {
        self.count = objects.len();
        let is_fitted = changed.iter().all(|&index| self.fit(objects, trees, index));
        self.changes += changed.len();
        if !is_fitted || self.is_worn() {
            *self = Self::new(objects, trees);
        }
    }

    /// Whether fitting has made the tree much worse than it was built.
    fn is_worn(&mut self) -> bool {
        if self.changes * CHANGES_EACH < self.count {
            return false;
        }
        self.changes = 0;
        self.tree.expected_visits() > WORN * self.expected_visits
    }

    /// Fits the tree to an object that has changed, if it can be fitted.
    fn fit(&mut self, objects: &[Object], trees: &[ObjectTree], changed: u32) -> bool {
        let object = &objects[changed as usize];
        let is_seen = !object.is_hidden();
        let has_copies = !self.duplicates.of(changed).is_empty();
        let is_odd = has_copies || self.duplicates.contains(changed);
        let is_other = |only| only != changed || !is_seen;
        if is_odd
            || trees[changed as usize].group().is_some()
            || self.only_object.is_some_and(is_other)
        {
            return false;
        }
        let around = || extent::box_around(object, trees[changed as usize].own());
        let bounds = if is_seen { around() } else { Bounds::EMPTY };
        let candidate = Candidate::new(objects, &self.duplicates, changed, bounds);
        if !self.listed.is_empty() {
            let listed = self.listed.iter_mut().find(|listed| listed.object == changed);
            match listed.filter(|it| is_seen && it.is_lone_shape == candidate.is_lone_shape) {
                Some(listed) => *listed = candidate.clone(),
                None => return false,
            }
        }
        let key = |outside: &Candidate| outside.object;
        let loose = self.outside.binary_search_by_key(&changed, key).ok();
        let is_loose = is_seen && is_loose(objects, changed as usize, &bounds);
        let slack = self.tree.slack();
        let Some(place) = loose else {
            let fits = !is_loose && object.slack() <= slack;
            return fits && self.tree.refit(changed, object.padded(bounds, slack));
        };
        self.outside[place] = candidate;
        is_loose
    }

    /// The object that stands for all that rays may meet, if it is one alone and no other is in its
    /// place.
    pub(super) fn only_object(&self) -> Option<u32> {
        self.only_object
    }

    /// Calls `visit` with the objects in whose place something may end beyond what was found, those
    /// in the tree as [`Bvh::each_beyond`] does.
    pub(super) fn each_beyond(
        &self,
        end: [usize; 2],
        mut found: f64,
        mut visit: impl FnMut(u32) -> f64,
    ) {
        for outside in &self.outside {
            found = visit(outside.object);
        }
        self.tree.each_beyond(end, found, visit);
    }

    /// The objects that are in no tree.
    pub(super) fn outside(&self) -> impl Iterator<Item = u32> {
        self.outside.iter().map(|outside| outside.object)
    }

    /// The size of the tree in bytes.
    pub(super) fn bytes(&self) -> usize {
        self.tree.bytes()
    }

    /// The objects that a ray may meet.
    #[inline(always)]
    pub(super) fn candidates(&self) -> ObjectCandidates<'_> {
        ObjectCandidates {
            outside: &self.outside,
            listed: &[],
            left: 0,
            tree: (self.outside.len() < self.count).then_some(&self.tree),
        }
    }
}

impl TopTree {
    /// The objects around a point.
    pub(super) fn around(&self, point: DVec3, stack: &mut WalkStack) -> NearbyObjects<'_> {
        NearbyObjects { outside: &self.outside, nearby: self.tree.nearby(point, stack) }
    }
}

/// See [`TopTree::around`].
#[doc(hidden)]
pub struct NearbyObjects<'a> {
    outside: &'a [Candidate],
    nearby: Nearby<'a>,
}

impl NearbyObjects<'_> {
    /// The next object of which a point may be at a distance with a square of at most `limit`. From
    /// call to call `limit` must not grow, and `stack` must be the same.
    pub fn next(&mut self, limit: f64, stack: &mut WalkStack) -> Option<u32> {
        if let Some((first, rest)) = self.outside.split_first() {
            self.outside = rest;
            return Some(first.object);
        }
        self.nearby.next(limit, stack)
    }
}

impl TopTree {
    /// Whether there is a list of candidates.
    #[inline(always)]
    pub(super) fn lists_candidates(&self) -> bool {
        !self.listed.is_empty()
    }

    /// The objects that any of some rays may meet; `None` where the tree serves better.
    pub(super) fn list_candidates(&self, beam: &Beam) -> Option<CandidateList<'_>> {
        if !self.lists_candidates() || !beam.is_forward() {
            return None;
        }
        let mut met = 0_u64;
        for (bit, listed) in self.listed.iter().enumerate() {
            met |= u64::from(listed.may_be_met_by(beam)) << bit;
        }
        let shapes = met & !u64::MAX.checked_shl(self.lone_shapes).unwrap_or(0);
        let others = met & !shapes;
        let is_short = shapes.count_ones() <= MOST_SHAPES && others.count_ones() <= MOST_OTHERS;
        is_short.then_some(CandidateList { all: &self.listed, shapes, others })
    }
}

/// The objects that some rays may meet, a bit for each of those that are listed.
#[derive(Clone, Copy)]
#[doc(hidden)]
pub struct CandidateList<'a> {
    all: &'a [Candidate],
    shapes: u64,
    others: u64,
}

impl CandidateList<'_> {
    /// The indices of the lone shapes: of objects that are no meshes, and in whose place is no
    /// other.
    #[inline(always)]
    pub fn lone_shapes(self) -> impl Iterator<Item = u32> {
        let mut left = self.shapes;
        std::iter::from_fn(move || {
            let first = self.all.get(left.trailing_zeros() as usize)?;
            left &= left.wrapping_sub(1);
            Some(first.object)
        })
    }

    #[inline(always)]
    pub fn has_lone_shapes(self) -> bool {
        self.shapes != 0
    }

    /// Whether there is anything but lone shapes.
    #[inline(always)]
    pub fn has_others(self) -> bool {
        self.others != 0
    }
}

/// The box around all objects of each group, by its leader.
fn boxes_together(trees: &[ObjectTree], boxes: &[Bounds]) -> HashMap<u32, Bounds> {
    let mut together = HashMap::new();
    for (tree, bounds) in trees.iter().zip(boxes) {
        if let Some(group) = tree.group() {
            let around = together.entry(group.leader()).or_insert(Bounds::EMPTY);
            *around = around.union(*bounds);
        }
    }
    together
}

/// Whether to fit a tree to so many changed objects takes less time than to build it anew.
pub(super) fn are_few(changed: usize, of: usize) -> bool {
    8 * changed <= of
}

/// Whether an object is in no tree.
fn is_loose(objects: &[Object], index: usize, bounds: &Bounds) -> bool {
    objects.len() <= FEW || is_unbounded(bounds) || objects[index].slack() > LARGEST_SLACK
}

pub(super) fn is_unbounded(bounds: &Bounds) -> bool {
    !bounds.is_empty() && !bounds.is_finite()
}

/// See [`TopTree::candidates`].
#[doc(hidden)]
pub struct ObjectCandidates<'a> {
    outside: &'a [Candidate],
    /// The listed candidates, of which those with set bits in `left` count.
    listed: &'a [Candidate],
    left: u64,
    /// The tree over all other objects.
    tree: Option<&'a Bvh>,
}

impl<'a> ObjectCandidates<'a> {
    /// No objects.
    pub const NONE: Self = Self { outside: &[], listed: &[], left: 0, tree: None };

    /// The candidates of a [list](TopTree::list_candidates), with the lone shapes or without.
    #[inline(always)]
    pub fn among(listed: CandidateList<'a>, with_shapes: bool) -> Self {
        let shapes = if with_shapes { listed.shapes } else { 0 };
        Self { outside: &[], listed: listed.all, left: listed.others | shapes, tree: None }
    }
}

impl<'a> ObjectCandidates<'a> {
    /// The next object outside of the tree that `ray` may meet at a parameter of at most `t_max`.
    /// From call to call `t_max` must not grow, and `ray` must be the same.
    #[inline(always)]
    pub fn next_outside(&mut self, ray: &Ray, t_max: f64) -> Option<u32> {
        while let Some(first) = self.listed.get(self.left.trailing_zeros() as usize) {
            self.left &= self.left.wrapping_sub(1);
            if first.may_be_met(ray, t_max) {
                return Some(first.object);
            }
        }
        while let Some((first, rest)) = self.outside.split_first() {
            self.outside = rest;
            if first.may_be_met(ray, t_max) {
                return Some(first.object);
            }
        }
        None
    }

    /// The tree over the objects that are not outside, if there is one.
    #[inline(always)]
    pub fn tree(&self) -> Option<&'a Bvh> {
        self.tree
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Transform;
    use crate::shape::Sphere;

    /// Balls in places without order, other ones for another seed, all of them `beside` those.
    fn balls(seed: u64, beside: f64) -> Vec<Object> {
        let mut state = seed;
        let mut coordinate = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 40) as f64 * 1e-5 + beside
        };
        let ball = Sphere::new(DVec3::ZERO, 1.0).unwrap();
        let mut place = || DVec3::new(coordinate(), coordinate(), coordinate());
        (0..200)
            .map(|_| Object::new(ball).placed(Transform::translation(place()).unwrap()))
            .collect()
    }

    fn no_trees(objects: &[Object]) -> Vec<ObjectTree> {
        vec![ObjectTree::None; objects.len()]
    }

    fn tree(objects: &[Object]) -> TopTree {
        TopTree::new(objects, &no_trees(objects))
    }

    /// The order of the tree's nodes and boxes.
    fn order(top: &TopTree) -> Vec<(u32, u32)> {
        top.tree.children().collect()
    }

    #[test]
    fn after_all_objects_moved_a_ray_meets_as_many_boxes_as_in_a_new_scene() {
        let before = balls(1, 0.0);
        for step in [200_u32, 50, 7] {
            let mut fitted = tree(&before);
            let mut objects = before.clone();
            let after = balls(2, 0.0);
            for first in (0..200_u32).step_by(step as usize) {
                let moved: Vec<u32> = (first..200.min(first + step)).collect();
                for &k in &moved {
                    objects[k as usize] = after[k as usize].clone();
                }
                fitted.changed(&objects, &no_trees(&objects), &moved);
                let built = tree(&objects).tree.expected_visits();
                let visits = fitted.tree.expected_visits();
                assert!(visits < 2.0 * built, "{step} {first}: {visits}, {built} where it is new");
            }
            let built = tree(&objects).tree.expected_visits();
            assert!(fitted.tree.expected_visits() < 1.5 * built, "{step}");
        }
    }

    #[test]
    fn a_tree_that_is_as_good_as_new_is_not_built_anew() {
        let mut fitted = tree(&balls(1, 0.0));
        let (visits, before) = (fitted.tree.expected_visits(), order(&fitted));
        let all: Vec<u32> = (0..200).collect();
        for step in 0..300 {
            let objects = balls(1, 1e-6 * f64::from(step));
            fitted.changed(&objects, &no_trees(&objects), &all);
        }
        assert!((fitted.tree.expected_visits() / visits - 1.0).abs() < 1e-3);
        assert_eq!(order(&fitted), before);
    }
}
