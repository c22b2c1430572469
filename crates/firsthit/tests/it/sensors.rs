//! Sensors other than cameras, against closed forms, brute force and the same rays in arrays.

use firsthit::channel::kind;
use firsthit::image::Metadata;
use firsthit::render::{Picture, Region};
use firsthit::sensor::{
    Lidar, LidarModel, Pattern, Pushbroom, RaySensor, Readout, Record, RollingShutter, Sensor,
    Spinning,
};
use firsthit::shoot::{BruteForce, First, trace, trace_with};
use firsthit::trajectory::{Extrapolation, Interpolation};
use firsthit::{
    Camera, Cuboid, DQuat, DVec2, DVec3, Object, Pose, Ray, Rays, Scene, Shader, Trajectory, View,
    example,
};

/// A drive along a curve that turns, from 0 to 1 second.
fn drive() -> Trajectory {
    let pose = |k: f64| {
        let turn = DQuat::from_rotation_z(0.2 * k) * DQuat::from_rotation_x(-0.1 * k);
        Pose::new(DVec3::new(0.3 * k, 0.1 * k * k, 0.05 * k), turn).unwrap()
    };
    let times = vec![0.0, 0.4, 0.7, 1.0];
    let poses = [0.0, 1.0, 2.0, 3.0].map(pose).to_vec();
    let drive = Trajectory::new(times, poses).unwrap();
    drive.interpolated(Interpolation::Spline).unwrap()
}

fn small_camera() -> Camera {
    let camera = example::camera(12, 16).unwrap();
    camera.starting_at(firsthit::RayStart::Eye)
}

/// One of each sensor that is no camera, all of which look at the example.
fn sensors() -> Vec<Box<dyn Sensor>> {
    let camera = small_camera();
    let row = camera.resize(1, 20).unwrap();
    let times = (0..12).map(|k| f64::from(k) / 11.0).collect();
    let rolling = |direction| RollingShutter::new(&camera, &drive(), 0.0, 1.0, direction).unwrap();
    let pattern = LidarModel::Vlp16.pattern(10.0, Some(12), 0.0).unwrap();
    let beside = Pose::new(camera.position(), DQuat::from_rotation_z(0.3)).unwrap();
    vec![
        Box::new(RaySensor::of(&camera).unwrap()),
        Box::new(rolling(Readout::TopDown)),
        Box::new(rolling(Readout::RightLeft)),
        Box::new(Pushbroom::new(&row, &drive(), times).unwrap()),
        Box::new(Lidar::new(pattern.clone(), beside).unwrap()),
        Box::new(Lidar::carried(pattern, beside, &drive()).unwrap()),
    ]
}

#[test]
fn every_sensor_has_the_hits_of_brute_force_and_of_the_same_rays_in_an_array() {
    let scene = example::scene().unwrap();
    for sensor in sensors() {
        let hits = trace(&scene, &*sensor, First, &()).unwrap();
        let slow = trace_with(&BruteForce, &scene, &*sensor, First, &()).unwrap();
        let rays: Vec<Ray> = (0..sensor.len()).map(|k| sensor.ray(k)).collect();
        let others = trace(&scene, &rays, First, &()).unwrap();
        let table = RaySensor::of(&*sensor).unwrap();
        let of_table = trace(&scene, &table, First, &()).unwrap();
        let met = hits.object.iter().filter(|&&object| object >= 0).count();
        assert!(met > 50, "{met} of {sensor:?}");
        for others in [slow, others, of_table] {
            assert_eq!(hits.object, others.object, "{sensor:?}");
            assert_eq!(hits.primitive, others.primitive, "{sensor:?}");
            let bits = |t: &[f64]| t.iter().map(|t| t.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&hits.t), bits(&others.t), "{sensor:?}");
        }
    }
}

