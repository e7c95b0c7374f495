"""The field of a scene without the project's code, by numpy.

Known are soft points, segments, arcs and triangles of one blend group under rotations and
translations: `sphere dot gauss line cylinder pipe arc arch torus triangle`, read by
independent_scene.py. Anything else that would change the surface is refused.

The field is strength · c · ∫ h(|p - q|) dq. In closed form: segments of the Gaussian and the Cauchy
kernel and triangles of the Cauchy kernel. All else is a sum over Gauss-Legendre nodes, on panels
as long as the distance at which the kernel falls. c makes the primitive alone 1 at its radius.
"""

import math

import numpy as np
from scipy.spatial.distance import cdist
from scipy.special import erf

NODES, WEIGHTS = np.polynomial.legendre.leggauss(10)
MAX_PAIRS = 2_000_000  # of points and sources at once


class Unreadable(Exception):
    """A command beyond the part of the language that is read here."""


# ---- kernels: h(u) and dh/du of the squared distance u ------------------------------------------
def width_of(kernel, radius, blobbiness):
    """The kernel's parameter s, a or support radius, from the radius and b = -blobbiness."""
    b = -blobbiness
    if kernel in ("cauchy", "gaussian"):
        return math.sqrt(b) / radius
    if kernel == "quartic":
        return radius * math.sqrt(1 + 2 / b)
    if kernel == "metaball":
        return radius * (1 + b) / b if b >= 0.5 else radius * math.sqrt(3 * (1 + b) / b)
    if kernel == "soft":
        v = 20 / ((5 * b - 2) + math.sqrt((5 * b - 2) ** 2 + 160 * b + 480))
        return radius / math.sqrt(b * v * (5 + 4 * v) / (10 + 12 * v))
    return 1.0


def kernel_values(kernel, width, u):
    """h and dh/du."""
    if kernel == "cauchy":
        v = 1 / (1 + width**2 * u)
        return v * v, -2 * width**2 * v**3
    if kernel == "gaussian":
        h = np.exp(-(width**2) * u)
        return h, -(width**2) * h
    if kernel in ("inverse", "squared"):
        u = np.maximum(u, 1e-300)
        return (u**-0.5, -0.5 * u**-1.5) if kernel == "inverse" else (1 / u, -1 / u**2)
    v = np.maximum(0, 1 - u / width**2)
    if kernel == "quartic":
        return v * v, -2 * v / width**2
    if kernel == "soft":
        return v * v * (5 + 4 * v) / 9, -(10 * v + 12 * v * v) / (9 * width**2)
    y = np.sqrt(u) / width
    outer, inner = np.maximum(0, 1 - y), np.maximum(0, 1 - 3 * y)
    slope = np.where(y < 1e-12, -3.0, -(1.5 * outer - 1.5 * inner) / np.maximum(y, 1e-12))
    return 1.5 * outer**2 - 0.5 * inner**2, slope / width**2


