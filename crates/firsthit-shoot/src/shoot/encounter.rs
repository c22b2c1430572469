//! The encounter of a ray with one object alone: a hit, or the reason why there is none.
//!
//! 1. The line of the ray, without ends, goes through the tree of a mesh, and every triangle that
//!    it may touch is asked (`accel`'s `EachCandidate`). Other shapes are asked directly.
//! 2. The code of [`BruteForce`](super::BruteForce) decides what the ray itself meets there. The
//!    first of it is kept.
//! 3. Of what the line touches and the ray does not meet, one place and its reason are kept.

use super::filter::{self, Place};
use super::scaled_ray::ScaledRay;
use super::start::met_at_start;
use crate::accel::{EachCandidate, InstructionSet, Scratch};
use crate::geometry::{Hit, Ray, RayFilter, Side, SurfaceId};
use crate::scene::{Object, Scene};
use crate::shape::triangle::{Doubtful, EdgeRule, MeshFilter, Shear};
use crate::shape::{Crossing, Mesh, Shape, Surface};
use crate::simd;

/// The reason why a ray does not meet a place that its line touches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[doc(hidden)]
pub enum Rejection {
    /// The ray starts on this surface and leaves it.
    Left,
    /// The ray is told to skip it.
    Skipped,
    /// The ray passes through this side.
    Culled(Side),
    /// The material is cut out there.
    CutOut,
    /// The place is beyond the ray's end.
    BeyondEnd,
    /// The place is not ahead of the ray's start.
    BehindStart,
}

/// The encounter of a ray with an object.
#[derive(Debug, Clone, Copy, PartialEq)]
#[doc(hidden)]
pub enum Encounter {
    /// The object is hidden from all rays.
    Hidden,
    /// The ray meets another object only.
    NotAsked,
    /// The masks of the object and the ray have no bit in common.
    Masked,
    /// The numbers of the object, or of the ray in its space, are out of range.
    OutOfRange,
    /// The line of the ray does not touch it.
    Untouched,
    /// The line touches it, but the ray does not meet it.
    Rejected(Hit, Rejection),
    /// The first place where the ray meets it.
    Met(Hit),
}

/// A ray that is brought to objects one by one.
#[doc(hidden)]
pub struct Encounters<'a> {
    scene: &'a Scene,
    ray: Ray,
    filter: &'a RayFilter,
    scaled: ScaledRay,
    /// The ray without ends.
    line: ScaledRay,
    scratch: Scratch,
    set: InstructionSet,
}

impl<'a> Encounters<'a> {
    /// `None` for a ray that is not [valid](Ray::is_valid).
    pub fn new(scene: &'a Scene, ray: &Ray, filter: &'a RayFilter) -> Option<Self> {
        Some(Self {
            scene,
            ray: *ray,
            filter,
            scaled: ScaledRay::filtered(ray, filter)?,
            line: ScaledRay::new(&endless(ray))?,
            scratch: Scratch::default(),
            set: InstructionSet::current().unwrap_or(InstructionSet::Portable),
        })
    }

    /// Whether two hits have the same `t`, so that their identifiers decide which is first.
    pub fn are_tied(&self, one: &Hit, other: &Hit) -> bool {
        let t = |hit| self.scaled.nearest_t(self.scene, hit);
        t(one) == t(other)
    }

