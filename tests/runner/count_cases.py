#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Counts the cases behind ctest's tests, most of which are GoogleTest binaries of many cases.

Usage: count_cases.py CTEST_JUNIT REPORT_FOLDER. Prints "PASSED FAILED", then a line for each failure. The reports are
GoogleTest's XML files, named as the tests are. A test without a report is one case.
"""

import pathlib
import sys
import xml.etree.ElementTree as ElementTree
from typing import NamedTuple


class Count(NamedTuple):
    passed: int
    failures: list


def count_report(name, report):
    """Of one GoogleTest binary. Skipped and disabled cases are neither passed nor failed."""
    passed, failures = 0, []
    for case in ElementTree.parse(report).getroot().iter("testcase"):
        if case.find("failure") is not None:
            failures.append(f"{name}: {case.get('classname')}.{case.get('name')}")
        elif case.get("result") == "completed":
            passed += 1
    return Count(passed, failures)


def count_test(test, folder):
    """Of one test of ctest. One that failed has a failed case, even if its report knows of none: it crashed, was
    stopped, or a sanitizer found something when it ended."""
    name, status = test.get("name"), test.get("status")
    skipped = test.find("skipped")
    if skipped is not None and skipped.get("message", "").startswith("Unable to find executable"):
        return Count(0, [f"{name}: was not built"])
    report = folder / f"{name}.xml"
    count = count_report(name, report) if report.is_file() else Count(int(status == "run"), [])
    if status == "fail" and not count.failures:
        count.failures.append(f"{name}: {test.find('failure').get('message') or 'failed'}")
    return count


def main():
    tests = ElementTree.parse(sys.argv[1]).getroot().findall("testcase")
    counts = [count_test(test, pathlib.Path(sys.argv[2])) for test in tests]
    failures = [failure for count in counts for failure in count.failures]
    print(sum(count.passed for count in counts), len(failures))
    print("\n".join(failures))


if __name__ == "__main__":
    main()
