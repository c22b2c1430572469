//! Trajectories beside closed forms.

use std::f64::consts::PI;

use super::rotation::exp;
use super::*;
use crate::geometry::DQuat;

/// Positions are below 10 and angles below 7: a few dozen roundings.
const ROUNDING: f64 = 1e-13;

fn turn(from: DQuat, to: DQuat) -> DVec3 {
    log(from.conjugate() * to)
}

fn pose(position: [f64; 3], rotation: DQuat) -> Pose {
    let position = DVec3::from_array(position);
    Pose { position, rotation }
}

/// Irregular times, positions without order, turns of 20 to 150 degrees about any axes.
fn wild() -> Trajectory {
    let times = vec![-3.0, -2.5, 0.0, 0.125, 1.0, 4.0, 4.5];
    let poses = (0..7).map(|k| {
        let k = f64::from(k);
        let [x, y, z] = [k * 2.7 % 5.0, k * 1.9 % 3.0 - 1.0, k * 3.1 % 4.0];
        let vector = DVec3::new(k * 0.9 % 2.0 - 1.0, k * 1.3 % 2.0, k * 0.7 % 1.0);
        pose([x, y, z], exp(vector))
    });
    Trajectory::new(times, poses.collect()).unwrap()
}

fn kinds() -> impl Iterator<Item = (Interpolation, Trajectory)> {
    let kinds = Interpolation::ALL.iter();
    kinds.map(|&kind| (kind, wild().interpolated(kind).unwrap()))
}

#[test]
fn poses_are_met_bit_for_bit_and_come_up_to_without_a_jump() {
    for (kind, trajectory) in kinds() {
        let knots = trajectory.times().iter().zip(trajectory.poses());
        for (&time, &knot) in knots {
            assert_eq!(trajectory.at(time).unwrap(), knot, "{kind:?}");
            for near in [time.next_up(), time.next_down()] {
                let Ok(near) = trajectory.at(near) else {
                    continue;
                };
                // Speeds are below 100.
                assert!((near.position - knot.position).length() < ROUNDING);
                assert!(turn(near.rotation, knot.rotation).length() < ROUNDING);
            }
        }
    }
}

#[test]
fn linear_turns_at_a_constant_angular_velocity() {
    // Slerp in closed form: the axis is fixed, and the angle grows with time.
    let axis = DVec3::new(1.0, 2.0, -2.0) / 3.0;
    let start = exp(DVec3::new(0.2, 0.5, -0.3));
    for angle in [1e-12, 1e-3, 1.0, 3.0, PI - 1e-9] {
        let end = exp(angle * axis) * start;
        let ends = [pose([0.0; 3], start), pose([1.0, 2.0, 3.0], end)];
        let trajectory = Trajectory::new(vec![5.0, 7.0], ends.to_vec()).unwrap();
        for step in 0..=16 {
            let s = f64::from(step) / 16.0;
            let found = trajectory.at(5.0 + 2.0 * s).unwrap();
            let (sine, cosine) = libm::sincos(0.5 * s * angle);
            let DVec3 { x, y, z } = sine * axis;
            let expected = DQuat::from_xyzw(x, y, z, cosine) * start;
            assert!(turn(found.rotation, expected).length() < 1e-15 + 4e-16 * angle);
            assert!((found.position - s * DVec3::new(1.0, 2.0, 3.0)).length() < 2e-15);
        }
    }
}

#[test]
fn the_short_way_is_taken_whatever_the_signs() {
    let end = exp(DVec3::new(0.0, 0.0, 1.0));
    for interpolation in Interpolation::ALL {
        let ends = [DQuat::IDENTITY, -end, end * end, -(end * end * end)];
        let poses = ends.map(|rotation| pose([0.0; 3], rotation));
        let trajectory = Trajectory::new(vec![0.0, 1.0, 2.0, 3.0], poses.to_vec()).unwrap();
        let trajectory = trajectory.interpolated(*interpolation).unwrap();
        for step in 0..=30 {
            let time = 0.1 * f64::from(step);
            let found = trajectory.at(time.min(3.0)).unwrap().rotation;
            let expected = exp(DVec3::new(0.0, 0.0, time));
            assert!((found - expected).length() < 1e-14, "{time}");
        }
    }
}