    /// The encounter of the ray with the object `index` of the scene.
    #[expect(clippy::too_many_lines, reason = "one case after the other")]
    pub fn with(&mut self, index: u32) -> Encounter {
        let scene = self.scene;
        let object = &scene.objects()[index as usize];
        if object.is_hidden() {
            return Encounter::Hidden;
        }
        if self.filter.only.is_some_and(|only| only != index.cast_signed()) {
            return Encounter::NotAsked;
        }
        if !filter::sees(self.filter, index, object) {
            return Encounter::Masked;
        }
        let Some(line) = self.line.in_object(object, f64::INFINITY) else {
            return Encounter::OutOfRange;
        };
        let t_max = self.scaled.ray.t_max;
        let within =
            filter::in_object(scene, (&self.scaled, self.filter), Place::Object(index), t_max);
        let mut touched = Touched {
            object,
            index,
            ray: within.map(|(ray, _)| ray),
            mesh_filter: within.map_or(MeshFilter::NONE, |(_, filter)| filter),
            line: within.map_or(line, |(ray, _)| endless(&ray)),
            scene,
            whole: &self.ray,
            filter: self.filter,
            scaled: &self.scaled,
            first: None,
            rejected: None,
        };
        match (object.shape(), scene.at_mesh(scene.leader_of(index))) {
            (Shape::Mesh(mesh), Some((meshes, tree))) => {
                if let Some((ray, filter)) = &within
                    && let Some(crossing) =
                        met_at_start(scene, self.filter, (Place::Object(index), ray, filter))
                {
                    touched.accept(crossing);
                }
                let off = touched.mesh_filter.departure().map_or(0.0, |point| point.off);
                let (shear, line) = (Shear::new(&touched.line), touched.line);
                let each = EachCandidate {
                    scratch: &mut self.scratch,
                    at_mesh: (tree, meshes),
                    ray: &line,
                    off,
                    with_copies: true,
                    visit: &mut |triangle, t_max| {
                        let number = triangle.cast_signed();
                        let met = scene.surface_at(scene.leader_of(index), number);
                        if met.object == index.cast_signed() {
                            touched.triangle(mesh, met.primitive.cast_unsigned(), &shear);
                        }
                        t_max
                    },
                };
                simd::run(self.set, each);
            }
            (shape, _) => touched.shape(shape),
        }
        match (touched.first, touched.rejected) {
            (Some(hit), _) => Encounter::Met(hit),
            (None, Some((hit, why))) => Encounter::Rejected(hit, why),
            (None, None) => Encounter::Untouched,
        }
    }
}

/// The line of a ray.
fn endless(ray: &Ray) -> Ray {
    Ray { t_min: f64::NEG_INFINITY, t_max: f64::INFINITY, ..*ray }
}

/// An object whose encounter is being decided.
struct Touched<'a> {
    scene: &'a Scene,
    object: &'a Object,
    index: u32,
    /// The ray as the caller has it.
    whole: &'a Ray,
    filter: &'a RayFilter,
    scaled: &'a ScaledRay,
    /// The ray in object space; `None` where nothing of it is left there.
    ray: Option<Ray>,
    mesh_filter: MeshFilter,
    /// The line in object space.
    line: Ray,
    first: Option<Hit>,
    rejected: Option<(Hit, Rejection)>,
}

