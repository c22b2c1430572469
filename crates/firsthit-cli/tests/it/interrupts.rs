//! Ctrl-C, and worse.

#![cfg(unix)]

use std::process::{Child, Command};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::support::{Lab, Outcome};

/// It would take hours.
const LONG: &str = "demo --size 2000x1500 --samples 65536 -o old.png";
/// Long enough to be in the middle of it.
const A_WHILE: Duration = Duration::from_millis(400);
/// Half a second is the promise; the rest is for a machine that is busy with other tests.
const SOON: Duration = Duration::from_secs(2);

fn interrupt(child: Child) -> Outcome {
    interrupt_after(child, A_WHILE)
}

fn interrupt_after(child: Child, a_while: Duration) -> Outcome {
    sleep(a_while);
    let pid = child.id().to_string();
    let sent = Instant::now();
    let status = Command::new("kill").args(["-INT", &pid]).status().unwrap();
    assert!(status.success());
    let output = child.wait_with_output().unwrap();
    assert!(sent.elapsed() < SOON, "{:?}", sent.elapsed());
    Outcome::of(output)
}

#[test]
fn ctrl_c_ends_a_render_soon_and_leaves_the_old_picture() {
    let lab = Lab::new();
    lab.write("old.png", "old");
    let outcome = interrupt(lab.start(LONG));
    assert_eq!(outcome.code, 130);
    assert_eq!(outcome.stderr, "firsthit: error: interrupted\n");
    assert_eq!(lab.names(), ["old.png"]);
    assert_eq!(lab.read("old.png"), b"old");
}

/// `nohup` and `&` in a script start programs so.
#[test]
fn ctrl_c_is_ignored_where_a_shell_ignores_it() {
    let lab = Lab::new();
    let program = lab.command("demo --size 480x300 --samples 4 -o picture.png");
    let mut shell = Command::new("sh");
    shell.args(["-c", "trap '' INT; exec \"$@\"", "sh"]);
    shell.arg(program.get_program()).args(program.get_args());
    shell.current_dir(program.get_current_dir().unwrap());
    let mut child = shell.spawn().unwrap();
    let pid = child.id().to_string();
    let status = loop {
        // The shell comes to its first word.
        sleep(Duration::from_millis(100));
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        let _ = Command::new("kill").args(["-INT", &pid]).status();
    };
    assert_eq!(status.code(), Some(0));
    assert_eq!(lab.names(), ["picture.png"]);
}

#[test]
fn ctrl_c_ends_the_wait_for_rays() {
    let lab = Lab::with_square();
    let mut command = lab.command("shoot square.ply - -o hits.npz");
    let mut child = command.stdin(std::process::Stdio::piped()).spawn().unwrap();
    let stdin = child.stdin.take();
    let outcome = interrupt(child);
    drop(stdin);
    assert_eq!(outcome.code, 130);
    assert_eq!(lab.names(), ["square.ply"]);
}

/// The work had no time to see Ctrl-C, and the handler ended the program without the object.
#[test]
fn ctrl_c_reports_json_where_the_work_is_slow_to_end() {
    let lab = Lab::with_square();
    let mut command = lab.command("nearest square.ply - -o found.npz --json");
    let mut child = command.stdin(std::process::Stdio::piped()).spawn().unwrap();
    let stdin = child.stdin.take();
    let outcome = interrupt(child);
    drop(stdin);
    let report: serde_json::Value = serde_json::from_slice(&outcome.stdout).unwrap();
    assert_eq!((&report["error"], outcome.code), (&"interrupted".into(), 130));
    assert_eq!(report["exit_code"], 130);
}

#[test]
fn ctrl_c_ends_a_long_scan() {
    let lab = Lab::with_square();
    let long = "scan square.ply --lidar os1-128 --turns 100000 --position 0,0,1";
    let outcome = interrupt(lab.start(long));
    assert_eq!((outcome.code, &*outcome.stderr), (130, "firsthit: error: interrupted\n"));
    assert_eq!(lab.names(), ["square.ply"]);
}

