pub struct Series<'a> {
    pub name: &'a str,
    pub values: &'a [f64],
}
pub struct Panel<'a> {
    pub label: String,
    pub series: Vec<Series<'a>>,
    pub nominal: Option<f64>,
}
pub fn histogram_grid(_title: &str, _panels: &[Option<Panel<'_>>], _columns: usize) -> String {
    String::new()
}
pub struct Cloud<'a> {
    pub name: &'a str,
    pub attitudes: &'a [nalgebra::UnitQuaternion<f64>],
    pub mean: nalgebra::UnitQuaternion<f64>,
}
pub fn attitude_spheres(_title: &str, _clouds: &[Cloud<'_>]) -> String {
    String::new()
}
