"""What is wrong with a page in a browser: each check returns a list of faults in words."""

from __future__ import annotations

import os
import shutil
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")

SLACK = 1.5
"""CSS pixels by which boxes may overlap or stand over the edge: rounding of layouts, no more."""
LABEL_SLACK = 3.0
"""The same between labels of a figure, whose boxes hold room for accents and descenders above and below the letters."""
CONTRAST = 3.0
"""Least ratio of luminances of text and paper; WCAG 2.1, 1.4.3 asks 3 of large text and 1.4.11 of parts of figures."""

BLOCKS = "h1, h2, h3, h4, p, pre, ul, ol, dl, figure, figcaption, details, .scroll, .strip > li, .panel, .drawn"


def browser_path() -> str | None:
    """Return A Chromium of this system, or that of MOORING_BROWSER."""
    return os.environ.get("MOORING_BROWSER") or next(filter(None, map(shutil.which, NAMES)), None)


def skip_or_fail(reason: str):
    """Skip, or fail where everything must be there."""
    (pytest.fail if os.environ.get("CI") else pytest.skip)(reason)


@dataclass
class Opened:
    """A page in the browser, every fold of it open. troubles : console errors, script errors and failed requests."""

    page: object
    troubles: list[str] = field(default_factory=list)


def opened(browser, path: Path, width: int, scheme: str) -> Opened:
    """Return the page opened at this width (CSS pixels), "light" or "dark"."""
    page = browser.new_page(viewport={"width": width, "height": 900}, color_scheme=scheme)
    result = Opened(page)
    page.on("console", lambda m: m.type == "error" and result.troubles.append(f"console: {m.text}"))
    page.on("pageerror", lambda error: result.troubles.append(f"script: {error}"))
    page.on("requestfailed", lambda request: result.troubles.append(f"request: {request.url}"))
    page.goto(path.resolve().as_uri(), wait_until="load")
    page.evaluate("document.querySelectorAll('details').forEach(d => { d.open = true; })")
    return result


def missing_figures(page) -> list[str]:
    """Return pictures without pixels, and drawings without size."""
    return page.evaluate("""() => [
        ...[...document.images].filter(i => !(i.complete && i.naturalWidth > 0)).map(i => 'img ' + i.src),
        ...[...document.querySelectorAll('figure svg')].filter(s => {
            const box = s.getBoundingClientRect();
            return box.width < 50 || box.height < 50 || !s.querySelector('path, use, image, polyline');
        }).map(s => 'svg ' + s.getAttribute('aria-label')),
    ]""")


def missing_files(page, path: Path) -> list[str]:
    """Return linked files that are not beside the page or are empty, and links to places that are not on it."""
    links = page.evaluate("[...document.querySelectorAll('a[href]')].map(a => a.getAttribute('href'))")
    ids = set(page.evaluate("[...document.querySelectorAll('[id]')].map(e => e.id)"))
    faults = [link for link in links if link.startswith("#") and unquote(link[1:]) not in ids]
    faults += [link for link in links if ".html#" in link and not urlsplit(link).scheme and not _has_anchor(link, path)]
    local = {link.split("#")[0] for link in links if not urlsplit(link).scheme} - {""}
    files = {link: path.parent / unquote(link) for link in local}
    return faults + sorted(link for link, file in files.items() if not (file.is_file() and file.stat().st_size))


def _has_anchor(link: str, path: Path) -> bool:
    """Return whether the page that a link names has the anchor that it names."""
    name, _, anchor = link.partition("#")
    file = path.parent / unquote(name)
    return file.is_file() and f'id="{unquote(anchor)}"' in file.read_text(encoding="utf-8")


def figures_without_data(page) -> list[str]:
    """Return panels with a drawing whose caption links no CSV; those of moving views stand with the figures beside."""
    return page.evaluate("""() => [...document.querySelectorAll('figure.panel:not(.view)')].filter(
        f => !f.querySelector('figcaption a[href$=".csv"]')).map(f => f.textContent.trim().slice(0, 80))""")


def overflows(page) -> list[str]:
    """Return whether the page scrolls sideways, and elements over its right edge that scroll in no box of theirs."""
    return page.evaluate(
        """slack => {
        const wide = document.documentElement.clientWidth, faults = [];
        if (document.documentElement.scrollWidth > wide + slack)
            faults.push('page: ' + document.documentElement.scrollWidth + ' px on ' + wide);
        const clipped = e => { for (let p = e.parentElement; p; p = p.parentElement)
            if (p !== document.body && getComputedStyle(p).overflowX !== 'visible') return true; return false; };
        for (const e of document.querySelectorAll('body *')) {
            if (e.ownerSVGElement) continue;
            const box = e.getBoundingClientRect();
            if (box.width && (box.right > wide + slack || box.left < -slack) && !clipped(e))
                faults.push(e.tagName + '.' + e.className + ' ' + Math.round(box.right) + ' px: ' +
                    e.textContent.trim().slice(0, 60));
        }
        return faults;
    }""",
        SLACK,
    )


