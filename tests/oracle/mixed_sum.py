#!/usr/bin/env python3
"""A sum of four kernels over four primitives by quadrature of the defining integrals, 33 digits.

    tests/oracle/mixed_sum.py POINTS > OUTPUT

evaluates the sum below at every point of the file POINTS, whose lines begin with x,y,z (further
cells, lines that begin with # and the header line are skipped), and prints a table in CSV:

    x,y,z,value,gx,gy,gz,slope,curvature

value and gradient (gx, gy, gz) to 25 digits; slope and curvature are the sums, over the parts, of
|gradient| l and |Hessian| l with l the largest distance or size of the part at the point: what
moving its inputs by one part in one makes of value and gradient to first order.

The committed table is its own input, so it is written anew by

    tests/oracle/mixed_sum.py tests/oracle/mixed_sum.csv > new.csv && mv new.csv \\
        tests/oracle/mixed_sum.csv

in a minute. The points were drawn once with `tests/oracle/mixed_sum.py --draw 1000`.

No closed form is used, and nothing of the library. The orders below reach 1e-30 around the parts,
which every run confirms at its first point against rules of higher order (to 1e-27).
"""
import random
import sys
from math import hypot, sqrt

from mpmath import cos, exp, legendre, mp, mpf, findroot, nstr, pi, sin
from mpmath import sqrt as wide_sqrt

mp.dps = 33

# The parts. Decimal numbers are the doubles nearest to them.
ARC = dict(amplitude=1.5, s=2.5,
           center=(0.25, -0.125, 0.5), radius=0.875, normal=(1.0, 2.0, 2.0),
           x_axis=(1.0, 0.0, 0.0), start=20.0, width=130.0)
SEGMENT = dict(log_amplitude=0.75, a=1.75, p=(-0.5, 0.25, -0.75), q=(0.625, 1.0, 0.375))
POINT = dict(amplitude=2.0, R=1.25, position=(0.125, 0.25, -0.375))
TRIANGLE = dict(amplitude=0.75, s=0.75,
                vertices=((-1.0, -0.75, 0.25), (0.5, -1.0, -0.25), (0.0, 0.375, 0.125)))


def vector(numbers):
    return [mpf(x) for x in numbers]


