#!/usr/bin/env python3
"""Prints the table of growth.rs, and with --write puts it into BENCHMARKS.md.

    benches/growth.py [--quick] [--write]

--quick leaves out what takes minutes: more than 1e5 of anything.
"""

import subprocess
import sys

from tables import ROOT, put

if set(sys.argv[1:]) - {"--quick", "--write"}:
    sys.exit(__doc__)
command = ["cargo", "bench", "--quiet", "--bench", "growth", "--", *([] if "--quick" in sys.argv else ["--full"])]
text = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE).stdout.decode().strip()
print(text)
if "--write" in sys.argv:
    put("growth", text)
