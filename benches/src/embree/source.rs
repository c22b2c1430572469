//! The source of Embree's rays: a camera's pixels or arrays. Blocks of 256 rays, packets within
//! them.

use firsthit::{Camera, DVec3, Ray};

use super::packet::Rays;

/// Rays in a block.
pub(super) const BLOCK: usize = 256;

/// Rays for packets.
pub(crate) trait Source {
    /// The number of rays.
    fn len(&self) -> usize;
    /// Fills in the rays of `block` from its ray `first` on.
    fn fill<const N: usize>(&self, block: usize, first: usize, rays: &mut Rays<N>);
    /// Puts the results of the packet that begins with ray `first` where they belong in their
    /// block.
    fn place<const N: usize>(first: usize, results: &[u32; N], block: &mut [u32; BLOCK]);
    /// The place of line `line` of a block's results among all lines.
    fn line(&self, block: usize, line: usize) -> usize;
}

/// The rays of a camera, made when they are needed, in float32: tiles of 16 x 16 pixels along a
/// curve that keeps neighbours together, packets of 4 x 4 (or 4 x 2) pixels.
#[derive(Debug)]
pub(crate) struct Pixels {
    side: usize,
    perspective: bool,
    eye: [f32; 3],
    aim: [f32; 3],
    /// The viewplane's point for pixel (0, 0), relative to the eye, and the steps to the next ones.
    corner: [f32; 3],
    right: [f32; 3],
    down: [f32; 3],
}

impl Pixels {
    /// The rays of a camera with as many columns as rows, a multiple of 16, starting at its eye.
    pub(crate) fn new(camera: &Camera) -> Self {
        let view = camera.view();
        let lens = view.lens.viewplane().expect("the bench's cameras have one");
        let right = lens.width / view.columns as f64 * camera.right();
        let down = -lens.height / view.rows as f64 * camera.upwards();
        let half =
            0.5 * (view.columns as f64 - 1.0) * right + 0.5 * (view.rows as f64 - 1.0) * down;
        Self {
            side: view.columns,
            perspective: !lens.parallel,
            eye: single(view.position),
            aim: single(view.aim),
            corner: if lens.parallel {
                // Parallel rays start on the plane through the camera's position.
                single(view.position - half)
            } else {
                single(lens.focal_length * view.aim - half)
            },
            right: single(right),
            down: single(down),
        }
    }

    /// The column and row of the first pixel of a tile.
    #[inline(always)]
    fn tile(&self, block: usize) -> (usize, usize) {
        let tiles = self.side / 16;
        if tiles.is_power_of_two() {
            (16 * every_other_bit(block), 16 * every_other_bit(block >> 1))
        } else {
            (block % tiles * 16, block / tiles * 16)
        }
    }
}

/// Bits 0, 2, 4, ... next to each other.
#[inline(always)]
fn every_other_bit(code: usize) -> usize {
    let mut x = code as u32 & 0x5555_5555;
    x = (x | x >> 1) & 0x3333_3333;
    x = (x | x >> 2) & 0x0f0f_0f0f;
    x = (x | x >> 4) & 0x00ff_00ff;
    ((x | x >> 8) & 0xffff) as usize
}

fn single(v: DVec3) -> [f32; 3] {
    v.to_array().map(|x| x as f32)
}

/// The place in its tile of ray `k` of a block: 4 x 4 pixels after 4 x 4 pixels.
#[inline(always)]
fn in_tile(k: usize) -> (usize, usize) {
    (k / 16 % 4 * 4 + k % 4, k / 64 * 4 + k / 4 % 4)
}

impl Source for Pixels {
    fn len(&self) -> usize {
        self.side * self.side
    }

    #[expect(
        clippy::needless_range_loop,
        reason = "loops over lanes: this is what the compiler makes wide"
    )]
    #[inline(always)]
    fn fill<const N: usize>(&self, block: usize, first: usize, rays: &mut Rays<N>) {
        let (column, row) = self.tile(block);
        let (x, y) = in_tile(first);
        let (left, top) = ((column + x) as f32, (row + y) as f32);
        let mut point = [[0.0_f32; N]; 3];
        for axis in 0..3 {
            for k in 0..N {
                let (x, y) = (left + (k % 4) as f32, top + (k / 4) as f32);
                point[axis][k] = self.corner[axis] + x * self.right[axis] + y * self.down[axis];
            }
        }
        if self.perspective {
            let mut scale = [0.0_f32; N];
            for k in 0..N {
                let [x, y, z] = [point[0][k], point[1][k], point[2][k]];
                scale[k] = 1.0 / (x * x + y * y + z * z).sqrt();
            }
            for axis in 0..3 {
                for k in 0..N {
                    rays.direction[axis][k] = scale[k] * point[axis][k];
                }
            }
            rays.origin = self.eye.map(|x| [x; N]);
        } else {
            rays.origin = point;
            rays.direction = self.aim.map(|x| [x; N]);
        }
        rays.t_far = [f32::INFINITY; N];
    }

    #[inline(always)]
    fn place<const N: usize>(first: usize, results: &[u32; N], block: &mut [u32; BLOCK]) {
        let (x, y) = in_tile(first);
        if N == 1 {
            block[16 * y + x] = results[0];
            return;
        }
        for (k, four) in results.chunks_exact(4).enumerate() {
            let start = 16 * (y + k) + x;
            block[start..start + 4].copy_from_slice(four);
        }
    }

    #[inline(always)]
    fn line(&self, block: usize, line: usize) -> usize {
        let (column, row) = self.tile(block);
        (row + line) * (self.side / 16) + column / 16
    }
}

