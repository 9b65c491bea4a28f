//! Train characteristics as the SFERA schema of the UIC (IRS 90940, version 3.00) names them.
//!
//! In: a train file, learned or not. Out: the element `TrainCharacteristics`, which the schema declares globally, with
//!
//! | field | unit | from |
//! |---|---|---|
//! | `trainWeight` | t, whole | mass as loaded, rounded: the *stated mass* m of all forces here |
//! | `rotatingMassFactor` | | γ |
//! | `rolloutCoefficientA`, `B`, `C` | N, N s/m, N s²/m² | γ m r0, γ m r1, γ m r2 |
//! | `TractionForceCurve` | km/h, N | min(F, P/v) with the stated mass |
//! | `trainLength` | m, whole | length |
//!
//! The coefficients are learned per rotating mass, from decelerations. With the stated mass, and not with the unrounded
//! one, a reader who divides by γ m gets the learned decelerations back. Names, units, order and what is mandatory were
//! read in the schema file itself; no message of a real system was at hand. The schema does not say whether
//! `rotatingMassFactor` is γ (1.06), γ - 1 (0.06) or percent: here it is γ, for the reasons in `docs/formats.md`, and
//! the file says so in a comment.

use super::number::decimal;
use super::{draft::Draft, effort_curve, xml};
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesText, Event};
use rundown::model::units::KmPerHour;
use rundown_files::refusal::{Place, ReadError};
use rundown_files::train_file::TrainFile;
use std::{io, path::Path, str::FromStr};

/// What the schema demands and no run shows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    /// `TC_RU_ID`: RICS code of the railway undertaking, four characters.
    pub company: String,
    pub id: String,
    pub version: String,
    pub traction: Traction,
    /// `trainMaxSpeed`, km/h; the traction curve ends there.
    pub max_speed_kmh: u16,
}

/// Energy of the traction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Traction {
    /// Overhead line or third rail.
    Electrical {
        /// Nominal voltage, V.
        volts: u32,
        /// Frequency, mHz; 0: direct current.
        millihertz: u32,
    },
    /// A battery that is charged at a stand.
    Battery,
    /// A diesel engine.
    Diesel,
    /// Fuel cells.
    Hydrogen,
}

impl FromStr for Traction {
    type Err = String;

    /// `diesel`, `battery`, `hydrogen`, `1500V` (direct current), `15000V16.7Hz`.
    fn from_str(text: &str) -> Result<Self, String> {
        let expected = || format!("expected diesel, battery, hydrogen, 1500V or 15000V16.7Hz, found `{text}`");
        match text {
            "battery" => return Ok(Self::Battery),
            "diesel" => return Ok(Self::Diesel),
            "hydrogen" => return Ok(Self::Hydrogen),
            _ => {}
        }
        let (volts, frequency) = text.split_once('V').ok_or_else(expected)?;
        let volts = volts.parse::<u32>().map_err(|_| expected())?;
        let hertz = match frequency.strip_suffix("Hz") {
            Some(hertz) => hertz.parse::<f64>().map_err(|_| expected())?,
            None if frequency.is_empty() => 0.0,
            None => return Err(expected()),
        };
        if volts == 0 || !(0.0..=1000.0).contains(&hertz) {
            return Err(expected());
        }
        let millihertz = (1000.0 * hertz).round() as u32;
        Ok(Self::Electrical { volts, millihertz })
    }
}

/// A RICS code as the schema takes it: four digits or capital letters.
pub fn company(text: &str) -> Result<String, String> {
    let good = |c: char| c.is_ascii_digit() || c.is_ascii_uppercase();
    if text.len() == 4 && text.chars().all(good) {
        Ok(text.to_owned())
    } else {
        Err("expected a RICS code of four digits or capital letters".to_owned())
    }
}

/// Mass that the file states, kg: whole tonnes.
pub fn stated_mass_kg(train: &TrainFile) -> f64 {
    1000.0 * (train.mass_kg / 1000.0).round().max(1.0)
}

/// A, B, C in N, N s/m, N s²/m² with the stated mass.
pub fn rollout_coefficients(train: &TrainFile) -> [f64; 3] {
    let rotating_mass_kg = train.rotating_mass_factor * stated_mass_kg(train);
    let davis = &train.davis;
    [davis.r0, davis.r1, davis.r2].map(|r| rotating_mass_kg * r)
}

/// Points of the largest traction: speed in km/h, force in N with the stated mass.
fn traction_curve(train: &TrainFile, max_speed_kmh: f64) -> Vec<(f64, f64)> {
    let share = stated_mass_kg(train) / train.mass_kg;
    let curve = effort_curve::points(share * train.max_tractive_effort_n, share * train.max_power_w, max_speed_kmh);
    // The schema's speeds have tenths. Rounded down, the knee states no more power than there is.
    curve.into_iter().map(|(kmh, force_n)| ((10.0 * kmh).floor() / 10.0, force_n)).collect()
}

