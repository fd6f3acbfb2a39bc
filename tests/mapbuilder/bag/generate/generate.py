#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the bags of rosbag2's SQLite storage, with Python's sqlite3, and those of ROS 1, with Debian's python3-rosbag,
from the messages.json of generate.js. Usage: generate.py OUT"""

import base64
import importlib
import io
import json
import pathlib
import sqlite3
import subprocess
import sys

import genpy
import rosbag

# As rosbag2 created its tables: Foxy, Galactic to Humble, and since Iron.
TOPICS = {
    "foxy": "CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,"
            "serialization_format TEXT NOT NULL)",
    "humble": "CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,"
              "serialization_format TEXT NOT NULL,offered_qos_profiles TEXT NOT NULL)",
    "jazzy": "CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,"
             "serialization_format TEXT NOT NULL,offered_qos_profiles TEXT NOT NULL,"
             "type_description_hash TEXT NOT NULL)",
}
MESSAGES = "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,timestamp INTEGER NOT NULL,data BLOB NOT NULL)"
DEFINITIONS = ("CREATE TABLE message_definitions(id INTEGER PRIMARY KEY,topic_type TEXT NOT NULL,encoding TEXT NOT NULL,"
               "encoded_message_definition TEXT NOT NULL,type_description_hash TEXT NOT NULL)")


def zstd(data):
    return subprocess.run(["zstd", "-c"], input=data, capture_output=True, check=True).stdout


def write_db3(file, messages, schema, compress=lambda data: data):
    file.parent.mkdir(parents=True, exist_ok=True)
    file.unlink(missing_ok=True)
    db = sqlite3.connect(file)
    db.execute("PRAGMA page_size = 1024")
    db.execute(TOPICS[schema])
    db.execute(MESSAGES)
    db.execute("CREATE INDEX timestamp_idx ON messages (timestamp ASC)")
    if schema == "jazzy":
        db.execute(DEFINITIONS)
    ids = {}
    for message in messages:
        topic, kind = message["topic"], message["type"].replace("/", "/msg/")
        if topic not in ids:
            ids[topic] = len(ids) + 1
            row = [ids[topic], topic, kind, "cdr", "", ""][:{"foxy": 4, "humble": 5, "jazzy": 6}[schema]]
            db.execute(f"INSERT INTO topics VALUES ({','.join('?' * len(row))})", row)
            if schema == "jazzy":
                db.execute("INSERT INTO message_definitions (topic_type, encoding, encoded_message_definition, "
                           "type_description_hash) VALUES (?, 'ros2msg', ?, '')", [kind, message["text"]])
        db.execute("INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)",
                   [ids[topic], message["sec"] * 10**9 + int(message["nsec"]), compress(base64.b64decode(message["data"]))])
    db.commit()
    db.close()


def write_split(folder, messages):
    """Two files, of which the first has the higher name; metadata.yaml says so."""
    names = ["split_1.db3", "split_0.db3"]
    half = len(messages) // 2
    write_db3(folder / names[0], messages[:half], "humble")
    write_db3(folder / names[1], messages[half:], "humble")
    listed = "".join(f"    - {name}\n" for name in names)
    (folder / "metadata.yaml").write_text(
        "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: sqlite3\n  relative_file_paths:\n" + listed +
        f"  message_count: {len(messages)}\n  compression_format: \"\"\n  compression_mode: \"\"\n")


def ros1_message(message):
    package, name = message["type"].split("/")
    kind = getattr(importlib.import_module(package + ".msg"), name)
    data = base64.b64decode(message["data"])
    parsed = kind().deserialize(data)
    written = io.BytesIO()
    parsed.serialize(written)
    assert written.getvalue() == data, message["topic"]  # the libraries agree
    kind._full_text = message["text"]  # without the comments, which are most of it
    return parsed


def write_bag(file, messages, compression, chunk_bytes):
    with rosbag.Bag(str(file), "w", compression=compression, chunk_threshold=chunk_bytes) as bag:
        for message in messages:
            bag.write(message["topic"], ros1_message(message), genpy.Time(message["sec"], int(message["nsec"])))


def main():
    out = pathlib.Path(sys.argv[1])
    messages = json.loads((out / "messages.json").read_text())
    write_db3(out / "foxy.db3", messages["ros2"], "foxy")
    write_db3(out / "jazzy.db3", messages["ros2"], "jazzy")
    write_db3(out / "compressed_messages.db3", messages["ros2"], "humble", zstd)
    write_split(out / "split", messages["ros2"])
    whole = (out / "foxy.db3").read_bytes()
    (out / "foxy.db3.zstd").write_bytes(zstd(whole))
    for compression, chunk_bytes in [("none", 100000), ("bz2", 100000), ("lz4", 6000)]:
        write_bag(out / f"{compression}.bag", messages["ros1"], compression, chunk_bytes)
    (out / "messages.json").unlink()


main()
