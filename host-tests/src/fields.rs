//! A second encoder, written from the rules of `WIRE.md` and not with postcard: each field of a value with its path,
//! its type and its bytes.
//!
//! The examples of the document are made of it, and the encoder of the frames is compared with it.

use serde::ser::{self, Serialize, Serializer};
use std::fmt;

/// One field on the wire.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Where it stands, as `location_m.value`.
    pub path: String,
    /// What it says.
    pub value: String,
    /// Its bytes.
    pub bytes: Vec<u8>,
}

/// A struct: its name, and name and type of its fields.
pub type Shape = (&'static str, Vec<(&'static str, String)>);

/// All fields of a value.
#[derive(Debug, Default)]
pub struct Fields {
    /// In the order of the wire.
    pub fields: Vec<Field>,
    /// The structs that were met.
    pub shapes: Vec<Shape>,
    /// The variants that were met: enum, number, word.
    pub variants: Vec<(&'static str, u32, String)>,
    /// Fields that another value makes longer: a varint below its largest value, an option without a value.
    pub could_grow: Vec<String>,
    path: String,
}

impl Fields {
    /// Walks through a value.
    pub fn of(value: &impl Serialize) -> Self {
        let mut walk = Self::default();
        value.serialize(&mut walk).expect("a value of the wire");
        walk
    }

    /// All bytes.
    pub fn bytes(&self) -> Vec<u8> {
        self.fields.iter().flat_map(|f| f.bytes.iter().copied()).collect()
    }

    fn put(&mut self, value: impl fmt::Display, bytes: Vec<u8>) {
        self.fields.push(Field { path: self.path.clone(), value: value.to_string(), bytes });
    }

    fn number(&mut self, value: u64, largest: u64) {
        if value < largest {
            self.could_grow.push(self.path.clone());
        }
        self.put(value, varint(value));
    }

    fn variant(&mut self, name: &'static str, index: u32, variant: &str) {
        let word = snake_case(variant);
        self.variants.push((name, index, word.clone()));
        let nameless = self.path.is_empty();
        if nameless {
            self.path = snake_case(name);
        }
        self.put(word, varint(index.into()));
        if nameless {
            self.path.clear();
        }
    }

    /// Walks with the path longer by a name.
    fn inside(&mut self, name: &str, value: &(impl Serialize + ?Sized)) -> Result<String, Unforeseen> {
        let before = self.path.len();
        if before > 0 && !name.starts_with('[') {
            self.path.push('.');
        }
        self.path.push_str(name);
        let kind = value.serialize(&mut *self);
        self.path.truncate(before);
        kind
    }
}

/// Seven bits a byte, the lowest first; the top bit says that more follow.
pub fn varint(mut value: u64) -> Vec<u8> {
    let mut bytes = Vec::new();
    while value >= 0x80 {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
    bytes
}

fn snake_case(name: &str) -> String {
    let mut word = String::new();
    for letter in name.chars() {
        if letter.is_uppercase() && !word.is_empty() {
            word.push('_');
        }
        word.extend(letter.to_lowercase());
    }
    word
}

/// Something that no frame has.
#[derive(Debug)]
pub struct Unforeseen(String);

impl fmt::Display for Unforeseen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Unforeseen {}

impl ser::Error for Unforeseen {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Self(message.to_string())
    }
}

/// What gives a type's name, or is being walked through.
type Kind = Result<String, Unforeseen>;

/// Values of one field, and the name of their type.
macro_rules! numbers {
    ($($method:ident($kind:ty): |$walk:ident, $v:ident| $put:expr;)*) => {
        $(fn $method(self, $v: $kind) -> Kind {
            let $walk = self;
            $put;
            Ok(stringify!($kind).into())
        })*
    };
}

/// What no frame has.
macro_rules! unforeseen {
    ($($method:ident($kind:ty))*) => {
        $(fn $method(self, _: $kind) -> Kind {
            Err(Unforeseen(concat!("no frame has a ", stringify!($kind)).into()))
        })*
    };
}

impl<'a> Serializer for &'a mut Fields {
    fn is_human_readable(&self) -> bool {
        false
    }

    /// The name of the type.
    type Ok = String;
    type Error = Unforeseen;
    type SerializeSeq = Items<'a>;
    type SerializeTuple = Items<'a>;
    type SerializeTupleStruct = ser::Impossible<String, Unforeseen>;
    type SerializeTupleVariant = ser::Impossible<String, Unforeseen>;
    type SerializeMap = ser::Impossible<String, Unforeseen>;
    type SerializeStruct = Members<'a>;
    type SerializeStructVariant = Members<'a>;

