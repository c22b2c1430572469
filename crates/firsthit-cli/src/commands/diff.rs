use std::path::Path;

use firsthit::error::{escape_controls, escaped};
use firsthit::image::{Array, Difference, Holds, Output, compare, format_of, read};
use serde_json::{Value, json};

use crate::args::DiffArgs;
use crate::console::{in_words, json_text, kept_warnings, print, warn};
use crate::failure::Failure;
use crate::hints::{meant, six_digits};

/// One channel of both files.
struct Compared {
    name: String,
    /// `[rows, columns]`, or `[n]`.
    shape: Vec<usize>,
    outcome: Result<Difference, String>,
}

/// All that there is to say.
struct Comparison {
    channels: Vec<Compared>,
    only_in_a: Vec<String>,
    only_in_b: Vec<String>,
}

pub(crate) fn run(args: &DiffArgs) -> Result<(), Failure> {
    let tolerance = args.tolerance.unwrap_or(0.0);
    let (a, b) = (load(&args.a)?, load(&args.b)?);
    let comparison = compared(args, &a, &b, tolerance)?;
    let text = if args.json {
        json_text(&comparison.json(tolerance)) + "\n"
    } else {
        comparison.text(args)
    };
    print(&text)?;
    if comparison.is_equal() { Ok(()) } else { Err(Failure::no()) }
}

fn load(path: &Path) -> Result<Output, Failure> {
    let output = read(path)?;
    let notes = output.notes.iter();
    let notes = notes.map(|note| format!("{}: {note}", escaped(path)));
    warn(&notes.collect::<Vec<_>>());
    Ok(output)
}

fn compared(
    args: &DiffArgs,
    a: &Output,
    b: &Output,
    tolerance: f64,
) -> Result<Comparison, Failure> {
    let pairs = pairs(args, a, b)?;
    let mut channels = Vec::new();
    for (name, a, b) in pairs {
        if a.is_picture != b.is_picture {
            return Err(Failure::usage(format!(
                "{name}: one file holds bytes to look at, the other values; write distances with --png-scale, or compare .exr, .npy and .npz"
            )));
        }
        let components = usize::from(a.components > 1);
        let shape = a.shape.len().saturating_sub(components);
        channels.push(Compared {
            name,
            shape: a.shape.iter().take(shape).copied().collect(),
            outcome: compare(a, b, tolerance),
        });
    }
    // A file that can only hold one channel lacks nothing.
    let holds_one = |path| format_of(path).is_ok_and(|format| format.holds == Holds::OneChannel);
    let are_all = args.channels.is_empty() && !holds_one(&args.a) && !holds_one(&args.b);
    let alone = |these: &Output, others: &Output| -> Vec<String> {
        if !are_all {
            return Vec::new();
        }
        let names = these.arrays.iter().map(name_of);
        names.filter(|name| others.array(name).is_none()).collect()
    };
    Ok(Comparison { only_in_a: alone(a, b), only_in_b: alone(b, a), channels })
}

/// Pairs of channels: by name, or where one file does not tell the name of its only channel, by
/// that.
fn pairs<'a>(
    args: &DiffArgs,
    a: &'a Output,
    b: &'a Output,
) -> Result<Vec<(String, &'a Array, &'a Array)>, Failure> {
    let names: Vec<String> = if args.channels.is_empty() {
        let names = a.arrays.iter().map(name_of);
        names.filter(|name| b.array(name).is_some()).collect()
    } else {
        let names = args.channels.iter().map(|name| match name.trim() {
            "depth" => "z".to_owned(),
            name => name.to_owned(),
        });
        names.collect()
    };
    if let ([a], [b]) = (&a.arrays[..], &b.arrays[..])
        && (a.name.is_none() || b.name.is_none())
    {
        let name = names.first().cloned();
        let name = name.or_else(|| a.name.clone()).or_else(|| b.name.clone());
        return Ok(vec![(name.unwrap_or_else(|| "array".to_owned()), a, b)]);
    }
    let find = |path: &Path, output: &'a Output, name: &str| {
        // A single array without a name is whatever is asked for.
        let only = match &output.arrays[..] {
            [only] if only.name.is_none() => Some(only),
            _ => None,
        };
        (output.array(name).or(only)).ok_or_else(|| {
            let known: Vec<String> = output.arrays.iter().map(name_of).collect();
            let meant = meant(name, known.iter().map(String::as_str));
            Failure::usage(format!(
                "--channels: {} has no channel \"{}\", only {}",
                escaped(path),
                escape_controls(name),
                escape_controls(&(in_words(known.iter().cloned()) + &meant))
            ))
        })
    };
    if names.is_empty() {
        let [known_a, known_b] =
            [a, b].map(|output| escape_controls(&in_words(output.arrays.iter().map(name_of))));
        return Err(Failure::usage(format!(
            "no channel is in both: {} has {known_a}; {} has {known_b}; choose one with --channels",
            escaped(&args.a),
            escaped(&args.b)
        )));
    }
    let pairs = names.into_iter().map(|name| {
        let (in_a, in_b) = (find(&args.a, a, &name)?, find(&args.b, b, &name)?);
        Ok((name, in_a, in_b))
    });
    pairs.collect()
}

