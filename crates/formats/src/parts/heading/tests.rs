//! Headings in the spellings of many lists.

use super::*;

#[test]
fn headings_are_known_in_every_spelling() {
    let value = |i, si| Heading::Column(Column::Value(i, si));
    let sigma = |i, n, si| Heading::Column(Column::Deviation(Group(i, n), Scale::Unit(si)));
    let size = |name, si| Heading::Size(name, si);
    let percent = |i, n| Heading::Column(Column::Deviation(Group(i, n), Scale::Percent));
    for (text, expected) in [
        ("mass", value(0, None)),
        ("Mass [g]", value(0, Some(1e-3))),
        ("Cx", value(1, None)),
        ("centre_y_mm", value(2, Some(1e-3))),
        ("Mass center Z (in)", value(3, Some(0.0254))),
        ("Ixx", value(4, None)),
        ("i23_kg_m2", value(9, Some(1.0))),
        ("mass_centre_2_m", value(2, Some(1.0))),
        ("sigma_mass", sigma(0, 1, None)),
        ("sigma_Cz", sigma(3, 1, None)),
        ("centre_sigma_mm", sigma(1, 3, Some(1e-3))),
        ("sigma_Ixy", sigma(7, 1, None)),
        ("moments_percent", percent(4, 3)),
        ("mass (%)", percent(0, 1)),
        ("sigma_products_kg_m2", sigma(7, 3, Some(1.0))),
        ("radius_m", size("radius_m", Some(1.0))),
        ("Radius [in]", size("radius_m", Some(0.0254))),
        ("inner radius", size("inner_radius_m", None)),
        ("Height above deck", Heading::Other),
        ("heights", Heading::Other),
        ("sigma_mess", Heading::NoDeviation),
        ("mass_std", Heading::NoDeviation),
        ("Mass (1σ)", Heading::NoDeviation),
        ("mass +/-", Heading::NoDeviation),
        ("Ixx (+/-) [kg m2]", Heading::NoDeviation),
        ("-Ixy", Heading::Signed),
        ("-sigma_Ixy", Heading::Signed),
        ("Ixx uncertainty [kg m2]", Heading::NoDeviation),
        ("uncertainty", Heading::NoDeviation),
        ("MassSD", Heading::NoDeviation),
        ("IxxError [kg m2]", Heading::NoDeviation),
        ("SDmass", Heading::NoDeviation),
        ("massTol", Heading::NoDeviation),
        ("mass_precision", Heading::NoDeviation),
        ("se_mass", Heading::NoDeviation),
        ("varx", Heading::Other),
        ("Tolerance [kg]", Heading::NoDeviation),
        ("tolerance class", Heading::Other),
        ("mass_delta", Heading::NoDeviation),
        ("mass half-width [kg]", Heading::NoDeviation),
        ("massPM", Heading::NoDeviation),
        ("mass 3s", Heading::NoDeviation),
        ("Ixx range [kg m2]", Heading::NoDeviation),
        ("Uncert.", Heading::NoDeviation),
        ("x_min", Heading::Other),
        ("temperature range", Heading::Other),
        ("max load", Heading::Other),
        ("radius_tolerance_mm", Heading::SizeDeviation),
        ("inner radius tol [mm]", Heading::SizeDeviation),
        ("sigma_radius_m", Heading::NoDeviation),
        ("kx_mm", Heading::Column(Column::Gyration(0, Some(1e-3)))),
        ("Kyy", Heading::Column(Column::Gyration(1, None))),
        ("Radius of gyration Z [m]", Heading::Column(Column::Gyration(2, Some(1.0)))),
        ("kg", Heading::Other),
        ("k2 screws", Heading::Other),
        ("Qty", Heading::Unread(Unread::Count)),
        ("quantity [-]", Heading::Unread(Unread::Count)),
        ("No. off", Heading::Unread(Unread::Count)),
        ("part number", Heading::Other),
        ("roll_deg", Heading::Unread(Unread::Turn)),
        ("MGA %", Heading::Unread(Unread::Growth)),
        ("mass growth allowance", Heading::Unread(Unread::Growth)),
        ("quat_w", Heading::Column(Column::Attitude(3))),
        ("basic mass", Heading::Other),
        ("+/-", Heading::NoDeviation),
        ("error", Heading::NoDeviation),
        ("function", Heading::Other),
        ("Mass [Mg]", value(0, Some(1000.0))),
        ("supplier", Heading::Other),
        ("m (kg)", value(0, Some(1.0))),
        ("m", value(0, None)),
        ("m_lbs", value(0, Some(0.453_592_37))),
        ("m no", Heading::Other),
        ("material", Heading::Other),
        ("xcg", value(1, None)),
        ("X CG [m]", value(1, Some(1.0))),
        ("Zbar (inches)", value(3, Some(0.0254))),
        ("Ycom_mm", value(2, Some(1e-3))),
        ("xcgi", Heading::Other),
        ("centre_m", Heading::Other),
        ("POIconv", Heading::Column(Column::Products)),
        ("Ipoint", Heading::Column(Column::Point)),
    ] {
        let found = Heading::of(text);
        let same = match (&found, &expected) {
            (
                Heading::Column(Column::Value(i, Some(a))),
                Heading::Column(Column::Value(j, Some(b))),
            ) => i == j && (a / b - 1.0).abs() < 1e-15,
            (a, b) => a == b,
        };
        assert!(same, "{text}: {found:?}");
    }
}

/// Any word for a deviation or a limit beside any name of a number, of three of them or of the inertia as a whole, in any order.
#[test]
fn words_of_uncertainty_beside_names_are_deviations() {
    for name in [
        "mass",
        "CG",
        "Xcg",
        "Ixx",
        "I_yz",
        "inertia",
        "MOI",
        "POI",
        "moments",
        "moment of inertia",
        "inertia tensor",
    ] {
        for word in
            ["uncertainty", "unc", "tolerance", "error", "SD", "lo", "hi", "min", "max", "k=2"]
        {
            for text in [
                format!("{name} {word}"),
                format!("{name}_{word}"),
                format!("{name} ({word})"),
                format!("{name} {word} [x]"),
            ] {
                assert_eq!(Heading::of(&text), Heading::NoDeviation, "{text}");
            }
        }
    }
    for text in ["Δm", "δm (kg)", "∆m [lb]", "U(mass) k=2", "mass_plus", "mass minus", "CG plus"]
    {
        assert_eq!(Heading::of(text), Heading::NoDeviation, "{text}");
    }
    for text in ["dm", "um", "product range", "moment", "book=3", "Hi", "plus"] {
        assert_ne!(Heading::of(text), Heading::NoDeviation, "{text}");
    }
}
