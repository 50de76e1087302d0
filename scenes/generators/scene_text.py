"""Writes scenes as JSON that people can read: what fits on a line stands on one, lists of numbers are wrapped."""

import json
import os

WIDTH = 118


def number(x):
    if isinstance(x, float) and x == int(x) and abs(x) < 1e15:
        return str(int(x))
    return json.dumps(x, ensure_ascii=False)


def on_one_line(value):
    if isinstance(value, dict):
        inner = ", ".join(f"{json.dumps(k)}: {on_one_line(v)}" for k, v in value.items())
        return f"{{ {inner} }}" if value else "{}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(on_one_line, value)) + "]"
    return number(value)


def text(value, indent=0, key=""):
    if not isinstance(value, (dict, list, tuple)):
        return number(value)
    line = on_one_line(value)
    if indent and key != "comment" and indent + len(key) + 5 + len(line) <= WIDTH:
        return line
    pad = " " * (indent + 2)
    end = " " * indent
    if isinstance(value, dict):
        items = [f"{pad}{json.dumps(k)}: {text(v, indent + 2, k)}" for k, v in value.items()]
        return "{\n" + ",\n".join(items) + f"\n{end}}}"
    if key == "comment" or any(isinstance(v, dict) for v in value):
        return "[\n" + ",\n".join(pad + text(v, indent + 2) for v in value) + f"\n{end}]"
    lines, current = [], ""
    for i, v in enumerate(value):
        item = on_one_line(v) + ("," if i + 1 < len(value) else "")
        if current and len(pad) + len(current) + 1 + len(item) > WIDTH:
            lines.append(current)
            current = item
        else:
            current = f"{current} {item}" if current else item
    lines.append(current)
    return "[\n" + "\n".join(pad + line for line in lines) + f"\n{end}]"


def write(name, scene):
    """Writes scenes/NAME.json beside this folder."""
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", name + ".json")
    with open(path, "w", encoding="utf-8") as out:
        out.write(text(scene) + "\n")
