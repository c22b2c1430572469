//! How far scenes reach: boxes around objects, and the smallest one around all.

use rayon::prelude::*;

use super::{Object, Scene, top_tree};
use crate::accel::MeshTree;
use crate::geometry::{Bounds, DVec3};
use crate::parallel;

impl Scene {
    /// The smallest box around all objects in the world, infinite and hidden ones left out; empty without any.
    pub fn bounds(&self) -> Bounds {
        *parallel::once(&self.bounds, || {
            let visible = |&k: &usize| !self.objects[k].is_hidden();
            let numbers: Vec<usize> = (0..self.objects.len()).filter(visible).collect();
            smallest(&numbers, self.top.boxes(), |k| {
                smallest_box(&self.objects[k], self.mesh_tree(k))
            })
        })
    }

    /// A box that no ray meets anything outside of, a little larger than [`bounds`](Self::bounds); `None` where something has no end.
    pub(crate) fn blocking_bounds(&self) -> Option<Bounds> {
        let mut boxed = self.objects.iter().zip(self.top.boxes());
        let is_endless =
            || boxed.any(|(object, bounds)| !object.is_hidden() && top_tree::is_unbounded(bounds));
        if *parallel::once(&self.endless, is_endless) {
            return None;
        }
        let Bounds { low, high } = self.bounds();
        let margin = 1e-9 * low.abs().max(high.abs()).max_element();
        Some(Bounds {
            low: low - margin,
            high: high + margin,
        })
    }

    /// The support function: the largest dot product of `direction` with a point of the scene, for a direction of any length.
    /// Infinite and hidden objects are left out; minus infinity for a scene without others.
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

/// A box around an object in the world in constant time. Of a turned mesh it is wider than the smallest one.
pub(super) fn box_around(object: &Object, tree: Option<&MeshTree>) -> Bounds {
    let transform = object.transform();
    let is_turned = object.mesh().is_some() && !transform.keeps_axes();
    let turned = tree.filter(|_| is_turned);
    turned
        .and_then(|tree| tree.transformed_bounds(transform.world_from_object()))
        .unwrap_or_else(|| object.box_around())
}

/// [`Object::bounds`], found by the tree of its mesh.
fn smallest_box(object: &Object, tree: Option<&MeshTree>) -> Bounds {
    let transform = object.transform();
    let turned = object.mesh().zip(tree).filter(|_| !transform.keeps_axes());
    turned
        .and_then(|(mesh, tree)| tree.smallest_bounds(mesh, transform.world_from_object()))
        .unwrap_or_else(|| object.bounds())
}

/// The box around the smallest boxes of some objects, of which `boxes` has wider ones. For each end the objects are asked whose wide box
/// goes beyond what was found, the farthest first.
fn smallest(numbers: &[usize], boxes: &[Bounds], of: impl Fn(usize) -> Bounds) -> Bounds {
    let mut found = Bounds::EMPTY;
    let is_bounded = |&&k: &&usize| !boxes[k].is_empty() && boxes[k].is_finite();
    for axis in 0..3 {
        for is_high in [false, true] {
            let reach = |bounds: &Bounds| {
                if is_high {
                    bounds.high[axis]
                } else {
                    -bounds.low[axis]
                }
            };
            let mut farthest: Vec<(f64, usize)> = (numbers.iter().filter(is_bounded))
                .map(|&k| (reach(&boxes[k]), k))
                .filter(|&(bound, _)| bound > reach(&found))
                .collect();
            farthest.sort_unstable_by(|(a, _), (b, _)| b.total_cmp(a));
            for (bound, k) in farthest {
                if bound <= reach(&found) {
                    break;
                }
                found = found.union(of(k));
            }
        }
    }
    found
}

/// Something of each object, by its number. Few objects may take long each, and of many each takes little.
pub(super) fn in_parts<T: Send>(
    objects: &[Object],
    of: impl Fn(usize, &Object) -> T + Sync,
) -> Vec<T> {
    const MOST_PARTS: usize = 1024;
    let size = objects.len().div_ceil(MOST_PARTS).max(1);
    parallel::gather(objects.chunks(size).enumerate(), |(part, objects)| {
        let numbered = (part * size..).zip(objects);
        numbered.map(|(index, object)| of(index, object)).collect()
    })
}

/// See [`Scene::support`]. Objects are visited in the order of the bounds that their boxes give, until no bound that is left
/// exceeds the largest product found: of many instances of a mesh, the vertices of a few are visited.
pub(crate) fn support(objects: &[Object], direction: DVec3) -> f64 {
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

    /// Numbers from -1 to 1 that look random.
    fn numbers(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed;
        move || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / f64::from(1 << 23) - 1.0
        }
    }

    /// Turned, sheared and mirrored copies of a cloud of triangles, whose corners are float32 or not, at a place.
    fn turned(single: bool, place: DVec3) -> Scene {
        let mut number = numbers(7);
        let round = |x: f64| {
            if single {
                DVec3::splat(x).as_vec3().as_dvec3().x
            } else {
                x
            }
        };
        let points: Vec<[f64; 3]> = (0..900)
            .map(|_| [number(), number(), number()].map(round))
            .collect();
        let triangles = (0..300).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        let mesh = Arc::new(Mesh::new(Positions::compact(points), triangles).unwrap());
        let objects = (0..40).map(|k| {
            let mut vector = || DVec3::new(number(), number(), number());
            let turn = DQuat::from_scaled_axis(3.0 * vector());
            let scale = vector() + DVec3::splat(1.5 * f64::from(1 - k % 2 * 2));
            let affine =
                DAffine3::from_scale_rotation_translation(scale, turn, place + 3.0 * vector());
            Object::new(Arc::clone(&mesh)).placed(Transform::new(affine).unwrap())
        });
        Scene::new(objects.collect()).unwrap()
    }

    #[test]
    fn bounds_of_turned_instances_are_those_of_all_their_corners() {
        for (single, place) in [
            (true, DVec3::ZERO),
            (false, DVec3::ZERO),
            (false, DVec3::new(5e5, 5e6, 300.0)),
        ] {
            let scene = turned(single, place);
            let mut all = Bounds::EMPTY;
            for (k, object) in scene.objects().iter().enumerate() {
                let exact = object.bounds();
                assert_eq!(
                    smallest_box(object, scene.mesh_tree(k)),
                    exact,
                    "{single} {place} {k}"
                );
                let wide = scene.boxes()[k];
                let size = exact.size().max_element();
                // What is outside of the smallest box comes of the children's corners.
                assert!((wide.size() - exact.size()).max_element() < 0.5 * size);
                let slack = 1e-9 * place.length();
                assert!(
                    wide.low.cmple(exact.low + slack).all(),
                    "{wide:?} {exact:?}"
                );
                assert!(
                    wide.high.cmpge(exact.high - slack).all(),
                    "{wide:?} {exact:?}"
                );
                all = all.union(exact);
            }
            assert_eq!(scene.bounds(), all);
        }
    }
}
