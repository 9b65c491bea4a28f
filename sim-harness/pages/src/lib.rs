//! One kit of pages for all reports: shell, tables, figures as SVG, numbers as words.
//!
//! A page is one HTML file that needs nothing else: no script, no style sheet, no font, no address.
#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod chart;
pub mod colours;
pub mod numbers;
pub mod shell;
