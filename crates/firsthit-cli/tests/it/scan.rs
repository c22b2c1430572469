//! Scans of laser scanners.

use std::f64::consts::FRAC_1_SQRT_2;

use firsthit::image::Data;
use firsthit::load::{LoadSettings, load};
use firsthit::scan::{Returns, Rings, Scan, ScanSettings, scan};
use firsthit::sensor::{Lidar, LidarModel, Lissajous, Pattern, Raster, Rosette, Spinning, Turn};
use firsthit::trajectory::read_csv;
use firsthit::{DVec3, Pose, Scene};
use serde_json::{Value, json};

use crate::support::{Lab, Outcome};

const ROOM: &str = "[[objects]]\nshape = \"box\"\nlow = [-4, -3, -1]\nhigh = [4, 3, 2]\n
[[objects]]\nshape = \"sphere\"\nname = \"ball\"\ncenter = [2, 0.5, 0]\nradius = 0.5\n";
const DRIVE: &str = "time,x,y,z,qx,qy,qz,qw\n3,-1,0,0,0,0,0,1\n3.3,1,0.2,0,0,0,0.6,0.8\n";

/// A folder with a room, its scene file, and a drive through it.
fn lab() -> (Lab, Scene) {
    let lab = Lab::new();
    lab.write("room.toml", ROOM);
    lab.write("drive.csv", DRIVE);
    let loaded = load(&lab.path("room.toml"), &LoadSettings::default()).unwrap();
    (lab, loaded.into_scene().unwrap())
}

fn at(x: f64, y: f64, z: f64) -> Pose {
    Pose { position: DVec3::new(x, y, z), ..Pose::IDENTITY }
}

fn standing(pattern: firsthit::Result<Pattern>, pose: Pose) -> Lidar {
    Lidar::new(pattern.unwrap(), pose).unwrap()
}

fn spinning(elevations: &[f64], columns: usize) -> Spinning {
    Spinning { elevations: elevations.to_vec(), columns, rate: 10.0, ..Spinning::default() }
}

fn assert_same(lab: &Lab, file: &str, scan: &Scan) {
    let written = Scan::read(&lab.path(file)).unwrap();
    assert_eq!(written.shape(), scan.shape());
    assert_eq!(written.frame().channels(), scan.frame().channels());
    assert_eq!(written.frame().metadata(), scan.frame().metadata());
    assert!(!scan.is_empty());
}

fn doubles<'a>(scan: &'a Scan, name: &str) -> &'a [f64] {
    match &scan.frame().channel(name).unwrap().data {
        Data::Float64(values) => values,
        other => panic!("{other:?}"),
    }
}

fn report(outcome: &Outcome) -> Value {
    serde_json::from_slice(&outcome.stdout).unwrap()
}

