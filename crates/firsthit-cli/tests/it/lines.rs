//! Rays that come line by line, and answers that go so.

use std::io::{BufRead, BufReader, Write};
use std::process::Stdio;
use std::sync::mpsc;
use std::time::Duration;

use crate::support::Lab;

/// How long an answer may take on a machine that is busy with other things.
const PATIENCE: Duration = Duration::from_secs(60);

#[test]
fn each_line_is_answered_before_the_next_one_is_sent() {
    let lab = Lab::with_square();
    let mut child = (lab.command("shoot square.ply - --channels t,object --quiet"))
        .stdin(Stdio::piped())
        .spawn()
        .unwrap();
    let mut rays = child.stdin.take().unwrap();
    let answers = BufReader::new(child.stdout.take().unwrap());
    let (sender, receiver) = mpsc::channel();
    let reader = std::thread::spawn(move || {
        for line in answers.lines() {
            sender.send(line.unwrap()).unwrap();
        }
    });
    let next = || receiver.recv_timeout(PATIENCE).expect("an answer");
    let mut expected = vec!["t,object".to_owned()];
    for height in 1..=20 {
        // A comment and a blank line have no answer, and half a line has none yet.
        write!(rays, "# {height}\n\n0,0,{height},").unwrap();
        rays.flush().unwrap();
        writeln!(rays, "0,0,-1").unwrap();
        rays.flush().unwrap();
        expected.push(format!("{height},0"));
        for line in expected.drain(..) {
            assert_eq!(next(), line);
        }
    }
    drop(rays);
    assert!(child.wait().unwrap().success());
    reader.join().unwrap();
}

#[test]
fn answers_are_the_same_however_the_lines_come() {
    use std::fmt::Write as _;
    let lab = Lab::with_square();
    let mut text = String::from("x,y,z,dx,dy,dz\r\n");
    for k in 0..30_000 {
        let x = f64::from(k % 301) / 100.0 - 1.5;
        writeln!(text, "{x},0.25,{},0.01,0,-1", 1 + k % 7).unwrap();
    }
    lab.write("rays.csv", &text);
    lab.ok("shoot square.ply rays.csv -o hits.csv --channels t,object,normal,front");
    let arguments = "shoot square.ply - --channels t,object,normal,front";
    let piped = lab.pipe(arguments, text.as_bytes());
    assert_eq!(piped.stdout, lab.read("hits.csv"));
    assert!(piped.stderr.starts_with("standard output: 30000 rays, "), "{}", piped.stderr);
    // In pieces that end anywhere, and without a line break at the end.
    let mut child = lab.command(arguments).stdin(Stdio::piped()).spawn().unwrap();
    let mut input = child.stdin.take().unwrap();
    let whole = text.trim_end().as_bytes().to_vec();
    let writer = std::thread::spawn(move || {
        for piece in whole.chunks(9973) {
            input.write_all(piece).unwrap();
        }
    });
    let output = child.wait_with_output().unwrap();
    writer.join().unwrap();
    assert_eq!(output.stdout, lab.read("hits.csv"));
}

#[test]
fn a_wrong_line_ends_the_answers_with_its_number() {
    let lab = Lab::with_square();
    let rays = b"# heights\n0,0,1,0,0,-1\n0,0,2,0,0,-1\n0,0,x,0,0,-1\n0,0,4,0,0,-1\n";
    let outcome = lab.pipe("shoot square.ply - --channels t", rays);
    assert_eq!((outcome.code, outcome.text()), (3, "t\n1\n2\n"));
    assert!(
        outcome.stderr.contains("standard input: line 4: expected numbers"),
        "{}",
        outcome.stderr
    );
    let long = lab.pipe("shoot square.ply -", &vec![b'1'; (1 << 24) + (1 << 20)]);
    assert_eq!(long.code, 3);
    assert!(long.stderr.contains("a line of rays is longer than 16 MiB"), "{}", long.stderr);
    let none = lab.pipe("shoot square.ply - --channels t", b"");
    assert_eq!((none.code, none.text()), (0, "t\n"));
    let three = lab.pipe("shoot square.ply -", b"0,0,1\n");
    assert_eq!((three.code, three.text()), (3, ""));
}
