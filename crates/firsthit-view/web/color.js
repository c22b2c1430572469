// @ts-check
// Colours for the numbers of a channel.

/** @typedef {Uint8ClampedArray} Pixels */

const MISS = [16, 21, 27];

/** The smallest and the largest finite number. @param {ArrayLike<number>} values @returns {[number, number] | null} */
export function rangeOf(values) {
    let [low, high] = [Infinity, -Infinity];
    for (let k = 0; k < values.length; k++) {
        const x = values[k];
        if (x < low && x > -Infinity) low = x;
        if (x > high && x < Infinity) high = x;
    }
    return low <= high ? [low, high] : null;
}

/** Each identifier's own colour: that of the PNGs that firsthit writes. @param {number} identifier @returns {number[]} */
export function identifierColor(identifier) {
    if (identifier < 0) return [0, 0, 0];
    const spread = (/** @type {number} */ factor) => (Math.imul(identifier, factor) >>> 0) / 2 ** 32;
    const hue = (0.58 + spread(2654435769)) % 1;
    const saturation = 0.8 - 0.5 * spread(3242174889);
    const value = 1 - 0.4 * spread(2447445414);
    return [0, 1 / 3, 2 / 3].map((own) => {
        const apart = Math.abs(hue - own);
        const away = Math.min(apart, 1 - apart);
        const strength = Math.max(0, Math.min(1, 2 - 6 * away));
        return Math.round(255 * value * (1 - saturation * (1 - strength)));
    });
}

/** Colours of a channel's numbers.
 * @param {Float32Array | Int32Array} values @param {number} components
 * @param {{kind: "number" | "identifier" | "direction" | "flag", map: number[][], range: [number, number] | null}} how
 * @returns {Pixels} red, green, blue and alpha of each pixel */
export function colored(values, components, how) {
    const count = values.length / components;
    const pixels = new Uint8ClampedArray(4 * count);
    /** @type {Map<number, number[]>} */
    const known = new Map();
    const [low, high] = how.range ?? [0, 1];
    const scale = high > low ? (how.map.length - 1) / (high - low) : 0;
    for (let k = 0; k < count; k++) {
        const x = values[k * components];
        let color = MISS;
        if (how.kind === "identifier") {
            color = known.get(x) ?? identifierColor(x);
            known.set(x, color);
        } else if (how.kind === "flag") {
            color = x ? [255, 255, 255] : [0, 0, 0];
        } else if (how.kind === "direction") {
            if (!Number.isNaN(x)) color = [0, 1, 2].map((axis) => 127.5 * (values[k * components + axis] + 1));
        } else if (Number.isFinite(x)) {
            const step = Math.round(Math.max(0, Math.min(how.map.length - 1, (x - low) * scale)));
            color = how.map[step];
        }
        pixels.set(color, 4 * k);
        pixels[4 * k + 3] = 255;
    }
    return pixels;
}
