//! The output for other programs.

use serde_json::Value;

use crate::support::{Lab, Outcome, SQUARE};

fn object(text: &str) -> Value {
    let value: Value = serde_json::from_str(text).unwrap_or_else(|error| panic!("{error}: {text}"));
    assert!(value.is_object(), "{text}");
    value
}

#[test]
fn every_command_says_what_it_did_in_one_object() {
    let lab = Lab::with_square();
    let said = |arguments: &str| {
        let outcome = lab.ok(arguments);
        assert_eq!(outcome.stderr, "", "{arguments}");
        object(outcome.text())
    };
    let rendered = said(
        "render square.ply --size 20x10 --channels depth,object --json -o a.exr -o b-{channel}.png",
    );
    assert_eq!((&rendered["columns"], &rendered["rows"]), (&20.into(), &10.into()));
    assert_eq!(rendered["outputs"][0]["file"], "a.exr");
    assert_eq!(rendered["outputs"][0]["channels"], serde_json::json!(["z", "object"]));
    let legend = rendered["outputs"][1]["legend"].as_str().unwrap();
    assert!(legend.starts_with("z from "), "{legend}");
    assert!(rendered["hits"].as_u64().unwrap() > 10);
    assert_eq!(rendered["triangles"], 2);
    assert_eq!(rendered["warnings"], serde_json::json!([]));
    let demo = said("demo --size 8x8 --samples 1 --json");
    assert_eq!(demo["outputs"][0]["file"], "demo.png");
    lab.write("rays.csv", "0,0,1,0,0,-1\n9,9,1,0,0,-1\n");
    let shot = said("shoot square.ply rays.csv -o hits.npz --json");
    assert_eq!((&shot["rays"], &shot["hits"]), (&2.into(), &1.into()));
    assert_eq!(shot["outputs"][0]["file"], "hits.npz");
    lab.write("points.csv", "0,0,1\n0,0,nan\n");
    let near = said("nearest square.ply points.csv -o near.npz --json");
    assert_eq!((&near["points"], &near["found"]), (&2.into(), &1.into()));
    assert_eq!(said("info square.ply --json")["triangles"], 2);
    assert_eq!(said("info a.exr --json")["format"], "exr");
    assert_eq!(said("diff a.exr a.exr --json")["equal"], true);
}

#[test]
fn warnings_are_in_the_object_and_nowhere_else() {
    let lab = Lab::with_square();
    let outcome = lab.ok("render square.ply --size 8x8 --channels t --samples 4 --json");
    assert_eq!(outcome.stderr, "");
    let warnings = object(outcome.text())["warnings"].clone();
    assert_eq!(warnings[0], "--samples does nothing without color among the --channels");
}

#[test]
fn where_results_take_standard_output_the_object_goes_to_standard_error() {
    let lab = Lab::with_square();
    let outcome = lab.pipe("shoot missing.ply - --json", b"0,0,1,0,0,-1\n");
    assert_eq!((outcome.code, outcome.text()), (3, ""));
    assert!(object(&outcome.stderr)["error"].is_string());
    let outcome = lab.pipe("shoot square.ply - --json", b"0,0,1,0,0,-1\n");
    assert_eq!(outcome.text(), "t,object,primitive\n1,0,0\n");
    let said = object(&outcome.stderr);
    assert_eq!((&said["rays"], &said["outputs"][0]["file"]), (&1.into(), &"-".into()));
    let failed = lab.pipe("shoot square.ply - --json", b"0,0,1\n");
    assert_eq!((failed.code, failed.text()), (3, ""));
    assert_eq!(object(&failed.stderr)["exit_code"], 3);
}

#[test]
fn failures_are_objects_too() {
    let lab = Lab::with_square();
    lab.write("bad.ply", &SQUARE[..SQUARE.len() - 4]);
    for (arguments, code, words) in [
        ("render bad.ply --json", 3, "bad.ply:"),
        ("info none.ply --json", 3, "none.ply: "),
        ("render square.ply --json --fob 3", 2, "unexpected argument '--fob'"),
        ("render square.ply -o none/a.png --json", 4, "the folder does not exist"),
        ("diff a.png b.png --json", 3, "a.png: "),
    ] {
        let Outcome { code: got, stdout, stderr } = lab.run(arguments);
        assert_eq!(got, code, "{arguments}: {stderr}");
        let failure = object(std::str::from_utf8(&stdout).unwrap());
        assert_eq!(failure["exit_code"], code, "{arguments}");
        assert!(failure["error"].as_str().unwrap().contains(words), "{arguments}: {failure}");
        assert!(stderr.starts_with("firsthit: error: "), "{stderr}");
    }
}
