//! Mode ATTRIBUTES: elements as differences from the ones before, byte by byte, in groups of 16.

use super::stream::{Decoded, Stream, TRUNCATED, unzigzag};

const GROUP: usize = 16;

/// The form of the differences of four bytes (version 1 of the stream).
#[derive(Clone, Copy)]
enum Channel {
    Bytes,
    Pairs,
    /// Differences by exclusive or, rotated by this many bits.
    Words(u32),
}

/// A stream, and the parameters at its end.
struct Parts<'a> {
    version: u8,
    body: &'a [u8],
    first: &'a [u8],
    channels: Vec<Channel>,
}

fn parts(source: &[u8], stride: usize) -> Decoded<Parts<'_>> {
    let (&header, rest) = source.split_first().ok_or(TRUNCATED)?;
    let version = match header {
        0xa0 => 0,
        0xa1 => 1,
        _ => return Err("the packed bytes are not of mode ATTRIBUTES"),
    };
    let (modes, padded) = match version {
        0 => (0, stride.max(32)),
        _ => (stride / 4, (stride + stride / 4).max(24)),
    };
    let body = rest.len().checked_sub(padded).ok_or(TRUNCATED)?;
    let (body, tail) = rest.split_at_checked(body).ok_or(TRUNCATED)?;
    let tail = tail.get(padded - stride - modes..).ok_or(TRUNCATED)?;
    let (first, modes) = tail.split_at_checked(stride).ok_or(TRUNCATED)?;
    let channels = modes.iter().map(|mode| match mode & 3 {
        0 => Ok(Channel::Bytes),
        1 => Ok(Channel::Pairs),
        2 => Ok(Channel::Words(u32::from(mode >> 4))),
        _ => Err("the packed bytes have a channel of an unknown kind"),
    });
    let channels: Decoded<Vec<_>> = match version {
        0 => Ok(vec![Channel::Bytes; stride / 4]),
        _ => channels.collect(),
    };
    Ok(Parts { version, body, first, channels: channels? })
}

fn block_size(stride: usize) -> usize {
    ((8192 / stride) & !15).min(256)
}

/// Refuses a stream that is shorter than any stream of `count` elements.
pub(super) fn check(source: &[u8], count: usize, stride: usize) -> Decoded<()> {
    let parts = parts(source, stride)?;
    let blocks = count.div_ceil(block_size(stride));
    // For each block, version 0 has a byte at least of each byte of an element, version 1 two bits.
    let least = if parts.version == 0 { stride } else { stride / 4 };
    match blocks.checked_mul(least) {
        Some(least) if least <= parts.body.len() => Ok(()),
        _ => Err(TRUNCATED),
    }
}

pub(super) fn decode(
    source: &[u8],
    count: usize,
    stride: usize,
    bytes: &mut Vec<u8>,
) -> Decoded<()> {
    let Parts { version, body, first, channels } = parts(source, stride)?;
    let mut stream = Stream { rest: body };
    let mut last = first.to_vec();
    let block = block_size(stride);
    let mut codes = vec![0; block * stride];
    let mut left = count;
    while left > 0 {
        let elements = left.min(block);
        let controls = match version {
            0 => &[][..],
            _ => stream.take(stride / 4)?,
        };
        // A row of the codes of each byte of an element.
        for (byte, row) in codes.chunks_mut(block).enumerate() {
            let control = match version {
                0 => None,
                _ => controls.get(byte / 4).map(|&four| (four >> (2 * (byte % 4))) & 3),
            };
            read_row(&mut stream, control, row, elements)?;
        }
        for element in 0..elements {
            let code = |byte: usize| codes.get(byte * block + element).copied();
            for (k, (channel, word)) in channels.iter().zip(last.chunks_mut(4)).enumerate() {
                let codes = std::array::from_fn(|byte| code(4 * k + byte).unwrap_or_default());
                advance(*channel, word, codes);
            }
            bytes.extend_from_slice(&last);
        }
        left -= elements;
    }
    stream.finish()
}

/// The codes of one byte of all elements of a block. `control` is version 1's choice of widths.
fn read_row(
    stream: &mut Stream<'_>,
    control: Option<u8>,
    row: &mut [u8],
    elements: usize,
) -> Decoded<()> {
    let widths = match control {
        None => [0, 2, 4, 8],
        Some(0) => [0, 1, 2, 4],
        Some(1) => [1, 2, 4, 8],
        Some(2) => {
            row.fill(0);
            return Ok(());
        }
        Some(_) => {
            let spelled = stream.take(elements)?;
            row.iter_mut().zip(spelled).for_each(|(code, &byte)| *code = byte);
            return Ok(());
        }
    };
    let groups = elements.div_ceil(GROUP);
    let header = stream.take(groups.div_ceil(4))?;
    for (k, group) in row.chunks_mut(GROUP).take(groups).enumerate() {
        let four = header.get(k / 4).copied().unwrap_or_default();
        let choice = usize::from((four >> (2 * (k % 4))) & 3);
        read_group(stream, widths.get(choice).copied().unwrap_or_default(), group)?;
    }
    Ok(())
}

/// Sixteen codes of `width` bits each. A code of ones stands for a byte behind the codes.
fn read_group(stream: &mut Stream<'_>, width: u32, group: &mut [u8]) -> Decoded<()> {
    if width == 0 {
        group.fill(0);
        return Ok(());
    }
    let packed = stream.take(2 * width as usize)?;
    if width == 8 {
        group.copy_from_slice(packed);
        return Ok(());
    }
    let (in_byte, ones) = (8 / width as usize, (1_u8 << width) - 1);
    for (k, code) in group.iter_mut().enumerate() {
        let byte = packed.get(k / in_byte).copied().unwrap_or_default();
        let place = k % in_byte;
        // Single bits begin at the low end of a byte, wider codes at the high end.
        let place = if width == 1 { place } else { in_byte - 1 - place };
        *code = (byte >> (place * width as usize)) & ones;
        if *code == ones {
            *code = stream.byte()?;
        }
    }
    Ok(())
}

/// Moves four bytes on to the next element.
#[expect(clippy::cast_possible_truncation, reason = "sums wrap around in 8 and 16 bits")]
fn advance(channel: Channel, word: &mut [u8], codes: [u8; 4]) {
    match channel {
        Channel::Bytes => {
            for (byte, code) in word.iter_mut().zip(codes) {
                *byte = byte.wrapping_add(unzigzag(code.into()) as u8);
            }
        }
        Channel::Pairs => {
            let pairs = word.as_chunks_mut::<2>().0.iter_mut();
            for (pair, code) in pairs.zip(codes.as_chunks::<2>().0) {
                let difference = unzigzag(u16::from_le_bytes(*code).into()) as u16;
                let sum = u16::from_le_bytes(*pair).wrapping_add(difference);
                *pair = sum.to_le_bytes();
            }
        }
        Channel::Words(turn) => {
            for word in word.as_chunks_mut::<4>().0 {
                let difference = u32::from_le_bytes(codes).rotate_right(turn);
                *word = (u32::from_le_bytes(*word) ^ difference).to_le_bytes();
            }
        }
    }
}
