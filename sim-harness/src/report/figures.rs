//! The figures: each a function from what the estimator said to a picture, inline SVG.
//!
//! | function | figure of the paper |
//! |---|---|
//! | [`motion`] | 3: speed, acceleration, effort, r0, r1, r2 |
//! | [`resistance_terms`] | 5: stacked terms of the running resistance |
//! | [`regimes`] | 6: the speed profile in the colours of the regimes |
//! | [`innovations`] | - |
//! | [`readings`] | - |
//! | [`resistance_curve`], [`vehicle_history`] | - (what Fig. 4 shows of all runs, with its uncertainty) |

use super::axis::Axis;
use super::chart::{Axes, Figure, Layer, Panel, Point, Stroke, range_of};
use super::colours;
use super::numbers::percent;
use super::resistance::{NINETY_FIVE, Resistance};
use super::{RunView, regime_shares};
use plotters::style::RGBColor;
use rundown::Real;
use rundown::estimate::{Cause, Estimate, Validity};
use rundown::regime::Regime;
use rundown::state::{self, Gaussian};
use rundown::train::Train;
use rundown::ukf::Reading;
use rundown::units::KmPerHour;
use std::ops::Range;

const KMH: Real = 3.6;
/// N/kg in the unit of the figures of resistance, 10⁻³ N/kg.
const MILLI: Real = 1e3;
/// Opacity of the ±1.96 sd band.
const BAND: Real = 0.18;
/// Opacity of the background where was learned.
const BACKGROUND: Real = 0.16;
/// Readings this much above the estimated speeds do not stretch the axis.
const SPEED_HEADROOM: Real = 1.3;

/// Fig. 3: speed, acceleration, effort and the three coefficients with their 95 % bands.
pub fn motion(run: &RunView, train: &Train) -> String {
    let axis = Axis::of_motion(run);
    let mut panels = vec![
        speed_panel(run, &axis),
        acceleration_panel(run, &axis, train),
        effort_panel(run, &axis, train),
    ];
    let davis = train.davis();
    let coefficients = [
        (state::R0, "r0, 10\u{207b}\u{b3} N/kg", 1e3, davis.r0),
        (
            state::R1,
            "r1, 10\u{207b}\u{2074} N/(kg m/s)",
            1e4,
            davis.r1,
        ),
        (
            state::R2,
            "r2, 10\u{207b}\u{2075} N/(kg (m/s)\u{b2})",
            1e5,
            davis.r2,
        ),
    ];
    for (component, label, per_unit, stated) in coefficients {
        panels.push(coefficient_panel(
            run, &axis, component, label, per_unit, stated,
        ));
    }
    figure(
        format!("Motion and resistance parameters of {}", run.name),
        "Measured and estimated speed, acceleration, applied effort and the three resistance \
         parameters with their 95 % bands, the manufacturer's values dashed",
        &axis,
        panels,
    )
}

/// Fig. 5: r0, r1 v, r2 v² stacked, and the resistance of the gradient in the same scale.
pub fn resistance_terms(run: &RunView) -> String {
    let axis = Axis::of_motion(run);
    let names = [
        ("constant r0", colours::CONSTANT_TERM),
        ("linear r1 v", colours::LINEAR_TERM),
        ("quadratic r2 v\u{b2}", colours::QUADRATIC_TERM),
    ];
    let mut layers = Vec::new();
    for (term, (legend, colour)) in names.into_iter().enumerate() {
        let points = axis.series(run.estimates, |_, estimate, x| {
            let speed_mps = estimate.belief.mean[state::SPEED];
            let terms = estimate.davis().terms_n_per_kg(speed_mps);
            let below: Real = terms.iter().take(term).sum();
            Some((x, MILLI * below, MILLI * (below + terms[term])))
        });
        layers.push(Layer::Band {
            legend: legend.to_owned(),
            colour,
            opacity: 1.0,
            points,
        });
    }
    layers.push(Layer::Line {
        legend: "track gradient (right axis)".to_owned(),
        colour: colours::GRADIENT,
        stroke: Stroke::Thin,
        points: axis.series(run.estimates, |_, estimate, x| {
            Some((x, MILLI * estimate.gradient_n_per_kg))
        }),
    });
    let panel = Panel {
        label: "resistance, 10\u{207b}\u{b3} N/kg".to_owned(),
        height: 480,
        y: None,
        axes: Axes::Both,
        layers,
        empty: nothing_estimated(run),
    };
    figure(
        format!("Terms of the running resistance of {}", run.name),
        "Stacked areas of the constant, linear and quadratic term, and a line of the resistance of the gradient",
        &axis,
        vec![panel],
    )
}

