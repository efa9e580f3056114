"""Which mistakes in ddlib would the tests notice? `make mutants` draws a sample and tries.

A mutant is the package with one small change (`a + b` to `a - b`, `<` to `<=`, 3 to 4, a keyword
left out). The unit tests run against it, in a copy of the repository; if one fails, the mutant is
killed. What survives is either equivalent (`mutants.yml` says why) or a hole in the tests.

Only the tests of files that execute the changed line run: those that execute it first, fastest
first. mutmut leaves out decorated functions, cosmic-ray selects no tests, neither draws a sample.
Lines are recorded by coverage.py, once for each test file until it or what it executes changes.
"""

from __future__ import annotations

import argparse
import difflib
import hashlib
import importlib
import json
import multiprocessing
import os
import re
import shutil
import subprocess
import sys
import time
from collections import Counter, defaultdict
from concurrent.futures import ProcessPoolExecutor, as_completed
from functools import cache
from itertools import islice
from pathlib import Path

import pytest
import yaml
from mutators import Mutant, mutants_of

ROOT = Path(__file__).resolve().parents[2]
CACHE = ROOT / ".cache" / "mutants"
JUDGED = Path(__file__).with_suffix("").with_name("mutants.yml")

ASIDE = ("widgets", "experiments/studies", "figures", "evidence/chart")
"""Modules that are not mutated: pages and pictures are judged in a browser and by eye, and the
studies take minutes; their outcome is committed and guarded by a hash."""

PAGES = ("book", "house", "figures", "widgets", "evidence/test_chart")
"""Tests that look at words, pictures and pages, and at the shape of the code."""
STALENESS = "test_committed_results_are_of_this_code"
"""The test that any change of code fails."""
HASHES = (
    "experiments/test_results.py",
)  # reads the text of modules: counts for these modules only
HASHING = ("experiments/results", "experiments/reproduce")

TESTS_SECONDS = 20.0
"""Time of the tests that a mutant has to survive, as recorded without it."""

HEAVY = (
    "numpy scipy.integrate scipy.optimize scipy.signal scipy.stats scipy.linalg torch sympy "
    "control matplotlib.pyplot hypothesis.extra.numpy yaml tqdm joblib anywidget IPython.display"
)


def group(module: str) -> str:
    return "measures" if module.startswith("evidence/measures/") else "library"


def modules() -> list[str]:
    """Names of the modules that are mutated."""
    found = (p.relative_to(ROOT / "ddlib") for p in sorted((ROOT / "ddlib").rglob("*.py")))
    return [p.with_suffix("").as_posix() for p in found if not p.as_posix().startswith(ASIDE)]


@cache
def every_mutant() -> tuple[Mutant, ...]:
    return tuple(m for name in modules() for m in mutants_of(name, text_of(name)))


@cache
def text_of(module: str) -> str:
    return (ROOT / "ddlib" / f"{module}.py").read_text(encoding="utf-8")


def draw(seed: int, count: int, which: str) -> list[Mutant]:
    """Drawn by a hash of seed and mutant: a change elsewhere leaves the rest of the sample."""

    def lot(mutant):
        return hashlib.sha256(f"{seed} {mutant.id}".encode()).digest()

    drawn = sorted((m for m in every_mutant() if group(m.module) == which), key=lot)
    return list(islice((m for m in drawn if m.is_code(text_of(m.module))), count))


# --- copies of the repository, and processes in them ----------------------------------------


def make_copy(folder: Path) -> Path:
    """A copy of the files that git knows, as they are now."""
    names = subprocess.check_output(
        ["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, text=True
    )
    shutil.rmtree(folder, ignore_errors=True)
    for name in names.splitlines():
        if (ROOT / name).is_file():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(ROOT / name, folder / name)
    return folder


class Chosen:
    """Plugin: run the chosen tests in the given order, without shrinking; keep what was seen."""

    def __init__(self, order=None, coverage=None):
        self.order, self.coverage = order, coverage
        self.seconds, self.failed = defaultdict(float), []

    def pytest_sessionstart(self):
        from hypothesis import Phase, settings

        phases = (Phase.explicit, Phase.generate)
        settings.register_profile(
            "mutants", deadline=None, derandomize=True, database=None, phases=phases
        )
        settings.load_profile("mutants")

    def pytest_collection_modifyitems(self, items):
        if self.order is not None:
            place = {name: i for i, name in enumerate(self.order)}
            items[:] = sorted(
                (i for i in items if i.nodeid in place), key=lambda i: place[i.nodeid]
            )

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item):
        start = time.process_time()
        if self.coverage:
            self.coverage.switch_context(item.nodeid)
        done = yield
        if self.coverage:
            self.coverage.switch_context("")
        self.seconds[item.nodeid] = round(time.process_time() - start, 3)
        return done

    def pytest_runtest_logreport(self, report):
        if report.failed:
            self.failed.append(report.nodeid)


