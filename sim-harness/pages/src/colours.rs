//! The colours of the report, the same in every figure. On white, whatever the reader's screen prefers.

use plotters::style::RGBColor;
use rundown::tick::regime::Regime;

/// Estimated values (Fig. 3: red).
pub const ESTIMATED: RGBColor = RGBColor(200, 16, 46);
/// Measured values (Fig. 3: blue, dotted).
pub const MEASURED: RGBColor = RGBColor(0, 84, 190);
/// The manufacturer's values (Fig. 3: blue, dashed).
pub const MANUFACTURER: RGBColor = RGBColor(0, 84, 190);
/// What was true, where it is known.
pub const TRUTH: RGBColor = RGBColor(15, 125, 55);
/// Limits of the train, dashed.
pub const LIMIT: RGBColor = RGBColor(70, 70, 70);
/// Where the resistance was learned: a background.
pub const LEARNING: RGBColor = RGBColor(120, 185, 90);

/// r0 of Fig. 5, dark blue.
pub const CONSTANT_TERM: RGBColor = RGBColor(23, 43, 118);
/// r1 v of Fig. 5, lilac.
pub const LINEAR_TERM: RGBColor = RGBColor(178, 143, 206);
/// r2 v² of Fig. 5, light blue.
pub const QUADRATIC_TERM: RGBColor = RGBColor(150, 205, 240);
/// Resistance of the gradient in Fig. 5, magenta.
pub const GRADIENT: RGBColor = RGBColor(200, 0, 140);

/// Readings that were used.
pub const VALID: RGBColor = RGBColor(196, 224, 196);
/// A reading was missing or not believed, its value carried on.
pub const HELD: RGBColor = RGBColor(240, 160, 20);
/// Not to be trusted.
pub const INVALID: RGBColor = RGBColor(200, 16, 46);

/// Colour of a regime (Fig. 6; grey for the standstill, which the paper does not have).
pub const fn of_regime(regime: Regime) -> RGBColor {
    match regime {
        Regime::Standstill => RGBColor(150, 150, 150),
        Regime::Traction => RGBColor(0, 0, 0),
        Regime::Cruise => RGBColor(20, 90, 210),
        Regime::Coast => RGBColor(140, 30, 160),
        Regime::Brake => RGBColor(210, 20, 40),
    }
}

/// `#RRGGBB`, for the page.
pub fn css(RGBColor(red, green, blue): RGBColor) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}
