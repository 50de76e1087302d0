"""Images, meshes and a grid that the scenes name. None is symmetric, so that a mirrored or turned picture differs."""

import struct
import zlib

import numpy as np


def write_exr(path, channels):
    import OpenEXR

    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(header, {k: np.ascontiguousarray(v, np.float32) for k, v in channels.items()}) as file:
        file.write(str(path))


def write_png(path, texels):
    """8-bit RGB, rows from the top."""
    height, width, _ = texels.shape
    rows = b"".join(b"\0" + row.astype(np.uint8).tobytes() for row in texels)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def hill():
    """A hill over a square: points, normals, texture coordinates, triangles."""
    n = 24
    u, v = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n))
    x, z = 2 * u - 1, 1 - 2 * v

    def height(x, z):
        return 0.6 * np.exp(-3 * ((x - 0.2) ** 2 + (z + 0.1) ** 2)) + 0.1 * np.sin(3 * x + z)

    step = 1e-5
    slope_x = (height(x + step, z) - height(x - step, z)) / (2 * step)
    slope_z = (height(x, z + step) - height(x, z - step)) / (2 * step)
    normals = np.stack([-slope_x, np.ones_like(x), -slope_z], -1).reshape(-1, 3)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    points = np.stack([x, height(x, z), z], -1).reshape(-1, 3)
    corners = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)[None]).reshape(-1)
    first = np.stack([corners, corners + 1, corners + n + 1], -1)
    second = np.stack([corners, corners + n + 1, corners + n], -1)
    return points, normals, np.stack([u, v], -1).reshape(-1, 2), np.concatenate([first, second])


def write_meshes(folder):
    points, normals, uvs, triangles = hill()
    lines = ["v {:.7g} {:.7g} {:.7g}".format(*p) for p in points] + ["vt {:.7g} {:.7g}".format(*t) for t in uvs]
    lines += ["vn {:.7g} {:.7g} {:.7g}".format(*n) for n in normals]
    lines += ["f " + " ".join(f"{c + 1}/{c + 1}/{c + 1}" for c in corners) for corners in triangles]
    (folder / "hill.obj").write_text("\n".join(lines) + "\n")

    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
    head += "".join(f"property float {name}\n" for name in "x y z nx ny nz u v".split())
    head += f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    vertices = np.concatenate([points, normals, uvs], 1).astype("<f4").tobytes()
    faces = b"".join(struct.pack("<B3i", 3, *corners) for corners in triangles)
    (folder / "hill.ply").write_bytes(head.encode() + vertices + faces)

    # Smooth colours of the vertices, and one of its own for each face.
    u, v = uvs.T
    colours = np.stack([0.1 + 0.8 * u, 0.5 + 0.4 * np.sin(5 * v), 0.9 - 0.6 * u * v], -1)
    own = np.random.default_rng(11).uniform(0.1, 0.9, (len(triangles), 3))
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
    head += "".join(f"property float {name}\n" for name in "x y z nx ny nz r g b".split())
    head += f"element face {len(triangles)}\nproperty list uchar int vertex_indices\n"
    head += "".join(f"property float {name}\n" for name in "rgb") + "end_header\n"
    vertices = np.concatenate([points, normals, colours], 1).astype("<f4").tobytes()
    faces = b"".join(struct.pack("<B3i3f", 3, *corners, *colour) for corners, colour in zip(triangles, own))
    (folder / "hill-colours.ply").write_bytes(head.encode() + vertices + faces)

    # Single precision, with normals and texture coordinates, without a name.
    body = struct.pack("<I", 0x1000 | 0x1 | 0x2) + b"\0" + struct.pack("<QQ", len(points), len(triangles))
    body += points.astype("<f4").tobytes() + normals.astype("<f4").tobytes() + uvs.astype("<f4").tobytes()
    body += triangles.astype("<u4").tobytes()
    mesh = struct.pack("<HH", 0x041C, 4) + zlib.compress(body)
    (folder / "hill.serialized").write_bytes(mesh + struct.pack("<QI", 0, 1))


