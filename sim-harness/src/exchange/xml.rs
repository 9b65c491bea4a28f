//! Elements of an XML file with their attributes, and where they stand; and comments.

use quick_xml::events::{BytesStart, Event};
use rundown_files::refusal::{Place, ReadError};
use std::path::Path;

/// An element of a file.
pub(super) struct Element {
    /// Without a namespace.
    pub name: String,
    pub attributes: Vec<(String, String)>,
    pub place: Place,
}

impl Element {
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }

    /// A number, where the attribute is there.
    pub fn number(&self, name: &str) -> Result<Option<f64>, ReadError> {
        let Some(text) = self.attribute(name) else { return Ok(None) };
        match text.trim().parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(Some(number)),
            _ => Err(self.refuse(name, format!("expected a number, found `{text}`"))),
        }
    }

    /// A number that must be there.
    pub fn required(&self, name: &str) -> Result<f64, ReadError> {
        self.number(name)?.ok_or_else(|| self.refuse(name, "expected a number, found none".to_owned()))
    }

    pub fn refuse(&self, field: &str, message: String) -> ReadError {
        self.place.clone().refuse(field, message).into()
    }
}

/// All elements in the order of their start.
pub(super) fn elements(path: &Path, text: &str) -> Result<Vec<Element>, ReadError> {
    let mut reader = quick_xml::Reader::from_str(text);
    let mut found = Vec::new();
    loop {
        let byte = reader.buffer_position() as usize;
        let refused = |error: String| {
            let message = format!("expected XML, found {error}");
            ReadError::from(Place::of_byte(path, text, byte).refuse("", message))
        };
        match reader.read_event().map_err(|error| refused(error.to_string()))? {
            Event::Start(start) | Event::Empty(start) => {
                let place = Place::of_byte(path, text, byte);
                found.push(element(&start, place).map_err(refused)?);
            }
            Event::Eof => return Ok(found),
            _ => {}
        }
    }
}

fn element(start: &BytesStart<'_>, place: Place) -> Result<Element, String> {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let attributes = start.attributes().map(|attribute| {
        let attribute = attribute.map_err(|error| error.to_string())?;
        let value = attribute.unescape_value().map_err(|error| error.to_string())?;
        Ok((text(attribute.key.as_ref()), value.into_owned()))
    });
    let attributes = attributes.collect::<Result<_, String>>()?;
    Ok(Element { name: text(start.local_name().as_ref()), attributes, place })
}

/// A text as the content of a comment, in which two hyphens must not follow each other.
pub(super) fn comment(text: &str) -> String {
    let mut safe = text.replace("--", "- -").replace("--", "- -");
    if safe.ends_with('-') {
        safe.push(' ');
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_that_is_none_is_refused_with_its_place() {
        let found = elements("f.xml".as_ref(), "<a>\n  <x:b c=\"1&lt;\" d='2.5'/></a>").unwrap();
        assert_eq!(found[1].name, "b");
        assert_eq!(found[1].required("d").unwrap(), 2.5);
        let refused = |name: &str| found[1].required(name).unwrap_err().to_string();
        assert_eq!(refused("c"), "f.xml:2:3: c: expected a number, found `1<`");
        assert_eq!(refused("e"), "f.xml:2:3: e: expected a number, found none");
        let broken = elements("f.xml".as_ref(), "<a>\n<b></c></a>").err().map(|error| error.to_string());
        assert!(broken.is_some_and(|text| text.starts_with("f.xml:2:4: expected XML, found")));
    }

    #[test]
    fn a_comment_cannot_end_early() {
        for text in ["a --> b", "----", "end-"] {
            let safe = comment(text);
            assert!(!safe.contains("--") && !safe.ends_with('-'), "{safe}");
        }
    }
}
