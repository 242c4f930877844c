#!/usr/bin/env python3
"""Edits gallery scenes under `rtscript watch` in a tmux pane, and measures how long the new picture takes to be seen.

    benches/watch.py [SCENE ...] [--rounds N] [--write]

Without names: all of the gallery. Each scene is rendered at 640 x 480 with its own samples into half blocks. An edit
writes the script anew with another background; the clock runs from before the write until `tmux capture-pane` returns
a pane that holds the first coarse picture of the new run, which is asked for without a pause. An edit comes while the
picture before it is still being refined, as when somebody types. Time on the wall, so a busy machine shows. --write
puts the table into BENCHMARKS.md. Needs tmux (apt-get install tmux).
"""

import json
import os
import pathlib
import random
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

from tables import ROOT, put, table

SIZE = "640x480"
LIMIT = 150
COARSE = re.compile(r"  coarse  80x60  ")
DONE = re.compile(r"\.rhai  640x480  ")


class Pane:
    """A terminal of 100 x 40 characters that runs a command."""

    def __init__(self, command, folder):
        self.socket = f"rtscript-watch-{os.getpid()}"
        self.tmux("-f", "/dev/null", "new-session", "-d", "-x", "100", "-y", "40", "-c", folder, f"exec {command}")
        self.process = self.tmux("display-message", "-p", "#{pane_pid}").strip()

    def tmux(self, *args):
        run = subprocess.run(["tmux", "-L", self.socket, *args], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        return run.stdout.decode(errors="replace")

    def wait(self, pattern, seconds=120):
        """When a capture that holds the pattern was there, and the capture with its colors."""
        end = time.perf_counter() + seconds
        while time.perf_counter() < end:
            text = self.tmux("capture-pane", "-p", "-e")
            if pattern.search(text):
                return time.perf_counter(), text
        sys.exit(f"waited in vain for {pattern.pattern!r}:\n{self.tmux('capture-pane', '-p')}")

    def busy(self):
        """Milliseconds of processor time that the command took so far, in steps of 10."""
        fields = pathlib.Path(f"/proc/{self.process}/stat").read_text().rpartition(")")[2].split()
        return 1000 * (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def close(self):
        self.tmux("kill-server")
        while pathlib.Path(f"/proc/{self.process}").exists():
            time.sleep(0.01)


def stages(binary, scene, folder):
    """Milliseconds of the script and of building trees."""
    command = [binary, scene.name, "--size", SIZE, "--samples", "1", "--stats=json", "-o", "stages.png"]
    run = subprocess.run(command, cwd=folder, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    seconds = json.loads(run.stderr.decode().splitlines()[-1])["seconds"]
    return 1000 * (seconds["read"] + seconds["script"]), 1000 * seconds["compile"]


def measure(binary, scene, folder, rounds):
    """Milliseconds on the wall from each edit to its coarse picture, mean milliseconds of processor time for that, wall
    milliseconds from an edit to the whole picture, and how many coarse pictures are another than the one before."""
    text = scene.read_text()
    file = pathlib.Path(folder) / scene.name
    pane = Pane(f"{binary} watch {scene.name} --size {SIZE} --pictures blocks", folder)
    refined = re.compile(r"  coarse  320x240  |rendering \d+%|" + DONE.pattern)
    coarse, busy, pictures = [], [], []
    try:
        for i in range(rounds + 1):
            # The next coarse picture must not be taken for this one's: what comes after it has another name.
            pane.wait(refined)
            time.sleep(random.uniform(0.1, 0.4))
            before, start = pane.busy(), time.perf_counter()
            file.write_text(text + f"\nbackground(0.1, 0.{i + 10}, 0.{90 - i});\n")
            seen, picture = pane.wait(COARSE)
            if i == rounds:
                # The last one is left to be finished.
                whole, _ = pane.wait(DONE, 600)
                others = sum(a != b for a, b in zip(pictures, pictures[1:]))
                return coarse, statistics.mean(busy), 1000 * (whole - start), others
            coarse.append(1000 * (seen - start))
            busy.append(pane.busy() - before)
            pictures.append(picture.split("\x1b[7m")[0])
    finally:
        pane.close()


def main():
    args = sys.argv[1:]
    rounds = 20
    if "--rounds" in args:
        at = args.index("--rounds")
        rounds = int(args[at + 1])
        del args[at:at + 2]
    write = "--write" in args
    names = [name for name in args if name != "--write"]
    if any(name.startswith("-") for name in names):
        sys.exit(__doc__)
    if not shutil.which("tmux"):
        sys.exit("tmux is missing: apt-get install tmux")
    subprocess.run(["cargo", "build", "--release", "--quiet"], cwd=ROOT, check=True)
    binary = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release" / "rtscript"
    scenes = [ROOT / "scripts" / f"{name}.rhai" for name in names] or sorted((ROOT / "scripts").glob("*.rhai"))
    rows, within = [], 0
    for scene in scenes:
        print(f"watching {scene.stem}", file=sys.stderr, flush=True)
        with tempfile.TemporaryDirectory() as folder:
            shutil.copytree(ROOT / "scripts", folder, dirs_exist_ok=True)
            script, trees = stages(binary, scene, folder)
            coarse, busy, whole, others = measure(binary, scene, folder, rounds)
        median = statistics.median(coarse)
        within += median < LIMIT
        rows.append([scene.stem, f"**{median:.0f}**" if median < LIMIT else f"{median:.0f}", f"{max(coarse):.0f}", f"{busy:.0f}",
                     f"{script:.0f}", f"{trees:.0f}", f"{whole:.0f}", f"{whole / median:.0f}", f"{others} of {rounds - 1}"])
        print(" | ".join(rows[-1]), file=sys.stderr, flush=True)
    heading = ["scene", "coarse, ms", "worst", "processor", "script alone", "trees alone", "whole picture, ms", "whole / coarse", "looked other"]
    text = table(heading, rows) + f"\n\nMedians below {LIMIT} ms: {within} of {len(scenes)}; {rounds} edits each."
    print(text)
    if write:
        put("watch", text)


main()
