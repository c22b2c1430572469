//! Pools of threads: as many as are asked for, or as many as the system grants. The result is the
//! same for any number.

use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::failure::Failure;

/// The stack of a thread, rayon's own default.
const STACK_BYTES: usize = 2 << 20;

/// The bytes that a thread maps beside its stack: guard pages, and a stack for signal handlers.
/// Where the system refuses that one, the standard library ends the process.
const BESIDE_STACK_BYTES: usize = 1 << 17;

/// The address space that glibc's allocator reserves for a thread, if there is as much.
const ARENA_BYTES: usize = 64 << 20;

/// The bytes that must be left for the work. A small allocation that fails ends the process.
const SPARE_BYTES: usize = 32 << 20;

/// The number of processors of this process, also by the limits of a control group.
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// A pool of `threads` threads, or of as many as the system grants.
///
/// # Errors
///
/// In words, where it grants none.
pub fn pool(mut threads: usize) -> Result<ThreadPool, String> {
    loop {
        let builder = ThreadPoolBuilder::new().num_threads(threads).stack_size(STACK_BYTES);
        let made = check_room(threads);
        match made.and_then(|()| builder.build().map_err(|error| error.to_string())) {
            Err(_) if threads > 1 => threads /= 2,
            last => return last,
        }
    }
}

/// Checks that there is address space for `threads` threads, which a limit such as `ulimit -v` may
/// deny. A thread alone does without an arena of its own.
fn check_room(threads: usize) -> Result<(), String> {
    let stacks = threads.saturating_mul(STACK_BYTES + BESIDE_STACK_BYTES);
    let arenas = (threads - 1).saturating_mul(ARENA_BYTES);
    let bytes = stacks.saturating_add(arenas).saturating_add(SPARE_BYTES);
    let mut probe = Vec::<u8>::new();
    let refused = probe.try_reserve_exact(bytes);
    // Without this the compiler may see that the room is not used, and not ask for it.
    std::hint::black_box(&mut probe);
    refused.map_err(|error| error.to_string())
}

/// Runs `work` with that many threads, or with all cores; the last resort is the thread that runs
/// already.
pub(crate) fn with_threads<T: Send>(
    threads: Option<u16>,
    work: impl FnOnce() -> Result<T, Failure> + Send,
) -> Result<T, Failure> {
    let alone = || ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
    let pool = pool(threads.map_or_else(cores, usize::from)).or_else(|_| alone());
    pool.map_err(|error| Failure::limit(format!("threads: {error}")))?.install(work)
}

/// Has all threads of the program share that many, or all cores.
pub(crate) fn share_threads(threads: Option<u16>) -> Result<(), Failure> {
    let threads = threads.map_or_else(cores, usize::from);
    let built = ThreadPoolBuilder::new().num_threads(threads).build_global();
    built.map_err(|error| Failure::limit(format!("{threads} threads: {error}")))
}
