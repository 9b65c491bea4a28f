//! SUMO's vehicle type for rail: an additional file with one `vType` of the car-following model `Rail`, train type
//! `custom`.
//!
//! | attribute | unit | from |
//! |---|---|---|
//! | `mass`, `massFactor` | kg, - | m, γ |
//! | `maxTraction`, `maxPower` | kN, kW | F, P: the model takes min(F, P/v) |
//! | `resCoef_constant`, `_linear`, `_quadratic` | kN, kN/(m/s), kN/(m/s)² | γ m r0, γ m r1, γ m r2 |
//! | `decel` | m/s² | largest brake |
//! | `length`, `maxSpeed` | m, m/s | length, as given |
//!
//! Units as SUMO's documentation of railways and its model `MSCFModel_Rail` state them (version 1.28). The same model
//! in table form, which is exact at its points only: `sumo_table.rs`.

use super::xml::{self, Element};
use super::{draft::Draft, number::decimal, sumo_table};
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesText, Event};
use rundown::model::units::KmPerHour;
use rundown_files::refusal::{Place, ReadError};
use rundown_files::train_file::TrainFile;
use std::{io, path::Path};

/// The name as the train file has it: an id has no spaces.
const NAME: &str = "rundown.name";

const RESISTANCE: [&str; 3] = ["resCoef_constant", "resCoef_linear", "resCoef_quadratic"];

/// How traction and resistance are written.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    Parameters,
    Tables,
}

/// The additional file.
pub(super) fn write(train: &TrainFile, max_speed_kmh: f64, form: Form, said: &[String]) -> io::Result<Vec<u8>> {
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let comment = xml::comment(&format!("\n  {}\n", said.join("\n  ")));
    xml.write_event(Event::Comment(BytesText::new(&comment)))?;
    let mut attributes = vec![
        ("id", id(&train.name)),
        ("vClass", "rail".to_owned()),
        ("carFollowModel", "Rail".to_owned()),
        ("trainType", "custom".to_owned()),
        ("length", decimal(train.length_m)),
        ("maxSpeed", decimal(KmPerHour(max_speed_kmh).to_mps())),
        ("mass", decimal(train.mass_kg)),
        ("massFactor", decimal(train.rotating_mass_factor)),
        ("decel", decimal(train.max_brake_mps2)),
    ];
    match form {
        Form::Parameters => attributes.extend(parameters(train)),
        Form::Tables => attributes.extend(sumo_table::attributes(train, max_speed_kmh)),
    }
    let attributes: Vec<(&str, &str)> = attributes.iter().map(|(name, value)| (*name, value.as_str())).collect();
    xml.create_element("additional").write_inner_content(|xml| {
        xml.create_element("vType").with_attributes(attributes).write_inner_content(|xml| {
            let name = [("key", NAME), ("value", train.name.as_str())];
            xml.create_element("param").with_attributes(name).write_empty()?;
            Ok(())
        })?;
        Ok(())
    })?;
    let mut bytes = xml.into_inner();
    bytes.push(b'\n');
    Ok(bytes)
}

