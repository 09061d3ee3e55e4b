"""Is the node-by-node elimination right? Random, ill-scaled, stiff and singular chains against the dense matrix."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.linalg import cython_blas

from solvers.numerics.lu import blas_by_address
from solvers.numerics.lu import bordered as block_chain
from solvers.numerics.lu.bordered import BlockChain
from verification import ROOT

from ..reference import EPS

BACKWARD = 100 * EPS
"""Of |A| |x| + |b|, row by row, in well-scaled chains: elimination with row exchanges leaves a few eps."""

ORDERS = 20
"""Where the scales of the rows differ, elimination loses digits of the small ones, by the order of its pivots: LAPACK
loses up to sixty times as many in another order of rows and columns. Allowed is what it loses in the worst of these."""

FORWARD = 100
"""Difference from the dense solution in units of eps times the condition of the matrix with its rows equilibrated."""


@dataclass(frozen=True)
class Chain:
    """Blocks and a right-hand side as BlockChain takes them; each a tuple (start, cells, end, border)."""

    blocks: tuple
    right: tuple

    @classmethod
    def random(cls, nodes, n, p, k, seed=0):
        """n unknowns a node, p start rows, k full rows, all of order one."""
        rng = np.random.default_rng(seed)
        shapes = (p, n), (2, nodes - 1, n, n), (n - p - k, n), (k, nodes, n)
        right = rng.normal(size=p), rng.normal(size=(nodes - 1, n)), rng.normal(size=n - p - k), rng.normal(size=k)
        return cls(tuple(rng.normal(size=shape) for shape in shapes), right)

    def scaled(self, decades, seed=1):
        """Every row and every column multiplied by a power of ten from -decades to decades."""
        rng = np.random.default_rng(seed)
        (start, cells, end, border), right = self.blocks, self.right
        nodes, n = cells.shape[1] + 1, cells.shape[2]
        rows = [10.0 ** rng.uniform(-decades, decades, part.shape) for part in right]
        columns = 10.0 ** rng.uniform(-decades, decades, (nodes, n))
        of_cells = np.stack([columns[:-1, None], columns[1:, None]])
        blocks = (
            rows[0][:, None] * start * columns[0],
            rows[1][..., None] * cells * of_cells,
            rows[2][:, None] * end * columns[-1],
            rows[3][:, None, None] * border * columns,
        )
        return Chain(blocks, tuple(r * b for r, b in zip(rows, right, strict=True)))

    def dense(self):
        """The matrix (N n, N n) and the right-hand side, as drawn in the docstring of BlockChain."""
        start, cells, end, border = self.blocks
        p, n, nodes = len(start), cells.shape[2], cells.shape[1] + 1
        A = np.zeros((nodes * n, nodes * n))
        A[:p, :n] = start
        for i in range(nodes - 1):
            rows = slice(p + i * n, p + (i + 1) * n)
            A[rows, i * n : (i + 1) * n], A[rows, (i + 1) * n : (i + 2) * n] = cells[0, i], cells[1, i]
        last = p + (nodes - 1) * n
        A[last : last + len(end), -n:] = end
        if len(border):
            A[last + len(end) :] = border.reshape(len(border), -1)
        return A, np.concatenate([part.ravel() for part in self.right])

    def solved(self) -> np.ndarray:
        factors = BlockChain(*self.blocks)
        assert not factors.singular
        return factors.solve(*self.right).ravel()


def stiff(nodes, growth) -> Chain:
    """A two-point problem with two modes that grow along the chain and two that decay, each bounded at its own end."""
    rng = np.random.default_rng(7)
    modes = rng.normal(size=(4, 4))
    step = modes @ np.diag([growth, growth / 2, 1 / growth, 2 / growth]) @ np.linalg.inv(modes)
    cells = np.stack([np.broadcast_to(-step, (nodes - 1, 4, 4)), np.broadcast_to(np.eye(4), (nodes - 1, 4, 4))])
    blocks = rng.normal(size=(2, 4)), cells, rng.normal(size=(2, 4)), np.zeros((0, nodes, 4))
    return Chain(blocks, (rng.normal(size=2), rng.normal(size=(nodes - 1, 4)), rng.normal(size=2), np.zeros(0)))


SHAPES = {  # nodes, n, p, k
    "two nodes": (2, 3, 1, 0),
    "a cable in its plane": (9, 8, 4, 0),
    "closed by mean places": (9, 8, 4, 2),
    "closed in space": (7, 18, 9, 3),
    "one full row, no other end": (5, 4, 3, 1),
    "all rows at the start": (5, 4, 4, 0),
    "all rows at the end": (5, 4, 0, 0),
    "one unknown a node": (12, 1, 1, 0),
    "one node": (1, 6, 3, 0),
    "one node, closed": (1, 6, 3, 1),
    "many nodes": (300, 3, 2, 1),
}
CHAINS = {
    **{name: Chain.random(*shape) for name, shape in SHAPES.items()},
    **{f"{name}, ill-scaled": Chain.random(*shape, seed=2).scaled(6) for name, shape in SHAPES.items()},
    "growing modes": stiff(60, 4.0),
    "growing fast": stiff(40, 1e6),
}


def backward_error(chain, x) -> float:
    """Largest |A x - b| over |A| |x| + |b|, by rows; not a number gives inf."""
    A, b = chain.dense()
    error = float((abs(A @ x - b) / (abs(A) @ abs(x) + abs(b))).max())
    return error if error == error else np.inf


def lapack_error(chain) -> float:
    """The largest ``backward_error`` of LAPACK on the whole matrix, its rows and columns in orders that are drawn."""
    (A, b), rng, errors, x = chain.dense(), np.random.default_rng(0), [], np.empty(chain.dense()[1].size)
    for _ in range(ORDERS):
        rows, columns = rng.permutation(b.size), rng.permutation(b.size)
        x[columns] = np.linalg.solve(A[np.ix_(rows, columns)], b[rows])
        errors.append(backward_error(chain, x))
    return max(errors)


@pytest.mark.parametrize("name", CHAINS)
def test_the_solution_meets_every_row(name):
    """A x = b to rounding in every row; with rows and columns of all scales as well as LAPACK on the whole matrix."""
    chain = CHAINS[name]
    allowed = BACKWARD
    if "scaled" in name:
        allowed = max(allowed, lapack_error(chain))
    assert backward_error(chain, chain.solved()) <= allowed


@pytest.mark.parametrize("name", [name for name in CHAINS if "scaled" not in name])
def test_the_solution_is_that_of_the_dense_matrix(name):
    """x is that of LAPACK on the whole matrix as far as its condition allows."""
    chain = CHAINS[name]
    A, b = chain.dense()
    size = abs(A).max(axis=1)
    wanted, x = np.linalg.solve(A, b), chain.solved()
    allowed = FORWARD * EPS * np.linalg.cond(A / size[:, None])
    assert np.linalg.norm(x - wanted) <= allowed * np.linalg.norm(wanted)


@pytest.mark.parametrize("name", SHAPES)
def test_factors_in_single_precision(name):
    """Of blocks in single precision: its rounding times the condition, in numbers of double precision."""
    chain = CHAINS[name]
    A, b = chain.dense()
    factors = BlockChain(*(part.astype(np.float32) for part in chain.blocks))
    x, wanted = factors.solve(*chain.right), np.linalg.solve(A, b)
    allowed = FORWARD * np.finfo(np.float32).eps * np.linalg.cond(A / abs(A).max(axis=1)[:, None])
    assert x.dtype == float and not factors.singular
    assert np.linalg.norm(x.ravel() - wanted) <= allowed * np.linalg.norm(wanted)


def test_factors_serve_many_right_hand_sides():
    """A second right-hand side finds its own solution, and the first finds the same again."""
    chain = CHAINS["closed by mean places"]
    factors = BlockChain(*chain.blocks)
    first = factors.solve(*chain.right)
    second = factors.solve(*(2 * part for part in chain.right))
    again = factors.solve(*chain.right)
    assert np.array_equal(first, again) and np.array_equal(second, 2 * first)  # doubling is exact


def test_blocks_and_right_hand_sides_are_left_as_they_are():
    """Neither factorising nor solving writes into its arguments."""
    chain = Chain.random(5, 6, 3, 2)
    before = [part.copy() for part in (*chain.blocks, *chain.right)]
    chain.solved()
    assert all(np.array_equal(a, b) for a, b in zip(before, (*chain.blocks, *chain.right), strict=True))


def test_without_compiling_it_solves_as_well():
    """With NUMBA_DISABLE_JIT, as for a debugger, the same file runs interpreted."""
    text = (
        "import numpy as np\n"
        "from solvers.numerics.lu import bordered as block_chain\n"
        "from verification.numerics.test_bordered import BACKWARD, CHAINS, backward_error\n"
        "assert not hasattr(block_chain._solve, 'py_func')\n"
        "chain = CHAINS['closed in space']\n"
        "assert backward_error(chain, chain.solved()) <= BACKWARD\n"
    )
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1"}
    run = subprocess.run([sys.executable, "-c", text], cwd=ROOT, env=environment, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr


@pytest.mark.parametrize("name", CHAINS)
def test_compiled_loops_are_those_on_the_page(name, monkeypatch):
    """Interpreted, they give the same bits."""
    chain = CHAINS[name]
    compiled = chain.solved()
    for loop in ("_eliminate", "_solve"):
        monkeypatch.setattr(block_chain, loop, getattr(block_chain, loop).py_func)
    assert np.array_equal(chain.solved(), compiled)


def test_a_build_with_longer_integers_is_refused(monkeypatch):
    """BLAS with integers of 64 bits would read past those of 32 that it is given."""
    monkeypatch.setitem(cython_blas.__pyx_capi__, "dgemm", "void (char *, char *, int64_t *, ...)")
    with pytest.raises(ImportError, match="64-bit integers"):
        blas_by_address.external(cython_blas, "dgemm", 13)


REFUSED = {
    "a cell too few": lambda blocks, right: blocks.__setitem__(1, blocks[1][:, 1:]),
    "a cell too many": lambda blocks, right: blocks.__setitem__(1, np.repeat(blocks[1], 2, axis=1)),
    "a cell too few in parts": lambda blocks, right: blocks.__setitem__(1, [blocks[1][:, :2], blocks[1][:, 3:]]),
    "cells with fewer unknowns": lambda blocks, right: blocks.__setitem__(1, blocks[1][..., 1:]),
    "an end row too few": lambda blocks, right: blocks.__setitem__(2, blocks[2][1:]),
    "full rows with fewer unknowns": lambda blocks, right: blocks.__setitem__(3, blocks[3][..., 1:]),
    "a start row too few on the right": lambda blocks, right: right.__setitem__(0, right[0][1:]),
    "a cell too few on the right": lambda blocks, right: right.__setitem__(1, right[1][1:]),
    "an end row too many on the right": lambda blocks, right: right.__setitem__(2, np.ones(9)),
    "full rows too many on the right": lambda blocks, right: right.__setitem__(3, np.ones(9)),
}


@pytest.mark.parametrize("spoil", REFUSED.values(), ids=REFUSED)
def test_blocks_that_do_not_fit_are_refused(spoil):
    """Compiled loops do not look at their indices: a block of another shape would be read past its end."""
    chain = Chain.random(6, 5, 2, 1)
    blocks, right = list(chain.blocks), list(chain.right)
    spoil(blocks, right)
    with pytest.raises(ValueError, match=r"must be|do not lie between"):
        BlockChain(*blocks).solve(*right)


LAYOUTS = {
    "by columns": np.asfortranarray,
    "backwards": lambda part: part[tuple(slice(None, None, -1) for _ in part.shape)].copy()[
        tuple(slice(None, None, -1) for _ in part.shape)
    ],
    "bytes swapped": lambda part: part.astype(part.dtype.newbyteorder()),
}


@pytest.mark.parametrize("layout", LAYOUTS.values(), ids=LAYOUTS)
def test_any_layout_in_memory_is_the_same_chain(layout):
    """Blocks and right-hand sides by columns, backwards or in the other byte order give the same bits."""
    chain = CHAINS["closed by mean places"]
    other = Chain(*(tuple(map(layout, parts)) for parts in (chain.blocks, chain.right)))
    assert np.array_equal(other.solved(), chain.solved())


SINGULAR = {
    "an end row of zeros": lambda c: c.blocks[2].__setitem__(0, 0.0),
    "a full row of zeros": lambda c: c.blocks[3].__setitem__(0, 0.0),
    "a field that no row sees": lambda c: [
        c.blocks[0].__setitem__((slice(None), 1), 0.0),
        c.blocks[1].__setitem__((0, 0, slice(None), 1), 0.0),
        c.blocks[3].__setitem__((slice(None), 0, 1), 0.0),
    ],
    "not a number": lambda c: c.blocks[1].__setitem__((0, 3, 0, 0), np.nan),
}


@pytest.mark.parametrize("spoil", SINGULAR.values(), ids=SINGULAR)
def test_a_singular_chain_is_called_singular(spoil):
    """Rows of zeros, a field that nothing determines, and a number that is none."""
    chain = Chain.random(6, 5, 2, 1)
    spoil(chain)
    with np.errstate(all="ignore"):  # as the solver calls it
        assert BlockChain(*chain.blocks).singular


def test_an_empty_column_is_singular_without_full_rows():
    """A chain is singular where a node's column is empty, although the elimination runs through to its end."""
    chain = Chain.random(6, 5, 2, 0)
    start, cells, _, _ = chain.blocks
    start[:, 1] = cells[0, 0, :, 1] = 0.0
    assert BlockChain(*chain.blocks).singular and not BlockChain(*Chain.random(6, 5, 2, 0).blocks).singular


