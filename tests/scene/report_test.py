"""`cs2mesh report`: numbers, pictures, and the page in a real browser where there is one."""

import base64
import csv
import html.parser
import json
import os
import re
import shutil
import struct
import subprocess
import unittest
import zlib

from harness import BALL, SceneTest, main

BROWSERS = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")
FAST = ("--tolerances", "4%,2%,1%", "--samples", 2000, "--size", 64)


class Page(html.parser.HTMLParser):
    """What the tests look at: cells of the table of runs, images, addresses, tags."""

    def __init__(self, text):
        super().__init__()
        self.rows, self.images, self.addresses, self.tags = [], [], [], set()
        self.words, self.cell = "", None
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.tags.add(tag)
        for name in ("src", "href", "action", "data", "srcset", "poster"):
            if name in attributes:
                self.addresses.append(attributes[name])
        if tag == "img":
            self.images.append(attributes)
        if tag == "td" and "data-column" in attributes:
            if attributes["data-column"] == "mesher":
                self.rows.append({})
            self.cell = {"value": attributes.get("data-value"), "text": ""}
            self.rows[-1][attributes["data-column"]] = self.cell

    def handle_endtag(self, tag):
        if tag == "td":
            self.cell = None

    def handle_data(self, text):
        self.words += text
        if self.cell is not None:
            self.cell["text"] += text


def content(address):
    """Media type and bytes of a data URI."""
    kind, data = re.fullmatch(r"data:([a-z/+]+);base64,([A-Za-z0-9+/=]+)", address).groups()
    return kind, base64.b64decode(data, validate=True)


def pixels(png):
    """Width, height and the rows of 8-bit samples of a PNG without interlacing."""
    assert png[:8] == b"\x89PNG\r\n\x1a\n"
    at, data, header = 8, b"", None
    while at < len(png):
        size, kind = struct.unpack_from(">I4s", png, at)
        body = png[at + 8 : at + 8 + size]
        assert zlib.crc32(kind + body) == struct.unpack_from(">I", png, at + 8 + size)[0]
        header = struct.unpack(">IIBBBBB", body) if kind == b"IHDR" else header
        data += body if kind == b"IDAT" else b""
        at += size + 12
    width, height, depth, color = header[:4]
    assert depth == 8 and color in (2, 6)
    step = 3 if color == 2 else 4
    return width, height, unfiltered(zlib.decompress(data), width * step, height, step)


