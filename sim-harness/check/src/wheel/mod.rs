//! What do the wheels do, by whose turns the speed is read?
//!
//! | question | module |
//! |---|---|
//! | does the wheel change? | `change` |
//! | does it creep while it powers? | `creep` |
//! | does it slip or slide for some seconds? | `slips` |
//! | does it slide in each brake? | `braking` |

pub(crate) mod braking;
pub(crate) mod change;
pub(crate) mod creep;
pub(crate) mod slips;
