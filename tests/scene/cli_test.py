"""Usage, exit statuses, streams and outputs of the program."""

import json
import math
import os

from harness import BALL, SceneTest, main


class Usage(SceneTest):
    def test_without_arguments_it_explains_itself(self):
        self.assertIn("cs2mesh help", self.fails(2).stderr)

    def test_help_of_every_verb_names_its_options(self):
        text = self.succeed("--help").stdout
        for verb in ("mesh", "render", "compare", "report", "check", "probe", "info"):
            page = self.succeed("help", verb).stdout
            for option in ("--help", "--threads", "--quiet", "--progress"):
                self.assertIn(option, page, verb)
            if verb != "mesh":
                self.assertIn(f"cs2mesh {verb}", text)

    def test_help_of_the_language(self):
        self.assertIn("sphere", self.succeed("help", "commands").stdout)
        self.assertTrue(self.succeed("help", "sphere").stdout.startswith("sphere "))
        self.assertIn("did you mean 'sphere'", self.fails(2, "help", "spere").stderr)

    def test_wrong_usage_is_status_2(self):
        scene = self.file("ball.art", BALL)
        for arguments in (
            [scene],
            [scene, "out.xyz"],
            [scene, "out.obj", "--tolerance", "0"],
            [scene, "out.obj", "--tolerance", "fine"],
            [scene, "out.obj", "--cell", "-1"],
            [scene, "out.obj", "--mesher", "none"],
            [scene, "out.obj", "--mesher", "dual", "--cell", "0.1"],
            [scene, "out.obj", "--bounds", 0, 0, 0, 1, 1],
            [scene, "out.obj", "--bounds", 0, 0, 0, 1, 1, 0],
            [scene, "out.obj", "-D", "novalue"],
            [scene, "out.obj", "--threads", 0],
            [scene, "out.obj", "--time-limit", "0"],
            [scene, "out.obj", "--max-memory", "much"],
            [scene, "out.obj", "--max-memory", "0K"],
            ["info"],
            ["info", scene, "--no-such-option"],
        ):
            done = self.fails(2, *arguments)
            self.assertEqual(done.stdout, "", arguments)

    def test_version(self):
        self.assertRegex(self.succeed("--version").stdout, r"^cs2mesh \d+\.\d+\.\d+\n$")


class Inputs(SceneTest):
    def test_what_is_no_scene_is_status_2(self):
        self.fails(2, "missing.art", "out.obj")
        self.fails(2, self.file("empty.art", ""), "out.obj")
        self.fails(2, self.folder, "out.obj")
        (self.folder / "binary.art").write_bytes(bytes(range(256)))
        self.fails(2, "binary.art", "out.obj")

    def test_place_of_an_error(self):
        scene = self.file("bad.art", "surface s radius 1 blobbiness -2\nspere s 1 0 0 0\n")
        self.assertIn(f"{scene}:2:1: error:", self.fails(2, scene, "out.obj").stderr)

    def test_unbounded_surface_is_status_3_unless_bounded(self):
        scene = self.file("slab.art", "surface s radius 0.5 blobbiness -2\nplane s 0 0 0 0 0 1\n")
        self.assertIn(f"{scene}:2:", self.fails(3, scene, "out.obj").stderr)
        self.succeed(scene, "out.obj", "--bounds", -1, -1, -1, 1, 1, 1)
        self.assertTrue(self.report("check", "out.obj")["closed"])

    def test_variables_win_over_the_scene(self):
        scene = self.file("ball.art", "var r = 1\n" + BALL.replace("sphere s 1", "sphere s r"))
        small = self.report(scene, "a.obj", "-D", "r=0.5")
        large = self.report(scene, "b.obj")
        self.assertAlmostEqual(large["volume"] / small["volume"], 8, delta=0.1)


