//! What a loader has to say: faults that stop it, warnings that do not.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use super::LoadSettings;
use crate::error::{Error, Place, escaped};
use crate::memory;
use crate::scene::Object;

/// The result of a loader's steps, before the path is known.
pub(super) type Checked<T> = Result<T, Fault>;

/// Why a file cannot be read.
#[derive(Debug)]
pub(super) enum Fault {
    /// Its content is wrong.
    Content { place: Place, what: String },
    /// It needs more memory than may be spent on it.
    TooLarge { place: Place, what: String },
    /// Anything else, as it will be reported.
    Other(Error),
}

impl Fault {
    pub(super) fn at(place: Place, what: impl Into<String>) -> Self {
        let what = what.into();
        Self::Content { place, what }
    }

    pub(super) fn line(number: u64, what: impl Into<String>) -> Self {
        Self::at(Place::Line(number), what)
    }

    pub(super) fn file(what: impl Into<String>) -> Self {
        Self::at(Place::File, what)
    }

    pub(super) fn into_error(self, path: &Path) -> Error {
        let path = path.to_owned();
        match self {
            Self::Content { place, what } => Error::Parse {
                path,
                place,
                what: shortened(what),
            },
            Self::TooLarge { place, what } => Error::TooLarge {
                path,
                place,
                what: shortened(what),
            },
            Self::Other(error) => error,
        }
    }
}

impl From<Error> for Fault {
    fn from(error: Error) -> Self {
        Self::Other(error)
    }
}

/// The most characters that are said about one fault.
const LONGEST: usize = 1000;

/// A text that a file's names may have made longer than anyone reads, cut to what is read.
fn shortened(mut text: String) -> String {
    if let Some((end, _)) = text.char_indices().nth(LONGEST) {
        text.truncate(end);
        text.push_str("...");
    }
    text
}

/// What a file describes may take so many times the file's size: the best compressed meshes come to half of it.
const TIMES_SIZE: u64 = 256;

/// Beside that it may take this share of the memory that is allowed, 32 MiB of the default: small files may
/// repeat themselves.
const FREE_SHARE: u64 = 256;

/// Of a texture this share counts as described: a picture of one colour is a file of a thousandth of its texels.
const TEXTURE_SHARE: u64 = 16;

/// The memory that an object takes beside its mesh and its name: itself and its part of the tree.
pub(super) const OBJECT_BYTES: u64 = size_of::<Object>() as u64 + 256;

/// A number of bytes, in the largest unit that keeps it from 1 on.
pub(super) fn size_in_words(bytes: u64) -> String {
    const UNITS: [&str; 4] = ["KiB", "MiB", "GiB", "TiB"];
    let mut words = format!("{bytes} bytes");
    let mut size = bytes as f64;
    for unit in UNITS {
        size /= 1024.0;
        if size >= 1.0 {
            words = format!("{size:.1} {unit}").replace(".0 ", " ");
        }
    }
    words
}

/// The name that a packed file has unpacked: `a.ply` of `a.ply.gz`.
pub(super) fn without_gz(path: &Path) -> PathBuf {
    match path.extension() {
        Some(extension) if extension.eq_ignore_ascii_case("gz") => path.with_extension(""),
        _ => path.to_owned(),
    }
}

/// The warnings about one file: one for each kind, however often it occurs.
#[derive(Debug)]
pub(super) struct Report {
    path: PathBuf,
    settings: LoadSettings,
    in_memory: bool,
    /// The bytes read so far: of the file and of those that it names, as they are on the disk.
    size: u64,
    /// The files whose bytes these are.
    sized: HashSet<PathBuf>,
    /// How much more memory the size allows for what is described.
    room: u64,
    grown: usize,
    kinds: Vec<Kind>,
    dropped: u64,
    first_dropped: String,
    /// Where and why a file seems to end too early.
    cut: Option<Error>,
    /// Warnings of files that this one names, worded.
    absorbed: Vec<String>,
    files: Vec<PathBuf>,
}

#[derive(Debug)]
struct Kind {
    key: &'static str,
    line: String,
    count: u64,
}

impl Report {
    pub(super) fn new(path: &Path, settings: LoadSettings) -> Self {
        Self {
            path: path.to_owned(),
            settings,
            in_memory: false,
            size: 0,
            sized: HashSet::new(),
            room: settings.max_memory / FREE_SHARE,
            grown: 0,
            kinds: Vec::new(),
            dropped: 0,
            first_dropped: String::new(),
            cut: None,
            absorbed: Vec::new(),
            files: Vec::new(),
        }
    }

