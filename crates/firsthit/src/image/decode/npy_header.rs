//! NumPy's arrays: the header, a dictionary as a Python literal, and the numbers behind it
//! (`numpy.lib.format`, versions 1.0 to 3.0).

use super::output::collected;
use crate::error::escape_controls;

/// What every array begins with.
const MAGIC: &[u8] = b"\x93NUMPY";

/// Those of plain arrays have a hundred bytes.
const LONGEST_HEADER: u64 = 1 << 16;

/// No array of numbers has brackets in brackets deeper than this.
const DEEPEST: u32 = 8;

/// No file holds so many elements.
const MOST_ELEMENTS: u64 = 1 << 48;

/// What the header of a NumPy array (`.npy`) says: the type of its elements, its shape and its order. The data behind it is
/// not looked at before [`NpyHeader::values`].
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
    element: Element,
    shape: Vec<u64>,
    fortran_order: bool,
}

/// The type of an element, as NumPy's type strings say it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Element {
    is_big_endian: bool,
    /// `f` for floats, `i` and `u` for whole numbers, `U` for texts, and so on.
    kind: char,
    /// In bytes; of a text, in characters.
    size: u64,
}

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
    /// The header of a file, and the data behind it.
    ///
    /// # Errors
    ///
    /// In words: for what is no NumPy array, for records, and for headers that claim what no file has.
    pub fn parse(bytes: &[u8]) -> Result<(Self, &[u8]), String> {
        let (text, data) = split(bytes)?;
        let literal = Literal {
            rest: text,
            length: text.len(),
        };
        let header = literal.header().map_err(|what| wrong(&what))?;
        Ok((header, data))
    }

    /// The type of the elements in NumPy's words: `<f8` is little-endian float64.
    pub fn descr(&self) -> &str {
        &self.descr
    }

    /// The length of each axis, as the file claims them.
    pub fn shape(&self) -> &[u64] {
        &self.shape
    }

    /// The name of the elements' type, such as `float64`; `None` for what are no numbers, and for numbers that are not read.
    pub fn dtype(&self) -> Option<&'static str> {
        Some(match (self.element.kind, self.element.size) {
            ('f', 8) => "float64",
            ('f', 4) => "float32",
            ('b', 1) => "bool",
            ('i', 8) => "int64",
            ('i', 4) => "int32",
            ('i', 2) => "int16",
            ('i', 1) => "int8",
            ('u', 8) => "uint64",
            ('u', 4) => "uint32",
            ('u', 2) => "uint16",
            ('u', 1) => "uint8",
            _ => return None,
        })
    }

    /// The length of the text that each element is, in characters, and whether their bytes are big-endian; `None` for
    /// other elements.
    pub(super) fn text(&self) -> Option<(u64, bool)> {
        let Element {
            is_big_endian,
            kind,
            size,
        } = self.element;
        (kind == 'U').then_some((size, is_big_endian))
    }

    /// The numbers in `data`, the bytes behind the header; `None` where [`NpyHeader::dtype`] is.
    ///
    /// # Errors
    ///
    /// In words: for less data than the shape claims, for a bool that is neither 0 nor 1, and where no memory is free.
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

    /// As many elements of `B` bytes as the shape says, each made of its bytes in little-endian order.
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

/// As many as NumPy 2 allows.
const MOST_AXES: usize = 64;

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

/// What is wrong with bytes that should be a NumPy array.
fn wrong(what: &str) -> String {
    format!("not a NumPy array: {what}")
}

/// The text of a header, and what is behind it.
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
        return Err(format!(
            "the header of {length} bytes is longer than the file"
        ));
    }
    if length > LONGEST_HEADER {
        return Err(format!(
            "the header of {length} bytes is over the limit of {LONGEST_HEADER}"
        ));
    }
    let length = usize::try_from(length).map_err(|_| truncated())?;
    let behind = bytes.get(start..).unwrap_or_default();
    behind.split_at_checked(length).ok_or_else(truncated)
}

/// A value of the literals that headers are made of.
enum Value {
    Text(String),
    Flag(bool),
    /// Of a tuple or a list.
    Sequence(Vec<Value>),
    /// Not negative; what is too large for 64 bits is the largest that fits.
    Whole(u64),
    /// Another number or word, as it is written.
    Word(String),
    /// A dictionary or another value that no plain array has.
    Other,
}