def overlaps(page) -> list[str]:
    """Return pairs of blocks that cover each other though neither is inside the other."""
    return page.evaluate(
        """([blocks, slack]) => {
        const all = [...document.querySelectorAll(blocks)].map(e => ({e, r: e.getBoundingClientRect()}))
            .filter(b => b.r.width > 0 && b.r.height > 0).sort((a, b) => a.r.top - b.r.top);
        const clipped = e => { for (let p = e.parentElement; p; p = p.parentElement)
            if (getComputedStyle(p).overflowX !== 'visible') return true; return false; };
        const inside = all.filter(b => !clipped(b.e)), faults = [], say = e =>
            e.tagName + ' ' + e.textContent.trim().slice(0, 40).replace(/\\s+/g, ' ');
        for (let i = 0; i < inside.length; i++)
            for (let j = i + 1; j < inside.length && inside[j].r.top < inside[i].r.bottom - slack; j++) {
                const a = inside[i], b = inside[j];
                if (Math.min(a.r.right, b.r.right) - Math.max(a.r.left, b.r.left) > slack
                    && Math.min(a.r.bottom, b.r.bottom) - b.r.top > slack && !a.e.contains(b.e) && !b.e.contains(a.e))
                    faults.push(say(a.e) + ' | ' + say(b.e));
            }
        return faults;
    }""",
        [BLOCKS, SLACK],
    )


def label_overlaps(page) -> list[str]:
    """Return labels of one figure that lie on each other; slanted ones, whose boxes say little, are left out."""
    return page.evaluate(
        """slack => [...document.querySelectorAll('figure svg')].flatMap(svg => {
        const scale = svg.getBoundingClientRect().width / (svg.viewBox.baseVal.width || 1);
        const slanted = t => { const m = t.getCTM();
            return Math.min(Math.abs(m.a), Math.abs(m.b)) > 1e-3 * Math.abs(m.a + m.b); };
        const texts = [...svg.querySelectorAll('text')].filter(t => t.textContent.trim() && !slanted(t)
            && getComputedStyle(t).opacity !== '0')
            .map(t => ({t, r: t.getBoundingClientRect()})).filter(b => b.r.width > 0);
        const faults = [], s = slack * scale, name = e => (e.getAttribute('aria-label') || '').slice(0, 50) + ': ';
        texts.forEach((a, i) => texts.slice(i + 1).forEach(b => {
            if (Math.min(a.r.right, b.r.right) - Math.max(a.r.left, b.r.left) > s
                && Math.min(a.r.bottom, b.r.bottom) - Math.max(a.r.top, b.r.top) > s)
                faults.push(name(svg) + a.t.textContent.replace(/\\s+/g, '') + ' | ' +
                    b.t.textContent.replace(/\\s+/g, ''));
        }));
        return faults;
    })""",
        LABEL_SLACK,
    )


def clipped_labels(page) -> list[str]:
    """Return labels that reach beyond the edge of their drawing."""
    return page.evaluate(
        """slack => [...document.querySelectorAll('figure svg')].flatMap(svg => {
        const box = svg.getBoundingClientRect();
        return [...svg.querySelectorAll('text')].filter(t => { const r = t.getBoundingClientRect();
            return r.width > 0 && t.textContent.trim()
            && (r.left < box.left - slack || r.right > box.right + slack || r.top < box.top - slack ||
                r.bottom > box.bottom + slack); })
            .map(t => (svg.getAttribute('aria-label') || '').slice(0, 50) + ': ' + t.textContent.trim());
    })""",
        SLACK,
    )


def unreadable(page) -> list[str]:
    """Return text whose colour is too near that of the paper under it."""
    return page.evaluate(
        """least => {
        const rgb = c => (c.match(/[\\d.]+/g) || []).map(Number);
        const light = c => { const [r, g, b] = c.slice(0, 3).map(v => { v /= 255; return v <= .03928 ? v / 12.92 :
            ((v + .055) / 1.055) ** 2.4; });
            return .2126 * r + .7152 * g + .0722 * b; };
        const paper = e => { for (let p = e; p;
            p = p.parentElement) { const c = rgb(getComputedStyle(p).backgroundColor);
            if (c.length === 3 || c[3] > .5) return c; } return [255, 255, 255]; };
        const faults = new Set();
        for (const e of document.querySelectorAll(
            'p, td, th, li, h1, h2, h3, h4, a, summary, figcaption, code, pre, dt, dd, svg text')) {
            if (!e.textContent.trim() || !e.getBoundingClientRect().width) continue;
            const style = getComputedStyle(e), ink = rgb(e.ownerSVGElement ? style.fill : style.color);
            if (ink.length < 3) continue;
            const a = light(ink), b = light(paper(e)), ratio = (Math.max(a, b) + .05) / (Math.min(a, b) + .05);
            if (ratio < least)
                faults.add(e.tagName + ' ' + ratio.toFixed(2) + ': ' + e.textContent.trim().slice(0, 40));
        }
        return [...faults];
    }""",
        CONTRAST,
    )
