//! A firmware image (ELF): sizes and symbols.

use object::{Object, ObjectSection, ObjectSymbol, SectionFlags, SectionKind};
use std::path::{Path, PathBuf};

/// Why an image could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ImageError {
    /// The file.
    #[error("{path}: {source}")]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// Its content.
    #[error("{path} is no firmware image: {reason}")]
    Content {
        /// Which.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// A symbol is not there.
    #[error("the image has no symbol {0}")]
    NoSymbol(String),
}

/// What of an image the budget and the tests ask for.
#[derive(Clone, Debug)]
pub struct Image {
    /// Bytes in flash: code, constants, first values of variables.
    pub flash: u64,
    /// Bytes of variables in RAM, without the stack.
    pub ram: u64,
    /// Address and bytes of the code.
    pub code: (u64, Vec<u8>),
    symbols: Vec<(String, u64, u64)>,
}

impl Image {
    /// Reads it.
    ///
    /// # Errors
    /// [`ImageError`] with the path.
    pub fn read(path: &Path) -> Result<Self, ImageError> {
        let bytes = std::fs::read(path).map_err(|source| ImageError::File { path: path.to_owned(), source })?;
        let file = object::File::parse(&*bytes)
            .map_err(|error| ImageError::Content { path: path.to_owned(), reason: error.to_string() })?;
        let (mut flash, mut ram) = (0, 0);
        for section in file.sections() {
            let SectionFlags::Elf { sh_flags, .. } = section.flags() else {
                continue;
            };
            if !sh_flags.contains(object::elf::SHF_ALLOC) {
                continue;
            }
            let variables = sh_flags.contains(object::elf::SHF_WRITE);
            // Zeroed or left as they are: nothing of them lies in flash.
            let stored = section.kind() != SectionKind::UninitializedData && section.name() != Ok(".uninit");
            flash += if stored { section.size() } else { 0 };
            ram += if variables { section.size() } else { 0 };
        }
        let code = file
            .section_by_name(".text")
            .and_then(|section| Some((section.address(), section.data().ok()?.to_vec())))
            .unwrap_or_default();
        let symbols = file
            .symbols()
            .filter_map(|symbol| Some((symbol.name().ok()?.to_owned(), symbol.address(), symbol.size())))
            .collect();
        Ok(Self { flash, ram, code, symbols })
    }

    /// Address of a symbol.
    ///
    /// # Errors
    /// [`ImageError::NoSymbol`].
    pub fn address(&self, symbol: &str) -> Result<u64, ImageError> {
        self.symbols
            .iter()
            .find(|(name, ..)| name == symbol)
            .map(|(_, address, _)| *address)
            .ok_or_else(|| ImageError::NoSymbol(symbol.to_owned()))
    }

    /// All symbols: name, address, size.
    pub fn symbols(&self) -> impl Iterator<Item = (&str, u64, u64)> {
        self.symbols.iter().map(|(name, address, size)| (name.as_str(), *address, *size))
    }
}