def apart(folder: Path, work, limit: float) -> dict | None:
    """What ``work()`` returns in a child process in a folder; None if it took too long or died."""
    import resource  # not on Windows, where nothing forks either

    answer = folder / ".answer.json"
    answer.unlink(missing_ok=True)
    if not (child := os.fork()):
        try:
            resource.setrlimit(resource.RLIMIT_CPU, (int(limit) + 1, int(limit) + 5))
            os.chdir(folder)
            os.environ.update(PYTHONPATH=f"{folder}:{folder}/tests/support", CI="1")
            sys.path[:0] = [str(folder), str(folder / "tests" / "support")]
            quiet = os.open("output.txt", os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
            os.dup2(quiet, 1)
            os.dup2(quiet, 2)
            answer.write_text(json.dumps(work()))
        finally:
            os._exit(0)
    os.waitpid(child, 0)
    return json.loads(answer.read_text()) if answer.exists() else None


def run_tests(files, plugin: Chosen, *options: str) -> int:
    os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"
    marks = "not built and not browser and not slow"
    plugins = ["-p", "no:cacheprovider", "-p", "_hypothesis_pytestplugin"]
    paths = [f"tests/{name}" for name in files]
    return int(
        pytest.main(["-q", "-m", marks, "-W", "ignore", *plugins, *options, *paths], [plugin])
    )


# --- which test executes which line ----------------------------------------------------------


def digest(*texts: str) -> str:
    return hashlib.sha256("\0".join(texts).encode()).hexdigest()[:16]


def state(name: str, executed: list[str]) -> str:
    """Digest of a test file, the modules beside it that it names, and those that it executes."""
    beside = {p.stem: p for p in sorted((ROOT / "tests" / "support").glob("*.py"))}
    named = set(re.findall(r"\w+", (ROOT / "tests" / name).read_text(encoding="utf-8")))
    files = [ROOT / "tests" / name, *(p for stem, p in beside.items() if stem in named)]
    files += [ROOT / "ddlib" / f"{module}.py" for module in executed]
    if name == "evidence/test_claims.py":
        files.append(ROOT / "book" / "claims.yml")
    return digest(*(p.read_text(encoding="utf-8") if p.exists() else "" for p in files))


def trace(name: str, folder: Path) -> dict:
    """Seconds and executed lines of each test of a file, run in a copy."""

    def work():
        import coverage

        inside = f"{folder}/ddlib/"
        cover = coverage.Coverage(data_file=None, config_file=False, include=[f"{inside}*"])
        plugin = Chosen(coverage=cover)
        cover.start()
        run_tests([name], plugin)
        cover.stop()
        data = cover.get_data()
        lines = {}
        for path in data.measured_files():
            found = data.contexts_by_lineno(path)
            lines[path.removeprefix(inside).removesuffix(".py")] = {
                line: tests for line, seen in found.items() if (tests := sorted(filter(None, seen)))
            }
        return {"seconds": plugin.seconds, "failed": plugin.failed, "lines": lines}

    found = apart(folder, work, 3600)
    if found is None:
        raise RuntimeError(f"{name} could not be traced: {(folder / 'output.txt').read_text()}")
    return found | {"state": state(name, sorted(found["lines"]))}


def files_with_tests() -> list[str]:
    """Test files that run against mutants, by their place in the folder of the tests."""
    found = (p.relative_to(ROOT / "tests") for p in sorted((ROOT / "tests").rglob("test_*.py")))
    return [path.as_posix() for path in found if not path.as_posix().startswith(PAGES)]


def traced(name: str) -> Path:
    """Where the trace of a test file is kept."""
    return CACHE / f"{name.removesuffix('.py').replace('/', '-')}.json"


def traces(jobs: int) -> dict[str, dict]:
    """What `trace` finds for every test file; only those that changed run again."""
    known, stale = {}, []
    for name in files_with_tests():
        kept = traced(name)
        known[name] = json.loads(kept.read_text()) if kept.exists() else {"state": ""}
        if known[name]["state"] != state(name, sorted(known[name].get("lines", ()))):
            stale.append(name)
    for name, found in in_copies(jobs, trace, stale):
        total = sum(found["seconds"].values())
        print(f"  {name}: {len(found['seconds'])} tests, {total:.0f} s", flush=True)
        if found["failed"]:
            print(f"  not used, since they fail without a mutant: {', '.join(found['failed'])}")
        traced(name).write_text(json.dumps(found))
        known[name] = found
    return {name: found for name, found in known.items() if found["state"]}


def tests_for(mutant: Mutant, known: dict) -> list[str]:
    """Tests to run against a mutant, in order, until their time is used up."""
    chosen, own = [], f"test_{Path(mutant.module).name}.py"
    for name, found in known.items():
        lines = found["lines"].get(mutant.module)
        if lines is None or (name in HASHES and mutant.module not in HASHING):
            continue
        body = range(mutant.scope[0], mutant.scope[1] + 1) if mutant.at_import else mutant.lines
        direct = {test for line in body for test in lines.get(str(line), ())}
        if mutant.at_import and not direct:  # a constant: whoever uses its module
            direct = {test for tests in lines.values() for test in tests}
            if Path(name).name == own:  # which may hold nothing but constants
                direct = set(found["seconds"])
        for test, seconds in found["seconds"].items():
            if direct and test not in found["failed"] and STALENESS not in test:
                chosen.append((test not in direct, Path(name).name != own, seconds, test))
    picked, total = [], 0.0
    for *_, seconds, test in sorted(chosen):
        if total + seconds <= TESTS_SECONDS:
            picked.append(test)
            total += seconds
    return picked


# --- mutants -----------------------------------------------------------------------------------


def file_of(test: str) -> str:
    return test.split("::")[0].removeprefix("tests/")


def judge(job: tuple[Mutant, list[str], float], folder: Path) -> dict:
    """Run a mutant's tests in a copy of the repository: killed, by whom, or not."""
    mutant, tests, seconds = job
    path = folder / "ddlib" / f"{mutant.module}.py"
    start = time.monotonic()
    path.write_text(mutant.apply(text_of(mutant.module)), encoding="utf-8")
    os.utime(path, (start + 1e9, start + 1e9))  # never the time of the compiled original
    row = {"outcome": "survived", "by": f"{len(tests)} tests"}
    try:  # the first file by itself: most mutants need no other
        for stage in (True, False):
            order = [test for test in tests if (file_of(test) == file_of(tests[0])) is stage]
            if order and (killer := _killer(order, folder, 5 * seconds + 90)):
                row = {"outcome": "killed", "by": killer}
                break
    finally:
        path.write_text(text_of(mutant.module), encoding="utf-8")
    return row | {"seconds": round(time.monotonic() - start, 1)}


def _killer(order: list[str], folder: Path, limit: float) -> str:
    """The first of these tests that fails; empty if none does."""
    plugin = Chosen(order)

    def work():
        sys.dont_write_bytecode = True
        code = run_tests(dict.fromkeys(map(file_of, order)), plugin, "-x")
        return {"code": code, "failed": plugin.failed[:1]}

    found = apart(folder, work, limit)
    if found is None:
        return "time"
    return "" if found["code"] in (0, 5) else (found["failed"] or ["import"])[0]


def in_copies(jobs: int, function, work: list):
    """``(item, function(item, folder))`` of all work, in processes with a copy each."""
    if not work:
        return
    for name in HEAVY.split():
        importlib.import_module(name)  # once, before the processes part
    context = multiprocessing.get_context("fork")
    folders = context.Queue()
    for i in range(jobs):
        folders.put(make_copy(CACHE / f"copy-{i}"))
    with ProcessPoolExecutor(jobs, context, _start, (folders,)) as pool:
        waiting = {pool.submit(_call, function, item): item for item in work}
        for done in as_completed(waiting):
            yield waiting[done], done.result()


def _start(folders):
    global _folder
    _folder = folders.get()
    apart(
        _folder, lambda: run_tests(files_with_tests(), Chosen(), "--collect-only"), 600
    )  # compiles them


def _call(function, item):
    return function(item, _folder)


def diff(mutant: Mutant) -> str:
    before = text_of(mutant.module)
    after = mutant.apply(before).splitlines()
    name = f"ddlib/{mutant.module}.py"
    return "\n".join(difflib.unified_diff(before.splitlines(), after, name, name, "", "", 1, ""))


def report(rows: list[tuple[Mutant, dict]], judged: dict[str, str]) -> str:
    """Scores of each group, survivors with their diffs."""
    lines = []
    for name in ("library", "measures"):
        found = [(m, row["outcome"]) for m, row in rows if group(m.module) == name]
        count = Counter("equivalent" if m.id in judged and o == "survived" else o for m, o in found)
        if found:
            total, killed = len(found), count["killed"]
            lines.append(
                f"{name}: {total} mutants, {killed} killed, {count['survived']} survived, "
                f"{count['equivalent']} judged equivalent; score {killed / total:.1%}, "
                f"without the equivalent {killed / max(total - count['equivalent'], 1):.1%}"
            )
    for mutant, row in sorted(rows, key=lambda pair: (pair[0].module, pair[0].lines)):
        if row["outcome"] == "survived":
            why = f"equivalent: {judged[mutant.id]}" if mutant.id in judged else row["by"]
            lines += ["", f"{mutant.id} {mutant.operator} ({why})", diff(mutant)]
        elif mutant.id in judged:
            lines += ["", f"{mutant.id} is judged equivalent, and killed by {row['by']}"]
    return "\n".join(lines)


def main(arguments=None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--library", type=int, default=200, help="mutants outside the measures")
    parser.add_argument("--measures", type=int, default=100, help="mutants of the measures")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--only", nargs="*", help="identifiers or modules, all their mutants")
    options = parser.parse_args(arguments)
    CACHE.mkdir(parents=True, exist_ok=True)
    os.environ["OMP_NUM_THREADS"] = "1"
    print("==> Which tests execute which lines", flush=True)
    known = traces(options.jobs)
    sample = draw(options.seed, options.measures, "measures")
    sample += draw(options.seed, options.library, "library")
    if options.only:
        sample = [m for m in every_mutant() if {m.id, m.module} & set(options.only)]
    seconds = {t: s for found in known.values() for t, s in found["seconds"].items()}
    kept = CACHE / "outcomes.json"
    outcomes = json.loads(kept.read_text()) if kept.exists() else {}
    judged = {entry["id"]: entry["why"] for entry in yaml.safe_load(JUDGED.read_text())}
    rows, jobs, keys = [], [], {}
    for mutant in sample:
        tests = tests_for(mutant, known)
        states = [known[name]["state"] for name in sorted(set(map(file_of, tests)))]
        keys[mutant] = digest(mutant.apply(text_of(mutant.module)), *tests, *states)
        if keys[mutant] in outcomes:
            rows.append((mutant, outcomes[keys[mutant]]))
        else:
            jobs.append((mutant, tests, sum(seconds[test] for test in tests)))
    print(f"==> {len(jobs)} of {len(sample)} mutants to try, of {len(every_mutant())}", flush=True)
    for (mutant, *_), row in in_copies(options.jobs, judge, jobs):
        rows.append((mutant, row))
        outcomes[keys[mutant]] = row
        kept.write_text(json.dumps(outcomes))  # an interrupted run goes on from here
        print(f"  {len(rows):4} {mutant.id} {mutant.module}: {row['outcome']} "
              f"({row['by']}, {row['seconds']} s)", flush=True)  # fmt: skip
    text = report(rows, judged)
    (CACHE / "report.txt").write_text(text + "\n")
    print(text)


if __name__ == "__main__":
    main()
