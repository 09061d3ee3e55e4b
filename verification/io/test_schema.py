"""Does the JSON Schema that editors take say what the readers say? It is judged by the jsonschema library."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tomllib
from importlib.resources import files
from pathlib import Path

import jsonschema
import pytest

from solvers import InputError, Scene
from solvers.io import keys, load_network, schema
from verification import ROOT

FOLDER = Path(str(files("reference_data") / "scenes"))
FILES = sorted(FOLDER.rglob("*.toml"))
SHIPPED = Path(str(files("solvers.io")))
SCENE, NETWORK = FOLDER / "dynamics" / "shallow_chain_surge.toml", FOLDER / "networks" / "three_bridles_moving.toml"
READERS = {"scene": Scene.load, "network": load_network}


def kind_of(text: str) -> str:
    """Return "scene" or "network"."""
    return "network" if "[[elements]]" in text else "scene"


def errors_in(text: str) -> list[str]:
    """Return what the schema has against the text of a file."""
    validator = jsonschema.Draft202012Validator(schema.build_schema(kind_of(text)))
    return [error.message for error in validator.iter_errors(tomllib.loads(text))]


@pytest.mark.parametrize("kind", ["scene", "network"])
def test_the_shipped_schema_is_that_of_the_keys(kind, tmp_path):
    """The file beside the readers is what `python -m solvers.io.schema` writes, and is itself a valid schema."""
    shipped = (SHIPPED / f"{kind}.schema.json").read_text(encoding="utf-8")
    schema.write_schemas(tmp_path)
    assert (tmp_path / f"{kind}.schema.json").read_text(encoding="utf-8") == shipped
    jsonschema.Draft202012Validator.check_schema(json.loads(shipped))


@pytest.mark.parametrize("path", FILES, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_every_shipped_file_is_valid_and_names_its_schema(path):
    """The first line leads an editor from the file to the shipped schema."""
    text = path.read_text(encoding="utf-8")
    assert errors_in(text) == []
    named = re.match(r"#:schema (\S+)\n", text)[1]
    assert (path.parent / named).resolve() == (SHIPPED / f"{kind_of(text)}.schema.json").resolve()


BROKEN = [
    (SCENE, "length = 665.0", "length = -665.0"),
    (SCENE, "length = 665.0", "length = '665'"),
    (SCENE, "length = 665.0", ""),
    (SCENE, "Cdn", "Cd"),
    (SCENE, "[environment]", "[water]"),
    (SCENE, "diameter = 0.09", ""),
    (SCENE, "seabed_stiffness", "# seabed_stiffness"),
    (SCENE, "depth", "# depth"),
    (SCENE, "tolerance = 2e-2", "tolerance = 2"),
    (SCENE, "anchor = [", "anchor = [0.0, "),
    (SCENE, "[motion]", "[motion]\nfrequency = 0.1"),
    (SCENE, "amplitude = [", "amplitude = [1.0, "),
    (SCENE, "[motion]", "[safety_factors]\nmean = 1.1\n[motion]"),
    (SCENE, "[line]", "[line]\nbreaking_load = 0.0"),
    (SCENE, "[line]", "[line]\nfriction = []"),
    (NETWORK, 'kind = "coupled"', 'kind = "vessel"'),
    (NETWORK, "[[nodes]]", "[[node]]"),
    (NETWORK, "length", "L"),
    (NETWORK, "Cdn", "cdn"),
    (NETWORK, "r = [", "r = [0.0, "),
    (NETWORK, "amplitude = [", "amplitude = [0.0, "),
    (NETWORK, "[motion]", "[motion]\nfile = 'a.csv'"),
]


@pytest.mark.parametrize(("path", "old", "new"), BROKEN, ids=[f"{p.stem}-{o}-{n}"[:60] for p, o, n in BROKEN])
def test_what_is_broken_fails_in_schema_and_reader(path, old, new, tmp_path):
    """A file with one mistake is marked by the schema and refused by the reader."""
    text = path.read_text(encoding="utf-8")
    assert old in text
    broken = tmp_path / "broken.toml"
    broken.write_text(text.replace(old, new, 1), encoding="utf-8")
    assert errors_in(broken.read_text(encoding="utf-8")) != []
    with pytest.raises(InputError):
        READERS[kind_of(text)](broken)


def test_every_key_has_a_known_kind_and_a_sentence():
    """A key that an editor could not explain would be of no help; aliases belong to keys."""
    known = set()
    for tables in (keys.SCENE, keys.NETWORK, {"columns": keys.CASES}):
        for table in tables.values():
            known |= table.keys()
            for key in table.values():
                assert key.kind in ("table", "tables") or key.kind in schema.KINDS
                assert (key.help.endswith(".") and key.help[0].isupper()) or key.help.startswith("fixed:")
    assert set(keys.ALIASES) <= known


@pytest.mark.parametrize(
    ("table", "key", "likely"),
    [
        ("line", "Cd", "Cdn"), ("line", "w", "submerged_weight"), ("line", "MBL", "breaking_load"),
        ("line", "mass", "mass_per_length"), ("line", "d", "diameter"), ("line", "L", "length"),
        ("line", "Cm", "Ca"), ("environment", "kBot", "seabed_stiffness"), ("environment", "water_depth", "depth"),
        ("motion", "T", "period"), ("line", "mu", "friction"), ("line", "lenght", "length"),
    ],
)  # fmt: skip
def test_the_usual_name_leads_to_the_key(table, key, likely):
    """Also where a key is nearer in letters: Cd is Cdn, not Cdt or Ca."""
    with pytest.raises(InputError, match=rf"unknown key '{key}' in \[{table}\]; did you mean '{likely}'\?"):
        keys.check_keys(f"[{table}]", {key: 1.0}, keys.SCENE[table])


def test_the_command_says_what_it_does(tmp_path, capsys):
    """--help writes nothing, a folder that is not there is named, and one that is there gets both files."""
    with pytest.raises(SystemExit) as end:
        schema.main(["--help"])
    printed = " ".join(capsys.readouterr().out.split())
    assert end.value.code == 0 and "scene.schema.json" in printed and schema.__doc__.splitlines()[0] in printed
    with pytest.raises(SystemExit) as end:
        schema.main([str(tmp_path / "none")])
    assert end.value.code == 2 and "there is no such folder" in capsys.readouterr().err
    subprocess.run([sys.executable, "-m", "solvers.io.schema", str(tmp_path)], cwd=ROOT, check=True, timeout=60)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["network.schema.json", "scene.schema.json"]
    assert schema.main([str(tmp_path)]) == 0