#[test]
fn the_ray_of_every_pixel_is_the_one_at_its_centre_and_distances_are_from_its_start() {
    for sensor in sensors() {
        for pixel in 0..sensor.len() {
            let ray = sensor.ray(pixel);
            assert_eq!(ray, sensor.ray_within(pixel, DVec2::splat(0.5)));
            assert!((ray.direction.length() - 1.0).abs() < 1e-15);
            let [range, z] = sensor.range_and_z(pixel, 3.0);
            assert!((range - 3.0).abs() < 1e-14, "{sensor:?}");
            assert_eq!(sensor.range_and_z(pixel, f64::INFINITY)[0], f64::INFINITY);
            assert_eq!(z.is_nan(), !sensor.has_aim());
            let (position, aim) = sensor.place(pixel);
            assert!((range - (ray.at(3.0) - position).length()).abs() < 1e-14);
            assert!(aim.is_none_or(|aim| (z - (ray.at(3.0) - position).dot(aim)).abs() < 1e-14));
        }
    }
}

/// A camera that stands at the origin, looks along -z, and has square pixels.
fn plain_camera(rows: usize, columns: usize) -> Camera {
    let lens = firsthit::Lens::Flat(firsthit::Viewplane {
        focal_length: 1.0,
        width: 2.0,
        height: 2.0 * rows as f64 / columns as f64,
        ray_start: firsthit::RayStart::Eye,
        ..firsthit::Viewplane::default()
    });
    let view = View { rows, columns, lens, ..View::default() };
    Camera::new(view).unwrap()
}

/// To the right at `speed`, from a point, for 2 seconds from 10 on.
fn straight(from: DVec3, velocity: DVec3) -> Trajectory {
    let pose = |time: f64| Pose { position: from + time * velocity, ..Pose::IDENTITY };
    Trajectory::new(vec![10.0, 12.0], vec![pose(0.0), pose(2.0)]).unwrap()
}

/// A wall to the right of a vertical edge at x = 0, ten units ahead.
fn edge() -> Scene {
    let wall = Cuboid::new(DVec3::new(0.0, -50.0, -11.0), DVec3::new(50.0, 50.0, -10.0)).unwrap();
    Scene::new(vec![Object::new(wall)]).unwrap()
}

/// The camera is at `x = speed (time - 10)`. The edge at x = 0, ten units ahead, is then seen at
/// the column `columns / 2 * (1 - x / 10)`: the picture of a vertical edge is a straight line that
/// leans.
#[test]
fn a_rolling_shutter_shears_a_vertical_edge_exactly() {
    let (rows, columns, speed) = (40, 64, 2.5);
    let scene = edge();
    let camera = plain_camera(rows, columns);
    let body = straight(DVec3::ZERO, DVec3::new(speed, 0.0, 0.0));
    for (direction, first_last) in [(Readout::TopDown, [0.0, 1.0]), (Readout::BottomUp, [1.0, 0.0])]
    {
        let sensor = RollingShutter::new(&camera, &body, 10.5, 1.2, direction).unwrap();
        let hits = trace(&scene, &sensor, First, &()).unwrap();
        for row in 0..rows {
            let share = (row as f64 + 0.5) / rows as f64;
            let share = first_last[0] + share * (first_last[1] - first_last[0]);
            let time = 10.5 + 1.2 * share;
            let x = speed * (time - 10.0);
            let column_of_edge = 0.5 * columns as f64 * (1.0 - x / 10.0);
            for column in 0..columns {
                let pixel = row * columns + column;
                assert!((sensor.time(pixel).unwrap() - time).abs() < 1e-14);
                let is_wall = hits.object[pixel] >= 0;
                let off = column as f64 + 0.5 - column_of_edge;
                // No centre is so near the edge that rounding could tell.
                assert!(off.abs() > 1e-9);
                assert_eq!(is_wall, off > 0.0, "{direction:?} {row} {column}");
                if is_wall {
                    let [range, z] = sensor.range_and_z(pixel, hits.t[pixel]);
                    assert!((z - 10.0).abs() < 1e-13);
                    let from = DVec3::new(x, 0.0, 0.0);
                    let point = sensor.ray(pixel).at(hits.t[pixel]);
                    assert!((range - (point - from).length()).abs() < 1e-13);
                }
            }
        }
    }
}