    numbers! {
        serialize_bool(bool): |walk, v| walk.put(v, vec![v.into()]);
        serialize_u8(u8): |walk, v| walk.put(v, vec![v]);
        serialize_u16(u16): |walk, v| walk.number(v.into(), u16::MAX.into());
        serialize_u32(u32): |walk, v| walk.number(v.into(), u32::MAX.into());
        serialize_u64(u64): |walk, v| walk.number(v, u64::MAX);
        serialize_f32(f32): |walk, v| walk.put(format!("{v:?}"), v.to_le_bytes().to_vec());
        serialize_f64(f64): |walk, v| walk.put(format!("{v:?}"), v.to_le_bytes().to_vec());
    }
    unforeseen! { serialize_i8(i8) serialize_i16(i16) serialize_i32(i32) serialize_i64(i64) serialize_char(char) }
    unforeseen! { serialize_str(&str) serialize_unit_struct(&'static str) }

    /// On the wire a list of bytes.
    fn serialize_bytes(self, bytes: &[u8]) -> Kind {
        bytes.serialize(self)
    }

    fn serialize_none(self) -> Kind {
        self.could_grow.push(self.path.clone());
        self.put("none", vec![0]);
        Ok("Option<?>".into())
    }
    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Kind {
        self.put("some", vec![1]);
        Ok(format!("Option<{}>", value.serialize(self)?))
    }
    fn serialize_unit(self) -> Kind {
        Ok("()".into())
    }
    fn serialize_unit_variant(self, name: &'static str, index: u32, variant: &'static str) -> Kind {
        self.variant(name, index, variant);
        Ok(name.into())
    }
    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        name: &'static str,
        index: u32,
        variant: &'static str,
        value: &T,
    ) -> Kind {
        self.variant(name, index, variant);
        // What a frame holds is named without the frame.
        let path = match name {
            "Body" | "Request" => std::mem::take(&mut self.path),
            _ => self.path.clone(),
        };
        let kind = value.serialize(&mut *self);
        self.path = path;
        kind.map(|_| name.into())
    }
    fn serialize_seq(self, length: Option<usize>) -> Result<Items<'a>, Unforeseen> {
        let length = length.ok_or_else(|| Unforeseen("a list without a length".into()))?;
        self.put(format!("{length} of them"), varint(length as u64));
        Ok(Items::begin(self, "Vec"))
    }
    fn serialize_tuple(self, _length: usize) -> Result<Items<'a>, Unforeseen> {
        Ok(Items::begin(self, "array"))
    }
    fn serialize_struct(self, name: &'static str, _: usize) -> Result<Members<'a>, Unforeseen> {
        let members = Vec::new();
        Ok(Members { walk: self, name, members, is_struct: true })
    }
    fn serialize_struct_variant(
        self,
        name: &'static str,
        index: u32,
        variant: &'static str,
        _: usize,
    ) -> Result<Members<'a>, Unforeseen> {
        self.variant(name, index, variant);
        let members = Vec::new();
        Ok(Members { walk: self, name, members, is_struct: false })
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, name: &'static str, _: &T) -> Kind {
        Err(Unforeseen(name.into()))
    }
    fn serialize_tuple_struct(self, name: &'static str, _: usize) -> Result<Self::SerializeTupleStruct, Unforeseen> {
        Err(Unforeseen(name.into()))
    }
    fn serialize_tuple_variant(
        self,
        name: &'static str,
        _: u32,
        _: &'static str,
        _: usize,
    ) -> Result<Self::SerializeTupleVariant, Unforeseen> {
        Err(Unforeseen(name.into()))
    }
    fn serialize_map(self, _: Option<usize>) -> Result<Self::SerializeMap, Unforeseen> {
        Err(Unforeseen("map".into()))
    }
}

/// A list or an array under way. Numbers in it become one field.
pub struct Items<'a> {
    walk: &'a mut Fields,
    outer: &'static str,
    kind: String,
    count: usize,
    first: usize,
}

impl<'a> Items<'a> {
    fn begin(walk: &'a mut Fields, outer: &'static str) -> Self {
        let first = walk.fields.len();
        Self { walk, outer, kind: "?".into(), count: 0, first }
    }

    fn item(&mut self, value: &(impl Serialize + ?Sized)) -> Result<(), Unforeseen> {
        self.kind = self.walk.inside(&format!("[{}]", self.count), value)?;
        self.count += 1;
        Ok(())
    }

    fn finish(self) -> Kind {
        let Self { walk, outer, kind, count, first } = self;
        if ["u8", "u16", "u32", "u64", "f32", "f64"].contains(&kind.as_str()) {
            let items: Vec<Field> = walk.fields.drain(first..).collect();
            let bytes: Vec<u8> = items.iter().flat_map(|item| item.bytes.clone()).collect();
            let value = match (kind.as_str(), <[u8; 4]>::try_from(&bytes[..])) {
                ("u8", Ok(four)) if outer == "array" => {
                    format!("0x{:08X}", u32::from_le_bytes(four))
                }
                ("u8", _) => format!("{count} bytes"),
                _ => items.iter().map(|item| item.value.as_str()).collect::<Vec<_>>().join(", "),
            };
            walk.put(value, bytes);
        }
        Ok(match (outer, kind.as_str(), count) {
            ("Vec", _, _) => format!("Vec<{kind}>"),
            (_, "u8", 4) => "u32 fixed".into(),
            _ => format!("[{kind}; {count}]"),
        })
    }
}

/// Both kinds of a list are walked alike, and both of a struct.
macro_rules! walked {
    ($kind:ident, $walker:ident: $method:ident($($key:ident: $key_type:ty)?) $one:ident) => {
        impl ser::$kind for $walker<'_> {
            type Ok = String;
            type Error = Unforeseen;
            fn $method<T: Serialize + ?Sized>(&mut self, $($key: $key_type,)? value: &T) -> Result<(), Unforeseen> {
                self.$one($($key,)? value)
            }
            fn end(self) -> Kind {
                self.finish()
            }
        }
    };
}

walked!(SerializeSeq, Items: serialize_element() item);
walked!(SerializeTuple, Items: serialize_element() item);
walked!(SerializeStruct, Members: serialize_field(key: &'static str) member);
walked!(SerializeStructVariant, Members: serialize_field(key: &'static str) member);

/// A struct under way.
pub struct Members<'a> {
    walk: &'a mut Fields,
    name: &'static str,
    members: Vec<(&'static str, String)>,
    is_struct: bool,
}

impl Members<'_> {
    fn member(&mut self, key: &'static str, value: &(impl Serialize + ?Sized)) -> Result<(), Unforeseen> {
        let kind = self.walk.inside(key, value)?;
        self.members.push((key, kind));
        Ok(())
    }

    fn finish(self) -> Kind {
        if self.is_struct {
            self.walk.shapes.push((self.name, self.members));
        }
        Ok(self.name.into())
    }
}
