//! Every lens, with random numbers: a direction that `project` puts into the picture is the ray of
//! that place.

use firsthit::{Camera, DVec2, DVec3, Lens, Projection, View};

use super::support::{Numbers, rounds};

const ROWS: usize = 192;
const COLUMNS: usize = 256;

/// So far from zero are a lens' own numbers, at most; where they are not from there to the
/// negative, from where.
#[rustfmt::skip]
fn own_numbers(projection: Projection) -> &'static [(&'static str, [f64; 2])] {
    match projection {
        Projection::Perspective => &[
            ("shift_x", [-0.5, 0.5]), ("shift_y", [-0.5, 0.5]), ("tilt_x", [-20.0, 20.0]),
            ("tilt_y", [-20.0, 20.0]), ("skew", [-0.2, 0.2]),
        ],
        Projection::Orthographic => &[("width", [1.0, 3.0]), ("height", [1.0, 3.0])],
        Projection::Equirectangular => &[
            ("horizontal_fov", [60.0, 360.0]),
            ("vertical_fov", [60.0, 180.0]),
        ],
        Projection::Cylindrical => &[
            ("horizontal_fov", [60.0, 360.0]),
            ("vertical_fov", [60.0, 170.0]),
        ],
        Projection::CubeMap | Projection::Octahedral => &[],
        Projection::OpenCv => &[
            ("k1", [-0.3, 0.3]), ("k2", [-0.3, 0.3]), ("p1", [-0.005, 0.005]),
            ("p2", [-0.005, 0.005]), ("k3", [-0.1, 0.1]), ("k4", [-0.3, 0.3]), ("k5", [-0.3, 0.3]),
            ("k6", [-0.1, 0.1]), ("s1", [-0.005, 0.005]), ("s2", [-0.002, 0.002]),
            ("s3", [-0.005, 0.005]), ("s4", [-0.002, 0.002]), ("tau_x", [-0.1, 0.1]),
            ("tau_y", [-0.1, 0.1]),
        ],
        Projection::OpenCvFisheye => &[
            ("k1", [-0.1, 0.1]), ("k2", [-0.05, 0.05]), ("k3", [-0.01, 0.01]),
            ("k4", [-0.003, 0.003]),
        ],
        Projection::KannalaBrandt => &[
            ("k1", [0.7, 1.3]), ("k2", [-0.1, 0.1]), ("k3", [-0.03, 0.03]), ("k4", [-0.01, 0.01]),
            ("k5", [-0.003, 0.003]),
        ],
        Projection::DoubleSphere => &[("xi", [-0.95, 1.5]), ("alpha", [0.0, 1.0])],
        Projection::Eucm => &[("alpha", [0.0, 1.0]), ("beta", [0.3, 2.0])],
        Projection::Ucm => &[("alpha", [0.0, 1.0])],
        Projection::Mei => &[
            ("xi", [0.0, 2.5]), ("k1", [-0.3, 0.3]), ("k2", [-0.1, 0.1]), ("p1", [-0.005, 0.005]),
            ("p2", [-0.005, 0.005]),
        ],
        Projection::Fov => &[("omega", [-2.5, 2.5])],
        Projection::ThinPrismFisheye => &[
            ("k1", [-0.1, 0.1]), ("k2", [-0.03, 0.03]), ("p1", [-0.005, 0.005]),
            ("p2", [-0.005, 0.005]), ("k3", [-0.005, 0.005]), ("k4", [-0.001, 0.001]),
            ("sx1", [-0.005, 0.005]), ("sy1", [-0.005, 0.005]),
        ],
        Projection::RadTanThinPrismFisheye => &[
            ("k0", [-0.1, 0.1]), ("k1", [-0.05, 0.05]), ("k2", [-0.01, 0.01]),
            ("k3", [-0.003, 0.003]), ("p0", [-0.005, 0.005]), ("p1", [-0.005, 0.005]),
            ("s0", [-0.005, 0.005]), ("s1", [-0.002, 0.002]), ("s2", [-0.005, 0.005]),
            ("s3", [-0.002, 0.002]),
        ],
        Projection::Equidistant | Projection::Equisolid => &[("fov", [60.0, 360.0])],
        Projection::Stereographic => &[("fov", [60.0, 350.0])],
        Projection::OrthographicFisheye => &[("fov", [60.0, 180.0])],
    }
}

fn has_matrix(projection: Projection) -> bool {
    let lens = Lens::named(projection, &[]).unwrap();
    lens.parameters().iter().any(|&(name, _)| name == "fx")
}

/// A lens with random numbers, each of its own left out now and then, of a camera of so many pixels
/// to a unit.
fn random_lens(
    projection: Projection,
    numbers: &mut Numbers,
    is_left_out: impl Fn(&str) -> bool,
) -> Vec<(&'static str, f64)> {
    let mut given = Vec::new();
    if has_matrix(projection) {
        let focal_length = 60.0 + 100.0 * numbers.unit();
        given.extend([
            ("fx", focal_length),
            ("fy", focal_length * (0.95 + 0.1 * numbers.unit())),
            ("cx", 120.0 + 16.0 * numbers.unit()),
            ("cy", 88.0 + 16.0 * numbers.unit()),
            ("skew", 2.0 * numbers.unit() - 1.0),
        ]);
    }
    for &(name, [low, high]) in own_numbers(projection) {
        let value = low + (high - low) * numbers.unit();
        if !is_left_out(name) {
            given.push((name, value));
        }
    }
    given
}

