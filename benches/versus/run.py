#!/usr/bin/env python3
"""Runs Embree and POV-Ray beside rtscript on equal work and prints tables in Markdown.

    benches/versus/run.py [embree] [packets] [builds] [povray] [runs] [threads] [--rounds N] [--write]

Without names: all of them. Needs g++, povray and libembree-dev, and installs them with apt-get where it may. The
programs take turns; every figure is a median over the rounds of processor seconds on one thread, so that it hardly
depends on what else runs (only `threads` measures time on the wall and wants an idle machine). --write puts the
tables into BENCHMARKS.md. Inputs and pictures are left under target/versus.
"""

import argparse
import json
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import meshes  # noqa: E402
from tables import machine, put, table  # noqa: E402

TARGET = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
WORK = TARGET / "versus"
# Models that others publish, where somebody has put them; the comparison also runs without.
MODELS = pathlib.Path(os.environ.get("RTSCRIPT_MODELS", ROOT.parent / "shared" / "meshes"))


def say(text):
    print(text, file=sys.stderr, flush=True)


def need(tool, package, found):
    if found():
        return
    if os.geteuid() == 0 and shutil.which("apt-get"):
        say(f"installing {package}")
        subprocess.run(["apt-get", "update", "-qq"], check=False)
        subprocess.run(["apt-get", "install", "-y", "-qq", package], check=True, stdout=subprocess.DEVNULL)
    if not found():
        sys.exit(f"{tool} is missing: apt-get install {package}")


def run(command, **options):
    """A program's output, processor seconds and peak MiB."""
    process = subprocess.Popen([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, **options)
    output = process.stdout.read().decode(errors="replace")
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        sys.exit(f"{command[0]} failed:\n{output[-2000:]}")
    return output, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def programs(parts):
    """The benchmark programs, built, and the release binary where a part is about pictures."""
    say("building")
    of_rays, of_scenes = {"embree", "builds", "packets"}, {"povray"}
    if set(parts) - of_rays:
        subprocess.run(["cargo", "build", "--release", "--quiet"], cwd=ROOT, check=True)
    found = {"rtscript": TARGET / "release" / "rtscript"}
    benches = [name for name, of in (("rays", of_rays), ("scene", of_scenes)) if of & set(parts)]
    if not benches:
        return found
    command = ["cargo", "bench", "--no-run", *(f"--bench={name}" for name in benches), "--message-format=json"]
    output = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout
    for line in output.decode().splitlines():
        message = json.loads(line)
        if message.get("executable") and "bench" in message["target"]["kind"]:
            found[message["target"]["name"]] = message["executable"]
    return found


def apart(work):
    """Does the work in a process of its own: the peak memory of a program counts that of the process which starts it,
    so this one must stay small."""
    child = os.fork()
    if child == 0:
        try:
            work()
        except BaseException as error:
            say(repr(error))
            os._exit(1)
        os._exit(0)
    if os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]):
        sys.exit("cannot make the inputs")


def medians(samples):
    return {key: statistics.median(values) for key, values in samples.items()}


def geometric_mean(values):
    return statistics.geometric_mean(values)


# Meshes -------------------------------------------------------------------------------------------------------------


def make_meshes():
    """Names of the meshes in WORK, made where they are missing."""
    inputs = []

    def fine(points, faces, step):
        return step(*step(points, faces))

    def add(name, inside, make):
        path = WORK / f"{name}.rtsm"
        inputs.append(name)

        def write():
            points, faces = make()
            seen = meshes.view(points, faces, inside)
            if not inside:
                points, faces = meshes.with_ground(points, faces)
            meshes.write_mesh(str(path), points, faces, seen)

        if not path.exists():
            say(f"making {name}")
            apart(write)

    add("ball", False, lambda: meshes.lumpy_ball(6))
    add("ball1m", False, lambda: meshes.lumpy_ball(8))
    add("hall", True, meshes.hall)
    add("hall-fine", True, lambda: fine(*meshes.hall(), meshes.at_midpoints))
    bunny, sponza = MODELS / "stanford-bunny.obj", MODELS / "sponza.obj"
    if bunny.exists():
        add("bunny", False, lambda: meshes.read_obj(bunny))
        add("bunny1m", False, lambda: fine(*meshes.read_obj(bunny), meshes.loop))
    if sponza.exists():
        add("sponza", True, lambda: meshes.read_obj(sponza))
        add("sponza540k", True, lambda: fine(*meshes.read_obj(sponza), meshes.at_midpoints))
    return inputs


SETS = [("primary", "primary"), ("ao", "AO closest"), ("ao-any", "AO any-hit"), ("shadow", "shadow")]


