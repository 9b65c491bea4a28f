//! What is tuned: α, β, κ, initial deviations, R and Q, as one point in a space where a step of 1 is a factor of 10.

use rundown::estimator::config::{Config, Mode};
use rundown::filter::ukf::{Spread, SpreadError};
use rundown::tick::paper::PaperConfig;

pub const COUNT: usize = 11;

pub type Place = [f64; COUNT];

#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    pub name: &'static str,
    pub unit: &'static str,
    /// Least and largest value of the search, in its own unit.
    pub range: [f64; 2],
    scale: Scale,
}

/// How a value becomes a coordinate.
#[derive(Clone, Copy, Debug)]
enum Scale {
    Decades,
    Linear,
    /// log10 of 5 + κ, which must be above zero.
    Kappa,
}

const fn decades(name: &'static str, unit: &'static str, range: [f64; 2]) -> Parameter {
    Parameter { name, unit, range, scale: Scale::Decades }
}

/// All parameters, in the order of Table 1, then R and Q.
pub const PARAMETERS: [Parameter; COUNT] = [
    decades("alpha", "", [1e-4, 2.0]),
    Parameter { name: "beta", unit: "", range: [0.0, 6.0], scale: Scale::Linear },
    Parameter { name: "kappa", unit: "", range: [-4.9, 20.0], scale: Scale::Kappa },
    decades("initial_location_sd", "m", [1e-2, 1e3]),
    decades("initial_speed_sd", "km/h", [1e-4, 1e2]),
    decades("initial_r0_sd", "N/kg", [1e-9, 1e-2]),
    decades("initial_r1_sd", "N/(kg m/s)", [1e-11, 1e-3]),
    decades("initial_r2_sd", "N/(kg (m/s)\u{b2})", [1e-12, 1e-4]),
    decades("location_sd", "m", [0.1, 1e3]),
    decades("speed_sd", "km/h", [0.05, 50.0]),
    decades("acceleration_noise", "m/s\u{b2}", [LEAST_NOISE, 1.0]),
];

/// Acceleration noise that stands for the paper's none, m/s²: 10 s of it are a thousandth of a km/h.
pub const LEAST_NOISE: f64 = 3e-5;

impl Parameter {
    pub fn coordinate(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Decades => value.max(f64::MIN_POSITIVE).log10(),
            Scale::Linear => value,
            Scale::Kappa => (value + 5.0).log10(),
        }
    }

    pub fn value(&self, coordinate: f64) -> f64 {
        match self.scale {
            Scale::Decades => 10_f64.powf(coordinate),
            Scale::Linear => coordinate,
            Scale::Kappa => 10_f64.powf(coordinate) - 5.0,
        }
    }

    pub fn ends(&self) -> [f64; 2] {
        self.range.map(|value| self.coordinate(value))
    }
}

pub fn place(paper: &PaperConfig) -> Place {
    let [alpha, beta, kappa] = paper.spread.parameters();
    let [r0, r1, r2] = paper.initial_davis_sd;
    let values = [
        alpha,
        beta,
        kappa,
        paper.initial_location_sd_m,
        paper.initial_speed_sd_kmh,
        r0,
        r1,
        r2,
        paper.location_sd_m,
        paper.speed_sd_kmh,
        paper.acceleration_noise_mps2.max(LEAST_NOISE),
    ];
    std::array::from_fn(|i| PARAMETERS[i].coordinate(values[i]))
}

/// The nearest place within the ranges.
pub fn within(place: &Place) -> Place {
    std::array::from_fn(|i| {
        let [least, most] = PARAMETERS[i].ends();
        place[i].clamp(least, most)
    })
}

/// The values at a place, each within its range.
pub fn values(place: &Place) -> Place {
    let place = within(place);
    std::array::from_fn(|i| PARAMETERS[i].value(place[i]))
}

/// The configuration at a place: the paper's mode, all else as it was.
pub fn config(base: &Config, place: &Place) -> Result<Config, SpreadError> {
    let [alpha, beta, kappa, s, v, r0, r1, r2, location_sd_m, speed_sd_kmh, noise] = values(place);
    let has_noise = noise > 1.001 * LEAST_NOISE;
    Ok(Config {
        mode: Mode::Paper,
        paper: PaperConfig {
            spread: Spread::try_new(alpha, beta, kappa)?,
            initial_location_sd_m: s,
            initial_speed_sd_kmh: v,
            initial_davis_sd: [r0, r1, r2],
            location_sd_m,
            speed_sd_kmh,
            acceleration_noise_mps2: if has_noise { noise } else { 0.0 },
            // Eq. (12)-(15) as printed leave Q out of the gain; with Q the sigma points are redrawn.
            reuse_points: !has_noise && base.paper.reuse_points,
            ..base.paper
        },
        ..*base
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_filter_is_a_place_and_comes_back() {
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-12 * b.abs();
        let mut base = Config::default();
        for spread in [Spread::PAPER, Spread::new(0.5, 3.0, 1.0)] {
            base.paper.spread = spread;
            let found = config(&base, &place(&base.paper)).unwrap().paper;
            assert!(near(found.initial_davis_sd[1], 1e-8) && near(found.speed_sd_kmh, 1.0));
            assert_eq!(found.acceleration_noise_mps2, 0.0);
            assert_eq!(found.reuse_points, base.paper.reuse_points);
            let pairs = found.spread.parameters().into_iter().zip(spread.parameters());
            assert!(pairs.into_iter().all(|(a, b)| near(a, b)), "{:?} for {spread:?}", found.spread);
        }
    }

    #[test]
    fn every_place_of_the_search_is_a_configuration() {
        for end in [0, 1] {
            let place = std::array::from_fn(|i| PARAMETERS[i].ends()[end] + [-9.0, 9.0][end]);
            let config = config(&Config::default(), &place).unwrap();
            config.check().unwrap();
            assert_eq!(config.paper.reuse_points, end == 0, "with Q the sigma points are redrawn");
        }
    }
}
