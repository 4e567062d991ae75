//! The names and directions of axes under which a scatter is searched for: the same however the axes of a body are named and
//! pointed, so that what is found does not depend on that.

use gyradius_inertia::{PrincipalAxes, RootSecondMoments};
use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion};

use super::{
    StatementError,
    scatter::{Body, Scatter},
    task::{Asked, Solution, Task},
};

/// Numbers that differ by less than this share of the largest are equal where frames are compared: far above rounding.
const EQUAL: f64 = 1e-9;
/// The last digit of numbers that are told beside one, 2⁻³⁶: far above rounding, and far below what anyone states.
const LAST_DIGIT: f64 = 1.0 / (1_u64 << 36) as f64;

/// Three axes under other names and with other directions: the new axis i is the old one `order[i]`, times `signs[i]`.
#[derive(Clone, Copy, Debug)]
struct Renamed {
    order: [usize; 3],
    signs: [f64; 3],
    /// 1, or −1 where axes that were right-handed no longer are.
    hand: f64,
}

/// Body axes and principal axes, both renamed. Whether axes are right-handed makes no difference to the deviations of entries, so
/// that both may become left-handed together.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    body: Renamed,
    principal: Renamed,
    /// The largest second moment, kg·m², which is one in this frame.
    size: f64,
}

impl Renamed {
    const SAME: Self = Self { order: [0, 1, 2], signs: [1.0; 3], hand: 1.0 };

    /// All that point as before.
    fn orders() -> impl Iterator<Item = Self> {
        let orders = PrincipalAxes::ORDERS.into_iter();
        orders.map(|(order, hand)| Self { order, signs: [1.0; 3], hand })
    }

    /// With these names, all directions.
    fn pointed(self) -> impl Iterator<Item = Self> {
        (0..8_u32).map(move |bits| {
            let signs = [0, 1, 2].map(|i| if bits >> i & 1 == 0 { 1.0 } else { -1.0 });
            Self { signs, hand: self.hand * signs.iter().product::<f64>(), ..self }
        })
    }

    /// Numbers of the axes, under their new names.
    fn of<T: Copy>(&self, old: [T; 3]) -> [T; 3] {
        self.order.map(|axis| old[axis])
    }

    /// The way back.
    fn back<T: Copy>(&self, new: [T; 3]) -> [T; 3] {
        let mut old = new;
        for (axis, value) in self.order.into_iter().zip(new) {
            old[axis] = value;
        }
        old
    }

    /// The signed permutation that takes old components to new ones.
    fn matrix(&self) -> Matrix3<f64> {
        Matrix3::from_fn(|i, j| if j == self.order[i] { self.signs[i] } else { 0.0 })
    }
}

/// Numbers of the pairs 12, 13, 23 by the axis that each leaves out, and back.
fn by_axis_left_out<T>([first, second, third]: [T; 3]) -> [T; 3] {
    [third, second, first]
}

/// A number of the order of 1, so that those that differ by rounding alone are equal.
fn whole(x: f64) -> i64 {
    (x / EQUAL).round() as i64
}

/// A number without the digits that rounding makes: as many digits of any number.
fn short(x: f64) -> f64 {
    let power = libm::exp2(libm::log2(x.abs()).floor());
    if power > 0.0 && power.is_finite() {
        (x / power / LAST_DIGIT).round() * LAST_DIGIT * power
    } else {
        x
    }
}

/// Numbers as shares of the largest.
fn shares(three: [f64; 3]) -> [f64; 3] {
    let largest = three.into_iter().fold(0.0, f64::max);
    three.map(|x| if largest > 0.0 { x / largest } else { 0.0 })
}

impl Frame {
    /// The frame in which what a task depends on, number by number, is larger than in any other. Where that is several, the task
    /// is the same in all of them.
    pub(super) fn of(task: &Task) -> Self {
        let size = task.body.roots.squared().values().into_iter().fold(f64::MIN_POSITIVE, f64::max);
        let named: Vec<_> = Renamed::orders()
            .flat_map(|principal| Renamed::orders().map(move |body| Self { body, principal, size }))
            .map(|frame| (frame.unsigned(task), frame))
            .collect();
        let largest = named.iter().map(|(numbers, _)| *numbers).max();
        let named = named.into_iter().filter(|(numbers, _)| Some(*numbers) == largest);
        let pointed = named.flat_map(|(_, Self { body, principal, .. })| {
            principal.pointed().flat_map(move |principal| {
                let bodies = body.pointed().filter(move |body| body.hand == principal.hand);
                bodies.map(move |body| Self { body, principal, size })
            })
        });
        let frame = pointed.max_by_key(|frame| frame.rows(&task.body).map(|row| row.map(whole)));
        frame.unwrap_or(Self { body: Renamed::SAME, principal: Renamed::SAME, size })
    }

