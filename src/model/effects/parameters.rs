//! Parameters of a kind of effect: their check, and their way into a frame and back.

use super::error::FrameError;
use crate::Real;
use crate::model::bounds::Range;
use heapless::Vec;
use rundown_wire::{self as wire, EFFECT_VALUES};

/// What the catalogue says of the parameters of a kind. Only [`Unknown`] has it by hand.
pub(super) trait Parameters: Sized {
    /// The section where it acts, m.
    fn section_m(&self) -> Option<(Real, Real)>;

    /// Where each has to lie; of none where they are checked by hand.
    fn ranges(&self) -> &'static [Range];

    /// As a frame has them.
    fn values(&self) -> Vec<Real, EFFECT_VALUES>;

    /// From a frame, not checked.
    fn from_frame(frame: &wire::Effect) -> Result<Self, FrameError>;
}
