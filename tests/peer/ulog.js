// SPDX-License-Identifier: BSD-3-Clause
'use strict';
// The independent side of the flight log's test: @foxglove/ulog reads a file and says what it found, one line each.
// Run by ulog_peer_test.cpp.
//
//   node ulog.js FILE
//
// Lines: "info NAME VALUE", "param NAME VALUE" (a float as the hex of its bits), "text LEVEL TIME TEXT", and of each
// data message "TOPIC VALUE ..." with the fields in their order: floats as the hex of their bits, arrays element by
// element.
const { ULog, MessageType } = require('@foxglove/ulog');
const { FileReader } = require('@foxglove/ulog/node');

const bits = new DataView(new ArrayBuffer(4));
function floatText(value) {
  bits.setFloat32(0, value);
  return bits.getUint32(0).toString(16).padStart(8, '0');
}

function valueText(type, value) {
  if (type === 'float') {
    return floatText(value);
  }
  return typeof value === 'boolean' ? (value ? '1' : '0') : String(value);
}

function fieldText(field, value) {
  const all = field.arrayLength === undefined ? [value] : Array.from(value);
  return all.map((element) => valueText(field.type, element)).join(' ');
}

async function main(path) {
  const log = new ULog(new FileReader(path));
  await log.open();
  const out = [];
  for (const [name, value] of log.header.information) {
    out.push(`info ${name} ${value}`);
  }
  for (const [name, parameter] of log.header.parameters) {
    const value = parameter.value;
    out.push(`param ${name} ${floatText(value)}`);
  }
  for await (const message of log.readMessages()) {
    if (message.type === MessageType.Log) {
      out.push(`text ${String.fromCharCode(message.logLevel)} ${message.timestamp} ${message.message}`);
    } else if (message.type === MessageType.Data) {
      const subscription = log.subscriptions.get(message.msgId);
      const fields = subscription.fields.map((field) => fieldText(field, message.value[field.name]));
      out.push(`${subscription.name} ${fields.join(' ')}`);
    }
  }
  process.stdout.write(out.join('\n') + '\n');
}

main(process.argv[2]).catch((error) => {
  console.error(error);
  process.exit(1);
});
