//! A unit, a driver or a day that differs from the others, or that cannot be compared, in words and as JSON.

use crate::data::runs::Run;
use rundown_check::figure::{Figure, HALF_95};
use rundown_files::effect_file::date_of;
use rundown_pages::numbers::counted;
use serde_json::{Value, json};

/// By what runs are grouped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// The unit that made them.
    Unit,
    /// Who drove.
    Driver,
    /// The day of departure.
    Day,
}

/// Of what runs have more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum More {
    /// Resistance in coasting, a share of the believed.
    Resistance,
    /// Effort for the same motion, a share of it.
    Effort,
}

impl More {
    /// As in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Resistance => "resistance",
            Self::Effort => "effort",
        }
    }
}

/// Runs that have more resistance than the others, or need more effort; or less.
#[derive(Clone, Debug, PartialEq)]
pub struct Standout {
    /// Of what.
    pub more: More,
    /// What the runs share.
    pub level: Level,
    /// Name of the unit or driver, or the date.
    pub of: String,
    /// How many runs it has.
    pub runs: usize,
    /// What it has beyond the other runs, as a share.
    pub share: Figure,
    /// The same beyond the description, as a share of it; beside the effects of places. Of efforts beside the gain of
    /// the column that all have.
    pub described: f64,
    /// The other one, where there are only two, with what that has beyond the description.
    pub other: Option<(String, f64)>,
    /// Probability of such a difference, or a larger one, somewhere among these levels, if none differs.
    pub p_value: f64,
}

impl Level {
    pub(super) const ALL: [Self; 3] = [Self::Unit, Self::Driver, Self::Day];
    /// What is the same from day to day.
    pub(super) const LASTING: [Self; 2] = [Self::Unit, Self::Driver];

    /// As in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Unit => "unit",
            Self::Driver => "driver",
            Self::Day => "day",
        }
    }

    /// Of a run; empty: not known.
    pub(super) fn of(self, run: &Run) -> String {
        match self {
            Self::Unit => run.recorded.unit.clone(),
            Self::Driver => run.recorded.driver.clone(),
            Self::Day => run.day.and_then(date_of).unwrap_or_default(),
        }
    }
}

impl Standout {
    /// For a person.
    pub fn sentence(&self) -> String {
        let Self { level, of, share: Figure { value, sd }, other, p_value, .. } = self;
        let name = level.name();
        let runs = counted(self.runs, "run", "runs");
        let share = format!("{:.1} \u{b1} {:.1} % {}", 100.0 * value.abs(), 100.0 * HALF_95 * sd, comparative(*value));
        let than = other.as_ref().map_or("the others".to_owned(), |(other, _)| format!("those of {name} {other}"));
        match self.more {
            More::Effort => format!(
                "The {runs} of {name} {of} need {share} effort for the same motion than {than} (p-value {p_value:.3}): {}.",
                effort_meaning(*value)
            ),
            More::Resistance => format!(
                "The {runs} of {name} {of} have {share} resistance in coasting than {than}, beside the effects above (p-value {p_value:.3}). {}.",
                self.against_description()
            ),
        }
    }

    fn against_description(&self) -> String {
        let Self { level, of, share: Figure { value, .. }, described, other, .. } = self;
        let against = match other {
            Some((other, others)) => {
                format!("{of} has {}, {other} {}", amount(*described), amount(*others))
            }
            None => format!("they have {}", amount(*described)),
        };
        let mass = if *level == Level::Unit {
            format!(
                "; the air drag of a {} unit is as much {} for its mass",
                if *value < 0.0 { "heavier" } else { "lighter" },
                comparative(*value)
            )
        } else {
            String::new()
        };
        format!("Against the description {against}: no law of its own is known for that{mass}")
    }

    /// As in `gap.json`.
    pub fn json(&self) -> Value {
        json!({
            "by": self.level.name(),
            "of": self.of,
            "more": self.more.name(),
            "runs": self.runs,
            "share": self.share.value,
            "share_sd": self.share.sd,
            "described": self.described,
            "other": self.other.as_ref().map(|(of, described)| json!({"of": of, "described": described})),
            "p_value": self.p_value,
        })
    }
}

/// What another effort of a unit means.
fn effort_meaning(share: f64) -> String {
    let (heavier, high) = if share > 0.0 { ("heavier", "high") } else { ("lighter", "low") };
    format!("it is {heavier} by about as much, or its effort column reads too {high}; these data cannot tell which")
}

fn comparative(share: f64) -> &'static str {
    if share < 0.0 { "less" } else { "more" }
}

fn amount(share: f64) -> String {
    format!("{:.1} % {}", 100.0 * share.abs(), comparative(share))
}

/// Several units, drivers or days that cannot be compared with each other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NotCompared {
    /// What they are.
    pub level: Level,
    /// Why.
    pub why: String,
}

impl NotCompared {
    /// For a person.
    pub fn sentence(&self) -> String {
        format!("Whether one {} has more resistance than the others is not known: {}.", self.level.name(), self.why)
    }

    /// As in `gap.json`.
    pub fn json(&self) -> Value {
        json!({"by": self.level.name(), "why": self.why})
    }
}
