//! The lines of objects, cut into pieces that are looked at.

use super::chain::{Link, chains};
use super::curves::{Curve, CurveKind, curves};
use super::eye::View;
use super::mesh::{Chosen, Instance, angle};
use super::pieces::{Cutter, Piece, Window};
use super::settings::{EdgeKind, EdgeKinds, Edges};
use super::sight::{Candidate, Look, Sight};
use super::table::{EdgeTable, MeshEdge};
use crate::error::Result;
use crate::geometry::{DVec2, DVec3, Departure, Side, SurfaceId};
use crate::parallel;
use crate::scene::{Object, Scene};
use crate::shape::{Mesh, Surface};
use crate::watch::{Watch, stop_if_asked};

/// Rays from contours lean outwards by this share of their length.
const TILT: f64 = 1e-9;

/// The number of edges that are cut at once.
const AT_ONCE: usize = 1 << 10;

/// Makes the lines of objects.
pub(super) struct Strokes<'a> {
    pub(super) scene: &'a Scene,
    pub(super) view: View<'a>,
    pub(super) edges: &'a Edges,
    /// The side of surfaces that is culled.
    pub(super) cull: Option<Side>,
    /// The whole picture, and around it as much as half a line's width reaches.
    pub(super) picture: Window,
    /// The part of the picture that is rendered, with the same margin.
    pub(super) part: Window,
}

