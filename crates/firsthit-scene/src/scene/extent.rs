//! The extent of scenes: boxes around objects, and the smallest one around all.

use std::sync::Arc;

use rayon::prelude::*;

use super::{Group, Object, ObjectTree, Scene, top_tree};
use crate::accel::MeshTree;
use crate::geometry::{Bounds, DVec3};
use crate::parallel;

impl Scene {
    /// The smallest box around all objects in the world, infinite and hidden ones left out; empty
    /// without any.
    pub fn bounds(&self) -> Bounds {
        *parallel::once(&self.derived.places.bounds, || self.smallest_bounds())
    }

    /// Finds the smallest box around all objects. For each end it asks those objects for their
    /// smallest boxes whose wide boxes go beyond what was found, the farthest first.
    fn smallest_bounds(&self) -> Bounds {
        let mut found = Bounds::EMPTY;
        for end in 0..6 {
            let [axis, side] = [end / 2, end % 2];
            let end = |bounds: &Bounds| [bounds.low, bounds.high][side][axis];
            let reach = |bounds: &Bounds| [-1.0, 1.0][side] * end(bounds);
            self.top.each_beyond([axis, side], end(&found), |object| {
                let mut farthest: Vec<(f64, usize)> = (self.standing_in_for(object))
                    .map(|k| (self.box_around(k), k))
                    .filter(|(around, _)| !around.is_empty() && around.is_finite())
                    .map(|(around, k)| (reach(&around), k))
                    .collect();
                farthest.sort_unstable_by(|(a, _), (b, _)| b.total_cmp(a));
                for (bound, k) in farthest {
                    if bound > reach(&found) {
                        found = found.union(self.smallest_box(k));
                    }
                }
                end(&found)
            });
        }
        found
    }

    /// The objects that one stands for in the tree over the objects.
    fn standing_in_for(&self, object: u32) -> impl Iterator<Item = usize> {
        let group = self.group_led_by(object);
        let alone = group.is_none().then_some(object);
        let members = group.into_iter().flat_map(Group::members).map(|(member, _)| member);
        members.chain(alone).map(|k| k as usize)
    }

    /// See [`box_around`]; of a hidden object too.
    #[doc(hidden)]
    pub fn box_around(&self, index: usize) -> Bounds {
        box_around(&self.objects[index], self.trees[index].own())
    }

    /// A box around each object, from which the tree over them is made.
    #[doc(hidden)]
    pub fn boxes(&self) -> Vec<Bounds> {
        boxes(&self.objects, &self.trees)
    }

    /// [`Object::bounds`] of an object, found by the tree of its mesh.
    #[doc(hidden)]
    pub fn smallest_box(&self, index: usize) -> Bounds {
        let object = &self.objects[index];
        let transform = object.transform();
        let tree = self.trees[index].own();
        let turned = object.mesh().zip(tree).filter(|_| !transform.keeps_axes());
        turned
            .and_then(|(mesh, tree)| {
                tree.smallest_bounds(mesh.as_ref().into(), transform.world_from_object())
            })
            .unwrap_or_else(|| object.bounds())
    }

    /// A box that no ray meets anything outside of, a little larger than [`bounds`](Self::bounds);
    /// `None` where something has no end.
    #[doc(hidden)]
    pub fn blocking_bounds(&self) -> Option<Bounds> {
        let has_no_end = |object| top_tree::is_unbounded(&self.box_around(object as usize));
        let is_endless = || self.top.outside().any(has_no_end);
        if *parallel::once(&self.derived.places.endless, is_endless) {
            return None;
        }
        let Bounds { low, high } = self.bounds();
        let margin = 1e-9 * low.abs().max(high.abs()).max_element();
        Some(Bounds { low: low - margin, high: high + margin })
    }

    /// The support function: the largest dot product of `direction` with a point of the scene, for
    /// a direction of any length. Infinite and hidden objects are left out; minus infinity for a
    /// scene without others.
    ///
    /// It is exact for every shape, where [`bounds`](Self::bounds) is a box around it.
    ///
    /// ```
    /// use firsthit::{DVec3, Object, Scene, Sphere};
    ///
    /// let ball = Sphere::new(DVec3::new(1.0, 0.0, 0.0), 2.0)?;
    /// let scene = Scene::new(vec![Object::new(ball)])?;
    /// assert_eq!(scene.support(DVec3::X), 3.0);
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    pub fn support(&self, direction: DVec3) -> f64 {
        support(&self.objects, direction)
    }
}

/// A box around an object in the world in constant time. Of a turned mesh it is wider than the
/// smallest one, which would take longer to find than it saves rays.
pub(super) fn box_around(object: &Object, tree: Option<&Arc<MeshTree>>) -> Bounds {
    let transform = object.transform();
    let is_turned = object.mesh().is_some() && !transform.keeps_axes();
    let turned = tree.filter(|_| is_turned);
    turned
        .and_then(|tree| tree.transformed_bounds(transform.world_from_object()))
        .unwrap_or_else(|| object.box_around())
}

/// A box around each object. Few objects are the calling thread's alone, and need no pool.
pub(super) fn boxes(objects: &[Object], trees: &[ObjectTree]) -> Vec<Bounds> {
    let around = |index: usize| box_around(&objects[index], trees[index].own());
    parallel::gather_each(objects.len(), parallel::MANY, around)
}

