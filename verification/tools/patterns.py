"""Find code in a function by its syntax, whatever its layout and the names of local variables."""

from __future__ import annotations

import ast
import builtins
import textwrap
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import cache, lru_cache

_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)
_DEFINITIONS = (*_FUNCTIONS, ast.ClassDef)
_VARIABLES = {ast.Name: "id", ast.arg: "arg", ast.ExceptHandler: "name", ast.FunctionDef: "name", ast.MatchAs: "name"}


# ---------------------------------------------------------------- texts
def parse_expression(text: str) -> ast.expr | None:
    """Return the expression that a text is, on one line or several, or None where it is none."""
    try:
        return ast.parse(f"(\n{text}\n)", mode="eval").body if text.strip() else None
    except SyntaxError:
        return None


def parse_statements(text: str) -> list[ast.stmt]:
    """Return the statements of a text. Raises ValueError where it has none."""
    try:
        statements = ast.parse(textwrap.dedent(text)).body
    except SyntaxError as error:
        raise ValueError(f"{text!r} is neither an expression nor statements: {error.msg}") from error
    if not statements:
        raise ValueError(f"{text!r} has no statement: write pass to leave out what is there")
    return statements


def same_code(one: str, other: str) -> bool:
    """Whether two texts are the same expression or the same statements."""
    try:
        codes = [parse_expression(text) or ast.Module(parse_statements(text), []) for text in (one, other)]
    except ValueError:
        return False
    return ast.dump(codes[0]) == ast.dump(codes[1])


@lru_cache(64)  # faults are planted in one text many times
def module_syntax(source: bytes) -> tuple[str, ...]:
    """Return the syntax of each statement of a module, without layout and comments. Raises SyntaxError.

    Statements are kept by their text: of two texts that differ in one function the others are not read again.
    """
    starts, begin, parts = line_starts(source), 0, []
    for node in ast.parse(source).body:
        end = starts[node.end_lineno - 1] + node.end_col_offset
        parts.append(_statement_syntax(source[begin:end].lstrip(b" ;")))
        begin = end
    return tuple(parts)


@cache
def _statement_syntax(text: bytes) -> str:
    return ast.dump(ast.parse(text))


def line_starts(source: bytes) -> list[int]:
    """Return the offset of each line of a text, in bytes."""
    starts = [0]
    for line in source.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    return starts


# ---------------------------------------------------------------- functions and their names
def walk(scope: ast.AST) -> Iterator[tuple[ast.AST, str, int | None, ast.AST]]:
    """Yield (parent, field, index, node) for all of a function, and for what a class or a module does by itself.

    The inside of formatted strings is left out, as Python 3.11 does not say where it stands.
    """
    for name, value in ast.iter_fields(scope):
        for index, node in enumerate(value) if isinstance(value, list) else [(None, value)]:
            if isinstance(node, ast.AST):
                yield scope, name, index, node
                apart = isinstance(node, _DEFINITIONS) and not isinstance(scope, _FUNCTIONS)
                if not apart and not isinstance(node, ast.JoinedStr):
                    yield from walk(node)


def find_definitions(tree: ast.Module, name: str) -> list[ast.AST]:
    """Return the module and each class and function on the way to the one with this qualified name, "" for none.

    Raises ValueError unless each is defined once.
    """
    path: list[ast.AST] = [tree]
    for part in name.split(".") if name else ():
        defined = [node for *_, node in walk(path[-1]) if isinstance(node, _DEFINITIONS) and node.name == part]
        if len(defined) != 1:
            raise ValueError(f"{name} is defined {len(defined)} times, not once")
        path += defined
    return path


def names_in(nodes: Iterable[ast.AST], bound: bool = False) -> set[str]:
    """Return every variable, parameter and function named below the nodes, or those bound there; no attributes."""
    below = [child for node in nodes for child in ast.walk(node) if type(child) in _VARIABLES]
    names = {getattr(node, _VARIABLES[type(node)]) for node in below
             if not (bound and isinstance(getattr(node, "ctx", None), ast.Load))}  # fmt: skip
    return names - {None}


def local_names(scope: ast.AST) -> set[str]:
    """Return parameters and variables of a function; of a class or module those of its lambdas and comprehensions."""
    if not isinstance(scope, _FUNCTIONS):
        inner = (node for *_, node in walk(scope) if isinstance(node, ast.Lambda | ast.comprehension))
        return names_in(inner, bound=True)
    foreign = {name for node in ast.walk(scope) if isinstance(node, ast.Global | ast.Nonlocal) for name in node.names}
    return names_in(ast.iter_child_nodes(scope), bound=True) - foreign