class Meshing(SceneTest):
    def test_a_ball(self):
        scene = self.file("ball.art", BALL)
        outputs = ("ball.obj", "ball.ply", "ball.stl", "ball.glb")
        report = self.report(scene, *outputs, "--tolerance", "0.001")
        self.assertEqual(report["outputs"], ["ball.obj", "ball.ply", "ball.stl", "ball.glb"])
        for key in ("closed", "manifold"):
            self.assertIs(report[key], True)
        self.assertEqual(report["self_intersections"], 0)
        self.assertEqual((report["components"], report["genus"]), (1, 0))
        # Less than a layer as thick as the tolerance, and none beyond the ball.
        layer = report["tolerance"] * 4 * math.pi
        self.assertLess(layer, 0.02)
        self.assertGreater(report["volume"], 4 / 3 * math.pi - layer)
        self.assertLess(report["volume"], 4 / 3 * math.pi)
        self.assertEqual(report["vertices"] - 2, report["triangles"] / 2)
        for key in ("total", "parse", "compile", "export"):
            self.assertGreaterEqual(report["seconds"][key], 0)
        for key in ("value", "gradient", "enclosure"):
            self.assertGreater(report["evaluations"][key], 0)
            counted = sum(stage[key] for stage in report["stages"])
            self.assertEqual(counted, report["evaluations"][key])
        names = [stage["stage"] for stage in report["stages"]]
        for stage in ("parse", "compile", "octree", "remesh", "refine", "export"):
            self.assertIn(stage, names)
        self.assertGreater(report["peak_memory_bytes"], 1 << 20)
        for output in report["outputs"]:
            measured = self.report("check", output)
            self.assertEqual(measured["triangles"], report["triangles"], output)
            self.assertIs(measured["closed"] and measured["manifold"], True, output)

    def test_finer_tolerance_gives_more_triangles_and_keeps_it(self):
        scene = self.file("ball.art", BALL)
        coarse = self.report(scene, "a.obj", "--tolerance", "1%")
        fine = self.report(scene, "b.obj", "--tolerance", "0.001")
        self.assertGreater(fine["triangles"], coarse["triangles"])
        measured = self.report("compare", scene, "b.obj", "--samples", 20000)["error"]
        self.assertLessEqual(measured["mesh_to_surface_max"], 0.001)
        self.assertLessEqual(measured["surface_to_mesh_max"], 0.001)

    def test_every_mesher_of_the_help(self):
        scene = self.file("ball.art", BALL)
        page = self.succeed("help", "mesh").stdout
        for mesher in ("lattice", "dual", "vdb"):
            self.assertIn(f"{mesher}: ", page)
            report = self.report(scene, f"{mesher}.obj", "--mesher", mesher)
            self.assertIs(report["closed"] and report["manifold"], True)
            self.assertLessEqual(report["error"]["mesh_to_surface_max"], report["tolerance"])

    def test_same_bytes_for_any_number_of_threads(self):
        scene = self.file("ball.art", BALL + "sphere s 0.7 1.2 0.3 0.1\n")
        for threads in (1, 2, 3):
            self.succeed(scene, f"{threads}.glb", "--threads", threads, "--tolerance", "0.5%")
        first = (self.folder / "1.glb").read_bytes()
        self.assertEqual(first, (self.folder / "2.glb").read_bytes())
        self.assertEqual(first, (self.folder / "3.glb").read_bytes())

    def test_dry_run_writes_nothing(self):
        scene = self.file("ball.art", BALL)
        report = self.report(scene, "out.obj", "--dry-run")
        self.assertGreater(report["parts"][0]["cell"], 0)
        self.assertFalse((self.folder / "out.obj").exists())

    def test_verify(self):
        scene = self.file("ball.art", BALL)
        report = self.report(scene, "out.obj", "--verify")
        self.assertLessEqual(report["error"]["mesh_to_surface_max"], report["tolerance"])
        plain = self.report(scene, "out.obj")
        self.assertEqual(report["evaluations"], plain["evaluations"])

    def test_certify(self):
        scene = self.file("ball.art", BALL)
        report = self.report(scene, "out.obj", "--certify")
        self.assertEqual(report["certified"], 1)
        self.assertEqual(set(report["uncertified"].values()), {0})
        self.assertEqual(report["listed"], [])

    def test_what_is_not_certified_is_listed_and_drawn(self):
        # A coarse lattice misses the tolerance by far.
        scene = self.file("ball.art", BALL)
        options = ("--cell", "0.3", "--json", "--certificate", "doubts.ply")
        done = self.run_program(scene, "out.obj", *options, "--certify")
        self.assertEqual(done.returncode, 5, done.stderr)
        self.assertFalse((self.folder / "out.obj").exists())
        report = json.loads(done.stdout)
        self.assertLess(report["certified"], 1)
        self.assertGreater(report["uncertified"]["distance"], 0)
        self.assertEqual(report["listed"][0]["reason"], "distance")
        self.assertTrue((self.folder / "doubts.ply").read_bytes().startswith(b"ply"))
        self.succeed(scene, "out.obj", *options)
        self.assertTrue((self.folder / "out.obj").exists())

    def test_a_mesh_that_cannot_be_certified_is_made_finer(self):
        # The tolerance is as large as the small balls, but not with a number of triangles.
        small = "".join(f"sphere s 0.1 <{x} {y} 0>\n" for x in (-0.45, 0.45) for y in (-0.3, 0.3))
        large = "surface s { kernel gaussian blobbiness -6 }\nsphere s 0.5 <0 0 0>\n"
        scene = self.file("balls.art", large + small)
        plain = self.report(scene, "out.obj", "--tolerance", "2%")
        options = ("--tolerance", "2%", "--certificate", "doubts.ply")
        report = self.report(scene, "out.obj", *options)
        self.assertGreater(report["certified"], 0.999)
        self.assertGreaterEqual(report["triangles"], plain["triangles"])
        self.assertLessEqual(report["error"]["mesh_to_surface_max"], report["tolerance"])
        self.assertEqual(report["tolerance"], plain["tolerance"])
        again = self.report(scene, "out.obj", *options, "--max-triangles", 100000)
        self.assertEqual(again["triangles"], plain["triangles"])

    def test_quiet_means_quiet(self):
        scene = self.file("ball.art", BALL)
        done = self.succeed(scene, "out.obj", "--quiet")
        self.assertEqual((done.stdout, done.stderr), ("", ""))

    def test_progress_as_json(self):
        scene = self.file("ball.art", BALL)
        lines = self.succeed(scene, "out.obj", "-q", "--progress", "json").stderr.splitlines()
        self.assertTrue(lines)
        for line in lines:
            entry = json.loads(line)
            self.assertTrue(0 <= entry["fraction"] <= 1 and entry["stage"])


