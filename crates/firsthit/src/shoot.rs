//! Rays to hits: what does this ray meet first, and does it meet anything?
//!
//! [`Trees`] and [`BruteForce`] propose candidates; the same float64 code decides about them, so both give
//! the same bits. Brute force is the judge that every faster way is tested against.

use rayon::prelude::*;

use crate::accel::{Candidates, Everything};
use crate::error::{Error, Result};
use crate::geometry::{DVec2, DVec3, Hit, Ray, Rays, moderation};
use crate::scene::{Object, Scene};
use crate::shape::{Mesh, Shape, Surface, triangle::Shear};
use crate::watch::Watch;

/// The first object on the ray `p + t * u_r`: the smallest `t > 0`, and at the same `t` the lower
/// (object, primitive). `u_r` need not be of length one; a ray that is zero, infinite or NaN misses.
pub fn shoot(scene: &Scene, p: DVec3, u_r: DVec3) -> Hit {
    first_hit::<Trees>(scene, &Ray::new(p, u_r))
}

/// Whether anything is at `0 < t <= t_max` on the ray `p + t * u_r`. Sooner known than the first hit.
pub fn occluded(scene: &Scene, p: DVec3, u_r: DVec3, t_max: f64) -> bool {
    any_hit(scene, &Ray::new(p, u_r).up_to(t_max))
}

/// [`occluded`] for a ray with its own `t_max`.
pub fn any_hit(scene: &Scene, ray: &Ray) -> bool {
    let mut found = false;
    search::<Trees>(scene, ray, |_| {
        found = true;
        f64::NEG_INFINITY
    });
    found
}

/// Where candidates come from.
pub trait Search {
    /// Visits the objects that the ray may meet, see [`Candidates::visit`].
    fn objects(scene: &Scene, ray: &Ray, visit: impl FnMut(u32, f64) -> f64);
    /// Visits the triangles of the mesh of an object that the ray, in object space, may meet.
    fn triangles(
        scene: &Scene,
        object: u32,
        mesh: &Mesh,
        ray: &Ray,
        visit: impl FnMut(u32, f64) -> f64,
    );
}

/// The trees propose.
#[derive(Debug, Clone, Copy)]
pub struct Trees;

impl Search for Trees {
    fn objects(scene: &Scene, ray: &Ray, mut visit: impl FnMut(u32, f64) -> f64) {
        let mut ray = *ray;
        for &object in scene.unbounded() {
            ray.t_max = visit(object, ray.t_max);
            if ray.t_max < 0.0 {
                return;
            }
        }
        scene.tree().visit(&ray, visit);
    }

    fn triangles(
        scene: &Scene,
        object: u32,
        _: &Mesh,
        ray: &Ray,
        visit: impl FnMut(u32, f64) -> f64,
    ) {
        if let Some(tree) = scene.mesh_tree(object as usize) {
            tree.visit(ray, visit);
        }
    }
}

/// Everything is proposed: slow, and right.
#[derive(Debug, Clone, Copy)]
pub struct BruteForce;

impl Search for BruteForce {
    fn objects(scene: &Scene, ray: &Ray, visit: impl FnMut(u32, f64) -> f64) {
        Everything(count(scene.objects().len())).visit(ray, visit);
    }

    fn triangles(_: &Scene, _: u32, mesh: &Mesh, ray: &Ray, visit: impl FnMut(u32, f64) -> f64) {
        Everything(count(mesh.triangles().len())).visit(ray, visit);
    }
}

fn count(length: usize) -> u32 {
    u32::try_from(length).expect("scenes and meshes hold at most i32::MAX things")
}

/// The first hit of `ray`, the candidates coming from `S`.
pub fn first_hit<S: Search>(scene: &Scene, ray: &Ray) -> Hit {
    let mut first = Hit::MISS;
    search::<S>(scene, ray, |hit| {
        if hit.precedes(&first) {
            first = hit;
        }
        first.t
    });
    first
}

/// Calls `accept` with every hit among the candidates, in any order; it returns the `t` beyond which
/// hits no longer matter, negative to end the search.
fn search<S: Search>(scene: &Scene, ray: &Ray, mut accept: impl FnMut(Hit) -> f64) {
    if !ray.is_valid() {
        return;
    }
    // Shapes square the direction. Where that would leave the range of float64, `t` is counted in other units.
    let scale = moderation(ray.direction);
    let moderate = Ray::new(ray.origin, scale * ray.direction).up_to(ray.t_max / scale);
    let mut accept = |hit: Hit| {
        let t = scale * hit.t;
        if t > 0.0 && t <= ray.t_max && t.is_finite() {
            accept(Hit { t, ..hit }) / scale
        } else {
            f64::INFINITY
        }
    };
    S::objects(scene, &moderate, |index, t_max| {
        let object = &scene.objects()[index as usize];
        let ray = object.transform().ray_in_object(&moderate.up_to(t_max));
        // A transform can take a ray's numbers out of the range of float64.
        if ray.is_valid() {
            search_object::<S>(scene, index, object, &ray, &mut accept)
        } else {
            t_max
        }
    });
}

