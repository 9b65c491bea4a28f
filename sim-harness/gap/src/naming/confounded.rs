//! Two causes that together look like one: rivals that a search does not find, because it replaces one term at a time.

use crate::candidate::Naming;
use crate::candidates::separates;
use crate::config::CertaintyConfig;
use crate::data::believed::Context;
use crate::data::rows::Row;
use crate::levels::{More, Standout};
use crate::named::Named;
use rundown::model::direction::Direction;
use rundown::model::effects::{DavisError, Effect, EffectKind, PowerLimitSection, TractionScale};
use rundown_check::figure::HALF_95;
use rundown_files::statistics::mean;

/// Length of the places at which the described gradient is looked at, m.
const PLACE_M: f64 = 100.0;

/// Adds to what was named the causes that it may be in truth. `gain`: by how much more than 1 the effort column was put
/// right by.
pub fn confounded(all: &mut [Named], gain: Option<f64>, naming: &Naming<'_>) {
    let certainty = &naming.context.config.certainty;
    let wrong: Vec<[f64; 2]> = all
        .iter()
        .filter(|one| is_of_gradients(one))
        .filter_map(|one| one.effect.section_m())
        .map(Into::into)
        .collect();
    for named in all {
        let is_drag = named.effect.kind() == EffectKind::DraggingBrake;
        if is_drag && (1..=certainty.few_dragging).contains(&named.runs.len()) {
            let (what, separates) = few_dragging(naming.measured);
            named.or_else(what, certainty.confounded, separates);
        }
        for rival in rivals(&named.effect, gain, &wrong, naming) {
            if !named.ambiguous_with.contains(&rival) {
                named.rival(rival, certainty.confounded, separates(named.effect.kind(), rival, naming.have()));
            }
        }
    }
}

/// What a brake that drags in one or two runs may be in truth, by chance of many, and what would separate them: coasts
/// that begin while a brake is let go look so.
fn few_dragging(measured: bool) -> (&'static str, &'static str) {
    if measured {
        ("another load or wind of these runs", "the load and the wind of each run")
    } else {
        ("brakes that were released late", "the pressure of the brake")
    }
}

/// What all runs seem to have may be one unit's or one driver's: wrong coefficients, where the other of two has the
/// described resistance, and whatever another mass changes, where a unit needs another effort.
pub fn of_one_alone(all: &mut [Named], standouts: &[Standout], certainty: &CertaintyConfig) {
    let is_alone = |standout: &Standout| {
        let other = standout.other.as_ref().filter(|_| standout.more == More::Resistance);
        let of_other = other.map(|(_, described)| described.abs());
        of_other.is_some_and(|of_other| of_other < certainty.as_described * standout.share.value.abs())
    };
    if standouts.iter().any(is_alone) {
        for one in all.iter_mut().filter(|one| one.effect.kind() == EffectKind::DavisError) {
            one.or_else("one unit or driver alone", certainty.alone, "the runs of each by themselves");
        }
    }
    const OF_MASS: [EffectKind; 3] = [EffectKind::DavisError, EffectKind::MassError, EffectKind::TractionScale];
    if standouts.iter().any(|standout| standout.more == More::Effort) {
        for one in all.iter_mut().filter(|one| OF_MASS.contains(&one.effect.kind())) {
            one.or_else("another mass of one unit", certainty.confounded, "the runs of each unit by themselves");
        }
    }
}

/// What an effect may be in truth, beside a cause that hides the difference. `wrong`: where gradients are.
fn rivals(effect: &Effect, gain: Option<f64>, wrong: &[[f64; 2]], naming: &Naming<'_>) -> Vec<EffectKind> {
    if let Effect::DavisError(davis) = effect {
        // Beside another mass, or what else changes r(v), a wind is no single rival.
        let wind = !naming.have().both_directions && is_like_wind(davis, naming);
        let wind = wind.then_some(EffectKind::SteadyWind);
        // Nor is a slope of the whole line another than r0, where none is described.
        let slope = !naming.have().both_directions && naming.context.surroundings.is_level && davis.dr0 != 0.0;
        let slope = slope.then_some(EffectKind::GradientError);
        return slope.into_iter().chain(wind).chain(gain.map(|_| EffectKind::MassError)).collect();
    }
    if let Effect::PowerLimitSection(limit) = effect {
        let climbs = !naming.measured && may_climb([limit.from_m, limit.to_m], wrong, naming);
        let drags = may_drag(limit, naming);
        let climbs = climbs.then_some(EffectKind::GradientError);
        return climbs.into_iter().chain(drags.then_some(EffectKind::TunnelDrag)).collect();
    }
    let Effect::TractionScale(TractionScale { factor }) = effect else { return Vec::new() };
    // The column as it reads has the described limit: force and limit are right, and the acceleration is that of
    // another mass.
    let certainty = &naming.context.config.certainty;
    let as_described = gain.is_some_and(|gain| ((1.0 + gain) * factor - 1.0).abs() < certainty.same_force);
    as_described.then_some(EffectKind::MassError).into_iter().collect()
}

