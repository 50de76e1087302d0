#!/usr/bin/env python3
"""Renders scenes/turntable.json frame by frame and makes docs/images/turntable.png, an animated PNG of 256 colours.

    python3 docs/turntable.py [path of etalon] [-- OPTIONS OF RENDER]

The frames are kept in target/turntable, and those that are finished are not rendered again. Needs nothing but Python.
"""
import pathlib
import struct
import subprocess
import sys
import zlib

root = pathlib.Path(__file__).resolve().parent.parent
FRAMES, FPS = 36, 12
OPTIONS = ["--size", "192x128", "--spp", "40"]
COLOURS = 256


def chunks(data):
    place = 8
    while place < len(data):
        (length,) = struct.unpack(">I", data[place : place + 4])
        yield data[place + 4 : place + 8], data[place + 8 : place + 8 + length]
        place += 12 + length


def pixels(path):
    """Width, height and the bytes of an 8-bit RGB picture."""
    found = list(chunks(path.read_bytes()))
    width, height, depth, colour = struct.unpack(">IIBB", found[0][1][:10])
    assert (depth, colour) == (8, 2), "8-bit RGB"
    data = zlib.decompress(b"".join(content for kind, content in found if kind == b"IDAT"))
    stride, above, rows = 3 * width, bytes(3 * width), []
    for y in range(height):
        kind, line = data[y * (stride + 1)], bytearray(data[y * (stride + 1) + 1 : (y + 1) * (stride + 1)])
        for i in range(stride):
            left = line[i - 3] if i >= 3 else 0
            up, corner = above[i], above[i - 3] if i >= 3 else 0
            if kind == 1:
                line[i] = (line[i] + left) & 255
            elif kind == 2:
                line[i] = (line[i] + up) & 255
            elif kind == 3:
                line[i] = (line[i] + (left + up) // 2) & 255
            elif kind == 4:
                guess = left + up - corner
                nearest = min((abs(guess - left), 0, left), (abs(guess - up), 1, up), (abs(guess - corner), 2, corner))
                line[i] = (line[i] + nearest[2]) & 255
        above = bytes(line)
        rows.append(above)
    return width, height, b"".join(rows)


def palette(counts):
    """Median cut: the box with the largest spread, weighed by its pixels, is halved until there are enough."""

    def widest(box):
        spans = [(max(c[k] for c in box) - min(c[k] for c in box), k) for k in range(3)]
        return max(spans)

    boxes = [list(counts)]
    while len(boxes) < COLOURS:
        order = sorted(range(len(boxes)), key=lambda i: widest(boxes[i])[0] * sum(counts[c] for c in boxes[i]) ** 0.5)
        box = boxes.pop(order[-1])
        span, axis = widest(box)
        if span == 0:
            boxes.append(box)
            break
        box.sort(key=lambda c: c[axis])
        half, total, cut = sum(counts[c] for c in box) / 2, 0, 1
        for i, c in enumerate(box[:-1]):
            total += counts[c]
            cut = i + 1
            if total >= half:
                break
        boxes += [box[:cut], box[cut:]]
    mean = lambda box: tuple(round(sum(c[k] * counts[c] for c in box) / sum(counts[c] for c in box)) for k in range(3))
    return [mean(box) for box in boxes], {c: i for i, box in enumerate(boxes) for c in box}


def animation(frames):
    """An animated PNG with one palette, which loops for ever."""
    width, height, _ = frames[0]
    counts = {}
    coarse = lambda p: tuple(v & 0xFC for v in p)
    triples = [[coarse(data[i : i + 3]) for i in range(0, len(data), 3)] for _, _, data in frames]
    for colours in triples:
        for colour in colours:
            counts[colour] = counts.get(colour, 0) + 1
    table, number = palette(counts)
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    out = [b"\x89PNG\r\n\x1a\n", chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0))]
    out += [chunk(b"acTL", struct.pack(">II", len(frames), 0)), chunk(b"PLTE", bytes(v for c in table for v in c))]
    sequence = 0
    for index, colours in enumerate(triples):
        out.append(chunk(b"fcTL", struct.pack(">IIIIIHHBB", sequence, width, height, 0, 0, 1, FPS, 0, 0)))
        sequence += 1
        lines = [bytes(number[c] for c in colours[y * width : (y + 1) * width]) for y in range(height)]
        packed = zlib.compress(b"".join(b"\0" + line for line in lines), 9)
        out.append(chunk(b"IDAT", packed) if index == 0 else chunk(b"fdAT", struct.pack(">I", sequence) + packed))
        sequence += index > 0
    return b"".join(out + [chunk(b"IEND", b"")])


def main():
    arguments = sys.argv[1:]
    extra = arguments[arguments.index("--") + 1 :] if "--" in arguments else []
    given = arguments[: arguments.index("--")] if "--" in arguments else arguments
    etalon = pathlib.Path(given[0]).resolve() if given else root / "target/release/etalon"
    folder = root / "target/turntable"
    folder.mkdir(parents=True, exist_ok=True)
    command = [etalon, "render", "scenes/turntable.json", "--frames", f"0:{FRAMES - 1}", "--fps", str(FPS), "--resume"]
    subprocess.run([*command, *OPTIONS, *extra, "-o", folder / "{frame:03}.png"], cwd=root, check=True)
    made = animation([pixels(folder / f"{number:03}.png") for number in range(FRAMES)])
    path = root / "docs/images/turntable.png"
    path.write_bytes(made)
    print(f"{path.relative_to(root)}: {FRAMES} frames, {len(made) / 1000:.0f} kB")


main()
