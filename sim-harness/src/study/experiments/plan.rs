//! How much of an experiment is simulated.

#[derive(Clone, Copy)]
pub struct Plan<'a> {
    /// Of the experiment, and what it asks.
    pub name: &'static str,
    pub question: &'static str,
    /// Sets of runs, each of a vehicle and with a seed of its own.
    pub sets: usize,
    /// Runs of each set.
    pub runs: usize,
    /// Of the first set.
    pub seed: u64,
    /// Called once for each piece of work that is done, with how many there are.
    pub done: &'a (dyn Fn(usize) + Sync),
}
