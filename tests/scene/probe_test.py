"""`probe` against high-precision values of single integrals, stated as scenes.

The rows are those of field_public.csv, in the folder $CS2MESH_SHARED/reference or
../shared/reference beside the sources. A value passes if it is exact for inputs moved by 64 units
in the last place.
"""

import csv
import math
import os
import pathlib

from harness import SOURCE, SceneTest, main

SHARED = pathlib.Path(os.environ.get("CS2MESH_SHARED", SOURCE.parent / "shared"))
ROWS = SHARED / "reference" / "field_public.csv"
EPSILON = 2.2e-16
KERNELS = {"invsquared": "squared", "metaballs": "metaball"}


def dot(a, b):
    return math.fsum(x * y for x, y in zip(a, b))


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def norm(a):
    return math.sqrt(dot(a, a))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def angle_of_reference(normal, x_axis):
    """Degrees from the language's reference axis of `normal` to `x_axis`."""
    n = [c / norm(normal) for c in normal]
    world = [0.0, 1.0, 0.0] if abs(n[0]) > 0.999 else [1.0, 0.0, 0.0]
    u = minus(world, [dot(world, n) * c for c in n])
    v = cross(n, u)
    x = minus(x_axis, [dot(x_axis, n) * c for c in n])
    return math.degrees(math.atan2(dot(x, v), dot(x, u)))


def triple(numbers):
    return "<" + " ".join(numbers) + ">"


def command(row):
    """The scene command for the primitive of a row; numbers as they stand in the file."""
    g = [row[f"g{i}"] for i in range(12)]
    kind = row["primitive"]
    if kind == "point":
        return f"gauss m {triple(g[0:3])}"
    if kind == "line":
        return f"line m {triple(g[0:3])} {triple(g[3:6])}"
    if kind == "triangle":
        return f"triangle m {triple(g[0:3])} {triple(g[3:6])} {triple(g[6:9])}"
    if kind == "plane":
        return f"plane m {triple(g[0:3])} {triple(g[3:6])}"
    normal = [float(x) for x in g[4:7]]
    turned = angle_of_reference(normal, [float(x) for x in g[7:10]])
    start = float(g[10]) + turned
    return f"arc m {g[3]} 1 {triple(g[0:3])} {triple(g[4:7])} {start!r} {g[11]}"


def conditioning(row):
    """Longest edge over smallest height of a triangle."""
    if row["primitive"] != "triangle":
        return 1.0
    v = [[float(row[f"g{3 * i + k}"]) for k in range(3)] for i in range(3)]
    longest = max(norm(minus(v[(i + 1) % 3], v[i])) for i in range(3))
    return longest * longest / norm(cross(minus(v[1], v[0]), minus(v[2], v[0])))


class Taper(SceneTest):
    """The scene of tapered bones against tests/oracle/taper.py, which integrates in 30 digits."""

    def test_values_and_gradients(self):
        with open(SOURCE / "tests" / "oracle" / "taper.csv", newline="", encoding="utf-8") as file:
            rows = [[float(x) for x in row] for row in list(csv.reader(file))[1:]]
        self.assertEqual(len(rows), 40)
        points = "\n".join(" ".join(repr(x) for x in row[:3]) for row in rows) + "\n"
        done = self.succeed("probe", SOURCE / "data" / "scenes" / "taper.art", "-", stdin=points)
        for row, line in zip(rows, done.stdout.splitlines(), strict=True):
            value, *gradient = (float(x) for x in line.split())
            slope = norm(row[4:])
            with self.subTest(point=row[:3]):
                # What is left out of a field is at most 1e-9.
                self.assertLessEqual(abs(value - row[3]), 2e-13 * (row[3] + slope) + 1e-9)
                self.assertLessEqual(norm(minus(gradient, row[4:])), 1e-12 * slope + 1e-8)


class Probe(SceneTest):
    def test_rows_of_the_reference(self):
        with open(ROWS, newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertGreater(len(rows), 500)
        worst = {}
        for row in rows:
            kernel = KERNELS.get(row["kernel"], row["kernel"])
            width = row["param"] or "1"
            scene = f"surface m {{ kernel {kernel} width {width} }}\n{command(row)}\n"
            point = " ".join(row[c] for c in ("px", "py", "pz"))
            done = self.succeed("probe", self.file("row.art", scene), "-", stdin=point + "\n")
            value, *gradient = (float(x) for x in done.stdout.split())
            exact = float(row["value"])
            if kernel in ("inverse", "squared") and gradient == [0.0, 0.0, 0.0]:
                # Nearer than 1e-6 of its size the language clamps a singular kernel.
                self.assertIn(row["tag"], ("near-primitive", "near-edge", "huge"), row["id"])
                self.assertTrue(0 < value < math.inf)
                continue
            slope = [float(row[c]) for c in ("gx", "gy", "gz")]
            kappa, scale = conditioning(row), float(row["lscale"])
            of_value = EPSILON * (kappa * abs(exact) + norm(slope) * scale)
            of_gradient = EPSILON * (kappa * norm(slope) + float(row["hess_norm"]) * scale)
            units = (
                abs(value - exact) / max(of_value, 1e-300),
                norm(minus(gradient, slope)) / max(of_gradient, 1e-300),
            )
            cell = f"{kernel} {row['primitive']}"
            worst[cell] = max(worst.get(cell, (0, "")), (max(units), row["id"]))
            allowed = 256 if kernel == "metaball" else 64
            with self.subTest(row=row["id"], cell=cell, tag=row["tag"]):
                self.assertLessEqual(units[0], 64)
                self.assertLessEqual(units[1], allowed)
        for cell, (units, row) in sorted(worst.items()):
            print(f"{cell}: at most {units:.2f} units, row {row}")


if __name__ == "__main__":
    main()
