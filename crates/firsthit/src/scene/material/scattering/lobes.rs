//! Directions of layered surfaces, drawn as often as light is likely to come from them.

use std::f64::consts::PI;

use super::Scattered;
use super::frame::Frame;
use super::layered::Layered;
use super::microfacet::{self, Microfacets};
use crate::geometry::{Color, DVec2, DVec3};
use crate::sampling::warp;

/// The ways in which a layered surface scatters light, and how often each is drawn.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Shares {
    ground: f64,
    mirror: f64,
    through: f64,
    coat: f64,
}

impl Layered {
    /// In proportion to what each way brings of white light from everywhere, more or less.
    pub(super) fn found_shares(&self) -> Shares {
        let mean = |of: &dyn Fn(f64) -> Color| {
            let here = of(self.out.z).element_sum() / 3.0;
            if self.facets.is_smooth() {
                return here;
            }
            // Some of the small mirrors are met head on, where they let light through that others reflect.
            0.5 * (here + of(1.0).element_sum() / 3.0)
        };
        let fibres = self.sheen.map_or(0.0, |sheen| sheen.brightness());
        let [ground, mirror, through] = [
            mean(&|cosine| self.ground(cosine)) + fibres,
            mean(&|cosine| self.mirror(cosine)),
            mean(&|cosine| self.passed(cosine)),
        ];
        let coat = self.coat.map_or(0.0, |coat| coat.share);
        let sum = ground + mirror + through;
        if sum > 0.0 {
            let each = (1.0 - coat) / sum;
            Shares {
                ground: ground * each,
                mirror: mirror * each,
                through: through * each,
                coat,
            }
        } else {
            let coat = f64::from(coat > 0.0);
            Shares {
                coat,
                ..Shares::default()
            }
        }
    }

    /// The density of all ways that draw more than single directions.
    pub(super) fn density(&self, frame: &Frame, towards: DVec3) -> f64 {
        let shares = &self.shares;
        let into = self.axes.local(towards);
        let flat = towards.dot(frame.geometric);
        if into.z > 0.0 && flat > 0.0 {
            let mirror = if self.facets.is_smooth() {
                0.0
            } else {
                shares.mirror * self.facets.reflection_density(self.out, into)
            };
            let coat = self.coat.map_or(0.0, |coat| coat.density(towards));
            shares.ground * into.z / PI + mirror + shares.coat * coat
        } else if into.z < 0.0 && flat < 0.0 && !self.is_straight_through() {
            shares.through * self.density_through(into)
        } else {
            0.0
        }
    }

    fn density_through(&self, into: DVec3) -> f64 {
        match self.ior {
            Some(ior) => Microfacets::refracting(self.out, into, ior).map_or(0.0, |mirror| {
                self.facets.refraction_density(self.out, mirror)
            }),
            None => (self.facets).reflection_density(self.out, microfacet::thin(into)),
        }
    }

    pub(super) fn sample(&self, frame: &Frame, u: [f64; 3]) -> Option<Scattered> {
        let shares = self.shares;
        let (u, mut left) = (DVec2::new(u[0], u[1]), u[2]);
        let mut is_chosen = |share: f64| {
            let is_chosen = left < share;
            left -= share;
            is_chosen
        };
        let towards = if is_chosen(shares.coat) {
            let coat = self.coat?;
            if coat.facets.is_smooth() {
                return self.of_coat(frame).map(|one| one.drawn(shares.coat));
            }
            coat.sample(u)
        } else if is_chosen(shares.ground) {
            self.axes.world(warp::cosine_hemisphere(u))
        } else {
            let is_through = is_chosen(shares.through);
            if is_through && self.is_straight_through() {
                return (self.straight(frame)).map(|one| one.drawn(shares.through));
            }
            if self.facets.is_smooth() {
                return (self.in_mirror(frame)).map(|one| one.drawn(shares.mirror));
            }
            let facet = self.facets.sample(self.out, u);
            let mirrored = microfacet::mirrored(self.out, facet);
            let into = match (is_through, self.ior) {
                (true, Some(ior)) => microfacet::through(self.out, facet, ior)?,
                // What goes on below the surface is lost: light is reflected once.
                _ if mirrored.z <= 0.0 => return None,
                (true, None) => microfacet::thin(mirrored),
                (false, _) => mirrored,
            };
            self.axes.world(into)
        };
        let density = self.density(frame, towards);
        let weight = self.value(frame, towards) / density;
        // Written so that a NaN fails.
        (weight.max_element() > 0.0).then_some(Scattered {
            towards,
            weight,
            density: Some(density),
        })
    }

    /// All directions that light comes from in one way only: in a smooth mirror, straight through, in a smooth coat.
    pub(super) fn branches(&self, frame: &Frame) -> [Option<Scattered>; 3] {
        let coat = self.coat.filter(|coat| coat.facets.is_smooth());
        let coat = coat.and_then(|_| self.of_coat(frame));
        let is_smooth = self.facets.is_smooth();
        [
            is_smooth.then(|| self.in_mirror(frame)).flatten(),
            (self.is_straight_through())
                .then(|| self.straight(frame))
                .flatten(),
            coat,
        ]
    }

    fn in_mirror(&self, frame: &Frame) -> Option<Scattered> {
        let into = microfacet::mirrored(self.out, DVec3::Z);
        let towards = self.axes.world(into);
        let weight = self.left(into) * frame.share(towards) * self.mirror(self.out.z);
        Scattered::single(towards, weight)
    }

    fn straight(&self, frame: &Frame) -> Option<Scattered> {
        let Some(ior) = self.ior else {
            let weight = self.left(self.out) * self.passed(self.out.z);
            return Scattered::single(-frame.out, weight);
        };
        let below = |towards: &DVec3| towards.dot(frame.geometric) < 0.0;
        let refracted = |normal| super::fresnel::refracted(frame.out, normal, ior);
        // Where the smooth normal would send light out again, the face's own decides.
        let towards = refracted(frame.normal).filter(below);
        let towards = towards.or_else(|| refracted(frame.geometric))?;
        // A ray's radiance is the less the wider its cone.
        let weight = self.left(self.out) * self.passed(self.out.z) / (ior * ior);
        Scattered::single(towards, weight)
    }

    fn of_coat(&self, frame: &Frame) -> Option<Scattered> {
        let coat = self.coat?;
        let towards = coat.mirrored(DVec3::Z);
        Scattered::single(towards, Color::splat(coat.share * frame.share(towards)))
    }
}
