//! Standard input, read by a thread of its own.

use std::io::{self, Read};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use crate::failure::Failure;

/// The number of bytes that are read at a time.
const PIECE: usize = 1 << 18;

/// The most bytes of whole lines that are read ahead of the rays that are shot. A line may be
/// longer.
const MOST_AHEAD: usize = 1 << 26;

/// The most bytes of a line. None of numbers has a thousand.
const LONGEST_LINE: usize = 1 << 24;

/// The time between two checks whether a wait should stop.
const PATIENCE: Duration = Duration::from_millis(50);

/// The number of bytes that tell the format of the rays.
pub(super) const MARK: usize = 6;

/// The bytes that have arrived and were not taken yet.
#[derive(Default)]
struct State {
    bytes: Vec<u8>,
    has_line: bool,
    /// Whether the caller wants the whole input at once.
    is_gathered: bool,
    end: Option<io::Result<()>>,
}

#[derive(Default)]
struct Shared {
    state: Mutex<State>,
    came: Condvar,
    taken: Condvar,
}

impl Shared {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Reads to the end. Once the `Feed` is dropped, no more than one piece is read: a `read` that
    /// waits keeps waiting.
    fn fill(self: &Arc<Self>) {
        let mut piece = vec![0; PIECE];
        let mut input = io::stdin().lock();
        let end = loop {
            let read = match input.read(&mut piece) {
                Ok(0) => break Ok(()),
                Ok(read) => &piece[..read],
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Err(error) => break Err(error),
            };
            let mut state = self.state();
            state.has_line |= read.contains(&b'\n');
            state.bytes.extend_from_slice(read);
            self.came.notify_one();
            while state.has_line && !state.is_gathered && state.bytes.len() > MOST_AHEAD {
                state = (self.taken.wait(state)).unwrap_or_else(PoisonError::into_inner);
            }
            if Arc::strong_count(self) == 1 {
                return;
            }
        };
        self.state().end = Some(end);
        self.came.notify_one();
    }
}

/// Standard input. A call takes all that has arrived since the last one, be it one line or a
/// million.
pub(crate) struct Feed {
    shared: Arc<Shared>,
}

impl Feed {
    /// `None` if the system grants no thread.
    pub(crate) fn new() -> Option<Self> {
        let shared = Arc::<Shared>::default();
        let filled = Arc::clone(&shared);
        let thread = thread::Builder::new().name("standard input".into());
        thread.spawn(move || filled.fill()).ok()?;
        Some(Self { shared })
    }

    /// The first [`MARK`] bytes, without taking them.
    pub(crate) fn mark(&self, is_stopped: &dyn Fn() -> bool) -> Result<Vec<u8>, Failure> {
        let is_enough = |state: &State| state.bytes.len() >= MARK || state.has_line;
        let state = self.wait(is_enough, is_stopped)?;
        Ok(state.bytes.iter().copied().take(MARK).collect())
    }

    /// All whole lines that have arrived, or the rest at the end of the input; `None` after that.
    /// Waits for a line.
    pub(crate) fn lines(&self, is_stopped: &dyn Fn() -> bool) -> Result<Option<Vec<u8>>, Failure> {
        let is_too_long = |state: &State| !state.has_line && state.bytes.len() > LONGEST_LINE;
        let is_enough = |state: &State| state.has_line || is_too_long(state);
        let mut state = self.wait(is_enough, is_stopped)?;
        if is_too_long(&state) {
            let what = "standard input: a line of rays is longer than 16 MiB";
            return Err(Failure::bad_input(what.to_owned()));
        }
        let whole = if state.end.is_some() {
            state.bytes.len()
        } else {
            let line_break = state.bytes.iter().rposition(|&byte| byte == b'\n');
            line_break.map_or(0, |place| place + 1)
        };
        let rest = state.bytes.split_off(whole);
        let lines = std::mem::replace(&mut state.bytes, rest);
        state.has_line = false;
        self.shared.taken.notify_one();
        Ok((!lines.is_empty()).then_some(lines))
    }

    /// The whole input. Waits for its end.
    pub(crate) fn all(&self, is_stopped: &dyn Fn() -> bool) -> Result<Vec<u8>, Failure> {
        self.shared.state().is_gathered = true;
        self.shared.taken.notify_one();
        let mut state = self.wait(|_| false, is_stopped)?;
        Ok(std::mem::take(&mut state.bytes))
    }

    /// Waits for the end, or until there `is_enough`.
    fn wait(
        &self,
        is_enough: impl Fn(&State) -> bool,
        is_stopped: &dyn Fn() -> bool,
    ) -> Result<MutexGuard<'_, State>, Failure> {
        let mut state = self.shared.state();
        loop {
            if let Some(Err(error)) = &state.end {
                return Err(Failure::bad_input(format!("standard input: {error}")));
            }
            if is_enough(&state) || state.end.is_some() {
                return Ok(state);
            }
            if is_stopped() {
                return Err(firsthit::Error::Interrupted.into());
            }
            let waited = self.shared.came.wait_timeout(state, PATIENCE);
            state = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }
}
