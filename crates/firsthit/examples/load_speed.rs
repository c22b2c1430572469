//! How fast files load: `cargo run --release --example load_speed FILE...`, on the thread's own CPU
//! time where the system tells it (Linux), so that a busy machine does not matter.

use std::path::Path;
use std::time::{Duration, Instant};

use firsthit::load::{LoadSettings, load};

/// The best of so many runs counts: the file is in memory from the first on.
const RUNS: u32 = 5;

/// The time that this thread has computed.
fn cpu_time() -> Option<Duration> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split(' ').next()?.parse().ok().map(Duration::from_nanos)
}

fn main() -> firsthit::Result<()> {
    for name in std::env::args().skip(1) {
        let path = Path::new(&name);
        let (mut cpu, mut wall) = (Duration::MAX, Duration::MAX);
        for _ in 0..RUNS {
            let (started, start) = (Instant::now(), cpu_time());
            let model = load(path, &LoadSettings::default())?;
            wall = wall.min(started.elapsed());
            cpu = cpu.min(cpu_time().unwrap_or_default().saturating_sub(start.unwrap_or_default()));
            drop(model);
        }
        let size = std::fs::metadata(path).map_or(0, |metadata| metadata.len());
        let speed = |time: Duration| size as f64 / 1e6 / time.as_secs_f64();
        println!(
            "{name}: {:.1} MB, {:.0} MB/s of CPU time, {:.0} MB/s",
            size as f64 / 1e6,
            speed(cpu),
            speed(wall)
        );
    }
    Ok(())
}
