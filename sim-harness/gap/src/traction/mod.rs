//! Limits of the traction: does the train give what its description says, everywhere and every day?
//!
//! In: intervals of steady power while the train gains speed, and ρ = effort over believed limit. A driver demands a
//! share a of the nominal effort and another of the nominal power, the same all through a run or another in each
//! powering phase; the train gives the smaller of that share and its true limit F:
//!
//! ```text
//! ρ_i = min(a, F(location, speed)) + noise        a unknown in each run, or in each powering phase, for effort and for power, even prior
//! ```
//!
//! | hypothesis | F |
//! |---|---|
//! | as believed | 1 |
//! | `traction_scale` | the factor, everywhere |
//! | `power_limit_section` | the factor, for power, inside a section |
//! | `low_adhesion` | the factor times the largest effort below a speed, in some runs |
//!
//! Compared by marginal likelihood, the shares integrated out. The rival of `low_adhesion` is a driver who moves the
//! handle within a phase, too ([`habit`]). Less power everywhere is reported, not named ([`less_power`]).

pub mod adhesion;
pub mod edges;
pub mod exceeded;
pub mod habit;
pub mod halves;
pub mod hypotheses;
pub mod less_power;
pub mod limit;
pub mod powering;
pub mod scale;
pub mod section;
pub mod shares;
