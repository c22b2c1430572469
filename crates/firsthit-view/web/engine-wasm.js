// @ts-check
// The engine that runs in the page: firsthit as a WebAssembly module, in workers. What it reads goes nowhere else.

import { EngineError, painted, singleSteps } from "./engine.js";

/** @typedef {import("./engine.js").Engine} Engine */
/** @typedef {import("./engine.js").FlatCamera} FlatCamera */
/** @typedef {import("./engine.js").FrameRequest} FrameRequest */
/** @typedef {import("./engine.js").Painted} Painted */
/** @typedef {import("./engine.js").Visibility} Visibility */
/** @typedef {{answer: any, pixels: Uint8Array<ArrayBuffer>}} Answer */
/**
 * What a worker is started with.
 * @typedef {object} Source
 * @property {() => Worker} worker makes a worker that runs worker.js
 * @property {ArrayBuffer} module the module's bytes
 * @property {string} name the file's, whose extension tells the format
 * @property {ArrayBuffer} content the file's
 * @property {{title: string, warnings: string[]} | null} about what the file does not say
 */

/** A worker with the scene, and who waits for its answers. */
class ModuleWorker {
    /** @type {Map<number, {resolve: (answer: Answer) => void, reject: (error: Error) => void}>} */
    #waiting = new Map();
    #count = 0;
    /** @type {Worker} */
    #worker;
    /** Whether a bug, or memory that ran out, has ended it. */
    isBroken = false;

    /** @param {Source} source */
    constructor({ worker, module, name, content }) {
        this.#worker = worker();
        this.#worker.onmessage = ({ data }) => {
            this.isBroken ||= data.isBroken === true;
            const asked = this.#waiting.get(data.id);
            this.#waiting.delete(data.id);
            if (data.error !== undefined) asked?.reject(new EngineError(data.error));
            else asked?.resolve(data);
        };
        this.#worker.onerror = (event) => {
            this.isBroken = true;
            for (const { reject } of this.#waiting.values()) reject(new EngineError(event.message || "The worker did not start."));
            this.#waiting.clear();
        };
        this.loaded = this.#post({ module, name, content });
        // Whoever asks is told.
        this.loaded.catch(() => {});
    }

    /** @param {string} question @param {object} about @returns {Promise<Answer>} */
    async ask(question, about) {
        await this.loaded;
        return this.#post({ question, about });
    }

    close() {
        this.#worker.terminate();
        for (const { reject } of this.#waiting.values()) reject(new EngineError("The page has ended."));
    }

    /** @param {object} asked @returns {Promise<Answer>} */
    #post(asked) {
        const id = ++this.#count;
        return new Promise((resolve, reject) => {
            this.#waiting.set(id, { resolve, reject });
            this.#worker.postMessage({ id, ...asked });
        });
    }
}

/** @implements {Engine} */
export class WasmEngine {
    /** @type {ModuleWorker | null} */
    #worker = null;
    /** With a worker of its own, for what shall not wait for pictures. @type {WasmEngine | null} */
    #aside = null;

    /** @param {Source} source @param {any} [info] what is known of the scene already */
    constructor(source, info = null) {
        this.source = source;
        this.known = info;
    }

    /** Starts the module and loads the file. @param {Source} source @returns {Promise<WasmEngine>} */
    static async start(source) {
        const engine = new WasmEngine(source);
        try {
            engine.#worker = new ModuleWorker(source);
            const { answer } = await engine.#worker.loaded;
            engine.known = { ...answer, ...(source.about ?? {}) };
            return engine;
        } catch (error) {
            engine.close();
            throw error;
        }
    }

    async info() {
        return this.known;
    }

    /** @param {FlatCamera} camera @param {[number, number]} pixel @param {Visibility} part @returns {Promise<any>} */
    async probe(camera, pixel, part) {
        return (await this.another().#ask("probe", { camera, pixel, part })).answer;
    }

    /** @param {Visibility} part @param {boolean} svg @returns {Promise<any>} */
    async section(part, svg) {
        return (await this.another().#ask("section", { part, svg })).answer;
    }

    /** @param {FlatCamera} camera @returns {Promise<any>} */
    async cameraText(camera) {
        return (await this.#ask("camera", { camera })).answer;
    }

    async alive() {}

    /** @param {number} samples @param {number} pixels */
    steps(samples, pixels) {
        return singleSteps(samples, pixels);
    }

    /** @param {FrameRequest} request @param {AbortSignal} signal @returns {Promise<Painted>} */
    async frame(request, signal) {
        const started = performance.now();
        const { answer, pixels } = await this.#ask("frame", request);
        signal.throwIfAborted();
        return painted({ ...answer, seconds: (performance.now() - started) / 1000 }, new Blob([pixels]));
    }

    /** Its worker starts with the first question. The other engine of that one is itself: two workers are enough. */
    another() {
        this.#aside ??= new WasmEngine(this.source, this.known);
        this.#aside.#aside = this.#aside;
        return this.#aside;
    }

    close() {
        this.#worker?.close();
        if (this.#aside !== this) this.#aside?.close();
    }

    /** @param {string} question @param {object} about */
    #ask(question, about) {
        // After a trap nothing of a module can be relied on.
        if (this.#worker?.isBroken) {
            this.#worker.close();
            this.#worker = null;
        }
        this.#worker ??= new ModuleWorker(this.source);
        return this.#worker.ask(question, about);
    }
}
