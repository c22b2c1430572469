// @ts-check
// The module for JavaScript: each call of the door as a method. What is refused is a Refused, and what a trap ends is a Broken;
// after that the module cannot be used, and another one is to be started.

/** What the module refused, in its own words. */
export class Refused extends Error {}

/** That a bug, or memory that ran out, ended a call: the module is of no use any more. */
export class Broken extends Error {}

/** @typedef {{answer: any, pixels: Uint8Array}} Answered pixels are a copy, empty where the question has none */

const DONE = 0;

export class Firsthit {
    /** @type {any} */
    #door;
    /** @type {Broken | null} */
    #broken = null;

    /** @param {WebAssembly.Instance} instance */
    constructor(instance) {
        this.#door = instance.exports;
    }

    /** @param {WebAssembly.Module} module compiled once, it may be started again and again @returns {Promise<Firsthit>} */
    static async start(module) {
        return new Firsthit(await WebAssembly.instantiate(module, {}));
    }

    /** Reads a file, and answers `info`. The extension of its name tells the format. @param {string} name @param {Uint8Array} content */
    load(name, content) {
        return this.#call(() => this.#door.fh_load(this.#put(name, content)));
    }

    /** Takes the embedded example, and answers `info`. */
    example() {
        return this.#call(() => this.#door.fh_example());
    }

    /** @param {"info" | "frame" | "probe" | "camera" | "hits"} question @param {object} about @returns {Answered} */
    ask(question, about = {}) {
        const json = new TextEncoder().encode(JSON.stringify(about));
        return this.#call(() => this.#door.fh_ask(this.#put(question, json)));
    }

    /** The memory that the module has taken, in bytes. */
    get memoryBytes() {
        return this.#door.memory.buffer.byteLength;
    }

    /** Puts a name and what follows it into the room. @param {string} name @param {Uint8Array} rest @returns {number} the name's bytes */
    #put(name, rest) {
        const named = new TextEncoder().encode(name);
        const bytes = named.length + rest.length;
        const address = this.#door.fh_room(bytes) >>> 0;
        if (address === 0) throw new Refused(`${bytes} bytes are more than the memory there is`);
        const room = new Uint8Array(this.#door.memory.buffer, address, bytes);
        room.set(named);
        room.set(rest, named.length);
        return named.length;
    }

    /** @param {() => number} door @returns {Answered} */
    #call(door) {
        if (this.#broken) throw this.#broken;
        try {
            const status = door();
            const answer = this.#text("fh_answer");
            if (status !== DONE) throw new Refused(answer);
            return { answer: JSON.parse(answer), pixels: this.#bytes("fh_pixels").slice() };
        } catch (error) {
            if (error instanceof Refused) throw error;
            this.#broken = new Broken(this.#whyBroken(error), { cause: error });
            throw this.#broken;
        }
    }

    /** @param {unknown} error @returns {string} */
    #whyBroken(error) {
        let known = "";
        try {
            known = this.#text("fh_bug");
        } catch { /* its memory is no more than bytes now */ }
        return known.replaceAll("\n", " ") || String(error);
    }

    /** What two functions of the door tell the address and the length of. A view: the next call may move it. @param {string} name */
    #bytes(name) {
        const [address, bytes] = [this.#door[name]() >>> 0, this.#door[`${name}_bytes`]() >>> 0];
        return new Uint8Array(this.#door.memory.buffer, address, bytes);
    }

    /** @param {string} name @returns {string} */
    #text(name) {
        return new TextDecoder().decode(this.#bytes(name));
    }
}
