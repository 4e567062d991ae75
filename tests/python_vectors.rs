//! The draws that the Python package is held against, bit by bit: they are the same from Rust.

use gyradius_campaign::Streams;
use gyradius_dispersion::{MassPropertiesLaw, TenParameters};
use gyradius_estimation::{StatedAmount, StatedBody, Statements};
use gyradius_inertia::MassProperties;
use rand_distr::Distribution;
use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, path::Path};

const FILE: &str = "../crates/python/tests/vectors.json";

/// The draws of each law by their places.
type Draws = BTreeMap<String, BTreeMap<u64, [f64; 10]>>;

#[derive(Deserialize, Serialize)]
struct Vectors {
    /// Where the numbers come from.
    about: String,
    seed: u64,
    term: String,
    /// The body of which something is stated.
    body: [f64; 10],
    /// A law as it stands in files.
    joint: MassPropertiesLaw,
    draws: Draws,
}

fn drawn(vectors: &Vectors) -> Draws {
    let body = TenParameters::from_values(vectors.body).unwrap();
    let statements = Statements {
        mass: Some(StatedAmount::mass("5%").unwrap().mass_statement(1.0).unwrap()),
        centre: Some(StatedAmount::centre("1cm").unwrap().centre_statement(1.0).unwrap()),
        moments: Some(StatedAmount::moments("10%").unwrap().moments_statement(1.0).unwrap()),
        axes: Some(StatedAmount::axes("2deg").unwrap().axes_statement(1.0).unwrap()),
        products: None,
    };
    let stated = StatedBody::new(&statements, &MassProperties::try_from(body).unwrap()).unwrap();
    let streams = Streams::of_draws(vectors.seed, &vectors.term);
    let of = |law: &MassPropertiesLaw| {
        let draw = |place: u64| {
            let drawn: MassProperties = law.sample(&mut streams.run(place));
            (place, TenParameters::from(drawn).values())
        };
        [0, 1, 2, 1000, 1 << 40].map(draw).into_iter().collect()
    };
    let laws = [("joint", &vectors.joint), ("stated", stated.law())];
    laws.into_iter().map(|(name, law)| (name.to_owned(), of(law))).collect()
}

/// `WRITE_PAGE=1` writes them anew.
#[test]
fn the_vectors_are_what_rust_draws() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(FILE);
    let text = std::fs::read_to_string(&path).unwrap();
    let mut vectors: Vectors = serde_json::from_str(&text).unwrap();
    let found = drawn(&vectors);
    if std::env::var_os("WRITE_PAGE").is_some() {
        vectors.draws = found;
        std::fs::write(&path, serde_json::to_string_pretty(&vectors).unwrap() + "\n").unwrap();
        return;
    }
    assert_eq!(vectors.draws, found);
}
