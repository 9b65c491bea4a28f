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
            confounded: "tunnel_drag and bad track (`unknown` over location), where all runs go in one direction",
            separates: "runs in the other direction; another survey of the heights",
            nature: Nature { by_place: true, turns: true, ..Nature::default() },
            size: Some(("delta_permille", 0.0)),
            ..Facts::default()
        }
    }

    /// Of a line without described gradients all may be one slope, too, which no section is long enough for.
    fn families(&self, offer: &Offer<'_>) -> Vec<Family> {
        let of = |section: [f64; 2]| Term { of: &This, shape: Shape::Section(section) };
        let Context { surroundings, config, .. } = offer.context;
        let beyond_m = config.interval.beyond_m + offer.context.believed.train().length_m();
        let whole = surroundings.is_level.then(|| of([-beyond_m, surroundings.length_m + beyond_m]));
        let whole = whole.map(|term| Family::Shapes(vec![term]));
        [Family::Section(of([0.0; 2]))].into_iter().chain(whole).collect()
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::believed::{Surroundings, tests::on_a_level_line};
    use crate::noise::{calibrate::Calibrated, whitening::Noise};
    use crate::search::fits::Search;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;
    use rundown::model::direction::Direction;

    /// What is found of 30 runs up and down a line of 60 km that is described as level, where a force acts against the
    /// `up` direction by a law of the speed, N/kg.
    fn found(level: &Context<'_>, law: impl Fn(f64) -> f64) -> Vec<Term> {
        let context = &Context {
            surroundings: &Surroundings { is_level: true, length_m: 60e3, ..Surroundings::default() },
            ..*level
        };
        let mut rng = ChaCha8Rng::seed_from_u64(8);
        let row = |i: usize| {
            let direction = [Direction::Up, Direction::Down][i / 60 % 2];
            let speed_mps = rng.random_range(15.0..40.0);
            let mut row = Row::coasting(direction, 900.0 * (i % 60) as f64, speed_mps);
            row.interval.run = i / 60;
            row.residual_n_per_kg = direction.sign() * law(speed_mps) + 0.005 * rng.sample::<f64, _>(StandardNormal);
            row
        };
        let rows: Vec<Row> = (0..30 * 60).map(row).collect();
        let noise = Noise { acceleration_mps2: 0.005, ..Noise::default() };
        let calibrated = Calibrated::even(noise, rows.len());
        Search::new(context, &rows, &calibrated, false).select()
    }

    #[test]
    fn a_slope_of_a_whole_line_that_is_described_as_level_is_a_gradient_and_no_wind() {
        on_a_level_line(30, |level| {
            let (gravity, r2) = (level.believed.train().gravity_n_per_kg(), level.believed.train().davis().r2);
            let slope = found(level, |_| 3e-3 * gravity);
            assert!(matches!(&slope[..], [one] if one.is(EffectKind::GradientError)), "{slope:?}");
            let wind = found(level, |speed_mps| 2.0 * r2 * 4.0 * speed_mps);
            assert!(matches!(&wind[..], [one] if one.is(EffectKind::SteadyWind)), "{wind:?}");
        });
    }
}
