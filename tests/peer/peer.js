// SPDX-License-Identifier: BSD-3-Clause
'use strict';
// The independent side of the MAVLink interoperation test: node-mavlink behind a socket on file descriptor 3. Run by
// mavlink_peer_test.cpp, one process per mode; reports on standard output, one line per message.
//
//   node peer.js catalogue                    every message of the dialects: id, CRC_EXTRA, base length, greatest length, name
//   node peer.js decode [key]                 frames from the socket -> lines, until the socket closes
//   node peer.js encode <count> <seed> <v1|v2|signed> <ids> [key]   random messages -> frames on the socket and lines
//
// A line: version sequence system component id, then each field in wire order: integers in decimal, floats as the hex of their
// bits, text as the hex of its bytes, elements separated by commas. Signed frames append " signed" when the key fits.
const net = require('net');
const { createMavLinkStream, MavLinkProtocolV1, MavLinkProtocolV2, MavLinkPacketSignature } = require('node-mavlink');
const mappings = require('mavlink-mappings');

const messages = new Map();
for (const dialect of ['minimal', 'standard', 'common', 'ardupilotmega']) {
  for (const type of Object.values(mappings[dialect])) {
    if (type && type.MSG_ID !== undefined && !messages.has(type.MSG_ID)) {
      messages.set(type.MSG_ID, type);
    }
  }
}

const inWireOrder = (type) => [...type.FIELDS].sort((a, b) => a.offset - b.offset);
const floatBits = new DataView(new ArrayBuffer(8));

function elementText(type, value) {
  if (type === 'float') {
    floatBits.setFloat32(0, value);
    return floatBits.getUint32(0).toString(16).padStart(8, '0');
  }
  if (type === 'double') {
    floatBits.setFloat64(0, value);
    return floatBits.getBigUint64(0).toString(16).padStart(16, '0');
  }
  return String(value);
}

function fieldText(field, value) {
  const type = field.type.replace('[]', '');
  if (type === 'char') {
    return 't' + Buffer.from(value, 'latin1').toString('hex');
  }
  return field.length > 0 ? value.map((v) => elementText(type, v)).join(',') : elementText(type, value);
}

function line(version, header, type, data) {
  const fields = inWireOrder(type).map((f) => fieldText(f, data[f.name]));
  return [version, header.seq, header.sysid, header.compid, type.MSG_ID, ...fields].join(' ');
}

// xorshift32: the same numbers for the same seed
let state = 1;
function random32() {
  state ^= state << 13;
  state >>>= 0;
  state ^= state >>> 17;
  state ^= state << 5;
  state >>>= 0;
  return state;
}
const below = (n) => random32() % n;

function randomElement(type) {
  floatBits.setUint32(0, random32());
  floatBits.setUint32(4, random32());
  switch (type) {
    case 'float': return below(8) === 0 ? [0, -0, 1, Infinity, -Infinity, NaN, 1e-45, -3.4e38][below(8)] : floatBits.getFloat32(0);
    case 'double': return floatBits.getFloat64(0);
    case 'uint64_t': return floatBits.getBigUint64(0);
    case 'int64_t': return floatBits.getBigInt64(0);
    case 'uint32_t': return floatBits.getUint32(0);
    case 'int32_t': return floatBits.getInt32(0);
    case 'uint16_t': return floatBits.getUint16(0);
    case 'int16_t': return floatBits.getInt16(0);
    case 'int8_t': return floatBits.getInt8(0);
    default: return floatBits.getUint8(0);
  }
}

function randomMessage(type) {
  const message = new type();
  const empty = below(50) === 0;
  for (const field of type.FIELDS) {
    const element = field.type.replace('[]', '');
    const zero = empty || below(8) === 0;
    const one = () => (zero ? (element.includes('64') ? 0n : 0) : randomElement(element));
    if (element === 'char') {
      const length = zero ? 0 : below(field.length + 1);
      message[field.name] = String.fromCharCode(...Array.from({ length }, () => 1 + below(255)));
    } else {
      message[field.name] = field.length > 0 ? Array.from({ length: field.length }, one) : one();
    }
  }
  return message;
}

function catalogue() {
  for (const type of messages.values()) {
    const end = (fields) => Math.max(0, ...fields.map((f) => f.offset + f.size * Math.max(1, f.length)));
    console.log([type.MSG_ID, type.MAGIC_NUMBER, end(type.FIELDS.filter((f) => !f.extension)), end(type.FIELDS), type.MSG_NAME].join(' '));
  }
}

function decode(keyHex) {
  const key = keyHex ? Buffer.from(keyHex, 'hex') : null;
  const socket = new net.Socket({ fd: 3 });
  const out = [];
  createMavLinkStream(socket, { onCrcError: () => out.push('crc error') }).on('data', (packet) => {
    const type = messages.get(packet.header.msgid);
    const version = packet.protocol instanceof MavLinkProtocolV1 ? 1 : 2;
    const data = packet.protocol.data(packet.payload, type);
    const signed = packet.signature && key && packet.signature.matches(key) ? ' signed' : packet.signature ? ' forged' : '';
    out.push(line(version, packet.header, type, data) + signed);
    if (out.length >= 500) {
      process.stdout.write(out.splice(0).join('\n') + '\n');
    }
  }).on('end', () => process.stdout.write(out.concat('end').join('\n') + '\n'));
}

async function encode(count, seed, mode, ids, keyHex) {
  const socket = new net.Socket({ fd: 3 });
  const key = keyHex ? Buffer.from(keyHex, 'hex') : null;
  const types = ids.map((id) => messages.get(id));
  const write = (stream, data) => (stream.write(data) ? null : new Promise((done) => stream.once('drain', done)));
  state = seed >>> 0 || 1;
  for (let i = 0; i < count; ++i) {
    const type = types[below(types.length)];
    const header = { seq: i & 255, sysid: 1 + below(255), compid: below(256) };
    const protocol = mode === 'v1' ? new MavLinkProtocolV1(header.sysid, header.compid)
      : new MavLinkProtocolV2(header.sysid, header.compid, mode === 'signed' ? MavLinkProtocolV2.IFLAG_SIGNED : 0);
    const message = randomMessage(type);
    let frame = protocol.serialize(message, header.seq);
    if (mode === 'signed') {
      // few senders, and a time that rises: the receiver remembers both
      header.sysid = 1 + (i % 3);
      protocol.sysid = header.sysid;
      header.compid = protocol.compid = 1;
      frame = protocol.sign(protocol.serialize(message, header.seq), 5, key, Date.UTC(2026, 0, 1) + i);
    }
    await write(socket, frame);
    await write(process.stdout, line(mode === 'v1' ? 1 : 2, header, type, message) + (mode === 'signed' ? ' signed' : '') + '\n');
  }
  socket.end(() => socket.destroy());
  process.stdout.write('end\n');
}

const [mode, ...rest] = process.argv.slice(2);
if (mode === 'catalogue') {
  catalogue();
} else if (mode === 'decode') {
  decode(rest[0]);
} else if (mode === 'encode') {
  encode(Number(rest[0]), Number(rest[1]), rest[2], rest[3].split(',').map(Number), rest[4]);
} else {
  console.error('usage: see the head of peer.js');
  process.exit(2);
}
