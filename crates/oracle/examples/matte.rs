//! Holds a matte surface to every law, right and with a mistake: it samples by area and calls the density a cosine.
//! `cargo run --release -p etalon-oracle --example matte`

#![allow(clippy::print_stdout)]

use std::f64::consts::{PI, TAU};

use etalon_oracle::subjects::{Density, Scattered, Scatters};
use etalon_oracle::suite;

struct Matte {
    albedo: f64,
    is_wrong: bool,
}

impl Scatters for Matte {
    fn f(&self, wo: [f64; 3], wi: [f64; 3], _nm: f64) -> f64 {
        if wo[2] * wi[2] > 0.0 { self.albedo / PI } else { 0.0 }
    }

    fn pdf(&self, wo: [f64; 3], wi: [f64; 3], _nm: f64) -> f64 {
        if wo[2] * wi[2] > 0.0 { wi[2].abs() / PI } else { 0.0 }
    }

    fn sample(&self, wo: [f64; 3], u: [f64; 3], nm: f64) -> Option<Scattered> {
        // Uniform on the hemisphere, or by the cosine.
        let cosine = if self.is_wrong { 1.0 - u[0] } else { (1.0 - u[0]).sqrt() };
        let (sine, phi) = ((1.0 - cosine * cosine).sqrt(), TAU * u[1]);
        let wi = [sine * phi.cos(), sine * phi.sin(), cosine.copysign(wo[2])];
        Some(Scattered { wi, weight: self.albedo, density: Density::SolidAngle(self.pdf(wo, wi, nm)) })
    }
}

fn main() {
    for is_wrong in [false, true] {
        println!("{}", if is_wrong { "With the mistake:" } else { "As it should be:" });
        for verdict in suite::scatters(&Matte { albedo: 0.7, is_wrong }, 1) {
            println!("  {} {}", if verdict.pass { "holds " } else { "BROKEN" }, verdict.law);
            if !verdict.pass {
                println!("         {}", verdict.evidence);
            }
        }
    }
}
