// node check.mjs FILE SECONDS RATE: reads every message of a loopback recording with @mcap/core,
// through its indexes and again from begin to end, and decodes all by the schemas in the file.
import { open } from "node:fs/promises";
import assert from "node:assert/strict";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import zlib from "node:zlib";
import { decompress } from "fzstd";
import protobuf from "protobufjs";
import "protobufjs/ext/descriptor.js";

const [path, seconds, rate] = [process.argv[2], Number(process.argv[3]), Number(process.argv[4])];
const decompressHandlers = { zstd: (bytes, size) => decompress(bytes, new Uint8Array(Number(size))) };
const file = await open(path);
const bytes = new Uint8Array(await file.readFile());
const readable = {
  size: async () => BigInt(bytes.length),
  read: async (offset, size) => bytes.slice(Number(offset), Number(offset + size)),
};

const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
const types = new Map();
for (const [id, schema] of reader.schemasById) {
  assert.equal(schema.encoding, "protobuf");
  types.set(id, protobuf.Root.fromDescriptor(schema.data).lookupType(schema.name));
}
const topics = new Map([...reader.channelsById].map(([id, c]) => [id, c.topic]));

const counts = {};
let before = 0n;
const lastMaster = {};
for await (const m of reader.readMessages()) {
  const channel = reader.channelsById.get(m.channelId);
  const value = types.get(channel.schemaId).decode(m.data);
  counts[channel.topic] = (counts[channel.topic] ?? 0) + 1;
  assert.ok(m.logTime >= before, "messages come in the order of their log times");
  before = m.logTime;
  if (channel.topic === "/master") {
    assert.equal(value.theta_rad.length, 6);
    assert.equal(value.handle_quaternion_M.length, 4);
    assert.ok(Math.abs(Math.hypot(...value.handle_quaternion_M) - 1) < 1e-4);
    lastMaster.time = m.logTime;
    lastMaster.position = value.handle_position_M_m;
  } else if (channel.topic === "/slave") {
    assert.equal(value.q_rad.length, 6);
  } else if (channel.topic === "/handle/pose") {
    assert.equal(value.frame_id, "M");
    if (m.logTime === lastMaster.time)
      assert.ok(Math.abs(value.pose.position.x - lastMaster.position[0]) < 1e-5);
  }
}

const streamed = {};
const stream = new McapStreamReader({ decompressHandlers, validateCrcs: true });
stream.append(bytes);
for (let r; (r = stream.nextRecord()); ) {
  if (r.type === "Message") streamed[topics.get(r.channelId)] = (streamed[topics.get(r.channelId)] ?? 0) + 1;
}
assert.ok(stream.done());
assert.deepEqual(streamed, counts);

const ticks = seconds * rate;
assert.equal(counts["/master"], ticks);
assert.ok(Math.abs(counts["/slave"] - ticks) <= 2);
for (const topic of ["/handle/pose", "/robot/pose", "/robot/target"])
  assert.ok(Math.abs(counts[topic] - seconds * 50) <= 2, `${topic}: ${counts[topic]}`);
const total = Object.values(counts).reduce((a, b) => a + b, 0);
assert.equal(BigInt(total), reader.statistics.messageCount);
for (const [id, count] of reader.statistics.channelMessageCounts)
  assert.equal(Number(count), counts[topics.get(id)]);

const metadata = {};
for await (const m of reader.readMetadata()) metadata[m.name] = m.metadata;
assert.equal(metadata.farhand.get("role"), "loopback");
assert.equal(metadata.limits.get("0"), "not_finite");
let attachments = 0;
for await (const a of reader.readAttachments()) {
  assert.equal(a.name, "scene.textproto");
  assert.match(new TextDecoder().decode(a.data), /master/);
  ++attachments;
}
assert.equal(attachments, 1);

// @mcap/core does not look at the two CRCs over all of the data and of the summary (nor has an old node a CRC).
if (zlib.crc32) {
  const view = new DataView(bytes.buffer);
  const summary = Number(reader.footer.summaryStart);
  assert.equal(view.getUint32(summary - 4, true), zlib.crc32(bytes.subarray(0, summary - 13)));
  assert.equal(reader.footer.summaryCrc, zlib.crc32(bytes.subarray(summary, bytes.length - 12)));
}
await file.close();
console.log(`${total} messages in ${bytes.length} bytes, all read and decoded:`, counts);
