"""Measure anew what is too slow for a chapter: ``make reproduce``.

A study (`ddlib.studies`) whose result is there already, made by the same code, is skipped;
so an interrupted run resumes.
"""

from __future__ import annotations

import argparse
import time

from ddlib import figures, results
from ddlib.experiment import STATE_FEEDBACK
from ddlib.filters import purest
from ddlib.network import TorqueModel
from ddlib.simulate import LOG_STEP
from ddlib.studies import PARTS


def picture() -> None:
    """The README's picture: two filters found in the networks of window 21."""
    networks = TorqueModel.load(results.networks_path(STATE_FEEDBACK.name, 21)).weights
    found = {
        f"{name} filter": purest(networks.hidden_weights, name)
        for name in ("velocity", "acceleration")
    }
    target = results.FOLDER.parent / "_static" / "readme.svg"
    figures.decomposition(found, LOG_STEP).save(target)


def main(arguments=None) -> None:
    """Run the parts that are missing or stale; ``--force`` runs them all."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("parts", nargs="*", help=f"among {', '.join(PARTS)}; default: all")
    parser.add_argument("--force", action="store_true", help="also what is up to date")
    options = parser.parse_args(arguments)
    for name in options.parts:
        if name not in PARTS:
            parser.error(f"parts must be among {', '.join(PARTS)}, got {name!r}")
    results.FOLDER.mkdir(parents=True, exist_ok=True)
    codes = {name: results.code_hash(name) for name in PARTS}  # now: files may change meanwhile
    for name in options.parts or PARTS:
        path = results.FOLDER / f"{name}.json"
        fresh = path.is_file() and results.read(name)["made by"]["code"] == codes[name]
        if fresh and not options.force:
            print(f"==> {name}: up to date", flush=True)
            continue
        print(f"==> {name}", flush=True)
        started = time.monotonic()
        content = PARTS[name]()
        seconds = time.monotonic() - started
        made_by = {**results.stamp(seconds, name), "code": codes[name]}
        results.write_json(path, {"made by": made_by, **content})
        print(f"==> {name}: {seconds:.0f} s, written to {path}", flush=True)
    picture()


if __name__ == "__main__":
    main()
