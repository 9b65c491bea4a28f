//! `<run>.estimates.csv`: one row a tick.

use rundown::model::state::{LOCATION, R0, R1, R2, SIZE, SPEED};
use rundown::{filter::ukf::Reading, tick::estimate::Estimate, tick::regime::Regime};
use rundown_files::column::Column;
use rundown_files::replay::ReplayedRun;

/// Name of the file of a run, without its end.
pub fn stem(run: &ReplayedRun) -> String {
    format!("{}.estimates", run.name)
}

/// A tick.
#[derive(Clone, Copy, Debug)]
pub struct EstimateRow {
    estimate: Estimate,
    confirmed: Regime,
}

/// The components of the state, with their names, units and meanings.
const STATE: [(usize, &str, &str, &str); SIZE] = [
    (LOCATION, "location_m", "m", "location of the front along the track"),
    (SPEED, "speed_mps", "m/s", "speed"),
    (R0, "r0", "N/kg", "Davis coefficient of this run's train: r(v) = r0 + r1 v + r2 v²"),
    (R1, "r1", "N/kg per m/s", "Davis coefficient of this run's train"),
    (R2, "r2", "N/kg per (m/s)²", "Davis coefficient of this run's train"),
];
const NO_READING: &str = "a reading was missing, or the run begins here";
const NOT_MEASURED: &str = "the reading was missing, or nothing was expected";

/// The columns of the file.
pub fn columns() -> Vec<Column<EstimateRow>> {
    let mut columns =
        vec![Column::number("time_s", "s", "time of the measurement", |row: &EstimateRow| row.estimate.time_s)];
    columns.extend(
        STATE.map(|(at, name, unit, meaning)| Column::number(name, unit, meaning, move |r: &EstimateRow| r.mean(at))),
    );
    columns.extend(STATE.map(|(at, name, unit, _)| {
        let meaning = format!("standard deviation of `{name}`");
        Column::number(&format!("sd_{name}"), unit, &meaning, move |r: &EstimateRow| r.estimate.belief.sd(at))
    }));
    columns.extend(upper_triangle().map(|at| {
        let names = [STATE[at.0].1, STATE[at.1].1];
        let meaning = format!("covariance of `{}` and `{}`, product of their units", names[0], names[1]);
        let name = format!("P_{}{}", at.0, at.1);
        Column::number(&name, "", &meaning, move |r: &EstimateRow| r.estimate.belief.covariance[at])
    }));
    columns.extend(motion());
    columns.extend(innovations());
    columns.extend(trust());
    columns
}

fn upper_triangle() -> impl Iterator<Item = (usize, usize)> {
    (0..SIZE).flat_map(|row| (row..SIZE).map(move |column| (row, column)))
}

fn motion() -> [Column<EstimateRow>; 4] {
    let effort = "applied effort F/(γ m), mean since the tick before; traction positive, brake negative";
    let learning = "1 where the resistance was learned from this measurement";
    [
        Column::number("effort_n_per_kg", "N/kg", effort, |r: &EstimateRow| r.estimate.effort_n_per_kg)
            .empty_when(NO_READING),
        Column::number("acceleration_mps2", "m/s²", "mean since the tick before", |r: &EstimateRow| {
            r.estimate.acceleration_mps2
        })
        .empty_when(NO_READING),
        Column::text("regime", "regime as known at this tick", |r: &EstimateRow| r.estimate.regime.as_str()),
        Column::count("learning", learning, |r: &EstimateRow| r.estimate.learning),
    ]
}

/// A reading that was missing has no innovation, and keeps its expected variance.
fn innovations() -> [Column<EstimateRow>; 5] {
    let variance = |at: (usize, usize)| {
        move |r: &EstimateRow| r.estimate.innovation.as_ref().map(|innovation| innovation.covariance[at])
    };
    let nothing = "nothing was expected: the run begins here";
    [
        Column::number("innovation_location_m", "m", "measured less expected location", |r: &EstimateRow| {
            r.innovation(0)
        })
        .empty_when(NOT_MEASURED),
        Column::number("innovation_speed_mps", "m/s", "measured less expected speed", |r: &EstimateRow| {
            r.innovation(1)
        })
        .empty_when(NOT_MEASURED),
        Column::number("S_ss", "m²", "expected variance of the innovation of the location", variance((0, 0)))
            .empty_when(nothing),
        Column::number("S_sv", "m²/s", "expected covariance of both innovations", variance((0, 1))).empty_when(nothing),
        Column::number("S_vv", "m²/s²", "expected variance of the innovation of the speed", variance((1, 1)))
            .empty_when(nothing),
    ]
}

fn trust() -> [Column<EstimateRow>; 3] {
    let confirmed = "regime of this row's sample as known one sample later; the last row keeps its `regime`";
    [
        Column::text(
            "validity",
            "`valid`, `held` or `invalid`: how far location and speed may be trusted",
            |r: &EstimateRow| r.estimate.validity.as_str(),
        ),
        Column::text("cause", "why they are not valid", |r: &EstimateRow| {
            r.estimate.validity.cause().map(|cause| cause.as_str())
        })
        .empty_when("they are valid"),
        Column::text("regime_confirmed", confirmed, |r: &EstimateRow| r.confirmed.as_str()),
    ]
}

impl EstimateRow {
    fn mean(&self, component: usize) -> f64 {
        self.estimate.belief.mean[component]
    }

    fn innovation(&self, index: usize) -> Option<f64> {
        let innovation = self.estimate.innovation.as_ref()?;
        (innovation.readings[index] != Reading::Missing).then(|| innovation.value[index])
    }
}

/// The ticks of a run.
pub fn rows(run: &ReplayedRun) -> impl Iterator<Item = EstimateRow> + '_ {
    let pairs = run.estimates.iter().zip(&run.regimes);
    pairs.map(|(estimate, confirmed)| EstimateRow { estimate: *estimate, confirmed: *confirmed })
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
        let names: Vec<String> = columns().into_iter().map(|column| column.about.name).collect();
        assert_eq!(names.join(","), expected);
    }
}