/// What a reader of the file must know and the schema does not say.
const MEANING: &str = "rotatingMassFactor: mass with its rotating part over trainWeight. Rollout coefficients and tractionForce: forces on a train of trainWeight.";

pub(super) fn write(writer: impl io::Write, train: &TrainFile, identity: &Identity, said: &[String]) -> io::Result<()> {
    let mut xml = Writer::new_with_indent(writer, b' ', 2);
    xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let comment = xml::comment(&format!("\n  {MEANING}\n  {}\n", said.join("\n  ")));
    xml.write_event(Event::Comment(BytesText::new(&comment)))?;
    let [a, b, c] = rollout_coefficients(train);
    let features = [
        ("trainLength", format!("{:.0}", train.length_m)),
        ("trainMaxSpeed", identity.max_speed_kmh.to_string()),
        ("trainWeight", format!("{:.0}", stated_mass_kg(train) / 1000.0)),
        ("rolloutCoefficientA", decimal(a)),
        ("rolloutCoefficientB", decimal(b)),
        ("rolloutCoefficientC", decimal(c)),
        ("rotatingMassFactor", decimal(train.rotating_mass_factor)),
    ];
    let features = features.each_ref().map(|(name, value)| (*name, value.as_str()));
    let curve = traction_curve(train, f64::from(identity.max_speed_kmh));
    xml.create_element("TrainCharacteristics")
        .with_attribute(("TC_ID", identity.id.as_str()))
        .with_attribute(("TC_VersionMajor", identity.version.as_str()))
        .write_inner_content(|xml| {
            xml.create_element("TC_RU_ID").write_text_content(BytesText::new(&identity.company))?;
            xml.create_element("TC_Features").with_attributes(features).write_inner_content(|xml| {
                xml.create_element("TractionForceCurve")
                    .write_inner_content(|xml| write_curve(xml, &curve, identity.traction))?;
                Ok(())
            })?;
            Ok(())
        })?;
    let mut inner = xml.into_inner();
    inner.write_all(b"\n")?;
    inner.flush()
}

fn write_curve(xml: &mut Writer<impl io::Write>, curve: &[(f64, f64)], traction: Traction) -> io::Result<()> {
    for (kmh, force_n) in curve {
        xml.create_element("TractionForceCurveDataPoint")
            .with_attribute(("speed", format!("{kmh:.1}").as_str()))
            .with_attribute(("tractionForce", format!("{force_n:.0}").as_str()))
            .write_empty()?;
    }
    xml.create_element("TFC_TractionType").write_inner_content(|xml| {
        match traction {
            Traction::Battery => xml.create_element("Battery").write_empty()?,
            Traction::Diesel => xml.create_element("Diesel").write_empty()?,
            Traction::Hydrogen => xml.create_element("Hydrogen").write_empty()?,
            Traction::Electrical { volts, millihertz } => {
                let hertz = f64::from(millihertz) / 1000.0;
                xml.create_element("Electrical")
                    .with_attribute(("voltageValue", volts.to_string().as_str()))
                    .with_attribute(("frequency", decimal(hertz).as_str()))
                    .write_empty()?
            }
        };
        Ok(())
    })?;
    Ok(())
}

pub(super) fn read(path: &Path, text: &str) -> Result<Draft, ReadError> {
    let elements = xml::elements(path, text)?;
    let mut features = elements.iter().filter(|element| element.name == "TC_Features");
    let (Some(train), None) = (features.next(), features.next()) else {
        let count = elements.iter().filter(|element| element.name == "TC_Features").count();
        return Err(Place::of_file(path).refuse("TC_Features", format!("expected one, found {count}")).into());
    };
    let points = elements
        .iter()
        .filter(|element| element.name == "TractionForceCurveDataPoint")
        .map(|point| Ok((KmPerHour(point.required("speed")?).to_mps(), point.required("tractionForce")?)));
    let limits = effort_curve::limits(&points.collect::<Result<Vec<_>, ReadError>>()?);
    let name = elements.iter().find_map(|element| element.attribute("TC_ID"));
    let mut draft = Draft {
        name: name.unwrap_or_default().to_owned(),
        resistance_n: [
            train.required("rolloutCoefficientA")?,
            train.required("rolloutCoefficientB")?,
            train.required("rolloutCoefficientC")?,
        ],
        ..Draft::default()
    };
    draft.put("mass_kg", train.number("trainWeight")?.map(|tonnes| 1000.0 * tonnes));
    draft.put("rotating_mass_factor", train.number("rotatingMassFactor")?);
    draft.put("length_m", train.number("trainLength")?);
    draft.put("max_tractive_effort_n", limits.as_ref().map(|limits| limits.effort_n));
    draft.put("max_power_w", limits.as_ref().map(|limits| limits.power_w));
    draft.notes.push(
        "rotatingMassFactor is read as mass with its rotating part over trainWeight; the schema does not say"
            .to_owned(),
    );
    let lost: Vec<&str> =
        train.attributes.iter().map(|(name, _)| name.as_str()).filter(|n| !KEPT.contains(n)).collect();
    if !lost.is_empty() {
        draft.notes.push(format!("not kept: {}", lost.join(", ")));
    }
    draft.notes.extend(limits.and_then(|limits| limits.note));
    Ok(draft)
}

