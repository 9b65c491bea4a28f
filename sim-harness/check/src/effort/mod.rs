//! An effort column that has nothing to do with the train: noise, zeros, another train's, the sign turned.
//!
//! In: rows of all runs of a unit, put right. Out: how the measured effort goes with the acceleration, where it does
//! not.
//!
//! Resistance and gradients stand between the two, so they never agree in full; over starts and stops they agree by far
//! the most. The measured mode learns from the column whatever it holds, so one that does not follow the train is said.
//!
//! | question | module |
//! |---|---|
//! | does it change in stairs? | `stairs` |
//! | does it stand still? | `held` |
//! | is it cut off at a maximum? | `cut` |
//! | is it older than the speed? | `age` |
//! | is it what acts, or what the lever asks for? | `demanded` |
//! | have small efforts the gain of large ones? | `small` |
//! | is nothing between zero and a least one? | `gap` |
//! | is the effort of a run unlike that of the others? | `unlike` |
//! | what does it have for trains that coast? | `coasting` |
//! | is its zero one? | `zero` |
//! | what did trains do where it hardly changes? | `driven` |

pub(crate) mod age;
pub(crate) mod coasting;
pub(crate) mod cut;
pub(crate) mod demanded;
pub(crate) mod driven;
pub(crate) mod gap;
pub(crate) mod held;
pub(crate) mod small;
pub(crate) mod stairs;
pub(crate) mod unlike;
pub(crate) mod zero;

use crate::figure::{Figure, HALF_95};
use nalgebra::{SMatrix, SVector};
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;
use rundown_files::statistics::{Pairs, mean_of};

/// Means over so long are compared, s: a lag of some seconds does not matter.
const WINDOW_S: f64 = 30.0;
/// So many windows of a moving train, and speeds that change by so much, m/s^2 (standard deviation), can show it.
const LEAST_WINDOWS: usize = 60;
const LEAST_CHANGE: f64 = 0.03;
/// A correlation that may be above this is one. Judgement: right columns have 0.7 and more.
const LEAST_CORRELATION: f64 = 0.3;

/// A train that slows down faster brakes, m/s²; and an effort that has this share of that, and the other sign, is none
/// of a brake.
const BRAKES_MPS2: f64 = 0.25;
const FOLLOWS: f64 = 0.4;
/// So many windows of braking decide.
const LEAST_BRAKES: usize = 5;
/// The same of a single run, in shorter windows, s: it may brake only once.
const LEAST_OWN_BRAKES: usize = 4;
const BRAKE_WINDOW_S: f64 = 10.0;

/// An effort column that does not go with the acceleration.
#[derive(Clone, Debug, PartialEq)]
pub struct Apart {
    /// Correlation of both over windows of 30 s.
    pub correlation: Figure,
    /// Windows.
    pub windows: usize,
    /// What the column holds instead.
    pub evidence: String,
}

/// Of the runs of one unit; nothing where the column follows the train, or too little is there to see it.
pub fn apart<'a>(recordings: impl Iterator<Item = &'a Recording>) -> Option<Apart> {
    let pairs: Vec<(f64, f64)> = recordings.flat_map(|recording| windows(&recording.rows)).collect();
    let n = pairs.len() as f64;
    let Pairs { y: effort, xx: cc, xy: ce, yy: ee, .. } = Pairs::of(&pairs);
    if pairs.len() < LEAST_WINDOWS || (cc / n).sqrt() < LEAST_CHANGE {
        return None;
    }
    let is_constant = ee <= f64::EPSILON * n * effort.powi(2).max(f64::MIN_POSITIVE);
    let value = if is_constant { 0.0 } else { ce / (cc * ee).sqrt() };
    let correlation = Figure { value, sd: (1.0 - value * value) / n.sqrt() };
    let [against, brakes] = braking(&pairs);
    let is_unsigned = brakes >= LEAST_BRAKES && 2 * against > brakes;
    // With the sign turned, the train powers with efforts below zero as well.
    let is_turned = value < -LEAST_CORRELATION && powers_below_zero(&pairs);
    let evidence = if is_constant {
        format!("the effort is {effort:.3} N/kg throughout")
    } else if is_unsigned && !is_turned {
        format!("above zero in {against} of {brakes} windows of a braking train: a brake without its sign?")
    } else if value < -LEAST_CORRELATION {
        "they go against each other".to_owned()
    } else {
        format!("{} windows of {WINDOW_S:.0} s", pairs.len())
    };
    let is_apart = value + HALF_95 * correlation.sd < LEAST_CORRELATION;
    (is_apart || is_unsigned).then_some(Apart { correlation, windows: pairs.len(), evidence })
}

