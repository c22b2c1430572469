//! The header of a NumPy array: a dictionary, as a Python literal (`numpy.lib.format`, versions 1.0
//! to 3.0).

use super::element::Element;
use super::literal::{Value, dictionary};
use crate::error::escape_controls;

/// The first bytes of every array.
const MAGIC: &[u8] = b"\x93NUMPY";

/// Headers of plain arrays have a hundred bytes.
const LONGEST_HEADER: u64 = 1 << 16;

/// An upper bound on the elements that any file holds.
const MOST_ELEMENTS: u64 = 1 << 48;

/// The most axes, as in NumPy 2.
const MOST_AXES: usize = 64;

/// The header of a NumPy array (`.npy`): the type of its elements, its shape and its order.
/// [`NpyHeader::values`] reads the data behind it.
///
/// ```
/// use firsthit::image::{NpyHeader, NpyValues};
///
/// let mut file = b"\x93NUMPY\x01\x00\x38\x00".to_vec();
/// file.extend(b"{'descr': '<i2', 'fortran_order': False, 'shape': (2,)}\n");
/// file.extend([1, 0, 255, 255]);
/// let (header, data) = NpyHeader::parse(&file)?;
/// assert_eq!((header.descr(), header.shape()), ("<i2", &[2][..]));
/// assert_eq!(header.values(data)?, Some(NpyValues::Whole(vec![1, -1])));
/// # Ok::<(), String>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NpyHeader {
    descr: String,
    pub(super) element: Element,
    pub(super) shape: Vec<u64>,
    pub(super) fortran_order: bool,
}

impl NpyHeader {
    /// The header of a file, and the data behind it.
    ///
    /// # Errors
    ///
    /// In words: for bytes that are no NumPy array, for records, and for headers that claim more
    /// than any file has.
    pub fn parse(bytes: &[u8]) -> Result<(Self, &[u8]), String> {
        let (text, data) = split(bytes)?;
        let header = dictionary(text).and_then(Self::of);
        Ok((header.map_err(|what| wrong(&what))?, data))
    }

    /// The type of the elements in NumPy's words: `<f8` is little-endian float64.
    pub fn descr(&self) -> &str {
        &self.descr
    }

    /// The length of each axis, as the file claims them.
    pub fn shape(&self) -> &[u64] {
        &self.shape
    }

    /// The name of the elements' type, such as `float64`; `None` for elements that are no numbers,
    /// and for numbers that are not read.
    pub fn dtype(&self) -> Option<&'static str> {
        self.element.dtype()
    }

    /// The length of the text that each element is, in characters, and whether their bytes are
    /// big-endian; `None` for other elements.
    pub(super) fn text(&self) -> Option<(u64, bool)> {
        let Element { is_big_endian, kind, size } = self.element;
        (kind == 'U').then_some((size, is_big_endian))
    }

    /// The header that a dictionary describes. Other entries than its three are ignored; of two
    /// with one key the last counts.
    fn of(entries: Vec<(String, Value)>) -> Result<Self, String> {
        let (mut descr, mut order, mut shape) = (None, None, None);
        for (key, value) in entries {
            match key.as_str() {
                "descr" => descr = Some(value),
                "fortran_order" => order = Some(value),
                "shape" => shape = Some(value),
                _ => {}
            }
        }
        let missing = |key: &str| format!("the header has no {key}");
        let descr = match descr.ok_or_else(|| missing("descr"))? {
            Value::Text(descr) => descr,
            Value::Sequence(_) => return Err("expected plain numbers, got records".to_owned()),
            _ => return Err("descr must be the name of a type".to_owned()),
        };
        let fortran_order = match order.ok_or_else(|| missing("fortran_order"))? {
            Value::Word(word) if word == "True" => true,
            Value::Word(word) if word == "False" => false,
            _ => return Err("fortran_order must be True or False".to_owned()),
        };
        let Value::Sequence(sides) = shape.ok_or_else(|| missing("shape"))? else {
            return Err("shape must be a tuple".to_owned());
        };
        if sides.len() > MOST_AXES {
            return Err(format!("{} axes are more than NumPy has", sides.len()));
        }
        let shape = sides.iter().map(side).collect::<Result<Vec<u64>, _>>()?;
        // Zeros count as one: they must not hide that the other sides multiply to too much.
        let sides = shape.iter().map(|&side| side.max(1));
        if sides.fold(1, u64::saturating_mul) > MOST_ELEMENTS {
            return Err("the array is longer than the file".to_owned());
        }
        let element = Element::of(&descr).ok_or_else(|| {
            let shown: String = descr.chars().take(40).collect();
            format!("'{}' names no type", escape_controls(&shown))
        })?;
        Ok(Self { descr, element, shape, fortran_order })
    }
}

