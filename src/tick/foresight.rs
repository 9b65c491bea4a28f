//! How well coasts were foreseen before they taught.
//!
//! In: while a segment runs, each reading of the speed (each edge, where those teach) beside what was foreseen of it,
//! by what was learned before the segment and by the description. Out: each segment as one [`Coast`], those of a run as
//! a [`Foresight`], and over runs the [`Trust`] in what was learned.
//!
//! Read speed less foreseen speed is y(t), and what the description foresees of it differs from that by w(t). A
//! straight line through each,
//!
//! ```text
//! y(t) = b + e t        w(t) = c + d t        e, e + d: acceleration that was not foreseen, m/s², by the learned and the described resistance
//! ```
//!
//! says what a coast contradicts, whatever the speed it began with. What the reading of the speed, gusts, the doubt of
//! the track and that of the resistance itself add to e is known, so e has an expected variance. If the coasts scatter
//! more than that, something is not in the model, and a run says less than its filter believes: its information is
//! divided by [`Trust::inflation`]. What is not in the model may be to one side, as a brake in half of the coasts is,
//! and no number of coasts averages that away: the reported resistance is doubted by it, see [`Trust::widen`].

use crate::Real;
use crate::extremes::Extremes;
use crate::filter::gaussian::Gaussian;
use crate::model::resistance::Davis;
use crate::model::state::resistance_sd;
use crate::plain::plain;
use serde::{Deserialize, Serialize};

/// Coasts that are taken to have been as expected before the first one: one that is not does not decide.
const EXPECTED_COASTS: Real = 5.0;
/// With fewer coasts nothing is said against the learned resistance.
const FEWEST_COASTS: Real = 5.0;
/// Coasts that scatter by no more than so many times what is expected are ordinary: wind and rounding are known
/// roughly.
pub const ORDINARY_SCATTER: Real = 1.5;
/// Weight of older coasts when a run is added: a fault that is mended is forgotten after some tens of runs.
const REMEMBERED: Real = 0.97;

/// One segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coast {
    /// How long it lasted, s.
    pub duration_s: Real,
    /// Acceleration that the learned resistance did not foresee, m/s².
    pub error_mps2: Real,
    /// Additional error of the described resistance, m/s².
    pub apart_mps2: Real,
    /// Variance of the error by readings and gusts, (m/s²)².
    pub noise_variance: Real,
    /// Variance by the doubt of the track.
    pub track_variance: Real,
    /// Variance by that of the learned resistance.
    pub resistance_variance: Real,
}

/// How far what was learned may be trusted, by how it foresaw coasts. Kept with the vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trust {
    /// Number of coasts.
    pub coasts: Real,
    /// Sum of the squared errors over their expected variances.
    pub squares: Real,
    /// Sum of squared errors, learned less described, over their expected variances.
    pub worse: Real,
    /// Sum of the squared difference between what the two foresee, over the same variances.
    pub apart: Real,
}

plain! {
    struct Trust { coasts, squares, worse, apart }
}

impl Trust {
    /// Of no coast.
    pub const NONE: Self = Self { coasts: 0.0, squares: 0.0, worse: 0.0, apart: 0.0 };

    /// Adds the coasts of a run to those of the runs before.
    pub fn add(&mut self, run: &Self) {
        // In single precision, as it is stored: a board that was restarted goes on with the same bits.
        let sum = |before: Real, run: Real| Real::from((REMEMBERED * before + run) as f32);
        *self = Self {
            coasts: sum(self.coasts, run.coasts),
            squares: sum(self.squares, run.squares),
            worse: sum(self.worse, run.worse),
            apart: sum(self.apart, run.apart),
        };
    }

    /// Scatter of the errors over what is expected, of variances, at least 1.
    pub fn inflation(&self) -> Real {
        self.scatter(self.squares)
    }

    /// Gives the learned resistance the doubt that belongs to it. In its place: the stack has no room for another one.
    #[inline(never)]
    pub fn widen(&self, found: &mut Gaussian<3>) {
        found.covariance *= self.doubt();
    }

