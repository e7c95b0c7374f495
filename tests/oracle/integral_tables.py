#!/usr/bin/env python3
"""Writes the number tables of libfield/integral, computed in 60 digits and rounded once:

    tests/oracle/integral_tables.py libfield/integral

gauss_legendre_table.inc  nodes and weights of Gauss-Legendre rules of even order on [-1, 1];
chord_table.inc           those of Gauss-Jacobi rules on [0, 1] for the weight 2u;
erfcx_table.inc           powers of t of (1 + 2x) erfcx(x), t = (x - 3) / (x + 3), x >= 0;
erfcx_first_table.inc     powers of t of (1 + x)^2 I1(x), the same t, and
erfcx_second_table.inc    of (1 + x)^3 I2(x), Ik = int_0^inf u^k exp(-2 x u - u^2) du;
cauchy_tail_table.inc     powers of z of the integral of u^4 / (1 + y u^2)^3 over u in [0, 1],
                          y = 0.245 (1 + z) in [0, 0.49];
small_erf_table.inc       powers of w of erf(z) / z - 1, w = z^2 in [0, 1];
arctan_table.inc          powers of w of (arctan(z) / z - 1) / w, w = z^2, 0 <= z <= 35/64;
short_arctan_table.inc    the same for 0 <= w <= 0.1716;
arc_rest_table.inc        powers of w of (atan x - x / (1 + x^2)) / (2 x^3), w = x^2 in [0, 1/4];
exp2_table.inc            powers of r of 2^r, |r| <= 1/2.
"""
import sys

from mpmath import (atan, cos, erf, erfc, exp, fac2, findroot, jacobi, legendre, mp, mpf, nstr, pi,
                    polyroots, quad, sqrt, taylor)

mp.dps = 60
HEAD = "// Written by tests/oracle/integral_tables.py.\n"


def literal(x):
    return nstr(x, 20, min_fixed=0, max_fixed=0)


def chebyshev_coefficients(f, degree):
    n = degree + 1
    angle = [pi * (k + mpf(1) / 2) / n for k in range(n)]
    values = [f(cos(a)) for a in angle]
    c = [2 * sum(v * cos(j * a) for v, a in zip(values, angle)) / n for j in range(n)]
    c[0] /= 2
    return c


def powers(chebyshev):
    """The same polynomial by powers: T_(j+1) = 2 t T_j - T_(j-1)."""
    n = len(chebyshev)
    previous, current = [mpf(1)] + [mpf(0)] * (n - 1), [mpf(0), mpf(1)] + [mpf(0)] * (n - 2)
    total = [chebyshev[0] * p for p in previous]
    for c in chebyshev[1:]:
        total = [t + c * p for t, p in zip(total, current)]
        shifted = [mpf(0)] + current[:-1]
        previous, current = current, [2 * s - p for s, p in zip(shifted, previous)]
    return total


def stretched(polynomial, scale, shift):
    """p(scale w + shift) by powers of w."""
    total = [mpf(0)] * len(polynomial)
    for c in reversed(polynomial):
        shifted = [mpf(0)] + total[:-1]
        total = [shift * t + scale * s for t, s in zip(total, shifted)]
        total[0] += c
    return total


def powers_from_zero(f, end, degree):
    """The polynomial close to f over [0, end]."""
    on_unit = lambda t: f(end * (1 + t) / 2)
    return stretched(powers(chebyshev_coefficients(on_unit, degree)), 2 / end, mpf(-1))


def erfcx(x):
    if x < 20:
        return exp(x * x) * erfc(x)
    return sum((-1) ** k * fac2(2 * k - 1) / (2 * x * x) ** k for k in range(30)) / (x * sqrt(pi))


def erfcx_moments(x):
    """I1 and I2, by parts from I0 = sqrt(pi) / 2 erfcx(x)."""
    zeroth = sqrt(pi) / 2 * erfcx(x)
    first = mpf(1) / 2 - x * zeroth
    return first, (zeroth - 2 * x * first) / 2


