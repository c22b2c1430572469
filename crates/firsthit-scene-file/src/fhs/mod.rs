//! `.fhs`: built scenes in files, with their trees, which are mapped into memory and used as they
//! are.
//!
//! A file is a header, a table of sections, and the sections. One section is a record in JSON,
//! which describes objects, materials, cameras and lights; all others are arrays as they are in
//! memory, and the record names them by number. `docs/fhs.md` is the whole format. `layout.rs` has
//! the header and the table, `record.rs` the record, `write.rs` takes a scene apart, and `read.rs`
//! puts it together.
//!
//! A file is untrusted. The header, the table and the record are compared with their checksum; all
//! that is indexed by a number of the file is checked when the file is opened. Of the sections'
//! content nothing else is, unless it is asked for.

// A reader that panics is a reader that a file can crash.
#![deny(clippy::expect_used, clippy::indexing_slicing, clippy::panic, clippy::unreachable)]

mod colors;
mod layout;
mod look;
mod number;
mod read;
mod record;
mod sensor;
mod tables;
mod write;

use std::path::Path;
use std::sync::Arc;

use crate::error::Result;
use crate::geometry::DVec3;
use crate::io::fault::Checked;
use crate::io::read::mapped_file;
#[cfg(feature = "scene-file")]
use crate::io::read::{is_named_as_packed, regular_file};
use crate::io::{Format, LoadSettings, Report};
use crate::memory::Block;
use crate::watch::Watch;
use crate::world::{Loaded, World, WorldFormat};

pub use write::{encode, save};

/// The row of the list of formats.
pub(crate) static FORMAT: WorldFormat = WorldFormat {
    format: Format { name: "built scene", extensions: &["fhs"], up: DVec3::Z, rules_up: true },
    read: read_copy,
};

/// Opens a file that [`save`] wrote, whatever its name. On Linux it is mapped, so that processes
/// that open it share its memory; elsewhere it is read. It takes milliseconds, since nothing is
/// built. Indices are checked, and with `verify` also whether every byte is as it was written.
///
/// The file must not be changed while the scene lives; [`save`] replaces a file and changes none. A
/// process that reads what was cut off a mapped file is ended by the system.
///
/// ```
/// use firsthit::world::World;
/// use firsthit::{DVec3, Object, Scene, Sphere, fhs, shoot};
///
/// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?).named("ball")])?;
/// let folder = std::env::temp_dir();
/// let path = folder.join(format!("firsthit-{}.fhs", std::process::id()));
/// fhs::save(&path, &scene, &World::default(), &())?;
///
/// let opened = fhs::open(&path, true)?.into_scene()?;
/// assert_eq!(opened.objects(), scene.objects());
/// assert_eq!(shoot(&opened, 5.0 * DVec3::Z, DVec3::NEG_Z).t, 4.0);
/// # std::fs::remove_file(path).expect("the file is there");
/// # Ok::<(), firsthit::Error>(())
/// ```
///
/// # Errors
///
/// [`Error::Read`](crate::error::Error::Read) when the system refuses, or `path` is no regular
/// file; [`Error::Parse`](crate::error::Error::Parse) for a file of another kind or version, for
/// one that is not whole, and for one whose content does not fit together;
/// [`Error::TooLarge`](crate::error::Error::TooLarge) where memory is short.
pub fn open(path: &Path, verify: bool) -> Result<Loaded> {
    open_watched(path, verify, &())
}

/// As [`open`]; `watch` follows it, and may end it.
///
/// # Errors
///
/// The errors of [`open`], and [`Error::Interrupted`](crate::error::Error::Interrupted).
pub fn open_watched(path: &Path, verify: bool, watch: &dyn Watch) -> Result<Loaded> {
    let settings = LoadSettings { verify, ..LoadSettings::default() };
    let block = Arc::new(mapped_file(path)?);
    open_mapped(block, &mut Report::new(path, settings, watch))
}

/// Opens a file that is mapped already.
pub(crate) fn open_mapped(block: Arc<Block>, report: &mut Report) -> Result<Loaded> {
    let world = read_mapped(block, report)?;
    Loaded::new(world, &FORMAT.format, report)
}

fn read_mapped(block: Arc<Block>, report: &mut Report) -> Result<World> {
    let path = report.source.path().to_owned();
    read::world(block, report).map_err(|fault| fault.into_error(&path))
}

/// Opens the file at `path`, which the file of `whole` names. The first such scene is the one that
/// `whole` has built.
///
/// # Errors
///
/// The errors of [`open`].
#[cfg(feature = "scene-file")]
pub(crate) fn open_part(path: &Path, whole: &mut Report) -> Result<World> {
    let mut report = whole.part(path);
    let world = if is_named_as_packed(path) {
        let bytes = regular_file(path, report.budget.left(), report.watch)?;
        FORMAT.load(bytes.into(), &mut report)?
    } else {
        let block = mapped_file(path)?;
        report.budget.make_room(path, block.bytes().len());
        read_mapped(block.into(), &mut report)?
    };
    if let Some(error) = report.strict_error() {
        return Err(error);
    }
    whole.absorb(report);
    Ok(world)
}

/// Reads content in memory, which may be anywhere: sections are aligned in a copy.
fn read_copy(bytes: &[u8], report: &mut Report) -> Checked<World> {
    report.budget.charge_content(bytes.len() as u64, "a copy of its content")?;
    let copy = Block::read(bytes, bytes.len());
    let no_room = |_| crate::memory::no_room_for("a copy of the file's content");
    let copy = Arc::new(copy.map_err(no_room)?);
    report.advance_until(0)?;
    read::world(copy, report)
}
