//! A ray on its way through a scene, from object to object: the top-level traversal.
//!
//! 1. Take the next object whose box the ray may meet, from the tree over the objects.
//! 2. Intersect a shape that is no mesh at once.
//! 3. A mesh has a tree: return it with the ray in its space. The caller traverses it, for one ray or for many, and hands
//!    the result to [`SceneWalk::take`].

use super::filter;
use super::ray_query::{FirstHit, RayQuery};
use super::scaled_ray::ScaledRay;
use crate::accel::{self, MeshQuery, MeshTree, Scratch, WalkStack};
use crate::geometry::{Hit, Ray};
use crate::scene::{OnTheWay, Scene};
use crate::shape::triangle::Shear;
use crate::shape::{Crossing, Mesh, Shape, Surface};
use crate::simd::{Kernel, Lanes};

/// A mesh that a ray comes to, and the ray in the space of that.
#[derive(Clone, Copy)]
pub(super) struct Instance<'a> {
    pub(super) object: u32,
    pub(super) tree: &'a MeshTree,
    pub(super) mesh: &'a Mesh,
    pub(super) ray: Ray,
}

/// A ray, and what it has met so far.
pub(super) struct SceneWalk<'a, Q> {
    scaled: Option<ScaledRay>,
    objects: OnTheWay<'a>,
    /// The last object, and those in the same place that are still to come.
    object: u32,
    duplicates: &'a [u32],
    t_max: f64,
    pub(super) query: Q,
}

impl<'a, Q: RayQuery> SceneWalk<'a, Q> {
    /// Begins with `ray`; `query` knows what that has met already, at `t_max` or before.
    #[inline(always)]
    pub(super) fn new(scene: &'a Scene, ray: &Ray, query: Q, t_max: f64) -> Self {
        let scaled = if Q::IS_FILTERED {
            ScaledRay::filtered(ray, query.filter())
        } else {
            ScaledRay::new(ray)
        };
        // A ray may begin behind its origin. Below zero `t_max` says that nothing matters any more, so it stays above.
        let within = |scaled: &ScaledRay| {
            let t_max = scaled.ray.t_max.min(t_max / scaled.t_scale);
            t_max.max(f64::MIN_POSITIVE)
        };
        Self {
            t_max: scaled.as_ref().map_or(-1.0, within),
            scaled,
            objects: scene.on_the_way(),
            object: 0,
            duplicates: &[],
            query,
        }
    }

    /// The ray on its way, unless it can meet nothing.
    #[inline(always)]
    pub(super) fn ray(&self) -> Option<&Ray> {
        self.scaled.as_ref().map(|scaled| &scaled.ray)
    }

    /// Leaves only some objects to be met, before the first is.
    #[inline(always)]
    pub(super) fn meet_only(&mut self, objects: OnTheWay<'a>) {
        self.objects = objects;
    }

    /// The ray, if eight such may be intersected side by side: those with a filter that leaves out no surface but the one that the ray
    /// leaves. `None` for any other, and where the query asks for all crossings.
    #[inline(always)]
    pub(super) fn plain_ray(&self) -> Option<&Ray> {
        let scaled = self.scaled.as_ref()?;
        let filter = self.query.filter();
        let is_plain = !Q::IS_FILTERED
            || filter.mask != 0
                && filter.only.is_none()
                && filter.cull.is_none()
                && filter.skip == [None; 2];
        (!Q::ALL && is_plain).then_some(&scaled.ray)
    }

    /// Whether anything matters any more, and up to which `t`.
    #[inline(always)]
    pub(super) fn limit(&self) -> (bool, f64) {
        let t_max = self.scaled.as_ref().map_or(-1.0, |scaled| scaled.ray.t_max);
        (self.t_max >= 0.0, self.t_max.min(t_max))
    }

