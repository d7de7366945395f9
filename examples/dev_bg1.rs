#[path = "../benches/meter/mod.rs"]
mod meter;
use quadfront::core::convert::conversion::background;
use quadfront::core::io::built_in;
use quadfront::core::progress::Nobody;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let mut case = built_in::named(&a[1]).unwrap().unwrap();
    case.parameters.size_scale = a[2].parse().unwrap();
    let t = meter::now();
    let bg = background(&case, &mut Nobody).unwrap();
    println!("{} {}", meter::since(t), bg.mesh.element_count());
}
