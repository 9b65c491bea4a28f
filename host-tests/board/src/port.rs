//! A serial port that takes only as many bytes as there is room for.

use crate::pipe::PipeEnd;
use embedded_io::{ErrorType, Read, ReadReady, Write};
use std::io;

/// One end of a pipe, and how many bytes more it takes.
pub struct Narrow {
    /// The end.
    pub end: PipeEnd<u8>,
    /// The room.
    pub room: usize,
}

impl ErrorType for Narrow {
    type Error = io::Error;
}

impl ReadReady for Narrow {
    fn read_ready(&mut self) -> io::Result<bool> {
        self.end.read_ready()
    }
}

impl Read for Narrow {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.end.read(buffer)
    }
}

impl Write for Narrow {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let length = bytes.len().min(self.room);
        self.room -= length;
        self.end.write(&bytes[..length])
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
