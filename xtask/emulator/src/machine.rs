//! QEMU as a child process.

use crate::board::{Board, NoImage};
use crate::flash_file::{FlashFile, SIZE};
use crate::qmp::Qmp;
use ihex::Record;
use serde_json::json;
use std::io::{self, Read};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Virtual time of one instruction, as QEMU is started here.
pub const NS_PER_INSTRUCTION: u32 = 1 << SHIFT;
const SHIFT: u32 = 4;
const QEMU: &str = "qemu-system-arm";
/// The first version that has the reference board with a working serial line.
const OLDEST: u32 = 10;
/// QEMU has to connect within this time.
const CONNECT: Duration = Duration::from_secs(10);

/// What time does while the processor sleeps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sleep {
    /// It goes with the host's clock. For anything that talks over the line.
    #[default]
    AsHost,
    /// It jumps to the next interrupt: a day in a minute. Without input.
    Jumps,
}

/// How to start the emulator.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The board.
    pub board: Board,
    /// Its firmware.
    pub image: PathBuf,
    /// What time does while the processor sleeps.
    pub sleep: Sleep,
    /// The flash of [`Board::Mps2`]; without it, it is lost with the emulator.
    pub flash: Option<FlashFile>,
    /// Bytes that lie in the flash of [`Board::L475`] before the start, with their address.
    pub preloads: Vec<(u32, Vec<u8>)>,
}

impl Settings {
    /// The firmware that `cargo xtask firmware` has built.
    pub fn new(board: Board) -> Result<Self, NoImage> {
        Ok(Self { board, image: board.image()?, sleep: Sleep::AsHost, flash: None, preloads: Vec::new() })
    }
}

/// What went wrong with the emulator.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "each has its message")]
pub enum EmulatorError {
    #[error("{QEMU} could not be started ({0}): `cargo xtask setup` installs it")]
    NotFound(io::Error),
    #[error("{QEMU}: expected version {OLDEST} or newer, found {found}: `cargo xtask setup` installs it")]
    TooOld { found: String },
    #[error("{QEMU} ended: {0}")]
    Ended(String),
    #[error("{QEMU} did not connect within {} s", CONNECT.as_secs())]
    Silent,
    #[error(transparent)]
    Io(#[from] io::Error),
}

/// Version of the emulator on the path, checked to be new enough.
pub fn version() -> Result<String, EmulatorError> {
    let output = Command::new(QEMU).arg("--version").output().map_err(EmulatorError::NotFound)?;
    let text = String::from_utf8_lossy(&output.stdout);
    let found = text.split_whitespace().skip_while(|word| *word != "version").nth(1).unwrap_or("unknown").to_owned();
    let major = found.split('.').next().and_then(|word| word.parse::<u32>().ok());
    if major.is_some_and(|major| major >= OLDEST) { Ok(found) } else { Err(EmulatorError::TooOld { found }) }
}

/// A running emulator. Dropping it is the loss of power. Its methods fail when QEMU refuses or is gone.
pub struct Emulator {
    child: Child,
    line: TcpStream,
    qmp: Qmp,
}

impl Emulator {
    /// Starts it and connects its serial line. The firmware says when it is ready: what is sent earlier is lost, as on
    /// a real line.
    pub fn start(settings: &Settings) -> Result<Self, EmulatorError> {
        version()?;
        let (line, line_at) = listen()?;
        let (control, control_at) = listen()?;
        let mut command = command(settings, line_at, control_at);
        let folder = tempfile::tempdir()?;
        for (address, bytes) in &settings.preloads {
            let file = folder.path().join(format!("{address:x}.hex"));
            std::fs::write(&file, hex(*address, bytes)?)?;
            command.args(["-device", &format!("loader,file={}", file.display())]);
        }
        let mut child = command.spawn().map_err(EmulatorError::NotFound)?;
        let connected = accept(&line, &mut child).and_then(|line| {
            let control = accept(&control, &mut child)?;
            let qmp = Qmp::new(control).map_err(|error| ended(&mut child).unwrap_or(error.into()))?;
            Ok((line, qmp))
        });
        match connected {
            Ok((line, qmp)) => Ok(Self { child, line, qmp }),
            Err(error) => {
                end(&mut child);
                Err(error)
            }
        }
    }

