//! Help, versions, completions, and command lines that cannot be understood.

use crate::support::Lab;

const COMMANDS: [&str; 5] = ["render", "shoot", "info", "demo", "completions"];

#[test]
fn every_command_has_help_with_examples() {
    let lab = Lab::new();
    let helps = COMMANDS.map(|command| format!("{command} --help"));
    for arguments in helps
        .iter()
        .map(String::as_str)
        .chain(["--help", "help render"])
    {
        let outcome = lab.ok(arguments);
        assert!(outcome.text().contains("Examples:\n  "), "{arguments}");
        assert!(outcome.text().contains("Usage: firsthit"), "{arguments}");
        assert_eq!(outcome.stderr, "");
    }
}

#[test]
fn help_fits_into_80_columns_and_its_examples_can_be_copied() {
    let lab = Lab::new();
    for command in COMMANDS.into_iter().chain([""]) {
        let mut help = lab.command(&format!("{command} --help"));
        let output = help.env("COLUMNS", "80").output().unwrap();
        let text = String::from_utf8(output.stdout).unwrap();
        let mut is_open = false;
        for line in text.lines() {
            assert!(line.chars().count() <= 80, "{line}");
            // A command that goes on says so, and goes on further in.
            assert!(!is_open || line.starts_with("      "), "{line}");
            is_open = line.ends_with('\\');
        }
    }
}

#[test]
fn the_examples_of_the_help_work() {
    let lab = Lab::with("cube_binary.stl", "part.stl");
    std::fs::copy(lab.path("part.stl"), lab.path("bunny.stl")).unwrap();
    let help = lab.ok("render --help");
    let (_, examples) = help.text().split_once("Examples:\n").unwrap();
    let (examples, _) = examples.split_once("\n\n").unwrap();
    let mut count = 0;
    for line in examples.replace("\\\n", " ").lines() {
        let line = line
            .replace('\'', "")
            .replace("bunny.ply", "bunny.stl")
            .replace("--size 720x480", "");
        let arguments = line.trim().strip_prefix("firsthit ").unwrap();
        lab.ok(&format!("{arguments} --size 48x32"));
        count += 1;
    }
    assert_eq!(count, 6);
}

#[test]
fn help_names_every_channel() {
    let lab = Lab::new();
    let help = lab.ok("render --help");
    let (_, channels) = help.text().split_once("\nChannels:\n").unwrap();
    for kind in firsthit::channel::KINDS {
        let row = format!("  {:<11}  ", kind.name);
        assert!(
            channels.lines().any(|line| line.starts_with(&row)),
            "{}",
            kind.name
        );
    }
}

#[test]
fn the_version_is_the_package_s() {
    let outcome = Lab::new().ok("--version");
    assert_eq!(
        outcome.text(),
        concat!("firsthit ", env!("CARGO_PKG_VERSION"), "\n")
    );
}

#[test]
fn shells_get_completions() {
    let lab = Lab::new();
    for shell in ["bash", "zsh", "fish"] {
        let outcome = lab.ok(&format!("completions {shell}"));
        for word in ["render", "focal-length", "ray-start"] {
            assert!(outcome.text().contains(word), "{shell} {word}");
        }
    }
    lab.fails("completions dos", 2, "possible values");
}

#[test]
fn wrong_usage_is_one_line_with_a_way_on() {
    let lab = Lab::with_square();
    for (arguments, words) in [
        (
            "rendr square.ply",
            "unrecognized subcommand 'rendr'; tip: a similar subcommand exists: 'render'; see --help",
        ),
        ("render", "<FILE>; see firsthit render --help"),
        (
            "render square.ply --fob 3",
            "unexpected argument '--fob' found; tip: a similar argument exists: '--fov'",
        ),
        (
            "render square.ply --size 3x3 --size 4x4",
            "cannot be used multiple times",
        ),
        (
            "info square.ply more.ply",
            "unexpected argument 'more.ply' found",
        ),
        ("shoot square.ply", "<RAYS>"),
        (
            "render square.ply -o",
            "a value is required for '--output <FILE>'",
        ),
    ] {
        lab.fails(arguments, 2, words);
    }
    let nothing = lab.run("");
    assert_eq!((nothing.code, nothing.text()), (2, ""));
    assert!(nothing.stderr.contains("Usage: firsthit <COMMAND>"));
}
