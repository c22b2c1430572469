//! Brute force: every ray against everything, in float64. Slow, and right by construction.

use super::Search;
use super::object::{Moderate, identifier};
use crate::geometry::{Hit, Ray};
use crate::scene::{Object, Scene};
use crate::shape::{Shape, Surface, triangle::Shear};

/// The judge: what every faster way is tested against.
#[derive(Debug, Clone, Copy)]
pub struct BruteForce;

impl Search for BruteForce {
    fn first_hit(scene: &Scene, ray: &Ray) -> Hit {
        let mut first = Hit::MISS;
        let Some(moderate) = Moderate::new(ray) else {
            return first;
        };
        for (index, object) in (0..).zip(scene.objects()) {
            all_hits(&moderate, index, object, |hit| {
                if moderate.precedes(scene, &hit, &first) {
                    first = hit;
                }
            });
        }
        first
    }
}

/// Calls `accept` with every hit in an object.
fn all_hits(moderate: &Moderate, index: u32, object: &Object, mut accept: impl FnMut(Hit)) {
    let Some(ray) = moderate.in_object(object, moderate.ray.t_max) else {
        return;
    };
    let Shape::Mesh(mesh) = object.shape() else {
        let hit = object.shape().intersect(&ray);
        hit.and_then(|hit| moderate.hit(index, hit)).map(accept);
        return;
    };
    let shear = Shear::new(&ray);
    for triangle in 0..mesh.triangles().len() {
        if let Some(hit) = mesh.intersect_triangle(triangle, &shear)
            && ray.holds(hit.t)
            && !(object.has_cutouts() && object.is_cut_out(mesh, triangle, hit.barycentric))
        {
            let hit = hit.crossing(identifier(triangle));
            moderate.hit(index, hit).map(&mut accept);
        }
    }
}