/// Fig. 6: the speed profile in the colours of the regimes, their shares in the legend.
pub fn regimes(run: &RunView) -> String {
    let axis = Axis::of_motion(run);
    let shares = regime_shares(run);
    let present = |regime: &Regime| (0..run.estimates.len()).any(|i| run.regime(i) == *regime);
    let legends = Regime::ALL.into_iter().filter(present).map(|regime| {
        let share = shares.map(|shares| shares[regime as usize]);
        let legend = format!("{regime} {}", percent(share));
        (legend, colours::of_regime(regime))
    });
    let mut layers = vec![Layer::Pieces {
        legends: legends.collect(),
        pieces: regime_pieces(run, &axis),
    }];
    if axis.is_location {
        let starts = [&run.features.final_coast, &run.features.final_brake];
        layers.push(Layer::Marks {
            legend: "start of final coast, brake".to_owned(),
            colour: RGBColor(255, 140, 0),
            points: starts
                .into_iter()
                .flatten()
                .map(|phase| (phase.start_location_m / 1000.0, KMH * phase.start_speed_mps))
                .collect(),
        });
        layers.retain(|layer| !matches!(layer, Layer::Marks { points, .. } if points.is_empty()));
    }
    let panel = Panel {
        label: "speed, km/h".to_owned(),
        height: 420,
        y: Some(speed_range(run)),
        axes: Axes::Left,
        layers,
        empty: nothing_estimated(run),
    };
    figure(
        format!("Driving regimes of {}", run.name),
        "The estimated speed, each stretch in the colour of its driving regime",
        &axis,
        vec![panel],
    )
}

/// Innovations of location and speed with their ±2 sd bands, over time.
pub fn innovations(run: &RunView) -> String {
    let axis = Axis::of_time(run);
    let panel = |reading: usize, label: &str, per_unit: Real| {
        let of = |estimate: &Estimate, wanted: fn(Reading) -> bool| {
            estimate
                .innovation
                .filter(|innovation| wanted(innovation.readings[reading]))
        };
        let there = |found| found != Reading::Missing;
        let band = axis.series(run.estimates, |_, estimate, x| {
            let variance = of(estimate, there)?.covariance[(reading, reading)];
            let width = 2.0 * per_unit * variance.max(0.0).sqrt();
            Some((x, -width, width))
        });
        let values = axis.series(run.estimates, |_, estimate, x| {
            Some((x, per_unit * of(estimate, there)?.value[reading]))
        });
        let gated = axis.series(run.estimates, |_, estimate, x| {
            let innovation = of(estimate, |found| found == Reading::Gated)?;
            Some((x, per_unit * innovation.value[reading]))
        });
        let gated: Vec<Point> = gated.into_iter().flatten().collect();
        let mut layers = vec![
            Layer::Band {
                legend: "\u{b1}2 standard deviations".to_owned(),
                colour: colours::MEASURED,
                opacity: BAND,
                points: band,
            },
            Layer::Line {
                legend: "measured less expected".to_owned(),
                colour: colours::ESTIMATED,
                stroke: Stroke::Thin,
                points: values,
            },
        ];
        if !gated.is_empty() {
            layers.push(Layer::Marks {
                legend: "outside the gate, not used".to_owned(),
                colour: colours::LIMIT,
                points: gated,
            });
        }
        Panel {
            label: label.to_owned(),
            height: 220,
            y: None,
            axes: Axes::Left,
            layers,
            empty: match nothing_estimated(run) {
                reason if run.estimates.is_empty() => reason,
                _ => "no innovation: nothing was expected of any sample of this run".to_owned(),
            },
        }
    };
    let panels = vec![
        panel(state::LOCATION, "innovation of the location, m", 1.0),
        panel(state::SPEED, "innovation of the speed, km/h", KMH),
    ];
    figure(
        format!("Innovations of {}", run.name),
        "Measured less expected location and speed with the band of two standard deviations",
        &axis,
        panels,
    )
}

