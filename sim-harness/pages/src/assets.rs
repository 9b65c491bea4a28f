//! Style and scripts of a page, from the binary: uPlot, which the display has too, and the few files around it.

/// The script of a page, whole. It asks for nothing else and takes part in no module.
pub const SCRIPT: &str = concat!(
    include_str!("../../assets/uplot/uPlot.iife.min.js"),
    include_str!("../../assets/pages/axes.js"),
    include_str!("../../assets/pages/layers.js"),
    include_str!("../../assets/pages/touch.js"),
    include_str!("../../assets/pages/figures.js"),
    include_str!("../../assets/pages/tables.js"),
    include_str!("../../assets/pages/page.js"),
);

/// The style of a page, whole.
pub(crate) const STYLE: &str =
    concat!(include_str!("../../assets/uplot/uPlot.min.css"), include_str!("../../assets/pages/pages.css"));
