//! The diagnosis of a set of runs, and what of it a person must know.

use crate::agreement::of_most::OfMost;
use crate::figure::Figure;
use crate::finding::{Done, Finding, Kind, with_evidence};
use crate::recorder::correction::Correction;
use crate::run::RunCheck;
use crate::{LEAST_SCALE, clock, gradients, usable_of};
use rundown_files::off_track::OffTrack;
use serde::Serialize;
use std::collections::BTreeMap;

/// What is the matter with all runs of one recorder.
#[derive(Clone, Debug, Default, Serialize)]
pub struct RecorderCheck {
    /// The unit, as the index names it.
    pub unit: String,
    /// Runs that moved long enough to compare speed and location.
    pub compared: usize,
    /// Runs.
    pub runs: usize,
    /// Step of the speeds, km/h.
    pub speed_step_kmh: Option<f64>,
    /// Step of the locations, m.
    pub location_step_m: Option<f64>,
    /// Step of the efforts, N/kg.
    pub effort_step_n_per_kg: Option<f64>,
    /// By how much the zero of the efforts may be wrong where it was put right, N/kg.
    #[serde(skip)]
    pub effort_doubt_n_per_kg: f64,
    /// Measured over true speed; with the offset known where that is decided.
    pub scale: Option<Figure>,
    /// Read over described locations, where they were put right: what is open of it is open of the speed, too.
    #[serde(skip)]
    pub located: Option<Figure>,
    /// That scale is a wheel's: it matters, and nothing else explains it.
    #[serde(skip)]
    pub is_wheel: bool,
    /// The scale of most of its runs.
    #[serde(skip)]
    pub(crate) of_most: Option<OfMost>,
    /// True less read speed, km/h.
    pub offset_kmh: Option<Figure>,
    /// By how much the speed is older than the location, s: median over the runs.
    pub skew_s: Option<Figure>,
    /// How much that differs from run to run, s.
    pub skew_spread_s: Option<f64>,
    /// How surely it is known that its clock loses no seconds beside a wheel that hides them: of the height of such
    /// steps, standard deviation, s.
    pub lost_second_sd_s: Option<f64>,
    /// What was put right in its speeds.
    pub correction: Correction,
    /// What is left in them: found, and not put right.
    #[serde(skip)]
    pub left_open: Correction,
    /// What was found.
    pub findings: Vec<Finding>,
    /// What says so, where it is more than a figure: by what was found.
    pub evidence: BTreeMap<Kind, String>,
}

impl RecorderCheck {
    /// Scale and lost seconds are not distinguishable: the noise of the location hides steps of a second.
    pub fn hides_lost_seconds(&self) -> bool {
        self.lost_second_sd_s.is_some_and(|sd_s| sd_s > clock::lost_seconds::NOT_SEEN_S)
    }

    /// A scale beside the locations as one beside the line.
    pub(crate) fn beside_the_line(&self, scale: Figure) -> Figure {
        let of_line = self.located.map_or(0.0, |located| located.sd / located.value);
        Figure { sd: scale.sd.hypot(scale.value * of_line), ..scale }
    }

    /// Whether one wheel gives speed and location: beside the locations as they were read, such a scale is none.
    pub(crate) fn has_one_wheel(&self, scale: Figure) -> bool {
        self.located.is_some_and(|located| (scale.value / located.value - 1.0).abs() < LEAST_SCALE)
    }

    /// A finding of this recorder as a sentence, with its evidence.
    pub fn said(&self, finding: &Finding) -> String {
        with_evidence(finding, &self.evidence)
    }

    /// True less read speed as the step decides it: half of it where the recorder truncates, less than 0 by as much
    /// where it rounds up, 0 where it rounds; else as measured. In km/h.
    pub fn decided_offset_kmh(&self) -> Option<f64> {
        self.offset_of_step_kmh().or_else(|| self.offset_kmh.map(|offset| offset.value))
    }

    /// The same; none where the step does not decide it.
    pub(crate) fn offset_of_step_kmh(&self) -> Option<f64> {
        let half_kmh = 0.5 * self.speed_step_kmh?;
        let decided = [(Kind::RoundedSpeed, 0.0), (Kind::TruncatedSpeed, half_kmh), (Kind::RoundedUpSpeed, -half_kmh)];
        decided.into_iter().find(|(kind, _)| self.has(*kind)).map(|(_, kmh)| kmh)
    }