impl Touched<'_> {
    /// Asks a triangle.
    fn triangle(&mut self, mesh: &Mesh, triangle: u32, shear: &Shear) {
        if let Some(ray) = &self.ray {
            let how = (EdgeRule::Closed, &self.mesh_filter);
            let met = self.object.intersect_triangle(mesh.into(), triangle, how, (ray, shear));
            if met.is_some_and(|crossing| self.accept(crossing)) {
                return;
            }
        }
        let number = triangle as usize;
        let Some(touch) = mesh.intersect_triangle(number, EdgeRule::Closed, shear) else {
            return;
        };
        let is_culled = || {
            let culls = MeshFilter::culling(self.filter.cull);
            let numbered = (triangle, mesh.corners(number));
            let line = (&self.line, shear);
            let met = culls.intersect(line, EdgeRule::Closed, numbered, Doubtful::settle);
            met.is_none()
        };
        let is_cut_out = || self.object.is_cut_out(mesh, number, touch.barycentric);
        let crossing = touch.crossing(triangle.cast_signed());
        let is_this =
            |surface: &SurfaceId| self.is_here(surface) && surface.primitive == crossing.primitive;
        // A line crosses a triangle once, so that this is the place that the ray leaves.
        let why = if self.left().as_ref().is_some_and(is_this) {
            Rejection::Left
        } else {
            let is_skipped = self.filter.skip.iter().flatten().any(is_this);
            if self.only_touches_start(mesh, triangle, shear) {
                Rejection::BehindStart
            } else {
                self.reason(&crossing, is_skipped, is_culled, is_cut_out)
            }
        };
        self.reject(crossing, why);
    }

    /// Whether the ray leaves a surface that a triangle touches at the start, and does not meet the
    /// triangle ahead of that.
    fn only_touches_start(&self, mesh: &Mesh, triangle: u32, shear: &Shear) -> bool {
        let Some((ray, point)) = self.ray.as_ref().zip(self.mesh_filter.departure()) else {
            return false;
        };
        let leaves = MeshFilter::leaving(*point);
        let numbered = (triangle, mesh.corners(triangle as usize));
        let met = leaves.intersect((ray, shear), EdgeRule::Closed, numbered, Doubtful::settle);
        met.is_none()
    }

    /// Asks a shape that is no mesh.
    fn shape(&mut self, shape: &Shape) {
        let t_scale = self.scaled.t_scale;
        let crossings =
            |ray: &Ray| filter::crossings(self.filter, self.index, shape, (ray, t_scale));
        let met = self.ray.as_ref().map_or([None; 2], crossings);
        for crossing in met.into_iter().flatten() {
            self.accept(crossing);
        }
        if self.first.is_some() {
            return;
        }
        let crossings = shape.crossings(&self.line);
        let left = self.left().filter(|left| self.is_here(left));
        let left = left.and_then(|_| nearest_start(&crossings));
        let mut kept = crossings;
        if let Some(left) = left {
            kept[left] = None;
        }
        filter::leave_out_skipped(self.filter, self.index, &mut kept, t_scale);
        for (k, crossing) in crossings.into_iter().enumerate() {
            let Some(crossing) = crossing else { continue };
            let why = if left == Some(k) {
                Rejection::Left
            } else {
                let is_culled =
                    || !filter::is_not_culled(self.filter, shape, &self.line, &crossing);
                self.reason(&crossing, kept[k].is_none(), is_culled, || false)
            };
            self.reject(crossing, why);
        }
    }

    /// The surface that the ray leaves.
    fn left(&self) -> Option<SurfaceId> {
        self.filter.departure.map(|departure| departure.surface)
    }

    fn is_here(&self, surface: &SurfaceId) -> bool {
        surface.object == self.index.cast_signed()
    }

    /// Takes a crossing, if it is a hit of the caller's ray.
    fn accept(&mut self, crossing: Crossing) -> bool {
        let surface = SurfaceId { object: self.index.cast_signed(), primitive: crossing.primitive };
        let Some(hit) = self.scaled.hit(surface, crossing) else {
            return false;
        };
        let is_first = |first: &Hit| self.scaled.precedes(self.scene, &hit, first);
        if self.first.as_ref().is_none_or(is_first) {
            self.first = Some(hit);
        }
        true
    }

    /// The reason why a crossing with the line, other than the one that the ray leaves, is none
    /// with the ray.
    fn reason(
        &self,
        crossing: &Crossing,
        is_skipped: bool,
        is_culled: impl Fn() -> bool,
        is_cut_out: impl Fn() -> bool,
    ) -> Rejection {
        let t = self.scaled.t_scale * crossing.t;
        if t <= self.whole.t_min || self.ray.is_some_and(|ray| crossing.t <= ray.t_min) {
            return Rejection::BehindStart;
        }
        if t > self.whole.t_max || self.ray.is_none_or(|ray| crossing.t > ray.t_max) {
            return Rejection::BeyondEnd;
        }
        if is_skipped {
            return Rejection::Skipped;
        }
        match self.filter.cull {
            Some(side) if is_culled() => Rejection::Culled(side),
            _ if is_cut_out() => Rejection::CutOut,
            // Only its rounded `t` lies beyond the start; the exact one does not.
            _ => Rejection::BehindStart,
        }
    }

    /// Keeps a crossing that the ray does not meet, if it tells more than the one that is kept.
    fn reject(&mut self, crossing: Crossing, why: Rejection) {
        let hit = Hit {
            t: self.scaled.t_scale * crossing.t,
            object: self.index.cast_signed(),
            primitive: crossing.primitive,
            barycentric: crossing.barycentric,
        };
        let is_better = |(kept, reason): &(Hit, Rejection)| {
            let (new, old) = (rank(&hit, why), rank(kept, *reason));
            let by_place = new.0.cmp(&old.0).then(new.1.total_cmp(&old.1));
            by_place.then(hit.primitive.cmp(&kept.primitive)).is_lt()
        };
        if hit.t.is_finite() && self.rejected.as_ref().is_none_or(is_better) {
            self.rejected = Some((hit, why));
        }
    }
}

/// The index of the crossing nearest to the line's start.
fn nearest_start(crossings: &[Option<Crossing>; 2]) -> Option<usize> {
    let distance = |k: &usize| crossings[*k].map_or(f64::INFINITY, |crossing| crossing.t.abs());
    let there = (0..2).filter(|&k| crossings[k].is_some());
    there.min_by(|one, other| distance(one).total_cmp(&distance(other)))
}

/// The order of rejections: the nearest on the ray first, then the least beyond its end, then the
/// least behind its start.
fn rank(hit: &Hit, why: Rejection) -> (u8, f64) {
    match why {
        Rejection::Left | Rejection::Skipped | Rejection::Culled(_) | Rejection::CutOut => {
            (0, hit.t)
        }
        Rejection::BeyondEnd => (1, hit.t),
        Rejection::BehindStart => (2, -hit.t),
    }
}
