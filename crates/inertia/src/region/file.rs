//! A region as it stands in a file.

use nalgebra::{Isometry3, Quaternion, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use super::{Kind, Region, RegionError};

/// The serialized form. Attitudes take the region's own axes to body axes, scalar last.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(super) enum RegionForm {
    Ellipsoid {
        middle_m: [f64; 3],
        semi_axes_m: [f64; 3],
        #[serde(default, skip_serializing_if = "Option::is_none")]
        attitude: Option<[f64; 4]>,
    },
    Box {
        middle_m: [f64; 3],
        half_sides_m: [f64; 3],
        #[serde(default, skip_serializing_if = "Option::is_none")]
        attitude: Option<[f64; 4]>,
    },
    Hull {
        points_m: Vec<[f64; 3]>,
    },
}

impl TryFrom<RegionForm> for Region {
    type Error = RegionError;

    fn try_from(form: RegionForm) -> Result<Self, RegionError> {
        let placed = |region: Self, middle: [f64; 3], attitude: Option<[f64; 4]>| {
            let [x, y, z, w] = attitude.unwrap_or([0.0, 0.0, 0.0, 1.0]);
            let turn = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
            region.transformed(&Isometry3::from_parts(Vector3::from(middle).into(), turn))
        };
        match form {
            RegionForm::Ellipsoid { middle_m, semi_axes_m, attitude } => {
                placed(Self::ellipsoid([0.0; 3], semi_axes_m)?, middle_m, attitude)
            }
            RegionForm::Box { middle_m, half_sides_m, attitude } => {
                placed(Self::solid_box([0.0; 3], half_sides_m)?, middle_m, attitude)
            }
            RegionForm::Hull { points_m } => Self::hull(&points_m),
        }
    }
}

impl From<Region> for RegionForm {
    fn from(region: Region) -> Self {
        let turned = |pose: &Isometry3<f64>| {
            let q = pose.rotation.coords;
            (pose.rotation != UnitQuaternion::identity()).then_some([q.x, q.y, q.z, q.w])
        };
        match region.0 {
            Kind::Ellipsoid { pose, semi_axes, .. } => Self::Ellipsoid {
                middle_m: pose.translation.vector.into(),
                semi_axes_m: semi_axes.into(),
                attitude: turned(&pose),
            },
            Kind::Box { pose, half_sides } => Self::Box {
                middle_m: pose.translation.vector.into(),
                half_sides_m: half_sides.into(),
                attitude: turned(&pose),
            },
            Kind::Hull(hull) => {
                Self::Hull { points_m: hull.points().iter().map(|p| (*p).into()).collect() }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
