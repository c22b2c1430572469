// Whether the module answers as the same code does on this machine, to the byte; see `make test-wasm`.
//
// node module.mjs MODULE ANSWERS FOLDER: ANSWERS is the program of examples/answers.rs, and FOLDER is for files.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { createHash } from "node:crypto";
import { existsSync, mkdirSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { basename, join } from "node:path";

import { Broken, Firsthit, Refused } from "../../firsthit-view/web/firsthit.mjs";

const [moduleFile, native, folder] = process.argv.slice(2);
const testdata = join(import.meta.dirname ?? new URL(".", import.meta.url).pathname, "../../../testdata");
const module = await WebAssembly.compile(readFileSync(moduleFile));

/** What the module was asked, in the words of examples/answers.rs, and what it answered. */
const calls = [];
const answers = [];
const firsthit = await Firsthit.start(module);

function record(call, ask) {
    calls.push(call);
    try {
        answers.push({ refused: null, ...ask() });
    } catch (error) {
        if (!(error instanceof Refused)) throw error;
        answers.push({ refused: error.message, pixels: new Uint8Array() });
    }
    return answers.at(-1);
}

const load = (file, name = basename(file)) => record({ name, file }, () => firsthit.load(name, readFileSync(file)));
const example = () => record({ example: true }, () => firsthit.example());
const ask = (question, about) => record({ question, about }, () => firsthit.ask(question, about));

/** All questions about a scene, by its own camera with as many pixels. */
function question(info, [rows, columns]) {
    const camera = { ...info.camera, rows, columns };
    ask("info", {});
    ask("hits", { camera });
    for (const channel of ["t", "object", "primitive", "normal", "position"]) ask("frame", { camera, channel });
    ask("frame", { camera });
    // With shadows, and half of them drawn by numbers that look random.
    ask("frame", { camera, is_lit: true });
    ask("frame", { camera, is_lit: true, samples: 2, light: "auto", ground: true });
    ask("frame", { camera: { ...camera, projection: "orthographic", height: 3 }, channel: "range" });
    for (let k = 0; k < 12; k++) {
        ask("probe", { camera, pixel: [Math.floor((rows * Math.floor(k / 4) + 1) / 3), Math.floor((columns * (k % 4) + 1) / 4)] });
    }
    ask("section", { part: { cut: { normal: [1, 2, 3], offset: 0 } }, svg: true });
    ask("camera", { camera });
}

// Every file of testdata/ that is read, and the example.
const extensions = [".obj", ".ply", ".stl", ".glb"];
const models = readdirSync(testdata).filter((name) => extensions.some((extension) => name.endsWith(extension)));
assert(models.length >= 10, `${models}`);
question(example().answer, [480, 640]);
for (const name of models) question(load(join(testdata, name)).answer, [96, 128]);

// A scene file of shapes, which opens nothing.
const made = join(folder, "made");
mkdirSync(made);
const make = (name, content) => {
    writeFileSync(join(made, name), content);
    return join(made, name);
};
// Zeros with both signs: what is the smaller one depends on the machine.
question(load(make("zeros.obj", "v 0 0 -0\nv 1 0 0\nv 0 1 -0\nv -0 -1 0\nf 1 2 3\nf 1 4 2\n")).answer, [24, 32]);

const scene = `
[camera]
position = [0.3, -6, 1.5]
look_at = [0, 0, 0.5]
fov = 40
[[objects]]
shape = "sphere"
center = [0, 0, 1]
radius = 1
[[objects]]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]
[[lights]]
kind = "point"
position = [-2, -3, 5]
intensity = [40, 40, 40]
`;
question(load(make("scene.toml", scene)).answer, [96, 128]);

// A larger mesh where there is one beside the clone.
const bunny = join(testdata, "../../shared/refdata/public/real/stl/bunny_99.stl");
if (existsSync(bunny)) question(load(bunny).answer, [480, 640]);

// Bad files, each one line; and that nothing is left of the file before.
const good = (name) => readFileSync(join(testdata, name));
const bad = {
    "empty.obj": "",
    "numbers.obj": "v 0 0 zero\n",
    "far.obj": "v 0 0 0\nf 1 2 3\n",
    "head.ply": "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n",
    "cut.ply": good("cube_quads_be.ply").subarray(0, 400),
    "cut.stl": good("cube_binary.stl").subarray(0, 300),
    "cut.glb": good("torus_draco.glb").subarray(0, 1000),
    "scrambled.glb": good("torus_draco.glb").map((byte, k) => (k > 1200 ? byte ^ 0x5a : byte)),
    "packed.obj.gz": Buffer.from([0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 3, 1, 2, 3]),
    "unknown.xyz": "1 2 3",
    "broken.toml": "[camera\n",
    "mesh.toml": '[[objects]]\nfile = "../../etc/passwd"\n',
    "outputs.toml": '[[outputs]]\nfile = "all.npz"\n',
    "old.fhs": "no scene",
};
let refused = 0;
for (const [name, content] of Object.entries(bad)) {
    const told = load(make(name, content));
    if (told.refused !== null) {
        assert(!told.refused.includes("\n") && told.refused.startsWith(name), told.refused);
        refused += 1;
        assert.equal(ask("info", {}).refused, "no file was loaded");
    }
}
assert(refused >= 9, `only ${refused} bad files were refused`);
load(join(testdata, "cube_binary.stl"));
for (const [name, about] of [
    ["frame", {}],
    ["frame", { camera: 1 }],
    ["nothing", {}],
    ["probe", { camera: answers.at(-1).answer.camera, pixel: [100000, 0] }],
    ["frame", { camera: { ...answers.at(-1).answer.camera, rows: 100000 } }],
    ["frame", { camera: answers.at(-1).answer.camera, channel: "no such" }],
]) {
    assert(ask(name, about).refused !== null, name);
}

// The same of the code on this machine.
writeFileSync(join(folder, "calls.json"), JSON.stringify(calls));
const told = spawnSync(native, [join(folder, "calls.json"), folder], { encoding: "utf8", maxBuffer: 1 << 28 });
assert.equal(told.status, 0, told.stderr);
const lines = told.stdout.trimEnd().split("\n").map((line) => JSON.parse(line));
assert.equal(lines.length, calls.length);

const sha256 = (bytes) => createHash("sha256").update(bytes).digest("hex").slice(0, 16);
let about = "";
for (const [number, call] of calls.entries()) {
    const { refused, answer, pixels } = answers[number];
    const expected = lines[number];
    const what = `${about} ${JSON.stringify(call)}`;
    if (call.question === undefined) about = call.name ?? "the example";
    assert.equal(expected.refused, refused !== null, `${what}: ${refused ?? expected.answer}`);
    if (refused !== null) {
        assert.equal(refused, expected.answer, what);
        continue;
    }
    assert.deepEqual(answer, JSON.parse(expected.answer), what);
    assert.equal(sha256(pixels), sha256(readFileSync(expected.pixels)), what);
    const { rows, columns } = call.about?.camera ?? { rows: 0, columns: 0 };
    if (rows === 480 && call.question === "hits") {
        const ends = [0, 8, 12, 16].map((bytes) => bytes * rows * columns);
        const [t, object, primitive] = [0, 1, 2].map((k) => sha256(pixels.subarray(ends[k], ends[k + 1])));
        console.log(`${about}: t ${t}, object ${object}, primitive ${primitive}`);
    } else if (rows === 480 && call.question === "frame" && call.about.channel === undefined) {
        console.log(`${about}: colours as a PNG ${sha256(pixels)}`);
    }
}
console.log(`${calls.length} answers are those of this machine's code, ${refused} bad files among them`);

// The module runs anywhere: it asks nothing of its host.
assert.deepEqual(WebAssembly.Module.imports(module), []);

// A trap: memory that is full of nonsense. It is caught, said, and the module is not used again; another one works.
const instance = await WebAssembly.instantiate(module, {});
const broken = new Firsthit(instance);
broken.example();
new Uint8Array(instance.exports.memory.buffer).fill(0xff, 1 << 20);
const { camera } = answers[0].answer;
const thrown = (act) => {
    try {
        act();
    } catch (error) {
        return error;
    }
    return null;
};
const first = thrown(() => broken.ask("hits", { camera }));
assert(first instanceof Broken, `${first}`);
assert.equal(thrown(() => broken.ask("info")), first);
const next = await Firsthit.start(module);
next.example();
assert.equal(sha256(next.ask("hits", { camera }).pixels), sha256(answers[calls.findIndex((call) => call.question === "hits")].pixels));
console.log("a trap is caught, and the next module works");