    /// Variance of the learned resistance over that of the filters; above 1 where coasts scatter by more than wind and
    /// rounding do.
    ///
    /// Of n coasts with an expected variance s each, which scatter by [`inflation`](Self::inflation) I, the filters
    /// make the variance I s / n. If half of them have an extra force, their mean is off by as much as a single one
    /// scatters beyond what is ordinary, O: by the variance (I - O) s = n (I - O) / I of that of the filters.
    pub fn doubt(&self) -> Real {
        let inflation = self.inflation();
        1.0 + self.coasts * (inflation - ORDINARY_SCATTER * ORDINARY_SCATTER).at_least(0.0) / inflation
    }

    /// Share that one coast has in what all of them say, the more the more they scatter.
    pub(crate) fn of_one(&self) -> Real {
        self.scatter(self.squares) / (EXPECTED_COASTS + self.coasts)
    }

    fn scatter(&self, squares: Real) -> Real {
        ((EXPECTED_COASTS + squares) / (EXPECTED_COASTS + self.coasts)).at_least(1.0)
    }

    /// By how many standard deviations the described resistance foresees the coasts better than the learned one; 0 with
    /// few coasts.
    ///
    /// Were both equally good, [`worse`](Self::worse) would be around zero with a standard deviation of 2
    /// √[`apart`](Self::apart), if coasts scatter as expected around the better of the two; more if they scatter more.
    pub fn worse_by(&self) -> Real {
        let square = 4.0 * self.apart * self.scatter(self.squares - self.worse);
        if self.coasts >= FEWEST_COASTS && square > 0.0 { self.worse / crate::roots::square_root(square) } else { 0.0 }
    }

    /// Numbers that sums over coasts can be.
    pub(crate) fn is_sound(&self) -> bool {
        let squares = [self.coasts, self.squares, self.apart];
        self.worse.is_finite() && squares.iter().all(|sum| (0.0..Real::MAX).contains(sum))
    }
}

/// How the coasts of a run were foreseen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foresight {
    /// What they say about trust.
    pub trust: Trust,
    /// Sum of the squared errors of the learned resistance in speed at the end of a coast, (m/s)².
    pub learned_mps: Real,
    /// The same of the described one.
    pub described_mps: Real,
    /// Sum of the shares of the known variance that the doubt of the track has.
    pub track_share: Real,
}

plain! {
    struct Foresight { trust, learned_mps, described_mps, track_share }
}

impl Foresight {
    /// Of no coast.
    pub const NONE: Self = Self { trust: Trust::NONE, learned_mps: 0.0, described_mps: 0.0, track_share: 0.0 };

    /// With one more coast.
    pub fn with(&self, coast: &Coast) -> Self {
        let square = |x: Real| x * x;
        let known = coast.noise_variance + coast.track_variance;
        let expected = known + coast.resistance_variance;
        let described_mps2 = coast.error_mps2 + coast.apart_mps2;
        let trust = &self.trust;
        Self {
            trust: Trust {
                coasts: trust.coasts + 1.0,
                squares: trust.squares + square(coast.error_mps2) / expected,
                worse: trust.worse + (square(coast.error_mps2) - square(described_mps2)) / expected,
                apart: trust.apart + square(coast.apart_mps2) / expected,
            },
            learned_mps: self.learned_mps + square(coast.error_mps2 * coast.duration_s),
            described_mps: self.described_mps + square(described_mps2 * coast.duration_s),
            track_share: self.track_share + coast.track_variance / known,
        }
    }

    /// Mean share of the track's doubt in the known variance.
    pub fn track_share(&self) -> Real {
        if self.trust.coasts > 0.0 { self.track_share / self.trust.coasts } else { 0.0 }
    }
}