/// Which samples were used, held or not to be trusted, why, and where was learned; over time.
pub fn readings(run: &RunView) -> String {
    const VALIDITIES: [(&str, RGBColor); 3] = [
        ("valid", colours::VALID),
        ("held", colours::HELD),
        ("invalid", colours::INVALID),
    ];
    const NO_GAP: Range<Real> = 0.12..0.5;
    let axis = Axis::of_time(run);
    let mut rows: Vec<(String, Vec<Layer>)> = Vec::new();
    let bars = |legend: &str, colour: RGBColor, spans: Vec<Range<Real>>| Layer::Bars {
        legend: legend.to_owned(),
        colour,
        spans,
        heights: NO_GAP,
    };
    let validity = VALIDITIES.map(|(word, colour)| {
        let spans = axis.spans(run.estimates, |_, e| e.validity.as_str() == word);
        bars(word, colour, spans)
    });
    rows.push(("estimate".to_owned(), validity.into()));
    let learned = axis.spans(run.estimates, |_, estimate| estimate.learning);
    rows.push((
        "resistance learned".to_owned(),
        vec![bars("learned", colours::LEARNING, learned)],
    ));
    let regimes = Regime::ALL.map(|regime| {
        let spans = axis.spans(run.estimates, |index, _| run.regime(index) == regime);
        bars("", colours::of_regime(regime), spans)
    });
    rows.push(("regime".to_owned(), regimes.into()));
    for cause in Cause::ALL {
        let spans = axis.spans(run.estimates, |_, e| e.validity.cause() == Some(cause));
        if !spans.is_empty() {
            let worst = run
                .estimates
                .iter()
                .any(|e| e.validity == Validity::Invalid(cause));
            let colour = if worst {
                colours::INVALID
            } else {
                colours::HELD
            };
            rows.push((
                cause.as_str().replace('_', " "),
                vec![bars("", colour, spans)],
            ));
        }
    }
    let count = rows.len();
    let mut layers = Vec::new();
    for (row, (name, bars)) in rows.into_iter().enumerate() {
        let foot = (count - row - 1) as Real;
        for bar in bars {
            layers.push(match bar {
                Layer::Bars {
                    legend,
                    colour,
                    spans,
                    heights,
                } => Layer::Bars {
                    legend: if spans.is_empty() {
                        String::new()
                    } else {
                        legend
                    },
                    colour,
                    spans,
                    heights: foot + heights.start..foot + heights.end,
                },
                other => other,
            });
        }
        layers.push(Layer::Word {
            text: name,
            y: foot + 0.52,
        });
    }
    let panel = Panel {
        label: "readings".to_owned(),
        height: 76 * count as u32,
        y: Some(0.0..count as Real),
        axes: Axes::Strip,
        layers,
        empty: nothing_estimated(run),
    };
    figure(
        format!("Use of the readings of {}", run.name),
        "Strips over time: whether the estimate is valid, where the resistance was learned, the regime, and each cause for which a reading was not used",
        &axis,
        vec![panel],
    )
}

/// r(v) of the vehicle with its 95 % band, the manufacturer's dashed; `learned_mps` are the speeds it was learned at.
pub fn resistance_curve(
    vehicle: Option<&Gaussian<3>>,
    train: &Train,
    learned_mps: Option<Range<Real>>,
) -> String {
    let fastest_kmh = learned_mps.as_ref().map_or(0.0, |speeds| KMH * speeds.end);
    let end_kmh = (20.0 * (fastest_kmh / 20.0).ceil() + 20.0).clamp(160.0, 400.0);
    let speeds_kmh: Vec<Real> = (0..=40).map(|i| end_kmh * Real::from(i) / 40.0).collect();
    let at =
        |kmh: Real| vehicle.and_then(|vehicle| Resistance::at(vehicle, KmPerHour(kmh).to_mps()));
    let band = speeds_kmh.iter().map(|&kmh| {
        let r = at(kmh)?;
        Some((kmh, MILLI * r.lower(), MILLI * r.upper()))
    });
    let mean = speeds_kmh
        .iter()
        .map(|&kmh| Some((kmh, MILLI * at(kmh)?.mean_n_per_kg)));
    let stated = speeds_kmh.iter().map(|&kmh| {
        let r = train.davis().resistance_n_per_kg(KmPerHour(kmh).to_mps());
        Some((kmh, MILLI * r))
    });
    let mut layers = Vec::new();
    if let Some(speeds) = learned_mps {
        layers.push(Layer::Spans {
            legend: "speeds it was learned at".to_owned(),
            colour: colours::LEARNING,
            opacity: BACKGROUND,
            spans: vec![KMH * speeds.start..KMH * speeds.end],
        });
    }
    layers.extend([
        Layer::Band {
            legend: "95 % band".to_owned(),
            colour: colours::ESTIMATED,
            opacity: BAND,
            points: band.collect(),
        },
        Layer::Line {
            legend: "estimated".to_owned(),
            colour: colours::ESTIMATED,
            stroke: Stroke::Solid,
            points: mean.collect(),
        },
        Layer::Line {
            legend: "manufacturer".to_owned(),
            colour: colours::MANUFACTURER,
            stroke: Stroke::Dashed,
            points: stated.collect(),
        },
    ]);
    let figure = Figure {
        title: "Running resistance over speed".to_owned(),
        description: "The estimated resistance with its 95 % band, the manufacturer's dashed"
            .to_owned(),
        x_label: "speed, km/h".to_owned(),
        x: 0.0..end_kmh,
        panels: vec![Panel {
            label: "r(v), 10\u{207b}\u{b3} N/kg".to_owned(),
            height: 520,
            y: None,
            axes: Axes::Left,
            layers,
            empty: "no estimate: no run has ended".to_owned(),
        }],
    };
    figure.to_svg()
}

