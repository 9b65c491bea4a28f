//! The view in a terminal, for a computer without a browser.
//!
//! In: a [`Hub`]. Out: a screen, drawn again with each change; `q`, Esc or Ctrl-C leaves it.
//!
//! A narrow screen, as the usual one of 80 x 24, has no room for both charts above four tables that can be read: past
//! runs take the place of r(v), whose values stand in their table.

use super::hub::{Connection, Hub, View};
use super::setup::Setup;
use super::state::{Point, State};
use super::text::{HALF_95, KMH, learned_words, of_coast_ahead};
use ratatui::crossterm::event::{self, Event, KeyCode, KeyEventKind, KeyModifiers};
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Modifier, Style, Stylize};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Axis, Block, Chart, Dataset, GraphType, LegendPosition, Paragraph};
use ratatui::{Frame, symbols::Marker};
use rundown_files::statistics::extremes;
use rundown_pages::numbers::counted;
use rundown_wire::{Learned, Phase, Regime, Statistic, Validity, Value};
use std::{io, time::Duration};

/// How often keys are looked at; changes are drawn as often at most.
const PAUSE: Duration = Duration::from_millis(100);
/// Dots of a curve across a chart.
const DOTS: f64 = 240.0;
const NARROW: u16 = 116;
/// Speeds of the ATB-EG steps, as the features frame has them.
pub const BRAKE_STEPS: [&str; 5] = ["> 130", "130-80", "80-60", "60-40", "< 40"];

pub fn run(hub: &Hub) -> io::Result<()> {
    let mut terminal = ratatui::try_init()?;
    let done = loop {
        let drawn = hub.view(|view| terminal.draw(|frame| draw(frame, &view)).map(drop));
        if let Err(error) = drawn {
            break Err(error);
        }
        match left() {
            Ok(false) => {}
            Ok(true) => break Ok(()),
            Err(error) => break Err(error),
        }
    };
    ratatui::try_restore()?;
    done
}

fn left() -> io::Result<bool> {
    if !event::poll(PAUSE)? {
        return Ok(false);
    }
    let Event::Key(key) = event::read()? else {
        return Ok(false);
    };
    let control_c = key.code == KeyCode::Char('c') && key.modifiers.contains(KeyModifiers::CONTROL);
    let leaves = matches!(key.code, KeyCode::Char('q') | KeyCode::Esc) || control_c;
    Ok(leaves && key.kind == KeyEventKind::Press)
}

const fn colour(regime: Regime) -> Color {
    match regime {
        Regime::Standstill => Color::Gray,
        Regime::Traction => Color::Green,
        Regime::Cruise => Color::LightBlue,
        Regime::Coast => Color::LightMagenta,
        Regime::Brake => Color::LightRed,
    }
}

/// Draws everything. Missing values are dashes of the same place.
pub fn draw(frame: &mut Frame<'_>, view: &View<'_>) {
    let narrow = frame.area().width < NARROW;
    let [head, charts, tables, foot] =
        Layout::vertical([Constraint::Length(4), Constraint::Min(8), Constraint::Length(9), Constraint::Length(1)])
            .areas(frame.area());
    let [speed, beside] = Layout::horizontal([Constraint::Percentage(55), Constraint::Percentage(45)]).areas(charts);
    // As wide as their longest lines.
    let [parameters, limits, brake, right] = Layout::horizontal([
        Constraint::Length(30),
        Constraint::Length(30),
        Constraint::Length(20),
        Constraint::Fill(1),
    ])
    .areas(tables);
    frame.render_widget(header(view), head);
    draw_speed(frame, speed, view.state, view.setup);
    let past = if narrow {
        beside
    } else {
        draw_resistance(frame, beside, view.state, view.setup);
        right
    };
    frame.render_widget(of_parameters(view.state), parameters);
    frame.render_widget(of_limits(view.state), limits);
    frame.render_widget(of_brake(view.state), brake);
    frame.render_widget(of_past(view.state), past);
    frame.render_widget(of_link(view), foot);
}

