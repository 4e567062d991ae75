//! Draws of the joint law in batches, into columns or rows.

use gyradius_inertia::{Containment, MassProperties, Region};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

use super::TenParameters;
use super::law::{JointScalar, MassPropertiesLaw};
use super::tensor::{Of, Principal};
use crate::ScalarLaw;
use crate::batch::{BatchAttitudes, CHUNK, assemble};
use crate::columns::{ColumnsError, common_length};

const SCALARS: usize = JointScalar::ALL.len();
/// Numbers of a body.
const TEN: usize = TenParameters::COLUMNS.len();

impl MassPropertiesLaw {
    /// Fills ten columns in the order of [`TenParameters::COLUMNS`] with independent draws: every row is a body, and one
    /// that is possible in the region of the law.
    ///
    /// Where the inertia has principal axes the draws are made 128 at a time, scalar by scalar and put together by the
    /// machine's vector units, a few times as fast as one by one. The values are others than those of
    /// [`sample`](Distribution::sample), and the same on every machine; of two batches the longer begins with the shorter as
    /// far as that has whole chunks.
    ///
    /// # Errors
    /// The columns are not equally long. Nothing has been written or drawn.
    pub fn sample_columns<R: Rng + ?Sized>(
        &self,
        rng: &mut R,
        mut columns: [&mut [f64]; TEN],
    ) -> Result<(), ColumnsError> {
        let length = common_length(&columns)?;
        let mut chunk = Chunk::new();
        let mut start = 0;
        while start < length {
            let n = CHUNK.min(length - start);
            chunk.draw(self, rng, n);
            for (column, values) in columns.iter_mut().zip(&chunk.ten) {
                column[start..start + n].copy_from_slice(&values[..n]);
            }
            start += n;
        }
        Ok(())
    }

    /// Fills rows of ten numbers, in the order of [`TenParameters::COLUMNS`], with the draws of
    /// [`sample_columns`](Self::sample_columns).
    pub fn sample_into<R: Rng + ?Sized>(&self, rng: &mut R, rows: &mut [[f64; TEN]]) {
        let mut chunk = Chunk::new();
        for rows in rows.chunks_mut(CHUNK) {
            chunk.draw(self, rng, rows.len());
            for (i, row) in rows.iter_mut().enumerate() {
                for (value, column) in row.iter_mut().zip(&chunk.ten) {
                    *value = column[i];
                }
            }
        }
    }
}

/// As many draws as fit into the first-level cache.
struct Chunk {
    ten: [[f64; CHUNK]; TEN],
    scalars: [[f64; CHUNK]; SCALARS],
    attitudes: [UnitQuaternion<f64>; CHUNK],
}

impl Chunk {
    fn new() -> Self {
        Self {
            ten: [[0.0; CHUNK]; TEN],
            scalars: [[0.0; CHUNK]; SCALARS],
            attitudes: [UnitQuaternion::identity(); CHUNK],
        }
    }

    /// The first n rows of the ten are drawn anew.
    fn draw<R: Rng + ?Sized>(&mut self, law: &MassPropertiesLaw, rng: &mut R, n: usize) {
        let (principal, follows) = match &law.tensor().of {
            Of::GyrationLengths(principal) => (principal, None),
            Of::Roots(principal) => (principal, Some(law.shares())),
            Of::Model(_) => {
                for i in 0..n {
                    self.put(i, &law.sample(rng));
                }
                return;
            }
        };
        self.draw_scalars(law, rng, n);
        let Principal { axes, .. } = principal;
        axes.attitudes_into(rng, &mut self.attitudes[..n]);
        let [mass, x, y, z, sizes @ ..] = &mut self.scalars;
        for size in sizes.iter_mut() {
            for (size, &mass) in size[..n].iter_mut().zip(&mass[..n]) {
                let factor = follows.map_or(mass, |follows| follows.factor(mass));
                *size = *size * *size * factor;
            }
        }
        let [ten_mass, ten_x, ten_y, ten_z, entries @ ..] = &mut self.ten;
        for (to, from) in [(ten_mass, &*mass), (ten_x, x), (ten_y, y), (ten_z, z)] {
            to[..n].copy_from_slice(&from[..n]);
        }
        assemble(sizes, &self.attitudes, entries.each_mut().map(|entry| &mut entry[..n]));
        for i in 0..n {
            // A mass that is not positive comes once in 1e15 draws.
            let is_in =
                self.ten[0][i] > 0.0 && law.region().is_none_or(|region| self.is_in(region, i));
            if !is_in {
                self.put(i, &law.sample(rng));
            }
        }
    }

    fn draw_scalars<R: Rng + ?Sized>(&mut self, law: &MassPropertiesLaw, rng: &mut R, n: usize) {
        for column in &mut self.scalars {
            column[..n].fill_with(|| StandardNormal.sample(rng));
        }
        if law.is_correlated() {
            for i in 0..n {
                let mut scores = self.scalars.each_ref().map(|column| column[i]);
                law.correlation().mix(&mut scores);
                for (column, score) in self.scalars.iter_mut().zip(scores) {
                    column[i] = score;
                }
            }
        }
        for (law, column) in law.scalar_laws().zip(&mut self.scalars) {
            at_scores(law, &mut column[..n]);
        }
    }

    /// Whether a row is possible in a region.
    fn is_in(&self, region: &Region, i: usize) -> bool {
        let ten = self.ten.each_ref().map(|column| column[i]);
        let [mass, x, y, z, i11, i22, i33, i12, i13, i23] = ten;
        let half = 0.5 * (i11 + i22 + i33);
        let sigma =
            Matrix3::new(half - i11, -i12, -i13, -i12, half - i22, -i23, -i13, -i23, half - i33);
        match region.room_in_ellipsoid(mass, &Vector3::new(x, y, z), &sigma) {
            Some(room) => room >= 0.0,
            None => {
                let body = TenParameters::from_values(ten).and_then(MassProperties::try_from);
                body.is_ok_and(|body| region.containment(&body) == Containment::Possible)
            }
        }
    }

    fn put(&mut self, i: usize, body: &MassProperties) {
        let values = TenParameters::from(*body).values();
        for (column, value) in self.ten.iter_mut().zip(values) {
            column[i] = value;
        }
    }
}

/// The values at scores, in their place.
fn at_scores(law: &ScalarLaw, scores: &mut [f64]) {
    match law.as_normal() {
        Some([mean, variance]) => {
            let deviation = variance.sqrt();
            for z in scores {
                *z = mean + deviation * *z;
            }
        }
        None => {
            for z in scores {
                *z = law.at_score(*z);
            }
        }
    }
}
