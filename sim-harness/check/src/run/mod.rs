//! One run by itself: its clock, its places, its readings, and what its speed and location say of each other.
//!
//! What these say beside what was taken off is [`of_speed`].

pub(crate) mod of_speed;

use crate::figure::Figure;
use crate::finding::{Done, Finding, Kind, with_evidence};
use crate::perturbed::Perturbation;
use crate::rows::same::{Seen, Shared};
use crate::rows::{interpolated, readings, times};
use crate::{clock, effort, location, speed, wheel};
use of_speed::{OfSpeed, Taken};
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;
use rundown_files::units;
use serde::Serialize;
use std::collections::BTreeMap;

/// A log that has more of its rows in common with another one teaches the same again.
const MOST_SHARED: f64 = 0.8;

/// What is the matter with one run.
#[derive(Clone, Debug, Default, Serialize)]
pub struct RunCheck {
    /// Name of the run.
    pub name: String,
    /// Whose recorder it was.
    pub unit: String,
    /// Rows of the log.
    pub rows: usize,
    /// Usual time between rows, s.
    pub step_s: f64,
    /// Its speeds were computed from the locations: beside these they say nothing.
    #[serde(skip)]
    pub speed_is_computed: bool,
    /// By how much the speed is older than the location, s; none where too little moves.
    pub skew_s: Option<Figure>,
    /// White noise of the location, standard deviation, m.
    pub location_noise_m: Option<f64>,
    /// Speed over location when this run alone is asked, the recorder's offset known.
    pub scale: Option<Figure>,
    /// What was found.
    pub findings: Vec<Finding>,
    /// What says so, where it is more than a figure: by what was found.
    pub evidence: BTreeMap<Kind, String>,
    /// What outside the train held the run up, beside the other runs in its direction.
    pub perturbations: Vec<Perturbation>,
}

impl RunCheck {
    fn of(recording: &Recording, step_s: f64, findings: Vec<Finding>) -> Self {
        Self {
            name: recording.name.clone(),
            unit: recording.unit.clone(),
            rows: recording.rows.len(),
            step_s,
            speed_is_computed: recording.speed_is_computed(),
            findings,
            ..Self::default()
        }
    }

    /// Why the run is not to be used.
    pub fn refusal(&self) -> Option<&Finding> {
        self.findings.iter().find(|finding| finding.done == Done::Refused)
    }

    /// Nothing forbids to use it.
    pub fn is_usable(&self) -> bool {
        self.refusal().is_none()
    }

    /// It is one of this unit, and is used.
    pub(crate) fn is_usable_of(&self, unit: &str) -> bool {
        self.unit == unit && self.is_usable()
    }

    /// Something is the matter with the whole of it.
    pub(crate) fn found(&mut self, kind: Kind, figure: Figure, unit: &'static str, done: Done) {
        self.findings.push(Finding { kind, figure, unit, count: 1, line: 0, done });
    }

    fn found_by(&mut self, kind: Kind, figure: Figure, unit: &'static str, done: Done, evidence: String) {
        self.found(kind, figure, unit, done);
        self.evidence.insert(kind, evidence);
    }

    /// Some of its rows are those of another log; where most are, it is not used.
    fn shares(&mut self, shared: &Shared) {
        let figure = Figure { value: 100.0 * shared.share, sd: 0.0 };
        let done = if shared.share > MOST_SHARED { Done::Refused } else { Done::Said };
        self.found_by(Kind::SharedRows, figure, "% of the rows", done, format!("those of {}", shared.with));
    }

    /// Its locations are those of another unit.
    pub(crate) fn is_in_other_unit(&mut self, factor: f64, stops: usize) {
        let evidence = format!("{stops} of its stops are described ones once locations are divided by it");
        self.found_by(Kind::OtherUnit, Figure { value: factor, sd: 0.0 }, "", Done::Refused, evidence);
    }

    /// The train answers otherwise to its effort than in the other runs.
    pub(crate) fn answers_otherwise(&mut self, figure: Figure) {
        let evidence = match figure.value {
            0.0 => "the column stands still".to_owned(),
            value if value > 0.0 => format!("as of a column that reads {:.2} of the effort", 1.0 / value),
            _ => "as of a column with the sign turned".to_owned(),
        };
        self.found_by(Kind::EffortUnlike, figure, "", Done::LeftOut, evidence);
    }

    /// The train brakes with efforts above zero, in so many of its windows of braking.
    pub(crate) fn brakes_without_sign(&mut self, [against, all]: [usize; 2]) {
        let figure = Figure { value: 100.0 * against as f64 / all as f64, sd: 0.0 };
        let evidence = format!("in {against} of {all} windows of 10 s, unlike in other runs");
        self.found_by(Kind::UnsignedBrake, figure, "%", Done::LeftOut, evidence);
    }

    /// Its wheel changes on the way.
    pub(crate) fn changes(&mut self, change: &wheel::change::Change, rows: &[Sample], done: Done) {
        let (at_m, line) = change.place(rows);
        self.findings.push(Finding { kind: Kind::WheelChange, figure: change.ratio, unit: "", count: 1, line, done });
        let place = at_m.map_or_else(String::new, |at_m| format!("near km {:.1}, ", at_m / 1000.0));
        self.evidence.insert(Kind::WheelChange, format!("{place}{:.0} s", change.time_s));
    }

