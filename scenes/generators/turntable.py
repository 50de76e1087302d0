"""Writes scenes/turntable.json: an orrery on a turning plate, whose three seconds begin again where they end."""

from scene_text import write

LOOP_S = 3
TILTED = [{"rotate": {"axis": [1, 0, 0.3], "angle_deg": 24}}]


def rgb(*value):
    return {"type": "rgb", "rgb": list(value)}


def ball(name, radius_m, material, center_m=(0, 0, 0), **more):
    return {"name": name, "shape": {"type": "sphere", "center_m": list(center_m), "radius_m": radius_m}, "material": material, **more}


def rod(name, start_m, end_m, radius_m, material, **more):
    shape = {"type": "cylinder", "start_m": list(start_m), "end_m": list(end_m), "radius_m": radius_m}
    return {"name": name, "shape": shape, "material": material, **more}


def turning(name, group, turns, place_m=(0, 0, 0), first_deg=0):
    """So many turns about the vertical in the loop. Neighbouring keyframes are a third of a turn apart, or the whole way."""
    count = max(1, round(3 * abs(turns)))
    move = [{"translate_m": list(place_m)}] if any(place_m) else []
    keys = [
        {
            "time_s": LOOP_S * k / count,
            "transform": [{"rotate": {"axis": [0, 1, 0], "angle_deg": first_deg + 360 * turns * k / count}}, *move],
        }
        for k in range(count + 1)
    ]
    return {"name": name, "group": group, "keyframes": keys}


def arm(length_m, height_m, planet):
    """An arm from the post to a pin with a planet on it."""
    end = (length_m, height_m, 0)
    return [
        rod("arm", (0, height_m, 0), end, 0.007, "brass"),
        rod("pin", end, (length_m, height_m + 0.06, 0), 0.005, "brass"),
        *planet((length_m, height_m + 0.06, 0)),
    ]


def studs(count=12):
    stud = {"shape": {"type": "sphere", "center_m": [0.57, 0.06, 0], "radius_m": 0.018}, "material": "brass"}
    place = lambda k: [{"rotate": {"axis": [0, 1, 0], "angle_deg": 360 * k / count}}]
    return {"objects": [stud]}, {"group": "stud", "transforms": [place(k) for k in range(count)]}


stud, all_studs = studs()
scene = {
    "etalon": 1,
    "comment": [
        "An orrery of brass on a turning plate: a lamp for the sun, and three planets, one with a moon and one with a ring.",
        "All of it is back where it began after three seconds. `etalon render scenes/turntable.json --frames 0:35 --fps 12` renders",
        "the loop; each frame is exposed for a fiftieth of a second (docs/how-to/sequences.md).",
        "Written by scenes/generators/turntable.py.",
    ],
    "camera": {
        "type": "perspective",
        "position_m": [0, 1.1, 2.0],
        "look_at_m": [0, 0.19, 0],
        "vertical_fov_deg": 32,
        "shutter_s": [0, 0.02],
    },
    "film": {"width": 480, "height": 320, "filter": {"type": "gaussian", "sigma_px": 0.5}},
    "integrator": {"spp": 256, "max_depth": 10},
    "materials": {
        "table": {"type": "lambert", "reflectance": rgb(0.32, 0.34, 0.38)},
        "walnut": {"type": "plastic", "reflectance": rgb(0.22, 0.09, 0.04), "alpha": 0.2},
        "brass": {"type": "conductor", "metal": "Au", "alpha": 0.25},
        "silver": {"type": "conductor", "metal": "Ag", "alpha": 0.2},
        "copper": {"type": "conductor", "metal": "Cu", "alpha": 0.2},
        "sea": {"type": "plastic", "reflectance": rgb(0.03, 0.14, 0.5), "alpha": 0.12},
        "sand": {"type": "plastic", "reflectance": rgb(0.7, 0.42, 0.16), "alpha": 0.2},
        "black": {"type": "black"},
    },
    "groups": {
        "stud": stud,
        "plate": {
            "objects": [
                rod("plate", (0, 0.02, 0), (0, 0.06, 0), 0.62, "walnut"),
                rod("rim", (0, 0, 0), (0, 0.02, 0), 0.64, "brass"),
            ],
            "instances": [all_studs],
        },
        "inner planet": {"objects": arm(0.22, 0.34, lambda at: [ball("inner planet", 0.042, "copper", at)])},
        "moon": {
            "objects": [rod("moon's arm", (0, 0.03, 0), (0.13, 0.03, 0), 0.004, "brass"), ball("moon", 0.024, "silver", (0.13, 0.045, 0))]
        },
        "middle planet": {
            "objects": arm(0.38, 0.24, lambda at: [ball("middle planet", 0.072, "sea", at)]),
            "instances": [turning("moon", "moon", 4, (0.38, 0.24, 0))],
        },
        "ring": {
            "objects": [
                ball("outer planet", 0.06, "sand"),
                rod("ring", (0, -0.002, 0), (0, 0.002, 0), 0.115, "silver"),
            ]
        },
        "outer planet": {
            "objects": arm(0.53, 0.14, lambda at: []),
            "instances": [{"group": "ring", "transform": [*TILTED, {"translate_m": [0.53, 0.2, 0]}]}],
        },
    },
    "objects": [
        {"name": "table", "shape": {"type": "disk", "normal": [0, 1, 0], "radius_m": 8}, "material": "table"},
        rod("post", (0, 0.06, 0), (0, 0.44, 0), 0.016, "brass"),
        ball("sun", 0.085, "black", (0, 0.5, 0), emission={"radiance": {"type": "blackbody", "temperature_k": 2900, "scale": 0.006}}),
        {
            "name": "key light",
            "shape": {"type": "parallelogram", "origin_m": [-2.4, 2.6, -0.6], "u_m": [1.5, 0, 0], "v_m": [0, 0.5, 1.6]},
            "material": "black",
            "emission": {"radiance": {"type": "illuminant", "name": "D65", "scale": 9}, "sides": "both"},
        },
    ],
    "instances": [
        turning("plate", "plate", 0.25),
        turning("inner planet", "inner planet", 3, first_deg=200),
        turning("middle planet", "middle planet", 2, first_deg=80),
        turning("outer planet", "outer planet", 1, first_deg=-30),
    ],
    "lights": [{"type": "environment", "radiance": rgb(0.22, 0.26, 0.34)}],
}

if __name__ == "__main__":
    write("turntable", scene)
