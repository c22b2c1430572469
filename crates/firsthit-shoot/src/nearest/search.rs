//! Searches by trees and by brute force.
//!
//! The points before are often near: no surface is farther away than the last one was, and the way
//! from there. This bounds the search from its start. The bound is rounded, so where nothing is
//! found within it, the search begins anew without one.

use super::NearestSettings;
use super::answers::{AnswerSlices, ClosestPoints};
use super::best::Best;
use crate::accel::{InstructionSet, Scratch, WalkStack, each_near};
use crate::error::Result;
use crate::geometry::{DVec3, SurfaceId};
use crate::memory;
use crate::parallel;
use crate::scene::Scene;
use crate::shape::{Surface, nearest_on_triangle};
use crate::simd::{self, Kernel, Lanes};
use crate::watch::{Watch, stop_if_asked};

/// The method of the search for nearest points. All methods come to equal bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Trees in lanes, with an instruction set; one that this machine does not have is replaced by
    /// the next plainer one.
    Trees(InstructionSet),
    /// Every triangle and every shape in float64: slow, and the reference.
    BruteForce,
}

/// The default is trees, as [`Cpu`](crate::shoot::Cpu) is by default.
impl Default for Method {
    fn default() -> Self {
        Self::Trees(InstructionSet::current().unwrap_or(InstructionSet::Portable))
    }
}

/// The number of points that a thread takes at a time.
const BATCH: usize = 512;

/// Fills `answers` by all threads of the current rayon pool.
pub(super) fn fill(
    method: Method,
    scene: &Scene,
    points: &[[f64; 3]],
    wanted: NearestSettings,
    answers: &mut ClosestPoints,
    watch: &dyn Watch,
) -> Result<()> {
    // Many for each point take long: fewer points, so that a stop is soon noticed.
    let size = (BATCH / wanted.count.min(BATCH)).max(16);
    let search = |(points, part): (&[[f64; 3]], AnswerSlices<'_>)| {
        stop_if_asked(watch)?;
        let mut batch = Batch { scene, points, part, best: Best::new(wanted), watch };
        let result = match method {
            Method::Trees(set) => simd::run(set, batch),
            Method::BruteForce => batch.by_brute_force(),
        };
        watch.advance(points.len() as u64);
        result
    };
    let parts = parts(answers, size, wanted.count);
    let mut batches = points.chunks(size).zip(parts);
    if points.len() <= BATCH {
        // Few points need no other thread, though they are several parts. (In Python there is then
        // no pool.)
        return batches.try_for_each(search);
    }
    parallel::try_each(batches, search)
}

/// The answers of `size` points at a time.
fn parts(
    answers: &mut ClosestPoints,
    size: usize,
    count: usize,
) -> impl Iterator<Item = AnswerSlices<'_>> {
    let length = size.saturating_mul(count);
    let point = answers.point.chunks_mut(length);
    let distance = answers.distance.chunks_mut(length);
    let object = answers.object.chunks_mut(length);
    let primitive = answers.primitive.chunks_mut(length);
    let barycentric = answers.barycentric.chunks_mut(length);
    let all = point.zip(distance).zip(object).zip(primitive).zip(barycentric);
    all.map(|((((point, distance), object), primitive), barycentric)| AnswerSlices {
        point,
        distance,
        object,
        primitive,
        barycentric,
    })
}

/// A batch of points, and the destination of their answers.
struct Batch<'a> {
    scene: &'a Scene,
    points: &'a [[f64; 3]],
    part: AnswerSlices<'a>,
    best: Best,
    watch: &'a dyn Watch,
}

