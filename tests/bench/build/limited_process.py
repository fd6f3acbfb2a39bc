# SPDX-License-Identifier: Apache-2.0
"""Runs a command with limits on time and memory, and measures both."""

import dataclasses
import os
import resource
import signal
import subprocess
import tempfile
import threading
import time


@dataclasses.dataclass
class Limits:
    seconds: float
    gigabytes: float  # of address space


@dataclasses.dataclass
class Outcome:
    seconds: float
    cpu_s: float  # of all threads
    peak_mb: float  # largest resident set
    failure: str  # empty: succeeded


def run_limited(command, limits, folder=None):
    """Runs a command in its own process group, which is killed as a whole at the time limit."""

    def set_limit():
        size = int(limits.gigabytes * 2**30)
        resource.setrlimit(resource.RLIMIT_AS, (size, size))

    with tempfile.TemporaryFile(mode="w+", errors="replace") as output:
        start = time.monotonic()
        process = subprocess.Popen(
            list(map(str, command)),
            cwd=folder,
            stdout=output,
            stderr=subprocess.STDOUT,
            preexec_fn=set_limit,
            start_new_session=True,
        )
        out_of_time = threading.Event()

        def end():
            out_of_time.set()
            os.killpg(process.pid, signal.SIGKILL)

        timer = threading.Timer(limits.seconds, end)
        timer.start()
        try:
            _, status, usage = os.wait4(process.pid, 0)
        except BaseException:  # Ctrl-C does not reach the other process group
            os.killpg(process.pid, signal.SIGKILL)
            raise
        finally:
            timer.cancel()
        seconds = time.monotonic() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        output.seek(0)
        failure = failure_of(process.returncode, out_of_time.is_set(), output)
        return Outcome(seconds, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024, failure)


def failure_of(code, out_of_time, output):
    if out_of_time:
        return "out of time"
    if code == 0:
        return ""
    words = [line.strip() for line in output if line.strip()]
    text = " ".join(words)
    if "out of memory" in text.lower() or "bad_alloc" in text or "Insufficient memory" in text:
        return "out of memory"
    if code < 0:
        return f"killed by {signal.Signals(-code).name}"
    return words[-1][:60] if words else f"exit code {code}"
