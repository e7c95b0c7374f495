#!/usr/bin/env python3
"""Random scenes by seed: every kernel over every primitive, stiff and soft, large and small, with
coincidences, touching, carving, profiles, tapers, transforms, groups and hard solids.

    tests/contract/random_scenes.py SEED     prints the scene
"""

import math
import random
import sys

KERNELS = ["cauchy", "gaussian", "inverse", "squared", "metaball", "soft", "quartic"]
TAPERED = {"cauchy", "gaussian"}
UNBOUNDED = {"inverse", "squared"}  # over planes, whose field is infinite


class RandomScene:
    """`head` defines surfaces; each of `primitives` is one primitive with all that acts on it."""

    def __init__(self, tolerance, head, primitives):
        self.tolerance = tolerance
        self.head = head
        self.primitives = primitives

    def items(self):
        return self.head + self.primitives


class Draw:
    """One scene's dice. Lengths are in units of `size`, the scale of the whole scene."""

    def __init__(self, seed):
        self.dice = random.Random(seed)
        self.size = self.log_uniform(1e-3, 1e3)
        self.places = []  # where primitives lie already, each with a radius
        self.kernels = {}  # of the soft surfaces
        self.reach = 1.0

    def chance(self, share):
        return self.dice.random() < share

    def log_uniform(self, low, high):
        return low * (high / low) ** self.dice.random()

    def direction(self):
        while True:
            v = [self.dice.uniform(-1, 1) for _ in range(3)]
            if 0.1 < math.hypot(*v) < 1.0:
                return [x / math.hypot(*v) for x in v]

    def near(self, point, distance):
        return [x + distance * d for x, d in zip(point, self.direction())]

    def text(self, length):
        return f"{self.size * length:.10g}"

    def vector(self, point):
        return "<" + " ".join(self.text(x) for x in point) + ">"

    def place(self, radius):
        """Anywhere; or where something is already, or touching it."""
        if self.places and self.chance(0.35):
            point, other = self.dice.choice(self.places)
            if self.chance(0.5):
                return list(point)
            return self.near(point, radius + other)
        return self.near([0.0, 0.0, 0.0], self.reach * self.dice.random() ** (1 / 3))


def surfaces(draw):
    lines = ["texture wave strength sin one bounds <0.5 0 0> <1 0 0> scale 6 1 1 times 1.2 1 1"]
    for number in range(draw.dice.randint(1, 4)):
        name, kernel = f"s{number}", draw.dice.choice(KERNELS)
        draw.kernels[name] = kernel
        blobbiness = draw.log_uniform(0.3, 20) if draw.chance(0.85) else draw.log_uniform(20, 300)
        words = [f"radius {draw.text(draw.log_uniform(0.1, 0.5))}"]
        words += [f"blobbiness {-blobbiness:.6g}", f"kernel {kernel}"]
        if draw.chance(0.25) and number > 0:
            words.append(f"strength {-draw.log_uniform(0.2, 3):.6g}")
        elif draw.chance(0.2):
            words.append(f"strength {draw.log_uniform(0.5, 3):.6g}")
        if draw.chance(0.08):
            words.append("texture wave")
        lines.append(f"surface {name} {{ {' '.join(words)} }}")
    lines.append("surface hard { diffuse Gold }")
    return lines


def segment(draw, name, kind, radius):
    first = draw.place(radius)
    second = draw.near(first, draw.log_uniform(0.05, 1.5))
    draw.places += [(first, radius), (second, radius)]
    words = f"{name} {draw.text(radius)}" if kind != "line" else name
    taper = ""
    if draw.kernels.get(name) in TAPERED and draw.chance(0.15):
        taper = f" taper {draw.log_uniform(0.3, 2):.4g} {draw.log_uniform(0.3, 2):.4g}"
    return f"{kind} {words} {draw.vector(first)} {draw.vector(second)}{taper}"


def arc(draw, name, radius):
    middle, sweep = draw.place(radius), draw.log_uniform(0.2, 1.0)
    draw.places.append((middle, sweep + radius))
    start, width = draw.dice.uniform(-360, 360), draw.dice.choice([360, draw.dice.uniform(20, 350)])
    normal = " ".join(f"{x:.8g}" for x in draw.direction())
    return (
        f"arc {name} {draw.text(sweep)} {draw.text(radius)} {draw.vector(middle)} "
        f"<{normal}> {start:.6g} {width:.6g}"
    )