impl Batch<'_> {
    /// Writes what was found for the point `index`.
    fn put(&mut self, index: usize) -> Result<()> {
        if self.best.is_short {
            return Err(memory::no_room_for("nearest points"));
        }
        if !self.best.is_many() {
            if let Some(found) = self.best.one() {
                self.part.put(index, &found);
            }
            return Ok(());
        }
        let count = self.part.distance.len() / self.points.len();
        for (place, found) in self.best.in_order().iter().enumerate() {
            self.part.put(index * count + place, found);
        }
        Ok(())
    }

    fn by_brute_force(&mut self) -> Result<()> {
        for index in 0..self.points.len() {
            stop_if_asked(self.watch)?;
            let point = DVec3::from(self.points[index]);
            self.best.start(f64::INFINITY);
            let objects = (0..).zip(self.scene.objects());
            for (number, object) in objects.filter(|_| point.is_finite()) {
                if !object.is_out_of_range() && !object.is_hidden() {
                    let best = &mut self.best;
                    let visit = &mut |nearest| best.take(number, nearest);
                    object.shape().nearest(point, object.transform(), visit);
                }
            }
            self.put(index)?;
        }
        Ok(())
    }
}

impl Kernel for Batch<'_> {
    type Output = Result<()>;

    #[inline(always)]
    fn run<L: Lanes>(mut self, l: L) -> Result<()> {
        let mut scratch = Scratch::default();
        let mut stack = WalkStack::new();
        // The point before, and how far its nearest was.
        let mut before: Option<(DVec3, f64)> = None;
        for index in 0..self.points.len() {
            let point = DVec3::from(self.points[index]);
            let hint = before.filter(|_| !self.best.is_many());
            let hint = hint.map_or(f64::INFINITY, |(before, squared)| {
                let farthest = (squared.sqrt() + before.distance(point)) * (1.0 + 1e-12);
                farthest * farthest
            });
            self.best.start(hint);
            if point.is_finite() {
                stop_if_asked(self.watch)?;
                let memory = (&mut scratch, &mut stack);
                l.call(Point(self.scene, point, &mut self.best, memory));
                if hint < f64::INFINITY && self.best.least() > hint {
                    self.best.start(f64::INFINITY);
                    let memory = (&mut scratch, &mut stack);
                    l.call(Point(self.scene, point, &mut self.best, memory));
                }
                let nearest = self.best.one().filter(|_| !self.best.is_many());
                before = nearest.map(|found| (point, found.nearest.squared));
            }
            self.put(index)?;
        }
        Ok(())
    }
}

/// One point, and memory for its search.
struct Point<'a>(&'a Scene, DVec3, &'a mut Best, (&'a mut Scratch, &'a mut WalkStack));

impl Kernel for Point<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let Self(scene, point, best, (scratch, stack)) = self;
        let mut around = scene.around(point, stack);
        while let Some(index) = around.next(best.limit(), stack) {
            near_object(l, scratch, scene, (index, point), best);
            if best.is_many() {
                for &copy in scene.duplicates().of(index) {
                    near_object(l, scratch, scene, (copy, point), best);
                }
            }
        }
    }
}

/// Shows what is near of an object to `best`.
#[inline(always)]
fn near_object<L: Lanes>(
    l: L,
    scratch: &mut Scratch,
    scene: &Scene,
    (index, point): (u32, DVec3),
    best: &mut Best,
) {
    let object = &scene.objects()[index as usize];
    if object.is_out_of_range() {
        return;
    }
    let place = object.transform();
    let Some((mesh, tree)) = scene.at_mesh(index) else {
        let visit = &mut |nearest| best.take(index, nearest);
        return object.shape().nearest(point, place, visit);
    };
    let (limit, is_many) = (best.limit(), best.is_many());
    let visit = |triangle: u32, corners: [DVec3; 3]| {
        let corners = [
            place.point_in_world(corners[0]),
            place.point_in_world(corners[1]),
            place.point_in_world(corners[2]),
        ];
        let SurfaceId { object, primitive } = scene.surface_at(index, triangle.cast_signed());
        best.take(object.cast_unsigned(), nearest_on_triangle(point, corners, primitive));
        best.limit()
    };
    each_near(l, scratch, (tree, mesh), (point, place, is_many), limit, visit);
}
