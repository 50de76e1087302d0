"""The facets of a round brilliant-cut gemstone, computed from its proportions.

Own coordinates: metres, y up through the table, the plane half way up the girdle is y = 0, a main facet faces +x.
Every facet is cut as a cutter cuts it, as a plane; vertices are where planes (and the girdle's polygon) meet, so that
facets are planar to rounding. Proportions are the usual ones, lengths as shares of the girdle's diameter:

    table         width of the table from corner to corner
    crown_deg     angle of the 8 mains (kites) of the crown with the girdle plane
    pavilion_deg  the same for the 8 mains of the pavilion (M. Tolkowsky, Diamond Design, 1919: 53 %, 34.5°, 40.75°)
    girdle        thickness of the girdle where it is thickest
    star          how far the stars reach from the table's edge toward the girdle
    lower_half    how far the lower halves reach from the girdle toward the culet

Plain standard library; `python3 brilliant.py` prints what it checked.
"""

import math


def brilliant(diameter_m, table=0.53, crown_deg=34.5, pavilion_deg=40.75, girdle=0.025, star=0.5, lower_half=0.77,
              girdle_sides=64):
    """(vertices, facets): facets are (kind, loop of vertex indices), counter-clockwise seen from outside."""
    assert girdle_sides % 16 == 0
    radius = diameter_m / 2
    crown, pavilion = math.tan(math.radians(crown_deg)), math.tan(math.radians(pavilion_deg))
    edge = girdle * diameter_m / 2  # height of the girdle's upper edge where it is thickest
    step = 2 * math.pi / girdle_sides
    quarter = girdle_sides // 16  # sides of the girdle under one half facet
    half = math.cos(math.pi / 8)  # a main plane is met this much further out between two mains

    vertices, facets = [], []

    def vertex(r, angle, y):
        # x, then toward −z: right-handed with y up, so that growing angles turn counter-clockwise seen from above.
        vertices.append((r * math.cos(angle), y, -r * math.sin(angle)))
        return len(vertices) - 1

    main = [2 * quarter * k * step for k in range(8)]
    between = [(2 * quarter * k + quarter) * step for k in range(8)]

    # The planes of the mains, and where two neighbours meet.
    def crown_y(x):
        return edge + (radius - x) * crown

    def pavilion_y(x):
        return -edge - (radius - x) * pavilion

    table_r = table * radius
    star_r = table_r * half + star * (radius - table_r * half)
    lower_r = (1 - lower_half) * radius
    tables = [vertex(table_r, a, crown_y(table_r)) for a in main]
    stars = [vertex(star_r, a, crown_y(star_r * half)) for a in between]
    lowers = [vertex(lower_r, a, pavilion_y(lower_r * half)) for a in between]
    culet = vertex(0.0, 0.0, pavilion_y(0.0))

    # A half facet is the plane through its inner tip and the two points, on the girdle's circle, where mains and the
    # other half begin, both at the same height. The circle bulges out between them, so the plane meets it lower (on
    # the crown), which is what scallops the girdle of a real stone.
    def scallop(tip, y_edge):
        r_tip = math.hypot(vertices[tip][0], vertices[tip][2])
        chord_angle = quarter * step / 2  # from the middle of the chord to its ends

        def height(angle_from_tip):
            # Along the chord's normal, the tip lies at r_tip·cos(chord_angle), the chord at radius·cos(chord_angle).
            outward = math.cos(abs(angle_from_tip) - chord_angle)
            slope = (vertices[tip][1] - y_edge) / ((radius - r_tip) * math.cos(chord_angle))
            return y_edge + slope * radius * (math.cos(chord_angle) - outward)

        return height

    upper = [None] * girdle_sides
    lower = [None] * girdle_sides
    for side in range(girdle_sides):
        k, offset = divmod(side, 2 * quarter)
        if offset == 0:
            y_up, y_down = edge, -edge
        else:
            angle_from_tip = (offset - quarter) * step
            # The tip is at angle 0, the next main at quarter·step: measure from the tip.
            y_up = scallop(stars[k], edge)(angle_from_tip)
            y_down = scallop(lowers[k], -edge)(angle_from_tip)
        upper[side] = vertex(radius, side * step, y_up)
        lower[side] = vertex(radius, side * step, y_down)

    def around(ring, first, count):
        return [ring[(first + i) % girdle_sides] for i in range(count + 1)]

    facets.append(("table", tables))
    for k in range(8):
        before, after, here = (k - 1) % 8, (k + 1) % 8, 2 * quarter * k
        facets.append(("star", [tables[k], stars[k], tables[after]]))
        facets.append(("crown main", [tables[k], stars[before], upper[here], stars[k]]))
        facets.append(("upper half", [stars[k]] + around(upper, here, quarter)))
        facets.append(("upper half", [stars[k]] + around(upper, here + quarter, quarter)))
        facets.append(("lower half", [lowers[k]] + around(lower, here, quarter)[::-1]))
        facets.append(("lower half", [lowers[k]] + around(lower, here + quarter, quarter)[::-1]))
        facets.append(("pavilion main", [lower[here], lowers[before], culet, lowers[k]]))
    for side in range(girdle_sides):
        following = (side + 1) % girdle_sides
        facets.append(("girdle", [upper[side], lower[side], lower[following], upper[following]]))
    return vertices, facets