/// What is left to be read of a Python literal.
struct Literal<'a> {
    rest: &'a [u8],
    /// The whole of it, in bytes.
    length: usize,
}

impl Literal<'_> {
    /// The dictionary of a header, which must be all there is.
    fn header(mut self) -> Result<NpyHeader, String> {
        let (mut descr, mut order, mut shape) = (None, None, None);
        self.expect(b'{')?;
        while !self.ends_with(b'}')? {
            let Value::Text(key) = self.value(1)? else {
                return Err("a key of the header is no text".to_owned());
            };
            self.expect(b':')?;
            let value = self.value(1)?;
            match key.as_str() {
                "descr" => descr = Some(value),
                "fortran_order" => order = Some(value),
                "shape" => shape = Some(value),
                _ => {}
            }
            self.separator(b'}')?;
        }
        if self.peek().is_some() {
            return Err("the header does not end after its dictionary".to_owned());
        }
        let missing = |key: &str| format!("the header has no {key}");
        let descr = match descr.ok_or_else(|| missing("descr"))? {
            Value::Text(descr) => descr,
            Value::Sequence(_) => {
                return Err("expected plain numbers, got records".to_owned());
            }
            _ => return Err("descr must be the name of a type".to_owned()),
        };
        let Value::Flag(fortran_order) = order.ok_or_else(|| missing("fortran_order"))? else {
            return Err("fortran_order must be True or False".to_owned());
        };
        let Value::Sequence(sides) = shape.ok_or_else(|| missing("shape"))? else {
            return Err("shape must be a tuple".to_owned());
        };
        if sides.len() > MOST_AXES {
            return Err(format!("{} axes are more than NumPy has", sides.len()));
        }
        let shape = sides.iter().map(side).collect::<Result<Vec<u64>, _>>()?;
        // The product without the zeros: nothing multiplies on without minding where that leads.
        let elements = shape
            .iter()
            .fold(1_u64, |n, &side| n.saturating_mul(side.max(1)));
        if elements > MOST_ELEMENTS {
            return Err("the array is longer than the file".to_owned());
        }
        let element = Element::of(&descr).ok_or_else(|| {
            let shown: String = descr.chars().take(40).collect();
            format!("'{}' names no type", escape_controls(&shown))
        })?;
        Ok(NpyHeader {
            descr,
            element,
            shape,
            fortran_order,
        })
    }

    /// The next byte that is no white space.
    fn peek(&mut self) -> Option<u8> {
        while let Some((b' ' | b'\t' | b'\x0c' | b'\r' | b'\n', rest)) = self.rest.split_first() {
            self.rest = rest;
        }
        self.rest.first().copied()
    }

    fn skip(&mut self) {
        self.rest = self.rest.get(1..).unwrap_or_default();
    }

    fn expect(&mut self, wanted: u8) -> Result<(), String> {
        if self.peek() == Some(wanted) {
            self.skip();
            return Ok(());
        }
        let wanted = if wanted == b':' {
            "a colon"
        } else {
            "a dictionary"
        };
        Err(self.unexpected(wanted))
    }

    fn unexpected(&mut self, wanted: &str) -> String {
        if self.peek().is_none() {
            return format!("the header ends where it must have {wanted}");
        }
        let at = self.length - self.rest.len();
        format!("the header must have {wanted} at its byte {at}")
    }

    /// Whether a sequence ends here, whose end is then passed.
    fn ends_with(&mut self, end: u8) -> Result<bool, String> {
        match self.peek() {
            Some(byte) if byte == end => {
                self.skip();
                Ok(true)
            }
            Some(_) => Ok(false),
            None => Err(self.unexpected("a closing bracket")),
        }
    }

    /// Passes a comma; `false` where there is none, since the sequence ends.
    fn separator(&mut self, end: u8) -> Result<bool, String> {
        if self.peek() == Some(b',') {
            self.skip();
            return Ok(true);
        }
        if self.peek() == Some(end) {
            return Ok(false);
        }
        Err(self.unexpected("a comma or a closing bracket"))
    }

    /// A value within so many brackets. It calls itself for those within, which [`DEEPEST`] bounds.
    fn value(&mut self, depth: u32) -> Result<Value, String> {
        let end = match self.peek() {
            Some(b'(') => b')',
            Some(b'[') => b']',
            Some(b'{') => b'}',
            Some(quote @ (b'\'' | b'"')) => return self.text(quote),
            _ => return self.word(),
        };
        if depth >= DEEPEST {
            return Err(format!(
                "the header's brackets are nested more than {DEEPEST} deep"
            ));
        }
        self.skip();
        let mut values = Vec::new();
        let mut has_comma = false;
        while !self.ends_with(end)? {
            values.push(self.value(depth + 1)?);
            if end == b'}' && self.peek() == Some(b':') {
                self.skip();
                self.value(depth + 1)?;
            }
            has_comma |= self.separator(end)?;
        }
        Ok(match (end, values.len()) {
            (b'}', _) => Value::Other,
            // In Python a value in brackets is that value.
            (b')', 1) if !has_comma => values.remove(0),
            _ => Value::Sequence(values),
        })
    }

    fn text(&mut self, quote: u8) -> Result<Value, String> {
        self.skip();
        let mut text = Vec::new();
        loop {
            match self.rest {
                [b'\\', escaped, rest @ ..] => {
                    // Names of types have none: that there is one is enough.
                    text.extend([b'\\', *escaped]);
                    self.rest = rest;
                }
                [byte, rest @ ..] => {
                    self.rest = rest;
                    if *byte == quote {
                        let text = String::from_utf8_lossy(&text).into_owned();
                        return Ok(Value::Text(text));
                    }
                    text.push(*byte);
                }
                [] => return Err("a text of the header does not end".to_owned()),
            }
        }
    }

    /// A number or a word.
    fn word(&mut self) -> Result<Value, String> {
        let is_part = |byte: &u8| byte.is_ascii_alphanumeric() || b"_.+-".contains(byte);
        let length = self.rest.iter().take_while(|byte| is_part(byte)).count();
        let (word, rest) = self.rest.split_at(length);
        let word = String::from_utf8_lossy(word).into_owned();
        if word.is_empty() {
            return Err(self.unexpected("a value"));
        }
        self.rest = rest;
        // Python 2 marks a text as Unicode, and a number as long.
        if let (true, Some(&quote @ (b'\'' | b'"'))) = (word == "u", rest.first()) {
            return self.text(quote);
        }
        let digits = word.strip_suffix('L').unwrap_or(&word);
        Ok(match word.as_str() {
            "True" => Value::Flag(true),
            "False" => Value::Flag(false),
            _ if !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit()) => {
                Value::Whole(digits.parse().unwrap_or(u64::MAX))
            }
            _ => Value::Word(word),
        })
    }
}