/// Running resistance of the vehicle at one speed after each run, with its 95 % band.
pub fn vehicle_history(
    vehicle: &[(String, Gaussian<3>)],
    train: &Train,
    speed_kmh: Real,
) -> String {
    let speed_mps = KmPerHour(speed_kmh).to_mps();
    let runs: Vec<(Real, Option<Resistance>)> = vehicle
        .iter()
        .enumerate()
        .map(|(index, (_, belief))| ((index + 1) as Real, Resistance::at(belief, speed_mps)))
        .collect();
    let ends = 0.5..vehicle.len().max(1) as Real + 0.5;
    let stated = MILLI * train.davis().resistance_n_per_kg(speed_mps);
    let band = |(run, r): &(Real, Option<Resistance>)| {
        r.map(|r| (*run, MILLI * r.lower(), MILLI * r.upper()))
    };
    let mean = |(run, r): &(Real, Option<Resistance>)| r.map(|r| (*run, MILLI * r.mean_n_per_kg));
    let layers = vec![
        Layer::Band {
            legend: "95 % band".to_owned(),
            colour: colours::ESTIMATED,
            opacity: BAND,
            points: runs.iter().map(band).collect(),
        },
        Layer::Line {
            legend: "vehicle after the run".to_owned(),
            colour: colours::ESTIMATED,
            stroke: Stroke::Solid,
            points: runs.iter().map(mean).collect(),
        },
        Layer::Line {
            legend: "manufacturer".to_owned(),
            colour: colours::MANUFACTURER,
            stroke: Stroke::Dashed,
            points: vec![Some((ends.start, stated)), Some((ends.end, stated))],
        },
    ];
    let figure = Figure {
        title: format!("Resistance of the vehicle at {speed_kmh} km/h after each run"),
        description:
            "The estimate with its 95 % band after each run, the manufacturer's value dashed"
                .to_owned(),
        x_label: "run, in the order of the table".to_owned(),
        x: ends,
        panels: vec![Panel {
            label: format!("r({speed_kmh} km/h), 10\u{207b}\u{b3} N/kg"),
            height: 360,
            y: None,
            axes: Axes::Left,
            layers,
            empty: "no estimate: no run has ended".to_owned(),
        }],
    };
    figure.to_svg()
}

fn figure(title: String, description: &str, axis: &Axis, panels: Vec<Panel>) -> String {
    let figure = Figure {
        title,
        description: description.to_owned(),
        x_label: axis.label.to_owned(),
        x: axis.range.clone(),
        panels,
    };
    figure.to_svg()
}

fn nothing_estimated(run: &RunView) -> String {
    match run.estimates.is_empty() {
        true => "no estimate: the run has no usable sample".to_owned(),
        false => "no estimate: no value is finite".to_owned(),
    }
}

/// Not where nothing can be said: there the line is broken.
fn trusted(estimate: &Estimate) -> bool {
    !matches!(estimate.validity, Validity::Invalid(_))
}