fn titled<'a>(title: &'a str, lines: Vec<Line<'a>>) -> Paragraph<'a> {
    Paragraph::new(lines).block(Block::bordered().title(title))
}

fn header<'a>(view: &View<'_>) -> Paragraph<'a> {
    let estimate = view.state.now.estimate.as_ref();
    let speed = estimate.map_or_else(
        || "   -   km/h".to_owned(),
        |e| {
            let Value { value, sd } = e.speed_mps;
            format!("{:.1} \u{b1}{:.1} km/h", value * KMH, HALF_95 * sd * KMH)
        },
    );
    let place = estimate.map_or_else(
        || "   -   km".to_owned(),
        |e| format!("{:.3} km \u{b1}{:.0} m", e.location_m.value / 1000.0, HALF_95 * e.location_m.sd),
    );
    let bold = Style::new().add_modifier(Modifier::BOLD);
    let regime = estimate.map_or(Span::raw(" no run yet "), |e| {
        let word = format!(" {} ", e.regime.as_str().to_uppercase());
        Span::styled(word, bold.fg(Color::Black).bg(colour(e.regime)))
    });
    let validity = estimate.map_or(Span::raw("-"), |e| match e.validity {
        Validity::Valid => Span::raw("valid"),
        Validity::Held(cause) => format!("held: {}", cause.as_str()).yellow(),
        Validity::Invalid(cause) => format!("invalid: {}", cause.as_str()).light_red(),
    });
    let old = if view.link.silent { " OLD VALUES ".black().on_yellow() } else { Span::raw("") };
    let line = Line::from(vec![
        Span::styled(format!(" {speed}   "), bold),
        regime,
        Span::styled(format!("   {place}   "), bold),
        validity,
        Span::raw("   "),
        old,
    ]);
    let ahead = view.state.now.coast_ahead.as_ref();
    let now_s = estimate.map(|estimate| estimate.time_s);
    let ahead = ahead.map_or_else(|| "-".to_owned(), |ahead| of_coast_ahead(ahead, now_s));
    let coasting = Line::from(format!(" coast: {ahead}"));
    titled(" Rundown (q: quit) ", vec![line, coasting])
}

type PlottedCurve = Vec<(f64, f64)>;

/// The curve of each regime, as dots: a line would join what is apart.
fn curves(points: &[Point], step_m: f64) -> [PlottedCurve; 5] {
    let mut curves: [PlottedCurve; 5] = Default::default();
    for pair in points.windows(2) {
        let [from, to] = pair else { continue };
        if to.gap {
            continue;
        }
        let place = |point: &Point| (f64::from(point.location_m) / 1000.0, f64::from(point.speed_mps * KMH));
        let ((x0, y0), (x1, y1)) = (place(from), place(to));
        let dots = ((x1 - x0).abs() * 1000.0 / step_m).ceil().clamp(1.0, DOTS);
        let curve = &mut curves[to.regime as usize];
        for dot in 0..=dots as u32 {
            let share = f64::from(dot) / dots;
            curve.push((x0 + share * (x1 - x0), y0 + share * (y1 - y0)));
        }
    }
    curves
}

fn axis<'a>(title: &'a str, [from, to]: [f64; 2], decimals: usize) -> Axis<'a> {
    let labels = (0..=4).map(|n| format!("{:.decimals$}", from + (to - from) * f64::from(n) / 4.0));
    Axis::default().title(title).bounds([from, to]).labels(labels).style(Style::new().gray())
}

