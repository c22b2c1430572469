//! NPY and NPZ files, read after the specification (`numpy.lib.format`, APPNOTE of ZIP): the
//! library's own reader is another.

use std::collections::BTreeMap;
use std::io::{Cursor, Read};

/// An array as a file has it.
pub(crate) struct Array {
    /// `<f8` and the like.
    pub(crate) descr: String,
    pub(crate) shape: Vec<usize>,
    data: Vec<u8>,
}

impl Array {
    pub(crate) fn of(bytes: &[u8]) -> Self {
        assert!(bytes.starts_with(b"\x93NUMPY\x01\x00"));
        let length = usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
        let (header, data) = bytes[10..].split_at(length);
        let header = std::str::from_utf8(header).unwrap();
        let between = |before: &str, after: &str| {
            let (_, rest) = header.split_once(before).unwrap();
            rest.split_once(after).unwrap().0
        };
        assert!(header.contains("'fortran_order': False"), "{header}");
        let sides = between("'shape': (", ")").split(',').map(str::trim);
        let sides = sides.filter(|side| !side.is_empty());
        Self {
            descr: between("'descr': '", "'").to_owned(),
            shape: sides.map(|side| side.parse().unwrap()).collect(),
            data: data.to_vec(),
        }
    }

    /// The values, if they are of this type.
    pub(crate) fn values<T, const B: usize>(
        &self,
        descr: &str,
        number: fn([u8; B]) -> T,
    ) -> Vec<T> {
        assert_eq!(self.descr, descr);
        let (elements, rest) = self.data.as_chunks::<B>();
        assert!(rest.is_empty());
        assert_eq!(elements.len(), self.shape.iter().product::<usize>());
        elements.iter().copied().map(number).collect()
    }

    /// The values of the types of reference data as float64.
    pub(crate) fn numbers(&self) -> Option<Vec<f64>> {
        let all = self;
        Some(match self.descr.as_str() {
            "<f8" => all.values("<f8", f64::from_le_bytes),
            "<f4" => all.values("<f4", |bytes| f64::from(f32::from_le_bytes(bytes))),
            "<i4" => all.values("<i4", |bytes| f64::from(i32::from_le_bytes(bytes))),
            "|u1" => all.values("|u1", |[byte]| f64::from(byte)),
            _ => return None,
        })
    }
}

/// The arrays of an archive by their names.
pub(crate) fn arrays(bytes: Vec<u8>) -> BTreeMap<String, Array> {
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
    let mut arrays = BTreeMap::new();
    for k in 0..archive.len() {
        let mut entry = archive.by_index(k).unwrap();
        let name = entry.name().unwrap().into_owned();
        let mut content = Vec::new();
        entry.read_to_end(&mut content).unwrap();
        let name = name.strip_suffix(".npy").unwrap().to_owned();
        arrays.insert(name, Array::of(&content));
    }
    arrays
}
