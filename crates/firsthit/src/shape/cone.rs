//! The cone: a round body whose radius changes evenly along its axis.

use super::bundle::{
    CrossingOf, RayOf, Vector, abs, dot, equal, has_minus, larger, minus, negative, plus, smaller,
    splat, squared, times,
};
use super::interval::Interval;
use super::{Crossing, Nearest, Surface, similarity, sines};
use crate::error::Result;
#[cfg(feature = "frame")]
use crate::geometry::Digest;
use crate::geometry::arithmetic::{Arithmetic, Scalar};
use crate::geometry::{Bounds, DVec2, DVec3, Ray, Transform, require, require_finite, unit};

/// A round body that tapers along its axis, with its lids: a cone, a cone with its tip cut off, or
/// (see [`Cylinder`](super::Cylinder)) a cylinder. Its primitives: 0 the side, 1 the bottom, 2 the top.
///
/// ```
/// use firsthit::{Cone, DVec3};
///
/// let pointed = Cone::new(DVec3::ZERO, DVec3::new(0.0, 0.0, 2.0), 1.0, 0.0)?;
/// let cup = Cone::new(DVec3::ZERO, DVec3::new(0.0, 0.0, 2.0), 0.7, 1.0)?;
/// assert!(pointed.top_radius() < cup.top_radius());
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cone {
    bottom: DVec3,
    top: DVec3,
    axis: DVec3,
    height: f64,
    bottom_radius: f64,
    top_radius: f64,
}

/// A cone whose radius changes by more than so many times its height is flat.
const FLAT: f64 = 4.0;

/// A line, or one in each lane, as a cone sees it: across its axis and along it, at the start and what it gains in one unit.
#[derive(Clone, Copy)]
struct Line<N> {
    across: Vector<N>,
    d_across: Vector<N>,
    z: N,
    dz: N,
}

impl Cone {
    /// The cone around the axis from `bottom` to `top`; a `top_radius` of zero gives it a tip.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::Error::Argument) for a `top` at the `bottom`, a negative radius, two radii of zero, and numbers
    /// that are not finite.
    pub fn new(bottom: DVec3, top: DVec3, bottom_radius: f64, top_radius: f64) -> Result<Self> {
        require_finite("bottom", bottom)?;
        require_finite("top", top)?;
        for (name, radius) in [("bottom_radius", bottom_radius), ("top_radius", top_radius)] {
            let fine = radius >= 0.0 && radius.is_finite();
            require(name, "zero or positive, and finite", fine, radius)?;
        }
        let is_wide = bottom_radius != 0.0 || top_radius != 0.0;
        let expected = "positive where top_radius is zero";
        require("bottom_radius", expected, is_wide, bottom_radius)?;
        require("top", "another point than bottom", top != bottom, top)?;
        let axis = unit(top - bottom);
        Ok(Self {
            bottom,
            top,
            axis,
            height: (top - bottom).dot(axis),
            bottom_radius,
            top_radius,
        })
    }

    /// The lower end of its axis.
    pub fn bottom(&self) -> DVec3 {
        self.bottom
    }

    /// The upper end of its axis.
    pub fn top(&self) -> DVec3 {
        self.top
    }

    /// The radius at the bottom.
    pub fn bottom_radius(&self) -> f64 {
        self.bottom_radius
    }

    /// The radius at the top.
    pub fn top_radius(&self) -> f64 {
        self.top_radius
    }

    /// How much the radius grows along the axis.
    #[inline(always)]
    fn slope(&self) -> f64 {
        (self.top_radius - self.bottom_radius) / self.height
    }

    /// The stretch of the lines `at + t * along` (relative to the bottom) that is inside.
    #[inline(always)]
    fn inside<A: Arithmetic>(
        &self,
        of: A,
        at: Vector<A::Number>,
        along: Vector<A::Number>,
    ) -> Interval<A> {
        let axis = splat(of, self.axis);
        let (z, dz) = (dot(of, at, axis), dot(of, along, axis));
        let slab = Interval::line(of).between(self.lids(), z, dz);
        if !slab.is_anywhere() {
            return slab;
        }
        let line = Line {
            across: minus(of, at, times(of, z, axis)),
            d_across: minus(of, along, times(of, dz, axis)),
            z,
            dz,
        };
        if FLAT * self.height < (self.top_radius - self.bottom_radius).abs() {
            self.inside_flat(of, slab, line)
        } else {
            self.inside_slab(of, slab, line)
        }
    }

