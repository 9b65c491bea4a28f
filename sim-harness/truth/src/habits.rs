//! What kind of driver this is today: every number of the driving style, drawn once for a run.
//!
//! The ranges follow section 4 of the paper: gentle departures, cruise speeds skewed towards 140 km/h, final coasts of
//! 2.5 to 10 min with a coefficient of variation of 30 %, brakes that build up over 2 to 3 s.

use crate::brake::BrakeHabit;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, Exp, Normal};
use serde::{Deserialize, Serialize};

/// Final coast of the case study: mean, standard deviation, least, most, s.
const COAST_S: [f64; 4] = [370.0, 110.0, 150.0, 600.0];

/// The case study's intercity has its habits on a line of at least this length, m; on shorter ones the coast is shorter
/// in proportion.
const COAST_HOP_M: f64 = 30_000.0;
/// Where trains stop beside the mark: standard deviation and most, m.
const STOP_SD_M: f64 = 0.6;
const STOP_MOST_M: f64 = 1.6;

/// What kind of service is driven.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
pub enum DriverKind {
    /// Intercity: one long run, a long final coast.
    #[default]
    #[serde(rename = "intercity")]
    CaseStudy,
    /// Stops every 4 to 6 km unless the line has its own, 80 to 100 km/h, no coast or a short one.
    #[serde(rename = "short_hops")]
    ShortHop,
    /// Metro or tram that saves energy: up to three quarters of the limit or a little more, then a coast until the
    /// brake.
    #[serde(rename = "hop_and_coast")]
    HopAndCoast,
    /// Automatic operation: an intercity by the energy-optimal sequence of regimes, all power, held speed, coast, one
    /// brake rate; every day alike.
    #[serde(rename = "ato")]
    Automatic,
}

/// Of what differs between drivers, this share differs between the days of one.
const DAY_SHARE: f64 = 0.35;
/// How automatic operation brakes, m/s², and how fast it raises the effort, N/kg per s.
const AUTOMATIC_BRAKE_MPS2: f64 = 0.5;
const AUTOMATIC_RISE_N_PER_KG_S: f64 = 0.08;

/// How the speed is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cruising {
    /// By holding it.
    Hold,
    /// By on/off cycles of power and coasting (pulse and glide).
    Cycles {
        /// The speed swings by this much to both sides, m/s.
        half_width_mps: f64,
        /// Effort of the powering phases, N/kg, below the traction curve.
        effort_n_per_kg: f64,
    },
}

/// What is done at 40 km/h, between the approach and the stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plateau {
    /// Speed held.
    Hold,
    /// Zero effort.
    Coast,
}

/// One driver in one run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Habits {
    /// Time of departure, s; also shifts the run against the sampling.
    pub departure_s: f64,
    /// Used share of the largest tractive effort.
    pub effort_share: f64,
    /// Used share of the largest power.
    pub power_share: f64,
    /// How fast effort is raised, N/kg per s.
    pub effort_rise_n_per_kg_s: f64,
    /// Speed kept in a zone of low speed, as a share of its limit.
    pub zone_share: f64,
    /// Speed to be kept on the open line, m/s: the middle of the cycles.
    pub cruise_mps: f64,
    /// How it is kept.
    pub cruising: Cruising,
    /// Wander of the speed held, m/s.
    pub wander_sd_mps: f64,
    /// Length of the final coast the driver aims at, s; 0 for none.
    pub coast_s: f64,
    /// On hops shorter than this the coast is shorter in proportion, m.
    pub coast_hop_m: f64,
    /// A coast is not let fall below this, m/s.
    pub least_coast_mps: f64,
    /// Decelerations.
    pub brake: BrakeHabit,
    /// What is done at 40 km/h.
    pub plateau: Plateau,
    /// Speed at which the brake is tried after the departure, m/s; `None` for no trial.
    pub brake_test_mps: Option<f64>,
    /// Where the train stops, relative to the platform, m.
    pub stop_error_m: f64,
}

impl Habits {
    /// The final coast aimed at on a hop of this length, s.
    pub fn coast_on_s(&self, hop_m: f64) -> f64 {
        if hop_m < self.coast_hop_m { self.coast_s * hop_m / self.coast_hop_m } else { self.coast_s }
    }

