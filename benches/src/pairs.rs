//! Our times alone, one at a time and when asked: `benches/pairs.py` has two builds run in turns
//! this way, frame by frame, and so sees differences far smaller than what a shared machine does to
//! the times themselves.

use std::hint::black_box;
use std::io::{self, BufRead, StdinLock, Write};

use firsthit::Hits;
use firsthit::shoot::AllHits;

use crate::firsthit_side;
use crate::measure;
use crate::rows::{Shot, Shots};
use crate::scenes;
use crate::settings::Settings;

/// Prints a line for each thing that can be timed, then does the one that each line of standard
/// input names and prints the nanoseconds it took for each ray or triangle, until a line says
/// `next`.
pub(crate) fn serve(settings: &Settings) -> Result<(), String> {
    let mut client = Client(io::stdin().lock());
    let failed = |error: io::Error| format!("--pairs: {error}");
    for name in settings.scenes()? {
        let scene = scenes::find(&name, &settings.folder)?;
        let built = firsthit_side::build(&scene.objects)?;
        let mut build = || drop(black_box(firsthit_side::build(&scene.objects)));
        client.time(&name, "build", scene.model.triangles(), &mut build).map_err(failed)?;
        let shots = Shots::new(&built, &scene.look, settings.side)?;
        let (mut hits, mut all) = (Hits::default(), AllHits::default());
        for row in settings.rows() {
            let shot = shots.of(*row)?;
            let mut shoot = || match &shot {
                Shot::Pixels(camera) | Shot::Curved(camera) => {
                    firsthit_side::first_hits(&built, camera, &mut hits);
                }
                Shot::First(rays) => firsthit_side::first_hits(&built, &**rays, &mut hits),
                Shot::Any(rays) => drop(black_box(firsthit_side::any_hits(&built, rays))),
                Shot::All(rays) => firsthit_side::all_hits(&built, rays, &mut all),
                Shot::Picture(picture) => drop(black_box(picture.render())),
            };
            client.time(&name, &row.name(), shot.count(), &mut shoot).map_err(failed)?;
        }
    }
    Ok(())
}

/// The client that asks for measurements.
struct Client(StdinLock<'static>);

impl Client {
    /// Times `work`, which does `things` things, as often as it is asked to.
    fn time(
        &mut self,
        scene: &str,
        row: &str,
        things: usize,
        work: &mut dyn FnMut(),
    ) -> io::Result<()> {
        let mut out = io::stdout().lock();
        writeln!(out, "{scene} {row}")?;
        out.flush()?;
        let mut line = String::new();
        loop {
            line.clear();
            if self.0.read_line(&mut line)? == 0 {
                return Err(io::ErrorKind::UnexpectedEof.into());
            }
            if line.trim() == "next" {
                return Ok(());
            }
            // Once uncounted: meanwhile the other build had the caches.
            work();
            writeln!(out, "{}", measure::once(things, work))?;
            out.flush()?;
        }
    }
}
