"""Reads the part of the scene language that independent_field.py knows; shares no code with the
project."""

import math
import pathlib
import re

import numpy as np

from independent_field import Arc, Field, Primitive, Segment, Triangle, Unreadable

KEYWORDS = ["body", "diffuse", "ambient", "specular", "shine", "radius", "blobbiness",
            "strength", "texture", "kernel", "width", "reflective", "transparent", "index",
            "dispersion", "skip"]
DEFAULT_KERNEL = {"dot": "quartic", "gauss": "gaussian", "line": "gaussian"}
WITHOUT_EFFECT = {"eyep", "vrp", "vup", "fov", "framesize", "filename", "format", "light", "echo",
                  "background", "sample", "reset", "shoot", "return"}
OWN_RADIUS = {"sphere": 0, "cylinder": 0, "pipe": 0, "arc": 1, "arch": 0, "torus": 1}


def commands(path):
    """Lists of words; a file that is read stands where its `read` does."""
    text = re.sub(r"#[^\n]*", "", path.read_text())
    text = re.sub(r"\{([^}]*)\}", lambda braces: " " + braces.group(1).replace("\n", " "), text)
    for line in text.splitlines():
        words = re.sub(r"[,<>]", " ", line).replace("=", " = ").split()
        if not words:
            continue
        words[0] = words[0].lstrip("@")
        if words[0] == "read":
            for name in words[1:]:
                yield from commands(path.parent / name)
        elif words[0] == "return":
            return
        else:
            yield words


def number(word):
    try:
        return float(word)
    except ValueError:
        return None


def unit(v):
    return v / np.linalg.norm(v)


def rotation(axis, degrees):
    """Of column vectors, right-handed."""
    x, y, z = unit(np.array(axis))
    turn = math.radians(degrees)
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(turn) * skew + (1 - math.cos(turn)) * skew @ skew


class Reader:
    def __init__(self):
        self.surfaces, self.variables, self.fragile = {}, {}, set()
        self.waiting = []  # makers of primitives: `fragile` counts for the whole scene
        self.moves = []  # (from, to, turn, shift)
        self.open, self.objects, self.last = [], {}, (0, 0)

    def read(self, path):
        for words in commands(pathlib.Path(path)):
            self.command(words[0], words[1:])
        primitives = [make() for make in self.waiting]
        for first, last, turn, shift in self.moves:
            for primitive in primitives[first:last]:
                primitive.move(turn, shift)
        return Field(primitives)

    def command(self, name, words):
        if name == "surface":
            self.surface(words)
        elif name == "var":
            self.variables[words[0]] = words[2:]
        elif name == "fragile":
            self.fragile = set(OWN_RADIUS) if "all" in words else set(words) - {"none"}
        elif name == "object":
            self.open.append((words[0], len(self.waiting)))
        elif name == "close":
            object_name, first = self.open.pop()
            self.last = self.objects[object_name] = (first, len(self.waiting))
        elif name in ("rotate", "translate"):
            self.move(name, words)
        elif name in OWN_RADIUS or name in DEFAULT_KERNEL or name == "triangle":
            self.primitive(name, words)
        elif name not in WITHOUT_EFFECT and not (name == "soft" and words == ["on"]):
            raise Unreadable(f"command {name}")

    def surface(self, words):
        found, at = {"strength": 1.0, "blobbiness": None, "radius": None, "kernel": None}, 1
        while at < len(words):
            keys = [key for key in KEYWORDS if key.startswith(words[at])]
            key = words[at] if words[at] in KEYWORDS else (keys[0] if len(keys) == 1 else None)
            if key in ("texture", "width"):
                raise Unreadable(f"surface with {key}")
            if key in ("strength", "blobbiness", "radius"):
                found[key] = number(words[at + 1])
            elif key == "kernel":
                found[key] = words[at + 1].replace("invsquared", "squared").rstrip("s")
            at += 1
        self.surfaces[words[0]] = found

    def move(self, name, words):
        count = 4 if name == "rotate" else 3
        values = [float(word) for word in words[:count]]
        first, last = self.objects[words[count]] if len(words) > count else self.last
        if name == "rotate":
            self.moves.append((first, last, rotation(values[:3], values[3]), np.zeros(3)))
        else:
            self.moves.append((first, last, np.eye(3), np.array(values)))

    def numbers(self, words):
        found = []
        for word in words:
            words_of = self.variables.get(word, [word]) if number(word) is None else [word]
            found += [float(w) for w in words_of if w != "hot"]
        return np.array(found)

    def primitive(self, name, words):
        surface = self.surfaces[words[0]]
        if "taper" in words:
            raise Unreadable("taper")
        values = self.numbers(words[1:])
        if surface["blobbiness"] is None:
            raise Unreadable("a surface without blobbiness")

        def make():
            radius = surface["radius"]
            at = OWN_RADIUS.get(name)
            if at is not None and not (name in self.fragile and radius):
                radius = values[at]
            kernel = surface["kernel"] or DEFAULT_KERNEL.get(name, "cauchy")
            material = (kernel, radius, surface["blobbiness"], surface["strength"])
            return primitive_of(name, values, material)

        self.last = (len(self.waiting), len(self.waiting) + 1)
        self.waiting.append(make)


def primitive_of(name, values, material):
    if name in ("sphere", "dot", "gauss"):
        return Primitive(*material, values[-3:], [1.0, 0.0, 0.0])
    if name in ("line", "cylinder", "pipe"):
        return Segment(values[-6:-3], values[-3:], *material)
    if name == "triangle":
        return Triangle(values.reshape(3, 3), *material)
    if name == "arch":
        return arch_of(*values[1:].reshape(3, 3), material)
    start, width = (values[8], values[9]) if name == "arc" else (0.0, 360.0)
    normal = unit(values[5:8])
    across = np.array([0.0, 1, 0]) if abs(normal[0]) > 0.999 else np.array([1.0, 0, 0])
    across = unit(across - normal * (across @ normal))
    turn = math.radians(start)
    begin = math.cos(turn) * across + math.sin(turn) * np.cross(normal, across)
    return Arc(values[2:5], values[0], normal, begin, math.radians(width), *material)


def arch_of(first, second, third, material):
    a, b = second - first, third - first
    normal = np.cross(a, b)
    if np.linalg.norm(normal) <= 1e-9 * np.linalg.norm(a) * np.linalg.norm(b):
        return Segment(first, third, *material)
    center = first + np.cross((a @ a) * b - (b @ b) * a, normal) / (2 * normal @ normal)
    normal = unit(normal)
    begin = unit(first - center)
    end = third - center
    angle = math.atan2(end @ np.cross(normal, begin), end @ begin) % (2 * math.pi)
    return Arc(center, np.linalg.norm(first - center), normal, begin, angle, *material)


def read_scene(path):
    return Reader().read(path)
