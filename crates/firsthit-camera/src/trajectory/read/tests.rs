//! Every reader, on what it should read and on what it should not.

use std::path::Path;

use super::super::pose::Pose;
use super::TrajectoryFormat::{Csv, Kitti, Ros, Tum};
use super::*;
use crate::geometry::{DMat3, DQuat, DVec3};

const TUM: &str = "# ground truth\n1305031102.175304 1.5 -2 3e-1 0 0.6 0 0.8\n\n1305031102.2 0 0 0 0 0 0 1.0001\n";
const CSV: &str = "qw,QX,qy,qz,frame,Timestamp_NS,Z,Y,X\n\
    0.8,0,0.6,0,\"a,b\",1305031102175304000,0.3,-2,1.5\n1,0,0,0,,1305031102200000000,0,0,0\n";
const ROS: &str = "%time,field.header.seq,field.header.stamp,field.header.frame_id,field.child_frame_id,\
    field.pose.pose.position.x,field.pose.pose.position.y,field.pose.pose.position.z,\
    field.pose.pose.orientation.x,field.pose.pose.orientation.y,field.pose.pose.orientation.z,field.pose.pose.orientation.w,\
    field.pose.covariance0\n\
    1305031102999999999,7,1305031102175304000,odom,base,1.5,-2,0.3,0,0.6,0,0.8,0\n\
    1305031103000000000,8,1305031102200000000,odom,base,0,0,0,0,0,0,1,0\n";
const KITTI: &str = "1.000000e+00 0 0 1.5 0 0 -1 2.5 0 1.000000e+00 0 -3\r\n\
    0.28 -9.600001e-01 0 4 0.96 0.28 0 5 0 0 1 6\r\n";

fn path() -> &'static Path {
    Path::new("poses.txt")
}

fn refused(format: TrajectoryFormat, text: impl AsRef<[u8]>) -> String {
    format.read(text.as_ref(), path()).unwrap_err().to_string()
}

fn is_near(found: &Pose, position: [f64; 3], rotation: [f64; 4]) -> bool {
    let rotation = DQuat::from_array(rotation);
    found.position == DVec3::from_array(position)
        && (found.rotation - rotation).length() < 4.0 * f64::EPSILON
}

#[test]
fn the_same_poses_are_read_from_each_format() {
    for (format, text) in [
        (Tum, TUM.to_owned()),
        (Csv, CSV.to_owned()),
        (Ros, ROS.to_owned()),
        (Ros, ROS.replace("pose.pose", "pose")),
        (
            Ros,
            ROS.replace("field.header.stamp", "field.x")
                .replace("2999999999", "2175304000")
                .replace("3000000000", "2200000000"),
        ),
        (Csv, CSV.replace('\n', "\r\n")),
        (Csv, format!("\u{feff}{}", CSV.replace('\n', "\r"))),
        (Tum, format!("\u{feff}{}", TUM.trim_end())),
    ] {
        let trajectory = format.read(text.as_bytes(), path()).unwrap();
        // Nanoseconds are rounded once, to the same float64 as the decimal.
        assert_eq!(trajectory.times(), [1_305_031_102.175_304, 1_305_031_102.2]);
        let [first, second] = trajectory.poses() else {
            panic!("{format:?}: {trajectory:?}");
        };
        assert!(is_near(first, [1.5, -2.0, 0.3], [0.0, 0.6, 0.0, 0.8]));
        assert_eq!(*second, Pose::IDENTITY);
    }
}

#[test]
fn times_of_csv_are_in_the_unit_of_their_name() {
    for (name, time, seconds) in [
        ("time", "0.25", 0.25),
        ("T", "+2.5e-1", 0.25),
        ("timestamp", "-1", -1.0),
        ("t_s", "3", 3.0),
        ("time_ms", "250.5", 0.2505),
        ("timestamp_us", "7", 7e-6),
        ("t_ns", "1.305031102175304e18", 1_305_031_102.175_304),
        // A division of the float64 nearest to it comes to its neighbour.
        ("t_ns", "1305031102175310006", 1_305_031_102.175_31),
    ] {
        let text = format!("x,y,z,{name},qx,qy,qz,qw\n1,2,3,{time},0,0,0,1\n");
        let trajectory = read_csv(text.as_bytes(), path()).unwrap();
        assert_eq!(trajectory.times(), [seconds], "{name}");
    }
}

