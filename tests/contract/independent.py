#!/usr/bin/env python3
"""Measures a mesh against the surface with no code of the project (numpy and scipy instead):

    tests/contract/independent.py SCENE.art MESH.obj [--samples N] [--seed S] [--json]
    tests/contract/independent.py SCENE.art --topology N      counts on a grid of N cells a side
        [--within X Y Z X Y Z]                                of that box alone
    tests/contract/independent.py SCENE.art --values          "x y z" a line on stdin: the field

To the surface: random points of triangles are led along the gradient until the field is 1; where
that way is longest, the nearest of many directions counts. Both are upper bounds. To the mesh:
rays, from places on the skeleton and through the box, are marched until the field crosses 1; the
distance to the nearest triangle is exact for the largest. Topology: components, hollows and tunnels
of the voxels inside, by Euler's formula (a genus is a tunnel). Status 3: a scene beyond the part of
the language that is read here.
"""

import argparse
import json
import sys

import numpy as np
from scipy import ndimage
from scipy.spatial import cKDTree

from independent_field import Unreadable
from independent_scene import read_scene

MARCH = 48  # steps of a ray
HALVINGS = 32  # of a step, around a crossing
BUDGET = 1.5e9  # evaluations of one source at one point, for all rays
DIRECTIONS = 300  # in which the surface is looked for, if the gradient may mislead
RETRY_STEPS = 32
SLID = 3000  # feet that are led along the surface, of the points farthest from it
RETRIED = 200  # points for which that is done at most
NEAREST = 12  # triangles tried by their middles


def read_obj(path):
    vertices, faces = [], []
    with open(path, encoding="utf-8") as lines:
        for line in lines:
            if line.startswith("v "):
                vertices.append(line.split()[1:4])
            elif line.startswith("f "):
                faces.append([int(word.split("/")[0]) - 1 for word in line.split()[1:]])
    return np.array(vertices, float), np.array(faces, int)


def potential(field, points):
    """log F where F > 0, which is nearly quadratic for stiff kernels, and its gradient; F - 1
    elsewhere. Both are 0 on the surface."""
    value, gradient = field.evaluate(points)
    positive = value > 1e-300
    safe = np.where(positive, value, 1.0)
    return (
        np.where(positive, np.log(safe), value - 1.0),
        np.where(positive[:, None], gradient / safe[:, None], gradient),
    )


# ---- mesh to surface ----------------------------------------------------------------------------
def random_on_mesh(random, vertices, faces, count):
    corners = vertices[faces]
    areas = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    picked = corners[random.choice(len(faces), size=count, p=areas / areas.sum())]
    root, other = np.sqrt(random.random((count, 1))), random.random((count, 1))
    return (1 - root) * picked[:, 0] + root * ((1 - other) * picked[:, 1] + other * picked[:, 2])


def feet_of(field, starts, most):
    """Newton along the gradient, no step longer than `most`; not a number where it does not
    arrive."""
    at, feet = starts.copy(), np.full(starts.shape, np.nan)
    waiting = np.arange(len(starts))
    for _ in range(30):
        value, gradient = potential(field, at[waiting])
        squared = np.maximum(np.einsum("pi,pi->p", gradient, gradient), 1e-300)
        step = -(value / squared)[:, None] * gradient
        length = np.linalg.norm(step, axis=1)
        arrived = length <= 1e-9 * most
        feet[waiting[arrived]] = at[waiting[arrived]]
        step *= np.minimum(1.0, most / np.maximum(length, 1e-300))[:, None]
        at[waiting] += step
        waiting = waiting[~arrived]
        if len(waiting) == 0:
            break
    return feet


def distances(points, feet):
    away = np.linalg.norm(points - feet, axis=1)
    return np.where(np.isnan(away), np.inf, away)


def slid_feet(field, points, feet, most):
    """The feet, led along the surface towards the points for as long as that shortens the way."""
    share = np.ones(len(points))
    for _ in range(8):
        gradient = potential(field, np.nan_to_num(feet))[1]
        normal = gradient / np.maximum(np.linalg.norm(gradient, axis=1), 1e-300)[:, None]
        away = points - feet
        along = away - np.einsum("pi,pi->p", away, normal)[:, None] * normal
        tried = feet_of(field, np.nan_to_num(feet + share[:, None] * along), most)
        better = distances(points, tried) < distances(points, feet)
        feet = np.where(better[:, None], tried, feet)
        share = np.where(better, share, 0.5 * share)
    return feet


def nearest_crossing(field, point, directions, reach):
    """The shortest way to the surface in one of the directions, and that direction."""
    inside = field.evaluate(point[None, :])[0][0] >= 1.0
    crossing = np.full(len(directions), np.inf)
    for share in np.arange(1, RETRY_STEPS + 1) / RETRY_STEPS:
        away = np.nonzero(crossing == np.inf)[0]
        value = field.evaluate(point + share * reach * directions[away])[0]
        crossing[away[(value >= 1.0) != inside]] = share * reach
    hit = np.nonzero(crossing == crossing.min())[0]
    if crossing[hit[0]] == np.inf:
        return np.inf, directions[0]
    starts, far = np.repeat(point[None, :], len(hit), axis=0), crossing[hit]
    feet = bisected(field, starts, directions[hit], far - reach / RETRY_STEPS, far)
    ways = np.linalg.norm(feet - point, axis=1)
    return float(ways.min()), directions[hit[np.argmin(ways)]]


