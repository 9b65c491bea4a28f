//! What is said of gradients that look wrong.

use super::mixture::MOST_SD_N_PER_KG;
use super::version::Version;
use rundown::tick::track_doubt::TrackDoubtConfig;
use rundown_files::track_file::MOST_SD_PERMILLE;
use serde::Serialize;
use std::fmt;

/// Coasts are explained where they scatter by less than this share of the most that is taken for coasting.
const EXPLAINED: f64 = 0.9;

/// What shows that gradients are off.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SeenBy {
    /// Accelerations beside measured efforts.
    Efforts,
    /// Coasts, which gain and lose speed.
    Coasts,
}

impl SeenBy {
    /// In a sentence.
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::Efforts => "the accelerations beside the efforts",
            Self::Coasts => "coasts",
        }
    }
}

/// The described gradients look wrong.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Doubt {
    /// What explains the coasts, or the accelerations beside the efforts, best.
    pub better: Version,
    /// Which of the two.
    pub seen_by: SeenBy,
    /// Scatter of coasted stretches, or accelerations, with it, standard deviation, N/kg.
    pub sd_n_per_kg: f64,
    /// Scatter of the same stretches with the gradients as described, N/kg.
    pub described_sd_n_per_kg: f64,
    /// Log-likelihood of the better version less that of the described one; none by efforts, and where the slopes are
    /// by place, whose shape is not fitted.
    pub log_likelihood: Option<f64>,
    /// By how many standard errors over the places of the line.
    pub z: f64,
    /// Stretches of 20 s that are coasted, or windows of 10 s with a steady effort.
    pub stretches: usize,
    /// By how much the described gradients are off, root mean square over these stretches, permille;
    /// by efforts twice that, for errors that follow the slopes do not average out.
    pub off_permille: f64,
}

impl Doubt {
    /// Until the gradients are put right they are taken to be off by as much.
    pub fn raise(&self, doubt: &mut TrackDoubtConfig) {
        let sd_permille = &mut doubt.gradient_sd_permille;
        *sd_permille = sd_permille.max(self.off_permille.min(MOST_SD_PERMILLE));
    }

    /// The described slopes have the wrong sign or scale: with another one they leave no more scatter than coasts have,
    /// and as described they leave more. No other version decides: short hops on a right line at times look like a
    /// level line, which a tenth all but is, or another place. How many times as steep is known from efforts, beside
    /// any resistance.
    pub fn is_decisive(&self) -> bool {
        let scaled = match self.better {
            Version::SignTurned | Version::PerCent | Version::TwiceOfIt | Version::HalfOfIt => true,
            Version::Times(_) => return true,
            Version::Described
            | Version::TenthOfIt
            | Version::Level
            | Version::ByPlace
            | Version::OtherEnd
            | Version::Shifted(_) => false,
        };
        scaled && explains(self.sd_n_per_kg) && !explains(self.described_sd_n_per_kg)
    }
}

/// Coasts on the right gradients scatter by no more.
pub fn explains(sd_n_per_kg: f64) -> bool {
    sd_n_per_kg < EXPLAINED * MOST_SD_N_PER_KG
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { better, sd_n_per_kg: sd, described_sd_n_per_kg: described, stretches, z, .. } = self;
        if self.seen_by == SeenBy::Efforts {
            return write!(
                f,
                "gradients look wrong: {better} they would explain what measured efforts do: the accelerations of \
                 {stretches} windows of 10 s scatter by {sd:.4} in place of {described:.4} N/kg (z = {z:.0})"
            );
        }
        write!(
            f,
            "gradients look wrong: {better} they would explain the coasts: {stretches} stretches of 20 s scatter by \
             {sd:.4} in place of {described:.4} N/kg, "
        )?;
        match self.log_likelihood {
            Some(ratio) => write!(f, "log-likelihood ratio {ratio:.0}, and both halves of the runs agree"),
            None => {
                let again = (described * described - sd * sd).max(0.0).sqrt();
                write!(f, "{again:.4} N/kg of it come again at their places in other runs (z = {z:.1})")
            }
        }
    }
}
