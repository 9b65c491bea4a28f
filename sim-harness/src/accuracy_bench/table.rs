//! The tables of `docs/measured.md`.

use super::fleets::Fleet;
use super::score::FleetFigures;
use rundown::estimator::config::Mode;
use rundown_files::statistics::mean_of;

/// The fleets beside each other: r(v), then regimes and features.
pub fn tables(judged: &[(Fleet, FleetFigures)]) -> String {
    let mut text = String::from(
        "| fleet | r(v) of the vehicle, rms % after 1 / 10 / all runs | possible by the board's prior | by the fleet's | \
         of the running train | truths inside 95 % | learned from, s a run |\n|---|---|---|---|---|---|---|\n",
    );
    for (fleet, table) in judged {
        let mode = if fleet.mode == Mode::Measured { ", `measured`" } else { "" };
        let inside = slots(&table.vehicle, |errors| format!("{:.0}", 100.0 * errors.coverage()));
        let [vehicle, running] =
            [&table.vehicle, &table.running].map(|errors| slots(errors, |errors| rms(errors.rmse_percent())));
        let [possible, knowing] = table.possible_percent().map(|percent| slots(&percent, |percent| rms(*percent)));
        let learned_s = mean_of(&table.learned_s);
        text += &format!(
            "| {}{mode} | {vehicle} | {possible} | {knowing} | {running} | {inside} | {learned_s:.0} |\n",
            fleet.what
        );
    }
    text += "\n| fleet | regimes right, at the sample / one later | macro F1 one later | 90 % of brake starts, coast starts \
             within | cruise, power |\n|---|---|---|---|---|\n";
    for (fleet, table) in judged {
        let [(at, _), (later, f1)] = table.regime_scores();
        let [brake_s, coast_s, cruise_kmh, power] = table.feature_p90();
        text += &format!(
            "| {} | {at:.2} / {later:.2} | {f1:.2} | {brake_s:.0} s, {coast_s:.0} s | {cruise_kmh:.1} km/h, {} |\n",
            fleet.what,
            if power.is_nan() { "-".to_owned() } else { format!("{power:.1} %") },
        );
    }
    text
}

fn rms(percent: f64) -> String {
    format!("{percent:.0$}", if percent < 1.0 { 2 } else { 1 })
}

fn slots<T>(looks: &[T; 3], of: impl Fn(&T) -> String) -> String {
    looks.iter().map(of).collect::<Vec<_>>().join(" / ")
}
