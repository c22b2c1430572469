//! The settings of a scan.

use std::f64::consts::PI;

use serde_json::{Value, json};

use crate::error::{Error, Result};
use crate::geometry::{named, require};

/// No noise is as large: ranges go to 1e150, and their product must be a number.
const MOST_NOISE: f64 = 1e100;

/// A cone of more lines takes long and tells no more: its lines are then a 256th of it apart.
const MOST_SUBRAYS: usize = 1 << 16;

named! {
    /// The returns of a beam that are kept.
    pub enum Returns, "returns":
    /// The nearest one.
    #[default]
    "first" => First;
    /// The farthest one.
    "last" => Last;
    /// The one with the largest sum of luminance times the cosine of incidence over the squared
    /// range; of equal ones the nearest.
    "strongest" => Strongest;
    /// All of them.
    "all" => All;
}

named! {
    /// The numbers of lasers.
    pub enum Rings, "rings":
    /// The maker's.
    #[default]
    "maker" => Maker;
    /// From 0 on for the laser whose lowest beam is the lowest, as drivers of ROS for Velodynes
    /// count.
    "lowest-first" => LowestFirst;
}

/// The settings of a scan. Lengths are in scene units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScanSettings {
    /// The returns of a beam that are kept.
    pub returns: Returns,
    /// The full angle of a beam's cone, in radians; `None` for a line.
    pub divergence: Option<f64>,
    /// The number of lines that fill a cone, at most 65,536: the first is its middle, the others
    /// lie on a spiral of equal areas.
    pub subrays: usize,
    /// The resolution of the receiver: hits up to this far behind the nearest one of a return
    /// belong to that return, whose range is their mean.
    pub range_gate: f64,
    /// With all returns: the most that are told of a beam, the nearest.
    pub max_returns: Option<usize>,
    /// Ranges are beyond this. A nearer surface blocks its line.
    pub min_range: f64,
    /// The longest range.
    pub max_range: f64,
    /// Whether each return has an intensity: the mean over the beam's lines of the luminance
    /// (Rec. 709) of the surface's base colour times the cosine of incidence.
    pub intensity: bool,
    /// The standard deviation of a range: the first number plus the second times the range. A
    /// return that its noise takes out of the limits of ranges, or to zero or below, is lost.
    pub noise: Option<[f64; 2]>,
    /// The probability that a return is lost.
    pub dropout: Option<f64>,
    /// The seed of noise and dropout, which need one. The numbers of a return depend on this, the
    /// beam and the return's number alone.
    pub seed: Option<u64>,
    /// The numbers of lasers.
    pub rings: Rings,
}

impl Default for ScanSettings {
    fn default() -> Self {
        Self {
            returns: Returns::First,
            divergence: None,
            subrays: 16,
            range_gate: 0.0,
            max_returns: None,
            min_range: 0.0,
            max_range: f64::INFINITY,
            intensity: false,
            noise: None,
            dropout: None,
            seed: None,
            rings: Rings::Maker,
        }
    }
}

impl ScanSettings {
    /// Fails for settings that make no sense.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for numbers out of range, for noise or dropout without a seed, for a
    /// number of returns of a beam that does not have all, and for one of the lines of a cone that
    /// does not diverge.
    pub fn check(&self) -> Result<()> {
        let within = |name, value: f64, below: f64, expected: &'static str| {
            require(name, expected, (0.0..below).contains(&value), value)
        };
        if let Some(angle) = self.divergence {
            within("divergence", angle, PI, "from 0 to below pi")?;
        }
        within("range_gate", self.range_gate, f64::INFINITY, "from 0 on, and finite")?;
        let (near, far) = (self.min_range, self.max_range);
        let rises = 0.0 <= near && near < far;
        require(
            "min_range and max_range",
            "from 0 on and increase",
            rises,
            format!("{near} and {far}"),
        )?;
        for spread in self.noise.into_iter().flatten() {
            within("noise", spread, MOST_NOISE, "from 0 to below 1e100")?;
        }
        if let Some(share) = self.dropout {
            require("dropout", "from 0 to 1", (0.0..=1.0).contains(&share), share)?;
        }
        let is_random = self.noise.is_some() || self.dropout.is_some();
        let expected = "given with noise or dropout, which are random";
        require("seed", expected, !is_random || self.seed.is_some(), "none")?;
        let is_few = (1..=MOST_SUBRAYS).contains(&self.subrays);
        require("subrays", "from 1 to 65536", is_few, self.subrays)?;
        let is_idle = self.divergence.is_none() && self.subrays != Self::default().subrays;
        require("subrays", "left out unless there is a divergence", !is_idle, self.subrays)?;
        let Some(most) = self.max_returns else {
            return Ok(());
        };
        require("max_returns", "1 or more", most > 0, most)?;
        if self.returns != Returns::All {
            let expected = "left out unless returns is all";
            return Err(Error::argument(
                "max_returns",
                expected,
                format!("returns {}", self.returns.name()),
            ));
        }
        Ok(())
    }

    /// A warning of lines of a cone that end as returns of their own, which no receiver has, where
    /// that is seen.
    pub fn warning(&self) -> Option<String> {
        let is_told = self.returns != Returns::First || self.intensity;
        let splits = self.lines() > 1 && is_told && self.range_gate == 0.0;
        splits.then(|| {
            format!(
                "each of the {} lines of a beam is a return of its own: give a range_gate, what the receiver resolves",
                self.subrays
            )
        })
    }

    /// The settings in metadata.
    #[doc(hidden)]
    pub fn record(&self) -> Value {
        let mut record = json!({
            "returns": self.returns.name(),
            "divergence": self.divergence,
            "subrays": self.divergence.map(|_| self.subrays),
            "range_gate": self.range_gate,
            "max_returns": self.max_returns,
            "min_range": self.min_range,
            // JSON has no infinity.
            "max_range": Some(self.max_range).filter(|far| far.is_finite()),
            "noise": self.noise,
            "dropout": self.dropout,
            "seed": self.seed,
        });
        if self.rings != Rings::Maker {
            record["rings"] = self.rings.name().into();
        }
        record
    }

    /// The number of lines of a beam.
    pub fn lines(&self) -> usize {
        self.divergence.map_or(1, |_| self.subrays)
    }

    /// Whether the brightness of hits matters.
    pub(super) fn needs_surfaces(&self) -> bool {
        self.intensity || self.returns == Returns::Strongest
    }
}
