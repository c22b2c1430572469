//! Mode TRIANGLES: triangles as edges and vertices met shortly before.

use super::stream::{Decoded, Stream, TRUNCATED, push_index, unzigzag};

const HEADER: u8 = 0xe1;
/// The table of common codes at the end.
const TABLE: usize = 16;

/// The latest 16 of something; those that never came are zero.
#[derive(Default)]
struct Latest<T> {
    ring: [T; 16],
    next: usize,
}

impl<T: Copy + Default> Latest<T> {
    fn push(&mut self, value: T) {
        if let Some(place) = self.ring.get_mut(self.next) {
            *place = value;
        }
        self.next = (self.next + 1) % 16;
    }

    /// The element `age` before the latest.
    fn get(&self, age: u8) -> T {
        let place = (self.next + 31 - usize::from(age & 15)) % 16;
        self.ring.get(place).copied().unwrap_or_default()
    }
}

#[derive(Default)]
struct State {
    /// The lowest index that has not occurred.
    next: u32,
    /// The latest index that was spelled out.
    last: u32,
    edges: Latest<[u32; 2]>,
    vertices: Latest<u32>,
}

impl State {
    fn fresh(&mut self) -> u32 {
        let index = self.next;
        self.next = self.next.wrapping_add(1);
        index
    }

    fn spelled(&mut self, data: &mut Stream<'_>) -> Decoded<u32> {
        self.last = self.last.wrapping_add(unzigzag(data.varint()?));
        Ok(self.last)
    }

    /// A triangle that has an edge of an earlier one.
    fn on_edge(&mut self, edge: u8, vertex: u8, data: &mut Stream<'_>) -> Decoded<[u32; 3]> {
        let [a, b] = self.edges.get(edge);
        let c = match vertex {
            0 => self.fresh(),
            1..=12 => self.vertices.get(vertex),
            13 => {
                self.last = self.last.wrapping_sub(1);
                self.last
            }
            14 => {
                self.last = self.last.wrapping_add(1);
                self.last
            }
            _ => self.spelled(data)?,
        };
        if !(1..=12).contains(&vertex) {
            self.vertices.push(c);
        }
        self.edges.push([c, b]);
        self.edges.push([a, c]);
        Ok([a, b, c])
    }

    /// A triangle without such an edge; `is_first_fresh`: its first index is the next one.
    fn apart(
        &mut self,
        is_first_fresh: bool,
        codes: u8,
        data: &mut Stream<'_>,
    ) -> Decoded<[u32; 3]> {
        let a = if is_first_fresh { self.fresh() } else { self.spelled(data)? };
        let (b, is_b_new) = self.corner(codes >> 4, data)?;
        let (c, is_c_new) = self.corner(codes & 15, data)?;
        self.vertices.push(a);
        for (vertex, is_new) in [(b, is_b_new), (c, is_c_new)] {
            if is_new {
                self.vertices.push(vertex);
            }
        }
        for edge in [[b, a], [c, b], [a, c]] {
            self.edges.push(edge);
        }
        Ok([a, b, c])
    }

    /// The second or third index, and whether it is to be remembered.
    fn corner(&mut self, code: u8, data: &mut Stream<'_>) -> Decoded<(u32, bool)> {
        Ok(match code {
            0 => (self.fresh(), true),
            15 => (self.spelled(data)?, true),
            _ => (self.vertices.get(code - 1), false),
        })
    }
}

pub(super) fn decode(
    source: &[u8],
    count: usize,
    stride: usize,
    bytes: &mut Vec<u8>,
) -> Decoded<()> {
    if !count.is_multiple_of(3) {
        return Err("the count of mode TRIANGLES must be divisible by 3");
    }
    let body = source.len().checked_sub(TABLE).ok_or(TRUNCATED)?;
    let (body, table) = source.split_at_checked(body).ok_or(TRUNCATED)?;
    let mut data = Stream { rest: body };
    if data.byte()? != HEADER {
        return Err("the packed bytes are not of mode TRIANGLES");
    }
    let codes = data.take(count / 3)?;
    let mut state = State::default();
    for &code in codes {
        let (high, low) = (code >> 4, code & 15);
        let triangle = if high < 15 {
            state.on_edge(high, low, &mut data)?
        } else if low < 14 {
            let codes = table.get(usize::from(low)).copied().unwrap_or_default();
            if codes >> 4 == 15 || codes & 15 == 15 {
                return Err("the table of the packed bytes has a code that it must not have");
            }
            state.apart(true, codes, &mut data)?
        } else {
            let codes = data.byte()?;
            if codes == 0 {
                state.next = 0;
            }
            state.apart(low == 14, codes, &mut data)?
        };
        for index in triangle {
            push_index(index, stride, bytes);
        }
    }
    data.finish()
}
