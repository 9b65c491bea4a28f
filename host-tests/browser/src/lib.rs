//! What a test of pages needs: a board to cut the line of, the display, reports, a browser.
#![forbid(unsafe_code)]

pub mod board;
#[cfg(feature = "browser")]
pub mod browser;
pub mod display;
#[cfg(feature = "browser")]
pub mod reports;
