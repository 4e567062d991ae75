//! Summarises a small sample: `cargo run -p gyradius-statistics --example summarise`.

use gyradius_statistics::{
    BinEdges, Confidence, Deviation, Histogram, Moments, SortedSample, StatisticsError,
};

fn main() -> Result<(), StatisticsError> {
    let sample =
        [2.31, 2.44, 2.38, 2.52, 2.29, 2.41, 2.47, 2.36, 2.40, 2.61, 2.33, 2.45, 2.39, 2.42, 2.50];
    let confidence = Confidence::default();
    let moments = Moments::new(&sample)?;
    let deviation = Deviation::new(&sample)?;
    let sorted = SortedSample::new(&sample)?;
    println!("mean      {:.3} in {:.3}", moments.mean(), moments.mean_interval(confidence));
    println!(
        "deviation {:.3} in {:.3}",
        deviation.standard_deviation(),
        deviation.interval(confidence)?
    );
    println!(
        "median    {:.3} in {:.3}",
        sorted.median(),
        sorted.quantile_interval(0.5, confidence)?
    );
    let edges = BinEdges::freedman_diaconis(&[&sorted])?;
    let histogram = Histogram::new(&sorted, &edges);
    for (pair, &count) in edges.values().windows(2).zip(histogram.counts()) {
        println!("{:.3} to {:.3} {}", pair[0], pair[1], "#".repeat(count as usize));
    }
    Ok(())
}
