//! Progress of long work: a function of Python, or lines on `sys.stderr`.
//!
//! The work goes on in a thread of its own, without the interpreter's lock, which is taken for the call alone.
//! Meanwhile the calling thread looks for an interrupt from the keyboard: Python sees it in the main thread only. An
//! interrupt, or what the function raises, ends the work at its next run or step: that unwinds the work's thread, as
//! its results are wanted no more, and is raised in the caller's.

use pyo3::prelude::*;
use std::sync::{
    Mutex,
    atomic::{AtomicBool, AtomicUsize, Ordering},
};
use std::time::Duration;
use std::{panic, thread};

/// Between two looks for an interrupt.
const LOOK: Duration = Duration::from_millis(50);

/// What the argument `progress` says.
#[derive(FromPyObject)]
pub enum Wanted {
    /// True: lines on `sys.stderr`; False: nothing.
    Lines(bool),
    /// A function.
    Function(Py<PyAny>),
}

/// How it is said, and the first error of saying it.
pub struct Progress {
    wanted: Wanted,
    total: usize,
    done: AtomicUsize,
    error: Mutex<Option<PyErr>>,
    is_stopped: AtomicBool,
}

/// What unwinds the work's thread.
struct Stopped;

impl Progress {
    /// Of so many runs; of steps with a name, where there are none.
    pub fn new(wanted: Option<Wanted>, total: usize) -> Self {
        let wanted = wanted.unwrap_or(Wanted::Lines(false));
        Self { wanted, total, done: AtomicUsize::new(0), error: Mutex::new(None), is_stopped: AtomicBool::new(false) }
    }

    /// Does the work, and says its progress.
    ///
    /// # Errors
    /// What the function raised, or an interrupt.
    pub fn during<T: Send>(&self, py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
        let caller = thread::current();
        let ended = py.detach(|| {
            thread::scope(|scope| {
                let worker = scope.spawn(move || {
                    let made = work();
                    caller.unpark();
                    made
                });
                while !worker.is_finished() {
                    thread::park_timeout(LOOK);
                    Python::attach(|py| py.check_signals()).unwrap_or_else(|interrupt| self.stop(interrupt));
                }
                worker.join()
            })
        });
        match (self.error.lock().ok().and_then(|mut first| first.take()), ended) {
            (Some(error), _) => Err(error),
            (None, Ok(made)) => Ok(made),
            (None, Err(cause)) => panic::resume_unwind(cause),
        }
    }

    /// The first error counts.
    fn stop(&self, error: PyErr) {
        // A lock that is poisoned has an error already.
        if let Ok(mut first) = self.error.lock() {
            first.get_or_insert(error);
        }
        self.is_stopped.store(true, Ordering::Relaxed);
    }

    /// Ends the work where it is wanted no more.
    fn go_on(&self) {
        if self.is_stopped.load(Ordering::Relaxed) {
            panic::resume_unwind(Box::new(Stopped));
        }
    }

    /// One more run is done.
    pub fn one_more(&self) {
        self.go_on();
        let (done, total) = (self.done.fetch_add(1, Ordering::Relaxed) + 1, self.total);
        let end = if done == total { "\n" } else { "" };
        self.say(|function| function.call1((done, total)).map(drop), || format!("\r{done} of {total} runs{end}"));
    }

    /// A step begins.
    pub fn step(&self, text: &str) {
        self.go_on();
        self.say(|function| function.call1((text,)).map(drop), || format!("{text}\n"));
    }

    fn say(&self, call: impl FnOnce(&Bound<'_, PyAny>) -> PyResult<()>, line: impl FnOnce() -> String) {
        if matches!(self.wanted, Wanted::Lines(false)) {
            return;
        }
        let said = Python::attach(|py| match &self.wanted {
            Wanted::Function(function) => call(function.bind(py)),
            Wanted::Lines(_) => {
                let stderr = py.import("sys")?.getattr("stderr")?;
                stderr.call_method1("write", (line(),)).map(drop)
            }
        });
        said.unwrap_or_else(|error| self.stop(error));
    }
}
