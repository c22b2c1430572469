use super::{Bounds, DVec3, Ray};

/// A box around the origins of some rays, one around their directions, and their parameters.
///
/// The points at a parameter `t` of at least 0 are in the box from
/// `origins.low + t * directions.low` to `origins.high + t * directions.high`. So where that box
/// and another have nothing in common at any `t`, no ray meets the other.
#[derive(Debug, Clone, Copy)]
#[doc(hidden)]
pub struct Beam {
    origins: Bounds,
    directions: Bounds,
    t_min: f64,
    t_max: f64,
}

impl Beam {
    /// The beam without any ray.
    pub const EMPTY: Self = Self {
        origins: Bounds::EMPTY,
        directions: Bounds::EMPTY,
        t_min: f64::INFINITY,
        t_max: f64::NEG_INFINITY,
    };

    /// Takes a ray in.
    #[inline]
    pub fn add(&mut self, ray: &Ray) {
        let around =
            |bounds: &Bounds, v: DVec3| Bounds { low: bounds.low.min(v), high: bounds.high.max(v) };
        self.origins = around(&self.origins, ray.origin);
        self.directions = around(&self.directions, ray.direction);
        self.t_min = self.t_min.min(ray.t_min);
        self.t_max = self.t_max.max(ray.t_max);
    }

    /// Whether no ray begins behind its origin: [`may_meet`](Self::may_meet) is for parameters of
    /// at least 0.
    #[inline]
    pub fn is_forward(&self) -> bool {
        self.t_min >= 0.0
    }

    /// The largest coordinate of an origin.
    pub fn farthest(&self) -> f64 {
        let Bounds { low, high } = self.origins;
        low.abs().max(high.abs()).max_element()
    }

    /// Whether any ray of a forward beam may pass within `margin` of a box. False only for a
    /// certain miss.
    #[inline]
    pub fn may_meet(&self, bounds: &Bounds, margin: f64) -> bool {
        let mut range = [self.t_min, self.t_max];
        for axis in 0..3 {
            let below = bounds.high[axis] + margin - self.origins.low[axis];
            let above = self.origins.high[axis] - (bounds.low[axis] - margin);
            clip(&mut range, self.directions.low[axis], below);
            clip(&mut range, -self.directions.high[axis], above);
        }
        let [from, to] = range;
        from <= to + 1e-12 * to.abs()
    }
}

/// Clips a range to the parameters with `slope * t <= most`.
#[inline]
fn clip(range: &mut [f64; 2], slope: f64, most: f64) {
    let [from, to] = range;
    if slope > 0.0 {
        *to = to.min(most / slope);
    } else if slope < 0.0 {
        *from = from.max(most / slope);
    } else if most < 0.0 {
        *to = f64::NEG_INFINITY;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The beam may meet whatever one of its rays may meet; and beams do miss.
    #[test]
    fn a_beam_may_meet_what_any_of_its_rays_may() {
        let step = |k: u32, axis: usize| {
            let roots = [2.0_f64, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0];
            (f64::from(k) * roots[axis].sqrt()).fract() - 0.5
        };
        let vector = |k, axis| DVec3::new(step(k, axis), step(k, axis + 1), step(k, axis + 2));
        let mut misses = 0;
        for k in 0..4000_u32 {
            let (start, way) = (8.0 * vector(k, 0), vector(k, 3));
            let spread = [0.0, 0.01, 0.5][k as usize % 3];
            let rays: Vec<Ray> = (0..16)
                .map(|i| {
                    let aside = spread * vector(16 * k + i, 6);
                    // Some go along an axis.
                    let flat = if k % 7 == 0 { DVec3::new(1.0, 0.0, 1.0) } else { DVec3::ONE };
                    let ray = Ray::new(start + aside, flat * (way + spread * vector(5 * k + i, 1)));
                    let ray = ray.up_to([f64::INFINITY, 3.0][k as usize % 2]);
                    ray.beyond([0.0, 0.5][k as usize / 2 % 2])
                })
                .collect();
            let mut beam = Beam::EMPTY;
            for ray in &rays {
                beam.add(ray);
            }
            assert!(beam.is_forward());
            let corner = 2.0 * vector(k, 6);
            let bounds = Bounds::of([corner, corner + (vector(k, 2) + 0.5) * 2.0]);
            let may = beam.may_meet(&bounds, 0.0);
            assert!(may || !rays.iter().any(|ray| meets(ray, &bounds)), "{k}");
            misses += u32::from(!may);
        }
        assert!(misses > 1000, "{misses}");
    }

    /// Whether a ray meets a box, by many of its points.
    fn meets(ray: &Ray, bounds: &Bounds) -> bool {
        let far = ray.t_max.min(60.0);
        (0..=2000).any(|k| {
            let t = ray.t_min + (far - ray.t_min) * f64::from(k) / 2000.0;
            bounds.contains(ray.at(t))
        })
    }

    #[test]
    fn a_beam_meets_all_of_space_and_nothing_of_the_empty_box() {
        let mut beam = Beam::EMPTY;
        beam.add(&Ray::new(DVec3::ZERO, DVec3::Z));
        assert!(beam.may_meet(&Bounds::EVERYTHING, 0.0));
        assert!(!beam.may_meet(&Bounds::EMPTY, 0.0));
        assert_eq!(beam.farthest(), 0.0);
        beam.add(&Ray::new(DVec3::NEG_X, DVec3::Z).beyond(-1.0));
        assert!(!beam.is_forward());
        assert_eq!(beam.farthest(), 1.0);
    }
}