    /// Its locations are not on the chainage of the others.
    pub(crate) fn is_off(&mut self, off: location::chainage::Off) {
        let kind = if off.is_turned { Kind::TurnedChainage } else { Kind::OtherChainage };
        let done = if off.is_decided { Done::Refused } else { Done::Said };
        self.found_by(kind, off.figure, "m", done, off.evidence);
    }

    /// A finding of this run as a sentence, with its evidence.
    pub fn said(&self, finding: &Finding) -> String {
        with_evidence(finding, &self.evidence)
    }

    /// What held the run up, in words; none where nothing did.
    pub fn perturbed(&self) -> Option<String> {
        let words: Vec<String> = self.perturbations.iter().map(ToString::to_string).collect();
        (!words.is_empty()).then(|| words.join("; "))
    }
}

/// Judges one run, and puts right what is beyond doubt. `ends_at_mps`: where the speeds of its recorder end, if they
/// do.
pub(crate) fn beside(
    recording: &mut Recording,
    ends_at_mps: Option<f64>,
    seen: &mut Seen,
) -> (RunCheck, Option<OfSpeed>) {
    if let Some(earlier) = seen.earlier(recording) {
        return (copy_of(recording, earlier), None);
    }
    let shared = seen.shared(recording);
    let (mut run, of_speed) = of_run(recording, ends_at_mps);
    shared.into_iter().for_each(|shared| run.shares(&shared));
    (run, of_speed)
}

/// A log that holds the same rows as an earlier one is not looked at further.
fn copy_of(recording: &Recording, earlier: &str) -> RunCheck {
    let rows = recording.rows.len();
    let figure = Figure { value: rows as f64, sd: 0.0 };
    let (kind, done) = (Kind::SameRows, Done::Refused);
    let finding = Finding { kind, figure, unit: "rows", count: 1, line: 0, done };
    let evidence = BTreeMap::from([(kind, format!("those of {earlier}"))]);
    RunCheck { evidence, ..RunCheck::of(recording, times::usual_step_s(&recording.rows), vec![finding]) }
}

fn is_usable(findings: &[Finding]) -> bool {
    findings.iter().all(|finding| finding.done != Done::Refused)
}

fn of_run(recording: &mut Recording, ends_at_mps: Option<f64>) -> (RunCheck, Option<OfSpeed>) {
    let mut findings = Vec::new();
    let speed_is_computed = recording.speed_is_computed();
    let rows = &mut recording.rows;
    clock::jumps::sort(rows, &mut findings);
    clock::bursts::spread(rows, &mut findings);
    clock::jumps::coarse(rows, &mut findings);
    clock::jumps::put_right(rows, &mut findings);
    interpolated::leave_out(rows, &mut findings);
    // In another unit readings may be beyond what any train has.
    if is_usable(&findings) {
        other_unit(rows, &mut findings);
    }
    readings::impossible(rows, &mut findings);
    readings::missing(rows, &mut findings);
    let mut evidence = BTreeMap::new();
    if is_usable(&findings) {
        let usual_s = times::usual_step_s(rows);
        // They accuse the locations beside them.
        let stuck = if speed_is_computed { Vec::new() } else { speed::stuck::found(rows) };
        // A single wild speed must not make a straight line look bridged.
        readings::speed_spikes(rows, &mut findings);
        evidence.extend(
            location::bridged::leave_out(rows, usual_s, &stuck, &mut findings).map(|text| (Kind::Bridged, text)),
        );
        location::placeholders::leave_out(rows, &mut findings);
        location::stuck::leave_out(rows, &mut findings);
        location::spikes::leave_out(rows, &stuck, &mut findings);
        location::odometer::join(rows, &stuck, &mut findings);
        if !speed_is_computed {
            // Only beside locations that are right is a speed known to stand still, or to come to its end.
            let end_mps = speed::saturated::end_of(rows, ends_at_mps);
            speed::stuck::leave_out(rows, end_mps, &mut findings);
            speed::saturated::leave_out(rows, end_mps, &mut findings);
            speed::stairs::leave_out(rows, &mut findings);
        }
        effort::stairs::put_right(rows, &mut findings);
        location::two_directions::refuse(rows, &mut findings);
    }
    clock::jumps::gaps(rows, &mut findings);
    let step_s = times::usual_step_s(rows);
    // Times that are those of the arrival make an age and lost seconds of their own.
    let is_timed = findings.iter().all(|found| found.kind != Kind::Bursts || found.done != Done::Said);
    let of_speed = if is_usable(&findings) && is_timed && !speed_is_computed {
        OfSpeed::of(rows, step_s, Taken::default())
    } else {
        None
    };
    let location_noise_m = of_speed.as_ref().map(|found| found.agreement.location_noise_m);
    (RunCheck { location_noise_m, evidence, ..RunCheck::of(recording, step_s, findings) }, of_speed)
}

/// Distance by location over distance by speed far from 1, in the whole log or from a line on: the run is not used.
/// Wild speeds are no matter of units.
fn other_unit(rows: &[Sample], findings: &mut Vec<Finding>) {
    let mut calm = rows.to_vec();
    readings::speed_spikes(&mut calm, &mut Vec::new());
    if let Some((value, line)) = units::far(&calm) {
        let figure = Figure { value, sd: 0.0 };
        findings.push(Finding { kind: Kind::OtherUnit, figure, unit: "", count: 1, line, done: Done::Refused });
    }
}