#[test]
fn ctrl_c_at_any_moment_leaves_no_other_file() {
    let lab = Lab::with_square();
    let render =
        "render square.ply --size 1600x1200 --channels t,position,normal,barycentric -o old.npz";
    for k in 1..8 {
        lab.write("old.npz", "old");
        let outcome = interrupt_after(lab.start(render), Duration::from_millis(60 * k));
        assert_eq!(lab.names(), ["old.npz", "square.ply"]);
        match outcome.code {
            130 => assert_eq!(lab.read("old.npz"), b"old"),
            // It was just done.
            code => assert_eq!((code, lab.npz("old.npz").len()), (0, 4)),
        }
    }
}

/// A run shorter than the time between two states lost everything.
#[test]
fn ctrl_c_keeps_the_samples_that_are_done() {
    let lab = Lab::with_square();
    let render = "render square.ply --size 48x32 --shader unlit --resume s.npz";
    let outcome = interrupt(lab.start(&format!("{render} -o a.png --samples 65536")));
    assert_eq!(outcome.code, 130, "{}", outcome.stderr);
    let said = outcome.stderr.trim_end().lines().last();
    assert_eq!(said, Some("firsthit: error: interrupted"));
    assert_eq!(lab.names(), ["s.npz", "square.ply"]);
    let counts = lab.npz("s.npz").remove("samples").unwrap().values;
    let count = counts[0];
    assert!(count >= 1.0 && counts.iter().all(|&other| other == count));
    let render = format!("{render} --samples {}", count + 2.0);
    lab.ok(&format!("{render} -o a.npz"));
    lab.ok(&format!("{render} -o b.npz").replace("--resume s.npz", ""));
    assert!(lab.read("a.npz") == lab.read("b.npz"), "{count}");
}

#[test]
fn a_killed_run_leaves_a_whole_picture() {
    let lab = Lab::new();
    lab.ok("demo --size 64x40 --samples 1 -o picture.png");
    let old = lab.read("picture.png");
    let mut killed = lab.start(&LONG.replace("old.png", "picture.png"));
    sleep(A_WHILE);
    killed.kill().unwrap();
    killed.wait().unwrap();
    assert_eq!(lab.read("picture.png"), old);
    // At moments that may be those of the writing, too.
    for k in 0..12 {
        let mut child = lab.start("demo --size 320x200 --samples 1 -o picture.png");
        sleep(Duration::from_millis(10 * k));
        child.kill().unwrap();
        child.wait().unwrap();
        let (width, ..) = lab.png("picture.png");
        assert!(width == 64 || width == 320);
    }
}

/// Nobody reads at the other end: to open it, and to fill it, waits.
#[cfg(target_os = "linux")]
#[test]
fn ctrl_c_ends_the_wait_for_the_reader_of_a_pipe() {
    use std::fs::OpenOptions;
    use std::io::Read;
    let lab = Lab::with_square();
    let fifo = lab.path("pipe.npz");
    assert!(Command::new("mkfifo").arg(&fifo).status().unwrap().success());
    let render = "render square.ply --size 400x300 --channels position -o pipe.npz";
    let outcome = interrupt(lab.start(render));
    assert_eq!((outcome.code, outcome.stderr.as_str()), (130, "firsthit: error: interrupted\n"));
    let child = lab.start(render);
    let mut reader = std::fs::File::open(&fifo).unwrap();
    let mut start = [0; 2];
    reader.read_exact(&mut start).unwrap();
    assert_eq!(start, *b"PK");
    assert_eq!(interrupt(child).code, 130);
    drop(reader);
    // A reader that comes late gets everything.
    let child = lab.start(render);
    sleep(A_WHILE);
    let mut all = Vec::new();
    OpenOptions::new().read(true).open(&fifo).unwrap().read_to_end(&mut all).unwrap();
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(0));
    lab.ok(&render.replace("pipe", "file"));
    assert!(all == lab.read("file.npz"));
}
