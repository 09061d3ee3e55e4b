"""Do faults stay with the code that they address, however it is laid out and whatever its variables are called?"""

from __future__ import annotations

import ast
import gc
import importlib
import math
import random
import re
import sys
import time
import tokenize
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from types import CodeType

import pytest

from solvers.catenary import regimes as catenary_regimes
from solvers.numerics.elementary import SCALAR

from ..defects.catalogue import CATALOGUE
from ..defects.planted import cables, dynamics, networks, spans
from ..tools.patterns import module_syntax
from ..tools.planting import ROOT, Fault, fault_at, plant_in_place, planted, sign_faults

EXAMPLE = '''"""A module."""
import math
from functools import cache

SIZE = 3 + 1


class Line:
    ends = 2

    @property
    def length(self):
        return math.hypot(self.x, self.y)  # of both


def tension(strain, rate=0.5, *, damping=2.0):
    """In N."""
    total = strain * damping - (rate
        + SIZE) * strain
    if total > 0:
        total = limited(total, most=1.0)
    elif rate:
        rate = total
    for each in range(3):
        total += each * each
        total -= 1
    return [total * s for s in (strain, rate)]


@cache
def limited(x, most):
    try:
        return min(x, most)
    except (TypeError, ValueError) as error:
        raise ArithmeticError(f"{x} is none") from error
'''


def fault(function, old, new, **options) -> Fault:
    """A fault in the example."""
    return Fault("example", function, old, new, **options)


def syntax(text: str) -> tuple[str, ...]:
    """What a text means: without layout and comments."""
    return module_syntax(text.encode())


# ---------------------------------------------------------------- matching
@pytest.mark.parametrize(
    ("function", "old", "new", "text", "becomes"),
    [
        ("", "3+1", "3", "3 + 1", "3"),
        ("", "SIZE = (3 + 1)", "SIZE = 5", "SIZE = 3 + 1", "SIZE = 5"),
        ("", "import math", "import math\nimport os", "import math\n", "import math\nimport os\n"),
        ("Line", "ends = 2", "ends = 3", "ends = 2", "ends = 3"),
        ("Line.length", "math.hypot( self.x,\n self.y )", "self.x", "math.hypot(self.x, self.y)", "self.x"),
        ("Line.length", "self.y", "self.x + 1", "self.y", "self.x + 1"),
        ("Line.length", "property", "cache", "@property", "@cache"),
        ("Line", "@property\ndef length(self): return math.hypot(self.x, self.y)", "length = ends",
         "@property\n    def length(self):\n        return math.hypot(self.x, self.y)", "length = ends"),
        ("tension", "(rate + SIZE) * strain", "rate", "(rate\n        + SIZE) * strain", "rate"),
        ("tension", "rate + SIZE", "rate * SIZE", "rate\n        + SIZE", "rate * SIZE"),
        ("tension", "strain * damping", "rate - damping", "strain * damping -", "(rate - damping) -"),
        ("tension", "each * each", "each or 1", "each * each", "each or 1"),
        ("tension", "total > 0", "total >= 0", "total > 0", "total >= 0"),
        ("tension", "rate=0.5", "rate=1.5", "rate=0.5", "rate=1.5"),
        ("tension", "damping=2.0", "damping=0", "damping=2.0", "damping=0"),
        ("tension", "most=1.0", "most=rate", "most=1.0", "most=rate"),
        ("tension", "total -= 1", "pass", "total -= 1", "pass"),
        ("tension", "total += each * each\ntotal -= 1", "pass", "total += each * each\n        total -= 1", "pass"),
        ("tension", "total -= 1", "if each:\n  break", "total -= 1", "if each:\n            break"),
        ("tension", "if rate: rate = total", "if SIZE: pass", "elif rate:\n        rate = total",
         "elif SIZE:\n        pass"),
        ("tension", "strain, rate", "rate, strain", "(strain, rate)", "(rate, strain)"),
        ("tension", "'In N.'", '"In kN."', '"""In N."""', '"""In kN."""'),
        ("limited", "cache", "property", "@cache", "@property"),
        ("limited", "(TypeError, ValueError)", "OSError", "(TypeError, ValueError)", "OSError"),
        ("limited", "f'{x} is none'", "'none'", 'f"{x} is none"', '"none"'),
    ],
)  # fmt: skip
def test_code_is_found_whatever_its_layout(function, old, new, text, becomes):
    """Expressions, statements, defaults, keywords, decorators: as if the text were replaced, and nothing around it."""
    assert EXAMPLE.count(text) == 1
    changed = fault(function, old, new).apply_to(EXAMPLE)
    assert syntax(changed) == syntax(EXAMPLE.replace(text, becomes))
    before, after = EXAMPLE.split(text)
    assert changed.startswith(before) and changed.endswith(after)