    /// The heights of the lids, and their primitives. A tip is part of the side: there is no lid.
    #[inline(always)]
    fn lids(&self) -> [(f64, i32); 2] {
        let bottom = i32::from(self.bottom_radius > 0.0);
        let top = 2 * i32::from(self.top_radius > 0.0);
        [(0.0, bottom), (self.height, top)]
    }

    /// The stretch inside a cone that is flat. Rounding of a line's height makes the more of the radius the flatter the cone is. So the line
    /// is made to start where it enters the slab between the lids, where its height is known without rounding, and to go through the slab in
    /// one unit. Where it goes a long way through the slab, it starts where it is nearest to the axis.
    #[inline(always)]
    fn inside_flat<A: Arithmetic>(
        &self,
        of: A,
        slab: Interval<A>,
        line: Line<A::Number>,
    ) -> Interval<A> {
        let Line {
            across,
            d_across,
            z,
            dz,
        } = line;
        let (zero, height) = (of.number(0.0), of.number(self.height));
        let is_upwards = of.lt(zero, dz);
        let [first, last] = [
            of.select(is_upwards, zero, height),
            of.select(is_upwards, height, zero),
        ];
        let [enter, exit] = [of.div(of.sub(first, z), dz), of.div(of.sub(last, z), dz)];
        let stretch = of.div(height, abs(of, dz));
        let size = self.height + self.bottom_radius + self.top_radius;
        let way = of.mul(squared(of, d_across), of.mul(stretch, stretch));
        let is_short = of.le(way, of.number(size * size));
        let nearest = of.div(
            negative(of, dot(of, across, d_across)),
            squared(of, d_across),
        );
        let within = smaller(of, larger(of, nearest, enter), exit);
        let nearest = of.select(equal(of, dz, zero), nearest, within);
        let start = of.select(is_short, enter, nearest);
        let unit = of.select(is_short, stretch, of.number(1.0));
        let z = of.select(is_short, first, of.add(z, of.mul(nearest, dz)));
        let dz = of.select(is_short, of.sub(last, first), dz);
        let line = Line {
            across: plus(of, across, times(of, start, d_across)),
            d_across: times(of, unit, d_across),
            z,
            dz,
        };
        let anew = Interval::line(of).between(self.lids(), z, dz);
        let inside = self.inside_slab(of, anew.only(slab.is_there()), line);
        inside.scaled(unit).moved(start)
    }

    /// The stretch of lines inside, `slab` being that between the lids.
    #[inline(always)]
    fn inside_slab<A: Arithmetic>(
        &self,
        of: A,
        slab: Interval<A>,
        line: Line<A::Number>,
    ) -> Interval<A> {
        let Line {
            across,
            d_across,
            z,
            dz,
        } = line;
        let slope = of.number(self.slope());
        let radius = of.add(of.number(self.bottom_radius), of.mul(slope, z));
        let d_radius = of.mul(slope, dz);
        // Inside is where a t^2 + 2 b t + c <= 0. Between the lids the radius is not negative, so the
        // cone's mirror image beyond its tip does not count.
        let steepness = squared(of, d_across);
        let a = of.sub(steepness, of.mul(d_radius, d_radius));
        let b = of.sub(dot(of, across, d_across), of.mul(radius, d_radius));
        let c = of.sub(squared(of, across), of.mul(radius, radius));
        // From where the line is deepest inside: b * b - a * c is all rounding for a thin shape. (Haines,
        // Günther and Akenine-Möller, see the sphere.)
        let is_steep = of.lt(of.mul(of.number(0.5), steepness), a);
        let deepest = of.div(negative(of, b), a);
        let radius_there = of.add(radius, of.mul(deepest, d_radius));
        let across_there = plus(of, across, times(of, deepest, d_across));
        let depth = of.sub(
            of.mul(radius_there, radius_there),
            squared(of, across_there),
        );
        let flat = of.sub(of.mul(b, b), of.mul(a, c));
        let discriminant = of.select(is_steep, of.mul(a, depth), flat);
        let zero = of.number(0.0);
        let is_even = equal(of, a, zero);
        let has_no_roots = (is_even & equal(of, b, zero)) | of.lt(discriminant, zero);
        // Then all of the line is inside, or nothing.
        let is_all_inside = (is_even & of.le(c, zero)) | of.lt(a, zero);
        let slab = slab.only(!has_no_roots | is_all_inside);
        let has_roots = !has_no_roots;
        let root = of.sqrt(discriminant);
        let away = of.select(has_minus(of, b), of.sub(b, root), of.add(b, root));
        let q = negative(of, away);
        let (t0, t1) = (of.div(q, a), of.div(c, q));
        let (lower, upper) = (smaller(of, t0, t1), larger(of, t0, t1));
        let between = has_roots & of.lt(zero, a);
        // Along the side there is one root.
        let before_one = has_roots & is_even & of.lt(zero, b);
        let after_one = has_roots & is_even & !of.lt(zero, b);
        // Steeper than the side: outside between the roots. One side of them is the mirror image's, where the
        // slab leaves nothing, or at the tip what rounding makes of nothing.
        let is_outside_between = has_roots & !between & !is_even;
        let before = slab.until(is_outside_between, lower, zero);
        let after = slab.from(is_outside_between, upper, zero);
        let is_after = is_outside_between & of.lt(before.length(), after.length());
        Interval::select(is_after, after, before)
            .from(between | after_one, of.select(is_even, t1, lower), zero)
            .until(between | before_one, of.select(is_even, t1, upper), zero)
    }

