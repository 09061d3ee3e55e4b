"""The version of the installed distribution, which pyproject.toml alone states."""

from importlib.metadata import PackageNotFoundError, version

try:
    __version__ = version("mooring-verification")
except PackageNotFoundError:  # imported from a folder that was never installed
    __version__ = "unknown"
