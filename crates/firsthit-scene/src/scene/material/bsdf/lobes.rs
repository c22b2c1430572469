//! Directions of layered surfaces, drawn as often as light is likely to come from them.

use std::f64::consts::PI;

use super::BsdfSample;
use super::frame::Frame;
use super::layered::Layered;
use super::microfacet::{self, Microfacets};
use crate::geometry::{Color, DVec2, DVec3, is_light};
use crate::sampling::warp;

/// The ways in which a layered surface scatters light, and how often each is drawn.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct LobeProbabilities {
    diffuse: f64,
    sheen: f64,
    specular: f64,
    transmission: f64,
    coat: f64,
}

impl Layered {
    /// Probabilities in proportion to the approximate albedo of each lobe.
    pub(super) fn lobe_probabilities(&self) -> LobeProbabilities {
        let mean = |of: &dyn Fn(f64) -> Color| {
            let here = of(self.out.z).element_sum() / 3.0;
            if self.facets.is_smooth() {
                return here;
            }
            // Some microfacets are met head on: they let light through that others reflect.
            0.5 * (here + of(1.0).element_sum() / 3.0)
        };
        // Seen from the side, the microfacets that light comes through are met much more steeply
        // than the surface.
        let from_side = (self.leftover).and_then(|leftover| leftover.albedo_from_side());
        let diffuse = from_side.map_or_else(
            || mean(&|cosine| self.diffuse(cosine)),
            |albedo| albedo * self.ground().element_sum() / 3.0,
        );
        let sheen = self.sheen.map_or(0.0, |sheen| sheen.brightness());
        let [specular, transmission] =
            [mean(&|cosine| self.specular(cosine)), mean(&|cosine| self.passed(cosine))];
        let coat = self.coat.map_or(0.0, |coat| coat.share);
        let sum = diffuse + sheen + specular + transmission;
        if sum > 0.0 {
            let each = (1.0 - coat) / sum;
            LobeProbabilities {
                diffuse: diffuse * each,
                sheen: sheen * each,
                specular: specular * each,
                transmission: transmission * each,
                coat,
            }
        } else {
            let coat = f64::from(coat > 0.0);
            LobeProbabilities { coat, ..LobeProbabilities::default() }
        }
    }

    /// The pdf of all ways that draw more than single directions.
    pub(super) fn pdf(&self, frame: &Frame, towards: DVec3) -> f64 {
        let lobes = &self.lobes;
        let into = self.axes.local(towards);
        let flat = towards.dot(frame.geometric);
        if flat > 0.0 {
            let coat = lobes.coat * self.coat.map_or(0.0, |coat| coat.pdf(towards));
            if into.z <= 0.0 {
                return coat;
            }
            let specular = if self.facets.is_smooth() {
                0.0
            } else {
                lobes.specular * self.facets.reflection_pdf(self.out, into)
            };
            let sheen = lobes.sheen * warp::cap_density(1.0);
            lobes.diffuse * into.z / PI + sheen + specular + coat
        } else if into.z < 0.0 && flat < 0.0 && !self.is_straight_through() {
            lobes.transmission * self.pdf_through(into)
        } else {
            0.0
        }
    }

    fn pdf_through(&self, into: DVec3) -> f64 {
        match self.ior {
            Some(ior) => Microfacets::refracting(self.out, into, ior)
                .map_or(0.0, |facet| self.facets.refraction_pdf(self.out, facet)),
            None => (self.facets).reflection_pdf(self.out, microfacet::thin(into)),
        }
    }

    pub(super) fn sample(&self, frame: &Frame, u: [f64; 3]) -> Option<BsdfSample> {
        let lobes = self.lobes;
        let (u, mut left) = (DVec2::new(u[0], u[1]), u[2]);
        let mut is_chosen = |probability: f64| {
            let is_chosen = left < probability;
            left -= probability;
            is_chosen
        };
        let towards = if is_chosen(lobes.coat) {
            let coat = self.coat?;
            if coat.facets.is_smooth() {
                return self.of_coat().map(|one| one.drawn(lobes.coat));
            }
            coat.sample(u)
        } else if is_chosen(lobes.diffuse) {
            self.axes.world(warp::cosine_hemisphere(u))
        } else if is_chosen(lobes.sheen) {
            // From all sides alike: fibres are brightest in light from the side.
            self.axes.world(warp::cap(u, 1.0))
        } else {
            let is_through = is_chosen(lobes.transmission);
            if is_through && self.is_straight_through() {
                return (self.straight(frame)).map(|one| one.drawn(lobes.transmission));
            }
            if self.facets.is_smooth() {
                return (self.specular_reflection(frame)).map(|one| one.drawn(lobes.specular));
            }
            let facet = self.facets.sample(self.out, u);
            let reflected = microfacet::reflected(self.out, facet);
            let into = match (is_through, self.ior) {
                (true, Some(ior)) => microfacet::through(self.out, facet, ior)?,
                // Light that continues below the surface is lost: it is reflected once.
                _ if reflected.z <= 0.0 => return None,
                (true, None) => microfacet::thin(reflected),
                (false, _) => reflected,
            };
            self.axes.world(into)
        };
        let pdf = self.pdf(frame, towards);
        let weight = self.value(frame, towards) / pdf;
        is_light(weight).then_some(BsdfSample { towards, weight, pdf: Some(pdf) })
    }

    /// All directions that light comes from in one way only: in a smooth mirror, straight through,
    /// in a smooth coat.
    pub(super) fn branches(&self, frame: &Frame) -> [Option<BsdfSample>; 3] {
        let coat = self.coat.filter(|coat| coat.facets.is_smooth());
        let coat = coat.and_then(|_| self.of_coat());
        let is_smooth = self.facets.is_smooth();
        [
            is_smooth.then(|| self.specular_reflection(frame)).flatten(),
            (self.is_straight_through()).then(|| self.straight(frame)).flatten(),
            coat,
        ]
    }

    fn specular_reflection(&self, frame: &Frame) -> Option<BsdfSample> {
        let into = microfacet::reflected(self.out, DVec3::Z);
        let towards = self.axes.world(into);
        let weight = self.left(into) * frame.share(towards) * self.specular(self.out.z);
        BsdfSample::single(towards, weight)
    }

    fn straight(&self, frame: &Frame) -> Option<BsdfSample> {
        let Some(ior) = self.ior else {
            let weight = self.left(self.out) * self.passed(self.out.z);
            return BsdfSample::single(-frame.out, weight);
        };
        let below = |towards: &DVec3| towards.dot(frame.geometric) < 0.0;
        let refracted = |normal| super::fresnel::refracted(frame.out, normal, ior);
        // Where the smooth normal would send light out again, the face's own decides.
        let towards = refracted(frame.normal).filter(below);
        let towards = towards.or_else(|| refracted(frame.geometric))?;
        // A ray's radiance is the less the wider its cone.
        let weight = self.left(self.out) * self.passed(self.out.z) / (ior * ior);
        BsdfSample::single(towards, weight)
    }

    fn of_coat(&self) -> Option<BsdfSample> {
        let (towards, weight) = self.coat?.reflection();
        BsdfSample::single(towards, Color::splat(weight))
    }
}