    /// The stretch of rays inside.
    #[inline(always)]
    fn along<A: Arithmetic>(&self, of: A, ray: &RayOf<A::Number>) -> Interval<A> {
        let at = minus(of, ray.origin, splat(of, self.bottom));
        // From far away the quadratic's terms would be all rounding: start it where the line is nearest.
        let size = self.height + self.bottom_radius + self.top_radius;
        let squared_distance = squared(of, at);
        let is_far = of.lt(of.number(64.0 * size * size), squared_distance);
        if !of.is_anywhere(is_far) {
            let start = of.number(0.0);
            let nearest = plus(of, at, times(of, start, ray.direction));
            return self.inside(of, nearest, ray.direction).moved(start);
        }
        let back = negative(of, dot(of, at, ray.direction));
        let start = of.div(back, squared(of, ray.direction));
        let start = of.select(is_far, start, of.number(0.0));
        let nearest = plus(of, at, times(of, start, ray.direction));
        // A line far outside, by more than rounding, meets nothing. Here, because the fourth powers below may overflow.
        let rounding = of.mul(of.number(1e-14), of.sqrt(squared_distance));
        let most = of.add(of.number(2.0 * size), rounding);
        let is_outside = is_far & of.lt(most, of.sqrt(squared(of, nearest)));
        self.inside(of, nearest, ray.direction)
            .only(!is_outside)
            .moved(start)
    }

    /// Where rays meet it first.
    #[inline(always)]
    pub(super) fn first<A: Arithmetic>(&self, of: A, ray: &RayOf<A::Number>) -> CrossingOf<A> {
        self.along(of, ray).first(ray)
    }
}

impl Surface for Cone {
    fn bounds(&self) -> Bounds {
        let sines = sines(self.axis);
        let lid = |center: DVec3, radius: f64| Bounds {
            low: center - radius * sines,
            high: center + radius * sines,
        };
        lid(self.bottom, self.bottom_radius).union(lid(self.top, self.top_radius))
    }

    /// The larger support of the two lids, whose convex hull the cone is.
    fn support(&self, direction: DVec3) -> f64 {
        let across = direction.cross(self.axis).length();
        let lid = |center: DVec3, radius: f64| center.dot(direction) + radius * across;
        lid(self.bottom, self.bottom_radius).max(lid(self.top, self.top_radius))
    }

    fn intersect(&self, ray: &Ray) -> Option<Crossing> {
        let ray = RayOf::from(ray);
        self.first(Scalar, &ray).single()
    }

    fn crossings(&self, ray: &Ray) -> [Option<Crossing>; 2] {
        self.along(Scalar, &ray.into()).crossings(ray)
    }

    #[inline(always)]
    fn normal(&self, point: DVec3, primitive: i32) -> DVec3 {
        match primitive {
            1 => -self.axis,
            2 => self.axis,
            _ => {
                let at = point - self.bottom;
                let across = at - at.dot(self.axis) * self.axis;
                // The tip has no normal: any will do.
                let outwards = if across == DVec3::ZERO {
                    self.axis.any_orthonormal_vector()
                } else {
                    unit(across)
                };
                unit(outwards - self.slope() * self.axis)
            }
        }
    }