/// Columns that are read out one after the other, while the camera drives along them, stretch the
/// wall.
#[test]
fn columns_read_out_sideways_have_their_own_times() {
    let camera = plain_camera(4, 10);
    let body = straight(DVec3::ZERO, DVec3::X);
    for (direction, times) in
        [(Readout::LeftRight, [0.05, 0.95]), (Readout::RightLeft, [0.95, 0.05])]
    {
        let sensor = RollingShutter::new(&camera, &body, 10.0, 1.0, direction).unwrap();
        for row in 0..4 {
            for (column, time) in [(0, times[0]), (9, times[1])] {
                let pixel = row * 10 + column;
                assert!((sensor.time(pixel).unwrap() - 10.0 - time).abs() < 1e-14);
                assert!((sensor.ray(pixel).origin.x - time).abs() < 1e-14);
            }
        }
    }
}

#[test]
fn a_rolling_shutter_that_does_not_move_is_its_camera_bit_for_bit() {
    let camera = small_camera();
    let still = Trajectory::new(vec![0.0, 1.0], vec![Pose::IDENTITY; 2]).unwrap();
    for &direction in Readout::ALL {
        let sensor = RollingShutter::new(&camera, &still, 0.0, 1.0, direction).unwrap();
        for pixel in 0..sensor.len() {
            assert_eq!(sensor.ray(pixel), Rays::ray(&camera, pixel));
        }
        for offset in [DVec2::new(0.1, 0.9), DVec2::ZERO] {
            assert_eq!(sensor.ray_within(77, offset), Sensor::ray_within(&camera, 77, offset));
        }
    }
}

/// It flies over the wall's edge, which is then a horizontal line of the picture, where the closed
/// form says.
#[test]
fn a_pushbroom_sees_each_row_at_its_time() {
    let wall = Cuboid::new(DVec3::new(-50.0, 0.0, -11.0), DVec3::new(50.0, 50.0, -10.0)).unwrap();
    let scene = Scene::new(vec![Object::new(wall)]).unwrap();
    let body = straight(DVec3::new(0.0, -1.0, 0.0), DVec3::Y);
    let times: Vec<f64> = (0..100).map(|k| 10.0 + 0.02 * f64::from(k)).collect();
    let sensor = Pushbroom::new(&plain_camera(1, 8), &body, times.clone()).unwrap();
    assert_eq!(sensor.shape(), [100, 8]);
    let hits = trace(&scene, &sensor, First, &()).unwrap();
    for (row, time) in times.iter().enumerate() {
        for column in 0..8 {
            let pixel = row * 8 + column;
            assert_eq!(sensor.time(pixel), Some(*time));
            // Row 50 is at the edge itself.
            if row != 50 {
                assert_eq!(hits.object[pixel] >= 0, row > 50, "{row}");
            }
        }
    }
    let error = Pushbroom::new(&plain_camera(2, 8), &body, times).unwrap_err();
    assert_eq!(error.to_string(), "camera must be one of a single row of pixels, got 2");
}

#[test]
fn a_spinning_lidar_in_a_room_has_the_ranges_of_the_closed_form() {
    let half = DVec3::new(4.0, 3.0, 2.0);
    let room = Cuboid::new(-half, half).unwrap();
    let scene = Scene::new(vec![Object::new(room)]).unwrap();
    let at = DVec3::new(1.0, -0.5, 0.25);
    let elevations: Vec<f64> = (0..40).map(|k| -70.0 + 3.5 * f64::from(k)).collect();
    let head = Spinning {
        elevations: elevations.clone(),
        columns: 360,
        azimuth_start: 30.0,
        azimuth_end: 30.0,
        ..Spinning::default()
    };
    let pattern = Pattern::spinning(&head).unwrap();
    let pose = Pose::new(at, DQuat::IDENTITY).unwrap();
    let lidar = Lidar::new(pattern, pose).unwrap();
    let hits = trace(&scene, &lidar, First, &()).unwrap();
    for row in 0..40 {
        // The highest laser is the top row.
        let elevation = elevations[39 - row].to_radians();
        for column in 0..360 {
            let azimuth = (30.0 - column as f64).to_radians();
            let (up, level) = libm::sincos(elevation);
            let (sine, cosine) = libm::sincos(azimuth);
            let direction = DVec3::new(level * cosine, level * sine, up);
            // From inside, the nearest of the planes ahead.
            let wall = DVec3::select(direction.cmpgt(DVec3::ZERO), half, -half);
            let ahead = (wall - at) / direction;
            let range = DVec3::select(direction.cmpeq(DVec3::ZERO), DVec3::INFINITY, ahead);
            let range = range.min_element();
            let pixel = row * 360 + column;
            let off = (hits.t[pixel] - range).abs();
            assert!(off < 1e-12, "{row} {column}: {off:e}");
            assert_eq!(lidar.range_and_z(pixel, hits.t[pixel])[0], hits.t[pixel]);
            let time = column as f64 / 360.0 / 10.0;
            assert!((lidar.time(pixel).unwrap() - time).abs() < 1e-15);
        }
    }
}

