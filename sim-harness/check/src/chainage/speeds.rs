//! Do the speeds over the location agree better when a run is moved, in both halves of it?

use crate::profile::{CELL_M, Profile, get};

/// Places where the speed changes by less over the shift say nothing of it, m/s.
const INFORMATIVE_MPS: f32 = 3.0;
/// Of these places each half must have so many, 50 m each.
const LEAST_PLACES: usize = 3;
/// And the difference of the speeds must be less than this share of what it is without the shift: in each half, where drivers coast as they like, and in both.
const HALF_SHARE: f32 = 0.9;
const AGREE_SHARE: f32 = 0.6;

/// Median speed by cell, m/s; not a number where nothing is known.
pub struct Speeds {
    first_cell: i64,
    medians_mps: Vec<f32>,
}

impl Speeds {
    /// Of these runs.
    pub fn of(profiles: &[Profile], runs: &[usize]) -> Self {
        let of_runs = || runs.iter().map(|run| &profiles[*run]);
        let first_cell = of_runs().map(|profile| profile.first_cell).min().unwrap_or(0);
        let end = of_runs().map(|profile| profile.first_cell + profile.speeds_mps.len() as i64).max();
        let median = |cell: i64| {
            let mut speeds: Vec<f32> = of_runs().filter_map(|profile| profile.speed_mps(cell)).collect();
            let middle = speeds.len() / 2;
            if speeds.is_empty() { f32::NAN } else { *speeds.select_nth_unstable_by(middle, f32::total_cmp).1 }
        };
        Self { first_cell, medians_mps: (first_cell..end.unwrap_or(first_cell)).map(median).collect() }
    }

    fn mps(&self, cell: i64) -> Option<f32> {
        get(&self.medians_mps, cell - self.first_cell)
    }
}

/// The speeds `here` are those `there`, moved by so many metres, and not those as they are.
pub fn agree(there: &Speeds, here: &Speeds, by_m: f64) -> bool {
    let by = (by_m / CELL_M).round() as i64;
    let compared = |at: usize| {
        let cell = here.first_cell + at as i64;
        let (mps, moved, unmoved) = (here.mps(cell)?, there.mps(cell + by)?, there.mps(cell)?);
        ((moved - unmoved).abs() > INFORMATIVE_MPS).then(|| [(mps - moved).abs(), (mps - unmoved).abs()])
    };
    let middle = here.medians_mps.len() / 2;
    let of_half = |half: std::ops::Range<usize>| {
        let each: Vec<[f32; 2]> = half.filter_map(compared).collect();
        let [moved, unmoved] = [0, 1].map(|which| each.iter().map(|off| off[which]).sum::<f32>());
        (each.len() >= LEAST_PLACES && moved < HALF_SHARE * unmoved).then_some([moved, unmoved])
    };
    let halves = [of_half(0..middle), of_half(middle..here.medians_mps.len())];
    matches!(halves, [Some(a), Some(b)] if a[0] + b[0] < AGREE_SHARE * (a[1] + b[1]))
}
