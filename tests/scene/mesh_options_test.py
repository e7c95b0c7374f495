"""Options that concern the mesh as a whole: what is left out of it, how large it may be."""

from harness import BALL, SceneTest, main

# A ball with a hollow, and a grain beside it.
HOLLOW = """surface s { kernel cauchy radius 1 blobbiness -2 }
surface hollow { kernel gaussian radius 0.4 blobbiness -4 strength -6 }
surface grain { kernel cauchy radius 0.1 blobbiness -2 }
sphere s 1 0 0 0
sphere hollow 0.4 0 0 0
sphere grain 0.1 2 0 0
"""
# And a hard ball that the soft shell has, touching nothing.
KERNEL = HOLLOW + "surface hard { diffuse Red }\nsphere hard 0.2 0 0 0\n"

THORNS = """surface s0 blob -128, radius .034 strength 2
surface s1 blob -16, radius .125
cylinder s1 0.125 <-1 0 0> <1 0 0>
cylinder s0 0.034 <-0.5 0 0> <-0.6 0.75 0.1>
cylinder s0 0.034 <0.1 0 0> <0.15 0.75 0.2>
cylinder s0 0.034 <0.5 0 0> <0.6 -0.3 0.7>
"""


class LeftOut(SceneTest):
    def mesh(self, text, *options):
        scene = self.file("scene.art", text)
        report = self.report(scene, "out.obj", "out.glb", "--tolerance", "1%", *options)
        for output in ("out.obj", "out.glb"):
            checked = self.report("check", output)
            self.assertIs(checked["closed"] and checked["manifold"], True)
            self.assertEqual(checked["triangles"], report["triangles"])
        return report

    def numbers(self, report):
        return report["components"], report["voids"]

    def test_voids_are_surface_unless_they_are_left_out(self):
        whole = self.mesh(HOLLOW)
        self.assertEqual(self.numbers(whole), (3, 1))
        self.assertNotIn("left_out", whole)
        outer = self.mesh(HOLLOW, "--outer", "--verify")
        self.assertEqual(self.numbers(outer), (2, 0))
        enclosed = outer["left_out"]["enclosed"]
        self.assertEqual((enclosed["components"], enclosed["voids"]), (1, 1))
        self.assertAlmostEqual(outer["area"] + enclosed["area"], whole["area"], delta=1e-9)
        self.assertGreater(outer["volume"], whole["volume"])
        self.assertLessEqual(outer["error"]["surface_to_mesh_max"], outer["tolerance"])

    def test_small_components(self):
        whole = self.mesh(HOLLOW)
        report = self.mesh(HOLLOW, "--component-min", "0.5")
        self.assertEqual(self.numbers(report), (2, 1))
        small = report["left_out"]["small"]
        self.assertEqual((small["components"], small["voids"]), (1, 0))
        self.assertAlmostEqual(report["area"] + small["area"], whole["area"], delta=1e-9)
        self.assertEqual(self.numbers(self.mesh(HOLLOW, "--component-min", "0.01%")), (3, 1))
        scene = self.file("scene.art", HOLLOW)
        self.fails(2, scene, "none.obj", "--component-min", "100")
        self.fails(2, scene, "none.obj", "--component-min", "0")

    def test_a_part_in_a_hollow_goes_with_it(self):
        self.assertEqual(self.numbers(self.mesh(KERNEL)), (4, 1))
        report = self.mesh(KERNEL, "--outer", "--verify")
        self.assertEqual(self.numbers(report), (2, 0))
        self.assertEqual(len(report["parts"]), 1)
        # Parts that may intersect are looked at one by one.
        report = self.mesh(KERNEL, "--outer", "--parts", "separate")
        self.assertEqual(self.numbers(report), (3, 0))

    def test_it_is_said(self):
        scene = self.file("scene.art", HOLLOW)
        done = self.succeed(scene, "out.obj", "--tolerance", "1%", "--outer")
        self.assertIn("left out: 1 enclosed component (1 void)", done.stderr)
        done = self.succeed(scene, "out.obj", "--tolerance", "1%")
        self.assertIn("3 components (1 void)", done.stderr)


