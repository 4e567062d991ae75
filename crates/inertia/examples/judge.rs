//! Judges an inertia matrix and prints its principal axes. Entries in the order I₁₁ I₂₂ I₃₃ I₁₂ I₁₃
//! I₂₃, in kg·m²: `cargo run -p gyradius-inertia --example judge -- 5000 1000 3000 20 2 -50`.

use gyradius_inertia::{Inertia, InertiaMatrix};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<f64> =
        std::env::args().skip(1).map(|x| x.parse()).collect::<Result<_, _>>()?;
    let [i11, i22, i33, i12, i13, i23] = match arguments.as_slice() {
        [] => [5000.0, 4000.0, 3000.0, 20.0, 2.0, -50.0],
        entries => entries.try_into().map_err(|_| "six numbers: I11 I22 I33 I12 I13 I23")?,
    };
    let matrix = InertiaMatrix::from_entries([i11, i22, i33], [i12, i13, i23])?;

    match Inertia::try_from(matrix) {
        Ok(_) => println!("realizable: some body has this inertia"),
        Err(error) => println!("{error}"),
    }
    // An unphysical matrix has principal axes too, and second moments that show what is wrong.
    let principal = matrix.principal_axes();
    let axes = principal.axes();
    println!("       I, kg·m²      K, kg·m²    axis in body components");
    for (k, axis) in axes.matrix().column_iter().enumerate() {
        println!(
            "{}  {:13.6} {:13.6}   {:9.6} {:9.6} {:9.6}",
            k + 1,
            principal.moments()[k],
            principal.second_moments()[k],
            axis[0],
            axis[1],
            axis[2]
        );
    }
    println!("turned from the body axes by {:.4}°", principal.attitude().angle().to_degrees());
    Ok(())
}
