//! A tile's hits from its visibility buffer: eight pixels at a time, the exact test's own numbers.

use super::square::BlockOfHits;
use super::tile::TileTask;
use crate::accel::{
    BLOCK, Corners, MeshTree, RayBundle, SharedTriangle, TriangleId, VisibilityBuffer,
    eight_crossings, product_along, row_and_column,
};
use crate::geometry::Hit;
use crate::geometry::arithmetic::quotient_by_inverse;
use crate::scene::{Object, Scene};
use crate::shape::Meshes;
use crate::shoot::hits::HitSlices;
use crate::simd::{InLanes, LANES, Lanes, WIDE, set_bits};

/// An object as a tile sees it.
#[derive(Clone, Copy)]
struct SeenObject<'a> {
    index: u32,
    object: &'a Object,
    mesh: Meshes<'a>,
    tree: &'a MeshTree,
}

impl SeenObject<'_> {
    /// The object of each triangle; the triangles' numbers become those in their objects.
    #[inline(always)]
    fn objects(&self, scene: &Scene, primitives: &mut [i32; LANES]) -> [i32; LANES] {
        if self.mesh.one().is_some() {
            return [self.index.cast_signed(); LANES];
        }
        let numbers = *primitives;
        let mut objects = [-1; LANES];
        for lane in 0..LANES {
            // Most are of one object, or of two.
            if objects[lane] >= 0 {
                continue;
            }
            let first = scene.surface_at(self.index, numbers[lane]);
            (objects[lane], primitives[lane]) = (first.object, first.primitive);
            // No `unwrap_or_default`: of an array it is not inlined (`.ci/inlined`).
            let range = scene.numbers_of(first.object.cast_unsigned()).unwrap_or([0; 2]);
            let [start, end] = range.map(u32::cast_signed);
            for (k, &number) in numbers.iter().enumerate() {
                let is_same = start <= number && number < end;
                objects[k] = if is_same { first.object } else { objects[k] };
                primitives[k] = if is_same { number - start } else { primitives[k] };
            }
        }
        objects
    }
}

