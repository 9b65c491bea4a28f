//! `<run>.estimates.csv`: one row a tick.
//!
//! | columns | what |
//! |---|---|
//! | `time_s` | time of the measurement |
//! | `location_m`, `speed_mps`, `r0`, `r1`, `r2`, `sd_*` | the estimate and its standard deviations |
//! | `P_00` .. `P_44` | covariance of (location, speed, r0, r1, r2), upper triangle |
//! | `effort_n_per_kg`, `acceleration_mps2` | means since the tick before |
//! | `regime` | as known at this tick |
//! | `learning` | 1 when the resistance was learned from this measurement |
//! | `innovation_*`, `S_ss`, `S_sv`, `S_vv` | measured minus expected, and its covariance |
//! | `validity`, `cause` | how far location and speed may be trusted, and why not |
//! | `regime_confirmed` | the regime of this row's sample as known one sample later; the last row keeps its causal one |

use rundown::model::state::{LOCATION, R0, R1, R2, SIZE, SPEED};
use rundown::{filter::ukf::Reading, tick::estimate::Estimate, tick::regime::Regime};
use rundown_files::{replay::ReplayedRun, table::digits_17};
use std::io::{self, Write};

pub fn file_name(run: &ReplayedRun) -> String {
    format!("{}.estimates.csv", run.name)
}

pub fn columns() -> Vec<String> {
    let fixed = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
    let mut columns = fixed(&["time_s", "location_m", "speed_mps", "r0", "r1", "r2"]);
    columns.extend(fixed(&["sd_location_m", "sd_speed_mps", "sd_r0", "sd_r1", "sd_r2"]));
    columns.extend(upper_triangle().map(|(row, column)| format!("P_{row}{column}")));
    columns.extend(fixed(&["effort_n_per_kg", "acceleration_mps2", "regime", "learning"]));
    columns.extend(fixed(&["innovation_location_m", "innovation_speed_mps", "S_ss", "S_sv", "S_vv"]));
    columns.extend(fixed(&["validity", "cause", "regime_confirmed"]));
    columns
}

fn upper_triangle() -> impl Iterator<Item = (usize, usize)> {
    (0..SIZE).flat_map(|row| (row..SIZE).map(move |column| (row, column)))
}

pub fn write(writer: impl Write, run: &ReplayedRun) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(writer);
    csv.write_record(columns())?;
    for (estimate, confirmed) in run.estimates.iter().zip(&run.regimes) {
        csv.write_record(fields(estimate, *confirmed))?;
    }
    csv.flush()
}

fn fields(estimate: &Estimate, confirmed: Regime) -> Vec<String> {
    let belief = &estimate.belief;
    let components = [LOCATION, SPEED, R0, R1, R2];
    let mut fields = vec![digits_17(estimate.time_s)];
    fields.extend(components.map(|component| digits_17(belief.mean[component])));
    fields.extend(components.map(|component| digits_17(belief.sd(component))));
    fields.extend(upper_triangle().map(|at| digits_17(belief.covariance[at])));
    fields.push(optional(estimate.effort_n_per_kg));
    fields.push(optional(estimate.acceleration_mps2));
    fields.push(estimate.regime.as_str().to_owned());
    fields.push(u8::from(estimate.learning).to_string());
    fields.extend(innovation(estimate).map(optional));
    fields.push(estimate.validity.as_str().to_owned());
    fields.push(estimate.validity.cause().map_or("", |cause| cause.as_str()).to_owned());
    fields.push(confirmed.as_str().to_owned());
    fields
}

/// Innovation of location and speed, S_ss, S_sv, S_vv. A reading that was missing has no innovation, and keeps its expected variance.
fn innovation(estimate: &Estimate) -> [Option<f64>; 5] {
    let Some(innovation) = &estimate.innovation else {
        return [None; 5];
    };
    let value = |index: usize| (innovation.readings[index] != Reading::Missing).then(|| innovation.value[index]);
    let s = &innovation.covariance;
    [value(0), value(1), Some(s[(0, 0)]), Some(s[(0, 1)]), Some(s[(1, 1)])]
}

fn optional(number: Option<f64>) -> String {
    number.filter(|number| number.is_finite()).map(digits_17).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_stand_in_the_agreed_order() {
        let expected = "time_s,location_m,speed_mps,r0,r1,r2,sd_location_m,sd_speed_mps,sd_r0,sd_r1,sd_r2,\
            P_00,P_01,P_02,P_03,P_04,P_11,P_12,P_13,P_14,P_22,P_23,P_24,P_33,P_34,P_44,\
            effort_n_per_kg,acceleration_mps2,regime,learning,innovation_location_m,innovation_speed_mps,S_ss,S_sv,S_vv,\
            validity,cause,regime_confirmed";
        assert_eq!(columns().join(","), expected);
    }
}
