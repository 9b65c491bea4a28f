//! Where a board is, in one word.
//!
//! In: an address from the command line. Out: the open link.
//!
//! | address | link |
//! |---|---|
//! | `/dev/ttyACM0@115200`, `COM3@115200` | serial |
//! | `tcp:127.0.0.1:5555` | serial, over TCP: the emulator's UART |
//! | `stdio:` | serial, over standard input and output |
//! | `slcan:PORT`, `slcanfd:PORT` | CAN behind one of the ports above, frames of 8 or 64 bytes |
//! | `can:can0`, `canfd:can0` | CAN, a network interface of Linux |
//!
//! The bit rate of the bus is set where the adapter or the interface is set up, not here: a wrong one would stop the
//! whole bus.

use super::port::HostPort;
use super::{HostLink, Unwrapped};
use embedded_can::nb::Can;
use rundown::link::slcan::{PortError, Slcan};
use rundown::{link::can::CanFrame, link::can_link::CanLink, link::isotp::Config, link::serial::SerialLink};
use std::{fmt, io, net::TcpStream, str::FromStr};

/// A port that carries bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "as in the table above")]
pub enum PortAddress {
    /// A serial port.
    Serial {
        path: String,
        baud: u32,
    },
    /// A TCP server.
    Tcp(String),
    Stdio,
}

/// A link.
#[derive(Clone, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "as in the table above")]
pub enum Address {
    /// Messages in COBS.
    Serial(PortAddress),
    /// Messages in ISO-TP in SLCAN.
    Slcan {
        port: PortAddress,
        /// Whether frames have up to 64 bytes.
        fd: bool,
    },
    /// Messages in ISO-TP.
    Can {
        interface: String,
        /// Whether frames have up to 64 bytes.
        fd: bool,
    },
}

/// A word that is no address.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "no address: `{found}`; expected for instance /dev/ttyACM0@115200, tcp:127.0.0.1:5555, stdio:, slcan:/dev/ttyACM0@115200 or can:can0"
)]
#[expect(missing_docs, reason = "said by the messages")]
pub struct AddressError {
    pub found: String,
}

impl FromStr for PortAddress {
    type Err = AddressError;

    fn from_str(word: &str) -> Result<Self, AddressError> {
        let error = || AddressError { found: word.to_owned() };
        if word == "stdio:" {
            return Ok(Self::Stdio);
        }
        if let Some(server) = word.strip_prefix("tcp:") {
            let (host, port) = server.rsplit_once(':').ok_or_else(error)?;
            port.parse::<u16>().map_err(|_| error())?;
            if host.is_empty() {
                return Err(error());
            }
            return Ok(Self::Tcp(server.to_owned()));
        }
        let (path, baud) = word.rsplit_once('@').ok_or_else(error)?;
        match baud.parse() {
            Ok(baud) if baud > 0 && !path.is_empty() && !path.contains(':') => {
                Ok(Self::Serial { path: path.to_owned(), baud })
            }
            _ => Err(error()),
        }
    }
}

impl FromStr for Address {
    type Err = AddressError;

    fn from_str(word: &str) -> Result<Self, AddressError> {
        let can = |interface: &str, fd| {
            if interface.is_empty() {
                return Err(AddressError { found: word.to_owned() });
            }
            Ok(Self::Can { interface: interface.to_owned(), fd })
        };
        match word.split_once(':') {
            Some(("slcan", port)) => Ok(Self::Slcan { port: port.parse()?, fd: false }),
            Some(("slcanfd", port)) => Ok(Self::Slcan { port: port.parse()?, fd: true }),
            Some(("can", interface)) => can(interface, false),
            Some(("canfd", interface)) => can(interface, true),
            _ => word.parse().map(Self::Serial),
        }
    }
}

impl fmt::Display for PortAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Serial { path, baud } => write!(f, "{path}@{baud}"),
            Self::Tcp(server) => write!(f, "tcp:{server}"),
            Self::Stdio => f.write_str("stdio:"),
        }
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let fd = |fd: &bool| if *fd { "fd" } else { "" };
        match self {
            Self::Serial(port) => port.fmt(f),
            Self::Slcan { port, fd: is_fd } => write!(f, "slcan{}:{port}", fd(is_fd)),
            Self::Can { interface, fd: is_fd } => write!(f, "can{}:{interface}", fd(is_fd)),
        }
    }
}

impl PortAddress {
    /// Opens the port.
    pub fn open(&self) -> io::Result<HostPort> {
        let port = match self {
            Self::Serial { path, baud } => HostPort::serial(path, *baud),
            Self::Tcp(server) => TcpStream::connect(server).and_then(HostPort::tcp),
            Self::Stdio => Ok(HostPort::stdio()),
        };
        port.map_err(|error| named(self, &error))
    }
}

impl Address {
    /// Opens the link, as the host's side.
    ///
    /// # Errors
    /// Those of the system, with the address in front; `can:` on a system other than Linux.
    pub fn open(&self) -> io::Result<HostLink> {
        self.open_as(false)
    }