def arc_rest(w):
    if w < mpf("1e-8"):
        return sum((-1) ** (k + 1) * k * w ** (k - 1) / (2 * k + 1) for k in range(1, 9))
    x = sqrt(w)
    return (atan(x) - x / (1 + w)) / (2 * x * w)


def legendre_rule(n):
    slope = lambda x: n * (legendre(n - 1, x) - x * legendre(n, x)) / (1 - x * x)
    nodes = [findroot(lambda x: legendre(n, x), cos(pi * (k + mpf(3) / 4) / (n + mpf(1) / 2)),
                      solver="newton", df=slope)
             for k in range(n // 2)]
    rule = []
    for x in sorted(nodes):
        rule.append((x, 2 / ((1 - x * x) * slope(x) ** 2)))
    return rule


def chord_rule(n):
    polynomial = lambda k, u: jacobi(k, 0, 1, 2 * u - 1)
    # The reciprocal of the sum of squares of the orthonormal polynomials.
    weight = lambda u: 1 / sum((k + 1) * polynomial(k, u)**2 for k in range(n))
    nodes = polyroots(taylor(lambda u: polynomial(n, u), 0, n)[::-1], maxsteps=200, extraprec=300)
    return [(u, weight(u)) for u in sorted(nodes)]


def write_list(path, numbers):
    with open(path, "w") as out:
        out.write(HEAD)
        out.write(",\n".join(literal(x) for x in numbers) + ",\n")


def main(folder):
    with open(f"{folder}/gauss_legendre_table.inc", "w") as out:
        out.write(HEAD)
        for n in (2, 4, 6, 8, 14, 16, 20):
            rule = legendre_rule(n)
            name = f"GaussLegendreRule<{n}> kGaussLegendre<{n}>"
            out.write(f"template <>\ninline constexpr {name} = {{\n")
            out.write("    {" + ",\n     ".join(literal(x) for x, _ in rule) + "},\n")
            out.write("    {" + ",\n     ".join(literal(w) for _, w in rule) + "}};\n")
    with open(f"{folder}/chord_table.inc", "w") as out:
        out.write(HEAD)
        for n in (1, 2, 3, 4, 5, 6, 8, 10, 12):
            lines = ["    {" + literal(u) + ", " + literal(w) + "}" for u, w in chord_rule(n)]
            out.write(",\n".join(lines) + ",\n")
    scaled = lambda t: (lambda x: (1 + 2 * x) * erfcx(x))(3 * (1 + t) / (1 - t))
    write_list(f"{folder}/erfcx_table.inc", powers(chebyshev_coefficients(scaled, 25)))
    for k, name in ((1, "first"), (2, "second")):
        scaled = lambda t: (lambda x: (1 + x)**(k + 1) * erfcx_moments(x)[k - 1])(
            3 * (1 + t) / (1 - t))
        write_list(f"{folder}/erfcx_{name}_table.inc", powers(chebyshev_coefficients(scaled, 25)))
    y_max = mpf("0.49")
    tail = lambda z: quad(lambda u: u**4 / (1 + y_max * (1 + z) / 2 * u * u) ** 3, [0, 0.5, 1])
    write_list(f"{folder}/cauchy_tail_table.inc", powers(chebyshev_coefficients(tail, 17)))
    small_erf = lambda w: erf(sqrt(w)) / sqrt(w) - 1
    write_list(f"{folder}/small_erf_table.inc", powers_from_zero(small_erf, mpf(1), 13))
    arctan = lambda w: (atan(sqrt(w)) / sqrt(w) - 1) / w
    write_list(f"{folder}/arctan_table.inc", powers_from_zero(arctan, (mpf(35) / 64)**2, 13))
    write_list(f"{folder}/short_arctan_table.inc", powers_from_zero(arctan, mpf("0.1716"), 9))
    write_list(f"{folder}/arc_rest_table.inc", powers_from_zero(arc_rest, mpf(1) / 4, 13))
    power_of_two = powers(chebyshev_coefficients(lambda t: mpf(2) ** (t / 2), 11))
    write_list(f"{folder}/exp2_table.inc", stretched(power_of_two, mpf(2), mpf(0)))


if __name__ == "__main__":
    main(sys.argv[1])
