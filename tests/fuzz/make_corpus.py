#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the inputs that the fuzz targets start from: OUT/NAME/NUMBER. Usage: make_corpus.py OUT

They are valid, or nearly so: a fuzzer finds the way into a parser by itself, but slowly."""

import base64
import hashlib
import itertools
import json
import pathlib
import sqlite3
import struct
import sys
import tempfile
import zlib

ROOT = pathlib.Path(__file__).resolve().parents[2]
SAMPLE = ROOT / "maps" / "sample"

# 16 x 16 pixels, as small as OpenCV writes them.
JPEG = base64.b64decode(
    "/9j/4AAQSkZJRgABAQAAAQABAAD/2wBDABQODxIPDRQSEBIXFRQYHjIhHhwcHj0sLiQySUBMS0dARkVQWnNiUFVtVkVGZIhlbXd7"
    "gYKBTmCNl4x9lnN+gXz/wAALCAAQABABAREA/8QAFgABAQEAAAAAAAAAAAAAAAAAAQAC/8QAGxAAAgMBAQEAAAAAAAAAAAAAAQMA"
    "AiEREjH/2gAIAQEAAD8AvKmDnyBpde10TRFG6MMDRiwOHs//2Q==")

CAMERA = {"image_width": 96, "image_height": 72, "camera_name": "small",
          "camera_matrix": {"rows": 3, "cols": 3, "data": [80, 0, 48, 0, 80, 36, 0, 0, 1]},
          "distortion_model": "plumb_bob", "distortion_coefficients": [0, 0, 0, 0]}
PIXEL_M = 1 / 300
FLOOR = {"homography": [0, -PIXEL_M, 0.12, -PIXEL_M, 0, 0.16, 0, 0, 1],
         "roi": {"x_min": -0.11, "x_max": 0.11, "y_min": -0.15, "y_max": 0.15}, "resolution": PIXEL_M}
VEHICLE = {"map": "hall", "camera": CAMERA, "floor": FLOOR, "gate": {"max_distance_m": 0.2, "max_angle_rad": 0.17},
           "correct_camera": False}
ODOMETRY = {"increments": [{"stamp": 1.5, "dx": 0.01, "dy": 0, "dyaw": 0.002},
                           {"stamp": "1700000000.123456789", "odometry": {"dx": 0.02, "dy": -0.01, "dyaw": 0}}]}
POSE = {"x": 0.5, "y": 0.5, "yaw": 0.1, "covariance": [0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.02], "stamp": 2.5}

CAMCHAIN = """cam0:
  camera_model: pinhole
  distortion_coeffs: [-0.1, 0.01, 0.001, -0.0005]
  distortion_model: radtan
  intrinsics: [600.0, 602.0, 321.0, 239.0]
  resolution: [640, 480]