@pytest.mark.parametrize(
    ("function", "old", "new", "why"),
    [
        ("tension", "total", "0", "found 4 times, not once"),
        ("tension", "total * 2", "0", "found 0 times, not once"),
        ("Line", "self.y", "self.x", "found 0 times"),  # of its method, not its own
        ("", "each * each", "1", "found 0 times"),
        ("stress", "total", "0", "stress is defined 0 times"),
        ("tension", "total > 0", "totally > 0", "nothing defines totally"),
        ("tension", "total > ", "0", "neither an expression nor statements"),
        ("tension", "total -= 1", "", "write pass"),
        ("tension", "strain=3", "strain=4", "found 0 times"),  # a parameter without a default
        ("tension", "most=1.0", "least=1.0", "found 0 times"),  # as an assignment
        ("limited", "min(x, most)", "pass", "found 0 times"),  # no statement of its own
    ],
)
def test_what_is_not_there_or_not_alone_is_refused(function, old, new, why):
    """Nothing is planted at a guess; the message names file, function, both codes and the reason."""
    with pytest.raises(ValueError, match=re.escape(why)) as refusal:
        fault(function, old, new).apply_to(EXAMPLE)
    assert f"solvers/example.py, {function or 'outside functions'}: {old!r} -> {new!r}" in str(refusal.value)


def test_equal_places_are_distinguished_by_number():
    """The n-th in the order of the text; one more than there are is refused."""
    text = "def f(a):\n    return (a + 1) * (a\n        + 1) - (a + 1)\n"
    changed = [fault("f", "a + 1", "2", occurrence=n).apply_to(text).split("return ")[1] for n in (1, 2, 3)]
    assert changed == [
        "(2) * (a\n        + 1) - (a + 1)\n",
        "(a + 1) * (2) - (a + 1)\n",
        "(a + 1) * (a\n        + 1) - (2)\n",
    ]
    with pytest.raises(ValueError, match="found 3 times, not 4"):
        fault("f", "a + 1", "2", occurrence=4).apply_to(text)


def test_two_functions_of_one_name_are_refused():
    """A name that is defined twice addresses none of them."""
    with pytest.raises(ValueError, match="limited is defined 2 times"):
        fault("limited", "min(x, most)", "x").apply_to(EXAMPLE + "\n\ndef limited(x):\n    return min(x, most)\n")


# ---------------------------------------------------------------- renamed variables
@pytest.mark.parametrize(
    ("function", "old", "new", "same_as"),
    [
        ("tension", "force > 0", "force > 1", ("total > 0", "total > 1")),
        ("tension", "e * damping", "damping", ("strain * damping", "damping")),
        ("tension", "each * f", "f", None),  # two names do not stand for one
        ("tension", "f += e * g", "pass", None),
        ("tension", "e * e", "e", ("each * each", "each")),
        ("tension", "a * b - (c + SIZE) * a", "c", ("strain * damping - (rate + SIZE) * strain", "rate")),
        ("tension", "(rate + N) * strain", "0", None),  # a name of the module is not one of the function
        ("tension", "bounded(total, most=1.0)", "0", None),
        ("tension", "limited(total, least=1.0)", "0", None),
        ("tension", "force -= 1", "force = 3\nother = force", ("total -= 1", "total = 3\nother = total")),
        ("tension", "damp=2.0", "damp=3.0", ("damping=2.0", "damping=3.0")),
        ("tension", "[force * r for r in (strain, rate)]", "[r for r in (force,)]",
         ("[total * s for s in (strain, rate)]", "[s for s in (total,)]")),
        ("Line.length", "line.y", "line.x", ("self.y", "self.x")),
        ("Line.length", "self.z", "self.x", None),
        ("limited", "ArithmeticError(f'{x} is none')", "e", None),  # e is nowhere else in the fault
    ],
)  # fmt: skip
def test_local_variables_may_have_other_names(function, old, new, same_as):
    """Unknown names stand for local ones, each for one, and the new code takes them over; other names do not."""
    if same_as is None:
        with pytest.raises(ValueError, match=r"found 0 times|nothing defines"):
            fault(function, old, new).apply_to(EXAMPLE)
    else:
        wanted = fault(function, *same_as).apply_to(EXAMPLE)
        assert syntax(fault(function, old, new).apply_to(EXAMPLE)) == syntax(wanted)


