//! A folder to run the program in, and eyes for what it writes.

use std::collections::HashMap;
use std::io::{Cursor, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::Once;
use std::{env, fs};

use tempfile::TempDir;

/// A square at z = 0 that faces up, from -1 to 1: one polygon, so two triangles.
pub(crate) const SQUARE: &str = "ply\nformat ascii 1.0\nelement vertex 4\n\
    property float x\nproperty float y\nproperty float z\nelement face 1\n\
    property list uchar int vertex_indices\nend_header\n\
    -1 -1 0\n1 -1 0\n1 1 0\n-1 1 0\n4 0 1 2 3\n";

/// A camera five above the [`SQUARE`]'s middle, its viewplane at z = 3, a pixel's centre in the
/// middle.
pub(crate) const ABOVE: &str = "--position 0,0,5 --aim 0,0,-3 --up 0,2,0 --focal-length 2 \
    --viewplane 4x3 --size 33x25";

/// A shell lets what it starts in the background ignore Ctrl-C, and so would all that tests start.
/// A handler is not handed on.
static HEEDS_CTRL_C: Once = Once::new();

/// The program, started by the words of `runner`, such as an emulator and its options.
fn started_by(runner: Option<&str>) -> Command {
    let program = env!("CARGO_BIN_EXE_firsthit");
    let mut words = runner.unwrap_or_default().split_whitespace();
    let Some(first) = words.next() else {
        return Command::new(program);
    };
    let mut command = Command::new(first);
    command.args(words).arg(program);
    command
}

/// A folder of its own for every test.
pub(crate) struct Lab {
    folder: TempDir,
}

/// The exit code and the output of the program.
pub(crate) struct Outcome {
    pub(crate) code: i32,
    pub(crate) stdout: Vec<u8>,
    pub(crate) stderr: String,
}

impl Lab {
    pub(crate) fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        Self { folder }
    }

    /// A folder with the square in it, as `square.ply`.
    pub(crate) fn with_square() -> Self {
        let lab = Self::new();
        lab.write("square.ply", SQUARE);
        lab
    }

    /// A folder with a file of `testdata` in it, called `name`.
    pub(crate) fn with(testdata: &str, name: &str) -> Self {
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata");
        let lab = Self::new();
        fs::copy(source.join(testdata), lab.path(name)).unwrap();
        lab
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.path(name), content).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// The names of all files, sorted.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// The program in this folder, its arguments separated by spaces.
    pub(crate) fn command(&self, arguments: &str) -> Command {
        HEEDS_CTRL_C.call_once(|| ctrlc::set_handler(|| std::process::exit(130)).unwrap());
        let mut command = started_by(env::var("FIRSTHIT_RUNNER").ok().as_deref());
        command
            .args(arguments.split_whitespace())
            .current_dir(self.folder.path())
            .env_remove("COLUMNS")
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        command
    }

    pub(crate) fn run(&self, arguments: &str) -> Outcome {
        Outcome::of(self.command(arguments).output().unwrap())
    }

    /// Runs it with something on standard input.
    pub(crate) fn pipe(&self, arguments: &str, input: &[u8]) -> Outcome {
        let mut child = self.command(arguments).stdin(Stdio::piped()).spawn().unwrap();
        // A program that refuses what comes need not read the rest.
        if let Err(error) = child.stdin.take().unwrap().write_all(input) {
            assert_eq!(error.kind(), std::io::ErrorKind::BrokenPipe);
        }
        Outcome::of(child.wait_with_output().unwrap())
    }

    pub(crate) fn start(&self, arguments: &str) -> Child {
        self.command(arguments).spawn().unwrap()
    }

    /// Runs what must succeed.
    pub(crate) fn ok(&self, arguments: &str) -> Outcome {
        let outcome = self.run(arguments);
        assert_eq!(outcome.code, 0, "{arguments}: {}", outcome.stderr);
        outcome
    }

    /// Runs what must fail with `code`, saying one line with `words` in it and leaving no new file.
    pub(crate) fn fails(&self, arguments: &str, code: i32, words: &str) {
        let before = self.names();
        let outcome = self.run(arguments);
        let Outcome { stdout, stderr, .. } = &outcome;
        assert_eq!(outcome.code, code, "{arguments}: {stderr}");
        assert!(stdout.is_empty(), "{arguments}");
        let line = stderr.strip_prefix("firsthit: error: ");
        let line = line.unwrap_or_else(|| panic!("{arguments}: {stderr}"));
        assert_eq!(line.trim_end().lines().count(), 1, "{arguments}: {stderr}");
        assert!(line.contains(words), "{arguments}: {stderr}");
        assert_eq!(self.names(), before, "{arguments}");
    }

    pub(crate) fn npz(&self, name: &str) -> Arrays {
        arrays(self.read(name))
    }

    /// A PNG's width, height and RGB bytes.
    pub(crate) fn png(&self, name: &str) -> (u32, u32, Vec<u8>) {
        let decoder = png::Decoder::new(Cursor::new(self.read(name)));
        let mut reader = decoder.read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        assert_eq!(info.color_type, png::ColorType::Rgb);
        (info.width, info.height, bytes)
    }
}

