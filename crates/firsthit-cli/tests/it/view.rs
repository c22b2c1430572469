//! `firsthit view`: what its page gets is what the other commands say.

#![cfg(unix)]

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command};
use std::thread::sleep;
use std::time::Duration;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use flate2::read::GzDecoder;
use serde_json::{Value, json};

use crate::support::{Lab, Outcome};

/// A page without a browser.
struct Page {
    child: Option<Child>,
    port: u16,
    token: String,
}

impl Page {
    fn open(lab: &Lab, arguments: &str) -> Self {
        let mut child = lab.start(&format!("view {arguments} --no-browser"));
        let mut address = String::new();
        BufReader::new(child.stdout.as_mut().unwrap()).read_line(&mut address).unwrap();
        let (place, token) = address.trim_end().split_once("/#").unwrap();
        Self {
            child: Some(child),
            port: place.strip_prefix("http://127.0.0.1:").unwrap().parse().unwrap(),
            token: token.to_owned(),
        }
    }

    fn ask(&self, path: &str, question: &Value) -> Vec<u8> {
        let body = question.to_string();
        let Self { port, token, .. } = self;
        let mut stream = TcpStream::connect(("127.0.0.1", *port)).unwrap();
        let head = format!(
            "POST {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nX-Firsthit-Token: {token}\r\nConnection: close\r\nContent-Length: {}\r\n\r\n",
            body.len()
        );
        stream.write_all(head.as_bytes()).unwrap();
        stream.write_all(body.as_bytes()).unwrap();
        let mut reply = Vec::new();
        stream.read_to_end(&mut reply).unwrap();
        let end = reply.windows(4).position(|four| four == b"\r\n\r\n").unwrap();
        let head = String::from_utf8_lossy(&reply[..end]).into_owned();
        assert!(
            head.starts_with("HTTP/1.1 200 "),
            "{head} {}",
            String::from_utf8_lossy(&reply[end..])
        );
        reply[end + 4..].to_vec()
    }

    fn json(&self, path: &str, question: &Value) -> Value {
        serde_json::from_slice(&self.ask(path, question)).unwrap()
    }

