//! What speed and location of one run say of each other, once what is known already is taken off.

use crate::agreement::Agreement;
use crate::agreement::compared::{Compared, Differences};
use crate::agreement::late_rows;
use crate::agreement::parts::compared;
use crate::figure::Figure;
use crate::rows::times;
use crate::wheel;
use crate::wheel::braking::{EachBrake, without_brakes};
use crate::wheel::creep::{Creep, Falls};
use nalgebra::Vector2;
use rundown_files::sample::Sample;

/// In rows farther apart the acceleration is not known, s.
const MOST_NEAR_S: f64 = 2.5;
/// Which part of what creep makes of scale and offset stays a doubt: wheels need not creep by the same share of each
/// speed.
const CREEP_DOUBT: f64 = 0.3;

/// What speed and location of a run say.
#[derive(Clone)]
pub(crate) struct OfSpeed {
    pub(crate) agreement: Agreement,
    pub(crate) change: Option<wheel::change::Change>,
    /// By how much more the speed reads while it rises than while it falls. None: the run does not say.
    pub(crate) creep: Option<Creep>,
    /// What the brakes alone say, where rows are near.
    pub(crate) each_brake: Option<EachBrake>,
    /// What was taken off, and what is left of the second order.
    pub(crate) taken: Taken,
    pub(crate) second_order_s2: Option<Figure>,
    /// What one more of it makes of 1/s - 1 and o/s.
    by_second_order: Vector2<f64>,
}

/// What was taken off the speeds before they are compared with the locations.
#[derive(Clone, Copy, Default)]
pub(crate) struct Taken {
    /// Of the second order, s².
    pub(crate) second_order_s2: Figure,
    /// The speeds of brakes, in which the wheels slide.
    pub(crate) brakes: bool,
    /// Creep, against these speeds.
    pub(crate) creep: Option<Falls>,
}

impl OfSpeed {
    /// With this taken off.
    pub(crate) fn of(rows: &[Sample], step_s: f64, taken: Taken) -> Option<Self> {
        if step_s > times::MOST_MEAN_S {
            return None;
        }
        // Creep and brakes are seen where differences last no longer than they do.
        let near_s = times::located_step_s(rows);
        let parts = match taken.brakes {
            true => compared(&without_brakes(rows), step_s, near_s),
            false => compared(rows, step_s, near_s),
        };
        let taken_s2 = taken.second_order_s2;
        let (mut compared, moved_s) = late_rows::moved(&parts, step_s, Compared::fitted(Differences::of(&parts))?)?;
        let turns_mps2 = compared.differences.turns_mps2.clone();
        if taken_s2.value != 0.0 {
            compared = compared.without(&turns_mps2.iter().map(|turn| taken_s2.value * turn).collect::<Vec<_>>())?;
        }
        let mut by_creep = Vector2::zeros();
        let creep = taken.creep.filter(|_| near_s < MOST_NEAR_S);
        if let Some(creep_m) = creep.and_then(|falls| falls.creep_m(&compared)) {
            by_creep = compared.taken_up(&creep_m).0.xy();
            compared = compared.without(&creep_m)?;
        }
        let beside = compared.beside(&turns_mps2).filter(|_| near_s < MOST_NEAR_S);
        let correlated = compared.independent().sqrt();
        let second_order_s2 = beside.map(|(left, _)| Figure { sd: left.sd / correlated, ..left });
        let by_second_order = compared.taken_up(&turns_mps2).0.xy();
        let change = wheel::change::within(&compared);
        let with_other_bends = compared.with_other_bends();
        let creep = Creep::of(&compared, with_other_bends.as_ref());
        let shows_brakes = near_s < MOST_NEAR_S && !taken.brakes;
        let each_brake = if shows_brakes { EachBrake::of(&compared) } else { None };
        let agreement = compared.agreement(with_other_bends.as_ref()).after_moving(moved_s);
        let agreement = agreement.doubted(by_second_order * taken_s2.sd + CREEP_DOUBT * by_creep);
        Some(Self { agreement, change, creep, each_brake, taken, second_order_s2, by_second_order })
    }

    /// It is known to so much, standard deviation, in all runs alike.
    pub(crate) fn doubted(self, sd_s2: f64) -> Self {
        let agreement = self.agreement.doubted(self.by_second_order * sd_s2);
        let second_order_s2 = Figure { sd: sd_s2, ..self.taken.second_order_s2 };
        Self { agreement, taken: Taken { second_order_s2, ..self.taken }, ..self }
    }
}