def nearer_surface(random, field, point, bound):
    """Looks in all directions, then in ever closer ones around the best."""
    directions = random_directions(random, DIRECTIONS)
    for width in (0.3, 0.1, 0.03, 0.0):
        way, best = nearest_crossing(field, point, directions, bound)
        bound = min(bound, way)
        directions = best + width * random_directions(random, DIRECTIONS)
        directions /= np.linalg.norm(directions, axis=1)[:, None]
    return bound


def largest_distance_to_surface(random, field, points, most):
    """Of the bounds by Newton the largest are tried again, until one stands: in a groove the
    gradient does not lead to the nearest place."""
    feet = feet_of(field, points, most)
    bounds = distances(points, feet)
    worst = np.argsort(-bounds)[:SLID]
    bounds[worst] = distances(points[worst], slid_feet(field, points[worst], feet[worst], most))
    largest = 0.0
    for index in np.argsort(-bounds)[:RETRIED]:
        if bounds[index] <= largest:
            break
        reach = min(float(bounds[index]), 10 * most)
        nearer = nearer_surface(random, field, points[index], reach)
        if nearer < reach:
            bounds[index] = nearer
        largest = max(largest, float(bounds[index]))
    return float(bounds.max())


# ---- surface to mesh ----------------------------------------------------------------------------
def random_directions(random, count):
    directions = random.normal(size=(count, 3))
    return directions / np.linalg.norm(directions, axis=1)[:, None]


def rays_of(random, field, low, high, count):
    """Starts, directions and lengths: half from the skeleton, half through the box."""
    starts, radii = field.random_skeleton(random, count)
    lengths = 4.0 * radii
    directions = random_directions(random, count)
    across = random.random(count) < 0.5
    diagonal = np.linalg.norm(high - low)
    inside = low + random.random((count, 3)) * (high - low)
    starts[across] = (inside - 0.5 * diagonal * directions)[across]
    lengths[across] = diagonal
    return starts, directions, lengths


def surface_points(random, field, low, high, count):
    """The first crossing from inside to outside or back in each step of each ray."""
    starts, directions, lengths = rays_of(random, field, low, high, count)
    found = []
    before = None
    for step in range(MARCH + 1):
        share = step / MARCH
        value = field.evaluate(starts + (share * lengths)[:, None] * directions)[0] >= 1.0
        if before is not None:
            crossed = np.nonzero(value != before)[0]
            near = (step - 1) / MARCH * lengths[crossed]
            far = share * lengths[crossed]
            found.append(bisected(field, starts[crossed], directions[crossed], near, far))
        before = value
    return np.vstack(found)


def bisected(field, starts, directions, near, far):
    begin = field.evaluate(starts + near[:, None] * directions)[0] >= 1.0
    for _ in range(HALVINGS):
        middle = 0.5 * (near + far)
        same = (field.evaluate(starts + middle[:, None] * directions)[0] >= 1.0) == begin
        near, far = np.where(same, middle, near), np.where(same, far, middle)
    return starts + (0.5 * (near + far))[:, None] * directions


def distance_to_segment(points, a, b):
    along = b - a
    squared = np.maximum(np.einsum("...i,...i->...", along, along), 1e-300)
    share = np.clip(np.einsum("...i,...i->...", points - a, along) / squared, 0, 1)
    return np.linalg.norm(points - a - share[..., None] * along, axis=-1)


def distance_to_triangles(points, corners):
    """Elementwise: of points (..., 3) to triangles (..., 3, 3)."""
    a, b, c = corners[..., 0, :], corners[..., 1, :], corners[..., 2, :]
    normal = np.cross(b - a, c - a)
    size = np.maximum(np.linalg.norm(normal, axis=-1), 1e-300)
    height = np.einsum("...i,...i->...", points - a, normal) / size
    inside = np.ones(height.shape, bool)
    edges = np.full(height.shape, np.inf)
    for first, second in ((a, b), (b, c), (c, a)):
        turn = np.einsum("...i,...i->...", np.cross(second - first, points - first), normal)
        inside &= turn >= 0
        edges = np.minimum(edges, distance_to_segment(points, first, second))
    return np.where(inside, np.abs(height), edges)


def largest_distance_to_mesh(points, vertices, faces):
    """Exact: bounds from near triangles first, all triangles for whatever may be the largest."""
    corners = vertices[faces]
    tree = cKDTree(corners.mean(axis=1))
    count = min(NEAREST, len(faces))
    near = tree.query(points, k=count)[1].reshape(len(points), count)
    bound = np.empty(len(points))
    for at in range(0, len(points), 20000):
        block = slice(at, at + 20000)
        shape = np.broadcast_to(points[block, None, :], (*near[block].shape, 3))
        bound[block] = distance_to_triangles(shape, corners[near[block]]).min(axis=1)
    largest = 0.0
    for index in np.argsort(-bound):
        if bound[index] <= largest:
            break
        every = np.broadcast_to(points[index], (len(faces), 3))
        largest = max(largest, float(distance_to_triangles(every, corners).min()))
    return largest