fn draw_speed(frame: &mut Frame<'_>, area: Rect, state: &State, setup: &Setup) {
    let (low, high) = extremes(state.points.iter().map(|point| f64::from(point.location_m) / 1000.0));
    // In steps of 5 km, so that the scale stays for a while; a location that is a little below its step is noise.
    let seen =
        if low <= high { [(low / 5.0 + 0.02).floor() * 5.0, ((high / 5.0).floor() + 1.0) * 5.0] } else { [0.0, 5.0] };
    let bounds = setup.track.as_ref().map_or(seen, |track| [0.0, track.length_m / 1000.0]);
    let curves = curves(&state.points, (bounds[1] - bounds[0]) * 1000.0 / DOTS);
    let sets = Regime::ALL.iter().zip(&curves).filter(|(_, curve)| !curve.is_empty()).map(|(regime, curve)| {
        Dataset::default()
            .name(regime.as_str())
            .marker(Marker::Braille)
            .graph_type(GraphType::Scatter)
            .style(Style::new().fg(colour(*regime)))
            .data(curve)
    });
    let chart = Chart::new(sets.collect())
        .block(Block::bordered().title(" speed over location "))
        .legend_position(Some(LegendPosition::Bottom))
        .x_axis(axis("km", bounds, 1))
        .y_axis(axis("km/h", [0.0, 160.0], 0));
    frame.render_widget(chart, area);
}

fn draw_resistance(frame: &mut Frame<'_>, area: Rect, state: &State, setup: &Setup) {
    let speeds = || (0..=60).map(|n| f64::from(n) * 160.0 / 60.0);
    let manufacturer: PlottedCurve =
        speeds().filter_map(|kmh| Some((kmh, 1000.0 * setup.manufacturer(kmh / 3.6)?))).collect();
    let mut mean = PlottedCurve::new();
    let mut band = PlottedCurve::new();
    if let Some(parameters) = &state.now.parameters {
        for kmh in speeds() {
            let at = parameters.at((kmh / 3.6) as f32);
            let (value, half) = (1000.0 * f64::from(at.value), 1000.0 * f64::from(HALF_95 * at.sd));
            mean.push((kmh, value));
            band.extend([(kmh, value - half), (kmh, value + half)]);
        }
    }
    let most = band.iter().chain(&manufacturer).map(|(_, r)| *r).fold(40.0, f64::max);
    let set = |name: &'static str, colour, kind| {
        Dataset::default().name(name).marker(Marker::Braille).graph_type(kind).style(Style::new().fg(colour))
    };
    let mut sets = vec![
        set("95 %", Color::DarkGray, GraphType::Scatter).data(&band),
        set("estimate", Color::LightYellow, GraphType::Line).data(&mean),
    ];
    if !manufacturer.is_empty() {
        sets.push(set("manufacturer", Color::LightCyan, GraphType::Line).data(&manufacturer));
    }
    let chart = Chart::new(sets)
        .block(Block::bordered().title(format!(" r(v), {} ", learned(state))))
        .hidden_legend_constraints((Constraint::Percentage(80), Constraint::Percentage(80)))
        .legend_position(Some(LegendPosition::TopLeft))
        .x_axis(axis("km/h", [0.0, 160.0], 0))
        .y_axis(axis("mN/kg", [0.0, (most / 20.0).ceil() * 20.0], 0));
    frame.render_widget(chart, area);
}

fn learned(state: &State) -> &'static str {
    state.now.parameters.map_or("no value yet", |parameters| learned_words(parameters.learned))
}

fn of_parameters<'a>(state: &State) -> Paragraph<'a> {
    let parameters = state.now.parameters.as_ref();
    let row = |name: &str, value: Option<Value>| {
        Line::from(value.map_or_else(
            || format!("{name:5} -"),
            |value| format!("{name:5} {:>10.3e} \u{b1}{:.1e}", value.value, HALF_95 * value.sd),
        ))
    };
    let at = |kmh: f32| {
        let value = parameters.map(|parameters| parameters.at(kmh / KMH));
        Line::from(value.map_or_else(
            || format!("r({kmh:>3}) -"),
            |value| format!("r({kmh:>3}) {:.5} \u{b1}{:.5} N/kg", value.value, HALF_95 * value.sd),
        ))
    };
    let words = match parameters.map(|parameters| parameters.learned) {
        Some(Learned::Learned) => learned(state).green(),
        Some(Learned::OutOfBounds | Learned::PredictsWorse) => learned(state).light_red(),
        _ => learned(state).yellow(),
    };
    let lines = vec![
        words.into(),
        row("r0", parameters.map(|p| p.r0)),
        row("r1", parameters.map(|p| p.r1)),
        row("r2", parameters.map(|p| p.r2)),
        at(60.0),
        at(100.0),
        row("gain", parameters.and_then(|p| p.gain)),
    ];
    titled(" r(v) of this run, SI per kg ", lines)
}

