//! A speed on a wrong scale.

use crate::candidates::kit::*;

pub struct This;

impl Candidate for This {
    fn facts(&self) -> Facts {
        Facts {
            kind: Some(EffectKind::SpeedScale),
            what: "The speed shows too much or too little: a worn wheel, a wrong diameter; or the locations go by another measure.",
            law: "measured speed = factor x true speed",
            parameters: "measured_over_true",
            shows: "the location grows slower (or faster) than the speed says, everywhere alike; or, where the odometer gives the location too, a run's distances between its stops are longer (or shorter) than those of the other runs: then the run is named",
            confounded: "a line whose chainage is stretched, in the logs of one vehicle alone; a speed and a location that both come from a receiver cannot show a wheel at all",
            separates: "a satellite receiver beside the odometer; another vehicle on the same line; stops with known chainage",
            nature: Nature { shows_in: ShowsIn::Readings, ..Nature::default() },
            size: Some(("measured_over_true", 1.0)),
            ..Facts::default()
        }
    }

    fn beside(&self, naming: &Naming<'_>) -> Option<(Named, Odds)> {
        // Found and put right by the diagnosis of the logs, where it is beyond doubt and matters: reported
        // nevertheless.
        Some((Named::wheel(&naming.kinematics.scale?, naming.context.config), Vec::new()))
    }

    fn separated_from(&self, other: EffectKind) -> Option<&'static str> {
        (other == EffectKind::LocationLag).then_some("a location that does not come from the wheel")
    }

    fn sentence(&self, named: &Named, _: &Context<'_>) -> String {
        format!(
            "The speed is read on a wrong scale: measured over true speed is {}",
            with_unit(named, "measured_over_true")
        )
    }

    fn hidden(&self, _: &str, hide: &mut Hide<'_>) -> Option<Value> {
        Some(json!({ "measured_over_true": 1.0 + hide.sign * hide.of([0.03, 0.015, 0.007]) }))
    }
}