/// The length of an axis.
fn side(value: &Value) -> Result<u64, String> {
    let word = match value {
        Value::Whole(side) => return Ok(*side),
        Value::Word(word) => word.chars().take(40).collect(),
        _ => "something else".to_owned(),
    };
    if word.starts_with('-') {
        return Err(format!("the shape has a negative length: {word}"));
    }
    Err(format!(
        "the shape's lengths must be whole numbers, got {word}"
    ))
}

impl Element {
    /// The type that a type string names: byte order, kind, size, and of dates their unit.
    fn of(descr: &str) -> Option<Self> {
        let mut chars = descr.chars();
        let (order, kind) = (chars.next()?, chars.next()?);
        let rest = chars.as_str();
        let digits = rest.bytes().take_while(u8::is_ascii_digit).count();
        let (size, unit) = rest.split_at_checked(digits)?;
        // Objects, which are pickled, have no size.
        let size: u64 = match (kind, size) {
            ('O', "") => 0,
            ('O', _) => return None,
            _ => size.parse().ok()?,
        };
        let (is_known, has_unit) = match kind {
            'b' => (size == 1, false),
            'i' | 'u' => (matches!(size, 1 | 2 | 4 | 8), false),
            'f' => (matches!(size, 2 | 4 | 8 | 16), false),
            'c' => (matches!(size, 8 | 16 | 32), false),
            'm' | 'M' => (size == 8, true),
            'S' | 'a' | 'U' | 'V' | 'O' => (true, false),
            _ => (false, false),
        };
        let unit_name = unit
            .strip_prefix('[')
            .and_then(|unit| unit.strip_suffix(']'));
        let is_unit = unit_name.is_some_and(|unit| {
            !unit.is_empty() && unit.bytes().all(|byte| byte.is_ascii_alphanumeric())
        });
        let has_order = match kind {
            'S' | 'a' | 'V' | 'O' => true,
            'U' => order != '|',
            _ => size == 1 || order != '|',
        };
        let is_type = matches!(order, '<' | '>' | '|')
            && is_known
            && has_order
            && if has_unit { is_unit } else { unit.is_empty() };
        is_type.then_some(Self {
            is_big_endian: order == '>',
            kind,
            size,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(version: u8, header: &str, data: &[u8]) -> Vec<u8> {
        let length = u32::try_from(header.len()).unwrap().to_le_bytes();
        let length = if version == 1 { &length[..2] } else { &length };
        [MAGIC, &[version, 0], length, header.as_bytes(), data].concat()
    }

    fn dictionary(descr: &str, order: &str, shape: &str) -> String {
        format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}  \n")
    }

    /// Each axis once took its part of each element's time.
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
                assert_eq!(
                    (parsed.shape(), parsed.dtype()),
                    (&[3, 2][..], Some("int32"))
                );
                assert_eq!(rest, data);
            }
        }
    }

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
        assert_eq!(
            values(">i2", "False", "(2,)", &[0, 1, 255, 254]),
            whole(&[1, -2])
        );
        assert_eq!(values("<u2", "False", "(1,)", &[255, 255]), whole(&[65535]));
        assert_eq!(
            values(">u4", "False", "()", &[255, 0, 0, 0]),
            whole(&[0xff00_0000])
        );
        assert_eq!(
            values("<i8", "False", "()", &(-7_i64).to_le_bytes()),
            whole(&[-7])
        );
        let large = Some(NpyValues::Unsigned(vec![u64::MAX]));
        assert_eq!(values(">u8", "False", "(1,)", &[255; 8]), large);
        let singles = Some(NpyValues::Float32(vec![1.5]));
        assert_eq!(
            values(">f4", "False", "(1,)", &1.5_f32.to_be_bytes()),
            singles
        );
        let doubles = Some(NpyValues::Float64(vec![-0.1]));
        assert_eq!(
            values("<f8", "True", "(1,)", &(-0.1_f64).to_le_bytes()),
            doubles
        );
        // Columns of 0 1, 2 3, 4 5.
        let rows = whole(&[0, 2, 4, 1, 3, 5]);
        assert_eq!(values("|i1", "True", "(2, 3)", &[0, 1, 2, 3, 4, 5]), rows);
        let boxes = whole(&[0, 4, 2, 6, 1, 5, 3, 7]);
        assert_eq!(
            values("|i1", "True", "(2, 2, 2)", &[0, 1, 2, 3, 4, 5, 6, 7]),
            boxes
        );
        assert_eq!(values("|i1", "True", "(0, 3)", &[]), whole(&[]));
        assert_eq!(values("<f2", "False", "(1,)", &[0, 0]), None);
        assert_eq!(values("<U2", "False", "()", &[0; 8]), None);
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
        check_refusals(&[
            ("{'descr': '<f4', 'fortran_order': False}", "no shape"),
            (
                "{'descr': '<f4'",
                "ends where it must have a comma or a closing bracket",
            ),
            ("{'descr': '<f4", "a text of the header does not end"),
            ("{'descr' '<f4'}", "must have a colon at its byte 9"),
            ("{}{}", "does not end after its dictionary"),
            ("{1: 2}", "a key of the header is no text"),
            ("(1, 2)", "must have a dictionary at its byte 0"),
            ("", "the header ends where it must have a dictionary"),
        ]);
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
        assert_eq!(
            error,
            "the header of 662372470 bytes is longer than the file"
        );
        let long = file(2, &" ".repeat(70_000), &[]);
        let error = NpyHeader::parse(&long).unwrap_err();
        assert_eq!(
            error,
            "the header of 70000 bytes is over the limit of 65536"
        );
    }

    #[test]
    fn brackets_in_brackets_are_refused() {
        for open in ["[", "(", "{"] {
            let refused = refusal(&format!("{{'descr': {}", open.repeat(10_000)));
            let words = "the header's brackets are nested more than 8 deep";
            assert!(refused.ends_with(words), "{refused}");
        }
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