    /// Comes to a lone shape out of turn.
    pub(super) fn come_to(&mut self, scene: &'a Scene, index: u32) {
        let Some(scaled) = self.scaled.as_ref().filter(|_| self.t_max >= 0.0) else {
            return;
        };
        let object = &scene.objects()[index as usize];
        let filter = self.query.filter();
        if Q::IS_FILTERED && !filter::sees(filter, index, object) {
            return;
        }
        let ray = if Q::IS_FILTERED {
            let in_object = filter::in_object(scene, (scaled, filter), index, self.t_max);
            in_object.map(|(ray, _)| ray)
        } else {
            scaled.in_object(object, self.t_max)
        };
        if let Some(ray) = ray {
            self.object = index;
            self.shape(scene, object.shape(), &ray);
        }
    }

    /// Takes a crossing with a shape, if it is a hit of the caller's ray.
    #[inline(always)]
    pub(super) fn meet(&mut self, scene: &Scene, index: u32, crossing: Crossing) {
        self.object = index;
        self.cross(scene, crossing);
    }

    /// The next mesh, among the objects that are wanted; `None` at the end. Scene and stack are the same each time.
    #[inline(always)]
    pub(super) fn next<L: Lanes>(
        &mut self,
        l: L,
        scratch: &mut Scratch,
        (scene, stack): (&'a Scene, &mut WalkStack),
        is_wanted: impl Fn(u32) -> bool,
    ) -> Option<Instance<'a>> {
        while self.t_max >= 0.0 {
            let index = self.next_object(scene, stack)?;
            if !is_wanted(index) {
                continue;
            }
            let scaled = self.scaled.as_ref()?;
            let object = &scene.objects()[index as usize];
            if Q::IS_FILTERED && !filter::sees(self.query.filter(), index, object) {
                continue;
            }
            let ray = if Q::IS_FILTERED {
                let scaled_and_filter = (scaled, self.query.filter());
                let in_object = filter::in_object(scene, scaled_and_filter, index, self.t_max);
                in_object.map(|(ray, in_mesh)| {
                    self.query.enter(in_mesh);
                    ray
                })
            } else {
                scaled.in_object(object, self.t_max)
            };
            let Some(ray) = ray else {
                continue;
            };
            self.object = index;
            match (object.shape(), scene.mesh_tree(index as usize)) {
                (Shape::Mesh(mesh), Some(tree)) => {
                    let is_plain = scaled.t_scale == 1.0 && !object.has_cutouts();
                    let is_near = ray.t_min >= 0.0 && !tree.is_distant(ray.origin);
                    let is_near = is_near && (!Q::IS_FILTERED || self.is_sharp(tree));
                    if is_plain && is_near && tree.has_nodes() {
                        return Some(Instance {
                            object: index,
                            tree,
                            mesh,
                            ray,
                        });
                    }
                    l.call(TriangleByTriangle {
                        walk: self,
                        scratch,
                        scene,
                        at_mesh: (tree, mesh),
                        ray: &ray,
                    });
                }
                (shape, _) => self.shape(scene, shape, &ray),
            }
        }
        None
    }

    /// The next object that may be met.
    #[inline(always)]
    fn next_object(&mut self, scene: &'a Scene, stack: &mut WalkStack) -> Option<u32> {
        if let Some((&copy, rest)) = self.duplicates.split_first() {
            self.duplicates = rest;
            return Some(copy);
        }
        let scaled = self.scaled.as_ref()?;
        let index = self.objects.next(&scaled.ray, self.t_max, stack)?;
        let object = &scene.objects()[index as usize];
        let filter = self.query.filter();
        if Q::ALL || (Q::IS_FILTERED && filter::tells_copies_apart(filter, index, object)) {
            self.duplicates = scene.duplicates().of(index);
        }
        Some(index)
    }

    /// Whether float32 can tell what is ahead of the start.
    fn is_sharp(&self, tree: &MeshTree) -> bool {
        let departure = self.query.mesh_filter().departure();
        departure.is_none_or(|point| tree.is_sharp_from(point))
    }

