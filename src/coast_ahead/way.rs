//! A coasting train over a distance: v² and time, how they answer to the speed at the beginning and to r0, r1, r2, and
//! what noise adds.
//!
//! In: where it begins, steps of distance. Out: [`Way`] at the end of each, or where the train stands.
//!
//! ```text
//! mean           E = v²      E' = E - 2 g (H' - H) - 2 h (r(v) + X)       v, X midway; H mean height under the train
//!                t' = t + h / (v + v_midway) + h / (v_midway + v')
//! sensitivities  dS/ds = f S - 2 (0, 1, v, v²)      f = -(r1 + 2 r2 v)/v      of E to E(0), r0, r1, r2
//!                dT/ds = -S / (2 v³)                                          of t to the same
//! noise          variance of E grows by 4 v² q dt
//! ```
//!
//! The sensitivities by the trapezoid rule with v midway. Named effects move the mean and add no slope, as in
//! [`crate::model::effects::Acting`].
//!
//! Single precision but for locations and heights: the board's processor has it, double precision costs it five times
//! the instructions. An error of 1e-7 of v² is nothing beside what is not known of it, and no result of the estimator
//! depends on it.

use crate::Real;
use crate::model::effects::Acting;
use crate::model::line::Line;
use crate::model::point::Point;
use crate::model::resistance::Davis;

/// Slower than this counts as standing: 1 m/s.
const STANDS_M2_PER_S2: f32 = 1.0;

/// Number of sensitivities: of the beginning's v², r0, r1, r2.
const N: usize = 4;

/// The state at a place on the way.
pub(super) struct Way<'a> {
    line: &'a Line<'a>,
    acting: &'a Acting<'a>,
    davis: &'a Davis,
    /// The same in single precision.
    r: [f32; 3],
    /// Twice gravity over the length of the train, N/(kg m).
    gravity: f32,
    /// Spectral density of the acceleration beyond the model, m²/s³.
    noise: f32,
    begin_s: Real,
    pub(super) location_m: Real,
    pub(super) speed_mps: f32,
    /// Since the beginning, s.
    pub(super) time_s: f32,
    /// v², m²/s².
    pub(super) energy: f32,
    /// Integral of the height under the train, m².
    height_m2: Real,
    /// Of the named effects at the last place where they were evaluated, N/kg.
    extra_n_per_kg: f32,
    /// Of v².
    pub(super) by_energy: [f32; N],
    /// Of the time.
    pub(super) by_time: [f32; N],
    /// Variances of v² and t and their covariance by noise alone.
    pub(super) noise_energy: f32,
    noise_both: f32,
    pub(super) noise_time: f32,
}

/// The train stands before the end of the step, at this distance from its beginning, m.
pub(super) struct Stands {
    pub(super) after_m: f32,
}

impl<'a> Way<'a> {
    pub(super) fn begin(
        line: &'a Line<'a>,
        acting: &'a Acting<'a>,
        davis: &'a Davis,
        noise: Real,
        from: &Point,
    ) -> Self {
        let speed_mps = from.speed_mps as f32;
        let extra_n_per_kg = acting.extra_n_per_kg(line, davis, from, 0.0);
        Self {
            line,
            acting,
            davis,
            r: [davis.r0 as f32, davis.r1 as f32, davis.r2 as f32],
            gravity: 2.0 * line.train.gravity_n_per_kg_m() as f32,
            noise: noise as f32,
            begin_s: from.time_s,
            location_m: from.location_m,
            speed_mps,
            time_s: 0.0,
            energy: speed_mps * speed_mps,
            height_m2: height_m2(line, from.location_m),
            extra_n_per_kg: extra_n_per_kg as f32,
            by_energy: [1.0, 0.0, 0.0, 0.0],
            by_time: [0.0; N],
            noise_energy: 0.0,
            noise_both: 0.0,
            noise_time: 0.0,
        }
    }

    /// Running resistance with the named effects, N/kg.
    fn resistance_n_per_kg(&self, v: f32) -> f32 {
        let [r0, r1, r2] = self.r;
        r0 + v * (r1 + v * r2) + self.extra_n_per_kg
    }