def test_renamed_variables_are_found_where_no_other_code_fits():
    """Code with the names themselves comes first; where several places fit a renamed one, none is taken."""
    assert "return min(most, most)" in fault("limited", "min(x, most)", "min(most, most)").apply_to(EXAMPLE)
    two = EXAMPLE.replace("return min(x, most)", "return min(x, most) + min(most, x)")
    assert "x + min(most, x)" in fault("limited", "min(x, most)", "x").apply_to(two)
    with pytest.raises(ValueError, match="found 2 times"):
        fault("limited", "min(a, b)", "a").apply_to(two)


def test_names_of_the_new_code_alone_are_found_in_other_code():
    """Variables of the new code that the old one does not have are known from other code of the function."""
    other = fault("tension", "total > 0", "rate > 0", where="rate + SIZE")
    assert "if rate > 0" in other.apply_to(EXAMPLE)
    renamed = EXAMPLE.replace("rate", "speed").replace("total", "force")
    assert "if speed > 0" in other.apply_to(renamed)
    for where, why in (("rate + SIZES", "found 0 times"), ("", "nothing defines rate"), ("speed", r"found \d times")):
        with pytest.raises(ValueError, match=why):
            replace(other, where=where).apply_to(renamed)


# ---------------------------------------------------------------- three ways to plant
WAYS = Fault("catenary.regimes", "hanging_length", "2 * h / (1 + f.sqrt(1 + 2 * e * h))", "1 * h")


def test_a_fault_is_the_same_on_disk_in_memory_and_in_place(tmp_path, monkeypatch):
    """Each plants it where it should, and nowhere else; the solvers are whole again afterwards."""
    length = lambda module: module.hanging_length(SCALAR, 3.0, 0.1)
    true, finders = length(catenary_regimes), list(sys.meta_path)
    copy = tmp_path / WAYS.path
    copy.parent.mkdir(parents=True)
    copy.write_text((ROOT / WAYS.path).read_text(encoding="utf-8"), encoding="utf-8")
    WAYS.write_to(tmp_path)
    assert copy.read_text(encoding="utf-8") == WAYS.apply_to((ROOT / WAYS.path).read_text(encoding="utf-8"))
    with planted(WAYS) as faulty:
        assert length(faulty.catenary.regimes) == 3.0 and length(catenary_regimes) == true
        assert faulty.catenary.solve.regimes is faulty.catenary.regimes  # what imports it has it, too
    with monkeypatch.context() as patch:
        plant_in_place(WAYS, patch)
        assert length(catenary_regimes) == 3.0
    assert length(catenary_regimes) == true != 3.0
    assert sys.meta_path == finders and not any(name.startswith("planted") for name in sys.modules)
    with planted(replace(WAYS, new="2 * h")) as faulty:  # nothing of the first one is left
        assert length(faulty.catenary.regimes) == 6.0