def unfiltered(data, length, height, step):
    rows, before = [], bytearray(length)
    for y in range(height):
        kind = data[y * (length + 1)]
        row = bytearray(data[y * (length + 1) + 1 : (y + 1) * (length + 1)])
        for i in range(length):
            left = row[i - step] if i >= step else 0
            corner = before[i - step] if i >= step else 0
            above = before[i]
            nearest = min((left, above, corner), key=lambda v: abs(left + above - corner - v))
            row[i] = (row[i] + (0, left, above, (left + above) // 2, nearest)[kind]) & 255
        rows.append(bytes(row))
        before = row
    return rows


def value_of(run, name):
    """What the CSV calls `name`, from the JSON of a run."""
    error = run["error"] or {}
    return {
        "tolerance": run["tolerance"],
        "seconds": run["seconds"]["mesh"],
        "triangles": run["triangles"],
        "value_evaluations": run["evaluations"]["value"],
        "gradient_evaluations": run["evaluations"]["gradient"],
        "peak_memory_bytes": run["peak_memory_bytes"],
        **{key: error.get(key) for key in ("max", "rms", "p999", "normal_deg_max", "spread")},
    }[name]


NUMBERS = ("tolerance", "seconds", "triangles", "value_evaluations", "gradient_evaluations",
           "peak_memory_bytes", "max", "rms", "p999", "normal_deg_max", "spread")


class Report(SceneTest):
    def make(self, *options, scene=BALL):
        name = self.file("ball.art", scene)
        report = self.report("report", name, "out.html", *FAST, *options)
        return report, Page((self.folder / "out.html").read_text(encoding="utf-8"))

    def test_the_table_has_the_numbers_of_the_json(self):
        report, page = self.make("--csv", "out.csv")
        self.assertEqual(len(report["runs"]), 3 * len(report["meshers"]))
        self.assertEqual(len(page.rows), len(report["runs"]))
        with open(self.folder / "out.csv", encoding="utf-8", newline="") as table:
            lines = list(csv.DictReader(table))
        self.assertEqual(len(lines), len(report["runs"]))
        for run, row, line in zip(report["runs"], page.rows, lines):
            self.assertEqual(row["mesher"]["text"], run["mesher"])
            self.assertEqual(row["outcome"]["text"], run["outcome"])
            self.assertEqual(line["outcome"], run["outcome"])
            for name in NUMBERS:
                value = value_of(run, name)
                told = row[name]["value"]
                self.assertEqual(None if told is None else json.loads(told), value, name)
                self.assertEqual(float(line[name]) if line[name] else None, value, name)
                if value is not None and name not in ("peak_memory_bytes",):
                    self.assertAlmostEqual(float(row[name]["text"]), value, delta=0.006 * value)

    def test_finer_tolerances_make_finer_meshes(self):
        report, _ = self.make()
        for mesher in report["meshers"]:
            runs = [run for run in report["runs"] if run["mesher"] == mesher]
            self.assertEqual([run["tolerance_share"] for run in runs], [0.04, 0.02, 0.01])
            for run in runs:
                self.assertIn(run["outcome"], ("reached", "missed"), run)
                if run["outcome"] == "reached":
                    self.assertLessEqual(run["error"]["max"], run["tolerance"])
                self.assertGreater(run["error"]["max"], report["reference"]["uncertainty"])
        self.assertTrue(any(run["pareto"]["triangles"] for run in report["runs"]))
        self.assertTrue(any(run["pareto"]["seconds"] for run in report["runs"]))

    def test_the_page_needs_nothing_else(self):
        _, page = self.make()
        self.assertFalse(page.tags & {"script", "link", "iframe", "object", "embed", "base"})
        for address in page.addresses:
            self.assertTrue(address.startswith("data:"), address[:80])
        text = (self.folder / "out.html").read_text(encoding="utf-8")
        self.assertNotRegex(re.sub(r"base64,[A-Za-z0-9+/=]+", "", text), r"https?:|url\(|@import")

    def test_every_picture_decodes(self):
        report, page = self.make()
        kinds = []
        for image in page.images:
            self.assertTrue(image["alt"])
            kind, data = content(image["src"])
            kinds.append(kind)
            if kind == "image/png":
                width, height, rows = pixels(data)
                self.assertIn((width, height), ((64, 64), (256, 1)))
                self.assertGreater(len(set(b"".join(rows))), 10)
            else:
                self.assertEqual(kind, "image/svg+xml")
                self.assertIn(b"</svg>", data)
                self.assertNotRegex(data, rb"<script|<image|href=.http")
        self.assertEqual(kinds.count("image/svg+xml"), report["plots"])
        self.assertEqual(kinds.count("image/png"), 2 + 2 * len(report["runs"]))
        self.assertEqual(report["plots"], 2 if shutil.which("gnuplot") else 0)

    def test_without_gnuplot_the_tables_still_come(self):
        name = self.file("ball.art", BALL)
        path = os.environ["PATH"]
        self.addCleanup(os.environ.__setitem__, "PATH", path)
        os.environ["PATH"] = str(self.folder)
        done = self.succeed("report", name, "out.html", *FAST, "--json")
        self.assertIn("warning: no plots: gnuplot cannot be run", done.stderr)
        report = json.loads(done.stdout)
        self.assertEqual(report["plots"], 0)
        page = Page((self.folder / "out.html").read_text(encoding="utf-8"))
        self.assertIn("There are no plots: gnuplot cannot be run", page.words)
        self.assertEqual(len(page.rows), len(report["runs"]))

    def test_words_of_the_scene_are_no_markup(self):
        name = "<b onload=x>&.art"
        self.file(name, BALL)
        self.succeed("report", name, "out.html", *FAST)
        page = Page((self.folder / "out.html").read_text(encoding="utf-8"))
        self.assertNotIn("b", page.tags)
        self.assertIn(name, page.words)

    def test_a_run_that_takes_too_long_is_a_row(self):
        report, page = self.make("--time-limit", "1e-9", scene=BALL + "sphere s 1 0 0 1\n")
        # How soon a mesher stops is its own affair; the default one looks at once.
        for run, row in zip(report["runs"], page.rows):
            self.assertEqual(row["outcome"]["text"], run["outcome"])
            if run["mesher"] == report["meshers"][0]:
                self.assertEqual(run["outcome"], "cut off")
                self.assertIn("stopped after", row["remark"]["text"])
                self.assertIsNone(run["error"])

    def test_interrupt_leaves_nothing(self):
        scene = self.file("ball.art", BALL)
        self.interrupted("report", scene, "out.html", "--tolerances", "0.00003", "-q")

    def test_wrong_usage_writes_nothing(self):
        name = self.file("ball.art", BALL)
        self.fails(2, "report", name)
        for arguments in (
            ["out.txt"],
            ["out.html", "--csv", "out.txt"],
            ["out.html", "--tolerances", "0"],
            ["out.html", "--tolerances", "1%,fine"],
            ["out.html", "--meshers", "none"],
            ["out.html", "--time-limit", "-1"],
            ["out.html", "--size", "1"],
        ):
            self.fails(2, "report", name, *arguments)
        self.fails(7, "report", name, "no-such-folder/out.html")
        self.fails(2, "report", self.file("bad.art", "spere"), "out.html")


class Browser(SceneTest):
    """The page as a browser shows it. The page has no script, and allows none; so that the test can
    ask what was loaded, it puts one into a copy, and lets that one alone run."""

    PROBE = """<script nonce="test">
window.addEventListener("load", () => {
  const sizes = [...document.images].map((i) => i.complete ? i.naturalWidth : 0);
  document.title = "sizes " + sizes.join(" ");
});
</script></head>"""

    @classmethod
    def setUpClass(cls):
        cls.browser = next(filter(None, map(shutil.which, BROWSERS)), None)
        if cls.browser is None:
            raise unittest.SkipTest("none of " + ", ".join(BROWSERS) + " is installed")

    def setUp(self):
        super().setUp()
        self.succeed("report", self.file("ball.art", BALL), "out.html", *FAST)
        self.page = (self.folder / "out.html").read_text(encoding="utf-8")

    def look(self, path, *options):
        done = subprocess.run(
            [self.browser, "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars",
             f"--user-data-dir={self.folder}/profile", "--enable-logging=stderr", "--v=0",
             "--window-size=1400,2000", *options, path.as_uri()],
            cwd=self.folder, capture_output=True, text=True, timeout=120,
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotRegex(done.stderr, r"CONSOLE")
        return done.stdout

    def test_the_console_is_listened_to(self):
        broken = self.folder / "broken.html"
        broken.write_text(self.page.replace("</h1>", "</h1><img src='https://example.org/x.png'>"))
        with self.assertRaisesRegex(AssertionError, "CONSOLE"):
            self.look(broken, "--dump-dom")

    def test_every_image_is_shown(self):
        asked = self.folder / "asked.html"
        asked.write_text(
            self.page.replace("default-src 'none';", "default-src 'none'; script-src 'nonce-test';")
            .replace("</head>", self.PROBE), encoding="utf-8")
        title = re.search(r"<title>sizes ([\d ]+)</title>", self.look(asked, "--dump-dom"))
        sizes = list(map(int, title.group(1).split()))
        self.assertEqual(len(sizes), len(Page(self.page).images))
        self.assertTrue(all(size > 0 for size in sizes), sizes)

    def test_the_page_as_it_is_looks_like_something(self):
        self.look(self.folder / "out.html", "--screenshot=shot.png")
        width, height, rows = pixels((self.folder / "shot.png").read_bytes())
        self.assertEqual((width, height), (1400, 2000))
        step = len(rows[0]) // width
        background = rows[0][:3]
        marked = [sum(row[i : i + 3] != background for i in range(0, len(row), step * 4))
                  for row in rows]
        # Something on a third of the rows, and in colour somewhere, as plots and pictures are.
        self.assertGreater(sum(count > 0 for count in marked), height // 3)
        colors = {row[i : i + 3] for row in rows[::3] for i in range(0, len(row), step * 3)}
        self.assertTrue(any(max(c) - min(c) > 80 for c in colors))


if __name__ == "__main__":
    main()
