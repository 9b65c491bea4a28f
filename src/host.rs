//! The application over stdin and stdout: what the board does with its serial line, without a board. Ticks of the timer are left out, time comes with the measurements.

use crate::application::Application;
use rundown::onboard::kept::Boot;
use std::io::{self, BufRead, Write};

/// Until stdin ends.
pub fn run() -> io::Result<()> {
    let (mut stdin, mut stdout) = (io::stdin().lock(), io::stdout().lock());
    let mut application = Box::new(Application::IDLE);
    let mut written = Ok(());
    let mut send = |frame: &[u8]| {
        if written.is_ok() {
            written = stdout.write_all(frame).and_then(|()| stdout.flush());
        }
    };
    application.begin(&Boot::default(), &[0xFF; 64], &mut send);
    loop {
        let bytes = stdin.fill_buf()?;
        if bytes.is_empty() {
            return written;
        }
        for byte in bytes {
            application.receive(*byte, &mut send);
        }
        let taken = bytes.len();
        stdin.consume(taken);
    }
}