def test_threads_that_plant_at_once_do_not_disturb_each_other():
    """Trees are read one at a time: up to 3.12 Python fails where another thread goes on while a tree is built."""
    thresholds, texts = gc.get_threshold(), {d: (ROOT / d.fault.path).read_text("utf-8") for d in CATALOGUE[::60]}
    yield_to_others = lambda *_: time.sleep(0)
    gc.callbacks.append(yield_to_others)
    gc.set_threshold(50)
    try:
        with ThreadPoolExecutor(4) as pool:
            changed = list(pool.map(lambda d: d.fault.apply_to(texts[d]), texts))
    finally:
        gc.set_threshold(*thresholds)
        gc.callbacks.remove(yield_to_others)
    assert all(text != texts[d] for d, text in zip(texts, changed, strict=True))


def test_properties_are_planted_in_place(monkeypatch):
    """The function behind a property, as behind a plain method."""
    cable = importlib.import_module("solvers.common.properties").CableProperties(1e6, 3.0, 10.0)
    true = cable.area
    plant_in_place(
        Fault("common.properties", "CableProperties.area", "math.pi * self.diameter**2 / 4", "math.pi"), monkeypatch
    )
    assert cable.area == math.pi != true


def test_what_is_outside_the_body_is_not_planted_in_place(monkeypatch):
    """A default is not in the code of its function: a fault that would do nothing is refused."""
    other = Fault("cable.system", "cable_system", "nodes=50", "nodes=20")
    with pytest.raises(ValueError, match="changes nothing in the body"):
        plant_in_place(other, monkeypatch)


def test_modules_of_a_subpackage_are_planted_in_memory(tmp_path, monkeypatch):
    """A module is named by its path with dots, and what imports it gets the one with the fault."""
    room = tmp_path / "solvers" / "room"
    room.mkdir(parents=True)
    (room / "__init__.py").write_text("from .part import double\n")
    (room / "part.py").write_text("def double(x):\n    return 2 * x\n")
    (tmp_path / "solvers" / "top.py").write_text("from .room import double\n")
    monkeypatch.setattr("verification.tools.planting.ROOT", tmp_path)
    with planted(Fault("room.part", "double", "2 * x", "3 * x")) as faulty:
        assert faulty.top.double(2) == faulty.room.double(2) == faulty.room.part.double(2) == 6


# ---------------------------------------------------------------- faults by rule
def test_a_change_of_the_text_is_addressed_by_the_code_around_it():
    """The smallest unit that is more than a name or number; of equal ones, by its number; what is none is refused."""

    def at(text, piece, new):
        start = EXAMPLE.encode().index(text.encode()) + text.index(piece)
        return fault_at("example", EXAMPLE, start, start + len(piece), new)

    assert at("each * each", "*", "/") == fault("tension", "each * each", "each / each")
    assert at("+ SIZE", "+", "-") == fault("tension", "rate + SIZE", "rate - SIZE")
    assert at("damping=2.0", "2.0", "3.0") == fault("tension", "damping=2.0", "damping=3.0")
    assert at("total -= 1", "1", "2") == fault("tension", "total -= 1", "total -= 2")
    assert at("SIZE = 3", "3", "4") == fault("", "3 + 1", "4 + 1")
    assert at("self.y)", "y", "x") == fault("Line.length", "self.y", "self.x")
    text = "def f(a, b):\n    return a * b + 2 * (a * b)\n"
    second = fault_at("example", text, text.rindex("*"), text.rindex("*") + 1, "/")
    assert second == fault("f", "a * b", "a / b", occurrence=2)
    with pytest.raises(ValueError, match="can become"):
        at("return [", "return", "else")


def test_every_sign_of_a_function_is_a_fault():
    """Each term of its sums once, and each value of an entry."""
    faults = sign_faults("cable.loads", ("transverse_drag",))
    text = (ROOT / "solvers/cable/loads.py").read_text(encoding="utf-8")
    assert len({syntax(each.apply_to(text)) for each in faults}) == len(faults) >= 6
    assert {each.function for each in faults} == {"transverse_drag"}
    assert sign_faults("cable.loads", ("transverse_drag",), every=4) == faults[::4]


# ---------------------------------------------------------------- the catalogue, in functions that were rewritten
FILES = {"spans": spans, "networks": networks, "cables": cables, "dynamics": dynamics}
PER_FILE = 3  # functions of each file of the catalogue by default; all in the long version


