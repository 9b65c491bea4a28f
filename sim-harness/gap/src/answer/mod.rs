//! The answer, and all that is made of it: `gap.json`, the page, the story on the screen, tables, model and frame.

mod acting;
pub mod files;
pub mod json;
pub mod notes;
pub mod report;
pub mod rivals;
pub mod story;
pub mod tables;
mod unseen;
pub mod whole;
