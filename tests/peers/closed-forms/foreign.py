"""Small scenes in glTF 2.0, in OBJ with MTL and images in PNG, written by hand; and the channels of an EXR file, read."""

import base64
import json
import struct
import zlib

import numpy as np

# Types of components of accessors, by the types of numpy.
COMPONENTS = {np.int8: 5120, np.uint8: 5121, np.int16: 5122, np.uint16: 5123, np.uint32: 5125, np.float32: 5126}
SHAPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}


class Gltf:
    """A model that is put together part by part. Methods that add something return its number."""

    def __init__(self):
        self.bytes = bytearray()
        self.json = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}]}

    def add(self, kind, value):
        self.json.setdefault(kind, []).append(value)
        return len(self.json[kind]) - 1

    def use(self, name, required=False):
        for key in ["extensionsUsed", *(["extensionsRequired"] if required else [])]:
            if name not in self.json.setdefault(key, []):
                self.json[key].append(name)

    def view(self, data, stride=None):
        self.bytes += bytes(-len(self.bytes) % 4)
        view = {"buffer": 0, "byteOffset": len(self.bytes), "byteLength": len(data)}
        self.bytes += data
        return self.add("bufferViews", view | ({"byteStride": stride} if stride else {}))

    def accessor(self, values, kind=np.float32, normalised=False):
        """Rows of numbers; rows whose size is no multiple of 4 bytes are padded, as attributes must be."""
        values = np.asarray(values, kind)
        values = values.reshape(len(values), -1)
        count, width = values.shape
        row = values.dtype.itemsize * width
        stride = row + -row % 4 if width > 1 else row
        data = b"".join(values[i].tobytes().ljust(stride, b"\0") for i in range(count))
        accessor = {"bufferView": self.view(data, stride if stride != row else None), "componentType": COMPONENTS[kind]}
        accessor |= {"count": count, "type": SHAPES[width]} | ({"normalized": True} if normalised else {})
        if width == 3:
            accessor |= {"min": values.min(0).tolist(), "max": values.max(0).tolist()}
        return self.add("accessors", accessor)

    def image(self, texels, sampler=None, **extra):
        """A texture of texels, and the keys by which a material names it."""
        uri = "data:image/png;base64," + base64.b64encode(png(texels)).decode()
        texture = {"source": self.add("images", {"uri": uri})}
        if sampler is not None:
            texture["sampler"] = self.add("samplers", sampler)
        return {"index": self.add("textures", texture)} | extra

    def material(self, base=0.5, metallic=0.0, roughness=1.0, extensions=None, **keys):
        """`base` is a grey, a colour, or a dictionary of keys of pbrMetallicRoughness."""
        surface = {"metallicFactor": metallic, "roughnessFactor": roughness}
        if isinstance(base, dict):
            surface |= base
        else:
            surface["baseColorFactor"] = [*([base] * 3 if np.isscalar(base) else base), 1]
        for name in extensions or {}:
            self.use(name)
        return self.add("materials", {"pbrMetallicRoughness": surface} | ({"extensions": extensions} if extensions else {}) | keys)

    def mesh(self, attributes, indices, material, **keys):
        primitive = {"attributes": attributes, "indices": self.accessor(indices, np.uint16), "material": material}
        return self.add("meshes", {"primitives": [primitive | keys]})

    def quad(self, material, half=4.0, z=0.0, up=1, **keys):
        """A square around the z axis, whose normal is +z, or −z with `up` −1."""
        corners = [[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]]
        attributes = {"POSITION": self.accessor(corners), "NORMAL": self.accessor([[0, 0, up]] * 4)}
        attributes["TEXCOORD_0"] = self.accessor([[0, 1], [1, 1], [1, 0], [0, 0]])
        return self.node(mesh=self.mesh(attributes, [0, 1, 2, 0, 2, 3][::up], material, **keys))

    def box(self, material, low, high):
        """A closed box whose normals point outward, with corners of its own for each face."""
        low, high = np.asarray(low, float), np.asarray(high, float)
        corners, normals, indices = [], [], []
        for axis in range(3):
            for side in [-1, 1]:
                first, second = (axis + 1) % 3, (axis + 2) % 3
                indices += [len(corners) + k for k in ([0, 1, 2, 0, 2, 3] if side == 1 else [0, 2, 1, 0, 3, 2])]
                for s, t in [(0, 0), (1, 0), (1, 1), (0, 1)]:
                    corner = np.where(side == 1, high, low)
                    corner[first], corner[second] = [low, high][s][first], [low, high][t][second]
                    corners.append(corner.tolist())
                normal = np.zeros(3)
                normal[axis] = side
                normals += [normal.tolist()] * 4
        attributes = {"POSITION": self.accessor(corners), "NORMAL": self.accessor(normals)}
        return self.node(mesh=self.mesh(attributes, indices, material))

    def glow(self, radiance):
        """A black material that shines to both sides."""
        strength = {"KHR_materials_emissive_strength": {"emissiveStrength": radiance}, "KHR_materials_specular": {"specularFactor": 0}}
        return self.material(0.0, extensions=strength, emissiveFactor=[1, 1, 1], doubleSided=True)

    def node(self, root=True, **keys):
        number = self.add("nodes", keys)
        if root:
            self.json["scenes"][0]["nodes"].append(number)
        return number

    def lamp(self, kind, intensity, position=None, toward=None, **keys):
        lamps = self.json.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})["lights"]
        lamps.append({"type": kind, "intensity": intensity} | keys)
        self.use("KHR_lights_punctual")
        position = np.zeros(3) if position is None else np.asarray(position, float)
        matrix = looking(position, position + ([0, 0, -1] if toward is None else toward))
        self.node(matrix=matrix.T.ravel().tolist(), extensions={"KHR_lights_punctual": {"light": len(lamps) - 1}})

    def camera(self, eye, target=(0, 0, 0), yfov=None, ymag=None):
        if ymag is None:
            camera = {"type": "perspective", "perspective": {"yfov": yfov, "znear": 0.01, "aspectRatio": 1}}
        else:
            camera = {"type": "orthographic", "orthographic": {"xmag": ymag, "ymag": ymag, "znear": 0.01, "zfar": 100}}
        self.node(camera=self.add("cameras", camera), matrix=looking(eye, target).T.ravel().tolist())

    def write(self, folder):
        """Writes the file into a folder, and returns its path."""
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.bytes).decode()
        path = folder / "model.gltf"
        path.write_text(json.dumps(self.json | {"buffers": [{"byteLength": len(self.bytes), "uri": uri}]}))
        return path


