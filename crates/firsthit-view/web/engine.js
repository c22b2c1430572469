// @ts-check
// What the page asks, whoever computes the answer: this program's server, a worker, or the window around the page.

/** @typedef {{position: number[], aim: number[], up: number[], projection: "perspective" | "orthographic", ray_start: "eye" | "viewplane", focal_length: number, width: number, height: number, rows: number, columns: number}} FlatCamera */
/** @typedef {{normal: number[], offset: number}} Cut */
/** @typedef {{hidden: number[] | null, only: number[] | null, cut: Cut | null}} Visibility */
/** @typedef {{choice: "own" | "none" | "daylight", strength: number, turn: number}} EnvironmentRequest */
/** @typedef {{camera: FlatCamera, channel: string, samples: number | null, is_lit: boolean, light: string | null, sun: number[] | null, environment: EnvironmentRequest | null, colors: [number, number[]][], ground: boolean | null, edges: number | null, cut_color: number[] | null, part: Visibility}} FrameRequest */
/** @typedef {{rows: number, columns: number, samples: number, full_samples: number, seconds: number, range?: [number, number], components?: number, dtype?: "float32" | "int32"}} About */
/** @typedef {{about: About, blob?: Blob, image?: ImageBitmap, values?: Float32Array | Int32Array}} Painted */
/**
 * @typedef {object} Engine
 * @property {() => Promise<any>} info what there is to look at
 * @property {(request: FrameRequest, signal: AbortSignal) => Promise<Painted>} frame a picture
 * @property {(camera: FlatCamera, pixel: [number, number], part: Visibility) => Promise<any>} probe what a pixel shows, by its row and column
 * @property {(part: Visibility, svg: boolean) => Promise<any>} section the faces that the plane cuts, with their areas, and their drawing if it is wanted
 * @property {(camera: FlatCamera) => Promise<any>} cameraText a camera as other programs read it
 * @property {() => Promise<any>} alive tells that the page is still there
 * @property {(samples: number, pixels: number) => (number | null)[]} steps in how many samples each a still picture of so many is asked for; null is all of them
 * @property {() => Engine} another one whose frames do not end those of this one
 * @property {() => void} close
 */

/** What an engine refused, or that it is gone. */
export class EngineError extends Error {
    /** @param {string} why @param {boolean} [isSuperseded] whether a newer frame of the same page took its place */
    constructor(why, isSuperseded = false) {
        super(why);
        this.isSuperseded = isSuperseded;
    }
}

/** A larger picture is begun anew at each step: frame.rs has the same number of pixels. */
const MOST_KEPT = 1 << 22;

/** The steps where a frame cannot be interrupted, and nobody waits for what is sent: a sample each, so that the next camera soon has its turn. @param {number} samples @param {number} pixels @returns {(number | null)[]} */
export function singleSteps(samples, pixels) {
    if (pixels > MOST_KEPT) return doublingSteps(samples);
    return [...Array.from({ length: samples - 1 }, (_, k) => k + 1), null];
}

/** The steps where a frame cannot be interrupted, and takes a while to send: none takes longer than all before it. @param {number} samples @returns {(number | null)[]} */
export function doublingSteps(samples) {
    const steps = [];
    for (let step = 1; step < samples; step *= 2) steps.push(step);
    return [...steps, null];
}

/** A frame from the bytes that engines send: colours are a PNG, other values a zlib stream. @param {About} about @param {Blob} blob @returns {Promise<Painted>} */
export async function painted(about, blob) {
    if (about.dtype === undefined) {
        return { about, blob, image: await createImageBitmap(blob) };
    }
    const bytes = await unpacked(blob, "deflate");
    const values = about.dtype === "int32" ? new Int32Array(bytes) : new Float32Array(bytes);
    return { about, values };
}

/** @param {Blob} blob @param {"deflate" | "gzip"} packing @returns {Promise<ArrayBuffer>} */
export function unpacked(blob, packing) {
    return new Response(blob.stream().pipeThrough(new DecompressionStream(packing))).arrayBuffer();
}
