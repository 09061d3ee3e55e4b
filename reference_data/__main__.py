"""Build and check the computed reference sets: `python -m reference_data regenerate | check [--only SET] [--jobs N]`.

`regenerate` keeps finished rows beside the data until all are there, so an interrupted run resumes; what it keeps is
tied to the inputs and to the code that computes them. `check` recomputes everything, or with
`--sample N` as many rows spread over the set, and compares text.
"""

import argparse
import csv
import hashlib
import io
import json
import multiprocessing
import os
import sys
import threading
from concurrent.futures import ProcessPoolExecutor, as_completed
from importlib.resources import files
from pathlib import Path

import mpmath
from tqdm import tqdm

from reference_data.generate import conformance_common, conformance_networks, conformance_statics, spans
from verification.exact.cable import catenary_mp

HERE = Path(str(files("reference_data")))
GENERATED = {
    "spans": spans,
    "conformance_statics": conformance_statics,
    "conformance_networks": conformance_networks,
}
"""Set -> its generator: design() gives rows with a name, compute(row) a dict. The table is data.csv of the set's folder
with the generator's COLUMNS; or its PATH, of cases of JSON, whose text its render(rows) gives."""
SHOWN_DIFFERENCES = 40


def _code_digest(generator):
    """Fingerprint of the generator, the oracle and the arithmetic."""
    modules = (generator, *getattr(generator, "SOURCES", (catenary_mp,)))
    sources = (Path(module.__file__).read_bytes() for module in modules)
    return hashlib.sha256(b"".join(sources) + mpmath.__version__.encode()).hexdigest()


def _finished(partial, digest):
    """Rows of an interrupted run by name; empty if it ran other code or inputs."""
    if not partial.exists():
        return {}
    header, *rows = [_parsed(line) for line in partial.read_text(encoding="utf-8").splitlines()] or [None]
    return {row["name"]: row for row in rows if row} if header == digest else {}


def _parsed(line):
    """A line of the log; None for one that was cut when the run was killed."""
    try:
        return json.loads(line)
    except ValueError:
        return None


def _end_with_parent():
    """In a process of the pool: end when the program ends, however it does (kill -9 runs no handler)."""

    def watch():
        multiprocessing.parent_process().join()
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def _computed(name, jobs, keep=None, done=()):
    """Yield the missing rows of a set as they are finished; `keep` is called with each."""
    generator = GENERATED[name]
    todo = [row for row in generator.design() if row.name not in done]
    bar = tqdm(total=len(todo), desc=name, unit="row")
    with ProcessPoolExecutor(jobs, initializer=_end_with_parent) as pool, bar:
        futures = [pool.submit(generator.compute, row) for row in todo]
        try:
            for future in as_completed(futures):
                row = future.result()
                if keep:
                    keep(row)
                bar.update()
                yield row
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise


def _as_csv(generator, rows):
    """Return the rows that there are, in design order, as the text of data.csv."""
    out = io.StringIO()
    writer = csv.DictWriter(out, generator.COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows[row.name] for row in generator.design() if row.name in rows)
    return out.getvalue()


def _is_json(generator):
    return hasattr(generator, "PATH")


def _table_path(name):
    """Return the file of a set."""
    generator = GENERATED[name]
    return HERE / generator.PATH if _is_json(generator) else HERE / name / "data.csv"


def _as_text(generator, rows):
    """Return the rows that there are, in design order, as the text of the set's file."""
    return generator.render(rows) if _is_json(generator) else _as_csv(generator, rows)


def _csv_rows(text):
    """Return name -> row, a dict of texts, of a data.csv."""
    return {row["name"]: row for row in csv.DictReader(io.StringIO(text))}


def _replace(path, text):
    """Write atomically: readers see the old file or the new one."""
    temporary = path.with_name(f"{path.name}.{os.getpid()}.tmp")
    temporary.write_text(text, encoding="utf-8", newline="")
    os.replace(temporary, path)


