//! The paper's loop: effort calculated from the readings drives the filter that is to explain them.
//!
//! In: readings. Out: state, effort, acceleration, innovation. The order inside a step:
//!
//! 1. `u = (z_v[k] - z_v[k-1]) / Δt + r(v) + g(s)` at the state `x[k-1]` (with the backward effort: `u[k-1]`, see 4),
//! 2. predict from `x[k-1]` with it,
//! 3. update,
//! 4. `u[k]`, the same at the filtered state: what is reported, and with the backward effort drives the next step.
//!
//! Where no reading is missing kept exact, as the reference. Its true resistance cancels out: the estimate does not
//! follow it.
//!
//! Of speeds that are missing the paper says nothing. With the forward effort the first step with one again is driven
//! by all that the speed changed by meanwhile and the steps without one did not: Table 1 believes the filter's own
//! speed, so what is lost once stays lost. What is reported then is the mean since the speed before; until then the
//! effort is held. With either effort the first speed of a run that began without one drives its step as a whole.

use crate::Real;
use crate::filter::elimination::NotPositiveDefinite;
use crate::filter::gaussian::Gaussian;
use crate::filter::ukf::Spread;
use crate::filter::ukf::{Innovation, Ukf};
use crate::model::effects::Acting;
use crate::model::effort;
use crate::model::line::Line;
use crate::model::motion::Evaluate;
use crate::model::motion::Motion;
use crate::model::pieces::pieces;
use crate::model::point::Point;
use crate::model::state::{self, LOCATION, R0, SIZE, SPEED};
use crate::plain::plain;
use crate::tick::bounds::settings;
use crate::tick::learning::{LocationAndSpeed, MOST_SUB_STEPS};
use serde::{Deserialize, Serialize};

/// Over which difference of speeds the calculated effort acts (the `paper` mode).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Difference {
    /// The difference up to a sample drives the step after it. Tracks a sample late.
    Backward,
    /// The difference over a step drives that very step. Tracks as the paper's Fig. 3 does; docs/paper.md compares
    /// both.
    #[default]
    Forward,
}

plain! {
    enum Difference { Backward, Forward }
}

settings! {
    /// Table 1 and what section 4.2 says about noise: the filter of the `paper` mode.
    PaperConfig in "paper" {
        /// Sigma-point spread α, β, κ.
        spread: Spread<SIZE> = Spread::PAPER;
        /// Initial standard deviation of the location, m.
        initial_location_sd_m: Real = 1.0, 1e-6 to 1e5;
        /// Initial standard deviation of the speed, km/h.
        initial_speed_sd_kmh: Real = 0.0018, 1e-6 to 1e3;
        /// Initial standard deviations of r0, r1, r2, SI units.
        initial_davis_sd: [Real; 3] = [1e-6, 1e-8, 1e-9], 1e-15 to 1.0;
        /// Measurement noise of the location, m.
        location_sd_m: Real = 4.0, 1e-3 to 1e5;
        /// Measurement noise of the speed, km/h.
        speed_sd_kmh: Real = 1.0, 1e-3 to 1e3;
        /// Standard deviation of the acceleration noise, m/s² (Q); zero in the paper.
        acceleration_noise_mps2: Real = 0.0, 0.0 to 10.0;
        /// Form the gain from the propagated points, which leave Q out, as Eq. (12)-(15) are printed.
        reuse_points: bool = true;
        /// Difference of the calculated effort.
        difference: Difference = Difference::Forward;
        /// Where in a step Eq. (5) is evaluated.
        evaluate: Evaluate = Evaluate::Beginning;
        /// Longest sub-step, s; longer than the sampling time means the single step of Eq. (4).
        sub_step_s: Real = 1e9, 0.1 to 1e12;
    }
}

settings! {
    /// What may change during a run, as the filter of the `paper` mode sees it.
    PaperDriftConfig in "paper_drift" {
        /// Standard deviations of the changes of r0, r1, r2 in one second, SI units: their part of Q in Eq. (3). They
        /// grow with the root of the time. Zero in the paper, where the coefficients are constants.
        davis_sd: [Real; 3] = [0.0; 3], 0.0 to 1.0;
    }
}

/// State of the paper's loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperLoop {
    /// State and covariance.
    pub belief: Gaussian<SIZE>,
    /// Effort that drives the next step, N/kg.
    pub effort_n_per_kg: Real,
    /// Acceleration of the filtered speed, m/s²: mean since the speed that was read before, 0 before the first.
    pub acceleration_mps2: Real,
    reading_mps: Option<Real>,
    since_reading_s: Real,
    /// What the filtered speed changed by in steps without a reading since, m/s.
    meanwhile_mps: Real,
}

plain! {
    struct PaperLoop { belief, effort_n_per_kg, acceleration_mps2, reading_mps, since_reading_s, meanwhile_mps }
}

impl PaperLoop {
    /// Zeros.
    pub(crate) const ZEROED: Self = Self {
        belief: Gaussian::ZEROED,
        effort_n_per_kg: 0.0,
        acceleration_mps2: 0.0,
        reading_mps: None,
        since_reading_s: 0.0,
        meanwhile_mps: 0.0,
    };

