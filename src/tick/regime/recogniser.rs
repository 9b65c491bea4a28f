//! The default recogniser: a small causal hidden-Markov model.
//!
//! In: the change of speed since an anchor some 10 s back, and what resistance and gradient would make of it. Out: the
//! probability of each regime now, and of each regime at the last tick in the light of this one.
//!
//! The paper's rule looks at one sample and at the effort alone; below about 81 km/h r(v) is smaller than its band, so
//! holding 40 km/h reads as coasting. Here each regime foresees an acceleration,
//!
//! | regime | acceleration foreseen, m/s² |
//! |---|---|
//! | coast | -(r + g), as uncertain as r is |
//! | cruise | 0 |
//! | traction | a share of the train's largest effort - (r + g) |
//! | brake | -`brake_mps2` |
//!
//! and evidence is gathered over samples: regimes last. An interval in which the regime changes shows a mixture of the
//! two, anywhere between them. The densities are Student's t with 5 degrees of freedom: outliers do not upset them and
//! they need no exponential (which costs 3000 instructions a piece in soft float). Standstill is not guessed: it is a
//! speed reading of zero.

use super::Regime;
use crate::Real;
use crate::extremes::Extremes;
use crate::plain::plain;
use crate::tick::bounds::settings;

const COUNT: usize = Regime::ALL.len();

settings! {
    /// What the recogniser expects of drivers and trains.
    RecogniserConfig in "recogniser" {
        /// Spacing of the evidence, s. Faster logs are judged on differences over this time.
        interval_s: Real = 10.0, 1.0 to 60.0;
        /// Share of the largest effort in traction, and its spread.
        traction_share: Real = 0.8, 0.05 to 2.0;
        /// Spread of `traction_share`.
        traction_share_sd: Real = 0.3, 0.01 to 2.0;
        /// Deceleration while braking, m/s².
        brake_mps2: Real = 0.3, 0.01 to 3.0;
        /// Spread of `brake_mps2`.
        brake_sd_mps2: Real = 0.15, 0.01 to 3.0;
        /// Spread of the acceleration while cruising, m/s².
        cruise_sd_mps2: Real = 0.015, 1e-4 to 1.0;
        /// Spread of the effort while coasting, N/kg: what track and weather do beyond the model.
        coast_sd_n_per_kg: Real = 0.003, 1e-5 to 1.0;
    }
}

/// Time of [`TRANSITION`], s.
const TRANSITION_S: Real = 10.0;
/// Probability of the regime of the next ten seconds, given the regime now (rows and columns as [`Regime::ALL`]). Set
/// by hand so that accelerations and brakes last one to two minutes and cruising and coasting two to three, shorter
/// than in the case study (section 4.3); not fitted to any set of runs.
const TRANSITION: [[Real; COUNT]; COUNT] = [
    [0.80, 0.19, 0.00, 0.005, 0.005],
    [0.005, 0.885, 0.05, 0.05, 0.01],
    [0.00, 0.025, 0.925, 0.035, 0.015],
    [0.00, 0.015, 0.015, 0.935, 0.035],
    [0.06, 0.015, 0.025, 0.02, 0.88],
];

/// Evidence of one interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evidence {
    /// Length of the interval, s.
    pub interval_s: Real,
    /// Mean acceleration over it, m/s².
    pub acceleration_mps2: Real,
    /// Standard deviation of that acceleration by the readings, m/s².
    pub acceleration_sd_mps2: Real,
    /// Running resistance and gradient over it, N/kg.
    pub resistance_n_per_kg: Real,
    /// Standard deviation of that resistance, N/kg.
    pub resistance_sd_n_per_kg: Real,
    /// Largest effort of the train at this speed, N/kg.
    pub max_effort_n_per_kg: Real,
}

/// Probability of each regime, indexed by `Regime as usize`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recogniser {
    probability: [Real; COUNT],
}

plain! {
    struct Recogniser { probability }
}

impl Recogniser {
    /// Zeros; no distribution before it is begun.
    pub(crate) const ZEROED: Self = Self { probability: [0.0; 5] };
}

impl Default for Recogniser {
    /// Before the first interval nothing is known of a moving train.
    fn default() -> Self {
        Self { probability: [0.0, 0.3, 0.3, 0.2, 0.2] }
    }
}

/// Answer of one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recognised {
    /// The regimes at the end of the interval.
    pub now: Recogniser,
    /// The regimes at its beginning, in the light of the interval.
    pub before: Recogniser,
    /// Probability that the whole interval was coasted.
    pub coasted: Real,
}

