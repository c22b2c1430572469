//! Work in parts, by all threads of the current rayon pool.
//!
//! Here is the one loop: it calls what it does by pointer, once for each part. A parallel iterator
//! of rayon's is compiled for each closure anew, 8 kB of code and more.
//!
//! One part is done by the calling thread, without a pool.

use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use rayon::prelude::*;

use crate::error::Result;

/// The number of small things that are worth a part of their own.
pub const MANY: usize = 1 << 12;

/// Does `work` with each part.
pub fn each<P: Send>(parts: impl IntoIterator<Item = P>, work: impl Fn(P) + Sync) {
    let parts = slots(parts);
    run(parts.len(), &|number| work(parts[number].take()));
}

/// Does `work` with each part.
///
/// # Errors
///
/// One of those that `work` returns. Parts that have not begun by then never do.
pub fn try_each<P: Send>(
    parts: impl IntoIterator<Item = P>,
    work: impl Fn(P) -> Result<()> + Sync,
) -> Result<()> {
    let parts = slots(parts);
    try_run(parts.len(), &|number| work(parts[number].take()))
}

/// [`try_each`] with scratch memory that `new` makes, at most once for each part that is under way
/// at the same time.
pub fn try_each_with<S: Send, P: Send>(
    new: impl Fn() -> Result<S> + Sync,
    parts: impl IntoIterator<Item = P>,
    work: impl Fn(&mut S, P) -> Result<()> + Sync,
) -> Result<()> {
    // Boxed: it may be many kilobytes, and goes in and out for each part.
    let spare: Mutex<Vec<Box<S>>> = Mutex::default();
    try_each(parts, |part| {
        let idle = lock(&spare).pop();
        let mut scratch = idle.map_or_else(|| new().map(Box::new), Ok)?;
        work(&mut scratch, part)?;
        lock(&spare).push(scratch);
        Ok(())
    })
}

/// Maps each part by `work`; the results are in the order of the parts.
pub fn map<P: Send, T: Send>(
    parts: impl IntoIterator<Item = P>,
    work: impl Fn(P) -> T + Sync,
) -> Vec<T> {
    let parts = slots(parts);
    let made = parts.iter().map(|_| Slot::empty()).collect::<Vec<_>>();
    run(parts.len(), &|number| {
        made[number].put(work(parts[number].take()));
    });
    made.into_iter().map(Slot::into_inner).collect()
}

/// Maps each part by `work`; the results are in the order of the parts.
///
/// # Errors
///
/// The first error of `work`, as [`try_each`] returns it.
pub fn try_map<P: Send, T: Send>(
    parts: impl IntoIterator<Item = P>,
    work: impl Fn(P) -> Result<T> + Sync,
) -> Result<Vec<T>> {
    let parts = slots(parts);
    let made = parts.iter().map(|_| Slot::empty()).collect::<Vec<_>>();
    try_run(parts.len(), &|number| {
        made[number].put(work(parts[number].take())?);
        Ok(())
    })?;
    Ok(made.into_iter().map(Slot::into_inner).collect())
}

/// Maps each part to a list by `work`, and joins the lists in the order of the parts.
pub fn gather<P: Send, T: Send>(
    parts: impl IntoIterator<Item = P>,
    work: impl Fn(P) -> Vec<T> + Sync,
) -> Vec<T> {
    let mut made = map(parts, work);
    if made.len() == 1 {
        return made.swap_remove(0);
    }
    let mut all = Vec::with_capacity(made.iter().map(Vec::len).sum());
    for mut part in made {
        all.append(&mut part);
    }
    all
}

/// The values of `of` from 0 to `count - 1`, in parts of `size`.
pub fn gather_each<T: Send>(count: usize, size: usize, of: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let parts = (0..count).step_by(size).map(|first| first..count.min(first + size));
    gather(parts, |part| part.map(&of).collect())
}

/// Tells whether `is_so` holds for every part. All are asked.
pub fn all<P: Send>(parts: impl IntoIterator<Item = P>, is_so: impl Fn(P) -> bool + Sync) -> bool {
    map(parts, is_so).into_iter().all(|is_so| is_so)
}

/// The value of a cell, computed when it is first asked for.
///
/// Several threads that ask at the same time compute it each, and the first value is kept. No
/// thread waits for another's computation: in a forked process that thread does not exist, and a
/// thread of a pool that waits may take up work that asks for the same value.
#[expect(clippy::disallowed_methods, reason = "the value is there already")]
pub fn once<T>(cell: &OnceLock<T>, compute: impl FnOnce() -> T) -> &T {
    if let Some(value) = cell.get() {
        return value;
    }
    let value = compute();
    cell.get_or_init(|| value)
}