/// A body that drives round a circle and climbs: a screw about the line through (2, 3) along z.
#[test]
fn se3_drives_round_the_circle_that_linear_cuts() {
    let at = |time: f64| {
        let (sine, cosine) = libm::sincos(time);
        let position = [2.0 + 4.0 * cosine, 3.0 + 4.0 * sine, 0.5 * time];
        pose(position, exp(DVec3::new(0.0, 0.0, time)) * exp(DVec3::ONE))
    };
    let times: Vec<f64> = vec![0.0, 1.0, 3.5, 4.0, 7.0];
    let poses: Vec<Pose> = times.iter().map(|&time| at(time)).collect();
    let linear = Trajectory::new(times, poses).unwrap();
    let se3 = linear.clone().interpolated(Interpolation::Se3).unwrap();
    let mut worst = 0.0_f64;
    for step in 0..=140 {
        let time = 0.05 * f64::from(step);
        let (found, expected) = (se3.at(time).unwrap(), at(time));
        assert!((found.position - expected.position).length() < ROUNDING, "{time}");
        assert!(turn(found.rotation, expected.rotation).length() < ROUNDING, "{time}");
        let off = linear.at(time).unwrap().position - expected.position;
        worst = worst.max(off.length());
    }
    // The chord of 3 radians is that far off: `4 (1 - cos 1.5)`.
    assert!(worst > 3.0, "{worst}");
}

#[test]
fn splines_reproduce_straight_lines_and_steady_turns() {
    let axis = DVec3::new(0.6, 0.0, -0.8);
    let at = |time: f64| {
        let position = [1.0 - 2.0 * time, 3.0 * time, 0.1 * time];
        pose(position, exp(DVec3::new(1.0, -1.0, 0.3)) * exp(0.5 * time * axis))
    };
    let times = vec![0.0, 0.25, 0.3, 1.0, 2.0];
    let poses = times.iter().map(|&time| at(time)).collect();
    let trajectory = Trajectory::new(times, poses).unwrap();
    let trajectory = trajectory.interpolated(Interpolation::Spline).unwrap();
    for step in 0..=40 {
        let time = 0.05 * f64::from(step);
        let (found, expected) = (trajectory.at(time).unwrap(), at(time));
        assert!((found.position - expected.position).length() < ROUNDING);
        assert!(turn(found.rotation, expected.rotation).length() < ROUNDING);
    }
}

/// About one axis the rotations are those of the spline of their angles, so each is a judge of the
/// other.
#[test]
fn splines_turn_about_one_axis_as_they_move_along_one() {
    let angles = [0.0, 1.0, 0.5, 2.0, 3.5, 3.0];
    let times = vec![0.0, 1.0, 1.5, 3.0, 5.0, 6.0];
    let poses = angles.map(|angle| pose([angle, 0.0, 0.0], exp(angle * DVec3::Y)));
    let trajectory = Trajectory::new(times, poses.to_vec()).unwrap();
    let trajectory = trajectory.interpolated(Interpolation::Spline).unwrap();
    for step in 0..=120 {
        let found = trajectory.at(0.05 * f64::from(step)).unwrap();
        let expected = exp(found.position.x * DVec3::Y);
        assert!(turn(found.rotation, expected).length() < ROUNDING, "{step}");
    }
}

/// The mean acceleration and the mean angular velocities on both sides of a time.
fn around(trajectory: &Trajectory, time: f64, step: f64) -> [DVec3; 4] {
    let at = |k: f64| trajectory.at(time + k * step).unwrap();
    let acceleration = |a: f64, b: f64, c: f64| {
        let [a, b, c] = [a, b, c].map(|k| at(k).position);
        (a - 2.0 * b + c) / (step * step)
    };
    let rate = |a: f64, b: f64| turn(at(a).rotation, at(b).rotation) / step;
    [acceleration(-2.0, -1.0, 0.0), acceleration(0.0, 1.0, 2.0), rate(-1.0, 0.0), rate(0.0, 1.0)]
}

#[test]
fn splines_have_a_continuous_acceleration_and_angular_velocity() {
    // Differences are off by the next derivative times the step, and by roundings over its square.
    // The third derivative of the positions is below 3e3 and the angular acceleration below 3e2;
    // both jump at the knots.
    let step = 1e-5;
    let bounds = [3e3 * 2.0 * step + 1e-14 / (step * step), 3e2 * step];
    let spline = wild().interpolated(Interpolation::Spline).unwrap();
    let inner = |trajectory: &Trajectory| trajectory.times()[1..6].to_vec();
    for time in inner(&spline) {
        let [before, after, turned, turns] = around(&spline, time, step);
        assert!((before - after).length() < bounds[0], "{time} {before} {after}");
        assert!((turned - turns).length() < bounds[1], "{time} {turned} {turns}");
    }
    // The ends do not bend.
    let [_, start, ..] = around(&spline.clone().extrapolated(Extrapolation::Hold), -3.0, step);
    assert!(start.length() < bounds[0], "{start}");
    // The other kinds have corners, which this finds.
    let linear = wild();
    for time in inner(&linear) {
        let [_, _, turned, turns] = around(&linear, time, step);
        assert!((turned - turns).length() > 10.0 * bounds[1], "{time}");
    }
}

