//! Small scenes of our own, for machines without the models: a boulder, hills, a room.

use std::sync::Arc;

use firsthit::{DVec3, Mesh, Object, Positions};

use super::look::Look;

/// The names of the scenes.
pub(super) const NAMES: &[&str] = &["boulder", "hills", "room"];

/// The scene of that name.
pub(super) fn make(name: &str) -> Option<(Vec<Object>, Look)> {
    match name {
        "boulder" => Some(boulder()),
        "hills" => Some(hills()),
        "room" => Some(room()),
        _ => None,
    }
}

/// A displaced sphere of 131,072 triangles.
fn boulder() -> (Vec<Object>, Look) {
    let mut grid = Grid::default();
    grid.add(256, 256, |u, v| {
        let p = on_sphere(u, v);
        p * (1.0 + 0.15 * waves(2.0 * p))
    });
    let look = Look {
        eye: DVec3::new(1.0, -3.0, 1.2),
        target: DVec3::ZERO,
        up: DVec3::Z,
        light: DVec3::new(-3.0, -4.0, 5.0),
        fov: 40.0,
        height: 2.6,
        reach: 0.3,
    };
    (grid.object("boulder"), look)
}

/// A height field of 2,097,152 triangles.
fn hills() -> (Vec<Object>, Look) {
    let mut grid = Grid::default();
    grid.add(1024, 1024, |u, v| {
        let (x, y) = (100.0 * u, 100.0 * v);
        let wide = waves(DVec3::new(0.07 * x, 0.07 * y, 0.5));
        let narrow = waves(DVec3::new(0.9 * x, 0.9 * y, 0.1));
        DVec3::new(x, y, 5.0 * wide + 0.2 * narrow)
    });
    let look = Look {
        eye: DVec3::new(50.0, -6.0, 16.0),
        target: DVec3::new(50.0, 50.0, 0.0),
        up: DVec3::Z,
        light: DVec3::new(-30.0, 120.0, 60.0),
        fov: 55.0,
        height: 60.0,
        reach: 2.0,
    };
    (grid.object("hills"), look)
}

/// A closed room with 24 boulders on its floor, 387,120 triangles.
fn room() -> (Vec<Object>, Look) {
    let mut grid = Grid::default();
    let size = DVec3::new(12.0, 10.0, 4.0);
    let walls = [
        (DVec3::ZERO, DVec3::X, DVec3::Y),
        (DVec3::Z, DVec3::X, DVec3::Y),
        (DVec3::ZERO, DVec3::X, DVec3::Z),
        (DVec3::Y, DVec3::X, DVec3::Z),
        (DVec3::ZERO, DVec3::Y, DVec3::Z),
        (DVec3::X, DVec3::Y, DVec3::Z),
    ];
    for (corner, across, up) in walls {
        grid.add(2, 2, |u, v| size * (corner + u * across + v * up));
    }
    for k in 0..24 {
        let (column, row) = (f64::from(k % 6), f64::from(k / 6));
        let radius = 0.3 + 0.05 * f64::from(k % 7);
        let place = DVec3::new(1.2 + 1.9 * column, 1.8 + 2.1 * row, radius);
        grid.add(96, 84, |u, v| {
            let p = on_sphere(u, v);
            place + radius * (1.0 + 0.1 * waves(3.0 * p + place)) * p
        });
    }
    let look = Look {
        eye: DVec3::new(5.6, 0.35, 1.7),
        target: DVec3::new(6.2, 6.0, 0.9),
        up: DVec3::Z,
        light: DVec3::new(6.0, 5.0, 3.7),
        fov: 75.0,
        height: 9.0,
        reach: 0.6,
    };
    (grid.object("room"), look)
}

/// The point of the unit sphere at a share `u` of the way around and `v` of the way up.
fn on_sphere(u: f64, v: f64) -> DVec3 {
    let (sin, cos) = libm::sincos(std::f64::consts::TAU * u);
    let (radius, z) = libm::sincos(std::f64::consts::PI * v);
    DVec3::new(radius * cos, radius * sin, -z)
}

/// A sum of waves between about -1 and 1, each octave crossing the others.
fn waves(p: DVec3) -> f64 {
    let mut sum = 0.0;
    let (mut p, mut height) = (p, 0.5);
    for _ in 0..6 {
        sum += height * libm::sin(p.x + libm::sin(p.z)) * libm::cos(p.y - p.z);
        p = 1.9 * DVec3::new(p.y + 0.3, p.z - 0.7, p.x + 0.4 * p.y);
        height *= 0.5;
    }
    sum
}

/// Grids of triangles over the unit square, taken into space.
#[derive(Debug, Default)]
struct Grid {
    vertices: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
}

impl Grid {
    /// Adds 2 * `columns` * `rows` triangles.
    fn add(&mut self, columns: u32, rows: u32, place: impl Fn(f64, f64) -> DVec3) {
        let first = self.vertices.len() as u32;
        for row in 0..=rows {
            for column in 0..=columns {
                let (u, v) =
                    (f64::from(column) / f64::from(columns), f64::from(row) / f64::from(rows));
                self.vertices.push(place(u, v).to_array().map(|x| x as f32));
            }
        }
        for row in 0..rows {
            for column in 0..columns {
                let low = first + row * (columns + 1) + column;
                let high = low + columns + 1;
                self.triangles.push([low, low + 1, high + 1]);
                self.triangles.push([low, high + 1, high]);
            }
        }
    }

    fn object(self, name: &str) -> Vec<Object> {
        let mesh = Mesh::new(Positions::Single(self.vertices.into()), self.triangles);
        let mesh = mesh.expect("the grid indexes its own vertices");
        vec![Object::new(Arc::new(mesh)).named(name)]
    }
}
