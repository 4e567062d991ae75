//! Judges every body of a file: `cargo run --example judge_file -- robot.urdf`.

use gyradius_formats::{InertiaFile, Products, TOLERANCE, judge};
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let here = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/rover.urdf");
    let path = std::env::args_os().nth(1).map_or_else(|| here.into(), PathBuf::from);
    let file = InertiaFile::read(&path, Products::TensorEntries)?;
    for body in file.bodies() {
        print!("{}:{}: {}: ", path.display(), body.line(), body.name());
        match body.inertia() {
            Ok(inertia) => {
                let judgement = judge(inertia, body.mass_kg(), TOLERANCE);
                println!("{}", judgement.report());
                if let Some(fault) = judgement.mass_fault() {
                    println!("    {fault}");
                }
            }
            Err(error) => println!("{error}"),
        }
    }
    Ok(())
}
