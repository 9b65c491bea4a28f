//! All files of `rundown gap`: rendered first, then written, so that nothing is written where something cannot be told.

use super::tables;
use super::workflow::Investigation;
use rundown_files::WriteError;
use rundown_files::effect_file::{self, EffectEntry};
use rundown_files::effect_frame;
use rundown_files::track_file::TrackFile;
use rundown_files::train_file::TrainFile;
use std::path::Path;
use std::{fs, io};
use thiserror::Error;

/// A file that cannot be rendered.
#[derive(Debug, Error)]
#[error("{name}: cannot be told: {reason}; nothing was written")]
pub struct RenderError {
    /// The file.
    pub name: &'static str,
    /// Why.
    pub reason: String,
}

/// The files of an output folder, by their names in it.
#[derive(Clone, Debug, Default)]
pub struct Files(Vec<(&'static str, Vec<u8>)>);

impl Files {
    /// Tables, model and frame of what was found, and these texts.
    ///
    /// # Errors
    /// [`RenderError`] names the file.
    pub fn render(
        found: &Investigation,
        (train, track): &(TrainFile, TrackFile),
        texts: [(&'static str, String); 2],
    ) -> Result<Self, RenderError> {
        let mut files = Self(texts.map(|(name, text)| (name, text.into_bytes())).into());
        let name = "model/train.toml";
        files.add(name, toml::to_string(train).map(String::into_bytes))?;
        let name = "model/track.toml";
        files.add(name, toml::to_string(track).map(String::into_bytes))?;
        let name = "effect.frame";
        let effects = effect_file::effects(&track.effect, &train.effect, None);
        let effects = effects.map_err(|error| failed(name, &error))?;
        files.add(name, effect_frame::write(&effects))?;
        files.add("residuals.csv", tables::residuals(&found.findings.rows))?;
        files.add("pulls.csv", tables::pulls(&found.findings.pulls))?;
        files.add("before_after.csv", tables::before_after(found))?;
        Ok(files)
    }

    fn add<B: Into<Vec<u8>>, E: std::fmt::Display>(
        &mut self,
        name: &'static str,
        rendered: Result<B, E>,
    ) -> Result<(), RenderError> {
        let bytes = rendered.map_err(|error| failed(name, &error))?;
        self.0.push((name, bytes.into()));
        Ok(())
    }

    /// Writes them into a folder, which is made when it does not exist.
    ///
    /// # Errors
    /// [`WriteError`] names the first that could not be written.
    pub fn write(&self, out: &Path) -> Result<(), WriteError> {
        let at = |path: &Path| {
            let path = path.to_owned();
            move |source| WriteError { path, source }
        };
        // All folders first: where one cannot be made, or one lies in the way, nothing is written.
        for (name, _) in &self.0 {
            let path = out.join(name);
            let folder = path.parent().unwrap_or(out);
            fs::create_dir_all(folder).map_err(at(folder))?;
        }
        if let Some(path) = self.0.iter().map(|(name, _)| out.join(name)).find(|path| path.is_dir()) {
            let source = io::Error::from(io::ErrorKind::IsADirectory);
            return Err(WriteError { path, source });
        }
        for (name, bytes) in &self.0 {
            let path = out.join(name);
            fs::write(&path, bytes).map_err(at(&path))?;
        }
        Ok(())
    }
}

fn failed(name: &'static str, error: &impl std::fmt::Display) -> RenderError {
    RenderError { name, reason: error.to_string() }
}

/// Train and track with what was found, in place of effects that they had: these took no part in the analysis.
pub fn repaired(found: &Investigation, train: &TrainFile, track: &TrackFile) -> (TrainFile, TrackFile) {
    let (mut train, mut track) = (train.clone(), track.clone());
    train.effect.clear();
    track.effect.clear();
    for one in &found.named {
        let entry = EffectEntry { effect: one.effect.clone(), runs: (!one.runs.is_empty()).then(|| one.runs.clone()) };
        match one.effect.section_m() {
            Some(_) => track.effect.push(entry),
            None => train.effect.push(entry),
        }
    }
    (train, track)
}
