//! An answer as `gyradius rare --json` writes it: the estimate with all warnings, those too that it does not show itself.

use gyradius_campaign::Event;
use gyradius_statistics::{ImportanceEstimate, Interval};
use serde::{Serialize, Serializer};

use super::{Rare, RareEstimate, RareWarning};

#[derive(Serialize)]
struct Told<'a> {
    scenario: &'a str,
    model: &'a str,
    event: &'a Event,
    failed: u64,
    groups: &'a [String],
    #[serde(flatten)]
    estimate: ToldEstimate<'a>,
}

#[derive(Serialize)]
#[serde(tag = "method", rename_all = "snake_case")]
enum ToldEstimate<'a> {
    Subset {
        probability: f64,
        coefficient_of_variation: Option<f64>,
        interval: Interval,
        evaluations: u64,
        without_excess: u64,
        replicas: &'a [f64],
        events: &'a [Vec<u64>],
        warnings: &'a [RareWarning],
    },
    Importance {
        steered: &'a [String],
        own_laws: &'a [String],
        probability: f64,
        interval: Interval,
        coefficient_of_variation: Option<f64>,
        evaluations: u64,
        without_excess: u64,
        warnings: &'a [RareWarning],
        weighted: &'a ImportanceEstimate,
    },
}

impl Serialize for Rare {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self { scenario, model, event, failed, groups, estimate, warnings } = self;
        let estimate = match estimate {
            RareEstimate::Subset(estimate) => ToldEstimate::Subset {
                probability: estimate.probability(),
                coefficient_of_variation: estimate.coefficient_of_variation(),
                interval: estimate.interval(),
                evaluations: estimate.evaluations(),
                without_excess: estimate.without_excess(),
                replicas: estimate.replicas(),
                events: estimate.events(),
                warnings,
            },
            RareEstimate::Importance { steered, own_laws, estimate } => ToldEstimate::Importance {
                steered,
                own_laws,
                probability: estimate.probability(),
                interval: estimate.interval(),
                coefficient_of_variation: estimate.coefficient_of_variation(),
                evaluations: estimate.evaluations(),
                without_excess: estimate.without_excess(),
                warnings,
                weighted: estimate.weighted(),
            },
        };
        Told { scenario, model, event, failed: *failed, groups, estimate }.serialize(serializer)
    }
}
