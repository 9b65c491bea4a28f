//! What the board says, live: frames from any source folded into one state, and the views of it.
//!
//! ```text
//! source -> message -> hub [Reader -> state] -> page (HTTP, server-sent events), terminal, text, JSON
//! ```
//!
//! | question | module |
//! |---|---|
//! | where do frames come from, and what if it fails? | `source` |
//! | a recording at the pace of the train | `player` |
//! | runs of the case study without a board | [`demo`] |
//! | who has what? one lock, many readers | `hub` |
//! | what is known now, of this run, of past runs? | `state` |
//! | what do frames say together that none says alone? | `judged` |
//! | what is drawn behind it: train and track | `setup` |
//! | train and track as described to the board | `sent` |
//! | the page in a browser | `page` |
//! | one line a frame | `text` |
//! | the view in a terminal | `terminal` |
//!
//! A display only listens: nothing is sent to the board but the flow control without which CAN does not work.

pub mod demo;
pub(crate) mod hub;
pub(crate) mod judged;
pub(crate) mod page;
pub(crate) mod player;
pub(crate) mod sent;
pub(crate) mod setup;
pub(crate) mod source;
pub(crate) mod state;
pub(crate) mod terminal;
#[cfg(test)]
mod tests;
pub(crate) mod text;
