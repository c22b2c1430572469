//! The table: a line as soon as it is measured, the means at the end, and the record.

use std::fmt::Write as _;
use std::fs;
use std::process::Command;

use firsthit::InstructionSet;

use crate::embree::Device;
use crate::measure::{Timing, geometric_mean};
use crate::row::{DOORS, Measured, Row};
use crate::scenes::BenchScene;
use crate::settings::Settings;
use crate::tinybvh::Beside;
use crate::tree::{EmbreeTrees, Trees};
use crate::visits::{Visits, fit};

/// The denominators of the ratios.
#[derive(Debug, Clone, Copy)]
struct Ratios {
    best: f64,
    single: f64,
    robust: f64,
}

impl Ratios {
    /// Embree's times divided by firsthit's; none without Embree.
    fn of(measured: &Measured) -> Option<Self> {
        let times: Vec<f64> = measured.embree.iter().map(|timing| timing.min).collect();
        let least = |times: &[f64]| times.iter().copied().fold(f64::INFINITY, f64::min);
        let ours = measured.firsthit.min;
        (times.len() == DOORS.len()).then(|| Self {
            best: least(&times) / ours,
            single: times[0] / ours,
            // The second half of the doors is the robust one.
            robust: least(&times[3..]) / ours,
        })
    }
}

/// Prints and remembers.
#[derive(Debug)]
pub(crate) struct Report<'a> {
    settings: &'a Settings,
    text: String,
    rows: Vec<Measured>,
    /// Scene and row, visits and time.
    counted: Vec<(String, (Visits, f64))>,
}

const HEAD: &str = "\
scene      row           rays firsthit (median) |     1    16 16coh | 1 rob 16rob 16cohr | x best    x1  xrob | 2 thr | wrong/judged  hit/miss  other id   max dt";

impl<'a> Report<'a> {
    pub(crate) fn new(settings: &'a Settings, device: Option<&Device<'_>>) -> Self {
        let mut report =
            Self { settings, text: String::new(), rows: Vec::new(), counted: Vec::new() };
        report.line(&machine());
        let set = settings.instruction_set();
        report.line(&format!(
            "firsthit {}{}, {}; rounds: {}; pixels: {side} x {side}",
            env!("CARGO_PKG_VERSION"),
            commit().map_or_else(String::new, |commit| format!(" at {commit}")),
            set.map_or("no such instruction set", InstructionSet::name),
            settings.rounds,
            side = settings.side,
        ));
        report.line(&match device {
            Some(device) => format!(
                "Embree {}{}, packets of {}, one thread, medium quality",
                device.version(),
                settings.embree_isa().map_or_else(String::new, |isa| format!(", isa={isa}")),
                device.width()
            ),
            None => "Embree is not there (--embree): firsthit alone".into(),
        });
        report.line("ns for each ray, thread time, the smallest of all rounds; x: Embree's time divided by firsthit's");
        report
    }

    /// A scene begins: its trees.
    pub(crate) fn tree(&mut self, scene: &BenchScene, trees: &Trees<'_>) {
        let triangles = scene.model.triangles();
        let mut line = format!(
            "\n{}: {triangles} triangles; build ns/triangle: firsthit {:.0} (refit {:.0})",
            scene.name, trees.firsthit_build.min, trees.firsthit_refit.min
        );
        if let Some(embree) = &trees.embree {
            let speed = embree.build.min / trees.firsthit_build.min;
            let _ = write!(line, ", Embree {:.0} (x {speed:.2})", embree.build.min);
        }
        let _ = write!(
            line,
            "; 2 threads x {:.2}; bytes/triangle: firsthit {:.1}",
            trees.speedup, trees.firsthit_bytes
        );
        if let Some(embree) = &trees.embree {
            let _ = write!(line, ", Embree {:.1}", embree.bytes);
        }
        self.line(&line);
        let objects = scene.objects.len();
        if objects > 1 {
            self.line(&of_objects(objects, triangles as f64, trees));
        }
        self.line(HEAD);
    }

    /// A row is measured.
    pub(crate) fn row(&mut self, scene: &str, measured: Measured) {
        let Timing { min, median } = measured.firsthit;
        let mut line = format!(
            "{scene:10} {:12} {:>5}k {min:8.2} {:8} |",
            measured.row.name(),
            measured.rays / 1000,
            format!("({median:.2})")
        );
        for door in 0..DOORS.len() {
            let time = measured.embree.get(door).map(|timing| timing.min);
            line += &number(time, 5, 1);
            line += if door % 3 == 2 { " |" } else { "" };
        }
        line += &ratios(Ratios::of(&measured));
        let checked = &measured.checked;
        let judged = format!("{}/{}", checked.wrong, checked.judged);
        let _ = write!(
            line,
            " {:5.2} | {judged:>12} {:9} {:9} {:8.1e}",
            measured.speedup,
            checked.other_outcome,
            checked.other_triangle,
            checked.largest_difference
        );
        if let Some(tinybvh) = measured.tinybvh {
            let Beside { nanoseconds, ratio, other } = tinybvh;
            let _ = write!(line, "  tinybvh {nanoseconds:.1} (x {ratio:.2}, {other} other)");
        }
        if let Some(visits) = measured.visits {
            let name = format!("{scene} {}", measured.row.name());
            self.counted.push((name, (visits, min)));
            let Visits { nodes, leaves, hits, .. } = visits;
            let _ = write!(line, "  {nodes:.2} nodes, {leaves:.2} leaves, {hits:.2} hits a ray");
        }
        self.line(&line);
        self.rows.push(measured);
    }