/// [`search`] in one object, in its space; returns the `t_max` to go on with.
fn search_object<S: Search>(
    scene: &Scene,
    index: u32,
    object: &Object,
    ray: &Ray,
    accept: &mut impl FnMut(Hit) -> f64,
) -> f64 {
    let id = identifier(index);
    let mut t_max = ray.t_max;
    if let Shape::Mesh(mesh) = object.shape() {
        let shear = Shear::new(ray);
        let has_holes = object.may_have_holes();
        S::triangles(scene, index, mesh, ray, |triangle, limit| {
            if let Some(hit) = mesh.intersect_triangle(triangle as usize, &shear)
                && hit.t > 0.0
                && hit.t <= limit
                && !(has_holes && object.is_hole(mesh, triangle as usize, hit.barycentric))
            {
                let primitive = identifier(triangle);
                t_max = limit.min(accept(Hit {
                    t: hit.t,
                    object: id,
                    primitive,
                    barycentric: hit.barycentric,
                }));
            }
            t_max
        });
    } else if let Some(hit) = object.shape().intersect(ray) {
        t_max = t_max.min(accept(Hit {
            t: hit.t,
            object: id,
            primitive: hit.primitive,
            barycentric: hit.barycentric,
        }));
    }
    t_max
}

fn identifier(index: u32) -> i32 {
    i32::try_from(index).expect("scenes and meshes hold at most i32::MAX things")
}

/// What many rays met, an array for each quantity; see [`Hit`] for their meaning.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Hits {
    /// The rays' parameters, infinity for a miss.
    pub t: Vec<f64>,
    /// The objects' identifiers, -1 for a miss.
    pub object: Vec<i32>,
    /// The primitives' identifiers, -1 for a miss.
    pub primitive: Vec<i32>,
    /// The weights of a triangle's corners 1 and 2, else NaN.
    pub barycentric: Vec<DVec2>,
}

impl Hits {
    /// How many rays there were.
    pub fn len(&self) -> usize {
        self.t.len()
    }

    /// Whether there were none.
    pub fn is_empty(&self) -> bool {
        self.t.is_empty()
    }

    /// What the ray `index` met.
    ///
    /// # Panics
    ///
    /// When there was no such ray.
    pub fn get(&self, index: usize) -> Hit {
        Hit {
            t: self.t[index],
            object: self.object[index],
            primitive: self.primitive[index],
            barycentric: self.barycentric[index],
        }
    }
}

/// How many rays a thread takes at a time: enough to be worth it, few enough to stop within a moment.
const BATCH: usize = 1024;

/// [`shoot`] for many rays, by all threads of the current rayon pool. The order is that of the rays, and
/// the result does not depend on the number of threads.
///
/// # Errors
///
/// [`Error::Limit`] when the result does not fit into memory, [`Error::Interrupted`] when `watch` stops it.
pub fn shoot_all<R: Rays + ?Sized>(scene: &Scene, rays: &R, watch: &dyn Watch) -> Result<Hits> {
    let count = rays.len();
    let mut hits = Hits {
        t: filled(count, Hit::MISS.t)?,
        object: filled(count, Hit::MISS.object)?,
        primitive: filled(count, Hit::MISS.primitive)?,
        barycentric: filled(count, Hit::MISS.barycentric)?,
    };
    hits.t
        .par_chunks_mut(BATCH)
        .zip(hits.object.par_chunks_mut(BATCH))
        .zip(hits.primitive.par_chunks_mut(BATCH))
        .zip(hits.barycentric.par_chunks_mut(BATCH))
        .enumerate()
        .try_for_each(|(batch, (((t, object), primitive), barycentric))| {
            if watch.is_stopped() {
                return Err(Error::Interrupted);
            }
            for k in 0..t.len() {
                let hit = first_hit::<Trees>(scene, &rays.ray(batch * BATCH + k));
                (t[k], object[k], primitive[k], barycentric[k]) =
                    (hit.t, hit.object, hit.primitive, hit.barycentric);
            }
            watch.advance(t.len() as u64);
            Ok(())
        })?;
    Ok(hits)
}

/// A vector of `count` times `value`, or an error instead of an abort when memory is short.
pub(crate) fn filled<T: Clone>(count: usize, value: T) -> Result<Vec<T>> {
    let mut vec = Vec::new();
    vec.try_reserve_exact(count).map_err(|_| Error::Limit {
        what: "elements of a result",
        got: count.to_string(),
        limit: "the memory there is".into(),
    })?;
    vec.resize(count, value);
    Ok(vec)
}
