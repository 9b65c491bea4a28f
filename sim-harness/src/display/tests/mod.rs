//! Does a display find every frame that came, and survive everything else?

mod screen;
mod sources;
mod state;

use super::{demo, hub::Hub, setup::Setup, source::FrameSource};
use rundown::link::serial;
use rundown_wire::{Body, Downlink};
use std::path::PathBuf;
use std::sync::{Arc, LazyLock};

/// Messages of two simulated runs.
pub(super) static MESSAGES: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
    let mut messages = Vec::new();
    demo::play_runs(2, |message| messages.push(message.to_vec())).unwrap();
    messages
});

fn on_the_line(messages: &[Vec<u8>]) -> Vec<u8> {
    messages.iter().flat_map(|message| serial::encode(message).unwrap()).collect()
}

fn hub() -> Arc<Hub> {
    Arc::new(Hub::new("test".to_owned(), 1.0, Setup::default(), Box::new(|_, _| {})))
}

fn file(bytes: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames");
    std::fs::write(&path, bytes).unwrap();
    (folder, path)
}

/// A recording through the display, at once.
fn shown(bytes: &[u8]) -> Arc<Hub> {
    let (_folder, path) = file(bytes);
    let hub = hub();
    let source = FrameSource::File { path, follow: false };
    source.open().unwrap().run(&hub, None);
    hub
}

fn estimates(messages: &[Vec<u8>]) -> Vec<f64> {
    let time_s = |message: &Vec<u8>| match Downlink::decode(message).unwrap().body {
        Body::Estimate(estimate) => Some(estimate.time_s),
        _ => None,
    };
    messages.iter().filter_map(time_s).collect()
}