impl Outcome {
    pub(crate) fn of(output: Output) -> Self {
        Self {
            code: output.status.code().unwrap_or(-1),
            stdout: output.stdout,
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// Standard output as text.
    pub(crate) fn text(&self) -> &str {
        std::str::from_utf8(&self.stdout).unwrap()
    }
}

/// An array of any type, its values as float64.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Array {
    pub(crate) dtype: String,
    pub(crate) shape: Vec<u64>,
    pub(crate) values: Vec<f64>,
}

pub(crate) type Arrays = HashMap<String, Array>;

/// An NPY file, read after its specification; the program's own reader is another.
pub(crate) fn array(bytes: &[u8]) -> Array {
    let (start, data) = bytes.split_at(10);
    assert_eq!(start[..8], *b"\x93NUMPY\x01\x00");
    let (header, data) = data.split_at(u16::from_le_bytes([start[8], start[9]]).into());
    assert_eq!((10 + header.len()) % 64, 0);
    let header = std::str::from_utf8(header).unwrap();
    let between = |before: &str, after: &str| {
        let (_, rest) = header.split_once(before).unwrap();
        rest.split_once(after).unwrap().0.to_owned()
    };
    assert!(header.contains("'fortran_order': False, "), "{header}");
    let dtype = between("'descr': '", "'");
    let shape = between("'shape': (", ")");
    let sides = shape.split(',').map(str::trim).filter(|side| !side.is_empty());
    let values = match dtype.as_str() {
        "<f8" => numbers(data, f64::from_le_bytes),
        "<f4" => numbers(data, |bytes| f32::from_le_bytes(bytes).into()),
        "<i4" => numbers(data, |bytes| i32::from_le_bytes(bytes).into()),
        "|b1" => numbers(data, |[byte]| {
            assert!(byte < 2);
            byte.into()
        }),
        other => panic!("{other}"),
    };
    let shape: Vec<u64> = sides.map(|side| side.parse().unwrap()).collect();
    assert_eq!(shape.iter().product::<u64>(), values.len() as u64);
    Array { dtype, shape, values }
}

fn numbers<const B: usize>(data: &[u8], number: impl Fn([u8; B]) -> f64) -> Vec<f64> {
    let (elements, rest) = data.as_chunks::<B>();
    assert!(rest.is_empty());
    elements.iter().copied().map(number).collect()
}

pub(crate) fn arrays(npz: Vec<u8>) -> Arrays {
    let mut archive = zip::ZipArchive::new(Cursor::new(npz)).unwrap();
    (0..archive.len())
        .filter_map(|k| {
            let mut entry = archive.by_index(k).unwrap();
            let name = entry.name().unwrap().into_owned();
            let name = name.trim_end_matches(".npy").to_owned();
            let mut bytes = Vec::new();
            entry.read_to_end(&mut bytes).unwrap();
            // A text, not numbers.
            (name != "metadata").then(|| (name, array(&bytes)))
        })
        .collect()
}

/// An NPY file as any program might have written it.
pub(crate) fn npy(descr: &str, fortran: bool, shape: &str, data: &[u8]) -> Vec<u8> {
    let order = if fortran { "True" } else { "False" };
    let mut header =
        format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}");
    while (10 + header.len() + 1) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend(u16::try_from(header.len()).unwrap().to_le_bytes());
    bytes.extend(header.bytes());
    bytes.extend(data);
    bytes
}

/// Rays, each an origin and a direction, as an array of float64.
pub(crate) fn rays_npy(rays: &[[f64; 6]]) -> Vec<u8> {
    let data: Vec<u8> = rays.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    npy("<f8", false, &format!("({}, 6)", rays.len()), &data)
}
