//! What a test of the page needs: a board to cut the line of, the display, a browser.
#![forbid(unsafe_code)]

pub mod board;
#[cfg(feature = "browser")]
pub mod browser;
pub mod display;
