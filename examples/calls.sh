#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The calls of a robot with curl. Usage: calls.sh SERVER MAP FOLDER [TOKEN]; FOLDER has camera.yaml, floor.yaml and
# frames.csv with images, as a survey.
set -euo pipefail
server=$1 map=$2 folder=$3 token=${4:-}
root=$(dirname "${BASH_SOURCE[0]}")/..

call() {
  # 429 and 503 come with a Retry-After, which --retry honours.
  curl --silent --show-error --fail-with-body --max-time 10 --retry 3 ${token:+-H "Authorization: Bearer $token"} "$@"
  echo
}

# camera.yaml and floor.yaml as JSON: what a vehicle registers.
registration=$(PYTHONPATH=$root/clients/python python3 -c '
import json, sys, floorloc
print(json.dumps({"map": sys.argv[1], **floorloc.read_calibration(sys.argv[2])}))' "$map" "$folder")
mapfile -t frames < <(tail -n +2 "$folder/frames.csv" | head -2)

echo "== register the vehicle"
call -X PUT "$server/v1/vehicles/curl-example" -H 'Content-Type: application/json' -d "$registration"

echo "== where is this image? (stateless)"
call "$server/v1/maps/$map/localize?vehicle=curl-example&stamp=${frames[0]%%,*}" \
  -H 'Content-Type: image/jpeg' -H 'X-Deadline-Ms: 2000' --data-binary "@$folder/${frames[0]#*,}"

echo "== the same with a pose that the server keeps"
call "$server/v1/vehicles/curl-example/frames?stamp=${frames[0]%%,*}" \
  -H 'Content-Type: image/jpeg' -H 'X-Deadline-Ms: 2000' --data-binary "@$folder/${frames[0]#*,}"

echo "== odometry since then"
call "$server/v1/vehicles/curl-example/odometry" -H 'Content-Type: application/json' \
  -d "{\"increments\": [{\"stamp\": ${frames[1]%%,*}, \"dx\": 0.0, \"dy\": 0.0, \"dyaw\": 0.0}]}"

echo "== its pose, in the shapes of ROS messages"
call "$server/v1/vehicles/curl-example?format=ros"

echo "== forget it"
call -X DELETE "$server/v1/vehicles/curl-example"
