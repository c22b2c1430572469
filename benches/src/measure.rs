//! Time: in turns, each contestant once a round, so that what disturbs the machine disturbs all.

use std::time::Instant;

use cpu_time::ThreadTime;
use rayon::ThreadPool;

/// The smallest and the median of some times, in nanoseconds for each thing done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Timing {
    pub(crate) min: f64,
    pub(crate) median: f64,
}

impl Timing {
    fn of(mut times: Vec<f64>) -> Self {
        times.sort_by(f64::total_cmp);
        Self { min: times[0], median: times[times.len() / 2] }
    }
}

/// The processor time of this thread for each of the `things` that `work` does, in nanoseconds.
pub(crate) fn once(things: usize, work: &mut dyn FnMut()) -> f64 {
    let start = ThreadTime::now();
    work();
    1e9 * start.elapsed().as_secs_f64() / things.max(1) as f64
}

/// Runs all `contestants` in turns, `rounds` times each and once more before, and counts the
/// processor time of this thread for each of the `things` that one run does.
pub(crate) fn in_turns(
    rounds: u32,
    things: usize,
    contestants: &mut [&mut dyn FnMut()],
) -> Vec<Timing> {
    let mut times = vec![Vec::new(); contestants.len()];
    for round in 0..=rounds {
        for (times, contestant) in times.iter_mut().zip(contestants.iter_mut()) {
            let time = once(things, contestant);
            // The first touches memory and wakes the processor's wide half.
            if round > 0 {
                times.push(time);
            }
        }
    }
    times.into_iter().map(Timing::of).collect()
}

/// The speedup of `work` by the two threads of `pool` over this thread, by the clock on the wall:
/// another program on a core shows here.
pub(crate) fn speedup(rounds: u32, pool: &ThreadPool, work: &(impl Fn() + Sync)) -> f64 {
    let (mut alone, mut together) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..=rounds.min(5) {
        let start = Instant::now();
        work();
        alone = alone.min(start.elapsed().as_secs_f64());
        pool.install(|| {
            let start = Instant::now();
            work();
            together = together.min(start.elapsed().as_secs_f64());
        });
    }
    alone / together
}

/// The mean of ratios.
pub(crate) fn geometric_mean(ratios: &[f64]) -> f64 {
    let logarithms: f64 = ratios.iter().map(|&ratio| libm::log(ratio)).sum();
    libm::exp(logarithms / ratios.len() as f64)
}