/// The message about bytes that should be a NumPy array.
pub(super) fn wrong(what: &str) -> String {
    format!("not a NumPy array: {what}")
}

/// The text of a header, and the data behind it.
fn split(bytes: &[u8]) -> Result<(&[u8], &[u8]), String> {
    if !bytes.starts_with(MAGIC) {
        return Err(wrong("it does not begin as one"));
    }
    // After the magic the version: the first has two bytes for the length, later ones four.
    let truncated = || wrong("truncated: the bytes end before the header");
    let (start, length) = match bytes.get(6..).unwrap_or_default() {
        [1, 0, a, b, ..] => (10, u64::from(u16::from_le_bytes([*a, *b]))),
        [2 | 3, 0, a, b, c, d, ..] => (12, u64::from(u32::from_le_bytes([*a, *b, *c, *d]))),
        [1..=3, 0, ..] | [] | [_] => return Err(truncated()),
        [major, minor, ..] => {
            let what = format!("version {major}.{minor} is not read; it must be 1.0, 2.0 or 3.0");
            return Err(wrong(&what));
        }
    };
    if length > bytes.len().saturating_sub(start) as u64 {
        return Err(format!("the header of {length} bytes is longer than the file"));
    }
    if length > LONGEST_HEADER {
        return Err(format!("the header of {length} bytes is over the limit of {LONGEST_HEADER}"));
    }
    let length = usize::try_from(length).map_err(|_| truncated())?;
    let behind = bytes.get(start..).unwrap_or_default();
    behind.split_at_checked(length).ok_or_else(truncated)
}

