//! A tile's hits, once it is known who wins: eight pixels at a time, what the judge would say about each.

use super::Work;
use crate::accel::{
    BLOCK, Common, Corners, InLanes, MeshTree, Pencil, Tile, Winner, pixel, turned, verdict,
};
use crate::geometry::Hit;
use crate::geometry::arithmetic::quotient_by_inverse;
use crate::scene::Object;
use crate::shape::Mesh;
use crate::shoot::hits::{BlockOfHits, HitSlices};
use crate::shoot::plan::tileable;
use crate::simd::{LANES, Lanes, WIDE};

/// An object as a tile sees it.
#[derive(Clone, Copy)]
struct Sight<'a> {
    index: u32,
    object: &'a Object,
    mesh: &'a Mesh,
    tree: &'a MeshTree,
}

impl Work<'_> {
    fn sight(&self, index: u32) -> Option<Sight<'_>> {
        let (mesh, tree) = tileable(self.plan.scene, index)?;
        let object = &self.plan.scene.objects()[index as usize];
        Some(Sight {
            index,
            object,
            mesh,
            tree,
        })
    }

    /// Writes the hits.
    #[inline(always)]
    pub(super) fn develop<L: Lanes>(
        &self,
        l: L,
        found: &Tile,
        [rows, columns]: [usize; 2],
        out: &mut HitSlices<'_>,
    ) {
        let mut sight: Option<Sight<'_>> = None;
        let mut common: Option<Common> = None;
        'blocks: for block in 0..LANES {
            let (row, column) = pixel(block, 0);
            if row >= rows || column >= columns {
                continue;
            }
            let at = self.at(row) + column;
            let (slots, objects) = found.block(block);
            let mut hits = BlockOfHits::MISSES;
            let all = l.load(objects);
            let mut left = !l.same(all, l.splat(f32::from_bits(Winner::NONE.object)));
            while left != 0 {
                let object = objects[left.trailing_zeros() as usize % LANES];
                let here = left & l.same(all, l.splat(object));
                left &= !here;
                let index = object.to_bits();
                if sight.is_none_or(|sight| sight.index != index) {
                    sight = self.sight(index);
                    common = None;
                }
                if let Some(sight) = &sight {
                    if here == u16::MAX
                        && self.develop_block(l, sight, (slots, &mut common), block, (at, out))
                    {
                        continue 'blocks;
                    }
                    self.develop_object(l, sight, (slots, here), block, &mut hits);
                }
            }
            let size = [rows - row, columns - column].map(|n| n.min(BLOCK));
            hits.write(at, size, out);
        }
    }

    /// Writes the hits of a block whose pixels all meet one object; `false` where anything is special.
    #[inline(always)]
    fn develop_block<L: Lanes>(
        &self,
        l: L,
        sight: &Sight<'_>,
        (slots, common): (&[f32; LANES], &mut Option<Common>),
        block: usize,
        (at, out): (usize, &mut HitSlices<'_>),
    ) -> bool {
        let is_one = !l.same(l.load(slots), l.splat(slots[0])) == 0;
        if is_one {
            return self.develop_triangle(l, sight, (slots[0].to_bits(), common), block, (at, out));
        }
        let mut primitives = [0.0; LANES];
        let corners = Corners::new(
            l,
            (sight.tree, sight.mesh),
            (slots, u16::MAX),
            &mut primitives,
        );
        macro_rules! half {
            ($half:literal) => {{
                let rays = self.pencil(l, sight, 2 * block + $half);
                verdict(l, &rays, &corners, $half, u8::MAX)
            }};
        }
        let ((sound, first), (sound_too, second)) = (half!(0), half!(1));
        if sound & sound_too != u8::MAX {
            return false;
        }
        let object = sight.index.cast_signed();
        out.put_block(
            l,
            at,
            object,
            bytemuck::cast_ref(&primitives),
            [first, second],
        );
        true
    }

    /// The same for a block whose pixels all meet one triangle.
    #[inline(always)]
    fn develop_triangle<L: Lanes>(
        &self,
        l: L,
        sight: &Sight<'_>,
        (slot, common): (u32, &mut Option<Common>),
        block: usize,
        (at, out): (usize, &mut HitSlices<'_>),
    ) -> bool {
        let rays = self.pencil(l, sight, 2 * block);
        if common.as_ref().is_none_or(|common| !common.is(slot)) {
            *common = Some(Common::new(l, (sight.tree, sight.mesh), slot, &rays));
        }
        let Some(common) = common else { return false };
        let (sound, first) = common.verdict(l, &rays);
        let (sound_too, second) = common.verdict(l, &self.pencil(l, sight, 2 * block + 1));
        if sound & sound_too != u8::MAX {
            return false;
        }
        let primitives = [common.triangle(); LANES];
        out.put_block(
            l,
            at,
            sight.index.cast_signed(),
            bytemuck::cast_ref(&primitives),
            [first, second],
        );
        true
    }

    #[inline(always)]
    fn develop_object<L: Lanes>(
        &self,
        l: L,
        sight: &Sight<'_>,
        (slots, here): (&[f32; LANES], u16),
        block: usize,
        hits: &mut BlockOfHits,
    ) {
        let object = l.splat(f32::from_bits(sight.index));
        let objects = bytemuck::cast_mut(&mut hits.object);
        l.store(l.select(here, object, l.load(objects)), objects);
        let corners = Corners::new(
            l,
            (sight.tree, sight.mesh),
            (slots, here),
            bytemuck::cast_mut(&mut hits.primitive),
        );
        for half in 0..2 {
            let [low, high] = here.to_le_bytes();
            let lanes = if half == 0 { low } else { high };
            if lanes == 0 {
                continue;
            }
            let rays = self.pencil(l, sight, 2 * block + half);
            let (sound, numbers) = verdict(l, &rays, &corners, half, lanes);
            hits.put_half(l, half, lanes & sound, numbers);
            let mut open = lanes & !sound;
            while open != 0 {
                let lane = WIDE * half + open.trailing_zeros() as usize;
                open &= open - 1;
                let winner = Winner {
                    object: sight.index,
                    slot: slots[lane % LANES].to_bits(),
                };
                let (row, column) = pixel(block, lane);
                let hit = self.decide(l, row, column, winner).unwrap_or(Hit::MISS);
                hits.put(lane, &hit);
            }
        }
    }

    /// The rays of half a block's pixels in an object's space: what [`Rays::ray`] and `ray_in_object` give, bit for bit.
    #[inline(always)]
    #[expect(clippy::too_many_lines, reason = "a macro for vectors is a part of it")]
    fn pencil<L: Lanes>(&self, l: L, sight: &Sight<'_>, half: usize) -> Pencil<L> {
        let object = sight.object;
        let grid = &self.plan.grid;
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
            (
                vector!(k => rays.origin(l, half, k)),
                vector!(k => rays.direction(l, half, k)),
            )
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
            (
                origin,
                vector!(k => quotient_by_inverse(InLanes(l), point[k], length, inverse)),
            )
        };
        let place = object.transform().world_from_object().translation;
        let matrix = &object.transform().object_from_world().matrix3;
        if object.transform().is_identity() {
            return Pencil { origin, direction };
        }
        let moved = vector!(k => l.sub64(origin[k], l.splat64(place[k])));
        Pencil {
            origin: vector!(k => turned(l, matrix, k, &moved)),
            direction: vector!(k => turned(l, matrix, k, &direction)),
        }
    }
}
