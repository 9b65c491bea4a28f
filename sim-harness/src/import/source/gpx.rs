//! Track points of GPX: time, position, height, and the speed where the recorder wrote one.

use super::row::{Each, Event, Header, RowField};
use super::unpacked;
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event as Xml};
use rundown_files::refusal::ReadError;
use std::io::BufReader;
use std::path::Path;

pub fn headers() -> Vec<Header> {
    ["time", "latitude [degrees]", "longitude [degrees]", "altitude [m]", "speed [m/s]", "track"]
        .map(Header::new)
        .to_vec()
}

fn attribute(tag: &BytesStart, name: &str) -> RowField {
    let found = tag.try_get_attribute(name).ok().flatten();
    found.map_or(RowField::Empty, |value| RowField::Text(String::from_utf8_lossy(&value.value).into_owned()))
}

pub fn rows(path: &Path, each: &mut Each) -> Result<(), ReadError> {
    let mut reader = Reader::from_reader(BufReader::new(unpacked::bytes(path)?));
    let (mut buffer, mut text) = (Vec::new(), String::new());
    let mut open: Vec<Vec<u8>> = Vec::new();
    let (mut point, mut number, mut tracks): (Option<Vec<RowField>>, u64, u64) = (None, 0, 0);
    loop {
        buffer.clear();
        match reader.read_event_into(&mut buffer) {
            Ok(Xml::Start(tag)) => {
                text.clear();
                open.push(tag.local_name().as_ref().to_owned());
                match tag.local_name().as_ref() {
                    b"trk" => tracks += 1,
                    b"trkpt" => {
                        let track = if tracks > 1 { RowField::Text(tracks.to_string()) } else { RowField::Empty };
                        let (latitude, longitude) = (attribute(&tag, "lat"), attribute(&tag, "lon"));
                        point =
                            Some(vec![RowField::Empty, latitude, longitude, RowField::Empty, RowField::Empty, track]);
                    }
                    _ => {}
                }
            }
            Ok(Xml::Text(part)) => text += &String::from_utf8_lossy(&part),
            Ok(Xml::End(tag)) => {
                open.pop();
                let of_point = match tag.local_name().as_ref() {
                    b"time" => Some(0),
                    b"ele" => Some(3),
                    b"speed" => Some(4),
                    _ => None,
                };
                if let (Some(index), Some(point)) = (of_point, &mut point) {
                    point[index] = RowField::Text(text.trim().to_owned());
                }
                if tag.local_name().as_ref() == b"trkpt"
                    && let Some(point) = point.take()
                {
                    number += 1;
                    if !each(Event::Row(number, &point)) {
                        return Ok(());
                    }
                }
                text.clear();
            }
            Ok(Xml::Eof) => {
                if let Some(tag) = open.last() {
                    let tag = String::from_utf8_lossy(tag);
                    each(torn(number, &format!("the end of the file within <{tag}>")));
                }
                return Ok(());
            }
            Ok(_) => {}
            Err(error) => {
                each(torn(number, &error.to_string()));
                return Ok(());
            }
        }
    }
}

/// What was read is used; the rest of a torn file is lost.
fn torn(number: u64, found: &str) -> Event<'static> {
    let message = format!("expected XML behind track point {number}, found {found}; the rest of the file is lost");
    Event::Bad(number, message)
}
