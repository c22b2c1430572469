//! Mode INDICES: a sequence of indices, each a difference from one of two before it.

use super::stream::{Decoded, Stream, TRUNCATED, push_index, unzigzag};

const HEADER: u8 = 0xd1;
const TAIL: usize = 4;

pub(super) fn decode(
    source: &[u8],
    count: usize,
    stride: usize,
    bytes: &mut Vec<u8>,
) -> Decoded<()> {
    let body = source.len().checked_sub(TAIL).ok_or(TRUNCATED)?;
    let mut stream = Stream { rest: source.get(..body).unwrap_or_default() };
    if stream.byte()? != HEADER {
        return Err("the packed bytes are not of mode INDICES");
    }
    let (mut even, mut odd) = (0_u32, 0_u32);
    for _ in 0..count {
        let code = stream.varint()?;
        let last = if code & 1 == 0 { &mut even } else { &mut odd };
        *last = last.wrapping_add(unzigzag(code >> 1));
        push_index(*last, stride, bytes);
    }
    stream.finish()
}