/// Rays from arrays, one for each coordinate.
#[derive(Debug)]
pub(crate) struct Columns {
    len: usize,
    /// Origin, direction, `t_max`, each as long as whole blocks are.
    columns: [Vec<f32>; 7],
}

impl Columns {
    /// The `rays` in float32, which they must fit into, as the ones of `rows` do.
    pub(crate) fn new(rays: &[Ray]) -> Self {
        let numbers = |ray: &Ray| {
            let (o, d) = (ray.origin, ray.direction);
            [o.x, o.y, o.z, d.x, d.y, d.z, ray.t_max].map(|x| x as f32)
        };
        let mut columns: [Vec<f32>; 7] = Default::default();
        for ray in rays {
            for (column, number) in columns.iter_mut().zip(numbers(ray)) {
                column.push(number);
            }
        }
        for column in &mut columns {
            column.resize(rays.len().next_multiple_of(BLOCK), 0.0);
        }
        Self { len: rays.len(), columns }
    }
}

impl Source for Columns {
    fn len(&self) -> usize {
        self.len
    }

    #[inline(always)]
    fn fill<const N: usize>(&self, block: usize, first: usize, rays: &mut Rays<N>) {
        let start = block * BLOCK + first;
        let range = start..start + N;
        let [x, y, z, dx, dy, dz, t_max] = &self.columns;
        for (target, source) in rays.origin.iter_mut().zip([x, y, z]) {
            target.copy_from_slice(&source[range.clone()]);
        }
        for (target, source) in rays.direction.iter_mut().zip([dx, dy, dz]) {
            target.copy_from_slice(&source[range.clone()]);
        }
        rays.t_far.copy_from_slice(&t_max[range]);
    }

    #[inline(always)]
    fn place<const N: usize>(first: usize, results: &[u32; N], block: &mut [u32; BLOCK]) {
        block[first..first + N].copy_from_slice(results);
    }

    #[inline(always)]
    fn line(&self, block: usize, line: usize) -> usize {
        block * (BLOCK / 16) + line
    }
}

#[cfg(test)]
mod tests {
    use firsthit::{Lens, View, Viewplane};

    use super::super::packet::RayHits;
    use super::*;

    /// Sides that are a power of two times 16, and not.
    const SIDES: [usize; 2] = [64, 48];

    fn camera(parallel: bool, side: usize) -> Camera {
        let view = View {
            position: DVec3::new(3.0, -5.0, 2.0),
            aim: DVec3::new(-3.0, 5.0, -1.5),
            up: DVec3::Z,
            rows: side,
            columns: side,
            lens: Lens::Flat(Viewplane {
                width: 1.5,
                height: 1.0,
                parallel,
                ray_start: firsthit::RayStart::Eye,
                ..Viewplane::default()
            }),
        };
        Camera::new(view).unwrap()
    }

    /// Every ray of a packet, with the place of its result among all.
    fn rays<const N: usize>(pixels: &Pixels) -> Vec<(usize, [f32; 3], [f32; 3])> {
        let mut all = Vec::new();
        for block in 0..pixels.len() / BLOCK {
            for first in (0..BLOCK).step_by(N) {
                let mut packet = RayHits::<N>::EMPTY;
                pixels.fill(block, first, &mut packet.rays);
                let mut places = [u32::MAX; BLOCK];
                Pixels::place(first, &std::array::from_fn::<u32, N, _>(|k| k as u32), &mut places);
                for (place, &k) in places.iter().enumerate().filter(|(_, k)| **k != u32::MAX) {
                    let index = 16 * pixels.line(block, place / 16) + place % 16;
                    let lane = |v: [[f32; N]; 3]| v.map(|axis| axis[k as usize]);
                    all.push((index, lane(packet.rays.origin), lane(packet.rays.direction)));
                }
            }
        }
        all
    }

    #[test]
    fn packets_hold_every_pixel_of_the_camera_once() {
        for parallel in [false, true] {
            for side in SIDES {
                let camera = camera(parallel, side);
                let pixels = Pixels::new(&camera);
                for mut all in [rays::<1>(&pixels), rays::<8>(&pixels), rays::<16>(&pixels)] {
                    all.sort_by_key(|&(index, ..)| index);
                    assert!(all.iter().map(|&(index, ..)| index).eq(0..side * side));
                    for (index, origin, direction) in all {
                        let ray = camera.ray(index / side, index % side);
                        let double = |v: [f32; 3]| DVec3::from(v.map(f64::from));
                        // A few roundings to float32 at coordinates below 8.
                        assert!((double(origin) - ray.origin).length() < 1e-5);
                        assert!((double(direction) - ray.direction).length() < 1e-6);
                    }
                }
            }
        }
    }

    #[test]
    fn columns_hold_every_ray_and_nothing_beyond() {
        let ray = |k: usize| Ray::new(DVec3::splat(k as f64), DVec3::X).up_to(k as f64 + 0.5);
        let all: Vec<Ray> = (0..300).map(ray).collect();
        let columns = Columns::new(&all);
        assert_eq!(columns.len(), all.len());
        let mut packet = RayHits::<16>::EMPTY;
        columns.fill(1, 32, &mut packet.rays);
        assert_eq!(packet.rays.origin[2][11], 256.0 + 32.0 + 11.0);
        assert_eq!(packet.rays.t_far[11], 299.5);
        assert_eq!(packet.rays.t_far[12], 0.0);
    }
}
