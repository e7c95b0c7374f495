#!/usr/bin/env python3
"""Holds a mesher to its contract: meshes scenes, checks and measures the meshes, prints a table.

    tests/contract/contract.py [--mesher NAME] [--scenes sphere,my.art] [--tolerances 1%,0.1%]
    tests/contract/contract.py --random N [--seed S]     scenes drawn by seeds S ... S+N-1
    tests/contract/contract.py --minimise S              the least part of a scene that still fails

Held is: the run ends in time with status 0; the mesh is closed, manifold, oriented, free of
self-intersections, nowhere farther from the surface than the tolerance, in either direction; outer
components, voids and genus are as expected. A random scene may also end with status 3 and the place
of what cannot be meshed, or with status 2 where it has no surface. Status 1 if anything does not
hold.
"""

import argparse
import json
import pathlib
import re
import subprocess
import sys

import random_scenes
import scenes
from judge import Judge, Limits

ROOT = pathlib.Path(__file__).resolve().parents[2]
HERE = pathlib.Path(__file__).resolve().parent
LOCATED = re.compile(r"^[^\n]*:\d+:(\d+:)? error: ", re.MULTILINE)
NO_SURFACE = re.compile(r"error: the scene has no surface")
COLUMNS = [
    ("scene", 11),
    ("tol", 6),
    ("s", 7),
    ("s cpu", 7),
    ("triangles", 10),
    ("->surf", 8),
    ("->mesh", 8),
    ("closed", 6),
    ("manif", 6),
    ("selfX", 6),
    ("c/v/g", 9),
    ("expected", 9),
    ("MB", 6),
]


def independent_python():
    """An interpreter with numpy and scipy: ours, or Debian's, which sees Debian's packages."""
    for python in (sys.executable, "/usr/bin/python3"):
        words = [python, "-c", "import numpy, scipy"]
        if pathlib.Path(python).exists():
            if subprocess.run(words, capture_output=True, check=False).returncode == 0:
                return python
    return None


def text_of(value):
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "NO"
    return f"{value:.3f}" if isinstance(value, float) else str(value)


def cells(row, topologies):
    shape = [str(row[name]) for name in ("outer", "voids", "genus") if name in row]
    megabytes = row["peak_memory_bytes"] >> 20
    return [
        row["scene"],
        row["tolerance"],
        row["seconds"],
        row["work_seconds"],
        row.get("triangles"),
        row.get("mesh_to_surface"),
        row.get("surface_to_mesh"),
        row.get("closed"),
        row.get("manifold"),
        row.get("self_intersections"),
        "/".join(shape) or None,
        " or ".join("/".join(map(str, right)) for right in topologies) or None,
        megabytes,
    ]


def print_line(values, rest):
    words = [
        text_of(value).ljust(width) if at < 2 else text_of(value).rjust(width)
        for at, (value, (_, width)) in enumerate(zip(values, COLUMNS))
    ]
    print(" ".join(words), rest, flush=True)


def print_row(row, topologies=()):
    print_line(cells(row, topologies), "; ".join(row["broken"]) or row.get("refused", "holds"))
    if "independent_surface_to_mesh" in row:
        to_surface, to_mesh = row["independent_mesh_to_surface"], row["independent_surface_to_mesh"]
        print(f"    independently: {to_surface:.3f} ->surf, {to_mesh:.3f} ->mesh", flush=True)


