//! Does the noise fit? Quantiles of the standardised residuals beside those of the normal distribution.

use crate::answer::whole::Answer;
use rundown_pages::chart::{Drawing, Figure, Layer, Panel, Stroke};
use rundown_pages::colours;

/// Picture and caption; none where too few rows count.
pub(super) fn whiteness(answer: &Answer) -> Option<(Drawing, String)> {
    let white = answer.found.whiteness.as_ref()?;
    let points = |of: &dyn Fn(f64, f64) -> f64| -> Vec<Option<(f64, f64)>> {
        white.quantiles.iter().map(|(expected, seen)| Some((*expected, of(*expected, *seen)))).collect()
    };
    let normal = Layer::line("normal distribution", colours::LIMIT, Stroke::Dashed, points(&|expected, _| expected));
    let found = Layer::line("residuals", colours::ESTIMATED, Stroke::Solid, points(&|_, seen| seen));
    let figure = Figure::new(
        "Does the noise fit?",
        "Quantiles of the standardised residuals over those of a normal distribution",
        "standard deviations of a normal distribution",
        -3.0..3.0,
        [Panel::new("residuals, in their standard deviations", 300, vec![normal, found], "too few intervals")],
    );
    Some((
        figure.into(),
        format!(
            "What model and noise leave of each interval, sorted, beside a normal distribution: a steeper line is noise that was taken for too small, tails that bend away are outliers. In figures: {}.",
            white.sentence()
        ),
    ))
}
