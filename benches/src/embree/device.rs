//! Embree's library, its devices and its scenes.

use std::error::Error;
use std::ffi::{CString, c_void};
use std::marker::PhantomData;
use std::path::Path;
use std::sync::atomic::{AtomicIsize, Ordering};

use super::api::{self, Api};
use super::model::Model;

/// Embree's code.
#[derive(Debug)]
pub(crate) struct Library(Api);

impl Library {
    /// Opens the shared library at `path`.
    pub(crate) fn open(path: &Path) -> Result<Self, String> {
        let api = Api::open(path).map_err(|error| match error.source() {
            Some(source) => format!("{}: {error}: {source}", path.display()),
            None => format!("{}: {error}", path.display()),
        })?;
        Ok(Self(api))
    }
}

/// The bytes that Embree holds at the moment, over all devices.
static BYTES: AtomicIsize = AtomicIsize::new(0);

unsafe extern "C" fn count_bytes(_: *mut c_void, bytes: isize, _: bool) -> bool {
    BYTES.fetch_add(bytes, Ordering::Relaxed);
    true
}

/// A device of one thread.
#[derive(Debug)]
pub(crate) struct Device<'a> {
    api: &'a Api,
    handle: api::Handle,
}

impl<'a> Device<'a> {
    /// One thread, and huge pages, as Embree's manual recommends; with no instructions beyond those
    /// of `isa`, by Embree's name for it.
    pub(crate) fn new(library: &'a Library, isa: Option<&str>) -> Result<Self, String> {
        let api = &library.0;
        let isa = isa.map_or_else(String::new, |isa| format!(",isa={isa}"));
        let settings = CString::new(format!("threads=1,hugepages=1{isa}"));
        let settings = settings.map_err(|error| error.to_string())?;
        // SAFETY: the text ends in a zero and is only read during the call.
        let handle = unsafe { (api.new_device)(settings.as_ptr()) };
        if handle.is_null() {
            return Err("Embree makes no device".into());
        }
        // SAFETY: the device is alive; the callback touches nothing but an atomic.
        unsafe { (api.set_memory_monitor)(handle, Some(count_bytes), std::ptr::null_mut()) };
        Ok(Self { api, handle })
    }

    /// The version, such as "4.4.0".
    pub(crate) fn version(&self) -> String {
        let number = self.property(api::PROPERTY_VERSION);
        format!("{}.{}.{}", number / 10000, number / 100 % 100, number % 100)
    }

    /// The number of rays of the best packet: 16, or 8 without AVX-512.
    pub(crate) fn width(&self) -> usize {
        if self.property(api::PROPERTY_NATIVE_RAY16) == 1 { 16 } else { 8 }
    }

    fn property(&self, property: std::ffi::c_int) -> isize {
        // SAFETY: the device is alive.
        unsafe { (self.api.device_property)(self.handle, property) }
    }

    /// Builds the trees over `model` at medium quality, Embree's default. With `filters`, rays can
    /// bring a filter function.
    pub(crate) fn scene<'s>(
        &'s self,
        model: &'s Model,
        robust: bool,
        filters: bool,
    ) -> Result<Scene<'s>, String> {
        let before = BYTES.load(Ordering::Relaxed);
        let flag = |is_on: bool, flag| if is_on { flag } else { 0 };
        let flags = flag(robust, api::SCENE_ROBUST) | flag(filters, api::SCENE_FILTERS);
        // SAFETY: the device is alive; the model lives for 's, longer than the scene that reads its
        // buffers.
        let handle = unsafe { model.commit(self.api, self.handle, flags) };
        // SAFETY: the device is alive.
        let error = unsafe { (self.api.device_error)(self.handle) };
        let scene = Scene {
            api: self.api,
            handle,
            width: self.width(),
            bytes: BYTES.load(Ordering::Relaxed) - before,
            model: PhantomData,
        };
        if error == 0 {
            Ok(scene)
        } else {
            Err(format!("Embree's error {error} while building a scene"))
        }
    }
}

impl Drop for Device<'_> {
    fn drop(&mut self) {
        // SAFETY: the device is alive, and its scenes borrow it, so there are none left.
        unsafe { (self.api.release_device)(self.handle) }
    }
}

/// A model with Embree's trees over it.
#[derive(Debug)]
pub(crate) struct Scene<'s> {
    pub(super) api: &'s Api,
    pub(super) handle: api::Handle,
    /// Rays in a packet.
    pub(super) width: usize,
    /// The bytes that Embree allocated to build and keep it, and did not give back.
    pub(crate) bytes: isize,
    model: PhantomData<&'s Model>,
}

impl Drop for Scene<'_> {
    fn drop(&mut self) {
        // SAFETY: the scene is alive, and nothing else holds it.
        unsafe { (self.api.release_scene)(self.handle) }
    }
}