class Outputs(SceneTest):
    def test_all_outputs_or_none(self):
        scene = self.file("ball.art", BALL)
        (self.folder / "folder.stl").mkdir()
        self.fails(7, scene, "good.obj", "folder.stl")
        self.fails(7, scene, "good.obj", "no/such/folder/out.stl")

    def test_former_file_survives_a_failure(self):
        scene = self.file("ball.art", BALL)
        self.file("out.obj", "former")
        self.fails(7, scene, "out.obj", "missing/out.stl")
        self.assertEqual((self.folder / "out.obj").read_text(), "former")

    def test_full_disk(self):
        scene = self.file("ball.art", BALL)
        os.symlink("/dev/full", self.folder / "full.stl")
        self.fails(7, scene, "full.stl")

    def test_interrupt_leaves_nothing(self):
        scene = self.file("ball.art", BALL)
        self.interrupted(scene, "out.obj", "--tolerance", "0.00003", "-q")


class Limits(SceneTest):
    def test_time(self):
        scene = self.file("ball.art", BALL)
        done = self.fails(6, scene, "out.obj", "--tolerance", "0.00003", "--time-limit", "0.3")
        self.assertRegex(done.stderr, r"the time limit of 0\.3 s was reached in stage '[\w ]+'")
        self.succeed(scene, "out.obj", "--time-limit", "300")

    def test_memory(self):
        scene = self.file("ball.art", BALL)
        done = self.fails(6, scene, "out.obj", "--tolerance", "0.00001", "--max-memory", "250M")
        self.assertRegex(done.stderr, r"more memory than 250 MiB would be needed in stage '[\w ]+'")
        self.succeed(scene, "out.obj", "--max-memory", "64G")

    def test_a_limit_that_nothing_fits_in(self):
        scene = self.file("ball.art", BALL)
        self.fails(6, scene, "out.obj", "--time-limit", "1e-9")
        self.fails(6, scene, "out.obj", "--max-memory", "1")