#[test]
fn rotations_between_poses_have_length_one() {
    for (kind, trajectory) in kinds() {
        for step in 0..=750 {
            let time = -3.0 + 0.01 * f64::from(step);
            let square = trajectory.at(time.min(4.5)).unwrap().rotation.length_squared();
            assert!((square - 1.0).abs() < 8.0 * f64::EPSILON, "{kind:?} {time}");
        }
    }
}

#[test]
fn one_pose_is_a_place_and_two_are_a_line() {
    let [here, there] = [[1.0, 2.0, 3.0], [5.0, 2.0, 3.0]].map(|p| pose(p, DQuat::IDENTITY));
    for &kind in Interpolation::ALL {
        let one = Trajectory::new(vec![2.0], vec![here]).unwrap();
        let one = one.interpolated(kind).unwrap();
        assert_eq!(one.at(2.0).unwrap(), here);
        assert!(one.at(2.5).is_err());
        let one = one.extrapolated(Extrapolation::Hold);
        for time in [f64::NEG_INFINITY, 0.0, 2.0, 1e300, f64::INFINITY] {
            assert_eq!(one.at(time).unwrap(), here);
        }
        assert!(one.at(f64::NAN).is_err());
        let two = Trajectory::new(vec![0.0, 4.0], vec![here, there]).unwrap();
        let two = two.interpolated(kind).unwrap();
        assert_eq!(two.at(1.0).unwrap(), pose([2.0, 2.0, 3.0], DQuat::IDENTITY));
    }
}

#[test]
fn times_outside_are_refused_by_name_or_held() {
    let trajectory = wild();
    let error = trajectory.at(4.6).unwrap_err().to_string();
    let expected =
        "time must be within the times of the trajectory, got 4.6, which is not from -3 to 4.5";
    assert_eq!(error, expected);
    let held = trajectory.extrapolated(Extrapolation::Hold);
    assert_eq!(held.at(1e9).unwrap(), held.poses()[6]);
    assert_eq!(held.at(-1e9).unwrap(), held.poses()[0]);
}

#[test]
fn what_is_no_trajectory_is_refused_with_its_index() {
    let refused = |times: &[f64], poses: &[Pose]| {
        let result = Trajectory::new(times.to_vec(), poses.to_vec());
        result.unwrap_err().to_string()
    };
    let fine = Pose::IDENTITY;
    assert_eq!(refused(&[], &[]), "poses must be at least one, got 0");
    let error = refused(&[1.0, 2.0], &[fine]);
    assert_eq!(error, "times must be as many as poses, got 2 for 1 poses");
    let error = refused(&[0.0, 2.0, 2.0], &[fine; 3]);
    assert_eq!(error, "times must be strictly increasing, got 2 at index 2 after 2");
    let error = refused(&[0.0, f64::NAN], &[fine; 2]);
    assert_eq!(error, "times must be finite, within 1e150, got NaN at index 1");
    let error = refused(&[0.0, 1.0], &[fine, pose([0.0, f64::INFINITY, 0.0], fine.rotation)]);
    assert_eq!(error, "positions must be finite, within 1e150, got [0, inf, 0] at index 1");
    let error = refused(&[0.0], &[pose([0.0; 3], fine.rotation * 1.01)]);
    assert!(error.starts_with("rotations must be quaternions of length one"), "{error}");
}

#[test]
fn splines_whose_rates_leave_float64_are_refused_and_all_others_are_finite() {
    let places = [0.0, 1e150, -1e150].map(|x| pose([x, 0.0, 0.0], DQuat::IDENTITY));
    let sudden = Trajectory::new(vec![0.0, 1e-200, 1.0], places.to_vec()).unwrap();
    let error = sudden.interpolated(Interpolation::Spline).unwrap_err();
    assert!(error.to_string().contains("far enough apart"), "{error}");
    for times in [[-1e150, 0.0, 1e150], [0.0, 1e-40, 1.0], [0.0, 1.0, 1e50]] {
        for &kind in Interpolation::ALL {
            let trajectory = Trajectory::new(times.to_vec(), places.to_vec()).unwrap();
            let trajectory = trajectory.interpolated(kind).unwrap();
            for s in [0.1, 0.5, 0.9] {
                for pair in times.windows(2) {
                    let found = trajectory.at(pair[0] + s * (pair[1] - pair[0])).unwrap();
                    assert!(found.position.is_finite() && found.rotation.is_finite());
                }
            }
        }
    }
}
