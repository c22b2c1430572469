//! Help, versions, completions, and command lines that cannot be understood.

use crate::support::{ABOVE, Lab};

const COMMANDS: [&str; 17] = [
    "render",
    "shoot",
    "nearest",
    "inside",
    "visible",
    "thickness",
    "section",
    "lint",
    "probe",
    "build",
    "info",
    "scan",
    "dataset",
    "parts",
    "pack",
    "demo",
    "completions",
];

#[test]
fn every_command_has_help_with_examples() {
    let lab = Lab::new();
    let helps = COMMANDS.map(|command| format!("{command} --help"));
    for arguments in helps.iter().map(String::as_str).chain(["--help", "help render"]) {
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
        let line =
            line.replace('\'', "").replace("bunny.ply", "bunny.stl").replace("--size 720x480", "");
        let arguments = line.trim().strip_prefix("firsthit ").unwrap();
        lab.ok(&format!("{arguments} --size 48x32"));
        count += 1;
    }
    assert_eq!(count, 10);
}

#[test]
fn help_names_every_channel() {
    let lab = Lab::new();
    let help = lab.ok("render --help");
    let (_, channels) = help.text().split_once("\nChannels:\n").unwrap();
    for kind in firsthit::channel::KINDS {
        let row = format!("  {:<11}  ", kind.name);
        assert!(channels.lines().any(|line| line.starts_with(&row)), "{}", kind.name);
    }
}

/// Those of the last months were missing.
#[test]
fn the_option_for_channels_names_every_channel_too() {
    let help = Lab::new().ok("render --help");
    let (_, after) = help.text().split_once("--channels <NAMES>").unwrap();
    let (about, _) = after.split_once("\n      --").unwrap();
    let words: Vec<&str> = (about.split(|c: char| !c.is_alphanumeric() && c != '_')).collect();
    for kind in firsthit::channel::KINDS {
        assert!(words.contains(&&*kind.name), "{}", kind.name);
    }
}

#[test]
fn the_option_for_lights_names_every_kind_and_set() {
    let help = Lab::new().ok("render --help");
    let (_, after) = help.text().split_once("--light <").unwrap();
    let (about, _) = after.split_once("\n      --").unwrap();
    let words: Vec<&str> = (about.split(|c: char| !c.is_alphanumeric())).collect();
    let names = firsthit::Light::NAMES.iter().chain(firsthit::shade::LightRig::NAMES);
    for name in names {
        assert!(words.contains(name), "{name}");
    }
}

#[test]
fn the_version_is_the_package_s() {
    let outcome = Lab::new().ok("--version");
    assert_eq!(outcome.text(), concat!("firsthit ", env!("CARGO_PKG_VERSION"), "\n"));
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
fn an_input_s_name_is_no_template_of_names() {
    let lab = Lab::with_square();
    std::fs::copy(lab.path("square.ply"), lab.path("{channel}.ply")).unwrap();
    lab.fails(
        "render {channel}.ply --size 8x8",
        2,
        "--output must be given: {channel}.png would be a template",
    );
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
            "scan square.ply --range-max 100",
            "'--range-max' found; tip: a similar argument exists: '--max-range'",
        ),
        (
            "render square.ply --colour-bar",
            "'--colour-bar': plot() of the Python package draws a bar of colours",
        ),
        ("render square.ply --size 3x3 --size 4x4", "cannot be used multiple times"),
        ("info square.ply more.ply", "unexpected argument 'more.ply' found"),
        ("shoot square.ply", "<RAYS>"),
        ("render square.ply -o", "a value is required for '--output <FILE>'"),
    ] {
        lab.fails(arguments, 2, words);
    }
    let nothing = lab.run("");
    assert_eq!((nothing.code, nothing.text()), (2, ""));
    assert!(nothing.stderr.contains("Usage: firsthit [OPTIONS] <COMMAND>"));
}

