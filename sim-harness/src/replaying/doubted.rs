//! What the configuration is made to doubt by what a diagnosis found: speeds and efforts in steps, descriptions of
//! train and line.

use super::{Opened, ReplayError, Summary};
use rundown::estimator::Estimator;
use rundown::estimator::config::Mode;
use rundown_check::Check;
use rundown_check::finding::Kind;
use rundown_check::gradients::Coasts;
use rundown_files::recording::Recording;

/// Speed at which the doubt of the efforts is said, km/h.
const DOUBTED_KMH: f64 = 60.0;
/// The largest step that a configuration may have, km/h.
const MOST_STEP_KMH: f64 = 20.0;

impl Opened {
    /// Speeds in larger steps than described are read as such.
    pub(super) fn doubt_speeds(&mut self, found: &Check) -> Result<Option<String>, ReplayError> {
        let steps = found.recorders.iter().filter_map(|recorder| recorder.speed_step_kmh);
        let quantum_kmh = &mut self.config.sensor.speed_quantum_kmh;
        let (described_kmh, step_kmh) = (*quantum_kmh, steps.fold(0.0, f64::max).min(MOST_STEP_KMH));
        if step_kmh <= described_kmh {
            return Ok(None);
        }
        *quantum_kmh = step_kmh;
        self.reconfigured()?;
        Ok(Some(format!(
            "speeds have steps of {step_kmh:.3} km/h and are doubted by as much; for `sensor.speed_quantum_kmh` the \
             configuration has {described_kmh} km/h"
        )))
    }

    /// Efforts in steps are doubted by a whole one: what rounding takes of one stays while a speed is held, and half a
    /// step as white noise would be sure too soon. Nothing says whether they are cut off: a note.
    pub(super) fn doubt_efforts(&mut self, found: &Check) -> Result<Option<String>, ReplayError> {
        let steps = found.recorders.iter().filter_map(|recorder| recorder.effort_step_n_per_kg);
        let noise = &mut self.config.effort_reading.noise_n_per_kg;
        let step = steps.fold(0.0, f64::max);
        if step <= *noise {
            return Ok(None);
        }
        *noise = step;
        self.reconfigured()?;
        let half = 0.5 * step;
        let percent = 100.0 * half / self.core_train.davis().resistance_n_per_kg(DOUBTED_KMH / 3.6);
        let is_learned_from = self.config.mode == Mode::Measured && !found.has(Kind::EffortSteps);
        Ok(is_learned_from.then(|| {
            format!(
                "efforts have steps of {step:.4} N/kg and are doubted by as much; should they be cut off, not rounded, r comes \
                 out about {half:.4} N/kg wrong, {percent:.0} % at {DOUBTED_KMH} km/h"
            )
        }))
    }

    /// Says where the described resistance looks as if in other units. Where the described gradients look wrong, the
    /// estimator doubts them by as much as they are off: what is learned in spite of them has an interval that says so.
    pub(super) fn doubt_descriptions(
        &mut self,
        recordings: &[Recording],
        summary: &mut Summary,
    ) -> Result<(), ReplayError> {
        let mut coasts = Coasts::default();
        coasts.add(recordings, &self.core_train);
        let said_permille = self.track.said_sd_permille(&self.config);
        let answer = coasts.answer(&self.core_train, self.estimator.track(), said_permille);
        let has_effects = !self.train.effect.is_empty() || !self.track.effect.is_empty();
        let answer = if has_effects { answer.beside_effects() } else { answer };
        let doubt = &mut self.config.track_doubt;
        answer.raise(doubt);
        let sd = doubt.gradient_sd_permille;
        summary.notes.extend(answer.resistance.map(|units| units.to_string()));
        summary.notes.extend(answer.resists.map(|found| found.to_string()));
        self.left_open.at_places_n_per_kg = answer.resists.map_or(0.0, |found| found.sd_n_per_kg);
        let taken = format!("until they are put right they are taken to be off by {sd:.1} permille");
        summary.notes.extend(answer.gradients.map(|doubt| format!("{doubt}; {taken}")));
        (summary.gradient_doubt, summary.small_errors) = (answer.gradients, answer.small);
        if sd == said_permille.unwrap_or(0.0) { Ok(()) } else { self.reconfigured() }
    }

    /// The estimator takes what the configuration has now.
    fn reconfigured(&mut self) -> Result<(), ReplayError> {
        let (track, effects) = (self.estimator.track().clone(), self.estimator.effects().clone());
        self.estimator = Estimator::try_new(self.config, self.core_train, track)?.with_effects(effects);
        Ok(())
    }
}
