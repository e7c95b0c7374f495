"""Every file in data/bad gives the messages and the status that its .expected file says: a line
`status N`, then what stands on stderr. The program runs in data/bad, quietly, and writes nothing
unless the status is 0."""

from harness import SOURCE, SceneTest, main

BAD = SOURCE / "data" / "bad"


class BadInputs(SceneTest):
    def check(self, expected_path):
        scene = expected_path.with_suffix(".art").name
        first, _, words = expected_path.read_text(encoding="utf-8").partition("\n")
        out = self.folder / "out.obj"
        done = self.run_program(scene, out, "--quiet", cwd=BAD)
        self.assertEqual(f"status {done.returncode}", first, done.stderr)
        self.assertEqual(done.stderr, words)
        self.assertEqual(done.stdout, "")
        self.assertEqual(out.exists(), done.returncode == 0)

    def test_all(self):
        expected = sorted(BAD.glob("*.expected"))
        self.assertTrue(expected)
        for path in expected:
            with self.subTest(path.name):
                self.check(path)


if __name__ == "__main__":
    main()
