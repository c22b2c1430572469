//! Brute force: every ray against everything, in float64. Slow, and right by construction.

use super::engine::Engine;
use super::query::Answers;
use super::ray_query::{AnyHit, EveryHit, FirstHit, RayQuery, Sink};
use super::scaled_ray::ScaledRay;
use crate::accel::MeshQuery;
use crate::error::{Error, Result};
use crate::geometry::{Hit, Ray, Rays};
use crate::scene::{Object, Scene};
use crate::shape::{Crossing, Shape, Surface, triangle::Shear};
use crate::watch::Watch;

/// The reference: what every faster engine is tested against.
#[derive(Debug, Clone, Copy)]
pub struct BruteForce;

impl Engine for BruteForce {
    fn first_hit(&self, scene: &Scene, ray: &Ray) -> Hit {
        let FirstHit(hit) = answer(scene, ray);
        hit
    }

    fn any_hit(&self, scene: &Scene, ray: &Ray) -> bool {
        let AnyHit(is_hit) = answer(scene, ray);
        is_hit
    }

    fn trace(
        &self,
        scene: &Scene,
        rays: &dyn Rays,
        answers: Answers<'_>,
        watch: &dyn Watch,
    ) -> Result<()> {
        assert_eq!(answers.count(), Some(rays.len()), "an answer for each ray");
        match answers {
            Answers::First(hits) => answer_all(scene, rays, hits, watch),
            Answers::Any(found) => answer_all(scene, rays, found, watch),
            Answers::Count(counts) => answer_all(scene, rays, counts, watch),
            Answers::All(all) => all.fill(scene, rays, watch, |first, lists| {
                for (index, list) in (first..).zip(lists) {
                    let EveryHit(found) = answer(scene, &rays.ray(index));
                    *list = found;
                }
            }),
        }
    }
}

fn answer_all<S: Sink>(
    scene: &Scene,
    rays: &dyn Rays,
    mut sink: S,
    watch: &dyn Watch,
) -> Result<()> {
    for index in 0..rays.len() {
        if watch.is_stopped() {
            return Err(Error::Interrupted);
        }
        sink.put(index, &answer(scene, &rays.ray(index)));
        watch.advance(1);
    }
    Ok(())
}

/// Shows all hits of a ray to a query.
fn answer<Q: RayQuery>(scene: &Scene, ray: &Ray) -> Q {
    let mut query = Q::START;
    let Some(scaled) = ScaledRay::new(ray) else {
        return query;
    };
    for (index, object) in (0..).zip(scene.objects()) {
        all_crossings::<Q::InMesh>(&scaled, object, |crossing| {
            if scaled.hit(index, crossing).is_some() {
                let found = Q::InMesh::of_crossing(Some(crossing));
                query.take(scene, &scaled, index, found);
            }
        });
    }
    query
}

/// Calls `accept` with every crossing of an object's surface.
fn all_crossings<Q: MeshQuery>(
    scaled: &ScaledRay,
    object: &Object,
    mut accept: impl FnMut(Crossing),
) {
    let Some(ray) = scaled.in_object(object, scaled.ray.t_max) else {
        return;
    };
    let Shape::Mesh(mesh) = object.shape() else {
        let crossings = object.shape().crossings(&ray);
        crossings.into_iter().flatten().for_each(accept);
        return;
    };
    let shear = Shear::new(&ray);
    for triangle in 0..mesh.triangles().len() {
        let crossing = object.intersect_triangle(mesh, triangle, Q::EDGES, (&ray, &shear));
        if let Some(crossing) = crossing {
            accept(crossing);
        }
    }
}