fn parameters(train: &TrainFile) -> [(&'static str, String); 5] {
    let rotating_mass_kg = train.rotating_mass_factor * train.mass_kg;
    let kilo = |value: f64| decimal(value / 1000.0);
    let [a, b, c] = [train.davis.r0, train.davis.r1, train.davis.r2].map(|r| kilo(rotating_mass_kg * r));
    let [constant, linear, quadratic] = RESISTANCE;
    let [power, effort] = [train.max_power_w, train.max_tractive_effort_n].map(kilo);
    [("maxPower", power), ("maxTraction", effort), (constant, a), (linear, b), (quadratic, c)]
}

/// A name as SUMO takes one.
fn id(name: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-' | '.');
    name.chars().map(|c| if plain(c) { c } else { '_' }).collect()
}

/// Attributes that are kept; those of every `vType` beside them are named as lost.
const KEPT: [&str; 16] = [
    "speedTable",
    "tractionTable",
    "resistanceTable",
    "id",
    "carFollowModel",
    "trainType",
    "length",
    "mass",
    "massFactor",
    "decel",
    "maxPower",
    "maxTraction",
    "resCoef_constant",
    "resCoef_linear",
    "resCoef_quadratic",
    "vClass",
];

pub(super) fn read(path: &Path, text: &str) -> Result<Draft, ReadError> {
    let elements = xml::elements(path, text)?;
    let mut types = elements.iter().enumerate().filter(|(_, element)| {
        element.name == "vType" && element.attribute("carFollowModel").is_some_and(|model| model == "Rail")
    });
    let (Some((index, vtype)), None) = (types.next(), types.next()) else {
        let count = elements.iter().filter(|element| element.attribute("carFollowModel") == Some("Rail")).count();
        let message = format!("expected one vType with carFollowModel=\"Rail\", found {count}");
        return Err(Place::of_file(path).refuse("vType", message).into());
    };
    if vtype.attribute("trainType") != Some("custom") {
        let found = vtype.attribute("trainType").unwrap_or("none");
        let message = format!("expected `custom`, found `{found}`: its values are SUMO's own and not in the file");
        return Err(vtype.refuse("trainType", message));
    }
    let named = elements[index..].iter().skip(1).take_while(|element| element.name == "param");
    let named = named.filter(|param| param.attribute("key") == Some(NAME)).find_map(|param| param.attribute("value"));
    let mut draft = Draft { name: named.or(vtype.attribute("id")).unwrap_or_default().to_owned(), ..Draft::default() };
    traction_and_resistance(vtype, &mut draft)?;
    draft.put("mass_kg", vtype.number("mass")?);
    draft.put("rotating_mass_factor", vtype.number("massFactor")?);
    draft.put("length_m", vtype.number("length")?);
    draft.put("max_brake_mps2", vtype.number("decel")?);
    let lost: Vec<&str> =
        vtype.attributes.iter().map(|(name, _)| name.as_str()).filter(|n| !KEPT.contains(n)).collect();
    if !lost.is_empty() {
        draft.notes.push(format!("not kept: {}", lost.join(", ")));
    }
    Ok(draft)
}

/// Each of parameters where the vehicle type has them, else of a table: SUMO takes them so, and ignores a table beside
/// parameters.
fn traction_and_resistance(vtype: &Element, draft: &mut Draft) -> Result<(), ReadError> {
    let has = |name: &str| vtype.attribute(name).is_some();
    let mut ignored = |name: &str| draft.notes.push(format!("{name} is ignored beside parameters, as SUMO does"));
    let limits = if has("maxTraction") || has("maxPower") { None } else { sumo_table::limits(vtype)? };
    if limits.is_none() && has("tractionTable") {
        ignored("tractionTable");
    }
    let resistance = if RESISTANCE.into_iter().any(has) { None } else { sumo_table::resistance_n(vtype)? };
    if resistance.is_none() && has("resistanceTable") {
        ignored("resistanceTable");
    }
    if let Some((found_n, note)) = resistance {
        draft.resistance_n = found_n;
        draft.notes.extend(note);
    } else {
        for (coefficient, name) in draft.resistance_n.iter_mut().zip(RESISTANCE) {
            *coefficient = 1000.0 * vtype.required(name)?;
        }
    }
    if let Some(limits) = limits {
        draft.put("max_tractive_effort_n", Some(limits.effort_n));
        draft.put("max_power_w", Some(limits.power_w));
        draft.notes.extend(limits.note);
    } else {
        for (field, name) in [("max_tractive_effort_n", "maxTraction"), ("max_power_w", "maxPower")] {
            draft.put(field, vtype.number(name)?.map(|value| 1000.0 * value));
        }
    }
    Ok(())
}
