//! Objects that no ray ever meets first: the same surface at the same place as an earlier one.
//!
//! Files repeat themselves, and some do to keep a renderer busy: a thousand objects in one place are a thousand
//! tests for every ray, and the first of them wins them all.

use std::collections::HashMap;
use std::sync::Arc;

use super::Object;
use crate::geometry::Bounds;
use crate::shape::Shape;

/// With how many earlier objects of the same bounds one is compared.
const MOST: usize = 4;

/// For each object whether an earlier one has its every hit, at the same `t`.
pub(super) fn covered(objects: &[Object], bounds: &[Bounds]) -> Vec<bool> {
    let mut first: HashMap<[u64; 6], Vec<usize>> = HashMap::new();
    let mut covered = vec![false; objects.len()];
    for (index, (object, bounds)) in objects.iter().zip(bounds).enumerate() {
        let ends = [bounds.low, bounds.high].map(|end| end.to_array().map(f64::to_bits));
        let [[a, b, c], [d, e, f]] = ends;
        let earlier = first.entry([a, b, c, d, e, f]).or_default();
        let is_covered = earlier.iter().any(|&other| covers(&objects[other], object));
        covered[index] = is_covered;
        // What has holes covers nothing.
        if !is_covered && earlier.len() < MOST && !object.has_cutouts() {
            earlier.push(index);
        }
    }
    covered
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
        let glass = Material {
            alpha_mode: AlphaMode::Mask { cutoff: 0.5 },
            ..Material::default()
        };
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
        let expected = [
            false, false, true, true, false, false, false, false, true, false,
        ];
        assert_eq!(covered(&objects, &bounds), expected);
    }
}
