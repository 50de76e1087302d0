"""Writes scenes/diamond.json: a round brilliant of 5 mm that lies on a table.

The stone rests on one of its pavilion mains, as a loose stone does; a gap of 5 µm keeps it from the table, since
surfaces that coincide would have no order. Plain standard library.
"""

import math

import scene_text
from brilliant import brilliant, check, dot, plane, triangles_of

PAVILION_DEG = 40.75
GAP = 5e-6  # m
TURN_DEG = -62.0  # of the table's tilt, from +x toward the viewer

vertices, facets = brilliant(5e-3, pavilion_deg=PAVILION_DEG)
found = check(vertices, facets)
rests_on = next(loop for kind, loop in facets if kind == "pavilion main")
_, distance = plane(vertices, rests_on)


def lamp(name, direction, distance_m, radius_m, radiance):
    """A disk that faces the stone from a direction given as (azimuth, elevation) in degrees, 0 toward the viewer."""
    azimuth, elevation = map(math.radians, direction)
    toward = (math.sin(azimuth) * math.cos(elevation), math.sin(elevation), math.cos(azimuth) * math.cos(elevation))
    return {
        "name": name,
        "shape": {
            "type": "disk", "center_m": [round(distance_m * x, 6) for x in toward],
            "normal": [round(-x, 6) for x in toward], "radius_m": radius_m,
        },
        "material": "black",
        "emission": {"radiance": {"type": "illuminant", "name": "D65", "scale": radiance}},
    }


if __name__ == "__main__":
    for key, value in found.items():
        print(f"{key}: {value}")
    lamps = [
        lamp("lamp 1", (-60, 35), 0.3, 0.016, 70),
        lamp("lamp 2", (-25, 68), 0.3, 0.016, 70),
        lamp("lamp 3", (35, 60), 0.3, 0.016, 70),
        lamp("lamp 4", (75, 40), 0.3, 0.016, 70),
        lamp("lamp 5", (140, 55), 0.3, 0.016, 70),
        lamp("lamp 6", (-140, 50), 0.3, 0.016, 70),
        lamp("lamp 7", (12, 80), 0.3, 0.016, 70),
        lamp("softbox, left", (-75, 50), 0.4, 0.11, 2.5),
        lamp("softbox, right", (60, 25), 0.4, 0.08, 2.5),
        lamp("softbox, behind", (170, 40), 0.4, 0.13, 2.5),
    ]
    scene_text.write("diamond", {
        "etalon": 1,
        "comment": [
            "A round brilliant of 5 mm (0.46 carat), modelled in metres: table 53 %, crown 34.5°, pavilion 40.75° (M. Tolkowsky, Diamond",
            "Design, 1919), 57 facets and a faceted girdle, each facet plane to rounding. It lies on one of its pavilion mains, table up",
            "and toward the viewer, in a bright room with seven small lamps and three soft ones.",
            "Look at: the dark star, in which the eight mains show the viewer's own head (a black disk behind the camera); brilliance, the",
            "room's white light returned by total reflection at the pavilion; fire, the pure colours at the edges of the lamps' images, which",
            "dispersion has spread; glints thrown on the table, the last to converge.",
            "The formula for diamond's index is known to 760 nm, so only 360 to 760 nm are rendered: beyond, the observer is all but blind.",
            "Written by scenes/generators/diamond.py.",
        ],
        "camera": {
            "type": "perspective", "position_m": [0.0124, 0.0335, 0.0307], "look_at_m": [0, 0.0019, 0.0001], "horizontal_fov_deg": 9,
        },
        "film": {"width": 512, "height": 448, "filter": {"type": "gaussian", "sigma_px": 0.5}},
        "integrator": {"spp": 256, "wavelength_range_nm": [360, 760]},
        "materials": {
            "diamond": {"type": "dielectric", "interior": "diamond"},
            "table": {"type": "lambert", "reflectance": {"type": "rgb", "rgb": [0.03, 0.036, 0.055]}},
            "black": {"type": "black"},
        },
        "objects": [
            {"name": "table", "shape": {"type": "parallelogram", "origin_m": [-1, 0, 1], "u_m": [2, 0, 0], "v_m": [0, 0, -2]},
             "material": "table"},
            {"name": "viewer's head", "comment": "A dark disk just behind the camera, some 50° across from the stone.",
             "shape": {"type": "disk", "center_m": [0.015, 0.041, 0.0375], "normal": [-15, -39.1, -37.4], "radius_m": 0.026},
             "material": "black"},
            *lamps,
            {
                "name": "brilliant",
                "material": "diamond",
                "transform": [
                    {"rotate": {"axis": [0, 0, 1], "angle_deg": -PAVILION_DEG}},
                    {"rotate": {"axis": [0, 1, 0], "angle_deg": TURN_DEG}},
                    {"translate_m": [0, round(distance + GAP, 9), 0]},
                ],
                "shape": {
                    "type": "mesh",
                    "vertices_m": [list(v) for v in vertices],
                    "triangles": [list(t) for t in triangles_of(facets)],
                },
            },
        ],
        "lights": [{"type": "environment", "name": "room", "radiance": {"type": "illuminant", "name": "D65", "scale": 0.4}}],
    })
