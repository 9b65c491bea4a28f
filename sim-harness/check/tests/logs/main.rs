//! Logs with known defects: is each found and put right, and is no clean log accused?

mod chainages;
mod clock_set;
mod computed;
mod creep;
mod drifting;
mod effort_age;
mod effort_demanded;
mod effort_small;
mod effort_zero;
mod held_speeds;
mod late_rows;
mod limits;
mod perturbed;
mod readings;
mod recorders;
mod same_rows;
mod sensors;
mod simulated;
mod single_runs;
mod slips;
mod smoothed;
mod stuck_speeds;
mod trailing;
mod wheel_changes;
mod written;
