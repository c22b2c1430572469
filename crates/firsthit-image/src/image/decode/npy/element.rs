//! The types of elements, as NumPy's type strings name them.

/// The type of an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Element {
    pub(super) is_big_endian: bool,
    /// `f` for floats, `i` and `u` for whole numbers, `U` for texts, and so on.
    pub(super) kind: char,
    /// The size in bytes; of a text, in characters.
    pub(super) size: u64,
}

impl Element {
    /// The type that a type string names: byte order, kind, size, and of dates their unit.
    pub(super) fn of(descr: &str) -> Option<Self> {
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
        let has_size = match kind {
            'b' => size == 1,
            'i' | 'u' => matches!(size, 1 | 2 | 4 | 8),
            'f' => matches!(size, 2 | 4 | 8 | 16),
            'c' => matches!(size, 8 | 16 | 32),
            'm' | 'M' => size == 8,
            'S' | 'a' | 'U' | 'V' | 'O' => true,
            _ => false,
        };
        let has_order = match (order, kind) {
            ('<' | '>', _) | ('|', 'S' | 'a' | 'V' | 'O') => true,
            ('|', kind) => size == 1 && kind != 'U',
            _ => false,
        };
        let has_unit = match kind {
            'm' | 'M' => is_unit(unit),
            _ => unit.is_empty(),
        };
        (has_size && has_order && has_unit).then_some(Self {
            is_big_endian: order == '>',
            kind,
            size,
        })
    }

    /// The name, such as `float64`; `None` for types that are no numbers, and for numbers that are
    /// not read.
    pub(super) fn dtype(self) -> Option<&'static str> {
        Some(match (self.kind, self.size) {
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
}

/// Whether a text is a unit of dates, such as `[ns]`.
fn is_unit(text: &str) -> bool {
    let unit = text.strip_prefix('[').and_then(|text| text.strip_suffix(']'));
    unit.is_some_and(|unit| !unit.is_empty() && unit.bytes().all(|b| b.is_ascii_alphanumeric()))
}