    /// The report about a file that another one names, from whose memory it spends.
    pub(super) fn of_part(path: &Path, whole: &Self) -> Self {
        Self {
            room: whole.room,
            ..Self::new(path, whole.settings)
        }
    }

    /// The same about content that is in memory, under a mere name: it has no folder, so nothing that
    /// it names is opened.
    pub(super) fn in_memory(mut self) -> Self {
        self.in_memory = true;
        self
    }

    /// What messages call the file.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// The file in whose folder the files are that it names.
    ///
    /// # Errors
    ///
    /// In words, when it has no folder.
    pub(super) fn scene(&self) -> Result<&Path, String> {
        if self.in_memory {
            Err("refused: content that is in memory has no folder".to_owned())
        } else {
            Ok(&self.path)
        }
    }

    /// The settings; of the memory, what is left of it.
    pub(super) fn settings(&self) -> &LoadSettings {
        &self.settings
    }

    /// The most that can be spent on what the file describes.
    pub(super) fn left(&self) -> u64 {
        self.settings.max_memory.min(self.room)
    }

    /// Takes so many bytes from the memory that the file may use; `what` they are for. They count against the file's
    /// size too: a few bytes may describe no more than a few bytes can be meant to.
    pub(super) fn spend(&mut self, bytes: u64, what: &str) -> Checked<()> {
        self.spend_at(Place::File, bytes, what)
    }

    /// The same for what is asked for at a place of the file.
    pub(super) fn spend_at(&mut self, place: Place, bytes: u64, what: &str) -> Checked<()> {
        self.take_room(&place, bytes, bytes, what)?;
        self.take_memory(place, bytes, what)
    }

    /// The same for a texture.
    pub(super) fn spend_on_texture(&mut self, bytes: u64) -> Checked<()> {
        let what = "the texture";
        self.take_room(&Place::File, bytes, bytes / TEXTURE_SHARE, what)?;
        self.take_memory(Place::File, bytes, what)
    }

    /// The same for bytes of the file itself, unpacked or parsed: they count against no size.
    pub(super) fn spend_on_content(&mut self, bytes: u64, what: &str) -> Checked<()> {
        self.take_memory(Place::File, bytes, what)
    }

    /// Takes the memory of bytes that were read from a file, and makes room for what they describe: once, however often the file is read.
    pub(super) fn spend_on_read(&mut self, path: &Path, bytes: usize) -> Checked<()> {
        let bytes = bytes as u64;
        if self.sized.insert(path.to_owned()) {
            self.size = self.size.saturating_add(bytes);
            self.room = self.room.saturating_add(bytes.saturating_mul(TIMES_SIZE));
        }
        self.spend_on_content(bytes, "its content")
    }

    /// Takes `counted` of `bytes` from what the file's size allows.
    fn take_room(&mut self, place: &Place, bytes: u64, counted: u64, what: &str) -> Checked<()> {
        let room = self.room;
        self.room = room.checked_sub(counted).ok_or_else(|| {
            let share = if counted == bytes {
                String::new()
            } else {
                format!(", of which 1/{TEXTURE_SHARE} counts")
            };
            let [bytes, room, size] = [bytes, room, self.size].map(size_in_words);
            let what = format!(
                "{what} would take {bytes} of memory{share}, {room} are left of what a file of {size} may describe: \
                 {TIMES_SIZE} times its size and 1/{FREE_SHARE} of what is allowed (--max-memory raises the limit)"
            );
            Fault::TooLarge {
                place: place.clone(),
                what,
            }
        })?;
        Ok(())
    }

    fn take_memory(&mut self, place: Place, bytes: u64, what: &str) -> Checked<()> {
        let left = self.settings.max_memory;
        self.settings.max_memory = left.checked_sub(bytes).ok_or_else(|| {
            let (bytes, left) = (size_in_words(bytes), size_in_words(left));
            let what = format!(
                "{what} would take {bytes} of memory, {left} are left of what is allowed \
                 (--max-memory raises the limit)"
            );
            Fault::TooLarge { place, what }
        })?;
        Ok(())
    }

    /// Refuses to go on where the system has not so many bytes to give.
    #[expect(clippy::unused_self, reason = "whoever asks spends from here")]
    pub(super) fn check_memory(&self, bytes: usize) -> Checked<()> {
        memory::check("the file's content", bytes).map_err(|error| Fault::TooLarge {
            place: Place::File,
            what: error.to_string(),
        })
    }