    fn interrupt(mut self) -> Outcome {
        let child = self.child.take().unwrap();
        let pid = child.id().to_string();
        assert!(Command::new("kill").args(["-INT", &pid]).status().unwrap().success());
        Outcome::of(child.wait_with_output().unwrap())
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        if let Some(child) = &mut self.child {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// Cameras of all kinds that the page has.
fn cameras(first: &Value) -> Vec<Value> {
    let mut others = vec![first.clone()];
    for (projection, ray_start) in
        [("perspective", "viewplane"), ("orthographic", "eye"), ("orthographic", "viewplane")]
    {
        let mut camera = first.clone();
        camera["projection"] = json!(projection);
        camera["ray_start"] = json!(ray_start);
        camera["focal_length"] = json!(0.1 + 0.2);
        camera["width"] = json!(4.0 / 3.0 * 0.7);
        camera["height"] = json!(1e-3_f64.mul_add(1.0, 0.7));
        camera["position"] = json!([1.0 / 3.0, -4.0, 2.0 + 1e-13]);
        camera["aim"] = json!([-0.1, 2.0, -1.1]);
        camera["up"] = json!([1e-17, 0.1, 3.0]);
        (camera["rows"], camera["columns"]) = (json!(31), json!(47));
        others.push(camera);
    }
    others
}

#[test]
fn what_is_said_of_a_camera_renders_the_same_bytes() {
    let lab = Lab::with_square();
    let page = Page::open(&lab, "square.ply --size 64x48");
    let first = page.json("/info", &json!({}))["camera"].clone();
    for camera in cameras(&first) {
        let picture = page.ask("/frame", &json!({"camera": camera, "is_lit": true}));
        let said = page.json("/camera", &json!({"camera": camera}));
        lab.ok(&format!(
            "render square.ply -q -o by-command.png {}",
            said["command"].as_str().unwrap()
        ));
        assert_eq!(lab.read("by-command.png"), picture, "{said}");
        let scene =
            format!("{}\n[[objects]]\nfile = \"square.ply\"\n", said["toml"].as_str().unwrap());
        lab.write("scene.toml", scene);
        lab.ok("render scene.toml -q -o by-table.png");
        assert_eq!(lab.png("by-table.png"), lab.png("by-command.png"), "{said}");
        assert_eq!(said["opencv"].is_null(), camera["projection"] == "orthographic");
        assert_eq!(said["colmap"].is_null(), camera["projection"] == "orthographic");
    }
}

#[test]
fn matrices_and_colmap_make_the_same_camera_but_for_rounding() {
    let lab = Lab::with_square();
    let page = Page::open(&lab, "square.ply --size 64x48");
    let camera = page.json("/info", &json!({}))["camera"].clone();
    let said = page.json("/camera", &json!({"camera": camera}));
    lab.ok(&format!(
        "render square.ply -q --channels t -o t.npy {}",
        said["command"].as_str().unwrap()
    ));
    let k = &said["opencv"]["k"];
    let pose = said["opencv"]["camera_from_world"].as_array().unwrap();
    let rows: Vec<String> = pose
        .iter()
        .map(|row| {
            row.as_array().unwrap().iter().map(Value::to_string).collect::<Vec<_>>().join(" ")
        })
        .collect();
    lab.write("pose.txt", rows.join("\n"));
    lab.ok(&format!(
        "render square.ply -q --channels t -o k.npy --intrinsics {},{},{},{} --pose pose.txt --convention opencv --size 64x48",
        k[0][0], k[1][1], k[0][2], k[1][2]
    ));
    let lines = said["colmap"].as_str().unwrap();
    let (cameras, images) = lines.split_once('\n').unwrap();
    std::fs::create_dir(lab.path("sparse")).unwrap();
    lab.write("sparse/cameras.txt", format!("{cameras}\n"));
    lab.write("sparse/images.txt", format!("{images}\n"));
    lab.ok("render square.ply -q --channels t -o colmap.npy --colmap sparse --image view.png");
    for name in ["k.npy", "colmap.npy"] {
        let outcome = lab.run(&format!("diff t.npy {name} --tolerance 1e-9"));
        assert_eq!(outcome.code, 0, "{name}: {}", String::from_utf8_lossy(&outcome.stdout));
    }
}

#[test]
fn a_pixel_says_what_probe_prints() {
    let lab = Lab::with_square();
    let page = Page::open(&lab, "square.ply --size 64x48");
    let camera = page.json("/info", &json!({}))["camera"].clone();
    let said = page.json("/camera", &json!({"camera": camera}));
    let told = page.json("/probe", &json!({"camera": camera, "pixel": [20, 30]}));
    let arguments = format!("probe square.ply --pixel 20,30 {}", said["command"].as_str().unwrap());
    let printed: Value =
        serde_json::from_slice(&lab.ok(&format!("{arguments} --json")).stdout).unwrap();
    for (name, value) in told.as_object().unwrap() {
        assert_eq!(value, &printed[name], "{name}");
    }
}

#[test]
fn the_file_s_light_and_camera_are_the_first_that_is_seen() {
    let lab = Lab::with_square();
    lab.write(
        "scene.toml",
        "[camera]\nposition = [0, -3, 2]\nlook_at = [0, 0, 0]\nfov = 40\ncolumns = 40\nrows = 30\n[[objects]]\nfile = \"square.ply\"\n\
         [[lights]]\nkind = \"point\"\nposition = [0, 0, 2]\nintensity = [9, 9, 9]\n",
    );
    lab.ok("render scene.toml -q -o a.png");
    let page = Page::open(&lab, "scene.toml");
    let camera = page.json("/info", &json!({}))["camera"].clone();
    lab.write("b.png", page.ask("/frame", &json!({"camera": camera, "is_lit": true})));
    assert_eq!(lab.png("a.png"), lab.png("b.png"));
}

/// Exposure, tone map and lines of the file are those of the page's picture too, and may be left
/// out there.
#[test]
fn what_the_file_says_of_its_pictures_is_shown() {
    let lab = Lab::with_square();
    lab.write(
        "scene.toml",
        "[camera]\ncolumns = 40\nrows = 30\n[display]\nexposure = 1.5\ntone_map = \"neutral\"\n[edges]\nwidth = 2.5\n\
         [[objects]]\nfile = \"square.ply\"\n",
    );
    lab.ok("render scene.toml -q -o a.png");
    lab.ok("render scene.toml -q --no-edges -o plain.png");
    let page = Page::open(&lab, "scene.toml");
    let info = page.json("/info", &json!({}));
    assert_eq!(info["edges"], 2.5);
    let camera = &info["camera"];
    let picture = page.ask("/frame", &json!({"camera": camera, "is_lit": true}));
    assert_eq!(lab.read("a.png"), picture);
    let plain = page.ask("/frame", &json!({"camera": camera, "is_lit": true, "edges": 0.0}));
    assert_eq!(lab.read("plain.png"), plain);
}

#[test]
fn ctrl_c_ends_it_and_nothing_is_left() {
    let lab = Lab::with_square();
    let page = Page::open(&lab, "square.ply");
    sleep(Duration::from_millis(50));
    let outcome = page.interrupt();
    assert_eq!((outcome.code, outcome.stderr.as_str()), (0, ""));
    assert_eq!(lab.names(), ["square.ply"]);
}

#[test]
fn what_is_wrong_is_said_in_a_line() {
    let lab = Lab::with_square();
    lab.fails("view nothing.ply --no-browser", 3, "nothing.ply");
    lab.fails("view square.ply --no-browser --port 0", 2, "--port");
    lab.fails("view square.ply --no-browser --size 0x1", 2, "--size");
    lab.fails("view square.ply --no-browser --host 0.0.0.0", 2, "--host");
    lab.fails("view square.ply -o page.png", 2, "must end in .html");
    lab.fails("view square.ply -o page.html --port 9", 2, "--port");
    let page = Page::open(&lab, "square.ply");
    lab.fails(&format!("view square.ply --no-browser --port {}", page.port), 2, "--port");
}

#[test]
fn a_report_has_the_scene_inside() {
    let lab = Lab::with_square();
    lab.ok("view square.ply -o page.html --size 64x48");
    lab.ok("view square.ply -o again.html --size 64x48 --threads 1");
    let page = String::from_utf8(lab.read("page.html")).unwrap();
    assert_eq!(page.as_bytes(), lab.read("again.html"));
    assert!(page.contains("default-src 'none'"));
    // What is inside is the scene: the same bytes as are saved.
    let (_, rest) = page.split_once("id=\"report-scene\" type=\"text/plain\">").unwrap();
    let (packed, _) = rest.split_once("</script>").unwrap();
    let mut scene = Vec::new();
    let packed = BASE64_STANDARD.decode(packed).unwrap();
    GzDecoder::new(&packed[..]).read_to_end(&mut scene).unwrap();
    lab.write("scene.fhs", scene);
    lab.ok("render scene.fhs -q -o inside.png --size 64x48");
    lab.ok("render square.ply -q -o own.png --size 64x48");
    assert!(lab.png("inside.png") == lab.png("own.png"));
}
