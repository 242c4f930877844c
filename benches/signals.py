#!/usr/bin/env python3
"""Sends SIGINT, SIGTERM and SIGKILL to `rtscript` at random moments, and looks at what is left.

    benches/signals.py [--runs N] [--kills N] [--opt-level=N] [--release FILE] [--debug FILE] [--write]

For each phase of a run, in a release and a debug build: SIGINT and SIGTERM in turn, each to a process of its own. The
clock runs from before the signal is sent until the process has been waited for. An older picture stands where the new
one goes; a run leaves a file half-written where that is afterwards neither the old one nor a whole PNG, or where a
temporary file stays beside it. SIGKILL, which nobody can answer, is sent while pictures are written: the same is
counted of the pictures, and temporary files for themselves, which stay and are harmless.

Where a phase has an end, a run that is let tells when it begins and how long it takes (`--stats=json`), and moments are
drawn from there; processes that were done before count as no runs, and the run that tells is made anew. A build that is not there is left out.
--opt-level says what the debug build was made with, where that is not the 1 of Cargo.toml. --write puts the table into
BENCHMARKS.md. Fails where a process ends otherwise than it should, takes longer than a second, or leaves half a file.
"""

import argparse
import json
import math
import os
import pathlib
import random
import signal
import statistics
import struct
import subprocess
import sys
import tempfile
import time
import zlib

from tables import ROOT, put, table

MOST_MS = 1000
LIMIT_WAS_HIT = 5
OLD = b"the picture that was there before"
NEW = "picture.png"
GLASS = """maxDepth(64); samples(1024);
areaLight([-2, 5, -2], [4, 0, 0], [0, 0, 4], [1, 1, 1], 16);
transmission(1, 1, 1); reflection(1, 1, 1);
for i in 0..27 { sphere(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1, 0.4); }
"""


class Phase:
    """What a process does when the signal comes: in `part` of a run that ends, or within `seconds` of its first line."""

    def __init__(self, name, script, part=None, seconds=1.0):
        self.name, self.script, self.part, self.seconds = name, script, part, seconds


def waves(folder, side):
    """An OBJ file of a surface of `2 (side - 1)^2` triangles."""
    with open(folder / "waves.obj", "w") as out:
        for i in range(side):
            for j in range(side):
                x, z = i * 0.01, j * 0.01
                out.write(f"v {x:.4f} {0.3 * math.sin(3 * x) * math.sin(2 * z):.6f} {z:.4f}\n")
        for k in (i * side + j for i in range(1, side) for j in range(1, side)):
            out.write(f"f {k + 1} {k} {k - side}\nf {k + 1} {k - side} {k - side + 1}\n")


def phases(debug):
    """What is large is smaller for a build that is some twenty times slower."""
    side = 1000 if debug else 4000
    return [
        Phase("an endless loop", 'print("begun"); loop { }'),
        Phase("a long call: sorting two million values",
              'let a = shuffle(linspace(0, 1, 2000000)); print("begun"); loop { a.sort(); a.sort_desc(); }'),
        Phase("reading an OBJ file", 'mesh("waves.obj");', "script"),
        Phase("building trees", 'mesh("waves.obj");', "compile"),
        Phase("tracing", GLASS, "trace"),
        Phase(f"writing a picture of {side} x {side}", f"size({side}, {side}); sphere(0, 0, 0, 1);", "write"),
        frames(),
    ]


def frames():
    return Phase("writing small pictures for ever",
                 f'size(160, 120); sphere(0, 0, 0, 1); print("begun"); let i = 0; '
                 'loop { render(`frame${i % 5}.png`); i += 1; }')


def is_png(data):
    """Whether the bytes are a whole PNG: all chunks with their sums, and all rows of pixels."""
    if data[:8] != b"\x89PNG\r\n\x1a\n":
        return False
    at, pixels, header = 8, b"", None
    while at + 12 <= len(data):
        (length,), kind = struct.unpack(">I", data[at:at + 4]), data[at + 4:at + 8]
        body, end = data[at + 8:at + 8 + length], at + 12 + length
        if end > len(data) or zlib.crc32(kind + body) != struct.unpack(">I", data[end - 4:end])[0]:
            return False
        if kind == b"IHDR":
            header = struct.unpack(">IIBB", body[:10])
        elif kind == b"IDAT":
            pixels += body
        elif kind == b"IEND":
            channels = {0: 1, 2: 3, 4: 2, 6: 4}[header[3]]
            row = 1 + header[0] * channels * header[2] // 8
            return end == len(data) and len(zlib.decompress(pixels)) == row * header[1]
        at = end
    return False