#[test]
fn kitti_has_ten_poses_a_second_or_the_times_that_are_given() {
    let trajectory = read_kitti(KITTI.as_bytes(), path(), None).unwrap();
    assert_eq!(trajectory.times(), [0.0, 0.1]);
    // A quarter of a turn about x takes y to z.
    let quarter = 0.5_f64.sqrt();
    assert!(is_near(&trajectory.poses()[0], [1.5, 2.5, -3.0], [quarter, 0.0, 0.0, quarter]));
    // An angle of the tangent 24/7, of which the sine of the half is 0.6.
    let second = trajectory.poses()[1];
    assert!((second.rotation - DQuat::from_xyzw(0.0, 0.0, 0.6, 0.8)).length() < 1e-6);
    let times = read_kitti_times(b"0.000000e+00\n1.038690e-01\n", Path::new("times.txt")).unwrap();
    let trajectory = read_kitti(KITTI.as_bytes(), path(), Some(&times)).unwrap();
    assert_eq!(trajectory.times(), [0.0, 0.103_869]);
    let error = read_kitti(KITTI.as_bytes(), path(), Some(&[1.0])).unwrap_err();
    assert_eq!(error.to_string(), "times must be as many as poses, got 1 for 2 poses");
    let error = read_kitti_times(b"0\n0\n", Path::new("times.txt")).unwrap_err();
    assert_eq!(
        error.to_string(),
        "times.txt:2:1: time 0 s is not after 0 s, that of the line before"
    );
}

/// The nearest rotation maximises the trace of its product with the matrix: no rotation beside it
/// does better.
#[test]
fn the_rotation_that_is_nearest_to_a_matrix_is_taken() {
    let rotation = super::super::rotation::exp(DVec3::new(0.4, -1.2, 2.0));
    let skew = DMat3::from_cols_array(&[3.0, -2.0, 1.0, 0.5, -4.0, 2.0, 1.0, 3.0, 2.0]);
    let matrix = DMat3::from_quat(rotation) + 1e-5 * skew;
    let rows = matrix.transpose().to_cols_array();
    let row = |k: usize| format!("{:?} {:?} {:?} 0", rows[k], rows[k + 1], rows[k + 2]);
    let text = [row(0), row(3), row(6)].join(" ");
    let found = read_kitti(text.as_bytes(), path(), None).unwrap().poses()[0].rotation;
    // So the product of the inverse and the matrix is symmetric.
    let rest = DMat3::from_quat(found).transpose() * matrix;
    let off = (rest - rest.transpose()).to_cols_array();
    assert!(off.iter().all(|x| x.abs() < 4.0 * f64::EPSILON), "{off:?}");
    assert!((found - rotation).length() > 1e-6);
}

/// Texts with a mistake each, and what is said of it.
#[rustfmt::skip]
const MISTAKES: &[(TrajectoryFormat, &str, &str)] = &[
    (Tum, "", ": there are no poses in it"),
    (Tum, "# nothing\n", ": there are no poses in it"),
    (Tum, "0 1 2 3\n", ":1: expected 8 numbers (timestamp tx ty tz qx qy qz qw), got 4"),
    (Tum, "0 1 2 3 0 0 0 1 9\n", ":1: expected 8 numbers (timestamp tx ty tz qx qy qz qw), got 9"),
    (Tum, "\n 0 1 2 é 0 0 0 1\n", ":2:8: 'é' is not a finite number within 1e150"),
    (Tum, "0 é 0 é 0 0 0 1\n", ":1:3: 'é' is not a finite number within 1e150"),
    (Tum, "0 0 0 0 0 0 0 1\r\n1 nan 0 0 0 0 0 1",
        ":2:3: 'nan' is not a finite number within 1e150"),
    (Tum, "1e400 0 0 0 0 0 0 1\n", ":1:1: '1e400' is not a finite number within 1e150"),
    (Tum, "0 0 0 0 0 0 0.5 0.5\n",
        ":1:9: the quaternion has the length 0.7071067811865476, not 1 within 0.001"),
    (Tum, "0 0 0 0 0 0 0 1\n0 0 0 0 0 0 0 1\n",
        ":2:1: time 0 s is not after 0 s, that of the pose before"),
    (Csv, "", ": there are no poses in it"),
    (Csv, "time,x,y,z,qx,qy,qz,qw\n", ": there are no poses in it"),
    (Csv, "0,0,0,0,0,0,0,1\n",
        ":1: there is no column time or t or timestamp; the first line is the header"),
    (Csv, "t,x,y,z,qx,qy,qz\n", ":1: there is no column qw; the first line is the header"),
    (Csv, "t,x,Time,z,qx,qy,qz\n",
        ":1:5: the columns 't' and 'Time' are for the same; one of them is expected"),
    (Csv, "t,x,y,X,z,qx,qy,qz\n",
        ":1:7: the columns 'x' and 'X' are for the same; one of them is expected"),
    (Csv, "time,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0\n",
        ":2: expected 8 columns, as in the header, got 7"),
    (Csv, "time,x,y,z,qx,qy,qz,qw\n0, 0,\"x\" ,0,0,0,0,1\n",
        ":2:7: 'x' is not a finite number within 1e150"),
    (Csv, "time,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,\n",
        ":2:15: '' is not a finite number within 1e150"),
    (Csv, "t_ns,x,y,z,qx,qy,qz,qw\ninf,0,0,0,0,0,0,1",
        ":2:1: 'inf' is not a finite number within 1e150"),
    (Ros, "%time,field.data\n0,1\n",
        ":1: there is no column field.pose.position.x or field.pose.pose.position.x or field.transform.translation.x \
            or field.position.x; the first line is the header"),
    (Ros, "field.pose.position.x\n",
        ":1: there is no column field.header.stamp or %time; the first line is the header"),
    (Kitti, "1 0 0 0 0 1 0 0 0 0 1\n",
        ":1: expected 12 numbers (the rows of a 3 x 4 matrix), got 11"),
    (Kitti, "1 0 0 0 0 1 0 0 0 0 1.001 0\n",
        ":1: the matrix is not a rotation: the products of its columns are off by 2.00e-3, \
            at most 0.0001 is expected"),
    (Kitti, "1 0 0 0 0 1 0 0 0 0 -1 0\n", ":1: the matrix is not a rotation: it mirrors"),
];

