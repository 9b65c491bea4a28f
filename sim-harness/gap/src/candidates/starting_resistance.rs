//! Extra resistance after standing.

use crate::candidates::kit::*;
use rundown::model::effects::StartingResistance;

/// Time of standing after which 63 % of it are back, min. Judgement: few runs stand for times that differ enough to show it.
const STANDING_MIN: f64 = 10.0;

pub struct This;

fn law(decay_kmh: f64, amplitude: f64) -> StartingResistance {
    StartingResistance { amplitude, decay_kmh, standing_min: STANDING_MIN, cold_per_deg_c: 0.0 }
}

impl Candidate for This {
    fn facts(&self) -> Facts {
        Facts {
            kind: Some(EffectKind::StartingResistance),
            what: "Bearings that stood turn hard at first.",
            law: "resistance + amplitude x exp(-v / decay) x (1 - exp(-time stood / standing)), larger in the cold",
            parameters: "amplitude in N/kg, decay_kmh, standing_min, cold_per_degC; the last two are taken as usual, for logs hardly show them",
            shows: "more resistance in the first seconds after each long stop, at low speed, and none soon after",
            confused: "warm_up, which lasts for minutes; an effort that still rises when it is read",
            separates: "logs of a sample a second; long and short stops; starts on cold days",
            // More than the train's whole resistance, at such speeds.
            nature: Nature { needs_effort: true, may_be_large: true, ..Nature::default() },
            prior: Prior {
                least: 4e-3,
                most: 0.3,
                shapes: &[6.0, 12.0, 20.0, 32.0],
                source: "Least in a row, N/kg, most at the start, N/kg; decay, km/h. Judgement, no source checked yet: 0.025 to 0.25 N/kg; what is over below 6 km/h no interval of 10 s shows.",
            },
            size: Some(("amplitude", 0.0)),
        }
    }

    fn families(&self, offer: &Offer<'_>) -> Vec<Family> {
        offer.measured.then(|| offer.numbers(&This, 3.6)).into_iter().collect()
    }

    /// exp(-v/v0) after standing, v0 in m/s.
    fn columns(&self, shape: &Shape, context: &Context<'_>, rows: &[Row]) -> Vec<Vec<f64>> {
        let law = law(3.6 * shape.number(), 1.0);
        vec![along(context, rows, |_, row, p| law.resistance_n_per_kg(p.speed_mps, row.interval.stood_s, None))]
    }

    fn is_plausible(&self, size: &Size<'_>) -> bool {
        (0.0..size.largest()).contains(&size.beta[0]) && size.most() > size.least()
    }

    /// 4 to 50 km/h.
    fn dial(&self, _: &Shape) -> Option<Dial> {
        Some(Dial { step: 0.25, range: ((4.0_f64 / 3.6).ln(), (50.0_f64 / 3.6).ln()), exponential: true })
    }

    fn effect(&self, fitted: &Fitted, _: &Naming<'_>) -> Option<(Effect, Vec<Interval95>)> {
        let (amplitude, decay_kmh, intervals) = fitted.with_number("amplitude", "decay_kmh", 3.6);
        Some((law(decay_kmh, amplitude).into(), intervals))
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
        Some(json!({ "amplitude": amplitude, "decay_kmh": decay_kmh, "standing_min": STANDING_MIN }))
    }
}