#[test]
#[expect(clippy::too_many_lines, reason = "a table")]
fn the_returns_are_those_of_the_scanner_bit_for_bit() {
    let (lab, scene) = lab();
    let raster = Raster {
        horizontal_fov: 70.0,
        vertical_fov: 40.0,
        rows: 9,
        columns: 16,
        rate: 10.0,
        is_serpentine: false,
        start: 0.0,
    };
    let rosette = Rosette {
        fov: 38.4,
        frequencies: [-9.0, 4.0],
        share: 0.3,
        points: 50,
        point_rate: 1e3,
        start: -1.0,
    };
    let lissajous = Lissajous {
        horizontal_fov: 60.0,
        vertical_fov: 30.0,
        frequencies: [7.0, 11.0],
        phase: -30.0,
        points: 50,
        point_rate: 1e3,
        start: 0.0,
    };
    let ahead = Spinning {
        azimuth_start: -60.0,
        azimuth_end: 60.0,
        direction: Turn::Counterclockwise,
        ..spinning(&[-9.0, 0.0, 9.0], 50)
    };
    let swept = Raster { rate: 5.0, is_serpentine: true, start: 2.0, ..raster };
    let flash = Raster { rate: 0.0, start: 2.0, ..raster };
    for (options, lidar) in [
        ("--lidar VLP-16", standing(LidarModel::Vlp16.pattern(10.0, None, 0.0), Pose::IDENTITY)),
        (
            "--lidar os1-32 --columns 64 --rate 20 --start 2 --position 1,-0.5,0.25",
            standing(LidarModel::Os1x32.pattern(20.0, Some(64), 2.0), at(1.0, -0.5, 0.25)),
        ),
        (
            "--elevations -25,15,5 --columns 90",
            standing(
                Pattern::spinning(&spinning(&[-25.0, -15.0, -5.0, 5.0, 15.0], 90)),
                Pose::IDENTITY,
            ),
        ),
        (
            "--elevations -9,9,3 --columns 50 --azimuth-start -60 --azimuth-end 60 --direction counterclockwise",
            standing(Pattern::spinning(&ahead), Pose::IDENTITY),
        ),
        (
            "--raster 70,40 --rows 9 --columns 16",
            standing(Pattern::raster(&raster), Pose::IDENTITY),
        ),
        (
            "--raster 70,40 --rows 9 --columns 16 --rate 5 --serpentine --start 2",
            standing(Pattern::raster(&swept), Pose::IDENTITY),
        ),
        (
            "--raster 70,40 --rows 9 --columns 16 --flash --start 2 --position 1,0,0",
            standing(Pattern::raster(&flash), at(1.0, 0.0, 0.0)),
        ),
        (
            "--rosette 38.4 --frequencies -9,4 --points 50 --point-rate 1e3 --share 0.3 --start -1",
            standing(Pattern::rosette(&rosette), Pose::IDENTITY),
        ),
        (
            "--lissajous 60,30 --frequencies 7,11 --points 50 --point-rate 1e3 --phase -30",
            standing(Pattern::lissajous(&lissajous), Pose::IDENTITY),
        ),
    ] {
        let outcome = lab.ok(&format!("scan room.toml {options} -o a.npz"));
        let scan = scan(&lidar, &scene, &ScanSettings::default(), &()).unwrap();
        assert_same(&lab, "a.npz", &scan);
        let [rows, columns] = scan.shape();
        let said = format!("a.npz: {} returns of {rows} x {columns} beams\n", scan.len());
        assert_eq!((outcome.text(), &outcome.stderr), ("", &said), "{options}");
    }
}

#[test]
fn options_of_returns_are_the_settings_of_a_scan() {
    let (lab, scene) = lab();
    let lidar =
        standing(Pattern::spinning(&spinning(&[-15.0, -5.0, 5.0, 15.0], 120)), Pose::IDENTITY);
    let usual = ScanSettings::default();
    for (options, settings) in [
        (
            "--returns all --max-returns 1",
            ScanSettings { returns: Returns::All, max_returns: Some(1), ..usual },
        ),
        (
            "--returns last --range-gate 0.5 --rings lowest-first",
            ScanSettings {
                returns: Returns::Last,
                range_gate: 0.5,
                rings: Rings::LowestFirst,
                ..usual
            },
        ),
        (
            "--divergence 0.003 --subrays 7 --range-gate 0.1 --returns strongest --intensity",
            ScanSettings {
                divergence: Some(0.003),
                subrays: 7,
                range_gate: 0.1,
                returns: Returns::Strongest,
                intensity: true,
                ..usual
            },
        ),
        (
            "--noise 0.02,0.001 --dropout 0.1 --seed 5 --threads 1",
            ScanSettings { noise: Some([0.02, 0.001]), dropout: Some(0.1), seed: Some(5), ..usual },
        ),
        (
            "--min-range 2 --max-range 4.5 --threads 3",
            ScanSettings { min_range: 2.0, max_range: 4.5, ..usual },
        ),
    ] {
        lab.ok(&format!("scan room.toml --elevations -15,15,4 --columns 120 {options} -o a.npz"));
        assert_same(&lab, "a.npz", &scan(&lidar, &scene, &settings, &()).unwrap());
    }
    lab.ok(
        "scan room.toml --elevations -15,15,4 --columns 120 --class ball=7 --class 0=6 -o a.npz",
    );
    let classified = scan(&lidar, &scene, &usual, &()).unwrap().classified(&[6, 7]).unwrap();
    assert_same(&lab, "a.npz", &classified);
}

