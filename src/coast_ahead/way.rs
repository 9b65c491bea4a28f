//! A coasting train over the way: v² and time, how they answer to the speed at the beginning and to r0, r1, r2, and what noise adds.
//!
//! In: where it begins, steps of the way. Out: [`Way`] at the end of each, or where the train stands.
//!
//! ```text
//! mean           E = v²      E' = E - 2 g (H' - H) - 2 h (r(v) + X)       v, X midway; H mean height under the train
//!                t' = t + h / (v + v_midway) + h / (v_midway + v')
//! sensitivities  dS/ds = f S - 2 (0, 1, v, v²)      f = -(r1 + 2 r2 v)/v      of E to E(0), r0, r1, r2
//!                dT/ds = -S / (2 v³)                                          of t to the same
//! noise          variance of E grows by 4 v² q dt
//! ```
//!
//! The sensitivities by the trapezoid rule with v midway. Named effects move the mean and add no slope, as in [`crate::effects::Acting`].

use crate::Real;
use crate::effects::Acting;
use crate::effort::Point;
use crate::motion::Line;
use crate::resistance::Davis;

/// Slower than this counts as standing: 1 m/s.
const STANDS_M2_PER_S2: Real = 1.0;

/// Number of sensitivities: of the beginning's v², r0, r1, r2.
const N: usize = 4;

/// The state at a place of the way.
pub(super) struct Way<'a> {
    line: &'a Line<'a>,
    acting: &'a Acting<'a>,
    davis: Davis,
    /// Spectral density of the acceleration beyond the model, m²/s³.
    noise: Real,
    pub(super) at: Point,
    /// v², m²/s².
    pub(super) energy: Real,
    /// Integral of the height under the train, m².
    height_m2: Real,
    /// Of the named effects at the last place where they were asked for, N/kg.
    extra_n_per_kg: Real,
    /// Of v².
    pub(super) by_energy: [Real; N],
    /// Of the time.
    pub(super) by_time: [Real; N],
    /// Variances of v² and t and their covariance by noise alone.
    pub(super) noise_energy: Real,
    noise_both: Real,
    pub(super) noise_time: Real,
}

/// The train stands before the end of the step, at this distance from its beginning, m.
pub(super) struct Stands {
    pub(super) after_m: Real,
}

impl<'a> Way<'a> {
    pub(super) fn begin(
        line: &'a Line<'a>,
        acting: &'a Acting<'a>,
        davis: Davis,
        noise: Real,
        from: Point,
    ) -> Self {
        Self {
            line,
            acting,
            davis,
            noise,
            at: from,
            energy: from.speed_mps * from.speed_mps,
            height_m2: Self::height_m2(line, from.location_m),
            extra_n_per_kg: acting.extra_n_per_kg(line, &davis, &from, 0.0),
            by_energy: [1.0, 0.0, 0.0, 0.0],
            by_time: [0.0; N],
            noise_energy: 0.0,
            noise_both: 0.0,
            noise_time: 0.0,
        }
    }

    fn height_m2(line: &Line<'_>, location_m: Real) -> Real {
        let length_m = line.train.length_m();
        line.track
            .height_integral_m2(location_m, length_m, line.direction)
    }

    /// What brakes the train here, N/kg: positive against travel.
    pub(super) fn braking_n_per_kg(&self) -> Real {
        self.davis.resistance_n_per_kg(self.at.speed_mps)
            + self.line.gradient_n_per_kg(self.at.location_m)
            + self.extra_n_per_kg
    }

    /// One step of `step_m`.
    pub(super) fn advance(&mut self, step_m: Real) -> Result<(), Stands> {
        let sign = self.line.direction.sign();
        let gravity = 2.0 * self.line.train.gravity_n_per_kg_m();
        let (begin, half_m) = (self.at, 0.5 * step_m);

        let midway_m = begin.location_m + sign * half_m;
        let rise_m2 = Self::height_m2(self.line, midway_m) - self.height_m2;
        let braking = self.davis.resistance_n_per_kg(begin.speed_mps) + self.extra_n_per_kg;
        let energy = self.energy - gravity * rise_m2 - step_m * braking;
        let midway_mps = speed(self.energy, energy, half_m)?;

        let midway = Point {
            time_s: begin.time_s + half_m / midway_mps,
            location_m: midway_m,
            speed_mps: midway_mps,
        };
        self.extra_n_per_kg = self
            .acting
            .extra_n_per_kg(self.line, &self.davis, &midway, 0.0);
        let end_m = begin.location_m + sign * step_m;
        let height_m2 = Self::height_m2(self.line, end_m);
        let braking = self.davis.resistance_n_per_kg(midway_mps) + self.extra_n_per_kg;
        let before = self.energy;
        let energy = before - gravity * (height_m2 - self.height_m2) - 2.0 * step_m * braking;
        let end_mps = speed(before, energy, step_m)?;
        // Each half at a constant deceleration: a hill may stand within the step.
        let dt_s = step_m / (begin.speed_mps + midway_mps) + step_m / (midway_mps + end_mps);

        self.answer(step_m, dt_s, midway_mps);
        self.energy = energy;
        self.height_m2 = height_m2;
        self.at = Point {
            time_s: begin.time_s + dt_s,
            location_m: end_m,
            speed_mps: end_mps,
        };
        Ok(())
    }

    /// Sensitivities and noise over a step.
    fn answer(&mut self, step_m: Real, dt_s: Real, v: Real) {
        let per_speed = 1.0 / v;
        let half = -0.5 * step_m * (self.davis.r1 + 2.0 * v * self.davis.r2) * per_speed;
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

/// The speed of a v² that has fallen from `before` over `way_m`.
fn speed(before: Real, energy: Real, way_m: Real) -> Result<Real, Stands> {
    if energy > STANDS_M2_PER_S2 {
        return Ok(libm::sqrt(energy));
    }
    // Also where it is NaN; what is made of it is not finite then.
    Err(Stands {
        after_m: way_m * (before - STANDS_M2_PER_S2) / (before - energy),
    })
}
