//! Extra resistance after standing.

use crate::candidates::kit::*;
use rundown::model::effects::StartingResistance;

/// Times of standing after which 63 % of it may be back, tried first, min. Judgement: stops of a minute bring all of it
/// or a tenth.
const STANDING_MIN: [f64; 4] = [0.3, 1.0, 3.0, HIDDEN_STANDING_MIN];
/// What the bench hides.
const HIDDEN_STANDING_MIN: f64 = 10.0;

pub struct This;

/// Of a shape, whose decay is in m/s.
fn law(shape: &Shape, amplitude: f64) -> StartingResistance {
    let [decay_kmh, standing_min] = [3.6 * shape.number(), shape.second_number()];
    StartingResistance { amplitude, decay_kmh, standing_min, cold_per_deg_c: 0.0 }
}

impl Candidate for This {
    fn facts(&self) -> Facts {
        Facts {
            kind: Some(EffectKind::StartingResistance),
            what: "Bearings that stood turn hard at first.",
            law: "resistance + amplitude x exp(-v / decay) x (1 - exp(-time stood / standing)), larger in the cold",
            parameters: "amplitude in N/kg, decay_kmh, standing_min, cold_per_degC; the last is taken for none, for logs hardly show it",
            shows: "more resistance in the first seconds after each long stop, at low speed, and none soon after",
            confounded: "warm_up, which lasts for minutes; an effort that still rises when it is read",
            separates: "logs of a sample a second; long and short stops; starts on cold days",
            // More than the train's whole resistance, at such speeds.
            nature: Nature { needs_effort: true, may_be_large: true, ..Nature::default() },
            prior: Prior {
                least: 4e-3,
                most: 0.3,
                shapes: &[4.5, 7.0, 12.0, 20.0, 32.0],
                source: "Least in a row, N/kg, most at the start, N/kg; decay, km/h. Judgement: 0.025 to 0.25 N/kg; what is over below 5 km/h no interval shows.",
            },
            size: Some(("amplitude", 0.0)),
        }
    }

    fn families(&self, offer: &Offer<'_>) -> Vec<Family> {
        let decays = offer.first_numbers(&This).into_iter().map(|kmh| kmh / 3.6);
        let of = |decay| STANDING_MIN.map(|standing| Term { of: &This, shape: Shape::Numbers(decay, standing) });
        offer.measured.then(|| Family::Shapes(decays.flat_map(of).collect())).into_iter().collect()
    }

    /// exp(-v/v0) after standing, v0 in m/s.
    fn columns(&self, shape: &Shape, context: &Context<'_>, rows: &[Row]) -> Vec<Vec<f64>> {
        let law = law(shape, 1.0);
        vec![along(context, rows, |_, row, p| law.resistance_n_per_kg(p.speed_mps, row.interval.stood_s, None))]
    }

    fn is_plausible(&self, size: &Size<'_>) -> bool {
        (0.0..size.largest()).contains(&size.beta[0]) && size.most() > size.least()
    }

    /// 4 to 50 km/h; 12 s to half an hour.
    fn dial(&self, _: &Shape) -> Option<Dial> {
        let range = ((4.0_f64 / 3.6).ln(), (50.0_f64 / 3.6).ln());
        Some(Dial { step: 0.25, range, exponential: true, second_range: (0.2_f64.ln(), 30.0_f64.ln()) })
    }

    fn effect(&self, fitted: &Fitted, _: &Naming<'_>) -> Option<(Effect, Vec<Interval95>)> {
        let (amplitude, _, mut intervals) = fitted.with_number("amplitude", "decay_kmh", 3.6);
        let standing = fitted.shape.and_then(|limits| limits.second);
        intervals.extend(standing.map(|(low, high)| ("standing_min", low, high)));
        Some((law(&fitted.term.shape, amplitude).into(), intervals))
    }

    fn separated_from(&self, other: EffectKind) -> Option<&'static str> {
        (other == EffectKind::WarmUp).then_some("logs of a sample a second")
    }

    fn sentence(&self, named: &Named, _: &Context<'_>) -> String {
        format!(
            "After standing the train is hard to start: {} more, 37\u{a0}% of it left at {}",
            with_unit(named, "amplitude"),
            with_unit(named, "decay_kmh")
        )
    }

    fn axis<'a>(&self, _: &'a Named, _: &Context<'a>) -> Option<Axis<'a>> {
        // Beyond three times its decay nothing of it is left.
        Some(Axis::over("speed below 60 km/h", |row| Some(kmh(row)).filter(|kmh| *kmh < 60.0)))
    }

    fn hidden(&self, _: &str, hide: &mut Hide<'_>) -> Option<Value> {
        let (amplitude, decay_kmh) = (hide.of([0.12, 0.06, 0.03]), hide.rng.random_range(12.0..25.0));
        Some(json!({ "amplitude": amplitude, "decay_kmh": decay_kmh, "standing_min": HIDDEN_STANDING_MIN }))
    }
}
