//! What is wrong with the locations?
//!
//! | question | module |
//! |---|---|
//! | did the odometer wrap, begin again? | [`odometer`] |
//! | which locations stand for none? | [`placeholders`] |
//! | are single locations wild? | `spikes` |
//! | does the location stand still? | `stuck` |
//! | does a straight line bridge what was not received? | `bridged` |
//! | did the train go there and back in one log? | `two_directions` |
//! | does the location drift between corrections? | `drifting` |
//! | do the locations grow as the described stops have it? | [`line_scale`] |
//! | do all runs count their locations from the same place? | [`chainage`] |

pub(crate) mod bridged;
pub mod chainage;
pub(crate) mod drifting;
pub mod line_scale;
pub mod odometer;
pub mod placeholders;
pub(crate) mod spikes;
pub(crate) mod stuck;
pub(crate) mod two_directions;
