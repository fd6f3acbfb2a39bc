# SPDX-License-Identifier: Apache-2.0
"""The one exception of the client, and the time that a call may take."""

from __future__ import annotations

import time
from typing import Optional

UNREACHABLE = "unreachable"
DEADLINE_EXCEEDED = "deadline_exceeded"
MALFORMED_ANSWER = "malformed_answer"


class FloorlocError(Exception):
    """A call that did not succeed.

    status         HTTP status; None when there was no answer
    reason         stable, for programs: the `code` of the server's problem, or `unreachable` (no connection, or it
                   broke), `deadline_exceeded` (the call took longer than it might), `malformed_answer` (not that of
                   a floorloc-server)
    detail         one sentence for people, of the server when it answered
    retry_after_s  when the same call may succeed, if the server said so
    request_id     under which the server's log has the request
    """

    def __init__(self, reason: str, detail: str, status: Optional[int] = None,
                 retry_after_s: Optional[float] = None, request_id: Optional[str] = None) -> None:
        super().__init__(f"{f'{status} ' if status else ''}{reason}: {detail}")
        self.status = status
        self.reason = reason
        self.detail = detail
        self.retry_after_s = retry_after_s
        self.request_id = request_id

    def __reduce__(self):  # exceptions of several arguments travel between processes only with this
        return type(self), (self.reason, self.detail, self.status, self.retry_after_s, self.request_id)


class Deadline:
    """The end of a call's time, all its attempts and waits included."""

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self._end = time.monotonic() + seconds

    def left_s(self) -> float:
        """Seconds that are left; raises FloorlocError when none are."""
        left_s = self._end - time.monotonic()
        if left_s <= 0.0:
            raise self.exceeded()
        return left_s

    def allows(self, wait_s: float) -> bool:
        return time.monotonic() + wait_s < self._end

    def exceeded(self) -> FloorlocError:
        return FloorlocError(DEADLINE_EXCEEDED, f"There was no answer within {self.seconds:g} s.")