    /// The serial line: bytes to and from the firmware. Waits at most 10 s, unless changed.
    pub fn line(&mut self) -> &mut TcpStream {
        &mut self.line
    }

    /// A copy of the memory, while the processor stands still for that moment.
    pub fn memory(&mut self, address: u64, bytes: u64) -> io::Result<Vec<u8>> {
        let folder = tempfile::tempdir()?;
        let file = folder.path().join("memory");
        self.qmp.execute("pmemsave", json!({ "val": address, "size": bytes, "filename": file.to_string_lossy() }))?;
        std::fs::read(file)
    }
}

impl Drop for Emulator {
    fn drop(&mut self) {
        end(&mut self.child);
    }
}

fn end(child: &mut Child) {
    // Both fail only if it has ended.
    let _ = child.kill();
    let _ = child.wait();
}

/// QEMU with this board, its serial line and its control channel.
fn command(settings: &Settings, line_at: SocketAddr, control_at: SocketAddr) -> Command {
    let mut machine = settings.board.machine().to_owned();
    let mut command = Command::new(QEMU);
    if let Some(flash) = &settings.flash {
        machine.push_str(",memory-backend=psram");
        let file = flash.path().display();
        let backend = format!("memory-backend-file,id=psram,size={SIZE},share=on,mem-path={file}");
        command.args(["-object", &backend]);
    }
    let sleep = match settings.sleep {
        Sleep::AsHost => "on",
        Sleep::Jumps => "off",
    };
    command
        .args(["-nodefaults", "-display", "none", "-monitor", "none"])
        .args(["-icount", &format!("shift={SHIFT},sleep={sleep}")])
        .args(["-chardev", &client("line", line_at), "-serial", "chardev:line"])
        .args(["-chardev", &client("control", control_at), "-mon", "chardev=control,mode=control"])
        .args(["-M", &machine, "-kernel"])
        .arg(&settings.image)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    command
}

/// As Intel HEX: this format QEMU lays into a flash; a raw file it refuses on a machine without RAM of variable size,
/// and single words it drops.
fn hex(address: u32, bytes: &[u8]) -> io::Result<String> {
    let mut records = Vec::new();
    for (at, value) in (address..).step_by(16).zip(bytes.chunks(16)) {
        records.push(Record::ExtendedLinearAddress((at >> 16) as u16));
        records.push(Record::Data { offset: (at & 0xFFFF) as u16, value: value.to_vec() });
    }
    records.push(Record::EndOfFile);
    ihex::create_object_file_representation(&records).map_err(io::Error::other)
}

fn listen() -> io::Result<(TcpListener, SocketAddr)> {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?;
    listener.set_nonblocking(true)?;
    let address = listener.local_addr()?;
    Ok((listener, address))
}

fn client(id: &str, address: SocketAddr) -> String {
    format!("socket,id={id},host={},port={},nodelay=on", address.ip(), address.port())
}

/// What it said, if it ends by itself within a moment.
fn ended(child: &mut Child) -> Option<EmulatorError> {
    std::thread::sleep(Duration::from_millis(100));
    let status = child.try_wait().ok()??;
    let mut said = String::new();
    child.stderr.as_mut()?.read_to_string(&mut said).ok()?;
    Some(EmulatorError::Ended(format!("{status}, {}", said.trim())))
}

fn accept(listener: &TcpListener, child: &mut Child) -> Result<TcpStream, EmulatorError> {
    let begin = Instant::now();
    loop {
        match listener.accept() {
            Ok((stream, _)) => {
                stream.set_nonblocking(false)?;
                stream.set_nodelay(true)?;
                stream.set_read_timeout(Some(CONNECT))?;
                stream.set_write_timeout(Some(CONNECT))?;
                return Ok(stream);
            }
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
            Err(error) => return Err(error.into()),
        }
        if child.try_wait()?.is_some() {
            return Err(ended(child).unwrap_or(EmulatorError::Silent));
        }
        if begin.elapsed() > CONNECT {
            return Err(EmulatorError::Silent);
        }
        std::thread::sleep(Duration::from_millis(2));
    }
}
