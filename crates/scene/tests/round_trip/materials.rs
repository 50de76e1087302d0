//! Materials and their spectra.

use super::*;

fn kind<'s>(scene: &'s Scene, name: &str) -> &'s MaterialKind {
    &scene.materials.iter().find(|m| m.name == name).expect("a material").kind
}

#[test]
fn materials_and_spectra() {
    let scene = scene(EVERYTHING);
    let names: Vec<&str> = scene.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(
        names,
        [
            "lambert",
            "red",
            "board",
            "dawn",
            "table",
            "mirror",
            "perfect",
            "gold",
            "own metal",
            "glass",
            "dispersive",
            "own glass",
            "solid",
            "black",
            "milk",
            "cloud",
            "drops",
            "clay",
            "leaf",
            "toy",
            "pane",
            "coated",
            "bubble",
            "coated pane",
            "disc",
            "vest",
            "marker",
            "film",
            "quarter",
            "dusty",
            "painted",
            "slope",
            "stained",
            "lacquered",
            "jar",
            "bronzed",
            "car",
            "clouds",
            "haze",
            "pot",
            "playing card",
            "objects[4].material"
        ]
    );
    let reflects = |spectrum: Spectrum| MaterialKind::Lambert { reflectance: spectrum.into() };
    assert_eq!(kind(&scene, "lambert"), &reflects(Spectrum::Constant(0.5)));
    assert_eq!(kind(&scene, "red"), &reflects(Spectrum::rgb_reflectance([0.8, 0.1, 0.1]).expect("right")));
    let table = Spectrum::tabulated(vec![400.0, 500.0, 700.0], vec![0.2, 0.4, 0.6], Outside::Hold).expect("right");
    assert_eq!(kind(&scene, "table"), &reflects(table));
    assert_eq!(kind(&scene, "mirror"), &MaterialKind::Mirror { reflectance: Spectrum::Constant(0.9).into() });
    assert_eq!(kind(&scene, "perfect"), &MaterialKind::Mirror { reflectance: Spectrum::Constant(1.0).into() });
    let gold = ComplexIndex::named("Au").expect("gold").with_outside(OutsideFit::Clamp);
    assert_eq!(
        kind(&scene, "gold"),
        &MaterialKind::RoughConductor {
            metal: Metal::Index(gold),
            facets: Microfacets { masking: FacetMasking::Separable, ..0.25.into() },
            compensated: false,
            film: None,
        }
    );
    let own = ComplexIndex::tabulated(vec![300.0, 900.0], vec![0.2, 0.3], vec![3.0, 4.0]).expect("right");
    let gaussian = |facets| Microfacets { distribution: FacetDistribution::Beckmann, ..facets };
    let apart = |facets| Microfacets { masking: FacetMasking::Separable, ..gaussian(facets) };
    let facets = gaussian(Microfacets::ggx([0.125, 0.5], FRAC_PI_2));
    let own = MaterialKind::RoughConductor { metal: Metal::Index(own), facets, compensated: true, film: None };
    assert_eq!(kind(&scene, "own metal"), &own);
    let glass = |name| RefractiveIndex::named(name).expect("a glass");
    assert_eq!(
        kind(&scene, "glass"),
        &MaterialKind::Dielectric {
            interior: glass("N-BK7"),
            exterior: RefractiveIndex::VACUUM,
            priority: None,
            film: None
        }
    );
    assert_eq!(
        kind(&scene, "dispersive"),
        &MaterialKind::RoughDielectric {
            interior: glass("N-SF11").with_outside(OutsideFit::Clamp),
            exterior: RefractiveIndex::Constant(1.33),
            facets: apart(1.0.into()),
            compensated: true,
            priority: None,
            film: None
        }
    );
    let terms = vec![SellmeierTerm { b: 1.039_612_12, c_um2: 0.006_000_698_67 }];
    assert_eq!(
        kind(&scene, "own glass"),
        &MaterialKind::Dielectric {
            interior: RefractiveIndex::sellmeier(terms, Some([300.0, 2500.0])).expect("right"),
            exterior: RefractiveIndex::cauchy(1.5, 0.004, 0.0001, Some([400.0, 700.0]))
                .expect("right")
                .with_outside(OutsideFit::Clamp),
            priority: None,
            film: None
        }
    );
    assert_eq!(
        kind(&scene, "solid"),
        &MaterialKind::Dielectric {
            interior: glass("water"),
            exterior: RefractiveIndex::VACUUM,
            priority: Some(7),
            film: None
        }
    );
    assert_eq!(kind(&scene, "black"), &MaterialKind::Black);
    let layer = |thickness_nm: f64, index| FilmLayer { thickness_nm: thickness_nm.into(), index };
    let film = |layers| Some(ThinFilm { layers, at_nm: None });
    let clear = |index| FilmIndex::Transparent(index);
    let metal = |name| ComplexIndex::named(name).expect("a metal").with_outside(OutsideFit::Clamp);
    let table = ComplexIndex::tabulated(vec![300.0, 900.0], vec![2.0, 3.0], vec![0.0, 1.0]).expect("right");
    let layers = vec![
        layer(60.0, clear(RefractiveIndex::Constant(2.4))),
        layer(12.5, FilmIndex::Absorbing(metal("Au"))),
        layer(0.0, FilmIndex::Absorbing(table)),
    ];
    let coated = MaterialKind::Conductor { metal: Metal::Index(metal("Ag")), film: film(layers) };
    assert_eq!(kind(&scene, "coated"), &coated);
    let bubble = MaterialKind::Dielectric {
        interior: RefractiveIndex::VACUUM,
        exterior: RefractiveIndex::VACUUM,
        priority: None,
        film: film(vec![layer(300.0, clear(glass("water")))]),
    };
    assert_eq!(kind(&scene, "bubble"), &bubble);
    let pane = MaterialKind::ThinDielectric {
        index: RefractiveIndex::Constant(1.5),
        film: film(vec![layer(100.0, clear(RefractiveIndex::Constant(1.38)))]),
    };
    assert_eq!(kind(&scene, "coated pane").untinted(), &pane);
    let grating = Grating {
        period_nm: 1600.0,
        orders: vec![(0, 0.5), (-2, 0.25)],
        grooves: Grooves::Straight(FRAC_PI_2),
        transmits: true,
        at_nm: None,
    };
    let disc = MaterialKind::Grating { reflectance: Spectrum::Constant(0.75).into(), grating };
    assert_eq!(kind(&scene, "disc"), &disc);
    let rows = [vec![0.0, 0.002, 0.001], vec![0.001, 0.004, 0.0]];
    let matrix = ReradiationMatrix::new(vec![400.0, 500.0], vec![500.0, 550.0, 600.0], &rows).unwrap();
    let vest = MaterialKind::Fluorescent {
        reflectance: Spectrum::Constant(0.125).into(),
        fluorescence: Fluorescence::Matrix(matrix),
    };
    assert_eq!(kind(&scene, "vest"), &MaterialKind::one_sided(vest, Side::Front));
    let emission = Spectrum::tabulated(vec![500.0, 600.0], vec![1.0; 2], Outside::Zero).unwrap();
    let dye = Fluorophore::new(Spectrum::Constant(0.75), emission, 0.5, scene.integrator.wavelength_range_nm).unwrap();
    let marker = MaterialKind::Fluorescent {
        reflectance: Spectrum::ZERO.into(),
        fluorescence: Fluorescence::Fluorophores(vec![dye]),
    };
    assert_eq!(kind(&scene, "marker"), &marker);
    let clay = MaterialKind::OrenNayar { reflectance: Spectrum::Constant(0.5).into(), roughness: 0.4 };
    // Seen from its front, what is made for the back.
    assert_eq!(kind(&scene, "playing card"), &MaterialKind::one_sided(clay.clone(), Side::Front));
    assert_eq!(kind(&scene, "clay"), &MaterialKind::one_sided(clay, Side::Back));
    let [reflectance, transmittance] = [0.25, 0.625].map(|share| Spectrum::Constant(share).into());
    assert_eq!(kind(&scene, "leaf"), &MaterialKind::Translucent { reflectance, transmittance });
    let (reflectance, coat) = (Spectrum::Constant(0.25).into(), RefractiveIndex::Constant(1.5));
    let toy = MaterialKind::Plastic {
        reflectance,
        coat,
        facets: Some(apart(0.1.into())),
        internal_reflection: InternalReflection::Uncoloured,
        compensated: false,
    };
    assert_eq!(kind(&scene, "toy"), &toy);
    let tinted = |kind, shares: [f64; 2]| {
        let [reflected, transmitted] = shares.map(|share| Spectrum::Constant(share).into());
        MaterialKind::Tinted { kind: Box::new(kind), reflected, transmitted }
    };
    let (interior, exterior) = (RefractiveIndex::Constant(1.5), RefractiveIndex::Constant(1.0));
    let stained = MaterialKind::Dielectric { interior, exterior, priority: None, film: None };
    assert_eq!(kind(&scene, "stained"), &tinted(stained, [0.75, 0.25]));
    let silver = MaterialKind::Conductor { metal: Metal::Index(ComplexIndex::named("Ag").unwrap()), film: None };
    let bronzed = MaterialKind::one_sided(tinted(silver, [0.5, 1.0]), Side::Front);
    assert_eq!(kind(&scene, "bronzed"), &bronzed);
    let (reflectance, coat) = (Spectrum::Constant(0.25).into(), RefractiveIndex::Constant(1.5));
    let lacquered = MaterialKind::Plastic {
        reflectance,
        coat,
        facets: None,
        internal_reflection: InternalReflection::Lost,
        compensated: true,
    };
    assert_eq!(kind(&scene, "lacquered"), &tinted(lacquered, [0.5, 1.0]));
    let jar = scene.materials.iter().find(|material| material.name == "jar").expect("a jar");
    assert_eq!(&jar.kind, kind(&scene, "pane"));
    assert_eq!(jar.medium.as_ref().expect("it is filled").absorption, Spectrum::Constant(2.0));
    let facets = |alpha: [f64; 2], rotation_rad: f64| Microfacets {
        masking: FacetMasking::Separable,
        ..Microfacets::ggx(alpha, rotation_rad)
    };
    let car = MaterialKind::Principled {
        reflectance: Spectrum::rgb_reflectance([0.8, 0.1, 0.1]).expect("right").into(),
        index: RefractiveIndex::Constant(1.5),
        facets: facets([0.25; 2], 0.0),
        lobes: Box::new(PrincipledLobes {
            metallic: 0.5,
            specular_tint: 0.25,
            flatness: 0.125,
            sheen: 0.5,
            sheen_tint: 0.75,
            clear_coat: 1.0,
            clear_coat_alpha: 0.0625,
        }),
    };
    assert_eq!(kind(&scene, "car"), &MaterialKind::one_sided(car, Side::Front));
    let pot = MaterialKind::Principled {
        reflectance: Spectrum::Constant(0.5).into(),
        index: RefractiveIndex::Constant(1.5),
        facets: facets([0.25, 0.5], 45.0_f64.to_radians()),
        lobes: Box::new(PrincipledLobes { clear_coat_alpha: 0.1, ..PrincipledLobes::default() }),
    };
    assert_eq!(kind(&scene, "pot"), &pot);
    assert_eq!(kind(&scene, "pane"), &MaterialKind::ThinDielectric { index: glass("N-BK7"), film: None });
    let sheet = PolarisingSheet::Polariser { transmittance: Spectrum::Constant(0.75), extinction: 0.125 };
    assert_eq!(kind(&scene, "film"), &MaterialKind::PolarisingSheet { axis: [0.0, 1.0, 0.0], sheet });
    let sheet = PolarisingSheet::Retarder { retardance_rad: FRAC_PI_2, at_nm: Some(550.0) };
    assert_eq!(kind(&scene, "quarter"), &MaterialKind::PolarisingSheet { axis: [1.0, 0.0, 0.0], sheet });
    let dusty = MaterialKind::blend(toy, MaterialKind::Black, 0.125);
    assert_eq!(kind(&scene, "dusty"), &dusty);
    let medium =
        |name: &str| scene.materials.iter().find(|m| m.name == name).and_then(|m| m.medium.as_deref().cloned());
    let absorbing = |per_m| Some(Medium::absorbing(Spectrum::Constant(per_m)));
    assert_eq!(medium("solid"), absorbing(0.5));
    // −ln ¼ over 2 m.
    assert_eq!(medium("own glass"), absorbing(4.0_f64.ln() / 2.0));
    assert_eq!(medium("dispersive"), None);
    let exterior = |name: &str| {
        scene.materials.iter().find(|m| m.name == name).and_then(|m| m.exterior_medium.as_deref().cloned())
    };
    assert_eq!((exterior("milk"), exterior("solid")), (absorbing(0.125), None));
    let cloud = Medium {
        absorption: Spectrum::Constant(0.25),
        scattering: Spectrum::Constant(50.0),
        phase: PhaseFunction::DoubleHenyeyGreenstein { g: [0.875, -0.25], weight: 0.75 },
        source: Some(Spectrum::blackbody(5000.0, 1e-3).expect("right")),
        density: MediumDensity::Uniform,
        albedo: None,
    };
    assert_eq!(kind(&scene, "drops"), &MaterialKind::Boundary { priority: Some(5) });
    assert_eq!((medium("cloud"), kind(&scene, "cloud")), (Some(cloud), &MaterialKind::Boundary { priority: None }));
    let air = scene.medium.as_ref().expect("it has one");
    assert_eq!((&air.scattering, &air.phase), (&Spectrum::Constant(1e-5), &PhaseFunction::Rayleigh));
    let exponential = ExponentialDensity { base_m: [0.0, -1.0, 0.0], up: [0.0, 0.0, 1.0], scale_height_m: 8000.0 };
    assert_eq!(air.density, MediumDensity::Exponential(exponential));
    assert_eq!((scene.objects[0].opacity, scene.objects[1].opacity), (0.75, 1.0));
    assert_eq!(kind(&scene, "objects[4].material"), &reflects(Spectrum::Constant(1.0)));
}
