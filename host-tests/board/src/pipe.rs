//! Two ends without a wire: bytes or CAN frames written at one end are read at the other, in the same thread.

use embedded_can::nb::Can;
use rundown::link::can::CanFrame;
use std::{cell::RefCell, collections::VecDeque, convert::Infallible, io, rc::Rc};

type Shared<T> = Rc<RefCell<VecDeque<T>>>;

/// One end of a pipe.
#[derive(Clone, Debug)]
pub struct PipeEnd<T> {
    from_other: Shared<T>,
    to_other: Shared<T>,
}

/// Both ends of a pipe of bytes.
pub fn bytes() -> (PipeEnd<u8>, PipeEnd<u8>) {
    ends()
}

/// Both ends of a CAN bus with two controllers. Nothing is lost and nothing takes time.
pub fn bus() -> (PipeEnd<CanFrame>, PipeEnd<CanFrame>) {
    ends()
}

fn ends<T>() -> (PipeEnd<T>, PipeEnd<T>) {
    let (a, b) = (Shared::default(), Shared::default());
    let one = PipeEnd { from_other: Rc::clone(&a), to_other: Rc::clone(&b) };
    let other = PipeEnd { from_other: b, to_other: a };
    (one, other)
}

impl<T> PipeEnd<T> {
    /// Everything on its way to this end, taken off the pipe.
    pub fn take(&mut self) -> Vec<T> {
        self.from_other.borrow_mut().drain(..).collect()
    }

    /// Puts something on its way to the other end.
    pub fn put(&mut self, items: impl IntoIterator<Item = T>) {
        self.to_other.borrow_mut().extend(items);
    }
}

impl embedded_io::ErrorType for PipeEnd<u8> {
    type Error = io::Error;
}

impl embedded_io::Read for PipeEnd<u8> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        io::Read::read(&mut *self.from_other.borrow_mut(), buffer)
    }
}

impl embedded_io::ReadReady for PipeEnd<u8> {
    fn read_ready(&mut self) -> io::Result<bool> {
        Ok(!self.from_other.borrow().is_empty())
    }
}

impl embedded_io::Write for PipeEnd<u8> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.put(bytes.iter().copied());
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// A bus of this kind does not fail.
#[derive(Clone, Copy, Debug)]
pub struct BusError(Infallible);

impl embedded_can::Error for BusError {
    fn kind(&self) -> embedded_can::ErrorKind {
        match self.0 {}
    }
}

impl Can for PipeEnd<CanFrame> {
    type Frame = CanFrame;
    type Error = BusError;

    fn transmit(&mut self, frame: &CanFrame) -> nb::Result<Option<CanFrame>, BusError> {
        self.put([frame.clone()]);
        Ok(None)
    }

    fn receive(&mut self) -> nb::Result<CanFrame, BusError> {
        self.from_other.borrow_mut().pop_front().ok_or(nb::Error::WouldBlock)
    }
}
