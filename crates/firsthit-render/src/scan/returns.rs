//! Hits to returns: those that lie close behind one another are one.

use super::lines::{Lines, Met};
use super::settings::{Returns, ScanSettings};
use crate::channel::{ChannelInput, kind, make};
use crate::error::Result;
use crate::geometry::{DVec3, Rays, luminance};
use crate::image::Data;
use crate::parallel;
use crate::scene::Scene;
use crate::shoot::RaysOfHits;
use crate::watch::{OnlyStops, Watch};

/// A return of a beam that is kept.
pub(super) struct Kept {
    pub(super) beam: usize,
    /// The number of the line of its nearest hit.
    pub(super) line: i32,
    /// The place of its nearest hit.
    pub(super) at: usize,
    pub(super) range: f64,
    /// Its number in its beam, from 1 on.
    pub(super) number: i32,
    /// The returns of its beam that are told.
    pub(super) total: i32,
    /// The share of the light that comes back, without the fall-off.
    pub(super) echo: f64,
}

/// A hit of a beam, and its share of the light.
struct Echo {
    line: i32,
    at: usize,
    range: f64,
    share: f64,
}

/// The returns of beams that are kept, beam by beam, and each beam's by range.
pub(super) fn of(
    met: &Met,
    lines: &Lines<'_>,
    scene: &Scene,
    settings: &ScanSettings,
    watch: &dyn Watch,
) -> Result<Vec<Kept>> {
    let shares = shares(met, lines, scene, settings, watch)?;
    let even = 1.0 / lines.each as f64;
    let part = (parallel::MANY / lines.each).max(1);
    let parts = (0..lines.beams.len()).step_by(part);
    Ok(parallel::gather(parts, |first| {
        let (mut kept, mut echoes) = (Vec::new(), Vec::new());
        for beam in first..lines.beams.len().min(first + part) {
            for line in beam * lines.each..(beam + 1) * lines.each {
                echoes.extend(met.of_line(line).map(|at| Echo {
                    line: i32::try_from(line).unwrap_or(i32::MAX),
                    at,
                    range: met.hits.t[at],
                    share: shares.get(at).copied().unwrap_or(even),
                }));
            }
            // Stable: of equal ones the line that comes first is first.
            echoes.sort_by(|a, b| a.range.total_cmp(&b.range));
            keep(&echoes, lines.beams.start + beam, settings, &mut kept);
            echoes.clear();
        }
        kept
    }))
}

/// The share of the light that each hit sends back, without the fall-off; none where it does not
/// matter.
fn shares(
    met: &Met,
    lines: &Lines<'_>,
    scene: &Scene,
    settings: &ScanSettings,
    watch: &dyn Watch,
) -> Result<Vec<f64>> {
    if !settings.needs_surfaces() {
        return Ok(Vec::new());
    }
    let numbers = met.lines();
    let rays = RaysOfHits::new(lines, &numbers);
    let shots = ChannelInput { scene, rays: &rays, hits: &met.hits, sensor: None };
    let kinds = [kind("base_color")?, kind("normal")?];
    let made = make(&kinds, &shots, &OnlyStops(watch))?;
    let [Data::Float64(colors), Data::Float64(normals)] = [&made[0].data, &made[1].data] else {
        return Ok(Vec::new());
    };
    let (colors, normals) = (colors.as_chunks::<3>().0, normals.as_chunks::<3>().0);
    let share = |k: usize| {
        let cosine = cosine(DVec3::from(normals[k]), rays.ray(k).direction);
        luminance(colors[k].into()) * cosine / lines.each as f64
    };
    let parts = (0..met.hits.len()).step_by(parallel::MANY);
    Ok(parallel::gather(parts, |first| {
        (first..met.hits.len().min(first + parallel::MANY)).map(share).collect()
    }))
}

/// The cosine between a normal of length one and a direction, whichever sides they are on.
fn cosine(normal: DVec3, direction: DVec3) -> f64 {
    let along = direction.dot(normal).abs() / direction.dot(direction).sqrt();
    along.min(1.0)
}

/// Makes returns of the hits of a beam, by range, and keeps those that are wanted.
fn keep(echoes: &[Echo], beam: usize, settings: &ScanSettings, kept: &mut Vec<Kept>) {
    let first = kept.len();
    let (mut rest, mut strongest) = (echoes, (f64::NEG_INFINITY, 0));
    // Without a gate a line's crossings are returns of their own, however near to one another.
    let joins = settings.range_gate > 0.0 || settings.divergence.is_some();
    while let Some(nearest) = rest.first() {
        let is_near = |echo: &&Echo| echo.range - nearest.range <= settings.range_gate;
        let size = if joins { rest.iter().take_while(is_near).count() } else { 1 };
        let (own, others) = rest.split_at(size);
        let power = sum(own, |echo| {
            let range = echo.range.max(1e-150);
            echo.share / (range * range)
        });
        if power > strongest.0 {
            strongest = (power, kept.len() - first);
        }
        kept.push(Kept {
            beam,
            line: nearest.line,
            at: nearest.at,
            range: if size == 1 {
                nearest.range
            } else {
                sum(own, |echo| echo.range) / size as f64
            },
            number: i32::try_from(kept.len() - first + 1).unwrap_or(i32::MAX),
            total: 0,
            echo: sum(own, |echo| echo.share),
        });
        rest = others;
    }
    let count = kept.len() - first;
    let most = settings.max_returns.unwrap_or(usize::MAX).min(count);
    let wanted = match settings.returns {
        _ if count == 0 => return,
        Returns::First => 0..1,
        Returns::Last => count - 1..count,
        Returns::Strongest => strongest.1..strongest.1 + 1,
        // As the receiver says it, which has no place for more.
        Returns::All => 0..most,
    };
    kept.truncate(first + wanted.end);
    kept.drain(first..first + wanted.start);
    for kept in &mut kept[first..] {
        kept.total = i32::try_from(most).unwrap_or(i32::MAX);
    }
}

/// The sum over some hits: the first, and the others in pairs (Higham, "The Accuracy of Floating
/// Point Summation", SIAM Journal on Scientific Computing 14(4), 1993).
fn sum(echoes: &[Echo], value: impl Fn(&Echo) -> f64) -> f64 {
    match echoes {
        [] => 0.0,
        [one] => value(one),
        [one, others @ ..] => {
            let others: Vec<f64> = others.iter().map(&value).collect();
            value(one) + pairwise(&others)
        }
    }
}

/// The sum of numbers in eight rows, halved where they are many.
fn pairwise(values: &[f64]) -> f64 {
    if values.len() > 128 {
        let (low, high) = values.split_at(values.len() / 2 / 8 * 8);
        return pairwise(low) + pairwise(high);
    }
    let (eights, rest) = values.as_chunks::<8>();
    let Some((&first, eights)) = eights.split_first() else {
        return rest.iter().sum();
    };
    let rows = |rows: [f64; 8], more: &[f64; 8]| std::array::from_fn(|k| rows[k] + more[k]);
    let [a, b, c, d, e, f, g, h] = eights.iter().fold(first, rows);
    let sum = ((a + b) + (c + d)) + ((e + f) + (g + h));
    rest.iter().fold(sum, |sum, x| sum + x)
}