fn of_limits<'a>(state: &State) -> Paragraph<'a> {
    let effort = state.now.effort.as_ref();
    let features = state.now.features.as_ref();
    let row = |name: &str, value: Option<f32>, decimals: usize, unit: &str| {
        Line::from(
            value.map_or_else(|| format!("{name:14} -"), |value| format!("{name:14} {value:>8.decimals$} {unit}")),
        )
    };
    let lines = vec![
        row("effort", effort.and_then(|e| e.effort_n_per_kg), 4, "N/kg"),
        row("most traction", effort.map(|e| e.max_traction_n_per_kg), 4, "N/kg"),
        row("most brake", effort.map(|e| -e.max_brake_n_per_kg), 4, "N/kg"),
        row("gradient", effort.map(|e| e.gradient_n_per_kg), 4, "N/kg"),
        row("max power", features.and_then(|f| f.max_power_w_per_kg), 2, "W/kg at 50-90 km/h"),
        row(
            "mean power",
            features.filter(|f| f.power_w_per_kg.count > 0).map(|f| f.power_w_per_kg.mean),
            2,
            "W/kg at 50-130 km/h",
        ),
        row("cruise speed", features.and_then(|f| f.cruise_speed_median_mps).map(|v| v * KMH), 1, "km/h"),
    ];
    titled(" effort and limits ", lines)
}

fn of_brake<'a>(state: &State) -> Paragraph<'a> {
    let features = state.now.features.as_ref();
    let rate = |(step, of): (&str, Option<Statistic>)| {
        Line::from(match of {
            Some(rate) if rate.count > 0 => {
                format!("{step:7} {:.2} s.d. {:.2}", rate.mean, rate.sd)
            }
            _ => format!("{step:7} -"),
        })
    };
    let rates = (0..BRAKE_STEPS.len()).map(|n| features.and_then(|f| f.brake_rate_mps2.get(n).copied()));
    let lines = BRAKE_STEPS.iter().copied().zip(rates).map(rate).collect();
    titled(" brake, m/s2 ", lines)
}

fn of_past<'a>(state: &State) -> Paragraph<'a> {
    let seconds =
        |phase: Option<&Phase>| phase.map_or_else(|| "   -".to_owned(), |phase| format!("{:4.0}", phase.duration_s));
    let mut lines = vec![Line::from(" run  coast s  brake s  learned s").gray()];
    for run in state.past.iter().rev().take(6) {
        let features = run.features.as_ref();
        lines.push(Line::from(format!(
            "{:4}  {:>7}  {:>7}  {:9.0}",
            run.summary.run,
            seconds(features.and_then(|f| f.final_coast.as_ref())),
            seconds(features.and_then(|f| f.final_brake.as_ref())),
            run.summary.learned_s
        )));
    }
    titled(" past runs ", lines)
}

fn of_link<'a>(view: &View<'_>) -> Paragraph<'a> {
    let link = &view.link;
    let state = match &link.connection {
        Connection::Opening => "opening".yellow(),
        Connection::Open if link.silent => "no frames".yellow(),
        Connection::Open => "open".green(),
        Connection::Lost(error) => format!("lost: {error}").light_red(),
        Connection::Ended => "end of the recording".into(),
    };
    let age = link.age_s.map_or_else(|| "-".to_owned(), |age| format!("{age:.0} s ago"));
    let counts = format!(
        "  {age}  {}, {} lost, {} damaged, {} out of order, {} unknown, {}; {}{}",
        counted(link.tally.frames as usize, "frame", "frames"),
        link.tally.lost,
        link.tally.damaged,
        link.tally.out_of_order,
        link.tally.unknown,
        counted(link.reconnects as usize, "reconnect", "reconnects"),
        link.source,
        view.state.now.versions.map_or_else(String::new, |versions| format!("; {versions}"))
    );
    Paragraph::new(Line::from(vec![" ".into(), state, counts.into()]))
}
