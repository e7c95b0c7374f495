"""Keeps the sizes and manners of the sources. usage: check_style.py REPOSITORY"""

import pathlib
import re
import shutil
import subprocess
import sys

MAX_FILE_LINES = 600
MAX_FUNCTION_LINES = 100
MAX_COLUMNS = 100
CODE = {".h", ".cpp", ".inc", ".py", ".cmake", ".sh"}
SKIPPED_FOLDERS = {".git", "build", "node_modules", ".cache", "shared"}
# Split, so that this file does not trip over itself.
UNFINISHED = re.compile(r"\b(TO" r"DO|FIX" r"ME|X" r"XX|GTEST_SK" r"IP|DISABLED" r"_\w+)\b")
MACHINE_PATH = re.compile(r"(?<![\w.])/(wo" r"rk|ho" r"me|ro" r"ot|Us" r"ers)/\w")
CMAKE_FORBIDDEN = re.compile(r"FetchCont" r"ent|ExternalProj" r"ect|file\s*\(\s*GLO" r"B")
FUNCTION_HEAD = re.compile(r"^(\s*)(?!namespace|class|struct|enum|union|extern)[^\s#/}].*\{$")


def text_files(root):
    for path in sorted(root.rglob("*")):
        if SKIPPED_FOLDERS & set(path.relative_to(root).parts[:-1]) or not path.is_file():
            continue
        raw = path.read_bytes()
        if b"\0" not in raw[:8000]:
            yield path, raw.decode("utf-8", errors="replace")


def long_functions(lines):
    """(line, length) of bodies over the limit; relies on clang-format's indentation."""
    open_at = {}
    for number, line in enumerate(lines, 1):
        head = FUNCTION_HEAD.match(line)
        if head:
            open_at[len(head.group(1))] = number
        indent = len(line) - len(line.lstrip())
        if line.lstrip().startswith("}") and indent in open_at:
            length = number - open_at.pop(indent) + 1
            if length > MAX_FUNCTION_LINES:
                yield number - length + 1, length


def complaints(root):
    for path, text in text_files(root):
        name = path.relative_to(root).as_posix()
        lines = text.splitlines()
        is_data = name.startswith("data/")
        if path.suffix in CODE and not name.endswith("_table.inc"):
            if len(lines) > MAX_FILE_LINES:
                yield f"{name}: {len(lines)} lines, at most {MAX_FILE_LINES}"
            for number, line in enumerate(lines, 1):
                if len(line) > MAX_COLUMNS:
                    yield f"{name}:{number}: {len(line)} columns, at most {MAX_COLUMNS}"
        if path.suffix in {".h", ".cpp"}:
            for number, length in long_functions(lines):
                yield f"{name}:{number}: a function of {length} lines, at most {MAX_FUNCTION_LINES}"
        if path.suffix == ".h" and "#pragma once" not in text:
            yield f"{name}: no #pragma once"
        is_cmake = path.suffix == ".cmake" or path.name == "CMakeLists.txt"
        for number, line in enumerate(lines, 1):
            if not is_data and UNFINISHED.search(line):
                yield f"{name}:{number}: unfinished: {line.strip()}"
            if MACHINE_PATH.search(line):
                yield f"{name}:{number}: a path of one machine: {line.strip()}"
            if is_cmake and CMAKE_FORBIDDEN.search(line):
                yield f"{name}:{number}: list the files, take packages: {line.strip()}"


def unformatted(root):
    clang_format = shutil.which("clang-format")
    if clang_format is None:
        return ["clang-format is not installed"]
    sources = [str(path) for path, _ in text_files(root) if path.suffix in {".h", ".cpp"}]
    done = subprocess.run([clang_format, "--dry-run", *sources], capture_output=True, text=True)
    return [line for line in done.stderr.splitlines() if "warning:" in line or "error:" in line]


def self_test():
    body = ["void f() {", *["  g();"] * MAX_FUNCTION_LINES, "}"]
    assert list(long_functions(body)) == [(1, MAX_FUNCTION_LINES + 2)]
    assert not list(long_functions(body[:50] + ["}"]))
    assert UNFINISHED.search("// TO" "DO: later") and MACHINE_PATH.search('"/ho' 'me/me/x"')


def main():
    self_test()
    root = pathlib.Path(sys.argv[1]).resolve()
    found = [*complaints(root), *unformatted(root)]
    print("\n".join(found) if found else "style: nothing found")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
