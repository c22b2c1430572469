//! A ray on its way through a scene, from object to object.
//!
//! The searches in meshes' trees are left to whoever takes the ray along: one by one, or many at a time.

use super::object::{Moderate, identifier};
use crate::accel::{self, MeshTree, Question, Scratch, WalkStack};
use crate::geometry::{Hit, Ray};
use crate::scene::{Object, OnTheWay, Scene};
use crate::shape::triangle::{Shear, clear_of};
use crate::shape::{Crossing, Mesh, Shape, Surface};
use crate::simd::Lanes;

/// A ray in the space of a mesh, for the tree of that.
#[derive(Clone, Copy)]
pub(super) struct Leg<'a> {
    pub(super) object: u32,
    pub(super) tree: &'a MeshTree,
    pub(super) mesh: &'a Mesh,
    pub(super) ray: Ray,
}

/// What is asked about a ray.
pub(super) trait Quest {
    /// What each mesh is asked for it.
    type Question: Question;
    /// Whether one hit is as good as any other.
    const ANY: bool;
    /// Before anything is met.
    const START: Self;
    /// After the one object that there is.
    fn of_answer(object: u32, answer: <Self::Question as Question>::Answer) -> Self;
    /// Takes note of what the object met; what is smaller than the `t_max` before is the new one, and below zero
    /// nothing else matters any more.
    fn take(
        &mut self,
        scene: &Scene,
        moderate: &Moderate,
        object: u32,
        answer: <Self::Question as Question>::Answer,
    ) -> f64;
}

/// The first hit.
#[derive(Debug, Clone, Copy)]
pub(super) struct FirstHit(pub(super) Hit);

impl Quest for FirstHit {
    type Question = accel::First;
    const ANY: bool = false;
    const START: Self = Self(Hit::MISS);

    #[inline(always)]
    fn of_answer(object: u32, crossing: Option<Crossing>) -> Self {
        Self(crossing.map_or(Hit::MISS, |crossing| Hit {
            t: crossing.t,
            object: object.cast_signed(),
            primitive: crossing.primitive,
            barycentric: crossing.barycentric,
        }))
    }

    #[inline(always)]
    fn take(
        &mut self,
        scene: &Scene,
        moderate: &Moderate,
        object: u32,
        crossing: Option<Crossing>,
    ) -> f64 {
        if let Some(hit) = crossing.and_then(|crossing| moderate.hit(object, crossing))
            && moderate.precedes(scene, &hit, &self.0)
        {
            self.0 = hit;
        }
        // As in [`Journey::new`].
        (clear_of(self.0.t) / moderate.scale).max(f64::MIN_POSITIVE)
    }
}

/// Whether there is any hit.
#[derive(Debug, Clone, Copy)]
pub(super) struct AnyHit(pub(super) bool);

impl Quest for AnyHit {
    type Question = accel::Any;
    const ANY: bool = true;
    const START: Self = Self(false);

    #[inline(always)]
    fn of_answer(_: u32, is_hit: bool) -> Self {
        Self(is_hit)
    }

    #[inline(always)]
    fn take(&mut self, _: &Scene, _: &Moderate, _: u32, is_hit: bool) -> f64 {
        self.0 |= is_hit;
        if self.0 { -1.0 } else { f64::INFINITY }
    }
}

/// A ray, and what it has met so far.
pub(super) struct Journey<'a, Q> {
    moderate: Option<Moderate>,
    objects: OnTheWay<'a>,
    /// The one whose mesh is being searched.
    object: u32,
    t_max: f64,
    pub(super) quest: Q,
}

impl<'a, Q: Quest> Journey<'a, Q> {
    /// Sets out with `ray`; `quest` is what it has met already, at `t_max` or before.
    #[inline(always)]
    pub(super) fn new(scene: &'a Scene, ray: &Ray, quest: Q, t_max: f64) -> Self {
        let moderate = Moderate::new(ray);
        // What is behind the origin is as good as just ahead of it: below zero there is no way to go.
        let within = |moderate: &Moderate| {
            let t_max = moderate.ray.t_max.min(t_max / moderate.scale);
            t_max.max(f64::MIN_POSITIVE)
        };
        Self {
            t_max: moderate.as_ref().map_or(-1.0, within),
            moderate,
            objects: scene.on_the_way(),
            object: 0,
            quest,
        }
    }

