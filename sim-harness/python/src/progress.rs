//! Progress of long work: a function of Python, or lines on `sys.stderr`.
//!
//! The work goes on without the interpreter's lock; it is taken for the call alone. What the function raises is kept and raised when the work is done.

use pyo3::prelude::*;
use std::sync::{
    Mutex,
    atomic::{AtomicUsize, Ordering},
};

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
}

impl Progress {
    /// Of so many runs; of steps with a name, where there are none.
    pub fn new(wanted: Option<Wanted>, total: usize) -> Self {
        let wanted = wanted.unwrap_or(Wanted::Lines(false));
        Self { wanted, total, done: AtomicUsize::new(0), error: Mutex::new(None) }
    }

    /// One more run is done.
    pub fn one_more(&self) {
        let (done, total) = (self.done.fetch_add(1, Ordering::Relaxed) + 1, self.total);
        let end = if done == total { "\n" } else { "" };
        self.say(|function| function.call1((done, total)).map(drop), || format!("\r{done} of {total} runs{end}"));
    }

    /// A step begins.
    pub fn step(&self, text: &str) {
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
        // A lock that is poisoned has an error already.
        if let (Err(error), Ok(mut first)) = (said, self.error.lock()) {
            first.get_or_insert(error);
        }
    }

    /// The first error of a call.
    ///
    /// # Errors
    /// What the function raised.
    pub fn end(self) -> PyResult<()> {
        let error = self.error.into_inner().ok().flatten();
        error.map_or(Ok(()), Err)
    }
}
