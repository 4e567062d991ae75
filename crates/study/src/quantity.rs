use std::borrow::Cow;

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
}

/// An axis of a body or of the inertial frame.
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
    /// From when on no spring can push, s: when the last one let go, or, late, came to its free length.
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
    /// Extreme of the nutation in the 1-2 plane, deg, above 90 for a backward spin; none where the
    /// momentum circles another axis.
    Nutation2,
    /// Extreme of the nutation in the 1-3 plane, deg, likewise.
    Nutation3,
    /// Angle between spin axis and angular momentum, deg.
    Cone,
    /// Inertia ratio, 1.
    InertiaRatio,
    /// Velocity of the payload's mass centre relative to the stage's, inertial axes, m/s.
    RelativeVelocity(Axis),
    /// Angle between it and the intended direction of separation, deg.
    DirectionError,
    /// Change of the payload's angular velocity from the start, body axes, deg/s.
    PayloadTipOff(Axis),
    /// Change of the stage's angular velocity from the start, body axes, deg/s.
    StageTipOff(Axis),
    /// Least nutation of the free motion, deg.
    NutationLeast,
    /// Greatest nutation of the free motion, deg.
    NutationGreatest,
    /// Nutation at the start, deg.
    NutationBefore,
    /// Least nutation if the payload had gone on as it started, deg.
    NutationLeastBefore,
    /// Greatest nutation if the payload had gone on as it started, deg.
    NutationGreatestBefore,
    /// Angular momentum of the payload about its mass centre, inertial axes, kg·m²/s.
    Momentum(Axis),
    /// Angle between it and its intended direction, deg.
    MomentumError,
    /// Energy that the springs had stored, J.
    SpringEnergy,
    /// What of it went into the payload's translation, J.
    PayloadTranslation,
    /// Into the payload's rotation, J.
    PayloadRotation,
    /// Into the stage's translation, J.
    StageTranslation,
    /// Into the stage's rotation, J.
    StageRotation,
    /// Smallest distance of the outlines over the coast, m; 0 if any two of them touch. Outlines that
    /// touch at the start count only if they touch again.
    Clearance,
    /// When that is, s.
    ClearanceTime,
    /// When outlines first touch, s.
    RecontactTime,
    /// When a spring let go, s, none if it never pushed; springs from 0.
    SpringRelease(usize),
}

impl Quantity {
    /// All but those of single springs, in the order of the run table.
    pub const ALL: [Self; 51] = {
        use Axis::{One, Three, Two};
        [
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
            Self::PayloadRate(One),
            Self::PayloadRate(Two),
            Self::PayloadRate(Three),
            Self::SpinRate,
            Self::Wobble,
            Self::Nutation,
            Self::Nutation2,
            Self::Nutation3,
            Self::Cone,
            Self::InertiaRatio,
            Self::RelativeVelocity(One),
            Self::RelativeVelocity(Two),
            Self::RelativeVelocity(Three),
            Self::DirectionError,
            Self::PayloadTipOff(One),
            Self::PayloadTipOff(Two),
            Self::PayloadTipOff(Three),
            Self::StageTipOff(One),
            Self::StageTipOff(Two),
            Self::StageTipOff(Three),
            Self::NutationLeast,
            Self::NutationGreatest,
            Self::NutationBefore,
            Self::NutationLeastBefore,
            Self::NutationGreatestBefore,
            Self::Momentum(One),
            Self::Momentum(Two),
            Self::Momentum(Three),
            Self::MomentumError,
            Self::SpringEnergy,
            Self::PayloadTranslation,
            Self::PayloadRotation,
            Self::StageTranslation,
            Self::StageRotation,
            Self::Clearance,
            Self::ClearanceTime,
            Self::RecontactTime,
        ]
    };

    /// How many of [`ALL`](Self::ALL) come before `realizable` in the run table; the rest come after the
    /// attitudes.
    pub(crate) const FIRST: usize = 24;

