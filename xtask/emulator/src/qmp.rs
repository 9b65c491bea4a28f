//! QEMU's control channel (QMP): one JSON object a line.

use serde_json::{Value, json};
use std::io::{self, BufRead, BufReader, Write};
use std::net::TcpStream;

pub(crate) struct Qmp {
    reader: BufReader<TcpStream>,
}

impl Qmp {
    /// Takes the greeting and leaves the negotiation.
    pub(crate) fn new(stream: TcpStream) -> io::Result<Self> {
        let mut qmp = Self { reader: BufReader::new(stream) };
        qmp.line()?;
        qmp.execute("qmp_capabilities", json!({}))?;
        Ok(qmp)
    }

    /// A command and its answer. Events that come between are passed over.
    pub(crate) fn execute(&mut self, command: &str, arguments: Value) -> io::Result<Value> {
        let request = json!({ "execute": command, "arguments": arguments });
        let mut bytes = request.to_string().into_bytes();
        bytes.push(b'\n');
        self.reader.get_mut().write_all(&bytes)?;
        loop {
            let mut answer = self.line()?;
            if let Some(error) = answer.get("error") {
                return Err(io::Error::other(format!("QEMU refused {command}: {error}")));
            }
            if let Some(done) = answer.get_mut("return") {
                return Ok(done.take());
            }
        }
    }

    fn line(&mut self) -> io::Result<Value> {
        let mut line = String::new();
        if self.reader.read_line(&mut line)? == 0 {
            return Err(io::Error::new(io::ErrorKind::UnexpectedEof, "QEMU has closed its control channel"));
        }
        serde_json::from_str(&line).map_err(io::Error::other)
    }
}
