//! The destinations of a list's results: files, and standard output.

use std::path::{Path, PathBuf};

use firsthit::channel::ChannelKind;
use firsthit::image::{Frame, WriteSettings};
use serde_json::{Value, json};

use crate::args::StreamFormat;
use crate::console::report_beside_data;
use crate::failure::Failure;
use crate::hits_csv::stream_csv;
use crate::output::{self, Target};
use crate::progress::Progress;

/// Says where reports go. Before anything fails: failures are reported too.
pub(super) fn announce(outputs: &[PathBuf]) {
    if outputs.is_empty() || outputs.iter().any(|path| path == Path::new("-")) {
        report_beside_data();
    }
}

/// The destinations of a result.
pub(super) struct Sinks {
    files: Vec<Target>,
    clouds: Vec<Target>,
    stdout: Option<StreamFormat>,
}

impl Sinks {
    /// The destinations that were asked for. None of `inputs`, which will be read, may be among
    /// them.
    pub(super) fn new(
        (outputs, format): (&[PathBuf], Option<StreamFormat>),
        inputs: &[&Path],
        kinds: &[&'static ChannelKind],
    ) -> Result<Self, Failure> {
        let stdout = |path: &&PathBuf| path.as_path() == Path::new("-");
        let streams = match outputs.iter().filter(stdout).count() {
            0 => outputs.is_empty(),
            1 => true,
            _ => return Err(Failure::usage("- is named twice as an output")),
        };
        let files: Vec<PathBuf> = (outputs.iter().filter(|path| !stdout(path))).cloned().collect();
        for path in inputs {
            firsthit::inputs::note(path);
        }
        let files = output::targets(&files, kinds, output::ChannelSource::Rays)?;
        if !streams {
            if format.is_some() {
                return Err(Failure::usage(
                    "--format is for standard output (-o -); a file's format is that of its extension",
                ));
            }
            output::check_all_go_somewhere(&files, kinds)?;
        }
        let format = format.unwrap_or(StreamFormat::Csv);
        if format == StreamFormat::Npy && kinds.len() != 1 {
            return Err(Failure::usage(
                "--format npy holds one channel, not several; npz holds all",
            ));
        }
        let stdout = streams.then_some(format);
        Ok(Self { files, clouds: Vec::new(), stdout })
    }

    /// Adds files beside, `more`, which replace a standard output that was not asked for.
    pub(super) fn beside(mut self, more: Vec<Target>, is_asked: bool) -> Result<Self, Failure> {
        if !more.is_empty() && !is_asked {
            self.stdout = None;
        }
        self.clouds = more;
        self.check()?;
        Ok(self)
    }

    /// Fails for a file that was read by now.
    pub(super) fn check(&self) -> Result<(), Failure> {
        output::check_paths(self.files.iter().chain(&self.clouds))
    }

    /// Writes the files beside.
    pub(super) fn write_clouds(&self, cloud: &Frame, progress: &Progress) -> Result<(), Failure> {
        output::write(cloud, &self.clouds, WriteSettings::default(), progress)?;
        Ok(())
    }

    /// Writes all of it. Files first: a reader of standard output who has had enough ends the
    /// program.
    pub(super) fn write(&self, frame: &Frame, progress: &Progress) -> Result<(), Failure> {
        output::write(frame, &self.files, WriteSettings::default(), progress)?;
        match self.stdout {
            Some(format) => stream(frame, format),
            None => Ok(()),
        }
    }

    /// The JSON about the destinations.
    pub(super) fn as_json(&self, kinds: &[&ChannelKind]) -> Vec<Value> {
        let names: Vec<&str> = kinds.iter().map(|kind| &*kind.name).collect();
        let stdout = self.stdout.map(|_| json!({"file": "-", "channels": names}));
        let files = output::as_json(&self.files, kinds, &[]);
        let clouds = self.clouds.iter();
        let clouds = clouds.map(|target| json!({"file": target.path.to_string_lossy()}));
        stdout.into_iter().chain(files).chain(clouds).collect()
    }

    /// Whether lines of rays can be answered one by one.
    pub(super) fn is_csv_stream(&self) -> bool {
        self.stdout == Some(StreamFormat::Csv) && self.files.is_empty()
    }

    pub(super) fn names(&self) -> String {
        let files = output::names(self.files.iter().chain(&self.clouds));
        match (self.stdout, &files[..]) {
            (Some(_), "") => "standard output".into(),
            (Some(_), _) => format!("standard output, {files}"),
            (None, _) => files,
        }
    }
}

fn stream(frame: &Frame, format: StreamFormat) -> Result<(), Failure> {
    match format {
        StreamFormat::Npy => output::stream(frame, "npy"),
        StreamFormat::Npz => output::stream(frame, "npz"),
        StreamFormat::Csv => stream_csv(frame),
    }
}
