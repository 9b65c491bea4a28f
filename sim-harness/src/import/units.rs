//! Units of columns: by their names in headers and in `import.toml`, and as factors to what a run log holds.

use super::meaning::{Dimension, Meaning, plain};

/// A unit of one kind of column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Its name in `import.toml`.
    pub name: &'static str,
    /// Other spellings in headers, in small letters.
    also: &'static [&'static str],
    /// Value in SI (m, m/s, s, degrees, N/kg, °C) = factor * (value + shift).
    factor: f64,
    shift: f64,
}

/// Degrees and minutes as one number: 5006.12 is 50° 6.12'.
pub const DEGREES_AND_MINUTES: &str = "ddmm";

impl Unit {
    const fn new(name: &'static str, also: &'static [&'static str], factor: f64) -> Self {
        Self { name, also, factor, shift: 0.0 }
    }

    pub fn to_si(self, value: f64) -> f64 {
        if self.name == DEGREES_AND_MINUTES {
            let degrees = (value / 100.0).trunc();
            return degrees + (value - 100.0 * degrees) / 60.0;
        }
        self.factor * (value + self.shift)
    }

    pub fn is_degrees(self) -> bool {
        self.name == "degrees"
    }

    /// A tenth or hundredth of a second.
    pub fn is_of_counter(self) -> bool {
        ["0.1 s", "0.01 s"].contains(&self.name)
    }

    pub const fn factor(self) -> f64 {
        self.factor
    }
}

const LENGTHS: [Unit; 8] = [
    Unit::new("m", &["metre", "metres", "meter", "meters", "mètres", "metros", "metri", "mtr"], 1.0),
    Unit::new(
        "km",
        &["kilometre", "kilometres", "kilometer", "kilometers", "kilómetros", "kilometros", "chilometri"],
        1000.0,
    ),
    Unit::new("miles", &["mi", "mile"], 1609.344),
    Unit::new("nautical miles", &["nmi", "nm", "nautical mile"], 1852.0),
    Unit::new("feet", &["ft", "foot"], 0.3048),
    Unit::new("cm", &[], 0.01),
    Unit::new("mm", &[], 0.001),
    Unit::new("dm", &[], 0.1),
];
const SPEEDS: [Unit; 9] = [
    Unit::new("km/h", &["kmh", "kph", "km h", "kmph", "km/hr", "km/std", "km/u", "km/t", "km/tim"], 1.0 / 3.6),
    Unit::new("m/s", &["mps", "ms", "m s", "m/sec", "meter per second"], 1.0),
    Unit::new("mph", &["mi/h", "miles/h", "miles per hour"], 0.44704),
    Unit::new(
        "knots",
        &["kn", "kt", "kts", "knot", "knoten", "nœud", "nœuds", "noeud", "noeuds", "nudo", "nudos", "nodo", "nodi"],
        1852.0 / 3600.0,
    ),
    // Whole numbers of a bus or a database.
    Unit::new("0.1 km/h", &["hm/h"], 0.1 / 3.6),
    Unit::new("0.01 km/h", &[], 0.01 / 3.6),
    Unit::new("dm/s", &["dmps", "dm s"], 0.1),
    Unit::new("cm/s", &["cmps", "cm s", "cm/sec"], 0.01),
    Unit::new("mm/s", &["mmps", "mm s", "mm/sec"], 0.001),
];
const TIMES: [Unit; 8] = [
    Unit::new("s", &["sec", "secs", "second", "seconds", "sek", "sekunden", "secondes", "segundos", "secondi"], 1.0),
    Unit::new("ms", &["msec", "millis", "milliseconds", "millisekunden"], 0.001),
    Unit::new("minutes", &["min", "mins", "minute", "minuten", "minutos", "minuti"], 60.0),
    // Whole numbers of a counter.
    Unit::new("0.1 s", &["ds", "tenths", "zehntelsekunden"], 0.1),
    Unit::new("0.01 s", &["cs", "hundredths", "hundertstelsekunden"], 0.01),
    Unit::new("us", &["µs", "microseconds"], 1e-6),
    Unit::new("hours", &["h", "hour", "std", "stunden"], 3600.0),
    Unit::new("ns", &["nanoseconds"], 1e-9),
];
const ANGLES: [Unit; 2] = [
    Unit::new("degrees", &["deg", "°", "grad", "wgs84"], 1.0),
    Unit::new(DEGREES_AND_MINUTES, &["ddmm.mmmm", "dddmm.mmmm", "ddmm.mm", "dddmm.mm"], 1.0),
];
/// N and kN are divided by the rotating mass, which the mapping gives.
const EFFORTS: [Unit; 3] = [
    Unit::new("N/kg", &["n per kg", "m/s²", "m/s2"], 1.0),
    Unit::new("kN", &["kn"], 1000.0),
    Unit::new("N", &["n"], 1.0),
];
const TEMPERATURES: [Unit; 3] = [
    Unit::new("°C", &["c", "degc", "celsius", "deg c"], 1.0),
    Unit { name: "°F", also: &["f", "degf", "fahrenheit"], factor: 5.0 / 9.0, shift: -32.0 },
    Unit { name: "K", also: &["k", "kelvin"], factor: 1.0, shift: -273.15 },
];

/// The units that a column may have; the first `candidates` of them are tried where nothing names one.
pub const fn of(meaning: Meaning) -> &'static [Unit] {
    match meaning.dimension() {
        Some(Dimension::Time) => &TIMES,
        Some(Dimension::Length) => &LENGTHS,
        Some(Dimension::Speed) => &SPEEDS,
        Some(Dimension::Angle) => &ANGLES,
        Some(Dimension::Force) => &EFFORTS,
        Some(Dimension::Temperature) => &TEMPERATURES,
        None => &[],
    }
}