    /// Whether a run is one of this recorder, and is used.
    pub(crate) fn has_usable(&self, run: &RunCheck) -> bool {
        run.is_usable_of(&self.unit)
    }

    /// The places of these.
    pub(crate) fn usable(&self, runs: &[RunCheck]) -> Vec<usize> {
        usable_of(&self.unit, runs)
    }

    pub(crate) fn has(&self, kind: Kind) -> bool {
        self.findings.iter().any(|finding| finding.kind == kind)
    }

    pub(crate) fn found(&mut self, kind: Kind, figure: Figure, unit: &'static str, done: Done) {
        self.findings.push(Finding { kind, figure, unit, count: 1, line: 0, done });
    }

    pub(crate) fn found_by(&mut self, kind: Kind, figure: Figure, unit: &'static str, done: Done, evidence: String) {
        self.found(kind, figure, unit, done);
        self.evidence.insert(kind, evidence);
    }
}

/// The diagnosis of a set of runs.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Check {
    /// By recorder, in the order in which the units appear.
    pub recorders: Vec<RecorderCheck>,
    /// By run.
    pub runs: Vec<RunCheck>,
    /// Runs among which perturbed ones cannot be recognised: too few others pass where they do, or they have no
    /// timetable in common.
    pub not_compared: usize,
    /// Locations of the runs that are used lie off the described track. None where they do not, or where no track was
    /// given.
    pub off_track: Option<OffTrack>,
    /// The described gradients look wrong. None where they do not, or where train and track were not given.
    pub gradients: Option<gradients::Doubt>,
    /// The described resistance looks as if it were in other units. None as above.
    pub resistance: Option<gradients::OtherUnits>,
}

/// Findings of single runs that [`Check::notes`] has.
const NOTED: usize = 8;

impl Check {
    /// Runs that are not to be used.
    pub fn refused(&self) -> impl Iterator<Item = &RunCheck> {
        self.runs.iter().filter(|run| run.refusal().is_some())
    }

    /// Runs of which nothing of their own was found, and that nothing outside the train held up.
    pub fn clean(&self) -> usize {
        self.runs.iter().filter(|run| run.findings.is_empty() && run.perturbations.is_empty()).count()
    }

    /// The perturbed runs with their reasons, as one line; none where there are none.
    pub fn perturbed_note(&self) -> Option<String> {
        let perturbed: Vec<&RunCheck> = self.runs.iter().filter(|run| !run.perturbations.is_empty()).collect();
        let first =
            perturbed.iter().take(NOTED).map(|run| format!("{}: {}", run.name, run.perturbed().unwrap_or_default()));
        let named: Vec<String> = first.collect();
        let more = perturbed.len() - named.len();
        let rest = if more > 0 { format!("; {more} more, all by `rundown check`") } else { String::new() };
        let (count, all) = (perturbed.len(), self.runs.len());
        (count > 0).then(|| format!("perturbed runs: {count} of {all}: {}{rest}", named.join("; ")))
    }

    /// A recorder has a finding of this kind.
    pub fn has(&self, kind: Kind) -> bool {
        self.recorders.iter().any(|recorder| recorder.has(kind))
    }

    /// The recorder of a unit.
    pub fn recorder(&self, unit: &str) -> Option<&RecorderCheck> {
        self.recorders.iter().find(|recorder| recorder.unit == unit)
    }

    /// What a person must know, a line each: whatever changed a reading, and what spoils results and was not changed.
    pub fn notes(&self) -> Vec<String> {
        let of_recorder = self.recorders.iter().flat_map(|recorder| {
            let name = if recorder.unit.is_empty() { "all runs" } else { &recorder.unit };
            recorder
                .findings
                .iter()
                .filter(|finding| finding.spoils())
                .map(move |finding| format!("{name}: {}", recorder.said(finding)))
        });
        let mut notes: Vec<String> = of_recorder.collect();
        let usable = self.runs.iter().filter(|run| run.is_usable());
        let of_run = usable.flat_map(|run| {
            run.findings
                .iter()
                .filter(|finding| finding.spoils())
                .map(|finding| format!("{}: {}", run.name, run.said(finding)))
        });
        let of_run: Vec<String> = of_run.collect();
        let more = of_run.len().saturating_sub(NOTED);
        notes.extend(of_run.into_iter().take(NOTED));
        if more > 0 {
            notes.push(format!("{more} more findings of single runs, all by `rundown check`"));
        }
        notes
    }
}
