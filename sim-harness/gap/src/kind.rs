//! Kinds of effects.

/// A kind of effect, in the order of the catalogue.
#[allow(missing_docs)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum EffectKind {
    TunnelDrag,
    CurveResistance,
    GradientError,
    SteadyWind,
    RunWind,
    MassError,
    DraggingBrake,
    PowerLimitSection,
    TractionScale,
    LowAdhesion,
    SpeedScale,
    LocationLag,
    TemperatureResistance,
    SeasonalDrift,
    BrakeFade,
    TrainLengthError,
    WarmUp,
    DavisError,
    Unknown,
}
