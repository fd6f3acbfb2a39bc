# SPDX-License-Identifier: Apache-2.0
"""The folder that --state names: as tests/bench/common/state_folder.h, with the same mark."""

MARK = ".floorloc_benchmark"


def claim(folder, benchmark):
    """Creates and marks the folder. Raises RuntimeError when it has content but not this benchmark's mark."""
    folder.mkdir(parents=True, exist_ok=True)
    mark = folder / MARK
    if any(folder.iterdir()) and not (mark.is_file() and mark.read_text().strip() == benchmark):
        raise RuntimeError(f"{folder}: is not empty and was not made by {benchmark}, which would delete what is in "
                           "it; give --state a new or empty folder")
    mark.write_text(benchmark + "\n")
