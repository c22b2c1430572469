//! A ray on its way through a scene, from object to object: the top-level traversal.
//!
//! 1. Take the next object whose box the ray may meet, from the tree over the objects.
//! 2. Intersect a shape that is no mesh at once.
//! 3. A mesh has a tree: return it with the ray in its space. The caller traverses it, for one ray
//!    or for many, and hands the result to [`SceneWalk::take`].

use super::filter::{self, Place};
use super::ray_query::{FirstHit, RayQuery};
use super::ray_state::RayState;
use super::scaled_ray::ScaledRay;
use super::start::met_at_start;
use crate::accel::{END, EachCandidate, MeshQuery, MeshTree, Scratch, WalkStack};
use crate::geometry::{Hit, Ray};
use crate::scene::{ObjectCandidates, Scene};
use crate::shape::triangle::{MeshFilter, Shear};
use crate::shape::{Meshes, Surface};
use crate::simd::{Kernel, Lanes};

/// A mesh that a ray comes to, and the ray in the space of that.
#[derive(Clone, Copy)]
pub(super) struct Instance<'a> {
    pub(super) object: u32,
    pub(super) tree: &'a MeshTree,
    pub(super) mesh: Meshes<'a>,
    pub(super) ray: Ray,
}

/// A ray, and the objects that are still to come.
pub(super) struct SceneWalk<'a, Q> {
    pub(super) state: RayState<Q>,
    objects: ObjectCandidates<'a>,
    /// The objects in the last one's place that are still to come.
    duplicates: &'a [u32],
    /// The next object, where it is [known](Self::look_ahead).
    ahead: Option<u32>,
}

impl<'a, Q: RayQuery> SceneWalk<'a, Q> {
    /// Begins, with some objects to come.
    #[inline(always)]
    pub(super) fn new(state: RayState<Q>, objects: ObjectCandidates<'a>) -> Self {
        Self { state, objects, duplicates: &[], ahead: None }
    }

    /// Leaves the search for objects to the ray's packet.
    pub(super) fn join(&mut self) {
        self.objects = ObjectCandidates::NONE;
    }

    /// Makes an object the next.
    pub(super) fn come_to(&mut self, object: u32) {
        self.ahead = Some(object);
    }

    /// Finds the next object, and asks memory for it. [`next`](Self::next) comes to it after other
    /// rays have done as much.
    #[inline(always)]
    pub(super) fn look_ahead<L: Lanes>(&mut self, l: L, scene: &'a Scene, stack: &mut WalkStack) {
        self.ahead = self.next_object(l, scene, stack);
        if let Some(index) = self.ahead {
            l.prefetch(&scene.objects()[index as usize]);
            if let Some((_, tree)) = scene.at_mesh(index) {
                l.prefetch(tree);
            }
        }
    }

    /// The next mesh, among the objects that are wanted; `None` at the end. Scene and stack are the
    /// same each time. What a filtered ray does not meet of the mesh goes to `in_mesh`.
    #[inline(always)]
    pub(super) fn next<L: Lanes>(
        &mut self,
        l: L,
        (scratch, in_mesh): (&mut Scratch, &mut MeshFilter),
        (scene, stack): (&'a Scene, &mut WalkStack),
        is_wanted: impl Fn(u32) -> bool,
    ) -> Option<Instance<'a>> {
        while self.state.is_open() {
            let index = self.next_object(l, scene, stack)?;
            if !is_wanted(index) {
                continue;
            }
            let state = &mut self.state;
            let scaled = state.scaled.as_ref()?;
            let object = &scene.objects()[index as usize];
            let filter = state.query.filter();
            if Q::IS_FILTERED && !filter::sees_any(scene, filter, index, object) {
                continue;
            }
            let place = Place::Leader(index);
            let ray = if Q::IS_FILTERED {
                filter::in_object(scene, (scaled, filter), place, state.t_max).map(|(ray, own)| {
                    *in_mesh = own;
                    ray
                })
            } else {
                scaled.in_object(object, state.t_max)
            };
            let Some(ray) = ray else {
                continue;
            };
            match scene.at_mesh(index) {
                Some((mesh, tree)) => {
                    let is_plain = scaled.t_scale == 1.0 && !object.has_cutouts();
                    if Q::IS_FILTERED
                        && let Some(met) = met_at_start(scene, filter, (place, &ray, &*in_mesh))
                    {
                        state.cross(scene, index, met);
                    }
                    if Q::IS_FILTERED && in_mesh.leaves_all_of(mesh) {
                        continue;
                    }
                    let is_near = ray.t_min >= 0.0 && !tree.is_distant(ray.origin);
                    let is_near = is_near && (!Q::IS_FILTERED || is_sharp(tree, in_mesh));
                    if is_plain && is_near && tree.has_nodes() {
                        return Some(Instance { object: index, tree, mesh, ray });
                    }
                    TriangleByTriangle {
                        state,
                        scratch,
                        scene,
                        at_mesh: (index, tree, mesh),
                        ray: &ray,
                        in_mesh,
                    }
                    .run(l);
                }
                None => state.meet_shape(scene, (index, object.shape()), &ray),
            }
        }
        None
    }

