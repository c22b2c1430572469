//! The bytes that a URI names: its own data, or a file beside the document.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

use base64::Engine as _;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use percent_encoding::percent_decode_str;

use super::super::fault::Fault;
use super::super::read;
use super::super::report::Report;
use super::problem::Problem;
use crate::error::{Error, escape_controls};

/// A range of bytes, cheap to clone.
#[derive(Debug, Clone)]
pub(super) struct Bytes<'a> {
    whole: Arc<Cow<'a, [u8]>>,
    range: Range<usize>,
}

impl<'a> Bytes<'a> {
    pub(super) fn new(bytes: impl Into<Cow<'a, [u8]>>) -> Self {
        let whole = bytes.into();
        Self { range: 0..whole.len(), whole: Arc::new(whole) }
    }

    pub(super) fn get(&self) -> &[u8] {
        self.whole.get(self.range.clone()).unwrap_or_default()
    }

    /// The `length` bytes from `offset` on, if there are that many.
    pub(super) fn part(&self, offset: usize, length: usize) -> Option<Self> {
        let end = offset.checked_add(length)?;
        let start = self.range.start.checked_add(offset)?;
        (end <= self.range.len())
            .then(|| Self { whole: Arc::clone(&self.whole), range: start..start + length })
    }
}

/// The content of a URI: its own data, or a file under the document's folder.
pub(super) fn resource<'a>(uri: &str, report: &mut Report) -> Result<Bytes<'a>, Problem> {
    let bytes = if is_data(uri) {
        data(uri.get(5..).unwrap_or_default(), report)?
    } else {
        let name = file_name(uri)?;
        let shown = escape_controls(uri);
        let named = |reason: String| Problem::Words(format!("'{shown}' is not read: {reason}"));
        let path = report.sibling(&name).map_err(named)?;
        match read::content(&path, report) {
            Err(
                fault @ (Fault::TooLarge { .. }
                | Fault::Other(Error::TooLarge { .. } | Error::Interrupted)),
            ) => return Err(fault.into()),
            read => read.map_err(|fault| named(fault.into_error(&path).to_string()))?,
        }
    };
    Ok(Bytes::new(bytes))
}

/// Whether a URI has its content in itself.
pub(super) fn is_data(uri: &str) -> bool {
    let scheme = uri.get(..5);
    scheme.is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:"))
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
    let is_base64 =
        header.rsplit(';').next().is_some_and(|word| word.eq_ignore_ascii_case("base64"));
    report.budget.charge_content(content.len() as u64, "a data uri")?;
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
        let mut report = Report::new("a.gltf".as_ref(), LoadSettings::default(), &());
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
        let bytes = Bytes::new(b"0123456789".as_slice()).part(2, 6).unwrap();
        assert_eq!(bytes.get(), b"234567");
        assert_eq!(bytes.part(1, 5).unwrap().get(), b"34567");
        assert!(bytes.part(1, 6).is_none());
        assert!(bytes.part(usize::MAX, 2).is_none());
    }
}