def embree_driver():
    """Embree's program, built."""
    need("g++", "g++", lambda: shutil.which("g++"))
    need("Embree", "libembree-dev", lambda: pathlib.Path("/usr/include/embree3/rtcore.h").exists())
    driver = WORK / "embree"
    source = HERE / "embree.cpp"
    if not driver.exists() or driver.stat().st_mtime < source.stat().st_mtime:
        subprocess.run(["g++", "-O3", "-march=native", source, "-lembree3", "-o", driver], check=True)
    return driver


def write_rays(driver, name):
    """The rays of a mesh, where they are not there."""
    if not (WORK / f"{name}.shadow.rays").exists():
        run([driver, WORK / f"{name}.rtsm", WORK, "--write-rays", "--reps", "1"])


def rates_of(command):
    """What a program prints of a mesh: its triangles, and of each set of rays the rate and the hits."""
    triangles, sets = 0, {}
    for line in run(command)[0].splitlines():
        what, value, detail, count = line.split(",")
        if what == "build":
            triangles = int(count)
        else:
            sets[what] = float(value), int(detail)
    return triangles, sets


def embree(found, rounds):
    driver, names = embree_driver(), make_meshes()
    rates, counts, triangles = {}, {}, {}
    for turn in range(rounds):
        for name in names:
            say(f"round {turn + 1} of {rounds}: {name}")
            mesh = WORK / f"{name}.rtsm"
            write_rays(driver, name)
            for who, command in (
                ("medium", [driver, mesh, WORK]),
                ("rtscript", [found["rays"], mesh, WORK]),
                ("robust", [driver, mesh, WORK, "--robust"]),
            ):
                triangles[name], sets = rates_of([*command, "--reps", "2"])
                for key, (rate, hits) in sets.items():
                    rates.setdefault((name, who, key), []).append(rate)
                    counts[name, who, key] = hits
    rate = medians(rates)
    for name in names:
        for key, _ in SETS:
            ours, theirs = counts[name, "rtscript", key], counts[name, "medium", key]
            if ours != theirs:
                say(f"{name}, {key}: rtscript hits {ours} rays, Embree {theirs}")
    for other, title in (("medium", "Embree, medium build"), ("robust", "Embree, robust mode")):
        rows = []
        for name in names:
            cells = [f"{rate[name, 'rtscript', k] / rate[name, other, k]:.2f} ({rate[name, 'rtscript', k]:.1f})" for k, _ in SETS]
            rows.append([name, f"{triangles[name]:,}", *cells])
        means = [geometric_mean([rate[n, "rtscript", k] / rate[n, other, k] for n in names]) for k, _ in SETS]
        rows.append(["**geometric mean**", "", *(f"**{m:.2f}**" for m in means)])
        heading = ["mesh", "triangles", *(title for _, title in SETS)]
        note = f"Single rays: rtscript's rate over that of {title}; in brackets rtscript's million rays per processor second.\n\n"
        yield f"embree-{other}", note + table(heading, rows)


def packets(found, rounds):
    """Camera rays in squares and shadow rays to an area light: in packets, beside the same rays one by one."""
    driver, names = embree_driver(), make_meshes()
    sets = (("primary", "camera rays"), ("area", "area-light shadows"))
    rates, counts, triangles = {}, {}, {}
    for turn in range(rounds):
        for name in names:
            say(f"round {turn + 1} of {rounds}: packets, {name}")
            mesh = WORK / f"{name}.rtsm"
            write_rays(driver, name)
            triangles[name], measured = rates_of([found["rays"], mesh, WORK, "--packets", "--reps", "3"])
            for key, (rate, hits) in measured.items():
                rates.setdefault((name, key), []).append(rate)
                counts[name, key] = hits
    rate = medians(rates)
    for name in names:
        for key, _ in sets:
            if counts[name, key] != counts[name, f"{key}-packet"]:
                sys.exit(f"{name}, {key}: packets hit another number of rays")
    ratio = lambda name, key: rate[name, f"{key}-packet"] / rate[name, key]
    rows = []
    for name in names:
        cells = []
        for key, _ in sets:
            cells += [f"{rate[name, key]:.1f}", f"{rate[name, f'{key}-packet']:.1f}", f"{ratio(name, key):.2f}"]
        rows.append([name, f"{triangles[name]:,}", *cells])
    small = [name for name in names if triangles[name] <= 600_000]
    means = []
    for key, _ in sets:
        means += ["", "", f"**{geometric_mean([ratio(name, key) for name in small]):.2f}**"]
    rows.append(["**geometric mean**", "up to 0.6 M", *means])
    heading = ["mesh", "triangles"]
    for _, title in sets:
        heading += [f"{title}, one by one", "in packets", "ratio"]
    yield "packets", table(heading, rows)


