//! The lines of shapes other than meshes, in object space, in closed form: rims and contours.

use std::f64::consts::{FRAC_PI_4, TAU};

use super::eye::Eye;
use crate::geometry::{Bounds, DVec3, unit};
use crate::shape::{Cone, Disc, Shape, Sphere, Surface};

/// A line on a shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Curve {
    pub(super) path: Path,
    pub(super) kind: CurveKind,
    /// Whether it begins a line: it does not continue the curve before it.
    pub(super) is_first: bool,
}

/// The kinds of lines on a shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum CurveKind {
    /// A contour, where a primitive turns away from the eye.
    Contour([i32; 1]),
    /// A rim, where two primitives meet.
    Rim([i32; 2]),
    /// A boundary, where a primitive ends.
    Boundary([i32; 1]),
}

impl CurveKind {
    /// The primitives that have the line.
    pub(super) fn primitives(&self) -> &[i32] {
        match self {
            Self::Rim(primitives) => primitives,
            Self::Contour(primitives) | Self::Boundary(primitives) => primitives,
        }
    }
}

/// The points of a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Path {
    /// A segment from a point to another.
    Straight([DVec3; 2]),
    /// An eighth of an ellipse around a middle, the eighths numbered from the first axis towards
    /// the second.
    Eighth { middle: DVec3, axes: [DVec3; 2], number: u8 },
}

impl Path {
    /// The point at a share of its parameter, from 0 to 1.
    pub(super) fn at(&self, share: f64) -> DVec3 {
        match *self {
            Self::Straight([from, to]) => from + share * (to - from),
            Self::Eighth { middle, axes: [x, y], number } => {
                let (sine, cosine) = libm::sincos(FRAC_PI_4 * (f64::from(number) + share) % TAU);
                middle + (cosine * x + sine * y)
            }
        }
    }

    /// Whether it is a straight line.
    pub(super) fn is_straight(&self) -> bool {
        matches!(self, Self::Straight(_))
    }
}

/// All lines of a shape, for an eye in object space. Meshes have theirs elsewhere, and planes have
/// none.
pub(super) fn curves(shape: &Shape, eye: Eye) -> Vec<Curve> {
    match shape {
        Shape::Mesh(_) | Shape::Plane(_) => Vec::new(),
        Shape::Sphere(sphere) => of_sphere(sphere, eye),
        Shape::Box(cuboid) => of_box(&cuboid.bounds()),
        Shape::Disc(disc) => of_disc(disc),
        Shape::Cone(cone) => of_cone(cone, eye),
        Shape::Cylinder(cylinder) => of_cone(cylinder.cone(), eye),
    }
}

/// A circle around a normal of length one.
fn circle(
    middle: DVec3,
    normal: DVec3,
    radius: f64,
    kind: CurveKind,
) -> impl Iterator<Item = Curve> {
    let (x, y) = normal.any_orthonormal_pair();
    let axes = [radius * x, radius * y];
    (0..8).map(move |number| Curve {
        path: Path::Eighth { middle, axes, number },
        kind,
        is_first: number == 0,
    })
}

/// The points whose tangent planes contain the eye: with the eye at a distance d from the center
/// they are a circle, r^2 / d nearer to the eye than the center.
fn of_sphere(sphere: &Sphere, eye: Eye) -> Vec<Curve> {
    let (center, radius) = (sphere.center(), sphere.radius());
    let toward = eye.from(center);
    let nearer = match eye {
        Eye::At(_) => radius / toward.length(),
        Eye::Toward(_) => 0.0,
    };
    // None from inside, nor for a NaN.
    if nearer.is_nan() || nearer >= 1.0 {
        return Vec::new();
    }
    let normal = unit(toward);
    let of_circle = radius * ((1.0 - nearer) * (1.0 + nearer)).sqrt();
    let middle = center + nearer * radius * normal;
    circle(middle, normal, of_circle, CurveKind::Contour([0])).collect()
}

fn of_disc(disc: &Disc) -> Vec<Curve> {
    let kind = CurveKind::Boundary([0]);
    circle(disc.center(), disc.facing(), disc.radius(), kind).collect()
}

/// Faces are numbered -x, +x, -y, +y, -z, +z.
fn of_box(bounds: &Bounds) -> Vec<Curve> {
    let ends = [bounds.low, bounds.high];
    let mut curves = Vec::with_capacity(12);
    for axis in 0..3 {
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        for (i, j) in [(0, 0), (1, 0), (1, 1), (0, 1)] {
            let mut corners = ends;
            for corner in &mut corners {
                corner[u] = ends[i][u];
                corner[v] = ends[j][v];
            }
            let face = |axis: usize, end: usize| i32::try_from(2 * axis + end).unwrap_or_default();
            curves.push(Curve {
                path: Path::Straight(corners),
                kind: CurveKind::Rim([face(u, i), face(v, j)]),
                is_first: true,
            });
        }
    }
    curves
}