/// Those that evidence decides between.
pub fn candidates(meaning: Meaning) -> &'static [Unit] {
    let all = of(meaning);
    let count = match meaning {
        Meaning::Time => 5,
        Meaning::Speed => all.len(),
        _ => 4,
    };
    &all[..count.min(all.len())]
}

/// A unit by one of its names, or as a part of another one.
pub fn by_name(meaning: Meaning, name: &str) -> Option<Unit> {
    let small = name.trim().to_lowercase();
    let exact = of(meaning).iter().find(|unit| unit.name == name.trim()).copied();
    exact.or_else(|| named(meaning, &small)).or_else(|| part(meaning, &small))
}

fn named(meaning: Meaning, small: &str) -> Option<Unit> {
    let small = small.trim();
    of(meaning).iter().find(|unit| unit.name.to_lowercase() == small || unit.also.contains(&small)).copied()
}

/// A tenth, hundredth or thousandth of a unit, as people write them.
const PARTS: [(f64, [&str; 4], &str); 3] = [
    (10.0, ["0.1", "0,1", "1/10", "01"], "10"),
    (100.0, ["0.01", "0,01", "1/100", "001"], "100"),
    (1000.0, ["0.001", "0,001", "1/1000", "0001"], "1000"),
];

/// `0.1 km/h`, `1/100 m/s`, `speed_01kmh`; `km/h x 10` are tenths, too.
fn part(meaning: Meaning, small: &str) -> Option<Unit> {
    let (unit, times) = small.rsplit_once(['x', '*', '×']).unwrap_or((small, ""));
    let (parts, whole) = PARTS.iter().find_map(|(parts, before, behind)| {
        let rest = before.iter().find_map(|number| named(meaning, small.strip_prefix(number)?));
        let whole = rest.or_else(|| named(meaning, unit).filter(|_| times.trim() == *behind));
        Some((parts, whole?))
    })?;
    of(meaning).iter().find(|unit| (parts * unit.factor / whole.factor - 1.0).abs() < 1e-9).copied()
}

/// It is a unit of some column, or one that no column has.
pub fn is_known(name: &str) -> bool {
    is_foreign(name) || Meaning::ALL.into_iter().any(|meaning| by_name(meaning, name).is_some())
}

/// Units that no column has.
pub fn is_foreign(name: &str) -> bool {
    const FOREIGN: [&str; 19] = [
        "%", "mn", "dan", "t", "tf", "kp", "kgf", "lbf", "klbf", "p.u.", "pu", "rpm", "1/min", "hz", "yd", "hm", "bar",
        "v", "a",
    ];
    FOREIGN.contains(&&*name.trim().to_lowercase())
}