#[test]
fn a_drive_is_scanned_turn_by_turn() {
    let (lab, scene) = lab();
    let options = "--lidar vlp-16 --columns 60 --noise 0.01 --seed 8 --trajectory drive.csv --position 0,0,0.3";
    // Three turns of a tenth of a second fit into the trajectory, from its first time on.
    lab.ok(&format!("scan room.toml {options} -o a.npz -q"));
    let drive = read_csv(DRIVE.as_bytes(), "drive.csv".as_ref()).unwrap();
    let turns = (0..3_u8).map(|turn| {
        let start = 3.0 + f64::from(turn) / 10.0;
        let pattern = LidarModel::Vlp16.pattern(10.0, Some(60), start).unwrap();
        let lidar = Lidar::carried(pattern, at(0.0, 0.0, 0.3), &drive).unwrap();
        let seed = Some(8 + u64::from(turn));
        let settings = ScanSettings { noise: Some([0.01, 0.0]), seed, ..ScanSettings::default() };
        scan(&lidar, &scene, &settings, &()).unwrap()
    });
    let joined = Scan::joined(turns).unwrap();
    assert_eq!(joined.shape(), [16, 180]);
    assert_same(&lab, "a.npz", &joined);
}

#[test]
fn a_rose_goes_on_from_turn_to_turn() {
    let (lab, _) = lab();
    let curve = "scan room.toml --rosette 50 --frequencies 12,-7.5 --point-rate 1000 --start 3";
    lab.ok(&format!("{curve} --points 60 --turns 3 -o a.npz"));
    lab.ok(&format!("{curve} --points 180 -o b.npz"));
    let [parts, whole] = ["a.npz", "b.npz"].map(|file| Scan::read(&lab.path(file)).unwrap());
    for name in ["time", "point", "range"] {
        let pairs = doubles(&parts, name).iter().zip(doubles(&whole, name));
        assert!({ pairs }.all(|(a, b)| (a - b).abs() < 1e-11), "{name}");
    }
    assert_eq!(parts.frame().channel("column"), whole.frame().channel("column"));
}

#[test]
fn turns_and_durations_count_whole_turns() {
    let (lab, _) = lab();
    for (options, turns) in [
        ("", 1),
        ("--turns 4", 4),
        ("--duration 0.3", 3),
        ("--duration 0.39 --rate 10", 3),
        ("--duration 0.3 --rate 20", 6),
        ("--trajectory drive.csv --start 3.1", 2),
        ("--trajectory drive.csv --turns 2 --interpolation se3", 2),
        ("--trajectory drive.csv --turns 5 --extrapolation hold", 5),
    ] {
        let said =
            report(&lab.ok(&format!("scan room.toml --lidar vlp-16 --columns 8 {options} --json")));
        assert_eq!(said["turns"], json!(turns), "{options}");
        assert_eq!((&said["rows"], &said["columns"]), (&json!(16), &json!(8 * turns)));
        assert_eq!(said["outputs"], json!(["room-scan.ply"]));
        assert_eq!((&said["lidar"], &said["warnings"]), (&json!("vlp-16"), &json!([])));
    }
    for (options, turns) in [
        ("--raster 70,40 --rows 3 --columns 4 --rate 20", 6),
        ("--lissajous 60,30 --frequencies 7,11 --points 50 --point-rate 1000", 6),
        ("--rosette 60 --frequencies 7,-11 --points 70 --point-rate 1000", 4),
    ] {
        let said = report(
            &lab.ok(&format!("scan room.toml {options} --trajectory drive.csv -o a.npz --json")),
        );
        assert_eq!(said["turns"], json!(turns));
        let scan = Scan::read(&lab.path("a.npz")).unwrap();
        let last = doubles(&scan, "time").iter().copied().fold(0.0, f64::max);
        assert_eq!(doubles(&scan, "time")[0], 3.0);
        assert!(3.2 < last && last < 3.3);
    }
}

