//! Rays that begin where others ended, and rays from anywhere. Their numbers are float32 ones, so
//! that both sides get the same rays to the last bit.

use std::f64::consts::TAU;

use firsthit::{Bounds, Camera, DVec3, Hits, Ray, Scene};

use crate::firsthit_side;

/// The hits of a camera: for each pixel that hits, in tiles of 16 x 16 pixels, 4 x 4 by 4 x 4.
#[derive(Debug)]
pub(super) struct Surface {
    tiles: Vec<Vec<Point>>,
}

/// A point just off the surface, on the side the camera saw, and the normal there.
#[derive(Debug, Clone, Copy)]
struct Point {
    place: DVec3,
    normal: DVec3,
}

/// The distance off the surface, as a share of the scene's diagonal.
const OFF: f64 = 1e-5;

/// A camera's rays, row by row from the top.
pub(super) fn of_pixels(camera: &Camera) -> Vec<Ray> {
    let pixels = (0..camera.rows()).flat_map(|row| (0..camera.columns()).map(move |k| (row, k)));
    let rounded = |(row, column)| {
        let Ray { origin, direction, t_max, .. } = camera.ray(row, column);
        ray(origin, direction, t_max)
    };
    pixels.map(rounded).collect()
}

impl Surface {
    pub(super) fn seen(scene: &Scene, camera: &Camera) -> Self {
        let mut hits = Hits::default();
        firsthit_side::first_hits(scene, camera, &mut hits);
        let off = OFF * scene.bounds().size().length();
        let tiles = camera.columns() / 16;
        let pixel = |tile: usize, k: usize| {
            let (x, y) = (k / 16 % 4 * 4 + k % 4, k / 64 * 4 + k / 4 % 4);
            (tile / tiles * 16 + y, tile % tiles * 16 + x)
        };
        let point = |(row, column): (usize, usize)| {
            let hit = hits.get(row * camera.columns() + column);
            let ray = camera.ray(row, column);
            let normal = scene.interaction(&ray, &hit)?.normal();
            let normal = if ray.direction.dot(normal) < 0.0 { normal } else { -normal };
            let place = ray.at(hit.t) + off * normal;
            normal.is_finite().then_some(Point { place, normal })
        };
        let seen = |tile| (0..256).filter_map(|k| point(pixel(tile, k))).collect();
        Self { tiles: (0..tiles * tiles).map(seen).collect() }
    }

    fn points(&self) -> impl Iterator<Item = Point> {
        self.tiles.iter().flatten().copied()
    }

    /// One to the light from each point, ending just before it.
    pub(super) fn to_light(&self, light: DVec3) -> Vec<Ray> {
        let shadow = |point: Point| {
            let way = light - point.place;
            ray(point.place, way.normalize(), 0.999 * way.length())
        };
        self.points().map(shadow).collect()
    }

    /// Four from each point over the half-space above it, as long as `reach`. Where that were more
    /// than `most`, whole tiles are left out, evenly.
    pub(super) fn around(&self, reach: f64, most: usize) -> Vec<Ray> {
        let mut random = Random(1);
        let all = 4 * self.points().count();
        let keep = (most as f64 / all.max(1) as f64).min(1.0);
        let kept =
            |tile: &usize| (*tile as f64 * keep) as usize != ((tile + 1) as f64 * keep) as usize;
        let tiles = (0..self.tiles.len()).filter(kept);
        let points = tiles.flat_map(|tile| &self.tiles[tile]);
        points
            .flat_map(|point| [point; 4])
            .map(|point| ray(point.place, random.above(point.normal), reach))
            .collect()
    }

    /// One from each point, as a matt surface scatters light.
    pub(super) fn scattered(&self) -> Vec<Ray> {
        let mut random = Random(2);
        self.points()
            .map(|point| ray(point.place, random.above(point.normal), f64::INFINITY))
            .collect()
    }
}

/// Rays from points all over `bounds` in all directions.
pub(super) fn anywhere(bounds: Bounds, count: usize) -> Vec<Ray> {
    let mut random = Random(3);
    let mut place = || {
        let share = DVec3::new(random.unit(), random.unit(), random.unit());
        ray(bounds.low + share * bounds.size(), random.direction(), f64::INFINITY)
    };
    (0..count).map(|_| place()).collect()
}

/// The ray with its numbers rounded to float32.
fn ray(origin: DVec3, direction: DVec3, t_max: f64) -> Ray {
    let single = |x: f64| f64::from(x as f32);
    let vector = |v: DVec3| DVec3::from(v.to_array().map(single));
    Ray::new(vector(origin), vector(direction)).up_to(single(t_max))
}

/// Steele, Lea and Flood's `SplitMix64`: the same rays in every run.
#[derive(Debug)]
struct Random(u64);

impl Random {
    /// Below one.
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
    }

    /// A direction of length one, every direction as likely.
    fn direction(&mut self) -> DVec3 {
        let z = 2.0 * self.unit() - 1.0;
        let (sin, cos) = libm::sincos(TAU * self.unit());
        let radius = (1.0 - z * z).sqrt();
        DVec3::new(radius * cos, radius * sin, z)
    }

    /// A direction of length one, as likely as the cosine to `normal`: a point of the sphere that
    /// touches the surface.
    fn above(&mut self, normal: DVec3) -> DVec3 {
        loop {
            let sum = normal + self.direction();
            if sum.length() > 1e-3 {
                return sum.normalize();
            }
        }
    }
}
