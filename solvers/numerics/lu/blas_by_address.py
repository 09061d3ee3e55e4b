"""BLAS and LAPACK of scipy on arrays in compiled loops: getrf, trsm, gemm, trsv, gemv, in single and double precision.

What numba itself gives to compiled loops, np.dot and np.linalg, copies blocks of larger arrays and has no triangles.
scipy gives the addresses of its own routines, and this is the one module that works with addresses. Its hazards:

- Nobody checks the arguments. Arrays have contiguous rows (vectors are contiguous), one precision and shapes that fit;
  exchanges are int32. ``bordered`` looks at the shapes of what it is given.
- BLAS counts down columns first, so it sees arrays transposed. In the docstrings A^ is A as BLAS sees it, and shapes
  and letters are those of BLAS.
- numba frees an array after its last use, and a routine has only its address. So every function looks at its sizes
  after the call; its arguments live as long as the caller waits.
- Integers have 32 bits here. A scipy whose BLAS takes 64 is refused at import.
- BLAS refuses some sizes of zero: calls with an empty array are left out.
- Routines take as many threads as scipy's BLAS may, which costs more than it saves on small blocks; who solves sets
  them to one, ``numerics.threads.one_blas_thread``.
- Loops on disk contain the code of these functions, and numba would not see that it changed: such loops are declared
  ``compiled(calls=(blas_by_address,))``. They contain no address but a name, as scipy_dgemm, that gets its address
  here in each process.
"""

from __future__ import annotations

import ctypes

import llvmlite.binding
import numba
import numpy as np
from numba import njit, types
from numba.extending import get_cython_function_address
from scipy.linalg import cython_blas, cython_lapack

RIGHT, UPPER, LOWER, PLAIN, TRANSPOSED, UNIT, NON_UNIT = (ord(letter) for letter in "RULNTUN")
"""Letters of BLAS for ``uplo``, ``trans`` and ``diag``: a triangle, whether to transpose it, whether it has ones."""


def external(module, name, count):
    """Return routine ``name`` of cython_blas or cython_lapack for numba, or for Python where numba is switched off.

    count: of its arguments, all of them addresses. Raises ImportError where its integers have 64 bits.
    """
    if "int64" in str(module.__pyx_capi__[name]):
        raise ImportError("scipy: this build has 64-bit integers in BLAS; one with 32 bits, as on PyPI, is needed")
    address = get_cython_function_address(module.__name__, name)
    if numba.config.DISABLE_JIT:  # type: ignore[attr-defined]
        return ctypes.CFUNCTYPE(None, *[ctypes.c_size_t] * count)(address)
    llvmlite.binding.add_symbol("scipy_" + name, address)
    return types.ExternalFunction("scipy_" + name, types.void(*[types.uintp] * count))


_sgetrf, _dgetrf = (external(cython_lapack, letter + "getrf", 6) for letter in "sd")
_strsm, _dtrsm = (external(cython_blas, letter + "trsm", 11) for letter in "sd")
_sgemm, _dgemm = (external(cython_blas, letter + "gemm", 13) for letter in "sd")
_strsv, _dtrsv = (external(cython_blas, letter + "trsv", 8) for letter in "sd")
_sgemv, _dgemv = (external(cython_blas, letter + "gemv", 11) for letter in "sd")

_ONE32, _ONE64 = np.ones(1, np.float32), np.ones(1)
_MINUS32, _MINUS64 = -_ONE32, -_ONE64


@njit(forceinline=True)
def _address(A):
    """Return the address of an array."""
    return A.ctypes.data


@njit(forceinline=True)
def _lda(A):
    """Return how many numbers lie from one row of an array to the next, by a shift: to divide takes longer."""
    return A.strides[0] >> (2 if A.itemsize == 4 else 3)


@njit(forceinline=True)
def getrf(A, exchanges):
    """LU of A^ (m, n) in place, with exchanges of its rows counted from 1; return whether a pivot was zero."""
    sizes = np.array([A.shape[1], A.shape[0], _lda(A), 0], np.int32)
    s = _address(sizes)
    if A.size and A.itemsize == 4:
        _sgetrf(s, s + 4, _address(A), s + 8, _address(exchanges), s + 12)
    elif A.size:
        _dgetrf(s, s + 4, _address(A), s + 8, _address(exchanges), s + 12)
    return sizes[3] != 0


@njit(forceinline=True)
def trsm(uplo, trans, diag, A, B):
    """B^ (m, n) = B^ op(A^)^-1 with a triangle of A^ (n, n)."""
    sizes = np.array([RIGHT, uplo, trans, diag, B.shape[1], B.shape[0], _lda(A), _lda(B)], np.int32)
    s, a, b = _address(sizes), _address(A), _address(B)
    if B.size and B.itemsize == 4:
        _strsm(s, s + 4, s + 8, s + 12, s + 16, s + 20, _address(_ONE32), a, s + 24, b, s + 28)
    elif B.size:
        _dtrsm(s, s + 4, s + 8, s + 12, s + 16, s + 20, _address(_ONE64), a, s + 24, b, s + 28)
    return sizes[0]


@njit(forceinline=True)
def gemm(A, B, C):
    """C^ (m, n) -= A^ (m, k) B^T, with B^ (n, k)."""
    sizes = np.array([PLAIN, TRANSPOSED, C.shape[1], C.shape[0], A.shape[0], _lda(A), _lda(B), _lda(C)], np.int32)
    s, a, b, c = _address(sizes), _address(A), _address(B), _address(C)
    if C.size and A.size and C.itemsize == 4:
        one, minus = _address(_ONE32), _address(_MINUS32)
        _sgemm(s, s + 4, s + 8, s + 12, s + 16, minus, a, s + 20, b, s + 24, one, c, s + 28)
    elif C.size and A.size:
        one, minus = _address(_ONE64), _address(_MINUS64)
        _dgemm(s, s + 4, s + 8, s + 12, s + 16, minus, a, s + 20, b, s + 24, one, c, s + 28)
    return sizes[0]


@njit(forceinline=True)
def trsv(uplo, trans, diag, A, x):
    """x (n) = op(A^)^-1 x with a triangle of A^ (n, n)."""
    sizes = np.array([uplo, trans, diag, x.size, _lda(A), 1], np.int32)
    s = _address(sizes)
    if x.size and x.itemsize == 4:
        _strsv(s, s + 4, s + 8, s + 12, _address(A), s + 16, _address(x), s + 20)
    elif x.size:
        _dtrsv(s, s + 4, s + 8, s + 12, _address(A), s + 16, _address(x), s + 20)
    return sizes[0]


@njit(forceinline=True)
def gemv(trans, A, x, y):
    """y -= op(A^) x with A^ (m, n)."""
    sizes = np.array([trans, A.shape[1], A.shape[0], _lda(A), 1], np.int32)
    s, a, b, c = _address(sizes), _address(A), _address(x), _address(y)
    if A.size and A.itemsize == 4:
        _sgemv(s, s + 4, s + 8, _address(_MINUS32), a, s + 12, b, s + 16, _address(_ONE32), c, s + 16)
    elif A.size:
        _dgemv(s, s + 4, s + 8, _address(_MINUS64), a, s + 12, b, s + 16, _address(_ONE64), c, s + 16)
    return sizes[0]