def undefined_names(new: list[ast.AST], path: list[ast.AST]) -> set[str]:
    """Return the names in new code that neither it, nor its function, its module or Python defines."""
    known = {*dir(builtins), "__file__", "__name__"} | names_in(new, bound=True) | names_in(path[1:])
    for *_, node in walk(path[0]):
        if isinstance(node, ast.Import | ast.ImportFrom):
            known |= {alias.asname or alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, _DEFINITIONS) or isinstance(getattr(node, "ctx", None), ast.Store):
            known.add(getattr(node, "name", getattr(node, "id", None)))
    return names_in(new) - known


# ---------------------------------------------------------------- places
@dataclass(frozen=True)
class Place:
    """Nodes that follow each other in a field of their parent.

    names : the local name that each name of the pattern stands for, where variables were renamed
    """

    parent: ast.AST
    field: str
    index: int | None
    nodes: list[ast.AST]
    names: dict[str, str] = field(default_factory=dict)

    def put(self, new: list[ast.AST]):
        """Replace the nodes in the tree."""
        if self.index is None:
            setattr(self.parent, self.field, new[0])
        else:
            getattr(self.parent, self.field)[self.index : self.index + len(self.nodes)] = new

    def span(self, starts: list[int]) -> tuple[int, int]:
        """Return (start, end) in the text, in bytes, from the offsets of its lines; decorators are included."""
        first, last = self.nodes[0], self.nodes[-1]
        begins = [starts[node.lineno - 1] + node.col_offset for node in (first, *getattr(first, "decorator_list", ()))]
        begin = min(begins) - (min(begins) < begins[0])  # a decorator begins with its @
        return begin, starts[last.end_lineno - 1] + last.end_col_offset


class Pattern:
    """What is looked for, and what takes its place.

    An expression, statements in a row, or ``name=value`` of a call, of a parameter with a default or of an assignment.
    """

    def __init__(self, old: str, new: str):
        expressions = parse_expression(old), parse_expression(new)
        self.is_expression = None not in expressions
        self.old, self.new = ([[e] for e in expressions] if self.is_expression
                              else [parse_statements(text) for text in (old, new)])  # fmt: skip
        self.keyword = _assigned(self.old) if _assigned(self.old) == _assigned(self.new) else None

    def places(self, scope: ast.AST, names: dict[str, str] | None = None) -> list[Place]:
        """Return the places in a function, in order; those with renamed variables only where no other is found.

        names : what names of the pattern stand for, where that is known
        """
        known, here, wanted = names or {}, names_in(ast.iter_child_nodes(scope)), names_in(self.old)
        matches = list(self._matches(scope, _Names(known, known, ())))
        if not matches and wanted - here - known.keys():
            matches = list(
                self._matches(scope, _Names(known, wanted - here | known.keys(), local_names(scope) - wanted))
            )
        return sorted(matches, key=lambda place: (place.nodes[0].lineno, place.nodes[0].col_offset))

    def _matches(self, scope, names) -> Iterator[Place]:
        for parent, name, index, nodes in self._candidates(scope):
            match = names.copy()
            if _agree(self.old, nodes, match):
                yield Place(parent, name, index, nodes, match.names)
        for parent, name, index, argument, value in _keywords(scope) if self.keyword else ():
            match = names.copy()
            same = argument == self.keyword if isinstance(parent, ast.keyword) else match(self.keyword, argument)
            if same and _agree(self.old[0].value, value, match):
                yield Place(parent, name, index, [value], match.names)

    def _candidates(self, scope):
        if self.is_expression:
            yield from ((parent, name, index, [node]) for parent, name, index, node in walk(scope)
                        if isinstance(node, ast.expr))  # fmt: skip
            return
        count = len(self.old)
        bodies = [(scope, "body", scope.body)]
        bodies += [(node, name, body) for *_, node in walk(scope) for name, body in ast.iter_fields(node)
                   if isinstance(body, list) and body and isinstance(body[0], ast.stmt)]  # fmt: skip
        for parent, name, body in bodies:
            yield from ((parent, name, i, body[i : i + count]) for i in range(len(body) - count + 1))

    def replacement(self, place: Place) -> list[ast.AST]:
        """Return the new nodes for a place, with the names that its variables have there."""
        new = self.new if self.is_expression or isinstance(place.nodes[0], ast.stmt) else [self.new[0].value]
        return [_renamed(node, place.names) for node in new]