/// The length of an axis; one that is too large for 64 bits is the largest that fits.
fn side(value: &Value) -> Result<u64, String> {
    let Value::Word(word) = value else {
        return Err("the shape's lengths must be whole numbers, got something else".to_owned());
    };
    // Python 2 marks a number as long.
    let digits = word.strip_suffix('L').unwrap_or(word);
    if !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit()) {
        return Ok(digits.parse().unwrap_or(u64::MAX));
    }
    let word: String = word.chars().take(40).collect();
    if word.starts_with('-') {
        return Err(format!("the shape has a negative length: {word}"));
    }
    Err(format!("the shape's lengths must be whole numbers, got {word}"))
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::values::NpyValues;
    use super::*;

    pub(in super::super) fn file(version: u8, header: &str, data: &[u8]) -> Vec<u8> {
        let length = u32::try_from(header.len()).unwrap().to_le_bytes();
        let length = if version == 1 { &length[..2] } else { &length };
        [MAGIC, &[version, 0], length, header.as_bytes(), data].concat()
    }

    pub(in super::super) fn dictionary(descr: &str, order: &str, shape: &str) -> String {
        format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}  \n")
    }

    /// The time of a read once grew with the product of axes and elements.
    #[test]
    fn axes_are_as_many_as_in_numpy() {
        let shape = |axes: usize| format!("({}2, 3)", "1, ".repeat(axes - 2));
        let header = dictionary("'<i4'", "True", &shape(64));
        let data: Vec<u8> = (0..24).collect();
        let bytes = file(2, &header, &data);
        let (header, data) = NpyHeader::parse(&bytes).unwrap();
        let Some(NpyValues::Whole(values)) = header.values(data).unwrap() else {
            panic!("{header:?}");
        };
        assert_eq!(values[1], i64::from(i32::from_le_bytes([8, 9, 10, 11])));
        let message = refusal(&dictionary("'<i4'", "True", &shape(65)));
        assert!(message.contains("65 axes"), "{message}");
    }

    fn refusal(header: &str) -> String {
        NpyHeader::parse(&file(1, header, &[])).unwrap_err()
    }

    #[test]
    fn headers_of_all_versions_and_spellings_are_read() {
        let data: Vec<u8> = (0..24).collect();
        for header in [
            dictionary("'<i4'", "False", "(3, 2)"),
            dictionary("'<i4'", "False", "(3, 2, )"),
            dictionary("\"<i4\"", "False", "[3,2]"),
            dictionary("u'<i4'", "False", "(3L, 2L)"),
            dictionary("('<i4')", "False", "((3), 2)"),
            "{'shape':(3,2),'more':{'a':[1.5,None]},'fortran_order':False,'descr':'<i4'}"
                .to_owned(),
        ] {
            for version in [1, 2, 3] {
                let file = file(version, &header, &data);
                let (parsed, rest) = NpyHeader::parse(&file).unwrap();
                assert_eq!((parsed.shape(), parsed.dtype()), (&[3, 2][..], Some("int32")));
                assert_eq!(rest, data);
            }
        }
    }

    fn check_refusals(headers: &[(&str, &str)]) {
        for (header, words) in headers {
            let refused = refusal(header);
            assert!(refused.contains(words), "{header}: {refused}");
            assert!(refused.starts_with("not a NumPy array: "), "{refused}");
        }
    }

    #[test]
    fn shapes_and_orders_that_are_none_are_refused_in_words() {
        for (shape, words) in [
            ("(-1,)", "negative length: -1"),
            ("(1e9,)", "whole numbers, got 1e9"),
            ("(4)", "shape must be a tuple"),
            ("x", "shape must be a tuple"),
            ("", "must have a value at its byte 50"),
            ("(1, 18446744073709551616)", "longer than the file"),
            ("(0, 18446744073709551615)", "longer than the file"),
        ] {
            check_refusals(&[(&dictionary("'<f4'", "False", shape), words)]);
        }
        let order = "fortran_order must be True or False";
        check_refusals(&[(&dictionary("'<f4'", "0", "(4,)"), order)]);
    }

    #[test]
    fn types_that_are_none_are_refused_in_words() {
        for (descr, words) in [
            ("None", "descr must be the name of a type"),
            ("[('a', '<f4')]", "expected plain numbers, got records"),
            ("'<f3'", "'<f3' names no type"),
            ("'f4'", "'f4' names no type"),
            ("'|f4'", "'|f4' names no type"),
            ("'<M8'", "'<M8' names no type"),
            ("'<M8[\x1b]'", "names no type"),
            ("'<f4\\x00'", "names no type"),
            ("'\x1b[2J'", r"'\u{1b}[2J' names no type"),
            ("'<f4", "must have a comma or a closing bracket"),
        ] {
            check_refusals(&[(&dictionary(descr, "False", "(4,)"), words)]);
        }
    }

    #[test]
    fn what_is_no_dictionary_is_refused_in_words() {
        check_refusals(&[("{'descr': '<f4', 'fortran_order': False}", "no shape")]);
        for (bytes, words) in [
            (&b"what else"[..], "it does not begin as one"),
            (b"\x93NUMPY", "truncated"),
            (b"\x93NUMPY\x01", "truncated"),
            (b"\x93NUMPY\x01\x00\x10", "truncated"),
            (b"\x93NUMPY\x03\x00\x10\x00\x00", "truncated"),
            (b"\x93NUMPY\x09\x00\x10\x00", "version 9.0 is not read"),
        ] {
            let refused = NpyHeader::parse(bytes).unwrap_err();
            assert!(refused.contains(words), "{refused}");
        }
    }

    #[test]
    fn a_header_that_is_longer_than_the_file_takes_no_memory() {
        // Found by fuzzing: a length of 660 million.
        let mut bytes = b"\x93NUMPY\x03\x00\x76\x00\x7b\x27desc".to_vec();
        bytes.resize(214, b' ');
        let error = NpyHeader::parse(&bytes).unwrap_err();
        assert_eq!(error, "the header of 662372470 bytes is longer than the file");
        let long = file(2, &" ".repeat(70_000), &[]);
        let error = NpyHeader::parse(&long).unwrap_err();
        assert_eq!(error, "the header of 70000 bytes is over the limit of 65536");
    }
}
