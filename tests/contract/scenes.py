#!/usr/bin/env python3
"""The scenes of the contract: writes those that a rule makes into a folder, one .art file each.

    tests/contract/scenes.py FOLDER [NAME...]

The same bytes on every machine: no clock, no random number but those of a fixed seed.
"""

import math
import pathlib
import random
import sys

import bust

SCENES = pathlib.Path(__file__).resolve().parents[2] / "data" / "scenes"

TOUCHING_BLOBBINESS = 4.0
TUBE_BLOBBINESS = 16.0
TUBE_GAP = 1e-4


def vector(point):
    return "<" + " ".join(f"{x:.12g}" for x in point) + ">"


def along(point, direction, length):
    return tuple(x + length * d for x, d in zip(point, direction))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    length = math.sqrt(sum(x * x for x in a))
    return tuple(x / length for x in a)


def perpendicular_frame(axis):
    """Two directions that make a right-handed frame with the axis."""
    other = (1.0, 0.0, 0.0) if abs(axis[0]) < 0.9 else (0.0, 1.0, 0.0)
    first = unit(cross(other, axis))
    return first, cross(axis, first)


def tilted(axis, angle, turn):
    """The direction at an angle from the axis, turned about it."""
    first, second = perpendicular_frame(axis)
    across = [math.cos(turn) * x + math.sin(turn) * y for x, y in zip(first, second)]
    return tuple(math.cos(angle) * a + math.sin(angle) * b for a, b in zip(axis, across))


def sphere():
    return "surface s { radius 1 blobbiness -2 }\nsphere s 1 <0 0 0>\n"


def torus():
    return "surface s { radius 0.3 blobbiness -4 }\ntorus s 1 0.3 <0 0 0> <0 0 1>\n"