/// Something of each object, by its number. Few objects may take long each, and of many each takes
/// little.
pub(super) fn in_parts<T: Send>(
    objects: &[Object],
    of: impl Fn(usize, &Object) -> T + Sync,
) -> Vec<T> {
    const MOST_PARTS: usize = 1024;
    let size = objects.len().div_ceil(MOST_PARTS).max(1);
    parallel::gather_each(objects.len(), size, |index| of(index, &objects[index]))
}

/// See [`Scene::support`]. Objects are visited in the order of the bounds that their boxes give,
/// until no bound that is left exceeds the largest product found: of many instances of a mesh, the
/// vertices of a few are visited.
#[doc(hidden)]
pub fn support(objects: &[Object], direction: DVec3) -> f64 {
    let bound = |index, object: &Object| (object.support_bound(direction), index);
    let mut bounds: Vec<(f64, usize)> = in_parts(objects, bound);
    bounds.retain(|&(bound, index)| bound < f64::INFINITY && !objects[index].is_hidden());
    bounds.par_sort_unstable_by(|(a, _), (b, _)| b.total_cmp(a));
    let mut farthest = f64::NEG_INFINITY;
    for (bound, index) in bounds {
        if bound <= farthest {
            break;
        }
        farthest = farthest.max(objects[index].support(direction));
    }
    // Of zeros with two signs `max` may return either, from machine to machine.
    farthest + 0.0
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::geometry::{DAffine3, DQuat, Transform};
    use crate::shape::{Mesh, Positions};

    /// Turned, sheared and mirrored copies of triangles whose corners are `points`, around a place.
    fn turned(points: Positions, place: DVec3) -> Scene {
        let triangles = (0..100).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        let mesh = Arc::new(Mesh::new(points, triangles).unwrap());
        let size = mesh.bounds().size().max_element();
        let mut number = numbers();
        let objects = (0..40).map(|k| {
            let mut vector = || DVec3::from([number(), number(), number()]);
            // Where it is hardly turned, the corners of boxes are those of the mesh.
            let turn = DQuat::from_scaled_axis([3.0, 1e-12][k % 4 / 3] * vector());
            let scale = vector() + DVec3::splat([1.5, -1.5][k % 2]);
            let linear = DAffine3::from_scale_rotation_translation(scale, turn, DVec3::ZERO);
            let middle = linear.transform_point3(mesh.bounds().centre());
            let to_place = DAffine3::from_translation(place - middle + 3.0 * size * vector());
            Object::new(Arc::clone(&mesh)).placed(Transform::new(to_place * linear).unwrap())
        });
        Scene::new(objects.collect()).unwrap()
    }

    /// Numbers between -1 and 1, by a linear congruential generator.
    fn numbers() -> impl FnMut() -> f64 {
        let mut state = 7_u64;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        }
    }

    #[test]
    fn bounds_of_turned_instances_are_those_of_all_their_corners() {
        let utm = DVec3::new(5e5, 5e6, 300.0);
        let mut number = numbers();
        let mut cloud = |size: f64, middle: DVec3| -> Vec<DVec3> {
            let mut point = || middle + size * DVec3::from([number(), number(), number()]);
            (0..300).map(|_| point()).collect()
        };
        let double =
            |points: Vec<DVec3>| Positions::Double(points.iter().map(DVec3::to_array).collect());
        let single = |points: Vec<DVec3>| {
            Positions::Single(points.iter().map(|point| point.as_vec3().to_array()).collect())
        };
        for (points, place) in [
            (single(cloud(1.0, DVec3::ZERO)), DVec3::ZERO),
            (single(cloud(1.0, utm)), DVec3::ZERO),
            (double(cloud(1.0, DVec3::ZERO)), utm),
            (double(cloud(1.0, utm)), utm),
            // A few steps of float64 large.
            (double(cloud(1e-8, utm)), DVec3::ZERO),
        ] {
            let scene = turned(points, place);
            let mut all = Bounds::EMPTY;
            for (k, object) in scene.objects().iter().enumerate() {
                let exact = object.bounds();
                assert_eq!(scene.smallest_box(k), exact, "{place} {k}");
                let wide = scene.boxes()[k];
                let is_around = wide.low.cmple(exact.low) & wide.high.cmpge(exact.high);
                assert!(is_around.all(), "{wide:?} {exact:?}");
                all = all.union(exact);
            }
            assert_eq!(scene.bounds(), all);
        }
    }

    /// A rod along the diagonal of its mesh's box, turned to lie along an axis: that box turned
    /// with it is 3 wide.
    #[test]
    fn the_box_around_a_turned_rod_is_close_to_it() {
        let places = (0..3_000).map(|k| [k as f32 / 1_500.0 - 1.0; 3]);
        let triangles = (0..1_000).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        let mesh = Arc::new(Mesh::new(Positions::Single(places.collect()), triangles).unwrap());
        let turn = DQuat::from_rotation_arc(DVec3::ONE.normalize(), DVec3::X);
        let rod = Object::new(mesh).placed(Transform::new(DAffine3::from_quat(turn)).unwrap());
        let scene = Scene::new(vec![rod]).unwrap();
        let width = |bounds: Bounds| bounds.size().y;
        assert!(width(scene.objects()[0].box_around()) > 2.5);
        assert!(width(scene.boxes()[0]) < 0.4, "{:?}", scene.boxes());
        assert!(width(scene.bounds()) < 1e-6, "{:?}", scene.bounds());
    }
}
