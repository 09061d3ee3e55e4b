"""What a result depends on: the files of the project that a program imports or names, found by reading them.

A name taken from a package that only passes it on (``from solvers import Span``) leads to the module that defines it,
and to nothing else in that package. Beside imports count: ``folder / "name"``, strings with the path of a file, strings
with the dotted name of a module, what follows "-m" in a command, and programs that stand in strings.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from importlib.resources import files
from pathlib import Path

ROOT = Path(str(files("reports"))).parent
"""Folder of the packages: the root of the repository, or site-packages where they are installed from a wheel."""
PACKAGES = ("solvers", "verification", "benchmarks", "reference_data", "reports")
OUT = Path("mooring-report")
"""Folder of page and results, below the caller's."""
SUFFIXES = {".py", ".toml", ".csv", ".map", ".j2", ".css", ".js", ".md"}

Reference = tuple[str, str]  # ("file", path from the root), ("module", dotted name) or ("name", module.name)


def depends_on(roots, root: Path = ROOT) -> list[str]:
    """Return all files that ``roots`` (files and folders) need, themselves included, as paths from the root."""
    needed, waiting = set(), [file for name in roots for file in files_of(name, root)]
    while waiting:
        if (file := waiting.pop()) not in needed:
            needed.add(file)
            waiting += _needed(file, root)
    return sorted(needed)


def program(module: str, root: Path = ROOT) -> str:
    """Return the file that ``python -m module`` runs."""
    path = module.replace(".", "/")
    return f"{path}/__main__.py" if (root / path).is_dir() else f"{path}.py"


def files_of(name: str, root: Path = ROOT) -> list[str]:
    """A file, or the sources in a folder. An absolute path may be outside."""
    path = root / name
    if path.is_file():
        return [name]
    result = [p for p in path.rglob("*") if p.suffix in SUFFIXES] if path.is_dir() else []
    inside = (p.relative_to(root).as_posix() for p in result)
    return sorted(p for p in inside if "/." not in p)


def _files(reference: Reference, root: Path) -> list[str]:
    kind, name = reference
    if kind == "file":
        return files_of(name, root)
    package, _, last = name.rpartition(".")
    if kind == "module" or _module(name, root):
        file = _module(name, root)
        return [file] if file else []
    passed = _passed_on(_module(package, root), root).get(last)
    return _files(("name", passed), root) if passed else _files(("module", package), root)


def _module(name: str, root: Path) -> str | None:
    path = name.replace(".", "/")
    choices = (f"{path}.py", f"{path}/__init__.py") if name.partition(".")[0] in PACKAGES else ()
    return next((choice for choice in choices if (root / choice).is_file()), None)


@cache  # and no tree: many of them are long looked through for garbage
def _passed_on(file: str | None, root: Path) -> dict[str, str]:
    """Return name -> where it comes from, of those that an __init__.py imports from its own modules."""
    if file is None or not file.endswith("/__init__.py"):
        return {}
    pairs = (_imported(node, file) for node in _tree(file, root).body if isinstance(node, ast.ImportFrom))
    return {alias: name for imported in pairs for alias, name in imported}


def _tree(file: str, root: Path) -> ast.Module:
    return ast.parse((root / file).read_text(encoding="utf-8"))


@cache
def _needed(file: str, root: Path) -> list[str]:
    """Return the files that a file names or imports; nothing where it is no program of this project."""
    if not (file.endswith(".py") and (root / file).is_relative_to(root)):
        return []
    references = set(_read(_tree(file, root), file, root))
    return sorted({other for reference in references for other in _files(reference, root)})


def _read(tree: ast.AST, file: str, root: Path) -> Iterator[Reference]:
    by_name, inner = False, set()
    for node in ast.walk(tree):  # from the outside inwards
        if isinstance(node, ast.Import):
            yield from (("module", alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from (("name", name) for _, name in _imported(node, file))
        elif isinstance(node, ast.BinOp) and isinstance(node.op, ast.Div):
            inner.add(node.left)
            if node not in inner:
                yield from _path(node, file, root)
        elif isinstance(node, ast.List | ast.Tuple):
            yield from _command(node)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield from _text(node.value, file, root)
        elif isinstance(node, ast.Call):
            by_name |= getattr(node.func, "attr", "") == "import_module" and not isinstance(node.args[0], ast.Constant)
    if by_name:  # which modules, nobody knows: all of the package itself, and of those that a string names
        words = {node.value for node in ast.walk(tree) if isinstance(node, ast.Constant)}
        own = [file.rpartition("/")[0]] if file.endswith("/__init__.py") else []
        yield from (("file", package) for package in [*own, *(name for name in PACKAGES if name in words)])


def _imported(node: ast.ImportFrom, file: str) -> list[tuple[str, str]]:
    """Return (alias, dotted name) of what the statement imports, relative names resolved."""
    package = file.split("/")[:-1]
    base = package[: len(package) - node.level + 1] if node.level else []
    module = ".".join([*base, *([node.module] if node.module else [])])
    return [(alias.asname or alias.name, f"{module}.{alias.name}") for alias in node.names]


def _path(node: ast.BinOp, file: str, root: Path) -> Iterator[Reference]:
    """The path of ``folder / "a" / "b"`` where it is there: below ``files(package)``, the root or the file's folder."""
    words = []
    while isinstance(node, ast.BinOp) and isinstance(node.right, ast.Constant) and isinstance(node.right.value, str):
        words.insert(0, node.right.value)
        node = node.left
    if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "files":
        words.insert(0, str(getattr(node.args[0], "value", "")))
    for place in ("", file.rpartition("/")[0]) if words else ():
        path = "/".join([*([place] if place else []), *words])
        if (root / path).exists():
            yield "file", path


def _command(node: ast.List | ast.Tuple) -> Iterator[Reference]:
    """Yield the program after "-m"; with a name put together at run time, any program of the package."""
    for flag, word in zip(node.elts, node.elts[1:], strict=False):
        if isinstance(flag, ast.Constant) and flag.value == "-m":
            if isinstance(word, ast.JoinedStr):
                yield "file", str(getattr(word.values[0], "value", "")).rstrip(".").replace(".", "/")
            elif isinstance(word, ast.Constant) and word.value.partition(".")[0] in PACKAGES:
                yield "file", program(word.value)


def _text(text: str, file: str, root: Path) -> Iterator[Reference]:
    """Yield a path, a module or a program in a string."""
    if "\n" in text:
        if "import " in text:
            try:
                tree = ast.parse(text)
            except (SyntaxError, ValueError):
                return
            yield from _read(tree, file, root)
        return
    if text.partition(".")[0] in PACKAGES and _module(text, root) and "." in text:
        yield "module", text
    path = text.partition("*")[0].rstrip("/")
    if "/" in text and path.partition("/")[0] in PACKAGES and (root / path).exists():
        yield "file", path
