//! Many variants in several modes: the frame of most experiments.

use super::answer::{Answer, Arm, ArmRow, VariantAxis};
use super::look::Driven;
use super::metrics::Metric;
use super::plan::Plan;
use super::variant::Variant;
use crate::study::Refused;
use rayon::prelude::*;
use rundown::estimator::config::{Config, Mode};
use rundown::tick::paper::Difference;
use rundown_pages::colours;

/// An arm that is an estimator: what makes it of a variant's configuration.
#[derive(Clone, Copy)]
pub struct Estimated {
    pub arm: Arm,
    pub config: fn(Config) -> Config,
}

impl Estimated {
    pub const PAPER: Self = Self { arm: Arm::of(Mode::Paper), config: |config| Config { mode: Mode::Paper, ..config } };
    pub const GATED: Self = Self { arm: Arm::of(Mode::Gated), config: |config| Config { mode: Mode::Gated, ..config } };
    pub const MEASURED: Self =
        Self { arm: Arm::of(Mode::Measured), config: |config| Config { mode: Mode::Measured, ..config } };
    /// The paper's mode with the other reading of the effort.
    pub const BACKWARD: Self = Self {
        arm: Arm { name: "paper, backward", colour: colours::CONSTANT_TERM },
        config: |mut config| {
            config.mode = Mode::Paper;
            config.paper.difference = Difference::Backward;
            config
        },
    };
}

/// Variants with values of one's own.
#[derive(Clone, Copy)]
pub struct Own {
    /// Name of the axis on which the values stand, with their unit.
    pub axis: &'static str,
    pub variant: fn(f64) -> Result<Variant, Refused>,
}

pub struct Sweep {
    pub variants: Vec<Variant>,
    pub axis: VariantAxis,
    /// None where the variants are kinds.
    pub own: Option<Own>,
    pub arms: &'static [Estimated],
    /// A panel of the picture for each.
    pub metrics: Vec<Metric>,
}

impl Sweep {
    /// The same at these values; none where the variants are kinds.
    pub fn with_values(self, values: &[f64]) -> Result<Option<Self>, Refused> {
        let Some(Own { axis, variant }) = self.own else {
            return Ok(None);
        };
        let variants = values.iter().map(|value| variant(*value)).collect::<Result<_, _>>()?;
        Ok(Some(Self { variants, axis: VariantAxis::Values(axis), ..self }))
    }

    pub fn answer(&self, plan: &Plan<'_>) -> Result<Answer, Refused> {
        let metrics = &self.metrics;
        let rows = over_sets(plan, &self.variants, |variant, driven| {
            let mut rows = Vec::new();
            for Estimated { arm, config } in self.arms {
                let look = driven.look(variant, config(variant.config))?;
                rows.push((*arm, metrics.iter().map(|metric| (metric.seen)(&look)).collect()));
            }
            if metrics.iter().any(|metric| metric.truth.is_some()) {
                rows.push((Arm::TRUTH, metrics.iter().map(|metric| metric.truth?(driven)).collect()));
            }
            Ok(rows)
        })?;
        let columns = metrics.iter().map(|metric| (metric.name, metric.label)).collect();
        Ok(Answer::new(plan, self.axis, columns, rows))
    }
}

/// Drives every set of every variant once and asks for its rows: an arm, and a value for each column.
pub fn over_sets(
    plan: &Plan<'_>,
    variants: &[Variant],
    rows: impl Fn(&Variant, &Driven) -> Result<Vec<(Arm, Vec<Option<f64>>)>, Refused> + Sync,
) -> Result<Vec<ArmRow>, Refused> {
    let all = variants.len() * plan.sets;
    let one = |index: usize| {
        let (variant, set) = (&variants[index / plan.sets], index % plan.sets);
        let driven = Driven::new(variant, plan.runs, plan.seed, set)?;
        let found = rows(variant, &driven)?;
        (plan.done)(all);
        let row = |(arm, values)| ArmRow { variant: variant.name.clone(), x: variant.x, arm, set, values };
        Ok(found.into_iter().map(row).collect::<Vec<ArmRow>>())
    };
    let found = (0..all).into_par_iter().map(one).collect::<Result<Vec<_>, Refused>>()?;
    Ok(found.concat())
}

#[cfg(test)]
mod tests {
    use super::super::metrics;
    use super::*;

    fn sweep(fields: [&str; 2]) -> Answer {
        let variants = fields.into_iter().zip([0.0, 1.0]);
        let variants = variants.map(|(fields, x)| Variant::parse(fields, x, fields).unwrap()).collect();
        let metrics = vec![metrics::RESISTANCE, metrics::REGIMES, metrics::LARGEST_POWER];
        let sweep = Sweep {
            variants,
            axis: VariantAxis::Values("x"),
            own: None,
            arms: &[Estimated::PAPER, Estimated::GATED],
            metrics,
        };
        let plan = Plan { name: "a", question: "?", sets: 2, runs: 4, seed: 11, done: &|_| () };
        sweep.answer(&plan).unwrap()
    }

    #[test]
    fn a_variant_that_changes_nothing_gives_the_same_numbers() {
        let answer = sweep(["", "name = \"the same\""]);
        let of = |x: f64| answer.rows.iter().filter(move |row| row.x == x).map(|row| (row.arm, row.set, &row.values));
        assert!(of(0.0).eq(of(1.0)));
        assert_eq!(of(0.0).count(), 2 * 3);
    }

    #[test]
    fn the_gated_mode_is_nearer_to_another_vehicle_than_the_paper_s() {
        let answer = sweep(["", "[train]\ntrue_davis_over_described = [0.8, 0.8, 0.8]"]);
        let error =
            |arm: &str| answer.moments("[train]\ntrue_davis_over_described = [0.8, 0.8, 0.8]", arm, 0).mean().unwrap();
        assert!(error("paper") > 15.0 && error("gated") < 8.0, "{} {}", error("paper"), error("gated"));
    }
}
