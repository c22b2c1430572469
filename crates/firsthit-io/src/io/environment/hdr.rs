//! Radiance's pictures (.hdr, .pic): four bytes a texel, three mantissas and an exponent (Ward,
//! "Real Pixels", Graphics Gems II, 1991).
//!
//! 1. Lines of text: the magic word, variables, comments; an empty line ends them.
//! 2. A line with the size, which says in which order texels come: `-Y 512 +X 1024` is row by row
//!    from the top left.
//! 3. The texels, line by line. A line is packed in the new way, each of its four components by
//!    itself; in the old way, where a texel of 1, 1, 1, n repeats the one before; or not at all.

use super::{Picture, charge};
use crate::error::{Place, escape_controls};
use crate::io::fault::{Checked, Fault};
use crate::io::report::Report;

pub(super) fn read(bytes: &[u8], report: &mut Report) -> Checked<Picture> {
    let mut source = ByteReader { bytes, at: 0 };
    header(&mut source, report)?;
    let order = Order::of(&mut source)?;
    let (lines, length) = (order.lines, order.length);
    charge(order.columns() as u64, order.rows() as u64, report)?;
    // The best packed line has two bytes for 127 of a component; in the old way one texel repeats
    // up to 2^24 times.
    let mut texels = crate::memory::filled(lines * length, [0.0; 3])?;
    let mut line = crate::memory::filled(length, [0; 4])?;
    for number in 0..lines {
        source.scan(&mut line)?;
        for (k, &texel) in line.iter().enumerate() {
            if let Some(place) = texels.get_mut(order.place(number, k)) {
                *place = decoded(texel);
            }
        }
    }
    Ok(Picture { columns: order.columns(), rows: order.rows(), texels })
}

/// Mantissas over 256, times two to the power of the exponent less 128: exact in float32.
fn decoded([red, green, blue, exponent]: [u8; 4]) -> [f32; 3] {
    // A power of two from its bits: 2^(e - 136), which is less than normal for e below 10.
    let exponent = u32::from(exponent);
    let scale = match exponent {
        0 => 0.0,
        1..10 => f32::from_bits(1 << (exponent + 13)),
        _ => f32::from_bits((exponent - 9) << 23),
    };
    [red, green, blue].map(|mantissa| f32::from(mantissa) * scale)
}

/// The lines of text up to the empty one.
fn header(source: &mut ByteReader<'_>, report: &mut Report) -> Checked<()> {
    loop {
        let start = source.at;
        let line = source.line()?;
        let place = || Place::Byte(start as u64);
        if line.is_empty() {
            return Ok(());
        }
        if let Some(format) = line.strip_prefix("FORMAT=")
            && format.trim() != "32-bit_rle_rgbe"
        {
            let format = escape_controls(format.trim());
            let what = format!("its format is {format}; only 32-bit_rle_rgbe is read");
            return Err(Fault::at(place(), what));
        }
        let factor = ["EXPOSURE=", "COLORCORR="];
        if let Some(value) = factor.iter().find_map(|name| line.strip_prefix(name)) {
            let is_one = |word: &str| word.parse::<f64>().is_ok_and(|value| value == 1.0);
            if !value.split_whitespace().all(is_one) {
                let line = escape_controls(&line);
                report.warn("exposure", &place(), || {
                    format!(
                        "{line} is not undone, as in other programs: texels are taken as they are"
                    )
                });
            }
        }
    }
}

/// The order of the texels.
struct Order {
    lines: usize,
    length: usize,
    /// Whether lines are rows of the picture, not columns.
    of_rows: bool,
    /// Whether rows come from the bottom.
    from_bottom: bool,
    /// Whether columns come from the right.
    from_right: bool,
}

impl Order {
    /// Reads the order from the line with the size.
    fn of(source: &mut ByteReader<'_>) -> Checked<Self> {
        let start = source.at;
        let line = source.line()?;
        let words: Vec<&str> = line.split_whitespace().collect();
        let order = if let [first, lines, second, length] = words[..] {
            Self::named(first, second, number(lines), number(length))
        } else {
            None
        };
        order.ok_or_else(|| {
            let line = escape_controls(&line);
            let what = format!("the size must be as in \"-Y 512 +X 1024\", got \"{line}\"");
            Fault::at(Place::Byte(start as u64), what)
        })
    }

