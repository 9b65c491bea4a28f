//! A gradient that is described wrongly.

use crate::candidates::kit::*;
use rundown::model::effects::GradientError;

pub struct This;

impl Candidate for This {
    fn facts(&self) -> Facts {
        Facts {
            kind: Some(EffectKind::GradientError),
            what: "The described gradient is wrong in a section.",
            law: "gradient + delta, mean under the train; in the other direction with the other sign",
            parameters: "from_m, to_m; delta_permille, uphill in the `up` direction positive",
            shows: "a constant force in one section that changes its sign with the direction",
            confused: "tunnel_drag and bad track (`unknown` over location), where all runs go in one direction",
            separates: "runs in the other direction; another survey of the heights",
            nature: Nature { by_place: true, turns: true, ..Nature::default() },
            size: Some(("delta_permille", 0.0)),
            ..Facts::default()
        }
    }

    fn families(&self, _: &Offer<'_>) -> Vec<Family> {
        vec![Family::Section(Term { of: &This, shape: Shape::Section([0.0; 2]) })]
    }

    /// g/γ times the share of the train in the section, sign of the direction; coefficient m/m.
    fn columns(&self, shape: &Shape, context: &Context<'_>, rows: &[Row]) -> Vec<Vec<f64>> {
        let section = shape.section();
        let gravity = context.believed.train().gravity_n_per_kg();
        vec![along(context, rows, |line, _, p| gravity * line.direction.sign() * share(line, p.location_m, section))]
    }

    fn is_plausible(&self, size: &Size<'_>) -> bool {
        size.most() > size.context.config.search.least_in_section_n_per_kg
    }

    fn effect(&self, fitted: &Fitted, _: &Naming<'_>) -> Option<(Effect, Vec<Interval95>)> {
        let [from_m, to_m] = fitted.term.section()?;
        let (delta_permille, interval) = fitted.first("delta_permille", 1000.0);
        Some((GradientError { from_m, to_m, delta_permille }.into(), [fitted.edges(), vec![interval]].concat()))
    }

    fn sentence(&self, named: &Named, _: &Context<'_>) -> String {
        format!(
            "The gradient is described wrongly from {}: going up the line it climbs {} by {}",
            section(named),
            side(named.value("delta_permille") > 0.0),
            scaled(named, "delta_permille", named.value("delta_permille").signum(), "\u{2030}")
        )
    }

    fn axis<'a>(&self, named: &'a Named, _: &Context<'a>) -> Option<Axis<'a>> {
        let (from_m, to_m) = named.effect.section_m()?;
        let around = (0.5 * (to_m - from_m)).max(1000.0);
        let near = (from_m - around) / 1000.0..(to_m + around) / 1000.0;
        let at = move |row: &Row| Some(km(row)).filter(|at| near.contains(at));
        Some(Axis { by_direction: true, ..Axis::over("location of the train's front, km", at) })
    }

    fn hidden(&self, _: &str, hide: &mut Hide<'_>) -> Option<Value> {
        let [from_m, to_m] = hide.section_m;
        Some(json!({ "from_m": from_m, "to_m": to_m, "delta_permille": hide.sign * hide.of([2.0, 1.0, 0.5]) }))
    }
}
