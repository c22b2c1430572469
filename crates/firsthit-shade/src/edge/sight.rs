//! Finds the pieces of lines that are visible.
//!
//! The ray of a piece goes from its middle, a point of the surface, to the eye ([`Departure`]).
//! Whether something is between the two is decided without rounding for all meshes with the
//! transform of the line's own: rounding makes neither the triangles at the edge nor what touches
//! it there occlude it, nor does it lose anything in front of it, however near.

use std::mem::take;

use super::settings::Dash;
use crate::error::Result;
use crate::geometry::{DVec2, DVec3, Departure, Filtered, Ray, RayFilter, Side, SurfaceId};
use crate::memory;
use crate::scene::Scene;
use crate::shoot::{Any, Engine, First, trace_with};
use crate::watch::{OnlyStops, Watch};

/// The number of rays that are traced at once.
const AT_ONCE: usize = 1 << 16;

/// A piece that may be drawn.
#[derive(Debug, Clone)]
pub(super) struct Candidate {
    /// The ends in the picture.
    pub(super) ends: [DVec2; 2],
    /// The test of its visibility; `None` where it is not drawn in any case.
    pub(super) look: Option<Look>,
}

/// The test of a piece's visibility.
#[derive(Debug, Clone)]
pub(super) struct Look {
    /// The ray from its middle to the eye.
    pub(super) ray: Ray,
    /// The direction of the ray that continues behind it.
    pub(super) away: DVec3,
    /// The surface that it is a point of.
    pub(super) departure: Departure,
    /// Other surfaces at the edge.
    pub(super) skip: [Option<SurfaceId>; 2],
    /// Whether it is drawn only where another object or nothing is behind it.
    pub(super) is_outline: bool,
}

/// A piece whose ray waits to be traced.
struct Waiting {
    ends: [DVec2; 2],
    look: Look,
    /// The place along its line where it begins, in pixels.
    along: f64,
}

/// Finds the pieces that are drawn.
pub(super) struct Sight<'a> {
    scene: &'a Scene,
    engine: &'a dyn Engine,
    /// The side of surfaces that is culled.
    cull: Option<Side>,
    hidden: Option<Dash>,
    waiting: Vec<Waiting>,
    /// The place along its line where the next piece begins.
    along: f64,
    drawn: Vec<[DVec2; 2]>,
}

impl<'a> Sight<'a> {
    pub(super) fn new(
        scene: &'a Scene,
        engine: &'a dyn Engine,
        cull: Option<Side>,
        hidden: Option<Dash>,
    ) -> Self {
        Self { scene, engine, cull, hidden, waiting: Vec::new(), along: 0.0, drawn: Vec::new() }
    }

    /// Begins another line.
    pub(super) fn begin(&mut self) {
        self.along = 0.0;
    }

    /// Adds the next piece of the line.
    pub(super) fn add(&mut self, candidate: Candidate, watch: &dyn Watch) -> Result<()> {
        let Candidate { ends, look } = candidate;
        let along = self.along;
        self.along += ends[0].distance(ends[1]);
        if let Some(look) = look {
            self.waiting.push(Waiting { ends, look, along });
        }
        if self.waiting.len() < AT_ONCE {
            return Ok(());
        }
        self.look(watch)
    }

    /// All that is drawn.
    pub(super) fn finish(mut self, watch: &dyn Watch) -> Result<Vec<[DVec2; 2]>> {
        self.look(watch)?;
        Ok(self.drawn)
    }

