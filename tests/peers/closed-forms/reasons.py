"""Why Etalon shows something else than a formula of glTF or of MTL, by the word that the cases name."""

REASONS = {
    "coat": "The formulas of glTF's Appendix B are samples. They weigh the base by 1 − F with Schlick's F of the half-way direction. The coat of "
    "`plastic` has Fresnel's equations. Light goes in by T(µᵢ) and comes out by T(µₒ), as reciprocity demands, and light that facets hide reaches the base.",
    "metal": "The sample formula loses light that meets several facets, and Appendix B recommends to add it. `conductor` adds it after Kulla and Conty, and "
    "has Fresnel's equations for 1 + ik instead of Schlick's formula.",
    "takes": "A clear coat takes the place of the base's own coat. The import lists this.",
    "share": "On metal white facets take 0.04 of the light at every angle. The import lists this.",
    "sheen": "A flat lobe that reflects as much in the mean stands for the fibres, which send light back where it comes from. The import lists this.",
    "film": "The extension approximates the observer by Gaussians, and Airy's sum by Schlick's formula and two orders. Etalon evaluates Airy's formula "
    "at every wavelength and polarisation, for the same real index of the base.",
    "spot": "Between its two angles a spot falls off as 3x² − 2x³, and as x² in glTF's sample code. The import lists this.",
    "range": "Light has no range. The import lists this.",
    "faces": "The layers of glTF count one reflection at a thin wall. Light goes to and fro between the two faces of a pane.",
    "phong": "The highlight of MTL is not normalised: with Ks it sends back more light, or less, than arrives. A coat that reflects 0.08 Ks head-on, or a metal if Kd "
    "is black, with Beckmann's facets of the same width stands for it. The import lists this.",
    "glass": "By MTL, `d` lets light by without an interface. With an index `Ni` above 1 and `d` below 0.5 the surface is that of glass.",
}