class Levels(SceneTest):
    def test_levels_are_meshes_at_four_times_the_tolerance(self):
        scene = self.file("scene.art", HOLLOW)
        report = self.report(scene, "out.glb", "out.obj", "--tolerance", "0.01", "--lod", 2)
        self.assertEqual(report["outputs"], ["out.glb", "out.obj"])
        levels = [report, *report["levels"]]
        self.assertEqual(len(levels), 3)
        for number, level in enumerate(levels):
            suffix = f".lod{number}" if number else ""
            self.assertEqual(level["outputs"], [f"out{suffix}.glb", f"out{suffix}.obj"])
            self.assertEqual(level["tolerance"], 0.01 * 4**number)
            for way in ("mesh_to_surface_max", "surface_to_mesh_max"):
                self.assertLessEqual(level["error"][way], level["tolerance"])
            self.assertIs(level["closed"] and level["manifold"], True)
            # The same as without levels.
            alone = self.report(scene, "alone.glb", "--tolerance", level["tolerance"])
            self.assertEqual(alone["triangles"], level["triangles"])
            written = (self.folder / level["outputs"][0]).read_bytes()
            self.assertEqual(written, (self.folder / "alone.glb").read_bytes())
            self.assertTrue((self.folder / f"out{suffix}.mtl").exists())
        self.assertLess(report["levels"][0]["triangles"], report["triangles"])

    def test_all_levels_or_none(self):
        scene = self.file("scene.art", HOLLOW)
        (self.folder / "out.lod2.obj").mkdir()
        self.fails(7, scene, "out.obj", "--tolerance", "1%", "--lod", 2)
        self.succeed(scene, "out.obj", "--tolerance", "1%", "--lod", 1)

    def test_files_that_would_be_one(self):
        scene = self.file("scene.art", HOLLOW)
        self.fails(2, scene, "out.obj", "out.lod1.obj", "--lod", 1)
        self.fails(2, scene, "out.obj", self.folder / "out.lod1.obj", "--lod", 1)
        self.fails(2, scene, "out.obj", "--lod", 1, "--report", "out.lod1.obj")
        self.succeed(scene, "out.obj", "out.lod1.obj", "--tolerance", "1%")

    def test_levels_need_a_tolerance(self):
        scene = self.file("scene.art", "mesh cell 0.3\n" + HOLLOW)
        self.fails(2, scene, "out.obj", "--lod", 1, "--cell", "0.3")
        for number in (0, -1, 9, "all"):
            self.fails(2, scene, "out.obj", "--lod", number)
        self.assertIsNone(self.report(scene, "out.obj")["tolerance"])
        report = self.report(scene, "out.obj", "--lod", 1)
        self.assertEqual(report["levels"][0]["tolerance"], 4 * report["tolerance"])

    def test_what_is_left_out_is_left_out_of_every_level(self):
        scene = self.file("scene.art", HOLLOW)
        report = self.report(scene, "out.stl", "--tolerance", "1%", "--lod", 1, "--outer")
        for level in (report, *report["levels"]):
            self.assertEqual((level["components"], level["voids"]), (2, 0))
            self.assertEqual(level["left_out"]["enclosed"]["components"], 1)