    /// What is being made of the file takes so many bytes in all by now: asked from time to time by
    /// loops in which a short file can make much of little.
    pub(super) fn has_grown_to(&mut self, bytes: usize) -> Checked<()> {
        let more = bytes.saturating_sub(self.grown);
        self.grown += more;
        // A vector that grows has room for twice as much, and is there twice meanwhile.
        self.check_memory(bytes.saturating_mul(2))?;
        self.spend(more as u64, "what it describes")
    }

    /// The file's name without its extension: what an object without a name is called.
    pub(super) fn stem(&self) -> String {
        let path = without_gz(&self.path);
        escaped(Path::new(path.file_stem().unwrap_or_default()))
    }

    /// Notes something doubtful. `key` tells the kinds apart; only the first of a kind is worded.
    pub(super) fn warn(&mut self, key: &'static str, place: &Place, what: impl FnOnce() -> String) {
        let path = self.path.clone();
        self.warn_in(&path, key, place, what);
    }

    /// The same about another file, such as a material library.
    pub(super) fn warn_in(
        &mut self,
        path: &Path,
        key: &'static str,
        place: &Place,
        what: impl FnOnce() -> String,
    ) {
        if let Some(kind) = self.kinds.iter_mut().find(|kind| kind.key == key) {
            kind.count += 1;
        } else {
            let line = format!("{}{place}: {}", escaped(path), shortened(what()));
            let count = 1;
            self.kinds.push(Kind { key, line, count });
        }
    }

    /// Reports that the file seems to be truncated, and why: a warning, or an error if reading is strict.
    pub(super) fn cut_short(&mut self, place: Place, why: &str) {
        let path = self.path.clone();
        self.cut_short_in(&path, place, why);
    }

    /// The same about another file.
    pub(super) fn cut_short_in(&mut self, path: &Path, place: Place, why: &str) {
        let what = format!("the file seems to be truncated: {why}");
        self.warn_in(path, "cut", &place, || what.clone());
        let fault = Fault::at(place, what);
        self.cut.get_or_insert_with(|| fault.into_error(path));
    }

    /// The first reason why strict reading fails.
    pub(super) fn strict_error(&mut self) -> Option<Error> {
        if !self.settings.strict {
            return None;
        }
        let dropped = self.dropped().map(Fault::file);
        let dropped = dropped.map(|fault| fault.into_error(&self.path));
        self.cut.take().or(dropped)
    }

    /// Takes over what another file's report came to: what memory it left, what it said, and the files
    /// that were read for it.
    pub(super) fn absorb(&mut self, part: &Self, lines: Vec<String>, files: Vec<PathBuf>) {
        self.settings.max_memory = part.settings.max_memory;
        self.size = self.size.saturating_add(part.size);
        self.room = part.room;
        self.absorbed.extend(lines);
        self.files.extend(files);
    }

    /// Notes a further file that was read, such as a texture.
    pub(super) fn note_file(&mut self, path: PathBuf) {
        self.files.push(path);
    }

    /// The further files that were read.
    pub(super) fn take_files(&mut self) -> Vec<PathBuf> {
        std::mem::take(&mut self.files)
    }

    /// Notes triangles that cannot be used; `first` words which one came first.
    pub(super) fn drop_triangles(&mut self, count: u64, first: impl FnOnce() -> String) {
        if self.dropped == 0 && count > 0 {
            self.first_dropped = first();
        }
        self.dropped += count;
    }

    /// What to say about the triangles that were dropped, if any were.
    pub(super) fn dropped(&self) -> Option<String> {
        (self.dropped > 0).then(|| {
            let (count, first) = (self.dropped, &self.first_dropped);
            let have = if count == 1 {
                "triangle has"
            } else {
                "triangles have"
            };
            format!(
                "{count} {have} a corner that is not finite or not below 1e30; \
                 the first is {first}"
            )
        })
    }

    /// The warnings, ready to print.
    pub(super) fn take_lines(&mut self) -> Vec<String> {
        let dropped = self
            .dropped()
            .map(|what| format!("{}: dropped: {what}", escaped(&self.path)));
        let worded = std::mem::take(&mut self.kinds);
        let worded = worded.into_iter().map(|kind| match kind.count {
            1 => kind.line,
            count => format!("{} (and {} more like it)", kind.line, count - 1),
        });
        let absorbed = std::mem::take(&mut self.absorbed);
        worded.chain(dropped).chain(absorbed).collect()
    }
}
