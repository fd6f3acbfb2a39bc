#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The Python client's types and calls against schema/openapi.yaml."""

import pathlib
import re
import sys
import typing
import unittest

import openapi

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parents[3] / "clients/python"))
import floorloc  # noqa: E402
from floorloc import types  # noqa: E402

# Types of objects that the document describes where they are used: their path from a schema.
INLINE = {
    "Twist": ("LocalizeRequest", "twist"), "VehicleSummary": ("VehicleList", "vehicles"),
    "Finding": ("Diagnosis", "findings"), "Scale": ("Map", "scale"), "RosTime": ("RosHeader", "stamp"),
    "RosPoseWithCovariance": ("RosPoseWithCovarianceStamped", "pose"),
    "RosPose": ("RosPoseWithCovarianceStamped", "pose", "pose"), "RosTransform": ("RosTransformStamped", "transform"),
}
OURS = {"Calibration"}  # parts of a VehicleRequest
KINDS = {str: "string", float: "number", int: "integer", bool: "boolean", type(None): "null", list: "array",
         dict: "object"}


def schema_of(name):
    owner, *fields = INLINE.get(name, (name,))
    schema = openapi.SCHEMAS[owner]
    for field in fields:
        schema = openapi.resolved(schema["properties"][field])
        schema = openapi.resolved(schema.get("items", schema))
    alternatives = [one for one in schema.get("oneOf", []) if one.get("type") != "null"]
    return openapi.resolved(alternatives[0]) if alternatives else schema


def kinds_of_schema(schema):
    """Names of JSON types, or the words of an enumeration."""
    schema = openapi.resolved(schema)
    if "oneOf" in schema:
        return set().union(*(kinds_of_schema(one) for one in schema["oneOf"]))
    words = schema.get("enum", [schema["const"]] if "const" in schema else None)
    return set(words) if words else {schema["type"]}


def kinds_of_type(hint):
    origin = typing.get_origin(hint)
    if origin is typing.Union:
        return set().union(*(kinds_of_type(one) for one in typing.get_args(hint)))
    if origin is typing.Literal:
        return set(typing.get_args(hint))
    return {"object"} if typing.is_typeddict(hint) else {KINDS[origin or hint]}


class TypesTest(unittest.TestCase):
    def test_every_type_has_the_fields_of_its_schema(self):
        for name in sorted(set(types.__all__) - OURS):
            with self.subTest(name):
                schema, of_type = schema_of(name), getattr(types, name)
                hints = typing.get_type_hints(of_type)
                self.assertEqual(set(hints), set(schema["properties"]))
                self.assertEqual(of_type.__required_keys__, set(schema.get("required", [])))
                for field, hint in hints.items():
                    self.assertEqual(kinds_of_type(hint), kinds_of_schema(schema["properties"][field]), field)

    def test_every_call_is_named_as_its_operation(self):
        documented = {re.sub("(?<!^)(?=[A-Z])", "_", name).lower() for name in openapi.operations()}
        prefixes = ("get_", "list_", "put_", "post_", "delete_", "stream_", "localize")
        calls = {name for name in vars(floorloc.Client) if name.startswith(prefixes)}
        self.assertEqual(calls - documented, {"get_ros_vehicle"})
        self.assertGreater(len(calls), 10)

    def test_what_the_cpp_client_reads_is_documented(self):
        source = (pathlib.Path(__file__).parents[3] / "clients/cpp/answers.cpp").read_text(encoding="utf-8")
        read = set(re.findall(r'(?:at\(|value\(|Optional\(object, )"(\w+)"', source))
        answers = ("LocalizeAnswer", "FrameAnswer", "OdometryAnswer", "VehicleFix", "Pose", "Alternative", "LatticePose", "Timing",
                   "Next", "SinceFix", "OdometryTrust")
        self.assertEqual(read - {field for name in answers for field in schema_of(name)["properties"]}, set())
        self.assertGreater(len(read), 30)

    def test_misfits_are_found(self):
        self.assertEqual(openapi.misfits(openapi.SCHEMAS["Next"], {"seconds": 1, "metres": 0.5}), [])
        for value in ({"seconds": 1}, {"seconds": 1, "metres": "x"}, {"seconds": 1, "metres": 1, "more": 1}, None, []):
            self.assertTrue(openapi.misfits(openapi.SCHEMAS["Next"], value), value)


if __name__ == "__main__":
    unittest.main()
