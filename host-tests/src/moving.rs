//! The steps of a true run in which the train moves, for accounts of what acts on it.

use rundown_truth::sensors::TruthSample;

/// One step of the simulator.
#[derive(Clone, Copy, Debug)]
pub struct MovingStep {
    /// Its beginning.
    pub from: TruthSample,
    /// Its end.
    pub to: TruthSample,
    /// Time from the departure to its middle, s.
    pub since_departure_s: f64,
    /// The train has braked by now.
    pub braked: bool,
}

impl MovingStep {
    /// Of a quantity that is steady or changes evenly: its value in the middle.
    pub fn mean(&self, of: fn(&TruthSample) -> f64) -> f64 {
        (of(&self.from) + of(&self.to)) / 2.0
    }

    /// Mean acceleration, m/s².
    pub fn acceleration_mps2(&self) -> f64 {
        (self.to.speed_mps - self.from.speed_mps) / (self.to.time_s - self.from.time_s)
    }
}

/// The steps of a trace that begin and end in motion; none where the train stands throughout.
pub fn moving_steps(trace: &[TruthSample]) -> impl Iterator<Item = MovingStep> {
    let steps = || trace.windows(2).map(|pair| [pair[0], pair[1]]);
    let departed_s = steps().find(|[_, to]| to.speed_mps > 0.0).map_or(f64::NAN, |[from, _]| from.time_s);
    let mut braked = false;
    steps().filter_map(move |[from, to]| {
        braked |= to.effort_n_per_kg < 0.0 && to.speed_mps > 0.0;
        let since_departure_s = (from.time_s + to.time_s) / 2.0 - departed_s;
        let moves = from.speed_mps != 0.0 && to.speed_mps != 0.0;
        moves.then_some(MovingStep { from, to, since_departure_s, braked })
    })
}
