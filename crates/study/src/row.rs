use gyradius_separation::Outcome as Separated;
use nalgebra::{Unit, UnitQuaternion, Vector3};

/// One run of one model.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    pub(crate) run: u64,
    /// I11, I22, I33, I12, I13, I23, kg·m².
    pub(crate) payload: [f64; 6],
    pub(crate) stage: [f64; 6],
    pub(crate) realizable: bool,
    pub(crate) payload_axes: Option<UnitQuaternion<f64>>,
    pub(crate) stage_axes: Option<UnitQuaternion<f64>>,
    /// What came of it, or why nothing did.
    pub(crate) outcome: Result<Outcome, Failure>,
}

/// Why a run failed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Failure {
    /// Without numbers, so that failures of a kind can be counted.
    pub(crate) kind: String,
    pub(crate) reason: String,
}

/// What a run is about; angles in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Outcome {
    pub(crate) release_time_s: f64,
    pub(crate) relative_speed_m_per_s: f64,
    pub(crate) payload_rate_rad_per_s: [f64; 3],
    pub(crate) spin_rate_rad_per_s: f64,
    pub(crate) wobble_deg: f64,
    pub(crate) nutation_deg: Option<f64>,
    pub(crate) nutation_2_deg: Option<f64>,
    pub(crate) nutation_3_deg: Option<f64>,
    pub(crate) cone_deg: Option<f64>,
    pub(crate) inertia_ratio: f64,
}

impl Outcome {
    pub(crate) fn new(separated: &Separated, spin_axis: &Unit<Vector3<f64>>) -> Self {
        let metrics = separated.spin_metrics(spin_axis);
        let degrees = |angle: Option<f64>| angle.map(f64::to_degrees);
        Self {
            release_time_s: separated.release_time(),
            relative_speed_m_per_s: separated.relative_speed(),
            payload_rate_rad_per_s: separated.payload().state().angular_velocity.into(),
            spin_rate_rad_per_s: metrics.spin_rate(),
            wobble_deg: metrics.wobble().to_degrees(),
            nutation_deg: degrees(metrics.nutation()),
            nutation_2_deg: degrees(metrics.nutation_2()),
            nutation_3_deg: degrees(metrics.nutation_3()),
            cone_deg: degrees(metrics.cone()),
            inertia_ratio: metrics.inertia_ratio(),
        }
    }
}

impl Row {
    /// Its number, from 0.
    #[must_use]
    pub fn run(&self) -> u64 {
        self.run
    }

    /// `ok`, or why the run failed.
    #[must_use]
    pub fn status(&self) -> &str {
        self.outcome.as_ref().err().map_or("ok", |failure| failure.reason.as_str())
    }

    /// Whether both drawn inertias are realizable.
    #[must_use]
    pub fn realizable(&self) -> bool {
        self.realizable
    }

    /// The value of a quantity; none if the run failed or it has no meaning for this run.
    #[must_use]
    pub fn value(&self, quantity: Quantity) -> Option<f64> {
        let outcome = self.outcome.as_ref().ok();
        match quantity {
            Quantity::Payload(entry) => Some(self.payload[entry as usize]),
            Quantity::Stage(entry) => Some(self.stage[entry as usize]),
            Quantity::ReleaseTime => outcome.map(|o| o.release_time_s),
            Quantity::RelativeSpeed => outcome.map(|o| o.relative_speed_m_per_s),
            Quantity::PayloadRate(axis) => outcome.map(|o| o.payload_rate_rad_per_s[axis as usize]),
            Quantity::SpinRate => outcome.map(|o| o.spin_rate_rad_per_s),
            Quantity::Wobble => outcome.map(|o| o.wobble_deg),
            Quantity::Nutation => outcome.and_then(|o| o.nutation_deg),
            Quantity::Nutation2 => outcome.and_then(|o| o.nutation_2_deg),
            Quantity::Nutation3 => outcome.and_then(|o| o.nutation_3_deg),
            Quantity::Cone => outcome.and_then(|o| o.cone_deg),
            Quantity::InertiaRatio => outcome.map(|o| o.inertia_ratio),
        }
    }
}

/// An entry of a symmetric matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names are the entries")]
pub enum Entry {
    I11,
    I22,
    I33,
    I12,
    I13,
    I23,
}

impl Entry {
    /// All six, in the order of the run table.
    pub const ALL: [Self; 6] = [Self::I11, Self::I22, Self::I33, Self::I12, Self::I13, Self::I23];
}

/// One of the two bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Body {
    Payload,
    Stage,
}

impl Body {
    pub(crate) const BOTH: [Self; 2] = [Self::Payload, Self::Stage];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Payload => "payload",
            Self::Stage => "stage",
        }
    }

    /// An entry of its inertia matrix.
    pub(crate) fn entry(self, entry: Entry) -> Quantity {
        match self {
            Self::Payload => Quantity::Payload(entry),
            Self::Stage => Quantity::Stage(entry),
        }
    }

    /// The attitude of its principal axes, as drawn.
    pub(crate) fn axes(self, row: &Row) -> Option<UnitQuaternion<f64>> {
        match self {
            Self::Payload => row.payload_axes,
            Self::Stage => row.stage_axes,
        }
    }
}

