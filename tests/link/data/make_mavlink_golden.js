// SPDX-License-Identifier: Apache-2.0
// Writes mavlink_golden.txt: frames of every message that gatefly knows as node-mavlink writes them, and the
// values that went in. Of no use to anybody else's program.
//
//   cd /tmp && npm install node-mavlink@2.3.0 mavlink-mappings@1.0.21-20250824-1
//   NODE_PATH=/tmp/node_modules node make_mavlink_golden.js > mavlink_golden.txt
const {minimal, standard, common} = require('mavlink-mappings');
const {MavLinkProtocolV2} = require('node-mavlink');

const ids = [0, 1, 20, 22, 23, 26, 27, 30, 31, 32, 76, 77, 82, 83, 84, 93, 105, 107, 111, 113, 132, 141, 147, 253, 331, 148];
const messages = {...minimal.REGISTRY, ...standard.REGISTRY, ...common.REGISTRY};

let state = 12345;
const random = () => (state = (state * 1103515245 + 12345) % 2147483648) / 2147483648;
const integer = (low, high) => low + Math.floor(random() * (high - low + 1));
const bits = {int8_t: 8, int16_t: 16, int32_t: 32, uint8_t: 8, uint16_t: 16, uint32_t: 32, uint8_t_mavlink_version: 8};

function value(type) {
  if (type === 'float') return Math.fround((random() - 0.5) * Math.pow(10, integer(-3, 4)));
  if (type === 'uint64_t') return BigInt(integer(0, 2 ** 31)) * 4294967296n + BigInt(integer(0, 2 ** 31));
  if (type === 'int64_t') return BigInt(integer(-(2 ** 30), 2 ** 30)) * 4294967296n + BigInt(integer(0, 2 ** 31));
  const size = 2 ** bits[type];
  return type.startsWith('u') ? integer(0, size - 1) : integer(-size / 2, size / 2 - 1);
}
const zero = type => type.endsWith('64_t') ? 0n : 0;

console.log('# By make_mavlink_golden.js with node-mavlink 2.3.0. A frame: message, sequence, system, component, bytes; then its fields.');
let sequence = 0;
for (const id of ids) {
  // Nothing but zeros; all fields; zeros at the end, which are not sent.
  for (const kind of ['zeros', 'full', 'cut']) {
    const message = new messages[id]();
    const fields = [...messages[id].FIELDS].sort((a, b) => a.offset - b.offset);
    const lines = fields.map((field, i) => {
      const empty = kind === 'zeros' || (kind === 'cut' && i > fields.length / 2);
      const type = field.type.replace('[]', '');
      let values;
      if (type === 'char') {
        const text = empty ? '' : Array.from({length: integer(1, field.length)}, () => String.fromCharCode(integer(33, 126))).join('');
        message[field.name] = text;
        values = Array.from({length: field.length}, (_, k) => k < text.length ? text.charCodeAt(k) : 0);
      } else {
        const count = field.type.endsWith('[]') ? field.length : 1;
        values = Array.from({length: count}, () => empty ? zero(type) : value(type));
        message[field.name] = field.type.endsWith('[]') ? values : values[0];
      }
      return `${field.source} ${values.join(' ')}`;
    });
    sequence = (sequence + 1) % 256;
    const system = integer(1, 255), component = integer(0, 255);
    const frame = new MavLinkProtocolV2(system, component).serialize(message, sequence);
    console.log(`${messages[id].MSG_NAME} ${sequence} ${system} ${component} ${frame.toString('hex')}`);
    for (const line of lines) console.log(`  ${line}`);
  }
}
