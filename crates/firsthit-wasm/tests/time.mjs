// How long the module takes for a file, or for the embedded `example`: node time.mjs MODULE FILE [ROWSxCOLUMNS]. Milliseconds of the
// processor, the smallest of twenty frames: on a busy machine they say more than the clock.

import { readFileSync } from "node:fs";
import { basename } from "node:path";

import { Firsthit } from "../../firsthit-view/web/firsthit.mjs";

const [moduleFile, file, size = "480x640"] = process.argv.slice(2);
const [rows, columns] = size.split("x").map(Number);

let began = process.cpuUsage();
const since = () => {
    const { user, system } = process.cpuUsage(began);
    began = process.cpuUsage();
    return (user + system) / 1000;
};
const module = await WebAssembly.compile(readFileSync(moduleFile));
const firsthit = await Firsthit.start(module);
console.log(`start ${since().toFixed(0)}`);
const content = file === "example" ? null : readFileSync(file);
since();
const { answer: info } = content === null ? firsthit.example() : firsthit.load(basename(file), content);
console.log(`load ${since().toFixed(0)}, ${info.triangles} triangles`);
const camera = { ...info.camera, rows, columns };
for (const [name, question, about] of [
    ["hits", "hits", { camera }],
    ["t", "frame", { camera, channel: "t" }],
    ["colours, headlight", "frame", { camera }],
    ["colours, lit, 1 sample", "frame", { camera, is_lit: true }],
]) {
    const times = [];
    for (let k = 0; k < 20; k++) {
        since();
        firsthit.ask(question, about);
        times.push(since());
    }
    times.sort((a, b) => a - b);
    console.log(`${name} ${times[0].toFixed(1)}, median ${times[10].toFixed(1)}`);
}
console.log(`memory ${(firsthit.memoryBytes / 2 ** 20).toFixed(0)} MiB`);