    fn named(
        first: &str,
        second: &str,
        lines: Option<usize>,
        length: Option<usize>,
    ) -> Option<Self> {
        // The sign says how coordinates run along the lines: y goes up, x to the right.
        let (of_rows, y, x) = match (first, second) {
            ("-Y" | "+Y", "-X" | "+X") => (true, first, second),
            ("-X" | "+X", "-Y" | "+Y") => (false, second, first),
            _ => return None,
        };
        Some(Self {
            lines: lines?,
            length: length?,
            of_rows,
            from_bottom: y == "+Y",
            from_right: x == "-X",
        })
    }

    fn columns(&self) -> usize {
        if self.of_rows { self.length } else { self.lines }
    }

    fn rows(&self) -> usize {
        if self.of_rows { self.lines } else { self.length }
    }

    /// The index in the picture, row by row from the top left, of a texel of a line.
    fn place(&self, line: usize, index: usize) -> usize {
        let (row, column) = if self.of_rows { (line, index) } else { (index, line) };
        let row = if self.from_bottom { self.rows() - 1 - row } else { row };
        let column = if self.from_right { self.columns() - 1 - column } else { column };
        row * self.columns() + column
    }
}

/// A size: at most what 32 bits hold.
fn number(word: &str) -> Option<usize> {
    usize::try_from(word.parse::<u32>().ok()?).ok()
}

/// The bytes, and how far they have been read.
struct ByteReader<'a> {
    bytes: &'a [u8],
    at: usize,
}

/// Longer lines are no header's.
const LONGEST: usize = 4096;