class Build:
    """One binary with its folder of scenes."""

    def __init__(self, name, binary, folder):
        self.name, self.binary, self.folder = name, binary, folder
        folder.mkdir()

    def start(self, phase, options=()):
        (self.folder / "scene.rhai").write_text(phase.script)
        command = [self.binary, "scene.rhai", "-o", NEW, *options]
        return subprocess.Popen(command, cwd=self.folder, stdin=subprocess.DEVNULL,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def span(self, phase):
        """When the phase begins, in seconds from the start of the process, and how long it takes; of two runs, for the
        first also reads from the disk."""
        options = ["--samples", "1"] if phase.part not in ("trace", "write") else []
        if phase.part == "trace":
            return 0.05, phase.seconds
        for _ in range(2):
            begun = time.perf_counter()
            process = self.start(phase, ["--stats=json", *options])
            _, said = process.communicate()
            whole = time.perf_counter() - begun
            if process.returncode != 0:
                sys.exit(f"{phase.name}: {said.decode()}")
        seconds = json.loads(said.decode().splitlines()[-1])["seconds"]
        before = whole - seconds["total"]
        for part in ("read", "script", "compile", "trace", "write"):
            if part == phase.part:
                return before, seconds[part]
            before += seconds[part]
        raise ValueError(phase.part)

    def signalled(self, phase, span, number):
        """Sends a signal at a random moment; milliseconds until the process has ended and its status, `None` where it
        was done before."""
        for file in self.folder.glob("*.png"):
            file.unlink()
        for name in (NEW, *(f"frame{i}.png" for i in range(5))):
            (self.folder / name).write_bytes(OLD)
        options = ["--samples", "1"] if phase.part in ("script", "compile") else []
        process = self.start(phase, options)
        if span is None:
            process.stdout.readline()
            time.sleep(random.uniform(0, phase.seconds))
        else:
            time.sleep(span[0] + random.uniform(0, span[1]))
        if process.poll() is not None:
            _, said = process.communicate()
            # Endless ones end by a limit where the machine has kept this process waiting.
            if process.returncode not in (0, LIMIT_WAS_HIT):
                sys.exit(f"{phase.name}: {said.decode()}")
            return None
        asked = time.perf_counter()
        process.send_signal(number)
        status = process.wait()
        took = 1000 * (time.perf_counter() - asked)
        process.communicate()
        return took, status

    def left(self):
        """Pictures that are neither old nor whole, and temporary files, which are taken away."""
        half = sum(1 for file in self.folder.glob("*.png") if not file.name.startswith(".")
                   and (data := file.read_bytes()) != OLD and not is_png(data))
        temporary = [file for file in self.folder.iterdir() if file.name.startswith(".")]
        for file in temporary:
            file.unlink()
        return half, len(temporary)


def stopped(build, phase, runs, faults):
    """A row of the table: SIGINT and SIGTERM in turn."""
    span = build.span(phase) if phase.part else None
    took, half = [], 0
    for i in range(2 * runs):
        if len(took) == runs:
            break
        number = (signal.SIGINT, signal.SIGTERM)[i % 2]
        result = build.signalled(phase, span, number)
        pictures, temporary = build.left()
        half += pictures + temporary
        if result is None:
            # The machine has become faster.
            span = span and build.span(phase)
            continue
        took.append(result[0])
        # What is done just before it looks ends well.
        if result[1] not in (128 + number, 0):
            faults.append(f"{phase.name}, {build.name}: status {result[1]} after {number.name}")
    if half:
        faults.append(f"{phase.name}, {build.name}: {half} files left half-written")
    if not took:
        faults.append(f"{phase.name}, {build.name}: no run was met")
        return [phase.name, build.name, 0, "-", "-", half]
    if max(took) > MOST_MS:
        faults.append(f"{phase.name}, {build.name}: ended after {max(took):.0f} ms")
    return [phase.name, build.name, len(took), f"{statistics.median(took):.0f}", f"{max(took):.0f}", half]


def killed(build, phase, runs, faults):
    """A row of the table: SIGKILL."""
    span = build.span(phase) if phase.part else None
    met, half, temporary = 0, 0, 0
    while met < runs:
        result = build.signalled(phase, span, signal.SIGKILL)
        pictures, others = build.left()
        half, temporary = half + pictures, temporary + others
        if result is None:
            span = span and build.span(phase)
        else:
            met += 1
    if half:
        faults.append(f"{phase.name}, {build.name}: {half} pictures left half-written by SIGKILL")
    return [f"SIGKILL: {phase.name}", build.name, met, half, temporary]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    target = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    parser.add_argument("--runs", type=int, default=30)
    parser.add_argument("--kills", type=int, default=200)
    parser.add_argument("--opt-level", default="1")
    parser.add_argument("--release", type=pathlib.Path, default=target / "release/rtscript")
    parser.add_argument("--debug", type=pathlib.Path, default=target / "debug/rtscript")
    parser.add_argument("--write", action="store_true")
    args = parser.parse_args()
    faults, rows, kills = [], [], []
    with tempfile.TemporaryDirectory() as folder:
        for name, binary in (("release", args.release), ("debug", args.debug)):
            if not binary.exists():
                print(f"left out: {binary} is not there", file=sys.stderr)
                continue
            build = Build(name, binary.resolve(), pathlib.Path(folder) / name)
            waves(build.folder, 150 if name == "debug" else 500)
            for phase in phases(name == "debug"):
                rows.append(stopped(build, phase, args.runs, faults))
                print(*rows[-1], f"load {os.getloadavg()[0]:.1f}", sep=" | ", file=sys.stderr, flush=True)
            for phase in phases(name == "debug")[-2:]:
                kills.append(killed(build, phase, args.kills // 2, faults))
                print(*kills[-1], f"load {os.getloadavg()[0]:.1f}", sep=" | ", file=sys.stderr, flush=True)
    text = table(["phase", "build", "runs", "median, ms", "most, ms", "half-written"], rows)
    text += "\n\n" + table(["phase", "build", "runs", "half-written", "temporary files left"], kills)
    text += f"\n\nThe debug build was made with opt-level {args.opt_level}."
    print(text)
    if args.write:
        put("signals", text)
    for fault in faults:
        print(fault, file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