/// What a tick of a segment says about its course.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leg {
    pub(crate) time_s: Real,
    pub(crate) dt_s: Real,
    /// Speed midway, m/s.
    pub(crate) midway_mps: Real,
    /// Change of the speed that was foreseen with `believed`, m/s.
    pub(crate) foreseen_mps: Real,
    pub(crate) believed: Davis,
    pub(crate) described: Davis,
    pub(crate) speed_mps: Option<Real>,
    /// Variance of a reading, (m/s)².
    pub(crate) speed_variance: Real,
    /// Spectral density of the acceleration by gusts, m²/s³.
    pub(crate) gusts: Real,
    /// The same by the doubt of the track.
    pub(crate) track: Real,
}

/// The straight lines through the speeds of a segment, as sums over its readings up to some moment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lines {
    /// Time since the segment began, s.
    duration_s: Real,
    readings: Real,
    /// Sums of t, t², y, t y, w, t w.
    t: Real,
    tt: Real,
    y: Real,
    ty: Real,
    w: Real,
    tw: Real,
    /// Integral of the track's density over time, m²/s².
    track: Real,
}

plain! {
    struct Lines { duration_s, readings, t, tt, y, ty, w, tw, track }
}

/// What is followed of a segment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Course {
    begin_s: Real,
    /// What was believed when it began.
    before: Gaussian<3>,
    /// Change of the speed since, foreseen by that, m/s.
    foreseen_mps: Real,
    /// Change foreseen by the description less that foreseen by what was learned, m/s, with the sign of resistance.
    apart_mps: Real,
    lines: Lines,
    /// Of the last tick.
    midway_mps: Real,
    speed_variance: Real,
    gusts: Real,
}

plain! {
    struct Course { begin_s, before, foreseen_mps, apart_mps, lines, midway_mps, speed_variance, gusts }
}

impl Lines {
    pub(crate) const ZEROED: Self =
        Self { duration_s: 0.0, readings: 0.0, t: 0.0, tt: 0.0, y: 0.0, ty: 0.0, w: 0.0, tw: 0.0, track: 0.0 };
}

impl Course {
    pub(crate) const ZEROED: Self = Self {
        begin_s: 0.0,
        before: Gaussian::ZEROED,
        foreseen_mps: 0.0,
        apart_mps: 0.0,
        lines: Lines { duration_s: 0.0, readings: 0.0, t: 0.0, tt: 0.0, y: 0.0, ty: 0.0, w: 0.0, tw: 0.0, track: 0.0 },
        midway_mps: 0.0,
        speed_variance: 0.0,
        gusts: 0.0,
    };

    pub(crate) fn begin(&mut self, time_s: Real, before: &Gaussian<3>) {
        *self = Self::ZEROED;
        self.begin_s = time_s;
        self.before = *before;
    }

    /// What was believed when it began.
    pub(crate) fn before(&self) -> &Gaussian<3> {
        &self.before
    }

    /// Up to here.
    pub(crate) fn lines(&self) -> Lines {
        self.lines
    }

    /// Adds a tick.
    #[inline(never)]
    pub(crate) fn add(&mut self, leg: &Leg) {
        let [r0, r1, r2] = self.before.mean.into();
        let r_before = Davis { r0, r1, r2 }.resistance_n_per_kg(leg.midway_mps);
        let more = leg.believed.resistance_n_per_kg(leg.midway_mps) - r_before;
        self.foreseen_mps += leg.foreseen_mps + more * leg.dt_s;
        self.apart_mps += (leg.described.resistance_n_per_kg(leg.midway_mps) - r_before) * leg.dt_s;
        self.midway_mps = leg.midway_mps;
        self.gusts = leg.gusts;
        let lines = &mut self.lines;
        let t = leg.time_s - self.begin_s;
        lines.duration_s = t;
        lines.track += leg.track * leg.dt_s;
        if let Some(speed_mps) = leg.speed_mps {
            self.speed_variance = leg.speed_variance;
            let (y, w) = (speed_mps - self.foreseen_mps, self.apart_mps);
            lines.readings += 1.0;
            lines.t += t;
            lines.tt += t * t;
            lines.y += y;
            lines.ty += t * y;
            lines.w += w;
            lines.tw += t * w;
        }
    }

