//! `rundown display`: what a board says, live, in a browser, in the terminal, or as lines.

use super::{Failure, screen};
use crate::display::hub::{Connection, Hub, OnMessage};
use crate::display::{terminal, text};
use crate::link::address::{Address, PortAddress};
use crate::link::record::{Log, Way};
use crate::{display::demo, display::page::PageServer, display::setup::Setup, display::source::FrameSource};
use rundown_files::{track_file::TrackFile, train_file::TrainFile};
use rundown_pages::numbers::counted;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::{process::ExitCode, sync::Arc, time::Duration};

/// Speed of a demonstration without `--speed`: a run in a minute.
const DEMO_SPEED: f64 = 20.0;

/// More curves than this are hard to distinguish.
const MOST_BESIDE: usize = 7;

const EXAMPLES: &str = "\
Examples:
  See it without a board: six simulated runs, twenty times as fast
    rundown display --demo

  A board on a serial port; train and track give the manufacturer's curve, stops, limits and gradients, which no frame has
    rundown display --port /dev/ttyACM0 --train t.toml --track k.toml

  The emulated board (`cargo xtask run`) beside `rundown link`, a CAN bus, one on which another computer answers the board
    rundown display --tcp 127.0.0.1:5475
    rundown display --can can0
    rundown display --can slcan:/dev/ttyACM0@115200 --listen-only

  A recording, ten times as fast; one that is just being written; one from elsewhere. That of a link has train and track
    rundown link --record run.frames ...
    rundown display --file run.frames --speed 10
    rundown display --file run.frames --follow
    ssh train cat run.frames | rundown display -

  Several units side by side: the newest state of two recordings beside a board
    rundown display --tcp 127.0.0.1:5475 --beside unit12.frames --beside unit13.frames

  For other programs: every frame as a line of JSON in SI units (WIRE.md has the fields)
    rundown display --file run.frames --json | jq .body.estimate.speed_mps.value

The page is at http://127.0.0.1:8475/, for this computer only, and works without a network. Its keys: 1 to 7 one part
large, 0 all parts, n day or night colours, ? help.

A source that fails is opened again until it is there. Lost, damaged and late frames are counted and shown; values that
have grown old are marked. The display never sends, but for the flow control that a CAN bus needs.";

#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
#[command(group = clap::ArgGroup::new("source").required(true))]
#[command(group = clap::ArgGroup::new("view"))]
pub struct Arguments {
    /// Serial port, with @BAUD for another rate than 115200
    #[arg(long, group = "source", value_name = "DEVICE")]
    port: Option<String>,
    /// Serial line over TCP, as of the emulator
    #[arg(long, group = "source", value_name = "HOST:PORT")]
    tcp: Option<String>,
    /// CAN interface: can0, canfd:can0, or an adapter slcan:DEVICE@BAUD
    #[arg(long, group = "source", value_name = "IF")]
    can: Option<String>,
    /// Recording: bytes of a serial line, or of `rundown link --record`
    #[arg(long, group = "source", value_name = "FILE")]
    file: Option<PathBuf>,
    /// Simulated runs of the paper's case study, without a board
    #[arg(long, group = "source")]
    demo: bool,
    /// A recording on standard input
    #[arg(group = "source", value_name = "-", value_parser = ["-"], hide_possible_values = true)]
    stdin: Option<String>,
    /// How many times as fast as the train a recording is played; without it page and terminal play a file at its pace,
    /// text and JSON at once, and standard input is taken as it comes
    #[arg(long, value_name = "X", value_parser = speed)]
    speed: Option<f64>,
    /// The file still grows: wait for it, at its end for more, and when it is written again
    #[arg(long, requires = "file")]
    follow: bool,
    /// Another unit, whose learned resistance stands beside this one's: a recording, or an address: tcp:HOST:PORT,
    /// can:IF, DEVICE@BAUD; up to seven times
    #[arg(long, value_name = "UNIT", conflicts_with = "view", value_parser = unit)]
    beside: Vec<FrameSource>,
    /// On CAN: send no flow control, another computer does
    #[arg(long, requires = "can")]
    listen_only: bool,
    /// Description of the train: the manufacturer's curve, kN and MW
    #[arg(long, value_name = "T.toml")]
    train: Option<PathBuf>,
    /// Description of the track: stops, limits, gradients
    #[arg(long, value_name = "K.toml")]
    track: Option<PathBuf>,
    /// Port of the page on this computer; 0 takes a free one
    #[arg(long, value_name = "PORT", default_value_t = 8475, conflicts_with = "view")]
    http: u16,
    /// One line a frame instead of the page
    #[arg(long, group = "view")]
    text: bool,
    /// One JSON object a frame instead of the page
    #[arg(long, group = "view")]
    json: bool,
    /// A view in the terminal instead of the page
    #[arg(long, group = "view")]
    tui: bool,
    /// Keep every message, as `rundown link --record` does
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
}