def torus(draw, name, radius):
    middle = draw.place(radius)
    draw.places.append((middle, radius))
    normal = " ".join(f"{x:.8g}" for x in draw.direction())
    sweep = draw.text(radius * draw.log_uniform(1.2, 4))
    return f"torus {name} {sweep} {draw.text(radius)} {draw.vector(middle)} <{normal}>"


def corners(draw, radius):
    first = draw.place(radius)
    return [first] + [draw.near(first, draw.log_uniform(0.2, 1.0)) for _ in range(2)]


def primitive(draw, name):
    """One command. Of a hard surface: sphere, cylinder or torus."""
    radius = draw.log_uniform(0.08, 0.5)
    kinds = ["sphere", "cylinder", "torus"]
    if name != "hard":
        kinds += ["sphere", "dot", "gauss", "line", "line", "cylinder", "pipe"]
        kinds += ["arc", "arc", "arch", "triangle", "triangle"]
    kind = draw.dice.choice(kinds)
    if kind in ("sphere", "dot", "gauss"):
        at = draw.place(radius)
        draw.places.append((at, radius))
        own = f" {draw.text(radius)}" if kind == "sphere" else ""
        return f"{kind} {name}{own} {draw.vector(at)}"
    if kind in ("line", "cylinder", "pipe"):
        return segment(draw, name, kind, radius)
    if kind == "arc":
        return arc(draw, name, radius)
    if kind == "torus":
        return torus(draw, name, radius)
    points = corners(draw, radius)
    draw.places += [(point, radius) for point in points]
    own = f" {draw.text(radius)}" if kind == "arch" else ""
    return f"{kind} {name}{own} " + " ".join(draw.vector(point) for point in points)


def transforms(draw):
    lines = []
    if draw.chance(0.5):
        axis = " ".join(f"{x:.6g}" for x in draw.direction())
        lines.append(f"rotate {axis} {draw.dice.uniform(-180, 180):.6g}")
    if draw.chance(0.6):
        factors = [draw.log_uniform(0.5, 2) * draw.dice.choice([1, 1, 1, -1]) for _ in range(3)]
        lines.append("scale " + " ".join(f"{x:.6g}" for x in factors))
    if draw.chance(0.5):
        shift = draw.near([0, 0, 0], 0.3)
        lines.append("translate " + " ".join(draw.text(x) for x in shift))
    return lines


def random_scene(seed):
    draw = Draw(seed)
    head = surfaces(draw)
    count = draw.dice.choice([1, 2, 2, 3, 4, 6, 8, 12, 20, 30])
    draw.reach = 0.6 * count ** (1 / 3)
    primitives = []
    for number in range(count):
        # The first is soft and adds, so that most scenes have a surface.
        name = "s0" if number == 0 else draw.dice.choice([*draw.kernels, "s0"])
        if number > 0 and draw.chance(0.04):
            name = "hard"
        lines = [primitive(draw, name)]
        if draw.chance(0.2):
            lines += transforms(draw)
        if number > 0 and draw.chance(0.05):
            lines = [f"object group{number}", "blend", *lines, "close"]
        primitives.append("\n".join(lines))
        if draw.chance(0.06):
            primitives.append(primitives[-1].replace(f"group{number}", f"again{number}"))
    if draw.chance(0.06):
        usable = [name for name, kernel in draw.kernels.items() if kernel not in UNBOUNDED]
        name = draw.dice.choice(usable or list(draw.kernels))
        low, high = draw.vector([-draw.reach] * 3), draw.vector([draw.reach] * 3)
        normal = " ".join(f"{x:.6g}" for x in draw.direction())
        primitives.append(f"plane {name} {draw.vector([0, 0, -0.5])} <{normal}>")
        if draw.chance(0.8):
            head.append(f"mesh bounds {low} {high}")
    return RandomScene(draw.dice.choice(["1%", "0.5%"]), head, primitives)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    scene = random_scene(int(sys.argv[1]))
    print(f"# seed {sys.argv[1]}, tolerance {scene.tolerance}")
    print("\n".join(scene.items()))


if __name__ == "__main__":
    main()
