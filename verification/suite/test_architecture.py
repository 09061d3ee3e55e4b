"""Does the code follow its architecture? Who imports whom, read from the source; what solvers leave out; sizes.

MAY_IMPORT is the table "Where things are" of README.md. The standard library is open to all but where a row says
otherwise. ROOMS are the sub-packages of solvers, each of which may import only those before it.
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from verification import ROOT

OWN = ("solvers", "verification", "benchmarks", "reference_data", "reports")
TESTING = ("pytest", "hypothesis", "mpmath", "jsonschema")
LONGEST_SOLVER_MODULE = 320  # lines: what one can read at a sitting
LARGEST_FOLDER = 13  # modules, packages and templates of one folder: about nine are wanted
NAMED_BY_PROBLEM = (
    "verification",
    "verification/mooring",
    "reports",
)  # lists that are not parted
READERS = "solvers/io/"  # the room whose job is to read input files

# Folder, most special first -> what it may import beside the standard library. A name covers all below it.
MAY_IMPORT = {
    "verification/conformance": ("numpy", "pytest", "verification.conformance", "verification.IN_REPOSITORY"),
    "verification/exact": ("numpy", "mpmath", "verification.exact"),
    "verification/cases": ("numpy", "solvers.numerics.chain", "verification.cases"),
    "reference_data/generate": ("numpy", "mpmath", "verification.exact", "reference_data.generate"),
    "reference_data": ("numpy", "mpmath", "verification.exact", "reference_data", "tqdm"),
    "benchmarks/peers": ("numpy", "benchmarks.peers", "verification.conformance", "verification.cases",
                         "verification.registry", "verification.reference", "moorpy", "pycatenary", "moordyn",
                         "solvers.io.moordyn.writer", "solvers.network.solve"),
    "benchmarks/conformance": ("numpy", "scipy", "solvers", "verification.exact", "verification.conformance", "pytest",
                               "benchmarks"),
    "benchmarks": ("numpy", "scipy", "solvers", "verification.cases", "verification.registry", "verification.reference",
                   "verification.conformance", "pytest", "threadpoolctl", "mpmath", "tqdm", "benchmarks"),
    "reports/browser": ("pytest", "playwright", "reports.browser"),
    "reports": ("numpy", "matplotlib", "mpl_toolkits", "jinja2", "tqdm", "reports"),
    "solvers": ("numpy", "scipy", "threadpoolctl", "solvers"),
    "verification": ("numpy", "scipy", "threadpoolctl", "solvers", "verification", *TESTING),
}  # fmt: skip

# Rooms of solvers from the lowest to the highest: imports between rooms run only downwards.
ROOMS = ("common", "numerics", "catenary", "network", "cable", "time_domain", "harmonic_balance", "stability",
         "mooring", "io", "load_cases")  # fmt: skip
# The dynamic solvers know chains only, and no line.
UNRELATED = {"time_domain": ("catenary", "network", "cable"),
             "harmonic_balance": ("catenary", "network", "cable", "time_domain"),
             "stability": ("catenary", "network", "cable")}  # fmt: skip

# Rooms and modules of reports from the lowest to the highest: imports between them run only downwards. Of the
# room "page" the modules that name every section stand at the top, all others below the rooms of the sections.
REPORT_ORDER = (
    "pipeline",
    "page",
    "drawing",
    "catenary",
    "network",
    "cable",
    "harmonic_balance",
    "mooring",
    "stability",
    "response_curves",
    "scenes",
    "papers",
    "conformance",
    "evidence",
    "front",
    "page.registry",
    "page.section_cache",
    "page.site",
    "__main__",
)
TEST_ROOMS = ("browser",)  # looks at the finished page, and imports none of these

# Beside that, what one file alone may import.
ALSO = {
    "benchmarks/load_cases/table.py": ("distributed",),
    "benchmarks/load_cases/measure.py": ("verification.exact.gaussian",),  # the theory that statistics are shown beside
    "verification/suite/conformance/test_conformance_motion.py": (
        "benchmarks.conformance.this_project",
    ),  # with mistakes
    "verification/suite/conformance/test_conformance_matrix.py": (
        "reports.conformance",
        "reports.page.section",
        "reports.pipeline.stages",
    ),  # it judges what the page says, and runs its scripts
    "verification/suite/report/test_profiles.py": ("reports.page.numbers.profiles",),  # small examples by hand
    "verification/suite/report/test_scene_pages.py": (
        "reports.page",
        "reports.pipeline",
        "reports.scenes",
    ),  # its words
    "reports/drawing/interactive.py": ("altair",),
    "reports/page/charts.py": ("vl_convert",),
    "solvers/load_cases/statistics.py": ("rainflow",),
    "solvers/numerics/compiled.py": (
        "numba",
    ),  # whose loops are worth it is measured: those of numerics/lu/bordered, harmonic_balance/blocks
    "solvers/numerics/lu/blas_by_address.py": ("numba", "llvmlite"),
    "benchmarks/harmonic_balance/block_lu.py": ("numba",),  # what the elimination by address is timed against
}

# Beside that, what a row must never import, standard library included.
NEVER = {
    "solvers": ("logging", "subprocess", "multiprocessing", "socket", "warnings"),
    "verification/exact": ("solvers",),
    "verification/conformance": ("solvers",),
    "reference_data/generate": ("solvers",),
    "reports": ("solvers", "verification", "benchmarks"),
    "benchmarks": ("verification.conftest", "reports"),
}


# ---------------------------------------------------------------- reading imports
@cache
def imports_of(path: Path, root: Path) -> list[tuple[int, str]]:
    """(line, dotted name) of everything a file imports, relative imports resolved, at any depth of the file."""
    return list(_read_imports(path, root))


def _read_imports(path: Path, root: Path) -> Iterator[tuple[int, str]]:
    package = path.relative_to(root).with_suffix("").parts[:-1]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else ()
            module = ".".join([*base, *([node.module] if node.module else [])])
            for alias in node.names:
                yield node.lineno, f"{module}.{alias.name}"
        elif isinstance(node, ast.Call) and getattr(node.func, "id", getattr(node.func, "attr", "")) in (
            "__import__",
            "import_module",
        ):
            first = node.args[0] if node.args else None
            if isinstance(first, ast.Constant):
                yield node.lineno, str(first.value)


def covers(allowed: str, name: str) -> bool:
    """Whether ``name`` is ``allowed`` or something below it, or the package on the way to it."""
    return name == allowed or name.startswith(allowed + ".")


def folder_of(path: Path, root: Path) -> str | None:
    """The row of the table that a file belongs to."""
    place = path.relative_to(root).as_posix()
    return next((folder for folder in MAY_IMPORT if place.startswith(folder + "/")), None)


def sources(root: Path) -> list[Path]:
    """Python files of the top-level folders."""
    return [path for folder in OWN for path in sorted((root / folder).rglob("*.py")) if "__pycache__" not in path.parts]


def bad_imports(root: Path = ROOT) -> list[str]:
    """Imports that the table does not allow."""
    bad = []
    for path in sources(root):
        folder, place = folder_of(path, root), path.relative_to(root).as_posix()
        if folder is None:
            bad.append(f"{place}: no row of the table covers this folder")
            continue
        allowed = MAY_IMPORT[folder] + ALSO.get(place, ())
        for line, name in imports_of(path, root):
            standard = name.partition(".")[0] in sys.stdlib_module_names
            if any(covers(n, name) for n in NEVER.get(folder, ())):
                bad.append(f"{place}:{line}: {folder} never imports {name}")
            elif not standard and not any(covers(n, name) for n in allowed):
                bad.append(f"{place}:{line}: {folder} may not import {name}")
            elif folder.startswith("benchmarks") and re.match(r"verification(\.\w+)*\.test_", name):
                bad.append(f"{place}:{line}: benchmarks import no test modules ({name})")
    return bad


# ---------------------------------------------------------------- rooms
def level_of(name: str, order: tuple[str, ...]) -> str | None:
    """Return the entry of ``order`` that covers a module, the longest one; None where none does."""
    return max((entry for entry in order if covers(entry, name)), key=len, default=None)


def upward_imports(package: str, order: tuple[str, ...], unrelated: dict | None = None, root: Path = ROOT) -> list[str]:
    """Return the imports between entries of ``order`` that do not lead to a lower one, or lead to an unrelated one."""
    bad = []
    for path in sorted((root / package).rglob("*.py")):
        inside = path.relative_to(root / package).with_suffix("").parts
        if inside == ("__init__",) or inside[0] in TEST_ROOMS:
            continue  # the former passes on public names of all rooms
        place, own = path.relative_to(root).as_posix(), level_of(".".join(inside), order)
        if own is None:
            bad.append(f"{place}: no entry of the order covers this file")
            continue
        lower = order[: order.index(own)]
        for line, name in imports_of(path, root):
            other = level_of(name.partition(".")[2], order) if covers(package, name) else own
            if other != own and (other not in lower or other in (unrelated or {}).get(own, ())):
                bad.append(f"{place}:{line}: {own} may not import {name}")
    return bad


def import_circles(root: Path = ROOT) -> list[list[str]]:
    """Sets of modules that import one another, in a circle, at any depth of their files; keyed by dotted path."""
    modules = {".".join(path.relative_to(root).with_suffix("").parts): path for path in sources(root)}
    leads_to = {
        module: {
            other
            for _, name in imports_of(path, root)
            for other in (name, name.rpartition(".")[0])
            if other in modules and other != module
        }
        for module, path in modules.items()
    }
    return [sorted(group) for group in _strong_components(leads_to) if len(group) > 1]


def _strong_components(graph: dict[str, set[str]]) -> list[set[str]]:
    """Strongly connected components by repeated reachability; a graph of some hundred modules."""

    def reachable(start: str, edges: dict[str, set[str]]) -> set[str]:
        seen, waiting = {start}, [start]
        while waiting:
            for other in edges[waiting.pop()] - seen:
                seen.add(other)
                waiting.append(other)
        return seen

    backwards: dict[str, set[str]] = {node: set() for node in graph}
    for node, others in graph.items():
        for other in others:
            backwards[other].add(node)
    components, left = [], set(graph)
    while left:
        node = min(left)
        component = reachable(node, graph) & reachable(node, backwards)
        components.append(component)
        left -= component
    return components


# ---------------------------------------------------------------- what solvers leave out
def forbidden_calls(root: Path = ROOT) -> list[str]:
    """Printing, opening files (but in READERS), breakpoints and global numpy settings in solvers."""
    bad = []
    for path in sorted((root / "solvers").rglob("*.py")):
        place = path.relative_to(root).as_posix()
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call):
                name = getattr(node.func, "id", getattr(node.func, "attr", ""))
                if name in ("print", "breakpoint", "input", "seterr", "exec", "eval"):
                    bad.append(f"{place}:{node.lineno}: {name}()")
                reads = name in ("open", "read_text", "write_text", "savetxt", "loadtxt")
                if reads and not place.startswith(READERS):
                    bad.append(f"{place}:{node.lineno}: {name}()")
            if isinstance(node, ast.Global | ast.Nonlocal):
                bad.append(f"{place}:{node.lineno}: {type(node).__name__.lower()} state")
    return bad


def long_modules(root: Path = ROOT) -> list[str]:
    """Modules of solvers that have grown beyond reading at a sitting."""
    paths = sorted((root / "solvers").rglob("*.py"))
    lines = {path.relative_to(root): path.read_text(encoding="utf-8").count("\n") for path in paths}
    return [f"{path}: {count} lines" for path, count in lines.items() if count > LONGEST_SOLVER_MODULE]


def large_folders(root: Path = ROOT) -> list[str]:
    """Folders of code that hold more modules, packages and templates than a reader takes in at once."""
    large = []
    for folder in {path.parent for package in OWN for path in (root / package).rglob("*.py")}:
        name = folder.relative_to(root).as_posix()
        entries = [
            path for path in folder.iterdir() if path.suffix in {".py", ".j2"} or (path / "__init__.py").exists()
        ]
        count = sum(path.name != "__init__.py" for path in entries)
        if count > LARGEST_FOLDER and name not in NAMED_BY_PROBLEM:
            large.append(f"{name}: {count} entries")
    return large


def silenced(root: Path = ROOT) -> list[str]:
    """Lines of the verification that silence floating-point errors or warnings and say no reason in a comment."""
    words = re.compile(r"errstate\(.*ignore|simplefilter\(.ignore|filterwarnings\(.ignore")
    return [
        f"{path.relative_to(root)}:{number}"
        for path in sorted((root / "verification").rglob("*.py"))
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1)
        if words.search(line) and "  # " not in line
    ]


def undocumented(root: Path = ROOT) -> list[str]:
    """Modules, and public functions, classes, methods and properties of solvers without a docstring."""
    missing = []
    for path in sources(root):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        if path.stat().st_size and not ast.get_docstring(tree):
            missing.append(f"{path.relative_to(root)}: module")
        if path.relative_to(root).parts[0] == "solvers":
            missing += [
                f"{path.relative_to(root)}: {name}" for name, node in public(tree) if not ast.get_docstring(node)
            ]
    return missing


def public(tree) -> Iterator[tuple[str, ast.AST]]:
    """(name, node) of public top-level functions and classes, and of the public methods of the latter."""
    for node in tree.body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_"):
            yield node.name, node
            for member in getattr(node, "body", []) if isinstance(node, ast.ClassDef) else []:
                if isinstance(member, ast.FunctionDef) and not member.name.startswith("_"):
                    yield f"{node.name}.{member.name}", member


# ---------------------------------------------------------------- the claims
def test_every_folder_exists():
    """The five top-level folders are packages."""
    for folder in OWN:
        assert (ROOT / folder / "__init__.py").is_file(), folder


def test_imports_follow_the_table():
    """No file imports what its folder may not: an oracle that shares the formula shares the error."""
    bad = bad_imports()
    assert not bad, "\n".join(bad)


def test_rooms_import_only_downwards():
    """Between the rooms of solvers no import runs up, and the dynamic solvers know of no line."""
    bad = upward_imports("solvers", ROOMS, UNRELATED)
    assert not bad, "\n".join(bad)


def test_rooms_of_the_report_import_only_downwards():
    """What a page consists of lies below the sections, and these below the list of sections and the site."""
    bad = upward_imports("reports", REPORT_ORDER)
    assert not bad, "\n".join(bad)


def test_no_modules_import_in_a_circle():
    """In no folder do modules import one another."""
    assert not import_circles()


def test_solvers_keep_to_solving():
    """Solvers do not print, stop, read files (but the readers of scenes) or change settings for everybody."""
    bad = forbidden_calls()
    assert not bad, "\n".join(bad)


def test_folders_of_the_code_are_small():
    """No folder has more than thirteen modules and folders, but lists of rooms and of the tests of moving lines."""
    assert not large_folders()


def test_solver_modules_are_short():
    """No module of solvers is longer than 320 lines."""
    assert not long_modules()


def test_nothing_is_silenced_without_a_reason():
    """Floating-point errors raise in tests and warnings are errors; what is silenced says why."""
    assert not silenced()
    with pytest.raises(FloatingPointError):
        np.array(1.0) / np.array(0.0)


def test_solvers_are_documented():
    """Every module says what it is for; every public function, class and method of solvers has a docstring."""
    missing = undocumented()
    assert not missing, "\n".join(missing)


# ---------------------------------------------------------------- the checker itself
BAD_IMPORTS = [
    ("solvers/x.py", "import mpmath"),
    ("solvers/x.py", "from matplotlib import pyplot"),
    ("solvers/x.py", "def f():\n    import pytest"),
    ("solvers/x.py", "from verification.reference import EPS"),
    ("solvers/x.py", "import warnings"),
    ("solvers/x.py", "__import__('mpmath')"),
    ("solvers/x.py", "from numba import njit"),
    ("verification/exact/x.py", "from solvers import solve_span"),
    ("verification/exact/x.py", "from ..reference import exact_span"),
    ("verification/exact/x.py", "import scipy"),
    ("reference_data/generate/x.py", "from solvers.catenary.span import Span"),
    ("reference_data/x.py", "import solvers"),
    ("verification/x.py", "from benchmarks import harness"),
    ("verification/x.py", "from reports import page"),
    ("benchmarks/x.py", "from verification.catenary.test_exact import allowed"),
    ("benchmarks/x.py", "from verification.catenary import test_exact"),
    ("benchmarks/x.py", "import moorpy"),
    ("reports/x.py", "import solvers"),
    ("reports/x.py", "from solvers import Span"),
    ("reports/x.py", "from verification.reference import EPS"),
    ("reports/x.py", "import importlib\nimportlib.import_module('benchmarks')"),
    ("solvers/deep/x.py", "from ...verification import reference"),
]

GOOD_IMPORTS = [
    ("solvers/x.py", "import math\nimport numpy as np\nfrom .newton import root\nfrom scipy.linalg import lapack"),
    ("solvers/numerics/lu/blas_by_address.py", "from numba import njit\nimport llvmlite.binding"),
    ("solvers/numerics/compiled.py", "from numba import njit"),
    ("verification/x.py", "import pytest\nfrom solvers import Span\nfrom .cases.spans import NAMED"),
    ("benchmarks/x.py", "from verification.cases.spans import NAMED\nfrom . import harness"),
    ("benchmarks/peers/x.py", "import moorpy"),
    ("reports/x.py", "import jinja2\nfrom . import page"),
]


def planted(tmp_path: Path, place: str, text: str) -> Path:
    """A tree with one file in it."""
    path = tmp_path / place
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f'"""A file."""\n{text}\n')
    return tmp_path


@pytest.mark.parametrize(("place", "text"), BAD_IMPORTS)
def test_a_planted_import_is_found(tmp_path, place, text):
    """Absolute, relative, hidden in a function or spelled as a call: the import is named with file and line."""
    result = bad_imports(planted(tmp_path, place, text))
    assert len(result) == 1 and result[0].startswith(place), result


@pytest.mark.parametrize(("place", "text"), GOOD_IMPORTS)
def test_what_the_table_allows_passes(tmp_path, place, text):
    """The checker does not refuse what the table allows."""
    assert not bad_imports(planted(tmp_path, place, text))


BAD_ROOMS = [
    ("solvers/numerics/x.py", "from ..catenary.span import Span"),
    ("solvers/common/x.py", "def f():\n    from ..numerics import newton"),
    ("solvers/time_domain/x.py", "from solvers.cable.system import CableSystem"),
    ("solvers/harmonic_balance/x.py", "from ..time_domain import solve"),
    ("solvers/cellar/x.py", "import math"),
    ("reports/page/numbers/tables.py", "from ...drawing import style"),
    ("reports/page/numbers/tables.py", "from ..registry import SECTIONS"),
    ("reports/cable/section.py", "from ..harmonic_balance import section"),
    ("reports/drawing/x.py", "from reports.page.site import build"),
    ("reports/cellar/x.py", "import math"),
]


@pytest.mark.parametrize(("place", "text"), BAD_ROOMS)
def test_a_planted_upward_import_is_found(tmp_path, place, text):
    """Into a higher room, into one that a dynamic solver must not know, or from a room without a name."""
    package, order = ("reports", REPORT_ORDER) if place.startswith("reports") else ("solvers", ROOMS)
    result = upward_imports(package, order, UNRELATED, planted(tmp_path, place, text))
    assert len(result) == 1 and result[0].startswith(place), result


def test_a_planted_circle_is_found(tmp_path):
    """Two modules of one bare name in two rooms are two modules; that they import one another is found."""
    planted(tmp_path, "solvers/cable/solve.py", "from ..network.solve import a")
    planted(tmp_path, "solvers/network/solve.py", "from ..numerics import newton")
    assert not import_circles(tmp_path)
    planted(tmp_path, "solvers/numerics/newton.py", "def f():\n    from ..cable.solve import b")
    assert import_circles(tmp_path) == [["solvers.cable.solve", "solvers.network.solve", "solvers.numerics.newton"]]


def test_a_planted_large_folder_is_found(tmp_path):
    """Fourteen modules in one room are too many; those of a folder below it do not count."""
    for i in range(12):
        planted(tmp_path, f"solvers/room/m{i}.py", "")
    planted(tmp_path, "solvers/room/below/__init__.py", "")
    assert not large_folders(planted(tmp_path, "solvers/room/below/m.py", ""))
    assert large_folders(planted(tmp_path, "solvers/room/m12.py", "")) == ["solvers/room: 14 entries"]


@pytest.mark.parametrize("text", ["print(1)", "breakpoint()", "import numpy\nnumpy.seterr(all='raise')", "open('x')"])
def test_a_planted_call_is_found(tmp_path, text):
    """A print, a breakpoint, a global setting or a file in a solver is found."""
    assert forbidden_calls(planted(tmp_path, "solvers/x.py", text))


def test_a_planted_long_or_silent_module_is_found(tmp_path):
    """So is a module that is too long, and a public function or method without a docstring."""
    root = planted(tmp_path, "solvers/x.py", "class A:\n    def run(self):\n        pass\n" + "\n" * 330)
    assert long_modules(root)
    assert undocumented(root) == ["solvers/x.py: A", "solvers/x.py: A.run"]


def test_a_planted_silence_is_found(tmp_path):
    """Without a comment it is found, with one it is not."""
    folder = tmp_path / "verification"
    folder.mkdir()
    text = 'with np.errstate(all="ign' + 'ore"):{}\n    pass\n'
    (folder / "a.py").write_text(text.format("") + text.format("  # a reason"), encoding="utf-8")
    assert silenced(tmp_path) == ["verification/a.py:1"]