class Probe(SceneTest):
    def test_value_on_the_surface_is_one(self):
        scene = self.file("ball.art", BALL)
        done = self.succeed("probe", scene, "-", stdin="1 0 0\n\n# a comment\n0 -1 0\n")
        lines = [[float(word) for word in line.split()] for line in done.stdout.splitlines()]
        self.assertEqual(len(lines), 2)
        for value, *_ in lines:
            self.assertAlmostEqual(value, 1, delta=1e-12)
        self.assertLess(lines[0][1], 0)
        self.assertGreater(lines[1][2], 0)

    def test_digits_are_enough(self):
        scene = self.file("ball.art", BALL)
        for word in self.succeed("probe", scene, "-", stdin="0.3 0.2 0.1\n").stdout.split():
            self.assertEqual(f"{float(word):.17g}", word)

    def test_inside(self):
        scene = self.file("ball.art", BALL)
        done = self.succeed("probe", scene, "-", "--inside", stdin="0 0 0.9\n0 0 1.1\n")
        self.assertEqual(done.stdout.split(), ["1", "0"])

    def test_bad_points(self):
        scene = self.file("ball.art", BALL)
        points = self.file("points.txt", "0 0 0\n0 0\n")
        self.assertIn("points.txt:2:", self.fails(2, "probe", scene, points).stderr)
        for text in ("1 2 nan\n", "1 2 3 4\n", "a b c\n", "1 2 1e999\n"):
            done = self.fails(2, "probe", scene, "-", stdin=text)
            self.assertIn("standard input:1:", done.stderr)
        self.fails(2, "probe", scene, "missing.txt")

    def test_groups(self):
        scene = self.file(
            "groups.art",
            BALL + "object o\nblend left\nsphere s 1 5 0 0\nclose\n",
        )
        at = "5 0 1\n"
        done = self.succeed("probe", scene, "-", "--group", "left", stdin=at)
        self.assertAlmostEqual(float(done.stdout.split()[0]), 1, delta=1e-12)
        self.assertIn("left", self.fails(2, "probe", scene, "-", "--group", "right").stderr)


class Others(SceneTest):
    def test_info(self):
        scene = self.file("ball.art", BALL)
        report = self.report("info", scene)
        self.assertEqual((report["primitives"], report["soft"], report["hard"]), (1, 1, 0))
        self.assertEqual(report["kinds"], {"sphere": 1})
        self.assertEqual(report["kernels"], {"cauchy": 1})
        for low, high in zip(report["extent"]["min"], report["extent"]["max"]):
            self.assertAlmostEqual(low, -1, delta=1e-9)
            self.assertAlmostEqual(high, 1, delta=1e-9)

    def test_info_needs_no_bounds(self):
        scene = self.file("slab.art", "surface s radius 0.5 blobbiness -2\nplane s 0 0 0 0 0 1\n")
        self.assertIs(self.report("info", scene)["parts"][0]["bounded"], False)

    def test_check_finds_a_hole(self):
        corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
        mesh = self.file("open.obj", corners + "f 1 3 2\nf 1 2 4\nf 1 4 3\n")
        done = self.run_program("check", mesh, "--json")
        self.assertEqual(done.returncode, 4, done.stderr)
        self.assertIs(json.loads(done.stdout)["closed"], False)

    def test_check_of_what_is_no_mesh(self):
        self.fails(2, "check", "missing.obj")
        self.fails(2, "check", self.file("bad.obj", "f 1 2 3\n"))

    def test_compare_sees_a_shifted_mesh(self):
        scene = self.file("ball.art", BALL)
        moved = self.file("moved.art", BALL.replace("0 0 0", "0.05 0 0"))
        self.succeed(moved, "moved.obj")
        error = self.report("compare", scene, "moved.obj", "--samples", 5000)["error"]
        self.assertAlmostEqual(error["mesh_to_surface_max"], 0.05, delta=0.005)
        self.assertAlmostEqual(error["surface_to_mesh_max"], 0.05, delta=0.005)

    def test_render(self):
        scene = self.file("ball.art", BALL)
        self.succeed("render", scene, "ball.png", "--size", 40, 30)
        data = (self.folder / "ball.png").read_bytes()
        self.assertEqual(data[:8], b"\x89PNG\r\n\x1a\n")
        size = [int.from_bytes(data[at : at + 4], "big") for at in (16, 20)]
        self.assertEqual(size, [40, 30])

    def test_render_a_mesh(self):
        scene = self.file("ball.art", BALL)
        self.succeed(scene, "ball.ply", "--tolerance", "1%")
        self.succeed("render", scene, "mesh.png", "--mesh", "ball.ply", "--size", 40, 30)
        self.assertGreater((self.folder / "mesh.png").stat().st_size, 500)
        self.fails(2, "render", scene, "m.png", "--mesh", "ball.ply", "--depth", "d.pfm")


if __name__ == "__main__":
    main()