/// Writes the hits of a block, half by half, each with its mask; `false` where one of them is not
/// sound.
#[inline(always)]
fn put_sound<L: Lanes>(
    l: L,
    (at, out): (usize, &mut HitSlices<'_>),
    (scene, seen): (&Scene, &SeenObject<'_>),
    mut primitives: [i32; LANES],
    [(sound, first), (sound_too, second)]: [(u8, [L::Doubles; 3]); 2],
) -> bool {
    if sound & sound_too != u8::MAX {
        return false;
    }
    let objects = seen.objects(scene, &mut primitives);
    out.put_block(l, at, &objects, &primitives, [first, second]);
    true
}

impl TileTask<'_> {
    fn seen(&self, index: u32) -> Option<SeenObject<'_>> {
        let (mesh, tree) = self.plan.scene.plain_mesh(index)?;
        let object = &self.plan.scene.objects()[index as usize];
        Some(SeenObject { index, object, mesh, tree })
    }

    /// Writes the hits.
    #[inline(always)]
    pub(super) fn resolve<L: Lanes>(
        &self,
        l: L,
        found: &VisibilityBuffer,
        [rows, columns]: [usize; 2],
        out: &mut HitSlices<'_>,
    ) {
        let mut seen: Option<SeenObject<'_>> = None;
        let mut common: Option<SharedTriangle> = None;
        'blocks: for block in 0..LANES {
            let (row, column) = row_and_column(block, 0);
            if row >= rows || column >= columns {
                continue;
            }
            let at = self.at(row) + column;
            let (leaf_lanes, objects) = found.block(block);
            let mut hits = BlockOfHits::MISSES;
            let all = l.load(objects);
            let mut left = !l.same(all, l.splat(f32::from_bits(TriangleId::NONE.object)));
            while left != 0 {
                let object = objects[left.trailing_zeros() as usize % LANES];
                let here = left & l.same(all, l.splat(object));
                left &= !here;
                let index = object.to_bits();
                if seen.is_none_or(|seen| seen.index != index) {
                    seen = self.seen(index);
                    common = None;
                }
                if let Some(seen) = &seen {
                    if here == u16::MAX
                        && self.resolve_block(l, seen, (leaf_lanes, &mut common), block, (at, out))
                    {
                        continue 'blocks;
                    }
                    self.resolve_object(l, seen, (leaf_lanes, here), block, &mut hits);
                }
            }
            let size = [(rows - row).min(BLOCK), (columns - column).min(BLOCK)];
            hits.write(at, size, out);
        }
    }

    /// Writes the hits of a block whose pixels all meet one object; `false` where anything is
    /// special.
    #[inline(always)]
    fn resolve_block<L: Lanes>(
        &self,
        l: L,
        seen: &SeenObject<'_>,
        (leaf_lanes, common): (&[f32; LANES], &mut Option<SharedTriangle>),
        block: usize,
        (at, out): (usize, &mut HitSlices<'_>),
    ) -> bool {
        let is_one = !l.same(l.load(leaf_lanes), l.splat(leaf_lanes[0])) == 0;
        if is_one {
            return self.resolve_triangle(
                l,
                seen,
                (leaf_lanes[0].to_bits(), common),
                block,
                (at, out),
            );
        }
        let mut primitives = [0.0; LANES];
        let corners =
            Corners::new(l, (seen.tree, seen.mesh), (leaf_lanes, u16::MAX), &mut primitives);
        macro_rules! half {
            ($half:literal) => {{
                let rays = self.rays_in_object(l, seen, 2 * block + $half);
                eight_crossings(l, &rays, &corners, $half, u8::MAX)
            }};
        }
        let halves = [half!(0), half!(1)];
        let seen = (self.plan.scene, seen);
        put_sound(l, (at, out), seen, bytemuck::cast(primitives), halves)
    }

    /// Resolves a block whose pixels all meet one triangle.
    #[inline(always)]
    fn resolve_triangle<L: Lanes>(
        &self,
        l: L,
        seen: &SeenObject<'_>,
        (leaf_lane, common): (u32, &mut Option<SharedTriangle>),
        block: usize,
        (at, out): (usize, &mut HitSlices<'_>),
    ) -> bool {
        let rays = self.rays_in_object(l, seen, 2 * block);
        if common.as_ref().is_none_or(|common| !common.is(leaf_lane)) {
            *common = Some(SharedTriangle::new(l, (seen.tree, seen.mesh), leaf_lane, &rays));
        }
        let Some(common) = common else { return false };
        let first = common.eight_crossings(l, &rays);
        let second = common.eight_crossings(l, &self.rays_in_object(l, seen, 2 * block + 1));
        let primitives = [common.triangle(); LANES];
        put_sound(
            l,
            (at, out),
            (self.plan.scene, seen),
            bytemuck::cast(primitives),
            [first, second],
        )
    }

    #[inline(always)]
    fn resolve_object<L: Lanes>(
        &self,
        l: L,
        seen: &SeenObject<'_>,
        (leaf_lanes, here): (&[f32; LANES], u16),
        block: usize,
        hits: &mut BlockOfHits,
    ) {
        let object = l.splat(f32::from_bits(seen.index));
        let objects = bytemuck::cast_mut(&mut hits.object);
        l.store(l.select(here, object, l.load(objects)), objects);
        let corners = Corners::new(
            l,
            (seen.tree, seen.mesh),
            (leaf_lanes, here),
            bytemuck::cast_mut(&mut hits.primitive),
        );
        if seen.mesh.one().is_none() {
            for lane in set_bits(here) {
                let surface = self.plan.scene.surface_at(seen.index, hits.primitive[lane]);
                (hits.object[lane], hits.primitive[lane]) = (surface.object, surface.primitive);
            }
        }
        for half in 0..2 {
            let [low, high] = here.to_le_bytes();
            let lanes = if half == 0 { low } else { high };
            if lanes == 0 {
                continue;
            }
            let rays = self.rays_in_object(l, seen, 2 * block + half);
            let (sound, numbers) = eight_crossings(l, &rays, &corners, half, lanes);
            hits.put_half(l, half, lanes & sound, numbers);
            for lane in set_bits((lanes & !sound).into()) {
                let lane = WIDE * half + lane;
                let triangle = TriangleId {
                    object: seen.index,
                    leaf_lane: leaf_lanes[lane % LANES].to_bits(),
                };
                let (row, column) = row_and_column(block, lane);
                let hit = self.decide(l, row, column, triangle).unwrap_or(Hit::MISS);
                hits.put(lane, &hit);
            }
        }
    }

    /// The rays of half a block's pixels in an object's space: what `Rays::ray` and `ray_in_object`
    /// give, bit for bit.
    #[inline(always)]
    fn rays_in_object<L: Lanes>(&self, l: L, seen: &SeenObject<'_>, half: usize) -> RayBundle<L> {
        let object = seen.object;
        let grid = &self.grid;
        let (x, y) = (self.pixels.x(l, half), self.pixels.y(l, half));
        // The lanes of a vector: an expression for each axis.
        macro_rules! vector {
            ($axis:ident => $value:expr) => {
                [
                    {
                        let $axis = 0;
                        $value
                    },
                    {
                        let $axis = 1;
                        $value
                    },
                    {
                        let $axis = 2;
                        $value
                    },
                ]
            };
        }
        let toward = vector!(k => l.splat64(grid.toward[k]));
        let position = vector!(k => l.splat64(grid.position[k]));
        let point = vector!(k => {
            let across = l.mul64(x, l.splat64(grid.right[k]));
            let upwards = l.mul64(y, l.splat64(grid.upwards[k]));
            l.add64(l.add64(toward[k], across), upwards)
        });
        let (origin, direction) = if let Some(rays) = &self.rays {
            (vector!(k => rays.origin(l, half, k)), vector!(k => rays.direction(l, half, k)))
        } else if let Some(parallel) = grid.parallel {
            let start = if grid.starts_on_viewplane {
                point
            } else {
                vector!(k => l.sub64(point[k], toward[k]))
            };
            let origin = vector!(k => l.add64(position[k], start[k]));
            (origin, vector!(k => l.splat64(parallel[k])))
        } else {
            let squares = vector!(k => l.mul64(point[k], point[k]));
            let length = l.sqrt64(l.add64(l.add64(squares[0], squares[1]), squares[2]));
            let origin = if grid.starts_on_viewplane {
                vector!(k => l.add64(position[k], point[k]))
            } else {
                position
            };
            let inverse = l.div64(l.splat64(1.0), length);
            // The quotient is that of a division, see `plan.rs`.
            (origin, vector!(k => quotient_by_inverse(InLanes(l), point[k], length, inverse)))
        };
        let translation = object.transform().world_from_object().translation;
        let matrix = &object.transform().object_from_world().matrix3;
        if object.transform().is_identity() {
            return RayBundle { origin, direction };
        }
        let moved = vector!(k => l.sub64(origin[k], l.splat64(translation[k])));
        RayBundle {
            origin: vector!(k => product_along(l, matrix, k, &moved)),
            direction: vector!(k => product_along(l, matrix, k, &direction)),
        }
    }
}