/// Places that the description of the line may be wrong about.
fn is_of_gradients(named: &Named) -> bool {
    matches!(named.effect.kind(), EffectKind::GradientError | EffectKind::Unknown)
}

/// Without efforts the power goes into a climb that nobody has described: where gradients are wrong close by, or, of a
/// section that is hardly ever coasted in, where they are wrong elsewhere or the section is described as level.
fn may_climb(section: [f64; 2], wrong: &[[f64; 2]], naming: &Naming<'_>) -> bool {
    let Context { believed, surroundings, config, .. } = naming.context;
    let [from_m, to_m] = section;
    let near_m = config.certainty.described_m;
    let is_near = |[from, to]: &[f64; 2]| *from < to_m + near_m && *to > from_m - near_m;
    let track = believed.line(Direction::Up).track;
    let places = ((to_m - from_m) / PLACE_M).max(1.0) as u32;
    let is_level =
        (1..=places).all(|i| track.mean_gradient(from_m + PLACE_M * f64::from(i), PLACE_M, Direction::Up) == 0.0);
    surroundings.is_level
        || wrong.iter().any(is_near)
        || (!is_coasted(section, naming) && (is_level || !wrong.is_empty()))
}

/// Without efforts the power may go into a resistance k v² of the section: unless enough rows coast there and surely
/// show less than half of it, even if the power is short of the least, at the highest speed.
pub fn may_drag(limit: &PowerLimitSection, naming: &Naming<'_>) -> bool {
    let certainty = &naming.context.config.certainty;
    let coasts: Vec<&Row> = coasted([limit.from_m, limit.to_m], naming).collect();
    if naming.measured || coasts.len() < certainty.coasted_rows {
        return !naming.measured;
    }
    let speeds = naming.rows.iter().map(|row| row.interval.mean_speed_mps());
    let fastest_mps = speeds.fold(f64::MIN_POSITIVE, f64::max);
    let lacks_n_per_kg = (1.0 - limit.factor) * naming.context.believed.train().max_effort_n_per_kg(fastest_mps);
    let expected = |row: &Row| lacks_n_per_kg * (row.interval.mean_speed_mps() / fastest_mps).powi(2);
    let pairs: Vec<[f64; 2]> = coasts.into_iter().map(|row| [expected(row), row.residual_n_per_kg]).collect();
    let sum = |of: &dyn Fn(&[f64; 2]) -> f64| pairs.iter().map(of).sum::<f64>();
    let weight = sum(&|[expected, _]| expected.powi(2));
    let shown = sum(&|[expected, residual]| expected * residual) / weight;
    let left = sum(&|[expected, residual]| (residual - shown * expected).powi(2));
    let sd = (left / (pairs.len() as f64 - 1.0) / weight).sqrt();
    // Of a limit that lacks nothing there is no number, and nothing is known.
    let most = shown + HALF_95 * sd;
    most.is_nan() || most >= certainty.coasted_drag
}

/// Enough of the rows lie in the section to show a resistance there.
fn is_coasted(section: [f64; 2], naming: &Naming<'_>) -> bool {
    coasted(section, naming).count() >= naming.context.config.certainty.coasted_rows
}

fn coasted<'a>([from_m, to_m]: [f64; 2], naming: &Naming<'a>) -> impl Iterator<Item = &'a Row> + use<'a> {
    naming.rows.iter().filter(move |row| (from_m..to_m).contains(&row.interval.middle().location_m))
}