/// A recording that is there, else an address.
fn unit(word: &str) -> Result<FrameSource, String> {
    if Path::new(word).is_file() {
        return Ok(FrameSource::File { path: word.into(), follow: false });
    }
    let address: Address = word.parse().map_err(|error| {
        format!("expected a recording that is there, or an address such as tcp:HOST:PORT, found neither: {error}")
    })?;
    Ok(FrameSource::Board { address, listen_only: false })
}

fn speed(word: &str) -> Result<f64, String> {
    match word.parse() {
        Ok(speed) if f64::is_finite(speed) && speed > 0.0 => Ok(speed),
        _ => Err("expected a number above 0".to_owned()),
    }
}

impl Arguments {
    fn source(&self) -> Result<FrameSource, Failure> {
        let board = |address: String| -> Result<FrameSource, Failure> {
            let address: Address = address.parse().map_err(Failure::arguments)?;
            Ok(FrameSource::Board { address, listen_only: self.listen_only })
        };
        if let Some(port) = &self.port {
            let rate = port.parse::<PortAddress>().is_ok();
            return board(if rate { port.clone() } else { format!("{port}@115200") });
        }
        if let Some(server) = &self.tcp {
            return board(format!("tcp:{server}"));
        }
        if let Some(interface) = &self.can {
            return board(if interface.contains(':') { interface.clone() } else { format!("can:{interface}") });
        }
        Ok(match &self.file {
            Some(path) => FrameSource::File { path: path.clone(), follow: self.follow },
            None if self.demo => FrameSource::Demo,
            None => FrameSource::Stdin,
        })
    }

    /// The other units, each with a thread that listens. Of a recording its end is of interest: it is not played at a
    /// pace.
    fn beside(&self) -> Result<Vec<Arc<Hub>>, Failure> {
        if self.beside.len() > MOST_BESIDE {
            let found = self.beside.len();
            let message = format_args!("--beside: expected at most {MOST_BESIDE} other units, found {found}");
            return Err(Failure::arguments(message));
        }
        let listened = |source: &FrameSource| {
            let hub = Arc::new(Hub::new(source.to_string(), 1.0, Setup::default(), Box::new(|_, _| {})));
            let open = source.clone().open().map_err(Failure::refused)?;
            let feed = Arc::clone(&hub);
            std::thread::spawn(move || open.run(&feed, None));
            Ok(hub)
        };
        self.beside.iter().map(listened).collect()
    }

    fn setup(&self) -> Result<Setup, Failure> {
        let mut setup = Setup::default();
        if self.demo {
            let (train, track) = demo::described().map_err(Failure::refused)?;
            (setup.train, setup.track) = (Some(train), Some(track));
        }
        if let Some(path) = &self.train {
            setup.train = Some(TrainFile::read(path)?.0);
        }
        if let Some(path) = &self.track {
            setup.track = Some(TrackFile::read(path)?.0);
        }
        Ok(setup)
    }

