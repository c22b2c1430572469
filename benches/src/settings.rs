//! The command line.

use std::path::PathBuf;

use clap::Parser;
use firsthit::InstructionSet;

use crate::row::Row;
use crate::scenes;

/// firsthit beside Embree: the same scenes, the same rays, one run.
#[derive(Debug, Parser)]
#[command(name = "firsthit-bench", max_term_width = 100)]
pub(crate) struct Settings {
    /// Embree 4's shared library [default: firsthit is measured alone]
    #[arg(long, value_name = "FILE")]
    pub(crate) embree: Option<PathBuf>,
    /// tinybvh, as benches/tinybvh.cpp is compiled [default: it is left out]
    #[arg(long, value_name = "FILE")]
    pub(crate) tinybvh: Option<PathBuf>,
    /// The folder with the scenes: NAME.ply, .glb or .toml beside NAME.cam
    #[arg(long, value_name = "FOLDER", default_value = "target/scenes")]
    pub(crate) folder: PathBuf,
    /// The scenes, by name [default: all of the folder; the built-in ones where it is empty]
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    pub(crate) scenes: Vec<String>,
    /// The rows [default: all]
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    pub(crate) rows: Vec<Row>,
    /// How often each time is taken, in turns; the smallest counts
    #[arg(long, default_value_t = 9, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) rounds: u32,
    /// Pixels across and down, a multiple of 16
    #[arg(long, default_value_t = 1024, value_parser = side)]
    pub(crate) side: usize,
    /// Both sides with the instructions of this set: portable, neon, avx2 or avx512 [default: the
    /// fastest of this machine]
    #[arg(long, value_name = "NAME", value_parser = set)]
    pub(crate) isa: Option<InstructionSet>,
    /// How many triangles the judge may test for a row's sample of hits
    #[arg(long, value_name = "NUMBER", default_value_t = 300_000_000)]
    pub(crate) judge: u64,
    /// Print no table: time a row once for each line of standard input, as benches/pairs.py wants
    /// it
    #[arg(long)]
    pub(crate) pairs: bool,
    /// Write the table to this file, too
    #[arg(long, value_name = "FILE")]
    pub(crate) record: Option<PathBuf>,
}

fn side(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(side) if side > 0 && side % 16 == 0 && side <= 16384 => Ok(side),
        _ => Err(format!("must be a multiple of 16 up to 16384, got {text}")),
    }
}

fn set(name: &str) -> Result<InstructionSet, String> {
    name.parse().map_err(|error: firsthit::Error| error.to_string())
}

impl Settings {
    /// The instruction set that firsthit uses.
    pub(crate) fn instruction_set(&self) -> Result<InstructionSet, String> {
        let current = || InstructionSet::current().map_err(|error| error.to_string());
        self.isa.map_or_else(current, Ok)
    }

    /// The setting that restricts Embree to that instruction set.
    pub(crate) fn embree_isa(&self) -> Option<&'static str> {
        self.isa.map(|set| match set {
            InstructionSet::Portable => "sse2",
            set => set.name(),
        })
    }

    /// The names of the scenes to measure.
    pub(crate) fn scenes(&self) -> Result<Vec<String>, String> {
        if self.scenes.is_empty() { scenes::all(&self.folder) } else { Ok(self.scenes.clone()) }
    }

    /// The command that measures the same again.
    pub(crate) fn command(&self) -> String {
        let mut words = vec![format!("make bench ROUNDS={}", self.rounds)];
        if !self.scenes.is_empty() {
            words.push(format!("SCENES={}", self.scenes.join(",")));
        }
        if !self.rows.is_empty() {
            let rows: Vec<String> = self.rows.iter().map(|row| row.name()).collect();
            words.push(format!("ROWS={}", rows.join(",")));
        }
        if let Some(set) = self.isa {
            words.push(format!("ISA={}", set.name()));
        }
        if self.tinybvh.is_some() {
            words.push("TINYBVH=tiny_bvh.h".into());
        }
        words.push(format!("JUDGE={}", self.judge));
        words.join(" ")
    }

    /// The rows to measure.
    pub(crate) fn rows(&self) -> &[Row] {
        if self.rows.is_empty() { Row::ALL } else { &self.rows }
    }
}
