# SPDX-License-Identifier: Apache-2.0
"""Whether a call that failed is tried again, and when."""

from __future__ import annotations

import dataclasses
import datetime
import email.utils
import random
from typing import Optional

from .errors import UNREACHABLE, FloorlocError

# A newer image of the vehicle took the place of this one: sending it again would push that one out.
# Without a map no call succeeds before somebody brings one.
FINAL_REASONS = ("replaced", "no_maps")


@dataclasses.dataclass(frozen=True)
class Retry:
    """Calls that were refused with 429 or 503, or got no answer, are tried again, within the call's deadline."""

    attempts: int = 3  # in all; 1: never again
    first_wait_s: float = 0.1  # without a Retry-After; doubled each time, of which a random share is waited
    max_wait_s: float = 5.0  # when the server wants more the call fails at once
    jitter: float = 0.25  # of a Retry-After, waited on top at most: a fleet should not come back all at once

    def wait_s(self, error: FloorlocError, attempt: int) -> Optional[float]:
        """Seconds until the next attempt after this one, the first is 1; None: there is none."""
        overloaded = error.status in (429, 503) and error.reason not in FINAL_REASONS
        if attempt >= self.attempts or not (overloaded or error.reason == UNREACHABLE):
            return None
        if error.retry_after_s is None:
            return random.uniform(0.0, min(self.max_wait_s, self.first_wait_s * 2 ** (attempt - 1)))
        if error.retry_after_s > self.max_wait_s:
            return None
        return error.retry_after_s * random.uniform(1.0, 1.0 + self.jitter)


def parse_retry_after(text: Optional[str]) -> Optional[float]:
    """Seconds of a Retry-After (RFC 9110, 10.2.3): a number, or a date as proxies send it; None when it is neither."""
    if text is None:
        return None
    if text.strip().isdigit():
        return float(text)
    try:
        until = email.utils.parsedate_to_datetime(text)
    except (TypeError, ValueError):
        return None
    if until.tzinfo is None:
        until = until.replace(tzinfo=datetime.timezone.utc)
    return max(0.0, (until - datetime.datetime.now(datetime.timezone.utc)).total_seconds())