# ---- sources: value and gradient at points, unit strength ---------------------------------------
class NodeSource:
    """A primitive as weighted nodes."""

    def __init__(self, kernel, width, nodes, weights):
        self.kernel, self.width = kernel, width
        self.nodes, self.weights = np.atleast_2d(nodes), np.atleast_1d(weights)

    def evaluate(self, points):
        value, gradient = np.zeros(len(points)), np.zeros((len(points), 3))
        origin = self.nodes.mean(axis=0)  # near the nodes, so that little cancels below
        step = max(1, MAX_PAIRS // len(self.nodes))
        for at in range(0, len(points), step):
            block = slice(at, at + step)
            squared = cdist(points[block], self.nodes, "sqeuclidean")
            h, slope = kernel_values(self.kernel, self.width, squared)
            value[block] = h @ self.weights
            slope = slope * self.weights
            whole = slope.sum(axis=1)[:, None] * (points[block] - origin)
            gradient[block] = 2 * (whole - slope @ (self.nodes - origin))
        return value, gradient


class SegmentSource:
    """Gaussian or Cauchy over a segment, in closed form."""

    def __init__(self, kernel, width, first, second):
        self.kernel, self.width = kernel, width
        self.first = first
        self.length = np.linalg.norm(second - first)
        self.axis = (second - first) / self.length

    def evaluate(self, points):
        from_first = points - self.first
        along = from_first @ self.axis
        across = from_first - along[:, None] * self.axis
        c2 = np.einsum("pi,pi->p", across, across)
        t1, t2, s = -along, self.length - along, self.width
        if self.kernel == "gaussian":
            value = math.sqrt(math.pi) / (2 * s) * np.exp(-s * s * c2) * (erf(s * t2) - erf(s * t1))
            moment = -2 * s * s * value
        else:
            p = 1 + s * s * c2
            v1, v2 = p + s * s * t1**2, p + s * s * t2**2
            root = s * np.sqrt(p)
            angle = np.arctan2(root * self.length, p + s * s * t1 * t2) / root
            value = (self.length * (p - s * s * t1 * t2) / (v1 * v2) + angle) / (2 * p)
            moment = -(s * s / p) * (t2 / v2**2 - t1 / v1**2 + 3 * value)
        h1 = kernel_values(self.kernel, s, c2 + t1**2)[0]
        h2 = kernel_values(self.kernel, s, c2 + t2**2)[0]
        return value, moment[:, None] * across + (h1 - h2)[:, None] * self.axis


class TriangleSource:
    """Cauchy over a triangle, by its edges."""

    def __init__(self, width, corners):
        self.width, self.corners = width, corners
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        self.normal = normal / np.linalg.norm(normal)

    def evaluate(self, points):
        s = self.width
        z = (points - self.corners[0]) @ self.normal
        q = 1 + s * s * z * z
        total, slope = np.zeros(len(points)), np.zeros(len(points))
        gradient = np.zeros((len(points), 3))
        for i in range(3):
            a, b = self.corners[i], self.corners[(i + 1) % 3]
            line = SegmentSource("cauchy", s, a, b)
            outward = np.cross(line.axis, self.normal)
            e = -(points - a) @ outward
            t1, t2 = (a - points) @ line.axis, (b - points) @ line.axis
            c = np.sqrt(1 + s * s * (e * e + z * z))
            angle = np.arctan2(s * c * line.length, c * c + s * s * t1 * t2) / (s * c)
            along_edge = line.evaluate(points)[0]
            total += e * angle
            slope += e * (angle + q * along_edge)
            gradient -= along_edge[:, None] * outward
        gradient += (-(s * s) * z / q**2 * slope)[:, None] * self.normal
        return total / (2 * q), gradient


# ---- primitives: geometry, the place where they alone are 1, their source -----------------------
def panels(length, scale):
    """Nodes in [0, 1] and weights that sum to 1, for a curve of that length."""
    count = max(1, math.ceil(length / scale))
    nodes = (np.arange(count)[:, None] + 0.5 * (1 + NODES)) / count
    return nodes.ravel(), np.tile(0.5 * WEIGHTS, count) / count


def falling_distance(kernel, width, radius):
    """How long a panel may be: Gaussians fall within 1/a, others are smooth over a radius."""
    return 1.5 / width if kernel == "gaussian" else 0.5 * min(radius, 1e9)


def perpendicular(axis):
    other = np.eye(3)[np.argmin(np.abs(axis))]
    across = np.cross(axis, other)
    return across / np.linalg.norm(across)


class Primitive:
    """`middle` lies on the primitive, `normal` leads from there to where it alone is 1."""

    def __init__(self, kernel, radius, blobbiness, strength, middle, normal):
        self.kernel, self.radius, self.strength = kernel, radius, strength
        self.width = width_of(kernel, radius, blobbiness)
        self.middle, self.normal = np.array(middle, float), np.array(normal, float)
        self.vectors = ["normal"]  # turned by rotations
        self.places = ["middle"]  # turned and shifted

    def move(self, turn, shift):
        for name in self.places:
            setattr(self, name, getattr(self, name) @ turn.T + shift)
        for name in self.vectors:
            setattr(self, name, getattr(self, name) @ turn.T)

    def source(self):
        return NodeSource(self.kernel, self.width, self.middle, 1.0)

    def skeleton(self, shares):
        """Points of the primitive, for shares in [0, 1]²."""
        return np.repeat(self.middle[None, :], len(shares), axis=0)


class Segment(Primitive):
    def __init__(self, first, second, *material):
        axis = (second - first) / np.linalg.norm(second - first)
        super().__init__(*material, 0.5 * (first + second), perpendicular(axis))
        self.first, self.second = first, second
        self.places += ["first", "second"]

    def skeleton(self, shares):
        return self.first + shares[:, :1] * (self.second - self.first)

    def source(self):
        if self.kernel in ("gaussian", "cauchy"):
            return SegmentSource(self.kernel, self.width, self.first, self.second)
        length = np.linalg.norm(self.second - self.first)
        nodes, weights = panels(length, falling_distance(self.kernel, self.width, self.radius))
        return NodeSource(
            self.kernel, self.width, self.skeleton(nodes[:, None]), length * weights
        )


class Arc(Primitive):
    """center + sweep (cos x, sin x) in the frame (start, normal × start), 0 <= x <= angle."""

    def __init__(self, center, sweep, normal, start, angle, *material):
        self.center, self.sweep, self.start, self.angle = center, sweep, start, angle
        self.normal = normal
        super().__init__(*material, self.skeleton(np.array([[0.5]]))[0], normal)
        self.vectors.append("start")
        self.places.append("center")

    def skeleton(self, shares):
        turn = self.angle * shares[:, :1]
        side = np.cross(self.normal, self.start)
        return self.center + self.sweep * (np.cos(turn) * self.start + np.sin(turn) * side)

    def source(self):
        length = self.sweep * self.angle
        scale = min(falling_distance(self.kernel, self.width, self.radius), 0.5 * self.sweep)
        nodes, weights = panels(length, scale)
        return NodeSource(
            self.kernel, self.width, self.skeleton(nodes[:, None]), length * weights
        )


class Triangle(Primitive):
    def __init__(self, corners, *material):
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        super().__init__(*material, corners.mean(axis=0), normal / np.linalg.norm(normal))
        self.corners = corners
        self.places.append("corners")

    def skeleton(self, shares):
        root = np.sqrt(shares[:, :1])
        weights = np.hstack([1 - root, root * (1 - shares[:, 1:]), root * shares[:, 1:]])
        return weights @ self.corners

    def source(self):
        if self.kernel != "cauchy":
            raise Unreadable(f"a triangle of the {self.kernel} kernel")
        return TriangleSource(self.width, self.corners)


class Field:
    """The sum over primitives; the surface is where it is 1."""

    def __init__(self, primitives):
        self.primitives = primitives
        self.factors, self.sources = [], []
        for primitive in primitives:
            source = primitive.source()
            place = primitive.middle + primitive.radius * primitive.normal
            self.factors.append(primitive.strength / source.evaluate(place[None, :])[0][0])
            self.sources.append(source)
        self.merge_points()
        self.cost = sum(len(getattr(source, "nodes", [1] * 3)) for source in self.sources)

    def merge_points(self):
        """Points of one kernel and width are one source, which numpy walks through faster."""
        merged, others = {}, []
        for factor, source in zip(self.factors, self.sources):
            if isinstance(source, NodeSource):
                merged.setdefault((source.kernel, source.width), []).append((factor, source))
            else:
                others.append((factor, source))
        for (kernel, width), group in merged.items():
            nodes = np.vstack([source.nodes for _, source in group])
            weights = np.concatenate([factor * source.weights for factor, source in group])
            others.append((1.0, NodeSource(kernel, width, nodes, weights)))
        self.factors = [factor for factor, _ in others]
        self.sources = [source for _, source in others]

    def evaluate(self, points):
        value, gradient = np.zeros(len(points)), np.zeros((len(points), 3))
        for factor, source in zip(self.factors, self.sources):
            f, g = source.evaluate(points)
            value += factor * f
            gradient += factor * g
        return value, gradient

    def random_skeleton(self, random, count):
        """Points of the skeleton, as many of each primitive, and the radius there."""
        picked = random.integers(len(self.primitives), size=count)
        shares = random.random((count, 2))
        points, radii = np.empty((count, 3)), np.empty(count)
        for number in np.unique(picked):
            here = picked == number
            points[here] = self.primitives[number].skeleton(shares[here])
            radii[here] = self.primitives[number].radius
        return points, radii
