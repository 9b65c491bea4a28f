//! Experiments that are a sweep: what is varied, in which modes, what is looked at.

pub(super) mod recording;
pub(super) mod resistance;
pub(super) mod traction;
pub(super) mod trains;

use super::variant::Variant;
use crate::study::Refused;

/// Kinds of the case study, side by side: name, fields of a scenario file.
fn variants(of: &[(&str, &str)]) -> Result<Vec<Variant>, Refused> {
    of.iter().zip(1..).map(|((name, fields), place)| Variant::parse(*name, f64::from(place), fields)).collect()
}
