//! A ray on its way through a scene, from object to object: the top-level traversal.
//!
//! 1. Take the next object whose box the ray may meet. Through the tree over the objects the caller
//!    takes it, one ray or many ([`Walks`]).
//! 2. Intersect a shape that is no mesh at once.
//! 3. A mesh has a tree: return it with the ray in its space. The caller traverses it, for one ray
//!    or for many, and hands the result to [`RayState::take`].

use super::filter::{self, Place};
use super::ray_query::{FirstHit, RayQuery};
use super::ray_state::RayState;
use super::scaled_ray::ScaledRay;
use super::start::met_at_start;
use crate::accel::{Bvh, END, EachCandidate, MeshQuery, MeshTree, Scratch, Walks};
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
    /// Its place in [`Walks`], once it has come to the tree over the objects.
    place: Option<u32>,
    /// The objects in the last one's place that are still to come.
    duplicates: &'a [u32],
    /// The next object, where it is [known](Self::look_ahead).
    ahead: Option<u32>,
    /// Whether its packet searches for objects.
    is_joined: bool,
}

impl<'a, Q: RayQuery> SceneWalk<'a, Q> {
    /// Begins, with some objects to come.
    #[inline(always)]
    pub(super) fn new(state: RayState<Q>, objects: ObjectCandidates<'a>) -> Self {
        Self { state, objects, place: None, duplicates: &[], ahead: None, is_joined: false }
    }

    /// Leaves the search for objects to the ray's packet.
    pub(super) fn join(&mut self) {
        self.objects = ObjectCandidates::NONE;
        self.is_joined = true;
    }

    /// Whether it searches for objects itself.
    pub(super) fn is_alone(&self) -> bool {
        !self.is_joined
    }

    /// Makes an object the next.
    pub(super) fn come_to(&mut self, object: u32) {
        self.ahead = Some(object);
    }

    /// Finds the next object, or sends the ray through the tree to it: that tree is to be
    /// [advanced](Walks::advance) then.
    #[inline(always)]
    pub(super) fn look_ahead(&mut self, scene: &'a Scene, walks: &mut Walks) -> Option<&'a Bvh> {
        if !self.state.is_open() || self.ahead.is_some() {
            return None;
        }
        if let Some((&copy, rest)) = self.duplicates.split_first() {
            self.duplicates = rest;
            self.ahead = Some(copy);
            return None;
        }
        let (ray, t_max) = (self.state.ray()?, self.state.t_max);
        if let Some(object) = self.objects.next_outside(ray, t_max) {
            self.come_with_copies(scene, object);
            return None;
        }
        let tree = self.objects.tree()?;
        let place = *self.place.get_or_insert_with(|| walks.begin(tree, ray));
        walks.send(place, t_max);
        Some(tree)
    }

    /// The next object, once the tree is advanced; `None` at the end.
    #[inline(always)]
    pub(super) fn arrive(&mut self, scene: &'a Scene, walks: &mut Walks) -> Option<u32> {
        if self.state.is_open()
            && self.ahead.is_none()
            && let Some(object) = self.place.and_then(|place| walks.arrived(place))
        {
            self.come_with_copies(scene, object);
        }
        let next = self.ahead.filter(|_| self.state.is_open());
        if next.is_none()
            && let Some(place) = self.place.take()
        {
            walks.end(place);
        }
        next
    }

    /// Makes an object the next, with those in its place after it where they matter.
    #[inline(always)]
    fn come_with_copies(&mut self, scene: &'a Scene, index: u32) {
        let object = &scene.objects()[index as usize];
        let filter = self.state.query.filter();
        if Q::ALL || (Q::IS_FILTERED && filter::tells_copies_apart(filter, index, object)) {
            self.duplicates = scene.duplicates().of(index);
        }
        self.ahead = Some(index);
    }

    /// The next mesh, among the objects that are wanted; `None` at the end. Scene and walks are the
    /// same each time. The triangles of the mesh that a filtered ray does not meet go to `in_mesh`.
    #[inline(always)]
    pub(super) fn next<L: Lanes>(
        &mut self,
        l: L,
        for_mesh: (&mut Scratch, &mut MeshFilter),
        (scene, walks): (&'a Scene, &mut Walks),
        is_wanted: impl Fn(u32) -> bool,
    ) -> Option<Instance<'a>> {
        let (scratch, in_mesh) = for_mesh;
        loop {
            if let Some(tree) = self.look_ahead(scene, walks) {
                walks.advance(l, tree);
            }
            let next = self.arrive(scene, walks)?;
            if !is_wanted(next) {
                self.ahead = None;
            } else if let Some(instance) = self.enter(l, (scratch, in_mesh), scene) {
                return Some(instance);
            }
        }
    }

    /// Takes the ray into the next object, if there is one. Returns the mesh that it comes to, and
    /// meets anything else at once.
    #[inline(always)]
    pub(super) fn enter<L: Lanes>(
        &mut self,
        l: L,
        (scratch, in_mesh): (&mut Scratch, &mut MeshFilter),
        scene: &'a Scene,
    ) -> Option<Instance<'a>> {
        let index = self.ahead.take()?;
        let state = &mut self.state;
        let scaled = state.scaled.as_ref()?;
        let object = &scene.objects()[index as usize];
        let filter = state.query.filter();
        if Q::IS_FILTERED && !filter::sees_any(scene, filter, index, object) {
            return None;
        }
        let place = Place::Leader(index);
        let ray = if Q::IS_FILTERED {
            let (ray, own) = filter::in_object(scene, (scaled, filter), place, state.t_max)?;
            *in_mesh = own;
            ray
        } else {
            scaled.in_object(object, state.t_max)?
        };
        let Some((mesh, tree)) = scene.at_mesh(index) else {
            state.meet_shape(scene, (index, object.shape()), &ray);
            return None;
        };
        let is_plain = scaled.t_scale == 1.0 && !object.has_cutouts();
        if Q::IS_FILTERED
            && let Some(met) = met_at_start(scene, filter, (place, &ray, &*in_mesh))
        {
            state.cross(scene, index, met);
        }
        if Q::IS_FILTERED && in_mesh.leaves_all_of(mesh) {
            return None;
        }
        let is_near = ray.t_min >= 0.0 && !tree.is_distant(ray.origin);
        let is_near = is_near && (!Q::IS_FILTERED || is_sharp(tree, in_mesh));
        if is_plain && is_near && tree.has_nodes() {
            return Some(Instance { object: index, tree, mesh, ray });
        }
        let at_mesh = (index, tree, mesh);
        TriangleByTriangle { state, scratch, scene, at_mesh, ray: &ray, in_mesh }.run(l);
        None
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
            t_max = t_max.min(first.take(scene, &scaled, surface, crossing));
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
