"""*Run this page*: `python -m live [--mirror FOLDER_OR_ADDRESS] [--packages]`."""

import argparse
import shlex
import sys
from pathlib import Path

from live.packages import PUBLIC, VERSION, Refused, taken
from live.pages import write

ROOT = Path(__file__).parents[3]
BUILD = ROOT / "_build"

parser = argparse.ArgumentParser(prog="live", description=__doc__.partition(":")[0])
mirror = f"folder or address with Pyodide's packages, or {PUBLIC}"
parser.add_argument("--mirror", default="", help=mirror)
parser.add_argument("--html", default=BUILD / "html", type=Path, help="the site as built")
parser.add_argument("--out", default=BUILD / "live", type=Path, help="where the new one goes")
parser.add_argument("--packages", action="store_true", help="take these, and make no pages")
options = parser.parse_args()
store = BUILD / "pyodide" / VERSION
try:
    if options.packages:
        taken(options.mirror, store)
        sys.exit()
    pages = write(ROOT, options.html, options.mirror, store, options.out)
except (Refused, OSError) as error:
    sys.exit(f"==> FAILED: {error}")
print(f"==> {len(pages)} pages run in the browser. Serve them, and open the first:")
print(f"    python -m http.server --directory {shlex.quote(str(options.out))}")
