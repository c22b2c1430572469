//! One ray through a scene.

use super::batch::Memory;
use super::ray_query::{FirstHit, RayQuery};
use super::ray_state::RayState;
use super::scene_walk::{Instance, SceneWalk};
use crate::accel;
use crate::geometry::{Hit, Ray};
use crate::scene::Scene;
use crate::shape::triangle::{MeshFilter, clear_of};
use crate::simd::{Kernel, Lanes};

/// One ray, with this thread's memory.
pub(super) struct Single<'a, Q>(pub(super) &'a Scene, pub(super) &'a Ray, pub(super) Q);

impl<Q: RayQuery> Kernel for Single<'_, Q> {
    type Output = Q;

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> Q {
        let Self(scene, ray, query) = self;
        let mut memory = Memory::take();
        let query = l.call(SingleRay::new(&mut memory, scene, ray, query));
        memory.give_back();
        query
    }
}

/// One ray through the scene, by single-ray traversal.
pub(super) struct SingleRay<'a, Q> {
    memory: &'a mut Memory,
    scene: &'a Scene,
    ray: &'a Ray,
    /// The query, with the answer up to `t_max`.
    query: Q,
    t_max: f64,
    /// Whether to skip an object, by its number; objects beyond the end are not skipped.
    is_skipped: &'a [bool],
}

impl<'a, Q: RayQuery> SingleRay<'a, Q> {
    pub(super) fn new(memory: &'a mut Memory, scene: &'a Scene, ray: &'a Ray, query: Q) -> Self {
        Self { memory, scene, ray, query, t_max: f64::INFINITY, is_skipped: &[] }
    }
}

impl<'a> SingleRay<'a, FirstHit> {
    /// The ray after it has met `known`, among the objects that are not skipped.
    pub(super) fn after(self, known: Hit, is_skipped: &'a [bool]) -> Self {
        Self { query: FirstHit(known), t_max: clear_of(known.t), is_skipped, ..self }
    }
}

impl<Q: RayQuery> Kernel for SingleRay<'_, Q> {
    type Output = Q;

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> Q {
        let Memory { scratch, walks, .. } = self.memory;
        let scene = self.scene;
        let state = RayState::new(self.ray, self.query, self.t_max);
        let mut walk = SceneWalk::new(state, scene.candidates());
        let mut in_mesh = MeshFilter::NONE;
        let is_wanted = |object: u32| self.is_skipped.get(object as usize) != Some(&true);
        while let Some(instance) = walk.next(l, (scratch, &mut in_mesh), (scene, walks), is_wanted)
        {
            let Instance { object, tree, mesh, ray } = instance;
            let found = if Q::IS_FILTERED {
                let filtered = (&ray, &in_mesh);
                accel::query_mesh_filtered::<L, Q::InMesh>(l, scratch, (tree, mesh), filtered)
            } else {
                accel::query_mesh::<L, Q::InMesh>(l, scratch, (tree, mesh), &ray)
            };
            walk.state.take(scene, object, found);
        }
        walk.state.query
    }
}