/// A body axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names are the axes")]
pub enum Axis {
    One,
    Two,
    Three,
}

/// A number that every run has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Entry of the payload's inertia matrix, kg·m².
    Payload(Entry),
    /// Entry of the stage's inertia matrix, kg·m².
    Stage(Entry),
    /// When the last spring let go, s.
    ReleaseTime,
    /// Speed at which the mass centres part, m/s.
    RelativeSpeed,
    /// Angular velocity of the payload after the last release, body axes, rad/s.
    PayloadRate(Axis),
    /// Its magnitude, rad/s.
    SpinRate,
    /// Angle between spin axis and nearest principal axis, deg.
    Wobble,
    /// Angle between that principal axis and angular momentum, deg.
    Nutation,
    /// Extreme of the nutation in the 1-2 plane, deg.
    Nutation2,
    /// Extreme of the nutation in the 1-3 plane, deg.
    Nutation3,
    /// Angle between spin axis and angular momentum, deg.
    Cone,
    /// Inertia ratio, 1.
    InertiaRatio,
}

impl Quantity {
    /// All numeric columns of the run table, in its order.
    pub const ALL: [Self; 24] = [
        Self::Payload(Entry::I11),
        Self::Payload(Entry::I22),
        Self::Payload(Entry::I33),
        Self::Payload(Entry::I12),
        Self::Payload(Entry::I13),
        Self::Payload(Entry::I23),
        Self::Stage(Entry::I11),
        Self::Stage(Entry::I22),
        Self::Stage(Entry::I33),
        Self::Stage(Entry::I12),
        Self::Stage(Entry::I13),
        Self::Stage(Entry::I23),
        Self::ReleaseTime,
        Self::RelativeSpeed,
        Self::PayloadRate(Axis::One),
        Self::PayloadRate(Axis::Two),
        Self::PayloadRate(Axis::Three),
        Self::SpinRate,
        Self::Wobble,
        Self::Nutation,
        Self::Nutation2,
        Self::Nutation3,
        Self::Cone,
        Self::InertiaRatio,
    ];

    /// What the paper's results are about.
    pub const BEHAVIOUR: [Self; 5] =
        [Self::Wobble, Self::Nutation, Self::Cone, Self::InertiaRatio, Self::SpinRate];

    /// Name of the column in the run table, with its unit.
    #[must_use]
    pub fn column(self) -> &'static str {
        const PAYLOAD: [&str; 6] = [
            "payload_i11",
            "payload_i22",
            "payload_i33",
            "payload_i12",
            "payload_i13",
            "payload_i23",
        ];
        const STAGE: [&str; 6] =
            ["stage_i11", "stage_i22", "stage_i33", "stage_i12", "stage_i13", "stage_i23"];
        const RATE: [&str; 3] =
            ["payload_w1_rad_per_s", "payload_w2_rad_per_s", "payload_w3_rad_per_s"];
        match self {
            Self::Payload(entry) => PAYLOAD[entry as usize],
            Self::Stage(entry) => STAGE[entry as usize],
            Self::ReleaseTime => "release_time_s",
            Self::RelativeSpeed => "relative_speed_m_per_s",
            Self::PayloadRate(axis) => RATE[axis as usize],
            Self::SpinRate => "spin_rate_rad_per_s",
            Self::Wobble => "wobble_deg",
            Self::Nutation => "nutation_deg",
            Self::Nutation2 => "nutation_2_deg",
            Self::Nutation3 => "nutation_3_deg",
            Self::Cone => "cone_deg",
            Self::InertiaRatio => "inertia_ratio",
        }
    }

    /// What it is called in tables and figures.
    #[must_use]
    pub fn label(self) -> &'static str {
        const ENTRY: [&str; 6] = ["I₁₁", "I₂₂", "I₃₃", "I₁₂", "I₁₃", "I₂₃"];
        const RATE: [&str; 3] = ["ω₁", "ω₂", "ω₃"];
        match self {
            Self::Payload(entry) | Self::Stage(entry) => ENTRY[entry as usize],
            Self::ReleaseTime => "release time",
            Self::RelativeSpeed => "relative speed",
            Self::PayloadRate(axis) => RATE[axis as usize],
            Self::SpinRate => "spin rate",
            Self::Wobble => "wobble",
            Self::Nutation => "nutation",
            Self::Nutation2 => "nutation θ₂",
            Self::Nutation3 => "nutation θ₃",
            Self::Cone => "cone",
            Self::InertiaRatio => "inertia ratio",
        }
    }

    /// Its unit.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Payload(_) | Self::Stage(_) => "kg·m²",
            Self::ReleaseTime => "s",
            Self::RelativeSpeed => "m/s",
            Self::PayloadRate(_) | Self::SpinRate => "rad/s",
            Self::InertiaRatio => "1",
            _ => "deg",
        }
    }
}
