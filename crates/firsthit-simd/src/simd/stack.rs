//! Runs kernels on stacks that are large enough for them.

/// Does `work` on this thread: the frame of an optimised kernel is smaller than 100 KiB.
#[cfg(not(unoptimised))]
#[inline(always)]
pub fn with_stack<T>(work: impl FnOnce() -> T) -> T {
    work()
}

/// Does `work` on a thread with a stack of 16 MiB: the frame of an unoptimised kernel may exceed
/// one megabyte, and rayon's threads have two. That is this thread where it is within such work
/// already: so what a thread remembers between kernels is there for the next, if all of them are
/// within one piece of work.
#[cfg(unoptimised)]
pub fn with_stack<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    use std::sync::OnceLock;
    use std::thread::{Builder, scope};

    use rayon::{ThreadPool, ThreadPoolBuilder, current_thread_index};

    /// The size of the stack. Only what is touched of it takes memory.
    const STACK_BYTES: usize = 16 << 20;
    static POOL: OnceLock<Option<ThreadPool>> = OnceLock::new();
    #[expect(
        clippy::disallowed_methods,
        reason = "one pool, however many ask; a child that is forked has no use for it either way"
    )]
    let pool = POOL.get_or_init(|| {
        let builder = ThreadPoolBuilder::new().stack_size(STACK_BYTES);
        builder.build().ok()
    });
    let Some(pool) = pool else {
        // Where there are no threads to be had, the caller's stack is all there is.
        return work();
    };
    if pool.current_thread_index().is_some() {
        return work();
    }
    if current_thread_index().is_none() {
        return pool.install(work);
    }
    // A thread of another pool that waits in `install` takes up more of its own pool's work
    // meanwhile, which may wait in turn: on a small stack that overflows. A thread of no pool just
    // waits.
    scope(|scope| {
        let waiting = Builder::new().spawn_scoped(scope, || pool.install(work));
        let waiting = waiting.expect("a thread, as there were for the pool");
        waiting.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}
