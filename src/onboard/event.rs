//! What an engineer at the board wants to read as it happens: starts, refusals, what was kept, what a run taught.
//!
//! In: the task notes events. Out: the firmware writes them to the debugger (defmt), the host prints the same ones.
//! They decide nothing, and where nobody reads them they cost their bytes in a ring: the frames say the same to the
//! other side of the link.

use crate::Real;
use crate::filter::gaussian::Gaussian;
use crate::model::resistance::Davis;
use crate::model::state::resistance_sd;
use crate::model::units::KmPerHour;
use crate::onboard::crash_loop::Operation;
use crate::onboard::kept::Boot;
use core::fmt;
use rundown_wire::{Failure, Memory, Refusal, ResetCause};

/// What happened.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Event {
    /// The board started.
    Boot {
        /// Why.
        cause: ResetCause,
        /// What the firmware wrote down before: a panic, a fault, a task that did not advance until the watchdog bit.
        failure: Failure,
        /// Crashes since power-on.
        resets: u32,
        /// Frequency of the processor, Hz.
        clock_hz: u32,
        /// It has started too often in a short time, and only says how it is.
        heartbeat_only: bool,
    },
    /// A request was refused, and answered so.
    Refused(Refusal),
    /// The train was described: what was found of it in the flash.
    Vehicle(Memory),
    /// A run begins.
    RunBegins,
    /// A run ended; what is known of the vehicle now.
    Learned {
        /// How long the run taught, s.
        learned_s: f32,
        /// Running resistance of the vehicle at 100 km/h, N/kg.
        r_n_per_kg: f32,
        /// Its standard deviation.
        sd_n_per_kg: f32,
    },
    /// A record was written to the flash; how many since the start.
    Kept(u32),
    /// A record could not be written: what is learned from now on ends with the power.
    NotKept,
    /// The crystal that trims the clock does not run.
    CrystalMissed,
}

/// Speed of the resistance that an event says, km/h.
const SAID_KMH: Real = 100.0;

/// Events of one call that wait to be written; more are dropped, for the frames have them too.
pub const WAITING: usize = 4;

impl Event {
    /// A start.
    pub fn boot(boot: &Boot, clock_hz: u32) -> Self {
        let heartbeat_only = boot.operation == Operation::HeartbeatOnly;
        let &Boot { cause, failure, resets, .. } = boot;
        Self::Boot { cause, failure, resets, clock_hz, heartbeat_only }
    }

    /// What a run has taught, `learned_s` long, to a vehicle.
    pub fn learned(learned_s: Real, vehicle: &Gaussian<3>) -> Self {
        let speed_mps = KmPerHour(SAID_KMH).to_mps();
        let [r0, r1, r2] = vehicle.mean.into();
        Self::Learned {
            learned_s: learned_s as f32,
            r_n_per_kg: Davis { r0, r1, r2 }.resistance_n_per_kg(speed_mps) as f32,
            sd_n_per_kg: resistance_sd(vehicle, speed_mps) as f32,
        }
    }

    /// Somebody should look.
    pub fn is_trouble(&self) -> bool {
        match self {
            Self::Boot { cause, failure, heartbeat_only, .. } => cause.is_crash(failure) || *heartbeat_only,
            Self::Vehicle(memory) => !matches!(memory, Memory::Empty | Memory::Restored),
            Self::Refused(_) | Self::NotKept | Self::CrystalMissed => true,
            Self::RunBegins | Self::Learned { .. } | Self::Kept(_) => false,
        }
    }
}

impl fmt::Display for Event {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Boot { cause, failure, resets, clock_hz, heartbeat_only } => {
                write!(f, "boot: {}, {resets} crashes since power-on, clock {clock_hz} Hz", cause.as_str())?;
                if *failure != Failure::None {
                    write!(f, ", before it {failure:?}")?;
                }
                if *heartbeat_only { f.write_str("; too many crashes, heartbeat only") } else { Ok(()) }
            }
            Self::Refused(refusal) => write!(f, "refused: {}", refusal.as_str()),
            Self::Vehicle(memory) => write!(f, "vehicle from the flash: {memory:?}"),
            Self::RunBegins => f.write_str("a run begins"),
            Self::Learned { learned_s, r_n_per_kg, sd_n_per_kg } => write!(
                f,
                "a run ended, {learned_s:.0} s taught; r({SAID_KMH} km/h) {r_n_per_kg:.5} N/kg, s.d. {sd_n_per_kg:.5}"
            ),
            Self::Kept(records) => write!(f, "record {records} since the start written to the flash"),
            Self::NotKept => f.write_str("the flash took no record: what is learned ends with the power"),
            Self::CrystalMissed => {
                f.write_str("the 32 kHz crystal does not run: the clock is not trimmed, and bytes may be lost")
            }
        }
    }
}