fn speed_panel(run: &RunView, axis: &Axis) -> Panel {
    let measured = axis.series(run.estimates, |index, _, x| {
        Some((x, KMH * run.measurement(index)?.speed_mps?))
    });
    let estimated = axis.series(run.estimates, |_, estimate, x| {
        trusted(estimate).then_some((x, KMH * estimate.belief.mean[state::SPEED]))
    });
    Panel {
        label: "speed, km/h".to_owned(),
        height: 380,
        y: Some(speed_range(run)),
        axes: Axes::Left,
        layers: vec![
            line("estimated", colours::ESTIMATED, Stroke::Solid, estimated),
            line("measured", colours::MEASURED, Stroke::Dotted, measured),
        ],
        empty: nothing_estimated(run),
    }
}

/// From 0 to a little above everything; a wild reading does not flatten the run.
fn speed_range(run: &RunView) -> Range<Real> {
    let estimated_kmh = run
        .estimates
        .iter()
        .map(|e| KMH * e.belief.mean[state::SPEED]);
    let estimated_kmh = range_of(estimated_kmh).end.max(10.0);
    let measured_kmh = run
        .measurements
        .iter()
        .filter_map(|m| m.speed_mps)
        .map(|v| KMH * v);
    let measured_kmh = range_of(measured_kmh)
        .end
        .min(SPEED_HEADROOM * estimated_kmh);
    0.0..1.06 * estimated_kmh.max(measured_kmh)
}

fn acceleration_panel(run: &RunView, axis: &Axis, train: &Train) -> Panel {
    let values = axis.series(run.estimates, |_, estimate, x| {
        Some((x, estimate.acceleration_mps2?))
    });
    let limit = -train.description().max_brake_mps2;
    let ends = [axis.range.start, axis.range.end];
    Panel {
        label: "acceleration, m/s\u{b2}".to_owned(),
        height: 260,
        y: None,
        axes: Axes::Left,
        layers: vec![
            line(
                "mean since the sample before",
                colours::ESTIMATED,
                Stroke::Thin,
                values,
            ),
            line(
                "largest deceleration",
                colours::LIMIT,
                Stroke::Dashed,
                ends.map(|x| Some((x, limit))).to_vec(),
            ),
        ],
        empty: no_difference(run),
    }
}

fn effort_panel(run: &RunView, axis: &Axis, train: &Train) -> Panel {
    let values = axis.series(run.estimates, |_, estimate, x| {
        Some((x, estimate.effort_n_per_kg?))
    });
    let limit = axis.series(run.estimates, |_, estimate, x| {
        let speed_mps = estimate.belief.mean[state::SPEED];
        let is_speed = speed_mps.is_finite() && trusted(estimate);
        is_speed.then(|| (x, train.max_effort_n_per_kg(speed_mps.max(0.0))))
    });
    Panel {
        label: "effort, N/kg".to_owned(),
        height: 260,
        y: None,
        axes: Axes::Left,
        layers: vec![
            line(
                "mean since the sample before",
                colours::ESTIMATED,
                Stroke::Thin,
                values,
            ),
            line(
                "largest tractive effort",
                colours::LIMIT,
                Stroke::Dashed,
                limit,
            ),
        ],
        empty: no_difference(run),
    }
}

fn no_difference(run: &RunView) -> String {
    match run.estimates.len() {
        0 => nothing_estimated(run),
        1 => "no value: it takes two samples".to_owned(),
        _ => "no value: no two samples with a speed".to_owned(),
    }
}

fn coefficient_panel(
    run: &RunView,
    axis: &Axis,
    component: usize,
    label: &str,
    per_unit: Real,
    stated: Real,
) -> Panel {
    let mean = axis.series(run.estimates, |_, estimate, x| {
        Some((x, per_unit * estimate.belief.mean[component]))
    });
    let band = axis.series(run.estimates, |_, estimate, x| {
        let mean = per_unit * estimate.belief.mean[component];
        let width = NINETY_FIVE * per_unit * estimate.belief.sd(component);
        Some((x, mean - width, mean + width))
    });
    let ends = [axis.range.start, axis.range.end];
    let learned = axis.spans(run.estimates, |_, estimate| estimate.learning);
    let mut layers = Vec::new();
    if !learned.is_empty() {
        layers.push(Layer::Spans {
            legend: "learned".to_owned(),
            colour: colours::LEARNING,
            opacity: BACKGROUND,
            spans: learned,
        });
    }
    layers.extend([
        Layer::Band {
            legend: "95 % band".to_owned(),
            colour: colours::ESTIMATED,
            opacity: BAND,
            points: band,
        },
        line("estimated", colours::ESTIMATED, Stroke::Solid, mean),
        line(
            "manufacturer",
            colours::MANUFACTURER,
            Stroke::Dashed,
            ends.map(|x| Some((x, per_unit * stated))).to_vec(),
        ),
    ]);
    Panel {
        label: label.to_owned(),
        height: 220,
        y: None,
        axes: Axes::Left,
        layers,
        empty: nothing_estimated(run),
    }
}