    /// Traces the rays of all pieces that wait.
    fn look(&mut self, watch: &dyn Watch) -> Result<()> {
        let mut waiting = take(&mut self.waiting);
        // A ray from the surface to the eye meets the other side.
        let cull = self.cull.map(|side| match side {
            Side::Front => Side::Back,
            Side::Back => Side::Front,
        });
        let rays: Vec<Ray> = waiting.iter().map(|piece| piece.look.ray).collect();
        let filters = filters(&waiting, cull);
        let (scene, stop) = (self.scene, OnlyStops(watch));
        let rays = Filtered::each(&rays, &filters);
        let mut is_hidden = trace_with(self.engine, scene, &rays, Any, &stop)?;
        if self.hidden.is_none() {
            let mut hides = is_hidden.iter();
            waiting.retain(|_| hides.next() == Some(&false));
            is_hidden.retain(|is_hidden| !is_hidden);
        }
        let is_wanted = self.outlines(&waiting, watch)?;
        let room = self.drawn.try_reserve(waiting.len());
        room.map_err(|_| memory::no_room_for("lines of edges"))?;
        for ((piece, is_hidden), is_wanted) in waiting.iter().zip(is_hidden).zip(is_wanted) {
            match self.hidden.filter(|_| is_hidden) {
                _ if !is_wanted => {}
                None => self.drawn.push(piece.ends),
                Some(dash) => self.drawn.extend(dashes(piece.ends, piece.along, dash)),
            }
        }
        waiting.clear();
        self.waiting = waiting;
        Ok(())
    }

    /// Whether each piece is drawn for what is behind it: an outline needs another object or
    /// nothing.
    fn outlines(&self, waiting: &[Waiting], watch: &dyn Watch) -> Result<Vec<bool>> {
        let mut is_wanted = vec![true; waiting.len()];
        if !waiting.iter().any(|piece| piece.look.is_outline) {
            return Ok(is_wanted);
        }
        let away = |piece: &Waiting| Ray::new(piece.look.ray.origin, piece.look.away);
        let rays: Vec<Ray> = waiting.iter().map(away).collect();
        let filters = filters(waiting, self.cull);
        let rays = Filtered::each(&rays, &filters);
        let behind = trace_with(self.engine, self.scene, &rays, First, &OnlyStops(watch))?;
        for ((is_wanted, piece), object) in is_wanted.iter_mut().zip(waiting).zip(behind.object) {
            *is_wanted = !piece.look.is_outline || object != piece.look.departure.surface.object;
        }
        Ok(is_wanted)
    }
}

fn filters(waiting: &[Waiting], cull: Option<Side>) -> Vec<RayFilter> {
    let filter = |piece: &Waiting| RayFilter {
        cull,
        skip: piece.look.skip,
        departure: Some(piece.look.departure),
        ..RayFilter::NONE
    };
    waiting.iter().map(filter).collect()
}

/// The parts of a piece that are within dashes. It begins at a distance of `along` from the start
/// of its line.
fn dashes(
    [from, to]: [DVec2; 2],
    along: f64,
    Dash { on, off }: Dash,
) -> impl Iterator<Item = [DVec2; 2]> {
    let length = from.distance(to);
    let period = on + off;
    let first = (along / period).floor();
    // A piece is short, but so may dashes be.
    let count = (length / period).ceil() + 1.0;
    let at = move |share: f64| from + share * (to - from);
    let numbers = (0..).map(f64::from).take_while(move |&k| k < count);
    numbers.filter_map(move |k| {
        let start = (first + k) * period - along;
        let (low, high) = (start.max(0.0), (start + on).min(length));
        (low < high).then(|| [at(low / length), at(high / length)])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_of_pieces_are_those_of_the_line() {
        let dash = Dash { on: 1.3, off: 0.4 };
        let mut total = 0.0;
        for k in 0..100 {
            let at = |k: i32| DVec2::new(0.5 * f64::from(k), 0.0);
            for [from, to] in dashes([at(k), at(k + 1)], 0.5 * f64::from(k), dash) {
                let middle = 0.5 * (from.x + to.x);
                // But for pieces that are all rounding.
                assert!(middle % 1.7 < 1.3 + 1e-9, "{middle}");
                total += to.x - from.x;
            }
        }
        // 29 whole periods, and 0.7 of the next.
        assert!((total - (29.0 * 1.3 + 0.7)).abs() < 1e-9, "{total}");
        let tiny = Dash { on: 0.01, off: 0.01 };
        assert_eq!(dashes([DVec2::ZERO, DVec2::new(0.5, 0.0)], 3.0, tiny).count(), 25);
    }
}
