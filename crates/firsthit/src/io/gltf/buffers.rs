//! The bytes that a document names: its container's, data URIs, files beside it, unpacked views.

use std::borrow::Cow;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

use base64::Engine as _;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use percent_encoding::percent_decode_str;

use super::super::read;
use super::super::report::{Checked, Fault, Report};
use super::document::{Document, Index};
use super::meshopt;
use super::place::Entry;
use crate::error::{Error, Place, escape_controls};

/// Some bytes, cheap to clone.
#[derive(Debug, Clone)]
pub(super) struct Bytes<'a> {
    whole: Whole<'a>,
    range: Range<usize>,
}

#[derive(Debug, Clone)]
enum Whole<'a> {
    Borrowed(&'a [u8]),
    Owned(Arc<Vec<u8>>),
}

impl<'a> Bytes<'a> {
    fn borrowed(bytes: &'a [u8]) -> Self {
        Self {
            whole: Whole::Borrowed(bytes),
            range: 0..bytes.len(),
        }
    }

    fn owned(bytes: Vec<u8>) -> Self {
        Self {
            range: 0..bytes.len(),
            whole: Whole::Owned(Arc::new(bytes)),
        }
    }

    pub(super) fn get(&self) -> &[u8] {
        let whole = match &self.whole {
            Whole::Borrowed(bytes) => bytes,
            Whole::Owned(bytes) => bytes.as_slice(),
        };
        whole.get(self.range.clone()).unwrap_or_default()
    }

    /// The part of so many bytes from `offset` on, if there is.
    pub(super) fn part(&self, offset: usize, length: usize) -> Option<Self> {
        let end = offset.checked_add(length)?;
        let start = self.range.start.checked_add(offset)?;
        (end <= self.range.len()).then(|| Self {
            whole: self.whole.clone(),
            range: start..start + length,
        })
    }
}

/// All buffers of a document; each is read when something asks for it, and once.
#[derive(Debug)]
pub(super) struct Buffers<'a> {
    document: &'a Document<'a>,
    binary: Option<&'a [u8]>,
    read: HashMap<usize, Bytes<'a>>,
    unpacked: HashMap<usize, Bytes<'a>>,
}

impl<'a> Buffers<'a> {
    pub(super) fn new(document: &'a Document<'a>, binary: Option<&'a [u8]>) -> Self {
        Self {
            document,
            binary,
            read: HashMap::new(),
            unpacked: HashMap::new(),
        }
    }

    /// What a buffer view shows.
    pub(super) fn view(&mut self, Index(index): Index, report: &mut Report) -> Checked<Bytes<'a>> {
        let entry = Entry::new("bufferViews", index);
        let view = self.document.buffer_views.get(index);
        let view = view.ok_or_else(|| entry.fault("", "there is no such view"))?;
        if let Some(packed) = &view.extensions.meshopt {
            if let Some(known) = self.unpacked.get(&index) {
                return Ok(known.clone());
            }
            let place = "extensions/EXT_meshopt_compression";
            let source = self.part(
                packed.buffer,
                [packed.byte_offset, packed.byte_length],
                &|| entry.at(format!("{place}/byteLength")),
                report,
            )?;
            let bytes = meshopt::unpack(source.get(), packed, report)
                .map_err(|problem| problem.at(entry.at(place)))?;
            let bytes = Bytes::owned(bytes);
            if bytes.get().len() < view.byte_length.0 {
                let (got, length) = (bytes.get().len(), view.byte_length.0);
                let what = format!("the view has {length} bytes, {got} are unpacked");
                return Err(entry.fault("byteLength", what));
            }
            self.unpacked.insert(index, bytes.clone());
            return Ok(bytes);
        }
        let extent = [view.byte_offset, view.byte_length];
        self.part(view.buffer, extent, &|| entry.at("byteLength"), report)
    }

    /// The step from one element of a view to the next, where the document states one.
    pub(super) fn stride(&self, Index(view): Index) -> Option<usize> {
        let view = self.document.buffer_views.get(view)?;
        let packed = view
            .extensions
            .meshopt
            .as_ref()
            .map(|meshopt| meshopt.byte_stride);
        let Index(stride) = view.byte_stride.or(packed)?;
        // Of a packed view, whose own is checked where it is unpacked.
        Some(stride).filter(|&stride| stride > 0)
    }

    fn part(
        &mut self,
        buffer: Index,
        [Index(offset), Index(length)]: [Index; 2],
        place: &dyn Fn() -> Place,
        report: &mut Report,
    ) -> Checked<Bytes<'a>> {
        let bytes = self.buffer(buffer, report)?;
        bytes.part(offset, length).ok_or_else(|| {
            let (there, buffer) = (bytes.get().len(), buffer.0);
            let what = format!("{length} bytes from byte {offset} on: buffer {buffer} has {there}");
            Fault::at(place(), what)
        })
    }

    fn buffer(&mut self, Index(index): Index, report: &mut Report) -> Checked<Bytes<'a>> {
        if let Some(known) = self.read.get(&index) {
            return Ok(known.clone());
        }
        let entry = Entry::new("buffers", index);
        let buffer = self.document.buffers.get(index);
        let buffer = buffer.ok_or_else(|| entry.fault("", "there is no such buffer"))?;
        let bytes = match (&buffer.uri, self.binary) {
            (Some(uri), _) => {
                resource(uri, report).map_err(|problem| problem.at(entry.at("uri")))?
            }
            (None, Some(binary)) if index == 0 => Bytes::borrowed(binary),
            (None, _) => {
                let what = "there is neither a uri nor a binary chunk for this buffer";
                return Err(Fault::at(entry.place(), what));
            }
        };
        let Index(length) = buffer.byte_length;
        // What is there beyond the stated length is padding.
        let bytes = bytes.part(0, length).ok_or_else(|| {
            let there = bytes.get().len();
            entry.fault(
                "byteLength",
                format!("{length} bytes are stated, {there} are there"),
            )
        })?;
        self.read.insert(index, bytes.clone());
        Ok(bytes)
    }
}