def measure_independently(python, scene, row):
    """Adds the distances that the script without the project's code finds."""
    command = [python, HERE / "independent.py", scene, row["mesh"], "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode == 3:
        return  # a scene that the script does not read
    if done.returncode != 0:
        row["broken"].append("independent: " + (done.stderr.splitlines() or ["no word"])[-1])
        return
    measured = json.loads(done.stdout)
    for way in ("mesh_to_surface", "surface_to_mesh"):
        share = measured[f"{way}_max"] / row["absolute_tolerance"]
        row["independent_" + way] = share
        if not share <= 1.0:
            row["broken"].append(f"independent {way} {share:.3g} tolerances")


def judge_contract(options, judge):
    """Known names and paths of scenes alike."""
    rows = []
    python = independent_python() if options.independent else None
    if options.independent and python is None:
        sys.exit("contract: --independent needs numpy and scipy (python3-numpy, python3-scipy)")
    for name in options.scenes.split(","):
        known = name in scenes.CONTRACT
        if not known and not pathlib.Path(name).is_file():
            known_names = ", ".join(scenes.CONTRACT)
            sys.exit(f"contract: no scene '{name}', expected a path or one of {known_names}")
        path = scenes.scene_file(name, judge.folder / "scenes") if known else pathlib.Path(name)
        topologies = scenes.CONTRACT[name].topologies if known else ()
        for tolerance in options.tolerances.split(","):
            row = judge.judge(path, tolerance, topologies)
            if python and "mesh" in row:
                measure_independently(python, path, row)
            print_row(row, topologies)
            rows.append(row)
    return rows


def judge_random_scene(judge, scene, tolerance):
    """As any scene, but that it may be refused: without a surface, or with a plane, whose field may
    be infinite and whose surface unbounded, if the place of the reason is named."""
    row = judge.judge(scene, tolerance)
    has_plane = re.search(r"^plane ", pathlib.Path(scene).read_text(), re.MULTILINE)
    accepted = {3: LOCATED if has_plane else None, 2: NO_SURFACE}.get(row["status"])
    if accepted and accepted.search(row["words"]):
        row["refused"] = "refused, rightly: " + row["broken"].pop()
    return row


def write_scene(judge, name, items):
    path = judge.folder / "random" / f"{name}.art"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n".join(items) + "\n")
    return path


def judge_random(options, judge):
    rows = []
    for seed in range(options.seed, options.seed + options.random):
        scene = random_scenes.random_scene(seed)
        path = write_scene(judge, f"seed{seed}", scene.items())
        row = judge_random_scene(judge, path, scene.tolerance)
        row["seed"] = seed
        print_row(row)
        rows.append(row)
    failing = [row for row in rows if row["broken"]]
    if failing:
        print("failing seeds:", ", ".join(str(row["seed"]) for row in failing))
    return rows


def kind_of_failure(row):
    """What stays the same when a scene is made smaller: the first failure without its numbers."""
    if not row["broken"]:
        return ""
    words = re.sub(r"\S*\.(art|obj)\S*", "", row["broken"][0])
    return re.sub(r"'[^']*'|-?\d[\d.e+-]*", "", words.replace("status ", "status#"))[:48]


def minimise(options, judge):
    """Leaves out halves, quarters ... single items for as long as the failure stays the same."""
    scene = random_scenes.random_scene(options.minimise)
    name = f"least{options.minimise}"
    head, items = scene.head, list(scene.primitives)

    def failure_of(kept):
        path = write_scene(judge, name, head + kept)
        return kind_of_failure(judge_random_scene(judge, path, scene.tolerance))

    wanted = failure_of(items)
    if not wanted:
        sys.exit(f"contract: seed {options.minimise} holds")
    size = max(1, len(items) // 2)
    while size >= 1:
        at = 0
        while at < len(items):
            fewer = items[:at] + items[at + size :]
            if fewer and failure_of(fewer) == wanted:
                items = fewer
            else:
                at += size
        size //= 2
    used = [line for line in head if not line.startswith("surface") or mentions(line, items)]
    path = write_scene(judge, name, used + items)
    row = judge_random_scene(judge, path, scene.tolerance)
    print(path.read_text())
    print_row(row)
    return [row]


def mentions(definition, items):
    name = definition.split()[1]
    return any(re.search(rf"\b{name}\b", item) for item in items)


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--program", default=ROOT / "build" / "release" / "cs2mesh")
    parser.add_argument("--folder", default=ROOT / "build" / "contract", type=pathlib.Path)
    parser.add_argument("--mesher")
    parser.add_argument("--scenes", default=",".join(scenes.CONTRACT), help="names or paths")
    parser.add_argument("--tolerances", default="1%,0.1%,0.01%", help="of the diagonal")
    parser.add_argument("--time-limit", type=float, default=600.0, help="seconds to mesh in")
    parser.add_argument("--measure-limit", type=float, default=1800.0, help="and to measure in")
    parser.add_argument("--memory", type=float, default=16.0, help="GiB of address space")
    parser.add_argument("--samples", type=int, default=1_000_000, help="each way")
    parser.add_argument("--independent", action="store_true", help="measure a second time")
    parser.add_argument("--random", type=int, default=0, metavar="N")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--minimise", type=int, metavar="SEED")
    parser.add_argument("--json", type=pathlib.Path, help="write the rows to this file")
    return parser.parse_args()


def main():
    options = parse_arguments()
    options.folder.mkdir(parents=True, exist_ok=True)
    memory = int(options.memory * (1 << 30))
    limits = Limits(options.time_limit, options.measure_limit, memory, options.samples)
    judge = Judge(options.program, options.folder, options.mesher, limits)
    print_line([name for name, _ in COLUMNS], "")
    if options.minimise is not None:
        rows = minimise(options, judge)
    elif options.random:
        rows = judge_random(options, judge)
    else:
        rows = judge_contract(options, judge)
    if options.json:
        options.json.write_text(json.dumps(rows, indent=1) + "\n")
    broken = sum(bool(row["broken"]) for row in rows)
    print(f"{len(rows) - broken} of {len(rows)} hold")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
