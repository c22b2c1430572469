//! Noise and dropout: random numbers of a return's own.
//!
//! They are hashes of the seed, the beam and the return's number ([`Draws`]): not streams, so no
//! order of work changes them.

use std::f64::consts::TAU;

use super::returns::Kept;
use super::settings::ScanSettings;
use crate::sampling::Draws;

/// The changes of the ranges of returns.
pub(super) struct Noise {
    seed: u64,
    spread: Option<[f64; 2]>,
    dropout: f64,
    is_random: bool,
}

impl Noise {
    pub(super) fn of(settings: &ScanSettings) -> Self {
        Self {
            seed: settings.seed.unwrap_or_default(),
            spread: settings.noise,
            dropout: settings.dropout.unwrap_or_default(),
            is_random: settings.seed.is_some(),
        }
    }

    /// The range that is measured; `None` for a return that is lost, also because its noise takes
    /// it out of the limits of ranges.
    pub(super) fn of_return(&self, kept: &Kept, settings: &ScanSettings) -> Option<f64> {
        if !self.is_random {
            return Some(kept.range);
        }
        let number = kept.number.unsigned_abs().into();
        let mut draws = Draws::new(kept.beam as u64, 0).split(self.seed).split(number);
        // The first are for the noise, also where there is none.
        let (normal, lost) = (normal(&mut draws), draws.one());
        let spread = |[constant, relative]: [f64; 2]| constant + relative * kept.range;
        let range = kept.range + self.spread.map_or(0.0, |noise| spread(noise) * normal);
        let is_within = settings.min_range < range && range <= settings.max_range;
        (is_within && lost >= self.dropout).then_some(range)
    }
}

/// A number of the standard normal distribution (Box and Muller, "A Note on the Generation of
/// Random Normal Deviates", Annals of Mathematical Statistics 29(2), 1958).
fn normal(draws: &mut Draws) -> f64 {
    let u = draws.two();
    // From above 0 up to 1.
    let radius = (-2.0 * libm::log(1.0 - u.x)).sqrt();
    radius * libm::cos(TAU * u.y)
}