    /// The segment up to a moment, if lines can be drawn.
    #[inline(never)]
    pub(crate) fn coast(&self, lines: &Lines) -> Option<Coast> {
        let n = lines.readings;
        let spread = lines.tt - lines.t * lines.t / n;
        let drawn = n >= 2.0 && spread > 0.0;
        drawn.then(|| {
            let slope = |sum: Real, with_t: Real| (with_t - lines.t * sum / n) / spread;
            // The slope of a line through a random walk has 6/5 of the variance of its mean step.
            let walk = 1.2 / lines.duration_s;
            let resistance_sd = resistance_sd(&self.before, self.midway_mps);
            Coast {
                duration_s: lines.duration_s,
                error_mps2: slope(lines.y, lines.ty),
                apart_mps2: slope(lines.w, lines.tw),
                noise_variance: self.speed_variance / spread + walk * self.gusts,
                track_variance: walk * lines.track / lines.duration_s,
                resistance_variance: resistance_sd * resistance_sd,
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DESCRIBED: Davis = Davis { r0: 7.38e-3, r1: 1.6e-4, r2: 2.8e-5 };

    /// A coast of 100 s on the level whose true resistance is the described one plus so much, followed with another
    /// belief.
    fn coast(true_more: Real, believed_more: Real) -> Coast {
        let before =
            Gaussian::independent([DESCRIBED.r0 + believed_more, DESCRIBED.r1, DESCRIBED.r2], [1e-4, 0.0, 0.0]);
        let mut course = Course::ZEROED;
        course.begin(0.0, &before);
        let mut speed_mps = 30.0;
        for tick in 1..=100 {
            let began_mps = speed_mps;
            speed_mps -= DESCRIBED.resistance_n_per_kg(speed_mps) + true_more;
            let midway_mps = 0.5 * (began_mps + speed_mps);
            // The filter has learned something else meanwhile; what was believed before counts.
            let believed = Davis { r0: DESCRIBED.r0 + 0.5 * believed_more, ..DESCRIBED };
            course.add(&Leg {
                time_s: Real::from(tick),
                dt_s: 1.0,
                midway_mps,
                foreseen_mps: -believed.resistance_n_per_kg(midway_mps),
                believed,
                described: DESCRIBED,
                speed_mps: Some(speed_mps),
                speed_variance: 1e-3,
                gusts: 2.5e-6,
                track: 0.0,
            });
        }
        course.coast(&course.lines()).unwrap()
    }

    #[test]
    fn a_coast_says_what_neither_resistance_foresaw() {
        let coast = coast(2e-3, 5e-3);
        // The train slowed by 2e-3 more than described, and by 3e-3 less than believed.
        assert!((coast.error_mps2 - 3e-3).abs() < 5e-5, "{coast:?}");
        assert!((coast.error_mps2 + coast.apart_mps2 + 2e-3).abs() < 5e-5, "{coast:?}");
        assert_eq!(coast.duration_s, 100.0);
        assert!((coast.resistance_variance - 1e-8).abs() < 1e-12);
    }

    #[test]
    fn who_foresees_worse_is_found_and_as_good_is_not_accused() {
        let trust_of = |true_more, believed_more| {
            let mut trust = Trust::NONE;
            for _ in 0..10 {
                trust.add(&Foresight::NONE.with(&coast(true_more, believed_more)).trust);
            }
            trust
        };
        assert!(trust_of(0.0, 4e-3).worse_by() > 2.0);
        assert!(trust_of(4e-3, 4e-3).worse_by() < 0.0);
        // Both are off by the same.
        assert!(trust_of(2e-3, 4e-3).worse_by().abs() < 0.5);
        assert_eq!(trust_of(0.0, 0.0).worse_by(), 0.0);
        assert!(trust_of(0.0, 4e-3).inflation() > 5.0);
        assert_eq!(trust_of(4e-3, 4e-3).inflation(), 1.0);
    }
}
