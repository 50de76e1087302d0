//! Whether light is polarised, and by how much it matters that it is not.

use super::{first_surface, media, surface};
use crate::bsdf::PathFilm;
use crate::bsdf::properties;
use crate::texture;
use etalon_optics::{Complex, RefractiveIndex, colour::colour_matching, fresnel, reference_nm, spectrum::whole_nm};
use etalon_scene::{MaterialKind, Metal, Parameter, Scene};

/// Why polarisation is not carried where it could make no difference.
pub(in crate::plan) const UNPOLARISED: &str = "nothing polarises light";

/// Whether polarisation is carried. Where it is not but could matter, how much it could.
pub(in crate::plan) fn polarisation(scene: &Scene, asked_for: bool) -> Result<String, String> {
    if asked_for {
        return Ok("asked for by --polarised".to_owned());
    }
    let sheet = first_surface(scene, |material, _| {
        let properties = properties(&material.kind);
        properties.polarising_axis.then(|| properties.smooth_name.to_owned())
    });
    if let Some(found) = sheet {
        return Ok(found);
    }
    if scene.film.stokes {
        return Ok("film: stokes".to_owned());
    }
    let of_surfaces = scene.placed_objects().filter_map(|object| {
        let material = &scene.materials[object.material];
        let range_nm = scene.integrator.wavelength_range_nm;
        let (share, how) = polarises(&material.kind, range_nm)?;
        Some((share, format!("{}: {how}", surface(object, material))))
    });
    let of_media = media::polarises(scene).map(|found| (1.0, found));
    // The first of the worst.
    let worst = of_surfaces.chain(of_media).reduce(|worst, other| if other.0 > worst.0 { other } else { worst });
    match worst {
        None => Err(UNPOLARISED.to_owned()),
        Some((_, found)) => {
            Err(format!("not asked for (--polarised); s and p are averaged, which errs most at {found}"))
        }
    }
}

/// By which share averaging s and p at a surface can be off after two of them, and that in words: two surfaces of diattenuation
/// a = (A_s − A_p)/(A_s + A_p) each hand on 1 + a² of what the averages do where their planes of incidence are parallel, and 1 − a²
/// where they are crossed.
fn polarises(kind: &MaterialKind, range_nm: [f64; 2]) -> Option<(f64, String)> {
    let of_parameter = |parameter| match parameter {
        Parameter::Interface(media) => {
            let [interior, exterior] = media.map(|index| index.eval(reference_nm(range_nm)));
            glass(interior / exterior)
        }
        Parameter::Coat(index) => glass(index.eval(reference_nm(range_nm))),
        Parameter::Metal(Metal::Reflectance(reflectance)) => {
            let mean = texture::mean(reflectance);
            metal(range_nm, |nm| (1.0, Metal::k_of(mean.eval(nm))))
        }
        Parameter::Metal(Metal::Index(index)) => metal(range_nm, |nm| index.eval(nm)),
        // What states a reflectance, was measured or is principled treats s and p alike; sheets call for polarisation themselves.
        // Films are looked at with what they coat.
        Parameter::Reflectance(_)
        | Parameter::Sheet(_)
        | Parameter::Film(_)
        | Parameter::Grating(_)
        | Parameter::Fluorescence(_)
        | Parameter::Measured(_)
        | Parameter::Principled(_) => None,
    };
    let coated = kind.parts().into_iter().filter_map(|part| film(part, range_nm));
    let worst = kind.parameters().into_iter().filter_map(of_parameter).chain(coated);
    worst.reduce(|worst, other| if other.0 > worst.0 { other } else { worst })
}

/// [`polarises`] of a metal of n + ik at each wavelength.
fn metal(range_nm: [f64; 2], index: impl Fn(f64) -> (f64, f64)) -> Option<(f64, String)> {
    worst_angle(range_nm, |nm, cos| {
        let (n, k) = index(nm);
        let f = fresnel::conductor(cos, n, k);
        [f.reflectance_s, f.reflectance_p]
    })
}

