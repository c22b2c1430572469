//! The stretch of a line that is inside a cone.

use super::super::bundle::{
    CrossingOf, RayOf, Vector, abs, dot, equal, has_minus, larger, minus, negative, plus, smaller,
    splat, squared, times,
};
use super::super::interval::Interval;
use super::Cone;
use crate::geometry::arithmetic::Arithmetic;

/// The largest change of a cone's radius, in heights, that is not flat.
const FLAT: f64 = 4.0;

/// A line, or one in each lane, relative to a cone's axis: across it and along it, at the start and
/// in one unit of its parameter.
#[derive(Clone, Copy)]
struct Line<N> {
    across: Vector<N>,
    d_across: Vector<N>,
    z: N,
    dz: N,
}

impl Cone {
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
        let line = Line {
            across: minus(of, at, times(of, z, axis)),
            d_across: minus(of, along, times(of, dz, axis)),
            z,
            dz,
        };
        let slab = self.slab(of, line);
        if !slab.is_anywhere() {
            return slab;
        }
        if FLAT * self.height < (self.top_radius - self.bottom_radius).abs() {
            self.inside_flat(of, line)
        } else {
            self.inside_slab(of, slab, line)
        }
    }

    /// The stretch between the planes of the lids.
    #[inline(always)]
    fn slab<A: Arithmetic>(&self, of: A, line: Line<A::Number>) -> Interval<A> {
        // A tip is part of the side: there is no lid.
        let bottom = i32::from(self.bottom_radius > 0.0);
        let top = 2 * i32::from(self.top_radius > 0.0);
        let lids = [(0.0, bottom), (self.height, top)];
        Interval::line(of).between(lids, line.z, line.dz)
    }

    /// The stretch of a line inside a flat cone. The line's height is off by a rounding, and the
    /// radius there by so much times the slope. So the line starts anew where it enters the slab
    /// between the lids, where its height is exact, and goes through the slab in one unit. If it
    /// goes a long way through the slab, it starts where it is nearest to the axis.
    #[inline(always)]
    fn inside_flat<A: Arithmetic>(&self, of: A, line: Line<A::Number>) -> Interval<A> {
        let (zero, height) = (of.number(0.0), of.number(self.height));
        let is_upwards = of.lt(zero, line.dz);
        let first = of.select(is_upwards, zero, height);
        let last = of.select(is_upwards, height, zero);
        let enter = of.div(of.sub(first, line.z), line.dz);
        let exit = of.div(of.sub(last, line.z), line.dz);
        let stretch = of.div(height, abs(of, line.dz));
        let size = self.height + self.bottom_radius + self.top_radius;
        let steepness = squared(of, line.d_across);
        let way = of.mul(steepness, of.mul(stretch, stretch));
        let is_short = of.le(way, of.number(size * size));
        let nearest = of.div(negative(of, dot(of, line.across, line.d_across)), steepness);
        let within = smaller(of, larger(of, nearest, enter), exit);
        let nearest = of.select(equal(of, line.dz, zero), nearest, within);
        let start = of.select(is_short, enter, nearest);
        let unit = of.select(is_short, stretch, of.number(1.0));
        let height_there = of.add(line.z, of.mul(nearest, line.dz));
        let line = Line {
            across: plus(of, line.across, times(of, start, line.d_across)),
            d_across: times(of, unit, line.d_across),
            z: of.select(is_short, first, height_there),
            dz: of.select(is_short, of.sub(last, first), line.dz),
        };
        let slab = self.slab(of, line);
        self.inside_slab(of, slab, line).scaled(unit).moved(start)
    }

    /// The stretch of a line inside, of what is between the lids.
    #[inline(always)]
    fn inside_slab<A: Arithmetic>(
        &self,
        of: A,
        slab: Interval<A>,
        line: Line<A::Number>,
    ) -> Interval<A> {
        let Line { across, d_across, z, dz } = line;
        let slope = of.number(self.slope());
        let radius = of.add(of.number(self.bottom_radius), of.mul(slope, z));
        let d_radius = of.mul(slope, dz);
        // Inside is where a t^2 + 2 b t + c <= 0. Between the lids the radius is not negative, so
        // the cone's mirror image beyond its tip does not count.
        let steepness = squared(of, d_across);
        let a = of.sub(steepness, of.mul(d_radius, d_radius));
        let b = of.sub(dot(of, across, d_across), of.mul(radius, d_radius));
        let c = of.sub(squared(of, across), of.mul(radius, radius));
        // From where the line is deepest inside: b * b - a * c is all rounding for a thin shape.
        // (Haines, Günther and Akenine-Möller, see the sphere.)
        let is_steep = of.lt(of.mul(of.number(0.5), steepness), a);
        let deepest = of.div(negative(of, b), a);
        let radius_there = of.add(radius, of.mul(deepest, d_radius));
        let across_there = plus(of, across, times(of, deepest, d_across));
        let depth = of.sub(of.mul(radius_there, radius_there), squared(of, across_there));
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
        // Steeper than the side: outside between the roots. One side of them is the mirror image's,
        // where the slab leaves nothing, or at the tip what rounding makes of nothing.
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
    pub(super) fn along<A: Arithmetic>(&self, of: A, ray: &RayOf<A::Number>) -> Interval<A> {
        let at = minus(of, ray.origin, splat(of, self.bottom));
        // From far away the quadratic's terms would be all rounding: start it where the line is
        // nearest.
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
        // A line far outside, by more than rounding, meets nothing. Here, because the fourth powers
        // below may overflow.
        let rounding = of.mul(of.number(1e-14), of.sqrt(squared_distance));
        let most = of.add(of.number(2.0 * size), rounding);
        let is_outside = is_far & of.lt(most, of.sqrt(squared(of, nearest)));
        self.inside(of, nearest, ray.direction).only(!is_outside).moved(start)
    }

    /// The first crossings of rays with the cone.
    #[inline(always)]
    pub(in crate::shape) fn first<A: Arithmetic>(
        &self,
        of: A,
        ray: &RayOf<A::Number>,
    ) -> CrossingOf<A> {
        self.along(of, ray).first(ray)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{DVec3, Ray, unit};
    use crate::shape::Surface;

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
}