/// Attributes of `TC_Features` that a train file has.
const KEPT: [&str; 6] = [
    "trainLength",
    "trainWeight",
    "rolloutCoefficientA",
    "rolloutCoefficientB",
    "rolloutCoefficientC",
    "rotatingMassFactor",
];

#[cfg(test)]
mod tests {
    use super::*;
    use rundown::{model::resistance::Davis, model::train::TrainDescription};

    fn train() -> TrainFile {
        let davis = Davis { r0: 7.1e-3, r1: 1.5e-4, r2: 2.7e-5 };
        let sized = TrainDescription { mass_kg: 363_700.0, length_m: 162.4, ..TrainDescription::CASE_STUDY };
        TrainFile::of("six & \"double\" <decks>", &TrainDescription { max_power_w: 2_036_377.8, davis, ..sized })
    }

    fn document(traction: &str) -> String {
        let train = train();
        let identity = Identity {
            company: company("0084").unwrap(),
            id: train.name.clone(),
            version: "3".to_owned(),
            traction: traction.parse().unwrap(),
            max_speed_kmh: 160,
        };
        let mut bytes = Vec::new();
        write(&mut bytes, &train, &identity, &["Learned.".to_owned()]).unwrap();
        String::from_utf8(bytes).unwrap()
    }

    #[test]
    fn the_document_has_the_names_and_the_order_of_the_schema() {
        let text = document("1500V");
        let expected = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
            <!--\n  rotatingMassFactor: mass with its rotating part over trainWeight. Rollout coefficients and tractionForce: forces on a train of trainWeight.\n  Learned.\n-->\n\
            <TrainCharacteristics TC_ID=\"six &amp; &quot;double&quot; &lt;decks&gt;\" TC_VersionMajor=\"3\">\n  \
              <TC_RU_ID>0084</TC_RU_ID>\n  \
              <TC_Features trainLength=\"162\" trainMaxSpeed=\"160\" trainWeight=\"364\" rolloutCoefficientA=\"2739.464\" rolloutCoefficientB=\"57.876\" \
            rolloutCoefficientC=\"10.41768\" rotatingMassFactor=\"1.06\">\n    \
                <TractionForceCurve>\n      \
                  <TractionForceCurveDataPoint speed=\"0.0\" tractionForce=\"193079\"/>\n      \
                  <TractionForceCurveDataPoint speed=\"38.0\" tractionForce=\"193079\"/>\n      \
                  <TractionForceCurveDataPoint speed=\"40.0\" tractionForce=\"183425\"/>\n";
        assert!(text.starts_with(expected), "{text}");
        let end = "<TractionForceCurveDataPoint speed=\"160.0\" tractionForce=\"45856\"/>\n      \
                  <TFC_TractionType>\n        \
                    <Electrical voltageValue=\"1500\" frequency=\"0\"/>\n      \
                  </TFC_TractionType>\n    \
                </TractionForceCurve>\n  \
              </TC_Features>\n\
            </TrainCharacteristics>\n";
        assert!(text.ends_with(end), "{text}");
        assert!(document("diesel").contains("<Diesel/>"));
        assert!(document("15000V16.7Hz").contains("voltageValue=\"15000\" frequency=\"16.7\""));
    }

    #[test]
    fn a_reader_gets_the_learned_deceleration_back() {
        let train = train();
        let [a, b, c] = rollout_coefficients(&train);
        // 364 t with 6 % of rotating mass.
        assert!((a - 385_840.0 * 7.1e-3).abs() < 1e-9 && (b - 57.876).abs() < 1e-9 && (c - 10.417_68).abs() < 1e-9);
        let v = 30.0;
        let deceleration = (a + b * v + c * v * v) / (1.06 * 364_000.0);
        let learned = 7.1e-3 + v * (1.5e-4 + v * 2.7e-5);
        assert!((deceleration - learned).abs() < 1e-15);
    }

    #[test]
    fn voltage_and_frequency_are_read_and_what_the_schema_does_not_take_is_refused() {
        assert_eq!("15000V16.7Hz".parse(), Ok(Traction::Electrical { volts: 15_000, millihertz: 16_700 }));
        assert_eq!("1500V".parse(), Ok(Traction::Electrical { volts: 1500, millihertz: 0 }));
        for wrong in ["84", "008a", "00844", "00 4"] {
            assert!(company(wrong).is_err(), "{wrong}");
        }
        for wrong in ["steam", "0V", "V", "1500", "1500Vdc", "1500V-1Hz", "1500VNaNHz"] {
            assert!(wrong.parse::<Traction>().is_err(), "{wrong}");
        }
    }
}