def triangles_of(facets):
    """Each facet as a fan of triangles about its first vertex."""
    return [(loop[0], loop[i], loop[i + 1]) for _, loop in facets for i in range(1, len(loop) - 1)]


def subtract(a, b):
    return tuple(x - y for x, y in zip(a, b))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def plane(vertices, loop):
    """Unit normal and offset of a facet, by Newell's method about its first vertex."""
    first = vertices[loop[0]]
    normal = (0.0, 0.0, 0.0)
    for i in range(1, len(loop) - 1):
        part = cross(subtract(vertices[loop[i]], first), subtract(vertices[loop[i + 1]], first))
        normal = tuple(x + y for x, y in zip(normal, part))
    length = math.sqrt(dot(normal, normal))
    unit = tuple(x / length for x in normal)
    return unit, dot(unit, first)


def check(vertices, facets):
    """Fails unless the facets bound a convex body, outward; says what was found."""
    triangles = triangles_of(facets)
    directed = {}
    for t in triangles:
        for i in range(3):
            e = (t[i], t[(i + 1) % 3])
            assert e not in directed, f"edge {e} is walked twice in one direction"
            directed[e] = t
    assert all((b, a) in directed for a, b in directed), "the surface has a boundary"
    assert sorted({i for t in triangles for i in t}) == list(range(len(vertices))), "a vertex is unused"
    euler = len(vertices) - len(directed) // 2 + len(triangles)
    assert euler == 2, f"Euler characteristic {euler}"

    size = max(abs(x) for v in vertices for x in v)
    worst_plane, least_inside = 0.0, math.inf
    for _, loop in facets:
        normal, offset = plane(vertices, loop)
        for i, v in enumerate(vertices):
            height = dot(normal, v) - offset
            if i in loop:
                worst_plane = max(worst_plane, abs(height))
            else:
                least_inside = min(least_inside, -height)
    assert worst_plane < 8 * 2**-52 * size, f"a vertex lies {worst_plane} m off its facet"
    assert least_inside > 1e-4 * size, f"not convex, or normals not outward: {least_inside}"
    volume = sum(dot(vertices[a], cross(vertices[b], vertices[c])) for a, b, c in triangles) / 6
    assert volume > 0
    kinds = {}
    for kind, _ in facets:
        kinds[kind] = kinds.get(kind, 0) + 1
    return {
        "vertices": len(vertices), "edges": len(directed) // 2, "triangles": len(triangles), "euler": euler,
        "facets": kinds, "off_plane_m": worst_plane, "nearest_other_vertex_m": least_inside, "volume_m3": volume,
    }


if __name__ == "__main__":
    stone = brilliant(5e-3)
    for key, value in check(*stone).items():
        print(f"{key}: {value}")
    heights = [v[1] for v in stone[0]]
    print(f"table {max(heights)} m, culet {min(heights)} m")
    gaps = [stone[0][a][1] - stone[0][b][1] for kind, (a, b, _, _) in stone[1][-64:]]
    print(f"girdle {min(gaps)} to {max(gaps)} m")
    # A carat is 0.2 g; diamond weighs 3515 kg/m³.
    print(f"{check(*stone)['volume_m3'] * 3515 / 2e-4:.3f} carat")
