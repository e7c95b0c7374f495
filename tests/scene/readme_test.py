"""Runs what the README shows: every block ```sh that calls cs2mesh, as it stands."""

import os
import re
import shutil
import subprocess

from harness import PROGRAM, SOURCE, SceneTest, main


class Readme(SceneTest):
    def test_examples_run(self):
        text = (SOURCE / "README.md").read_text(encoding="utf-8")
        blocks = [b for b in re.findall(r"^```sh\n(.*?)^```", text, re.M | re.S) if "cs2mesh " in b]
        self.assertTrue(blocks)
        shutil.copytree(SOURCE / "data" / "scenes", self.folder / "data" / "scenes")
        path = os.path.dirname(PROGRAM) + os.pathsep + os.environ["PATH"]
        # In order: later examples may use what earlier ones made.
        for block in blocks:
            done = subprocess.run(
                ["bash", "-euo", "pipefail", "-c", block],
                cwd=self.folder,
                env={**os.environ, "PATH": path},
                capture_output=True,
                text=True,
                timeout=600,
            )
            self.assertEqual(done.returncode, 0, f"{block}\n{done.stdout}{done.stderr}")


if __name__ == "__main__":
    main()
