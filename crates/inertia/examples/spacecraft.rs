//! Assembles a small spacecraft from shapes and prints its mass properties:
//! `cargo run -p gyradius-inertia --example spacecraft`.

use gyradius_inertia::{LogCholesky, MassProperties, Shape};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use std::f64::consts::FRAC_PI_2;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Vehicle frame: origin in the middle of the separation plane, axis 3 up through the bus.
    let up = |part: MassProperties, z: f64| part.translated([0.0, 0.0, z]);
    let aluminium = 2700.0;

    // A bus of 3 mm panels, 1.0 × 1.0 × 1.2 m, on a cone of 2 mm.
    let bus = up(Shape::box_shell([1.0, 1.0, 1.2])?.of_density(aluminium * 0.003)?, 0.9)?;
    let adapter = Shape::frustum_shell(0.6, 0.45, 0.3)?.of_density(aluminium * 0.002)?;
    // The panel that the adapter closes has a round opening.
    let opening = up(Shape::disc(0.45)?.of_density(aluminium * 0.003)?, 0.3)?;
    let bus = bus.without(&opening)?;

    // A titanium tank with hydrazine: a sphere in a sphere.
    let tank = up(Shape::hollow_sphere(0.298, 0.3)?.of_density(4430.0)?, 0.8)?;
    let fuel = up(Shape::sphere(0.298)?.of_density(1010.0)?, 0.8)?;

    // A reaction wheel along axis 1, and a box of electronics in a corner.
    let wheel_pose = Isometry3::from_parts(
        Vector3::new(0.3, 0.2, 1.2).into(),
        UnitQuaternion::from_axis_angle(&Vector3::y_axis(), FRAC_PI_2),
    );
    let wheel = Shape::cylinder(0.11, 0.08)?.of_mass(6.0)?.transformed(&wheel_pose)?;
    let electronics =
        Shape::solid_box([0.3, 0.25, 0.2])?.of_mass(14.0)?.translated([-0.3, 0.3, 1.35])?;

    // Two wings of 8 kg, 2.4 m long, outward along ±2, turned to the Sun by 30°.
    let sun = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 30f64.to_radians());
    let wing = Shape::plate([0.9, 2.4])?.of_mass(8.0)?.rotated(&sun)?;
    let left = wing.translated([0.0, -1.9, 0.9])?;
    let right = wing.translated([0.0, 1.9, 0.9])?;

    let parts = [
        ("bus", bus),
        ("adapter", adapter),
        ("tank", tank),
        ("fuel", fuel),
        ("wheel", wheel),
        ("electronics", electronics),
        ("left wing", left),
        ("right wing", right),
    ];
    println!("part           mass, kg        mass centre, m");
    for (name, part) in &parts {
        let c = part.mass_centre_m();
        println!("{name:12} {:9.3}   {:8.4} {:8.4} {:8.4}", part.mass_kg(), c.x, c.y, c.z);
    }

    let craft = MassProperties::combined(parts.iter().map(|(_, part)| part))?;
    report("spacecraft", &craft)?;
    report("without fuel", &craft.without(&fuel)?)?;

    let [length, width, height] = craft.equivalent_box()?.sizes_m();
    println!("\nas a solid box: {length:.3} × {width:.3} × {height:.3} m");
    let coordinates = LogCholesky::of(&craft)?.values();
    println!("log-Cholesky coordinates: {coordinates:.4?}");
    Ok(())
}

fn report(name: &str, body: &MassProperties) -> Result<(), Box<dyn std::error::Error>> {
    let c = body.mass_centre_m();
    let [i11, i22, i33, i12, i13, i23] = body.inertia().entries();
    println!("\n{name}: {:.3} kg, mass centre {:.4} {:.4} {:.4} m", body.mass_kg(), c.x, c.y, c.z);
    println!("  I₁₁ I₂₂ I₃₃, kg·m²   {i11:9.3} {i22:9.3} {i33:9.3}");
    println!("  I₁₂ I₁₃ I₂₃          {i12:9.3} {i13:9.3} {i23:9.3}");
    println!("  principal moments    {:9.3?}", body.inertia().principal_axes().moments());
    println!("  radii of gyration, m {:9.4?}", body.radii_of_gyration()?.values());
    Ok(())
}