    /// Opens the link and sends no frame on a CAN bus: another computer there answers the board.
    pub fn listen(&self) -> io::Result<HostLink> {
        self.open_as(true)
    }

    fn open_as(&self, silent: bool) -> io::Result<HostLink> {
        match self {
            Self::Serial(port) => Ok(HostLink::new(SerialLink::new(port.open()?))),
            Self::Slcan { port, fd } => {
                let adapter = Slcan::open(port.open()?, None).map_err(|error| match error {
                    PortError::Port(error) => named(self, &error),
                    PortError::Full => named(self, &io::ErrorKind::WriteZero.into()),
                })?;
                Ok(over_can(adapter, *fd, silent))
            }
            Self::Can { interface, fd } => open_interface(interface, *fd, silent).map_err(|error| named(self, &error)),
        }
    }
}

fn over_can(
    controller: impl Can<Frame = CanFrame, Error = PortError<io::Error>> + 'static,
    fd: bool,
    silent: bool,
) -> HostLink {
    let config = if fd { Config::FD } else { Config::CLASSIC };
    if silent {
        HostLink::new(Unwrapped(CanLink::host(Silent(controller), config)))
    } else {
        HostLink::new(Unwrapped(CanLink::host(controller, config)))
    }
}

/// A controller that never sends.
struct Silent<C>(C);

impl<C: Can> Can for Silent<C> {
    type Frame = C::Frame;
    type Error = C::Error;

    fn transmit(&mut self, _: &C::Frame) -> nb::Result<Option<C::Frame>, C::Error> {
        Ok(None)
    }

    fn receive(&mut self) -> nb::Result<C::Frame, C::Error> {
        self.0.receive()
    }
}

#[cfg(target_os = "linux")]
fn open_interface(interface: &str, fd: bool, silent: bool) -> io::Result<HostLink> {
    Ok(over_can(super::socket::Socket::open(interface)?, fd, silent))
}

#[cfg(not(target_os = "linux"))]
fn open_interface(_interface: &str, _fd: bool, _silent: bool) -> io::Result<HostLink> {
    Err(io::Error::new(
        io::ErrorKind::Unsupported,
        "CAN interfaces are there on Linux only; elsewhere use an adapter with slcan:",
    ))
}

fn named(address: &impl fmt::Display, error: &io::Error) -> io::Error {
    io::Error::new(error.kind(), format!("{address}: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_read_and_written_back() {
        let words = "/dev/ttyACM0@115200 COM3@9600 tcp:127.0.0.1:5555 tcp:[::1]:5555 stdio: \
            slcan:tcp:localhost:5555 slcanfd:/dev/ttyACM0@115200 can:can0 canfd:vcan0";
        for word in words.split_whitespace() {
            let address: Address = word.parse().unwrap();
            assert_eq!(address.to_string(), word);
        }
        assert_eq!(
            "/dev/serial/by-id/x@y@115200".parse(),
            Ok(PortAddress::Serial { path: "/dev/serial/by-id/x@y".to_owned(), baud: 115_200 })
        );
    }

    #[test]
    fn words_that_are_no_address_are_named() {
        let words = "/dev/ttyACM0 /dev/ttyACM0@fast @9600 /dev/ttyACM0@0 tcp:127.0.0.1 tcp::5555 tcp:host:99999 can: \
            slcan:can0 udp:1.2.3.4:5 http:host@80";
        for word in words.split_whitespace().chain([""]) {
            let error = word.parse::<Address>().unwrap_err().to_string();
            assert!(error.starts_with("no address: "), "{word}: {error}");
        }
    }

    #[test]
    fn a_port_that_is_not_there_is_named() {
        for word in ["/dev/no-such-port@9600", "can:no-such-interface"] {
            let address: Address = word.parse().unwrap();
            let error = address.open().err().unwrap().to_string();
            assert!(error.starts_with(&format!("{word}: ")), "{error}");
        }
    }

    #[test]
    fn who_only_listens_sends_nothing_and_hears_all() {
        use board_tests::pipe;
        use rundown::{link::Link, link::can::Format, link::can_link::TO_BOARD};
        let (here, mut there) = pipe::bus();
        let mut other = here.clone();
        let mut listener = CanLink::host(Silent(here), Config::CLASSIC);
        let mut board = CanLink::board(there.clone(), Config::CLASSIC);
        board.send(&[7; 100], 0).unwrap();
        assert!(listener.receive(0).unwrap().is_none());
        assert!(there.take().is_empty(), "no flow control of ours");
        // Another computer lets the board go on.
        other.put([CanFrame::try_new(TO_BOARD, Format::Classic, &[0x30, 0, 0]).unwrap()]);
        let heard = (0..20).find_map(|_| {
            board.receive(0).unwrap();
            listener.receive(0).unwrap()
        });
        assert_eq!(heard.as_deref(), Some(&[7; 100][..]));
        assert!(there.take().is_empty());
    }
}