impl ByteReader<'_> {
    /// The next line, without its end.
    fn line(&mut self) -> Checked<String> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let within = rest.get(..LONGEST).unwrap_or(rest);
        let Some(length) = memchr::memchr(b'\n', within) else {
            return Err(self.fault("the header does not end"));
        };
        self.at += length + 1;
        let line = within.get(..length).unwrap_or_default();
        Ok(String::from_utf8_lossy(line.strip_suffix(b"\r").unwrap_or(line)).into_owned())
    }

    fn four(&mut self) -> Checked<[u8; 4]> {
        let four = self.bytes.get(self.at..).and_then(<[u8]>::first_chunk);
        let four = *four.ok_or_else(|| self.too_short())?;
        self.at += 4;
        Ok(four)
    }

    fn some(&mut self, count: usize) -> Checked<&[u8]> {
        let some = self.bytes.get(self.at..).and_then(|rest| rest.get(..count));
        let some = some.ok_or_else(|| self.too_short())?;
        self.at += count;
        Ok(some)
    }

    fn byte(&mut self) -> Checked<u8> {
        Ok(self.some(1)?.first().copied().unwrap_or(0))
    }

    /// The texels of the next line.
    fn scan(&mut self, line: &mut [[u8; 4]]) -> Checked<()> {
        let start = self.at;
        let [a, b, high, low] = self.four()?;
        let length = usize::from(u16::from_be_bytes([high, low]));
        // Lines of other lengths are never packed in the new way.
        let may_be_new = (8..0x8000).contains(&line.len());
        if may_be_new && [a, b] == [2, 2] && high < 128 {
            if length != line.len() {
                let what = format!("a line of {length} texels, where {} are in each", line.len());
                return Err(Fault::at(Place::Byte(start as u64), what));
            }
            return (0..4).try_for_each(|component| self.component(component, line));
        }
        self.at = start;
        self.old(line)
    }

    /// One component of a line that is packed in the new way: runs, and bytes as they are.
    fn component(&mut self, component: usize, line: &mut [[u8; 4]]) -> Checked<()> {
        let mut left = line.len();
        let mut places = line.iter_mut().filter_map(|texel| texel.get_mut(component));
        while left > 0 {
            let start = self.at;
            let code = usize::from(self.byte()?);
            let (count, is_run) = if code > 128 { (code - 128, true) } else { (code, false) };
            if count == 0 || count > left {
                let what = format!("a run of {count} texels, where {left} are left in the line");
                return Err(Fault::at(Place::Byte(start as u64), what));
            }
            left -= count;
            if is_run {
                let value = self.byte()?;
                places.by_ref().take(count).for_each(|place| *place = value);
            } else {
                // The values first: else a place is taken for which there is no value left.
                let values = self.some(count)?.iter();
                values.zip(places.by_ref()).for_each(|(&value, place)| *place = value);
            }
        }
        Ok(())
    }

    /// A line that is packed in the old way, or not at all.
    fn old(&mut self, line: &mut [[u8; 4]]) -> Checked<()> {
        let mut done = 0;
        // Repetitions one after the other are the digits of a number to the base 256.
        let mut shift = 0;
        while done < line.len() {
            let start = self.at;
            let texel = self.four()?;
            let [1, 1, 1, count] = texel else {
                if let Some(place) = line.get_mut(done) {
                    *place = texel;
                }
                (done, shift) = (done + 1, 0);
                continue;
            };
            let left = line.len() - done;
            let count = usize::from(count).checked_shl(shift).unwrap_or(usize::MAX);
            let before = done.checked_sub(1).and_then(|before| line.get(before)).copied();
            let (Some(before), true) = (before, count <= left && shift <= 16) else {
                let what = format!(
                    "the texel before is repeated {count} times, where {left} are left in the line"
                );
                return Err(Fault::at(Place::Byte(start as u64), what));
            };
            let places = line.iter_mut().skip(done).take(count);
            places.for_each(|place| *place = before);
            (done, shift) = (done + count, shift + 8);
        }
        Ok(())
    }

    fn too_short(&self) -> Fault {
        self.fault("the file ends too early")
    }

    fn fault(&self, what: &str) -> Fault {
        Fault::at(Place::Byte(self.bytes.len().min(self.at) as u64), what)
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::io::LoadSettings;

    fn picture(bytes: &[u8]) -> Picture {
        let mut report = Report::new(Path::new("sky.hdr"), LoadSettings::default(), &());
        read(bytes, &mut report).unwrap()
    }

    /// A row of 8 texels, its components packed in every way in which a row may be: one packet,
    /// several, and runs between them.
    #[test]
    fn packets_follow_each_other_without_a_gap() {
        let values: Vec<u8> = (1..9).map(|k| 16 * k).collect();
        let packed = |lengths: &[usize]| {
            let mut row = vec![2, 2, 0, 8];
            for _ in 0..3 {
                let mut at = 0;
                for &length in lengths {
                    row.push(u8::try_from(length).unwrap());
                    row.extend(&values[at..at + length]);
                    at += length;
                }
            }
            row.extend([0x84, 136, 0x84, 136]);
            row
        };
        let expected: Vec<f32> = values.iter().map(|&value| f32::from(value)).collect();
        for lengths in [&[8][..], &[4, 4], &[1, 7], &[3, 2, 3], &[1; 8]] {
            let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 8\n".to_vec();
            bytes.extend(packed(lengths).repeat(2));
            let picture = picture(&bytes);
            let reds: Vec<f32> = picture.texels.iter().map(|texel| texel[0]).collect();
            assert_eq!(reds, [&expected[..], &expected[..]].concat(), "{lengths:?}");
        }
        // A run between two packets.
        let mut bytes = b"#?RADIANCE\n\n-Y 1 +X 8\n".to_vec();
        bytes.extend([2, 2, 0, 8]);
        bytes.extend([2, 1, 2, 0x83, 9, 3, 3, 4, 5].repeat(3));
        bytes.extend([0x88, 136]);
        let picture = picture(&bytes);
        let reds: Vec<f32> = picture.texels.iter().map(|texel| texel[1]).collect();
        assert_eq!(reds, [1.0, 2.0, 9.0, 9.0, 9.0, 3.0, 4.0, 5.0]);
    }
}
