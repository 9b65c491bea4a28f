//! What nearly every test names: `use host_tests::prelude::*;`.

pub use board_tests::prelude::*;
pub use rundown_files::recording::{DirectionChoice, Recording};
pub use rundown_files::run_log::{BadRows, RunLog};
pub use rundown_files::run_set::RunSet;
pub use rundown_files::sample::Sample;
pub use rundown_files::track_file::TrackFile;
pub use rundown_files::train_file::TrainFile;
pub use std::path::{Path, PathBuf};
