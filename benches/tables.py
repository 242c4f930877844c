"""Markdown tables, and where they stand in BENCHMARKS.md."""

import datetime
import os
import pathlib
import platform
import re

ROOT = pathlib.Path(__file__).resolve().parent.parent


def table(heading, rows):
    """A Markdown table, columns as wide as their widest cell; the first to the left, numbers to the right."""
    rows = [[str(cell) for cell in row] for row in [heading, *rows]]
    widths = [max(len(row[i]) for row in rows) for i in range(len(heading))]
    pad = lambda i, cell: cell.ljust(widths[i]) if i == 0 else cell.rjust(widths[i])
    lines = ["| " + " | ".join(pad(i, cell) for i, cell in enumerate(row)) + " |" for row in rows]
    rule = "|" + "|".join(("-" * (w + 2)) if i == 0 else ("-" * (w + 1) + ":") for i, w in enumerate(widths)) + "|"
    return "\n".join([lines[0], rule, *lines[1:]])


def machine():
    """Processor, cores and system, as the system names them, and how busy it is."""
    model = re.search(r"model name\s*:\s*(.*)", pathlib.Path("/proc/cpuinfo").read_text())
    system = re.search(r'PRETTY_NAME="(.*)"', pathlib.Path("/etc/os-release").read_text())
    load = os.getloadavg()[0]
    return (f"{model.group(1) if model else platform.processor()}, {os.cpu_count()} cores, "
            f"{system.group(1) if system else platform.platform()}; {datetime.date.today()}; "
            f"load when the measurement began: {load:.1f}")


STARTED = machine()


def put(name, text):
    """Puts a table between the marks of its name in BENCHMARKS.md, with the machine and the date."""
    path = ROOT / "BENCHMARKS.md"
    page = path.read_text()
    begin, end = f"<!-- begin {name} -->\n", f"<!-- end {name} -->"
    if begin not in page or end not in page:
        raise SystemExit(f"BENCHMARKS.md has no place for {name}")
    before, rest = page.split(begin, 1)
    after = rest.split(end, 1)[1]
    path.write_text(f"{before}{begin}{text}\n\n{STARTED}\n{end}{after}")