    /// Draws a driver for a line with this highest limit. `cycle_share` is the probability of cruising by cycles; short
    /// hops are too short for them.
    pub fn draw(kind: DriverKind, cycle_share: f64, top_mps: f64, rng: &mut impl Rng) -> Self {
        let unit = Normal::new(0.0, 1.0).expect("constant");
        let departure_s = rng.random_range(0.0..10.0);
        let effort_share = rng.random_range(0.75..1.0);
        let power_share = rng.random_range(0.75..1.0);
        let effort_rise_n_per_kg_s = rng.random_range(0.03..0.08);
        let zone_share = rng.random_range(0.95..1.0);
        let half_width_mps = rng.random_range(2.0..3.0) / 3.6;
        let cycle_effort_n_per_kg = rng.random_range(0.12..0.2);
        let cycles = rng.random_bool(cycle_share);
        let brake = BrakeHabit::draw(rng);
        let plateau = if rng.random_bool(0.5) { Plateau::Hold } else { Plateau::Coast };
        let stop_error_m = f64::clamp(STOP_SD_M * unit.sample(rng), -STOP_MOST_M, STOP_MOST_M);

        let below_limit = Exp::new(1.0 / 3.5).expect("constant");
        let (drawn_kmh, coast_s, least_coast_kmh): (f64, f64, f64) = match kind {
            DriverKind::CaseStudy | DriverKind::Automatic => {
                let near_kmh = 140.15 + 0.6 * unit.sample(rng);
                let [mean, sd, least, most] = COAST_S;
                let coast_s = mean + sd * unit.sample(rng);
                let cruise_kmh: f64 = near_kmh - below_limit.sample(rng);
                (cruise_kmh.clamp(125.0, 141.0), coast_s.clamp(least, most), 55.0)
            }
            DriverKind::ShortHop => {
                let cruise_kmh = rng.random_range(80.0..100.0);
                let coasts = rng.random_bool(0.5);
                let coast_s = rng.random_range(10.0..40.0);
                (cruise_kmh, if coasts { coast_s } else { 0.0 }, 45.0)
            }
            DriverKind::HopAndCoast => {
                let share = rng.random_range(0.75..0.95);
                (3.6 * share * top_mps, rng.random_range(15.0..45.0), 30.0)
            }
        };
        // Drawn for a line of 140 km/h.
        let mut cruise_mps = match kind {
            DriverKind::CaseStudy | DriverKind::Automatic => drawn_kmh / 140.0 * top_mps,
            DriverKind::ShortHop | DriverKind::HopAndCoast => (drawn_kmh / 3.6).min(top_mps),
        };
        let mut cruising = Cruising::Hold;
        if cycles && kind == DriverKind::CaseStudy {
            // The speed that is liked is the upper end of the cycles.
            cruise_mps -= half_width_mps;
            cruising = Cruising::Cycles { half_width_mps, effort_n_per_kg: cycle_effort_n_per_kg };
        }
        let drawn = Self {
            departure_s,
            effort_share,
            power_share,
            effort_rise_n_per_kg_s,
            zone_share,
            cruise_mps,
            cruising,
            wander_sd_mps: 0.12,
            coast_s,
            coast_hop_m: match kind {
                DriverKind::CaseStudy | DriverKind::Automatic => COAST_HOP_M,
                DriverKind::ShortHop | DriverKind::HopAndCoast => 0.0,
            },
            least_coast_mps: (least_coast_kmh / 3.6).min(0.45 * top_mps),
            brake,
            plateau,
            brake_test_mps: None,
            stop_error_m,
        };
        if kind == DriverKind::Automatic { drawn.automatic(top_mps) } else { drawn }
    }

    /// The same departure, driven automatically.
    fn automatic(self, top_mps: f64) -> Self {
        Self {
            effort_share: 1.0,
            power_share: 1.0,
            effort_rise_n_per_kg_s: AUTOMATIC_RISE_N_PER_KG_S,
            zone_share: 1.0,
            cruise_mps: top_mps,
            cruising: Cruising::Hold,
            wander_sd_mps: 0.0,
            coast_s: COAST_S[0],
            brake: BrakeHabit::constant(AUTOMATIC_BRAKE_MPS2),
            plateau: Plateau::Hold,
            stop_error_m: 0.0,
            ..self
        }
    }

    /// This driver on a day on which another would have driven like `day`: the style is the driver's own, `DAY_SHARE`
    /// of it the day's.
    pub fn on_day(self, day: &Self) -> Self {
        let mixed = |own: f64, day: f64| own + DAY_SHARE * (day - own);
        Self {
            departure_s: day.departure_s,
            effort_share: mixed(self.effort_share, day.effort_share),
            power_share: mixed(self.power_share, day.power_share),
            effort_rise_n_per_kg_s: mixed(self.effort_rise_n_per_kg_s, day.effort_rise_n_per_kg_s),
            zone_share: mixed(self.zone_share, day.zone_share),
            cruise_mps: mixed(self.cruise_mps, day.cruise_mps),
            coast_s: mixed(self.coast_s, day.coast_s),
            brake: self.brake.mixed(&day.brake, DAY_SHARE),
            stop_error_m: day.stop_error_m,
            ..self
        }
    }
}
