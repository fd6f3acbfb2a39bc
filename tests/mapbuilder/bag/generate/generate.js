// SPDX-License-Identifier: Apache-2.0
// Writes the MCAP files with Foxglove's libraries, and messages.json, from which generate.py makes the others. Usage:
// node generate.js OUT
import cdr from "@foxglove/cdr";
import rosmsg from "@foxglove/rosmsg";
import definitions from "@foxglove/rosmsg-msgs-common";
import ros1Serialization from "@foxglove/rosmsg-serialization";
import ros2Serialization from "@foxglove/rosmsg2-serialization";
import { McapWriter } from "@mcap/core";
import { execFileSync } from "node:child_process";
import { mkdirSync, writeFileSync } from "node:fs";
import path from "node:path";

import { allMessages } from "./messages.js";

// The definition of a type, and of all types in it.
function closure(known, type) {
  const names = [type];
  for (let i = 0; i < names.length; ++i) {
    for (const field of known[names[i]].definitions) {
      if (field.isComplex && !names.includes(field.type)) names.push(field.type);
    }
  }
  return names.map((name) => known[name]);
}

const writers = new Map();
function serialize(type, message, ros1) {
  const key = `${type} ${ros1}`;
  if (!writers.has(key)) {
    const all = closure(ros1 ? definitions.ros1 : definitions.ros2humble, type);
    // The root has no name.
    const list = [{ ...all[0], name: undefined }, ...all.slice(1)];
    writers.set(key, {
      writer: ros1 ? new ros1Serialization.MessageWriter(list) : new ros2Serialization.MessageWriter(list),
      text: rosmsg.stringify(list),
    });
  }
  const { writer, text } = writers.get(key);
  return { data: writer.writeMessage(message), text };
}

class Memory {
  parts = [];
  size = 0n;
  async write(bytes) {
    this.parts.push(Buffer.from(bytes));
    this.size += BigInt(bytes.byteLength);
  }
  position() {
    return this.size;
  }
}

async function writeMcap(file, messages, encoding, options) {
  const writable = new Memory();
  const writer = new McapWriter({ writable, chunkSize: 1500, ...options });
  await writer.start({ profile: encoding === "ros1" ? "ros1" : "ros2", library: "test" });
  const channels = new Map();
  for (const { topic, type, sec, nsec, data, text } of messages) {
    if (!channels.has(topic)) {
      const name = encoding === "ros1" ? type : type.replace("/", "/msg/");
      const schemaId = await writer.registerSchema(
        { name, encoding: encoding === "ros1" ? "ros1msg" : "ros2msg", data: Buffer.from(text) });
      channels.set(topic, await writer.registerChannel({ schemaId, topic, messageEncoding: encoding, metadata: new Map() }));
    }
    const logTime = BigInt(sec) * 1000000000n + BigInt(nsec);
    await writer.addMessage({ channelId: channels.get(topic), sequence: 0, logTime, publishTime: logTime, data });
  }
  await writer.end();
  writeFileSync(file, Buffer.concat(writable.parts));
}

const compressWith = (name, ...command) => (chunk) => ({
  compression: name, compressedData: execFileSync(command[0], command.slice(1), { input: chunk }),
});

// Odometry in the byte order that no writer of messages offers, by the library's writer of fields.
function bigEndianOdometry(message) {
  const w = new cdr.CdrWriter({ kind: cdr.EncapsulationKind.CDR_BE });
  const { header, child_frame_id, pose, twist } = message;
  w.int32(header.stamp.sec).uint32(header.stamp.nanosec).string(header.frame_id).string(child_frame_id);
  const { position, orientation } = pose.pose;
  for (const value of [position.x, position.y, position.z, orientation.x, orientation.y, orientation.z, orientation.w,
                       ...pose.covariance]) w.float64(value);
  const { linear, angular } = twist.twist;
  for (const value of [linear.x, linear.y, linear.z, angular.x, angular.y, angular.z, ...twist.covariance]) w.float64(value);
  return w.data;
}

const out = process.argv[2];
mkdirSync(out, { recursive: true });
const ros2 = allMessages(false).map((m) => ({ ...m, ...serialize(m.type, m.message, false) }));
const ros1 = allMessages(true).map((m) => ({ ...m, ...serialize(m.type, m.message, true) }));
const bare = { useStatistics: false, useSummaryOffsets: false, useMessageIndex: false, useChunkIndex: false,
               repeatSchemas: false, repeatChannels: false };
await writeMcap(path.join(out, "unchunked.mcap"), ros2, "cdr", { useChunks: false });
await writeMcap(path.join(out, "bare.mcap"), ros2, "cdr", bare);
await writeMcap(path.join(out, "lz4.mcap"), ros2, "cdr", { compressChunk: compressWith("lz4", "lz4", "-zc", "-") });
await writeMcap(path.join(out, "zstd.mcap"), ros2, "cdr", { compressChunk: compressWith("zstd", "zstd", "-c") });
await writeMcap(path.join(out, "ros1.mcap"), ros1, "ros1", { compressChunk: compressWith("lz4", "lz4", "-zc", "-") });
await writeMcap(path.join(out, "big_endian.mcap"),
  ros2.map((m) => (m.type === "nav_msgs/Odometry" ? { ...m, data: bigEndianOdometry(m.message) } : m)), "cdr", {});
const plain = (list) => list.map(({ topic, type, sec, nsec, data, text }) =>
  ({ topic, type, sec, nsec, text, data: Buffer.from(data).toString("base64") }));
writeFileSync(path.join(out, "messages.json"), JSON.stringify({ ros1: plain(ros1), ros2: plain(ros2) }));
