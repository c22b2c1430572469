//! Guesses which way is up from the triangles: most things stand on a flat base.

use super::{Object, Scene};
use crate::geometry::{Bounds, DVec2, DVec3};
use crate::parallel;

/// The base and the lid are the lowest and the highest part of the scene, this share of its height.
const LAYER: f64 = 0.02;

/// A triangle is level if the cosine between its normal and the axis is at least this.
const LEVEL: f64 = 0.9;

/// A base has at least this share of the area that faces down.
const BASE: f64 = 0.2;

/// A base must be this many times larger than the base along the other axis.
const CLEARLY: f64 = 10.0;

/// Areas projected along y and along z: of all triangles, of the level ones in the base, and of
/// those in the lid.
#[derive(Clone, Copy, Default)]
pub(super) struct LevelAreas {
    all: DVec2,
    bottom: DVec2,
    top: DVec2,
}

impl LevelAreas {
    fn and(self, other: Self) -> Self {
        Self {
            all: self.all + other.all,
            bottom: self.bottom + other.bottom,
            top: self.top + other.top,
        }
    }
}

impl Scene {
    /// Guesses whether +y or +z is up, for a file that does not say. `convention` is the format's
    /// own answer, and is returned unless it is +y or +z and the scene clearly stands on a flat
    /// base along the other of the two: the base is large, the lid is not, and there is hardly a
    /// base along `convention`.
    ///
    /// Busts, bottles and figures on a pedestal are recognised. Scenes without a base, and those
    /// with flat sides all around, as most machine parts have, keep the convention. Takes time
    /// linear in the number of triangles.
    pub fn likely_up(&self, convention: DVec3) -> DVec3 {
        let (mine, other) = match convention {
            DVec3::Y => (0, 1),
            DVec3::Z => (1, 0),
            _ => return convention,
        };
        let seen = *parallel::once(&self.derived.places.seen, || self.all_seen());
        // Half of the projected area faces down.
        let share = |part: DVec2, axis: usize| part[axis] / (0.5 * seen.all[axis]);
        let base = share(seen.bottom, other);
        let stands = base > BASE
            && base > 2.0 * share(seen.top, other)
            && base > CLEARLY * share(seen.bottom, mine);
        if stands { [DVec3::Y, DVec3::Z][other] } else { convention }
    }

    fn all_seen(&self) -> LevelAreas {
        let bounds = self.bounds();
        let seen = self.objects().iter().map(|object| seen(object, bounds));
        seen.fold(LevelAreas::default(), LevelAreas::and)
    }
}

fn seen(object: &Object, bounds: Bounds) -> LevelAreas {
    let Some(mesh) = object.mesh() else {
        return LevelAreas::default();
    };
    let place = object.transform();
    let world_from_object = place.world_from_object();
    let is_identity = place.is_identity();
    let triangles = mesh.triangles().len();
    // Parts of one size, added in their order: the sums are the same for any number of threads.
    let parts = parallel::map((0..triangles).step_by(PART), |first| {
        let triangles = first..triangles.min(first + PART);
        let seen = triangles.map(|triangle| {
            let corners = mesh.corners(triangle);
            let corners = if is_identity {
                corners
            } else {
                corners.map(|corner| world_from_object.transform_point3(corner))
            };
            seen_of(corners, bounds)
        });
        seen.fold(LevelAreas::default(), LevelAreas::and)
    });
    parts.into_iter().fold(LevelAreas::default(), LevelAreas::and)
}

/// The evidence of one triangle.
#[inline]
fn seen_of([a, b, c]: [DVec3; 3], bounds: Bounds) -> LevelAreas {
    let area = (b - a).cross(c - a);
    let level = LEVEL * 0.5 * area.length();
    let layer = LAYER * bounds.size();
    let (lowest, highest) = (a.min(b).min(c), a.max(b).max(c));
    let mut seen = LevelAreas::default();
    for (k, axis) in [1, 2].into_iter().enumerate() {
        let along = 0.5 * area[axis].abs();
        seen.all[k] = along;
        if along < level {
            continue;
        }
        if highest[axis] <= bounds.low[axis] + layer[axis] {
            seen.bottom[k] = along;
        }
        if lowest[axis] >= bounds.high[axis] - layer[axis] {
            seen.top[k] = along;
        }
    }
    seen
}

/// The number of triangles in a part of the sum.
const PART: usize = 1 << 15;

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::geometry::{DAffine3, DQuat, Transform};
    use crate::shape::{Mesh, Positions};

    /// A pyramid on its base, its tip along +y.
    fn pyramid() -> Object {
        let points = [[-1., 0., -1.], [1., 0., -1.], [1., 0., 1.], [-1., 0., 1.], [0.1, 3., 0.2]];
        let sides = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        let triangles = [vec![[0, 2, 1], [0, 3, 2]], sides.to_vec()].concat();
        let mesh = Mesh::new(Positions::compact(points.to_vec()), triangles).unwrap();
        Object::new(Arc::new(mesh))
    }

    fn turned(object: Object, quarters: f64) -> Scene {
        let turn = DQuat::from_rotation_x(quarters * std::f64::consts::FRAC_PI_2);
        let transform = Transform::new(DAffine3::from_quat(turn)).unwrap();
        Scene::new(vec![object.placed(transform)]).unwrap()
    }

    #[test]
    fn what_stands_on_a_base_is_upright_whatever_the_convention() {
        for convention in [DVec3::Y, DVec3::Z] {
            assert_eq!(turned(pyramid(), 0.0).likely_up(convention), DVec3::Y);
            assert_eq!(turned(pyramid(), 1.0).likely_up(convention), DVec3::Z);
            // On its head it would stand on nothing.
            assert_eq!(turned(pyramid(), 2.0).likely_up(convention), convention);
        }
        assert_eq!(turned(pyramid(), 1.0).likely_up(DVec3::X), DVec3::X);
    }

    #[test]
    fn without_a_base_the_convention_holds() {
        // A sheet has as much of a lid as of a base.
        let points = vec![[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]];
        let sheet = Mesh::new(Positions::compact(points), vec![[0, 1, 2], [0, 2, 3]]).unwrap();
        let sheet = turned(Object::new(Arc::new(sheet)), 0.0);
        for scene in [sheet, Scene::new(vec![]).unwrap()] {
            for convention in [DVec3::Y, DVec3::Z] {
                assert_eq!(scene.likely_up(convention), convention);
            }
        }
    }
}
