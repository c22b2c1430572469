//! firsthit's viewer as a WebAssembly module: a door of plain functions, for pages and for any
//! other host of modules.
//!
//! The host puts bytes into a room ([`fh_room`]), and calls [`fh_load`] or [`fh_ask`], which say
//! whether all went well. Then it reads the answer, and for some questions the pixels, by their
//! address and length. The module imports nothing, opens nothing, and holds one scene at a time.
//! `firsthit.mjs` of the crate firsthit-view wraps the calls for JavaScript.
//!
//! Requests and answers are those of the server of `firsthit view`; see
//! [`Door`].

#![allow(
    unsafe_code,
    reason = "only the names of the door's functions: a linker takes them for unique, and the prefix makes them so"
)]

mod door;

use std::panic;
use std::ptr;
use std::sync::{Mutex, MutexGuard, Once, PoisonError};

pub use door::{Door, Refused};

static DOOR: Mutex<Door> = Mutex::new(Door::new());

/// The message of a bug that ended a call. It is apart, for the call holds the door.
static BUG: Mutex<String> = Mutex::new(String::new());

/// The door. A bug behind it leaves a text.
fn door() -> MutexGuard<'static, Door> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| panic::set_hook(Box::new(|bug| *lock(&BUG) = bug.to_string())));
    lock(&DOOR)
}

/// A poisoned lock holds what it did.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// All went well.
const DONE: i32 = 0;
/// The answer is a line that says why not.
const REFUSED: i32 = 1;

fn status(result: Result<(), Refused>) -> i32 {
    match result {
        Ok(()) => DONE,
        Err(Refused) => REFUSED,
    }
}

/// Makes room for what the host hands over, and returns its address; null where there is no memory.
/// A room is used up by the next call of [`fh_load`] or [`fh_ask`].
#[unsafe(no_mangle)]
pub extern "C" fn fh_room(bytes: usize) -> *mut u8 {
    door().room(bytes).map_or(ptr::null_mut(), <[u8]>::as_mut_ptr)
}

/// Reads the file in the room: its name, which takes that many bytes, and then its content. Returns
/// 0 where all went well; then the viewer is about this file, and the answer is that to `info`.
#[unsafe(no_mangle)]
pub extern "C" fn fh_load(name_bytes: usize) -> i32 {
    status(door().load(name_bytes))
}

/// Takes the embedded example in place of a file.
#[unsafe(no_mangle)]
pub extern "C" fn fh_example() -> i32 {
    status(door().example())
}

/// Answers the question in the room: its name, which takes that many bytes, and then its JSON.
#[unsafe(no_mangle)]
pub extern "C" fn fh_ask(name_bytes: usize) -> i32 {
    status(door().ask(name_bytes))
}

/// The address of the last answer: JSON, or where a call was refused a line of text.
#[unsafe(no_mangle)]
pub extern "C" fn fh_answer() -> *const u8 {
    door().answer().as_ptr()
}

/// The length of the last answer, in bytes.
#[unsafe(no_mangle)]
pub extern "C" fn fh_answer_bytes() -> usize {
    door().answer().len()
}

/// The address of the last answer's pixels.
#[unsafe(no_mangle)]
pub extern "C" fn fh_pixels() -> *const u8 {
    door().pixels().as_ptr()
}

/// The length of the pixels, in bytes; 0 where the answer has none.
#[unsafe(no_mangle)]
pub extern "C" fn fh_pixels_bytes() -> usize {
    door().pixels().len()
}

/// The address of what is known of a call that a trap ended. After a trap nothing else may be
/// called: start another module.
#[unsafe(no_mangle)]
pub extern "C" fn fh_bug() -> *const u8 {
    lock(&BUG).as_ptr()
}

/// The length of the message, in bytes; 0 where nothing is known.
#[unsafe(no_mangle)]
pub extern "C" fn fh_bug_bytes() -> usize {
    lock(&BUG).len()
}
