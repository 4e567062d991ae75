//! Every number of a run, each declared in one place: its column, what it is called, its unit, where the report shows
//! it, what it means and how it follows from a run.

use gyradius_campaign::{Row, Table};
use gyradius_report::with_unit;
use gyradius_separation::{AnyLoad, LoadId, LoadKind, Separation};
use std::borrow::Cow;

use crate::{
    body::{Body, Entry},
    run::Run,
};

/// Where the report tells of a quantity, and in which place there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Shown {
    /// Nowhere: it is drawn, and is in the run table, the summary and the draws.
    Drawn,
    /// Nowhere: it is in the run table and the summary.
    Table,
    /// Among what the paper's results are about.
    Behaviour(u8),
    /// Among how the bodies part.
    Parting(u8),
}

struct Declaration {
    column: &'static str,
    label: &'static str,
    unit: &'static str,
    shown: Shown,
    meaning: &'static str,
}

/// Declares quantities, in the order of the run table: the meaning, then
/// `name: column, label, unit, shown, how it follows from a run`.
macro_rules! quantities {
    ($($(#[doc = $meaning:literal])+ $name:ident:
        $column:literal, $label:literal, $unit:literal, $shown:expr, $of:expr;)+) => {
        /// A number that a run has.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Quantity {
            $($(#[doc = $meaning])+ $name,)+
            /// When a load, a spring say, let go; none if it never pushed, a late one too.
            Release(LoadId),
        }

        impl Quantity {
            /// All but those of single loads, in the order of the run table.
            pub const ALL: &'static [Self] = &[$(Self::$name),+];

            fn declaration(self) -> &'static Declaration {
                use Shown::{Behaviour, Drawn, Parting, Table};
                match self {
                    $(Self::$name => const {
                        &Declaration {
                            column: $column,
                            label: $label,
                            unit: $unit,
                            shown: $shown,
                            meaning: concat!($($meaning),+),
                        }
                    },)+
                    // With the load in the place of the braces.
                    Self::Release(_) => const {
                        &Declaration {
                            column: "{}_release_s",
                            label: "release of {}",
                            unit: "s",
                            shown: Table,
                            meaning: " When the {} let go; none if it never pushed, a late one too.",
                        }
                    },
                }
            }

            /// Its value in a run; none if the run failed or it has no meaning for this run.
            pub(crate) fn value(self, run: &Run<'_>) -> Option<f64> {
                let of: fn(&Run<'_>) -> Option<f64> = match self {
                    $(Self::$name => $of,)+
                    Self::Release(load) => {
                        let place = run.case.separation.as_ref().ok()?.place(load)?;
                        return run.end()?.separated.release_times().nth(place)?;
                    }
                };
                of(run)
            }
        }
    };
}

quantities! {
    /// Entry 11 of the payload's inertia matrix as drawn, about its mass centre, body axes.
    PayloadI11: "payload_i11", "I₁₁", "kg·m²", Drawn, |r| Some(r.inertia(Body::Payload)[0]);
    /// Entry 22 of the payload's inertia matrix as drawn, about its mass centre, body axes.
    PayloadI22: "payload_i22", "I₂₂", "kg·m²", Drawn, |r| Some(r.inertia(Body::Payload)[1]);
    /// Entry 33 of the payload's inertia matrix as drawn, about its mass centre, body axes.
    PayloadI33: "payload_i33", "I₃₃", "kg·m²", Drawn, |r| Some(r.inertia(Body::Payload)[2]);
    /// Entry 12 of the payload's inertia matrix as drawn, about its mass centre, body axes.
    PayloadI12: "payload_i12", "I₁₂", "kg·m²", Drawn, |r| Some(r.inertia(Body::Payload)[3]);
    /// Entry 13 of the payload's inertia matrix as drawn, about its mass centre, body axes.
    PayloadI13: "payload_i13", "I₁₃", "kg·m²", Drawn, |r| Some(r.inertia(Body::Payload)[4]);
    /// Entry 23 of the payload's inertia matrix as drawn, about its mass centre, body axes.
    PayloadI23: "payload_i23", "I₂₃", "kg·m²", Drawn, |r| Some(r.inertia(Body::Payload)[5]);
    /// Entry 11 of the stage's inertia matrix as drawn, about its mass centre, body axes.
    StageI11: "stage_i11", "I₁₁", "kg·m²", Drawn, |r| Some(r.inertia(Body::Stage)[0]);
    /// Entry 22 of the stage's inertia matrix as drawn, about its mass centre, body axes.
    StageI22: "stage_i22", "I₂₂", "kg·m²", Drawn, |r| Some(r.inertia(Body::Stage)[1]);
    /// Entry 33 of the stage's inertia matrix as drawn, about its mass centre, body axes.
    StageI33: "stage_i33", "I₃₃", "kg·m²", Drawn, |r| Some(r.inertia(Body::Stage)[2]);
    /// Entry 12 of the stage's inertia matrix as drawn, about its mass centre, body axes.
    StageI12: "stage_i12", "I₁₂", "kg·m²", Drawn, |r| Some(r.inertia(Body::Stage)[3]);
    /// Entry 13 of the stage's inertia matrix as drawn, about its mass centre, body axes.
    StageI13: "stage_i13", "I₁₃", "kg·m²", Drawn, |r| Some(r.inertia(Body::Stage)[4]);
    /// Entry 23 of the stage's inertia matrix as drawn, about its mass centre, body axes.
    StageI23: "stage_i23", "I₂₃", "kg·m²", Drawn, |r| Some(r.inertia(Body::Stage)[5]);
    /// From when on no spring can push: when the last one let go, or, late, came to its release length.
    ReleaseTime: "release_time_s", "release time", "s", Parting(10), |r| Some(r.end()?.separated.release_time());
    /// Speed at which the mass centres part.
    RelativeSpeed: "relative_speed_m_per_s", "relative speed", "m/s", Parting(0), |r| Some(r.end()?.separated.relative_speed());
    /// Angular velocity of the payload about its body axis 1 after the last release.
    PayloadRate1: "payload_w1_rad_per_s", "ω₁", "rad/s", Table, |r| Some(r.end()?.separated.payload().state().angular_velocity[0]);
    /// Angular velocity of the payload about its body axis 2 after the last release.
    PayloadRate2: "payload_w2_rad_per_s", "ω₂", "rad/s", Table, |r| Some(r.end()?.separated.payload().state().angular_velocity[1]);
    /// Angular velocity of the payload about its body axis 3 after the last release.
    PayloadRate3: "payload_w3_rad_per_s", "ω₃", "rad/s", Table, |r| Some(r.end()?.separated.payload().state().angular_velocity[2]);
    /// Magnitude of the payload's angular velocity after the last release.
    SpinRate: "spin_rate_rad_per_s", "spin rate", "rad/s", Behaviour(4), |r| Some(r.end()?.spin.spin_rate());
    /// Angle between the spin axis and the nearest principal axis, Eq. 33; every axis in the plane of two equal moments is principal, and of three equal moments every axis.
    Wobble: "wobble_deg", "wobble", "deg", Behaviour(0), |r| Some(r.end()?.spin.wobble().to_degrees());
    /// Angle between the principal axis nearest to the spin axis and the angular momentum at the last release, Eq. 34; above 90 for a backward spin; none where the payload does not turn.
    Nutation: "nutation_deg", "nutation", "deg", Behaviour(1), |r| r.end()?.spin.nutation().map(f64::to_degrees);
    /// Extreme of the nutation in the 1-2 plane, Eq. 35; none where the momentum circles another axis.
    Nutation2: "nutation_2_deg", "nutation θ₂", "deg", Table, |r| r.end()?.spin.nutation_2().map(f64::to_degrees);
    /// Extreme of the nutation in the 1-3 plane, Eq. 35; none where the momentum circles another axis.
    Nutation3: "nutation_3_deg", "nutation θ₃", "deg", Table, |r| r.end()?.spin.nutation_3().map(f64::to_degrees);
    /// Angle between the spin axis and the angular momentum, Eq. 36; none where the payload does not turn.
    Cone: "cone_deg", "cone", "deg", Behaviour(2), |r| r.end()?.spin.cone().map(f64::to_degrees);
    /// Inertia ratio of the payload, Eq. 37; none of a rod that spins across its own axis.
    InertiaRatio: "inertia_ratio", "inertia ratio", "1", Behaviour(3), |r| r.end()?.spin.inertia_ratio();
    /// Velocity of the payload's mass centre from the stage's along inertial axis 1, after the last release.
    RelativeVelocity1: "relative_v1_m_per_s", "relative v₁", "m/s", Table, |r| Some(r.end()?.separated.relative_velocity()[0]);
    /// Velocity of the payload's mass centre from the stage's along inertial axis 2, after the last release.
    RelativeVelocity2: "relative_v2_m_per_s", "relative v₂", "m/s", Table, |r| Some(r.end()?.separated.relative_velocity()[1]);
    /// Velocity of the payload's mass centre from the stage's along inertial axis 3, after the last release.
    RelativeVelocity3: "relative_v3_m_per_s", "relative v₃", "m/s", Table, |r| Some(r.end()?.separated.relative_velocity()[2]);
    /// Angle between the relative velocity after the last release and `separation_direction`; none if there is none, or the bodies do not part.
    DirectionError: "direction_error_deg", "direction error", "deg", Parting(1), |r| r.end()?.direction_error().map(f64::to_degrees);
    /// Angular velocity of the payload after the last release less that at the start, about its body axis 1.
    PayloadTipOff1: "payload_tip_off_1_deg_per_s", "payload tip-off ω₁", "deg/s", Parting(2), |r| Some(r.end()?.tip_off[0][0].to_degrees());
    /// Angular velocity of the payload after the last release less that at the start, about its body axis 2.
    PayloadTipOff2: "payload_tip_off_2_deg_per_s", "payload tip-off ω₂", "deg/s", Parting(3), |r| Some(r.end()?.tip_off[0][1].to_degrees());
    /// Angular velocity of the payload after the last release less that at the start, about its body axis 3.
    PayloadTipOff3: "payload_tip_off_3_deg_per_s", "payload tip-off ω₃", "deg/s", Parting(4), |r| Some(r.end()?.tip_off[0][2].to_degrees());
    /// Angular velocity of the stage after the last release less that at the start, about its body axis 1.
    StageTipOff1: "stage_tip_off_1_deg_per_s", "stage tip-off ω₁", "deg/s", Parting(5), |r| Some(r.end()?.tip_off[1][0].to_degrees());
    /// Angular velocity of the stage after the last release less that at the start, about its body axis 2.
    StageTipOff2: "stage_tip_off_2_deg_per_s", "stage tip-off ω₂", "deg/s", Parting(6), |r| Some(r.end()?.tip_off[1][1].to_degrees());
    /// Angular velocity of the stage after the last release less that at the start, about its body axis 3.
    StageTipOff3: "stage_tip_off_3_deg_per_s", "stage tip-off ω₃", "deg/s", Parting(7), |r| Some(r.end()?.tip_off[1][2].to_degrees());
    /// Least nutation of the free motion after the last release, by energy and momentum.
    NutationLeast: "nutation_least_deg", "least nutation", "deg", Table, |r| Some(r.end()?.spin.nutation_bounds()?[0].to_degrees());
    /// Greatest nutation of the free motion after the last release, by energy and momentum.
    NutationGreatest: "nutation_greatest_deg", "greatest nutation", "deg", Parting(8), |r| Some(r.end()?.spin.nutation_bounds()?[1].to_degrees());
    /// Nutation at the start; none at rest.
    NutationBefore: "nutation_before_deg", "nutation before", "deg", Table, |r| r.end()?.spin_before.nutation().map(f64::to_degrees);
    /// Least nutation if the payload had gone on as it started.
    NutationLeastBefore: "nutation_least_before_deg", "least nutation before", "deg", Table, |r| Some(r.end()?.spin_before.nutation_bounds()?[0].to_degrees());
    /// Greatest nutation if the payload had gone on as it started.
    NutationGreatestBefore: "nutation_greatest_before_deg", "greatest nutation before", "deg", Table, |r| Some(r.end()?.spin_before.nutation_bounds()?[1].to_degrees());
    /// Angular momentum of the payload about its mass centre along inertial axis 1, after the last release.
    Momentum1: "payload_h1_kg_m2_per_s", "momentum h₁", "kg·m²/s", Table, |r| Some(r.end()?.momentum[0]);
    /// Angular momentum of the payload about its mass centre along inertial axis 2, after the last release.
    Momentum2: "payload_h2_kg_m2_per_s", "momentum h₂", "kg·m²/s", Table, |r| Some(r.end()?.momentum[1]);
    /// Angular momentum of the payload about its mass centre along inertial axis 3, after the last release.
    Momentum3: "payload_h3_kg_m2_per_s", "momentum h₃", "kg·m²/s", Table, |r| Some(r.end()?.momentum[2]);
    /// Angle between the payload's angular momentum after the last release and `momentum_direction`; none where the payload does not turn.
    MomentumError: "momentum_error_deg", "momentum error", "deg", Parting(9), |r| r.end()?.momentum_error().map(f64::to_degrees);
    /// Energy that the springs had stored at the start. The translation and rotation of both bodies sum to it, less what friction takes, what a late spring gives away under its latch and what failed ones keep.
    SpringEnergy: "spring_energy_j", "spring energy", "J", Table, |r| Some(r.end()?.energy.stored_j());
    /// Energy of the springs that went into the payload's translation, relative to the common mass centre.
    PayloadTranslation: "payload_translation_j", "payload translation", "J", Table, |r| Some(r.end()?.energy.payload_translation_j());
    /// Energy of the springs that went into the payload's rotation.
    PayloadRotation: "payload_rotation_j", "payload rotation", "J", Table, |r| Some(r.end()?.energy.payload_rotation_j());
    /// Energy of the springs that went into the stage's translation, relative to the common mass centre.
    StageTranslation: "stage_translation_j", "stage translation", "J", Table, |r| Some(r.end()?.energy.stage_translation_j());
    /// Energy of the springs that went into the stage's rotation.
    StageRotation: "stage_rotation_j", "stage rotation", "J", Table, |r| Some(r.end()?.energy.stage_rotation_j());
    /// Smallest distance of the outlines over the coast after the last release, 0 if any two touch, before it too; none without outlines, and where `clearance_note` says so.
    Clearance: "clearance_m", "clearance", "m", Parting(11), |r| Some(r.end()?.closest()?.distance_m());
    /// When the outlines are nearest, from the opening of the clamp on; at the first contact if any two touch.
    ClearanceTime: "clearance_time_s", "time of clearance", "s", Table, |r| Some(r.end()?.closest()?.time_s());
    /// When outlines first touch, from the opening of the clamp on, those that touch at the opening or at the last release after having parted; none if they do not.
    RecontactTime: "recontact_s", "recontact", "s", Table, |r| r.end()?.clearance()?.contact_s();
}

impl Quantity {
    /// Angular velocity of the payload after the last release.
    pub const PAYLOAD_RATE: [Self; 3] =
        [Self::PayloadRate1, Self::PayloadRate2, Self::PayloadRate3];
    /// Velocity of the payload's mass centre from the stage's.
    pub const RELATIVE_VELOCITY: [Self; 3] =
        [Self::RelativeVelocity1, Self::RelativeVelocity2, Self::RelativeVelocity3];
    /// Change of the payload's angular velocity.
    pub const PAYLOAD_TIP_OFF: [Self; 3] =
        [Self::PayloadTipOff1, Self::PayloadTipOff2, Self::PayloadTipOff3];
    /// Change of the stage's angular velocity.
    pub const STAGE_TIP_OFF: [Self; 3] =
        [Self::StageTipOff1, Self::StageTipOff2, Self::StageTipOff3];
    /// Angular momentum of the payload.
    pub const MOMENTUM: [Self; 3] = [Self::Momentum1, Self::Momentum2, Self::Momentum3];

    /// An entry of the inertia matrix of a body: these stand first, body by body.
    #[must_use]
    pub fn entry(body: Body, entry: Entry) -> Self {
        Self::ALL[body as usize * Entry::ALL.len() + entry as usize]
    }

    /// The last one before `realizable` in the run table; the rest come after the attitudes.
    pub(crate) const LAST_BEFORE_REALIZABLE: Self = Self::InertiaRatio;

    /// All of them, of a separation by such loads.
    pub fn of(separation: &Separation) -> impl Iterator<Item = Self> {
        let releases = separation.loads().map(|(load, _)| Self::Release(load));
        Self::ALL.iter().copied().chain(releases)
    }

    /// What the paper's results are about.
    #[must_use]
    pub fn behaviour() -> Vec<Self> {
        Self::shown(|shown| matches!(shown, Shown::Behaviour(_)))
    }

    /// How the bodies part: what a separation analyst asks for.
    #[must_use]
    pub fn parting() -> Vec<Self> {
        Self::shown(|shown| matches!(shown, Shown::Parting(_)))
    }

    /// Whether it is drawn, so that a run has it before it is separated.
    pub(crate) fn is_drawn(self) -> bool {
        self.declaration().shown == Shown::Drawn
    }

    fn shown(here: impl Fn(Shown) -> bool) -> Vec<Self> {
        let shown = |quantity: &Self| quantity.declaration().shown;
        let mut found: Vec<Self> =
            Self::ALL.iter().copied().filter(|quantity| here(shown(quantity))).collect();
        found.sort_by_key(shown);
        found
    }

    /// Whether the report shows it as an outcome.
    pub(crate) fn is_told(self) -> bool {
        matches!(self.declaration().shown, Shown::Behaviour(_) | Shown::Parting(_))
    }

    /// Name of the column in the run table, with its unit.
    #[must_use]
    pub fn column(self) -> Cow<'static, str> {
        self.of_load(self.declaration().column, LoadId::column)
    }

    /// Its values in a run table, in run order, of the runs that have one.
    #[must_use]
    pub fn in_table(self, table: &Table) -> Vec<f64> {
        table.values(&self.column()).unwrap_or_default()
    }

    /// Its value in a row of a run table; none if the run failed or it has no meaning for this run.
    #[must_use]
    pub fn in_row(self, row: &Row<'_>) -> Option<f64> {
        row.number(&self.column())
    }

    /// The quantity of a column.
    #[must_use]
    pub fn of_column(column: &str) -> Option<Self> {
        let known = Self::ALL.iter().copied().find(|quantity| quantity.column() == column);
        let released = || {
            let load = column.strip_suffix("_release_s")?;
            let of_kind = |kind: &LoadKind| {
                let number = load.strip_prefix(kind.name())?.strip_prefix('_')?;
                let number = number.parse::<usize>().ok()?.checked_sub(1)?;
                Some(Self::Release(LoadId { kind: *kind, number }))
            };
            let mut releases = AnyLoad::KINDS.iter().filter_map(of_kind);
            releases.find(|release| release.column() == column)
        };
        known.or_else(released)
    }

    /// What it is called in tables and figures.
    #[must_use]
    pub fn label(self) -> Cow<'static, str> {
        self.of_load(self.declaration().label, |load| load.to_string())
    }

    /// Its name in tables and figures with its unit, if it has one.
    pub(crate) fn label_with_unit(self) -> String {
        with_unit(&self.label(), self.unit())
    }

    /// Its unit.
    #[must_use]
    pub fn unit(self) -> &'static str {
        self.declaration().unit
    }

    /// What it means, in a sentence.
    #[must_use]
    pub fn meaning(self) -> Cow<'static, str> {
        self.of_load(self.declaration().meaning.trim_start(), |load| load.kind.to_string())
    }

    fn of_load(self, text: &'static str, load: fn(LoadId) -> String) -> Cow<'static, str> {
        match self {
            Self::Release(id) => text.replace("{}", &load(id)).into(),
            _ => text.into(),
        }
    }
}
