//! Train and track as described to the board: the other direction of a recording of `rundown link --record`.
//!
//! In: messages to the board. Out: a [`Setup`] whenever a run begins, for then the description is whole. A display has
//! no key: the MAC is the board's affair, and what it refused is no description of its run.

use super::setup::Setup;
use rundown::onboard::auth::TRAILER;
use rundown::uplink::{self, Command, OPEN, Request, SECURED, VERSION};
use rundown_files::track_file::{SpeedLimit, Stop, TrackFile};
use rundown_files::train_file::TrainFile;

const NAME: &str = "as described to the board";

#[derive(Clone, Debug, Default)]
pub struct SentSetup {
    setup: Setup,
}

impl SentSetup {
    /// Takes a message; the description of the run that begins with it, if one does.
    pub fn hear(&mut self, message: &[u8]) -> Option<&Setup> {
        match request(message)? {
            Request::Train(frame) => self.setup.train = Some(TrainFile::of(NAME, &frame.description)),
            Request::Track(part) => {
                if part.first == 0 {
                    self.setup.track =
                        Some(TrackFile { name: NAME.to_owned(), length_m: part.length_m, ..TrackFile::default() });
                }
                self.setup.track.as_mut()?.gradient.extend(part.gradients.iter().copied());
            }
            Request::Targets(part) => {
                let track = self.setup.track.as_mut()?;
                if part.first == 0 {
                    track.speed_limit.clear();
                    track.stop.clear();
                }
                for target in &part.targets {
                    match target.limit_mps {
                        Some(limit_mps) => {
                            track.speed_limit.push(SpeedLimit { from_m: target.at_m, kmh: 3.6 * limit_mps })
                        }
                        // A board knows no names.
                        None => {
                            track.stop.push(Stop { at_m: target.at_m, name: format!("stop {}", track.stop.len() + 1) })
                        }
                    }
                }
            }
            Request::Command(Command::Begin { .. }) => return Some(&self.setup),
            _ => {}
        }
        None
    }
}

fn request(message: &[u8]) -> Option<Request> {
    let payload = match message {
        [VERSION, OPEN, payload @ ..] => payload,
        [VERSION, SECURED, secured @ ..] => secured.split_last_chunk::<TRAILER>()?.0,
        _ => return None,
    };
    uplink::decode(payload).map(|uplink| uplink.request)
}