/// [`polarises`] of a surface that reflects the shares of s and p that a function of the wavelength and the cosine says.
fn worst_angle(range_nm: [f64; 2], reflectances: impl Fn(f64, f64) -> [f64; 2]) -> Option<(f64, String)> {
    let mut worst = (0.0, 0.0, 1.0);
    for nm in seen(range_nm) {
        for cos in (1..100).map(|i| f64::from(i) / 100.0) {
            let [s, p] = reflectances(nm, cos);
            let sum = s + p;
            let most = if sum > 0.0 { ((s - p) / sum).abs() } else { 0.0 };
            if most > worst.0 {
                worst = (most, nm, cos);
            }
        }
    }
    let (most, nm, cos) = worst;
    let (share, degrees) = (most * most, cos.acos().to_degrees());
    Some((share, format!("by up to {:.2} % after two reflections, at {degrees:.0}° and {nm} nm", 100.0 * share)))
}

/// [`polarises`] of a part that is coated, by what it reflects from its outer side.
fn film(part: &MaterialKind, range_nm: [f64; 2]) -> Option<(f64, String)> {
    let transparent = |index: &RefractiveIndex, nm: f64| Complex::real(index.eval(nm));
    let vacuum = RefractiveIndex::VACUUM;
    let (film, incident): (_, &RefractiveIndex) = match part {
        MaterialKind::Conductor { film, .. }
        | MaterialKind::RoughConductor { film, .. }
        | MaterialKind::ThinDielectric { film, .. } => (film, &vacuum),
        MaterialKind::Dielectric { exterior, film, .. } | MaterialKind::RoughDielectric { exterior, film, .. } => {
            (film, exterior)
        }
        _ => return None,
    };
    let film = PathFilm::of(film.as_ref())?;
    let mean = part.parameters().into_iter().find_map(|parameter| parameter.reflectance()).map(texture::mean);
    let substrate = |nm: f64| match part {
        MaterialKind::Dielectric { interior, .. } | MaterialKind::RoughDielectric { interior, .. } => {
            transparent(interior, nm)
        }
        MaterialKind::ThinDielectric { index, .. } => transparent(index, nm),
        MaterialKind::Conductor { metal, .. } | MaterialKind::RoughConductor { metal, .. } => match metal {
            Metal::Index(index) => {
                let (n, k) = index.eval(nm);
                Complex::new(n, k)
            }
            Metal::Reflectance(_) => Complex::new(1.0, mean.as_ref().map_or(0.0, |mean| Metal::k_of(mean.eval(nm)))),
        },
        _ => Complex::ONE,
    };
    worst_angle(range_nm, |nm, cos| {
        let wave = film.fresnel(nm, cos, (incident.eval(nm), substrate(nm)), true, [0.5; 2]).reflection;
        [wave.s.squared(), wave.p.squared()]
    })
}

/// The wavelengths of a range that count for what the eye sees, at least a hundredth of the most; all, if none does.
fn seen(range_nm: [f64; 2]) -> Vec<f64> {
    let seen: Vec<f64> = whole_nm(range_nm).filter(|&nm| colour_matching(nm)[1] >= 0.01).collect();
    if seen.is_empty() { whole_nm(range_nm).collect() } else { seen }
}

/// [`polarises`] of an interface of relative index `n`: reflection at Brewster's angle leaves s alone; and what a plate passes on
/// at 75°, followed for s and p each, against the averages at each face.
fn glass(n: f64) -> Option<(f64, String)> {
    if n == 1.0 {
        return None;
    }
    let brewster = n.atan().to_degrees();
    let plate = |reflectance: f64| (1.0 - reflectance) / (1.0 + reflectance);
    let behind = fresnel::dielectric(75_f64.to_radians().cos(), n).map(|f| {
        let polarised = 0.5 * (plate(f.r_s * f.r_s) + plate(f.r_p * f.r_p));
        format!(", by {:.1} % behind a plate at 75°", 100.0 * (polarised / plate(f.reflectance) - 1.0))
    });
    let behind = behind.unwrap_or_default();
    Some((1.0, format!("by up to a factor of 2 after two reflections at {brewster:.1}°{behind} (n {n:.3})")))
}