    fn on_message(&self) -> Result<OnMessage, Failure> {
        let (text, json) = (self.text, self.json);
        let mut log = match &self.record {
            None => None,
            Some(path) => {
                let at = |error: io::Error| Failure::not_written(format!("{}: {error}", path.display()));
                let log = Log::new(crate::output::files::fresh(path)?).map_err(at)?;
                log::info!("writing {}", path.display());
                Some(log)
            }
        };
        let clock = crate::link::Clock::new();
        Ok(Box::new(move |message, received| {
            if let Some(log) = &mut log {
                log.write(clock.now_us(), Way::Received, message);
            }
            let line = match received {
                Some(received) if text => text::line(received),
                Some(received) if json => text::json(received),
                _ => return,
            };
            // A reader that has had enough (`| head`) ends the display, as it ends other tools; a full disk does not
            // end it well.
            let mut stdout = io::stdout().lock();
            match writeln!(stdout, "{line}").and_then(|()| stdout.flush()) {
                Ok(()) => (),
                Err(error) if error.kind() == io::ErrorKind::BrokenPipe => std::process::exit(0),
                Err(error) => {
                    let failure = Failure::not_printed(error);
                    screen::error(&failure.message);
                    std::process::exit(i32::from(failure.code));
                }
            }
        }))
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let source = arguments.source()?;
    let setup = arguments.setup()?;
    let lines = arguments.text || arguments.json;
    let speed = match arguments.speed {
        None if lines || !source.is_recording() => None,
        None if arguments.demo => Some(DEMO_SPEED),
        speed => Some(speed.unwrap_or(1.0)),
    };
    let hub = Arc::new(Hub::new(source.to_string(), speed.unwrap_or(1.0), setup, arguments.on_message()?));
    let tried_again = source.is_tried_again();
    let open = source.open().map_err(Failure::refused)?;
    if lines {
        if tried_again {
            let watched = Arc::clone(&hub);
            std::thread::spawn(move || report_losses(&watched));
        }
        open.run(&hub, speed);
        return finished(&hub);
    }
    let page = if arguments.tui {
        None
    } else {
        let beside = arguments.beside()?;
        let bound = PageServer::bind(arguments.http, Arc::clone(&hub), beside);
        Some(bound.map_err(|error| {
            Failure::not_written(format!(
                "port {} of this computer: {error}; --http takes another one, --http 0 a free one",
                arguments.http
            ))
        })?)
    };
    let feed = Arc::clone(&hub);
    std::thread::spawn(move || open.run(&feed, speed));
    match page {
        None => terminal::run(&hub).map_err(Failure::not_written)?,
        Some(page) => {
            screen::print(&format!("page: {}  (Ctrl-C ends it)\n", page.url()));
            page.serve();
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// Beside the lines of a board that may come later: why none come. What becomes of a recording is said at its end.
fn report_losses(hub: &Hub) -> ! {
    let mut version = 0;
    let mut said = String::new();
    loop {
        let connection = hub.wait(version, Duration::MAX, |view| {
            version = view.version;
            view.link.connection
        });
        match connection {
            Connection::Lost(error) if error != said => {
                screen::note(&format!("{error}; it is tried again"));
                said = error;
            }
            Connection::Open => said.clear(),
            _ => {}
        }
    }
}

/// What is to be said of a recording that was printed.
fn finished(hub: &Hub) -> Result<ExitCode, Failure> {
    hub.view(|view| {
        let tally = &view.link.tally;
        if tally.lost + tally.damaged + tally.unknown > 0 {
            screen::note(&format!(
                "{}, {} lost, {} damaged, {} unknown",
                counted(tally.frames as usize, "frame", "frames"),
                tally.lost,
                tally.damaged,
                tally.unknown
            ));
        }
        if view.state.missing_runs > 0 {
            screen::note(&format!(
                "by their numbers {} missing between those recorded; their lost frames are not counted",
                counted(view.state.missing_runs as usize, "run is", "runs are")
            ));
        }
        match &view.link.connection {
            Connection::Lost(error) => Err(Failure::refused(format!("{}: {error}", view.link.source))),
            _ => Ok(ExitCode::SUCCESS),
        }
    })
}
