//! `--resume`: pictures that are gone on with, from a state that a file keeps.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use firsthit::Error;
use firsthit::channel::Kind;
use firsthit::error::escaped;
use firsthit::image::{Frame, Origin};
use firsthit::render::Picture;
use firsthit::watch::Watch;

use super::job::needs_shade;
use crate::failure::Failure;
use crate::output::{self, Order};
use crate::progress::{Keeping, Progress};

/// How often the state of a picture is kept.
const KEPT_EVERY: Duration = Duration::from_secs(20);

/// Refuses a file that cannot hold a state.
pub(super) fn check_name(path: &Path) -> Result<(), Failure> {
    let extension = path.extension().unwrap_or_default();
    if extension.eq_ignore_ascii_case("npz") {
        return Ok(());
    }
    let name = escaped(path);
    Err(Failure::usage(format!("--resume: {name} must end in .npz")))
}

/// Refuses a picture without anything to go on with, and a state over another file of the run.
pub(super) fn check(path: &Path, orders: &[Order], inputs: &[PathBuf]) -> Result<(), Failure> {
    if !orders.iter().any(needs_shade) {
        return Err(Failure::usage(
            "--resume is of colours: it needs color, alpha or samples among the --channels",
        ));
    }
    output::check_other(path, orders, inputs)
}

/// Makes a picture from where a file says it was left, if it is there, and keeps its state in that file.
pub(super) fn resumed(
    picture: &Picture<'_>,
    path: &Path,
    progress: &Progress<'_>,
) -> Result<Frame, Failure> {
    let (shaded, plain): (Vec<&Kind>, Vec<&Kind>) =
        picture.channels.iter().partition(|kind| kind.needs_shade());
    let shaded = Picture {
        channels: &shaded,
        ..picture.clone()
    };
    let mut going_on = if path.exists() {
        shaded.resume_from(path)?
    } else {
        shaded.start()?
    };
    let (known, wanted) = (going_on.samples(), picture.samples);
    if known > wanted {
        let name = escaped(path);
        return Err(Failure::usage(format!(
            "--resume {name}: the state has {known} samples already, and --samples is {wanted}"
        )));
    }
    let keeping = Keeping::begin();
    let mut kept = Instant::now();
    while going_on.samples() < wanted && going_on.add_sample(&Counted(progress))? {
        let is_interrupted = progress.is_stopped();
        // What is done is not lost, whatever happens.
        if is_interrupted || kept.elapsed() > KEPT_EVERY {
            going_on.state()?.save(path)?;
            kept = Instant::now();
        }
        if is_interrupted {
            return Err(Error::Interrupted.into());
        }
    }
    going_on.state()?.save(path)?;
    drop(keeping);
    // As many as there are of the colours: a noise may have ended them.
    let plain = Picture {
        channels: &plain,
        samples: going_on.samples(),
        noise: None,
        ..picture.clone()
    };
    let (colors, others) = (going_on.frame()?, plain.render(progress)?);
    put_together(picture.channels, colors, others)
}

/// Counts, and is not stopped: half a sample could not be gone on with.
struct Counted<'a>(&'a Progress<'a>);

impl Watch for Counted<'_> {
    fn advance(&self, rays: u64) {
        self.0.advance(rays);
    }
}

/// One frame of the colours and of all else, in the order that was asked for.
fn put_together(channels: &[&Kind], colors: Frame, others: Frame) -> Result<Frame, Failure> {
    let origin = colors.origin().clone();
    let mut whole = Frame::new(colors.shape().to_vec()).from_origin(Origin {
        names: others.origin().names.clone(),
        cryptomatte: others.origin().cryptomatte.clone(),
        ..origin
    });
    let mut made = [colors.into_channels(), others.into_channels()].concat();
    let place = |name: &str| channels.iter().position(|kind| kind.name == name);
    made.sort_by_key(|channel| place(&channel.name));
    for channel in made {
        whole.push(channel)?;
    }
    Ok(whole)
}
