//! Effects on traction and brake: caps of what the train can do, and what arrives of a demanded brake.

use super::Effect;
use crate::motion::Motion;

/// What is left of the train's described limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capability {
    /// Largest effort over the described one: what the driver's share is a share of.
    pub scale: f64,
    /// The effort is not above this share of the largest.
    pub effort_cap: f64,
    /// The power is not above this share of the largest.
    pub power_cap: f64,
}

/// What the effects leave of the train's limits at a place and speed.
pub fn capability(effects: &[Effect], at: Motion) -> Capability {
    let mut left = Capability { scale: 1.0, effort_cap: f64::INFINITY, power_cap: f64::INFINITY };
    for effect in effects {
        match *effect {
            Effect::TractionScale { factor } => left.scale *= factor,
            Effect::PowerLimitSection { from_m, to_m, factor, .. } if (from_m..=to_m).contains(&at.location_m) => {
                left.power_cap = left.power_cap.min(factor);
            }
            Effect::LowAdhesion { factor, below_kmh, .. } if 3.6 * at.speed_mps < below_kmh => {
                left.effort_cap = left.effort_cap.min(factor);
            }
            _ => {}
        }
    }
    left
}

/// What arrives of a demanded brake, 0 to 1.
pub fn brake_share(effects: &[Effect], speed_mps: f64) -> f64 {
    let share = |effect: &Effect| match *effect {
        Effect::BrakeFade { fade_at_140, from_kmh } => {
            let beyond = (3.6 * speed_mps - from_kmh).max(0.0) / (140.0 - from_kmh);
            (1.0 - fade_at_140 * beyond).max(0.05)
        }
        _ => 1.0,
    };
    effects.iter().map(share).product()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Affected;

    fn at(location_m: f64, kmh: f64) -> Motion {
        Motion { location_m, speed_mps: kmh / 3.6 }
    }

    #[test]
    fn caps_hold_where_they_are_said_to() {
        let effects = [
            Effect::TractionScale { factor: 1.1 },
            Effect::PowerLimitSection { from_m: 0.0, to_m: 3_000.0, factor: 0.8, runs: Affected::Share(1.0) },
            Effect::LowAdhesion { factor: 0.5, below_kmh: 30.0, runs: Affected::Share(1.0) },
        ];
        let slow = capability(&effects, at(2_999.0, 29.0));
        assert_eq!(slow, Capability { scale: 1.1, effort_cap: 0.5, power_cap: 0.8 });
        let fast = capability(&effects, at(3_001.0, 31.0));
        assert_eq!((fast.effort_cap, fast.power_cap), (f64::INFINITY, f64::INFINITY));
    }

    #[test]
    fn brake_fade_grows_with_speed() {
        let fade = [Effect::BrakeFade { fade_at_140: 0.3, from_kmh: 60.0 }];
        for (kmh, share) in [(50.0, 1.0), (60.0, 1.0), (100.0, 0.85), (140.0, 0.7)] {
            assert!((brake_share(&fade, kmh / 3.6) - share).abs() < 1e-12);
        }
    }
}
