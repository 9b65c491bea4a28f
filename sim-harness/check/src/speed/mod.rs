//! How does a recorder show the speed, and what does that leave out?
//!
//! | question | module |
//! |---|---|
//! | does the speed stand still? | [`stuck`], `stuck_by_location` |
//! | does it end at a largest value? | `saturated` |
//! | does it read zero below a threshold? | `dead_zone` |
//! | does it repeat old values? | `held` |
//! | does it change in stairs? | `stairs` |
//! | do whole km/h come late? | `dead_band` |
//! | do speeds trail behind the train in a filter? | `trailing` |
//! | are they means over some seconds? | `smoothed` |
//! | are they counted in one unit and written in steps of another? | `written` |

pub(crate) mod dead_band;
pub(crate) mod dead_zone;
pub(crate) mod held;
pub(crate) mod saturated;
pub(crate) mod smoothed;
pub(crate) mod stairs;
pub mod stuck;
mod stuck_by_location;
pub(crate) mod trailing;
pub(crate) mod written;
