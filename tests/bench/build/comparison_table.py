# SPDX-License-Identifier: Apache-2.0
"""Text tables of the results."""

import dataclasses
import typing

from limited_process import Outcome


@dataclasses.dataclass
class Row:
    method: str
    frames: int
    outcome: Outcome
    placed: int
    error_m: typing.Optional[typing.Tuple[float, float]]  # RMS and largest error of the placed frames


def print_rows(rows):
    """Prints one line per method; ratio is CPU time relative to the first method."""
    print(f"  {'':24}{'time, s':>9}{'CPU, s':>9}{'ratio':>8}{'placed':>8}{'RMS, mm':>9}{'max, mm':>9}{'peak, MB':>10}")
    for row in rows:
        rms, largest = (f"{1e3 * e:.2f}" for e in row.error_m) if row.error_m else ("-", "-")
        ratio = row.outcome.cpu_s / rows[0].outcome.cpu_s
        print(
            f"  {row.method:24}{row.outcome.seconds:9.1f}{row.outcome.cpu_s:9.1f}{ratio:8.1f}{row.placed:8}{rms:>9}{largest:>9}"
            f"{row.outcome.peak_mb:10.0f}  {row.outcome.failure}"
        )
