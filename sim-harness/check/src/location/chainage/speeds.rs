//! Do the speeds over the location agree better when a run is moved, in both halves of it?

use crate::rows::profile::{CELL_M, Medians};
use std::ops::Range;

/// Places where the speed changes by less over the shift say nothing of it, m/s.
const INFORMATIVE_MPS: f32 = 3.0;
/// Of these places each half must have so many, 50 m each.
const LEAST_PLACES: usize = 3;
/// And the difference of the speeds must be less than this share of what it is without the shift: in each half, where
/// drivers coast as they like, and in both.
const HALF_SHARE: f32 = 0.9;
const AGREE_SHARE: f32 = 0.6;

/// The speeds `here` are those `there`, moved by so many metres, and not those as they are.
pub fn agree(there: &Medians, here: &Medians, by_m: f64) -> bool {
    let by = (by_m / CELL_M).round() as i64;
    let compared = |cell: i64| {
        let (mps, moved, unmoved) = (here.mps(cell)?, there.mps(cell + by)?, there.mps(cell)?);
        ((moved - unmoved).abs() > INFORMATIVE_MPS).then(|| [(mps - moved).abs(), (mps - unmoved).abs()])
    };
    let of_half = |half: Range<i64>| {
        let each: Vec<[f32; 2]> = half.filter_map(compared).collect();
        let [moved, unmoved] = [0, 1].map(|which| each.iter().map(|off| off[which]).sum::<f32>());
        (each.len() >= LEAST_PLACES && moved < HALF_SHARE * unmoved).then_some([moved, unmoved])
    };
    let Range { start, end } = here.cells();
    let middle = start + (end - start) / 2;
    let halves = [of_half(start..middle), of_half(middle..end)];
    matches!(halves, [Some(a), Some(b)] if a[0] + b[0] < AGREE_SHARE * (a[1] + b[1]))
}
