//! One kit of pages for all reports: shell, tables, figures as SVG, numbers as words.
//!
//! A page is one HTML file that asks for no address. Its figures stand in it as SVG; with scripts they are live, by
//! uPlot.
#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod assets;
pub mod chart;
pub mod colours;
pub mod numbers;
pub mod run_pages;
pub mod shell;