#[test]
fn a_scanner_looks_along_its_aim() {
    let (lab, _) = lab();
    lab.write("pose.txt", "0 0 1 0\n1, 0, 0, 0\n0 1 0 0\n");
    lab.write("beams.csv", "azimuth,elevation\n0,0\n90,0\n");
    let half = FRAC_1_SQRT_2;
    for (options, forwards, left) in [
        ("--aim 0,2,0", [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]),
        ("--aim 1,0,-1 --up 0,0,1", [half, 0.0, -half], [0.0, 1.0, 0.0]),
        ("--up 1,0,0", [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
        ("--pose pose.txt", [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
    ] {
        lab.ok(&format!("scan room.toml --pattern beams.csv {options} -o a.npz"));
        let scan = Scan::read(&lab.path("a.npz")).unwrap();
        for (k, way) in [forwards, left].into_iter().enumerate() {
            let point = &doubles(&scan, "point")[3 * k..];
            for (axis, expected) in way.into_iter().enumerate() {
                let found = point[axis] / doubles(&scan, "range")[k];
                assert!((found - expected).abs() < 1e-12, "{options}: {point:?}");
            }
        }
    }
}

#[test]
fn a_scanner_stands_upright_where_y_is_up() {
    let lab = Lab::new();
    lab.write("floor.obj", "v -9 -1 -9\nv 9 -1 -9\nv 9 -1 9\nv -9 -1 9\nf 4 3 2 1\n");
    lab.ok("scan floor.obj --elevations -20,-20,1 --columns 12 --position 1,0.5,2 -o a.npz");
    let scan = Scan::read(&lab.path("a.npz")).unwrap();
    assert_eq!(scan.len(), 12);
    // The cone of beams meets the floor in a circle around the scanner, 1.5 below.
    let wide = 1.5 / 0.363_970_234_266_202_36;
    for point in doubles(&scan, "point").as_chunks::<3>().0 {
        assert!(((point[0] - 1.0).hypot(point[2] - 2.0) - wide).abs() < 1e-12);
        assert!((point[1] + 1.0).abs() < 1e-12);
    }
    // Azimuth 0 is along x.
    assert!((doubles(&scan, "point")[3 * 6] - 1.0 - wide).abs() < 1e-9);
}

#[test]
fn the_up_that_was_guessed_is_said() {
    let (lab, _) = lab();
    lab.write("floor.obj", "v 0 -1 0\nv 1 -1 0\nv 0 -1 1\nf 1 3 2\n");
    lab.write("pose.txt", "1 0 0 0\n0 1 0 0\n0 0 1 0\n");
    let scanner = "--elevations -20,20,3 --columns 8 -o a.npz";
    let outcome = lab.ok(&format!("scan floor.obj {scanner}"));
    assert!(outcome.stderr.ends_with("; guessed: up +y (--up)\n"), "{}", outcome.stderr);
    let outcome = lab.ok(&format!("scan floor.obj {scanner} --json"));
    assert_eq!(report(&outcome)["guessed"], json!(["up +y (--up)"]));
    for run in [
        "floor.obj --up 0,1,0",
        "floor.obj --pose pose.txt",
        "floor.obj --trajectory drive.csv",
        "room.toml",
    ] {
        let outcome = lab.ok(&format!("scan {run} {scanner}"));
        assert!(!outcome.stderr.contains("guessed"), "{run}");
    }
}

#[test]
fn every_format_holds_the_returns() {
    let (lab, _) = lab();
    let files = ["a.npz", "a.ply", "a.pcd", "a.las", "a.laz", "a.csv"];
    let outputs = files.map(|file| format!("-o {file}")).join(" ");
    let scan = format!(
        "scan room.toml --lidar vlp-16 --columns 36 --turns 2 --noise 0.01 --seed 1 {outputs}"
    );
    lab.ok(&scan);
    let bytes = files.map(|file| lab.read(file));
    let whole = Scan::read(&lab.path("a.npz")).unwrap();
    for (file, bytes) in files.iter().zip(&bytes) {
        let points = firsthit::image::points_of(file.as_ref(), bytes).unwrap();
        assert_eq!(points.positions.len(), whole.len());
        // As float32, or in steps of 1e-4.
        let most = if matches!(*file, "a.npz" | "a.ply" | "a.csv") { 0.0 } else { 0.51e-4 };
        let expected = doubles(&whole, "point");
        let found = points.positions.as_flattened();
        let off = found.iter().zip(expected).map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f64::max) <= most, "{file}");
    }
    // No day and no path is in them.
    lab.ok(&scan);
    assert_eq!(files.map(|file| lab.read(file)), bytes);
    // What is packed are the same points.
    let [las, laz] = ["a.las", "a.laz"].map(|file| {
        let points = firsthit::image::points_of(file.as_ref(), &lab.read(file)).unwrap();
        (points.positions, points.columns)
    });
    assert_eq!(las, laz);
}

#[test]
fn a_scan_that_meets_nothing_is_an_empty_cloud() {
    let (lab, _) = lab();
    let outcome =
        lab.ok("scan room.toml --lidar vlp-16 --position 99,0,9 --max-range 1 -o a.las -o a.laz");
    assert_eq!(
        outcome.stderr,
        "firsthit: warning: no beam met anything: the scanner starts at 99,0,9, the scene goes from -4,-3,-1 to 4,3,2, \
         and ranges of 0 to 1 count\na.las: 0 returns of 16 x 1808 beams\na.laz: 0 returns of 16 x 1808 beams\n"
    );
    for file in ["a.las", "a.laz"] {
        let points = firsthit::image::points_of(file.as_ref(), &lab.read(file)).unwrap();
        assert!(points.positions.is_empty());
    }
}

#[test]
#[expect(clippy::too_many_lines, reason = "a table")]
fn what_makes_no_sense_is_one_line_and_an_exit_code() {
    let (lab, _) = lab();
    lab.write("p.txt", "1 0 0 0\n0 1 0 0\n0 0 1 0\n");
    let rose = "--frequencies 1,2 --points 9 --point-rate 9";
    for (options, says) in [
        ("", "the following required arguments were not provided"),
        ("--lidar vlp-17", "a similar value exists: 'vlp-16'"),
        ("--lidar vlp-16 --pattern a.csv", "cannot be used with"),
        ("--lidar vlp-16 --turns 1 --duration 1", "cannot be used with"),
        ("--lidar vlp-16 --turns 0", "a whole number from 1 on"),
        ("--lidar vlp-16 --rate 0", "a positive number"),
        (
            "--lidar vlp-16 --duration 0.05",
            "--duration has 0.05 s, less than a turn of 0.1 s: say --turns or another --rate",
        ),
        ("--lidar vlp-16 --position 1,2", "three finite numbers"),
        ("--lidar vlp-16 --position 1,2,nan", "three finite numbers"),
        ("--lidar vlp-16 --azimuth-start 0", "--azimuth-start needs --elevations"),
        ("--elevations 5,-5,3", "LOW,HIGH,N"),
        ("--elevations -5,5,2.5", "a whole number of lasers"),
        ("--elevations -5,95,3", "elevations must be from -90 to 90 degrees"),
        ("--lidar vlp-16 --subrays 4", "--divergence"),
        ("--lidar vlp-16 --max-returns 4", "--max-returns needs --returns all"),
        ("--lidar vlp-16 --noise 0.1", "seed must be given with noise"),
        ("--lidar vlp-16 --seed 1", "--seed needs --noise or --dropout"),
        ("--lidar vlp-16 --duration 1e9", "fewer than 2^31 columns"),
        ("--lidar vlp-16 --duration 1e300", "fewer than 2^31 columns"),
        ("--lidar vlp-16 --turns 2 --noise 0.1 --seed 9223372036854775807", "leave a number"),
        ("--lidar vlp-16 --divergence -3", "divergence must be from 0"),
        ("--lidar vlp-16 --min-range 5 --max-range 4", "must be from 0 on and increase"),
        ("--lidar vlp-16 --class ball", "a name and a whole number from 0 to 255"),
        ("--lidar vlp-16 --class none=2", "there is no object \"none\""),
        ("--lidar vlp-16 --body forwards-left-up", "--trajectory"),
        ("--lidar vlp-16 --trajectory drive.csv --aim 1,0,0", "give a --pose"),
        ("--lidar vlp-16 --pose p.txt --position 0,0,0", "cannot be used with"),
        ("--lidar vlp-16 --aim 0,0,3", "directions that are not parallel"),
        ("--lidar vlp-16 --trajectory drive.csv --turns 9", "within the times of the trajectory"),
        ("--lidar vlp-16 --trajectory drive.csv --start 3.25", "less than a turn"),
        (
            "--lidar vlp-16 --trajectory drive.csv --trajectory-format tum",
            "--body must be given with --trajectory-format tum",
        ),
        ("--pattern room.toml --columns 8", "--columns must be left out with --pattern"),
        ("--pattern room.toml --flash", "--flash must be left out with --pattern"),
        ("--lidar vlp-16 --rows 8", "--rows needs --raster"),
        ("--lidar vlp-16 --points 8", "--points needs --rosette or --lissajous"),
        ("--raster 70,40 --rows 3", "--raster needs --columns"),
        ("--raster 70 --rows 3 --columns 4", "two finite numbers"),
        ("--raster 70,181 --rows 3 --columns 4", "vertical_fov must be above 0"),
        ("--raster 7,4 --rows 3 --columns 4 --duration 0.01", "a picture of 0.1 s"),
        (
            "--raster 70,40 --rows 3 --columns 4 --flash --serpentine",
            "--serpentine must be left out with --flash",
        ),
        ("--rosette 40 --points 9 --point-rate 9", "--rosette needs --frequencies"),
        (
            &format!("--rosette 40 {rose} --columns 3"),
            "--columns needs --lidar or --elevations or --raster",
        ),
        (&format!("--rosette 40 {rose} --phase 3"), "--phase needs --lissajous"),
        (&format!("--rosette 40 {rose} --share 3"), "a number from 0 to 1"),
        (
            &format!("--lissajous 9,9 {rose} --duration 0.5"),
            "less than the 1 s of 9 points: say --turns or fewer --points",
        ),
        ("--lidar vlp-16 -o a.txt", "--output must end in one of .npz, "),
        ("--lidar vlp-16 -o a.ply -o ./a.ply", "is named twice as an output"),
        ("--lidar vlp-16 --shade x", "unexpected argument '--shade'"),
    ] {
        lab.fails(&format!("scan room.toml {options}"), 2, says);
    }
    for (arguments, says) in [
        ("none.obj --lidar vlp-16", "none.obj"),
        ("drive.csv --lidar vlp-16", "drive.csv"),
        ("room.toml --lidar vlp-16 --trajectory none.csv", "none.csv"),
        ("room.toml --lidar vlp-16 --trajectory room.toml", "room.toml"),
        ("room.toml --pattern drive.csv", "drive.csv"),
        ("room.toml --lidar vlp-16 --pose drive.csv", "the 12 or 16 numbers of a 3 x 4"),
    ] {
        lab.fails(&format!("scan {arguments}"), 3, says);
    }
    lab.fails("scan room.toml --lidar vlp-16 -o none/a.ply", 4, "the folder does not exist");
}

#[test]
fn nothing_that_was_read_is_written_over() {
    let (lab, _) = lab();
    lab.write("beams.csv", "azimuth,elevation\n0,0\n90,0\n");
    lab.write("pose.csv", "1 0 0 0 0 1 0 0 0 0 1 0\n");
    for (arguments, name) in [
        ("room.toml --lidar vlp-16 --trajectory drive.csv -o drive.csv", "drive.csv"),
        ("room.toml --pattern beams.csv -o ./beams.csv", "beams.csv"),
        ("room.toml --lidar vlp-16 --pose pose.csv -o pose.csv", "pose.csv"),
    ] {
        let says = format!("{name} is an input; it will not be overwritten");
        lab.fails(&format!("scan {arguments}"), 2, &says);
    }
}