    /// The means over the scenes, and the record; whether all answers were the judge's.
    pub(crate) fn finish(mut self) -> Result<bool, String> {
        self.line("\ngeometric means over the scenes | x best    x1  xrob | 2 thr");
        for &row in Row::ALL {
            let rows: Vec<&Measured> = self.rows.iter().filter(|m| m.row == row).collect();
            if rows.is_empty() {
                continue;
            }
            let mean = |number: &dyn Fn(&Measured) -> f64| {
                geometric_mean(&rows.iter().map(|m| number(m)).collect::<Vec<_>>())
            };
            let ours = mean(&|m| m.firsthit.min);
            let all: Option<Vec<Ratios>> = rows.iter().map(|m| Ratios::of(m)).collect();
            let all = all.map(|all| {
                let mean = |ratio: fn(&Ratios) -> f64| {
                    geometric_mean(&all.iter().map(ratio).collect::<Vec<_>>())
                };
                Ratios {
                    best: mean(|r| r.best),
                    single: mean(|r| r.single),
                    robust: mean(|r| r.robust),
                }
            });
            let speedup = mean(&|m| m.speedup);
            let line =
                format!("{:12} {ours:8.2} ns       |{} {speedup:5.2}", row.name(), ratios(all));
            let beside: Option<Vec<f64>> = rows.iter().map(|m| Some(m.tinybvh?.ratio)).collect();
            let beside = beside.map(|all| format!("  tinybvh x {:.2}", geometric_mean(&all)));
            self.line(&(line + &beside.unwrap_or_default()));
        }
        self.costs();
        if let Some(path) = &self.settings.record {
            let heading = path.file_stem().unwrap_or_default().to_string_lossy();
            let text = format!(
                "# {heading}\n\n`{}`\n\n```text\n{}```\n",
                self.settings.command(),
                self.text
            );
            fs::write(path, text).map_err(|error| format!("{}: {error}", path.display()))?;
        }
        Ok(self.rows.iter().all(|measured| measured.checked.wrong == 0))
    }

    /// Prints the cost of nodes, leaves and hits, from the rows where they were counted.
    fn costs(&mut self) {
        let rows: Vec<_> = self.counted.iter().map(|(_, counted)| *counted).collect();
        let Some(([ray, node, leaf, hit], off)) = fit(&rows) else {
            return;
        };
        self.line(&format!(
            "\nbounce and random, ns a ray = {ray:.1} + {node:.1} nodes + {leaf:.1} leaves + {hit:.1} hits; beyond that, rows took"
        ));
        let names = self.counted.iter().map(|(name, _)| name);
        let named: Vec<String> =
            names.zip(off).map(|(name, off)| format!("{name} {off:+.1}")).collect();
        self.line(&named.join(", "));
    }

    fn line(&mut self, line: &str) {
        println!("{line}");
        self.text += line;
        self.text.push('\n');
    }
}

/// The time until the first ray among many objects, and the memory that they take.
fn of_objects(objects: usize, triangles: f64, trees: &Trees<'_>) -> String {
    let ready = |build: Timing| build.min * triangles / 1e6;
    let each = |bytes: isize| bytes as f64 / objects as f64;
    let embree = |text: &dyn Fn(&EmbreeTrees<'_>) -> String| {
        trees.embree.as_ref().map_or_else(String::new, text)
    };
    format!(
        "{objects} objects; ready in ms: firsthit {:.1}{}; bytes/object, trees of meshes among them: firsthit {:.0}{}",
        ready(trees.firsthit_build),
        embree(&|embree| format!(", Embree {:.1}", ready(embree.build))),
        each(trees.firsthit_held),
        embree(&|embree| format!(", Embree {:.0}", each(embree.plain.bytes))),
    )
}

fn number(number: Option<f64>, width: usize, digits: usize) -> String {
    match number {
        Some(number) => format!(" {number:width$.digits$}"),
        None => format!(" {:>width$}", "-"),
    }
}

fn ratios(ratios: Option<Ratios>) -> String {
    format!(
        "  {}{}{} |",
        number(ratios.map(|r| r.best), 5, 2),
        number(ratios.map(|r| r.single), 5, 2),
        number(ratios.map(|r| r.robust), 5, 2)
    )
}

/// The processor and how many there are.
fn machine() -> String {
    let info = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let models = info.lines().filter_map(|line| line.strip_prefix("model name"));
    let models: Vec<&str> =
        models.map(|model| model.trim_start_matches([' ', '\t', ':'])).collect();
    match models.first() {
        Some(model) => format!("{model}, {} processors", models.len()),
        None => format!("{} processor", std::env::consts::ARCH),
    }
}

/// The commit that is built, if git knows it.
fn commit() -> Option<String> {
    let git = Command::new("git").args(["describe", "--always", "--dirty"]).output().ok()?;
    let name = String::from_utf8(git.stdout).ok()?.trim().to_owned();
    (git.status.success() && !name.is_empty()).then_some(name)
}
