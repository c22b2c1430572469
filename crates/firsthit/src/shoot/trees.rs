//! One ray through the trees: the objects on its way, and in each mesh the triangles.

use std::cell::Cell;

use super::Search;
use super::object::{Moderate, identifier};
use crate::accel::{self, Scratch};
use crate::geometry::{Hit, Ray};
use crate::scene::{Object, Scene};
use crate::shape::{Crossing, Mesh, Shape, Surface, triangle::Shear};
use crate::simd::{self, Kernel, Lanes};

/// The trees propose, float64 decides.
#[derive(Debug, Clone, Copy)]
pub struct Trees;

impl Search for Trees {
    fn first_hit(scene: &Scene, ray: &Ray) -> Hit {
        simd::run(scene.instruction_set(), First(scene, ray))
    }
}

thread_local! {
    /// What single rays work with; made once for each thread.
    static SCRATCH: Cell<Option<Scratch>> = const { Cell::new(None) };
}

struct First<'a>(&'a Scene, &'a Ray);

impl Kernel for First<'_> {
    type Output = Hit;

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> Hit {
        let mut scratch = SCRATCH.take().unwrap_or_else(Scratch::new);
        let hit = first_hit(l, &mut scratch, self.0, self.1);
        SCRATCH.set(Some(scratch));
        hit
    }
}

/// [`super::any_hit`].
pub(super) struct Any<'a>(pub(super) &'a Scene, pub(super) &'a Ray);

impl Kernel for Any<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> bool {
        let mut scratch = SCRATCH.take().unwrap_or_else(Scratch::new);
        let is_hit = any_hit(l, &mut scratch, self.0, self.1);
        SCRATCH.set(Some(scratch));
        is_hit
    }
}

/// The first hit of `ray`.
#[inline(always)]
pub(super) fn first_hit<L: Lanes>(l: L, scratch: &mut Scratch, scene: &Scene, ray: &Ray) -> Hit {
    first_hit_among(l, scratch, scene, ray, Hit::MISS, |_| true)
}

/// The first of a hit that is known and of those in the objects that are wanted.
#[inline(always)]
pub(super) fn first_hit_among<L: Lanes>(
    l: L,
    scratch: &mut Scratch,
    scene: &Scene,
    ray: &Ray,
    known: Hit,
    is_wanted: impl Fn(u32) -> bool,
) -> Hit {
    let mut first = known;
    let Some(moderate) = Moderate::new(ray) else {
        return first;
    };
    let mut t_max = moderate.ray.t_max.min(known.t / moderate.scale);
    let mut objects = scene.on_the_way(&moderate.ray);
    while let Some(index) = objects.next(t_max) {
        if !is_wanted(index) {
            continue;
        }
        let object = &scene.objects()[index as usize];
        let Some(ray) = moderate.in_object(object, t_max) else {
            continue;
        };
        let crossing = match (object.shape(), scene.mesh_tree(index as usize)) {
            (Shape::Mesh(mesh), Some(tree)) if is_plain(&moderate, object) => {
                accel::first(l, scratch, (tree, mesh), &ray)
            }
            (Shape::Mesh(mesh), Some(tree)) => {
                let mut first: Option<Crossing> = None;
                accel::each(l, scratch, (tree, mesh), &ray, |triangle, t_max| {
                    if let Some(new) = checked(&moderate, object, mesh, triangle as usize, &ray)
                        && first.is_none_or(|old| (new.t, new.primitive) < (old.t, old.primitive))
                    {
                        first = Some(new);
                    }
                    first.map_or(t_max, |first| first.t)
                });
                first
            }
            (shape, _) => shape.intersect(&ray),
        };
        if let Some(hit) = crossing.and_then(|crossing| moderate.hit(index, crossing))
            && hit.precedes(&first)
        {
            first = hit;
            t_max = t_max.min(first.t / moderate.scale);
        }
    }
    first
}

/// Whether `ray` hits anything.
#[inline(always)]
pub(super) fn any_hit<L: Lanes>(l: L, scratch: &mut Scratch, scene: &Scene, ray: &Ray) -> bool {
    let Some(moderate) = Moderate::new(ray) else {
        return false;
    };
    let t_max = moderate.ray.t_max;
    let mut objects = scene.on_the_way(&moderate.ray);
    while let Some(index) = objects.next(t_max) {
        let object = &scene.objects()[index as usize];
        let Some(ray) = moderate.in_object(object, t_max) else {
            continue;
        };
        let is_hit = match (object.shape(), scene.mesh_tree(index as usize)) {
            (Shape::Mesh(mesh), Some(tree)) if is_plain(&moderate, object) => {
                accel::any(l, scratch, (tree, mesh), &ray)
            }
            (Shape::Mesh(mesh), Some(tree)) => {
                let mut is_hit = false;
                accel::each(l, scratch, (tree, mesh), &ray, |triangle, t_max| {
                    is_hit = checked(&moderate, object, mesh, triangle as usize, &ray).is_some();
                    if is_hit { -1.0 } else { t_max }
                });
                is_hit
            }
            (shape, _) => {
                let crossing = shape.intersect(&ray);
                crossing
                    .and_then(|crossing| moderate.hit(index, crossing))
                    .is_some()
            }
        };
        if is_hit {
            return true;
        }
    }
    false
}

/// Whether all that a mesh's triangles meet is a hit.
#[inline(always)]
fn is_plain(moderate: &Moderate, object: &Object) -> bool {
    moderate.scale == 1.0 && !object.may_have_holes()
}

/// The hit in a triangle, if it is one.
#[cold]
fn checked(
    moderate: &Moderate,
    object: &Object,
    mesh: &Mesh,
    triangle: usize,
    ray: &Ray,
) -> Option<Crossing> {
    let hit = mesh.intersect_triangle(triangle, &Shear::new(ray))?;
    let is_within = hit.t > 0.0 && hit.t <= ray.t_max;
    let is_hole = || object.may_have_holes() && object.is_hole(mesh, triangle, hit.barycentric);
    let crossing = hit.crossing(identifier(triangle));
    // In the caller's units `t` may be too small for float64.
    (is_within && moderate.hit(0, crossing).is_some() && !is_hole()).then_some(crossing)
}