def chosen(deep: bool) -> list[tuple[str, str]]:
    """(module, function) of those that are rewritten: at random from each file of the catalogue, or all."""
    draw, pairs = random.Random(2026), []
    for file in FILES.values():
        here = sorted({(d.fault.module, d.fault.function) for d in file.DEFECTS if d.fault.function})
        pairs += here if deep else draw.sample(here, PER_FILE)
    return sorted(set(pairs))


def find(tree, function: str):
    """The definition with this qualified name."""
    for part in function.split("."):
        tree = next(n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef | ast.ClassDef) and n.name == part)
    return tree


def variables(text: str, function: str) -> list[str]:
    """Parameters and variables of a function as Python compiles it, those of its lambdas and loops included."""
    code = compile(text, "module", "exec")
    for part in function.split("."):
        code = next(c for c in code.co_consts if isinstance(c, CodeType) and c.co_name == part)
    names, codes = set(), [code]
    while codes:
        code = codes.pop()
        names |= {*code.co_varnames, *code.co_cellvars}
        codes += [c for c in code.co_consts if isinstance(c, CodeType)]
    return sorted(name for name in names if name.isidentifier() and name != "__class__")


def renamed(text: str, function: str, names) -> str:
    """The text with variables of one function renamed."""
    tree = ast.parse(text)
    for node in (node for part in ast.iter_child_nodes(find(tree, function)) for node in ast.walk(part)):
        for place in ("id", "arg", "name"):
            is_variable = isinstance(node, ast.Name | ast.arg | ast.FunctionDef | ast.ExceptHandler)
            if is_variable and getattr(node, place, None) in names:
                setattr(node, place, f"{getattr(node, place)}_renamed")
    return ast.unparse(tree)


def rewrapped(text: str) -> str:
    """The same code laid out anew: no comments, each statement on one line, but each item in brackets on its own."""
    rows, depth, breaks = ast.unparse(ast.parse(text)).splitlines(keepends=True), 0, []
    for token in tokenize.generate_tokens(iter(rows).__next__):
        if token.type == tokenize.OP:
            depth += (token.string in "([{") - (token.string in ")]}")
            if token.string == "," and depth:
                breaks.append(token.end)
    for row, column in reversed(breaks):
        rows[row - 1] = f"{rows[row - 1][:column]}\n{rows[row - 1][column:]}"
    return "".join(rows)


@pytest.fixture(scope="module")
def functions(deep) -> list[tuple[str, str]]:
    """(module, function) of those that are rewritten."""
    return chosen(deep)


def test_defects_stay_in_functions_that_are_laid_out_anew(functions):
    """Without comments, with all lines joined or broken, each defect is the same mistake."""
    for defect in CATALOGUE:
        if (defect.module, defect.fault.function) in functions:
            text = (ROOT / defect.fault.path).read_text(encoding="utf-8")
            wanted = syntax(defect.applied_to(text))
            for layout in (ast.unparse(ast.parse(text)), rewrapped(text)):
                assert layout != text and syntax(layout) == syntax(text)
                assert syntax(defect.applied_to(layout)) == wanted, defect.name


def test_defects_stay_in_functions_whose_variables_are_renamed(functions, deep):
    """Each variable in turn, by default every third, and the lines broken elsewhere: the same mistake, renamed."""
    assert len(functions) >= 10
    count = 0
    for module, function in functions:
        text = (ROOT / Fault(module, function, "", "").path).read_text(encoding="utf-8")
        defects = [d for d in CATALOGUE if (d.module, d.fault.function) == (module, function)]
        for name in variables(text, function)[:: 1 if deep else 3]:
            other = rewrapped(renamed(text, function, {name}))
            assert syntax(other) != syntax(text)
            for defect in defects:
                count += 1
                wanted = renamed(defect.applied_to(text), function, {name})
                assert syntax(defect.applied_to(other)) == syntax(wanted), (defect.name, name)
    assert count >= (50 if deep else 20)
