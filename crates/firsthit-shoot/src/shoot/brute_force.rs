//! Brute force: every ray against everything, in float64. Slow, and right by construction.

use super::engine::Engine;
use super::filter::{self, Place};
use super::query::Answers;
use super::ray_query::{AnyHit, EveryHit, FirstHit, RayQuery, Sink};
use super::scaled_ray::ScaledRay;
use super::start::met_at_start;
use crate::accel::MeshQuery;
use crate::error::Result;
use crate::geometry::{Hit, Ray, RayFilter, Rays, SurfaceId};
use crate::scene::Scene;
use crate::shape::{Crossing, Shape, triangle::Shear};
use crate::watch::{Watch, stop_if_asked};

/// The reference: what every faster engine is tested against.
#[derive(Debug, Clone, Copy)]
pub struct BruteForce;

impl Engine for BruteForce {
    fn first_hit(&self, scene: &Scene, ray: &Ray) -> Hit {
        let FirstHit(hit) = answer(scene, ray, &RayFilter::NONE);
        hit
    }

    fn any_hit(&self, scene: &Scene, ray: &Ray) -> bool {
        let AnyHit(is_hit) = answer(scene, ray, &RayFilter::NONE);
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
                    // The caller looks too, and says so.
                    if watch.is_stopped() {
                        break;
                    }
                    let EveryHit(found) = answer_of(scene, rays, index);
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
        stop_if_asked(watch)?;
        sink.put(index, &answer_of(scene, rays, index));
        watch.advance(1);
    }
    Ok(())
}

fn answer_of<Q: RayQuery>(scene: &Scene, rays: &dyn Rays, index: usize) -> Q {
    let filter = if rays.is_filtered() { rays.filter(index) } else { RayFilter::NONE };
    answer(scene, &rays.ray(index), &filter)
}

/// Shows all hits of a ray to a query.
fn answer<Q: RayQuery>(scene: &Scene, ray: &Ray, filter: &RayFilter) -> Q {
    let mut query = Q::START;
    let Some(scaled) = ScaledRay::filtered(ray, filter) else {
        return query;
    };
    for index in 0..u32::try_from(scene.objects().len()).unwrap_or(u32::MAX) {
        all_crossings::<Q::InMesh>(scene, (&scaled, filter), index, |crossing| {
            if scaled.holds(&crossing) {
                let found = Q::InMesh::of_crossing(Some(crossing));
                let surface = |primitive| SurfaceId { object: index.cast_signed(), primitive };
                query.take(scene, &scaled, surface, found);
            }
        });
    }
    query
}

/// Calls `accept` with every crossing of an object's surface that the ray meets.
fn all_crossings<Q: MeshQuery>(
    scene: &Scene,
    (scaled, filter): (&ScaledRay, &RayFilter),
    index: u32,
    mut accept: impl FnMut(Crossing),
) {
    let object = &scene.objects()[index as usize];
    if !filter::sees(filter, index, object) {
        return;
    }
    let t_max = scaled.ray.t_max;
    let Some((ray, of_mesh)) =
        filter::in_object(scene, (scaled, filter), Place::Object(index), t_max)
    else {
        return;
    };
    let Shape::Mesh(mesh) = object.shape() else {
        let crossings = filter::crossings(filter, index, object.shape(), (&ray, scaled.t_scale));
        crossings.into_iter().flatten().for_each(accept);
        return;
    };
    met_at_start(scene, filter, (Place::Object(index), &ray, &of_mesh))
        .into_iter()
        .for_each(&mut accept);
    let shear = Shear::new(&ray);
    for triangle in 0..u32::try_from(mesh.triangles().len()).unwrap_or(u32::MAX) {
        let how = (Q::EDGES, &of_mesh);
        let crossing =
            object.intersect_triangle(mesh.as_ref().into(), triangle, how, (&ray, &shear));
        if let Some(crossing) = crossing {
            accept(crossing);
        }
    }
}
