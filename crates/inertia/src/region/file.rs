//! A region as it stands in a file.

use nalgebra::{Isometry3, Quaternion, UnitQuaternion};
use serde::{Deserialize, Serialize};

use super::{Kind, Region, RegionError, pose, sizes, unit};
use crate::RELATIVE_TOLERANCE;

/// The serialized form: one of its fields. Attitudes take the region's own axes to body axes, scalar last.
#[derive(Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RegionForm {
    #[serde(skip_serializing_if = "Option::is_none")]
    ellipsoid: Option<EllipsoidForm>,
    #[serde(rename = "box", skip_serializing_if = "Option::is_none")]
    solid_box: Option<BoxForm>,
    #[serde(skip_serializing_if = "Option::is_none")]
    hull: Option<HullForm>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct EllipsoidForm {
    middle_m: [f64; 3],
    semi_axes_m: [f64; 3],
    #[serde(default, skip_serializing_if = "Option::is_none")]
    attitude: Option<[f64; 4]>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct BoxForm {
    middle_m: [f64; 3],
    half_sides_m: [f64; 3],
    #[serde(default, skip_serializing_if = "Option::is_none")]
    attitude: Option<[f64; 4]>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct HullForm {
    points_m: Vec<[f64; 3]>,
}

impl TryFrom<RegionForm> for Region {
    type Error = RegionError;

    fn try_from(form: RegionForm) -> Result<Self, RegionError> {
        let placed = |middle: [f64; 3], attitude: Option<[f64; 4]>| {
            let [x, y, z, w] = attitude.unwrap_or([0.0, 0.0, 0.0, 1.0]);
            let turn = turn(&Quaternion::new(w, x, y, z))?;
            Ok::<_, RegionError>(Isometry3 { rotation: turn, ..pose(middle.into())? })
        };
        let two = |first, second| Err(RegionError::Shapes { first, second });
        match (form.ellipsoid, form.solid_box, form.hull) {
            (Some(form), None, None) => {
                let semi_axes = sizes("semi-axis", form.semi_axes_m.into())?;
                Ok(Self::of_ellipsoid(placed(form.middle_m, form.attitude)?, semi_axes))
            }
            (None, Some(form), None) => {
                let half_sides = sizes("half side", form.half_sides_m.into())?;
                let pose = placed(form.middle_m, form.attitude)?;
                Ok(Self(Kind::Box { pose, half_sides }))
            }
            (None, None, Some(form)) => Self::hull(&form.points_m),
            (None, None, None) => Err(RegionError::NoShape),
            (Some(_), Some(_), _) => two("ellipsoid", "box"),
            (Some(_), None, Some(_)) => two("ellipsoid", "hull"),
            (None, Some(_), Some(_)) => two("box", "hull"),
        }
    }
}

/// The rotation of a quaternion of length one to 1e-6. One that has all of its digits stays as it is, so that a region is
/// read as it was written.
fn turn(q: &Quaternion<f64>) -> Result<UnitQuaternion<f64>, RegionError> {
    let has_all_digits = (q.norm() - 1.0).abs() <= RELATIVE_TOLERANCE;
    if has_all_digits { Ok(UnitQuaternion::new_unchecked(*q)) } else { unit(q) }
}

impl From<Region> for RegionForm {
    fn from(region: Region) -> Self {
        let turned = |pose: &Isometry3<f64>| {
            let q = pose.rotation.coords;
            (pose.rotation != UnitQuaternion::identity()).then_some([q.x, q.y, q.z, q.w])
        };
        let none = Self::default();
        match region.0 {
            Kind::Ellipsoid { pose, semi_axes, .. } => {
                let ellipsoid = EllipsoidForm {
                    middle_m: pose.translation.vector.into(),
                    semi_axes_m: semi_axes.into(),
                    attitude: turned(&pose),
                };
                Self { ellipsoid: Some(ellipsoid), ..none }
            }
            Kind::Box { pose, half_sides } => {
                let solid_box = BoxForm {
                    middle_m: pose.translation.vector.into(),
                    half_sides_m: half_sides.into(),
                    attitude: turned(&pose),
                };
                Self { solid_box: Some(solid_box), ..none }
            }
            Kind::Hull(hull) => {
                let points_m = hull.points().iter().map(|p| (*p).into()).collect();
                Self { hull: Some(HullForm { points_m }), ..none }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// To the bit, however often they have been turned and moved; attitudes with few digits are made of unit length.
        #[test]
        fn files_keep_regions_to_the_bit(
            sizes in prop::array::uniform3(1e-3..1e3_f64),
            middle in prop::array::uniform3(-1e3..1e3_f64),
            turns in prop::collection::vec((prop::array::uniform3(-3.0..3.0_f64), prop::array::uniform3(-9.0..9.0_f64)), 0..9),
        ) {
            for mut region in [Region::ellipsoid(middle, sizes).unwrap(), Region::solid_box(middle, sizes).unwrap()] {
                for (axis, by) in &turns {
                    let by = Isometry3::new((*by).into(), (*axis).into());
                    region = region.transformed(&by).unwrap();
                }
                let json = serde_json::to_string(&region).unwrap();
                let back: Region = serde_json::from_str(&json).unwrap();
                prop_assert_eq!(&back, &region, "{}", json);
                prop_assert_eq!(serde_json::to_string(&back).unwrap(), json);
            }
            if let Some((axis, _)) = turns.first() {
                let q = UnitQuaternion::from_scaled_axis(Vector3::from(*axis));
                let short = q.coords.map(|x| (x * 1e8).round() / 1e8);
                let form = |q: &[f64]| serde_json::json!({"box": {"middle_m": middle, "half_sides_m": sizes, "attitude": q}});
                let read: Region = serde_json::from_value(form(short.as_slice())).unwrap();
                let Kind::Box { pose, .. } = read.0 else { return Err(TestCaseError::fail("no box")) };
                prop_assert!((pose.rotation.norm() - 1.0).abs() < 1e-15);
                let long = short * (1.0 + 1e-5);
                prop_assert!(serde_json::from_value::<Region>(form(long.as_slice())).is_err());
            }
        }
    }

    #[test]
    fn files_keep_regions() {
        let by = Isometry3::new(Vector3::new(1.0, 2.0, 3.0), Vector3::new(0.3, -0.2, 0.9));
        let plain = [
            Region::ellipsoid([0.1, 0.2, 0.3], [1.0, 2.0, 0.5]).unwrap(),
            Region::solid_box([0.1, 0.2, 0.3], [1.0, 2.0, 0.5]).unwrap(),
            Region::hull(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.5]]).unwrap(),
        ];
        for region in plain.iter().cloned().chain(plain.iter().map(|r| r.transformed(&by).unwrap()))
        {
            let json = serde_json::to_string(&region).unwrap();
            let back: Region = serde_json::from_str(&json).unwrap();
            let body = crate::Shape::sphere(0.2).unwrap().of_mass(1.0).unwrap();
            assert!((back.room(&body) - region.room(&body)).abs() < 1e-12, "{json}");
            assert_eq!(
                serde_json::from_str::<Region>(&serde_json::to_string(&back).unwrap()).unwrap(),
                back
            );
        }
        for bad in [
            r#"{"box":{"middle_m":[0,0,0],"half_sides_m":[1,1,-1]}}"#,
            r#"{"box":{"middle_m":[0,0,0],"half_sides_m":[1,1,1],"attitude":[0,0,0,2]}}"#,
            r#"{"ellipsoid":{"middle_m":[0,0,0],"semi_axes_m":[1,1,1],"colour":1}}"#,
        ] {
            assert!(serde_json::from_str::<Region>(bad).is_err(), "{bad}");
        }
    }

    /// Every subset of the shapes: one is a region, and what is wrong with the others is said.
    #[test]
    fn a_region_has_one_shape() {
        let shapes = [
            ("ellipsoid", r#""ellipsoid":{"middle_m":[0,0,0],"semi_axes_m":[1,1,1]}"#),
            ("box", r#""box":{"middle_m":[0,0,0],"half_sides_m":[1,1,1]}"#),
            ("hull", r#""hull":{"points_m":[[0,0,0],[1,0,0],[0,1,0],[0,0,1]]}"#),
        ];
        for which in 0..8 {
            let some: Vec<_> = (0..3).filter(|i| which >> i & 1 == 1).map(|i| shapes[i]).collect();
            let json: Vec<&str> = some.iter().map(|(_, text)| *text).collect();
            let found = serde_json::from_str::<Region>(&format!("{{{}}}", json.join(",")));
            match &some[..] {
                [_] => assert!(found.is_ok()),
                [] => {
                    assert!(found.unwrap_err().to_string().contains("there is no shape: it must"))
                }
                [(first, _), (second, _), ..] => {
                    let said =
                        format!("it has {first} and {second}: it must have one of ellipsoid,");
                    let error = found.unwrap_err().to_string();
                    assert!(error.contains(&said), "{error}");
                }
            }
        }
        let error = serde_json::from_str::<Region>(r#"{"ball":{}}"#).unwrap_err().to_string();
        assert!(error.contains("unknown field `ball`, expected one of `ellipsoid`, `box`, `hull`"));
    }
}
