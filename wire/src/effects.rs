//! What the numbers of an effect mean: the table of `WIRE.md` in words for a display.

use crate::downlink::Effect;

/// One kind of effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EffectKind {
    /// Its name in files and tables.
    pub name: &'static str,
    /// Name and unit of each value.
    pub values: &'static [(&'static str, &'static str)],
}

const fn kind(name: &'static str, values: &'static [(&'static str, &'static str)]) -> EffectKind {
    EffectKind { name, values }
}

/// Kind 1 stands first.
const KINDS: [EffectKind; 19] = [
    kind("tunnel_drag", &[("k", "N/kg per (m/s)²")]),
    kind("curve_resistance", &[("times Roeckl's formula", "")]),
    kind("gradient_error", &[("true minus described", "‰")]),
    kind("steady_wind", &[("headwind in the up direction", "m/s")]),
    kind("run_wind", &[("s.d. between runs", "m/s")]),
    kind("mass_error", &[("true over described mass, minus 1", "")]),
    kind("dragging_brake", &[("drag", "N/kg")]),
    kind("power_limit_section", &[("share of the power", "")]),
    kind("traction_scale", &[("share of effort and power", "")]),
    kind("low_adhesion", &[("share of the effort", ""), ("below", "km/h")]),
    kind("speed_scale", &[("measured over true speed", "")]),
    kind("location_lag", &[("age of the location", "s")]),
    kind("temperature_resistance", &[("r0", "N/kg per °C"), ("from", "°C")]),
    kind("seasonal_drift", &[("r0 over the period", "N/kg"), ("period", "days"), ("from day", "")]),
    kind("brake_fade", &[("share lost at 140 km/h", ""), ("from", "km/h")]),
    kind("train_length_error", &[("true length", "m")]),
    kind("warm_up", &[("at the departure", "N/kg"), ("time constant", "s")]),
    kind("davis_error", &[("r0", "N/kg"), ("r1", "N/kg per m/s"), ("r2", "N/kg per (m/s)²")]),
    kind("unknown", &[("over", "coordinate"), ("points", ""), ("least", "N/kg"), ("most", "N/kg")]),
];

impl Effect {
    /// What its numbers mean; none for a kind that is newer than this library.
    ///
    /// ```
    /// use rundown_wire::Effect;
    ///
    /// let effect = Effect { kind: 1, section_m: Some([500.0, 900.0]), values: [2e-5].into_iter().collect() };
    /// let meaning = effect.meaning().unwrap();
    /// assert_eq!(meaning.name, "tunnel_drag");
    /// assert_eq!(meaning.values, [("k", "N/kg per (m/s)²")]);
    /// ```
    pub fn meaning(&self) -> Option<&'static EffectKind> {
        KINDS.get(usize::from(self.kind).checked_sub(1)?)
    }
}