#[test]
fn a_lidar_that_is_carried_fires_each_beam_from_where_it_then_is() {
    let body = straight(DVec3::ZERO, DVec3::new(7.0, 0.0, 0.0));
    let pattern = LidarModel::Vlp32c.pattern(10.0, None, 10.0).unwrap();
    let mount =
        Pose::new(DVec3::new(0.0, 0.0, 2.0), DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2))
            .unwrap();
    let lidar = Lidar::carried(pattern, mount, &body).unwrap();
    for pixel in [0, 1000, 30_000, lidar.len() - 1] {
        let time = lidar.time(pixel).unwrap();
        let ray = lidar.ray(pixel);
        let expected = DVec3::new(7.0 * (time - 10.0), 0.0, 2.0);
        assert!(ray.origin.abs_diff_eq(expected, 1e-14));
        let own = lidar.pattern().direction(pixel);
        // Its forwards is the body's left.
        let turned = DVec3::new(-own.y, own.x, own.z);
        assert!(ray.direction.abs_diff_eq(turned, 1e-15));
        let it = lidar.return_at(pixel, 5.0);
        assert_eq!(it.point, ray.at(5.0));
        assert_eq!(it.sensor_point, 5.0 * own);
        assert_eq!(it.time, time);
        assert_eq!(it.ring, lidar.pattern().rings()[pixel]);
        let [_, columns] = lidar.shape();
        let place = [it.row, it.column].map(|x| usize::try_from(x).unwrap());
        assert_eq!(place, [pixel / columns, pixel % columns]);
    }
    let late = LidarModel::Vlp16.pattern(10.0, None, 11.95).unwrap();
    assert!(Lidar::carried(late.clone(), mount, &body).is_err());
    let held = body.extrapolated(Extrapolation::Hold);
    assert!(Lidar::carried(late, mount, &held).is_ok());
}

#[test]
fn a_cone_of_beams_is_round_and_its_first_is_its_middle() {
    let pattern = Pattern::table(&[20.0], &[-90.0], &[], &[]).unwrap();
    let lidar = Lidar::new(pattern, Pose::IDENTITY).unwrap();
    let mut cone = [DVec3::ZERO; 200];
    lidar.spread(0, 0.02, &mut cone).unwrap();
    assert_eq!(cone[0], lidar.ray(0).direction);
    let angles = cone.map(|d| d.angle_between(cone[0]));
    let widest = angles.iter().copied().fold(0.0, f64::max);
    assert!((widest - 0.01).abs() < 1e-9, "{widest}");
    // Equal areas: a quarter of them is within half of the radius.
    let within = angles.iter().filter(|&&angle| angle < 0.005).count();
    assert!((45..=55).contains(&within), "{within}");
    let mean = cone.iter().sum::<DVec3>() / 200.0;
    assert!(mean.angle_between(cone[0]) < 0.001);
}

#[test]
fn distances_along_the_aim_take_an_aim() {
    let scene = example::scene().unwrap();
    let shade = Shader::named("normal").unwrap();
    let shade = shade.on(&scene);
    let channels = [kind("z").unwrap()];
    let table = RaySensor::of(&small_camera()).unwrap();
    let picture = Picture::new(&scene, &table, &shade, &channels);
    let error = picture.render(&()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "channel must be one that a sensor without an aim has, such as range, got z"
    );
    let aimed = table.aimed(small_camera().aim() * 3.0).unwrap();
    let of_table = Picture::new(&scene, &aimed, &shade, &channels).render(&());
    let camera = small_camera();
    let of_camera = Picture::new(&scene, &camera, &shade, &channels).render(&());
    let (of_table, of_camera) = (of_table.unwrap(), of_camera.unwrap());
    let z = |frame: &firsthit::image::Frame| match &frame.channel("z").unwrap().data {
        firsthit::image::Data::Float64(values) => values.clone(),
        other => panic!("{other:?}"),
    };
    for (a, b) in z(&of_table).into_iter().zip(z(&of_camera)) {
        assert!(a == b || (a - b).abs() < 1e-13, "{a} {b}");
    }
}