fn name_of(array: &Array) -> String {
    array.name.clone().unwrap_or_else(|| "(no name)".to_owned())
}

impl Comparison {
    fn is_equal(&self) -> bool {
        let is_equal = |compared: &Compared| {
            let outcome = compared.outcome.as_ref();
            outcome.is_ok_and(|difference| difference.differing == 0)
        };
        self.channels.iter().all(is_equal) && self.only_in_a.is_empty() && self.only_in_b.is_empty()
    }

    fn text(&self, args: &DiffArgs) -> String {
        let mut lines: Vec<String> = self.channels.iter().map(Compared::text).collect();
        for (path, names) in [(&args.a, &self.only_in_a), (&args.b, &self.only_in_b)] {
            let line = |name: &String| format!("{name}: only in {}", path.display());
            lines.extend(names.iter().map(line));
        }
        let lines = lines.iter().map(|line| escape_controls(line) + "\n");
        lines.collect()
    }

    fn json(&self, tolerance: f64) -> Value {
        json!({
            "equal": self.is_equal(),
            "tolerance": tolerance,
            "channels": self.channels.iter().map(Compared::json).collect::<Vec<_>>(),
            "only_in_a": self.only_in_a,
            "only_in_b": self.only_in_b,
            "warnings": kept_warnings(),
        })
    }
}

fn short(x: f64) -> String {
    format!("{:?}", six_digits(x))
}

impl Compared {
    fn text(&self) -> String {
        let found = match &self.outcome {
            Ok(found) => found,
            Err(why) => return format!("{}: {why}", self.name),
        };
        let Some([a, b]) = found.values else {
            return format!("{}: equal", self.name);
        };
        // With six digits where they differ in those, else with all.
        let [a, b] = match [a, b].map(short) {
            [short_a, short_b] if short_a == short_b => [a, b].map(|x| format!("{x:?}")),
            both => both,
        };
        let ulps = found
            .ulps
            .filter(|&ulps| ulps > 0)
            .map_or(String::new(), |ulps| format!(", {ulps} ulp of {}", found.compared_as));
        let equality = match (found.differing, found.ulps) {
            (0, Some(0)) => format!("equal as {}", found.compared_as),
            (differing, _) => format!("{differing} of {} differ", found.elements),
        };
        format!(
            "{}: {equality}; largest difference {} ({a} and {b}) at {}{ulps}",
            self.name,
            short(found.largest),
            self.place(found.element),
        )
    }

    fn json(&self) -> Value {
        let found = match &self.outcome {
            Ok(found) => found,
            Err(why) => return json!({ "name": self.name, "incomparable": why }),
        };
        // JSON has neither infinity nor NaN.
        let in_json = |x: f64| {
            if x.is_finite() { json!(x) } else { json!(format!("{x:?}").to_lowercase()) }
        };
        let place = found.values.map(|_| match self.shape[..] {
            [_, columns] => vec![found.element / columns, found.element % columns],
            _ => vec![found.element],
        });
        json!({
            "name": self.name,
            "elements": found.elements,
            "differing": found.differing,
            "largest": in_json(found.largest),
            "values": found.values.map(|values| values.map(in_json)),
            "at": place,
            "ulps": found.ulps,
            "compared_as": found.compared_as,
        })
    }

    fn place(&self, element: usize) -> String {
        match self.shape[..] {
            [_, columns] => format!("row {}, column {}", element / columns, element % columns),
            _ => format!("element {element}"),
        }
    }
}
