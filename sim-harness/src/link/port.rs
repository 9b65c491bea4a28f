//! Ports of the host that do not wait: serial, TCP, stdin and stdout.
//!
//! In: an open port. Out: [`HostPort`], which tells whether there is something to read, as the links of the library
//! need.
//!
//! A thread reads the port into a bounded queue. When nobody takes from the queue the thread stops reading, and the
//! other side is held back by its own port. Writing waits, at most [`WRITE_TIMEOUT`].

use std::io::{self, Read, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, sync_channel};
use std::{collections::VecDeque, net::TcpStream, sync::Arc, thread, time::Duration};

/// How long a write may take before the port counts as broken.
pub const WRITE_TIMEOUT: Duration = Duration::from_secs(5);

/// How often the reading thread looks whether the port was dropped.
const READ_TIMEOUT: Duration = Duration::from_millis(100);

/// Reads of up to 4 KiB that may be waiting.
const QUEUE: usize = 64;

/// An open port.
pub struct HostPort {
    writer: Box<dyn Write + Send>,
    queue: Receiver<io::Result<Vec<u8>>>,
    ready: VecDeque<u8>,
    closed: Arc<AtomicBool>,
}

impl HostPort {
    /// A serial port, 8 data bits, no parity, one stop bit, no flow control.
    pub fn serial(path: &str, baud: u32) -> io::Result<Self> {
        let mut port = serial2::SerialPort::open(path, baud)?;
        port.set_read_timeout(READ_TIMEOUT)?;
        port.set_write_timeout(WRITE_TIMEOUT)?;
        let reader = port.try_clone()?;
        Ok(Self::new(reader, port))
    }

    /// A TCP connection, for instance to the UART of the emulator.
    pub fn tcp(stream: TcpStream) -> io::Result<Self> {
        stream.set_nodelay(true)?;
        stream.set_read_timeout(Some(READ_TIMEOUT))?;
        stream.set_write_timeout(Some(WRITE_TIMEOUT))?;
        let reader = stream.try_clone()?;
        Ok(Self::new(reader, stream))
    }

    /// Standard input and output of this process.
    pub fn stdio() -> Self {
        Self::new(io::stdin(), io::stdout())
    }

    /// A port of any kind. Its reader may say `TimedOut` or `WouldBlock` when there is nothing to read.
    pub fn new(reader: impl Read + Send + 'static, writer: impl Write + Send + 'static) -> Self {
        let (sender, queue) = sync_channel(QUEUE);
        let closed = Arc::new(AtomicBool::new(false));
        let seen = Arc::clone(&closed);
        thread::spawn(move || read_on(reader, &sender, &seen));
        Self { writer: Box::new(writer), queue, ready: VecDeque::new(), closed }
    }
}

impl Drop for HostPort {
    fn drop(&mut self) {
        self.closed.store(true, Ordering::Relaxed);
    }
}

fn read_on(mut reader: impl Read, sender: &SyncSender<io::Result<Vec<u8>>>, closed: &AtomicBool) {
    let mut buffer = [0; 4096];
    while !closed.load(Ordering::Relaxed) {
        let read = match reader.read(&mut buffer) {
            Ok(0) => Err(io::Error::new(io::ErrorKind::UnexpectedEof, "closed by the other side")),
            Ok(length) => Ok(buffer.iter().copied().take(length).collect()),
            Err(error) => match error.kind() {
                io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted => continue,
                _ => Err(error),
            },
        };
        let ended = read.is_err();
        // The port was dropped if nobody can take it.
        if sender.send(read).is_err() || ended {
            return;
        }
    }
}

impl embedded_io::ErrorType for HostPort {
    type Error = io::Error;
}

impl embedded_io::ReadReady for HostPort {
    fn read_ready(&mut self) -> io::Result<bool> {
        if self.ready.is_empty() {
            match self.queue.try_recv() {
                Ok(read) => self.ready.extend(read?),
                Err(TryRecvError::Empty) => {}
                Err(TryRecvError::Disconnected) => {
                    return Err(io::Error::new(io::ErrorKind::NotConnected, "port closed"));
                }
            }
        }
        Ok(!self.ready.is_empty())
    }
}

impl embedded_io::Read for HostPort {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        // Waits for the first byte, as the trait asks; links look for it before.
        if self.ready.is_empty() {
            let read = self.queue.recv().map_err(|_| io::Error::new(io::ErrorKind::NotConnected, "port closed"))?;
            self.ready.extend(read?);
        }
        io::Read::read(&mut self.ready, buffer)
    }
}

impl embedded_io::Write for HostPort {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.writer.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}
