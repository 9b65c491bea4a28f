//! Do messages name options as Python has them? The module itself needs the library of an interpreter to be linked: its
//! words are tested here.

#[path = "../python/src/options.rs"]
mod options;
