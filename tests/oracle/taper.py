#!/usr/bin/env python3
"""The field of data/scenes/taper.art by quadrature of the defining integrals, 30 digits.

    tests/oracle/taper.py > tests/oracle/taper.csv

prints x,y,z,value,gx,gy,gz, to 20 digits, at points around the three bones. Weights, kernels and
strengths are computed from the numbers that the scene's text has; nothing of the library is used.
"""
import random

from mpmath import exp, mp, mpf, nstr, sqrt

from mixed_sum import dot, rule

mp.dps = 30
NODES = rule(20, 12)

# (kernel, R, B, base, apex, weights at the base, in the middle, at the apex); decimals are doubles.
BONES = [
    ("gaussian", 0.25, -3, (-1.25, 0, 0), (0, 0.25, 0.5), 1.5, 1.125, 0.75),
    ("gaussian", 0.25, -3, (0, 0.25, 0.5), (1.25, -0.25, 0.125), 0.75, 0.625, 0.25),
    ("cauchy", 0.1875, -4, (-1.25, 0, 0), (-1, -0.5, -1), 0.25, 0.625, 1.0),
]


def along(a, b, x):
    return [p + x * (q - p) for p, q in zip(a, b)]


def quadratic(base, middle, apex, x):
    """Lagrange's form."""
    return (base * (1 - x) * (1 - 2 * x) + middle * 4 * x * (1 - x) + apex * x * (2 * x - 1))


def profile(kernel, k2, u):
    """h and dh/du of unit amplitude; k2 is a^2 or s^2."""
    if kernel == "gaussian":
        h = exp(-k2 * u)
        return h, -k2 * h
    v = 1 / (1 + k2 * u)
    return v * v, -2 * k2 * v * v * v


def integrate(f):
    """Of a list of functions of x in [0, 1]."""
    columns = zip(*([weight * y for y in f(x)] for x, weight in NODES))
    return [sum(column) for column in columns]


class Bone:
    def __init__(self, kernel, radius, blobbiness, base, apex, *weights):
        self.kernel, self.weights = kernel, [mpf(w) for w in weights]
        self.base, self.apex = [mpf(x) for x in base], [mpf(x) for x in apex]
        difference = [q - p for p, q in zip(self.base, self.apex)]
        self.length = sqrt(dot(difference, difference))
        self.k2 = -mpf(blobbiness) / mpf(radius) ** 2
        # The surface of the bone without weights is at distance R from its middle.
        beside = integrate(lambda x: [profile(
            kernel, self.k2, mpf(radius) ** 2 + (self.length * (x - mpf(1) / 2)) ** 2)[0]])
        self.scale = 1 / beside[0]  # lengths cancel

    def jet(self, p):
        def at(x):
            d = [a - b for a, b in zip(p, along(self.base, self.apex, x))]
            h, slope = profile(self.kernel, self.k2, dot(d, d))
            w = quadratic(*self.weights, x)
            return [w * h] + [2 * w * slope * c for c in d]
        return [self.scale * y for y in integrate(at)]


def main():
    chance = random.Random(4)
    bones = [Bone(*b) for b in BONES]
    print("x,y,z,value,gx,gy,gz")
    for _ in range(40):
        bone = chance.choice(bones)
        p = [float(c) + chance.uniform(-0.4, 0.4)
             for c in along(bone.base, bone.apex, chance.uniform(0, 1))]
        total = [sum(parts) for parts in zip(*(b.jet([mpf(x) for x in p]) for b in bones))]
        print(",".join([f"{x:.17g}" for x in p] + [nstr(y, 20) for y in total]))


if __name__ == "__main__":
    main()