fn camera(projection: Projection, given: &[(&str, f64)]) -> Camera {
    let view = View {
        rows: ROWS,
        columns: COLUMNS,
        lens: Lens::named(projection, given).unwrap(),
        ..View::default()
    };
    Camera::new(view).unwrap_or_else(|error| panic!("{projection:?} {given:?}: {error}"))
}

/// Counts of random directions by their fate.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
struct Tally {
    seen: usize,
    without_a_ray: usize,
    elsewhere: usize,
}

impl Tally {
    fn direction(&mut self, camera: &Camera, toward: DVec3) {
        let Some(pixel) = camera.project(camera.position() + toward) else {
            return;
        };
        let [column, row] = pixel.to_array().map(f64::floor);
        let is_inside = column >= 0.0 && row >= 0.0 && column < COLUMNS as f64 && row < ROWS as f64;
        if !is_inside {
            return;
        }
        self.seen += 1;
        let offset = DVec2::new(pixel.x - column, row + 1.0 - pixel.y);
        let ray = camera.ray_within(row as usize, column as usize, offset);
        if !ray.is_valid() {
            self.without_a_ray += 1;
            return;
        }
        // Parallel rays have another origin each. Where a lens hardly moves a pixel for another
        // direction, rounding is a wider angle.
        let to_point = camera.position() + toward - ray.origin;
        let off = to_point - ray.direction * to_point.dot(ray.direction);
        let is_ahead = to_point.dot(ray.direction) > 0.0 || ray.origin != camera.position();
        let is_near = off.length() < 1e-5 * toward.length();
        let again = camera.project(ray.origin + ray.direction);
        let is_same = again.is_some_and(|again| (again - pixel).length() < 1e-7);
        self.elsewhere += usize::from(!(is_near && is_ahead && is_same));
    }

    fn directions(camera: &Camera, numbers: &mut Numbers, count: usize) -> Self {
        let mut tally = Self::default();
        for k in 0..count {
            let mut toward = numbers.point();
            if k % 2 == 0 {
                // More of what is in front.
                toward = DVec3::new(2.0 * toward.x, 2.0 * toward.y, -1.0);
            }
            tally.direction(camera, toward);
        }
        tally
    }
}

#[test]
fn what_project_puts_into_the_picture_has_a_ray_there() {
    let mut report = Vec::new();
    for &projection in Projection::ALL {
        let mut all = Tally::default();
        for seed in rounds(140_u64) {
            let mut numbers = Numbers::new(seed);
            let every = 1 + numbers.below(3);
            let given = random_lens(projection, &mut numbers, |name| {
                every > 1 && name.len() % every == 0 && name.starts_with(['t', 's', 'p'])
            });
            let camera = camera(projection, &given);
            let tally = Tally::directions(&camera, &mut numbers, 2000);
            if tally.without_a_ray + tally.elsewhere > 0 {
                report.push(format!("{projection:?} {seed}: {tally:?} {given:?}"));
            }
            all.seen += tally.seen;
        }
        assert!(all.seen > 1_000, "{projection:?}: {all:?}");
    }
    assert!(report.is_empty(), "{}\n{}", report.len(), report.join("\n"));
}

/// Where the divisor has a pole, a solution was sought from there, and found for some pixels alone.
#[test]
fn rational_cameras_have_no_holes() {
    #[rustfmt::skip]
    let own = [
        ("fx", 78.8), ("fy", 78.8), ("cx", 127.3), ("cy", 93.4), ("k1", 0.1823), ("k2", 0.0882),
        ("p1", -0.00096), ("p2", 0.0012), ("k3", 0.0028), ("k4", 0.2734), ("k5", -0.2209),
        ("k6", -0.0163),
    ];
    let whole = camera(Projection::OpenCv, &own);
    let pixels = (0..ROWS).flat_map(|row| (0..COLUMNS).map(move |column| (row, column)));
    let without = pixels.filter(|&(row, column)| !whole.ray(row, column).is_valid());
    assert_eq!(without.count(), 0);
    let mut report = Vec::new();
    for seed in 0..600 {
        let mut numbers = Numbers::new(1_000 + seed);
        let given =
            random_lens(Projection::OpenCv, &mut numbers, |name| name.starts_with(['s', 't']));
        let camera = camera(Projection::OpenCv, &given);
        let tally = Tally::directions(&camera, &mut numbers, 2000);
        if tally.without_a_ray + tally.elsewhere > 0 {
            report.push(format!("{seed}: {tally:?} {given:?}"));
        }
    }
    assert!(report.is_empty(), "{}\n{}", report.len(), report.join("\n"));
}