    #[inline(always)]
    fn onto(&self, point: DVec3, primitive: i32) -> DVec3 {
        let at = point - self.bottom;
        let z = at.dot(self.axis);
        let across = at - z * self.axis;
        match primitive {
            1 => self.bottom + across.clamp_length_max(self.bottom_radius),
            2 => self.bottom + self.height * self.axis + across.clamp_length_max(self.top_radius),
            _ => {
                let z = z.clamp(0.0, self.height);
                let radius = self.bottom_radius + self.slope() * z;
                let outwards = if across == DVec3::ZERO {
                    DVec3::ZERO
                } else {
                    unit(across)
                };
                self.bottom + (z * self.axis + radius * outwards)
            }
        }
    }

    /// In the half-plane through the axis and the point, the side and the lids are segments.
    fn nearest(&self, from: DVec3, place: &Transform, visit: &mut dyn FnMut(Nearest)) {
        let Some(scale) = similarity(&place.world_from_object().matrix3) else {
            return;
        };
        let bottom = place.point_in_world(self.bottom);
        let axis = unit(place.point_in_world(self.top) - bottom);
        let height = scale * self.height;
        let [bottom_radius, top_radius] = [self.bottom_radius, self.top_radius].map(|r| scale * r);
        let at = from - bottom;
        let z = at.dot(axis);
        let across = at - z * axis;
        let r = across.length();
        // On the axis all directions are equally far.
        let outwards = if r == 0.0 {
            axis.any_orthonormal_vector()
        } else {
            unit(across)
        };
        let mut show = |to: DVec2, primitive| {
            let squared = (to - DVec2::new(r, z)).length_squared();
            let point = bottom + (to.y * axis + to.x * outwards);
            visit(Nearest::apart(squared, point, primitive));
        };
        let (low, high) = (
            DVec2::new(bottom_radius, 0.0),
            DVec2::new(top_radius, height),
        );
        let side = high - low;
        let share = (DVec2::new(r, z) - low).dot(side) / side.length_squared();
        show(low + share.clamp(0.0, 1.0) * side, 0);
        for (lid, primitive) in [(low, 1), (high, 2)] {
            // A tip is part of the side.
            if lid.x > 0.0 {
                show(DVec2::new(r.min(lid.x), lid.y), primitive);
            }
        }
    }

    #[cfg(feature = "frame")]
    fn digest(&self, digest: &mut Digest) {
        digest.vector(self.bottom);
        digest.vector(self.top);
        digest.numbers(&[self.bottom_radius, self.top_radius]);
    }
}

#[cfg(test)]
impl super::conformance::Conforming for Cone {
    fn examples() -> Vec<Self> {
        vec![
            Self::new(DVec3::NEG_Z, DVec3::Z, 1.0, 0.0).unwrap(),
            Self::new(
                DVec3::new(0.0, 1.0, 0.0),
                DVec3::new(2.0, 2.0, -1.0),
                0.2,
                0.9,
            )
            .unwrap(),
            Self::new(DVec3::ZERO, DVec3::new(0.1, 0.0, 0.0), 3.0, 2.0).unwrap(),
        ]
    }

