//! A firmware image (ELF): sizes and symbols.

use object::{Object, ObjectSection, ObjectSymbol, SectionFlags, SectionKind};
use std::path::{Path, PathBuf};

/// Why an image could not be read.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "each has its message")]
pub enum ImageError {
    #[error("{path}: {source}")]
    File { path: PathBuf, source: std::io::Error },
    #[error("{path}: expected a firmware image: {reason}")]
    Content { path: PathBuf, reason: String },
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
    pub fn address(&self, symbol: &str) -> Result<u64, ImageError> {
        let found = self.symbols().find(|(name, ..)| *name == symbol);
        found.map(|(_, address, _)| address).ok_or_else(|| ImageError::NoSymbol(symbol.to_owned()))
    }

    /// All symbols: name, address, size.
    pub fn symbols(&self) -> impl Iterator<Item = (&str, u64, u64)> {
        self.symbols.iter().map(|(name, address, size)| (name.as_str(), *address, *size))
    }
}
