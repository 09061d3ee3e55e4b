"""The browser that the tests of pages share."""

from __future__ import annotations

import pytest

from . import checks

try:
    from playwright.sync_api import sync_playwright
except ImportError:  # the optional extra "browser"
    sync_playwright = None


@pytest.fixture(scope="session")
def browser():
    """A headless Chromium of this system; the sandbox is off, for it does not start under root."""
    if sync_playwright is None:
        checks.skip_or_fail('playwright is not installed: pip install -e ".[browser]"')
    if not (path := checks.browser_path()):
        checks.skip_or_fail(f"no browser: none of {', '.join(checks.NAMES)} is in PATH, and MOORING_BROWSER names none")
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=path, args=["--no-sandbox"])
        yield chromium
        chromium.close()