# ---- topology on a grid -------------------------------------------------------------------------
class Surroundings:
    """Of the skeleton: outside of them nodes count as outside, which every seventh has to prove."""

    def __init__(self, field):
        random = np.random.default_rng(1)
        points, radii = field.random_skeleton(random, 300 * len(field.primitives))
        self.reach = 2.5 * radii.max()
        self.low, self.high = (points - self.reach).min(axis=0), (points + self.reach).max(axis=0)
        self.tree = cKDTree(points)

    def inside(self, field, points):
        near = self.tree.query(points, distance_upper_bound=self.reach)[0] < np.inf
        asked = near | (np.arange(len(points)) % 7 == 0)
        inside = np.zeros(len(points), bool)
        inside[asked] = field.evaluate(points[asked])[0] >= 1.0
        if np.any(inside & ~near):
            raise Unreadable("a surface far from its skeleton, which --topology would miss")
        return inside


def topology(field, cells, within=None):
    """(components, hollows, tunnels) of the union of closed cubes around the nodes inside."""
    surroundings = Surroundings(field)
    low, high = surroundings.low, surroundings.high
    if within:
        low, high = np.array(within[:3]), np.array(within[3:])
    side = (high - low).max() / cells
    shape = np.ceil((high - low) / side).astype(int) + 1
    inside = np.zeros(shape + 2, bool)
    y, z = np.meshgrid(np.arange(shape[1]), np.arange(shape[2]), indexing="ij")
    for x in range(shape[0]):
        points = low + side * np.stack([np.full(y.size, x), y.ravel(), z.ravel()], axis=1)
        inside[x + 1, 1:-1, 1:-1] = surroundings.inside(field, points).reshape(y.shape)
    components = ndimage.label(inside, np.ones((3, 3, 3)))[1]
    hollows = ndimage.label(~inside)[1] - 1
    return components, hollows, components + hollows - euler_number(inside)


def euler_number(inside):
    """Vertices - edges + faces - cubes of the union of closed voxels."""
    total = 0
    for axes in range(8):
        grown = inside
        for axis in range(3):
            if not axes >> axis & 1:  # cells of this dimension lie between voxels along the axis
                before, after = [slice(None)] * 3, [slice(None)] * 3
                before[axis], after[axis] = slice(None, -1), slice(1, None)
                grown = grown[tuple(before)] | grown[tuple(after)]
        total += (-1) ** bin(axes).count("1") * int(grown.sum())
    return total


def measure(field, vertices, faces, samples, seed):
    random = np.random.default_rng(seed)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    diagonal = float(np.linalg.norm(high - low))
    on_mesh = random_on_mesh(random, vertices, faces, samples)
    mesh_to_surface = largest_distance_to_surface(random, field, on_mesh, 0.01 * diagonal)
    rays = int(min(samples, BUDGET / (field.cost * (MARCH + HALVINGS))))
    margin = 0.05 * diagonal
    on_surface = surface_points(random, field, low - margin, high + margin, max(rays, 200))
    return {
        "mesh_to_surface_max": mesh_to_surface,
        "surface_to_mesh_max": largest_distance_to_mesh(on_surface, vertices, faces),
        "mesh_samples": samples,
        "surface_samples": len(on_surface),
        "triangles": len(faces),
    }


def print_topology(field, options):
    try:
        found = topology(field, options.topology, options.within)
    except Unreadable as reason:
        sys.exit(f"independent: {options.scene}: {reason}")
    print("components %d, hollows %d, tunnels %d" % found)


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("scene")
    parser.add_argument("mesh", nargs="?", help="an .obj of triangles")
    parser.add_argument("--samples", type=int, default=20000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--topology", type=int, metavar="N")
    parser.add_argument("--within", type=float, nargs=6, help="lower and upper corner of a box")
    parser.add_argument("--values", action="store_true")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    if not (options.mesh or options.topology or options.values):
        parser.error("a mesh, --topology or --values is wanted")
    return options


def main():
    options = parse_arguments()
    try:
        field = read_scene(options.scene)
    except Unreadable as reason:
        print(f"independent: {options.scene}: not read here: {reason}", file=sys.stderr)
        sys.exit(3)
    if options.topology:
        print_topology(field, options)
        return
    if options.values:
        points = np.loadtxt(sys.stdin, ndmin=2)
        value, gradient = field.evaluate(points)
        np.savetxt(sys.stdout, np.column_stack([value, gradient]), fmt="%.17g")
        return
    measured = measure(field, *read_obj(options.mesh), options.samples, options.seed)
    if options.json:
        print(json.dumps(measured))
    else:
        print(
            f"mesh to surface {measured['mesh_to_surface_max']:.6g} ({options.samples} points), "
            f"surface to mesh {measured['surface_to_mesh_max']:.6g} "
            f"({measured['surface_samples']} points)"
        )


if __name__ == "__main__":
    main()
