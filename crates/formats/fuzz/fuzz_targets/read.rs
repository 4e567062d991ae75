//! Any bytes, read as any format: no panic, and what is repaired is repaired.
//!
//! The first byte says which format. Samples to start from are in `../tests/data`; see README.md.
#![no_main]

use gyradius_formats::{InertiaFile, Products, Remedy, TOLERANCE, judge};
use libfuzzer_sys::fuzz_target;
use std::path::Path;

const NAMES: [&str; 6] = ["a.urdf", "a.xml", "a.sdf", "a.csv", "a.toml", "a.json"];

fn impossible(file: &InertiaFile) -> Vec<usize> {
    let bodies = file.bodies().iter().enumerate();
    bodies
        .filter(|(_, body)| {
            body.inertia().is_ok_and(|m| !judge(m, body.mass_kg(), TOLERANCE).report().is_realizable())
        })
        .map(|(i, _)| i)
        .collect()
}

fuzz_target!(|data: &[u8]| {
    let Some((first, bytes)) = data.split_first() else { return };
    let path = Path::new(NAMES[usize::from(*first) % NAMES.len()]);
    let products = if *first < 128 { Products::TensorEntries } else { Products::Integrals };
    let Ok(file) = InertiaFile::parse(path, bytes.to_vec(), products) else { return };
    let bad = impossible(&file);
    let nearest: Vec<_> = bad.iter().map(|i| (*i, Remedy::Nearest)).collect();
    if let Ok(copy) = file.repaired(&nearest) {
        let again = InertiaFile::parse(path, copy, products).expect("a copy reads back");
        assert!(impossible(&again).is_empty());
    }
});
