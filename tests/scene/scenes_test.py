"""Cowrie and seahorse at the default tolerance, and every scene in data/scenes."""

import math
import pathlib
import shutil
import subprocess

from harness import SCENES, SOURCE, SceneTest, glb_json, main

VALIDATOR = SOURCE / "build" / "gltf-validator" / "node_modules" / "gltf-validator"
VALIDATE = """
const validator = require(process.argv[1]);
const bytes = new Uint8Array(require('fs').readFileSync(process.argv[2]));
validator.validateBytes(bytes).then(report => {
  const found = report.issues.numErrors + report.issues.numWarnings;
  if (found) console.log(JSON.stringify(report.issues, null, 1));
  process.exit(found ? 1 : 0);
}, error => { console.log(error); process.exit(2); });
"""


class Thesis(SceneTest):
    def mesh_and_measure(self, name, parts):
        scene = SCENES / name
        report = self.report(scene, "out.obj", "out.glb")
        self.assertIs(report["closed"] and report["manifold"], True)
        self.assertEqual(report["self_intersections"], 0)
        self.assertEqual(len(report["parts"]), parts)
        for output in ("out.obj", "out.glb"):
            error = self.report("compare", scene, output, "--samples", 100000)["error"]
            self.assertLessEqual(error["mesh_to_surface_max"], report["tolerance"], output)
            self.assertLessEqual(error["surface_to_mesh_max"], report["tolerance"], output)
        return report

    def test_cowrie(self):
        self.mesh_and_measure("cowrie.art", 1)

    def test_seahorse(self):
        # The two eyes meet, and become one part; they do not touch the head.
        report = self.mesh_and_measure("seahorse.art", 2)
        self.assertEqual(report["components"], 2)
        self.assertEqual([len(part["united"]) for part in report["parts"]], [0, 2])

    def test_same_bytes_for_any_number_of_threads(self):
        for threads in (1, 2):
            options = ("--threads", threads, "--tolerance", "0.4%")
            self.succeed(SCENES / "seahorse.art", f"{threads}.glb", *options)
        self.assertEqual(
            (self.folder / "1.glb").read_bytes(), (self.folder / "2.glb").read_bytes()
        )
        self.assertEqual(len(glb_json(self.folder / "1.glb")["meshes"]), 2)

    def test_glb_is_clean_in_the_khronos_validator(self):
        """Runs where node and the validator are set up, as .ci/run does."""
        self.succeed(SCENES / "seahorse.art", "horse.glb", "--tolerance", "0.5%")
        if VALIDATOR.is_dir() and shutil.which("node"):
            done = subprocess.run(
                ["node", "-e", VALIDATE, VALIDATOR, self.folder / "horse.glb"],
                capture_output=True,
                text=True,
                timeout=300,
            )
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


class SmallScenes(SceneTest):
    def test_every_scene_is_meshed(self):
        scenes = sorted(SCENES.glob("*.art"))
        self.assertTrue(scenes)
        for scene in scenes:
            if scene.stem in ("cowrie", "seahorse"):
                continue
            with self.subTest(scene.name):
                report = self.report(scene, "out.glb", "--tolerance", "0.5%")
                self.assertIs(report["closed"] and report["manifold"], True)
                self.assertEqual(report["self_intersections"], 0)
                self.assertGreater(report["volume"], 0)
                pathlib.Path(self.folder / "out.glb").unlink()


    def test_tapered_bones_are_meshed_within_the_tolerance(self):
        scene = SCENES / "taper.art"
        report = self.report(scene, "out.obj", "--tolerance", "0.5%")
        self.assertEqual(report["components"], 1)
        error = self.report("compare", scene, "out.obj", "--samples", 20000)["error"]
        self.assertLessEqual(error["mesh_to_surface_max"], report["tolerance"])
        self.assertLessEqual(error["surface_to_mesh_max"], report["tolerance"])


class Creases(SceneTest):
    def united(self, scene, *options):
        report = self.report(scene, "out.obj", "out.glb", "out.stl", *options)
        self.assertIs(report["closed"] and report["manifold"], True)
        self.assertEqual(report["self_intersections"], 0)
        for output in ("out.obj", "out.glb", "out.stl"):
            checked = self.report("check", output)
            self.assertIs(checked["closed"] and checked["manifold"], True, output)
            self.assertEqual(checked["self_intersections"], 0, output)
            error = self.report("compare", scene, output, "--samples", 50000)["error"]
            self.assertLessEqual(error["mesh_to_surface_max"], report["tolerance"], output)
            self.assertLessEqual(error["surface_to_mesh_max"], report["tolerance"], output)
        return report

    def test_soft_parts_and_solids_become_one_body(self):
        report = self.united(SCENES / "creases.art", "--tolerance", "0.3%", "--verify")
        self.assertEqual(report["components"], 1)
        self.assertEqual(len(report["parts"][0]["united"]), 4)
        self.assertEqual(report["swallowed"], [])
        self.assertIn("usemtl", (self.folder / "out.obj").read_text())

    def test_same_bytes_for_any_number_of_threads(self):
        for threads in (1, 2):
            options = ("--threads", threads, "--tolerance", "0.5%")
            self.succeed(SCENES / "creases.art", f"{threads}.glb", *options)
        self.assertEqual(
            (self.folder / "1.glb").read_bytes(), (self.folder / "2.glb").read_bytes()
        )

    def test_parts_may_stay_separate(self):
        scene = SCENES / "creases.art"
        report = self.report(scene, "out.obj", "--tolerance", "0.5%", "--parts", "separate")
        self.assertEqual(len(report["parts"]), 4)
        self.assertNotIn("swallowed", report)

    def test_volume_and_genus_of_known_unions(self):
        balls = self.file(
            "balls.art",
            "surface s { diffuse Red }\nsphere s 1 0 0 0\nsphere s 1 1 0 0\nsphere s 0.3 0 0 0\n",
        )
        report = self.united(balls, "--tolerance", "0.1%")
        lens = math.pi * (4 + 1) * (2 - 1) ** 2 / 12
        self.assertAlmostEqual(report["volume"], 8 * math.pi / 3 - lens, delta=0.05)
        self.assertEqual(report["genus"], 0)
        self.assertEqual(report["swallowed"], ["sphere 4"])
        bead = self.file(
            "bead.art",
            "surface s { diffuse Red }\ntorus s 1 0.25 0 0 0, 0 0 1\nsphere s 0.5 1 0 0\n",
        )
        self.assertEqual(self.united(bead)["genus"], 1)


if __name__ == "__main__":
    main()