fn line(legend: &str, colour: RGBColor, stroke: Stroke, points: Vec<Option<Point>>) -> Layer {
    Layer::Line {
        legend: legend.to_owned(),
        colour,
        stroke,
        points,
    }
}

/// A piece for each stretch of one regime; it begins where the one before it ended.
fn regime_pieces(run: &RunView, axis: &Axis) -> Vec<(RGBColor, Vec<Point>)> {
    let mut pieces: Vec<(Regime, Vec<Point>)> = Vec::new();
    let mut last: Option<Point> = None;
    for (index, estimate) in run.estimates.iter().enumerate() {
        let speed_kmh = KMH * estimate.belief.mean[state::SPEED];
        let place = axis.x[index].filter(|_| speed_kmh.is_finite() && trusted(estimate));
        let Some(x) = place else {
            last = None;
            continue;
        };
        let last_here = last.filter(|_| !axis.has_pause_before(index));
        let point = (x, speed_kmh);
        let regime = run.regime(index);
        match (pieces.last_mut(), last_here) {
            (Some((same, points)), Some(_)) if *same == regime => points.push(point),
            (_, last_here) => {
                pieces.push((regime, last_here.into_iter().chain([point]).collect()));
            }
        }
        last = Some(point);
    }
    let coloured = |(regime, points)| (colours::of_regime(regime), points);
    pieces.into_iter().map(coloured).collect()
}

#[cfg(test)]
mod tests {
    use super::super::example::{Example, train};
    use super::*;

    #[test]
    fn each_regime_has_its_colour_and_share() {
        let svg = regimes(&Example::run().view());
        for regime in Regime::ALL {
            let RGBColor(r, g, b) = colours::of_regime(regime);
            assert!(
                svg.contains(&format!("stroke=\"#{r:02X}{g:02X}{b:02X}\"")),
                "{regime}"
            );
        }
        assert!(svg.contains("coast 52.8\u{a0}%"));
        assert!(!regimes(&Example::first(5).view()).contains("coast"));
    }

    #[test]
    fn the_pieces_of_the_regimes_join() {
        let example = Example::run();
        let view = example.view();
        let pieces = regime_pieces(&view, &Axis::of_motion(&view));
        assert_eq!(pieces.len(), 6);
        for pair in pieces.windows(2) {
            assert_eq!(pair[0].1.last(), pair[1].1.first());
        }
    }

    #[test]
    fn a_missing_speed_is_a_gap_of_the_measured_line_only() {
        let example = Example::run();
        let view = example.view();
        let panel = speed_panel(&view, &Axis::of_motion(&view));
        let gaps = |layer: &Layer| match layer {
            Layer::Line { points, .. } => points.iter().filter(|point| point.is_none()).count(),
            _ => 0,
        };
        let gaps: Vec<usize> = panel.layers.iter().map(gaps).collect();
        assert_eq!(gaps, [0, 5]);
    }

    #[test]
    fn a_wild_reading_does_not_flatten_the_run() {
        let mut example = Example::run();
        let before = speed_range(&example.view());
        example.measurements[40].speed_mps = Some(500.0);
        let after = speed_range(&example.view());
        assert!(after.end < 1.31 * before.end);
    }

    #[test]
    fn a_run_without_innovations_says_so() {
        let mut example = Example::run();
        for estimate in &mut example.estimates {
            estimate.innovation = None;
        }
        assert!(innovations(&example.view()).contains("no innovation: nothing was expected"));
    }

    #[test]
    fn the_strip_names_each_cause() {
        let mut example = Example::run();
        assert!(!readings(&example.view()).contains("location jump"));
        example.estimates[50].validity = Validity::Invalid(Cause::LocationJump);
        let svg = readings(&example.view());
        assert!(svg.contains("location jump") && svg.contains("no speed"));
    }

    #[test]
    fn the_curve_shows_the_manufacturer_even_without_an_estimate() {
        let svg = resistance_curve(None, &train(), None);
        assert!(svg.contains("no estimate") && svg.contains("manufacturer"));
    }
}
