"""The pages of a report with all that they link, in one file to be sent."""

from __future__ import annotations

import os
import re
import zipfile
from pathlib import Path
from urllib.parse import unquote

LINK = re.compile(r'(?:href|src)="([^"#:]+)(?:#[^"]*)?"')
SCRIPTS = "*.js"


def linked_files(out: Path) -> list[Path]:
    """Return the pages of a folder, its scripts and every file beside them that a page links."""
    pages = sorted(out.glob("*.html"))
    names = {unquote(name) for page in pages for name in LINK.findall(page.read_text(encoding="utf-8"))}
    return sorted({*pages, *out.glob(SCRIPTS), *(out / name for name in names if (out / name).is_file())})


def pack(out: Path) -> Path:
    """Write <folder>.zip beside the folder of a report, which unpacks to that folder; return its path."""
    path = out.with_name(f"{out.name}.zip")
    temporary = path.with_name(f"{path.name}.{os.getpid()}.tmp")
    with zipfile.ZipFile(temporary, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in linked_files(out):
            archive.write(file, f"{out.name}/{file.relative_to(out).as_posix()}")
    os.replace(temporary, path)
    return path
