#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The server under the load of a fleet, beside another version of it."""

import argparse
import functools
import pathlib
import resource
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "build"))
import state_folder  # noqa: E402

import scenarios  # noqa: E402
from fleet import Fleet  # noqa: E402
from server_process import Server  # noqa: E402


def measure(binary, name, scenario, arguments, capacity):
    with Server(binary, arguments.maps, arguments.state / f"{name}.log") as server:
        server.wait_until_ready()
        fleet = Fleet(server.port, arguments.map, arguments.frames)
        bench = scenarios.Bench(server, fleet, str(arguments.bin / "load_generator"), arguments.seconds, capacity)
        return list(scenario(bench))


def print_rows(rows, base):
    for row, other in zip(rows, base or [None] * len(rows)):
        line = f"| {row.name} | {row.value:.4g} {row.unit}"
        if other:
            ratio = row.value / other.value if other.value else float("nan")
            line += f" | {other.value:.4g} {other.unit} | {ratio:.2f}"
        print(f"{line} | {row.note} |", flush=True)


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bin", type=pathlib.Path, required=True, help="folder of floorloc-server and load_generator")
    parser.add_argument("--against", type=pathlib.Path, help="another floorloc-server")
    parser.add_argument("--maps", type=pathlib.Path, required=True, help="folder with the map")
    parser.add_argument("--map", default="sample", help="its name (default: sample)")
    parser.add_argument("--frames", type=pathlib.Path, required=True, help="a drive in the map, in the survey format")
    parser.add_argument("--state", type=pathlib.Path, required=True, help="folder for logs")
    parser.add_argument("--seconds", type=float, default=10.0, help="of each measurement (default: 10)")
    parser.add_argument("--only", help=f"some of {','.join(scenarios.SCENARIOS)}")
    parser.add_argument("--soak", type=int, default=0, metavar="MINUTES", help="also the memory's growth")
    arguments = parser.parse_args()
    arguments.chosen = (arguments.only or ",".join(scenarios.SCENARIOS)).split(",")
    for name in arguments.chosen:
        if name not in scenarios.SCENARIOS:
            parser.error(f"--only: '{name}' is not one of {', '.join(scenarios.SCENARIOS)}")
    if arguments.seconds < 1:
        parser.error("--seconds: at least 1")
    return arguments


def main():
    arguments = parse_arguments()
    resource.setrlimit(resource.RLIMIT_NOFILE, (resource.getrlimit(resource.RLIMIT_NOFILE)[1],) * 2)
    try:
        state_folder.claim(arguments.state, "server_benchmark")
        chosen = [scenarios.SCENARIOS[name] for name in arguments.chosen]
        if arguments.soak:
            chosen.append(functools.partial(scenarios.soak, minutes=arguments.soak))
        print("| what | this server |" + (" the other | ratio |" if arguments.against else "") + " |")
        print("|---" * (5 if arguments.against else 3) + "|")
        capacities = {}, {}
        for scenario in chosen:
            base = None
            if arguments.against:
                base = measure(arguments.against, "other", scenario, arguments, capacities[1])
            print_rows(measure(arguments.bin / "floorloc-server", "this", scenario, arguments, capacities[0]), base)
    except RuntimeError as error:
        sys.exit(f"bench: {error}")


if __name__ == "__main__":
    main()