class MostTriangles(SceneTest):
    def mesh(self, *options):
        scene = self.file("scene.art", HOLLOW)
        report = self.report(scene, "out.glb", *options)
        self.assertEqual(self.report("check", "out.glb")["triangles"], report["triangles"])
        return report

    def test_the_tolerance_gives_way(self):
        for most in (200, 1000, 2500):
            report = self.mesh("--tolerance", "0.004", "--max-triangles", most, "--verify")
            self.assertLessEqual(report["triangles"], most)
            self.assertGreaterEqual(report["triangles"], 0.85 * most)
            self.assertEqual(report["tolerance_asked"], 0.004)
            self.assertGreater(report["tolerance"], 0.004)
            for way in ("mesh_to_surface_max", "surface_to_mesh_max"):
                self.assertLessEqual(report["error"][way], report["tolerance"])
            # As if that tolerance had been asked for.
            written = (self.folder / "out.glb").read_bytes()
            alone = self.mesh("--tolerance", repr(report["tolerance"]))
            self.assertEqual(alone["triangles"], report["triangles"])
            self.assertEqual(written, (self.folder / "out.glb").read_bytes())

    def test_no_finer_than_asked_for(self):
        report = self.mesh("--tolerance", "0.02", "--max-triangles", 100000)
        self.assertEqual(report["tolerance"], 0.02)
        self.assertEqual(report["tolerance_asked"], 0.02)
        self.assertLess(report["triangles"], 2000)

    def test_too_few_for_any_tolerance(self):
        scene = self.file("scene.art", HOLLOW)
        done = self.fails(6, scene, "none.glb", "--max-triangles", 30)
        self.assertRegex(done.stderr, r"\d+ triangles, more than the 30 of --max-triangles")
        # Of what is left out no triangle counts.
        report = self.mesh("--max-triangles", 80, "--outer", "--component-min", "0.5")
        self.assertLessEqual(report["triangles"], 80)

    def test_usage(self):
        scene = self.file("scene.art", HOLLOW)
        for number in (0, 3, -5, "few", "1e3.5"):
            self.fails(2, scene, "none.glb", "--max-triangles", number)
        self.fails(2, scene, "none.glb", "--max-triangles", 100, "--cell", "0.1")

    def test_levels_go_on_from_there(self):
        report = self.mesh("--max-triangles", 1000, "--lod", 1, "--threads", 1)
        level = report["levels"][0]
        self.assertEqual(level["tolerance"], 4 * report["tolerance"])
        self.assertLess(level["triangles"], report["triangles"])
        written = (self.folder / "out.lod1.glb").read_bytes()
        self.mesh("--max-triangles", 1000, "--lod", 1, "--threads", 2)
        self.assertEqual(written, (self.folder / "out.lod1.glb").read_bytes())

    def test_certified_all_the_same(self):
        scene = self.file("ball.art", BALL)
        report = self.report(scene, "ball.obj", "--max-triangles", 500, "--certify")
        self.assertEqual(report["certified"], 1)
        self.assertGreater(report["certificate_time_share"], 0)
        self.assertLess(report["certificate_time_share"], 1)
        names = [stage["stage"] for stage in report["stages"]]
        for stage in ("topology", "certify"):
            self.assertIn(stage, names)
        plain = self.report(scene, "ball.obj", "--max-triangles", 500)
        self.assertNotIn("certificate_time_share", plain)
        self.assertLessEqual(report["triangles"], 500)


class Features(SceneTest):
    # Two balls with a gap of 0.06 between them.
    GAP = """surface s { kernel gaussian radius 1 blobbiness -8 }
sphere s 1 -1.03 0 0
sphere s 1 1.03 0 0
"""

    def mesh(self, *options):
        return self.report(self.file("gap.art", self.GAP), "out.obj", "--verify", *options)

    def test_what_may_be_lost_is_counted(self):
        self.assertNotIn("unresolved_cells", self.mesh())
        # Cells are cut until there is nothing left that could be lost.
        fine = self.mesh("--min-feature", "0.001")
        self.assertEqual(fine["unresolved_cells"], 0)
        coarse = self.mesh("--min-feature", "0.05")
        self.assertGreater(coarse["unresolved_cells"], 0)
        for report in (fine, coarse):
            self.assertIs(report["closed"] and report["manifold"], True)
            self.assertLessEqual(report["error"]["mesh_to_surface_max"], report["tolerance"])
            self.assertLessEqual(report["error"]["surface_to_mesh_max"], report["tolerance"])

    def test_large_features_do_not_cost_the_tolerance(self):
        for feature in ("0.3", "10"):
            report = self.mesh("--min-feature", feature)
            self.assertLessEqual(report["error"]["surface_to_mesh_max"], report["tolerance"])

    def test_it_is_for_the_mesher_that_proves(self):
        scene = self.file("gap.art", self.GAP)
        self.fails(2, scene, "none.obj", "--min-feature", "0.1", "--mesher", "lattice")
        self.fails(2, scene, "none.obj", "--min-feature", "0.1", "--cell", "0.1")


class Verified(SceneTest):
    def test_what_is_written_is_within_the_tolerance(self):
        # Stiff thorns as thick as the tolerance are the hardest to be sure of.
        scene = self.file("thorns.art", THORNS)
        for tolerance in (0.0227, 0.03):
            report = self.report(
                scene, "out.glb", "out.ply", "--verify", "--tolerance", tolerance
            )
            self.assertEqual(report["tolerance"], tolerance)
            for output in report["outputs"]:
                error = self.report("compare", scene, output, "--samples", 100000)["error"]
                for way in ("mesh_to_surface_max", "surface_to_mesh_max"):
                    # Other samples than those of --verify.
                    self.assertLessEqual(error[way], 1.02 * tolerance)

    def test_cells_are_as_large_as_they_are(self):
        scene = self.file("scene.art", HOLLOW)
        done = self.fails(5, scene, "out.obj", "--verify", "--cell", "0.3", "--tolerance", "0.001")
        self.assertNotIn("again", done.stderr)


if __name__ == "__main__":
    main()