/// A wind that blows would add as much at the usual speed: r2 ((v + w)² - v²).
fn is_like_wind(davis: &DavisError, naming: &Naming<'_>) -> bool {
    let speed_mps = mean(naming.rows.iter().map(|row| row.interval.mean_speed_mps())).unwrap_or_default();
    let extra = davis.dr0 + davis.dr1 * speed_mps + davis.dr2 * speed_mps * speed_mps;
    let air = speed_mps * speed_mps + extra / naming.context.believed.train().davis().r2;
    let wind_mps = air.max(0.0).sqrt() - speed_mps;
    air > 0.0 && wind_mps.abs() < naming.context.config.certainty.most_wind_mps
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::believed::{Surroundings, tests::on_a_hilly_line};
    use crate::levels::Level;
    use crate::readings::kinematics::Kinematics;
    use rundown::model::effects::{DraggingBrake, GradientError};
    use rundown_check::figure::Figure;

    /// Rivals of a limit in this section, where gradients are wrong in `wrong` and so many intervals coasted in it.
    fn rivals(
        context: &Context<'_>,
        [from_m, to_m]: [f64; 2],
        wrong: Option<[f64; 2]>,
        coasts: usize,
        measured: bool,
    ) -> Vec<EffectKind> {
        let rows = vec![Row::coasting(Direction::Up, 0.5 * (from_m + to_m), 30.0); coasts];
        let kinematics = Kinematics::default();
        let naming = Naming { rows: &rows, measured, ..Naming::plain(context, &kinematics) };
        let limit = PowerLimitSection { from_m, to_m, factor: 0.6 };
        let mut all = vec![Named::plain(limit.into(), Vec::new(), 40.0, 1e-3)];
        let of_gradient = |[from_m, to_m]: [f64; 2]| GradientError { from_m, to_m, delta_permille: 4.0 };
        all.extend(wrong.map(|wrong| Named::plain(of_gradient(wrong).into(), Vec::new(), 30.0, 1e-3)));
        confounded(&mut all, None, &naming);
        all[0].ambiguous_with.clone()
    }

    #[test]
    fn a_limit_may_be_a_climb_where_the_gradients_are_wrong_near_by_or_not_known() {
        const SHARED: [EffectKind; 2] = [EffectKind::GradientError, EffectKind::TunnelDrag];
        let section = [10_000.0, 14_000.0];
        on_a_hilly_line(20, |context| {
            let near = Some([14_300.0, 15_000.0]);
            // Where nobody coasts, whatever takes power in a section may be a resistance of it.
            for (coasts, resists) in [(0, &SHARED[1..]), (12, &[])] {
                assert_eq!(rivals(context, section, None, coasts, false), resists);
                assert_eq!(rivals(context, section, near, coasts, false), [&SHARED[..1], resists].concat());
                assert_eq!(rivals(context, section, near, coasts, true), []);
            }
            // Wrong elsewhere, or a kilometre that is described as level: only of what hardly anyone coasted in.
            for (section, wrong) in [(section, Some([20_000.0, 22_000.0])), ([7_100.0, 7_900.0], None)] {
                assert_eq!(rivals(context, section, wrong, 0, false), SHARED);
                assert_eq!(rivals(context, section, wrong, 12, false), []);
            }
        });
    }

    #[test]
    fn a_brake_that_drags_in_one_or_two_runs_may_be_something_else() {
        on_a_hilly_line(20, |context| {
            let kinematics = Kinematics::default();
            let confidence = |runs: usize, measured: bool| {
                let drag = DraggingBrake { drag_n_per_kg: 2e-3 };
                let names = (0..runs).map(|run| run.to_string()).collect();
                let mut all = vec![Named { runs: names, ..Named::plain(drag.into(), Vec::new(), 40.0, 30.0) }];
                confounded(&mut all, None, &Naming { measured, ..Naming::plain(context, &kinematics) });
                all[0].confidence
            };
            for measured in [false, true] {
                assert!(confidence(2, measured) < 0.7 && confidence(3, measured) > 0.9);
            }
        });
    }

    #[test]
    fn coefficients_of_all_runs_are_those_of_one_unit_where_the_other_is_as_described() {
        let certainty = CertaintyConfig::default();
        let confidence = |of_other: f64| {
            let davis = DavisError { dr0: 2e-3, dr1: 0.0, dr2: 0.0 };
            let mut all = vec![Named::plain(davis.into(), Vec::new(), 40.0, 30.0)];
            let standout = Standout {
                more: More::Resistance,
                level: Level::Unit,
                of: "u02".to_owned(),
                runs: 15,
                share: Figure { value: 0.16, sd: 0.01 },
                described: 0.16 + of_other,
                other: Some(("u01".to_owned(), of_other)),
                p_value: 0.001,
            };
            of_one_alone(&mut all, &[standout], &certainty);
            all[0].confidence
        };
        assert!(confidence(0.01) < 0.25 && confidence(0.08) > 0.9);
    }

    #[test]
    fn a_section_whose_coasts_show_its_resistance_may_have_no_limit() {
        on_a_hilly_line(20, |context| {
            let limit = PowerLimitSection { from_m: 10e3, to_m: 14e3, factor: 0.9 };
            let lacks = 0.1 * context.believed.train().max_effort_n_per_kg(30.0);
            let may_drag = |share: f64, scatter: f64| {
                let row = |i: usize| Row {
                    residual_n_per_kg: share * lacks + if i.is_multiple_of(2) { scatter } else { -scatter },
                    ..Row::coasting(Direction::Up, 12e3, 30.0)
                };
                let rows: Vec<Row> = (0..12).map(row).collect();
                let kinematics = Kinematics::default();
                super::may_drag(&limit, &Naming { rows: &rows, measured: false, ..Naming::plain(context, &kinematics) })
            };
            assert!(may_drag(0.8, 0.3 * lacks));
            assert!(!may_drag(0.0, 0.3 * lacks));
            // Rows that scatter too much to know.
            assert!(may_drag(0.0, 2.0 * lacks));
        });
    }

    #[test]
    fn another_r0_in_one_direction_may_be_a_slope_of_a_line_without_described_ones() {
        on_a_hilly_line(20, |context| {
            let kinematics = Kinematics::default();
            let rivals_of = |is_level: bool, dr0: f64| {
                let surroundings = Surroundings { is_level, ..Surroundings::default() };
                let context = Context { surroundings: &surroundings, ..*context };
                let davis = DavisError { dr0, dr1: 0.0, dr2: 1e-6 };
                let mut all = vec![Named::plain(davis.into(), Vec::new(), 40.0, 30.0)];
                confounded(&mut all, None, &Naming::plain(&context, &kinematics));
                all[0].ambiguous_with.clone()
            };
            assert!(rivals_of(true, 5e-3).contains(&EffectKind::GradientError));
            assert!(!rivals_of(false, 5e-3).contains(&EffectKind::GradientError));
            assert!(!rivals_of(true, 0.0).contains(&EffectKind::GradientError));
        });
    }

    #[test]
    fn what_another_mass_of_one_unit_changes_may_be_that_mass() {
        let certainty = CertaintyConfig::default();
        let standout = |more: More| Standout {
            more,
            level: Level::Unit,
            of: "u02".to_owned(),
            runs: 15,
            share: Figure { value: 0.1, sd: 0.01 },
            described: 0.1,
            other: Some(("u01".to_owned(), 0.08)),
            p_value: 0.001,
        };
        let or_else = |more: More| {
            let weak = TractionScale { factor: 0.95 };
            let mut all = vec![Named::plain(weak.into(), Vec::new(), 40.0, 30.0)];
            of_one_alone(&mut all, &[standout(more)], &certainty);
            (all[0].or_else, all[0].confidence < 0.7)
        };
        assert_eq!(or_else(More::Effort), (Some("another mass of one unit"), true));
        assert_eq!(or_else(More::Resistance), (None, false));
    }

    #[test]
    fn a_limit_that_the_effort_column_shows_as_described_may_be_another_mass() {
        on_a_hilly_line(20, |context| {
            let rivals_of = |factor: f64, gain: Option<f64>| {
                let kinematics = Kinematics::default();
                let naming = Naming::plain(context, &kinematics);
                let mut all = vec![Named::plain(TractionScale { factor }.into(), Vec::new(), 40.0, 1e-3)];
                let before = all[0].confidence;
                confounded(&mut all, gain, &naming);
                (all[0].ambiguous_with.clone(), all[0].confidence < before)
            };
            // Off by as much in the other direction: they cancel.
            assert_eq!(rivals_of(0.948, Some(0.057)), (vec![EffectKind::MassError], true));
            assert_eq!(rivals_of(1.33, Some(-0.24)), (vec![EffectKind::MassError], true));
            // A column that reads too much of a train that is as weak as it shows.
            assert_eq!(rivals_of(0.9, Some(0.05)), (Vec::new(), false));
            assert_eq!(rivals_of(0.9, None), (Vec::new(), false));
        });
    }
}
