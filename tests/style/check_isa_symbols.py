"""Keeps code for wide instructions out of what every machine runs.

usage: check_isa_symbols.py NM LIBRARY

The linker keeps one copy of an inline function, whichever object it finds it in. So an object
compiled for wide instructions may define no code but those over packs, which no other object has.
"""

import re
import subprocess
import sys

MEMBER = re.compile(r"^(\w+_avx\w+)\.cpp\.o:$")
SHARED = re.compile(r"^[0-9a-f]* +[WT] (?!.*Pack<)(.*)$")


def shared_symbols(listing):
    """(member, symbol) of what the wide members define and others could be linked to."""
    member = None
    for line in listing.splitlines():
        if line.endswith(":"):
            found = MEMBER.match(line)
            member = found and found.group(1)
        elif member and (symbol := SHARED.match(line)):
            yield member, symbol.group(1)


def self_test():
    listing = """
term.cpp.o:
0000000000000000 W double std::max<double>(double const&, double const&)

bulk_avx2.cpp.o:
0000000000000000 D cs2mesh::detail::kBulkAvx2
0000000000000000 W cs2mesh::Pack<4> cs2mesh::exp<4>(cs2mesh::Pack<4> const&)
                 U memcpy
0000000000000000 W double std::min<double>(double const&, double const&)
"""
    assert list(shared_symbols(listing)) == [
        ("bulk_avx2", "double std::min<double>(double const&, double const&)")]


def main(nm, library):
    self_test()
    done = subprocess.run([nm, "-C", library], capture_output=True, text=True, check=True)
    if "bulk_avx2.cpp.o:" not in done.stdout:
        print(f"{library} has no wide members")
        return 1
    found = list(shared_symbols(done.stdout))
    for member, symbol in found:
        print(f"{member} defines {symbol}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