# ---------------------------------------------------------------- the checks turn red
@pytest.mark.parametrize("part", range(4), ids=("start", "cells", "end", "border"))
def test_an_entry_off_by_a_millionth_is_found(part):
    """A factorisation that sees one entry wrong by 1e-6 fails the first check."""
    chain = Chain.random(9, 8, 4, 2)
    wrong = [block.copy() for block in chain.blocks]
    wrong[part].flat[3] *= 1 + 1e-6
    assert backward_error(chain, BlockChain(*wrong).solve(*chain.right).ravel()) > BACKWARD


def test_elimination_without_row_exchanges_is_found(monkeypatch):
    """Pivots taken as they come leave rows unmet where the first is small."""
    chain = Chain.random(7, 18, 9, 3)
    chain.blocks[0][0, 0] = 1e-12

    def unpivoted(A, exchanges):
        for j in range(len(A)):
            A[j, j + 1 :] /= A[j, j]
            A[j + 1 :, j + 1 :] -= np.outer(A[j + 1 :, j], A[j, j + 1 :])
        exchanges[:] = np.arange(1, len(A) + 1)
        return False

    assert backward_error(chain, chain.solved()) <= BACKWARD
    monkeypatch.setattr(blas_by_address, "getrf", unpivoted)
    monkeypatch.setattr(block_chain, "_eliminate", block_chain._eliminate.py_func)
    assert backward_error(chain, chain.solved()) > BACKWARD
