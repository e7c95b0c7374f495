#!/usr/bin/env python3
"""Breaks the closed forms one character at a time and tells which breaks no test notices:

    tests/mutation/mutate.py BUILD [FILE...]

BUILD is a release build with tests; without FILEs all closed forms are broken. A mutant changes a
sign or a constant in one place of one header. It is compiled into the tests of values (first the
reference rows, then, for what survives them, the comparison with 100 digits; those of second
derivatives into their own), as code for single doubles. Each is printed as it is done, the
survivors again at the end, those in conditions on their own: a threshold between two forms that
agree around it may move without changing a value. Status 1 if a value's mutant survives.
"""

import argparse
import concurrent.futures
import os
import pathlib
import re
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
FORMS = ["arc_place", "arc_powers", "arc_window", "carlson", "cauchy_arc", "cauchy_segment",
         "cauchy_triangle", "edge_panels", "gaussian_arc", "gaussian_segment", "gaussian_triangle",
         "hessian", "inverse_arc", "inverse_segment", "inverse_triangle", "metaball_arc",
         "metaball_triangle", "plane", "point", "squared_triangle", "support_arc",
         "support_segment", "support_triangle", "tapered_segment", "triangle_place",
         "triangle_trial"]
# The forms that a test is about, tried on them first; the test, how to compile it, what to run.
STAGES = [("edge|gaussian_tri|squared_tri", "tests/unit/integral/edge_panels_test.cpp", "-O0", "*"),
          ("", "tests/oracle/field_reference_test.cpp", "-O0",
           "FieldReference.EveryRowIsExactFor*"),
          ("segment|plane", "tests/unit/integral/closed_form_test.cpp", "-O1",
           "ClosedForm.*Exact*"),
          ("arc|carlson", "tests/unit/integral/arc_test.cpp", "-O1",
           "ArcFields.*Exact*:ArcFields.*CutOff*:Carlson.*"),
          ("triangle", "tests/unit/integral/triangle_form_test.cpp", "-O1",
           "TriangleForm.*Exact*"),
          ("tapered", "tests/unit/integral/tapered_segment_test.cpp", "-O1",
           "TaperedSegment.*Exact*")]
SECOND_STAGES = [("", "tests/unit/integral/hessian_test.cpp", "-O1",
                  "Hessian.*Exact*:Hessian.IsTheSlope*:Hessian.AddsUp*:Hessian.GivesTheValue*")]

# What does not enter a value: declarations, loops, tables, conditions of types.
SKIPPED = re.compile(r"^\s*(//|#|template|using|namespace|friend|static_assert|requires|for |"
                     r"constexpr const UnitRule|std::array|inline constexpr std::array|struct|"
                     r"\}|if constexpr)")
CONDITION = re.compile(r"\btake\(|\bif \(|\bselect\(|\bauto \w+ = .*[<>]|while \(|kReach|kGrowth|"
                       r"[<>]=? ?T?\(?[0-9]|\bgood =|\bnear =|\bfar =|growth|reach =|rest =|"
                       r"curvature|kLeast|kFlat|kEdge|kBeside|kNearEnd|limit\(|jet\.value / \(T")
SIGN = re.compile(r"(?<=[\w)\]]) ([+-]) (?=[\w(*-])|(?<=[(,=]) ?(-)(?=[\w(])")
NUMBER = re.compile(r"(?<![\w.<\[])(\d+\.\d*(?:e-?\d+)?|\d+)(?![\w.>\]])")


def changed_number(text):
    if "." in text or "e" in text:
        value = float(text)
        return repr(value * 1.01) if value else "0.01"
    return str(int(text) + 1)


def mutants_of(path):
    """(line number, line, its mutant)"""
    inside = in_bound = False
    for number, line in enumerate(path.read_text().splitlines(), 1):
        inside = inside or line.startswith("namespace cs2mesh")
        # Bounds have tests of their own.
        if line and not line[0].isspace():
            in_bound = "_bound(" in line
        if in_bound:
            continue
        if not inside or SKIPPED.match(line) or ";" not in line and "(" not in line:
            continue
        code = line.split("//")[0]
        for match in SIGN.finditer(code):
            group = 1 if match.group(1) else 2
            old = match.group(group)
            new = {"+": "-", "-": "+"}[old] if group == 1 else ""
            yield number, line, code[:match.start(group)] + new + code[match.end(group):]
        for match in NUMBER.finditer(code):
            before = code[:match.start()]
            if re.search(r"[\[%]\s*\(?\w*\s*[+-]?\s*$", before):
                continue  # an index
            yield number, line, before + changed_number(match.group(1)) + code[match.end():]


def stages_for(form):
    stages = SECOND_STAGES if form == "hessian" else STAGES
    first = [stage for stage in stages if re.search(stage[0], form)]
    return [stage[1:] for stage in first + [s for s in stages if s not in first]]


def survives(path, number, mutant, build):
    """Whether the mutant compiles and passes all tests."""
    with tempfile.TemporaryDirectory() as folder:
        overlay = pathlib.Path(folder) / path.relative_to(ROOT)
        overlay.parent.mkdir(parents=True)
        lines = path.read_text().splitlines()
        lines[number - 1] = mutant
        overlay.write_text("\n".join(lines) + "\n")
        for source, optimise, tests in stages_for(path.stem):
            program = pathlib.Path(folder) / "test"
            command = ["g++", "-std=c++20", optimise, "-ffp-contract=off", "-I", folder, "-I", ROOT,
                       f'-DCS2MESH_SOURCE_DIR="{ROOT}"', "-DCS2MESH_WIDE_ISAS=1", ROOT / source,
                       "-o", program, build / "libfield" / "libcs2mesh_field.a", "-lgtest",
                       "-lgtest_main", "-ltbb", "-lpng", "-pthread"]
            if subprocess.run(command, capture_output=True, check=False).returncode != 0:
                return False
            try:
                run = subprocess.run([program, f"--gtest_filter={tests}", "--gtest_fail_fast"],
                                     capture_output=True, check=False, timeout=600)
            except subprocess.TimeoutExpired:
                return False
            if run.returncode != 0:
                return False
    return True


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("file", nargs="*", type=pathlib.Path)
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="so many at a time")
    parser.add_argument("--every", type=int, default=1, help="only every so many mutants")
    options = parser.parse_args()
    files = options.file or [ROOT / "libfield" / "integral" / f"{name}.h" for name in FORMS]
    jobs = [(path.resolve(), *mutant) for path in files for mutant in mutants_of(path.resolve())]
    jobs = jobs[::options.every]
    values, conditions = [], []
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        verdicts = pool.map(lambda j: survives(j[0], j[1], j[3], options.build.resolve()), jobs)
        for (path, number, line, mutant), survivor in zip(jobs, verdicts):
            where = f"{path.relative_to(ROOT)}:{number}: {line.strip()}  ->  {mutant.strip()}"
            print(("SURVIVES " if survivor else "noticed  ") + where, flush=True)
            if survivor:
                (conditions if CONDITION.search(line) else values).append(where)
    print(f"{len(jobs)} mutants, {len(jobs) - len(values) - len(conditions)} noticed")
    for title, survivors in (("values", values), ("conditions", conditions)):
        print(f"{len(survivors)} survive in {title}" + (":" if survivors else ""))
        for where in survivors:
            print("  " + where)
    raise SystemExit(1 if values else 0)


if __name__ == "__main__":
    main()
