//! CAN interfaces of Linux (`AF_CAN`), as a controller of the library.
//!
//! In: the name of an interface, set up and up. Out: frames. The socket takes classic frames and, where the interface
//! can, FD frames.

use embedded_can::Frame as _;
use rundown::link::can::{CanFrame, Format};
use rundown::link::slcan::PortError;
use socketcan::{CanAnyFrame, CanFdFrame, CanFdSocket, Socket as _};
use std::io;

/// An open interface.
pub struct Socket(CanFdSocket);

impl Socket {
    /// Opens it.
    ///
    /// # Errors
    /// Those of the system: no such interface, a kernel without CAN.
    pub fn open(interface: &str) -> io::Result<Self> {
        let socket = CanFdSocket::open(interface)?;
        socket.set_nonblocking(true)?;
        Ok(Self(socket))
    }
}

fn to_socket(frame: &CanFrame) -> Option<CanAnyFrame> {
    match frame.format() {
        Some(Format::Fd { bit_rate_switch }) => {
            let mut frame: CanFdFrame = frame.to_frame()?;
            frame.set_brs(bit_rate_switch);
            Some(CanAnyFrame::Fd(frame))
        }
        // Classic data and remote frames; the frame type picks which by the number of bytes.
        _ => frame.to_frame(),
    }
}

/// Nothing for error frames, which carry no message.
fn from_socket(frame: &CanAnyFrame) -> Option<CanFrame> {
    match frame {
        CanAnyFrame::Fd(frame) => CanFrame::try_new(
            embedded_can::Frame::id(frame),
            Format::Fd { bit_rate_switch: frame.is_brs() },
            frame.data(),
        )
        .ok(),
        CanAnyFrame::Error(_) => None,
        classic => CanFrame::from_frame(classic),
    }
}

fn port(error: io::Error) -> nb::Error<PortError<io::Error>> {
    if error.kind() == io::ErrorKind::WouldBlock {
        nb::Error::WouldBlock
    } else {
        nb::Error::Other(PortError::Port(error))
    }
}

impl embedded_can::nb::Can for Socket {
    type Frame = CanFrame;
    type Error = PortError<io::Error>;

    fn transmit(&mut self, frame: &CanFrame) -> nb::Result<Option<CanFrame>, Self::Error> {
        let frame = to_socket(frame).ok_or_else(|| {
            port(io::Error::new(io::ErrorKind::InvalidData, "frame that the interface does not have"))
        })?;
        self.0.write_frame(&frame).map_err(port)?;
        Ok(None)
    }

    fn receive(&mut self) -> nb::Result<CanFrame, Self::Error> {
        loop {
            let frame = self.0.read_frame().map_err(port)?;
            if let Some(frame) = from_socket(&frame) {
                return Ok(frame);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use embedded_can::Frame;
    use rundown::link::can::{extended, standard};

    #[test]
    fn frames_survive_the_type_of_the_socket() {
        let fd = |bit_rate_switch| Format::Fd { bit_rate_switch };
        for frame in [
            CanFrame::try_new(standard(0x6D0), Format::Classic, &[1, 2, 3]).unwrap(),
            CanFrame::try_new(extended(0x1234_5678), Format::Classic, &[]).unwrap(),
            CanFrame::try_new(standard(0x6D0), fd(false), &[4; 8]).unwrap(),
            CanFrame::try_new(standard(0x6D0), fd(true), &[5; 64]).unwrap(),
            CanFrame::new_remote(standard(0x6D0), 3).unwrap(),
        ] {
            let there = to_socket(&frame).unwrap();
            assert_eq!(from_socket(&there), Some(frame));
        }
    }

    #[test]
    #[ignore = "needs an interface: ip link add vcan0 type vcan && ip link set vcan0 up"]
    fn a_message_passes_a_virtual_interface() {
        use rundown::link::{Link, can_link::CanLink, isotp::Config};
        let (here, there) = (Socket::open("vcan0").unwrap(), Socket::open("vcan0").unwrap());
        let mut host = CanLink::host(here, Config::CLASSIC);
        let mut board = CanLink::board(there, Config::CLASSIC);
        host.send(&[7; 100], 0).unwrap();
        let received = (0..1000).find_map(|_| {
            std::thread::sleep(std::time::Duration::from_millis(1));
            host.receive(0).unwrap();
            board.receive(0).unwrap()
        });
        assert_eq!(received.as_deref(), Some(&[7; 100][..]));
    }
}
