//! The numbers behind a header.

use super::super::output::collected;
use super::header::{NpyHeader, wrong};

/// The numbers of an array, row by row whatever its order in the file.
#[derive(Debug, Clone, PartialEq)]
pub enum NpyValues {
    /// float64.
    Float64(Vec<f64>),
    /// float32.
    Float32(Vec<f32>),
    /// Whole numbers of 1 to 8 bytes but for uint64; of bool, 0 and 1.
    Whole(Vec<i64>),
    /// uint64.
    Unsigned(Vec<u64>),
}

impl NpyHeader {
    /// The numbers in `data`, the bytes behind the header; `None` where [`NpyHeader::dtype`] is.
    ///
    /// # Errors
    ///
    /// In words: for less data than the shape claims, for a bool that is neither 0 nor 1, and where
    /// no memory is free.
    pub fn values(&self, data: &[u8]) -> Result<Option<NpyValues>, String> {
        let Some(dtype) = self.dtype() else {
            return Ok(None);
        };
        Ok(Some(match dtype {
            "float64" => NpyValues::Float64(self.numbers(data, f64::from_le_bytes)?),
            "float32" => NpyValues::Float32(self.numbers(data, f32::from_le_bytes)?),
            "uint64" => NpyValues::Unsigned(self.numbers(data, u64::from_le_bytes)?),
            "int64" => NpyValues::Whole(self.numbers(data, i64::from_le_bytes)?),
            "int32" => NpyValues::Whole(self.numbers(data, |b| i32::from_le_bytes(b).into())?),
            "int16" => NpyValues::Whole(self.numbers(data, |b| i16::from_le_bytes(b).into())?),
            "int8" => NpyValues::Whole(self.numbers(data, |b| i8::from_le_bytes(b).into())?),
            "uint32" => NpyValues::Whole(self.numbers(data, |b| u32::from_le_bytes(b).into())?),
            "uint16" => NpyValues::Whole(self.numbers(data, |b| u16::from_le_bytes(b).into())?),
            "uint8" => NpyValues::Whole(self.numbers(data, |[byte]| byte.into())?),
            _ => {
                let flags: Vec<i64> = self.numbers(data, |[byte]| byte.into())?;
                match flags.iter().find(|&&flag| flag > 1) {
                    Some(flag) => {
                        let what = format!("a bool must be 0 or 1, got {flag}");
                        return Err(wrong(&what));
                    }
                    None => NpyValues::Whole(flags),
                }
            }
        }))
    }

    /// The elements of `B` bytes that the shape counts, each made of its bytes in little-endian
    /// order.
    fn numbers<T: Copy, const B: usize>(
        &self,
        data: &[u8],
        number: impl Fn([u8; B]) -> T,
    ) -> Result<Vec<T>, String> {
        let sides = self.shape.iter().map(|&side| usize::try_from(side).ok());
        let shape: Option<Vec<usize>> = sides.collect();
        let count = shape.as_ref().and_then(|shape| {
            (shape.iter()).try_fold(1_usize, |count, &side| count.checked_mul(side))
        });
        let (elements, _) = data.as_chunks::<B>();
        let (Some(shape), Some(elements)) = (shape, count.and_then(|count| elements.get(..count)))
        else {
            return Err(format!(
                "the array of shape {:?} is longer than the file, which holds {} bytes of it",
                self.shape,
                data.len()
            ));
        };
        let elements = elements.iter().copied();
        let values = if self.element.is_big_endian {
            let turned = elements.map(|mut bytes| {
                bytes.reverse();
                number(bytes)
            });
            collected(turned.len(), turned)?
        } else {
            collected(elements.len(), elements.map(number))?
        };
        if self.fortran_order && shape.len() > 1 {
            return in_c_order(&values, &shape);
        }
        Ok(values)
    }
}