#[test]
fn a_file_in_place_of_a_command_is_told_which_command_is_meant() {
    let lab = Lab::with_square();
    let meant = |arguments: &str, words: &str| lab.fails(arguments, 2, words);
    meant(
        "square.ply",
        "square.ply is a file, not a command; did you mean firsthit render square.ply?",
    );
    // It need not be there, nor alone.
    meant("part.STL --size 3x3", "did you mean firsthit render part.STL?");
    meant("scene.toml", "firsthit render scene.toml?");
    meant("a.ply.gz", "firsthit render a.ply.gz?");
    meant("all.npz", "firsthit info all.npz?");
    lab.write("odd", "x");
    meant("odd", "odd is a file");
    lab.write("two words.ply", "x");
    let outcome = lab.command("").arg("two words.ply").output().unwrap();
    let said = String::from_utf8(outcome.stderr).unwrap();
    assert!(said.contains("firsthit render 'two words.ply'?"), "{said}");
    std::fs::create_dir(lab.path("folder")).unwrap();
    meant("folder", "folder is a folder, not a command");
    // A slip of the finger is one still.
    meant("rendr", "a similar subcommand exists: 'render'");
}

#[test]
fn a_folder_is_told_to_be_one_by_every_command_that_reads() {
    let lab = Lab::with_square();
    for name in ["models", "models.glb", "out.exr"] {
        std::fs::create_dir(lab.path(name)).unwrap();
        for arguments in [
            format!("render {name}"),
            format!("info {name}"),
            format!("section {name}"),
            format!("lint {name}"),
            format!("shoot {name} rays.csv"),
            format!("shoot square.ply {name}"),
            format!("shoot square.ply rays.csv {name}"),
            format!("diff {name} {name}"),
        ] {
            lab.write("rays.csv", "0,0,1,0,0,-1\n");
            lab.fails(&arguments, 3, &format!("{name}: a folder, not a file"));
        }
        lab.fails(&format!("render square.ply -o {name}"), 4, "is a folder, not a file");
    }
}

#[test]
fn the_version_can_be_asked_of_every_command() {
    let lab = Lab::new();
    for command in [
        "render",
        "shoot",
        "build",
        "nearest",
        "info",
        "diff",
        "section",
        "lint",
        "probe",
        "scan",
        "dataset",
        "parts",
        "pack",
        "demo",
        "schema",
        "completions",
    ] {
        for option in ["-V", "--version"] {
            let outcome = lab.ok(&format!("{command} {option}"));
            let text = outcome.text().trim_end();
            let version = concat!("firsthit ", env!("CARGO_PKG_VERSION"));
            assert_eq!(text, version, "{command}");
        }
    }
}

#[test]
fn a_command_of_the_python_package_says_where_it_is() {
    let lab = Lab::new();
    for arguments in [
        "dataset",
        "dataset plan.toml -o out --part 1/2",
        "parts",
        "parts out --verify",
        "pack",
        "pack out -o shards --size 300",
    ] {
        let command = arguments.split(' ').next().unwrap();
        let says = "comes with the Python package: pip install . in a clone";
        lab.fails(arguments, 2, &format!("firsthit {command} {says}"));
    }
}

#[test]
fn shells_complete_the_names_of_channels() {
    let lab = Lab::new();
    for shell in ["bash", "zsh", "fish"] {
        let completions = lab.ok(&format!("completions {shell}"));
        // Fish has a line for each.
        let text = completions.text().replace("\\t''\n", " ");
        let of_channels =
            |line: &&str| ["barycentric", "primitive"].iter().all(|name| line.contains(name));
        let lines = text.lines().filter(of_channels);
        // Of render, shoot, diff and demo.
        assert!(lines.count() >= 4, "{shell}");
    }
}

#[test]
fn messages_name_options_as_they_are_typed_and_files_that_are_not_there() {
    let lab = Lab::with_square();
    for (arguments, expected) in [
        ("--camera nofile.exr", "--camera 'nofile.exr': there is no such file"),
        ("--camera nobody", "--camera 'nobody': the file has no cameras"),
        ("--channels depht -o a.npz", "; did you mean depth?"),
        ("--only sqare", "lists the 1 there are; did you mean square?"),
        ("--channels z --png-scale 1e-7 -o a.png", "--png-scale must be so large"),
        ("--channels z --png-scale=1e-7 -o a.png", "farthest hit, unless --far is given"),
    ] {
        lab.fails(&format!("render square.ply {ABOVE} {arguments}"), 2, expected);
    }
}
