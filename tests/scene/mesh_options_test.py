"""Options that concern the mesh as a whole: what is left out of it, how large it may be."""

from harness import SceneTest, main

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


if __name__ == "__main__":
    main()
