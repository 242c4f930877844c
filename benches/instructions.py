#!/usr/bin/env python3
"""Counts the instructions that the release binary takes for five small scenes, and compares with the table kept in
benches/instructions.txt: a figure that does not depend on how busy the machine is.

    benches/instructions.py [--check] [--write]

--check fails where a scene takes 10 % more than the table says. --write puts the counts into the table and into
BENCHMARKS.md. Needs valgrind (apt-get install valgrind), which offers the program AVX2 but not AVX-512.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from tables import ROOT, put, table

HERE = ROOT / "benches"
KEPT = HERE / "instructions.txt"
LIMIT = 1.10


def count(binary, scene, folder):
    command = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={folder}/out", binary, scene, "--threads", "1", "--quiet",
               "-o", f"{folder}/out.png"]
    run = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    found = re.search(r"Collected : (\d+)", run.stdout.decode(errors="replace"))
    if run.returncode or not found:
        sys.exit(f"{scene.name} failed:\n{run.stdout.decode(errors='replace')[-2000:]}")
    return int(found.group(1))


def kept():
    if not KEPT.exists():
        return {}
    lines = (line.split() for line in KEPT.read_text().splitlines() if not line.startswith("#"))
    return {name: int(number) for name, number in lines}


def main():
    unknown = set(sys.argv[1:]) - {"--check", "--write"}
    if unknown:
        sys.exit(__doc__)
    if not shutil.which("valgrind"):
        sys.exit("valgrind is missing: apt-get install valgrind")
    subprocess.run(["cargo", "build", "--release", "--quiet"], cwd=ROOT, check=True)
    binary = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release" / "rtscript"
    before, now = kept(), {}
    with tempfile.TemporaryDirectory() as folder:
        for scene in sorted((HERE / "instructions").glob("*.rhai")):
            print(f"counting {scene.stem}", file=sys.stderr, flush=True)
            now[scene.stem] = count(binary, scene, folder)
    change = {name: now[name] / before[name] for name in now if name in before}
    rows = [[n, f"{now[n] / 1e6:.1f}", f"{(change[n] - 1) * 100:+.2f} %" if n in change else "new"] for n in now]
    print(table(["scene", "million instructions", "change"], rows))
    if "--write" in sys.argv:
        note = "# Instructions of the release binary for benches/instructions/*.rhai, one thread; written by instructions.py.\n"
        KEPT.write_text(note + "".join(f"{name} {number}\n" for name, number in now.items()))
        put("instructions", table(["scene", "million instructions"], [row[:2] for row in rows]))
    dearer = [name for name, ratio in change.items() if ratio > LIMIT]
    if "--check" in sys.argv and dearer:
        sys.exit(f"more than {(LIMIT - 1) * 100:.0f} % dearer than {KEPT.name} says: {', '.join(dearer)}")


main()
