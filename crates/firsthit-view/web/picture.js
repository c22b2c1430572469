// @ts-check
// The picture on the stage: colours for the numbers of a channel and their legend, and the picture as a file.

import { colored, rangeOf } from "./color.js";
import { element, hex } from "./dom.js";
import { drawLegend, showLegend } from "./legend.js";

/** @typedef {import("./engine.js").Painted} Painted */
/** @typedef {import("./compare.js").Shown} Shown */

/** Channels whose numbers are not shown by a map of colours. */
const KINDS = /** @type {Record<string, "identifier" | "flag" | "direction" | "number">} */ ({
    object: "identifier", primitive: "identifier", front: "flag", normal: "direction", position: "direction",
});

/** Whether a channel is shown by a map of colours. @param {string} channel */
export const isMapped = (channel) => channel !== "color" && !KINDS[channel];

export class Picture {
    /** @param {any} info */
    constructor(info) {
        this.info = info;
        this.canvas = element("picture");
        this.drawing = this.canvas.getContext("2d", { willReadFrequently: true });
        /** What is shown now, if it has all its pixels. @type {Shown | null} */
        this.shown = null;
        /** The range of the numbers that are shown. @type {[number, number] | null} */
        this.range = null;
    }

    /** @param {Painted} painted @param {string} channel @param {boolean} isWhole whether it has all the pixels of the stage @param {boolean} isDone whether no better one follows */
    paint(painted, channel, isWhole, isDone) {
        const { rows, columns } = painted.about;
        const { canvas, drawing } = this;
        if (canvas.width !== columns || canvas.height !== rows) [canvas.width, canvas.height] = [columns, rows];
        if (painted.image) {
            showLegend(this.#legendOf(painted.about.range));
            drawing.clearRect(0, 0, columns, rows);
            drawing.drawImage(painted.image, 0, 0);
            painted.image.close();
        } else {
            this.#paintNumbers(painted, channel);
        }
        const pixels = () => drawing.getImageData(0, 0, columns, rows).data;
        this.shown = isWhole ? { rows, columns, pixels: pixels(), values: painted.values ?? null, name: channel, isDone } : null;
        document.body.dataset.painted = `${rows}x${columns}`;
    }

    /** @param {Painted} painted @param {string} channel */
    #paintNumbers({ about: { rows, columns, components }, values }, channel) {
        if (!values || !components) return;
        const kind = KINDS[channel] ?? "number";
        const range = kind === "number" ? (chosenRange() ?? rangeOf(values)) : null;
        const map = this.info.maps[element("map").value];
        const shown = channel === "position" ? this.#spread(values) : values;
        const pixels = colored(shown, components, { kind, map, range });
        this.drawing.putImageData(new ImageData(/** @type {any} */ (pixels), columns, rows), 0, 0);
        showLegend(range && { name: channel, map, range });
        this.range = range;
    }

    /** The legend of a scene that is coloured by numbers. @param {[number, number] | undefined} range */
    #legendOf(range) {
        const { colors, maps } = this.info;
        if (!colors || !range) return null;
        const [below, above] = [colors.below, colors.above].map((color) => color && hex(color));
        return { name: colors.by.replace(/^attribute:/, ""), map: maps[colors.map], range, below, above };
    }

    /** Positions, each axis from -1 to 1. @param {Float32Array | Int32Array} values */
    #spread(values) {
        const [low, high] = this.info.bounds ?? [[0, 0, 0], [1, 1, 1]];
        return Float32Array.from(values, (x, k) => (2 * (x - low[k % 3])) / (high[k % 3] - low[k % 3] || 1) - 1);
    }

    /** The colour that is shown there. @param {[number, number]} pixel */
    colorAt([row, column]) {
        return [...this.drawing.getImageData(column, row, 1, 1).data];
    }

    /** The picture with its marks and its legend, as a PNG. @returns {Promise<Blob>} */
    asShown() {
        const overlay = element("overlay");
        const whole = document.createElement("canvas");
        [whole.width, whole.height] = [overlay.width, overlay.height];
        const on = /** @type {CanvasRenderingContext2D} */ (whole.getContext("2d"));
        on.imageSmoothingEnabled = !this.canvas.classList.contains("pixels");
        for (const layer of [this.canvas, overlay]) on.drawImage(layer, 0, 0, whole.width, whole.height);
        drawLegend(on, devicePixelRatio);
        return new Promise((resolve, reject) => {
            whole.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("The browser made no PNG of the picture."))));
        });
    }
}

/** The range that was typed, if it is one. @returns {[number, number] | null} */
function chosenRange() {
    const [low, high] = ["low", "high"].map((id) => element(id).value.trim());
    const isEmpty = low === "" && high === "";
    const isRange = low !== "" && high !== "" && Number(low) < Number(high);
    for (const id of ["low", "high"]) element(id).setAttribute("aria-invalid", String(!isEmpty && !isRange));
    return isRange ? [Number(low), Number(high)] : null;
}
