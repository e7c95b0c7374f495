"""What the end-to-end tests share. The program is $CS2MESH, the sources are $CS2MESH_SOURCE."""

import json
import os
import pathlib
import signal
import struct
import subprocess
import tempfile
import time
import unittest

PROGRAM = os.environ["CS2MESH"]
SOURCE = pathlib.Path(os.environ["CS2MESH_SOURCE"])
SCENES = SOURCE / "data" / "scenes"

BALL = "surface s { kernel cauchy radius 1 blobbiness -2 }\nsphere s 1 0 0 0\n"


class SceneTest(unittest.TestCase):
    """Each test has an empty folder, in which the program runs."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="cs2mesh-test-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def file(self, name, text):
        path = self.folder / name
        path.write_text(text, encoding="utf-8")
        return name

    def run_program(self, *arguments, stdin="", cwd=None, timeout=600):
        return subprocess.run(
            [PROGRAM, *map(str, arguments)],
            cwd=cwd or self.folder,
            input=stdin,
            capture_output=True,
            text=True,
            timeout=timeout,
        )

    def succeed(self, *arguments, **options):
        done = self.run_program(*arguments, **options)
        self.assertEqual(done.returncode, 0, f"{arguments}\n{done.stdout}{done.stderr}")
        return done

    def fails(self, status, *arguments, **options):
        """Runs, expects the status and a message, and that nothing new lies in the folder."""
        before = sorted(self.folder.rglob("*"))
        done = self.run_program(*arguments, **options)
        self.assertEqual(done.returncode, status, f"{arguments}\n{done.stdout}{done.stderr}")
        self.assertTrue(done.stderr.strip(), "no word about the failure")
        self.assertEqual(sorted(self.folder.rglob("*")), before)
        return done

    def interrupted(self, *arguments):
        """Runs, presses Ctrl-C at work, expects status 130 and that nothing new lies there."""
        before = sorted(self.folder.rglob("*"))
        process = subprocess.Popen(
            [PROGRAM, *map(str, arguments)], cwd=self.folder, stderr=subprocess.PIPE
        )
        deadline = time.monotonic() + 60
        while not catches(process.pid, signal.SIGINT) and time.monotonic() < deadline:
            time.sleep(0.01)
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        _, words = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 130, words)
        self.assertEqual(sorted(self.folder.rglob("*")), before)

    def report(self, *arguments, **options):
        return json.loads(self.succeed(*arguments, "--json", **options).stdout)


def catches(process, number):
    """Whether the running process has set up a handler of the signal (Linux)."""
    status = pathlib.Path(f"/proc/{process}/status").read_text(encoding="ascii")
    caught = next(line for line in status.splitlines() if line.startswith("SigCgt:"))
    return int(caught.split()[1], 16) >> (number - 1) & 1 == 1


def glb_json(path):
    """The JSON chunk of a GLB file."""
    data = pathlib.Path(path).read_bytes()
    magic, version, length = struct.unpack_from("<4sII", data)
    assert (magic, version, length) == (b"glTF", 2, len(data))
    size, kind = struct.unpack_from("<I4s", data, 12)
    assert kind == b"JSON"
    return json.loads(data[20 : 20 + size])


def main():
    unittest.main(verbosity=1)