/// A header without its unit, and the unit: `v [km/h]`, `Weg (km)`, `speed_kmh`, `location/m`, `Time, s`.
pub fn split(header: &str) -> (String, Option<String>) {
    let header = header.trim().trim_start_matches(['#', '\u{feff}']).trim();
    for (open, close) in [('[', ']'), ('(', ')'), ('{', '}')] {
        if let Some((name, rest)) = header.split_once(open)
            && let Some((unit, _)) = rest.split_once(close)
            && !name.trim().is_empty()
        {
            return (name.trim().to_owned(), Some(unit.trim().to_owned()));
        }
    }
    let known = |unit: &str| Meaning::ALL.into_iter().find(|meaning| by_name(*meaning, unit).is_some());
    for separator in [" in ", ", ", " / ", "_", "/", "-", " "] {
        // The longest unit first: `speed_km_h`.
        for (at, _) in header.match_indices(separator) {
            let (name, unit) = (&header[..at], &header[at + separator.len()..]);
            let spelled = unit.replace('_', " ");
            let of_name = Meaning::of_name(name);
            let fits = |unit: &str| of_name.is_some_and(|meaning| by_name(meaning, unit).is_some());
            if fits(&spelled) || fits(unit) {
                return (name.to_owned(), Some(spelled));
            }
        }
    }
    // `km` or `Kilometer` alone names a location and its unit.
    let alone = plain(header);
    if known(&alone) == Some(Meaning::Location)
        && by_name(Meaning::Location, &alone).is_some_and(|unit| unit.name == "km")
    {
        return (header.to_owned(), Some("km".to_owned()));
    }
    (header.to_owned(), None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_part_into_name_and_unit() {
        for (header, name, unit) in [
            ("v [km/h]", "v", Some("km/h")),
            ("Weg (km)", "Weg", Some("km")),
            ("speed_kmh", "speed", Some("kmh")),
            ("location_m", "location", Some("m")),
            ("Geschwindigkeit in km/h", "Geschwindigkeit", Some("km/h")),
            ("effort_n_per_kg", "effort", Some("n per kg")),
            ("train number", "train number", None),
            ("km", "km", Some("km")),
            ("Kilometer", "Kilometer", Some("km")),
            ("Strecken-km", "Strecken", Some("km")),
            ("Zugkraft/Masse [N/kg]", "Zugkraft/Masse", Some("N/kg")),
        ] {
            assert_eq!(split(header), (name.to_owned(), unit.map(str::to_owned)), "{header}");
        }
    }

    #[test]
    fn units_become_si() {
        let si = |meaning, name, value| by_name(meaning, name).map(|unit| unit.to_si(value));
        assert_eq!(si(Meaning::Speed, "MPH", 100.0), Some(44.704));
        assert_eq!(si(Meaning::Location, "ft", 1000.0), Some(304.8));
        assert_eq!(si(Meaning::Temperature, "F", 212.0), Some(100.0));
        assert_eq!(si(Meaning::Latitude, "ddmm", -5006.12).map(|degrees| (degrees * 1e6).round()), Some(-50_102_000.0));
        assert_eq!(si(Meaning::Speed, "kg", 1.0), None);
    }

    #[test]
    fn parts_of_units_are_units() {
        for (header, unit) in [
            ("v [0.1 km/h]", "0.1 km/h"),
            ("v (0,01 km/h)", "0.01 km/h"),
            ("speed_01kmh", "0.1 km/h"),
            ("speed (km/h x 100)", "0.01 km/h"),
            ("speed [km/h*10]", "0.1 km/h"),
            ("v (1/100 m/s)", "cm/s"),
            ("speed_cm_s", "cm/s"),
            ("speed_mmps", "mm/s"),
            ("Vitesse (nœuds)", "knots"),
            ("Geschwindigkeit in Knoten", "knots"),
        ] {
            let found = split(header).1.and_then(|unit| by_name(Meaning::Speed, &unit));
            assert_eq!(found.map(|unit| unit.name), Some(unit), "{header}");
        }
        assert_eq!(by_name(Meaning::Location, "0.1 m").map(|unit| unit.name), Some("dm"));
        for none in ["0.1", "x 10", "km/h x 7", "0.1 m", "01"] {
            assert_eq!(by_name(Meaning::Speed, none), None, "{none}");
        }
    }
}