    /// What brakes the train here, N/kg: positive against travel.
    pub(super) fn braking_n_per_kg(&self) -> f32 {
        let gradient = self.line.gradient_n_per_kg(self.location_m) as f32;
        self.resistance_n_per_kg(self.speed_mps) + gradient
    }

    /// One step of `step_m`.
    pub(super) fn advance(&mut self, step_m: Real) -> Result<(), Stands> {
        let way_m = self.line.direction.sign() * step_m;
        let step_m = step_m as f32;
        let before = self.energy;

        let midway_m = self.location_m + 0.5 * way_m;
        let rise_m2 = (height_m2(self.line, midway_m) - self.height_m2) as f32;
        let braking = self.resistance_n_per_kg(self.speed_mps);
        let energy = before - self.gravity * rise_m2 - step_m * braking;
        let midway_mps = speed(before, energy, 0.5 * step_m)?;

        if !self.acting.is_empty() {
            let midway = Point {
                time_s: self.begin_s + Real::from(self.time_s + 0.5 * step_m / midway_mps),
                location_m: midway_m,
                speed_mps: Real::from(midway_mps),
            };
            let extra = self.acting.extra_n_per_kg(self.line, self.davis, &midway, 0.0);
            self.extra_n_per_kg = extra as f32;
        }
        let end_m = self.location_m + way_m;
        let end_m2 = height_m2(self.line, end_m);
        let rise_m2 = (end_m2 - self.height_m2) as f32;
        let braking = self.resistance_n_per_kg(midway_mps);
        let energy = before - self.gravity * rise_m2 - 2.0 * step_m * braking;
        let end_mps = speed(before, energy, step_m)?;
        // Each half at a constant deceleration: a hill may stand within the step.
        let dt_s = step_m / (self.speed_mps + midway_mps) + step_m / (midway_mps + end_mps);

        self.answer(step_m, dt_s, midway_mps);
        self.energy = energy;
        self.height_m2 = end_m2;
        self.location_m = end_m;
        self.speed_mps = end_mps;
        self.time_s += dt_s;
        Ok(())
    }

    /// Sensitivities and noise over a step.
    fn answer(&mut self, step_m: f32, dt_s: f32, v: f32) {
        let [_, r1, r2] = self.r;
        let per_speed = 1.0 / v;
        let half = -0.5 * step_m * (r1 + 2.0 * v * r2) * per_speed;
        let share = 1.0 / (1.0 - half);
        let keep = (1.0 + half) * share;
        let push = -2.0 * step_m * share;
        let slower = -0.25 * step_m * per_speed * per_speed * per_speed;
        let drives = [0.0, 1.0, v, v * v];
        let both = self.by_energy.iter_mut().zip(&mut self.by_time);
        for ((by_energy, by_time), drive) in both.zip(drives) {
            let next = keep * *by_energy + push * drive;
            *by_time += slower * (*by_energy + next);
            *by_energy = next;
        }
        // t' = t + a E + b w, E' = keep E + w with the noise w of the step.
        let fresh = 4.0 * v * v * self.noise * dt_s;
        let (a, b) = (slower * (1.0 + keep), slower);
        self.noise_time += a * (2.0 * self.noise_both + a * self.noise_energy) + b * b * fresh;
        self.noise_both = keep * (self.noise_both + a * self.noise_energy) + b * fresh;
        self.noise_energy = keep * keep * self.noise_energy + fresh;
    }
}

#[inline]
fn height_m2(line: &Line<'_>, location_m: Real) -> Real {
    let length_m = line.train.length_m();
    line.track.height_integral_m2(location_m, length_m, line.direction)
}

/// The speed of a v² that has fallen from `before` over `way_m`.
#[inline]
fn speed(before: f32, energy: f32, way_m: f32) -> Result<f32, Stands> {
    if energy > STANDS_M2_PER_S2 {
        return Ok(crate::roots::square_root(energy.into()) as f32);
    }
    // Also where it is NaN; what is made of it is not finite then.
    Err(Stands { after_m: way_m * (before - STANDS_M2_PER_S2) / (before - energy) })
}