def plus(a, k, b):
    """a + k b"""
    return [x + k * y for x, y in zip(a, b)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    return plus([mpf(0)] * 3, 1 / wide_sqrt(dot(a, a)), a)


def rule(order, panels):
    """Gauss-Legendre on [0, 1], composite."""
    nodes = []
    for k in range(order):
        slope = lambda x: order * (legendre(order - 1, x) - x * legendre(order, x)) / (1 - x * x)
        guess = cos(pi * (k + mpf(3) / 4) / (order + mpf(1) / 2))
        x = findroot(lambda t: legendre(order, t), guess, solver="newton", df=slope)
        nodes.append(((1 + x) / 2, 1 / ((1 - x * x) * slope(x) ** 2)))
    return [((i + x) / panels, w / panels) for i in range(panels) for x, w in nodes]


def cauchy(part):
    amplitude, s2 = mpf(part["amplitude"]), mpf(part["s"]) ** 2

    def h(u):
        v = 1 / (1 + s2 * u)
        third = -2 * amplitude * s2 * v * v * v
        return amplitude * v * v, third, float(-3 * s2 * v * third)

    return h


def gaussian(part):
    log_amplitude, a2 = mpf(part["log_amplitude"]), mpf(part["a"]) ** 2

    def h(u):
        value = exp(log_amplitude - a2 * u)
        return value, -a2 * value, float(a2 * a2 * value)

    return h


def quartic(part):
    amplitude, r2 = mpf(part["amplitude"]), mpf(part["R"]) ** 2

    def h(u):
        v = 1 - u / r2
        if v <= 0:
            return mpf(0), mpf(0), 0.0
        return amplitude * v * v, -2 * amplitude * v / r2, float(2 * amplitude / (r2 * r2))

    return h


def arc_nodes(part, order, panels):
    n = unit(vector(part["normal"]))
    x0 = vector(part["x_axis"])
    x = unit(plus(x0, -dot(x0, n), n))
    y = cross(n, x)
    start, width = mpf(part["start"]) * pi / 180, mpf(part["width"]) * pi / 180
    c = mpf(part["radius"])
    for t, w in rule(order, panels):
        angle = start + width * t
        q = plus(plus(vector(part["center"]), c * cos(angle), x), c * sin(angle), y)
        yield q, w * c * width


def segment_nodes(part, order, panels):
    p, q = vector(part["p"]), vector(part["q"])
    axis = plus(q, -1, p)
    length = wide_sqrt(dot(axis, axis))
    for t, w in rule(order, panels):
        yield plus(p, t, axis), w * length


def triangle_nodes(part, order, panels):
    """The square (t, r) folded on the first vertex: weight t."""
    v0, v1, v2 = (vector(v) for v in part["vertices"])
    e1, e2 = plus(v1, -1, v0), plus(v2, -1, v0)
    normal = cross(e1, e2)
    doubled_area = wide_sqrt(dot(normal, normal))
    across = plus(e2, -1, e1)
    line = rule(order, panels)
    for t, wt in line:
        for r, wr in line:
            yield plus(plus(v0, t, e1), t * r, across), wt * wr * t * doubled_area


def parts(finer):
    """(kernel, nodes with weights, points whose distances count, own size) of each part."""
    more = 8 if finer else 0
    return [
        (cauchy(ARC), list(arc_nodes(ARC, 28 + more, 5)), [ARC["center"]], ARC["radius"]),
        (gaussian(SEGMENT), list(segment_nodes(SEGMENT, 28 + more, 2)),
         [SEGMENT["p"], SEGMENT["q"]], 1.8),
        (quartic(POINT), [(vector(POINT["position"]), mpf(1))], [POINT["position"]], 0.0),
        (cauchy(TRIANGLE), list(triangle_nodes(TRIANGLE, 30 + more // 2, 1)),
         TRIANGLE["vertices"], 1.7),
    ]


def evaluate(every_part, p):
    value, gradient, slope, curvature = mpf(0), [mpf(0)] * 3, 0.0, 0.0
    wide = vector(p)
    for h, nodes, corners, size in every_part:
        f, g = mpf(0), [mpf(0)] * 3
        trace, hessian = 0.0, [0.0] * 6
        for q, w in nodes:
            x, y, z = wide[0] - q[0], wide[1] - q[1], wide[2] - q[2]
            h0, h1, h2 = h(x * x + y * y + z * z)
            f += w * h0
            k = w * h1
            g[0] += k * x
            g[1] += k * y
            g[2] += k * z
            trace += float(k)
            x, y, z, k = float(x), float(y), float(z), 4 * float(w) * h2
            for i, product in enumerate((x * x, y * y, z * z, x * y, y * z, z * x)):
                hessian[i] += k * product
        scale = max([size] + [hypot(*(a - b for a, b in zip(p, c))) for c in corners])
        diagonal = [2 * trace + d for d in hessian[:3]]
        value += f
        gradient = plus(gradient, 2, g)
        slope += 2 * sqrt(float(dot(g, g))) * scale
        mixed = sum(d * d for d in hessian[3:])
        curvature += scale * sqrt(sum(d * d for d in diagonal) + 2 * mixed)
    return value, gradient, slope, curvature


def draw(count):
    """Points around the parts, a third of them close to one."""
    chance = random.Random(20)
    close = [q for _, nodes, _, _ in parts(False) for q, _ in nodes[::7]]
    for i in range(count):
        base = [float(x) for x in chance.choice(close)] if i % 3 == 0 else [0.0, 0.0, 0.0]
        reach = 10 ** chance.uniform(-6, -0.5) if i % 3 == 0 else 10 ** chance.uniform(-0.5, 0.7)
        print(",".join(f"{x + chance.uniform(-reach, reach):.17g}" for x in base))


def main(arguments):
    if arguments[0] == "--draw":
        draw(int(arguments[1]))
        return
    with open(arguments[0], encoding="ascii") as lines:
        points = [[float(x) for x in line.split(",")[:3]] for line in lines
                  if line.strip() and line[0] not in "#x"]
    every_part = parts(False)
    value, gradient, _, _ = evaluate(every_part, points[0])
    finer_value, finer_gradient, _, _ = evaluate(parts(True), points[0])
    assert abs(value - finer_value) < mpf("1e-27"), nstr(value - finer_value, 3)
    difference = plus(gradient, -1, finer_gradient)
    assert dot(difference, difference) < mpf("1e-52"), nstr(dot(difference, difference), 3)
    print("x,y,z,value,gx,gy,gz,slope,curvature")
    for p in points:
        value, gradient, slope, curvature = evaluate(every_part, p)
        print(",".join([f"{x:.17g}" for x in p] + [nstr(x, 25) for x in (value, *gradient)] +
                       [f"{slope:.6g}", f"{curvature:.6g}"]))


if __name__ == "__main__":
    main(sys.argv[1:])