"""
FILE_STORAGE = """%YAML:1.0
---
image_width: 640
image_height: 480
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 598., 0., 322., 0., 597., 238., 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -0.25, 0.06, 0.0008, -0.0005, 0.01 ]
"""
CAMERA_INFO = """height: 480
width: 640
distortion_model: plumb_bob
d: [-0.25, 0.06, 0.0008, -0.0005, 0.01]
k: [598.0, 0.0, 322.0, 0.0, 597.0, 238.0, 0.0, 0.0, 1.0]
binning_x: 0
roi: {x_offset: 0, y_offset: 0, height: 0, width: 0, do_rectify: false}
---
"""

# What fuzz targets of libraries below ours have found before: depth, size, numbers that are none.
HOSTILE_JSON = ["[" * 500, '{"a":' * 500, "[" + "1," * 500 + "1]", "1e999", "-0", '"\\ud800"', "{}", "null",
                '{"x":1e308,"y":-1e308,"yaw":1e-320}', '{"x":NaN}']


def first_lines(file, count):
    return "\n".join(file.read_text().splitlines()[:count]) + "\n"


def png(width, height, rows):
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    header = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def images():
    pixels = b"".join(b"\0" + bytes((16 * y + x * 5) % 256 for x in range(16)) for y in range(16))
    huge = bytearray(JPEG)
    at = huge.index(b"\xff\xc0") + 5
    huge[at:at + 4] = b"\xff\xff\xff\xff"
    return [JPEG, png(16, 16, pixels), png(2**31 - 1, 2**31 - 1, pixels), bytes(huge), JPEG[:100]]


def survey_files():
    survey, kidnap = SAMPLE / "survey", SAMPLE / "kidnap"
    return {"camera_yaml": [(survey / "camera.yaml").read_text()],
            "camera_import": [CAMCHAIN, FILE_STORAGE, CAMERA_INFO],
            "floor_yaml": [(survey / "floor.yaml").read_text()],
            "frames_csv": [first_lines(survey / "frames.csv", 4), "timestamp,filename\n0,0.jpg\n1.5,1.jpg\n",
                           '"timestamp","filename"\r\n"0","images\\a.jpg"\r\n1,".\\b ""c"".jpg"\r\n'],
            "imu_csv": [first_lines(kidnap / "imu.csv", 4)],
            "control_points": ["filename,u,v,x,y\n0.jpg,1,2,3,4\n1.jpg,5.5,6,-7,8\n"],
            "known_distances": ["filename1,u1,v1,filename2,u2,v2,distance\n0.jpg,1,2,1.jpg,3,4,1.5\n"],
            "markers_csv": ["id,x,y,yaw\n3,1,2,\n17,0,4,1.57\n"],
            "texture_model": ["floorloc-texture 1\ngrid 4 3 0\nclass ROUGH error 0.2 classifiers 1\n-1 1 0.5 0 1 0.7\n"
                              "class SMOOTH error 0.1 classifiers 2\n1 -1 0 2e3 -1 1.5\n0 0 1 0 1 0.25\n"],
            "tum": [first_lines(survey / "odometry.tum", 4), "# t\n1.5 1 2 3 0 0 0 1\n2.5 -1 2e0 3 0 0 1 0\n"],
            "euroc": ["#t\n10,1,2,3,1,0,0,0,5\n20,1,2,3,0,1,0,0\n"],
            "time_stamp": ["1700000000.123456789", "-1.5e-3", "1e9", "+0", "9" * 40]}


def whole_survey(files):
    names = ["camera_yaml", "floor_yaml", "frames_csv", "tum", "imu_csv", "control_points", "known_distances", "tum"]
    return "\0".join(files[name][-1] for name in names)


def token_files():
    token = hashlib.sha256(b"test").hexdigest()
    return ["0123456789abcdef0123456789abcdef\n",
            f"# name role hash ids\nline vehicle {token} agv7,line-*\noffice operator {token[::-1]}\nboss admin {'0' * 64}\n"]


def multipart_bodies():
    part = '--1/2\r\nContent-Disposition: form-data; name={}\r\n\r\n{{}}\r\n'
    quoted = part.format('"request"; filename="a\\"b.json"') + part.format("image\r\nContent-Type: a/b")
    return ['multipart/form-data; boundary="1/2"\0' + quoted + "--1/2--\r\n",
            "Multipart/Form-Data; charset=utf-8; BOUNDARY=1/2\0preamble\r\n" + quoted + "--1/2 \r\n--1/2--epilogue"]


def http_requests():
    def request(line, headers=(), body=b""):
        head = "".join(f"{header}\r\n" for header in (line + " HTTP/1.1", "Host: x", *headers))
        return head.encode() + b"\r\n" + body

    parts = (b'--xyz\r\nContent-Disposition: form-data; name="request"\r\n\r\n{"vehicle":"a"}\r\n'
             b'--xyz\r\nContent-Disposition: form-data; name="image"; filename="a.jpg"\r\n'
             b"Content-Type: image/jpeg\r\n\r\n" + JPEG + b"\r\n--xyz--\r\n")
    multipart = "Content-Type: multipart/form-data; boundary=xyz"
    vehicle = json.dumps(VEHICLE).encode()
    return [request("GET /livez"),
            request("GET /v1/maps?a=b%20c&d=%zz", ["Range: bytes=0-5,7-", "If-None-Match: \"x\""]) * 2,
            request("POST /v1/maps/hall/localize", [multipart, f"Content-Length: {len(parts)}"], parts),
            request("POST /v1/maps/hall/localize?vehicle=a&prior=1,2,3&radius=2",
                    ["Content-Type: image/jpeg", f"Content-Length: {len(JPEG)}"], JPEG),
            request("PUT /v1/vehicles/a", ["Content-Type: application/json; charset=utf-8",
                                           f"Content-Length: {len(vehicle)}", "Expect: 100-continue"], vehicle),
            request("PUT /v1/vehicles/a", ["Content-Type: application/json", "Transfer-Encoding: chunked"],
                    b"5\r\n{\"map\r\n2\r\n\":\r\n0\r\n\r\n"),
            request("PUT /v1/vehicles/a", ["Content-Type: application/json", "Content-Encoding: gzip",
                                           "Content-Length: 20"], zlib.compress(b"{}", wbits=31)),
            request("DELETE /v1/vehicles/a", ["Authorization: Bearer abc", "Connection: close", "X-Request-Id: a",
                                              "traceparent: 00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01"]),
            request("POST /" + "a" * 4000, ["Content-Length: 0"]), b"\r\n\r\n", b"GET / HTTP/9.9\r\n\r\n"]


def api_calls():
    def call(line, body="", form=0, query=()):
        texts = [line.encode(), bytes([form | len(query) << 4])]
        texts = texts[0] + b"\0" + texts[1]
        return texts + b"".join(f"{text}\0".encode() for text in (*itertools.chain(*query), body))

    image, multipart = 1, 2
    register = call("PUT /v1/vehicles/a", json.dumps(VEHICLE))
    frame = call("POST /v1/vehicles/a/frames", json.dumps({"stamp": 3, "odometry": {"dx": 0.1, "dy": 0, "dyaw": 0}}),
                 image | multipart)
    reads = ["/livez", "/readyz", "/metrics", "/v1/maps", "/v1/maps/hall", "/v1/maps/hall/report", "/v1/vehicles",
             "/v1/maps/hall/tiles/0/0/0.jpg", "/v1/maps/hall/fixes", "/v1/vehicles/a", "/", "/web/page.js", "/openapi.yaml"]
    return [call("POST /v1/maps/hall/localize", json.dumps({"camera": CAMERA, "floor": FLOOR, "prior": [0.5, 0.5, 0],
                                                            "radius": 0.3}), image | multipart),
            register + call("POST /v1/maps/hall/localize", "", image, [("vehicle", "a"), ("prior", "0.5,0.5,0")]),
            register + call("POST /v1/vehicles/a/odometry", json.dumps(ODOMETRY)) + frame,
            register + call("POST /v1/vehicles/a/initialpose", json.dumps(POSE)) + frame,
            register + call("POST /v1/vehicles/a/frames", "", image, [("stamp", "5"), ("odometry", "0.1,0,0")]),
            register + call("DELETE /v1/vehicles/a") + call("GET /v1/vehicles/a"),
            call("GET /v1/maps/hall/fixes", query=[("since", "1")])] + [call(f"GET {path}") for path in reads]


def server_texts():
    def texts(*values):
        return [json.dumps(value) for value in values] + HOSTILE_JSON

    localize = {"camera": CAMERA, "floor": FLOOR, "stamp": 1.5, "prior": {"x": 1, "y": 2, "yaw": 3}, "radius": 0.5}
    config = {"threads": 2, "queue_length": 8, "queue_timeout_s": 1, "drain_s": 0, "open": True,
              "protect_reads": False, "log_level": "info", "log_format": "json", "access_log": True, "token_file": "t",
              "limits": {"max_body_bytes": 1000, "max_bodies_bytes": 2000, "max_vehicles": 5, "idle_timeout_s": 9},
              "localizer": {"max_p_wrong": 0.1}}
    actions = [{"actionId": "a", "actionType": kind, "blockingType": "NONE",
                "actionParameters": [{"key": key, "value": value} for key, value in parameters.items()]}
               for kind, parameters in (("initPosition", {"x": 1, "y": 2, "theta": 3, "mapId": "hall"}),
                                        ("downloadMap", {"mapId": "hall", "mapVersion": "0" * 64, "mapHash": "a" * 64,
                                                         "mapDownloadLink": "http://m/x"}))]
    payloads = [{"headerId": 1, "actions": actions}, {"headerId": 4294967295},
                {"orderId": "o", "nodes": [{"nodePosition": {"x": 1, "y": 2, "mapId": "hall"}}]}]
    bridge = (ROOT / "server/ops/bridge.example.json").read_text()
    return {"mqtt_payload": texts(*payloads), "bridge_config": [bridge, "localhost:1883", "[::1]:1"],
            "localize_json": texts(localize, {"vehicle": "a", "prior": "1,2,3"}, {"vehicle": "a", "prior": [1, 2, 3]}),
            "frame_json": texts({"stamp": 1.5, "odometry": {"dx": 0.1, "dy": 0, "dyaw": 0}}, {"stamp": "1.5"}),
            "odometry_json": texts(ODOMETRY, {"stamp": 1, "dx": 0.1, "dy": 0, "dyaw": 0}),
            "initial_pose_json": texts(POSE, {"x": 1, "y": 2, "yaw": 3}),
            "vehicle_json": texts(VEHICLE),
            "server_config": texts(config) + ["127.0.0.1:8080", "[::1]:0"],
            "query": ["vehicle\0a\0prior\0001,2,3\0radius\0002\0stamp\0001.5\0", "stamp\0001.5\0odometry\0001,0,0\0",
                      'stamp\0001.5\0odometry\0{"dx":1,"dy":0,"dyaw":0}\0', "stamp\0001\0stamp\0002\0"]}


def journal_pieces():
    def texts(*values):
        return b"".join(struct.pack("<Q", len(value)) + value for value in values)

    def matrix(rows, cols, kind, pixels):
        return struct.pack("<iiiQ", rows, cols, kind, len(pixels)) + pixels

    pose, identity = struct.pack("<?ddd", True, 1, 2, 0.5), struct.pack("<9d", 1, 0, 0, 0, 1, 0, 0, 0, 1)
    frames = struct.pack("<Q", 3) + (pose + texts(b"")) * 3
    links = struct.pack("<Q", 1) + struct.pack("<iiid", 0, 1, 50, 1e-4) + pose + identity
    placement = frames + links + struct.pack("<Qi", 1, 3) + struct.pack("<iiidddd", 0, 2, 1, 1, 1e-4, 0.1, 0.01)
    fixes = struct.pack("<Q", 1) + struct.pack("<i", 2) + pose + identity
    keypoints = struct.pack("<Q", 2) + struct.pack("<5f", 0.1, 0.2, 0.3, 0.01, 9) * 2
    frame = (keypoints + matrix(2, 32, 0, bytes(64)) + matrix(1, 2, 5, bytes(8)) +
             struct.pack("<fff4xQ", 0.5, 200, 0, 12345))
    header = b"floorloc journal 1\n"
    record = struct.pack("<QqQ", 0x464C4F434A524E4C, 4, 1) + b"a" * 64 + b"data"
    return {"placement_journal": [placement, fixes], "frame_journal": [frame],
            "build_journal": [header, header + record, header + 2 * record, header + record[:50], b"no journal"]}


def learnt_values():
    """Nothing; odometry, a fix that told of the camera, and a read-out; a mask of 3 x 2 cells."""
    def square(size, diagonal):
        return [diagonal if row == column else 0 for row in range(size) for column in range(size)]

    sums = square(12, 100) + [0.5] * 12
    odometry = [1, 0.05, -0.01, 0.001, *square(3, 1e-4), 1.5, 9.6e7]
    camera = [123456, 654321, 40, 1, 0.5, 0.5, 0.1, *sums, *sums]
    mask = [14, 0.2, 3, 2, 0.11, 0.15, 0.003] + [14] * 6 + [12, 0] * 3 + [0, 13] * 3
    values = [[1] + [0] * 7, [1, *odometry, *camera, 1, 0.02, 0.0005, 0], [1, 0, 0, 0, 0, 0, 0, *mask]]
    return [struct.pack(f"<{len(numbers)}d", *numbers) for numbers in values]


def map_changes():
    """A command and a few changes, see map_content_fuzzer.cpp: all commands on the whole map, then with damages."""
    commands = 17
    whole = [bytes([command, 0]) for command in range(commands)]
    damages = [bytes([table, (7 * command + table) % 11, (5 * command) % 3, (11 * command + 3 * table) % 33, 8, 5])
               for command in range(commands) for table in range(8)]
    return whole + [bytes([index % commands, 0]) + damage for index, damage in enumerate(damages)]


def surface_models():
    """The body of a model that tells dark from bright by the histogram of values, and the whole file's beginning."""
    names = b"".join(struct.pack("<I", len(name)) + name for name in (b"bright", b"dark"))
    group = struct.pack("<IB", 1, 1)
    options = struct.pack("<iddi", 640, 0.8, 200.0, 400) + group + struct.pack("<fiQ", 1.0, 2, 1)
    input_ = group + struct.pack("<16f", *[0.0] * 8, *[1.0] * 8)
    vectors = [0.0] * 7 + [1.0] + [1.0] + [0.0] * 7
    weak = struct.pack("<IfI", 0, 1.0, 2) + struct.pack("<22f", *vectors, 1, -1, -1, 1, 0, 0)
    confidences = struct.pack("<B16f", 1, *([-1.0] * 4 + [1.0] * 4) * 2)
    body = (struct.pack("<I", 2) + names + options + struct.pack("<I", 1) + input_ + struct.pack("<I", 1) + weak +
            confidences + struct.pack("<ff", 1.0, 1.0))
    return [body, b"FLOORSRF" + struct.pack("<IQ", 1, 0) + body]