impl Recogniser {
    /// The train stands.
    pub fn standing() -> Self {
        Self { probability: [1.0, 0.0, 0.0, 0.0, 0.0] }
    }

    /// The most probable regime.
    pub fn regime(&self) -> Regime {
        let mut best = (Regime::Coast, 0.0);
        for regime in Regime::ALL {
            let probability = self.of(regime);
            if probability > best.1 {
                best = (regime, probability);
            }
        }
        best.0
    }

    /// Probability of one regime.
    pub fn of(&self, regime: Regime) -> Real {
        self.probability.get(regime as usize).copied().unwrap_or(0.0)
    }

    /// One interval of a moving train. Standstill is possible at its beginning, not at its end.
    pub fn step(&self, config: &RecogniserConfig, evidence: &Evidence) -> Recognised {
        let foreseen = foreseen(config, evidence);
        let noise = evidence.acceleration_sd_mps2 * evidence.acceleration_sd_mps2;
        let share = (evidence.interval_s / TRANSITION_S).at_most(1.0);
        let mut now = [0.0; COUNT];
        let mut before = [0.0; COUNT];
        let mut coasted = 0.0;
        let regimes = self.probability.iter().zip(&mut before);
        let rows = foreseen.iter().zip(&TRANSITION).zip(regimes);
        for (i, ((from, row), (own, before))) in rows.enumerate() {
            let columns = foreseen.iter().zip(row).zip(&mut now);
            for (j, ((to, transition), now)) in columns.enumerate() {
                if j == Regime::Standstill as usize {
                    continue;
                }
                let probability = if i == j { 1.0 - share * (1.0 - transition) } else { share * transition };
                let density = Foreseen::between(from, to, i == j).density(evidence.acceleration_mps2, noise);
                let joint = own * probability * density;
                *now += joint;
                *before += joint;
                if i == j && i == Regime::Coast as usize {
                    coasted = joint;
                }
            }
        }
        let sum: Real = now.iter().sum();
        // Also taken by NaN: nothing foresaw this, so nothing is known.
        let foreseen_at_all = sum > Real::MIN_POSITIVE;
        if !foreseen_at_all {
            let unknown = Self::default();
            return Recognised { now: unknown, before: *self, coasted: 0.0 };
        }
        Recognised {
            now: Self { probability: now.map(|p| p / sum) },
            before: Self { probability: before.map(|p| p / sum) },
            coasted: coasted / sum,
        }
    }
}

/// Acceleration that a regime foresees.
#[derive(Clone, Copy, Debug)]
struct Foreseen {
    mean: Real,
    variance: Real,
    /// Beyond the mean on this side (+1, -1) everything is as likely as the mean: strong traction, hard braking.
    open: Real,
}

fn foreseen(config: &RecogniserConfig, evidence: &Evidence) -> [Foreseen; COUNT] {
    let resistance = evidence.resistance_n_per_kg;
    let square = |x: Real| x * x;
    let of_resistance = square(evidence.resistance_sd_n_per_kg);
    let standstill = Foreseen { mean: 0.0, variance: 1e-4, open: 0.0 };
    let traction = Foreseen {
        mean: config.traction_share * evidence.max_effort_n_per_kg - resistance,
        variance: square(config.traction_share_sd * evidence.max_effort_n_per_kg),
        open: 1.0,
    };
    let cruise = Foreseen { mean: 0.0, variance: square(config.cruise_sd_mps2), open: 0.0 };
    let coast = Foreseen { mean: -resistance, variance: of_resistance + square(config.coast_sd_n_per_kg), open: 0.0 };
    let brake = Foreseen { mean: -config.brake_mps2, variance: square(config.brake_sd_mps2), open: -1.0 };
    [standstill, traction, cruise, coast, brake]
}

impl Foreseen {
    /// What is foreseen of an interval that begins in one regime and ends in another: the change may lie anywhere in
    /// it.
    fn between(from: &Self, to: &Self, same: bool) -> Self {
        if same {
            return *to;
        }
        let apart = to.mean - from.mean;
        Self {
            mean: 0.5 * (from.mean + to.mean),
            variance: 0.3 * (from.variance + to.variance) + apart * apart / 12.0,
            open: 0.0,
        }
    }

    /// Density of Student's t with 5 degrees of freedom, up to a constant.
    fn density(&self, acceleration_mps2: Real, noise: Real) -> Real {
        let apart = acceleration_mps2 - self.mean;
        let apart = if apart * self.open > 0.0 { 0.0 } else { apart };
        let variance = self.variance + noise;
        let tail = 1.0 / (1.0 + apart * apart / (5.0 * variance));
        tail * tail * tail / crate::roots::square_root(variance)
    }
}