/// Of one run: the windows of a braking train in which the effort is far above zero, and all windows of one; none of
/// too few, or where the sign of all efforts is turned.
pub(crate) fn brakes(rows: &[Sample]) -> Option<[usize; 2]> {
    let windows: Vec<(f64, f64)> = stretches(rows, BRAKE_WINDOW_S).into_iter().filter_map(window).collect();
    let [against, all] = braking(&windows);
    (all >= LEAST_OWN_BRAKES && !powers_below_zero(&windows)).then_some([against, all])
}

/// Windows of a braking train in which the effort is far above zero, and all of a braking one.
fn braking(windows: &[(f64, f64)]) -> [usize; 2] {
    let brakes = windows.iter().filter(|(change, _)| *change < -BRAKES_MPS2);
    let against = brakes.clone().filter(|(change, effort)| *effort > -FOLLOWS * change).count();
    [against, brakes.count()]
}

/// Where the train powers the efforts are below zero, in sum.
fn powers_below_zero(windows: &[(f64, f64)]) -> bool {
    let powers = windows.iter().filter(|(change, _)| *change > BRAKES_MPS2);
    powers.map(|(_, effort)| effort).sum::<f64>() < 0.0
}

/// Coefficients by least squares, the inverse of the normal matrix, and the sum of the squares that they leave.
pub(crate) fn least_squares<const N: usize>(
    rows: &[(SVector<f64, N>, f64)],
) -> Option<(SVector<f64, N>, SMatrix<f64, N, N>, f64)> {
    let (mut normal, mut score) = (SMatrix::<f64, N, N>::zeros(), SVector::<f64, N>::zeros());
    for (x, y) in rows {
        normal += x * x.transpose();
        score += x * *y;
    }
    let inverse = normal.cholesky()?.inverse();
    let beta = inverse * score;
    Some((beta, inverse, rows.iter().map(|(x, y)| (y - x.dot(&beta)).powi(2)).sum()))
}

/// Acceleration, m/s^2, and mean effort, N/kg, of windows in which the train moves and each row has both.
fn windows(rows: &[Sample]) -> Vec<(f64, f64)> {
    stretches(rows, WINDOW_S).into_iter().filter_map(window).collect()
}

/// Stretches of `least_s` up to twice as much, in which each row has a speed and an effort.
pub(crate) fn stretches(rows: &[Sample], least_s: f64) -> Vec<&[Sample]> {
    let (mut found, mut begin) = (Vec::new(), 0);
    for end in 1..rows.len() {
        let complete = rows[end].speed_mps.is_some() && rows[end].effort_n_per_kg.is_some();
        let long_s = rows[end].time_s - rows[begin].time_s;
        if !complete || long_s > 2.0 * least_s {
            begin = end;
        } else if long_s >= least_s {
            found.push(&rows[begin..=end]);
            begin = end;
        }
    }
    found
}

/// The same of one window.
pub(crate) fn window(rows: &[Sample]) -> Option<(f64, f64)> {
    let (begin, end) = (rows.first()?, rows.last()?);
    let ([first, last], long_s) = ([begin.speed_mps?, end.speed_mps?], end.time_s - begin.time_s);
    let is_moving = first.max(last) > 0.0;
    let effort = mean_of(rows[1..].iter().filter_map(|row| row.effort_n_per_kg));
    is_moving.then_some(((last - first) / long_s, effort))
}
