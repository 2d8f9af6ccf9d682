// SPDX-License-Identifier: Apache-2.0
// flight.mcap as others read it: @mcap/core finds every message, by the index and from front to back, and each is what its
// schema says; Foxglove's also what Foxglove's own schemas say.
//
// usage: node mcap_test.mjs GATEFLY ROOT      exit 77: skipped, something is missing here
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";

const [gatefly, root] = process.argv.slice(2);
const load = createRequire(join(root, "viewer", "package.json"));
let mcap, support, Ajv, foxglove;
try {
  mcap = load("@mcap/core");
  support = load("@mcap/support");
  Ajv = load("ajv").default;
  foxglove = load("@foxglove/schemas/jsonschema");
} catch {
  console.log("mcap: skipped, no @mcap/core, @mcap/support, ajv or @foxglove/schemas here (cd viewer && npm ci)");
  process.exit(77);
}

const folder = mkdtempSync(join(tmpdir(), "gatefly-mcap-"));
const decompressHandlers = await support.loadDecompressHandlers();
const text = (bytes) => new TextDecoder().decode(bytes);

/** A flight's file; whether it finished does not matter. */
function fly(name, ...args) {
  const out = join(folder, name);
  const run = spawnSync(gatefly, ["fly", "oval", ...args, "--quiet", "--out", out], { cwd: root, encoding: "utf-8" });
  assert.ok(run.status === 0 || run.status === 1, run.stderr);
  return out;
}

/** Channels by topic, messages by channel; both readers must find the same. */
async function read(path) {
  const bytes = readFileSync(path);
  const stream = new mcap.McapStreamReader({ decompressHandlers, validateCrcs: true });
  stream.append(bytes);
  const streamed = [];
  for (let record; (record = stream.nextRecord()); ) if (record.type === "Message") streamed.push(record);
  assert.ok(stream.done());

  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, size) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + size))),
  };
  const reader = await mcap.McapIndexedReader.Initialize({ readable, decompressHandlers });
  const messages = [];
  for await (const message of reader.readMessages()) messages.push(message);
  assert.equal(messages.length, streamed.length);
  assert.equal(BigInt(messages.length), reader.statistics.messageCount);
  assert.equal(reader.chunkIndexes.length, reader.statistics.chunkCount);
  for (let i = 1; i < messages.length; ++i) assert.ok(messages[i].logTime >= messages[i - 1].logTime);

  // From the middle on, one topic only, as a viewer jumps.
  const middle = (reader.statistics.messageStartTime + reader.statistics.messageEndTime) / 2n;
  let later = 0;
  for await (const message of reader.readMessages({ topics: ["/estimate"], startTime: middle })) {
    assert.ok(message.logTime >= middle);
    ++later;
  }
  assert.ok(later > 10);

  const topics = new Map();
  for (const channel of reader.channelsById.values()) {
    assert.equal(channel.messageEncoding, "json");
    const schema = reader.schemasById.get(channel.schemaId);
    assert.equal(schema.encoding, "jsonschema");
    topics.set(channel.topic, {
      schema: schema.name,
      json: JSON.parse(text(schema.data)),
      messages: messages.filter((message) => message.channelId === channel.id).map((message) => ({
        time: Number(message.logTime) * 1e-9,
        value: JSON.parse(text(message.data)),
      })),
    });
  }
  return topics;
}

function expectValid(topics) {
  const ajv = new Ajv({ strict: false, allErrors: true });
  for (const [topic, { schema, json, messages }] of topics) {
    assert.ok(messages.length > 0, topic);
    const own = ajv.compile(json);
    const wellKnown = schema.startsWith("foxglove.") ? ajv.compile(foxglove[schema.slice("foxglove.".length)]) : own;
    for (const { value } of messages)
      for (const validate of [own, wellKnown]) assert.ok(validate(value), `${topic}: ${ajv.errorsText(validate.errors)}`);
    // That a schema refuses something is what makes its yes worth having.
    assert.ok(!own({}), topic);
  }
}

const common = ["/tf", "/tf_static", "/truth/pose", "/estimate/pose", "/scene", "/truth", "/estimate", "/control", "/imu", "/detections"];

const tests = {
  async "a rendered flight: every message is read, and is what its schema says"() {
    const out = fly("rendered", "--laps", "1", "--set", "sim.timeout_s=5");
    const topics = await read(join(out, "flight.mcap"));
    assert.deepEqual([...topics.keys()].sort(), [...common, "/camera/image", "/camera/annotations"].sort());
    expectValid(topics);

    const pictures = readFileSync(join(out, "images.csv"), "utf-8").trim().split("\n").slice(1);
    assert.equal(topics.get("/detections").messages.length, pictures.length);
    const images = topics.get("/camera/image").messages;
    assert.equal(images.length, Math.ceil(pictures.length / 2));
    for (const { value } of images) {
      const jpeg = Buffer.from(value.data, "base64");
      assert.equal(jpeg.readUInt16BE(0), 0xffd8);
      assert.equal(jpeg.readUInt16BE(jpeg.length - 2), 0xffd9);
    }
    const stamps = (name) => topics.get(name).messages.map(({ time }) => time);
    assert.deepEqual(stamps("/camera/annotations"), stamps("/camera/image"));
  },

  async "an ideal flight: z is up, and everything says the same"() {
    const topics = await read(join(fly("ideal", "--laps", "1", "--vision", "ideal"), "flight.mcap"));
    assert.deepEqual([...topics.keys()].sort(), [...common].sort());
    expectValid(topics);
    const near = (a, b) => assert.ok(Math.abs(a - b) < 2e-3, `${a} ${b}`);
    const poses = topics.get("/truth/pose").messages, truth = topics.get("/truth").messages;
    assert.equal(poses.length, truth.length);
    poses.forEach(({ value }, i) => {
      const { position, orientation } = value.pose, { position_m, attitude_rad } = truth[i].value;
      near(position.x, position_m.x), near(position.y, -position_m.y), near(position.z, -position_m.z);
      // Where front points: yaw is clockwise from above in ours, counter-clockwise with z up.
      const { x, y, z, w } = orientation, { pitch, yaw } = attitude_rad;
      near(1 - 2 * (y * y + z * z), Math.cos(pitch) * Math.cos(yaw));
      near(2 * (x * y + w * z), -Math.cos(pitch) * Math.sin(yaw));
      near(2 * (x * z - w * y), Math.sin(pitch));
      const [drone] = topics.get("/tf").messages[i].value.transforms;
      assert.deepEqual([drone.translation, drone.rotation], [position, orientation]);
    });
    assert.ok(Math.max(...poses.map(({ value }) => value.pose.position.z)) > 1);
    // The camera looks ahead, and a little down: its z axis on the drone.
    const { x, y, z, w } = topics.get("/tf_static").messages[0].value.transforms[0].rotation;
    const ahead = 2 * (x * z + w * y), left = 2 * (y * z - w * x), above = 1 - 2 * (x * x + y * y);
    assert.ok(ahead > 0.8 && Math.abs(left) < 1e-3 && above < 0, `${ahead} ${left} ${above}`);
    const ids = topics.get("/scene").messages[0].value.entities.map(({ id }) => id);
    assert.deepEqual(ids.slice(0, 2), ["gate 1", "gate 2"]);
  },
};

let failed = 0;
try {
  for (const [name, test] of Object.entries(tests)) {
    try {
      await test();
      console.log(`ok: ${name}`);
    } catch (error) {
      ++failed;
      console.log(`FAILED: ${name}\n${error.stack}`);
    }
  }
} finally {
  rmSync(folder, { recursive: true, force: true });
}
process.exit(failed ? 1 : 0);
