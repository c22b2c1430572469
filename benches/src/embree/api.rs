//! The part of Embree 4's C interface that we use, declared by hand, and opened at run time.
//!
//! Names are Embree's without their prefix; its manual describes each. Everything here is `unsafe`
//! to call.

use std::ffi::{c_char, c_int, c_uint, c_void};
use std::mem::ManuallyDrop;
use std::path::Path;

use super::packet::{RayHits, Rays};

pub(super) type Handle = *mut c_void;

/// `RTCIntersectArguments` of Embree 4.
#[derive(Debug)]
#[repr(C)]
pub(super) struct Arguments {
    pub(super) flags: c_uint,
    pub(super) feature_mask: c_uint,
    pub(super) context: *mut c_void,
    pub(super) filter: *mut c_void,
    pub(super) intersect: *mut c_void,
}

impl Arguments {
    pub(super) fn new(coherent: bool) -> Self {
        Self {
            flags: if coherent { QUERY_COHERENT } else { 0 },
            feature_mask: u32::MAX,
            context: std::ptr::null_mut(),
            filter: std::ptr::null_mut(),
            intersect: std::ptr::null_mut(),
        }
    }

    /// The arguments with a filter function and the context that it is given.
    pub(super) fn filtered(coherent: bool, filter: *mut c_void, context: *mut c_void) -> Self {
        let plain = Self::new(coherent);
        Self { flags: plain.flags | QUERY_INVOKE_ARGUMENT_FILTER, context, filter, ..plain }
    }
}

const QUERY_INVOKE_ARGUMENT_FILTER: c_uint = 1 << 1;
const QUERY_COHERENT: c_uint = 1 << 16;
pub(super) const PROPERTY_VERSION: c_int = 0;
pub(super) const PROPERTY_NATIVE_RAY16: c_int = 34;
pub(super) const GEOMETRY_TRIANGLE: c_int = 0;
pub(super) const GEOMETRY_SPHERE: c_int = 50;
pub(super) const GEOMETRY_INSTANCE: c_int = 121;
pub(super) const BUFFER_INDEX: c_int = 0;
pub(super) const BUFFER_VERTEX: c_int = 1;
pub(super) const FORMAT_UINT3: c_int = 0x5003;
pub(super) const FORMAT_FLOAT3: c_int = 0x9003;
pub(super) const FORMAT_FLOAT4: c_int = 0x9004;
pub(super) const FORMAT_COLUMNS: c_int = 0x9234;
pub(super) const QUALITY_MEDIUM: c_int = 1;
pub(super) const SCENE_ROBUST: c_int = 1 << 2;
pub(super) const SCENE_FILTERS: c_int = 1 << 3;

type Single<T> = unsafe extern "C" fn(Handle, *mut T, *mut Arguments);
type Packet<T> = unsafe extern "C" fn(*const c_int, Handle, *mut T, *mut Arguments);
type Monitor = unsafe extern "C" fn(*mut c_void, isize, bool) -> bool;

/// Declares the functions as fields of [`Api`] and finds each in the library by its name.
macro_rules! functions {
    ($($field:ident = $name:literal: $type:ty;)*) => {
        /// Embree's functions; they live as long as the library, which stays open.
        #[derive(Debug)]
        pub(super) struct Api {
            $(pub(super) $field: $type,)*
            /// Never closed: Embree's threads may still be leaving when the program ends.
            _library: ManuallyDrop<libloading::Library>,
        }

        impl Api {
            /// Opens the library at `path`.
            pub(super) fn open(path: &Path) -> Result<Self, libloading::Error> {
                // SAFETY: the caller names Embree 4; its initialisers do nothing but set up its own
                // state.
                let library = unsafe { libloading::Library::new(path) }?;
                $(
                    // SAFETY: the type is that of the function in Embree 4's headers, and
                    // `library`, which the function lives in, is kept beside it.
                    let $field = *unsafe { library.get::<$type>($name) }?;
                )*
                Ok(Self { $($field,)* _library: ManuallyDrop::new(library) })
            }
        }
    };
}

functions! {
    new_device = b"rtcNewDevice": unsafe extern "C" fn(*const c_char) -> Handle;
    release_device = b"rtcReleaseDevice": unsafe extern "C" fn(Handle);
    device_error = b"rtcGetDeviceError": unsafe extern "C" fn(Handle) -> c_int;
    device_property = b"rtcGetDeviceProperty": unsafe extern "C" fn(Handle, c_int) -> isize;
    set_memory_monitor = b"rtcSetDeviceMemoryMonitorFunction":
        unsafe extern "C" fn(Handle, Option<Monitor>, *mut c_void);
    new_geometry = b"rtcNewGeometry": unsafe extern "C" fn(Handle, c_int) -> Handle;
    set_shared_buffer = b"rtcSetSharedGeometryBuffer":
        unsafe extern "C" fn(Handle, c_int, c_uint, c_int, *const c_void, usize, usize, usize);
    set_instanced_scene = b"rtcSetGeometryInstancedScene": unsafe extern "C" fn(Handle, Handle);
    set_transform = b"rtcSetGeometryTransform":
        unsafe extern "C" fn(Handle, c_uint, c_int, *const c_void);
    commit_geometry = b"rtcCommitGeometry": unsafe extern "C" fn(Handle);
    release_geometry = b"rtcReleaseGeometry": unsafe extern "C" fn(Handle);
    new_scene = b"rtcNewScene": unsafe extern "C" fn(Handle) -> Handle;
    release_scene = b"rtcReleaseScene": unsafe extern "C" fn(Handle);
    set_scene_flags = b"rtcSetSceneFlags": unsafe extern "C" fn(Handle, c_int);
    set_build_quality = b"rtcSetSceneBuildQuality": unsafe extern "C" fn(Handle, c_int);
    attach_geometry = b"rtcAttachGeometry": unsafe extern "C" fn(Handle, Handle) -> c_uint;
    commit_scene = b"rtcCommitScene": unsafe extern "C" fn(Handle);
    intersect1 = b"rtcIntersect1": Single<RayHits<1>>;
    intersect8 = b"rtcIntersect8": Packet<RayHits<8>>;
    intersect16 = b"rtcIntersect16": Packet<RayHits<16>>;
    occluded1 = b"rtcOccluded1": Single<Rays<1>>;
    occluded8 = b"rtcOccluded8": Packet<Rays<8>>;
    occluded16 = b"rtcOccluded16": Packet<Rays<16>>;
}