    /// The next leg, among the objects that are wanted; `None` at the end. What is no mesh is asked on the way.
    /// Scene and stack are the same each time.
    #[inline(always)]
    pub(super) fn next<L: Lanes>(
        &mut self,
        l: L,
        scratch: &mut Scratch,
        (scene, stack): (&'a Scene, &mut WalkStack),
        is_wanted: impl Fn(u32) -> bool,
    ) -> Option<Leg<'a>> {
        while self.t_max >= 0.0 {
            let moderate = self.moderate.as_ref()?;
            let index = self.objects.next(&moderate.ray, self.t_max, stack)?;
            if !is_wanted(index) {
                continue;
            }
            let object = &scene.objects()[index as usize];
            let Some(ray) = moderate.in_object(object, self.t_max) else {
                continue;
            };
            self.object = index;
            match (object.shape(), scene.mesh_tree(index as usize)) {
                (Shape::Mesh(mesh), Some(tree))
                    if is_plain(moderate, object)
                        && ray.t_min >= 0.0
                        && !tree.is_distant(ray.origin) =>
                {
                    if tree.has_nodes() {
                        return Some(Leg {
                            object: index,
                            tree,
                            mesh,
                            ray,
                        });
                    }
                    // Float32 holds nothing of this mesh, or there is nothing.
                    self.cross(scene, mesh.first_crossing(&ray, &Shear::new(&ray)));
                }
                (Shape::Mesh(mesh), Some(tree)) => {
                    let crossing =
                        one_by_one::<L, Q>(l, scratch, moderate, object, (tree, mesh), &ray);
                    self.cross(scene, crossing);
                }
                (shape, _) => self.cross(scene, shape.intersect(&ray)),
            }
        }
        None
    }

    /// Takes the answer to the last search.
    #[inline(always)]
    pub(super) fn answer(&mut self, scene: &Scene, answer: <Q::Question as Question>::Answer) {
        if let Some(moderate) = &self.moderate {
            let t_max = self.quest.take(scene, moderate, self.object, answer);
            self.t_max = self.t_max.min(t_max);
        }
    }

    fn cross(&mut self, scene: &Scene, crossing: Option<Crossing>) {
        let hit = |crossing: &Crossing| self.moderate.as_ref()?.hit(self.object, *crossing);
        let crossing = crossing.filter(|crossing| hit(crossing).is_some());
        self.answer(scene, Q::Question::from_crossing(crossing));
    }
}

/// Whether all that a mesh's triangles meet is a hit.
#[inline(always)]
fn is_plain(moderate: &Moderate, object: &Object) -> bool {
    moderate.scale == 1.0 && !object.has_cutouts()
}

/// The first hit in a mesh, or any, each of them asked for.
#[inline(always)]
fn one_by_one<L: Lanes, Q: Quest>(
    l: L,
    scratch: &mut Scratch,
    moderate: &Moderate,
    object: &Object,
    (tree, mesh): (&MeshTree, &Mesh),
    ray: &Ray,
) -> Option<Crossing> {
    let mut first: Option<Crossing> = None;
    accel::each(l, scratch, (tree, mesh), ray, |triangle, t_max| {
        if let Some(new) = checked(moderate, object, mesh, triangle as usize, ray)
            && first.is_none_or(|old| mesh.precedes(ray, &new, &old))
        {
            first = Some(new);
        }
        let so_far = |first: Crossing| {
            if Q::ANY {
                accel::END
            } else {
                clear_of(first.t)
            }
        };
        first.map_or(t_max, so_far)
    });
    first
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
    let is_within = ray.holds(hit.t);
    let is_cut_out = || object.has_cutouts() && object.is_cut_out(mesh, triangle, hit.barycentric);
    let crossing = hit.crossing(identifier(triangle));
    // In the caller's units `t` may be too small for float64.
    (is_within && moderate.hit(0, crossing).is_some() && !is_cut_out()).then_some(crossing)
}