/// Column by column to row by row.
fn in_c_order<T: Copy>(values: &[T], shape: &[usize]) -> Result<Vec<T>, String> {
    // Axes of length one move nothing.
    let sides = shape.iter().rev().copied().filter(|&side| side != 1);
    let sides: Vec<usize> = sides.collect();
    let place = |index: usize| {
        // The last axis runs fastest here and slowest there.
        let (mut rest, mut stride, mut place) = (index, values.len(), 0);
        for &side in &sides {
            stride /= side;
            place += rest % side * stride;
            rest /= side;
        }
        place
    };
    let ordered = (0..values.len()).filter_map(|index| values.get(place(index)).copied());
    collected(values.len(), ordered)
}

#[cfg(test)]
mod tests {
    use super::super::header::tests::{dictionary, file};
    use super::*;

    #[test]
    fn numbers_of_every_type_and_order_are_read() {
        let values = |descr: &str, order: &str, shape: &str, data: &[u8]| {
            let file = file(1, &dictionary(&format!("'{descr}'"), order, shape), data);
            let (header, data) = NpyHeader::parse(&file).unwrap();
            header.values(data).unwrap()
        };
        let whole = |values: &[i64]| Some(NpyValues::Whole(values.to_vec()));
        assert_eq!(values("|i1", "False", "(2,)", &[1, 255]), whole(&[1, -1]));
        assert_eq!(values("|u1", "False", "(2,)", &[1, 255]), whole(&[1, 255]));
        assert_eq!(values("|b1", "False", "(2,)", &[1, 0]), whole(&[1, 0]));
        assert_eq!(values(">i2", "False", "(2,)", &[0, 1, 255, 254]), whole(&[1, -2]));
        assert_eq!(values("<u2", "False", "(1,)", &[255, 255]), whole(&[65535]));
        assert_eq!(values(">u4", "False", "()", &[255, 0, 0, 0]), whole(&[0xff00_0000]));
        assert_eq!(values("<i8", "False", "()", &(-7_i64).to_le_bytes()), whole(&[-7]));
        let large = Some(NpyValues::Unsigned(vec![u64::MAX]));
        assert_eq!(values(">u8", "False", "(1,)", &[255; 8]), large);
        let singles = Some(NpyValues::Float32(vec![1.5]));
        assert_eq!(values(">f4", "False", "(1,)", &1.5_f32.to_be_bytes()), singles);
        let doubles = Some(NpyValues::Float64(vec![-0.1]));
        assert_eq!(values("<f8", "True", "(1,)", &(-0.1_f64).to_le_bytes()), doubles);
        // Columns of 0 1, 2 3, 4 5.
        let rows = whole(&[0, 2, 4, 1, 3, 5]);
        assert_eq!(values("|i1", "True", "(2, 3)", &[0, 1, 2, 3, 4, 5]), rows);
        let boxes = whole(&[0, 4, 2, 6, 1, 5, 3, 7]);
        assert_eq!(values("|i1", "True", "(2, 2, 2)", &[0, 1, 2, 3, 4, 5, 6, 7]), boxes);
        assert_eq!(values("|i1", "True", "(0, 3)", &[]), whole(&[]));
        assert_eq!(values("<f2", "False", "(1,)", &[0, 0]), None);
        assert_eq!(values("<U2", "False", "()", &[0; 8]), None);
    }

    #[test]
    fn data_that_ends_early_is_refused_and_more_is_not_read() {
        let header = dictionary("'<f4'", "False", "(4,)");
        for length in [0, 15, 16, 17] {
            let file = file(1, &header, &vec![0; length]);
            let (header, data) = NpyHeader::parse(&file).unwrap();
            match header.values(data) {
                Ok(values) => assert_eq!(values, Some(NpyValues::Float32(vec![0.0; 4]))),
                Err(error) => {
                    let words = format!(
                        "the array of shape [4] is longer than the file, which holds {length} bytes of it"
                    );
                    assert_eq!(error, words);
                    assert!(length < 16);
                }
            }
        }
        let header = dictionary("'|b1'", "False", "(2,)");
        let file = file(1, &header, &[1, 7]);
        let (header, data) = NpyHeader::parse(&file).unwrap();
        let error = header.values(data).unwrap_err();
        assert_eq!(error, "not a NumPy array: a bool must be 0 or 1, got 7");
    }
}