def bags():
    """Those that other libraries wrote, and of one its messages: type and serialization as ros_message_fuzzer.cpp has them,
    then the bytes."""
    data = ROOT / "tests" / "mapbuilder" / "bag" / "data"
    types = ["Image", "CompressedImage", "CameraInfo", "Imu", "Odometry", "PoseStamped", "TFMessage"]
    connection = sqlite3.connect(data / "foxy.db3")
    rows = connection.execute("SELECT type, data FROM messages JOIN topics ON topics.id = topic_id").fetchall()
    connection.close()
    messages = [bytes([types.index(kind.split("/")[-1])]) + message for kind, message in rows
                if kind.split("/")[-1] in types]
    return {"mcap": [file.read_bytes() for file in sorted(data.glob("*.mcap"))],
            "rosbag1": [file.read_bytes() for file in sorted(data.glob("*.bag"))],
            "rosbag2": [file.read_bytes() for file in sorted(data.glob("*.db3"))], "ros_message": messages}


def map_file():
    """A map of one camera and one frame in pages as small as SQLite has them; its checksums and hashes are wrong."""
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "m.floormap"
        connection = sqlite3.connect(file)
        connection.executescript("PRAGMA page_size = 512;" + (ROOT / "schema" / "map.sql").read_text())
        connection.execute("INSERT INTO map VALUES (1, 'b', 'i', 'v', 'n', 'c', 'map', 0.001, 0, 1, 0, 1, 1, 1, 'binary',"
                           " 32, 32, 0, '[]', '{}')")
        doubles = struct.pack("<9d", *FLOOR["homography"])
        connection.execute("INSERT INTO camera VALUES (0, 'c', 96, 72, 80, 80, 48, 36, 'plumb_bob', zeroblob(32), ?,"
                           " -0.11, 0.11, -0.15, 0.15, 0.0033)", [doubles])
        for name, value in {"type": "hessian", "max_keypoints": 60, "cell_px": 48, "levels": 2, "scale_factor": 1.4,
                            "threshold": 0, "normalize_radius_px": 15, "smooth_sigma_px": 1}.items():
            connection.execute("INSERT INTO extractor_parameter VALUES (?, ?)", [name, str(value)])
        for layer in ["frames", "keypoints", "mosaic"]:
            connection.execute("INSERT INTO layer VALUES (?, 1, 1, ?)", [layer, "0" * 64])
        connection.execute("INSERT INTO frame VALUES (0, 0, 5, 'a.jpg', 0, 0, 0, 1, NULL, NULL, NULL)")
        connection.commit()
        connection.close()
        return file.read_bytes()


def main():
    files = survey_files()
    boards = ["9x6\x000.025", "8x6\x000.03\0DICT_4X4_50\x000.02\x000.1,0.3,-0.1,0.1\x000.36,-0.03,1.571\0auto",
              "999x0\0-1\0\0\0\0nan,0,0"]
    corpus = {**files, **server_texts(), **journal_pieces(), **bags(), "survey_folder": [whole_survey(files)],
              "image": images(), "image_header": images(), "http": http_requests(),
              "request_head": http_requests(), "multipart": multipart_bodies(),
              "tokens": token_files(), "learnt_values": learnt_values(), "api": api_calls(),
              "calibrate_options": boards, "map_content": map_changes(), "map_file": [map_file()],
              "surface_model": surface_models()}
    for name, seeds in corpus.items():
        folder = pathlib.Path(sys.argv[1]) / name
        folder.mkdir(parents=True, exist_ok=True)
        for number, seed in enumerate(seeds):
            (folder / f"seed{number}").write_bytes(seed.encode() if isinstance(seed, str) else seed)


main()
