"""A bust of 1,242 triangles: head with nose, neck and shoulders, as rings of one grid."""

import math

COLUMNS = 27
RINGS = 23

# From the crown down to the base: height, half width (x), half depth (y), middle in y.
OUTLINE = [
    (1.62, 0.00, 0.00, 0.00),
    (1.57, 0.24, 0.28, 0.00),
    (1.42, 0.43, 0.50, 0.00),
    (1.15, 0.52, 0.60, 0.00),
    (0.85, 0.50, 0.56, 0.02),
    (0.60, 0.42, 0.46, 0.04),
    (0.42, 0.30, 0.32, 0.02),
    (0.22, 0.26, 0.26, -0.04),
    (0.04, 0.32, 0.29, -0.06),
    (-0.12, 0.62, 0.36, -0.06),
    (-0.32, 0.86, 0.42, -0.04),
    (-0.60, 0.88, 0.44, -0.02),
    (-0.68, 0.00, 0.00, 0.00),
]


def outline(position):
    """Linear between the rows, at 0 the crown and at 1 the base."""
    place = position * (len(OUTLINE) - 1)
    row = min(int(place), len(OUTLINE) - 2)
    part = place - row
    return tuple(a + part * (b - a) for a, b in zip(OUTLINE[row], OUTLINE[row + 1]))


def bump(x, middle, width):
    return math.exp(-(((x - middle) / width) ** 2))


def vertex(ring, column):
    height, half_width, half_depth, middle = outline(ring / (RINGS + 1))
    turn = 2.0 * math.pi * column / COLUMNS
    x, y = half_width * math.cos(turn), half_depth * math.sin(turn) + middle
    front = bump(turn, 0.5 * math.pi, 0.28)
    nose = 0.26 * front * bump(height, 0.83, 0.12)
    chin = 0.10 * bump(turn, 0.5 * math.pi, 0.5) * bump(height, 0.50, 0.10)
    eyes = -0.06 * bump(abs(turn - 0.5 * math.pi), 0.42, 0.16) * bump(height, 1.02, 0.10)
    return (x, y + nose + chin + eyes, height)


def triangles():
    """Corners, counter-clockwise seen from outside."""
    crown, base = vertex(0, 0), vertex(RINGS + 1, 0)
    found = []
    for column in range(COLUMNS):
        after = (column + 1) % COLUMNS
        found.append((crown, vertex(1, column), vertex(1, after)))
        for ring in range(1, RINGS):
            above, above_after = vertex(ring, column), vertex(ring, after)
            below, below_after = vertex(ring + 1, column), vertex(ring + 1, after)
            found.append((above, below, below_after))
            found.append((above, below_after, above_after))
        found.append((base, vertex(RINGS, after), vertex(RINGS, column)))
    return found