    /// Takes what the last mesh was found to do to the ray.
    #[inline(always)]
    pub(super) fn take(&mut self, scene: &Scene, found: <Q::InMesh as MeshQuery>::Found) {
        if let Some(scaled) = &self.scaled {
            let t_max = self.query.take(scene, scaled, self.object, found);
            self.t_max = self.t_max.min(t_max);
        }
    }

    /// Intersects a shape that is no mesh.
    fn shape(&mut self, scene: &Scene, shape: &Shape, ray: &Ray) {
        let filter = self.query.filter();
        if Q::IS_FILTERED && !filter::meets_all_of(filter, self.object) {
            let t_scale = self.scaled.as_ref().map_or(1.0, |scaled| scaled.t_scale);
            let crossings = filter::crossings(filter, self.object, shape, (ray, t_scale));
            let crossings = crossings.into_iter().flatten();
            crossings.for_each(|crossing| self.cross(scene, crossing));
        } else if Q::ALL {
            let crossings = shape.crossings(ray).into_iter().flatten();
            crossings.for_each(|crossing| self.cross(scene, crossing));
        } else if let Some(crossing) = shape.intersect(ray) {
            self.cross(scene, crossing);
        }
    }

    /// Takes a crossing with the last object, if it is a hit of the caller's ray.
    fn cross(&mut self, scene: &Scene, crossing: Crossing) {
        let scaled = self.scaled.as_ref();
        if scaled.is_some_and(|scaled| scaled.hit(self.object, crossing).is_some()) {
            self.take(scene, Q::InMesh::of_crossing(Some(crossing)));
        }
    }
}

/// The first hit of a ray among some objects that are no meshes and in no other's place, and `known`, which it has met already.
#[inline(always)]
pub(super) fn first_of_shapes(scene: &Scene, ray: &Ray, objects: &[u32], known: Hit) -> Hit {
    let Some(scaled) = ScaledRay::new(ray) else {
        return known;
    };
    let mut first = FirstHit(known);
    let mut t_max = first.t_max(&scaled);
    for &index in objects {
        let object = &scene.objects()[index as usize];
        let crossing = scaled
            .in_object(object, t_max)
            .and_then(|ray| object.shape().intersect(&ray));
        if crossing.is_some() {
            t_max = first.take(scene, &scaled, index, crossing);
        }
    }
    first.0
}

/// Intersects a mesh for which the lanes' traversals do not serve: its triangles may be cut out, it has no nodes, or the ray is
/// distant, begins behind its origin, has other units or leaves a triangle that float32 cannot tell from its neighbours.
struct TriangleByTriangle<'r, 'a, Q> {
    walk: &'r mut SceneWalk<'a, Q>,
    scratch: &'r mut Scratch,
    scene: &'r Scene,
    at_mesh: (&'r MeshTree, &'r Mesh),
    ray: &'r Ray,
}

impl<Q: RayQuery> Kernel for TriangleByTriangle<'_, '_, Q> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let Self {
            walk,
            scratch,
            scene,
            at_mesh,
            ray,
        } = self;
        let object = &scene.objects()[walk.object as usize];
        let filter = *walk.query.mesh_filter();
        let off = filter.departure().map_or(0.0, |point| point.off);
        let shear = Shear::new(ray);
        accel::each_candidate(
            l,
            scratch,
            at_mesh,
            (ray, off, Q::ALL || Q::IS_FILTERED),
            |triangle, t_max| {
                let edges = <Q::InMesh as MeshQuery>::EDGES;
                let (_, mesh) = at_mesh;
                let crossing =
                    object.intersect_triangle(mesh, triangle, (edges, &filter), (ray, &shear));
                let Some(crossing) = crossing else {
                    return t_max;
                };
                walk.cross(scene, crossing);
                if walk.t_max < 0.0 {
                    accel::END
                } else {
                    t_max.min(walk.t_max)
                }
            },
        );
    }
}
