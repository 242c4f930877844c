"""Runs every attack of tests/abuse as a process of its own and writes docs/abuse.md.

    cargo test --test abuse   # makes the models and pictures
    cargo build; cargo build --release
    cargo build --example attack; cargo build --release --example attack
    python3 benches/abuse.py [--default] [--opt-level=N] [WAY...]   # a way is "library", "command, debug" and so on

Each attack runs by the command (`rtscript --untrusted`) and through the library (`examples/attack.rs`), in a debug and a
release build, with the limits as `Limits::untrusted()` has them; with `--default`, which takes half an hour more, by the
release command also with the default ones. `--opt-level` says what the debug builds were made with, where that is not the 1
of Cargo.toml. Two run at a time. A process that aborts, panics, or takes longer than MOST_SECONDS
fails the run.
"""

import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor

ROOT = pathlib.Path(__file__).resolve().parent.parent
ATTACKS = ROOT / "tests/abuse/attacks"
# Written by the tests, each file with a script that reads it.
FILES = ROOT / "target/tmp/abuse"
MOST_SECONDS = 150
DEFAULT = "default limits"
# An abort by lack of address space would be found too.
MOST_ADDRESS_SPACE = 8 << 30


def written_out(text):
    """The script with its lines `@repeat N TEXT` written out, as tests/abuse/attacks.rs does it."""
    out = []
    for line in text.splitlines():
        if not line.startswith("@repeat "):
            out.append(line + "\n")
            continue
        count, piece = line[len("@repeat "):].split(" ", 1)
        out.append("".join(piece.replace("#", str(i)) for i in range(int(count))) + "\n")
    return "".join(out)


def limited():
    resource.setrlimit(resource.RLIMIT_AS, (MOST_ADDRESS_SPACE, MOST_ADDRESS_SPACE))


def run(command):
    """Exit status, seconds, peak memory in MiB and what the process said."""
    with tempfile.TemporaryFile() as said:
        start = time.monotonic()
        process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=said, preexec_fn=limited
        )
        killed = False
        while True:
            pid, status, usage = os.wait4(process.pid, os.WNOHANG)
            if pid:
                break
            if time.monotonic() - start > MOST_SECONDS:
                process.kill()
                killed = True
            time.sleep(0.002)
        seconds = time.monotonic() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        text = said.read(20000).decode(errors="replace")
    return (None if killed else process.returncode), seconds, usage.ru_maxrss / 1024, text


def message(text):
    for line in text.splitlines():
        if line.startswith("error") or ": error: " in line:
            return line.split(": ", 1)[1].replace("scene.rhai", "").strip() if line.startswith("error") else line.split(": error: ", 1)[1]
    return "runs to its end"


def limit_of(text):
    return text.split("the limit '", 1)[1].split("'", 1)[0] if "the limit '" in text else "-"


def main():
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "self.rhai").write_text('import "self" as s;')
        ways = {
            "command, debug": ["target/debug/rtscript", "--untrusted", "-o", folder / "picture.png"],
            "library, debug": ["target/debug/examples/attack"],
            "command": ["target/release/rtscript", "--untrusted", "-o", folder / "picture.png"],
            "library": ["target/release/examples/attack"],
        }
        if "--default" in sys.argv:
            ways[DEFAULT] = ["target/release/rtscript", "-o", folder / "picture.png"]
        # What was not built or not asked for is left out.
        asked = [way for way in sys.argv[1:] if not way.startswith("--")] or ways
        ways = {way: command for way, command in ways.items() if way in asked and (ROOT / command[0]).exists()}
        faults = []

        def attacked(name, script):
            results = {}
            with ThreadPoolExecutor(2) as two:
                runs = two.map(lambda command: run([ROOT / command[0], *command[1:], script]), ways.values())
            for way, (status, seconds, memory, text) in zip(ways, runs):
                if status not in (0, 1, 3, 5, 6):
                    faults.append(f"{name}, {way}: status {status}: {text[:300]}")
                results[way] = (seconds, memory, message(text))
            print(name, *(f"{s:.1f}s {m:.0f}M" for s, m, _ in results.values()), flush=True)
            return name, results

        rows = {"Scripts": [], "Models": [], "Pictures": []}
        script = folder / "scene.rhai"
        for attack in sorted(ATTACKS.glob("*.rhai")):
            script.write_text(written_out(attack.read_text()))
            rows["Scripts"].append(attacked(attack.stem, script))
        for kind in ("Models", "Pictures"):
            rows[kind] = [attacked(file.stem, file) for file in sorted((FILES / kind.lower()).glob("*.rhai"))]
        (ROOT / "docs/abuse.md").write_text(page(ways, rows))
    for fault in faults:
        print(fault, file=sys.stderr)
    return 1 if faults else 0


def debug_level():
    given = [word.removeprefix("--opt-level=") for word in sys.argv if word.startswith("--opt-level=")]
    return given[0] if given else "1"


def page(ways, rows):
    strangers = [way for way in ways if way != DEFAULT]
    every = [results for of_kind in rows.values() for _, results in of_kind]
    worst = {way: (max(r[way][0] for r in every), max(r[way][1] for r in every)) for way in ways}
    lines = [
        "# What stopped each attack",
        "",
        "The scripts of `tests/abuse/attacks/`, and the models and pictures that `tests/abuse/` has or makes, each run as a",
        "process of its own with the limits as they are, written by `benches/abuse.py`. No process aborted, panicked or had",
        "to be killed. Seconds are of wall clock on two cores that other work was using too (loaded), start of the process",
        "included; memory is the peak of the whole process, some 10 MiB of which is the program.",
        f"Debug builds check overflow and assertions and are made with `opt-level` {debug_level()}, release builds as `Cargo.toml`",
        "has them.",
        "",
        "| | longest | most memory |",
        "|---|---|---|",
        *(f"| {way} | {seconds:.1f} s | {memory:.0f} MiB |" for way, (seconds, memory) in worst.items()),
    ]
    for kind, of_kind in rows.items():
        lines += [
            "",
            f"## {kind} under the limits for strangers",
            "",
            "`Limits::untrusted()`; seconds and MiB by command and library, in release builds unless it says debug.",
            "",
            "| attack | limit | " + " | ".join(strangers) + " | message |",
            "|---|---|" + "---|" * len(strangers) + "---|",
        ]
        for name, results in of_kind:
            cells = " | ".join(f"{results[way][0]:.2f} s, {results[way][1]:.0f}" for way in strangers)
            text = results[strangers[0]][2]
            lines.append(f"| {name} | {limit_of(text)} | {cells} | {escaped(text)} |")
    if DEFAULT not in ways:
        return "\n".join(lines) + "\n"
    lines += [
        "",
        "## Limits for one's own scripts",
        "",
        "`Limits::default()`, by the command in a release build.",
        "",
        "| attack | limit | seconds | MiB | message |",
        "|---|---|---|---|---|",
    ]
    for name, results in (row for of_kind in rows.values() for row in of_kind):
        seconds, memory, text = results[DEFAULT]
        lines.append(f"| {name} | {limit_of(text)} | {seconds:.2f} | {memory:.0f} | {escaped(text)} |")
    return "\n".join(lines) + "\n"


def escaped(text):
    text = text if len(text) <= 160 else text[:157] + "..."
    return text.replace("\\", "\\\\").replace("|", "\\|").replace("<", "\\<").replace("`", "\\`")


if __name__ == "__main__":
    sys.exit(main())
