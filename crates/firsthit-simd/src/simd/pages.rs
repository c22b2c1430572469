//! Large pages, for arrays of megabytes. Where these are read at random, or written for the first
//! time, small pages cost more than the work itself.

/// A smaller array is not worth the call.
const LARGE: usize = 4 << 20;

/// Asks the system to back the memory of `values` with large pages, best before anything is written
/// there. Only time is lost where it does not.
pub(crate) fn prefer_large_pages<T>(values: &[T]) {
    if size_of_val(values) < LARGE {
        return;
    }
    #[cfg(target_os = "linux")]
    {
        let range = values.as_ptr_range();
        let page = rustix::param::page_size();
        // Whole pages only: the first and the last may hold other things too.
        let start = (range.start as usize).next_multiple_of(page);
        let end = range.end as usize / page * page;
        let pages = range.start.cast_mut().cast::<std::ffi::c_void>();
        let pages = pages.wrapping_byte_add(start - range.start as usize);
        // SAFETY: the pages are all within `values`; the advice changes neither what they hold nor
        // who may use them.
        let advice = unsafe {
            rustix::mm::madvise(pages, end.saturating_sub(start), rustix::mm::Advice::LinuxHugepage)
        };
        // Systems without large pages say so: that is all right.
        advice.ok();
    }
}