/// Why bytes cannot be had, before it is known where in the document they are asked for.
#[derive(Debug)]
pub(super) enum Problem {
    Words(String),
    Fault(Fault),
}

impl Problem {
    pub(super) fn at(self, place: Place) -> Fault {
        match self {
            Self::Words(what) => Fault::at(place, what),
            Self::Fault(fault) => fault,
        }
    }

    /// As words, for those to whom it is a mere warning.
    pub(super) fn into_words(self, report: &Report) -> String {
        match self {
            Self::Words(what) => what,
            Self::Fault(fault) => fault.into_error(report.path()).to_string(),
        }
    }
}

impl From<String> for Problem {
    fn from(what: String) -> Self {
        Self::Words(what)
    }
}

impl From<&str> for Problem {
    fn from(what: &str) -> Self {
        Self::Words(what.to_owned())
    }
}

impl From<Fault> for Problem {
    fn from(fault: Fault) -> Self {
        Self::Fault(fault)
    }
}

/// What a URI names: its own data, or a file under the document's folder.
pub(super) fn resource<'a>(uri: &str, report: &mut Report) -> Result<Bytes<'a>, Problem> {
    let is_data = uri
        .get(..5)
        .is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:"));
    let bytes = if is_data {
        data(uri.get(5..).unwrap_or_default(), report)?
    } else {
        let name = file_name(uri)?;
        let shown = escape_controls(uri);
        let named = |reason: String| Problem::Words(format!("'{shown}' is not read: {reason}"));
        let path = report.scene().and_then(|scene| read::sibling(scene, &name));
        let path = path.map_err(named)?;
        match read::content(&path, report) {
            Err(fault @ (Fault::TooLarge { .. } | Fault::Other(Error::TooLarge { .. }))) => {
                return Err(fault.into());
            }
            read => read.map_err(|fault| named(fault.into_error(&path).to_string()))?,
        }
    };
    Ok(Bytes::owned(bytes))
}

/// The file that a URI names, as the file system has it.
pub(super) fn file_name(uri: &str) -> Result<Cow<'_, str>, Problem> {
    let name = percent_decode_str(uri).decode_utf8();
    name.map_err(|_| "the uri is not UTF-8 behind its percent signs".into())
}

/// The content of a data URI behind its scheme (RFC 2397).
fn data(uri: &str, report: &mut Report) -> Result<Vec<u8>, Problem> {
    const LENIENT: GeneralPurpose = GeneralPurpose::new(
        &STANDARD,
        GeneralPurposeConfig::new()
            .with_decode_padding_mode(DecodePaddingMode::Indifferent)
            .with_decode_allow_trailing_bits(true),
    );
    let (header, content) = uri.split_once(',').ok_or("the data uri has no comma")?;
    let is_base64 = header
        .rsplit(';')
        .next()
        .is_some_and(|word| word.eq_ignore_ascii_case("base64"));
    report.spend_on_content(content.len() as u64, "a data uri")?;
    let content: Cow<'_, [u8]> = if content.contains('%') {
        percent_decode_str(content).into()
    } else {
        content.as_bytes().into()
    };
    if !is_base64 {
        return Ok(content.into_owned());
    }
    let decoded = LENIENT.decode(content.as_ref());
    decoded.map_err(|error| format!("the data uri is not base64: {error}").into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::LoadSettings;

    fn content(uri: &str) -> Result<Vec<u8>, String> {
        let mut report = Report::new("a.gltf".as_ref(), LoadSettings::default());
        let bytes = resource(uri, &mut report).map_err(|problem| problem.into_words(&report))?;
        Ok(bytes.get().to_vec())
    }

    #[test]
    fn data_uris_are_read_as_they_are_written() {
        for uri in [
            "data:application/octet-stream;base64,aGVsbG8=",
            "data:;base64,aGVsbG8",
            "DATA:text/plain;charset=x;BASE64,aGVsbG8%3D",
            "data:,hello",
            "data:text/plain,%68ello",
        ] {
            assert_eq!(content(uri).unwrap(), b"hello", "{uri}");
        }
        for uri in ["data:;base64", "data:;base64,a", "data:;base64,!!!!"] {
            assert!(content(uri).unwrap_err().contains("data uri"), "{uri}");
        }
    }

    #[test]
    fn uris_that_lead_elsewhere_are_refused_percent_signs_or_not() {
        for uri in [
            "../x.bin",
            "%2e%2e/x.bin",
            "a/..%2Fx.bin",
            "/etc/passwd",
            "%2Fetc/passwd",
            "file:///etc/passwd",
            "http://host/x.bin",
            "C:%5Cx.bin",
            "a%00b",
            "",
        ] {
            let reason = content(uri).unwrap_err();
            assert!(reason.contains("refused"), "{uri}: {reason}");
        }
        assert!(content("%ff.bin").unwrap_err().contains("UTF-8"));
    }

    #[test]
    fn parts_beyond_the_end_are_none() {
        let bytes = Bytes::borrowed(b"0123456789").part(2, 6).unwrap();
        assert_eq!(bytes.get(), b"234567");
        assert_eq!(bytes.part(1, 5).unwrap().get(), b"34567");
        assert!(bytes.part(1, 6).is_none());
        assert!(bytes.part(usize::MAX, 2).is_none());
    }
}
