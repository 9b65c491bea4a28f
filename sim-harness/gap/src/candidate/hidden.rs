//! What the bench hides, by its size.

use rand_chacha::ChaCha8Rng;
use rundown::model::resistance::Davis;

/// How large an effect is that the bench hides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum HiddenSize {
    /// Well above the noise.
    Clear,
    /// Between the two.
    Medium,
    /// At the limit of what data of this size show.
    Faint,
}

/// What the bench has drawn of a set when it hides an effect.
pub struct Hide<'a> {
    /// How large the effect is.
    pub size: HiddenSize,
    /// Where an effect of a section acts, m.
    pub section_m: [f64; 2],
    /// Of effects that may have either.
    pub sign: f64,
    /// The true coefficients.
    pub davis: Davis,
    /// The described length of the train, m.
    pub length_m: f64,
    /// For all else.
    pub rng: &'a mut ChaCha8Rng,
}

impl Hide<'_> {
    /// By size: clear, medium, faint.
    pub fn of(&self, values: [f64; 3]) -> f64 {
        values[self.size as usize]
    }
}
