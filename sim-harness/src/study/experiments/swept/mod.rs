//! Experiments that are a sweep: what is varied, in which modes, what is looked at.

pub(super) mod recording;
pub(super) mod resistance;
pub(super) mod traction;
pub(super) mod trains;

use super::variant::Variant;
use crate::study::Refused;

/// Variants of the case study: name, place on the axis, fields of a scenario file.
fn variants(of: &[(&str, f64, &str)]) -> Result<Vec<Variant>, Refused> {
    of.iter().map(|(name, x, fields)| Variant::parse(*name, *x, fields)).collect()
}