/// The numbers of a channel as text: all bits of them.
fn values(data: &firsthit::image::Data) -> Vec<String> {
    fn text<T: std::fmt::Debug>(values: &[T]) -> Vec<String> {
        values.iter().map(|value| format!("{value:?}")).collect()
    }
    match data {
        firsthit::image::Data::Float64(values) => text(values),
        firsthit::image::Data::Float32(values) => text(values),
        firsthit::image::Data::Int32(values) => text(values),
        firsthit::image::Data::Bool(values) => text(values),
    }
}

#[test]
fn a_pixel_without_a_ray_is_a_miss_that_says_so() {
    let directions = vec![DVec3::ZERO, DVec3::NAN, DVec3::NEG_Z];
    let sensor = RaySensor::new(vec![DVec3::new(0.5, 0.0, 0.0)], directions, [1, 3]).unwrap();
    let scene = edge();
    let shade = Shader::named("unlit").unwrap();
    let shade = shade.on(&scene);
    let channels = ["range", "valid"].map(|name| kind(name).unwrap());
    let frame = Picture::new(&scene, &sensor, &shade, &channels);
    let frame = frame.render(&()).unwrap();
    let data = |name: &str| values(&frame.channel(name).unwrap().data);
    assert_eq!(data("range"), ["inf", "inf", "10.0"]);
    assert_eq!(data("valid"), ["false", "false", "true"]);
}

#[test]
fn a_part_of_a_sensors_picture_is_that_part_of_the_whole() {
    let scene = example::scene().unwrap();
    let shade = Shader::named("normal").unwrap();
    let shade = shade.on(&scene);
    let channels = ["color", "range", "object"].map(|name| kind(name).unwrap());
    for sensor in sensors() {
        let [rows, columns] = sensor.shape();
        let picture = Picture { samples: 2, ..Picture::new(&scene, &*sensor, &shade, &channels) };
        let whole = picture.render(&()).unwrap();
        let region = Region { rows: 3..rows - 2, columns: 5..columns - 4 };
        let part = Picture { region: Some(region.clone()), ..picture };
        let part = part.render(&()).unwrap();
        for name in ["color", "range", "object"] {
            let (of_whole, of_part) = (whole.channel(name).unwrap(), part.channel(name).unwrap());
            let text = |data: &firsthit::image::Data, components: usize, width: usize| {
                let values = values(data);
                let lines = values.chunks(components * width);
                lines.map(<[String]>::to_vec).collect::<Vec<_>>()
            };
            let components = of_whole.components;
            let all = text(&of_whole.data, components, columns);
            let some = text(&of_part.data, components, region.columns.len());
            for (k, line) in some.iter().enumerate() {
                let of_line = components * region.columns.start..components * region.columns.end;
                assert_eq!(line, &all[region.rows.start + k][of_line], "{name} {sensor:?}");
            }
        }
    }
}

#[test]
fn every_sensor_says_what_it_is_and_the_record_comes_back() {
    let scene = example::scene().unwrap();
    let shade = Shader::named("unlit").unwrap();
    let shade = shade.on(&scene);
    let channels = [kind("range").unwrap()];
    let mut kinds = Vec::new();
    for sensor in sensors() {
        let frame = Picture::new(&scene, &*sensor, &shade, &channels);
        let metadata = frame.render(&()).unwrap().metadata();
        let json = metadata.to_json();
        assert_eq!(Metadata::from_json(&json).unwrap(), metadata);
        assert_eq!(metadata.camera, None);
        let Record::Other(record) = sensor.record() else {
            panic!("{sensor:?} says that it is a camera");
        };
        assert_eq!(metadata.sensor.as_ref(), Some(&*record));
        kinds.push(record.kind.clone());
        let moves = record.trajectory.is_some();
        assert_eq!(moves, format!("{sensor:?}").contains("moves: true") || record.camera.is_some());
    }
    kinds.dedup();
    assert_eq!(kinds, ["rays", "rolling_shutter", "pushbroom", "lidar"]);
}