def sphereflake(levels):
    """Balls with nine balls of a third of the size upon each: 6 around the equator, 3 above it."""
    lines = ["surface s { kernel gaussian blobbiness -6 }"]

    def grow(center, axis, radius, level):
        lines.append(f"sphere s {radius:.12g} {vector(center)}")
        if level == levels:
            return
        upper = math.asin(math.sqrt(1.0 / 3.0))
        places = [(0.5 * math.pi, k * math.pi / 3.0) for k in range(6)]
        places += [(upper, (2 * k + 0.5) * math.pi / 3.0) for k in range(3)]
        for angle, turn in places:
            direction = tilted(axis, angle, turn)
            grow(along(center, direction, 4.0 / 3.0 * radius), direction, radius / 3.0, level + 1)

    grow((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0.5, 0)
    return "\n".join(lines) + "\n"


def swirl(count):
    """A horn of points that widens upwards, denser than their radii: one thick wall of balls."""
    draw = random.Random(70000)
    lines = ["surface s { kernel gaussian blobbiness -2.5 }"]
    for _ in range(count):
        height = 4.0 * draw.random()
        turn = 2.0 * math.pi * draw.random()
        middle = 0.28 + 0.066 * height * height
        distance = middle + (0.12 + 0.1 * height) * (draw.random() - draw.random())
        place = (distance * math.cos(turn), distance * math.sin(turn), height)
        lines.append(f"sphere s {0.012 + 0.02 * draw.random():.6g} {vector(place)}")
    return "\n".join(lines) + "\n"


def coral(count):
    """A tree of that many segments, each ending in two or three thinner, shorter ones."""
    draw = random.Random(543)
    lines = ["surface s { kernel cauchy blobbiness -12 }"]
    queue = [((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 1.0, 0.13)]
    for number in range(count):
        start, axis, length, radius = queue.pop(0)
        end = along(start, axis, length)
        lines.append(f"cylinder s {radius:.12g} {vector(start)} {vector(end)}")
        children = 3 if number % 3 == 0 else 2
        turn = 2.0 * math.pi * draw.random()
        for child in range(children):
            angle = 0.4 + 0.3 * draw.random()
            direction = tilted(axis, angle, turn + 2.0 * math.pi * child / children)
            queue.append((end, direction, (0.74 + 0.1 * draw.random()) * length, 0.85 * radius))
    return "\n".join(lines) + "\n"


def starfish():
    """Seven arms, each an arch from the middle, down to the ground, of one radius."""
    lines = ["surface s { kernel cauchy radius 0.3 blobbiness -4 }"]
    for arm in range(7):
        turn = 2.0 * math.pi * arm / 7
        places = [(0.1, 0.25, 0.0), (1.1, 0.3, 0.12), (2.0, -0.1, 0.0)]
        points = []
        for distance, height, side in places:
            x, y = math.cos(turn), math.sin(turn)
            points.append((distance * x - side * y, distance * y + side * x, height))
        lines.append("arch s 0.3 " + " ".join(vector(point) for point in points))
    return "\n".join(lines) + "\n"


def bust_scene():
    """A shell of triangles: its surface has an outer side and a hollow inside."""
    lines = ["surface s { kernel cauchy radius 0.03 blobbiness -8 }"]
    lines += ["triangle s " + " ".join(vector(p) for p in corners) for corners in bust.triangles()]
    return "\n".join(lines) + "\n"


def touching():
    """Two balls whose common field is 1 in the middle between them: a point where they touch."""
    b = TOUCHING_BLOBBINESS
    half = math.sqrt((b + math.log(2.0)) / b)
    lines = [f"surface s {{ kernel gaussian radius 1 blobbiness {-b:g} }}"]
    lines += [f"sphere s 1 <{side * half:.17g} 0 0>" for side in (-1, 1)]
    return "\n".join(lines) + "\n"


def tube_distance():
    """Of the axes of two parallel Gaussian tubes of radius 0.3 whose surfaces are TUBE_GAP apart.

    Far from their ends the field of both is exp(b - a² d²) each; it falls with the distance.
    """
    b, radius = TUBE_BLOBBINESS, 0.3
    squared = b / radius**2

    def field(distance):
        near, far = 0.5 * (distance - TUBE_GAP), 0.5 * (distance + TUBE_GAP)
        return math.exp(b - squared * near * near) + math.exp(b - squared * far * far)

    low, high = 2.0 * radius, 3.0 * radius
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if field(middle) > 1.0 else (low, middle)
    return high


def tubes():
    half = 0.5 * tube_distance()
    lines = [f"surface s {{ kernel gaussian radius 0.3 blobbiness {-TUBE_BLOBBINESS:g} }}"]
    lines += [f"line s <-2 {side * half:.17g} 0> <2 {side * half:.17g} 0>" for side in (-1, 1)]
    return "\n".join(lines) + "\n"


def spike():
    return (
        "surface s { kernel gaussian radius 1 blobbiness -4 }\n"
        "surface thin { kernel gaussian radius 1e-4 blobbiness -4 }\n"
        "sphere s 1 <0 0 0>\n"
        "cylinder thin 1e-4 <0 0 0.5> <0 0 1.6>\n"
    )


def ring():
    """A stiff kernel of finite support: in the hole, 0.4 wide, the field and its gradient are 0."""
    return "surface s { kernel quartic blobbiness -170 }\ntorus s 1.2 1 <0 0 0> <0 0 1>\n"


def negative():
    """A ball, and a group in which nothing adds to the field: it has no surface."""
    return (
        "surface s { kernel gaussian blobbiness -2 }\n"
        "surface n { kernel gaussian blobbiness -2 strength -1 }\n"
        "sphere s 1 <0 0 0>\nobject group\nblend\nsphere n 1 <0.5 0 0>\nclose\n"
    )


def groove():
    """Two stiff balls: the fillet of the groove between them is far narrower than the tolerance."""
    return (
        "surface s { kernel gaussian radius 1 blobbiness -1000 }\n"
        "sphere s 1 <0 0 0>\nsphere s 1 <1.9 0 0>\n"
    )


def edge():
    """A stiff kernel of finite support: F has a kink at its edge, next to the surface."""
    return (
        "surface s { radius 0.9 blobbiness -70 kernel metaball }\n"
        "surface t { radius 0.62 blobbiness -1.2 kernel soft strength 1.1 }\n"
        "gauss s <-0.16 -1.45 0.77>\n"
        "line t <-0.16 -1.45 0.77> <0.39 -1.78 1.14>\n"
        "cylinder t 0.342 <-0.312 0.284 0.231> <-3.22 0.61 1.5>\n"
    )


def waves():
    """A singular kernel under a profile with kinks."""
    return (
        "texture wave strength sin one bounds <0.5 0 0> <1 0 0> scale 6 1 1 times 1.2 1 1\n"
        "surface s { kernel squared radius 1.6 blobbiness -2 texture wave }\n"
        "line s <-1.37 -0.55 0.97> <-1.25 -1.52 5.44>\n"
    )


class Scene:
    """`topologies`: what is right, as (outer components, voids, genus); empty if not known."""

    def __init__(self, topologies, make=None):
        self.topologies = topologies
        self.make = make  # none: a file of data/scenes


# Topologies: by construction; flake1, flake2, coral, starfish and icicle (whose dot hangs free) as
# `independent.py --topology` counts them on grids without the project's code; the seahorse (two
# rings; the eyes, which meet each other, but not the head) likewise from values of the field; the
# cowrie as meshes of three tolerances agree. Of the coral, grids of cells of 0.009 and more find
# one more, beside two necks: `--within -1.7044 -1.9944 1.8856 -1.4644 -1.7544 2.1256` tells
# 2 tunnels with --topology 26, and 1 with 34, 50, 66 and 97. In flake3, flake4 and magra70000 balls
# meet uncounted times.
CONTRACT = {
    "sphere": Scene([(1, 0, 0)], sphere),
    "torus": Scene([(1, 0, 1)], torus),
    "cowrie": Scene([(1, 0, 0)]),
    "seahorse": Scene([(2, 0, 2)]),
    "icicle": Scene([(2, 0, 0)]),
    "cone": Scene([(1, 0, 0)]),
    "polygon": Scene([(1, 0, 0)]),
    "quadric": Scene([(3, 0, 0)]),
    "offsets": Scene([(7, 0, 0)]),
    "flake1": Scene([(1, 0, 0)], lambda: sphereflake(1)),
    "flake2": Scene([(1, 0, 0)], lambda: sphereflake(2)),
    "flake3": Scene([], lambda: sphereflake(3)),
    "flake4": Scene([], lambda: sphereflake(4)),
    "magra70000": Scene([], lambda: swirl(70000)),
    "coral": Scene([(1, 0, 27)], lambda: coral(543)),
    "starfish": Scene([(1, 0, 0)], starfish),
    "bust": Scene([(1, 1, 0)], bust_scene),
    "touching": Scene([(1, 0, 0), (2, 0, 0)], touching),
    "tubes": Scene([(2, 0, 0)], tubes),
    "spike": Scene([(1, 0, 0)], spike),
    # What random seeds found, made smaller.
    "ring": Scene([(1, 0, 1)], ring),
    "negative": Scene([(1, 0, 0)], negative),
    "groove": Scene([(1, 0, 0)], groove),
    "edge": Scene([(2, 0, 0)], edge),
    "waves": Scene([(1, 0, 0)], waves),
}


def scene_file(name, folder):
    """The path of the scene, which is written into the folder if a rule makes it."""
    scene = CONTRACT[name]
    if scene.make is None:
        return SCENES / f"{name}.art"
    path = pathlib.Path(folder) / f"{name}.art"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"# {name}, written by tests/contract/scenes.py\n" + scene.make())
    return path


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    for name in sys.argv[2:] or CONTRACT:
        print(scene_file(name, sys.argv[1]))


if __name__ == "__main__":
    main()
