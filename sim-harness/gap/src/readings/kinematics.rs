//! Do speed and location agree, before any question about forces? The diagnosis of the logs has asked: here is what it
//! says of all runs together.
//!
//! Scales and offsets of the speed are put right in the samples. The age of the location moves the train on its
//! gradients, run by run.

use crate::config::KinematicsConfig;
use crate::data::runs::Run;
use rundown_check::figure::Figure;

/// What all runs have alike.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Kinematics {
    /// Measured over true speed, where all recorders read alike and not true.
    pub scale: Option<Figure>,
    /// Age of the location reading less that of the speed, s.
    pub lag_s: Option<Figure>,
    /// Runs in which speed and location could be compared.
    pub runs: usize,
}

impl Kinematics {
    /// Of these runs.
    pub fn of(runs: &[Run]) -> Self {
        let recorders = recorders(runs);
        let compared = runs.iter().filter(|run| run.recorded.own_scale.is_some()).count();
        let lags_s: Vec<Figure> = recorders.iter().filter_map(|(_, _, lag_s)| *lag_s).collect();
        Self { scale: common(&recorders), lag_s: Figure::mean_of(&lags_s), runs: compared }
    }

    /// The lag, s, with its standard deviation, if it is beyond doubt and matters.
    pub fn lag_that_matters(&self, config: &KinematicsConfig) -> Option<(f64, f64)> {
        let Figure { value, sd } = self.lag_s?;
        (value.abs() > config.least_lag_s && value.abs() > config.sure * sd).then_some((value, sd))
    }
}

/// A unit with the scale that was put right in its speeds, and its usual lag, s.
type Recorder<'a> = (&'a str, Option<Figure>, Option<Figure>);

/// Recorders differ by no more than this in standard deviations, if they have one scale.
const ALIKE: f64 = 3.0;

/// The scale that all recorders have: what several units have alike is the description of the wheel, or the measure of
/// the line.
fn common(recorders: &[Recorder<'_>]) -> Option<Figure> {
    let scales: Vec<Figure> = recorders.iter().map(|(_, scale, _)| *scale).collect::<Option<_>>()?;
    let mean = Figure::mean_of(&scales)?;
    scales.iter().all(|scale| scale.away_from(mean.value) < ALIKE).then_some(mean)
}

/// The recorders of these runs, in the order in which they appear.
fn recorders(runs: &[Run]) -> Vec<Recorder<'_>> {
    let mut found: Vec<Recorder<'_>> = Vec::new();
    for recorded in runs.iter().map(|run| &run.recorded) {
        if found.iter().all(|(unit, ..)| *unit != recorded.unit) {
            found.push((&recorded.unit, recorded.scale, recorded.usual_lag_s));
        }
    }
    found
}

/// Measured over true speed by each run alone, where it could be compared, with its index.
pub fn own_scales(runs: &[Run]) -> Vec<(usize, Figure)> {
    let of = |(i, run): (usize, &Run)| Some((i, run.recorded.own_scale?));
    runs.iter().enumerate().filter_map(of).collect()
}

/// Recorders whose speeds were put right, where not all have one scale: the scale, and the runs by their indices.
pub fn scaled_recorders(runs: &[Run]) -> Vec<(Figure, Vec<usize>)> {
    let recorders = recorders(runs);
    if common(&recorders).is_some() {
        return Vec::new();
    }
    let of = |unit: &str| (0..runs.len()).filter(|i| runs[*i].recorded.unit == unit).collect();
    recorders.into_iter().filter_map(|(unit, scale, _)| Some((scale?, of(unit)))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::runs::Recorded;
    use rundown::model::direction::Direction;

    fn run(unit: &str, scale: Option<f64>, lag_s: f64) -> Run {
        let recorded = Recorded {
            unit: unit.to_owned(),
            scale: scale.map(|value| Figure { value, sd: 0.001 }),
            usual_lag_s: Some(Figure { value: lag_s, sd: 0.1 }),
            ..Recorded::default()
        };
        Run { name: unit.to_owned(), direction: Direction::Up, day: None, samples: Vec::new(), recorded }
    }

    #[test]
    fn one_recorder_has_one_scale_and_of_several_each_its_own() {
        let alike = [run("a", Some(1.013), 2.0), run("a", Some(1.013), 2.0)];
        assert_eq!(Kinematics::of(&alike).scale.map(|scale| scale.value), Some(1.013));
        assert_eq!(scaled_recorders(&alike), []);
        let two = [run("a", Some(1.013), 2.0), run("b", None, 3.0), run("a", Some(1.013), 2.0)];
        assert_eq!(Kinematics::of(&two).scale, None);
        let [(scale, runs)] = scaled_recorders(&two).try_into().unwrap();
        assert_eq!((scale.value, runs), (1.013, vec![0, 2]));
    }

    #[test]
    fn units_that_read_alike_have_one_scale() {
        let all = [run("a", Some(1.0131), 0.0), run("b", Some(1.0128), 0.0), run("c", Some(1.0141), 0.0)];
        let scale = Kinematics::of(&all).scale.unwrap();
        assert!((scale.value - 1.01333).abs() < 1e-5 && scale.sd < 0.001, "{scale:?}");
        assert_eq!(scaled_recorders(&all), []);
        let apart = [run("a", Some(1.013), 0.0), run("b", Some(0.99), 0.0)];
        assert_eq!(Kinematics::of(&apart).scale, None);
        assert_eq!(scaled_recorders(&apart).len(), 2);
    }

    #[test]
    fn lags_of_recorders_that_differ_are_uncertain_by_that() {
        let Figure { value, sd } = Kinematics::of(&[run("a", None, 1.0), run("b", None, 3.0)]).lag_s.unwrap();
        assert!((value - 2.0).abs() < 1e-9 && (sd - 1.0).abs() < 1e-9, "{value} {sd}");
        assert_eq!(Kinematics::of(&[]).lag_s, None);
    }
}