fn run(count: usize, work: &(dyn Fn(usize) + Sync)) {
    match count {
        0 => {}
        1 => work(0),
        _ => (0..count).into_par_iter().for_each(work),
    }
}

fn try_run(count: usize, work: &(dyn Fn(usize) -> Result<()> + Sync)) -> Result<()> {
    match count {
        0 => Ok(()),
        1 => work(0),
        _ => (0..count).into_par_iter().try_for_each(work),
    }
}

fn slots<P>(parts: impl IntoIterator<Item = P>) -> Vec<Slot<P>> {
    parts.into_iter().map(Slot::of).collect()
}

/// A slot in which a part waits for the one thread that takes it, or its result for the caller.
struct Slot<T>(Mutex<Option<T>>);

impl<T> Slot<T> {
    fn empty() -> Self {
        Self(Mutex::new(None))
    }

    fn of(value: T) -> Self {
        Self(Mutex::new(Some(value)))
    }

    fn put(&self, value: T) {
        *lock(&self.0) = Some(value);
    }

    fn take(&self) -> T {
        lock(&self.0).take().expect("each number comes once")
    }

    fn into_inner(self) -> T {
        let value = self.0.into_inner().unwrap_or_else(PoisonError::into_inner);
        value.expect("all numbers came")
    }
}

/// Locks a mutex; no code that can panic runs under it.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use std::sync::Barrier;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::sync::mpsc::channel;
    use std::thread::sleep;
    use std::time::Duration;

    use super::*;
    use crate::error::Error;

    const COUNTS: [usize; 4] = [0, 1, 2, 1000];

    #[test]
    fn what_is_made_is_in_the_order_of_its_parts() {
        for count in COUNTS {
            let squares: Vec<usize> = (0..count).map(|number| number * number).collect();
            assert_eq!(map(0..count, |number| number * number), squares);
            let made = try_map(0..count, |number| Ok(number * number));
            assert_eq!(made.unwrap(), squares);
            let twice = gather(0..count, |number| vec![number; 2]);
            assert!(twice.into_iter().eq((0..2 * count).map(|k| k / 2)));
        }
    }

    #[test]
    fn each_part_comes_once() {
        for count in COUNTS {
            let mut values = vec![0; count];
            each(values.iter_mut(), |value| *value += 1);
            try_each(values.iter_mut(), |value| {
                *value += 1;
                Ok(())
            })
            .unwrap();
            assert!(values.iter().all(|&value| value == 2));
        }
    }

    #[test]
    fn all_are_so_only_where_each_is() {
        for count in COUNTS {
            assert!(all(0..count, |number| number < count));
            assert!(count == 0 || !all(0..count, |number| number + 1 < count));
        }
    }

    #[test]
    fn nobody_waits_for_another_who_computes() {
        let cell = OnceLock::new();
        let begun = Barrier::new(2);
        let (end, ended) = channel();
        std::thread::scope(|scope| {
            let slow = scope.spawn(|| {
                *once(&cell, || {
                    begun.wait();
                    // Who waited for this would get 1.
                    let _ = ended.into_iter().next();
                    1
                })
            });
            begun.wait();
            let waits = scope.spawn(|| *once(&cell, || 2));
            let is_there = (0..1000).any(|_| {
                sleep(Duration::from_millis(10));
                waits.is_finished()
            });
            end.send(()).unwrap();
            assert!(is_there, "it waited");
            // The value that was kept first is everybody's.
            assert_eq!([waits.join().unwrap(), slow.join().unwrap()], [2, 2]);
        });
    }

    #[test]
    fn scratch_memory_is_used_again() {
        let made = AtomicUsize::new(0);
        let new = || Ok(made.fetch_add(1, Ordering::Relaxed));
        try_each_with(new, 0..1000, |_, _| Ok(())).unwrap();
        assert!((1..=rayon::current_num_threads()).contains(&made.into_inner()));
    }

    #[test]
    fn after_an_error_nothing_more_begins() {
        let begun = AtomicUsize::new(0);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
        let result = pool.unwrap().install(|| {
            try_map(0..1000, |number| {
                begun.fetch_add(1, Ordering::Relaxed);
                if number == 3 { Err(Error::Interrupted) } else { Ok(()) }
            })
        });
        assert!(matches!(result, Err(Error::Interrupted)));
        assert!(begun.into_inner() < 1000);
    }
}