def looking(eye, target):
    """The matrix of a node at `eye` whose −z axis points at `target`; its y axis is as near to +y as possible, or to +x if it looks along y."""
    eye = np.asarray(eye, float)
    back = unit(eye - target)
    up = np.array([0, 1, 0]) if abs(back[1]) < 0.999 else np.array([1, 0, 0])
    right = unit(np.cross(up, back))
    matrix = np.eye(4)
    matrix[:3] = np.column_stack([right, np.cross(back, right), back, eye])
    return matrix


def unit(v):
    v = np.asarray(v, float)
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def png(texels):
    """Rows of RGB texels of 8 bits as a PNG file."""
    texels = np.asarray(texels, np.uint8)
    height, width, _ = texels.shape

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = b"".join(b"\0" + row.tobytes() for row in texels)
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def exr(path):
    """The channels of an EXR file of scan lines in ZIP, ZIPS or without compression."""
    data = path.read_bytes()
    at, channels, compression, window = 8, [], 0, None
    while data[at]:
        name, at = string(data, at)
        _, at = string(data, at)
        size = struct.unpack_from("<i", data, at)[0]
        at += 4
        if name == "channels":
            place = at
            while data[place]:
                channel, place = string(data, place)
                channels.append((channel, struct.unpack_from("<i", data, place)[0]))
                place += 16
        elif name == "compression":
            compression = data[at]
        elif name == "dataWindow":
            window = struct.unpack_from("<4i", data, at)
        at += size
    at += 1
    lines = {0: 1, 2: 1, 3: 16}[compression]
    width, height = window[2] - window[0] + 1, window[3] - window[1] + 1
    types = [np.dtype(["<u4", "<f2", "<f4"][kind]) for _, kind in channels]
    picture = {name: np.empty((height, width)) for name, _ in channels}
    for offset in struct.unpack_from(f"<{-(-height // lines)}Q", data, at):
        first, size = struct.unpack_from("<2i", data, offset)
        block = data[offset + 8 : offset + 8 + size]
        rows = range(first - window[1], min(first - window[1] + lines, height))
        if compression and size < len(rows) * width * sum(kind.itemsize for kind in types):
            block = unpacked(block)
        place = 0
        for row in rows:
            for (name, _), kind in zip(channels, types):
                picture[name][row] = np.frombuffer(block, kind, width, place)
                place += width * kind.itemsize
    return picture


def string(data, at):
    end = data.index(0, at)
    return data[at:end].decode(), end + 1


def unpacked(block):
    """Undoes ZIP of EXR: bytes are differences, and those at even places come first."""
    found = np.frombuffer(zlib.decompress(block), np.uint8).astype(np.int64)
    found[1:] -= 128
    found = (np.cumsum(found) & 255).astype(np.uint8)
    half = (len(found) + 1) // 2
    result = np.empty_like(found)
    result[::2], result[1::2] = found[:half], found[half:]
    return result.tobytes()