def builds(found, rounds):
    """Building without splits beside the medium build, which has none, and with splits beside the high one."""
    driver, names = embree_driver(), make_meshes()
    samples = {}
    for turn in range(rounds):
        for name in names:
            say(f"round {turn + 1} of {rounds}: building {name}")
            mesh = WORK / f"{name}.rtsm"
            for who, command in (
                ("medium", [driver, mesh, WORK]),
                ("uncut", [found["rays"], mesh, WORK, "--uncut"]),
                ("high", [driver, mesh, WORK, "--quality", "high"]),
                ("cut", [found["rays"], mesh, WORK]),
            ):
                line = run([*command, "--build-only", "--reps", "5"])[0].strip()
                _, seconds, size, count = line.split(",")
                samples.setdefault((name, who), []).append((float(seconds), float(size), int(count)))
    rows, speeds = [], []
    for name in names:
        all_of = {who: samples[name, who] for who in ("uncut", "medium", "cut", "high")}
        ms = {who: 1e3 * statistics.median(s[0] for s in of) for who, of in all_of.items()}
        size = {who: of[0][1] for who, of in all_of.items()}
        speeds.append((ms["medium"] / ms["uncut"], ms["high"] / ms["cut"]))
        rows.append([
            name, f"{all_of['cut'][0][2]:,}", f"{ms['uncut']:.1f}", f"{speeds[-1][0]:.2f}", f"{ms['cut']:.1f}",
            f"{speeds[-1][1]:.2f}", *(f"{size[who]:.0f}" for who in ("uncut", "medium", "cut", "high")),
        ])
    means = [f"**{geometric_mean(column):.2f}**" for column in zip(*speeds)]
    rows.append(["**geometric mean**", "", "", means[0], "", means[1], *[""] * 4])
    heading = ["mesh", "triangles", "ms without splits", "speed / medium", "ms with splits", "speed / high",
               "bytes without", "medium", "bytes with", "high"]
    yield "embree-build", table(heading, rows)


# Scenes -------------------------------------------------------------------------------------------------------------


def povray(scene, width, height, *more):
    command = ["povray", f"-I{scene}", f"+L{HERE / 'scenes'}", f"+L{WORK}", f"+W{width}", f"+H{height}", "-D", "-A", "+WT1",
               f"+O{WORK / (scene.stem + '-povray.png')}", *more]
    return run(command, cwd=WORK)


def trace_seconds(output):
    line = re.search(r"Trace Time:.*?with ([\d.]+) CPU-seconds", output, re.S)
    rays = re.search(r"^Rays:\s+(\d+)", output, re.M)
    shadow = re.search(r"Shadow Ray Tests:\s+(\d+)", output)
    return float(line.group(1)), int(rays.group(1)), int(shadow.group(1)) if shadow else 0


def need_povray():
    need("POV-Ray", "povray", lambda: shutil.which("povray"))


def copy_scenes():
    for scene in (HERE / "scenes").glob("*.rhai"):
        shutil.copy(scene, WORK)


def make_model():
    """The model of the mesh scene, in a ball of radius 1."""
    bunny = MODELS / "stanford-bunny.obj"
    name = "bunny" if bunny.exists() else "ball"
    obj, inc = WORK / f"model-{name}.obj", WORK / f"model-{name}.inc"

    def write():
        points, faces = meshes.read_obj(bunny) if bunny.exists() else meshes.lumpy_ball(6)
        low, high = meshes.bounds(points, faces)
        radius = max(h - l for l, h in zip(low, high)) / 2
        points = [[(x - (l + h) / 2) / radius for x, l, h in zip(p, low, high)] for p in points]
        meshes.write_obj(obj, points, faces)
        meshes.write_pov(inc, points, faces)

    if not inc.exists():
        apart(write)
    shutil.copy(obj, WORK / "model.obj")
    shutil.copy(inc, WORK / "model.inc")
    return name