    /// The next object that may be met.
    #[inline(always)]
    fn next_object<L: Lanes>(
        &mut self,
        l: L,
        scene: &'a Scene,
        stack: &mut WalkStack,
    ) -> Option<u32> {
        if let Some(known) = self.ahead.take() {
            return Some(known);
        }
        if let Some((&copy, rest)) = self.duplicates.split_first() {
            self.duplicates = rest;
            return Some(copy);
        }
        let ray = (self.state.ray()?, self.state.t_max);
        let index = self.objects.next(l, ray, stack)?;
        let object = &scene.objects()[index as usize];
        let filter = self.state.query.filter();
        if Q::ALL || (Q::IS_FILTERED && filter::tells_copies_apart(filter, index, object)) {
            self.duplicates = scene.duplicates().of(index);
        }
        Some(index)
    }
}

/// Whether float32 can tell what is ahead of the start.
fn is_sharp(tree: &MeshTree, in_mesh: &MeshFilter) -> bool {
    let departure = in_mesh.departure();
    departure.is_none_or(|point| tree.is_sharp_from(point))
}

/// The first hit of a ray among some objects that are no meshes and in no other's place, and
/// `known`, which it has met already.
#[inline(always)]
pub(super) fn first_of_shapes(scene: &Scene, ray: &Ray, objects: &[u32], known: Hit) -> Hit {
    let Some(scaled) = ScaledRay::new(ray) else {
        return known;
    };
    let mut first = FirstHit(known);
    let mut t_max = first.t_max(&scaled);
    for &index in objects {
        let object = &scene.objects()[index as usize];
        let crossing =
            scaled.in_object(object, t_max).and_then(|ray| object.shape().intersect(&ray));
        if crossing.is_some() {
            let surface = |primitive| scene.surface_at(index, primitive);
            t_max = first.take(scene, &scaled, surface, crossing);
        }
    }
    first.0
}

/// Intersects a mesh for which the lanes' traversals do not serve: its triangles may be cut out, it
/// has no nodes, or the ray is distant, begins behind its origin, has other units or leaves a
/// triangle that float32 cannot tell from its neighbours.
struct TriangleByTriangle<'r, Q> {
    state: &'r mut RayState<Q>,
    scratch: &'r mut Scratch,
    scene: &'r Scene,
    at_mesh: (u32, &'r MeshTree, Meshes<'r>),
    ray: &'r Ray,
    /// The filter of the ray at the mesh; without meaning for rays without a filter.
    in_mesh: &'r MeshFilter,
}

impl<Q: RayQuery> TriangleByTriangle<'_, Q> {
    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let Self { state, scratch, scene, at_mesh: (index, tree, mesh), ray, in_mesh } = self;
        let filter = if Q::IS_FILTERED { in_mesh } else { &MeshFilter::NONE };
        let shear = Shear::new(ray);
        l.call(EachCandidate {
            scratch,
            at_mesh: (tree, mesh),
            ray,
            off: filter.departure().map_or(0.0, |point| point.off),
            with_copies: Q::ALL || !filter.meets_everything(),
            // Behind the pointer nothing is compiled for the instruction set but what is called as
            // a kernel.
            visit: &mut |triangle, t_max| {
                l.call(OneTriangle {
                    state,
                    scene,
                    at_mesh: (index, mesh, triangle),
                    filter,
                    ray: (ray, &shear),
                    t_max,
                })
            },
        });
    }
}

/// Intersects a triangle for [`TriangleByTriangle`], and returns the `t_max` to continue with.
struct OneTriangle<'r, Q> {
    state: &'r mut RayState<Q>,
    scene: &'r Scene,
    at_mesh: (u32, Meshes<'r>, u32),
    filter: &'r MeshFilter,
    ray: (&'r Ray, &'r Shear),
    t_max: f64,
}

impl<Q: RayQuery> Kernel for OneTriangle<'_, Q> {
    type Output = f64;

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) -> f64 {
        let (index, mesh, triangle) = self.at_mesh;
        let object = &self.scene.objects()[index as usize];
        let group = self.scene.group_led_by(index);
        // Where all triangles of a tree are asked, those of objects that have left are among them.
        if group.is_some_and(|group| group.locate(triangle).is_none()) {
            return self.t_max;
        }
        let direction = self.ray.0.direction;
        if self.filter.leaves_behind(mesh, direction, triangle) {
            return self.t_max;
        }
        let edges = <Q::InMesh as MeshQuery>::EDGES;
        let crossing = object.intersect_triangle(mesh, triangle, (edges, self.filter), self.ray);
        let Some(crossing) = crossing else {
            return self.t_max;
        };
        if !self.filter.has_begun(crossing.t, || mesh.farthest(triangle)) {
            return self.t_max;
        }
        self.state.cross(self.scene, index, crossing);
        if self.state.is_open() { self.t_max.min(self.state.t_max) } else { END }
    }
}
