//! The bytes that a document names: its container's, data URIs, files beside it, unpacked views.

use std::collections::HashMap;

use super::super::fault::{Checked, Fault};
use super::super::report::Report;
use super::document::{Buffer, Document};
use super::index::Index;
use super::meshopt;
use super::place::Entry;
use super::resource::{Bytes, is_data, resource};
use crate::error::Place;

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
        Self { document, binary, read: HashMap::new(), unpacked: HashMap::new() }
    }

    /// Tells the watch of the bytes in other files, which are most of the work where there are any.
    pub(super) fn begin(&self, report: &mut Report) -> Checked<()> {
        let uri = |buffer: &&Buffer<'_>| buffer.uri.as_ref().is_some_and(|uri| !is_data(uri));
        let outside = self.document.buffers.iter().filter(uri);
        match outside.fold(0, |sum: usize, buffer| sum.saturating_add(buffer.byte_length.0)) {
            0 => Ok(()),
            bytes => {
                report.advance_until(0)?;
                report.begin_parsing("buffers of ", bytes);
                Ok(())
            }
        }
    }

    /// The bytes of a buffer view.
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
            let bytes = Bytes::new(bytes);
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
        let packed = view.extensions.meshopt.as_ref();
        let packed = packed.map(|meshopt| meshopt.byte_stride);
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
        report.advance(length)?;
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
            (None, Some(binary)) if index == 0 => Bytes::new(binary),
            (None, _) => {
                let what = "there is neither a uri nor a binary chunk for this buffer";
                return Err(Fault::at(entry.place(), what));
            }
        };
        let Index(length) = buffer.byte_length;
        // Bytes beyond the stated length are padding.
        let bytes = bytes.part(0, length).ok_or_else(|| {
            let there = bytes.get().len();
            let what = format!("{length} bytes are stated, {there} are there");
            entry.fault("byteLength", what)
        })?;
        self.read.insert(index, bytes.clone());
        Ok(bytes)
    }
}