def scenes(found, rounds):
    need_povray()
    copy_scenes()
    model = make_model()
    ours, theirs = {}, {}
    # To 2^-20, as rtscript does where nothing is said, in place of the 1/255 of POV-Ray.
    whole = "glass, every branch"
    glass = (HERE / "scenes" / "glass.rhai").read_text()
    (WORK / f"{whole}.rhai").write_text(glass.replace("minWeight(1.0 / 255);", ""))
    names = ["sphereflake", "model", "glass", "softshadow", whole]
    more = {whole: ["glass", "Declare=Bailout=0.00000095"]}
    for turn in range(rounds):
        for name in names:
            say(f"round {turn + 1} of {rounds}: {name}")
            stem, *declared = more.get(name, [name])
            output = povray(HERE / "scenes" / f"{stem}.pov", 1280, 960, *declared)[0]
            theirs.setdefault(name, []).append(trace_seconds(output))
            output = run([found["scene"], WORK / f"{name}.rhai", "--reps", "1"])[0]
            ours.setdefault(name, []).append([float(x) for x in output.strip().split(",")])
    for name in names:
        run([found["rtscript"], WORK / f"{name}.rhai", "-q", "-o", WORK / f"{name}-rtscript.png"], cwd=WORK)
    say(f"pictures to compare: {WORK}/*-povray.png, *-rtscript.png")
    rows = []
    for name in names:
        pov = statistics.median(t[0] for t in theirs[name])
        own = statistics.median(t[2] for t in ours[name])
        rows.append([
            f"model: {model}" if name == "model" else name, f"{pov:.2f}", f"{own:.3f}", f"**{pov / own:.1f}**",
            f"{(theirs[name][0][1] + theirs[name][0][2]) / 1e6:.1f}", f"{ours[name][0][3] / 1e6:.1f}",
        ])
    heading = ["scene, 1280 x 960, one sample", "POV-Ray trace s", "rtscript trace s", "POV-Ray / rtscript",
               "POV-Ray million rays", "rtscript million rays"]
    yield "povray", table(heading, rows)


def whole_runs(found, rounds):
    need_povray()
    copy_scenes()
    pairs = [
        ("one million balls by a loop, 64 x 64", "million.pov", [], "million.rhai", (64, 64)),
        ("597,871 balls by recursion, 640 x 480", "sphereflake.pov", ["Declare=Depth=6"], "flake6.rhai", (640, 480)),
    ]
    rows = []
    for title, pov, more, rhai, (width, height) in pairs:
        ours, theirs = [], []
        for turn in range(rounds):
            say(f"round {turn + 1} of {rounds}: {title}")
            theirs.append(povray(HERE / "scenes" / pov, width, height, *more)[1:])
            ours.append(run([found["rtscript"], WORK / rhai, "-q", "--threads", "1", "--size", f"{width}x{height}",
                             "-o", WORK / "run.png"], cwd=WORK)[1:])
        (pov_s, pov_m), (own_s, own_m) = (map(statistics.median, zip(*x)) for x in (theirs, ours))
        rows.append([title, f"{pov_s:.2f}", f"{own_s:.2f}", f"**{pov_s / own_s:.1f}**", f"{pov_m:.0f}", f"{own_m:.0f}",
                     f"**{own_m / pov_m:.2f}**"])
    heading = ["whole run", "POV-Ray CPU s", "rtscript CPU s", "POV-Ray / rtscript", "POV-Ray peak MiB",
               "rtscript peak MiB", "rtscript / POV-Ray"]
    yield "povray-runs", table(heading, rows)


def threads(found, rounds):
    """Wall time of whole runs, in which one thread runs the script, and of tracing alone."""
    rows = []
    for script in sorted((ROOT / "scripts").glob("*.rhai")):
        wall = {1: [], 2: []}
        for turn in range(rounds):
            for count in wall:
                say(f"round {turn + 1} of {rounds}: {script.stem}, threads: {count}")
                output, _, _ = run([found["rtscript"], script, "-q", "--stats=json", "--threads", str(count), "-o",
                                    WORK / "thread.png"], cwd=WORK)
                wall[count].append(json.loads(output.strip().splitlines()[-1])["seconds"])
        one, two = ({k: statistics.median(s[k] for s in wall[n]) for k in ("trace", "total")} for n in (1, 2))
        rows.append([script.stem, f"{one['total']:.2f}", f"{two['total']:.2f}", f"{one['total'] / two['total']:.2f}",
                     f"{one['trace'] / two['trace']:.2f}"])
    long = [float(r[3]) for r in rows if float(r[1]) > 1]
    if long:
        rows.append([f"**least of those over 1 s** ({len(long)})", "", "", f"**{min(long):.2f}**", ""])
    yield "threads", table(["gallery scene", "1 thread, wall s", "2 threads", "ratio", "ratio of tracing alone"], rows)


PARTS = {"embree": embree, "packets": packets, "builds": builds, "povray": scenes, "runs": whole_runs, "threads": threads}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", choices=[[], *PARTS], metavar="part", help=", ".join(PARTS))
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--write", action="store_true", help="put the tables into BENCHMARKS.md")
    arguments = parser.parse_args()
    WORK.mkdir(parents=True, exist_ok=True)
    parts = arguments.parts or list(PARTS)
    found = programs(parts)
    print(machine())
    for part in parts:
        for name, text in PARTS[part](found, arguments.rounds):
            print(f"\n{text}", flush=True)
            if arguments.write:
                put(name, text)


main()
