//! Whether there is memory, asked before it is needed.

use crate::error::{Error, Result};

/// Refuses what would take more memory than the system gives at this moment.
///
/// To be asked before work of many allocations that cannot each fail in an orderly manner: in Rust a small
/// one that fails ends the process. Under a limit on the address space (`ulimit -v`) the answer is exact, but
/// for what other threads take meanwhile.
///
/// # Errors
///
/// [`Error::Limit`].
pub(crate) fn check(what: &'static str, bytes: usize) -> Result<()> {
    let mut probe = Vec::<u8>::new();
    let refused = probe.try_reserve_exact(bytes).is_err();
    // Without this the compiler may see that nobody uses what is reserved, and not reserve it.
    std::hint::black_box(&mut probe);
    if refused {
        return Err(Error::Limit {
            what,
            got: format!("{bytes} bytes"),
            limit: "the memory there is".into(),
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_machine_has_is_refused() {
        assert!(check("bytes of a test", 1 << 20).is_ok());
        let error = check("bytes of a test", isize::MAX as usize).unwrap_err();
        assert!(
            error.to_string().starts_with("bytes of a test: "),
            "{error}"
        );
    }
}