impl Strokes<'_> {
    fn object(&self, number: usize) -> (&Object, i32) {
        // No scene has more objects.
        let identifier = i32::try_from(number).unwrap_or(i32::MAX);
        (&self.scene.objects()[number], identifier)
    }

    /// A piece, with its look where it is within the part.
    fn candidate(&self, piece: &Piece, look: impl FnOnce() -> Option<Look>) -> Candidate {
        let ends = piece.ends;
        let matters = self.part.holds(ends, 0.0) || self.across_seam(ends).next().is_some();
        Candidate { ends, look: matters.then(look).flatten() }
    }

    /// A piece as it is seen within the part from across the seam of a panorama: it may be wide
    /// enough to reach beyond.
    pub(super) fn across_seam(&self, ends: [DVec2; 2]) -> impl Iterator<Item = [DVec2; 2]> {
        let periods = self.view.period().into_iter();
        let moves = periods.flat_map(|period| [-period, period]);
        let moved = moves.map(move |by| ends.map(|end| end + DVec2::new(by, 0.0)));
        moved.filter(|&ends| self.part.holds(ends, 0.0))
    }

    /// The lines of a mesh.
    pub(super) fn of_mesh(
        &self,
        number: usize,
        mesh: &Mesh,
        table: &EdgeTable,
        sight: &mut Sight<'_>,
        watch: &dyn Watch,
    ) -> Result<()> {
        let (object, _) = self.object(number);
        let instance = Instance {
            number,
            object,
            mesh,
            table,
            catalog: self.scene.catalog(),
            eye: self.view.eye.in_object(object.transform()),
            cull: self.cull,
        };
        let chosen = instance.chosen(self.edges);
        for links in self.links(table, &chosen).chunks(AT_ONCE) {
            stop_if_asked(watch)?;
            let cut = |link: &Link| self.of_edge(&instance, chosen[link.edge], link.is_reversed);
            for (link, candidates) in links.iter().zip(parallel::map(links, cut)) {
                if link.is_first {
                    sight.begin();
                }
                for candidate in candidates {
                    sight.add(candidate, watch)?;
                }
            }
        }
        Ok(())
    }

    /// The order in which edges are drawn: along chains, if they may be dashed.
    fn links(&self, table: &EdgeTable, chosen: &[Chosen]) -> Vec<Link> {
        if self.edges.hidden.is_none() {
            let alone = |edge| Link { edge, is_reversed: false, is_first: true };
            return (0..chosen.len()).map(alone).collect();
        }
        let ends: Vec<[u32; 2]> =
            (chosen.iter()).map(|chosen| table.edges[chosen.edge as usize].ends).collect();
        chains(&ends)
    }

    /// The pieces of an edge of a mesh.
    fn of_edge(&self, of: &Instance<'_>, chosen: Chosen, is_reversed: bool) -> Vec<Candidate> {
        let edge = &of.table.edges[chosen.edge as usize];
        let [from, to] = of.table.points(of.mesh, edge);
        let transform = of.object.transform();
        let cutter = Cutter {
            view: &self.view,
            window: self.picture,
            at: |share| transform.point_in_world(from + share * (to - from)),
            is_straight: true,
        };
        let candidate = |piece: &Piece| {
            self.candidate(piece, || {
                let point = (cutter.at)(piece.middle);
                self.look_at_edge(of, (edge, chosen.is_outline), piece.middle, point)
            })
        };
        let mut candidates: Vec<Candidate> = cutter.pieces().iter().map(candidate).collect();
        if is_reversed {
            candidates.reverse();
            for candidate in &mut candidates {
                candidate.ends.swap(0, 1);
            }
        }
        candidates
    }

    /// The look of a point of an edge, `share` of the way along it. The triangles at the edge do
    /// not occlude it.
    fn look_at_edge(
        &self,
        of: &Instance<'_>,
        (edge, is_outline): (&MeshEdge, bool),
        share: f64,
        point: DVec3,
    ) -> Option<Look> {
        if of.is_cut_out(edge, share) {
            return None;
        }
        let (_, object) = self.object(of.number);
        let surface = |triangle: u32| SurfaceId { object, primitive: triangle.cast_signed() };
        let [left, other] = edge.sides;
        let left = left?;
        let others = edge.neighbours.map(|of| of.map(|of| of.triangle));
        let is_new = |triangle: &u32| *triangle != left.triangle;
        let [a, b] = others.map(|triangle| triangle.filter(is_new));
        let skip = [a.or(b), other.map(|side| side.triangle)];
        let ray = self.view.ray_from(point);
        Some(Look {
            ray,
            away: -ray.direction,
            departure: Departure {
                surface: surface(left.triangle),
                barycentric: left.weights(share),
                side: None,
            },
            skip: skip.map(|triangle| triangle.map(surface)),
            is_outline,
        })
    }

    /// The lines of a shape that is not a mesh.
    pub(super) fn of_shape(
        &self,
        number: usize,
        sight: &mut Sight<'_>,
        watch: &dyn Watch,
    ) -> Result<()> {
        let (object, _) = self.object(number);
        let transform = object.transform();
        let eye = self.view.eye.in_object(transform);
        for curve in curves(object.shape(), eye) {
            if curve.is_first {
                sight.begin();
            }
            let cutter = Cutter {
                view: &self.view,
                window: self.picture,
                at: |share| transform.point_in_world(curve.path.at(share)),
                is_straight: curve.path.is_straight(),
            };
            for piece in cutter.pieces() {
                let at = curve.path.at(piece.middle);
                let look = || self.look_at_curve(number, &curve, (at, eye.from(at)));
                sight.add(self.candidate(&piece, look), watch)?;
            }
        }
        Ok(())
    }

    /// The look of a point of a line on a shape. The point and the direction `toward` the eye are
    /// in object space.
    #[expect(clippy::too_many_lines, reason = "one decision after the other")]
    fn look_at_curve(
        &self,
        number: usize,
        curve: &Curve,
        (point, toward): (DVec3, DVec3),
    ) -> Option<Look> {
        let (object, identifier) = self.object(number);
        let (shape, transform) = (object.shape(), object.transform());
        let faces = |primitive: i32| shape.normal(point, primitive).dot(toward);
        let primitives = curve.kind.primitives();
        let is_passed = |primitive: i32| {
            let is_front = faces(primitive) > 0.0;
            self.cull == Some(if is_front { Side::Front } else { Side::Back })
        };
        // At a contour there are both sides.
        let is_contour = matches!(curve.kind, CurveKind::Contour(_));
        if !is_contour && primitives.iter().all(|&primitive| is_passed(primitive)) {
            return None;
        }
        let mut found = EdgeKinds::NONE;
        match curve.kind {
            CurveKind::Contour(_) => found = found.with(EdgeKind::Silhouette),
            CurveKind::Boundary(_) => {
                found = found.with(EdgeKind::Boundary).with(EdgeKind::Wireframe);
            }
            CurveKind::Rim([a, b]) => {
                found = found.with(EdgeKind::Wireframe);
                if (faces(a) > 0.0) != (faces(b) > 0.0) {
                    found = found.with(EdgeKind::Silhouette);
                }
                let normal = |of| transform.normal_in_world(shape.normal(point, of));
                if angle([a, b].map(normal)) > self.edges.angle {
                    found = found.with(EdgeKind::Crease);
                }
            }
        }
        let kinds = self.edges.kinds;
        let is_drawn = !found.common(kinds).is_empty();
        let ends_surface = found.has(EdgeKind::Silhouette) || found.has(EdgeKind::Boundary);
        if !(is_drawn || ends_surface && kinds.has(EdgeKind::Object)) {
            return None;
        }
        // A solid does not occlude a point of it where one of its primitives faces the eye, and
        // does where none does.
        let by_facing = |&&a: &&i32, &&b: &&i32| faces(a).total_cmp(&faces(b));
        let is_shown = primitives.iter().any(|&primitive| faces(primitive) > 0.0);
        let &primitive = if is_shown {
            primitives.iter().max_by(by_facing)
        } else {
            primitives.iter().min_by(by_facing)
        }?;
        let mut ray = self.view.ray_from(transform.point_in_world(point));
        let mut away = -ray.direction;
        if is_contour {
            // A tangent neither leaves nor enters, and rounding would say which.
            let normal = transform.normal_in_world(shape.normal(point, primitive));
            let outwards = TILT * ray.direction.length() * normal;
            ray.direction += outwards;
            away += outwards;
        }
        Some(Look {
            ray,
            away,
            departure: Departure {
                surface: SurfaceId { object: identifier, primitive },
                barycentric: DVec2::NAN,
                side: None,
            },
            skip: [None; 2],
            is_outline: !is_drawn,
        })
    }
}