/// The rims of both lids, and the lines of the side whose tangent planes contain the eye.
///
/// With `e` from the bottom to the eye, of height z and length h across the axis, `r` the radius at
/// the bottom and `s` its slope, the outward direction at an angle from that to the eye is that of
/// such a line where h * cosine = r + s z. For an eye infinitely far away in a direction `e` it is
/// where h * cosine = s z.
fn of_cone(cone: &Cone, eye: Eye) -> Vec<Curve> {
    let (bottom, top) = (cone.bottom(), cone.top());
    let radii = [cone.bottom_radius(), cone.top_radius()];
    let length = (top - bottom).length();
    let axis = unit(top - bottom);
    let mut curves = Vec::new();
    for (middle, radius, lid) in [(bottom, radii[0], 1), (top, radii[1], 2)] {
        if radius > 0.0 {
            curves.extend(circle(middle, axis, radius, CurveKind::Rim([0, lid])));
        }
    }
    let slope = (radii[1] - radii[0]) / length;
    let (e, radius) = match eye {
        Eye::At(eye) => (eye - bottom, radii[0]),
        Eye::Toward(direction) => (direction, 0.0),
    };
    let height = e.dot(axis);
    let across = e - height * axis;
    let cosine = (radius + slope * height) / across.length();
    if cosine.abs() < 1.0 {
        let x = unit(across);
        let y = axis.cross(x);
        let sine = ((1.0 - cosine) * (1.0 + cosine)).sqrt();
        for sine in [sine, -sine] {
            let outwards = cosine * x + sine * y;
            curves.push(Curve {
                path: Path::Straight([bottom + radii[0] * outwards, top + radii[1] * outwards]),
                kind: CurveKind::Contour([0]),
                is_first: true,
            });
        }
    }
    curves
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Ray;
    use crate::shape::{Cone, Cuboid, Cylinder, Disc, Plane, Sphere};

    /// Two or three of each kind that has curves of its own.
    fn shapes() -> Vec<Shape> {
        let v = DVec3::new;
        let shapes = vec![
            Shape::from(Sphere::new(DVec3::ZERO, 1.0).unwrap()),
            Sphere::new(v(0.5, -2.0, 3.0), 0.25).unwrap().into(),
            Plane::new(v(1.0, -2.0, 0.5), v(1.0, 2.0, -0.5)).unwrap().into(),
            Disc::new(v(1.0, 0.0, -1.0), v(3.0, -1.0, 2.0), 2.0).unwrap().into(),
            Cuboid::new(v(0.25, -3.0, 1.0), v(0.5, 4.0, 1.1)).unwrap().into(),
            Cylinder::new(DVec3::NEG_Z, DVec3::Z, 1.0).unwrap().into(),
            Cylinder::new(v(1.0, 1.0, 0.0), v(-1.0, 2.0, 3.0), 0.4).unwrap().into(),
            Cone::new(DVec3::NEG_Z, DVec3::Z, 1.0, 0.0).unwrap().into(),
            Cone::new(DVec3::Y, v(2.0, 2.0, -1.0), 0.2, 0.9).unwrap().into(),
            Cone::new(DVec3::ZERO, v(0.1, 0.0, 0.0), 3.0, 2.0).unwrap().into(),
        ];
        let is_there = |name| shapes.iter().any(|shape| shape.name() == name);
        assert!(Shape::NAMES.iter().all(|&name| name == "mesh" || is_there(name)));
        shapes
    }

    /// Rays from the eye to points of contours are tangents: a bit farther out they miss, a bit
    /// farther in they hit.
    #[test]
    fn contours_are_where_the_eye_sees_past() {
        let mut contours = 0;
        for shape in shapes() {
            for eye in [DVec3::new(5.0, -4.0, 1.5), DVec3::new(-3.0, 0.4, 6.0)] {
                for eye in [Eye::At(eye), Eye::Toward(eye)] {
                    for curve in curves(&shape, eye) {
                        if let CurveKind::Contour(_) = curve.kind {
                            check_tangent(&shape, eye, curve.path.at(0.3));
                            contours += 1;
                        }
                    }
                }
            }
        }
        assert!(contours > 40, "{contours}");
    }

    fn check_tangent(shape: &Shape, eye: Eye, point: DVec3) {
        let normal = shape.normal(point, 0);
        let toward = eye.from(point);
        assert!(normal.dot(toward).abs() < 1e-12 * toward.length(), "{shape:?}");
        for (off, is_met) in [(1e-6, false), (-1e-6, true)] {
            let origin = point + off * normal + 100.0 * toward;
            let ray = Ray::new(origin, -toward);
            assert_eq!(shape.intersect(&ray).is_some(), is_met, "{shape:?} {point}");
        }
    }
}