    /// Begins with the first readings, Table 1's standard deviations and a belief of the Davis coefficients.
    pub fn begin(
        config: &PaperConfig,
        line: &Line<'_>,
        acting: &Acting<'_>,
        time_s: Real,
        davis: &Gaussian<3>,
        location_m: Option<Real>,
        speed_mps: Option<Real>,
    ) -> Self {
        let mut mean = [0.0; SIZE];
        mean[LOCATION] = location_m.unwrap_or(0.0);
        mean[SPEED] = speed_mps.unwrap_or(0.0);
        let mut sd = [0.0; SIZE];
        sd[LOCATION] = config.initial_location_sd_m;
        sd[SPEED] = config.initial_speed_sd_kmh / 3.6;
        let mut belief = Gaussian::independent(mean, sd);
        belief.mean.fixed_rows_mut::<3>(R0).copy_from(&davis.mean);
        belief.covariance.fixed_view_mut::<3, 3>(R0, R0).copy_from(&davis.covariance);
        let effort_n_per_kg = effort::of_paper(line, acting, &state::davis(&belief.mean), 0.0, &point(time_s, &belief));
        Self { belief, effort_n_per_kg, reading_mps: speed_mps, ..Self::ZEROED }
    }

    /// The coefficients drift for `dt_s`. Before a step, so that its points have it also where the gain is formed from
    /// them.
    pub fn drift(&mut self, config: &PaperDriftConfig, dt_s: Real) {
        for (i, sd) in config.davis_sd.iter().enumerate() {
            self.belief.covariance[(R0 + i, R0 + i)] += sd * sd * dt_s;
        }
    }

    /// One step of `dt_s` up to `time_s`, with the readings of location and speed.
    ///
    /// # Errors
    /// [`NotPositiveDefinite`]; the loop is then as it was.
    pub fn step(
        &mut self,
        config: &PaperConfig,
        line: &Line<'_>,
        acting: &Acting<'_>,
        time_s: Real,
        dt_s: Real,
        readings: [Option<Real>; 2],
    ) -> Result<Innovation<2>, NotPositiveDefinite> {
        let [_, speed_mps] = readings;
        let ukf = Ukf { spread: config.spread, gate: [None; 2], reuse_points: config.reuse_points };
        let since_reading_s = self.since_reading_s + dt_s;
        let before_mps = self.belief.mean[SPEED];
        let is_first = self.reading_mps.is_none();
        // A run that begins without a speed begins at rest.
        let change_mps = speed_mps.map(|now| now - self.reading_mps.unwrap_or(0.0));
        let effort_of = |belief: &Gaussian<SIZE>, acceleration_mps2| {
            effort::of_paper(line, acting, &state::davis(&belief.mean), acceleration_mps2, &point(time_s, belief))
        };
        let driving_n_per_kg = match change_mps {
            Some(change_mps) if is_first || config.difference == Difference::Forward => {
                effort_of(&self.belief, (change_mps - self.meanwhile_mps) / dt_s)
            }
            _ => self.effort_n_per_kg,
        };

        let mut belief = self.belief;
        let sub_steps = pieces(dt_s, config.sub_step_s, MOST_SUB_STEPS);
        let h_s = dt_s / Real::from(sub_steps);
        let motion = |belief: &Gaussian<SIZE>, step: u32| {
            let (x, evaluate) = (&belief.mean, config.evaluate);
            let begin_s = time_s - dt_s + Real::from(step) * h_s;
            Motion::new(line, x, driving_n_per_kg, h_s, evaluate)
                .with_effects(line, acting, x, begin_s, evaluate)
                .with_noise(config.acceleration_noise_mps2)
        };
        let last = sub_steps - 1;
        for step in 0..last {
            let motion = motion(&belief, step);
            ukf.predict(&mut belief, &motion)?;
        }
        let speed_sd_mps = config.speed_sd_kmh / 3.6;
        let observation = LocationAndSpeed {
            location_variance: config.location_sd_m * config.location_sd_m,
            speed_variance: speed_sd_mps * speed_sd_mps,
        };
        let last = motion(&belief, last);
        let innovation = ukf.step(&mut belief, &last, &observation, &readings)?;

        let meanwhile_mps = self.meanwhile_mps + (belief.mean[SPEED] - before_mps);
        self.belief = belief;
        self.since_reading_s = since_reading_s;
        self.meanwhile_mps = meanwhile_mps;
        // The step up to the first speed is none of the train's.
        if !is_first {
            self.acceleration_mps2 = meanwhile_mps / since_reading_s;
            if let Some(change_mps) = change_mps {
                self.effort_n_per_kg = effort_of(&belief, change_mps / since_reading_s);
            }
        }
        if speed_mps.is_some() {
            self.reading_mps = speed_mps;
            self.since_reading_s = 0.0;
            self.meanwhile_mps = 0.0;
        }
        Ok(innovation)
    }
}

fn point(time_s: Real, belief: &Gaussian<SIZE>) -> Point {
    Point { time_s, location_m: belief.mean[LOCATION], speed_mps: belief.mean[SPEED] }
}
