//! The processor's floating-point control word.

/// A guard: while it lives, numbers too small for the normal format are zero on this thread, as
/// Embree's manual asks for. firsthit is never called meanwhile: it wants IEEE arithmetic.
#[derive(Debug)]
pub(crate) struct FlushToZero {
    #[cfg(target_arch = "x86_64")]
    before: u32,
}

impl FlushToZero {
    /// Switches it on.
    pub(crate) fn on() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            /// Flush to zero, and denormals are zero.
            const BOTH: u32 = 1 << 15 | 1 << 6;
            let before = read();
            write(before | BOTH);
            Self { before }
        }
        #[cfg(not(target_arch = "x86_64"))]
        Self {}
    }
}

impl Drop for FlushToZero {
    fn drop(&mut self) {
        #[cfg(target_arch = "x86_64")]
        write(self.before);
    }
}

#[cfg(target_arch = "x86_64")]
fn read() -> u32 {
    let mut word = 0_u32;
    // SAFETY: stores the control word, 4 bytes, where the pointer points.
    unsafe { std::arch::asm!("stmxcsr [{}]", in(reg) &raw mut word, options(nostack)) };
    word
}

#[cfg(target_arch = "x86_64")]
fn write(word: u32) {
    // SAFETY: loads the control word from 4 bytes that are alive. Only bits of this thread's
    // rounding of subnormal numbers differ from what Rust assumes; the code run meanwhile (filling
    // packets of ordinary numbers) meets none.
    unsafe { std::arch::asm!("ldmxcsr [{}]", in(reg) &raw const word, options(nostack, readonly)) };
}
