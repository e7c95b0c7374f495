"""One run of the program, judged: what it took, what it promised, and whether that holds."""

import json
import math
import os
import pathlib
import resource
import signal
import subprocess
import tempfile
import threading
import time


class Limits:
    def __init__(self, seconds=60.0, measure_seconds=600.0, memory=8 << 30, samples=1_000_000):
        self.seconds = seconds  # of meshing
        self.measure_seconds = measure_seconds  # of check and of compare
        self.memory = memory  # bytes of address space
        self.samples = samples  # of compare, each way; a hundredth of it are certified rays


class Done:
    def __init__(self, status, seconds, work, peak, timed_out, stdout, stderr):
        self.status = status  # negative: the signal that ended it
        self.seconds = seconds  # of the clock
        self.work = work  # seconds of all cores together, which other programs disturb less
        self.peak = peak  # bytes
        self.timed_out = timed_out
        self.stdout = stdout
        self.stderr = stderr

    def failure(self):
        """In words; empty after status 0."""
        if self.timed_out:
            return f"ran over its time, {self.seconds:.0f} s, {self.work:.0f} s of all cores"
        if self.status < 0:
            return f"ended by signal {-self.status}"
        if self.status > 0:
            errors = [line for line in self.stderr.splitlines() if "error: " in line]
            return f"status {self.status}: " + (errors or ["no word of an error"])[0]
        return ""


def run_limited(command, seconds, memory):
    """Runs a program to its end or to the limit, whichever comes first.

    The limit is work of that many seconds on all cores; by the clock it is ten times as long, for
    a machine that is busy with other things.
    """

    def limit():
        work = math.ceil(seconds * (os.cpu_count() or 1))
        resource.setrlimit(resource.RLIMIT_CPU, (work, work + 5))
        resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        start = time.monotonic()
        process = subprocess.Popen(
            [*map(str, command)], stdout=out, stderr=err, stdin=subprocess.DEVNULL, preexec_fn=limit
        )
        late = threading.Event()

        def stop():
            late.set()
            process.kill()

        timer = threading.Timer(10 * seconds, stop)
        timer.start()
        _, status, usage = os.wait4(process.pid, 0)
        timer.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)
        took = time.monotonic() - start
        out.seek(0)
        err.seek(0)
        words = [stream.read().decode("utf-8", errors="replace") for stream in (out, err)]
    work = usage.ru_utime + usage.ru_stime
    timed_out = late.is_set() or process.returncode == -signal.SIGXCPU
    return Done(process.returncode, took, work, usage.ru_maxrss << 10, timed_out, *words)


class Judge:
    """`program` is cs2mesh; meshes are left in `folder`."""

    def __init__(self, program, folder, mesher=None, limits=None):
        self.program = program
        self.folder = pathlib.Path(folder)
        self.mesher = mesher
        self.limits = limits or Limits()

    def judge(self, scene, tolerance, topologies=()):
        """A row of the table: a dictionary with `broken`, the list of what does not hold.

        `tolerance` is a word of the command line. `topologies` are the right ones, (outer
        components, voids, genus) each; without any, any is right.
        """
        scene = pathlib.Path(scene)
        row = {"scene": scene.stem, "tolerance": tolerance, "broken": []}
        mesh = self.folder / f"{scene.stem}-{tolerance.rstrip('%')}.obj"
        mesh.unlink(missing_ok=True)
        report = self.mesh(scene, tolerance, mesh, row)
        if report is None:
            return row
        row["mesh"] = str(mesh)
        row["absolute_tolerance"] = report["tolerance"]
        self.check(mesh, topologies, row)
        self.compare(scene, mesh, row)
        return row

    def mesh(self, scene, tolerance, mesh, row):
        command = [self.program, scene, mesh, "--tolerance", tolerance, "--json", "-q"]
        if self.mesher:
            command += ["--mesher", self.mesher]
        done = run_limited(command, self.limits.seconds, self.limits.memory)
        row.update(status=done.status, seconds=done.seconds, work_seconds=done.work)
        row["peak_memory_bytes"] = done.peak
        row["timed_out"] = done.timed_out
        if done.failure():
            row["broken"].append("mesh " + done.failure())
            row["words"] = done.stderr[-2000:]
            return None
        report = json.loads(done.stdout)
        row["triangles"] = report["triangles"]
        row["listed"] = len(report["listed"])
        return report

    def check(self, mesh, topologies, row):
        command = [self.program, "check", mesh, "--json", "-q"]
        done = run_limited(command, self.limits.measure_seconds, self.limits.memory)
        if done.timed_out or done.status not in (0, 4):
            row["broken"].append("check " + done.failure())
            return
        report = json.loads(done.stdout)
        row["outer"] = report["components"] - report["voids"]
        for name in ("closed", "manifold", "oriented", "self_intersections", "voids", "genus"):
            row[name] = report[name]
        for name in ("closed", "manifold", "oriented"):
            if report[name] is not True:
                row["broken"].append("not " + name)
        if report["self_intersections"] != 0:
            row["broken"].append(f"self-intersections: {report['self_intersections']}")
        if done.status == 4 and not row["broken"]:
            row["broken"].append("check " + done.failure())
        topology = (row["outer"], row["voids"], row["genus"])
        if topologies and topology not in [tuple(right) for right in topologies]:
            row["broken"].append(f"components, voids, genus {topology}, expected {topologies}")

    def compare(self, scene, mesh, row):
        command = [self.program, "compare", scene, mesh, "--samples", self.limits.samples]
        command += ["--rays", self.limits.samples // 100, "--no-silhouette", "--json", "-q"]
        done = run_limited(command, self.limits.measure_seconds, self.limits.memory)
        if done.failure():
            row["broken"].append("compare " + done.failure())
            return
        error = json.loads(done.stdout)["error"]
        for way in ("mesh_to_surface", "surface_to_mesh"):
            # An infinite distance (a mesh without a surface) is null in JSON.
            distance = error[f"{way}_max"]
            share = float("inf") if distance is None else distance / row["absolute_tolerance"]
            row[way] = share
            if not share <= 1.0:
                at = ", ".join(f"{x:.9g}" for x in error[f"{way}_at"] or [])
                row["broken"].append(f"{way} {share:.3g} tolerances at ({at})")
