# SPDX-License-Identifier: Apache-2.0
"""What VDA 5050 wants of the bridge's messages, 2.1 and 3.0, written from its texts: required fields, types, enumerations,
ranges."""

TEXT, NUMBER, INTEGER, FLAG = ({"type": name} for name in ("string", "number", "integer", "boolean"))


def record(required, optional=None):
    """A closed object: a field that is misspelt is a misfit, too."""
    return {"type": "object", "required": list(required), "additionalProperties": False,
            "properties": {**required, **(optional or {})}}


def items(schema):
    return {"type": "array", "items": schema}


def one_of(*words):
    return {"type": "string", "enum": list(words)}


def header(digits, version):
    return {"headerId": {"type": "integer", "minimum": 0},
            "timestamp": {"type": "string", "pattern": rf"^\d{{4}}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{{{digits}}}Z$"},
            "version": one_of(version), "manufacturer": TEXT, "serialNumber": TEXT}


SCORE = {"type": "number", "minimum": 0, "maximum": 1}
RADIUS = {"type": "number", "minimum": 0}
THETA = {"type": "number", "minimum": -3.14159265359, "maximum": 3.14159265359}
PERCENT = {"type": "number", "minimum": 0, "maximum": 100}
VELOCITY = record({}, {"vx": NUMBER, "vy": NUMBER, "omega": NUMBER})
MAPS = items(record({"mapId": TEXT, "mapVersion": TEXT, "mapStatus": one_of("ENABLED", "DISABLED")}))
ERRORS = items(record({"errorType": TEXT, "errorLevel": one_of("WARNING", "FATAL")},
                      {"errorDescription": TEXT,
                       "errorReferences": items(record({"referenceKey": TEXT, "referenceValue": TEXT}))}))
IDLE = {"orderId": TEXT, "orderUpdateId": INTEGER, "lastNodeId": TEXT, "lastNodeSequenceId": INTEGER,
        "nodeStates": items(record({})), "edgeStates": items(record({})), "driving": FLAG}
STATUS = ("WAITING", "INITIALIZING", "RUNNING", "PAUSED", "FINISHED", "FAILED")

POSITION_2 = record({"x": NUMBER, "y": NUMBER, "theta": THETA, "mapId": TEXT, "positionInitialized": FLAG},
                    {"mapDescription": TEXT, "localizationScore": SCORE, "deviationRange": RADIUS})
HEADER_2 = header(2, "2.1.0")
ACTIONS_2 = items(record({"actionId": TEXT, "actionStatus": one_of(*STATUS)},
                         {"actionType": TEXT, "actionDescription": TEXT, "resultDescription": TEXT}))
V2 = {
    "position": POSITION_2, "actionStates": ACTIONS_2,
    "connection": record({**HEADER_2, "connectionState": one_of("ONLINE", "OFFLINE", "CONNECTIONBROKEN")}),
    "visualization": record(HEADER_2, {"agvPosition": POSITION_2, "velocity": VELOCITY}),
    "state": record({**HEADER_2, **IDLE, "actionStates": ACTIONS_2, "errors": ERRORS,
                     "batteryState": record({"batteryCharge": PERCENT, "charging": FLAG}),
                     "operatingMode": one_of("AUTOMATIC", "SEMIAUTOMATIC", "MANUAL", "SERVICE", "TEACHIN"),
                     "safetyState": record({"eStop": one_of("AUTOACK", "MANUAL", "REMOTE", "NONE"),
                                            "fieldViolation": FLAG})},
                    {"agvPosition": POSITION_2, "velocity": VELOCITY, "maps": MAPS, "information": items(record({}))}),
}

POSITION_3 = record({"x": NUMBER, "y": NUMBER, "theta": THETA, "mapId": TEXT, "localized": FLAG},
                    {"localizationScore": SCORE, "deviationRange": RADIUS})
HEADER_3 = header(3, "3.0.0")
ACTIONS_3 = items(record({"actionId": TEXT, "actionStatus": one_of(*STATUS, "RETRIABLE")},
                         {"actionType": TEXT, "actionDescriptor": TEXT, "actionResult": TEXT}))
V3 = {
    "position": POSITION_3, "actionStates": ACTIONS_3,
    "connection": record({**HEADER_3,
                          "connectionState": one_of("ONLINE", "OFFLINE", "HIBERNATING", "CONNECTION_BROKEN")}),
    "visualization": record({**HEADER_3, "referenceStateHeaderId": INTEGER},
                            {"mobileRobotPosition": POSITION_3, "velocity": VELOCITY}),
    "state": record({**HEADER_3, **IDLE, "actionStates": ACTIONS_3, "instantActionStates": ACTIONS_3, "errors": ERRORS,
                     "powerSupply": record({"stateOfCharge": PERCENT, "charging": FLAG}),
                     "operatingMode": one_of("STARTUP", "AUTOMATIC", "SEMIAUTOMATIC", "INTERVENED", "MANUAL", "SERVICE",
                                             "TEACH_IN"),
                     "safetyState": record({"activeEmergencyStop": one_of("MANUAL", "REMOTE", "NONE"),
                                            "fieldViolation": FLAG})},
                    {"mobileRobotPosition": POSITION_3, "velocity": VELOCITY, "maps": MAPS}),
}
for schemas in (V2, V3):
    schemas.update(velocity=VELOCITY, maps=MAPS, errors=ERRORS)