    /// What a task depends on, in this frame, but for what directions of axes change.
    fn unsigned(&self, task: &Task) -> [[i64; 3]; 7] {
        let Self { body, principal, .. } = self;
        let [x, y, z] = self.rows(&task.body).map(|row| row.map(|r| r * r));
        let numbers = [
            principal.of(shares(task.body.roots.values())),
            x,
            y,
            z,
            principal.of(shares(task.axes.unwrap_or_default())),
            body.of(shares(task.moments.variances())),
            self.pairs(shares(task.products.variances())),
        ];
        numbers.map(|three| three.map(whole))
    }

    /// The rows of the rotation that takes body components to principal ones.
    fn rows(&self, body: &Body) -> [[f64; 3]; 3] {
        let rotation = self.rotation(body);
        [0, 1, 2].map(|i| [0, 1, 2].map(|j| rotation[(i, j)]))
    }

    /// The rotation that takes body components to principal ones.
    fn rotation(&self, body: &Body) -> Matrix3<f64> {
        let rotation = body.attitude.to_rotation_matrix();
        self.principal.matrix() * rotation.matrix() * self.body.matrix().transpose()
    }

    /// A task as it is in this frame, the largest second moment being one, without the last digits of all numbers: a long
    /// search makes much of differences that rounding alone makes between the frames and units in which a body is given.
    pub(super) fn task(&self, task: &Task) -> Result<Task, StatementError> {
        let Self { body, principal, size } = self;
        let digits = |x: f64| (x / LAST_DIGIT).round() * LAST_DIGIT;
        let k = principal.of(task.body.roots.squared().values()).map(|k| digits(k / size));
        let roots = RootSecondMoments::new(k.map(f64::sqrt))
            .map_err(|e| StatementError::Law { problem: e.to_string() })?;
        let rotation = Rotation3::from_matrix_unchecked(self.rotation(&task.body));
        let attitude = UnitQuaternion::from_rotation_matrix(&rotation).coords.map(digits);
        let attitude = UnitQuaternion::new_normalize(Quaternion::from_vector(attitude));
        let asked = |asked: Asked, named: &dyn Fn([f64; 3]) -> [f64; 3]| match asked {
            Asked::Nothing => Asked::Nothing,
            Asked::Stated(deviations) => {
                Asked::Stated(named(deviations).map(|deviation| short(deviation / size)))
            }
            Asked::Added(variances) => {
                Asked::Added(named(variances).map(|variance| short(variance / size / size)))
            }
        };
        Ok(Task {
            body: Body { attitude, roots },
            trace: 2.0 * k.iter().sum::<f64>(),
            moments: asked(task.moments, &|three| body.of(three)),
            products: asked(task.products, &|three| self.pairs(three)),
            axes: task.axes.map(|three| principal.of(three)),
            mass: task.mass.map(|(relative, most)| (short(relative), short(most))),
            ..*task
        })
    }

    /// What was found in this frame, as it is in the frame of the body.
    pub(super) fn back(&self, found: &Solution) -> Solution {
        let turned = self.principal.matrix();
        let named = turned.map(f64::abs);
        let [i11, i22, i33, i12, i13, i23] = found.with_centre;
        let [i11, i22, i33] = self.body.back([i11, i22, i33]);
        let [i12, i13, i23] = by_axis_left_out(self.body.back(by_axis_left_out([i12, i13, i23])));
        Solution {
            scatter: Scatter {
                roots: named.tr_mul(&found.scatter.roots) * named * self.size,
                rotations: turned.tr_mul(&found.scatter.rotations) * turned,
            },
            with_centre: [i11, i22, i33, i12, i13, i23].map(|it| Some(it? * self.size)),
            ..*found
        }
    }

    /// Numbers of the pairs 12, 13, 23.
    fn pairs(&self, three: [f64; 3]) -> [f64; 3] {
        by_axis_left_out(self.body.of(by_axis_left_out(three)))
    }
}
