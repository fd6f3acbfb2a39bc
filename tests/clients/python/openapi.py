# SPDX-License-Identifier: Apache-2.0
"""schema/openapi.yaml: its schemas and operations, and whether a value fits a schema."""

import pathlib
import re

import yaml

DOCUMENT = yaml.safe_load((pathlib.Path(__file__).parents[3] / "schema/openapi.yaml").read_text(encoding="utf-8"))
SCHEMAS = DOCUMENT["components"]["schemas"]
TYPES = {"string": str, "number": (int, float), "integer": int, "boolean": bool, "array": list, "object": dict,
         "null": type(None)}


def operations():
    return {call["operationId"] for path in DOCUMENT["paths"].values() for call in path.values()
            if isinstance(call, dict) and "operationId" in call}


def resolved(schema):
    while "$ref" in schema:
        schema = SCHEMAS[schema["$ref"].rpartition("/")[2]]
    return schema


def misfits(schema, value, where="answer"):
    """What of a value does not fit, as sentences."""
    schema = resolved(schema)
    if "oneOf" in schema:
        found = [misfits(one, value, where) for one in schema["oneOf"]]
        return [] if any(not one for one in found) else min(found, key=len)
    if "const" in schema or "enum" in schema:
        allowed = schema.get("enum", [schema.get("const")])
        return [] if value in allowed else [f"{where} is {value!r}, not one of {allowed}"]
    kind = schema.get("type")
    if kind and (not isinstance(value, TYPES[kind]) or isinstance(value, bool) != (kind == "boolean")):
        return [f"{where} is {value!r}, not a {kind}"]
    if isinstance(value, dict):
        return object_misfits(schema, value, where)
    if isinstance(value, list):
        fits = schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value))
        bad = [] if fits else [f"{where} has {len(value)} items"]
        return bad + [one for item in value for one in misfits(schema.get("items", {}), item, f"{where}[]")]
    if isinstance(value, str) and not re.search(schema.get("pattern", ""), value):
        return [f"{where} is {value!r}, not {schema['pattern']}"]
    return []


def object_misfits(schema, value, where):
    properties = schema.get("properties", {})
    bad = [f"{where} has no {name}" for name in schema.get("required", []) if name not in value]
    if schema.get("additionalProperties", True) is False:
        bad += [f"{where} has {name}, which is not documented" for name in value if name not in properties]
    for name, one in value.items():
        bad += misfits(properties[name], one, f"{where}.{name}") if name in properties else []
    return bad
