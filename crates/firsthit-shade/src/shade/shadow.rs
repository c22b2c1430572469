//! Light that arrives unless something is in its way.

use super::Shading;
use super::blend::transmitted;
use crate::geometry::{Color, Filtered, Ray, RayFilter, is_light};
use crate::shoot::Answers;

/// Rays towards light, each with what it brings if nothing blocks it, and to which sum. They are
/// shot together: those of neighbours go nearly the same way.
#[derive(Default)]
pub(super) struct ShadowRays {
    rays: Vec<Ray>,
    filters: Vec<RayFilter>,
    brought: Vec<(usize, Color)>,
}

impl ShadowRays {
    pub(super) fn with_capacity(count: usize) -> Self {
        Self {
            rays: Vec::with_capacity(count),
            filters: Vec::with_capacity(count),
            brought: Vec::with_capacity(count),
        }
    }

    /// A ray that brings light to the sum of that number. A colour that is no number, as of lights
    /// beyond the range of float64, is no light.
    #[inline]
    pub(super) fn push(&mut self, (ray, filter): (Ray, RayFilter), sum: usize, light: Color) {
        if !is_light(light) {
            return;
        }
        self.rays.push(ray);
        self.filters.push(filter);
        self.brought.push((sum, light));
    }

    /// Adds the light of the rays that meet nothing to their sums, of all where nothing casts
    /// `shadows`, and forgets the rays.
    pub(super) fn add_to(&mut self, sums: &mut [Color], shading: &Shading<'_>, shadows: bool) {
        if !shadows || self.rays.is_empty() {
            for &(sum, light) in &self.brought {
                sums[sum] += light;
            }
        } else if shading.scene.has_translucent() {
            let shares = transmitted(shading, &self.rays, &self.filters);
            for (&(sum, light), share) in self.brought.iter().zip(shares) {
                sums[sum] += share * light;
            }
        } else {
            for (&(sum, light), blocked) in self.brought.iter().zip(self.blocked(shading)) {
                if !blocked {
                    sums[sum] += light;
                }
            }
        }
        self.rays.clear();
        self.filters.clear();
        self.brought.clear();
    }

    /// Finds the rays that meet something.
    fn blocked(&self, shading: &Shading<'_>) -> Vec<bool> {
        let mut blocked = vec![false; self.rays.len()];
        let rays = Filtered::each(&self.rays, &self.filters);
        let answers = Answers::Any(&mut blocked);
        let traced = shading.engine.trace(shading.scene, &rays, answers, &());
        debug_assert!(traced.is_ok(), "no watch can stop it");
        blocked
    }
}