class _Names:
    """Says whether a name of the pattern may be a name of the function: itself, or a local one in its place."""

    def __init__(self, names: dict[str, str], wildcards: Iterable[str], free: Iterable[str]):
        self.names, self.wildcards, self.free = dict(names), wildcards, free

    def copy(self) -> _Names:
        """Return one that knows the same, and learns for itself."""
        return _Names(self.names, self.wildcards, self.free)

    def __call__(self, wanted: str | None, name: str | None) -> bool:
        if wanted not in self.wildcards:
            return wanted == name
        if wanted not in self.names and name in self.free and name not in self.names.values():
            self.names[wanted] = name
        return self.names.get(wanted) == name


def _agree(wanted, node, match) -> bool:
    """Whether two pieces of syntax are the same up to what ``match`` allows of their names; layout is not looked at."""
    if type(wanted) is not type(node):
        return False
    if isinstance(wanted, list):
        return len(wanted) == len(node) and all(_agree(*pair, match) for pair in zip(wanted, node, strict=True))
    if not isinstance(wanted, ast.AST):
        return repr(wanted) == repr(node)
    variable = _VARIABLES.get(type(wanted))
    return all(
        match(*pair) if name == variable else _agree(*pair, match)
        for name in wanted._fields
        if name not in ("kind", "type_comment")
        for pair in [(getattr(wanted, name, None), getattr(node, name, None))]
    )


def _assigned(nodes: list[ast.AST]) -> str | None:
    """The name in ``name = value``, where that is all there is."""
    match nodes:
        case [ast.Assign(targets=[ast.Name(id=name)])]:
            return name
    return None


def _keywords(scope) -> Iterator[tuple[ast.AST, str, int | None, str, ast.expr]]:
    """Arguments by name of calls, and parameters with defaults: where the value stands, its name and itself."""
    for *_, node in walk(scope):
        if isinstance(node, ast.keyword) and node.arg:
            yield node, "value", None, node.arg, node.value
        elif isinstance(node, ast.arguments):
            both = [*node.posonlyargs, *node.args]
            defaults = list(zip(both[len(both) - len(node.defaults) :], node.defaults, strict=True))
            by_name = zip(node.kwonlyargs, node.kw_defaults, strict=True)
            for name, pairs in (("defaults", defaults), ("kw_defaults", by_name)):
                yield from ((node, name, i, a.arg, value) for i, (a, value) in enumerate(pairs) if value is not None)


def _renamed(node: ast.AST, names: dict[str, str]) -> ast.AST:
    """The node with its variables called by other names, in place."""
    for child in ast.walk(node):
        variable = _VARIABLES.get(type(child))
        if variable and getattr(child, variable) in names:
            setattr(child, variable, names[getattr(child, variable)])
    return node


# ---------------------------------------------------------------- the other way round
def units_around(tree: ast.Module, source: bytes, start: int, end: int) -> Iterator[tuple[str, int, int, str]]:
    """Yield (function, begin, end, what to write before) of each unit that a fault can name, the smallest first.

    Units are expressions that are no bare name or number, values with the name of their argument, and statements.
    """
    starts, path, scope = line_starts(source), [], tree
    around = lambda place: (lambda span: span[0] <= start and end <= span[1])(place.span(starts))
    located = lambda scope: [Place(*at, [node]) for *at, node in walk(scope) if hasattr(node, "lineno")]
    while not isinstance(scope, _FUNCTIONS):
        inner = [p.nodes[0] for p in located(scope) if isinstance(p.nodes[0], _DEFINITIONS) and around(p)]
        if not inner:
            break
        scope = inner[0]
        path.append(scope.name)
    named = {id(value): f"{name}=" for *_, name, value in _keywords(scope)}
    units = []
    for place in located(scope):
        node = place.nodes[0]
        if isinstance(node, ast.expr | ast.stmt) and around(place):
            begin, stop = place.span(starts)
            bare = isinstance(node, ast.Name | ast.Constant) or isinstance(getattr(node, "operand", None), ast.Constant)
            lead = " " * node.col_offset if isinstance(node, ast.stmt) else named.get(id(node), "") if bare else ""
            if not bare or lead:
                units.append((".".join(path), begin, stop, lead))
    yield from sorted(units, key=lambda unit: unit[2] - unit[1])
