// @ts-check
// The legend beside the model: a bar of colours with their numbers.

import { element, make } from "./dom.js";
import { aligned, trimmed } from "./readout.js";

/** How the numbers of a bar are told: at both ends and between. */
const STEPS = 4;
/** What a number of the range needs to be told from its neighbours. */
const DIGITS = 4;

/** @typedef {{name: string, map: number[][], range: [number, number], below?: string | null, above?: string | null}} Legend */

/** @type {Legend | null} */
let now = null;

// On a phone it begins folded: it would cover a quarter of the picture.
element("legend").open = !matchMedia("(max-width: 50rem)").matches;

/** The numbers from the top down. @param {[number, number]} range */
function numbers([low, high]) {
    const steps = Array.from({ length: STEPS + 1 }, (_, k) => high + (k / STEPS) * (low - high));
    // As many decimals as the range needs: the numbers may be large, and near each other.
    const size = Math.floor(Math.log10((high - low) || 1));
    const whole = Math.floor(Math.log10(Math.max(Math.abs(low), Math.abs(high)) || 1));
    return trimmed(aligned(steps, DIGITS + Math.max(0, Math.min(11, whole - size))));
}

/** Shows it; none without a range. @param {Legend | null} legend */
export function showLegend(legend) {
    now = legend;
    element("legend").hidden = legend === null;
    if (!legend) return;
    const canvas = element("legend-map");
    canvas.height = legend.map.length;
    const on = canvas.getContext("2d");
    const pixels = on.createImageData(1, legend.map.length);
    legend.map.forEach((color, k) => pixels.data.set([...color, 255], 4 * (legend.map.length - 1 - k)));
    on.putImageData(pixels, 0, 0);
    element("legend-name").textContent = legend.name;
    element("legend-numbers").replaceChildren(...numbers(legend.range).map((text) => make("li", text)));
    for (const side of /** @type {const} */ (["above", "below"])) {
        const color = legend[side];
        element(`legend-${side}`).hidden = !color;
        element(`legend-${side}`).firstElementChild.style.background = color ?? "";
    }
}

/** Draws it into a picture, at its right edge. @param {CanvasRenderingContext2D} on @param {number} scale pixels of the picture for one of the page */
export function drawLegend(on, scale) {
    if (!now) return;
    const texts = numbers(now.range);
    on.font = `${13 * scale}px system-ui, sans-serif`;
    const named = [now.name, ...texts].map((text) => on.measureText(text).width);
    const [bar, gap, line] = [14 * scale, 8 * scale, 20 * scale];
    const width = Math.max(named[0], bar + gap + Math.max(...named.slice(1))) + 2 * gap;
    const high = Math.min(224 * scale, on.canvas.height - 4 * line);
    const [left, top] = [on.canvas.width - width - gap, (on.canvas.height - high - line) / 2];
    on.fillStyle = "#10151be6";
    on.beginPath();
    on.roundRect(left, top - gap, width, high + line + 3 * gap, 4 * scale);
    on.fill();
    on.fillStyle = "#fff";
    on.textBaseline = "top";
    on.fillText(now.name, left + gap, top);
    on.textBaseline = "middle";
    on.imageSmoothingEnabled = false;
    on.drawImage(element("legend-map"), left + gap, top + line + gap / 2, bar, high);
    texts.forEach((text, k) => on.fillText(text, left + 2 * gap + bar, top + line + gap / 2 + (k / STEPS) * high));
}