#[test]
fn mistakes_are_told_with_their_line_and_column() {
    for &(format, text, expected) in MISTAKES {
        let error = refused(format, text);
        assert_eq!(error, format!("poses.txt{expected}"), "{text:?}");
    }
    let utf16 = refused(Tum, b"\xff\xfe0\0 \0");
    assert_eq!(utf16, "poses.txt: the text is UTF-16; save it as UTF-8");
}

#[test]
fn long_and_hidden_texts_make_short_messages() {
    let word = "\u{1b}[2J".repeat(100_000);
    let error = refused(Tum, format!("{word} 0 0 0 0 0 0 1"));
    assert!(error.len() < 800 && !error.contains('\u{1b}'), "{error}");
    let many = refused(Kitti, "1 ".repeat(1_000_000));
    assert!(many.ends_with("got 1000000"), "{many}");
}

#[test]
fn no_text_crashes_a_reader() {
    let pieces: [&[u8]; 12] = [
        b"nan",
        b"-inf",
        b"1e400",
        b",",
        b"\"",
        b"\n",
        b"\r",
        b"\xff",
        b"\xef\xbb\xbf",
        b"#",
        b" ",
        b"9",
    ];
    let mut state = 1_u64;
    let mut random = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        usize::try_from(state >> 33).unwrap() % below
    };
    let mut read = 0;
    for text in [TUM, CSV, ROS, KITTI] {
        for _ in 0..500 {
            let mut bytes = text.as_bytes().to_vec();
            for _ in 0..=random(2) {
                let (at, piece) = (random(bytes.len()), pieces[random(pieces.len())]);
                let end = (at + random(3)).min(bytes.len());
                bytes.splice(at..end, piece.iter().copied());
            }
            if random(4) == 0 {
                bytes.truncate(random(bytes.len()));
            }
            for &format in TrajectoryFormat::ALL {
                if let Ok(trajectory) = format.read(&bytes, path()) {
                    assert!(trajectory.at(trajectory.start()).is_ok());
                    read += 1;
                }
            }
        }
    }
    assert!(read > 100, "{read}: hardly anything was read");
}

#[test]
fn what_is_written_is_read_as_the_same_bits() {
    let poses = (0..50).map(|k| {
        let k = f64::from(k);
        let vector = DVec3::new(k * 0.37 % 3.0, k * 0.91 % 2.0, k * 0.13 % 1.0);
        let position = DVec3::new(k / 3.0, -1e-7 * k, 1e20 * k + 0.1);
        Pose { position, rotation: super::super::rotation::exp(vector) }
    });
    let times = (0..50).map(|k| 1.7e9 + f64::from(k) / 7.0).collect();
    let trajectory = Trajectory::new(times, poses.collect()).unwrap();
    let (mut tum, mut csv) = (Vec::new(), Vec::new());
    trajectory.write_tum(&mut tum).unwrap();
    trajectory.write_csv(&mut csv).unwrap();
    assert_eq!(read_tum(&tum, path()).unwrap(), trajectory);
    assert_eq!(read_csv(&csv, path()).unwrap(), trajectory);
}