    /// All of them, of a separation by so many springs.
    pub fn of(springs: usize) -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().chain((0..springs).map(Self::SpringRelease))
    }

    /// What the paper's results are about.
    pub const BEHAVIOUR: [Self; 5] =
        [Self::Wobble, Self::Nutation, Self::Cone, Self::InertiaRatio, Self::SpinRate];

    /// How the bodies part: what a separation analyst asks for.
    pub const PARTING: [Self; 12] = [
        Self::RelativeSpeed,
        Self::DirectionError,
        Self::PayloadTipOff(Axis::One),
        Self::PayloadTipOff(Axis::Two),
        Self::PayloadTipOff(Axis::Three),
        Self::StageTipOff(Axis::One),
        Self::StageTipOff(Axis::Two),
        Self::StageTipOff(Axis::Three),
        Self::NutationGreatest,
        Self::MomentumError,
        Self::ReleaseTime,
        Self::Clearance,
    ];

    /// Name of the column in the run table, with its unit.
    #[must_use]
    pub fn column(self) -> Cow<'static, str> {
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
        const VELOCITY: [&str; 3] =
            ["relative_v1_m_per_s", "relative_v2_m_per_s", "relative_v3_m_per_s"];
        const PAYLOAD_TIP_OFF: [&str; 3] = [
            "payload_tip_off_1_deg_per_s",
            "payload_tip_off_2_deg_per_s",
            "payload_tip_off_3_deg_per_s",
        ];
        const STAGE_TIP_OFF: [&str; 3] =
            ["stage_tip_off_1_deg_per_s", "stage_tip_off_2_deg_per_s", "stage_tip_off_3_deg_per_s"];
        const MOMENTUM: [&str; 3] =
            ["payload_h1_kg_m2_per_s", "payload_h2_kg_m2_per_s", "payload_h3_kg_m2_per_s"];
        let plain = match self {
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
            Self::RelativeVelocity(axis) => VELOCITY[axis as usize],
            Self::DirectionError => "direction_error_deg",
            Self::PayloadTipOff(axis) => PAYLOAD_TIP_OFF[axis as usize],
            Self::StageTipOff(axis) => STAGE_TIP_OFF[axis as usize],
            Self::NutationLeast => "nutation_least_deg",
            Self::NutationGreatest => "nutation_greatest_deg",
            Self::NutationBefore => "nutation_before_deg",
            Self::NutationLeastBefore => "nutation_least_before_deg",
            Self::NutationGreatestBefore => "nutation_greatest_before_deg",
            Self::Momentum(axis) => MOMENTUM[axis as usize],
            Self::MomentumError => "momentum_error_deg",
            Self::SpringEnergy => "spring_energy_j",
            Self::PayloadTranslation => "payload_translation_j",
            Self::PayloadRotation => "payload_rotation_j",
            Self::StageTranslation => "stage_translation_j",
            Self::StageRotation => "stage_rotation_j",
            Self::Clearance => "clearance_m",
            Self::ClearanceTime => "clearance_time_s",
            Self::RecontactTime => "recontact_s",
            Self::SpringRelease(spring) => {
                return format!("spring_{}_release_s", spring + 1).into();
            }
        };
        plain.into()
    }

    /// What it is called in tables and figures.
    #[must_use]
    pub fn label(self) -> Cow<'static, str> {
        const ENTRY: [&str; 6] = ["I₁₁", "I₂₂", "I₃₃", "I₁₂", "I₁₃", "I₂₃"];
        const RATE: [&str; 3] = ["ω₁", "ω₂", "ω₃"];
        const VELOCITY: [&str; 3] = ["relative v₁", "relative v₂", "relative v₃"];
        const PAYLOAD_TIP_OFF: [&str; 3] =
            ["payload tip-off ω₁", "payload tip-off ω₂", "payload tip-off ω₃"];
        const STAGE_TIP_OFF: [&str; 3] =
            ["stage tip-off ω₁", "stage tip-off ω₂", "stage tip-off ω₃"];
        const MOMENTUM: [&str; 3] = ["momentum h₁", "momentum h₂", "momentum h₃"];
        let plain = match self {
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
            Self::RelativeVelocity(axis) => VELOCITY[axis as usize],
            Self::DirectionError => "direction error",
            Self::PayloadTipOff(axis) => PAYLOAD_TIP_OFF[axis as usize],
            Self::StageTipOff(axis) => STAGE_TIP_OFF[axis as usize],
            Self::NutationLeast => "least nutation",
            Self::NutationGreatest => "greatest nutation",
            Self::NutationBefore => "nutation before",
            Self::NutationLeastBefore => "least nutation before",
            Self::NutationGreatestBefore => "greatest nutation before",
            Self::Momentum(axis) => MOMENTUM[axis as usize],
            Self::MomentumError => "momentum error",
            Self::SpringEnergy => "spring energy",
            Self::PayloadTranslation => "payload translation",
            Self::PayloadRotation => "payload rotation",
            Self::StageTranslation => "stage translation",
            Self::StageRotation => "stage rotation",
            Self::Clearance => "clearance",
            Self::ClearanceTime => "time of clearance",
            Self::RecontactTime => "recontact",
            Self::SpringRelease(spring) => {
                return format!("release of spring {}", spring + 1).into();
            }
        };
        plain.into()
    }

    /// Its unit.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Payload(_) | Self::Stage(_) => "kg·m²",
            Self::ReleaseTime
            | Self::SpringRelease(_)
            | Self::ClearanceTime
            | Self::RecontactTime => "s",
            Self::Clearance => "m",
            Self::RelativeSpeed | Self::RelativeVelocity(_) => "m/s",
            Self::PayloadRate(_) | Self::SpinRate => "rad/s",
            Self::PayloadTipOff(_) | Self::StageTipOff(_) => "deg/s",
            Self::Momentum(_) => "kg·m²/s",
            Self::SpringEnergy
            | Self::PayloadTranslation
            | Self::PayloadRotation
            | Self::StageTranslation
            | Self::StageRotation => "J",
            Self::InertiaRatio => "1",
            _ => "deg",
        }
    }
}