    /// In the half-plane through the axis the cone is a polygon with three sides that count.
    fn distance(&self, point: DVec3) -> f64 {
        let at = point - self.bottom;
        let z = at.dot(self.axis);
        let r = (at - z * self.axis).length();
        let to = |(r0, z0): (f64, f64), (r1, z1): (f64, f64)| {
            let along = ((r - r0) * (r1 - r0) + (z - z0) * (z1 - z0))
                / ((r1 - r0) * (r1 - r0) + (z1 - z0) * (z1 - z0));
            let along = if along.is_nan() {
                0.0
            } else {
                along.clamp(0.0, 1.0)
            };
            (r - r0 - along * (r1 - r0)).hypot(z - z0 - along * (z1 - z0))
        };
        let (bottom, top) = ((self.bottom_radius, 0.0), (self.top_radius, self.height));
        let distance = to(bottom, top)
            .min(to((0.0, 0.0), bottom))
            .min(to((0.0, self.height), top));
        let inside = z > 0.0 && z < self.height && r < self.bottom_radius + self.slope() * z;
        if inside { -distance } else { distance }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where a ray meets a cone, and in which of its primitives.
    fn met(cone: &Cone, origin: DVec3, direction: DVec3) -> Option<(f64, i32)> {
        let hit = cone.intersect(&Ray::new(origin, direction))?;
        Some((hit.t, hit.primitive))
    }

    #[test]
    fn a_ray_from_the_tip_leaves_through_the_lid() {
        let cone = Cone::new(DVec3::NEG_Z, DVec3::Z, 1.0, 0.0).unwrap();
        for direction in [DVec3::NEG_Z, DVec3::new(0.1, 0.05, -1.0)] {
            assert_eq!(met(&cone, DVec3::Z, direction), Some((2.0, 1)));
        }
    }

    #[test]
    fn the_tip_is_part_of_the_side() {
        let cone = Cone::new(DVec3::NEG_Z, DVec3::Z, 1.0, 0.0).unwrap();
        let met = met(&cone, 3.0 * DVec3::Z, DVec3::NEG_Z);
        assert_eq!(met, Some((2.0, 0)));
    }

    #[test]
    fn a_wire_is_as_thick_as_it_is() {
        for radius in [1e-4, 1e-8, 1e-12] {
            let wire = Cone::new(DVec3::ZERO, 100.0 * DVec3::Z, radius, radius).unwrap();
            // The ray passes the axis at `gap`, 300 away from its start and 70 from the bottom.
            let at = |gap: f64| Ray::new(DVec3::new(-300.0, gap, 70.0), DVec3::X);
            assert!(wire.intersect(&at(1.001 * radius)).is_none(), "{radius}");
            let hit = wire.intersect(&at(0.6 * radius)).unwrap();
            let t = 300.0 - 0.8 * radius;
            assert!(
                (hit.t - t).abs() <= 2.0 * t * f64::EPSILON,
                "{radius} {}",
                hit.t
            );
        }
    }

    /// Rays through the bottom's plane; the side is a height above it at most.
    #[test]
    fn a_flat_cone_is_as_wide_as_it_is() {
        let tilted = unit(DVec3::new(0.3, -0.4, 0.7));
        for height in [1e-7, 1e-8, 1e-9, 1e-12, 1e-16, 1e-20, 1e-50, 1e-160, 1e-300] {
            for ([bottom, top], axis) in [
                ([1.0, 0.0], DVec3::Z),
                ([0.25, 1.0], DVec3::Z),
                ([1.0, 0.0], tilted),
                ([0.25, 1.0], -tilted),
            ] {
                let cone = Cone::new(DVec3::ZERO, height * axis, bottom, top).unwrap();
                let (x, y) = axis.any_orthonormal_pair();
                for k in 0..400_u32 {
                    let angle = f64::from(k);
                    let radius = 1.5 * f64::from(k % 40) / 39.5;
                    let to = radius * (libm::cos(angle) * x + libm::sin(angle) * y);
                    let from = 3.0 * x + 0.3 * y + [2.0, -2.0, 1e-3, 40.0][(k % 4) as usize] * axis;
                    let hit = cone.intersect(&Ray::new(from, to - from));
                    let what = || format!("{cone:?} {radius} {from} {hit:?}");
                    assert_eq!(hit.is_some(), radius < 1.0, "{}", what());
                    let is_there = hit.is_none_or(|hit| (hit.t - 1.0).abs() < 1e4 * height + 1e-12);
                    assert!(is_there, "{}", what());
                }
            }
        }
    }

    /// Along a cone that is flat: in at the side, at its radius there, and out.
    #[test]
    fn rays_along_a_flat_cone_meet_its_side() {
        for height in [1e-2, 1e-5, 1e-8, 1e-30, 1e-300] {
            let cone = Cone::new(DVec3::ZERO, height * DVec3::Z, 1.0, 0.0).unwrap();
            for share in [0.25, 0.5, 0.875] {
                for rise in [0.0, 1e-3, -1e-3] {
                    let at = |x: f64| DVec3::new(x, 0.0, height * (share + rise * x));
                    let ray = Ray::new(at(-3.0), at(1.0) - at(0.0));
                    let [enter, exit] = cone.crossings(&ray).map(|hit| hit.unwrap().t - 3.0);
                    // 1 - share - rise x = |x|.
                    let expected = [(share - 1.0) / (1.0 - rise), (1.0 - share) / (1.0 + rise)];
                    for (t, expected) in [enter, exit].into_iter().zip(expected) {
                        assert!((t - expected).abs() < 1e-12, "{height} {share} {rise} {t}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_mirror_image_beyond_the_tip_is_not_there() {
        let cone = Cone::new(DVec3::ZERO, DVec3::Z, 1.0, 0.0).unwrap();
        for (x, z, direction, expected) in [
            (-5.0, 1.5, DVec3::X, None),
            (-5.0, 0.5, DVec3::X, Some((4.5, 0))),
            (0.25, 5.0, DVec3::NEG_Z, Some((4.25, 0))),
            (0.25, -5.0, DVec3::Z, Some((5.0, 1))),
        ] {
            assert_eq!(met(&cone, DVec3::new(x, 0.0, z), direction), expected);
        }
    }
}
