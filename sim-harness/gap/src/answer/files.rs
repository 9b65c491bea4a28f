//! All files of `rundown gap`: rendered first, then written, so that nothing is written where something cannot be
//! rendered.

use crate::answer::report::{page, run_pages as pages_of_runs};
use crate::answer::{tables, whole::Answer};
use rundown_files::folder::{self, Provenance};
use rundown_files::{WriteError, effect_file, effect_frame};
use rundown_pages::{assets::SCRIPT, run_pages};
use std::{borrow::Cow, fs, path::Path};
use thiserror::Error;

/// A file that cannot be rendered.
#[derive(Debug, Error)]
#[error("{name}: cannot be written: {reason}; nothing was written")]
pub struct RenderError {
    /// The file.
    pub name: &'static str,
    /// Why.
    pub reason: String,
}

/// The files of an output folder, by their names in it.
#[derive(Clone, Debug, Default)]
pub struct Files(Vec<(Cow<'static, str>, Vec<u8>)>);

/// Why an answer is not in its folder.
#[derive(Debug, Error)]
#[error(transparent)]
pub enum AnswerError {
    /// A file cannot be rendered.
    Render(#[from] RenderError),
    /// A file cannot be written.
    Write(#[from] WriteError),
}

impl Answer {
    /// As text: `gap.json`.
    pub fn json_text(&self) -> String {
        format!("{:#}\n", self.json())
    }

    /// Writes all files into a folder, which is made when it does not exist.
    ///
    /// # Errors
    /// [`AnswerError`] names the first file that cannot be rendered, and then nothing was written, or cannot be
    /// written.
    pub fn write(&self, folder: &Path, has_run_pages: bool) -> Result<(), AnswerError> {
        Ok(Files::render(self, has_run_pages)?.write(folder, &self.input.provenance)?)
    }
}

impl Files {
    /// Tables, model, frame and texts of an answer.
    ///
    /// # Errors
    /// [`RenderError`] names the file.
    pub fn render(answer: &Answer, has_run_pages: bool) -> Result<Self, RenderError> {
        let (train, track) = answer.model();
        let texts = [("gap.json", answer.json_text()), ("report.html", page(answer, has_run_pages))];
        let mut files = Self(texts.map(|(name, text)| (name.into(), text.into_bytes())).into());
        if has_run_pages {
            let script = format!("{}/{}", run_pages::FOLDER, run_pages::SCRIPT_FILE);
            files.0.push((script.into(), SCRIPT.as_bytes().to_vec()));
            let of_runs = pages_of_runs(answer).into_iter().enumerate();
            files.0.extend(of_runs.map(|(index, text)| (run_pages::file(index).into(), text.into_bytes())));
        }
        files.add("model/train.toml", toml::to_string(&train).map(String::into_bytes))?;
        files.add("model/track.toml", toml::to_string(&track).map(String::into_bytes))?;
        let name = "effect.frame";
        let effects = effect_file::effects(&track.effect, &train.effect, None);
        let effects = effects.map_err(|error| failed(name, &error))?;
        files.add(name, effect_frame::write(&effects))?;
        let tables = tables::files(answer).map_err(|error| failed("residuals.csv", &error))?;
        files.0.extend(tables.map(|(name, bytes)| (name.into(), bytes)));
        Ok(files)
    }

    fn add<B: Into<Vec<u8>>, E: std::fmt::Display>(
        &mut self,
        name: &'static str,
        rendered: Result<B, E>,
    ) -> Result<(), RenderError> {
        let bytes = rendered.map_err(|error| failed(name, &error))?;
        self.0.push((name.into(), bytes.into()));
        Ok(())
    }

    /// Writes them into a folder, all or none.
    ///
    /// # Errors
    /// [`WriteError`] names the first that could not be written.
    pub fn write(&self, out: &Path, provenance: &Provenance) -> Result<(), WriteError> {
        folder::write("gap", out, provenance, |folder| {
            for (name, bytes) in &self.0 {
                let path = folder.join(name.as_ref());
                let made = path.parent().map_or(Ok(()), fs::create_dir_all);
                made.and_then(|()| fs::write(&path, bytes)).map_err(|source| WriteError { path, source })?;
            }
            Ok(())
        })
    }
}

fn failed(name: &'static str, error: &impl std::fmt::Display) -> RenderError {
    RenderError { name, reason: error.to_string() }
}