def regenerate(name, jobs, sample=None):
    """Compute a set, resuming an interrupted run, and replace its table; ``sample`` is not used."""
    generator, data = GENERATED[name], _table_path(name)
    digest = _code_digest(generator)
    partial = data.with_name(f"{data.stem}.partial.tmp")
    rows = _finished(partial, digest)
    data.parent.mkdir(exist_ok=True)
    _replace(partial, "".join(json.dumps(line) + "\n" for line in (digest, *rows.values())))
    with partial.open("a", encoding="utf-8") as log:

        def keep(row):
            log.write(json.dumps(row) + "\n")
            log.flush()

        rows |= {row["name"]: row for row in _computed(name, jobs, keep, done=frozenset(rows))}
    _replace(data, _as_text(generator, rows))
    partial.unlink()
    return []


def differences(stored, fresh, read_rows=_csv_rows):
    """Sentences on every difference between two texts of a table, data.csv if not said otherwise."""
    old, new = read_rows(stored), read_rows(fresh)
    results = [f"{name}: not stored" for name in new if name not in old]
    results += [f"{name}: stored but not in the design" for name in old if name not in new]
    for name in (n for n in new if n in old):
        results += [
            f"{name}: {column} stored {old[name].get(column)}, computed {value}"
            for column, value in new[name].items()
            if old[name].get(column) != value
        ]
    if not results and stored != fresh:
        results = ["same values, but another order, layout or line ending"]
    return results


def _spread(names, count):
    """Return ``count`` of the names, or all, at even distances."""
    return {names[i * len(names) // count] for i in range(count)} if count < len(names) else set(names)


def _only(text, names, is_json=False):
    """Return the text of a table without the rows of other names."""
    if is_json:
        return conformance_common.without_cases(text, names)
    header, *lines = text.splitlines(keepends=True)
    return "".join([header, *(line for line in lines if next(csv.reader([line]))[0] in names)])


def check(name, jobs, sample=None):
    """Recompute a set, or ``sample`` of its rows, and compare it with its data.csv, character by character."""
    data, generator = _table_path(name), GENERATED[name]
    if not data.exists():
        return [f"{data.name} of set {name} is missing: run `python -m reference_data regenerate --only {name}`"]
    stored, names = data.read_bytes().decode("utf-8"), [row.name for row in generator.design()]
    chosen = _spread(names, sample or len(names))
    fresh = _as_text(generator, {row["name"]: row for row in _computed(name, jobs, done=set(names) - chosen)})
    read_rows = conformance_common.table_rows if _is_json(generator) else _csv_rows
    return differences(_only(stored, chosen, _is_json(generator)) if sample else stored, fresh, read_rows)


def _positive(text):
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"{text} is not a positive number")
    return value


def _arguments(argv):
    parser = argparse.ArgumentParser(prog="python -m reference_data", description=__doc__.splitlines()[0])
    parser.add_argument("action", choices=("regenerate", "check"))
    parser.add_argument(
        "--only",
        choices=sorted(GENERATED),
        metavar="SET",
        help=f"one computed set, of: {', '.join(sorted(GENERATED))} (published sets are not computed)",
    )
    parser.add_argument("--jobs", type=_positive, default=os.cpu_count() or 1, help="processes (default: all cores)")
    parser.add_argument("--sample", type=_positive, metavar="N", help="check N rows of each set, spread over it")
    arguments = parser.parse_args(argv)
    if arguments.sample and arguments.action != "check":
        parser.error("--sample belongs to check: a set is regenerated whole")
    return arguments


def _is_installed(folder):
    """Return whether a wheel was unpacked into the folder of the packages: its files are the installer's."""
    return any(folder.glob("mooring_verification-*.dist-info"))


def main(argv=None):
    arguments = _arguments(argv)
    if arguments.action == "regenerate" and _is_installed(HERE.parent):
        print(f"regenerate writes into the package's own folder, and {HERE} is an installed copy: run it in a checkout "
              "of the repository. `python -m reference_data check` works here.", file=sys.stderr)  # fmt: skip
        return 2
    action = {"regenerate": regenerate, "check": check}[arguments.action]
    failed = False
    for name in [arguments.only] if arguments.only else GENERATED:
        result = action(name, arguments.jobs, arguments.sample)
        for line in result[:SHOWN_DIFFERENCES]:
            print(f"{name}: {line}")
        if len(result) > SHOWN_DIFFERENCES:
            print(f"{name}: and {len(result) - SHOWN_DIFFERENCES} more")
        print(f"{name}: {len(result)} differences" if arguments.action == "check" else f"{name}: written")
        failed = failed or bool(result)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
