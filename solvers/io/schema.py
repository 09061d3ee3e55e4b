"""JSON Schema of scene and network files, for editors: made of the table of keys that the readers check with.

``python -m solvers.io.schema [FOLDER]`` writes scene.schema.json and network.schema.json. An editor with Taplo (Even
Better TOML) takes them from the first line of a file, ``#:schema ./scene.schema.json``.
"""

from __future__ import annotations

import argparse
import json
from os import PathLike
from pathlib import Path

from .keys import NETWORK, SCENE, SEA, Key

_NUMBER = {"type": "number"}
_VECTOR = {"type": "array", "items": _NUMBER, "minItems": 3, "maxItems": 3}
_SIX = {"type": "array", "items": _NUMBER, "minItems": 6, "maxItems": 6}
_NON_NEGATIVE = {"type": "number", "minimum": 0}
KINDS: dict[str, dict] = {
    "text": {"type": "string"},
    "number": _NUMBER,
    "positive": {"type": "number", "exclusiveMinimum": 0},
    "non_negative": _NON_NEGATIVE,
    "tolerance": {"type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": 1},
    "vector": _VECTOR,
    "six": _SIX,
    "rows_of_three": {"oneOf": [_VECTOR, {"type": "array", "items": _VECTOR, "minItems": 1}]},
    "rows_of_six": {"type": "array", "items": _SIX, "minItems": 1},
    "friction": {"oneOf": [_NON_NEGATIVE, {"type": "array", "items": _NON_NEGATIVE, "minItems": 1}]},
    "kind": {"enum": ["fixed", "free", "coupled"]},
    "count": {"type": "integer", "minimum": 0},
    "amplitudes": {"enum": ["rayleigh", "deterministic"]},
}
"""Kind of a Key -> what its value must be."""

_WEIGHT = {"anyOf": [{"required": ["submerged_weight"]}, {"required": ["diameter", "mass_per_length"]}]}
_MOVING = {"required": ["diameter", "mass_per_length"]}
_OVER_SEABED = {  # a motion over a seabed takes its stiffness
    "if": {"required": ["motion", "environment"], "properties": {"environment": {"required": ["depth"]}}},
    "then": {"properties": {"environment": {"required": ["seabed_stiffness"]}}},
}
_ONE_FREQUENCY = {"oneOf": [{"required": ["frequency"]}, {"required": ["period"]}]}
_EXTRA = {  # what a table takes beside its keys
    "environment": {"dependentRequired": {"seabed_stiffness": ["depth"]}},
    "line": _WEIGHT,
    "line_types": _WEIGHT,
}
_SCENE_MOTION = {"if": {"required": ["motion"]}, "then": {"properties": {"line": _MOVING}}}
_SERIES = {"required": ["file"], "propertyNames": {"enum": ["file", "reference"]}}
_FILE = {"required": ["file"]}
_ROWS = {"anyOf": [{"required": ["sine"]}, {"required": ["cosine"]}]}
_NOT_WITH_ROWS = {"anyOf": [{"required": ["phase"]}, {"required": ["amplitude"]}, _FILE]}
_IN_WAVES = {
    "required": ["spectrum", "seed", "duration", "operators"],
    "propertyNames": {"enum": ["reference", *SEA]},
    "if": {"properties": {"spectrum": {"enum": ["jonswap", "pierson_moskowitz"]}}},
    "then": {"required": ["Hs", "Tp"]},
    "else": {"propertyNames": {"not": {"enum": ["Hs", "Tp", "gamma"]}}},
}
_OF_FAIRLEAD = {"required": ["amplitude"], "propertyNames": {"enum": list(SCENE["motion"])}, **_ONE_FREQUENCY}
_SCENE_TABLES = SCENE | {
    "motion": {name: key._replace(required=False) for name, key in (SCENE["motion"] | SCENE["sea"]).items()}
}
_NOT_IN_WAVES = {"propertyNames": {"not": {"enum": list(SEA)}}}
_NETWORK_MOTION = {
    "oneOf": [
        _SERIES,
        _IN_WAVES,
        {"required": ["amplitude"], **_ONE_FREQUENCY, **_NOT_IN_WAVES, "not": {"anyOf": [_ROWS, _FILE]}},
        {**_ROWS, **_ONE_FREQUENCY, **_NOT_IN_WAVES, "not": _NOT_WITH_ROWS},
    ]
}


def build_schema(kind: str) -> dict:
    """Return the JSON Schema (draft 2020-12) of "scene" or "network" files.

    >>> build_schema("scene")["properties"]["line"]["required"]
    ['length', 'EA']
    """
    tables, title, motion, whole = {
        "scene": (
            _SCENE_TABLES,
            "A scene: one mooring line",
            {"oneOf": [_OF_FAIRLEAD, _IN_WAVES]},
            [_SCENE_MOTION, _OVER_SEABED],
        ),
        "network": (NETWORK, "A network of mooring lines", _NETWORK_MOTION, [_OVER_SEABED]),
    }[kind]
    extra = _EXTRA | {"motion": motion}
    schema = _table(tables[""], tables, extra)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": title} | schema | {"allOf": whole}


def _table(keys: dict[str, Key], tables, extra) -> dict:
    """Return the schema of a table."""
    properties = {name: _property(name, key, tables, extra) for name, key in keys.items()}
    required = [name for name, key in keys.items() if key.required]
    return dict(type="object", properties=properties, required=required, additionalProperties=False)  # noqa: C408


def _property(name: str, key: Key, tables, extra) -> dict:
    about = {"description": f"{key.help} Unit: {key.unit}." if key.unit else key.help}
    if key.kind not in ("table", "tables"):
        return about | KINDS[key.kind]
    table = _table(tables[name], tables, extra) | extra.get(name, {})
    return about | (table if key.kind == "table" else {"type": "array", "items": table, "minItems": 1})


def write_schemas(folder: str | PathLike[str] = ".") -> list[Path]:
    """Write scene.schema.json and network.schema.json into a folder; return their paths."""
    paths = []
    for kind in ("scene", "network"):
        path = Path(folder) / f"{kind}.schema.json"
        path.write_text(json.dumps(build_schema(kind), indent=1) + "\n", encoding="utf-8")
        paths.append(path)
    return paths


def main(argv=None) -> int:
    """Command line."""
    parser = argparse.ArgumentParser(prog="python -m solvers.io.schema", description=__doc__.partition("\n")[0])
    parser.add_argument("folder", nargs="?", default=".", metavar="FOLDER", help="where to write scene.schema.json and "
                        "network.schema.json (default: here)")  # fmt: skip
    folder = Path(parser.parse_args(argv).folder)
    if not folder.is_dir():
        parser.error(f"{folder}: there is no such folder")
    write_schemas(folder)
    return 0


if __name__ == "__main__":
    main()