def write_measured(path, phi_i):
    """A measured BRDF in the format of the RGL material database: glossy facets, whose colour changes with the angle."""
    theta_i = np.linspace(0, np.pi / 2, 6)
    wavelengths = np.linspace(360, 830, 11)
    nodes = np.linspace(0, 1, 24)
    y, x = np.meshgrid(nodes, nodes, indexing="ij")
    theta, phi = np.pi / 2 * x**2, np.pi * (2 * y - 1)
    facet = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], -1)
    # An isotropic material has no direction of its own.
    widths = (0.5, 0.5) if len(phi_i) == 1 else (0.6, 0.35)
    slopes = (facet[..., 0] / widths[0]) ** 2 + (facet[..., 1] / widths[1]) ** 2
    ndf = 1 / (np.pi * widths[0] * widths[1] * (slopes + facet[..., 2] ** 2) ** 2)
    stretch = (facet[..., 0] * widths[0]) ** 2 + (facet[..., 1] * widths[1]) ** 2 + facet[..., 2] ** 2
    sigma = 0.5 * (facet[..., 2] + np.sqrt(stretch))
    vndf, luminance, spectra = [], [], []
    for azimuth in phi_i:
        for angle in theta_i:
            light = np.array([np.sin(angle) * np.cos(azimuth), np.sin(angle) * np.sin(azimuth), np.cos(angle)])
            # Density over the square: a little of it everywhere, so that none is lost between the nodes.
            seen = ndf * np.maximum(facet @ light, 0) * 2 * np.pi**2 * x * np.sin(theta)
            vndf.append(seen + 0.02 * seen.max() * (x + 0.05))
            shape = 0.6 + 0.3 * np.sin(3 * x + angle) * np.cos(np.pi * (2 * y - 1) + azimuth)
            luminance.append(0.3 + 0.7 * shape)
            spectra.append([shape * (0.5 + 0.3 * np.cos(nm / 60 + 2 * x)) for nm in wavelengths])
    lights = (len(phi_i), len(theta_i))
    fields = {
        "description": np.frombuffer(b"made up", np.uint8),
        "theta_i": theta_i,
        "phi_i": np.array(phi_i),
        "ndf": ndf,
        "sigma": sigma,
        "vndf": np.reshape(vndf, (*lights, 24, 24)),
        "luminance": np.reshape(luminance, (*lights, 24, 24)),
        "spectra": np.reshape(spectra, (*lights, len(wavelengths), 24, 24)),
        "wavelengths": wavelengths,
        "jacobian": np.ones(1, np.uint8),
    }
    fields = {name: field if field.dtype == np.uint8 else field.astype("<f4") for name, field in fields.items()}
    at = 18 + sum(13 + len(name) + 8 * field.ndim for name, field in fields.items())
    head = b"tensor_file\0\x01\0" + struct.pack("<I", len(fields))
    for name, field in fields.items():
        kind = 1 if field.dtype == np.uint8 else 10
        head += struct.pack("<H", len(name)) + name.encode() + struct.pack("<HBQ", field.ndim, kind, at)
        head += struct.pack(f"<{field.ndim}Q", *field.shape)
        at += field.nbytes
    path.write_bytes(head + b"".join(field.tobytes() for field in fields.values()))


def write_crown(folder):
    """Polygons that are not flat, some of them concave: how they are cut into triangles is seen."""
    lines = []
    for k in range(6):
        turn = np.radians(60 * k)
        for x, y, z in ((-0.5, -0.9, 0.9), (0.5, -0.9, 0.9), (0.5, 0.9, 1.3), (0.0, 0.1, 0.7), (-0.5, 0.9, 1.3)):
            lines.append(f"v {x * np.cos(turn) + z * np.sin(turn):.7f} {y} {z * np.cos(turn) - x * np.sin(turn):.7f}")
    # From another corner each time.
    for k in range(6):
        lines.append("f " + " ".join(str(5 * k + 1 + (i + k) % 5) for i in range(5)))
    (folder / "crown.obj").write_text("\n".join(lines) + "\n")


def write_panes(folder):
    """A square of two triangles, with texture coordinates that are turned by 35°, and without."""
    points = [(-1, -1, 0), (1, -1, 0), (-1, 1, 0), (1, 1, 0)]
    turn = np.radians(35)
    vertices = "".join(f"v {x} {y} {z}\n" for x, y, z in points)
    turned = [(x * np.cos(turn) + y * np.sin(turn), y * np.cos(turn) - x * np.sin(turn)) for x, y, _ in points]
    (folder / "pane-bare.obj").write_text(vertices + "f 1 2 3\nf 2 4 3\n")
    coordinates = "".join(f"vt {u:.7f} {v:.7f}\n" for u, v in turned)
    (folder / "pane-turned.obj").write_text(vertices + coordinates + "f 1/1 2/2 3/3\nf 2/2 4/4 3/3\n")


def write_all(folder):
    write_panes(folder)
    write_crown(folder)
    rng = np.random.default_rng(7)
    write_exr(folder / "picture.exr", {c: t for t in [rng.uniform(0.1, 0.9, (5, 7))] for c in "RGB"})
    write_exr(folder / "sky.exr", {c: t for t in [rng.uniform(0.1, 1, (6, 12)) ** 2] for c in "RGB"})
    write_png(folder / "picture.png", rng.integers(20, 240, (5, 7, 3)))
    # Hills so fine that their slope hardly changes within a texel, and tilts of up to 8°.
    turns = 2 * np.pi
    u, v = np.meshgrid((np.arange(256) + 0.5) / 256, (np.arange(256) + 0.5) / 256)
    hills = 0.5 + 0.2 * np.sin(2 * turns * u + np.sin(turns * v)) + 0.1 * np.cos(3 * turns * v + 0.5 * np.sin(turns * u))
    write_exr(folder / "heights.exr", {c: hills for c in "RGB"})
    x, y = 0.1 * np.sin(turns * u + 2), 0.1 * np.cos(turns * (v + 0.1 * u)) * u
    vectors = dict(zip("RGB", (x, y, np.sqrt(1 - x * x - y * y))))
    write_exr(folder / "normals.exr", {c: 0.5 + 0.5 * part for c, part in vectors.items()})
    write_meshes(folder)
    write_measured(folder / "isotropic.bsdf", [0])
    write_measured(folder / "half-a-turn.bsdf", np.linspace(-np.pi, 0, 7))
    write_measured(folder / "two-mirrors.bsdf", np.linspace(-np.pi, -np.pi / 2, 4))
    cells = rng.uniform(0, 1, (4, 5, 3)).astype("<f4")
    box = struct.pack("<6f", 0, 0, 0, 1, 1, 1)
    (folder / "cloud.vol").write_bytes(b"VOL\x03" + struct.pack("<5i", 1, 3, 5, 4, 1) + box + cells.tobytes())
